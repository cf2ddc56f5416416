"""A rigid subsatellite below a point mass on a line, as a scenario of the plant.

The Shuttle starts on the x axis at r2 and moves along y (for an inclination, towards z as well); the attachment, or the
centre of mass, is straight below it at r1. With e small, x' = rbar n e is added to both. Unless told otherwise,

    attachment         attachment at r1, the centre of mass off it, moving at r1 n along the track             (1)
    attachment-rigid   the same, the centre of mass moving as a point of the rigidly turning pair, n x r       (2)
    centre             centre of mass at r1, moving at r1 n                                                  (3)

The unstretched length is that which balances the tension of the pair at the length from the Shuttle to the attachment. A
line with mass has nodes, which start on the straight line as its tension spaces them and turn with the pair. The Earth is a
point of the program's GM; its oblateness and the anomaly act on nodes, and on the halves of segments at the ends, as they do on
the two masses, and the air on nodes where a drag area is given for the line. A line without mass feels none of them.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fieldline.cases.erbs_like import number
from fieldline.cases.sao_1982.dumbbell import Dumbbell, Strung, critical_damping, dumbbell, natural_length
from fieldline.cases.sao_1982.euler_angles import body_rate, direction_cosines
from fieldline.cases.sao_1982.surroundings import EARTH_RADIUS_M, GM_M3_S2, J2, NO_AIR, load_parameters
from fieldline.errors import InputError, nearest
from fieldline.frames.attitude import quaternion_from_dcm

SOURCE = "Smithsonian Astrophysical Observatory (1982), NASA-CR-170721"
PLACEMENTS = ("attachment", "attachment-rigid", "centre")
HERE = "fieldline.cases.sao_1982"
LINE = "tether"
MOST_STRAIN = 0.2
OTHER_AREAS = ("upper_drag_area_m2", "line_drag_area_m2")  # of air, beside the subsatellite's
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
    strung: Strung | None = None  # of a line with mass


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
    velocities[:, 0] += outward_rate(pair, eccentricity)
    return places @ axes, velocities @ axes, lever @ axes


def outward_rate(pair: Pair, eccentricity: float) -> float:
    """rbar n e [m/s], which all masses start with."""
    two = pair.dumbbell
    return two.mean_radius_m * two.orbital_rate_rad_s * number("eccentricity", eccentricity, 0.0, 0.05)


def damping_of(pair: Pair, rest_m: float) -> float:
    """Damping b [N s/m] of the whole line."""
    if pair.damping == "critical":
        return critical_damping(pair.dumbbell, rest_m, pair.stiffness_n)
    if isinstance(pair.damping, str):
        raise InputError(f'damping must be "critical" or a number [N s/m]; got "{pair.damping}".')
    return number("damping", pair.damping, 0.0)


def line_record(pair: Pair, length_m: float) -> dict:
    """The line from the subsatellite up, of the length that balances its tension."""
    tension = pair.dumbbell.tension_n if pair.strung is None else float(pair.strung.tension_n.mean())
    rest = natural_length(length_m, tension, pair.stiffness_n)
    if tension > MOST_STRAIN * pair.stiffness_n:
        raise InputError(
            f"stiffness_n = {pair.stiffness_n:g} N is too soft for a tension of {tension:.4g} N, which would stretch the line by "
            f"{100.0 * tension / pair.stiffness_n:.3g} %: give {tension / MOST_STRAIN:.4g} N or more."
        )
    found = {
        "name": LINE,
        "from_body": "subsatellite",
        "to_body": "shuttle",
        "from_point_b_m": floats(pair.lever_b_m),
        "from_joint_damping_n_m_s": float(pair.angular_damping_n_m_s),
        "rest_length_m": rest,
        "stiffness_n": float(pair.stiffness_n),
        "damping_n_s": damping_of(pair, rest) * rest,
    }
    if pair.strung is not None and pair.strung.nodes > 0:
        found |= {"nodes": pair.strung.nodes, "mass_per_length_kg_m": float(pair.strung.line_mass_kg / rest)}
    return found


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
    "upper_drag_area_m2", C_d A of the Shuttle, and "line_drag_area_m2", C_d A of the whole line seen from its side, which its
    nodes share (what of it is next to the ends is left out), beside the keys of NO_AIR, which are the subsatellite's.
    """
    from fieldline.simulate.scenario import Scenario

    places, velocities, lever = states(pair, start, inclination_deg, eccentricity)
    line = line_record(pair, float(np.linalg.norm(places[0] - places[1] - lever)))
    bodies = [
        {"name": "shuttle", "kind": "point", "mass_kg": pair.dumbbell.upper_mass_kg},
        {
            "name": "subsatellite",
            "mass_kg": pair.dumbbell.lower_mass_kg,
            "inertia_kg_m2": floats(pair.inertia_kg_m2),
            "attitude": {"quaternion_bi": floats(start_quaternion(start, inclination_deg))},
            "rate_deg_s": floats(np.degrees(start.rate_b)),
            "disturbance_torque_b_n_m": floats(torque_b_n_m),
        },
    ]
    nodes, line_mass = (0, 0.0) if pair.strung is None else (pair.strung.nodes, pair.strung.line_mass_kg)
    half = 0.5 * line_mass / (nodes + 1)
    areas = (_own_air(air, "upper_drag_area_m2"), _own_air(air, None))
    for body, its_air, lever_b in zip(bodies, areas, ((0.0, 0.0, 0.0), pair.lever_b_m), strict=True):
        settings = {"end_mass_kg": half, "lever_b_m": lever_b}
        body["load"] = _loads("surroundings_of_1978", body["mass_kg"], oblate, anomaly, its_air, **settings)
    if half > 0.0:
        line["load"] = _loads("surroundings_of_a_node", 0.0, oblate, anomaly, _line_air(air, nodes))
    bodies[1] |= _beside(places, velocities)
    return Scenario.from_dict(
        {
            "name": name,
            "time": {
                "start_utc": START_UTC,
                "duration_s": number("duration_s", duration_s, 1e-3),
                "output_step_s": number("output_step_s", output_step_s, 1e-3),
            },
            "integrator": EXACT,
            "environment": {"gravity": "point", "gravity_gm_m3_s2": GM_M3_S2, "uniform_field_i_tesla": [1e-9, 0.0, 0.0]},
            "orbit": {"state": {"position_km": floats(1e-3 * places[0]), "velocity_km_s": floats(1e-3 * velocities[0])}},
            "body": bodies,
            "line": [line],
        },
        name,
    )


def start_quaternion(start: Start, inclination_deg: float) -> np.ndarray:
    """q_bi (4,) of the subsatellite."""
    return quaternion_from_dcm(direction_cosines(start.theta, start.psi, start.phi) @ orbit_axes(inclination_deg))


def _beside(places, velocities) -> dict:
    """Place and velocity of the second body from the first, in its orbital axes."""
    from fieldline.simulate.scenario.states import orbital_axes

    dcm_io, turn = orbital_axes(places[0], velocities[0])
    offset = (places[1] - places[0]) @ dcm_io
    rate = (velocities[1] - velocities[0]) @ dcm_io - np.cross(turn, offset)
    return {"offset_o_m": floats(offset), "offset_rate_o_m_s": floats(rate)}


def _own_air(air: dict | None, area: str | None) -> dict | None:
    """The air of one body: `area` names its drag area among what is given, None the subsatellite's; None for no air."""
    if air is not None and not isinstance(air, dict):
        raise InputError(f"air must be a dict of {', '.join((*NO_AIR, *OTHER_AREAS))}, or None; got {air!r}.")
    if not air:
        return air
    own = {key: value for key, value in air.items() if key not in OTHER_AREAS}
    if area is None:
        return own
    return own | {"drag_area_m2": air.get(area, 0.0)}


def _line_air(air: dict | None, nodes: int) -> dict | None:
    """The air of one node."""
    own = _own_air(air, "line_drag_area_m2")
    if not own:
        return own
    return own | {"drag_area_m2": number('air["line_drag_area_m2"]', own["drag_area_m2"], 0.0, 1e12) / (nodes + 1)}


def _loads(function: str, mass_kg: float, oblate: bool, anomaly: dict | None, air: dict | None, **settings) -> list[dict]:
    """What surrounds a body or a node besides the pull of a point, as a load."""
    if not isinstance(oblate, bool):
        raise InputError(f"oblate must be True or False; got {oblate!r}.")
    if not oblate and anomaly is None and air is None:
        return []
    parameters = load_parameters(mass_kg, j2=J2 if oblate else 0.0, anomaly=anomaly, air=air or None, **settings)
    return [{"function": f"{HERE}.surroundings:{function}", "parameters": parameters}]


def floats(values) -> list[float]:
    """Three or four numbers as plain floats."""
    return [float(value) for value in values]
