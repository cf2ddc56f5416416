"""What the plant is made of, as compiled code takes it: frozen arrays, one row per body, actuator or line.

The state of a run is one array y,

    y = [ r_i v_i q_bi omega_bi_b | ... | wheel momenta | rod inductions ]      13 a body, 1 a wheel, 1 a rod       (1)

and within a step the attitude is a rotation vector sigma from the step's start, q_bi = q0 exp(sigma / 2), so that

    z = [ r_i v_i sigma omega_bi_b | ... | wheel momenta | rod inductions ]     12 a body, 1 a wheel, 1 a rod       (2)

is what the stepper adds up. A point mass keeps its attitude and its rate at what they were.
Units SI; axes i for r and v, b for everything fixed in a body.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fieldline.environment.atmosphere import Atmosphere
from fieldline.environment.ephemeris import Ephemeris
from fieldline.environment.field_record import FieldParams
from fieldline.environment.gravity import Gravity

STATE, TANGENT = 13, 12  # numbers of a body in (1) and (2)
PLAIN_LOAD = 100  # user loads from this number on are written in plain Python


class Surroundings(NamedTuple):
    """What surrounds the bodies, frozen for a run."""

    gravity: Gravity
    field: FieldParams
    uniform_field_i: np.ndarray  # (3,) [T], added to the model's
    atmosphere: Atmosphere
    ephemeris: Ephemeris
    rotating: bool  # the Earth's attitude is needed: field, oblate gravity or air


class Bodies(NamedTuple):
    """One row a body; a load that a body does not carry has zeros."""

    mass: np.ndarray  # (n,) [kg]
    rigid: np.ndarray  # (n,) int64, 0: a point mass
    inertia: np.ndarray  # (n, 9) [kg m^2], without the wheels' spin inertia
    inertia_inv: np.ndarray  # (n, 9)
    gravity_gradient: np.ndarray  # (n,) 0 or 1
    residual: np.ndarray  # (n, 3) [A m^2]
    induced: np.ndarray  # (n, 9) [A m^2 / T]
    eddy: np.ndarray  # (n, 9) [N m s / T^2], symmetric and not negative
    drag: np.ndarray  # (n,) drag coefficient times area [m^2]
    drag_point: np.ndarray  # (n, 3) [m] from the centre of mass
    solar: np.ndarray  # (n,) coefficient of solar pressure times area [m^2]
    solar_point: np.ndarray  # (n, 3) [m]
    torque_b: np.ndarray  # (n, 3) [N m], constant in the body
    torque_i: np.ndarray  # (n, 3) [N m], constant in inertial axes


class Torquers(NamedTuple):
    """Magnetorquers: (n,) body, axes (n, 3), time constant (n,) [s]."""

    body: np.ndarray
    axis: np.ndarray
    lag: np.ndarray


class Wheels(NamedTuple):
    """Reaction wheels: (n,) body, axes (n, 3), largest momentum (n,) [N m s]."""

    body: np.ndarray
    axis: np.ndarray
    momentum_max: np.ndarray


class Thrusters(NamedTuple):
    """Thrusters: (n,) body, place (n, 3) [m] from the centre of mass, force at full thrust (n, 3) [N], body axes."""

    body: np.ndarray
    point: np.ndarray
    force: np.ndarray


class Rods(NamedTuple):
    """Hysteresis rods: (n,) body, axes (n, 3), volume [m^3], saturation and remanence [T], coercivity [A/m]."""

    body: np.ndarray
    axis: np.ndarray
    volume: np.ndarray
    saturation: np.ndarray
    remanence: np.ndarray
    coercivity: np.ndarray


class Lines(NamedTuple):
    """Massless visco-elastic lines between two bodies: tension only."""

    body: np.ndarray  # (n, 2) int64
    point: np.ndarray  # (n, 6) [m], attachment on the first and on the second body, body axes
    length: np.ndarray  # (n,) [m], unstretched
    stiffness: np.ndarray  # (n,) [N], E A
    damping: np.ndarray  # (n,) [N s], tension per rate of strain


class UserLoads(NamedTuple):
    """Forces and torques of the user's own: a compiled function's slot, or PLAIN_LOAD and up for plain Python."""

    body: np.ndarray  # (n,) int64
    slot: np.ndarray  # (n,) int64
    first: np.ndarray  # (n + 1,) int64, where each one's parameters start
    parameters: np.ndarray


class Plant(NamedTuple):
    """Everything that the right-hand side knows."""

    surroundings: Surroundings
    bodies: Bodies
    torquers: Torquers
    wheels: Wheels
    thrusters: Thrusters
    rods: Rods
    lines: Lines
    user: UserLoads
    magnetic: bool  # the field is needed by some body


class Inputs(NamedTuple):
    """Commands in effect; a torquer goes from `dipole_from` to `dipole_to` with its time constant since `dipole_since`."""

    dipole_from: np.ndarray  # (torquers,) [A m^2]
    dipole_to: np.ndarray
    dipole_since: np.ndarray  # (torquers,) [s]
    wheel_torque: np.ndarray  # (wheels,) [N m] of the motor on the wheel
    thrust: np.ndarray  # (thrusters,) 0 to 1


def state_size(plant: Plant) -> int:
    """Numbers in y of equation (1)."""
    return STATE * len(plant.bodies.mass) + len(plant.wheels.body) + len(plant.rods.body)


def tangent_size(plant: Plant) -> int:
    """Numbers in z of equation (2)."""
    return TANGENT * len(plant.bodies.mass) + len(plant.wheels.body) + len(plant.rods.body)
