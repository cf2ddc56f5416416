"""The chapters of the report that are tables and words: candidates, calibration, judgement, input, provenance."""

from __future__ import annotations

from collections.abc import Sequence
from math import floor, isfinite, log10
from typing import Any

from fieldline.report.markup import facts, flat, number, sentences, table, text
from fieldline.report.theme import AXES

KEPT = '<span class="good">kept</span>'
DROPPED = '<span class="poor">dropped</span>'
CANDIDATE_WORDS = (
    "A candidate is named after its first motion: what moved it, how fast it turned, and its misfit over its first rows (1: as "
    "the noise has it). The log-likelihood counts every sample; the last column counts those that repeat each other once."
)
REFINED_WORDS = (
    "Once the attitude is known, direction calibrates too. The estimate uses these values; the gain is refined with them. "
    "What moved by more than a few sigma is a hint that one of the two models is wrong."
)
SCALES = (("_tesla_s", 1e9, "nT/s"), ("_tesla", 1e6, "µT"))  # ending of a parameter's name, factor, unit


def candidates_table(candidates: list[dict[str, Any]]) -> str:
    """The starts that were refined: which were kept, which dropped, and why; the best first."""
    if not candidates:
        return ""
    best = max((c["log_likelihood"] for c in candidates if c.get("log_likelihood") is not None), default=0.0)

    def row(one: dict[str, Any]) -> list[str]:
        likelihood = one.get("log_likelihood")
        below = "–" if likelihood is None else number(likelihood - best, 5)
        rms = "–" if one.get("residual_rms_nt") is None else number(float(one["residual_rms_nt"]), 3)
        return [text(one.get("name", "")), KEPT if one.get("kept") else DROPPED, below, rms, text(one.get("words", ""))]

    heads = ("candidate", "", "log-likelihood below the best", "residual [nT]", "why")
    return table(heads, map(row, candidates), "numbers") + f"<p><small>{CANDIDATE_WORDS}</small></p>"


def calibration_tables(calibration: dict[str, Any]) -> str:
    """Bias, matrix and other parameters with their uncertainty, and the models that were tried."""
    parts = [f"<p>{text(calibration['sentence'])}</p>"] if calibration.get("sentence") else []
    if calibration.get("bias_ut"):
        parts.append(_bias_and_matrix(calibration))
    others = [p for p in calibration.get("parameters", []) if not p["name"].startswith(("bias", "matrix", "gain_"))]
    if others:
        parts.append(table(("parameter", "value", "1σ"), [_parameter(p, ("value",)) for p in others], "numbers"))
    refined = [p for p in calibration.get("refined") or [] if not p["name"].startswith("gain_")]
    if refined:
        heads = ("parameter", "by magnitude alone", "with the attitude", "1σ")
        rows = [_parameter(p, ("by_magnitude", "value")) for p in refined]
        parts.append("<h3>Refined with the attitude</h3>" + f"<p>{REFINED_WORDS}</p>" + table(heads, rows, "numbers"))
    if calibration.get("candidates"):
        parts.append("<h3>Models that were tried</h3>" + _models(calibration["candidates"]))
    return "".join(parts)


def _parameter(one: dict[str, Any], keys: Sequence[str]) -> list[str]:
    """Name with its unit, the values of these keys, and the uncertainty, to the digits that it leaves."""
    name, factor, unit = one["name"], 1.0, ""
    for ending, scale, shown in SCALES:
        if name.endswith(ending):
            name, factor, unit = name.removesuffix(ending), scale, f" [{shown}]"
            break
    std = one.get("std")
    values = [_to_digits_of(factor * one[key], None if std is None else factor * std) for key in keys]
    return [text(name.replace("_", " ")) + unit, *values, "–" if std is None else number(factor * std, 2)]


def _to_digits_of(value: float, std: float | None) -> str:
    """A value to two digits of its uncertainty."""
    if not std or not isfinite(std):
        return number(value)
    decimals = max(0, min(12, 1 - floor(log10(std))))
    return f"{value:.{decimals}f}".replace("-", "−")


def _bias_and_matrix(calibration: dict[str, Any]) -> str:
    """A row for each axis: bias, its sigma, the row of the matrix with its sigmas."""
    bias, bias_std = calibration["bias_ut"], calibration.get("bias_std_ut") or [None] * 3
    matrix, matrix_std = calibration.get("matrix") or [], calibration.get("matrix_std")
    rows = []
    for k, axis in enumerate(AXES):
        entries = []
        for m in range(3) if matrix else ():
            spread = f" <small>± {number(matrix_std[k][m], 2)}</small>" if matrix_std else ""
            entries.append(f"{matrix[k][m]:.5f}".replace("-", "−") + spread)
        spread = "" if bias_std[k] is None else f" <small>± {number(bias_std[k], 2)}</small>"
        rows.append([axis, f"{bias[k]:.3f}".replace("-", "−") + spread, *entries])
    heads = ("", "bias [µT]", *(f"matrix, {a}" for a in AXES if matrix))
    return table(heads, rows, "matrix")


def _models(candidates: list[dict[str, Any]]) -> str:
    """The calibration models with what they leave and why each was or was not chosen."""

    def row(one: dict[str, Any]) -> list[str]:
        cells = [number(float(one[key]), 3) if one.get(key) is not None else "–" for key in ("rms_nt", "held_out_rms_nt")]
        mark = '<span class="good">chosen</span>' if one.get("chosen") else ""
        return [text(one.get("model", "")), mark, text(one.get("parameters")), *cells, text(one.get("why", ""))]

    return table(("model", "", "parameters", "left [nT]", "left where not fitted [nT]", "why"), map(row, candidates), "numbers")


def motion_words(verdict: dict[str, Any]) -> str:
    """Which motion was assumed, with the inertia's ratios where they were found, and what the search for it remarked."""
    motion = verdict.get("motion") or {}
    words = f"<p>{text(str(motion.get('model', '')).capitalize())}: {text(motion['words'])}.</p>" if motion.get("words") else ""
    ratio = motion.get("inertia_ratio")
    if ratio:
        rows = [[axis, *(number(float(one), 3) for one in row)] for axis, row in zip(AXES, ratio, strict=True)]
        words += table(("inertia, mean 1", *AXES), rows, "numbers")
    aliases = [motion["aliases"]] if motion.get("aliases") else []
    return words + sentences(aliases + (verdict.get("remarks") or []))


def noise_words(noise: dict[str, Any]) -> str:
    """The noise that the data were found to have."""
    names = (
        ("white_nt", "white noise of an axis", "nT"),
        ("slow_nt", "slow error of an axis", "nT"),
        ("slow_time_s", "memory of the slow error", "s"),
        ("rate_noise_rad_s15", "wandering of the rate", "rad/s/√s"),
    )
    pairs = [(words, f"{number(float(noise[key]), 3)} {unit}") for key, words, unit in names if noise.get(key) is not None]
    return "<h3>Noise, found from the data</h3>" + facts(pairs) if pairs else ""


def judgement_table(judgement: list[dict[str, Any]]) -> str:
    """What sensors that were not used say of the estimate."""

    def row(one: dict[str, Any]) -> list[str]:
        passed = one.get("passed")
        mark = "–" if passed is None else '<span class="good">✓ passed</span>' if passed else '<span class="poor">✕ failed</span>'
        unit = f" {text(one.get('unit', ''))}" if one.get("unit") else ""
        limit = "–" if one.get("limit") is None else f"{text(one['limit'])}{unit}"
        value = "–" if one.get("value") is None else f"{number(float(one['value']), 3)}{unit}"
        return [text(one.get("what", "")), mark, value, limit, text(one.get("words", ""))]

    return table(("judge", "", "found", "limit", "in words"), map(row, judgement), "numbers") if judgement else ""


def input_tables(verdict: dict[str, Any]) -> str:
    """Telemetry quality in sentences, orbit and field model as facts."""
    orbit = {k: v for k, v in verdict.get("orbit", {}).items() if k != "warnings"}
    return "".join(
        (
            "<h3>Telemetry</h3>" + sentences(verdict.get("telemetry", {}).get("lines", [])),
            "<h3>Orbit</h3>" + facts(flat(orbit)) + sentences(verdict.get("orbit", {}).get("warnings", [])),
            "<h3>Field model</h3>" + facts(flat(verdict.get("field_model", {}))),
        )
    )


def provenance_table(settings: dict[str, Any], provenance: dict[str, Any], told: Sequence[dict[str, Any]] = ()) -> str:
    """Settings, versions, hashes: what is needed to make the same estimate again; what the page has `told` is left out."""
    parts = []
    if settings:
        parts.append("<h3>Settings</h3>" + facts(flat(settings)))
    rest = _without(provenance, [settings, *told])
    if rest:
        parts.append("<h3>Versions and files</h3>" + facts(flat(rest)))
    return "".join(parts)


def _without(record: dict[str, Any], told: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """The record less those parts that stand elsewhere on the page."""
    return {
        key: _without(value, told) if isinstance(value, dict) else value
        for key, value in record.items()
        if not (isinstance(value, dict) and value in told)
    }
