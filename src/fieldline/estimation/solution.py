"""From a calibrated arc to the motion that explains it best, with the rivals that lost and by how much.

    starts (both rate models) -> filter over the whole arc -> likeliest of each kind -> noise tuned -> constants polished
    with the attitude -> noise tuned again -> smoothed -> covariance widened by what the constants and the field model hide

Every choice is by the likelihood of the innovations; nothing here knows what satellite it is.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from fieldline.errors import NoEstimateError
from fieldline.estimation.batch import Motion
from fieldline.estimation.kalman import Noise
from fieldline.estimation.motion import RateModel
from fieldline.estimation.natanson.candidates import natanson_candidates
from fieldline.estimation.polish import Constants, effective_share, gather_constants, polish
from fieldline.estimation.refine import Contender, contend, settle
from fieldline.estimation.series import Series, part
from fieldline.estimation.smoothing import Smoothed, smooth, state_at_first
from fieldline.estimation.starts import Candidate, find_starts
from fieldline.estimation.systematics import stretch, widen, widen_by_field_model
from fieldline.estimation.tuning import magnitude_noise, middle_rows, substeps, tune

SLOW_ERROR_TIME = 300.0  # [s] first guess of the slow error's correlation time
POLISH_ROUNDS = 4
FINAL_PASSES = 4
STEADY_SHARE = 0.02  # of the rate
STEADY_STD_DEG = 3.0
RESTLESS = 1e-5  # [rad/s/sqrt(s)]
SLOW_TURN = 0.5  # [rad] between samples
MORE_ANCHORS = 6
QUIET_ROUNDS = 6
UNSURE_STRETCH = 2.0
QUIET_NOISES = (1e-6, 1e-7)  # [rad/s/sqrt(s)]
BODY_COUNT = 8  # numbers that a free rigid body has and a random walk has not: half of ln n each in its favour

Progress = Callable[[str, float, float, str], None]
SeriesOf = Callable[[np.ndarray], Series]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Solution:
    """The motion of an arc: `smoothed` with its widened covariance, constants, all contenders and the noise floor.

    memory: how many samples tell as much as one independent one. added_covariance_b (3, 3) [rad2], added_rate_var (3,): what
    constants and field model add to the smoother's covariance, mean over the arc. core: what the contenders ran over.
    """

    smoothed: Smoothed
    constants: Constants
    contenders: tuple[Contender, ...]
    winner: Contender
    floor_tesla: float
    candidates_tried: int
    remarks: tuple[str, ...]
    series: Series
    core: Series
    added_covariance_b: np.ndarray
    added_rate_var: np.ndarray
    memory: float


def solve(
    series_of: SeriesOf,
    volume_of: Callable[[np.ndarray, slice], float],
    calibration_values: np.ndarray | None,
    calibration_covariance: np.ndarray | None,
    *,
    unsure: bool = False,
    inertia=None,
    progress: Progress,
    seed: int,
) -> Solution:
    """The motion of an arc. series_of(calibration numbers) is the arc calibrated with them; None: nothing to recalibrate.

    volume_of(calibration numbers, rows) is V of `polish` over some rows of the arc; unsure: the calibration is so uncertain
    that it must be found together with the motion.

    Errors: NoEstimateError where no start survives the filter.
    """
    series = series_of(calibration_values)
    floor = magnitude_noise(series)
    noise = Noise(white=floor, coloured=0.5 * floor, coloured_time=SLOW_ERROR_TIME)
    contenders, tried, remarks = _contenders(series, noise, floor, inertia, progress)
    settled = _settled(series, contenders, floor)
    if _restless(settled[0], series):
        # a body free of torque looks like this where no start found its shape: look for it from more places
        starts = find_starts(series, floor, inertia=inertia, rigid=True, anchors=MORE_ANCHORS)
        tried += len(starts)
        contenders = sorted(contenders + contend(series, starts, noise, floor), key=lambda c: -c.log_likelihood)
        settled = _settled(series, contenders, floor)
    progress("refine", 0.4, 1.0, settled[0].candidate.words)
    job = _Polish(series_of=series_of, volume_of=volume_of, floor=floor)
    # a calibration that is unsure judges the rate models only once it has been found with each of them
    rivals = [r for r in settled if r is settled[0] or (unsure and substeps(series, r.smoothed.model, r.smoothed.start) < 3)]
    polished = [_polished(job, series, rival, calibration_values, calibration_covariance, unsure) for rival in rivals]
    winner, smoothed, constants, _ = max(polished, key=lambda one: one[3])
    series = series_of(_calibration_part(constants, calibration_values))
    progress("refine", 0.7, 1.0, "uncertainty")
    smoothed = smooth(series, smoothed.start, smoothed.noise, smoothed.model, passes=FINAL_PASSES)
    # samples that repeat each other are fewer than they seem, and the smoother's covariance shrinks with their number
    memory = 1.0 / effective_share(smoothed.white)
    smoothed = stretch(smoothed, memory)
    widened = widen_by_field_model(widen(smoothed, constants, series_of), series, seed)
    left = series.field_b - widened.slow_b - widened.predicted(series)
    progress("refine", 1.0, 1.0, f"residual {1e6 * np.sqrt((left[series.used] ** 2).mean()):.2f} µT RMS")
    return Solution(
        smoothed=widened,
        added_covariance_b=(widened.attitude_covariance_b - smoothed.attitude_covariance_b).mean(axis=0),
        memory=memory,
        added_rate_var=(widened.rate_std_b**2 - smoothed.rate_std_b**2).mean(axis=0),
        constants=constants,
        contenders=tuple(settled + [c for c in contenders if all(c.candidate is not s.candidate for s in settled)]),
        winner=winner,
        floor_tesla=floor,
        candidates_tried=tried,
        remarks=tuple(remarks),
        series=series,
        core=series,
    )


def _restless(contender: Contender, series: Series) -> bool:
    """Whether the likeliest motion wanders more than a body without control does, at a rate that is cheap to follow."""
    smoothed = contender.smoothed
    slow = np.linalg.norm(np.median(smoothed.omega_b, axis=0)) * float(np.median(np.diff(series.seconds))) < SLOW_TURN
    return bool(slow and smoothed.model.noise > RESTLESS and not series.gyro_b.any())


def extend(solution: Solution, series_of: SeriesOf, calibration_values, first_row: int, progress: Progress) -> Solution:
    """A solution of the middle of an arc carried over the whole of it, with the same constants and noise.

    series_of gives the whole arc; first_row is where its middle begins. Costs two passes of the smoother.
    """
    progress("smooth", 0.0, 1.0, "the whole record")
    core = solution.smoothed
    series = series_of(_calibration_part(solution.constants, calibration_values))
    state = np.concatenate([core.q_bi[0], core.omega_b[0]])
    start = state_at_first(series, first_row, state, core.noise, core.model)
    smoothed = stretch(smooth(series, start, core.noise, core.model, passes=2), solution.memory)
    progress("smooth", 1.0, 1.0, f"{len(series.seconds):,} samples")
    return replace(
        solution,
        series=series,
        smoothed=replace(
            smoothed,
            attitude_covariance_b=smoothed.attitude_covariance_b + solution.added_covariance_b,
            rate_std_b=np.sqrt(smoothed.rate_std_b**2 + solution.added_rate_var),
        ),
    )


def _calibration_part(constants: Constants, otherwise):
    return constants.values[: constants.calibrated] if constants.calibrated else otherwise


def _contenders(series: Series, noise: Noise, floor: float, inertia, progress) -> tuple[list[Contender], int, list[str]]:
    """The likeliest contenders of both rate models, and how many starts were tried."""
    from_roots, remarks = natanson_starts(series, floor)
    contenders: list[Contender] = []
    tried = 0
    kinds = (False,) if series.gyro_b.any() else (False, True)
    for k, rigid in enumerate(kinds):
        if rigid and inertia is None and contenders and _steady(max(contenders, key=lambda c: c.log_likelihood)):
            break
        progress("first guess", k, len(kinds), "rigid body" if rigid else "random walk")
        starts = ([] if rigid else from_roots) + find_starts(series, floor, inertia=inertia, rigid=rigid)
        tried += len(starts)
        contenders += contend(series, starts, noise, floor)
    progress("first guess", len(kinds), len(kinds), f"{len(contenders)} of {tried} candidates kept")
    if not contenders:
        raise NoEstimateError(
            "no motion was found that the filter could follow over this arc: the field seen by the sensor does not look like "
            "the model's along this orbit in any attitude. Check that orbit, time (UTC) and calibration belong together."
        )
    return sorted(contenders, key=lambda c: -c.log_likelihood), tried, remarks


def _steady(contender: Contender) -> bool:
    """Whether the rate hardly changes: then there is nothing for a rigid body to explain that a random walk does not."""
    omega, spread = contender.smoothed.omega_b, contender.smoothed.attitude_covariance_b
    known = np.degrees(np.sqrt(np.median(np.trace(spread, axis1=1, axis2=2)))) < STEADY_STD_DEG
    return bool(known and np.linalg.norm(omega.std(axis=0)) < STEADY_SHARE * np.linalg.norm(omega.mean(axis=0)))


def natanson_starts(series: Series, noise_tesla: float) -> tuple[list[Candidate], list[str]]:
    """Starts from smoothed derivatives (Natanson 1990), all roots; or why there are none."""
    rows = series.used
    found = natanson_candidates(series.seconds[rows], series.field_b[rows], series.field_i[rows], noise_tesla)
    index = np.flatnonzero(rows)
    starts = [
        Candidate(
            motion=Motion(q_bi=np.asarray(root.q_bi), omega_b=np.asarray(root.omega_b), anchor=int(index[root.index])),
            row=int(index[root.index]),
            rows=1,
            words=f"derivatives of the field, loss {1e9 * float(root.loss):.0f} nT",
        )
        for root in found
    ]
    reason = getattr(found, "reason", "")
    return starts, [f"smoothed derivatives gave no start: {reason}"] if not starts and reason else []


def _settled(series: Series, contenders: list[Contender], floor: float) -> list[Contender]:
    """The best of each rate model with its noise tuned, the likelier first."""
    settled = []
    for rigid in (False, True):
        kind = [c for c in contenders if c.smoothed.model.rigid == rigid]
        if kind:
            settled.append(_settle_on_part(series, kind[0], floor))
    share = min((effective_share(c.smoothed.white) for c in settled), default=1.0)
    return sorted(settled, key=lambda c: -_penalised(c, series, share))


def _settle_on_part(series: Series, contender: Contender, floor: float) -> Contender:
    """`settle`; a long arc, or one that is dear to follow, is tuned on its middle, then smoothed whole."""
    before = contender.smoothed
    rows = middle_rows(series, substeps(series, before.model, before.start))
    if rows.stop - rows.start == len(series.seconds):
        return settle(series, contender, floor)
    state = np.concatenate([before.q_bi[rows.start], before.omega_b[rows.start]])
    noise, model, _ = tune(part(series, rows), state, before.noise, before.model, floor)
    after = smooth(series, before.start, noise, model, passes=2)
    return replace(contender, smoothed=after) if after.log_likelihood > before.log_likelihood else contender


def _penalised(contender: Contender, series: Series, share: float) -> float:
    """Log-likelihood less half ln n for each number that the rigid body fitted besides the state.

    `share` is what the innovations' memory leaves of the samples' number and so of the likelihood.
    """
    free = BODY_COUNT if contender.candidate.motion.shape is not None else 0
    return share * contender.log_likelihood - 0.5 * free * np.log(max(share * series.used.sum(), 2.0))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Polish:
    """What every polish of an arc needs: how to calibrate, the rows that are read, and the magnitude's residual."""

    series_of: SeriesOf
    volume_of: Callable[[np.ndarray, slice], float]
    floor: float
    rows: slice | None = None

    def arc(self, constants: Constants) -> Series:
        return part(self.series_of(constants.values[: constants.calibrated]), self.rows)

    def step(self, constants: Constants, start: np.ndarray, noise: Noise, like: RateModel) -> tuple[Constants, float]:
        """One climb of the constants."""
        return polish(
            constants,
            lambda v: part(self.series_of(v), self.rows),
            lambda v: self.volume_of(v, self.rows),
            start,
            noise,
            like,
        )

    def score(self, constants: Constants, log_likelihood: float) -> float:
        """The logarithm of the posterior: likelihood of the readings and prior of the constants."""
        off = constants.values - constants.prior_mean
        prior = -0.5 * float(off @ np.linalg.solve(constants.prior_covariance, off)) if off.size else 0.0
        return log_likelihood + self.volume_of(constants.values[: constants.calibrated], self.rows) + prior

    def climb(
        self, constants: Constants, start, noise: Noise, like: RateModel, quiet: float | None, rounds: int = POLISH_ROUNDS
    ) -> _Climbed:
        """Constants and noise in turn; with `quiet`, the rate noise is held there first, then set free."""
        if quiet is not None:
            like = like._replace(noise=quiet)
            for _ in range(QUIET_ROUNDS):
                arc, model = self.arc(constants), constants.model(like)
                start = smooth(arc, start, noise, model, passes=3).start
                noise, _, _ = tune(arc, start, noise, model, min(self.floor, magnitude_noise(arc)), hold_rate=True)
                constants, gained = self.step(constants, start, noise, like)
                if gained < 1.0:
                    break
        for _ in range(rounds):
            constants, gained = self.step(constants, start, noise, like)
            arc = self.arc(constants)
            noise, like, _ = tune(arc, start, noise, constants.model(like), min(self.floor, magnitude_noise(arc)))
            result = smooth(arc, start, noise, like)
            start = result.start
            if gained < 2.0:
                break
        return _Climbed(constants, start, noise, like, self.score(constants, result.log_likelihood))


class _Climbed(NamedTuple):
    """The end of one climb."""

    constants: Constants
    start: np.ndarray
    noise: Noise
    like: RateModel
    score: float


def _polished(job: _Polish, series: Series, winner: Contender, values, covariance, unsure: bool):
    """A contender with its constants and noise at the top of the posterior: itself, motion, constants, score.

    Where the calibration is unsure, or a body's shape is sought, the tops are several: a rate that wanders freely agrees
    with any constants. The climb is then repeated from rates held quiet, and the highest top counts.
    """
    motion, smoothed = winner.candidate.motion, winner.smoothed
    rigid = smoothed.model.rigid
    dipole = (np.zeros(3) if motion.dipole is None else motion.dipole) if rigid else None
    constants = gather_constants(values, covariance, motion.shape if rigid else None, dipole, motion.inertia)
    if constants.values.size == 0:
        return winner, smoothed, constants, winner.log_likelihood
    parts = substeps(series, smoothed.model, smoothed.start)
    rows = middle_rows(series, parts)
    job, first_row = replace(job, rows=rows), rows.start
    start = np.concatenate([smoothed.q_bi[first_row], smoothed.omega_b[first_row]])
    # where the magnitudes have settled the calibration, little is left to climb
    rounds = POLISH_ROUNDS if unsure or rigid else POLISH_ROUNDS // 2
    tops = [job.climb(constants, start, smoothed.noise, smoothed.model, None, rounds)]
    # a fast spinner shows its calibration and its shape by itself, and its rigid motion is dear to follow
    quiet_noises = () if parts > 2 else QUIET_NOISES if unsure else QUIET_NOISES[:1] if rigid else ()
    if quiet_noises:
        plain = smoothed.noise._replace(white=job.floor, coloured=0.5 * job.floor, coloured_time=SLOW_ERROR_TIME)
        tops += [job.climb(constants, start, plain, smoothed.model, quiet) for quiet in quiet_noises]
    best = max(tops, key=lambda top: top.score if np.isfinite(top.score) else -np.inf)
    first = smoothed.start if first_row else best.start
    found = best.constants
    if unsure:
        # on simulated Earth-pointing flights the errors of matrix and bias were about twice what the curvature of the
        # posterior says: slow error and calibration share the same few turns of the field
        found = replace(found, covariance=UNSURE_STRETCH**2 * found.covariance)
    result = replace(smoothed, noise=best.noise, model=best.like, q_bi=first[None, :4], omega_b=first[None, 4:])
    free = BODY_COUNT if constants.shape else 0
    return winner, result, found, best.score - 0.5 * free * np.log(max(series.used.sum(), 2))
