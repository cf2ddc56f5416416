"""The head of the report: the verdict in one sentence, its colour, and the numbers that it rests on."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from fieldline.report.markup import facts, number, sentences, text
from fieldline.report.record import Record

MARKS = {"usable": "✓", "doubtful": "!", "refused": "✕"}
WORDS = {"usable": "Usable", "doubtful": "Usable with doubts", "refused": "Not usable"}


def standing(verdict: dict[str, Any]) -> str:
    """usable, doubtful (a judge failed or the residuals do not fit their uncertainty) or refused."""
    if not verdict.get("usable", False):
        return "refused"
    failed = any(judge.get("passed") is False for judge in verdict.get("judgement", []))
    words = str(verdict.get("consistency", {}).get("words", "consistent"))
    return "doubtful" if failed or not words.startswith("consistent") else "usable"


def verdict_panel(verdict: dict[str, Any]) -> str:
    """The sentence, large, in the colour of its standing, with the warnings under it."""
    state = standing(verdict)
    sentence = str(verdict.get("sentence", ""))
    if sentence.startswith(f"{WORDS['usable']}: "):  # the state above says so
        sentence = sentence.removeprefix(f"{WORDS['usable']}: ")
        sentence = sentence[:1].upper() + sentence[1:]
    return panel(state, WORDS[state], sentence, [*doubts(verdict), *verdict.get("warnings", [])])


def doubts(verdict: dict[str, Any]) -> list[str]:
    """A sentence for each judge that failed and for residuals that do not fit their uncertainty."""
    if not verdict.get("usable", False):
        return []
    found = []
    for one in verdict.get("judgement", []):
        if one.get("passed") is False:
            value = "" if one.get("value") is None else f" {float(one['value']):.3g} {one.get('unit', '')}".rstrip()
            words = f" ({one['words']})" if one.get("words") else ""
            found.append(f"Doubt: {one.get('what', 'a judge')}:{value}{words}")
    words = str(verdict.get("consistency", {}).get("words", "consistent"))
    return found if words.startswith("consistent") else [*found, f"Doubt: {words}"]


def panel(state: str, words: str, sentence: str, lines: Sequence[str] = ()) -> str:
    """A coloured box that opens a report."""
    return (
        f'<div class="verdict {state}" role="status"><span class="mark" aria-hidden="true">{MARKS[state]}</span>'
        f'<div><p class="state">{words}</p><p class="sentence">{text(sentence)}</p>{sentences(lines)}</div></div>'
    )


def key_numbers(record: Record) -> str:
    """The table of what a reader wants to know first."""
    verdict = record.verdict
    pairs = [
        ("Attitude, 1σ about body x, y, z", _triple(verdict.get("attitude_std_deg"), "deg")),
        ("Rate, 1σ about body x, y, z", _triple(verdict.get("rate_std_deg_s"), "deg/s")),
        ("Rate, median about body x, y, z", _triple(_median_rate(record), "deg/s")),
        ("Residual of the field", _one(verdict.get("residual_rms_nt"), "nT RMS per axis")),
        ("Consistency", _consistency(verdict.get("consistency", {}))),
        ("Calibration", _calibration(verdict.get("calibration", {}))),
        ("Samples used", f"{int(record.used.sum()):,} of {len(record.seconds):,}"),
        ("Arc", _arc(record)),
    ]
    return facts((name, value) for name, value in pairs if value)


def _median_rate(record: Record) -> list[float]:
    """(3,) [deg/s]."""
    return list(np.nanmedian(record.values("omega_bi_b", 180.0 / np.pi), axis=0))


def _triple(values: list[float] | None, unit: str) -> str:
    """Three numbers with one unit."""
    return f"{' · '.join(number(float(v), 3) for v in values)} {unit}" if values else ""


def _one(value: float | None, unit: str) -> str:
    """A number with its unit, or nothing."""
    return "" if value is None else f"{number(float(value), 3)} {unit}"


def _consistency(consistency: dict[str, Any]) -> str:
    """For example: consistent; NIS 0.98, expected 0.95 to 1.05."""
    parts = [text(consistency["words"])] if consistency.get("words") else []
    if consistency.get("nis_mean") is not None:
        band = consistency.get("nis_band") or []
        expected = f", expected {number(float(band[0]), 3)} to {number(float(band[1]), 3)}" if len(band) == 2 else ""
        parts.append(f"NIS {number(float(consistency['nis_mean']), 3)}{expected}")
    return "; ".join(parts)


def _calibration(calibration: dict[str, Any]) -> str:
    """Model and what it leaves."""
    left = _one(calibration.get("rms_nt"), "nT RMS in magnitude")
    return ", ".join(part for part in (text(calibration.get("model", "")), left) if part)


def _arc(record: Record) -> str:
    """Start, length, step."""
    start = np.datetime_as_string(record.time_utc[0], unit="s").replace("T", " ")
    minutes = float(record.seconds[-1]) / 60.0
    length = f"{number(minutes, 3)} min" if minutes < 600.0 else f"{number(minutes / 60.0, 3)} h"
    return f"{start} UTC, {length}, every {number(record.step_s, 3)} s"
