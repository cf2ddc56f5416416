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
from fieldline.dynamics.layout import attitude_at, store, three
from fieldline.dynamics.lines.chain import END_MASS, unstretched
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
    burden: np.ndarray  # (bodies, 10) end masses at the step's start
    seat: np.ndarray  # (bodies,) int64
    lever: np.ndarray  # (lines, 2, 9) V of either end
    hold: np.ndarray  # (bodies, 9) sum of s^2 [p x][F_b x]
    feed: np.ndarray  # (lines, 7) e, pi / (m_r + pi), s^2 T_L, pi, mu l / (2 m_r)
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
        burden=np.zeros((bodies, END_MASS)),
        seat=seat,
        lever=np.zeros((count, 2, 9)),
        hold=np.zeros((bodies, 9)),
        feed=np.zeros((count, 7)),
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
def enter_body(b, s, z, start, bodies, end_mass, axes, system):
    """The mass matrix of (2) of a body that lines touch."""
    row = 6 * system.seat[b]
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
def enter_end(k, end, s, force_i, along_i, z, start, lines, rigid, point, system):
    """V of (3), and (4), of an end of line k that pulls with a force [N] along a unit vector, inertial axes."""
    b = lines.body[k, end]
    if rigid[b] == 0:
        return
    q = attitude_at(z, start, b)
    body_from_i = dcm(q)
    keep(system.lever[k], end, matscale(-1.0, matmul(skew(to_inertial(q, point)), transpose(body_from_i))))
    hold = matscale(s * s, matmul(skew(point), skew(to_body(q, force_i))))
    keep(system.hold, b, matadd(block(system.hold, b), hold))
    row = 6 * system.seat[b] + 3
    add_block(system.matrix, row, row, matscale(-1.0, hold))
    if lines.joint[k, end] > 0.0 and dot(force_i, force_i) > 0.0:
        e = to_body(q, along_i)
        add_block(system.matrix, row, row, matscale(s * lines.joint[k, end], matsub(IDENTITY, outer(e, e))))


@inner
def enter_line(k, s, z, start, at, lines, rigid, tensions, axes, system):
    """Blocks of line k, condensed onto its ends, and those onto its bodies."""
    chain = system.chain
    omega = three(axes.origin[axes.group[lines.body[k, 0]]], 6)
    turns = turning_part(omega, s)
    nodes, first, base, feed = lines.nodes[k], lines.first[k], at[0] + 6 * lines.first[k], at[1] + 2 * k
    warm = at[2] + lines.warm[k] if lines.warm[k + 1] > lines.warm[k] else -1
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
        tension = tensions[row]
        carried, elastic, e = segment_blocks(chord, moving, rest, lines.stiffness[row], lines.damping[row], tension, s)
        if j == 0:
            enter_end(k, 0, s, scale(tension, e), e, z, start, lines, rigid, three(axes.point[k], 0), system)
        if j == nodes:
            enter_end(k, 1, s, scale(-tension, e), e, z, start, lines, rigid, three(axes.point[k], 3), system)
            if lines.reel[k] != NO_REEL:
                carried, elastic = enter_reel(k, s, sqrt(dot(chord, chord)), rest, e, carried, elastic, lines, system.feed)
        keep(chain.carried, row, carried)
        keep(chain.elastic, row, elastic)
        next_half = 0.5 * lines.linear_mass[row] * (z[feed] if j == nodes else lines.rest[row])
        if j > 0:
            system.mass[first + j - 1] = half + next_half
            keep(chain.pivot, first + j - 1, matscale(half + next_half, turns))
        half = next_half
        p0, v0 = p1, v1
    factorise_chain(k, first, nodes, chain)
    if lines.reel[k] == TENSION_REEL:
        system.feed[k, 6] = half / lines.reel_lag[k]
        for i in range(2, 4):
            keep(chain.ends[k], i, matmul(eased(system.feed[k]), block(chain.ends[k], i)))
    for i in range(2):
        for j in range(2):
            enter_pair(k, i, j, lines.body, system)


@inner
def enter_reel(k, s, length, rest, e, carried, elastic, lines, feed):
    """(P, Q) of the segment beside a reel, which may give way; (3) of `segment_blocks`."""
    row = lines.first[k] + k + lines.nodes[k]
    store(feed[k], 0, e)
    slope, push = 0.0, 0.0
    if carried[0] + carried[4] + carried[8] > 0.0:
        slope, push = feed_slopes(length, rest, lines.stiffness[row], lines.damping[row], s)
    share = push / (lines.reel_lag[k] + push) if lines.reel[k] == TENSION_REEL else 0.0
    feed[k, 3], feed[k, 4], feed[k, 5] = share, s * s * slope, push
    less = matscale(-share, outer(e, e))
    return matadd(carried, matmul(less, carried)), matadd(elastic, matmul(less, elastic))


@inner
def eased(reel):
    """E - (mu l / 2 m_r) e e^T: of its pull a reel that gives way spends this part on the half segment that it sets going."""
    e = three(reel, 0)
    return matsub(IDENTITY, matscale(reel[6], outer(e, e)))


@inner
def enter_pair(k, i, j, body, system):
    """What end j of line k does to end i, S of `chain_solve`, in the rows and columns of their bodies."""
    row, column = 6 * system.seat[body[k, i]], 6 * system.seat[body[k, j]]
    both = block(system.chain.ends[k], 2 * i + j)
    back, lever = transpose(block(system.lever[k], i)), block(system.lever[k], j)
    add_block(system.matrix, row, column, both)
    add_block(system.matrix, row, column + 3, matmul(both, lever))
    turned = matmul(back, both)
    add_block(system.matrix, row + 3, column, turned)
    add_block(system.matrix, row + 3, column + 3, matmul(turned, lever))


@inner
def enter_system(s, z, start, at, lines, bodies, tensions, end_mass, axes, system):
    """The whole matrix for a step from z, and its factors; at: where nodes, feeds and temperatures start in z."""
    system.matrix[:, :] = 0.0
    system.hold[:, :] = 0.0
    for b in range(system.seat.shape[0]):
        for j in range(END_MASS):
            system.burden[b, j] = end_mass[b, j]
    for b in range(system.seat.shape[0]):
        if system.seat[b] >= 0:
            enter_body(b, s, z, start, bodies, system.burden, axes, system)
    for k in range(lines.nodes.shape[0]):
        enter_line(k, s, z, start, at, lines, bodies.rigid, tensions, axes, system)
    factorise(system.matrix, system.column.shape[0], system.order)


@inner
def body_load(b, s, rate, z, start, bodies, end_mass, axes, system):
    """The right-hand side of (2) of a body, from the rates in turning axes."""
    base, row, omega = TANGENT * b, 6 * system.seat[b], three(axes.origin[axes.group[b]], 6)
    w = scale(s, axpy(-s, cross(omega, cross(omega, three(rate, base))), three(rate, base + 3)))
    mass = bodies.mass[b] + end_mass[b, 0]
    if bodies.rigid[b] == 0:
        store(system.column, row, scale(mass, w))
        store(system.column, row + 3, NONE)
        return
    q = attitude_at(z, start, b)
    arm = three(end_mass[b], 1)
    turn = scale(s, three(rate, base + 9))
    inertia = matadd(row9(bodies.inertia, b), spread(end_mass[b]))
    store(system.column, row, axpy(mass, w, to_inertial(q, cross(turn, arm))))
    torque = add(matvec(inertia, turn), cross(arm, to_body(q, w)))
    store(system.column, row + 3, add(torque, matvec(block(system.hold, b), three(rate, base + 6))))


@inner
def end_value(lever, end, values, at):
    """An end's from its body's three numbers at `at` and the turning three after them."""
    return add(three(values, at), matvec(block(lever, end), three(values, at + 3)))


@inner
def end_rate(lever, end, rate, b):
    """Rate of an end's place, from those of body b."""
    return add(three(rate, TANGENT * b), matvec(block(lever, end), three(rate, TANGENT * b + 6)))


@inner
def reel_load(k, s, rate, feed, lines, reel):
    """What the last segment carries because the reel moves [kg m/s]: e times the terms of (3) without P and Q."""
    share, slope, push = reel[3], reel[4], reel[5]
    known = slope * rate[feed]
    if lines.reel[k] == TENSION_REEL:
        return (1.0 - share) * known - share * s * lines.reel_lag[k] * rate[feed + 1]
    return known - push * s * rate[feed + 1] / (1.0 + s / lines.reel_lag[k])


@inner
def line_load(k, s, rate, at, lines, axes, system):
    """Loads of the nodes and the ends of line k from the rates in turning axes; those of the ends go to the column."""
    chain, lever = system.chain, system.lever[k]
    omega = three(axes.origin[axes.group[lines.body[k, 0]]], 6)
    nodes, first, base, feed = lines.nodes[k], lines.first[k], at[0] + 6 * lines.first[k], at[1] + 2 * k
    x0 = end_rate(lever, 0, rate, lines.body[k, 0])
    on_a, behind = NONE, NONE
    for j in range(nodes + 1):
        row = first + k + j
        x1 = three(rate, base + 6 * j) if j < nodes else end_rate(lever, 1, rate, lines.body[k, 1])
        ahead = matvec(block(chain.elastic, row), sub(x1, x0))
        if j == nodes and lines.reel[k] != NO_REEL:
            ahead = axpy(reel_load(k, s, rate, feed, lines, system.feed[k]), three(system.feed[k], 0), ahead)
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
    push_end(6 * system.seat[lines.body[k, 0]], 0, add(more_a, on_a), lever, system.column)
    on_b = sub(more_b, behind)
    if lines.reel[k] == TENSION_REEL:
        on_b = matvec(eased(system.feed[k]), on_b)
    push_end(6 * system.seat[lines.body[k, 1]], 1, on_b, lever, system.column)


@inner
def push_end(row, end, force, lever, column):
    """A force at an end of a line, on its body's rows of the column."""
    store(column, row, add(three(column, row), force))
    torque = matvec(transpose(block(lever, end)), force)
    store(column, row + 3, add(three(column, row + 3), torque))


@inner
def follow(at, s, rate, u_w, out):
    """U of a place and its velocity, from U_w: U_x = s (x' + U_w)."""
    store(out, at, scale(s, add(three(rate, at), u_w)))
    store(out, at + 3, u_w)


@inner
def line_answer(k, s, rate, at, lines, system, out):
    """U of the nodes of line k and of its feed, once those of the bodies are in the column."""
    chain, lever = system.chain, system.lever[k]
    u_a = end_value(lever, 0, system.column, 6 * system.seat[lines.body[k, 0]])
    u_b = end_value(lever, 1, system.column, 6 * system.seat[lines.body[k, 1]])
    nodes, first, base = lines.nodes[k], lines.first[k], at[0] + 6 * lines.first[k]
    spread_out(k, first, nodes, u_a, u_b, chain)
    for j in range(nodes):
        follow(base + 6 * j, s, rate, vec(chain.load, first + j), out)
    if lines.reel[k] != NO_REEL:
        x1 = end_rate(lever, 1, rate, lines.body[k, 1])
        if nodes > 0:
            u0, x0 = vec(chain.load, first + nodes - 1), three(rate, base + 6 * (nodes - 1))
        else:
            u0, x0 = u_a, end_rate(lever, 0, rate, lines.body[k, 0])
        row = first + k + nodes
        pull = add(matvec(block(chain.carried, row), sub(u_b, u0)), matvec(block(chain.elastic, row), sub(x1, x0)))
        feed_answer(k, s, rate, at[1] + 2 * k, pull, lines, system.feed[k], out)


@inner
def feed_answer(k, s, rate, feed, pull, lines, reel, out):
    """U of a feed by (3) or (4) of `segment_blocks`; `pull`: P dU + Q dx' of its segment."""
    lag = lines.reel_lag[k]
    if lines.reel[k] == TENSION_REEL:
        known = s * rate[feed + 1] + reel[4] * rate[feed] / lag
        out[feed + 1] = (1.0 - reel[3]) * known + dot(three(reel, 0), pull) / lag
    else:
        out[feed + 1] = s * rate[feed + 1] / (1.0 + s / lag)
    out[feed] = s * (rate[feed] + out[feed + 1])


@inner
def solve(s, rate, z, start, at, lines, bodies, axes, system, out):
    """U of one stage into out, from its right-hand side in turning axes; what the matrix leaves out: U = s rate."""
    for j in range(rate.shape[0]):
        out[j] = s * rate[j]
    for b in range(system.seat.shape[0]):
        if system.seat[b] >= 0:
            body_load(b, s, rate, z, start, bodies, system.burden, axes, system)
    for k in range(lines.nodes.shape[0]):
        line_load(k, s, rate, at, lines, axes, system)
    substitute(system.matrix, system.column.shape[0], system.order, system.column)
    for k in range(lines.nodes.shape[0]):
        line_answer(k, s, rate, at, lines, system, out)
    for b in range(system.seat.shape[0]):
        if system.seat[b] >= 0:
            row, base = 6 * system.seat[b], TANGENT * b
            follow(base, s, rate, three(system.column, row), out)
            if bodies.rigid[b] != 0:
                turn = three(system.column, row + 3)
                store(out, base + 6, scale(s, add(three(rate, base + 6), turn)))
                store(out, base + 9, turn)
