"""What the compiled loop works on: schedules, boards, tasks, commands and records, all arrays.

Everything that the loop remembers is in these arrays, so it can return at any step and go on: that is how progress is
shown and how an interrupted run keeps what it has.
"""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple

import numpy as np

from fieldline.dynamics.parameters import Inputs, Plant
from fieldline.dynamics.step import Shared, Work
from fieldline.environment.field_record import FieldParams
from fieldline.integrate.tableau import Tableau
from fieldline.sensing.suite import Suite

NEVER = 1e300  # [s] a time that does not come
SAME_TIME_S = 1e-7  # what is due within this is due now: 0.1 s three times is not 0.3 s in floating point

# what a row of the schedule does; at one time they are done in the order of the rows
MAGNETOMETER, GYRO, SUN_SENSOR, STAR_TRACKER, NAVIGATION, TASK, TORQUE_OFF, TORQUE_ON, OUTPUT, AMBIENT = range(10)
ECLIPSE, ALTITUDE, RATE, USER_EVENT = range(4)  # kinds of events
# kinds of actuators, in the order of the axis of actuators
DIPOLE, WHEEL, THRUST, CONDUCTOR, CIRCUIT, REEL, SLIDER = range(7)
PLAIN_EVENT = 1000  # numbers by which `call` tells a plain Python event from a task or a load


class Outcome(IntEnum):
    """How the loop came back."""

    PAUSED = 0
    DONE = 1
    STOPPED = 2
    NOT_FINITE = 3
    GROUND = 4
    COARSE = 5
    UNDERFLOW = 6
    LAW_RAISED = 7
    LAW_SHAPE = 8
    LAW_NOT_FINITE = 9
    LOAD_RAISED = 10
    LOAD_SHAPE = 11
    LOAD_NOT_FINITE = 12
    EVENT_FAILED = 13
    LAW_NOT_UNIT = 14
    REEL_IN = 15
    REEL_OUT = 16


class Stepping(NamedTuple):
    """How the plant is stepped."""

    tableau: Tableau
    adaptive: bool
    step: float  # [s] the step, or the largest one
    relative: float
    absolute: np.ndarray  # (n,) allowed error of each number of z
    end: float  # [s]
    floor: float  # [m] height at which a run ends


class Schedule(NamedTuple):
    """What happens when: row j at phase + count * period."""

    kind: np.ndarray  # (n,) int64
    who: np.ndarray  # (n,) int64, body or task
    period: np.ndarray  # (n,) [s]
    phase: np.ndarray  # (n,) [s]
    count: np.ndarray  # (n,) int64, how often it has happened


class Sensors(NamedTuple):
    """The sensors of all bodies, and what they and the software on board remember or know."""

    suite: Suite
    gyro_bias: np.ndarray  # (bodies, 3) [rad/s], walking
    field: FieldParams  # of the model on board


class Boards(NamedTuple):
    """What is known on board, one row a body: `Measurement` gives a law its row."""

    field_b: np.ndarray
    field_time_s: np.ndarray
    rate_b: np.ndarray
    sun_sensor: np.ndarray
    q_bi: np.ndarray
    omega_bi_b: np.ndarray
    position_i: np.ndarray
    velocity_i: np.ndarray
    field_i: np.ndarray
    wheel_momentum: np.ndarray
    dipole_b: np.ndarray
    valid: np.ndarray
    tension: np.ndarray
    line_length: np.ndarray
    line_rate: np.ndarray
    relative_position_i: np.ndarray
    relative_velocity_i: np.ndarray
    faces: np.ndarray  # (bodies,) int64, how many of the columns of sun_sensor are this body's
    wheels: np.ndarray  # (bodies,) int64
    lines: np.ndarray  # (bodies,) int64, how many lines are attached


class Tasks(NamedTuple):
    """Flight software: one row a task."""

    body: np.ndarray  # (n,) int64
    slot: np.ndarray  # (n,) int64: a compiled law's place, or -1: plain Python
    reference: np.ndarray  # (n,) int64: whether it is given the reference field
    estimator: np.ndarray  # (n,) int64: 0 for a controller, 1 for an estimator, 2 for one whose last call had an answer
    groups: np.ndarray  # (n, 7) int64: whether it commands each kind of actuator
    replies: np.ndarray  # (n,) int64: how many numbers it must return
    period: np.ndarray  # (n,) [s]
    delay: np.ndarray  # (n,) [s]
    pending: np.ndarray  # (n, depth) [s] when a command takes effect; NEVER: empty
    waiting: np.ndarray  # (n, depth, actuators) commands not yet in effect
    runs: np.ndarray  # (n,) int64


class Actuators(NamedTuple):
    """Limits and allocation of all actuators, kind after kind along an axis of actuators."""

    body: np.ndarray  # (n,) int64, whose flight software commands it
    ends: np.ndarray  # (7,) int64: where each kind ends on the axis
    target: np.ndarray  # (n,) int64: the row of its kind that it moves
    share: np.ndarray  # (n, 3): a torquer's share of a wanted dipole, a wheel's of a wanted torque on the body
    lower: np.ndarray  # (n,)
    limit: np.ndarray  # (n,)
    quantum: np.ndarray  # (n,) 0: none
    off: np.ndarray  # (bodies,) int64: the duty cycle has the torquers off
    wanted: np.ndarray  # (n,) command in effect, as if the duty cycle were not
    least: np.ndarray  # (thrusters,) [s] shortest firing
    until: np.ndarray  # (thrusters,) [s] when a firing ends; NEVER: it does not fire


class Events(NamedTuple):
    """What is watched for: one row an event."""

    kind: np.ndarray  # (n,) int64
    body: np.ndarray
    level: np.ndarray  # (n,) [m] or [rad/s]
    direction: np.ndarray  # (n,) int64: 1 rising, -1 falling, 0 both
    stop: np.ndarray  # (n,) int64
    slot: np.ndarray  # (n,) int64: compiled, or PLAIN_EVENT and up
    value: np.ndarray  # (n,) at the last step's end
    parameters: np.ndarray  # of the user's functions, one after the other
    first: np.ndarray  # (n + 1,) int64, where each one's start
    found: np.ndarray  # (most, 3): row, time [s], +1 rising or -1 falling


class Record(NamedTuple):
    """What a run leaves behind."""

    seconds: np.ndarray  # (rows,)
    state: np.ndarray  # (rows, n)
    field_i: np.ndarray  # (rows, bodies, 3) [T]
    sunlit: np.ndarray  # (rows, bodies)
    actuators: np.ndarray  # (rows, n) in effect
    known: np.ndarray  # (rows, bodies, 7) q_bi and rate as known on board
    loads: np.ndarray  # (rows or 0, loads, bodies, 6)
    nodes: np.ndarray  # (rows, lines) int64 nodes that are out
    tension: np.ndarray  # (rows, segments) [N]
    current: np.ndarray  # (rows, segments) [A]
    circuit: np.ndarray  # (rows, lines, 8) electromotive force [V], power delivered [W], force of field and of air, axes i [N]
    samples: np.ndarray  # (samples, 2 + widest): row of the schedule, time, readings
    start: np.ndarray  # (bodies, 4), z and rate (n,): scratch of the log of loads
    z: np.ndarray
    rate: np.ndarray
    unfrozen: np.ndarray  # (0, 3): the field as it is


class Clock(NamedTuple):
    """Where the loop is."""

    t: np.ndarray  # (1,) [s]
    h: np.ndarray  # (1,) [s] next try of an adaptive step
    rows: np.ndarray  # (1,) int64 outputs written
    samples: np.ndarray  # (1,) int64
    events: np.ndarray  # (1,) int64
    steps: np.ndarray  # (2,) int64: taken, refused


class Run(NamedTuple):
    """All of it: what a run is made of, what it remembers and what it writes."""

    y: np.ndarray  # (n,) state
    scratch: np.ndarray  # (n,) another, for looking into a step
    plant: Plant
    inputs: Inputs
    schedule: Schedule
    stepping: Stepping
    sensors: Sensors
    boards: Boards
    tasks: Tasks
    actuators: Actuators
    events: Events
    record: Record
    clock: Clock
    shared: Shared
    work: Work
