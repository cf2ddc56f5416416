"""The report on an estimate: which figures and chapters it has, as one HTML file or as separate pictures."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fieldline.files import write_text_whole, write_whole
from fieldline.report.record import Record, dark_spells
from fieldline.report.theme import Picture, themed, write_png, write_svg

if TYPE_CHECKING:
    import xarray


def write_report(estimate: xarray.Dataset, path: str | Path) -> Path:
    """Write the report on an estimate as one self-contained HTML file, whole or not at all.

    Parameters
    ----------
    estimate : Dataset of `estimate_attitude`, in SI; the report shows degrees, kilometres and microtesla, and says so.
    path : the file to write.

    Errors: InputError where the folder does not exist or cannot be written to.
    """
    return write_text_whole(path, report_html(estimate))


def report_html(estimate: xarray.Dataset) -> str:
    """The report as text; the same estimate gives the same text."""
    from fieldline.report import chapters
    from fieldline.report.markup import section
    from fieldline.report.page import drawings, page
    from fieldline.report.verdict import key_numbers, verdict_panel

    record = Record(estimate)
    verdict, groups = record.verdict, _pictures(record)
    calibration = verdict.get("calibration", {})
    return page(
        f"Attitude from {_name(record)}",
        _span(record),
        verdict_panel(verdict) + key_numbers(record),
        [
            ("field", section("field", "Field", drawings(groups["field"]))),
            ("motion", section("motion", "Motion", chapters.motion_words(verdict), drawings(groups["motion"]))),
            (
                "residuals",
                section(
                    "residuals", "Residuals", drawings(groups["residuals"]), chapters.noise_words(verdict.get("noise") or {})
                ),
            ),
            ("candidates", section("candidates", "Candidates", chapters.candidates_table(verdict.get("candidates", [])))),
            (
                "calibration",
                section("calibration", "Calibration", chapters.calibration_tables(calibration), drawings(groups["calibration"])),
            ),
            (
                "judgement",
                section(
                    "judgement",
                    "Judgement by sensors that were not used",
                    chapters.judgement_table(verdict.get("judgement", [])),
                    drawings(groups["judgement"]),
                ),
            ),
            ("input", section("input", "Input", chapters.input_tables(verdict))),
            (
                "provenance",
                section(
                    "provenance",
                    "Provenance",
                    chapters.provenance_table(
                        verdict.get("settings", {}),
                        {key: value for key, value in record.provenance.items() if key != "noise"},
                        [verdict.get("orbit", {}), verdict.get("field_model", {})],
                    ),
                ),
            ),
        ],
        "Body axes are the magnetometer's axes as the file gives them; a constant turn between them and the satellite's is not "
        "seen by a magnetometer. Quaternions are scalar last and take body vectors to inertial (GCRS) axes.",
    )


def write_figures(estimate: xarray.Dataset, folder: str | Path) -> list[Path]:
    """Every figure of the report as PNG and SVG in a folder, which is made if need be."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    written = []
    for picture in (p for group in _pictures(Record(estimate)).values() for p in group):
        written.append(write_whole(folder / f"{picture.name}.png", lambda path, p=picture: write_png(p.figure, path)))
        written.append(write_whole(folder / f"{picture.name}.svg", lambda path, p=picture: write_svg(p.figure, path)))
    return written


def _pictures(record: Record) -> dict[str, list[Picture]]:
    """All figures, by chapter, those that the Dataset has the variables for."""
    from fieldline.report.calibration_figures import gain_picture, slow_error_picture
    from fieldline.report.field_figures import field_picture, magnitude_picture
    from fieldline.report.judgement_figures import gyro_picture, sun_picture
    from fieldline.report.motion_figures import attitude_picture, rate_picture, uncertainty_picture
    from fieldline.report.residual_figures import residual_picture, whiteness_picture
    from fieldline.report.track_figure import track_picture

    with themed():
        dark = _eclipses(record)
        gain = gain_picture(record.verdict.get("calibration", {}), record.time_utc[0], dark)
        groups = {
            "field": [field_picture(record), magnitude_picture(record)],
            "motion": [rate_picture(record), attitude_picture(record), uncertainty_picture(record)],
            "residuals": [residual_picture(record), whiteness_picture(record), track_picture(record)],
            "calibration": [gain, slow_error_picture(record, dark)],
            "judgement": [gyro_picture(record), sun_picture(record)],
        }
    return {name: [p for p in group if p is not None] for name, group in groups.items()}


def _eclipses(record: Record) -> list[tuple[float, float]]:
    """Start and stop [s] of each stay in the shadow."""
    return dark_spells(record.seconds, record.values("sunlit")) if record.has("sunlit") else []


def _name(record: Record) -> str:
    """The telemetry's name, as the provenance has it."""
    return str(record.provenance.get("inputs", {}).get("telemetry", {}).get("name", "telemetry"))


def _span(record: Record) -> str:
    """The arc in words."""
    start, stop = (np.datetime_as_string(record.time_utc[k], unit="s").replace("T", " ") for k in (0, -1))
    return f"{start} to {stop} UTC · {len(record.seconds):,} samples"
