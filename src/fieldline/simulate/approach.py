"""A run seen from the first body: where another body was and how it was turned, what its currents cost.

Axes h are the first body's: x up, y along its velocity, z along its orbit's normal (`control.tracking.relative_state`).

    charge of a conductor     integral |I| dt                                                       (1)
    heat                      integral R I^2 dt                                                     (2)
    work on the orbit         integral F . (v - w x r) dt,   F = I L x B                            (3)
    impulse of the thrusters  integral |T| dt

(3): a conductor moves through the plasma that turns with the Earth; what its force does on the body its supply must give
beside the heat, or takes back where it is negative. A thruster fires in pulses within a law's period: its command is taken.
Sums by the trapezoid over the outputs: currents are held over a law's period, so outputs of that length or less are exact
enough (1 %).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fieldline.constants import EARTH_ROTATION_RATE_RAD_S
from fieldline.errors import InputError, nearest, shown

if TYPE_CHECKING:
    import xarray


def approach(dataset: xarray.Dataset, body: str | None = None) -> xarray.Dataset:
    """Place, attitude and costs of a body beside the first one, from a run of `fieldline.simulate`.

    Parameters
    ----------
    dataset : the run.      body : its name; the first after the first that carries conductors, else the second, by default.

    Returns
    -------
    Dataset over time: place_h_m, rate_h_m_s, angle_deg (a rotation vector's parts), angle_rate_deg_s (axis); distance_m;
    force_h_n of the conductors; and of the whole run charge_c (conductor), peak_share (conductor, of its limit), heat_j,
    work_j, impulse_n_s (thruster), corridor_deg, the half-angle of the cone about the line from start to end, seen from
    the end, that holds the way.

    Raises
    ------
    InputError : a run of one body, or a body that it has not.
    """
    import xarray

    from fieldline.simulate.scenario.scenario import Scenario

    scenario = Scenario.from_toml(dataset.attrs["scenario_toml"])
    index = _which(scenario, body)
    place, rate, dcm_hi = relative_motion_h(dataset, index)
    angle, turning = _attitude(dataset, index, dcm_hi)
    vector = ("time", "axis")
    data = xarray.Dataset(
        {
            "place_h_m": (vector, place, {"units": "m", "long_name": "place from the first body", "axes": "h"}),
            "rate_h_m_s": (vector, rate, {"units": "m s-1", "long_name": "its rate in the turning axes", "axes": "h"}),
            "distance_m": ("time", np.linalg.norm(place, axis=1), {"units": "m", "long_name": "distance of centres"}),
            "angle_deg": (vector, angle, {"units": "degree", "long_name": "turn of the body from axes h"}),
            "angle_rate_deg_s": (vector, turning, {"units": "degree s-1", "long_name": "rate of the body against axes h"}),
            "corridor_deg": ((), corridor_deg(place), {"units": "degree", "long_name": "half-angle of the cone of the way"}),
        },
        coords={"time": dataset["time"].values, "seconds": dataset["seconds"], "axis": ["up", "along", "across"]},
        attrs={"body": scenario.body[index].name, "target": scenario.body[0].name, "title": scenario.name},
    )
    _costs(data, dataset, scenario.body[index], index, dcm_hi)
    return data


def relative_motion_h(dataset: Any, index: int, first: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """((n, 3) place [m], (n, 3) rate [m/s] in axes h, (n, 3, 3) matrices v_h = dcm_hi @ v_i) of a body about the first."""
    position, velocity = dataset["position_i"].values, dataset["velocity_i"].values
    r, v = position[:, first], velocity[:, first]
    momentum = np.cross(r, v)
    up, across = r / np.linalg.norm(r, axis=1)[:, None], momentum / np.linalg.norm(momentum, axis=1)[:, None]
    dcm_hi = np.stack([up, np.cross(across, up), across], axis=1)
    spin = np.linalg.norm(momentum, axis=1) / (r * r).sum(axis=1)
    place = np.einsum("nij,nj->ni", dcm_hi, position[:, index] - r)
    rate = np.einsum("nij,nj->ni", dcm_hi, velocity[:, index] - v)
    rate = rate - spin[:, None] * np.stack([-place[:, 1], place[:, 0], 0.0 * place[:, 0]], axis=1)
    return place, rate, dcm_hi


def corridor_deg(place: np.ndarray) -> float:
    """Half-angle [deg] of the cone with its point at the last place, about the first, that holds every place on the way.

    What lies within a tenth of the way from the point is left out: a cone ends at its point. 0 for a body that stands.
    """
    from_end = place - place[-1]
    length = float(np.linalg.norm(from_end[0]))
    far = np.linalg.norm(from_end, axis=1) > 0.1 * length
    if length < 0.05 * float(np.linalg.norm(place, axis=1).max()) or not far.any():
        return 0.0
    along = from_end[far] @ (from_end[0] / length)
    across = np.linalg.norm(from_end[far] - along[:, None] * (from_end[0] / length), axis=1)
    return float(np.degrees(np.arctan2(across, along)).max())


def _which(scenario, name: str | None) -> int:
    """Index of the body that is looked at."""
    names = [one.name for one in scenario.body]
    if len(names) < 2:
        raise InputError("an approach needs two bodies, the first one the target; the run has one.")
    if name is None:
        carrying = [k for k, one in enumerate(scenario.body) if k and one.conductor]
        return carrying[0] if carrying else 1
    if name not in names[1:]:
        raise InputError(f'the run has no body "{shown(name)}" beside the first; {nearest(name, names[1:])}')
    return names.index(name)


def _attitude(dataset: Any, index: int, dcm_hi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """((n, 3) turn [deg], (n, 3) rate against axes h [deg/s]), body axes."""
    from scipy.spatial.transform import Rotation

    body = Rotation.from_quat(dataset["q_bi"].values[:, index])
    turn = Rotation.from_matrix(dcm_hi) * body
    r, v = dataset["position_i"].values[:, 0], dataset["velocity_i"].values[:, 0]
    spin_i = np.cross(r, v) / (r * r).sum(axis=1)[:, None]
    return turn.as_rotvec(degrees=True), np.degrees(dataset["omega_bi_b"].values[:, index] - body.inv().apply(spin_i))


def _costs(data, dataset: Any, body, index: int, dcm_hi: np.ndarray) -> None:
    """Charge, heat, work and impulse: equations (1) to (3)."""
    seconds = dataset["seconds"].values

    def whole(values):
        return np.trapezoid(values, seconds, axis=0)

    if body.conductor and "conductor_current" in dataset:
        from scipy.spatial.transform import Rotation

        names = body.names_of("conductor")
        current = dataset["conductor_current"].sel(conductor=[f"{body.name}.{one}" for one in names]).values
        wire = np.array([one.length_m * np.array(one.direction_b) for one in body.conductor])
        resistance = np.array([one.resistance_ohm for one in body.conductor])
        push_b = np.cross(current @ wire, dataset["field_b"].values[:, index])
        push = Rotation.from_quat(dataset["q_bi"].values[:, index]).apply(push_b)
        r, v = dataset["position_i"].values[:, index], dataset["velocity_i"].values[:, index]
        through = v - np.cross([0.0, 0.0, EARTH_ROTATION_RATE_RAD_S], r)
        limits = np.array([one.current_max_a for one in body.conductor])
        data.coords["conductor"] = names
        data["force_h_n"] = (("time", "axis"), np.einsum("nij,nj->ni", dcm_hi, push), {"units": "N", "axes": "h"})
        data["current_a"] = (("time", "conductor"), current, {"units": "A", "long_name": "current of each conductor"})
        data["charge_c"] = ("conductor", whole(np.abs(current)), {"units": "C", "long_name": "charge through each conductor"})
        data["peak_share"] = ("conductor", np.abs(current).max(axis=0) / limits, {"units": "1", "long_name": "peak over limit"})
        heat, work = current**2 @ resistance, (push * through).sum(axis=1)
        data["power_w"] = ("time", heat + work, {"units": "W", "long_name": "power of the supplies"})
        data["heat_j"] = ((), float(whole(heat)), {"units": "J", "long_name": "heat in the conductors"})
        data["work_j"] = ((), float(whole(work)), {"units": "J", "long_name": "work of the currents on the orbit"})
    if body.thruster and "thrust" in dataset:
        names = body.names_of("thruster")
        duty = dataset["thrust"].sel(thruster=[f"{body.name}.{one}" for one in names]).values
        force = np.array([one.force_n for one in body.thruster])
        data.coords["thruster"] = names
        data["impulse_n_s"] = ("thruster", whole(duty * force), {"units": "N s", "long_name": "impulse of each thruster"})
