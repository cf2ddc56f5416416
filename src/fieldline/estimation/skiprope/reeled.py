"""A tether on the reel whose length is known: time stretched so that its skiprope keeps its frequency, piece by piece.

    dtau = f(L(t)) / f(L(t_m)) dt                                                                               (1)

about the middle t_m of a piece, with f of `line_band`; in tau the cone is that of a tether of constant length. Each piece of
2,500 s is estimated by itself, every 1,250 s, and rows are taken of the middle half of each (the first from its start, the last
to its end); their frequency is f(L(t)) / f(L(t_m)) times that found. Deflections are those of the length at the row's time.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fieldline.errors import NoEstimateError
from fieldline.estimation.skiprope.estimate import SURE, estimate_skiprope
from fieldline.estimation.skiprope.line_band import line_band, line_frequency
from fieldline.estimation.skiprope.signals import SkipropeSignals
from fieldline.estimation.skiprope.solution import SkipropeEstimate

PIECE_S, STEP_S, STEADY_S = 2500.0, 1250.0, 800.0
ROWS = (
    "trusted", "phasor", "covariance", "frequency_hz", "frequency_std_hz", "sense", "yaw_rad", "yaw_std_rad", "azimuth_off_rad",
    "amplitude_rad", "amplitude_std_rad", "major_rad", "major_std_rad", "minor_rad", "minor_std_rad", "phase_rad",
    "phase_std_rad", "plane_rad", "plane_std_rad", "deflection_m", "deflection_std_m", "position_m", "position_covariance_m2",
)  # fmt: skip


def estimate_reeled(
    signals: SkipropeSignals,
    length_m,
    *,
    mean_motion_rad_s: float,
    ratio_m: float | None = None,
    frequency_hz: float | None = None,
    memory_s: float | None = None,
    false_alarm: float = 0.01,
    **given,
) -> SkipropeEstimate:
    """The skiprope of a tether of lengths length_m (n,) [m] at the signals' times; `given` as for `estimate_skiprope`.

    ratio_m : end mass over mass per length [m]; without it the line counts as light. frequency_hz : at the first sample.

    Errors: NoEstimateError where no piece is long enough.
    """
    times = signals.seconds
    length = np.broadcast_to(np.asarray(length_m, dtype=float), times.shape)
    rate = line_frequency(length, mean_motion_rad_s, ratio_m)
    cycles = np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(times))])
    starts = piece_starts(times[0], times[-1])
    found, refused = [], None
    for start in starts:
        middle = start + 0.5 * PIECE_S
        inside = (times >= start) & (times <= start + PIECE_S + (1e-6 if start < starts[-1] else PIECE_S))
        if not inside.any():
            continue
        there = float(np.interp(middle, times, rate))
        tau = middle + (cycles[inside] - np.interp(middle, times, cycles)) / there
        part = SkipropeSignals(tau, signals.field_b[inside], type(signals.geometry)(*(x[inside] for x in signals.geometry)))
        at_middle = float(np.interp(middle, times, length))
        first = None if frequency_hz is None else frequency_hz * there / rate[0]
        band = line_band(at_middle, mean_motion_rad_s, ratio_m)
        share = -np.expm1(np.log1p(-false_alarm) / len(starts))  # of a record of many pieces
        try:
            one = estimate_skiprope(
                part,
                false_alarm=share,
                tether_length_m=1.0,
                frequency_hz=first,
                memory_s=memory_s or STEADY_S,
                band_hz=band,
                **given,
            )
        except NoEstimateError as error:
            refused = error
            continue
        found.append(_back(one, start, starts, (times[inside], tau, rate[inside] / there, length[inside])))
    if not found:
        raise refused or NoEstimateError("no piece of the record holds samples; give a longer record.")
    return _joined(found, length)


def piece_starts(first_s: float, last_s: float) -> np.ndarray:
    """[s] starts of the pieces: every STEP_S while a whole piece follows, one at least."""
    return first_s + STEP_S * np.arange(max(int((last_s - first_s - PIECE_S) / STEP_S + 1e-9), 0) + 1)


def _back(one: SkipropeEstimate, start: float, starts, columns) -> SkipropeEstimate:
    """A piece's estimate in its own time and length, its middle half."""
    times, tau, pace, length = columns
    at = np.interp(one.seconds, tau, times)
    edge = 0.5 * (PIECE_S - STEP_S)
    kept = (at >= (start + edge if start > starts[0] else -np.inf)) & (
        at < (start + edge + STEP_S if start < starts[-1] else np.inf)
    )
    pace, length = np.interp(at, times, pace), np.interp(at, times, length)
    if one.method == "harmonic" and start > starts[0] and one.trusted.any():  # windows on both sides of each row kept
        one = replace(one, trusted=one.amplitude_std_rad < SURE * one.amplitude_rad)
    rows = {name: getattr(one, name)[kept] for name in ROWS}
    pace, length = pace[kept], length[kept]
    rows["frequency_hz"], rows["frequency_std_hz"] = rows["frequency_hz"] * pace, rows["frequency_std_hz"] * pace
    rows = rows | in_metres(rows, length)
    return replace(one, seconds=at[kept], **rows)


def in_metres(rows, factor) -> dict[str, np.ndarray]:
    """Deflections and places, with their deviations, times a factor (m,); rows by name, or an estimate."""
    of = rows.__getitem__ if isinstance(rows, dict) else lambda name: getattr(rows, name)
    return {
        "deflection_m": of("deflection_m") * factor,
        "deflection_std_m": of("deflection_std_m") * factor,
        "position_m": of("position_m") * factor[:, None],
        "position_covariance_m2": of("position_covariance_m2") * (factor**2)[:, None, None],
    }


def _joined(pieces: list[SkipropeEstimate], length) -> SkipropeEstimate:
    """All pieces in which something was found as one; the last one where there are none."""
    found = [one for one in pieces if one.detected]
    if not found:
        return pieces[-1]
    rows = {name: np.concatenate([getattr(one, name) for one in found]) for name in ("seconds", *ROWS)}
    good = rows["trusted"]
    shown = good if good.any() else np.ones(len(good), dtype=bool)
    hz, tilt = 1e3 * rows["frequency_hz"][shown][[0, -1]], np.degrees(rows["amplitude_rad"][shown][[0, -1]])
    middle = rows["deflection_m"][shown][[0, -1]]
    verdict = (
        f"skiprope: followed while {1e-3 * length[0]:.3g} km of tether became {1e-3 * length[-1]:.3g} km, from {hz[0]:.3g} to "
        f"{hz[1]:.3g} mHz, {tilt[0]:.2g} to {tilt[1]:.2g} deg, {middle[0]:.3g} to {middle[1]:.3g} m at the middle"
    )
    notes = list(found[-1].notes)
    if len(found) < len(pieces):
        notes.append(f"nothing was found in {len(pieces) - len(found)} of {len(pieces)} pieces of the record.")
    return replace(
        found[-1],
        trusted_from_s=float(rows["seconds"][good.argmax()]) if good.any() else np.nan,
        verdict=verdict + ("." if good.any() else "; not to be trusted yet."),
        notes=tuple(notes),
        tether_length_m=float(length[-1]),
        **rows,
    )
