"""A field's first two time derivatives from samples: differences, local polynomials, smoothing spline.

All three are linear in the samples and, inside the arc, shift-invariant, so that each has an error that can be told
beforehand from the noise, the step and the speed at which the field turns:

    noise:  std of the k-th derivative = sigma * |c|               for weights c of a stencil                  (1)
    bias:   |sum c_j t_j^p| / p! * |B| w^p                         the first power p that c does not treat exactly (2)

for a field of magnitude |B| that turns at w rad/s. Central differences over three points have |c| = 1/(sqrt 2 h) and
sqrt 6 / h^2, and biases |B| w^3 h^2 / 6 and |B| w^4 h^2 / 12; over five points sqrt(130)/(12 h), sqrt(1414)/(12 h^2),
|B| w^5 h^4 / 30 and |B| w^6 h^4 / 90. A digitised field has sigma = (digit)/sqrt 12, true while it moves several digits
within the window; where it rests on one digit no filter can tell its derivative.

Use the same filter for the body and the inertial field: most of the bias then cancels in the attitude, so that longer
windows than those of least derivative error still gain.

Sources: Savitzky and Golay (1964), Anal. Chem. 36:1627; Silverman (1984), Ann. Stat. 12:898 (equivalent kernel).
"""

from __future__ import annotations

from math import factorial
from typing import NamedTuple

import numpy as np

from fieldline.errors import InputError

CENTRAL = {  # weights for (first, second) derivative at unit step
    3: (np.array([-0.5, 0.0, 0.5]), np.array([1.0, -2.0, 1.0])),
    5: (np.array([1.0, -8.0, 0.0, 8.0, -1.0]) / 12.0, np.array([-1.0, 16.0, -30.0, 16.0, -1.0]) / 12.0),
}


class Derivatives(NamedTuple):
    """A field and its derivatives at n samples; NaN rows where the stencil leaves the data."""

    value: np.ndarray  # (n, 3) [T]
    first: np.ndarray  # (n, 3) [T/s]
    second: np.ndarray  # (n, 3) [T/s^2]


class ExpectedError(NamedTuple):
    """One-sigma error per axis of a derivative: (first [T/s], second [T/s^2])."""

    noise: tuple[float, float]
    bias: tuple[float, float]

    @property
    def total(self) -> tuple[float, float]:
        """Noise and bias as independent."""
        return (float(np.hypot(self.noise[0], self.bias[0])), float(np.hypot(self.noise[1], self.bias[1])))


def seen_in_body(derivatives_i: Derivatives, dcm_bi, omega_b, omega_rate_b=0.0) -> Derivatives:
    """The derivatives in body axes of a field known in inertial axes: (2-1b) and (3-1) solved for them.

    dcm_bi (..., 3, 3); omega_b (..., 3) [rad/s]; omega_rate_b (..., 3) [rad/s^2].
    """
    value, first, second = (np.einsum("...ij,...j->...i", dcm_bi, x) for x in derivatives_i)
    omega = np.asarray(omega_b, dtype=float)
    first_b = first - np.cross(omega, value)
    acceleration = np.cross(np.broadcast_to(omega_rate_b, value.shape), value)
    return Derivatives(value, first_b, second - np.cross(omega, first) - np.cross(omega, first_b) - acceleration)


def finite_differences(seconds, field, *, step_samples: int = 1, points: int = 3) -> Derivatives:
    """Central differences over 3 or 5 points that lie `step_samples` samples apart; (n,) [s] equally spaced, (n, 3) [T]."""
    if points not in CENTRAL:
        raise InputError(f"points must be 3 or 5; got {points}.")
    times, values = _checked(seconds, field)
    interval = _interval(times)
    if step_samples != int(step_samples) or step_samples < 1:
        raise InputError(f"step_samples must be a whole number of samples, 1 or more; got {step_samples}.")
    first, second = CENTRAL[points]
    offsets = int(step_samples) * (np.arange(points) - points // 2)
    step = float(step_samples) * interval
    return Derivatives(values, _stencil(values, offsets, first / step), _stencil(values, offsets, second / step**2))


def local_polynomial(seconds, field, *, window_s: float, order: int = 4, at=None) -> Derivatives:
    """Savitzky-Golay: value and derivatives of the least-squares polynomial over `window_s`, centred on each sample.

    Times need not be equally spaced; a window that is not filled to both ends, or to half of its samples, gives NaN.
    `at` (m,) names the samples wanted, and the result has m rows: for long records, of which a few epochs will do.
    """
    times, values = _checked(seconds, field)
    interval = float(np.median(np.diff(times)))
    half = int(np.floor(0.5 * window_s / interval + 1e-9))
    if order < 2 or 2 * half + 1 <= order:
        raise InputError(
            f"a window of {window_s:g} s holds {2 * half + 1} samples, too few for a polynomial of order {order} with a "
            "second derivative; lengthen window_s."
        )
    wanted = np.arange(times.size) if at is None else np.asarray(at, dtype=int)
    if not _is_uniform(times):
        return _local_fits(times, values, wanted, half * interval, interval, order)
    offsets = np.arange(-half, half + 1)
    weights = polynomial_weights(offsets * interval, order)
    if at is None:
        return Derivatives(*(_stencil(values, offsets, w) for w in weights))
    return _stencils_at(values, wanted, offsets, weights)


def smoothing_spline(seconds, field, *, cutoff_rad_s: float) -> Derivatives:
    """Spline of degree five that minimises sum |y - s|^2 + mu int |s'''|^2 dt, at every sample.

    Away from the ends it is the low-pass H(w) = 1 / (1 + (w/w_c)^6) with w_c = cutoff_rad_s = (interval * mu)^(-1/6).
    Within 3/w_c of an end it rests on half the data: those rows are NaN. The bias of the ends fades as exp(-w_c t/2), so that
    the expected error of `spline_error` holds from about 8/w_c inwards.
    """
    from scipy.interpolate import BSpline
    from scipy.sparse.linalg import splu

    times, values = _checked(seconds, field)
    interval = float(np.median(np.diff(times)))
    reach = 3.0 / cutoff_rad_s
    span = times[-1] - times[0]
    if not 0.0 < cutoff_rad_s or span < 2.0 * reach:
        raise InputError(
            f"the arc of {span:g} s is shorter than the smoothing spline's reach, {2.0 * reach:g} s; raise cutoff_rad_s."
        )
    unit = 1.0 / cutoff_rad_s  # time in units of 1/w_c keeps the normal equations in scale
    cells = max(8, int(np.ceil(span / min(max(interval, unit / 3.0), span / 8.0))))
    inner = np.linspace(times[0], times[-1], cells + 1) / unit
    knots = np.concatenate([np.repeat(inner[0], 5), inner, np.repeat(inner[-1], 5)])
    design = BSpline.design_matrix(np.clip(times / unit, inner[0], inner[-1]), knots, 5).tocsc()
    normal = design.T @ design + (unit / interval) * _third_derivative_penalty(knots, inner)
    spline = BSpline(knots, splu(normal.tocsc()).solve(design.T @ values), 5)
    rows = [spline.derivative(k)(times / unit) / unit**k if k else spline(times / unit) for k in range(3)]
    ends = (times < times[0] + reach) | (times > times[-1] - reach)
    for row in rows:
        row[ends] = np.nan
    return Derivatives(*rows)


def polynomial_weights(offsets_s, order: int) -> np.ndarray:
    """(3, m) weights of value, first and second derivative at 0 of the least-squares polynomial on m offsets [s]."""
    reach = float(np.abs(offsets_s).max())
    powers = np.vander(np.asarray(offsets_s) / reach, order + 1, increasing=True)
    fit = np.linalg.pinv(powers)[:3]
    return fit * np.array([1.0, 1.0 / reach, 2.0 / reach**2])[:, None]


def difference_error(step_s, noise_tesla, magnitude_tesla, turn_rad_s, points: int = 3) -> ExpectedError:
    """Expected error (1), (2) of `finite_differences` for white noise [T] per sample and axis."""
    first, second = CENTRAL[points]
    offsets = step_s * (np.arange(points) - points // 2)
    weights = (first / step_s, second / step_s**2)
    return _stencil_error(weights, offsets, noise_tesla, magnitude_tesla, turn_rad_s)


def polynomial_error(window_s, interval_s, noise_tesla, magnitude_tesla, turn_rad_s, order: int = 4) -> ExpectedError:
    """Expected error (1), (2) of `local_polynomial` for white noise [T] per sample and axis."""
    half = int(np.floor(0.5 * window_s / interval_s + 1e-9))
    offsets = interval_s * np.arange(-half, half + 1)
    weights = polynomial_weights(offsets, order)[1:]
    return _stencil_error(tuple(weights), offsets, noise_tesla, magnitude_tesla, turn_rad_s)


def spline_error(cutoff_rad_s, interval_s, noise_tesla, magnitude_tesla, turn_rad_s) -> ExpectedError:
    """Expected error of `smoothing_spline` away from the ends, from its equivalent low-pass H.

    noise^2 = sigma^2 interval / pi * int_0^inf w^2k H^2 dw = sigma^2 interval w_c^(2k+1) / pi * J_k          (3)
    bias = |B| w^k (1 - H(w)),      J_k = B(a, 2 - a) / 6,  a = (2k + 1)/6
    """
    from scipy.special import beta

    noise, bias = [], []
    for k in (1, 2):
        a = (2 * k + 1) / 6.0
        noise.append(noise_tesla * np.sqrt(interval_s * cutoff_rad_s ** (2 * k + 1) / np.pi * beta(a, 2.0 - a) / 6.0))
        ratio = (turn_rad_s / cutoff_rad_s) ** 6
        bias.append(magnitude_tesla * turn_rad_s**k * ratio / (1.0 + ratio))
    return ExpectedError((float(noise[0]), float(noise[1])), (float(bias[0]), float(bias[1])))


def best_step_samples(interval_s, noise_tesla, magnitude_tesla, turn_rad_s, points=3, longest_s=600.0) -> int:
    """The step, in samples, with the least expected error of the second derivative by differences."""
    steps = np.arange(1, max(1, int(longest_s / interval_s)) + 1)
    errors = [difference_error(n * interval_s, noise_tesla, magnitude_tesla, turn_rad_s, points).total[1] for n in steps]
    return int(steps[int(np.argmin(errors))])


def best_window_s(interval_s, noise_tesla, magnitude_tesla, turn_rad_s, order=4, longest_s=1200.0) -> float:
    """The window [s] with the least expected error of the second derivative by local polynomials."""
    shortest, longest = order // 2 + 1, max(order // 2 + 1, int(0.5 * longest_s / interval_s))
    halves = np.unique(np.geomspace(shortest, longest, 60).astype(int))
    windows = 2.0 * halves * interval_s
    errors = [polynomial_error(w, interval_s, noise_tesla, magnitude_tesla, turn_rad_s, order).total[1] for w in windows]
    return float(windows[int(np.argmin(errors))])


def best_cutoff_rad_s(interval_s, noise_tesla, magnitude_tesla, turn_rad_s) -> float:
    """The spline's cutoff with the least expected error of the second derivative."""
    cutoffs = turn_rad_s * np.geomspace(1.0, 100.0, 200)
    cutoffs = cutoffs[cutoffs < np.pi / interval_s] if turn_rad_s < np.pi / interval_s else cutoffs[:1]
    errors = [spline_error(c, interval_s, noise_tesla, magnitude_tesla, turn_rad_s).total[1] for c in cutoffs]
    return float(cutoffs[int(np.argmin(errors))])


def _stencil_error(weights, offsets, noise, magnitude, turn) -> ExpectedError:
    """(1) and (2) for weights of the first and second derivative on offsets [s]."""
    gains, biases = [], []
    for k, row in enumerate(weights, start=1):
        gains.append(float(noise * np.linalg.norm(row)))
        biases.append(float(magnitude * _moment(row, offsets, turn, k)))
    return ExpectedError((gains[0], gains[1]), (biases[0], biases[1]))


def _moment(weights, offsets, turn, k) -> float:
    """|sum c t^p| w^p / p! of the lowest power p > k of k's parity that is not treated exactly."""
    for power in range(k + 2, 40, 2):
        terms = weights * offsets**power
        if abs(terms.sum()) > 1e-9 * np.abs(terms).sum():
            return abs(terms.sum()) * turn**power / factorial(power)
    return 0.0


def _stencil(values, offsets, weights) -> np.ndarray:
    """(n, 3) sums of weights times the rows at `offsets`, NaN where those leave the data."""
    count, reach = len(values), int(np.abs(offsets).max())
    out = np.full(values.shape, np.nan)
    if count > 2 * reach:
        inside = slice(reach, count - reach)
        out[inside] = sum(w * values[reach + o : count - reach + o] for w, o in zip(weights, offsets, strict=True))
    return out


def _stencils_at(values, at, offsets, weights) -> Derivatives:
    """`_stencil` at samples `at` only."""
    rows = np.full((3, at.size, 3), np.nan)
    for m, k in enumerate(at):
        if k + offsets[0] >= 0 and k + offsets[-1] < len(values):
            rows[:, m] = weights @ values[k + offsets[0] : k + offsets[-1] + 1]
    return Derivatives(*rows)


def _local_fits(times, values, at, half_s, interval, order) -> Derivatives:
    """`local_polynomial` on unequal times, one small fit a sample."""
    rows = np.full((3, at.size, 3), np.nan)
    low = np.searchsorted(times, times[at] - half_s - 1e-6 * interval)
    high = np.searchsorted(times, times[at] + half_s + 1e-6 * interval)
    least = max(order + 1, int(half_s / interval))
    for k, (centre, a, b) in enumerate(zip(times[at], low, high, strict=True)):
        offsets = times[a:b] - centre
        if b - a >= least and min(-offsets[0], offsets[-1]) >= half_s - 1.5 * interval:
            rows[:, k] = polynomial_weights(offsets, order) @ values[a:b]
    return Derivatives(*rows)


def _third_derivative_penalty(knots, inner):
    """Gram matrix of the third derivatives of the B-splines; they are quadratics, so three Gauss nodes a cell are exact."""
    from scipy.interpolate import BSpline
    from scipy.sparse import csc_matrix, diags

    nodes, weights = np.polynomial.legendre.leggauss(3)
    half = 0.5 * np.diff(inner)
    points = ((inner[:-1] + inner[1:]) / 2)[:, None] + half[:, None] * nodes
    count = len(knots) - 6
    basis = BSpline(knots, np.eye(count), 5).derivative(3)(points.ravel())
    basis = csc_matrix(np.where(np.abs(basis) > 0.0, basis, 0.0))
    return basis.T @ diags((half[:, None] * weights).ravel()) @ basis


def _checked(seconds, field) -> tuple[np.ndarray, np.ndarray]:
    """Times (n,) and values (n, 3) as floats, or a refusal."""
    times, values = np.asarray(seconds, dtype=float), np.asarray(field, dtype=float)
    if times.ndim != 1 or values.shape != (times.size, 3):
        raise InputError(
            f"seconds must be (n,) and field (n, 3); got {times.shape} and {values.shape}. Did you pass (3, n)? Use .T."
        )
    if times.size < 3:
        raise InputError(f"a second derivative needs three samples or more; got {times.size}.")
    if not (np.diff(times) > 0.0).all():
        raise InputError("seconds must rise from sample to sample; sort them and drop repeated times first.")
    return times, values


def _is_uniform(times) -> bool:
    """Whether the times are equally spaced to a thousandth of the interval."""
    gaps = np.diff(times)
    return bool(np.ptp(gaps) < 1e-3 * gaps.mean())


def _interval(times) -> float:
    """The interval of equally spaced times, or a refusal that names the first gap."""
    gaps = np.diff(times)
    if not _is_uniform(times):
        usual = float(np.median(gaps))
        worst = int(np.argmax(np.abs(gaps - usual)))
        raise InputError(
            f"finite differences need equally spaced samples; the usual interval is {usual:g} s but {gaps[worst]:g} s after "
            f"t = {times[worst]:g} s. Use smoothing derivatives, which allow for gaps."
        )
    return float(gaps.mean())
