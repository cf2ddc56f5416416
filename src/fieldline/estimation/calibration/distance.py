"""The distances (4) of `model` and their derivatives (6), compiled: one pass over the samples, nothing stored but sums.

A sample touches the terms that all share and four coefficients of its flight's spline. Its products are therefore gathered
in a small square, which is added to the whole matrix when the spline's interval changes: time is linear in the samples,
memory does not grow with them, and no thread waits for another.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from fieldline.estimation.calibration.arrow import Arrow, empty_arrow
from fieldline.estimation.calibration.model import TINY, Samples, Terms
from fieldline.estimation.calibration.spline import basis_at
from fieldline.frames.matrices import matvec
from fieldline.frames.vectors import axpy, dot, norm, scale, vec

ABSENT = -1
MAGNITUDE, SECONDS, FLIGHT, COLUMNS = 3, 4, 5, 6  # places in a row of the table; the reading comes first, columns last


class Form(NamedTuple):
    """Number of each term's first parameter, ABSENT without it, and where in the table its column begins.

    `matrix_size`: how many numbers D has; `on_field`: whether the gain is that of the field without the bias.
    """

    bias: int
    matrix: int
    matrix_size: int
    gain: int
    on_field: bool
    temperature: int
    drift: int
    dipole: int
    current: int
    sunlit: int
    temperature_column: int
    drift_column: int
    dipole_column: int
    current_column: int
    sunlit_column: int


class Problem(NamedTuple):
    """What the kernels need besides the parameters.

    `table` (n, 6 and more): reading, magnitude, seconds, flight, columns of the terms; `splines` (flights, 4): start, spacing,
    intervals, first parameter. The arrays go to the kernels one by one: a tuple of arrays is counted at every call.
    """

    table: np.ndarray
    splines: np.ndarray
    form: Form


def problem_of(terms: Terms, samples: Samples) -> Problem:
    """The candidate and its samples as kernels take them."""
    columns = {
        "temperature": samples.temperature, "drift": samples.arc, "dipole": samples.dipole,
        "current": samples.current, "sunlit": samples.sunlit,
    }  # fmt: skip
    used = {name: column.reshape(len(samples), -1) for name, column in columns.items() if getattr(terms, name)}
    width, at = COLUMNS, []
    for name in columns:
        at.append(width if name in used else ABSENT)
        width += used[name].shape[1] if name in used else 0
    table = np.empty((len(samples), width))
    table[:, :3], table[:, MAGNITUDE], table[:, SECONDS] = samples.field_s, samples.magnitude, samples.seconds
    table[:, FLIGHT] = samples.flight
    for start, name in zip(at, columns, strict=True):
        if name in used:
            table[:, start : start + used[name].shape[1]] = used[name]
    first = {name: place.start for name, place in terms.layout.items()}
    place = lambda name: first.get(name, ABSENT)
    size = {"none": 0, "scale": 1, "full": 6}[terms.matrix]
    form = Form(
        place("bias"), place("matrix"), size, place("gain"), terms.gain == "field", *[place(name) for name in columns], *at
    )
    splines = [(one.start_s, one.spacing_s, one.intervals, terms.gain_slice(k).start) for k, one in enumerate(terms.splines)]
    return Problem(table, np.array(splines if "gain" in first else [], dtype=float).reshape(-1, 4), form)


def matrix9(terms: Terms, theta: np.ndarray) -> tuple[float, ...]:
    """D, row by row."""
    return tuple(terms.matrix_of(theta).ravel().tolist())


def distances(terms: Terms, theta: np.ndarray, samples: Samples) -> np.ndarray:
    """(n,) equation (4) over all samples, flight after flight."""
    out = np.empty(len(samples))
    distance_kernel(theta, matrix9(terms, theta), *problem_of(terms, samples), out)
    return out


@njit(cache=True)
def undisturbed(k, theta, table, splines, form):
    """w of equation (1), the gain, and the gain's first parameter and weights, of sample k."""
    gain, first, weights = 1.0, ABSENT, (0.0, 0.0, 0.0, 0.0)
    if form.gain >= 0:
        flight = int(table[k, FLIGHT])
        place = (table[k, SECONDS] - splines[flight, 0]) / splines[flight, 1]
        first, weights = basis_at(place, int(splines[flight, 2]))
        first += int(splines[flight, 3])
        gain += weights[0] * theta[first] + weights[1] * theta[first + 1]
        gain += weights[2] * theta[first + 2] + weights[3] * theta[first + 3]
    if form.temperature >= 0:
        gain += theta[form.temperature] * table[k, form.temperature_column]
    w = vec(table, k)
    if not form.on_field:
        w = scale(gain, w)
    if form.bias >= 0:
        w = axpy(-1.0, three(theta, form.bias), w)
    if form.drift >= 0:
        w = axpy(-table[k, form.drift_column], three(theta, form.drift), w)
    if form.dipole >= 0:
        d, c = three(table[k], form.dipole_column), form.dipole
        w = axpy(-1.0, (dot(three(theta, c), d), dot(three(theta, c + 3), d), dot(three(theta, c + 6), d)), w)
    if form.current >= 0:
        w = axpy(-table[k, form.current_column], three(theta, form.current), w)
    if form.sunlit >= 0:
        w = axpy(-table[k, form.sunlit_column], three(theta, form.sunlit), w)
    return w, gain, first, weights


@njit(cache=True)
def three(values, start):
    """Three numbers as a vector."""
    return values[start], values[start + 1], values[start + 2]


@njit(cache=True)
def distance_kernel(theta, matrix, table, splines, form, out):
    """Equation (4) of every sample; TINY keeps a reading of nothing finite."""
    for k in range(len(out)):
        w, gain, _, _ = undisturbed(k, theta, table, splines, form)
        field_b = matvec(matrix, w)
        if form.on_field:
            field_b = scale(gain, field_b)
        length = norm(field_b)
        v = matvec(matrix, scale(1.0 / max(length, TINY), field_b))
        out[k] = (length - table[k, MAGNITUDE]) / max(norm(v), TINY)


@njit(cache=True)
def row_at(k, theta, matrix, table, splines, form, row):
    """Distance of sample k and the first parameter of its gain; the derivatives (6) go to `row`, the gain's four last."""
    w, gain, first, weights = undisturbed(k, theta, table, splines, form)
    outer = gain if form.on_field else 1.0
    field_b = scale(outer, matvec(matrix, w))
    length = max(norm(field_b), TINY)
    u = scale(1.0 / length, field_b)
    v = matvec(matrix, u)
    stretch = max(norm(v), TINY)
    distance = (length - table[k, MAGNITUDE]) / stretch
    turning = scale(1.0 / (stretch * length), matvec(matrix, v))
    turning = axpy(-dot(turning, u), u, turning)
    a = scale(1.0 / stretch, axpy(-distance, turning, u))
    inner = matvec(matrix, a)
    to_offset = scale(-outer, inner)
    if form.bias >= 0:
        put_scaled(row, form.bias, 1.0, to_offset)
    if form.matrix >= 0:
        s, t = scale(outer, w), scale(-distance / stretch**2, v)
        xx, yy, zz = a[0] * s[0] + t[0] * u[0], a[1] * s[1] + t[1] * u[1], a[2] * s[2] + t[2] * u[2]
        if form.matrix_size == 1:
            row[form.matrix] = xx + yy + zz
        else:
            row[form.matrix], row[form.matrix + 1], row[form.matrix + 2] = xx, yy, zz
            row[form.matrix + 3] = a[0] * s[1] + t[0] * u[1] + a[1] * s[0] + t[1] * u[0]
            row[form.matrix + 4] = a[0] * s[2] + t[0] * u[2] + a[2] * s[0] + t[2] * u[0]
            row[form.matrix + 5] = a[1] * s[2] + t[1] * u[2] + a[2] * s[1] + t[2] * u[1]
    along = dot(inner, w if form.on_field else vec(table, k))
    if form.temperature >= 0:
        row[form.temperature] = along * table[k, form.temperature_column]
    if form.drift >= 0:
        put_scaled(row, form.drift, table[k, form.drift_column], to_offset)
    if form.dipole >= 0:
        for i in range(3):
            put_scaled(row, form.dipole + 3 * i, to_offset[i], three(table[k], form.dipole_column))
    if form.current >= 0:
        put_scaled(row, form.current, table[k, form.current_column], to_offset)
    if form.sunlit >= 0:
        put_scaled(row, form.sunlit, table[k, form.sunlit_column], to_offset)
    if form.gain >= 0:
        for j in range(4):
            row[form.gain + j] = along * weights[j]
    return distance, first


@njit(cache=True)
def put_scaled(row, start, factor, v):
    """Three numbers of a row."""
    for i in range(3):
        row[start + i] = factor * v[i]


@njit(cache=True)
def place_of(a, shared, first):
    """Parameter that entry `a` of a row belongs to."""
    return a if a < shared else first + a - shared


@njit(cache=True)
def shared_size(form, parameters):
    """How many parameters every sample touches; a row has four more where there is a gain."""
    return form.gain if form.gain >= 0 else parameters


def information_of(
    terms: Terms, theta: np.ndarray, samples: Samples, sigma: float, degrees: float, squared: bool = False
) -> tuple[Arrow, np.ndarray]:
    """Sum f J J^T and sum weight J d / sigma^2; f and weight as of `information_kernel`."""
    shared = terms.layout["gain"].start if "gain" in terms.layout else terms.size
    total, gradient = empty_arrow(shared, terms.size - shared), np.zeros(terms.size)
    information_kernel(theta, matrix9(terms, theta), *problem_of(terms, samples), sigma, degrees, squared, *total, gradient)
    return total, gradient


@njit(cache=True)
def information_kernel(
    theta, matrix, table, splines, form, sigma, degrees, squared, shared_total, coupling_total, band_total, gradient
):
    """Adds sum f J J^T to the parts of an `Arrow` and sum weight J d / sigma^2 to `gradient`.

    f is weight / sigma^2, or with `squared` (weight d / sigma^2)^2; weight that of Student's t with `degrees`.
    """
    shared = len(shared_total)
    size = shared + (4 if form.gain >= 0 else 0)
    row, square, sums, held = np.empty(size), np.zeros((size, size)), np.zeros(size), ABSENT
    for k in range(len(table)):
        distance, first = row_at(k, theta, matrix, table, splines, form, row)
        if first != held:
            if held >= 0:
                spill(square, sums, shared, held, shared_total, coupling_total, band_total, gradient)
            held = first
        weight = (degrees + 1.0) / (degrees + (distance / sigma) ** 2) / sigma**2
        factor = (weight * distance) ** 2 if squared else weight
        for a in range(size):
            scaled = factor * row[a]
            for b in range(a + 1):
                square[a, b] += scaled * row[b]
            sums[a] += weight * distance * row[a]
    spill(square, sums, shared, held, shared_total, coupling_total, band_total, gradient)


@njit(cache=True)
def spill(square, sums, shared, first, shared_total, coupling_total, band_total, gradient):
    """Moves what was gathered over one interval of the spline to its place."""
    for a in range(len(sums)):
        gradient[place_of(a, shared, first)] += sums[a]
        sums[a] = 0.0
        for b in range(a + 1):
            if a < shared:
                shared_total[a, b] += square[a, b]
            elif b < shared:
                coupling_total[first - shared + a - shared, b] += square[a, b]
            else:
                band_total[first - shared + a - shared, a - b] += square[a, b]
            square[a, b] = 0.0


@njit(cache=True)
def block_kernel(theta, matrix, table, splines, form, sigma, degrees, error, length, total):
    """Adds sum_blocks s s^T to `total` (lower half), s: sum over a block's samples of weight J d / sigma^2.

    A block has `length` samples of one flight; a finite `error` stands in the place of d.
    """
    shared = shared_size(form, len(theta))
    size = shared + (4 if form.gain >= 0 else 0)
    row, sums, low, high, inside = np.empty(size), np.zeros(len(theta)), len(theta), 0, 0
    n = len(table)
    for k in range(n):
        distance, first = row_at(k, theta, matrix, table, splines, form, row)
        weight = (degrees + 1.0) / (degrees + (distance / sigma) ** 2) / sigma**2
        score = weight * (error if np.isfinite(error) else distance)
        for a in range(size):
            sums[place_of(a, shared, first)] += score * row[a]
        if size > shared:
            low, high = min(low, first), max(high, first + 4)
        inside += 1
        if inside == length or k == n - 1 or table[k + 1, FLIGHT] != table[k, FLIGHT]:
            add_square(sums, shared, low, high, total)
            low, high, inside = len(theta), 0, 0


@njit(cache=True)
def add_square(sums, shared, low, high, total):
    """Adds s s^T over the shared parameters and those from `low` to `high`, and clears s."""
    count = shared + max(high - low, 0)
    for a in range(count):
        i = place_of(a, shared, low)
        for b in range(a + 1):
            total[i, place_of(b, shared, low)] += sums[i] * sums[place_of(b, shared, low)]
    for a in range(count):
        sums[place_of(a, shared, low)] = 0.0


def mirrored_half(lower: np.ndarray) -> np.ndarray:
    """The symmetric matrix whose lower half was summed."""
    return lower + np.tril(lower, -1).T
