"""The report on a skiprope: verdict, the next crossings, signals, place, settling, spectrum, what the data cannot tell."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fieldline.files import write_whole
from fieldline.report.markup import facts, number, section, sentences, table, text
from fieldline.report.skiprope_figures import SkipropeRecord
from fieldline.report.theme import Picture, themed, write_png, write_svg

if TYPE_CHECKING:
    import xarray

STATES = {True: "usable", False: "refused"}
SENSES = {1: "from the orbit's normal towards the rear", -1: "from the orbit's normal towards the front", 0: "not to be told"}


def is_skiprope(dataset: xarray.Dataset) -> bool:
    """Whether a Dataset is one of `estimate_skiprope`."""
    return "spectrum_forward_rad" in dataset


def skiprope_html(estimate: xarray.Dataset) -> str:
    """The report as text, one page without script or network; the same estimate gives the same text."""
    from fieldline.report import chapters
    from fieldline.report.page import drawings, page
    from fieldline.report.verdict import WORDS, panel

    record = SkipropeRecord(estimate)
    verdict, pictures = record.verdict, skiprope_pictures(record)
    state = STATES[verdict["usable"]]
    words = WORDS[state] if verdict["detected"] else "no skiprope found"
    chapter = {name: drawings([picture]) for name, picture in pictures.items()}
    return page(
        f"Skiprope from {verdict['telemetry']['name']}",
        _span(record),
        panel(state, words, verdict["sentence"], verdict["warnings"]) + key_numbers(record),
        [
            (
                "crossings",
                section("crossings", f"Next crossings of the plane: {verdict['settings']['plane']}", _crossings(record)),
            ),
            ("place", section("place", "Place", chapter.get("place", ""))),
            ("signals", section("signals", "Signals", chapter.get("signals", ""))),
            ("settling", section("settling", "Settling", chapter.get("settling", ""))),
            ("spectrum", section("spectrum", "Spectrum", chapter.get("spectrum", ""))),
            ("limits", section("limits", "What the data cannot tell", sentences(limits(verdict)))),
            ("input", section("input", "Input", chapters.input_tables(verdict))),
            (
                "provenance",
                section(
                    "provenance",
                    "Provenance",
                    chapters.provenance_table(verdict["settings"], record.provenance, [verdict["orbit"], verdict["field_model"]]),
                ),
            ),
        ],
        "U is along the velocity, V along the orbit's normal, W up. Azimuths count from V towards against the flight (-U). The "
        "deflection takes the tether for half a sine.",
    )


def write_skiprope_report(estimate: xarray.Dataset, path: str | Path) -> Path:
    """The page as a file, whole or not at all."""
    html = skiprope_html(estimate)
    return write_whole(path, lambda beside: beside.write_text(html, encoding="utf-8"))


def write_skiprope_figures(estimate: xarray.Dataset, folder: str | Path) -> list[Path]:
    """Every figure as PNG and SVG in a folder, which is made if need be."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    written = []
    for picture in skiprope_pictures(SkipropeRecord(estimate)).values():
        written.append(write_whole(folder / f"{picture.name}.png", lambda path, p=picture: write_png(p.figure, path)))
        written.append(write_whole(folder / f"{picture.name}.svg", lambda path, p=picture: write_svg(p.figure, path)))
    return written


def skiprope_pictures(record: SkipropeRecord) -> dict[str, Picture]:
    """All figures that there is something for."""
    from fieldline.report.skiprope_figures import place_picture, settling_picture, signals_picture, spectrum_picture

    with themed():
        drawn = (place_picture(record), signals_picture(record), settling_picture(record), spectrum_picture(record))
    return {picture.name: picture for picture in drawn if picture is not None}


def key_numbers(record: SkipropeRecord) -> str:
    """The table of what a reader wants to know first."""
    verdict = record.verdict
    pairs = [("Method", text(verdict["method"]))]
    if verdict["detected"]:
        period = 1.0 / verdict["frequency_hz"]
        pairs += [
            ("Tilt", f"{_pm(verdict['amplitude_deg'], verdict['amplitude_std_deg'])} deg, half axes "
             f"{number(verdict['major_deg'], 3)} and {number(verdict['minor_deg'], 3)} deg"),
            ("Deflection at the middle", f"{_pm(verdict['deflection_m'], verdict['deflection_std_m'])} m"),
            ("Frequency", f"{_pm(1e3 * verdict['frequency_hz'], 1e3 * verdict['frequency_std_hz'])} mHz, "
             f"a turn in {number(period, 4)} s"),
            ("Turning", text(SENSES[verdict["sense"]])),
            ("Azimuth of the middle", f"{_pm(verdict['plane_deg'], verdict['plane_std_deg'])} deg at {text(verdict['row_utc'])}"),
            ("To be trusted", _when(verdict)),
        ]  # fmt: skip
    elif verdict["threshold_deg"] is not None:
        pairs.append(("Would have been seen", f"a round cone of {number(verdict['threshold_deg'], 2)} deg"))
    pairs.append(("False-alarm probability", number(verdict["false_alarm"], 3)))
    pairs.append(("Arc", f"{len(record.seconds):,} samples over {number(record.seconds[-1] / 60.0, 3)} min"))
    return facts(pairs)


def limits(verdict: dict[str, Any]) -> list[str]:
    """What a magnetometer does not see, with this record's own numbers."""
    lines = list(verdict["notes"])
    if not verdict["detected"]:
        return lines
    if verdict["yaw_measured"]:
        lines.append("The telemetry's yaw was used, so that the azimuth of the known field does not matter to the plane.")
    else:
        lines.append(
            f"Without a measured yaw {verdict['floor_deg']:.2g} deg of the plane's deviation remain however long the record is. "
            "A yaw column (yaw_deg) would lower that."
        )
    lines.append("The deflection is the tilt times length over pi: exact for half a sine, a few per cent off for a heavy line.")
    return lines


def _crossings(record: SkipropeRecord) -> str:
    """The next three after the last row."""
    if not record.detected:
        return ""
    data = record.dataset
    rows = []
    for k in range(data.sizes["crossing"]):
        at = np.datetime_as_string(data["crossing_time"].values[-1, k], unit="ms").replace("T", " ")
        side = "on the side of its azimuth" if data["crossing_towards"].values[-1, k] else "on the far side"
        azimuth = (float(record.values("crossing_plane_rad", 180.0 / np.pi)[-1, k]) + 180.0) % 360.0 - 180.0
        rows.append([str(k + 1), f"{at[:-2]} UTC", f"{number(float(data['crossing_std_s'].values[-1, k]), 2)} s",
                     f"{number(azimuth, 3)} deg", side])  # fmt: skip
    return table(("", "time", "1σ", "azimuth of the plane", "the tether's middle then"), rows, "numbers")


def _when(verdict: dict[str, Any]) -> str:
    """From when on the estimate may be trusted."""
    after = verdict["trusted_after_s"]
    return "not yet: give a longer record" if after is None else f"from {number(after, 4)} s after the first sample on"


def _pm(value: float, std: float) -> str:
    """Value and deviation, the value to the deviation's second digit."""
    digits = int(np.clip(1 - np.floor(np.log10(std)), 0, 9)) if std > 0.0 and np.isfinite(std) else 3
    return f"{value:.{digits}f} ± {std:.{digits}f}".replace("-", "−")


def _span(record: SkipropeRecord) -> str:
    """The arc in words."""
    start, stop = (np.datetime_as_string(record.time_utc[k], unit="s").replace("T", " ") for k in (0, -1))
    return f"{start} to {stop} UTC · {len(record.seconds):,} samples"
