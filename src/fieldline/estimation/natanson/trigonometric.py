"""Common roots of two quadratics whose coefficients are trigonometric polynomials of an angle.

    a_0(Phi) + a_1(Phi) x + a_2(Phi) x^2 = 0,     b_0(Phi) + b_1(Phi) x + b_2(Phi) x^2 = 0                (1)

have a common x where  R(Phi) = (a_2 b_0 - a_0 b_2)^2 - (a_2 b_1 - a_1 b_2)(a_1 b_0 - a_0 b_1)  vanishes. If a_k and b_k
have degree 3 - k, R has degree 8: with z = exp(i Phi), z^8 R is a polynomial of degree 16, whose roots are the eigenvalues
of its companion matrix. Real angles are the roots with |z| = 1; the others come in pairs z, 1/conj(z).

Where a_2, b_1 and b_2 all vanish (a spherical body), R is zero for any angle, and b_0 = 0 alone gives the angles; it is
then multiplied by (2 + cos Phi)^5, which has no real root, to be of degree 8 like the rest.

Coefficients enter as samples at equally spaced angles; a discrete Fourier transform makes them exact polynomials.
Source of the resultant: Sylvester; any algebra text. All functions work on n problems at once.
"""

from __future__ import annotations

import numpy as np

DEGREE = 3
RESULTANT_DEGREE = 8
WAVES = np.arange(-DEGREE, DEGREE + 1)
NEAR_CIRCLE = 0.05  # |log|z|| of candidates; a double root splits off the circle by the square root of rounding
RESIDUAL = 1e-9  # of (1), relative to the size of its terms, after refinement
SAME = 1e-6  # two candidates nearer than this [rad] are one root


def common_roots(first, other) -> tuple[np.ndarray, np.ndarray]:
    """Angles in 0..2 pi and x, (n, m) each, of all real common roots of (1), sorted by angle and padded with NaN.

    first, other : (n, 3, s) samples of a_0, a_1, a_2 and b_0, b_1, b_2 at s >= 8 equally spaced angles from 0.
    """
    a, b = fourier(first), fourier(other)
    angle = resultant_angles(a, b)
    x = _shared_unknown(evaluate(a, angle), evaluate(b, angle))
    angle, x, worst = _refine(a, b, angle, x)
    angle = np.where(worst < RESIDUAL, np.mod(angle, 2.0 * np.pi), np.nan)
    return _distinct(angle, x)


def fourier(samples) -> np.ndarray:
    """(n, 3, 7) Fourier coefficients of waves -3..3 from (n, 3, s) samples."""
    return np.fft.fft(samples, axis=-1)[..., WAVES] / samples.shape[-1]


def evaluate(coefficients, angle, derivative: bool = False) -> np.ndarray:
    """(n, 3, m) real values at angles (n, m), or derivatives with respect to the angle."""
    waves = np.exp(1j * angle[:, :, None] * WAVES)
    if derivative:
        waves = waves * (1j * WAVES)
    return np.einsum("nkw,nmw->nkm", coefficients, waves).real


def resultant_angles(a, b) -> np.ndarray:
    """(n, 16) angles of the resultant's roots near the unit circle, NaN for the others."""
    grid = 2.0 * np.pi * np.arange(32) / 32
    at_a, at_b = (evaluate(c, np.tile(grid, (len(c), 1))) for c in (a, b))
    values = np.where(_is_linear(a, b)[:, None], at_b[:, 0] * (2.0 + np.cos(grid)) ** 5, _resultant(at_a, at_b))
    waves = np.fft.fft(values, axis=-1)[:, np.arange(-RESULTANT_DEGREE, RESULTANT_DEGREE + 1)]
    z = _polynomial_roots(waves)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(np.abs(np.log(np.abs(z))) < NEAR_CIRCLE, np.angle(z), np.nan)


def _is_linear(a, b) -> np.ndarray:
    """(n,) whether the first equation is linear in x and the other free of it, to rounding."""
    size_a, size_b = (np.abs(c).sum(axis=-1) for c in (a, b))
    return np.maximum(size_a[:, 2], np.maximum(size_b[:, 1], size_b[:, 2])) < 1e-11 * size_a[:, 1]


def _resultant(a, b) -> np.ndarray:
    """R of the values a_k, b_k (n, 3, m)."""
    outer = a[:, 2] * b[:, 0] - a[:, 0] * b[:, 2]
    upper = a[:, 2] * b[:, 1] - a[:, 1] * b[:, 2]
    lower = a[:, 1] * b[:, 0] - a[:, 0] * b[:, 1]
    return outer**2 - upper * lower


def _polynomial_roots(rising) -> np.ndarray:
    """(n, d) roots of polynomials with coefficients (n, d + 1) of rising powers, by companion eigenvalues.

    Numpy's eigenvalue routine balances the matrix. The first and last coefficients are conjugate here and so equal in
    size; where both vanish the degree is lower, and a touch of rounding keeps the companion finite: roots at 0 and
    infinity then come out as such, far from the unit circle.
    """
    count, degree = rising.shape[0], rising.shape[1] - 1
    largest = np.abs(rising).max(axis=1)
    lead = np.where(np.abs(rising[:, -1]) > 1e-18 * largest, rising[:, -1], 1e-18 * np.maximum(largest, 1e-300))
    companion = np.zeros((count, degree, degree), dtype=complex)
    companion[:, np.arange(1, degree), np.arange(degree - 1)] = 1.0
    companion[:, :, -1] = -rising[:, :-1] / lead[:, None]
    return np.linalg.eigvals(companion)


def _shared_unknown(a, b) -> np.ndarray:
    """X common to both quadratics (n, 3, m) -> (n, m): from the difference that is free of x^2, or from a linear one."""
    upper = a[:, 2] * b[:, 1] - a[:, 1] * b[:, 2]
    outer = a[:, 2] * b[:, 0] - a[:, 0] * b[:, 2]
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(np.abs(upper) > 1e-11 * a[:, 1] ** 2, -outer / upper, -a[:, 0] / a[:, 1])


def _refine(a, b, angle, x, rounds: int = 12):
    """Newton's rule on (1) in both unknowns; returns angle, x and the residual relative to the size of the terms."""
    for _ in range(rounds):
        values, slopes = (evaluate(a, angle), evaluate(b, angle)), (evaluate(a, angle, True), evaluate(b, angle, True))
        powers = np.stack([np.ones_like(x), x, x * x], axis=1)
        rise = np.stack([np.zeros_like(x), np.ones_like(x), 2.0 * x], axis=1)
        (f, g), (f_x, g_x) = (np.sum(v * powers, axis=1) for v in values), (np.sum(v * rise, axis=1) for v in values)
        f_angle, g_angle = (np.sum(v * powers, axis=1) for v in slopes)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            determinant = f_angle * g_x - g_angle * f_x
            angle_step = (f * g_x - g * f_x) / determinant
            angle = angle - np.clip(angle_step, -0.1, 0.1)
            x = x - (f_angle * g - g_angle * f) / determinant
    return angle, x, _relative_residual(a, b, angle, x)


def _relative_residual(a, b, angle, x) -> np.ndarray:
    """(n, m): the larger of both equations' residuals, over the sum of the sizes of their terms."""
    powers = np.stack([np.ones_like(x), x, x * x], axis=1)
    worst = np.zeros_like(x)
    for coefficients in (a, b):
        terms = evaluate(coefficients, angle) * powers
        size = np.sum(np.abs(coefficients).sum(axis=-1)[:, :, None] * np.abs(powers), axis=1)
        with np.errstate(invalid="ignore"):
            worst = np.maximum(worst, np.abs(np.sum(terms, axis=1)) / size)
    return np.where(np.isfinite(worst), worst, np.inf)


def _distinct(angle, x) -> tuple[np.ndarray, np.ndarray]:
    """Sort by angle, drop what Newton's rule brought together, and cut the columns to the most that any row has."""
    order = np.argsort(angle, axis=1)
    angle, x = np.take_along_axis(angle, order, axis=1), np.take_along_axis(x, order, axis=1)
    with np.errstate(invalid="ignore"):
        again = np.diff(angle, axis=1, prepend=-1.0) < SAME
    angle = np.where(again, np.nan, angle)
    x = np.where(np.isnan(angle), np.nan, x)
    order = np.argsort(angle, axis=1)
    angle, x = np.take_along_axis(angle, order, axis=1), np.take_along_axis(x, order, axis=1)
    most = max(1, int(np.isfinite(angle).sum(axis=1).max(initial=0)))
    return angle[:, :most], x[:, :most]
