"""Three axes by the field alone, linear-quadratic: gains over the orbit, or constant ones by two kinds of averaging.

State x = (theta, w), and the integral of theta if asked; model (32); cost the integral of x'Qx + M'M/m^2.

    magnetic-lqr-periodic     M = -m^2 B x (J^-1 P_w(u) x), P the periodic Riccati solution at the phase u      (36)
    magnetic-lqr-asymptotic   the same with one P, of the Riccati equation with the mean of b b' over the orbit  (37)
    magnetic-lqr-averaged     M = -B x (K x) / B^2, K for a torque through the mean of (I - B B'/B^2)            (38)

P_w are the rows of P that belong to w; B is the field as measured, which at theta = 0 is the design's. (36) tends to (37) as
the input is weighed more (the control weak against the field's turning), where averaging is exact: Psiaki's asymptotic
regulator. (38) is the older way: it averages the projection, not the effect.

The integral of theta takes out what a constant torque in the orbital axes leaves; it rests while the moment is at its limit
or the error beyond `integral_limit_deg`. Better is to estimate (`cancel_residual`): a residual dipole is then commanded away,
and a constant torque met by the gains (40) of `regulator_design`.

Kernel: params hold the table of 3 x 12 gains at N phases of one orbit, or of a day's orbits, because the Earth turns its
tilted field under the orbit; the phase is counted from the run's start as the design's field was.

Sources: Wisniewski (1997), Proc. IEEE Conf. Decision and Control, 1788; Psiaki (2001), J. Guidance 24(2):386.
"""

from __future__ import annotations

from math import floor, pi

from numba import njit

from fieldline.control import residual_dipole, target
from fieldline.control.orbital_axes import argument_of_latitude
from fieldline.control.readings import field_known, lifted, orbit_known, wheel_momentum_b
from fieldline.control.residual_dipole import residual_estimate
from fieldline.control.saturation import as_command, shortened
from fieldline.control.target import pointing_error
from fieldline.frames.vectors import add, cross, dot, norm, scale, sub

MEAN_MOTION = target.SIZE
NODES, ORBITS, BY_PROJECTION = MEAN_MOTION + 1, MEAN_MOTION + 2, MEAN_MOTION + 3
INTEGRATES, INTEGRAL_LIMIT = MEAN_MOTION + 4, MEAN_MOTION + 5
MOMENT_MAX = MEAN_MOTION + 6
FILTER = MOMENT_MAX + 3
TABLE_AT = FILTER + residual_dipole.SIZE
WHEELS = TABLE_AT + 1
COLUMNS = 12  # theta, w, integral of theta, torque
ROW = 3 * COLUMNS

HAS_PHASE, PHASE_SHIFT, HAS_TIME, TIME, SUM, SATURATED, OWN = 0, 1, 2, 3, 4, 7, 8
MEMORY = OWN + residual_dipole.MEMORY


@njit(cache=True)
def orbit_phase(t, measurement, memory, params):
    """Angle [rad] along the orbit since the run's start: by the mean motion, corrected by where the satellite is, if known."""
    by_clock = params[MEAN_MOTION] * t
    if not orbit_known(measurement):
        return by_clock
    here = argument_of_latitude(lifted(measurement.position_i), lifted(measurement.velocity_i))
    if memory[HAS_PHASE] < 0.5:
        memory[HAS_PHASE] = 1.0
        memory[PHASE_SHIFT] = by_clock - here
    ahead = here + memory[PHASE_SHIFT] - by_clock
    return by_clock + ahead - 2.0 * pi * floor(ahead / (2.0 * pi) + 0.5)


@njit(cache=True)
def _interpolated(params, phase, theta, rate, whole, torque):
    """The table's matrix at a phase times the state, linear between the nodes."""
    nodes = int(params[NODES])
    turns = phase / (2.0 * pi * params[ORBITS])
    at = (turns - floor(turns)) * nodes
    lower = int(at) % nodes
    share = at - int(at)
    first = int(params[TABLE_AT]) + ROW * lower
    second = int(params[TABLE_AT]) + ROW * ((lower + 1) % nodes)
    return add(
        scale(1.0 - share, _row_product(params, first, theta, rate, whole, torque)),
        scale(share, _row_product(params, second, theta, rate, whole, torque)),
    )


@njit(cache=True)
def _line(params, k, theta, rate, whole, torque):
    """Twelve gains times the state."""
    return (
        dot((params[k], params[k + 1], params[k + 2]), theta)
        + dot((params[k + 3], params[k + 4], params[k + 5]), rate)
        + dot((params[k + 6], params[k + 7], params[k + 8]), whole)
        + dot((params[k + 9], params[k + 10], params[k + 11]), torque)
    )


@njit(cache=True)
def _row_product(params, k, theta, rate, whole, torque):
    return (
        _line(params, k, theta, rate, whole, torque),
        _line(params, k + COLUMNS, theta, rate, whole, torque),
        _line(params, k + 2 * COLUMNS, theta, rate, whole, torque),
    )


@njit(cache=True)
def _integral(t, theta, memory, params):
    """Integral of theta [rad s], held while the moment is at its limit or the error large."""
    if params[INTEGRATES] > 0.5:
        dt = t - memory[TIME]
        good = memory[HAS_TIME] > 0.5 and memory[SATURATED] < 0.5 and norm(theta) < params[INTEGRAL_LIMIT]
        if good and dt > 0.0:
            for j in range(3):
                memory[SUM + j] += dt * theta[j]
        memory[HAS_TIME] = 1.0
        memory[TIME] = t
    return (memory[SUM], memory[SUM + 1], memory[SUM + 2])


@njit(cache=True)
def magnetic_regulator(t, measurement, memory, params):
    """Moment of (36), (37) or (38), as the params hold it, less the residual dipole if it is estimated.

    Where field, attitude or rate is not known, only the residual dipole as last estimated is cancelled.
    """
    momentum_b = wheel_momentum_b(measurement, params, WHEELS)
    dipole, torque = residual_estimate(t, measurement, momentum_b, memory, OWN, params, FILTER)
    known, theta, rate, _ = pointing_error(measurement, params, 0)
    if not (known and field_known(measurement)):
        memory[HAS_TIME] = 0.0
        return as_command(shortened(scale(-1.0, dipole), params, MOMENT_MAX)[0])
    whole = _integral(t, theta, memory, params)
    push = _interpolated(params, orbit_phase(t, measurement, memory, params), theta, rate, whole, torque)
    field = lifted(measurement.field_b)
    moment = scale(-1.0, cross(field, push))
    if params[BY_PROJECTION] > 0.5:
        moment = scale(1.0 / dot(field, field), moment)
    moment, short = shortened(sub(moment, dipole), params, MOMENT_MAX)
    memory[SATURATED] = 1.0 if short else 0.0
    return as_command(moment)
