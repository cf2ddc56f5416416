"""A rigid subsatellite below a point mass on a massless line, as a scenario of the plant.

The Shuttle starts on the x axis at r2 and moves along y (for an inclination, towards z as well); the attachment, or the
centre of mass, is straight below it at r1. With e small, x' = rbar n e is added to both. Unless told otherwise,

    attachment         attachment at r1, the centre of mass off it, moving at r1 n along the track             (1)
    attachment-rigid   the same, the centre of mass moving as a point of the rigidly turning pair, n x r       (2)
    centre             centre of mass at r1, moving at r1 n                                                  (3)

The unstretched length is that which balances the tension of the pair at the length from the Shuttle to the attachment.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fieldline.cases.erbs_like import number
from fieldline.cases.sao_1982.dumbbell import Dumbbell, critical_damping, dumbbell, natural_length
from fieldline.cases.sao_1982.euler_angles import body_rate, direction_cosines
from fieldline.cases.sao_1982.surroundings import EARTH_RADIUS_M, GM_M3_S2, J2, load_parameters
from fieldline.errors import InputError, nearest
from fieldline.frames.attitude import quaternion_from_dcm

SOURCE = "Smithsonian Astrophysical Observatory (1982), NASA-CR-170721"
PLACEMENTS = ("attachment", "attachment-rigid", "centre")
HERE = "fieldline.cases.sao_1982"
START_UTC = "1982-10-01T00:00:00Z"  # gravity is a point's: the date plays no part
EXACT = {
    "method": "dop853",
    "step_s": 0.1,
    "relative_tolerance": 1e-13,
    "position_tolerance_m": 1e-7,
    "velocity_tolerance_m_s": 1e-9,
    "angle_tolerance_rad": 1e-12,
    "rate_tolerance_rad_s": 1e-13,
}


class Pair(NamedTuple):
    """What hangs on what; SI, body axes."""

    dumbbell: Dumbbell
    inertia_kg_m2: tuple[float, float, float]
    lever_b_m: tuple[float, float, float]  # from the centre of mass to the attachment
    stiffness_n: float  # EA
    damping: float | str  # b [N s/m] or "critical"
    angular_damping_n_m_s: float = 0.0


class Start(NamedTuple):
    """Attitude and rate of the subsatellite; angles and rates of `euler_angles`, radians, in the orbit's axes at the start."""

    theta: float
    psi: float
    phi: float
    rate_b: tuple[float, float, float]  # [rad/s], against inertial axes
    placement: str = "attachment"


def pair_at(altitude_m: float, lower_mass_kg: float, upper_mass_kg: float, length_m: float) -> Dumbbell:
    """The dumbbell whose upper mass flies at an altitude over the report's Earth."""
    upper = EARTH_RADIUS_M + number("altitude_m", altitude_m, 100e3, 1e9)
    length = number("length_m", length_m, 1.0, 0.01 * upper)
    return dumbbell(lower_mass_kg, upper_mass_kg, upper - length, upper, GM_M3_S2)


def turning_start(theta, psi, phi, theta_rate, psi_rate, phi_rate, placement: str = "attachment") -> Start:
    """A start from Euler angles [rad] and their rates [rad/s], psi's against inertial axes."""
    rate = body_rate(theta, phi, theta_rate, psi_rate, phi_rate)
    return Start(theta, psi, phi, tuple(map(float, rate)), placement)


def orbit_axes(inclination_deg: float) -> np.ndarray:
    """(3, 3), rows a, b, c of the start in inertial axes."""
    tilt = np.radians(number("inclination_deg", inclination_deg, 0.0, 180.0))
    return np.array([[1.0, 0.0, 0.0], [0.0, np.cos(tilt), np.sin(tilt)], [0.0, -np.sin(tilt), np.cos(tilt)]])


def states(pair: Pair, start: Start, inclination_deg: float, eccentricity: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(2, 3) positions [m] and velocities [m/s] of Shuttle and subsatellite, and the lever (3,) [m]; inertial axes."""
    if start.placement not in PLACEMENTS:
        raise InputError(f'unknown placement "{start.placement}"; {nearest(str(start.placement), PLACEMENTS)}')
    two, n = pair.dumbbell, pair.dumbbell.orbital_rate_rad_s
    axes = orbit_axes(inclination_deg)
    lever = direction_cosines(start.theta, start.psi, start.phi).T @ np.array(pair.lever_b_m)  # in a, b, c
    lower = np.array([two.lower_radius_m, 0.0, 0.0])
    centre = lower if start.placement == "centre" else lower - lever
    moving = centre if start.placement == "attachment-rigid" else lower
    places = np.array([[two.upper_radius_m, 0.0, 0.0], centre])
    velocities = n * np.cross([0.0, 0.0, 1.0], [places[0], moving])
    velocities[:, 0] += two.mean_radius_m * n * number("eccentricity", eccentricity, 0.0, 0.05)
    return places @ axes, velocities @ axes, lever @ axes


def line_constants(pair: Pair, length_m: float) -> tuple[float, float]:
    """Unstretched length [m] and damping b [N s/m] of the line at a length."""
    rest = natural_length(length_m, pair.dumbbell.tension_n, pair.stiffness_n)
    if pair.damping == "critical":
        return rest, critical_damping(pair.dumbbell, rest, pair.stiffness_n)
    if isinstance(pair.damping, str):
        raise InputError(f'damping must be "critical" or a number [N s/m]; got "{pair.damping}".')
    return rest, number("damping", pair.damping, 0.0)


def scenario_of(
    name: str,
    pair: Pair,
    start: Start,
    *,
    duration_s: float,
    output_step_s: float,
    torque_b_n_m=(0.0, 0.0, 0.0),
    inclination_deg: float = 0.0,
    eccentricity: float = 0.0,
    oblate: bool = False,
    anomaly: dict | None = None,
    air: dict | None = None,
):
    """The `Scenario` of a pair and its start.

    torque_b_n_m : constant in the subsatellite. oblate, anomaly, air : see `surroundings`; `air` may hold
    "upper_drag_area_m2", C_d A of the Shuttle, beside the keys of NO_AIR, which are the subsatellite's.
    """
    from fieldline.simulate.scenario import Scenario
    from fieldline.simulate.scenario.states import orbital_axes

    places, velocities, lever = states(pair, start, inclination_deg, eccentricity)
    rest, damping = line_constants(pair, float(np.linalg.norm(places[0] - places[1] - lever)))
    dcm_io, turn = orbital_axes(places[0], velocities[0])
    offset = dcm_io.T @ (places[1] - places[0])
    offset_rate = dcm_io.T @ (velocities[1] - velocities[0]) - np.cross(turn, offset)
    q_bi = quaternion_from_dcm(direction_cosines(start.theta, start.psi, start.phi) @ orbit_axes(inclination_deg))
    upper_air = {**air, "drag_area_m2": air["upper_drag_area_m2"]} if air and "upper_drag_area_m2" in air else None
    shuttle = {
        "name": "shuttle",
        "kind": "point",
        "mass_kg": pair.dumbbell.upper_mass_kg,
        "load": _loads(pair.dumbbell.upper_mass_kg, oblate, anomaly, upper_air),
    }
    subsatellite = {
        "name": "subsatellite",
        "mass_kg": pair.dumbbell.lower_mass_kg,
        "inertia_kg_m2": floats(pair.inertia_kg_m2),
        "attitude": {"quaternion_bi": floats(q_bi)},
        "rate_deg_s": floats(np.degrees(start.rate_b)),
        "offset_o_m": floats(offset),
        "offset_rate_o_m_s": floats(offset_rate),
        "disturbance_torque_b_n_m": floats(torque_b_n_m),
        "load": _loads(pair.dumbbell.lower_mass_kg, oblate, anomaly, air),
    }
    if pair.angular_damping_n_m_s > 0.0:
        joint = dict(zip(("x_m", "y_m", "z_m"), floats(pair.lever_b_m), strict=True))
        joint |= {"rest_length_m": rest, "damping_n_m_s": float(pair.angular_damping_n_m_s)}
        shuttle["load"].append({"function": f"{HERE}.attachment:far_end"})
        subsatellite["load"].append({"function": f"{HERE}.attachment:joint_damping", "parameters": joint})
    return Scenario.from_dict(
        {
            "name": name,
            "time": {
                "start_utc": START_UTC,
                "duration_s": number("duration_s", duration_s, 1e-3),
                "output_step_s": number("output_step_s", output_step_s, 1e-3),
            },
            "integrator": EXACT,
            "environment": {"gravity": "point", "uniform_field_i_tesla": [1e-9, 0.0, 0.0]},
            "orbit": {"state": {"position_km": floats(1e-3 * places[0]), "velocity_km_s": floats(1e-3 * velocities[0])}},
            "body": [shuttle, subsatellite],
            "line": [
                {
                    "from_body": "subsatellite",
                    "from_point_b_m": floats(pair.lever_b_m),
                    "to_body": "shuttle",
                    "rest_length_m": rest,
                    "stiffness_n": float(pair.stiffness_n),
                    "damping_n_s": damping * rest,
                }
            ],
        },
        name,
    )


def _loads(mass_kg: float, oblate: bool, anomaly: dict | None, air: dict | None) -> list[dict]:
    """What surrounds a body, as a load."""
    own = {key: value for key, value in (air or {}).items() if key != "upper_drag_area_m2"}
    parameters = load_parameters(mass_kg, j2=J2 if oblate else 0.0, anomaly=anomaly, air=own or None)
    return [{"function": f"{HERE}.surroundings:surroundings_of_1978", "parameters": parameters}]


def floats(values) -> list[float]:
    """Three or four numbers as plain floats."""
    return [float(value) for value in values]
