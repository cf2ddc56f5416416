"""One linearly implicit step of the plant: what stretches the lines is solved for, the rest taken as an explicit method does.

    (1/(h gamma) - A) U_i = f(t + c_i h, x + sum_j a_ij U_j) + sum_j (c_ij / h) U_j,   x1 = x + sum_j m_j U_j      (1)

with x the state z in axes that fall and turn with the lines (`turning_axes`) and A what tension depends on, over the
nodes and the bodies at the ends of lines (`stiff_system`). The method keeps its order 3 with any A, so that field, air,
wheels, rods, currents, temperatures and the user's loads need no derivative. Its error estimate allows a velocity what
moves its place by the allowed error of a place within the step, or within some seconds where the step is shorter,

    allowed_v = max(allowed_v, allowed_x / max(h, h_0)),   the same for angular rate and angle, feed rate and feed   (2)

so that an oscillation along the line too fast for the step, which the method damps, does not shorten it. Without h_0 the
short steps of a snap would let speeds be wrong that slack parts then keep.

Within the step a place is the cubic of Hermite of both ends, and what the fall c(t) of its axes, of degree 5, departs from
its own cubic; the velocity is the derivative of that. The accelerations of a stiff line are no help there. In the form of
`fieldline.integrate.dense`, with F0..F2 the cubic's,

    place:     F3 = h^2 c''(0)/2 + (F1 - F2)_c,   F3 + F4 = h^2 c''(h)/2 + (F1 + 2 F2)_c                           (3)
    velocity:  G1 = (3 F2 + 2 F3)/h,   G2 = -(4 F3 + 2 F4)/h,   G3 = 5 F4/h                                        (4)
"""

from __future__ import annotations

from fieldline.compiled import inner
from fieldline.dynamics.layout import feeds_at, nodes_at, temperatures_at, three
from fieldline.dynamics.lines.stiff_system import enter_system, solve
from fieldline.dynamics.lines.turning_axes import enter_all, fall, leave_all, move_axes, open_axes, turn_all_rates
from fieldline.dynamics.parameters import TANGENT
from fieldline.dynamics.rates import plant_rates
from fieldline.dynamics.step import closing_rates, lift
from fieldline.integrate.dense import hermite_coefficients
from fieldline.integrate.rosenbrock import sum_stages

STAGES = 4
OPENING, CLOSING = STAGES, STAGES + 1  # rows of k for the rates at the step's start and end
EVALUATIONS = STAGES + 2
PLACES_S, ANGLES_S = 10.0, 1.0  # h_0 of equation (2): of a line's swing, of a body's pendulum on it


@inner
def attempt_implicit(t, h, y, plant, inputs, loads, call, shared, work):
    """Stages (1) of a step of length h from state y, its end in work.z1; 0 or what a user's load did wrong."""
    implicit, gm = work.implicit, plant.surroundings.gravity.gm
    method, axes, system = implicit.method, implicit.axes, implicit.system
    lines, bodies, s = plant.lines, plant.bodies, method.gamma * h
    at = (nodes_at(plant), feeds_at(plant), temperatures_at(plant))
    lift(y, work.start, work.z)
    work.k[:, :] = 0.0  # numbers of nodes that are not out are not written
    status = plant_rates(t, work.z, work.start, plant, inputs, work.frozen, loads, call, shared, work.log, work.k[OPENING])
    if status != 0:
        return status
    open_axes(t, work.z, work.start, at, plant, inputs, axes)
    move_axes(0.0, gm, axes)
    enter_all(work.z, at[0], lines, axes, implicit.opening)
    enter_system(s, work.z, work.start, at, lines, bodies, shared.tension, shared.end_mass, axes, system)
    turn_all_rates(implicit.opening, work.k[OPENING], at[0], lines, axes, implicit.rate)
    solve(s, implicit.rate, work.z, work.start, at, lines, bodies, axes, system, work.k[0])
    for i in range(1, STAGES):
        later = method.nodes[i] * h
        sum_stages(implicit.opening, work.k, method.a[i], i, implicit.inside)
        move_axes(later, gm, axes)
        leave_all(implicit.inside, at[0], lines, axes, work.stage)
        status = plant_rates(
            t + later, work.stage, work.start, plant, inputs, work.frozen, loads, call, shared, work.log, work.k[i]
        )
        if status != 0:
            return status
        turn_all_rates(implicit.inside, work.k[i], at[0], lines, axes, implicit.rate)
        for j in range(i):
            w = method.c[i, j] / h
            for n in range(implicit.rate.shape[0]):
                implicit.rate[n] += w * work.k[j, n]
        solve(s, implicit.rate, work.z, work.start, at, lines, bodies, axes, system, work.k[i])
    sum_stages(implicit.opening, work.k, method.m, STAGES, implicit.inside)
    move_axes(h, gm, axes)
    leave_all(implicit.inside, at[0], lines, axes, work.z1)
    return 0


@inner
def allow_motion(h, plant, scale):
    """Equation (2) on the allowed errors of a step."""
    for b in range(plant.bodies.mass.shape[0]):
        widen(max(h, PLACES_S), TANGENT * b, 3, scale)
        widen(max(h, ANGLES_S), TANGENT * b + 6, 3, scale)
    for k in range(plant.lines.nodes.shape[0]):
        for i in range(plant.lines.nodes[k]):
            widen(max(h, PLACES_S), nodes_at(plant) + 6 * (plant.lines.first[k] + i), 3, scale)
        widen(max(h, PLACES_S), feeds_at(plant) + 2 * k, 1, scale)


@inner
def widen(seconds, at, count, scale):
    """Equation (2) for so many numbers from `at` on, whose rates follow them."""
    for j in range(at, at + count):
        scale[j + count] = max(scale[j + count], scale[j] / seconds)


@inner
def implicit_interpolant(t, h, plant, inputs, loads, call, shared, work):
    """Coefficients of the state within the step just taken into work.dense; equations (3) and (4)."""
    status = closing_rates(t, h, plant, inputs, loads, call, shared, work, CLOSING)
    hermite_coefficients(work.z, work.z1, work.k[OPENING], work.k[CLOSING], h, work.dense)
    group = work.implicit.axes.group
    for b in range(plant.bodies.mass.shape[0]):
        fallen(TANGENT * b, group[b], h, plant, work)
    for k in range(plant.lines.nodes.shape[0]):
        for i in range(plant.lines.nodes[k]):
            fallen(nodes_at(plant) + 6 * (plant.lines.first[k] + i), group[plant.lines.body[k, 0]], h, plant, work)
    return status


@inner
def fallen(at, group, h, plant, work):
    """Place and velocity at `at` within the step, into work.dense."""
    origin, gm, dense, z, z1 = work.implicit.axes.origin[group], plant.surroundings.gravity.gm, work.dense, work.z, work.z1
    c0, u0, bend0 = fall(three(origin, 0), three(origin, 3), 0.0, gm)
    c1, u1, bend1 = fall(three(origin, 0), three(origin, 3), h, gm)
    for j in range(3):
        f0 = c1[j] - c0[j]
        f1, f2 = h * u0[j] - f0, 2.0 * f0 - h * (u0[j] + u1[j])
        f3 = 0.5 * h * h * bend0[j] + f1 - f2
        f4 = 0.5 * h * h * bend1[j] + f1 + 2.0 * f2 - f3
        x, v = at + j, at + 3 + j
        moved = z1[x] - z[x]
        f1, f2 = h * z[v] - moved, 2.0 * moved - h * (z[v] + z1[v])
        dense[1, x], dense[2, x], dense[3, x], dense[4, x] = f1, f2, f3, f4
        dense[1, v], dense[2, v], dense[3, v] = (3.0 * f2 + 2.0 * f3) / h, -(4.0 * f3 + 2.0 * f4) / h, 5.0 * f4 / h
