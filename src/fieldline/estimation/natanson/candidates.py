"""First guesses with no prior: every root at the best-conditioned epochs of an arc, each fitted over its window.

For a body that turns little from one sample to the next. The window of the smoothing derivatives follows from the noise
and from how fast the field is seen to turn; at each epoch the error of the root is foretold from the noise,

    sigma_Phi = lambda sigma(ddB) / (hypot(Q, R) sqrt(discriminant)),   lambda = max(lambda_A, lambda_R)           (1)

which is the noise of (3-9b) over its slope at the root; epochs where it, or afterwards the fit's own one-sigma angle,
exceeds one radian hold no answer. Where none is left, or the field turns so far between samples that its derivatives are
aliased, the list is empty and says why.

Source: Natanson, McLaughlin and Nicklas (1990), NASA CP-3102, section 3.1, with local polynomials for its differences.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fieldline.estimation.natanson.constant_rate import coefficients, constant_rate_roots, projections
from fieldline.estimation.natanson.derivatives import best_window_s, local_polynomial, polynomial_error
from fieldline.estimation.natanson.window_fit import fit_window

TURN_MAX_RAD = 0.35  # between samples; beyond it a window of a few samples spans more than a radian
ERROR_MAX_RAD = 1.0
CLEARLY_WORSE = 1.2  # of the noise: residuals below that rank by expected error, since short windows always fit well
SAME_RAD = 0.01
ROWS = 20_000  # longer records are averaged down to about as many
BLOCK_TURN_RAD = 0.02
CENTRES = 300  # samples at which roots are looked for: a long record costs no more than a short one
TURNS_MAX_RAD = 4.0 * np.pi  # in a window: a polynomial of degree four cannot follow more, so such a root is an artefact
ORDER = 4
STRETCHES = (1.0, 2.0)  # windows, in units of the one of least derivative error: bias cancels, so longer ones gain


class Candidate(NamedTuple):
    """An attitude and rate at sample `index`; loss is the rms residual per axis over the window [T].

    A record of more than ROWS samples is averaged in short blocks first, and the residual is that of the means.
    """

    index: int
    q_bi: np.ndarray  # (4,)
    omega_b: np.ndarray  # (3,) [rad/s]
    loss: float


class Candidates(list):
    """A list of `Candidate`, least loss first; where it is empty, `reason` says why."""

    def __init__(self, rows=(), reason: str = ""):
        super().__init__(rows)
        self.reason = reason


def natanson_candidates(
    seconds, field_b, field_i, noise_tesla, *, epochs: int = 4, longest_window_s: float = 1200.0
) -> Candidates:
    """Attitudes and rates to start from, for a slowly turning body; all roots at `epochs` places of the arc.

    Parameters
    ----------
    seconds (n,) [s]; field_b, field_i (n, 3) [T], body (calibrated) and inertial axes; rows with NaN are left out.
    noise_tesla : one sigma per axis, with what calibration and field model leave.
    longest_window_s : bound on the window, for a rate that is only about constant.
    """
    times, body, inertial = (np.asarray(x, dtype=float) for x in (seconds, field_b, field_i))
    kept = np.flatnonzero(np.isfinite(times) & np.isfinite(body).all(axis=-1) & np.isfinite(inertial).all(axis=-1))
    if kept.size < 2 * ORDER:
        return Candidates(reason=f"only {kept.size} usable samples; smoothing derivatives need {2 * ORDER} or more")
    times, body, inertial = times[kept], body[kept], inertial[kept]
    turn_between = _turn_between_samples(body)
    if turn_between > TURN_MAX_RAD:
        return Candidates(
            reason=f"the field turns {np.degrees(turn_between):.0f} deg from sample to sample in body axes: its derivatives "
            f"are aliased (at most {np.degrees(TURN_MAX_RAD):.0f} deg); find the spin from the spectrum instead"
        )
    times, body, inertial, kept, block = _thinned(times, body, inertial, kept, turn_between)
    noise_tesla = noise_tesla / np.sqrt(block)
    interval, span = float(np.median(np.diff(times))), float(times[-1] - times[0])
    turn_rad_s = turning_rate(times, body, noise_tesla)
    magnitude = float(np.median(np.linalg.norm(body, axis=1)))
    window = best_window_s(interval, noise_tesla, magnitude, turn_rad_s, ORDER, min(longest_window_s, 0.7 * span))
    found, least = [], np.inf
    for length in sorted({min(stretch * window, longest_window_s, 0.7 * span) for stretch in STRETCHES}):
        rows, error = _at_window(times, body, inertial, noise_tesla, magnitude, length, interval, epochs)
        found += [(sigma, row._replace(index=int(kept[row.index]))) for sigma, row in rows]
        least = min(least, error)
    if not found:
        return Candidates(reason=_too_noisy(noise_tesla, min(STRETCHES[-1] * window, longest_window_s, 0.7 * span), least))
    found.sort(key=lambda pair: (max(pair[1].loss, CLEARLY_WORSE * noise_tesla), pair[0]))
    return Candidates(row for _, row in found)


def _thinned(times, body, inertial, kept, turn_between):
    """Means over odd blocks of a record longer than ROWS, of its middle samples; blocks with gaps are left out.

    Returns also the block's length. Body and inertial field are averaged alike, over BLOCK_TURN_RAD at most.
    """
    block = min(-(-times.size // ROWS), int(BLOCK_TURN_RAD / max(turn_between, 1e-9)))
    block = max(1, block - 1 + block % 2)
    if block == 1:
        return times, body, inertial, kept, 1
    count = times.size // block
    rows = [x[: count * block].reshape(count, block, *x.shape[1:]) for x in (times, body, inertial, kept)]
    lengths = rows[0][:, -1] - rows[0][:, 0]
    whole = lengths < 1.01 * np.median(lengths)
    means = [x[whole].mean(axis=1) for x in rows[:3]]
    return *means, rows[3][whole, block // 2], block


def _too_noisy(noise_tesla, window_s, error_rad) -> str:
    """Why no epoch gave an answer."""
    angle = "above 60" if error_rad > ERROR_MAX_RAD else f"{np.degrees(error_rad):.0f}, but above 60 after a fit"
    return (
        f"a noise of {noise_tesla * 1e9:.0f} nT hides the field's second derivative within windows of {window_s:.0f} s: "
        f"the expected error in degrees is {angle} at every epoch; take a longer arc"
    )


def turning_rate(seconds, field_b, noise_tesla) -> float:
    """How fast the field turns in body axes [rad/s], from the shortest lag at which its change stands out of the noise."""
    magnitude = float(np.median(np.linalg.norm(field_b, axis=1)))
    lag = 1
    while True:
        change = float(np.median(np.linalg.norm(field_b[lag:] - field_b[:-lag], axis=1)))
        lapse = float(np.median(seconds[lag:] - seconds[:-lag]))
        if change > 10.0 * noise_tesla * np.sqrt(2.0) or 4 * lag >= len(seconds):
            return max(change, noise_tesla) / (magnitude * lapse)
        lag *= 2


def _turn_between_samples(field_b) -> float:
    """Median angle [rad] between successive field directions."""
    before, after = field_b[:-1], field_b[1:]
    sine, cosine = np.linalg.norm(np.cross(before, after), axis=1), np.sum(before * after, axis=1)
    return float(np.median(np.arctan2(sine, cosine)))


def _at_window(times, body, inertial, noise_tesla, magnitude, length_s, interval_s, epochs):
    """Fitted candidates with one window, and the least expected error of Phi [rad] among its epochs."""
    if 2 * int(0.5 * length_s / interval_s + 1e-9) <= ORDER:
        return [], np.inf
    at = np.unique(np.linspace(0, times.size - 1, min(times.size, CENTRES)).astype(int))
    smooth_b, smooth_i = (local_polynomial(times, x, window_s=length_s, order=ORDER, at=at) for x in (body, inertial))
    roots = constant_rate_roots(smooth_b, smooth_i, beyond="nearest")
    noise = polynomial_error(length_s, interval_s, noise_tesla, magnitude, 0.0, ORDER).noise[1]
    error = angle_error(roots, smooth_b.second, smooth_i.second, noise)
    finite = np.isfinite(roots.q_bi).all(axis=(1, 2)) & np.isfinite(roots.omega_b).all(axis=(1, 2))
    error[~finite] = np.inf
    rows = []
    for stretch in np.array_split(np.flatnonzero(np.isfinite(error)), epochs):
        if stretch.size and error[best := stretch[np.argmin(error[stretch])]] < ERROR_MAX_RAD:
            starts = roots.q_bi[best], roots.omega_b[best]
            rows += _fitted(times, body, inertial, noise_tesla, length_s, int(at[best]), starts)
    return rows, float(error.min(initial=np.inf))


def angle_error(roots, second_b, second_i, second_noise) -> np.ndarray:
    """(n,) [rad]: equation (1), for a noise [T/s^2] per axis of the second derivative; never below the touch's square root."""
    circle = roots.circle
    _, q, r = coefficients(circle, projections(circle, second_b, second_i))
    with np.errstate(invalid="ignore", divide="ignore"):
        ratio = np.maximum(circle.lambda_a, circle.lambda_r) * second_noise / np.hypot(q, r)
        clear = np.sqrt(np.maximum(roots.discriminant, ratio))  # near a touch the error is the square root of the noise
        return np.where(np.isfinite(ratio), ratio / clear, np.inf)


def _fitted(times, body, inertial, noise_tesla, length_s, index, starts) -> list[tuple[float, Candidate]]:
    """Expected error [rad] and candidate for each root of one epoch, fitted over the window that gave it."""
    near = np.abs(times - times[index]) <= 0.5 * length_s
    window = times[near], body[near], inertial[near]
    fit = fit_window(*window, *starts, noise_tesla=noise_tesla, epoch_s=times[index])
    rows: list[tuple[float, Candidate]] = []
    for m, q in enumerate(fit.q_bi):
        sigma = float(np.sqrt(np.trace(fit.covariance[m][:3, :3])))
        again = any(abs(float(row.q_bi @ q)) > np.cos(0.5 * SAME_RAD) for _, row in rows)
        followed = float(np.linalg.norm(fit.omega_b[m])) * length_s < TURNS_MAX_RAD
        if sigma < ERROR_MAX_RAD and followed and not again:
            rows.append((sigma, Candidate(index, q, fit.omega_b[m], float(fit.residual_rms_tesla[m]))))
    return rows
