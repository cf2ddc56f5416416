"""Axes that fall and turn with what hangs together, through one step: there, a stretched line hardly moves.

    r = c(t) + R(t) X,    v = c'(t) + R(t) (W + Omega x X),    R(t) = exp(t [Omega x])                       (1)
    X' = W,    W' = R^T (r'' - c'') - 2 Omega x W - Omega x (Omega x X)                                     (2)

Nothing is left out: (1) is another way to write r and v, for any Omega and any c(t) of which c'' is known. They are chosen
so that X and W change little. c(t) is the polynomial of degree 5 in time that the two-body motion of the centre of mass
begins with (the series of f and g); its remainder is in (2). Omega is the rate at which the lines' chords
d_k, from attachment to attachment, turn on the whole:

    Omega = n + delta,   sum (|d|^2 (1 + eps) E - d d^T) delta = sum d x (d' - n x d)                        (3)

with n the orbital rate r x v / r^2, about a single line's chord also its spin. What makes this the right choice: the
matrix of a linearly implicit step is taken once, so that a direction which turns by the angle a within the step leaves a
part a of the line's stiffness out of it. In inertial axes that is n h, and a step of some seconds diverges; axes that
turn with the orbit alone still leave the libration. Measured: docs/theory/tether_stepper.md.

Everything that is joined by lines is a group with axes of its own; a body without lines falls alone.
"""

from __future__ import annotations

from math import cos, sin, sqrt
from typing import NamedTuple

import numpy as np

from fieldline.compiled import inner
from fieldline.dynamics.layout import store, three
from fieldline.dynamics.lines.chain import attachment, line_end
from fieldline.dynamics.parameters import NO_REEL, TANGENT, Lines
from fieldline.frames.matrices import IDENTITY, inverse, matadd, matmul, matscale, matvec, skew, transpose
from fieldline.frames.vectors import add, axpy, cross, dot, scale, sub

LEVEL = 1e-4  # eps of equation (3): lines that are parallel to this leave their spin to the orbit


class Axes(NamedTuple):
    """One row a group: where its axes start, how they turn, where they are at a stage."""

    group: np.ndarray  # (bodies,) int64
    origin: np.ndarray  # (groups, 9) c, c' at the step's start, Omega
    now: np.ndarray  # (groups, 18) R, c, c', c''
    sums: np.ndarray  # (groups, 13) of equation (3): the matrix, the right-hand side, and the mass
    attached: np.ndarray  # (lines, 12) place and velocity of A's attachment, of B's, inertial axes, at the step's start
    point: np.ndarray  # (lines, 6) the attachments in the bodies, body axes


def new_axes(bodies: int, lines: Lines) -> Axes:
    """Groups of the bodies that lines join."""
    group = np.arange(bodies)
    for a, b in lines.body:
        group[group == group[b]] = group[a]
    names, numbers = np.unique(group, return_inverse=True)
    groups = len(names)
    return Axes(
        group=numbers.astype(np.int64),
        origin=np.zeros((groups, 9)),
        now=np.zeros((groups, 18)),
        sums=np.zeros((groups, 13)),
        attached=np.zeros((len(lines.nodes), 12)),
        point=np.zeros((len(lines.nodes), 6)),
    )


@inner
def turn_matrix(omega, t):
    """R(t) = exp(t [Omega x])."""
    rate = sqrt(dot(omega, omega))
    if rate == 0.0:
        return IDENTITY
    around = skew(scale(1.0 / rate, omega))
    return matadd(IDENTITY, matadd(matscale(sin(rate * t), around), matscale(1.0 - cos(rate * t), matmul(around, around))))


@inner
def fall(r, v, t, gm):
    """(c, c', c'') at t of the two-body motion from r, v: its series of f and g, to t^5 in f and g."""
    square = dot(r, r)
    s = gm / (square * sqrt(square))
    p, w = dot(r, v) / square, dot(v, v) / square - s
    f2, f3, f4, f5 = -s / 2.0, s * p / 2.0, s * (3.0 * w - 15.0 * p * p + s) / 24.0, s * p * (7.0 * p * p - 3.0 * w - s) / 8.0
    g3, g4, g5 = -s / 6.0, s * p / 4.0, s * (9.0 * w - 45.0 * p * p + s) / 120.0
    f = 1.0 + t * t * (f2 + t * (f3 + t * (f4 + t * f5)))
    g = t + t * t * t * (g3 + t * (g4 + t * g5))
    f_rate = t * (2.0 * f2 + t * (3.0 * f3 + t * (4.0 * f4 + t * 5.0 * f5)))
    g_rate = 1.0 + t * t * (3.0 * g3 + t * (4.0 * g4 + t * 5.0 * g5))
    f_bend = 2.0 * f2 + t * (6.0 * f3 + t * (12.0 * f4 + t * 20.0 * f5))
    g_bend = t * (6.0 * g3 + t * (12.0 * g4 + t * 20.0 * g5))
    return (
        axpy(f, r, scale(g, v)),
        axpy(f_rate, r, scale(g_rate, v)),
        axpy(f_bend, r, scale(g_bend, v)),
    )


@inner
def open_axes(t, z, start, at, plant, inputs, axes):
    """Axes of a step that starts at t from z, by (3); at: where nodes and feeds start in z."""
    axes.sums[:, :] = 0.0
    axes.origin[:, :] = 0.0
    for b in range(axes.group.shape[0]):
        weigh(plant.bodies.mass[b], three(z, TANGENT * b), three(z, TANGENT * b + 3), axes.group[b], axes)
    for k in range(plant.lines.nodes.shape[0]):
        attach(t, k, z, start, plant, inputs, axes)
        weigh_line(k, z, at, plant.lines, axes)
    for g in range(axes.origin.shape[0]):
        for j in range(6):
            axes.origin[g, j] /= axes.sums[g, 12]
        r, v = three(axes.origin[g], 0), three(axes.origin[g], 3)
        store(axes.origin[g], 6, scale(1.0 / dot(r, r), cross(r, v)))
    for k in range(plant.lines.nodes.shape[0]):
        gather_chord(k, axes.group[plant.lines.body[k, 0]], axes)
    for g in range(axes.origin.shape[0]):
        sums = axes.sums[g]
        whole = 0.5 * (sums[0] + sums[4] + sums[8])
        if whole > 0.0:
            level = LEVEL * whole
            left = (
                sums[0] + level, sums[1], sums[2], sums[3], sums[4] + level, sums[5], sums[6], sums[7], sums[8] + level,
            )  # fmt: skip
            more = matvec(inverse(left), three(sums, 9))
            store(axes.origin[g], 6, add(three(axes.origin[g], 6), more))


@inner
def weigh(mass, place, speed, g, axes):
    """A mass into the centre of its group."""
    axes.sums[g, 12] += mass
    store(axes.origin[g], 0, axpy(mass, place, three(axes.origin[g], 0)))
    store(axes.origin[g], 3, axpy(mass, speed, three(axes.origin[g], 3)))


@inner
def weigh_line(k, z, at, lines, axes):
    """The masses of a line into the centre of its group; what has left a reel is missing in its body."""
    g, row, base = axes.group[lines.body[k, 0]], lines.first[k] + k, at[0] + 6 * lines.first[k]
    p0, v0 = three(axes.attached[k], 0), three(axes.attached[k], 3)
    out = 0.0
    for j in range(lines.nodes[k] + 1):
        if j < lines.nodes[k]:
            p1, v1 = three(z, base + 6 * j), three(z, base + 6 * j + 3)
        else:
            p1, v1 = three(axes.attached[k], 6), three(axes.attached[k], 9)
        mass = lines.linear_mass[row + j] * (z[at[1] + 2 * k] if j == lines.nodes[k] else lines.rest[row + j])
        weigh(mass, scale(0.5, add(p0, p1)), scale(0.5, add(v0, v1)), g, axes)
        out += mass
        p0, v0 = p1, v1
    if lines.reel[k] != NO_REEL:
        weigh(lines.stored[k] - out, p0, v0, g, axes)


@inner
def attach(t, k, z, start, plant, inputs, axes):
    """A line's attachments, in the bodies and in inertial axes."""
    for end in range(2):
        point, rate = attachment(t, k, end, plant, inputs)
        place, speed, _ = line_end(z, start, plant.lines.body[k, end], plant.bodies, point, rate)
        store(axes.point[k], 3 * end, point)
        store(axes.attached[k], 6 * end, place)
        store(axes.attached[k], 6 * end + 3, speed)


@inner
def gather_chord(k, g, axes):
    """A line's part of the sums of (3)."""
    ends = axes.attached[k]
    chord = sub(three(ends, 6), three(ends, 0))
    moving = sub(sub(three(ends, 9), three(ends, 3)), cross(three(axes.origin[g], 6), chord))
    square = dot(chord, chord)
    turning = cross(chord, moving)
    for i in range(3):
        axes.sums[g, 4 * i] += square
        axes.sums[g, 9 + i] += turning[i]
        for j in range(3):
            axes.sums[g, 3 * i + j] -= chord[i] * chord[j]


@inner
def move_axes(t, gm, axes):
    """Bring all axes to the time t after the step's start."""
    for g in range(axes.origin.shape[0]):
        origin, now = axes.origin[g], axes.now[g]
        turned = turn_matrix(three(origin, 6), t)
        for j in range(9):
            now[j] = turned[j]
        place, speed, bend = fall(three(origin, 0), three(origin, 3), t, gm)
        store(now, 9, place)
        store(now, 12, speed)
        store(now, 15, bend)


@inner
def turned(now):
    """R of a group."""
    return (now[0], now[1], now[2], now[3], now[4], now[5], now[6], now[7], now[8])


@inner
def enter(z, at, g, axes, out):
    """r, v in z as X, W in out, at the step's start, where R = E."""
    origin = axes.origin[g]
    x = sub(three(z, at), three(origin, 0))
    store(out, at, x)
    store(out, at + 3, sub(sub(three(z, at + 3), three(origin, 3)), cross(three(origin, 6), x)))


@inner
def leave(points, g, axes, out):
    """X, W of points (6 n,) as r, v in out; equation (1). They are alike, so the compiler takes several at a time."""
    now, omega = axes.now[g], three(axes.origin[g], 6)
    matrix, place, speed = turned(now), three(now, 9), three(now, 12)
    for i in range(points.size // 6):
        x, w = three(points, 6 * i), three(points, 6 * i + 3)
        store(out, 6 * i, add(place, matvec(matrix, x)))
        store(out, 6 * i + 3, add(speed, matvec(matrix, add(w, cross(omega, x)))))


@inner
def turn_rates(points, rates, g, axes, out):
    """(X', W') of (2) into out, from X, W of points (6 n,) and their (r', r'') in rates; several at a time."""
    now, omega = axes.now[g], three(axes.origin[g], 6)
    back, bend = transpose(turned(now)), three(now, 15)
    for i in range(points.size // 6):
        x, w = three(points, 6 * i), three(points, 6 * i + 3)
        pull = matvec(back, sub(three(rates, 6 * i + 3), bend))
        store(out, 6 * i, w)
        store(out, 6 * i + 3, sub(pull, cross(omega, axpy(2.0, w, cross(omega, x)))))


@inner
def enter_all(z, base, lines, axes, out):
    """Everything of z in turning axes, nodes from `base` on; what neither falls nor turns as it is."""
    for j in range(z.shape[0]):
        out[j] = z[j]
    for b in range(axes.group.shape[0]):
        enter(z, TANGENT * b, axes.group[b], axes, out)
    for k in range(lines.nodes.shape[0]):
        for i in range(lines.nodes[k]):
            enter(z, base + 6 * (lines.first[k] + i), axes.group[lines.body[k, 0]], axes, out)


@inner
def leave_all(z, base, lines, axes, out):
    """The stepper's z of what is given in turning axes."""
    for j in range(z.shape[0]):
        out[j] = z[j]
    for b in range(axes.group.shape[0]):
        at = TANGENT * b
        leave(z[at : at + 6], axes.group[b], axes, out[at : at + 6])
    for k in range(lines.nodes.shape[0]):
        at, end = base + 6 * lines.first[k], base + 6 * (lines.first[k] + lines.nodes[k])
        leave(z[at:end], axes.group[lines.body[k, 0]], axes, out[at:end])


@inner
def turn_all_rates(z, rate, base, lines, axes, out):
    """Rates in turning axes, of everything, into out."""
    for j in range(z.shape[0]):
        out[j] = rate[j]
    for b in range(axes.group.shape[0]):
        at = TANGENT * b
        turn_rates(z[at : at + 6], rate[at : at + 6], axes.group[b], axes, out[at : at + 6])
    for k in range(lines.nodes.shape[0]):
        at, end = base + 6 * lines.first[k], base + 6 * (lines.first[k] + lines.nodes[k])
        turn_rates(z[at:end], rate[at:end], axes.group[lines.body[k, 0]], axes, out[at:end])
