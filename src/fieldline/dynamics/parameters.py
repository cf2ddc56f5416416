"""What the plant is made of, as compiled code takes it: frozen arrays, one row per body, actuator or line.

The state of a run is one array y,

    y = [ r_i v_i q_bi omega_bi_b | wheel momenta | rod inductions | r_i v_i of nodes | feeds | temperatures ]      (1)
          13 a body                 1 a wheel       1 a rod          6 a node           2 a line  1 a warm segment

and within a step the attitude is a rotation vector sigma from the step's start, q_bi = q0 exp(sigma / 2), so that

    z = [ r_i v_i sigma omega_bi_b | ... ]     12 a body, the rest as in (1)                                        (2)

is what the stepper adds up. A point mass keeps its attitude and its rate at what they were. A line's feed is the
unstretched length of its last segment [m] and the rate of that [m/s]; only a reel makes it change.
Units SI; axes i for r and v, b for everything fixed in a body.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fieldline.environment.atmosphere import Atmosphere
from fieldline.environment.ephemeris import Ephemeris
from fieldline.environment.field_record import FieldParams
from fieldline.environment.gravity import Gravity
from fieldline.environment.plasma import Plasma

STATE, TANGENT = 13, 12  # numbers of a body in (1) and (2)
PLAIN_LOAD = 100  # user loads from this number on are written in plain Python


class Surroundings(NamedTuple):
    """What surrounds the bodies, frozen for a run."""

    gravity: Gravity
    field: FieldParams
    uniform_field_i: np.ndarray  # (3,) [T], added to the model's
    atmosphere: Atmosphere
    plasma: Plasma
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


class Conductors(NamedTuple):
    """Straight rigid conductors: (n,) body, middle (n, 3) [m] from the centre of mass, from end to end (n, 3) [m], body axes."""

    body: np.ndarray
    point: np.ndarray
    wire: np.ndarray


class Lines(NamedTuple):
    """Visco-elastic lines between points of two bodies, A and B: tension only, with nodes where they have mass.

    The points of line k are A's attachment, its nodes, B's attachment; segment j joins the points j and j + 1. The nodes of
    line k are those from first[k] on, its segments the rows from first[k] + k on. A reel is at B: it feeds the last
    segment, and nodes appear and vanish there.
    """

    body: np.ndarray  # (n, 2) int64
    point: np.ndarray  # (n, 6) [m], attachment on A and on B, body axes
    joint: np.ndarray  # (n, 2) [N m s], angular damping at A and B
    first: np.ndarray  # (n + 1,) int64
    nodes: np.ndarray  # (n,) int64, those that are out: changes between steps where there is a reel
    rest: np.ndarray  # (s,) [m], unstretched length of a segment at the reference temperature; the last one's is a feed
    stiffness: np.ndarray  # (s,) [N], E A
    damping: np.ndarray  # (s,) [N s], tension per rate of strain
    linear_mass: np.ndarray  # (s,) [kg/m]
    diameter: np.ndarray  # (s,) [m], 0: the air does not feel it
    drag_coefficient: np.ndarray  # (s,)
    capacity: np.ndarray  # (s,) [J/m/K] of a warm line
    absorptivity: np.ndarray  # (n,) of a warm line's surface
    emissivity: np.ndarray  # (n,)
    expansion: np.ndarray  # (n,) [1/K]
    reference: np.ndarray  # (n,) [K], temperature at which `rest` holds
    warm: np.ndarray  # (n + 1,) int64, where the temperatures of each line's segments start; none for a cold line
    exposed: np.ndarray  # (n,) int64, 1: air or current act on it, from what `Ambient` holds
    reel: np.ndarray  # (n,) int64, NO_REEL, RATE_REEL or TENSION_REEL
    reel_lag: np.ndarray  # (n,) [s], of a reel that follows a rate; [kg], effective mass of one that follows a tension
    spacing: np.ndarray  # (n,) [m], unstretched length of a full segment beside a reel
    span: np.ndarray  # (n, 2) [m], least and largest unstretched length out beside a reel
    stored: np.ndarray  # (n,) [kg], mass of the line that is out at the start: the rest is in the reel's body


NO_REEL, RATE_REEL, TENSION_REEL = range(3)


NO_CIRCUIT, PROFILE, SERIES, BARE = range(4)


class Circuits(NamedTuple):
    """How the current of each line comes about, one row a line; what a kind does not use is zero, or no rows of a table."""

    kind: np.ndarray  # (n,) int64, NO_CIRCUIT, PROFILE, SERIES or BARE
    commanded: np.ndarray  # (n,) int64
    resistance: np.ndarray  # (n,) [ohm/m] at the reference temperature
    coefficient: np.ndarray  # (n,) [1/K]
    reference: np.ndarray  # (n,) [K]
    load: np.ndarray  # (n,) [ohm]
    contactors: np.ndarray  # (n,) [ohm], of both
    supply: np.ndarray  # (n,) [V], positive from A to B
    radius: np.ndarray  # (n, 2) [m] of the sphere at A and at B, 0: a plasma contactor
    gain: np.ndarray  # (n,) of a sphere over Parker and Murphy's current
    emitted: np.ndarray  # (n, 2) [A] most that A and B can emit
    cathode_at_b: np.ndarray  # (n,) int64
    drop: np.ndarray  # (n,) [V] at the cathode
    ion_mass: np.ndarray  # (n,) [u]
    first_time: np.ndarray  # (n + 1,) int64, where each line's table in time starts
    times: np.ndarray  # [s]
    currents: np.ndarray  # [A]
    first_share: np.ndarray  # (n + 1,) int64, and its table along the line
    fractions: np.ndarray
    shares: np.ndarray


class Ambient(NamedTuple):
    """What surrounds the segments of exposed lines, one row each, held between refreshes."""

    field_i: np.ndarray  # (s, 3) [T]
    density: np.ndarray  # (s,) [kg/m^3], of the air
    current: np.ndarray  # (s,) [A], positive from A to B
    heating: np.ndarray  # (s,) [W/m], taken in from outside and by the current
    drive: np.ndarray  # (s,) [V], electromotive force from A to B
    resistance: np.ndarray  # (s,) [ohm]
    length: np.ndarray  # (s,) [m], unstretched
    electrons: np.ndarray  # (s,) [1/m^3]
    gather: np.ndarray  # (s,) [A/V^0.5], what a bare segment collects per root of its potential
    chord_i: np.ndarray  # (s, 3) [m]
    emf: np.ndarray  # (n,) [V], of each line from A to B
    power: np.ndarray  # (n,) [W], electric power delivered to each line's load
    lorentz_i: np.ndarray  # (n, 3) [N], of the field on each line's current
    drag_i: np.ndarray  # (n, 3) [N], of the air on each line
    cells: np.ndarray  # scratch of `dynamics.lines.bare`
    rows: np.ndarray
    stale: np.ndarray  # (1,) int64, 1: to be taken anew at once


class Sliders(NamedTuple):
    """Attachments that move along an axis of the body: (n,) line, end 0 or 1, axis (n, 3), speed (n,) [m/s]."""

    line: np.ndarray
    end: np.ndarray
    axis: np.ndarray
    speed: np.ndarray


class UserLoads(NamedTuple):
    """Forces and torques of the user's own: a compiled function's slot, or PLAIN_LOAD and up for plain Python.

    A load on line k acts on each of its nodes: its body is the number of bodies plus k.
    """

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
    conductors: Conductors
    lines: Lines
    circuits: Circuits
    sliders: Sliders
    user: UserLoads
    magnetic: bool  # the field is needed by some body


class Inputs(NamedTuple):
    """Commands in effect; a torquer goes from `dipole_from` to `dipole_to` with its time constant since `dipole_since`."""

    dipole_from: np.ndarray  # (torquers,) [A m^2]
    dipole_to: np.ndarray
    dipole_since: np.ndarray  # (torquers,) [s]
    wheel_torque: np.ndarray  # (wheels,) [N m] of the motor on the wheel
    thrust: np.ndarray  # (thrusters,) 0 to 1
    current: np.ndarray  # (conductors,) [A]
    circuit: np.ndarray  # (lines,) [A] or part of full current: what the circuit of a line is told
    reel: np.ndarray  # (lines,) [m/s] or [N]: what the reel of a line is told
    slide_from: np.ndarray  # (sliders,) [m] along its axis
    slide_to: np.ndarray  # (sliders,) [m]
    slide_since: np.ndarray  # (sliders,) [s]


def _tail(plant: Plant) -> int:
    """Numbers after the bodies."""
    lines = plant.lines
    return len(plant.wheels.body) + len(plant.rods.body) + 6 * int(lines.first[-1]) + 2 * len(lines.nodes) + int(lines.warm[-1])


def state_size(plant: Plant) -> int:
    """Numbers in y of equation (1)."""
    return STATE * len(plant.bodies.mass) + _tail(plant)


def tangent_size(plant: Plant) -> int:
    """Numbers in z of equation (2)."""
    return TANGENT * len(plant.bodies.mass) + _tail(plant)
