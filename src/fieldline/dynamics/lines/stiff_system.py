"""The linear system of an implicit step: lines condensed onto the bodies at their ends.

Unknown are the stages' U of the velocities, in turning axes, and of the angular rates, in body axes; with s = gamma h
those of places and rotation vectors follow, U_x = s (x' + U_w). For nodes see `chain_solve`, with

    D_i = m_i (E + 2 s [Omega x] + s^2 [Omega x]^2),     b_i = m_i s (w' - s Omega x (Omega x x')) + sum Q (x' - x')   (1)

x', w' the right-hand sides. A body with end masses (`end_mass`: M, S, J) whose line is attached at p, C = (body to inertial),

    [ M              -C [S x] ] [ E + 2 s [Omega x] + s^2 [Omega x]^2      ]
    [ [S x] C^T       I + J   ] [                                       E  ] U - (what lines do) = b          (2)
    U_a = U_w + V U_omega,   V = -[C p x] C,   force on it F, and V^T F about its centre of mass                (3)
    to I + J:   s beta C^T (E - e e^T) C - s^2 [p x][F_b x]                                                    (4)

(4): the damping of its joints, taken as if it damped every motion across the line, and the pendulum that the line's pull
F_b makes of it. What is left out of the matrix is taken explicitly: gravity's gradient, gyroscopic torques, loads.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from fieldline.compiled import inner
from fieldline.dynamics.layout import attitude_at, feeds_at, nodes_at, store, temperatures_at, three
from fieldline.dynamics.lines.chain import attachment, unstretched
from fieldline.dynamics.lines.chain_solve import Chain, block, condense, factorise_chain, keep, new_chain, spread_out
from fieldline.dynamics.lines.end_mass import spread
from fieldline.dynamics.lines.segment_blocks import feed_slopes, outer, segment_blocks
from fieldline.dynamics.loads.magnetic import row9
from fieldline.dynamics.parameters import NO_REEL, TANGENT, TENSION_REEL, Lines
from fieldline.frames.attitude import dcm, to_body, to_inertial
from fieldline.frames.matrices import IDENTITY, matadd, matmul, matscale, matsub, matvec, skew, transpose
from fieldline.frames.vectors import add, axpy, cross, dot, put, scale, sub, vec
from fieldline.integrate.linear import factorise, substitute

NONE = (0.0, 0.0, 0.0)


class StiffSystem(NamedTuple):
    """Arrays of the system; `seat` says which six rows of the matrix are a body's, -1: no line touches it."""

    chain: Chain
    mass: np.ndarray  # (nodes,) [kg]
    seat: np.ndarray  # (bodies,) int64
    lever: np.ndarray  # (lines, 2, 9) V of either end
    hold: np.ndarray  # (bodies, 9) sum of s^2 [p x][F_b x]
    feed: np.ndarray  # (lines, 6) e, pi / (m_r + pi), s^2 T_L, pi
    matrix: np.ndarray  # (n, n)
    order: np.ndarray  # (n,) int64
    column: np.ndarray  # (n,)


def new_system(bodies: int, lines: Lines) -> StiffSystem:
    """Arrays for so many bodies and their lines."""
    touched = np.unique(lines.body)
    seat = np.full(bodies, -1, dtype=np.int64)
    seat[touched] = np.arange(len(touched))
    size, count = 6 * len(touched), len(lines.nodes)
    return StiffSystem(
        chain=new_chain(int(lines.first[-1]), count),
        mass=np.zeros(int(lines.first[-1])),
        seat=seat,
        lever=np.zeros((count, 2, 9)),
        hold=np.zeros((bodies, 9)),
        feed=np.zeros((count, 6)),
        matrix=np.zeros((size, size)),
        order=np.zeros(size, dtype=np.int64),
        column=np.zeros(size),
    )


@inner
def turning_part(omega, s):
    """E + 2 s [Omega x] + s^2 [Omega x]^2."""
    around = skew(scale(s, omega))
    return matadd(IDENTITY, matadd(matscale(2.0, around), matmul(around, around)))


@inner
def add_block(matrix, row, column, m):
    """Add a 3 x 3 block."""
    for i in range(3):
        for j in range(3):
            matrix[row + i, column + j] += m[3 * i + j]


@inner
def enter_body(b, s, z, start, plant, end_mass, axes, system):
    """The mass matrix of (2) of a body that lines touch."""
    bodies, row = plant.bodies, 6 * system.seat[b]
    turns = turning_part(three(axes.origin[axes.group[b]], 6), s)
    add_block(system.matrix, row, row, matscale(bodies.mass[b] + end_mass[b, 0], turns))
    if bodies.rigid[b] == 0:
        add_block(system.matrix, row + 3, row + 3, IDENTITY)
        return
    body_from_i = dcm(attitude_at(z, start, b))
    arm = skew(three(end_mass[b], 1))
    add_block(system.matrix, row, row + 3, matscale(-1.0, matmul(transpose(body_from_i), arm)))
    add_block(system.matrix, row + 3, row, matmul(matmul(arm, body_from_i), turns))
    add_block(system.matrix, row + 3, row + 3, matadd(row9(bodies.inertia, b), spread(end_mass[b])))


@inner
def enter_end(t, k, end, s, force_i, along_i, z, start, plant, inputs, system):
    """V of (3), and (4), of an end of line k that pulls with a force [N] along a unit vector, inertial axes."""
    b = plant.lines.body[k, end]
    if plant.bodies.rigid[b] == 0:
        return
    q = attitude_at(z, start, b)
    point, _ = attachment(t, k, end, plant, inputs)
    body_from_i = dcm(q)
    keep(system.lever[k], end, matscale(-1.0, matmul(skew(to_inertial(q, point)), transpose(body_from_i))))
    hold = matscale(s * s, matmul(skew(point), skew(to_body(q, force_i))))
    keep(system.hold, b, matadd(block(system.hold, b), hold))
    row = 6 * system.seat[b] + 3
    add_block(system.matrix, row, row, matscale(-1.0, hold))
    if plant.lines.joint[k, end] > 0.0 and dot(force_i, force_i) > 0.0:
        e = to_body(q, along_i)
        add_block(system.matrix, row, row, matscale(s * plant.lines.joint[k, end], matsub(IDENTITY, outer(e, e))))


@inner
def enter_line(t, k, s, z, start, plant, inputs, shared, axes, system):
    """Blocks of line k, condensed onto its ends, and those onto its bodies."""
    lines, chain = plant.lines, system.chain
    omega = three(axes.origin[axes.group[lines.body[k, 0]]], 6)
    turns = turning_part(omega, s)
    nodes, first, base, feed = lines.nodes[k], lines.first[k], nodes_at(plant) + 6 * lines.first[k], feeds_at(plant) + 2 * k
    warm = temperatures_at(plant) + lines.warm[k] if lines.warm[k + 1] > lines.warm[k] else -1
    p0, v0 = three(axes.attached[k], 0), three(axes.attached[k], 3)
    half = 0.0
    for j in range(nodes + 1):
        if j < nodes:
            p1, v1 = three(z, base + 6 * j), three(z, base + 6 * j + 3)
        else:
            p1, v1 = three(axes.attached[k], 6), three(axes.attached[k], 9)
        row = first + k + j
        rest, _ = unstretched(j, k, z, feed, warm, lines)
        chord = sub(p1, p0)
        moving = sub(sub(v1, v0), cross(omega, chord))
        tension = shared.tension[row]
        carried, elastic, e = segment_blocks(chord, moving, rest, lines.stiffness[row], lines.damping[row], tension, s)
        if j == 0:
            enter_end(t, k, 0, s, scale(tension, e), e, z, start, plant, inputs, system)
        if j == nodes:
            enter_end(t, k, 1, s, scale(-tension, e), e, z, start, plant, inputs, system)
            if lines.reel[k] != NO_REEL:
                carried, elastic = enter_reel(k, s, sqrt(dot(chord, chord)), rest, e, carried, elastic, plant, system)
        keep(chain.carried, row, carried)
        keep(chain.elastic, row, elastic)
        next_half = 0.5 * lines.linear_mass[row] * (z[feed] if j == nodes else lines.rest[row])
        if j > 0:
            system.mass[first + j - 1] = half + next_half
            keep(chain.pivot, first + j - 1, matscale(half + next_half, turns))
        half = next_half
        p0, v0 = p1, v1
    factorise_chain(k, first, nodes, chain)
    for i in range(2):
        for j in range(2):
            enter_pair(k, i, j, plant, system)


@inner
def enter_reel(k, s, length, rest, e, carried, elastic, plant, system):
    """(P, Q) of the segment beside a reel, which may give way; (3) of `segment_blocks`."""
    lines, row = plant.lines, plant.lines.first[k] + k + plant.lines.nodes[k]
    store(system.feed[k], 0, e)
    slope, push = 0.0, 0.0
    if carried[0] + carried[4] + carried[8] > 0.0:
        slope, push = feed_slopes(length, rest, lines.stiffness[row], lines.damping[row], s)
    share = push / (lines.reel_lag[k] + push) if lines.reel[k] == TENSION_REEL else 0.0
    system.feed[k, 3], system.feed[k, 4], system.feed[k, 5] = share, s * s * slope, push
    less = matscale(-share, outer(e, e))
    return matadd(carried, matmul(less, carried)), matadd(elastic, matmul(less, elastic))


@inner
def enter_pair(k, i, j, plant, system):
    """What end j of line k does to end i, S of `chain_solve`, in the rows and columns of their bodies."""
    row, column = 6 * system.seat[plant.lines.body[k, i]], 6 * system.seat[plant.lines.body[k, j]]
    both = block(system.chain.ends[k], 2 * i + j)
    back, lever = transpose(block(system.lever[k], i)), block(system.lever[k], j)
    add_block(system.matrix, row, column, both)
    add_block(system.matrix, row, column + 3, matmul(both, lever))
    turned = matmul(back, both)
    add_block(system.matrix, row + 3, column, turned)
    add_block(system.matrix, row + 3, column + 3, matmul(turned, lever))


@inner
def enter_system(t, s, z, start, plant, inputs, shared, axes, system):
    """The whole matrix for a step from z, and its factors."""
    system.matrix[:, :] = 0.0
    system.hold[:, :] = 0.0
    for b in range(plant.bodies.mass.shape[0]):
        if system.seat[b] >= 0:
            enter_body(b, s, z, start, plant, shared.end_mass, axes, system)
    for k in range(plant.lines.nodes.shape[0]):
        enter_line(t, k, s, z, start, plant, inputs, shared, axes, system)
    factorise(system.matrix, system.column.shape[0], system.order)


@inner
def body_load(b, s, rate, z, start, plant, end_mass, axes, system):
    """The right-hand side of (2) of a body, from the rates in turning axes."""
    base, row, omega = TANGENT * b, 6 * system.seat[b], three(axes.origin[axes.group[b]], 6)
    w = scale(s, axpy(-s, cross(omega, cross(omega, three(rate, base))), three(rate, base + 3)))
    mass = plant.bodies.mass[b] + end_mass[b, 0]
    if plant.bodies.rigid[b] == 0:
        store(system.column, row, scale(mass, w))
        store(system.column, row + 3, NONE)
        return
    q = attitude_at(z, start, b)
    arm = three(end_mass[b], 1)
    turn = scale(s, three(rate, base + 9))
    inertia = matadd(row9(plant.bodies.inertia, b), spread(end_mass[b]))
    store(system.column, row, axpy(mass, w, to_inertial(q, cross(turn, arm))))
    torque = add(matvec(inertia, turn), cross(arm, to_body(q, w)))
    store(system.column, row + 3, add(torque, matvec(block(system.hold, b), three(rate, base + 6))))


@inner
def end_value(k, end, values, at, turning, plant, system):
    """U_w + V U_omega of an end, from numbers at `at` and `turning` of its body's part."""
    return add(three(values, at), matvec(block(system.lever[k], end), three(values, turning)))


@inner
def reel_load(k, s, rate, feed, plant, system):
    """What the last segment carries because the reel moves [kg m/s]: e times the terms of (3) without P and Q."""
    share, slope, push = system.feed[k, 3], system.feed[k, 4], system.feed[k, 5]
    known = slope * rate[feed]
    if plant.lines.reel[k] == TENSION_REEL:
        return (1.0 - share) * known - share * s * plant.lines.reel_lag[k] * rate[feed + 1]
    return known - push * s * rate[feed + 1] / (1.0 + s / plant.lines.reel_lag[k])


@inner
def line_load(k, s, rate, plant, axes, system):
    """Loads of the nodes and the ends of line k from the rates in turning axes; those of the ends go to the column."""
    lines, chain = plant.lines, system.chain
    a, b = lines.body[k, 0], lines.body[k, 1]
    omega = three(axes.origin[axes.group[a]], 6)
    nodes, first, base = lines.nodes[k], lines.first[k], nodes_at(plant) + 6 * lines.first[k]
    feed = feeds_at(plant) + 2 * k
    x0 = end_value(k, 0, rate, TANGENT * a, TANGENT * a + 6, plant, system)
    on_a, behind = NONE, NONE
    for j in range(nodes + 1):
        row = first + k + j
        x1 = three(rate, base + 6 * j) if j < nodes else end_value(k, 1, rate, TANGENT * b, TANGENT * b + 6, plant, system)
        ahead = matvec(block(chain.elastic, row), sub(x1, x0))
        if j == nodes and lines.reel[k] != NO_REEL:
            ahead = axpy(reel_load(k, s, rate, feed, plant, system), three(system.feed[k], 0), ahead)
        if j == 0:
            on_a = ahead
        else:
            put(chain.load, first + j - 1, add(vec(chain.load, first + j - 1), sub(ahead, behind)))
        if j < nodes:
            w = axpy(-s, cross(omega, cross(omega, x1)), three(rate, base + 6 * j + 3))
            put(chain.load, first + j, scale(s * system.mass[first + j], w))
        behind = ahead
        x0 = x1
    more_a, more_b = condense(k, first, nodes, chain)
    push_end(k, 0, add(more_a, on_a), plant, system)
    push_end(k, 1, sub(more_b, behind), plant, system)


@inner
def push_end(k, end, force, plant, system):
    """A force at an end of line k, on its body's rows of the column."""
    row = 6 * system.seat[plant.lines.body[k, end]]
    store(system.column, row, add(three(system.column, row), force))
    torque = matvec(transpose(block(system.lever[k], end)), force)
    store(system.column, row + 3, add(three(system.column, row + 3), torque))


@inner
def follow(at, s, rate, u_w, out):
    """U of a place and its velocity, from U_w: U_x = s (x' + U_w)."""
    store(out, at, scale(s, add(three(rate, at), u_w)))
    store(out, at + 3, u_w)


@inner
def line_answer(k, s, rate, plant, system, out):
    """U of the nodes of line k and of its feed, once those of the bodies are in the column."""
    lines, chain, column = plant.lines, system.chain, system.column
    row_a, row_b = 6 * system.seat[lines.body[k, 0]], 6 * system.seat[lines.body[k, 1]]
    u_a = end_value(k, 0, column, row_a, row_a + 3, plant, system)
    u_b = end_value(k, 1, column, row_b, row_b + 3, plant, system)
    nodes, first, base, feed = lines.nodes[k], lines.first[k], nodes_at(plant) + 6 * lines.first[k], feeds_at(plant) + 2 * k
    spread_out(k, first, nodes, u_a, u_b, chain)
    for j in range(nodes):
        follow(base + 6 * j, s, rate, vec(chain.load, first + j), out)
    if lines.reel[k] != NO_REEL:
        u0 = u_a if nodes == 0 else vec(chain.load, first + nodes - 1)
        feed_answer(k, s, rate, feed, sub(u_b, u0), plant, system, out)


@inner
def feed_answer(k, s, rate, feed, stretching, plant, system, out):
    """U of a feed by (3) or (4) of `segment_blocks`; `stretching`: dU of its segment's ends."""
    lines, chain = plant.lines, system.chain
    lag, e = lines.reel_lag[k], three(system.feed[k], 0)
    if lines.reel[k] == TENSION_REEL:
        nodes, row, b = lines.nodes[k], lines.first[k] + k + lines.nodes[k], lines.body[k, 1]
        far = end_value(k, 1, rate, TANGENT * b, TANGENT * b + 6, plant, system)
        if nodes > 0:
            last = three(rate, nodes_at(plant) + 6 * (lines.first[k] + nodes - 1))
        else:
            last = end_value(k, 0, rate, TANGENT * lines.body[k, 0], TANGENT * lines.body[k, 0] + 6, plant, system)
        pull = add(matvec(block(chain.carried, row), stretching), matvec(block(chain.elastic, row), sub(far, last)))
        left = 1.0 - system.feed[k, 3]
        out[feed + 1] = left * (s * rate[feed + 1] + system.feed[k, 4] * rate[feed] / lag) + dot(e, pull) / lag
    else:
        out[feed + 1] = s * rate[feed + 1] / (1.0 + s / lag)
    out[feed] = s * (rate[feed] + out[feed + 1])


@inner
def solve(s, rate, z, start, plant, shared, axes, system, out):
    """U of one stage into out, from its right-hand side in turning axes; what the matrix leaves out: U = s rate."""
    for j in range(rate.shape[0]):
        out[j] = s * rate[j]
    bodies = plant.bodies.mass.shape[0]
    for b in range(bodies):
        if system.seat[b] >= 0:
            body_load(b, s, rate, z, start, plant, shared.end_mass, axes, system)
    for k in range(plant.lines.nodes.shape[0]):
        line_load(k, s, rate, plant, axes, system)
    substitute(system.matrix, system.column.shape[0], system.order, system.column)
    for k in range(plant.lines.nodes.shape[0]):
        line_answer(k, s, rate, plant, system, out)
    for b in range(bodies):
        if system.seat[b] >= 0:
            row, base = 6 * system.seat[b], TANGENT * b
            follow(base, s, rate, three(system.column, row), out)
            if plant.bodies.rigid[b] != 0:
                turn = three(system.column, row + 3)
                store(out, base + 6, scale(s, add(three(rate, base + 6), turn)))
                store(out, base + 9, turn)
