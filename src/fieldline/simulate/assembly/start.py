"""Where and how the bodies start: orbit, attitude, rate, wheels and rods, as the state y of the plant.

Axes of `offset_o_m` and of orbital attitudes: x along the track, y against the orbit normal, z down. A rate counted
against the orbital axes has their own turn added, h / r^2 about -y.
"""

from __future__ import annotations

import numpy as np

from fieldline.dynamics.loads.hysteresis import MU0, resting_induction
from fieldline.dynamics.parameters import STATE, Plant, state_size
from fieldline.frames.attitude import quaternion_from_dcm
from fieldline.simulate.assembly.plant import each

UNIT_QUATERNION = (0.0, 0.0, 0.0, 1.0)


def start_of(scenario, plant: Plant, rng: np.random.Generator) -> np.ndarray:
    """State y at the start; random attitudes and rates are drawn from `rng`, body after body."""
    y = np.zeros(state_size(plant))
    places = orbits_of(scenario)
    for b, body in enumerate(scenario.body):
        row = y[STATE * b : STATE * (b + 1)]
        row[0:3], row[3:6] = places[b]
        row[6:10] = UNIT_QUATERNION
        if body.kind == "rigid":
            row[6:10], row[10:13] = turning_of(body, *places[b], rng)
    _wheels(scenario, y)
    _rods(scenario, plant, y)
    return y


def orbits_of(scenario) -> list[tuple[np.ndarray, np.ndarray]]:
    """Position [m] and velocity [m/s] of every body, GCRS axes."""
    places = []
    for b, body in enumerate(scenario.body):
        orbit = scenario.orbit if b == 0 else body.orbit
        if orbit is not None:
            places.append(state_of(orbit, scenario.time.start, scenario.folder))
        else:
            places.append(beside(*places[0], body.offset_o_m or (0.0, 0.0, 0.0), body.offset_rate_o_m_s))
    return places


def state_of(orbit, start_utc, folder) -> tuple[np.ndarray, np.ndarray]:
    """Position [m] and velocity [m/s], GCRS axes, of an orbit's record at the start."""
    if orbit.state is not None:
        position, velocity = 1e3 * np.array(orbit.state.position_km), 1e3 * np.array(orbit.state.velocity_km_s)
        return position, velocity
    raise NotImplementedError


def orbital_axes_of(position, velocity) -> tuple[np.ndarray, np.ndarray]:
    """dcm_oi and the orbital axes' own rate [rad/s], in orbital axes."""
    momentum = np.cross(position, velocity)
    z = -position / np.linalg.norm(position)
    y = -momentum / np.linalg.norm(momentum)
    rate = np.array([0.0, -np.linalg.norm(momentum) / (position @ position), 0.0])
    return np.stack([np.cross(y, z), y, z]), rate


def beside(position, velocity, offset_o, offset_rate_o) -> tuple[np.ndarray, np.ndarray]:
    """Place and velocity at an offset in another body's orbital axes, which turn."""
    dcm_oi, rate_o = orbital_axes_of(position, velocity)
    moved = np.asarray(offset_rate_o, dtype=float) + np.cross(rate_o, offset_o)
    return position + dcm_oi.T @ np.asarray(offset_o, dtype=float), velocity + dcm_oi.T @ moved


def turning_of(body, position, velocity, rng) -> tuple[np.ndarray, np.ndarray]:
    """q_bi and omega_bi_b [rad/s] of a rigid body."""
    from scipy.spatial.transform import Rotation

    dcm_oi, rate_o = orbital_axes_of(position, velocity)
    orbital = Rotation.from_quat(quaternion_from_dcm(dcm_oi))  # orbital axes to inertial
    start = body.attitude
    if start is None:
        rotation = orbital
    elif start.random:
        rotation = Rotation.from_quat(rng.standard_normal(4))
    elif start.quaternion_bi is not None:
        rotation = Rotation.from_quat(start.quaternion_bi)
    elif start.quaternion_bo is not None:
        rotation = orbital * Rotation.from_quat(start.quaternion_bo)
    else:
        turned = Rotation.from_euler("ZYX", start.euler_321_deg, degrees=True)
        rotation = turned if start.axes == "gcrs" else orbital * turned
    if body.random_rate_deg_s is not None:
        direction = rng.standard_normal(3)
        rate = np.radians(body.random_rate_deg_s) * direction / np.linalg.norm(direction)
    else:
        rate = np.radians(np.asarray(body.rate_deg_s or (0.0, 0.0, 0.0), dtype=float))
        if body.rate_axes == "orbital":
            rate = rate + rotation.inv().apply(dcm_oi.T @ rate_o)
    return rotation.as_quat(), rate


def _wheels(scenario, y: np.ndarray) -> None:
    """Momentum of the wheels: what they are given relative to the body; the body's own turn is small beside it."""
    base = STATE * len(scenario.body)
    for k, (_, one) in enumerate(each(scenario.body, "wheel")):
        y[base + k] = one.momentum_n_m_s


def _rods(scenario, plant: Plant, y: np.ndarray) -> None:
    """Rods start on the middle of their loop in the field that they start in."""
    from scipy.spatial.transform import Rotation

    from fieldline.dynamics.rates import field_at
    from fieldline.environment.ephemeris import dcm_ei_kernel

    pairs = each(scenario.body, "hysteresis_rod")
    base = len(y) - len(pairs)
    dcm_ei = dcm_ei_kernel(0.0, plant.surroundings.ephemeris)
    for k, (b, one) in enumerate(pairs):
        row = y[STATE * b : STATE * (b + 1)]
        field_i = field_at(tuple(row[:3]), dcm_ei, plant.surroundings)
        field_b = Rotation.from_quat(row[6:10]).inv().apply(field_i)
        along = float(np.dot(one.axis_b, field_b)) / MU0
        y[base + k] = resting_induction(along, one.saturation_tesla, one.remanence_tesla, one.coercivity_a_m)
