"""One explicit Runge-Kutta step of the plant, with the attitude advanced on its own manifold.

    z = (r, v, sigma = 0, omega, ...),   z1 by the method's stages of `plant_rates`,   q1 = q0 exp(sigma1 / 2)   (1)

A quaternion stays a unit quaternion to rounding, and a body that turns at a constant rate is integrated without error
however far it turns in a step (Munthe-Kaas). What limits the step is the change of the rate and of the field within it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fieldline.compiled import inner, kernel
from fieldline.dynamics.implicit_arrays import Implicit, new_implicit
from fieldline.dynamics.layout import store, three
from fieldline.dynamics.lines.ambient import new_ambient
from fieldline.dynamics.lines.chain import END_MASS
from fieldline.dynamics.load_log import LOADS
from fieldline.dynamics.parameters import STATE, TANGENT, Ambient, Plant, state_size, tangent_size
from fieldline.dynamics.rates import freeze_fields, plant_rates
from fieldline.frames.attitude import quat_exp, quat_mul, quat_unit
from fieldline.integrate.steps import combine
from fieldline.packed import pack


class Work(NamedTuple):
    """Arrays that a step writes: n numbers of z, m evaluations."""

    k: np.ndarray  # (m, n)
    z: np.ndarray  # (n,) at the step's start
    z1: np.ndarray  # (n,) at its end
    stage: np.ndarray  # (n,)
    scale: np.ndarray  # (n,) error allowed
    dense: np.ndarray  # (7, n) coefficients of the state within the step
    start: np.ndarray  # (bodies, 4) attitudes at the step's start
    frozen: np.ndarray  # (bodies, 3) field in mid-step, where it is taken once a step; else (0, 3)
    log: np.ndarray  # (0, bodies, 6), or (loads, bodies, 6) to keep every load
    implicit: Implicit  # without rows where an explicit method steps the plant


class Shared(NamedTuple):
    """Arrays through which compiled code and a user's functions meet."""

    outer: np.ndarray  # (bodies, 6) forces_i and torques_b of lines and of the user's loads
    end_mass: np.ndarray  # (bodies, 10) of the lines' ends, equation (3) of `fieldline.dynamics.lines.chain`
    tension: np.ndarray  # (segments,) [N] at the last evaluation
    rest: np.ndarray  # (segments,) [m], unstretched, and
    mass: np.ndarray  # (segments,) [kg] then
    earth: np.ndarray  # (1, 9) dcm_ei of the last evaluation, and
    earth_time: np.ndarray  # (1,) [s] when that was
    ambient: Ambient
    state: np.ndarray  # (13,) state of the body that a user's load acts on
    reply: np.ndarray  # (64 or more,) what a user's function answered
    replies: np.ndarray  # (1,) int64, how many numbers that is
    commands: np.ndarray  # (actuators,) what a law commands
    culprit: np.ndarray  # (3,) int64: task, load or event at fault, how many numbers it returned, which compiled kind runs


def new_work(plant: Plant, evaluations: int, *, once_a_step: bool = False, loads: int = 0, implicit: bool = False) -> Work:
    """Arrays for a plant and a method of so many evaluations; `loads` rows of log."""
    n, bodies = tangent_size(plant), len(plant.bodies.mass)
    return Work(
        k=np.zeros((evaluations, n)),
        z=np.zeros(n),
        z1=np.zeros(n),
        stage=np.zeros(n),
        scale=np.ones(n),
        dense=np.zeros((7, n)),
        start=np.zeros((bodies, 4)),
        frozen=np.zeros((bodies if once_a_step else 0, 3)),
        log=np.zeros((loads, bodies, 6)),
        implicit=new_implicit(plant, implicit),
    )


def new_shared(plant: Plant, actuators: int = 0) -> Shared:
    """Arrays for a plant's lines and users' functions, and for the commands of so many actuators."""
    return Shared(
        outer=np.zeros((len(plant.bodies.mass), 6)),
        end_mass=np.zeros((len(plant.bodies.mass), END_MASS)),
        tension=np.zeros(len(plant.lines.rest)),
        rest=np.zeros(len(plant.lines.rest)),
        mass=np.zeros(len(plant.lines.rest)),
        earth=np.zeros((1, 9)),
        earth_time=np.full(1, np.nan),
        ambient=new_ambient(plant),
        state=np.zeros(13),
        reply=np.zeros(64 + len(plant.thrusters.body)),
        replies=np.zeros(1, dtype=np.int64),
        commands=np.zeros(actuators),
        culprit=np.zeros(3, dtype=np.int64),
    )


@inner
def lift(y, start, z):
    """State y as the stepper's z and the attitudes it starts from."""
    bodies = start.shape[0]
    for b in range(bodies):
        for j in range(6):
            z[TANGENT * b + j] = y[STATE * b + j]
        for j in range(4):
            start[b, j] = y[STATE * b + 6 + j]
        for j in range(3):
            z[TANGENT * b + 6 + j] = 0.0
            z[TANGENT * b + 9 + j] = y[STATE * b + 10 + j]
    here, there = y[STATE * bodies :], z[TANGENT * bodies :]
    for j in range(there.shape[0]):
        there[j] = here[j]


@inner
def settle(z, start, y):
    """The stepper's z as a state; equation (1)."""
    bodies = start.shape[0]
    for b in range(bodies):
        for j in range(6):
            y[STATE * b + j] = z[TANGENT * b + j]
        q0 = (start[b, 0], start[b, 1], start[b, 2], start[b, 3])
        q = quat_unit(quat_mul(q0, quat_exp(three(z, TANGENT * b + 6))))
        for j in range(4):
            y[STATE * b + 6 + j] = q[j]
        store(y, STATE * b + 10, three(z, TANGENT * b + 9))
    here, there = z[TANGENT * bodies :], y[STATE * bodies :]
    for j in range(here.shape[0]):
        there[j] = here[j]


@inner
def attempt(t, h, y, plant, inputs, tableau, loads, call, shared, work):
    """Stages of a step of length h from state y, leaving its end in work.z1; 0 or what a user's load did wrong."""
    lift(y, work.start, work.z)
    if work.frozen.shape[0] > 0:
        freeze_fields(t, h, y, plant, work.frozen)
    stages = tableau.b.shape[0]
    for s in range(stages):
        combine(work.z, h, work.k, tableau.a[s], s, work.stage)
        status = plant_rates(
            t + tableau.c[s] * h,
            work.stage,
            work.start,
            plant,
            inputs,
            work.frozen,
            loads,
            call,
            shared,
            work.log,
            work.k[s],
        )
        if status != 0:
            return status
    combine(work.z, h, work.k, tableau.b, stages, work.z1)
    return 0


@inner
def closing_rates(t, h, plant, inputs, loads, call, shared, work, row):
    """Evaluate the right-hand side at the step's end, into row `row` of k."""
    return plant_rates(t + h, work.z1, work.start, plant, inputs, work.frozen, loads, call, shared, work.log, work.k[row])


@kernel
def evaluate(t, y, plant, inputs, loads, call, shared, work, out):
    """Fill `out` with dz/dt at state y, and work.log where it has rows; 0 or what a user's load did wrong."""
    lift(y, work.start, work.z)
    return plant_rates(t, work.z, work.start, plant, inputs, work.frozen, loads, call, shared, work.log, out)


def rates_of(t: float, y, plant: Plant, inputs, loads, call, shared: Shared) -> tuple[np.ndarray, np.ndarray]:
    """(dz/dt, log) at a state: the right-hand side once, with force_i and torque_b of every load, (loads, bodies, 6)."""
    if len(y) != state_size(plant):
        raise ValueError(f"the plant's state has {state_size(plant)} numbers; got {len(y)}")
    work = new_work(plant, 1, loads=len(LOADS))
    out = np.zeros_like(work.z)
    evaluate(float(t), np.array(y, dtype=float), pack(plant), pack(inputs), loads, call, pack(shared), pack(work), out)
    return out, work.log
