"""The report on a calibration: what was found, how well, and what it leaves, for each flight."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fieldline.report.record import MICROTESLA, MagnitudeRecord, lengths
from fieldline.report.theme import Picture, themed


@dataclass(frozen=True, kw_only=True)
class CalibratedFlight:
    """One flight's readings before and after.

    time_utc (n,); field_s, field_b (n, 3) [T]; magnitude_tesla (n,) of the model; used (n,) bool; dark: (start, stop) [s] of
    each eclipse; lines: the telemetry's account in sentences.
    """

    name: str
    time_utc: np.ndarray
    field_s: np.ndarray
    field_b: np.ndarray
    magnitude_tesla: np.ndarray
    used: np.ndarray
    summary: dict[str, Any]
    lines: Sequence[str] = ()
    dark: Sequence[tuple[float, float]] = ()


def calibration_html(flights: Sequence[CalibratedFlight], settings: dict[str, Any], provenance: dict[str, Any]) -> str:
    """The report as text; the flights share matrix and bias, so those are told once."""
    from fieldline.report import chapters
    from fieldline.report.markup import section, sentences, text
    from fieldline.report.page import drawings, page
    from fieldline.report.verdict import panel

    first = flights[0]
    doubt = misfit(flights)
    state, words = ("refused", "Not usable") if doubt else ("usable", "Calibrated")
    head = panel(state, words, verdict_sentence([f.summary for f in flights]), [doubt] if doubt else [])
    inputs = "".join(f"<h3>{text(f.name)}</h3>{sentences(f.lines)}" for f in flights)
    return page(
        f"Calibration from {first.name}" + (f" and {len(flights) - 1} more" if len(flights) > 1 else ""),
        f"{sum(int(f.used.sum()) for f in flights):,} samples",
        head,
        [
            ("calibration", section("calibration", "Calibration", chapters.calibration_tables(first.summary))),
            ("magnitude", section("magnitude", "Magnitude", drawings(pictures(flights)))),
            ("input", section("input", "Input", inputs)),
            ("provenance", section("provenance", "Provenance", chapters.provenance_table(settings, provenance))),
        ],
        "The matrix is symmetric: a constant turn between the magnetometer's axes and the body's is not seen in magnitudes.",
    )


def verdict_sentence(summaries: Sequence[dict[str, Any]]) -> str:
    """For example: model full+gain, bias (99.8, -30.1, -28.6) ± 0.1 µT, leaves 612 nT RMS in magnitude."""
    first = summaries[0]
    bias = ", ".join(f"{b:.2f}" for b in first["bias_ut"])
    rms = ", ".join(f"{s['rms_nt']:.0f}" for s in summaries)
    return f"model {first['model']}, bias ({bias}) ± {max(first['bias_std_ut']):.2g} µT, leaves {rms} nT RMS in magnitude"


def misfit(flights: Sequence[CalibratedFlight]) -> str:
    """Why the calibration explains a flight no better than chance, in a sentence; empty where it explains them all."""
    from fieldline.estimation.verdict import LARGEST_MAGNITUDE_SHARE

    for flight in flights:
        share = 1e-9 * flight.summary["rms_nt"] / float(np.median(flight.magnitude_tesla))
        if share > LARGEST_MAGNITUDE_SHARE:
            return (
                f"No usable calibration: the magnitude of {flight.name} misses the model's by {100 * share:.0f} % RMS. Check "
                "that orbit and time stamps (UTC) belong to this satellite, and the unit."
            )
    return ""


def pictures(flights: Sequence[CalibratedFlight]) -> list[Picture]:
    """For each flight its magnitudes and, where there is one, its gain."""
    from fieldline.report.calibration_figures import gain_picture
    from fieldline.report.field_figures import magnitudes_picture

    drawn: list[Picture | None] = []
    with themed():
        for k, flight in enumerate(flights):
            of = flight.name if len(flights) > 1 else ""
            before, after = (lengths(field * MICROTESLA) for field in (flight.field_s, flight.field_b))
            record = MagnitudeRecord(flight.time_utc, before, after, flight.magnitude_tesla * MICROTESLA, flight.used)
            drawn += [
                magnitudes_picture(record, f"magnitude_{k + 1}", of),
                gain_picture(flight.summary, flight.time_utc[0], flight.dark),
            ]
    return [picture for picture in drawn if picture is not None]
