"""Standoff, R-BAR, V-BAR and Z-BAR with the regulator of the frozen instant (appendix E).

Q is q diag(1 for places and their rates, r0 for angles and theirs), R the unit matrix; the prefilter is (4.9). The field
stays at its angle: what the same regulators do on the field that turns is another question (the thesis's chapter 6).

    case       from [m]          to [m]            q      towers l1, l2 [m]
    standoff   (100, 100, 100)   the same          1      50, 310
    r-bar      (100, 0, 0)       (50, 0, 0)        1000   50, 310
    v-bar      (0, 100, 0)       (0, 50, 0)        100    310, 50
    z-bar      (0, 0, 100)       (0, 0, 50)        1000   50, 310   (described, not printed)
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fieldline.analysis.controllability import orbital_scale
from fieldline.analysis.margins import Margins, frozen_margins
from fieldline.cases.afit_1992.earth import ALTITUDE_M, FIELD_ANGLE_DEG, SOURCE, Circle, circle, whole
from fieldline.cases.afit_1992.frozen_model import built, frozen_plant
from fieldline.cases.afit_1992.reach import refuse_uncontrollable
from fieldline.cases.ames_1961.dipole_field import settings_text
from fieldline.cases.erbs_like import number
from fieldline.control.electrodynamic import Plant
from fieldline.control.frozen_regulator import Regulator, Response, frozen_regulator, respond
from fieldline.control.steady_hold import held_share, holding_controls, most_held_share, refuse_unreachable
from fieldline.design.tracking_vehicle import TrackingVehicle
from fieldline.environment.orbital_dipole import orbit_gradient_h
from fieldline.errors import InputError, NoEstimateError, nearest, shown
from fieldline.mechanics.relative_motion import OUTPUTS, STATES, linearisation_error

LARGEST_ANGLE = np.radians(15.0)
LARGEST_ERROR = 0.01
MOST_POINTS = 200_001


class Approach(NamedTuple):
    """One of the thesis's runs."""

    start_m: tuple[float, float, float]
    target_m: tuple[float, float, float]
    state_weight: float
    towers_m: tuple[float, float]


APPROACHES = {
    "standoff": Approach((100.0, 100.0, 100.0), (100.0, 100.0, 100.0), 1.0, (50.0, 310.0)),
    "r-bar": Approach((100.0, 0.0, 0.0), (50.0, 0.0, 0.0), 1000.0, (50.0, 310.0)),
    "v-bar": Approach((0.0, 100.0, 0.0), (0.0, 50.0, 0.0), 100.0, (310.0, 50.0)),
    "z-bar": Approach((0.0, 0.0, 100.0), (0.0, 0.0, 50.0), 1000.0, (50.0, 310.0)),
}


def lqr(
    case: str = "standoff",
    field_angle_deg: float = FIELD_ANGLE_DEG,
    state_weight: float | None = None,
    *,
    control_weight: float = 1.0,
    start_m=None,
    target_m=None,
    steps: int = 1,
    step_every_s: float = 2000.0,
    duration_s: float = 10_000.0,
    points: int = 501,
    vertical_m: float | None = None,
    horizontal_m: float | None = None,
    thruster: bool = True,
    arms: str = "centre",
    inclination_deg: float = 0.0,
    node_deg: float = 0.0,
    altitude_m: float = ALTITUDE_M,
    current_limit_a: float = 125.0,
    within_limit: bool = False,
):
    """Gains, prefilter, poles and the response of a case, as a Dataset over `seconds`.

    Parameters
    ----------
    case : "standoff", "r-bar", "v-bar" or "z-bar".      field_angle_deg : where the field is frozen.
    state_weight, control_weight, start_m, target_m, vertical_m, horizontal_m : other than the case's own.
    steps, step_every_s : the command is moved from start to target in so many equal steps ("stepping").
    duration_s, points : of the response.      thruster, arms, inclination_deg, node_deg, altitude_m : vehicle and orbit.
    current_limit_a : what a conductor carries; the response does not respect it, the Dataset says what it can hold.
    within_limit : refuse a target that cannot be held within it.

    Returns
    -------
    Dataset: gain, prefilter, pole; state, control, force_h [N], moment_b [N m], reference_m over seconds; peak_current_a,
    held_share (of the target, at the limit, by the least norm), most_held_share (by the best currents); of all controls and
    (..._of) of each alone: gain_margin_low, gain_margin_high, phase_margin_deg, delay_margin_s, and return_difference
    (`analysis.margins`), while the field stays at its angle.

    Raises
    ------
    InputError : an unknown case, weights that are not positive, a plant out of reach, a target out of reach (within_limit).
    """
    settings = dict(locals())
    if not isinstance(case, str) or case not in APPROACHES:
        raise InputError(f'there is no case "{shown(str(case))}"; {nearest(str(case), APPROACHES)}')
    own = APPROACHES[case]
    towers = own.towers_m[0] if vertical_m is None else vertical_m, own.towers_m[1] if horizontal_m is None else horizontal_m
    start, target = _place("start_m", start_m, own.start_m), _place("target_m", target_m, own.target_m)
    orbit = circle(altitude_m)
    made = built({**settings, "vertical_m": towers[0], "horizontal_m": towers[1]})
    for name, angle in (("field_angle_deg", field_angle_deg), ("node_deg", node_deg), ("inclination_deg", inclination_deg)):
        number(name, angle, -1e6, 1e6)
    refuse_uncontrollable(made, orbit, field_angle_deg, inclination_deg, node_deg)
    plant, field_h = frozen_plant(made, orbit, field_angle_deg, inclination_deg, node_deg)
    weight = number("state_weight", own.state_weight if state_weight is None else state_weight, 1e-12)
    found = regulator_of(plant, orbit, weight, number("control_weight", control_weight, 1e-12))
    seconds, references = _command(start, target, steps, step_every_s, duration_s, points)
    state = np.zeros(12)
    state[:6:2] = start
    response = respond(plant.F, plant.G, found, state, references, seconds)
    held = _held(made, plant, target, number("current_limit_a", current_limit_a, 1e-9))
    if within_limit:
        refuse_unreachable(held["most_held_share"], target, f"{current_limit_a:g} A a conductor")
    n = orbit.mean_motion_rad_s
    margins = frozen_margins(plant.F, plant.G, found.gain, rate=n, scale=orbital_scale(n))  # R is a multiple of 1
    return _dataset(made, plant, orbit, found, response, references, settings | held | {"field_h": field_h, "margins": margins})


def regulator_of(plant: Plant, orbit: Circle, state_weight: float, control_weight: float = 1.0) -> Regulator:
    """Gain and prefilter with the thesis's weights."""
    states = state_weight * np.repeat([1.0, orbit.radius_m], 6)
    n = orbit.mean_motion_rad_s
    return frozen_regulator(plant.F, plant.G, plant.H, states, control_weight, rate=n, scale=orbital_scale(n))


def _place(name: str, given, own) -> np.ndarray:
    """(3,) [m], the case's own where none is given."""
    try:
        place = np.asarray(own if given is None else given, dtype=float)
    except (TypeError, ValueError):
        place = np.empty(0)
    if place.shape != (3,) or not np.isfinite(place).all() or np.abs(place).max() > 1e6:
        raise InputError(f"{name} must be three places x, y, z in metres, under 1000 km; got {given!r}.")
    return place


def _command(start, target, steps, step_every_s, duration_s, points) -> tuple[np.ndarray, np.ndarray]:
    """seconds (k,) and references (k, 6): the target, or equal steps towards it."""
    steps, points = whole("steps", steps, 1, 10_000), whole("points", points, 3, MOST_POINTS)
    seconds = np.linspace(0.0, number("duration_s", duration_s, 1.0, 1e9), points)
    done = np.minimum(1.0, (1.0 + np.floor(seconds / number("step_every_s", step_every_s, 1e-3) + 1e-9)) / steps)
    references = np.zeros((points, 6))
    references[:, :3] = start + done[:, None] * (target - start)
    return seconds, references


def _held(made: TrackingVehicle, plant: Plant, target: np.ndarray, limit_a: float) -> dict[str, float]:
    """The shares of the target that the limit on currents can hold; zero where the plant cannot hold it at all."""
    reference = np.concatenate([target, np.zeros(3)])
    limits = np.concatenate([np.full(len(made.conductors), limit_a), np.full(len(made.thrusters), np.inf)])
    most, _ = most_held_share(plant.F, plant.G, plant.H, reference, limits)
    try:
        least = held_share(holding_controls(plant.F, plant.G, plant.H, reference), limits)
    except NoEstimateError:
        least = 0.0
    return {"held_share": least, "most_held_share": most}


def _cautions(orbit: Circle, field_h: np.ndarray, response: Response) -> tuple[float, float, list[str]]:
    """The errors of the linear models over the response, as parts of gravity's difference and of the field, and words."""
    place = response.state[:, :6:2]
    motion = float(linearisation_error(orbit.radius_m, place).max())
    direction = field_h / orbit.strength_tesla / np.array([2.0, -1.0, -1.0])
    change = place @ orbit_gradient_h(direction, orbit.strength_tesla, orbit.radius_m).T
    field = float(np.linalg.norm(change, axis=1).max() / np.linalg.norm(field_h))
    told = []
    for name, size in (("relative motion", motion), ("a field that is the same everywhere", field)):
        if size > LARGEST_ERROR:
            told.append(f"{name} is used outside its range: wrong by {100.0 * size:.1f} %.")
    angle = float(np.abs(response.state[:, 6::2]).max())
    if angle > LARGEST_ANGLE:
        told.append(f"angles reach {np.degrees(angle):.0f} deg: the small-angle equations are wrong beyond 15.")
    return motion, field, told


def _margins_of(margins: Margins) -> dict[str, tuple]:
    """What the frozen loop forgives, all controls at once and each alone."""
    every = {
        "gain_margin_low": (margins.gain.low, [one.low for one in margins.gain_of], "1", "least stable factor"),
        "gain_margin_high": (margins.gain.high, [one.high for one in margins.gain_of], "1", "largest stable factor"),
        "phase_margin_deg": (
            np.degrees(margins.lag_rad),
            np.degrees(margins.lag_of_rad),
            "degree",
            "least lag or lead that loses it",
        ),
        "delay_margin_s": (margins.delay_s, margins.delay_of_s, "s", "least delay that loses it"),
    }
    found: dict[str, tuple] = {}
    for name, (together, alone, unit, words) in every.items():
        found[name] = (), together, {"units": unit, "long_name": f"{words}, all controls"}
        found[f"{name}_of"] = "control", alone, {"units": unit, "long_name": f"{words}, one control"}
    words = "least distance of the loop from -1, over R"
    return found | {"return_difference": ((), margins.return_difference, {"units": "1", "long_name": words})}


def _dataset(
    made: TrackingVehicle, plant: Plant, orbit: Circle, found: Regulator, response: Response, references: np.ndarray, settings
):
    """Everything with its labels and units."""
    import xarray as xr

    loads = response.control @ plant.G.T
    motion, field, told = _cautions(orbit, settings["field_h"], response)
    currents = response.control[:, : len(made.conductors)]
    scalars = {
        "peak_current_a": (float(np.abs(currents).max()), "A", "largest current of a conductor"),
        "held_share": (settings["held_share"], "1", "of the target, held within the limit by the least currents"),
        "most_held_share": (settings["most_held_share"], "1", "of the target, held within the limit by the best currents"),
        "motion_error": (motion, "1", "largest error of the linear relative motion, as a part of it"),
        "field_error": (field, "1", "largest change of the field over the way, as a part of it"),
    }
    inertia = np.array(made.inertia_kg_m2)
    time = "seconds"
    return xr.Dataset(
        {
            "gain": (("control", "state"), found.gain, {"long_name": "K of u = M r - K x, SI"}),
            "prefilter": (("control", "output"), found.prefilter, {"long_name": "M, SI"}),
            "pole_real": ("mode", found.poles.real, {"units": "s-1"}),
            "pole_imag": ("mode", found.poles.imag, {"units": "rad s-1"}),
            "state_of": ((time, "state"), response.state, {"long_name": "places [m], angles [rad], their rates"}),
            "control_of": ((time, "control"), response.control, {"long_name": "currents [A] and thrust [N]"}),
            "force_h": ((time, "axis"), made.mass_kg * loads[:, 1:6:2], {"units": "N", "axes": "h"}),
            "moment_b": ((time, "axis"), inertia * loads[:, 7::2], {"units": "N m", "axes": "b"}),
            "reference_m": ((time, "axis"), references[:, :3], {"units": "m", "long_name": "command", "axes": "h"}),
            **{name: ((), value, {"units": unit, "long_name": words}) for name, (value, unit, words) in scalars.items()},
            **_margins_of(settings["margins"]),
        },
        coords={
            time: (time, response.seconds, {"units": "s"}),
            "state": list(STATES),
            "control": list(plant.controls),
            "output": list(OUTPUTS),
            "axis": list("xyz"),
        },
        attrs={
            "title": f"{settings['case']}, field frozen at {settings['field_angle_deg']:g} deg",
            "case": "afit_1992_lqr",
            "source": f"{SOURCE}, section 4.2 and appendix E",
            "settings_json": settings_text({key: value for key, value in settings.items() if key not in ("field_h", "margins")}),
            "riccati_residual": found.residual,
            "cautions": " ".join(told),
        },
    )
