"""The report on a simulated run: which figures and chapters it has, as one HTML file or as separate pictures."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fieldline.errors import InputError
from fieldline.files import write_text_whole, write_whole
from fieldline.report.run_record import MOST_BODIES, RunRecord
from fieldline.report.theme import Picture, themed, write_png, write_svg

if TYPE_CHECKING:
    import xarray

MOST_EVENTS = 200  # rows of the table
FOOT = (
    "Body axes are the scenario's. Quaternions are scalar last and take body vectors to inertial (GCRS) axes. Long series are "
    "drawn through the extremes of each pixel column; the NetCDF file has every output."
)


def is_run(dataset: xarray.Dataset) -> bool:
    """Whether a Dataset is one of `fieldline.simulate`."""
    return "scenario_toml" in dataset.attrs and "torque_b" in dataset


def write_simulation_report(dataset: xarray.Dataset, path: str | Path) -> Path:
    """Write the report on a run as one self-contained HTML file, whole or not at all.

    Parameters
    ----------
    dataset : of `fieldline.simulate`, whole or partial, in memory or opened from its NetCDF file.
    path : the file to write.

    Errors: InputError where the run has less than two outputs, or the folder does not exist or cannot be written to.
    """
    return write_text_whole(path, simulation_html(dataset))


def simulation_html(dataset: xarray.Dataset) -> str:
    """The report as text; the same run gives the same text."""
    from fieldline.report.approach_figures import approach_table
    from fieldline.report.line_animation import animation_html
    from fieldline.report.markup import facts, flat, section
    from fieldline.report.page import drawings, page
    from fieldline.report.run_load_figures import load_table
    from fieldline.report.run_numbers import run_numbers

    record = _record(dataset)
    numbers = run_numbers(dataset)
    groups = _pictures(record)
    return page(
        record.scenario.name,
        _span(record),
        _verdict(record, numbers) + _key_numbers(record, numbers),
        [
            ("motion", section("motion", "Motion", _left_out(record), drawings(groups["motion"]))),
            ("bodies", section("bodies", "Several bodies", drawings(groups["bodies"]))),
            ("lines", section("lines", "Lines", animation_html(record), drawings(groups["lines"]))),
            ("approach", section("approach", "By current", drawings(groups["approach"]), approach_table(record))),
            ("field", section("field", "Field and Sun", drawings(groups["field"]))),
            ("loads", section("loads", "Loads", drawings(groups["loads"]), load_table(record))),
            ("actuators", section("actuators", "Actuators", drawings(groups["actuators"]))),
            ("knowledge", section("knowledge", "Knowledge and truth", drawings(groups["knowledge"]))),
            ("sensors", section("sensors", "Sensors", drawings(groups["sensors"]))),
            ("events", section("events", "Events", _events(record))),
            ("scenario", section("scenario", "Scenario", _scenario_text(dataset))),
            ("provenance", section("provenance", "Provenance", facts(flat(record.provenance)))),
        ],
        FOOT,
    )


def simulation_figures(dataset: xarray.Dataset) -> list[Picture]:
    """Every figure of the report, with its words."""
    return [picture for group in _pictures(_record(dataset)).values() for picture in group]


def write_simulation_figures(dataset: xarray.Dataset, folder: str | Path) -> list[Path]:
    """Every figure of the report as PNG and SVG in a folder, which is made if need be."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    written = []
    for picture in simulation_figures(dataset):
        written.append(write_whole(folder / f"{picture.name}.png", lambda path, p=picture: write_png(p.figure, path)))
        written.append(write_whole(folder / f"{picture.name}.svg", lambda path, p=picture: write_svg(p.figure, path)))
    return written


def _record(dataset: Any) -> RunRecord:
    """The run, where there is enough of it to draw."""
    if dataset.sizes["time"] < 2:
        raise InputError(f"the run has {dataset.sizes['time']} outputs; a report needs two. It ended: {dataset.attrs['outcome']}")
    return RunRecord(dataset)


def _pictures(record: RunRecord) -> dict[str, list[Picture]]:
    """All figures, by chapter, those that the run has the signals for."""
    from fieldline.report.approach_figures import approach_pictures
    from fieldline.report.run_line_figures import line_pictures
    from fieldline.report.run_load_figures import actuator_pictures, torque_picture
    from fieldline.report.run_motion_figures import attitude_picture, place_picture, pointing_picture, rate_picture
    from fieldline.report.run_orbit_figures import orbit_picture
    from fieldline.report.run_relative_figures import relative_picture, separation_picture
    from fieldline.report.run_sensor_figures import knowledge_picture, sensor_picture

    with themed():
        groups: dict[str, list[Picture | None]] = {
            "motion": [
                *(draw(record, b) for b in record.rigid for draw in (rate_picture, pointing_picture, attitude_picture)),
                *(orbit_picture(record, b) for b in range(min(len(record.bodies), MOST_BODIES))),
            ],
            "bodies": [separation_picture(record), relative_picture(record)],
            "approach": [picture for b in record.rigid for picture in approach_pictures(record, b)],
            "lines": [*line_pictures(record)],
            "field": [place_picture(record)],
            "loads": [torque_picture(record, b) for b in record.rigid],
            "actuators": [picture for b in record.rigid for picture in actuator_pictures(record, b)],
            "knowledge": [knowledge_picture(record, b) for b in record.rigid],
            "sensors": [sensor_picture(record, b) for b in record.rigid],
        }
    return {name: [p for p in group if p is not None] for name, group in groups.items()}


def _verdict(record: RunRecord, numbers: dict[str, Any]) -> str:
    """The outcome, large: green where the run went to its end, red where it is partial; and what to know of its lines."""
    from fieldline.report.run_line_numbers import line_warnings
    from fieldline.report.verdict import panel

    state, words = ("usable", "Flown") if record.complete else ("refused", "Partial")
    outcome = str(record.dataset.attrs.get("outcome", ""))
    notes = [] if record.complete else ["Everything below ends where the run ended."]
    notes += [note for name, line in numbers["lines"].items() for note in line_warnings(name, line)]
    return panel(state, words, outcome[:1].upper() + outcome[1:], notes)


def _key_numbers(record: RunRecord, numbers: dict[str, Any]) -> str:
    """The table of what a reader wants to know first."""
    from fieldline.report.markup import facts, number, text
    from fieldline.report.run_line_numbers import line_pairs

    pairs = [("About", text(record.scenario.description))] if record.scenario.description else []
    pairs.append(("Run", f"{number(numbers['duration_s'] / 3600.0, 4)} h, {numbers['samples']:,} outputs"))
    for name, body in numbers["bodies"].items():
        of = f"{text(name)}: " if len(record.bodies) > 1 else ""
        start, end = number(body["rate_start_deg_s"], 3), number(body["rate_end_deg_s"], 3)
        pairs.append((f"{of}rate at start and end", f"{start} → {end} deg/s"))
        if "at_rest_after_s" in body:
            pairs.append((f"{of}below 0.5 deg/s for good after", f"{number(body['at_rest_after_s'] / 3600.0, 3)} h"))
        if "pointing" in body:
            told = body["pointing"]
            error = " · ".join(f"{number(told[key], 3)}" for key in ("rms_deg", "worst_deg", "end_deg"))
            pairs.append((f"{of}pointing, last quarter: RMS · worst · end", f"{error} deg"))
        for what, share in body.get("saturated_share", {}).items():
            pairs.append((f"{of}{what} at their limit", f"{number(100.0 * share, 3)} % of the outputs"))
    for name, line in numbers["lines"].items():
        pairs += line_pairs(name, line)
    return facts([(name[:1].upper() + name[1:], value) for name, value in pairs])


def _left_out(record: RunRecord) -> str:
    """A sentence where not every body has figures."""
    rigid = sum(body.kind == "rigid" for body in record.scenario.body)
    if rigid <= len(record.rigid):
        return ""
    return f"<p>Figures of the first {len(record.rigid)} of {rigid} bodies that turn; the NetCDF file has all of them.</p>"


def _events(record: RunRecord) -> str:
    """The table of events."""
    from fieldline.report.markup import table, text

    dataset = record.dataset
    if not dataset.sizes.get("event", 0):
        return ""
    shown = slice(0, MOST_EVENTS)
    times = np.datetime_as_string(dataset["event_time"].values[shown].astype("datetime64[ms]"))
    after = (dataset["event_time"].values[shown] - record.time_utc[0]) / np.timedelta64(1, "s")
    ways = np.where(dataset["event_direction"].values[shown] > 0, "rising", "falling")
    names = dataset["event_name"].values[shown]
    rows = zip(map(text, names), ways, (one.replace("T", " ") for one in times), (f"{s:,.3f}" for s in after), strict=True)
    more = dataset.sizes["event"] - MOST_EVENTS
    return table(("event", "", "UTC", "after the start [s]"), rows, "numbers") + (
        f"<p>… and {more} more.</p>" if more > 0 else ""
    )


def _scenario_text(dataset: Any) -> str:
    """The scenario as TOML."""
    from fieldline.report.markup import text

    return f'<pre class="scroll"><code>{text(dataset.attrs.get("scenario_toml", ""))}</code></pre>'


def _span(record: RunRecord) -> str:
    """The run in words."""
    start, stop = (np.datetime_as_string(record.time_utc[k], unit="s").replace("T", " ") for k in (0, -1))
    bodies = ", ".join(record.bodies[:6]) + (" …" if len(record.bodies) > 6 else "")
    return f"Simulated: {start} to {stop} UTC · {bodies}"
