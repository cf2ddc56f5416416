"""`estimate_attitude`: magnetometer telemetry and an orbit in; attitude, rate and their uncertainty out, no prior needed.

telemetry, orbit -> reference field -> calibration by magnitude -> starts without a prior -> filter, smoother, tuning,
constants -> uncertainty -> judges that were not used -> verdict -> Dataset
"""

from __future__ import annotations

import dataclasses
import platform
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from fieldline.errors import InputError, NoEstimateError, nearest
from fieldline.estimation.attitude_dataset import attitude_dataset
from fieldline.estimation.calibrate import COLUMNS, calibrate_against, columns_for
from fieldline.estimation.calibration import Calibration
from fieldline.estimation.consistency import consistency
from fieldline.estimation.judgement import SPREAD_LIMIT, judge_gyro, judge_line, judge_sun, meeting
from fieldline.estimation.polish import effective_share
from fieldline.estimation.reference import Reference, reference_along_orbit
from fieldline.estimation.series import Series, make_series, part
from fieldline.estimation.smoothing import Smoothed, smooth
from fieldline.estimation.solution import Solution, extend, solve
from fieldline.estimation.systematics import stretch
from fieldline.estimation.tuning import magnitude_noise
from fieldline.estimation.verdict import RIVAL_ANGLE_DEG, RIVAL_LIKELIHOOD, angle_between, judge_usable, refuse_magnitude
from fieldline.frames.attitude import rotation_error_b
from fieldline.mechanics.rigid_body import as_inertia9
from fieldline.orbit import Orbit, orbit_from_positions
from fieldline.telemetry import Telemetry

FEWEST = 30  # usable samples
HALVES = "halves of the arc, where they meet"
CORE_FEWEST = 1_500  # rows that thinning leaves, at least
CORE_TURN = 0.3  # [rad]
CORE_ROWS = 20_000  # of a longer arc: its middle, on which everything but attitude and rate is found
LARGEST_STRETCH = 3.0  # of the whole arc's uncertainty: half an arc may go astray where the whole one does not
UNSURE = 0.02  # of the field: a calibration this uncertain is found together with the motion
ALIAS_TURN_DEG = 15.0  # between samples, from which aliases are named
USES = ("gyro", *COLUMNS)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Arc:
    """The inputs of an estimate, made ready: what turns calibration numbers into a series."""

    telemetry: Telemetry
    reference: Reference
    calibration: Calibration
    columns: dict
    gyro_b: np.ndarray | None
    moment_b: np.ndarray | None = None

    def field_b(self, values: np.ndarray) -> np.ndarray:
        """(n, 3) [T] the telemetry calibrated with other numbers."""
        calibration = dataclasses.replace(self.calibration, values=values)
        return calibration.apply(
            self.telemetry.seconds, self.telemetry.field_s, epoch_utc=self.telemetry.epoch_utc, **self.columns
        )

    def series(self, values: np.ndarray | None) -> Series:
        """The arc as kernels take it."""
        values = self.calibration.values if values is None or not len(values) else values
        return make_series(
            self.telemetry.seconds,
            self.field_b(values),
            self.reference.field_i,
            self.reference.position_i,
            self.telemetry.usable,
            self.gyro_b,
            self.moment_b,
        )

    def volume(self, values: np.ndarray, rows: slice) -> float:
        """Sum over the usable rows of log |d field_b / d field_s|, for `polish`."""
        if not len(values):
            return 0.0
        calibration = dataclasses.replace(self.calibration, values=values)
        telemetry = self.telemetry
        gain = calibration.gain_at(telemetry.seconds[rows], epoch_utc=telemetry.epoch_utc, **self._columns_at(rows))
        sign, size = np.linalg.slogdet(calibration.matrix)
        # a mirrored matrix is no calibration
        return float((3.0 * np.log(np.maximum(gain, 1e-9)) + size)[telemetry.usable[rows]].sum()) if sign > 0 else -np.inf

    def core(self) -> tuple[Arc, slice]:
        """The part of a long arc on which motion, noise and constants are found, and its rows.

        Samples that are closer than the motion needs are passed over first; then the middle is taken.
        """
        n = len(self.telemetry)
        stride = self._stride()
        first = max(0, (n - CORE_ROWS * stride) // 2)
        rows = slice(first, min(n, first + CORE_ROWS * stride), stride)
        if stride == 1 and rows.stop - rows.start == n:
            return self, rows
        core = dataclasses.replace(
            self,
            telemetry=self.telemetry.rows(rows),
            reference=self.reference.part(rows),
            columns=self._columns_at(rows),
            gyro_b=None if self.gyro_b is None else self.gyro_b[rows],
            moment_b=None if self.moment_b is None else self.moment_b[rows],
        )
        return core, rows

    def _stride(self) -> int:
        """Every how many samples a densely sampled arc is read: the field turns by CORE_TURN between them, at most."""
        field_b = self.series(None).field_b[self.telemetry.usable]
        stride = 1
        while len(field_b) // (2 * stride) >= CORE_FEWEST:
            # judged before it is doubled: a body that turns half round between samples would look at rest at every other one
            taken = field_b[::stride]
            if np.median(angle_between(taken[1:], taken[:-1])) > 0.5 * CORE_TURN:
                break
            stride *= 2
        return stride

    def unsure(self) -> bool:
        """Whether the magnitudes left the calibrated field more uncertain than UNSURE of itself."""
        telemetry = self.telemetry
        std = self.calibration.propagated_std(
            telemetry.seconds, telemetry.field_s, epoch_utc=telemetry.epoch_utc, **self.columns
        )  # fmt: skip
        return bool(np.median(np.linalg.norm(std[telemetry.usable], axis=1)) > UNSURE * np.median(self.reference.magnitude))

    def _columns_at(self, rows: slice) -> dict:
        return {name: column[rows] for name, column in self.columns.items()}


def estimate_attitude(
    telemetry: Telemetry,
    orbit: Orbit | None = None,
    *,
    model="IGRF-14",
    calibration: str | Calibration = "auto",
    use: Sequence[str] = (),
    inertia_kg_m2=None,
    degree: int | None = None,
    progress: Callable[[str, float, float, str], None] | None = None,
    seed: int = 0,
):
    """Attitude and rate of a satellite from its magnetometer, over the whole record.

    Parameters
    ----------
    telemetry : as `read_telemetry` gives it.      orbit : as `read_orbit` gives it; None takes the telemetry's own positions.
    model : field model by name, or a FieldModel; degree : its highest degree, all where None.
    calibration : "auto", "none", "bias", "full", or a Calibration; whatever is fitted by magnitude is refined with the
        attitude (a given Calibration is where that starts and what it may not leave far behind); "none" is left as it is.
    use : columns besides the magnetometer that may be used: "gyro" (the rate's random walk becomes the gyro's error),
        "temperature", "dipole", "current" (in the calibration; a dipole command is also the torque of a body whose inertia is
        given).
    inertia_kg_m2 : three principal moments about body axes or a (3, 3) matrix; without it both a wandering rate and a rigid
        body of unknown shape are tried.      progress(stage, done, total, words).      seed : of every random draw.

    Returns
    -------
    xarray.Dataset with q_bi, omega_bi_b, their 1-sigma, measured and predicted field, and the verdict in its attributes.

    Errors: InputError for input that cannot be used; NoEstimateError where too little of it is usable. A result that the
    data do not support is returned, with attribute `usable` 0 and the reason in `verdict`.
    Source: docs/theory/attitude.md. Valid for one rigid body in low orbit; alignment of magnetometer and body is not seen.
    """
    report = progress or (lambda stage, done, total, words="": None)
    _check_use(use, telemetry)
    orbit = _orbit(telemetry, orbit)
    _check_count(telemetry)
    report("field", 0, 1, "")
    reference = reference_along_orbit(telemetry.time_utc, orbit, model, degree)
    report("field", 1, 1, f"{reference.model} along {reference.orbit['kind']}")
    arc, free = _calibrated(telemetry, reference, calibration, use, report)
    refuse_magnitude(magnitude_noise(arc.series(None)), float(np.median(reference.magnitude)))
    inertia = None if inertia_kg_m2 is None else np.reshape(as_inertia9(inertia_kg_m2)[0], (3, 3))
    if inertia is not None and "dipole" in use:
        arc = dataclasses.replace(arc, moment_b=telemetry.dipole_command_b)
    values, spread = (arc.calibration.values, arc.calibration.covariance) if free else (None, None)
    core, rows = arc.core()
    solution = solve(
        core.series, core.volume, values, spread, unsure=free and core.unsure(), inertia=inertia, progress=report, seed=seed,
    )  # fmt: skip
    if core is not arc:
        solution = extend(solution, arc.series, values, rows.start, report)
    judgement, smoothed = _judged(arc, solution, report)
    verdict = _verdict(arc, solution, smoothed, judgement, use, seed)
    report("judge", 1, 1, verdict["sentence"])
    return attitude_dataset(
        telemetry, reference, solution.series.field_b, solution.series.used, smoothed, smoothed.omega_b + solution.series.gyro_b,
        smoothed.predicted(solution.series), verdict, _provenance(arc, solution, use, seed),
    )  # fmt: skip


def _check_use(use: Sequence[str], telemetry: Telemetry) -> None:
    for name in use:
        if name not in USES:
            raise InputError(f'use "{name}": no such column; {nearest(name, USES)}')
    if "gyro" in use and telemetry.rate_b is None:
        raise InputError(f'use "gyro": "{telemetry.name}" has no column that was recognised as a gyro.')


def _orbit(telemetry: Telemetry, orbit: Orbit | None) -> Orbit:
    if orbit is not None:
        return orbit
    if telemetry.position_e is None:
        raise InputError(
            f'no orbit: "{telemetry.name}" has no position columns either. Give a TLE, OMM or OEM file (--orbit), or positions.'
        )
    return orbit_from_positions(telemetry.time_utc, telemetry.position_e)


def _check_count(telemetry: Telemetry) -> None:
    usable = int(telemetry.usable.sum())
    if usable < FEWEST:
        raise NoEstimateError(
            f'"{telemetry.name}" has {usable} usable samples; at least {FEWEST} are needed to see how the field turns. '
            "Give a longer record."
        )


def _calibrated(telemetry, reference, calibration, use, report) -> tuple[Arc, bool]:
    """The arc with its calibration, and whether that may be refined with the attitude."""
    report("calibration", 0, 1, "")
    columns = tuple(name for name in use if name in COLUMNS)
    free = isinstance(calibration, Calibration) or calibration != "none"
    if isinstance(calibration, Calibration):
        found = calibration
    else:
        found = calibrate_against([telemetry], [reference], calibration=calibration, use=columns)[0]
    given = columns_for(found, telemetry, reference)
    gyro_b = telemetry.rate_b if "gyro" in use else None
    arc = Arc(telemetry=telemetry, reference=reference, calibration=found, columns=given, gyro_b=gyro_b)
    report("calibration", 1, 1, f"{found.model}, residual {1e6 * found.residual_rms_tesla:.2f} µT RMS")
    return arc, free


def _judged(arc: Arc, solution: Solution, report) -> tuple[list[dict], Smoothed]:
    """The judgement, and the smoothed arc with its covariance stretched where the halves ask for it."""
    from fieldline.environment import eclipse, sun_direction_i

    report("judge", 0, 1, "")
    telemetry, smoothed = arc.telemetry, solution.smoothed
    lines = []
    halves = _halves(solution)
    if halves is not None:
        error, square = halves
        angle, apart = np.degrees(np.linalg.norm(error)), float(np.sqrt(square / 3.0))
        agree = np.sqrt(square) <= SPREAD_LIMIT
        words = f"{apart:.1f} times the stated 1-sigma"
        if not agree:
            apart = min(apart, LARGEST_STRETCH)
            smoothed = stretch(smoothed, apart**2)
            words += f"; the stated uncertainty of the whole arc has been stretched {apart:.1f} times"
        lines.append(judge_line(HALVES, angle, "deg", None, bool(agree), words))
    if telemetry.rate_b is not None and arc.gyro_b is None:
        lines += judge_gyro(smoothed.omega_b, telemetry.rate_b)
    if telemetry.sun_sensor:
        sunlit = eclipse(arc.reference.position_i, telemetry.time_utc)
        lines += judge_sun(smoothed, sun_direction_i(telemetry.time_utc), sunlit, telemetry.sun_sensor)
    return lines, smoothed


def _halves(solution: Solution) -> tuple[np.ndarray, float] | None:
    """Each half filtered by itself, with the constants of the whole; where they meet."""
    series, smoothed = solution.series, solution.smoothed
    middle = len(series.seconds) // 2
    if middle < FEWEST:
        return None
    extra = smoothed.attitude_covariance_b
    both = []
    for rows in (slice(0, middle), slice(middle, None)):
        about = dataclasses.replace(
            smoothed, q_bi=smoothed.q_bi[rows], omega_b=smoothed.omega_b[rows], slow_b=smoothed.slow_b[rows]
        )
        half = smooth(part(series, rows), about.start, smoothed.noise, smoothed.model, passes=3, about=about)
        both.append(stretch(half, solution.memory))
    # what constants and field model add to the whole arc, the halves carry too
    plain = stretch(smooth(series, smoothed.start, smoothed.noise, smoothed.model, about=smoothed), solution.memory)
    added = np.maximum(extra - plain.attitude_covariance_b, 0.0)[middle]
    first, second = both
    first.attitude_covariance_b[-1] += 0.5 * (added + added.T)
    gap = float(series.seconds[middle] - series.seconds[middle - 1])
    return meeting(first, second, series.gyro_b[middle], gap)


def _rivals(solution: Solution) -> list[str]:
    """Contenders about as likely as the winner, in words, that stand elsewhere."""
    smoothed = solution.winner.smoothed
    share = effective_share(smoothed.white)
    middle = len(solution.core.seconds) // 2
    rivals = []
    for other in solution.contenders:
        behind = share * (solution.winner.log_likelihood - other.log_likelihood)
        if other is solution.winner or behind > RIVAL_LIKELIHOOD or other.smoothed.model.rigid != smoothed.model.rigid:
            continue
        turn = rotation_error_b(solution.winner.smoothed.q_bi[middle], other.smoothed.q_bi[middle])
        spread = smoothed.attitude_covariance_b[middle] + other.smoothed.attitude_covariance_b[middle]
        away = float(np.degrees(np.linalg.norm(turn)))
        if away > RIVAL_ANGLE_DEG and turn @ np.linalg.solve(spread, turn) > 16.0:
            rivals.append(f"one {away:.0f}° away, {behind:.1f} less likely in the logarithm")
    return rivals


def _candidates(solution: Solution) -> list[dict]:
    """Every contender with its fate, plain types."""
    best = solution.winner
    share = effective_share(best.smoothed.white)
    rows = []
    for contender in solution.contenders:
        left = contender.smoothed.predicted(solution.core) - solution.core.field_b + contender.smoothed.slow_b
        used = solution.core.used
        rows.append(
            {
                "name": contender.candidate.words,
                "kept": contender is best,
                "log_likelihood": float(contender.log_likelihood),
                "residual_rms_nt": float(1e9 * np.sqrt((left[used] ** 2).mean())),
                "words": _fate(contender is best, share * (best.log_likelihood - contender.log_likelihood)),
            }
        )
    return rows


def _fate(kept: bool, behind: float) -> str:
    """Why a candidate was kept or dropped; behind: in log-likelihood, after the samples' memory."""
    if kept:
        return "kept: the likeliest for the numbers it needs"
    if behind <= 0.0:
        return f"dropped: likelier by {-behind:.1f} (logarithm), too little for the further numbers that it fits"
    return f"dropped: less likely by {behind:,.1f} (logarithm, after the samples' memory)"


def _verdict(arc: Arc, solution: Solution, smoothed: Smoothed, judgement: list[dict], use, seed: int) -> dict:
    """The machine-readable verdict."""
    series = solution.series
    used = series.used
    measured, predicted = series.field_b - smoothed.slow_b, smoothed.predicted(series)
    std = np.degrees(np.sqrt(np.maximum(smoothed.attitude_covariance_b[:, [0, 1, 2], [0, 1, 2]], 0.0)))
    found = consistency(smoothed.white)
    misfit = float(np.degrees(np.sqrt(np.mean(angle_between(measured[used], predicted[used]) ** 2))))
    apart = next((line["value"] for line in judgement if line["what"] == HALVES and not line["passed"]), 0.0)
    usable, sentence = judge_usable(np.median(std, axis=0), float(std.max()), misfit, apart, _rivals(solution), found)
    model = smoothed.model
    return {
        "usable": usable,
        "sentence": sentence,
        "exit_code": 0 if usable else 1,
        "attitude_std_deg": [float(v) for v in np.median(std, axis=0)],
        "attitude_std_worst_deg": float(std.max()),
        "rate_std_deg_s": [float(v) for v in np.degrees(np.median(smoothed.rate_std_b, axis=0))],
        "rate_median_deg_s": [float(v) for v in np.degrees(np.median(smoothed.omega_b + series.gyro_b, axis=0))],
        "residual_rms_nt": float(1e9 * np.sqrt(((measured - predicted)[used] ** 2).mean())),
        "direction_rms_deg": misfit,
        "consistency": found,
        "calibration": {**arc.calibration.summary(), **_recalibration(arc, solution)},
        "telemetry": {"name": arc.telemetry.name, "sha256": arc.telemetry.sha256, "lines": arc.telemetry.describe()},
        "orbit": arc.reference.orbit,
        "field_model": arc.reference.stamp,
        "candidates": _candidates(solution),
        "candidates_tried": solution.candidates_tried,
        "motion": _motion(solution) | {"aliases": _aliases(solution)},
        "judgement": judgement,
        "warnings": list(arc.reference.orbit.get("warnings", [])),
        "remarks": list(solution.remarks),
        "noise": {
            "white_nt": 1e9 * float(smoothed.noise.white),
            "slow_nt": 1e9 * float(smoothed.noise.coloured),
            "slow_time_s": float(smoothed.noise.coloured_time),
            "rate_noise_rad_s15": float(model.noise),
        },
        "settings": _settings(arc, solution, use, seed),
    }


def _settings(arc: Arc, solution: Solution, use, seed: int) -> dict:
    """What the run was told, plain types."""
    inertia = solution.constants.inertia
    return {
        "use": list(use),
        "seed": seed,
        "calibration": arc.calibration.model,
        "field_model": arc.reference.model,
        "inertia_kg_m2": None if inertia is None else np.asarray(inertia).tolist(),
    }


def _motion(solution: Solution) -> dict:
    """The rate model in words and numbers."""
    if not solution.smoothed.model.rigid:
        return {"model": "random walk", "words": "each body rate wanders; no inertia is assumed"}
    body = solution.constants
    inertia = np.reshape(solution.smoothed.model.inertia, (3, 3))
    return {
        "model": "rigid body",
        "words": "Euler's equations with gravity gradient and a residual dipole"
        + ("; inertia ratios found from the data" if body.shape else "; inertia as given"),
        "inertia_ratio": (3.0 * inertia / np.trace(inertia)).tolist(),
        # the inertia's scale is known where it was given, and 1 kg m2 in the mean where only its ratios were found
        ("dipole_per_inertia_a_kg" if body.shape else "residual_dipole_a_m2"): [float(v) for v in solution.smoothed.model.dipole],
    }


def _aliases(solution: Solution) -> str:
    """What rates even sampling cannot tell from the one found, in words; empty where the body turns little between samples."""
    series = solution.series
    step = float(np.median(np.diff(series.seconds)))
    spin = float(np.degrees(np.median(np.linalg.norm(solution.smoothed.omega_b + series.gyro_b, axis=1))))
    if spin * step < ALIAS_TURN_DEG:
        return ""
    turn = 360.0 / step
    return (
        f"Sampled every {step:g} s, a spin of {spin:.1f} deg/s looks like one of {turn - spin:.1f} deg/s the other way round or "
        f"{turn + spin:.1f} deg/s; the slowest is taken."
    )


def _recalibration(arc: Arc, solution: Solution) -> dict:
    """What the attitude changed in the calibration."""
    count = solution.constants.calibrated
    if not count:
        return {"refined": None}
    std = np.sqrt(np.diag(solution.constants.covariance)[:count])
    names = arc.calibration.parameter_names
    return {
        "refined": [
            {"name": n, "value": float(v), "std": float(s), "by_magnitude": float(b)}
            for n, v, s, b in zip(names, solution.constants.values[:count], std, arc.calibration.values, strict=True)
        ]
    }


def _provenance(arc: Arc, solution: Solution, use, seed: int) -> dict:
    """Versions, inputs, models and settings: what it takes to make the same bits again."""
    import importlib.metadata as metadata

    packages = ("fieldline", "numpy", "scipy", "numba", "pyerfa", "sgp4", "xarray")
    return {
        "versions": {name: metadata.version(name) for name in packages} | {"python": platform.python_version()},
        "inputs": {"telemetry": {"name": arc.telemetry.name, "sha256": arc.telemetry.sha256}, "orbit": arc.reference.orbit},
        "field_model": arc.reference.stamp,
        "settings": _settings(arc, solution, use, seed),
        "noise": solution.smoothed.noise._asdict() | {"rate_noise_rad_s15": float(solution.smoothed.model.noise)},
    }
