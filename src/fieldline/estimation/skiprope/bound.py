"""How well any unbiased estimator could do: the Cramer-Rao bound of cone and frequency from the geometry of the field.

With white noise of deviation s on each axis of the magnetometer, two numbers of a sample across the known direction b = B / |B|
tell of the small rotation theta = (a1, a2, 0) + slow part + other lines,

    J = sum_k (|B_k| / s)^2 H_k' (1 - b b') H_k,     H_k = d(-theta x b) / d(unknowns),     covariance >= J^-1       (1)

The unknowns: phasors z1, z2 and frequency of the cone at the record's middle; for each other line its phasors and frequency; and
the slow part, a rotation of Legendre polynomials over the record that stands for bias, yaw and what the known field's direction
is off. None of them is known beforehand, so that a bound with more of them is larger. A slow part of degree zero is the bound for
a perfect model of the field.

Digits count as white noise of a twelfth of their square.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fieldline.errors import InputError
from fieldline.estimation.skiprope.bandpass import positive
from fieldline.estimation.skiprope.numbers import derived
from fieldline.estimation.skiprope.signals import FieldGeometry, field_vector

TURN = 2.0 * np.pi


class Bound(NamedTuple):
    """Least standard deviations of any unbiased estimator that hears the whole record."""

    amplitude_rad: float  # of the round part, RMS over the record
    phase_rad: float
    plane_rad: float  # of the tether's azimuth, without that of yaw and azimuth of the known field
    frequency_hz: float
    covariance: np.ndarray  # (5, 5) of Re z1, Im z1, Re z2, Im z2 [rad] and w [rad/s] at the record's middle


def cramer_rao(
    seconds,
    geometry: FieldGeometry,
    phasor,
    frequency_hz: float,
    *,
    noise_tesla: float,
    digit_tesla: float = 0.0,
    slow_degree: int = 0,
    other_lines=(),
) -> Bound:
    """Equation (1).

    Parameters
    ----------
    seconds : (n,) [s]. geometry : the true field's, (n,) each.
    phasor : (z1, z2), complex [rad], of the cone at the middle of the record. frequency_hz : positive.
    noise_tesla : white, per axis and sample. digit_tesla : of the reading, 0 for none.
    slow_degree : of the slow rotation. other_lines : of (frequency [Hz], z1, z2) each.
    """
    times = np.asarray(seconds, dtype=float)
    middle = 0.5 * (times[0] + times[-1])
    noise = np.hypot(float(noise_tesla), float(digit_tesla) / np.sqrt(12.0))
    if not noise > 0.0 or slow_degree < 0:
        raise InputError(
            f"noise_tesla or digit_tesla must be positive, slow_degree 0 or more; got {noise_tesla!r}, {slow_degree!r}."
        )
    t = times - middle
    lines = [(positive("frequency_hz", frequency_hz), *(complex(z) for z in phasor)), *other_lines]
    shapes = [shape for hz, z1, z2 in lines for shape in _line(t, hz, (z1, z2))]
    shapes += _slow(t, slow_degree)
    known = field_vector(geometry)
    size = np.linalg.norm(known, axis=1)
    unit = known / size[:, None]
    rotation = np.stack(shapes, axis=-1)  # (n, 3, unknowns)
    seen = np.cross(unit[:, None, :], rotation.transpose(0, 2, 1)).transpose(0, 2, 1)
    scale = np.sqrt(np.mean(np.sum(seen**2, axis=1), axis=0)) + 1e-300
    rows = (seen / scale * (size / noise)[:, None, None]).reshape(-1, len(shapes))
    covariance = np.linalg.pinv(rows.T @ rows, rcond=1e-14, hermitian=True) / np.outer(scale, scale)
    covariance = covariance[:5, :5]
    return Bound(*_deviations(t, lines[0], covariance), covariance)


def _line(t, hz: float, z) -> list[np.ndarray]:
    """Rotations (n, 3) by Re z1, Im z1, Re z2, Im z2 and w."""
    turn = np.exp(1j * TURN * hz * t)
    none = np.zeros_like(t)
    out = [np.stack([turn.real, none, none], axis=1), np.stack([-turn.imag, none, none], axis=1)]
    out += [np.stack([none, turn.real, none], axis=1), np.stack([none, -turn.imag, none], axis=1)]
    by_w = [np.real(1j * t * part * turn) for part in z]
    return [*out, np.stack([*by_w, none], axis=1)]


def _slow(t, degree: int) -> list[np.ndarray]:
    """Rotations (n, 3) by each Legendre polynomial about each axis."""
    from numpy.polynomial.legendre import legvander

    shapes = legvander(t / max(abs(t[0]), 1e-300), degree)
    return [np.outer(shape, axis) for shape in shapes.T for axis in np.eye(3)]


def _deviations(t, line, covariance) -> tuple[float, float, float, float]:
    """RMS deviations over the record of amplitude, phase and plane, and that of the frequency [Hz]."""
    hz, z1, z2 = line
    when = t[:: max(len(t) // 500, 1)]
    turn = np.exp(1j * TURN * hz * when)
    phasor = np.stack([z1 * turn, z2 * turn], axis=1)
    carry = np.zeros((len(when), 4, 5))
    for k in (0, 2):
        carry[:, k, k] = carry[:, k + 1, k + 1] = turn.real
        carry[:, k, k + 1], carry[:, k + 1, k] = -turn.imag, turn.imag
        by_w = 1j * when * phasor[:, k // 2]
        carry[:, k, 4], carry[:, k + 1, 4] = by_w.real, by_w.imag
    spread = carry @ covariance @ carry.transpose(0, 2, 1)
    none = np.zeros(len(when))
    numbers = derived(phasor, spread, none.astype(int), none, none, np.pi)
    names = ("amplitude_std_rad", "phase_std_rad", "plane_std_rad")
    amplitude, phase, plane = (float(np.sqrt(np.mean(numbers[name] ** 2))) for name in names)
    return amplitude, phase, plane, float(np.sqrt(covariance[4, 4])) / TURN
