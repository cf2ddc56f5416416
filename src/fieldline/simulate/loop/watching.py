"""Events: a quantity crosses its level within a step, and the step's interpolant says when.

eclipse:   sunlit fraction - 1/2                                                                       (1)
altitude:  height over the ellipsoid - level                                                           (2)
rate:      |omega| - level                                                                             (3)
user:      the first number that the user's function returns for (t, state, parameters)               (4)
"""

from __future__ import annotations

from math import nan

from fieldline.compiled import inner
from fieldline.dynamics.implicit_step import implicit_interpolant
from fieldline.dynamics.layout import three
from fieldline.dynamics.parameters import PLAIN_LOAD, STATE
from fieldline.dynamics.rates import EVENT_AT_WORK, FINITE, ask, plant_rates
from fieldline.dynamics.step import closing_rates, settle
from fieldline.environment.eclipse import sunlit_kernel
from fieldline.environment.ephemeris import dcm_ei_kernel, sun_kernel
from fieldline.frames.geodetic import geodetic_kernel
from fieldline.frames.matrices import matvec
from fieldline.frames.vectors import norm
from fieldline.integrate.dense import dense_coefficients, dense_value, hermite_coefficients
from fieldline.integrate.roots import bracketed, evaluations, narrow, next_guess
from fieldline.integrate.steps import combine
from fieldline.simulate.loop.records import ALTITUDE, ECLIPSE, RATE

SHARPNESS = 1e-10  # of a step: how closely a crossing is found
GOES_ON, FAILED = 2.0, -1.0  # in place of the fraction of a step at which a run stops


@inner
def height_of(t, r_i, plant):
    """Height [m] of a place over the ellipsoid."""
    dcm_ei = dcm_ei_kernel(t, plant.surroundings.ephemeris)
    return geodetic_kernel(matvec(dcm_ei, r_i))[2]


@inner
def quantity(t, k, y, run, loads, call):
    """What event k watches, at state y; NaN where the user's function failed."""
    plant, events, shared = run.plant, run.events, run.shared
    b = events.body[k]
    shared.culprit[0] = k
    if events.kind[k] == ECLIPSE:
        return sunlit_kernel(three(y, STATE * b), sun_kernel(t, plant.surroundings.ephemeris)) - 0.5
    if events.kind[k] == ALTITUDE:
        return height_of(t, three(y, STATE * b), plant) - events.level[k]
    if events.kind[k] == RATE:
        return norm(three(y, STATE * b + 10)) - events.level[k]
    for j in range(STATE):
        shared.state[j] = y[STATE * b + j]
    slot = events.slot[k]
    if slot >= PLAIN_LOAD:
        if call(slot, t) != 0:
            return nan
    else:
        parameters = events.parameters[events.first[k] : events.first[k + 1]]
        shared.culprit[2] = EVENT_AT_WORK
        shared.replies[0] = ask(loads, slot, t, shared.state, parameters, shared.reply)
        shared.culprit[2] = 0
    return shared.reply[0] if shared.replies[0] > 0 else nan


@inner
def interpolant(t, h, run, loads, call):
    """Coefficients of the state within the step just taken, into work.dense."""
    plant, inputs, stepping, shared, work = run.plant, run.inputs, run.stepping, run.shared, run.work
    if work.implicit.rate.shape[0] > 0:
        implicit_interpolant(t, h, plant, inputs, loads, call, shared, work)
        return
    stages = stepping.tableau.b.shape[0]
    closing_rates(t, h, plant, inputs, loads, call, shared, work, stages)
    extra = stepping.tableau.c_extra.shape[0]
    if extra == 0:
        hermite_coefficients(work.z, work.z1, work.k[0], work.k[stages], h, work.dense)
        return
    for x in range(extra):
        row = stages + 1 + x
        combine(work.z, h, work.k, stepping.tableau.a_extra[x], row, work.stage)
        at = t + stepping.tableau.c_extra[x] * h
        plant_rates(at, work.stage, work.start, plant, inputs, work.frozen, loads, call, shared, work.log, work.k[row])
    dense_coefficients(work.z, work.z1, h, work.k, stepping.tableau.d, work.dense)


@inner
def within(theta, work, y):
    """State at the fraction theta of the step, into y."""
    dense_value(theta, work.dense, work.z, work.stage)
    settle(work.stage, work.start, y)


@inner
def crossing(t, h, k, before, after, run, loads, call):
    """Fraction of the step at which event k happens; FAILED where its quantity has no value."""
    a, fa, b, fb = 0.0, before, 1.0, after
    left = evaluations(b - a, SHARPNESS)
    while b - a > SHARPNESS and left > 0:
        x = next_guess(a, fa, b, fb, left, SHARPNESS)
        within(x, run.work, run.scratch)
        value = quantity(t + x * h, k, run.scratch, run, loads, call)
        if not abs(value) < FINITE:
            return FAILED
        a, fa, b, fb = narrow(a, fa, b, fb, x, value)
        left -= 1
    return b


@inner
def watch(t, h, ready, run, loads, call):
    """Look for crossings in the step from t to t + h, whose end is the state now; keep them.

    Returns the fraction of the step at which the run stops, which may be its end; GOES_ON where it does not, FAILED where a
    quantity has no value, with the culprit noted. `ready`: the interpolant is made.
    """
    events, clock = run.events, run.clock
    stop = GOES_ON
    for k in range(events.kind.shape[0]):
        before, after = events.value[k], quantity(t + h, k, run.y, run, loads, call)
        if not abs(after) < FINITE:
            return FAILED
        events.value[k] = after
        if not bracketed(before, after, events.direction[k]):
            continue
        if not ready:
            interpolant(t, h, run, loads, call)
            ready = True
        theta = crossing(t, h, k, before, after, run, loads, call)
        if theta == FAILED:
            return FAILED
        place = clock.events[0]
        if place < events.found.shape[0]:
            events.found[place, 0] = k
            events.found[place, 1] = t + theta * h
            events.found[place, 2] = 1.0 if after >= before else -1.0
            clock.events[0] += 1
        if events.stop[k] != 0:
            stop = min(stop, theta)
    return stop
