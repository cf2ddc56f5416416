"""Many copies of one satellite at once: a step of the plant for sixteen runs, one in every lane of a vector.

    z = (r, v, sigma, omega),  RK4 with q1 = q0 exp(sigma / 2);  N = (m + m_residual) x B + gravity gradient

The equations are those of `fieldline.dynamics` and the kernels are the plant's own where they have no branch; what has
one is written here without it. Arrays are flat, row after row of LANES numbers, so that the compiler makes of each loop
over the lanes a few vector instructions: number j of run n is at j LANES + n. The Earth's attitude is that of all runs.

    sin(x/2)/x, cos(x/2):   series in x^2                                                               (1)
    (1 - x/2 cot(x/2))/x^2 = 1/12 + x^2/720 + x^4/30240 + ...                                           (2)

both to rounding for x up to 1 rad, the longest turn that the plant allows a fixed step.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np
from numba import njit

from fieldline.environment.ephemeris import Ephemeris, dcm_ei_kernel
from fieldline.environment.harmonics import Basis
from fieldline.frames.attitude import quat_mul, quat_unit, to_body
from fieldline.frames.matrices import matvec, transpose
from fieldline.frames.vectors import add, axpy, cross, dot, scale, sub

LANES = 16
MOTION = 12  # rows of z
WIDE = MOTION * LANES

lanewise = njit(cache=True, error_model="numpy", _nrt=False, nogil=True, fastmath={"contract"})  # a*b+c may be rounded once


class Shared(NamedTuple):
    """What all runs have in common."""

    gm: float
    j2: float
    oblate_radius_m: float
    basis: Basis
    table: np.ndarray
    ephemeris: Ephemeris
    lanes: int  # LANES: a number that the compiler does not know keeps it from unrolling loops before it vectorises them


class Own(NamedTuple):
    """What each run has of its own, flat rows of LANES numbers."""

    inertia: np.ndarray  # 9 rows [kg m^2]
    inverse: np.ndarray  # 9 rows
    residual: np.ndarray  # 3 rows [A m^2]
    gradient: np.ndarray  # 1 row, 0 or 1
    gain: np.ndarray  # 1 row [N m s], of B-dot
    moment_max: np.ndarray  # 3 rows [A m^2], of the torquers along X, Y, Z


class Scratch(NamedTuple):
    """Arrays that a step writes, flat rows of LANES numbers."""

    z: np.ndarray  # 12 rows
    stage: np.ndarray  # 12 rows
    k: np.ndarray  # 12 rows
    total: np.ndarray  # 12 rows
    start: np.ndarray  # 4 rows, attitudes at the step's start
    place: np.ndarray  # 3 rows, positions, axes e
    field: np.ndarray  # 3 rows, axes e
    sums: np.ndarray  # 15 rows of the harmonic sums


@lanewise
def lane3(rows, first, n):
    """Three rows of lane n, from row `first` on, as a tuple."""
    return (rows[first * LANES + n], rows[(first + 1) * LANES + n], rows[(first + 2) * LANES + n])


@lanewise
def put3(rows, first, n, v):
    """A tuple as three rows of lane n."""
    rows[first * LANES + n] = v[0]
    rows[(first + 1) * LANES + n] = v[1]
    rows[(first + 2) * LANES + n] = v[2]


@lanewise
def lane9(rows, n):
    """Nine rows of lane n as a tuple."""
    return (
        rows[n],
        rows[LANES + n],
        rows[2 * LANES + n],
        rows[3 * LANES + n],
        rows[4 * LANES + n],
        rows[5 * LANES + n],
        rows[6 * LANES + n],
        rows[7 * LANES + n],
        rows[8 * LANES + n],
    )


@lanewise
def small_turn(angle):
    """The unit quaternion of a rotation vector of at most 1 rad: `quat_exp` by series (1), without a branch."""
    x = 0.25 * dot(angle, angle)
    s = 1.0 - x / 156.0 * (1.0 - x / 210.0)
    s = 1.0 - x / 42.0 * (1.0 - x / 72.0 * (1.0 - x / 110.0 * s))
    s = 0.5 * (1.0 - x / 6.0 * (1.0 - x / 20.0 * s))
    c = 1.0 - x / 132.0 * (1.0 - x / 182.0 * (1.0 - x / 240.0))
    c = 1.0 - x / 30.0 * (1.0 - x / 56.0 * (1.0 - x / 90.0 * c))
    c = 1.0 - x / 2.0 * (1.0 - x / 12.0 * c)
    return (s * angle[0], s * angle[1], s * angle[2], c)


@lanewise
def small_turn_rate(sigma, omega):
    """dsigma/dt of a rotation vector of at most 1 rad: `turn_rate` by series (2), without a branch."""
    x = dot(sigma, sigma)
    c = 1.0 / 74724249600.0 + x * (3617.0 / 10670622842880000.0 + x * (43867.0 / 5109094217170944000.0))
    c = 1.0 / 1209600.0 + x * (1.0 / 47900160.0 + x * (691.0 / 1307674368000.0 + x * c))
    c = 1.0 / 12.0 + x * (1.0 / 720.0 + x * (1.0 / 30240.0 + x * c))
    bend = cross(sigma, omega)
    return axpy(1.0, omega, axpy(0.5, bend, scale(c, cross(sigma, bend))))


@lanewise
def oblate_gravity(r_e, shared):
    """Acceleration of a point and J2, axes e: `gravity_kernel` without its branches."""
    square = dot(r_e, r_e)
    inverse = shared.gm / (square * sqrt(square))
    flat = 1.5 * shared.j2 * shared.oblate_radius_m * shared.oblate_radius_m / square
    polar = 5.0 * r_e[2] * r_e[2] / square
    across = -inverse * (1.0 + flat * (1.0 - polar))
    return (across * r_e[0], across * r_e[1], -inverse * (1.0 + flat * (3.0 - polar)) * r_e[2])


@lanewise
def field_lanes(lanes, place, basis, table, w, field):
    """The field [T] at every lane's place [m], axes e: `synthesis_kernel` of all lanes; w: 15 rows of scratch."""
    radius = basis.radius_m
    for n in range(lanes):
        x, y, z = lane3(place, 0, n)
        ratio = radius / (x * x + y * y + z * z)
        w[n] = ratio * x
        w[LANES + n] = ratio * y
        w[2 * LANES + n] = ratio * z
        w[3 * LANES + n] = ratio * radius
        w[4 * LANES + n] = sqrt(ratio * radius)
        w[5 * LANES + n] = 1.0
        w[6 * LANES + n] = 0.0
        put3(field, 0, n, (0.0, 0.0, 0.0))
    row = 0
    for m in range(basis.order + 1):
        row = order_lanes(lanes, row, basis.degree - m + 1, basis.recursion, table, w)
        for n in range(lanes):
            cosine, sine = w[5 * LANES + n], w[6 * LANES + n]
            s, t = w[n], w[LANES + n]
            for j in range(3):
                field[j * LANES + n] += cosine * w[(9 + 2 * j) * LANES + n] + sine * w[(10 + 2 * j) * LANES + n]
            w[5 * LANES + n] = cosine * s - sine * t
            w[6 * LANES + n] = cosine * t + sine * s


@lanewise
def order_lanes(lanes, row, count, recursion, table, w):
    """The six sums of one order over its degrees, rows 9 to 14 of w; returns the next order's first row."""
    for n in range(lanes):
        w[7 * LANES + n] = 0.0
        w[8 * LANES + n] = w[4 * LANES + n]
        for j in range(9, 15):
            w[j * LANES + n] = 0.0
    for _ in range(count):
        a, b = recursion[2 * row], recursion[2 * row + 1]
        k = 6 * row
        k0, k1, k2, k3, k4, k5 = table[k], table[k + 1], table[k + 2], table[k + 3], table[k + 4], table[k + 5]
        for n in range(lanes):
            here = w[8 * LANES + n]
            above = a * w[2 * LANES + n] * here - b * w[3 * LANES + n] * w[7 * LANES + n]
            w[7 * LANES + n] = here
            w[8 * LANES + n] = above
            w[9 * LANES + n] += k0 * here
            w[10 * LANES + n] += k1 * here
            w[11 * LANES + n] += k2 * here
            w[12 * LANES + n] += k3 * here
            w[13 * LANES + n] += k4 * here
            w[14 * LANES + n] += k5 * here
        row += 1
    return row


@lanewise
def places_lanes(lanes, dcm_ei, z, place):
    """Positions in axes e."""
    for n in range(lanes):
        put3(place, 0, n, matvec(dcm_ei, lane3(z, 0, n)))


@lanewise
def rates_lanes(dcm_ei, z, start, moment, place, field, shared, own, out):
    """dz/dt of all lanes under the field `field`, axes e, and the torquers' moment (3 rows)."""
    lanes = shared.lanes
    dcm_ie = transpose(dcm_ei)
    for n in range(lanes):
        sigma, omega = lane3(z, 6, n), lane3(z, 9, n)
        turn = small_turn(sigma)
        q0 = (start[n], start[LANES + n], start[2 * LANES + n], start[3 * LANES + n])
        q = quat_mul(q0, turn)
        field_b = to_body(q, matvec(dcm_ie, lane3(field, 0, n)))
        torque = cross(add(lane3(moment, 0, n), lane3(own.residual, 0, n)), field_b)
        inertia = lane9(own.inertia, n)
        r_b = to_body(q, lane3(z, 0, n))
        square = dot(r_b, r_b)
        pull = own.gradient[n] * 3.0 * shared.gm / (square * square * sqrt(square))
        torque = axpy(pull, cross(r_b, matvec(inertia, r_b)), torque)
        put3(out, 0, n, lane3(z, 3, n))
        put3(out, 3, n, matvec(dcm_ie, oblate_gravity(lane3(place, 0, n), shared)))
        put3(out, 6, n, small_turn_rate(sigma, omega))
        spin = matvec(inertia, omega)
        put3(out, 9, n, matvec(lane9(own.inverse, n), sub(torque, cross(omega, spin))))


@lanewise
def stage_lanes(t, z, moment, shared, own, s):
    """Rates of all lanes at t and z, into s.k."""
    dcm_ei = dcm_ei_kernel(t, shared.ephemeris)
    places_lanes(shared.lanes, dcm_ei, z, s.place)
    field_lanes(shared.lanes, s.place, shared.basis, shared.table, s.sums, s.field)
    rates_lanes(dcm_ei, z, s.start, moment, s.place, s.field, shared, own, s.k)


@lanewise
def add_stage(weight, next_step, s):
    """Take a stage into the sum of the step, and make the next stage's z."""
    z, k, total, stage = s.z, s.k, s.total, s.stage
    for i in range(WIDE):
        total[i] += weight * k[i]
    for i in range(WIDE):
        stage[i] = z[i] + next_step * k[i]


@lanewise
def step_lanes(t, h, moment, shared, own, s):
    """One RK4 step of s.z and s.start."""
    z, total = s.z, s.total
    for i in range(6 * LANES, 9 * LANES):
        z[i] = 0.0
    for i in range(WIDE):
        total[i] = 0.0
    stage_lanes(t, z, moment, shared, own, s)
    add_stage(h / 6.0, 0.5 * h, s)
    stage_lanes(t + 0.5 * h, s.stage, moment, shared, own, s)
    add_stage(h / 3.0, 0.5 * h, s)
    stage_lanes(t + 0.5 * h, s.stage, moment, shared, own, s)
    add_stage(h / 3.0, h, s)
    stage_lanes(t + h, s.stage, moment, shared, own, s)
    add_stage(h / 6.0, h, s)
    for i in range(WIDE):
        z[i] += total[i]
    start, lanes = s.start, shared.lanes
    for n in range(lanes):
        q0 = (start[n], start[LANES + n], start[2 * LANES + n], start[3 * LANES + n])
        q = quat_unit(quat_mul(q0, small_turn(lane3(z, 6, n))))
        start[n] = q[0]
        put3(start, 1, n, (q[1], q[2], q[3]))


def new_scratch() -> Scratch:
    """Arrays of one block of runs."""
    rows = (MOTION, MOTION, MOTION, MOTION, 4, 3, 3, 15)
    return Scratch(*(np.zeros(n * LANES) for n in rows))
