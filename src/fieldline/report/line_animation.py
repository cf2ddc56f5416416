"""The lines of a run in motion, inside the report: a drawing of its own script with the run thinned to some hundred frames.

The page needs nothing else: numbers travel as 16-bit integers in base64, each array with its scale, places in the orbital
axes of the mass centre of the bodies at the ends of the first line.
"""

from __future__ import annotations

import base64
import json
from importlib.resources import files
from typing import Any

import numpy as np

from fieldline.report.line_record import LineRecord, lines_of
from fieldline.report.markup import text
from fieldline.report.run_record import RunRecord
from fieldline.simulate.line_shape import POSITION

MOST_FRAMES = 900  # of a run with one line, fewer with several
POINTS = 25  # of a line that has nodes
FULL = 32767
FOLLOWED = 3.0  # ratio of greatest to least length from which on the scale follows the length
SHOWN_BOW = 0.12  # of the length, that the largest deflection is magnified to
CAPTION = (
    "Along the track to the right, or against the orbit normal; up is up. Colour: tension, blue to amber for the most, "
    "dashed where slack. Bodies are drawn large, with their body axes x, y, z, at the attitude that they have; the line leaves "
    "them where it is attached. Space plays and stops, the arrow keys step, Home and End go to the ends."
)


def animation_html(record: RunRecord) -> str:
    """The animation with its data and script; empty where the run has no lines."""
    lines = lines_of(record)
    if not lines:
        return ""
    data = json.dumps(_data(record, lines), separators=(",", ":")).replace("<", "\\u003c")
    script = files("fieldline.report").joinpath("line_animation.js").read_text(encoding="utf-8")
    views = "".join(
        f'<div><p>{words}</p><canvas role="img" aria-label="The lines {words}" width="600" height="640"></canvas></div>'
        for words in ("in the orbital plane", "across it")
    )
    return (
        f'<figure class="motion" id="motion-of-lines" tabindex="0" aria-label="Motion of the lines"><h3>Motion</h3>'
        f'<div class="views">{views}</div>{_controls()}<p class="readout"></p>'
        "<noscript><p>This drawing moves by a script inside the page, which is switched off here.</p></noscript>"
        f"<figcaption>{text(CAPTION)}</figcaption></figure>"
        f'<script type="application/json" id="motion-data">{data}</script><script>{script}</script>'
    )


def _controls() -> str:
    """Play, time, speed, magnification, scale."""
    speeds = "".join(f'<option value="{s}"{" selected" if s == 20 else ""}>in {s} s</option>' for s in (10, 20, 60, 180))
    return (
        '<div class="controls"><button type="button" data-do="play">Play</button>'
        '<label class="wide">Time <input type="range" data-do="time" min="0" max="1" step="any" value="0"></label>'
        f'<label>The whole run <select data-do="speed">{speeds}</select></label>'
        '<label>Deflection × <input type="range" data-do="magnify" min="0" max="9" step="1"> <output></output></label>'
        '<label><input type="checkbox" data-do="follow"> scale follows the length</label></div>'
    )


def _data(record: RunRecord, lines: list[LineRecord]) -> dict[str, Any]:
    """Everything that the script draws."""
    count = min(len(record.seconds), max(150, MOST_FRAMES // len(lines)))
    kept = np.unique(np.linspace(0, len(record.seconds) - 1, count).astype(int))
    turn, centre = _centre(lines[0], kept)
    lengths = np.concatenate([line.shape.chord_m for line in lines])
    bow = max(float(np.nanmax(line.shape.largest_m)) for line in lines)
    touched = sorted({b for line in lines for b in line.ends})
    return {
        "seconds": [round(float(s), 3) for s in record.seconds[kept]],
        "clock": {"unit_s": record.clock.unit_s, "label": record.clock.label},
        "magnify": _round_down(max(1.0, SHOWN_BOW * float(np.median(lengths)) / bow)) if bow > 1e-6 * lengths.max() else 1,
        "follow": bool(lengths.max() > FOLLOWED * lengths.min()),
        "longest": _reach(lines, kept),
        "tension": max(float(np.nanmax(line.tension)) for line in lines),
        "bodies": [_body(record, b, kept, turn) for b in touched],
        "lines": [_line(line, kept, turn, centre, touched) for line in lines],
    }


def _centre(line: LineRecord, kept: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(n, 3, 3) dcm_oi and (n, 3) [m] inertial place of the mass centre of the bodies at a line's ends."""
    from fieldline.frames.orbital import dcm_oi

    run, ends = line.run, list(line.ends)
    masses = [run.scenario.body[b].mass_kg for b in ends]
    place, velocity = (np.average(run.values(key)[kept][:, ends], axis=1, weights=masses) for key in ("position_i", "velocity_i"))
    return dcm_oi(place, velocity), place


def _reach(lines: list[LineRecord], kept: np.ndarray) -> float:
    """[m] largest distance between any two ends of lines at any of the frames."""
    ends = np.concatenate([line.run.values(POSITION + line.name)[kept][:, [0, -1]] for line in lines], axis=1)
    return max(float(np.linalg.norm(ends - ends[:, k : k + 1], axis=2).max()) for k in range(ends.shape[1]))


def _line(line: LineRecord, kept: np.ndarray, turn: np.ndarray, centre: np.ndarray, touched: list[int]) -> dict[str, Any]:
    """Ends, deflection from the chord, tension of a line at points evenly spaced along it."""
    points = line.run.values(POSITION + line.name)[kept]
    place = np.einsum("nij,npj->npi", turn, points - centre[:, None])
    count = POINTS if place.shape[1] > 2 else 2
    even, tension = np.empty((len(kept), count, 3)), np.empty((len(kept), count - 1))
    for k, one in enumerate(place):
        even[k], tension[k] = _resampled(one, line.tension[kept[k]], count)
    ends = even[:, [0, -1]]
    share = np.linspace(0.0, 1.0, count)[None, :, None]
    deflection = even - ends[:, :1] - share * (ends[:, 1:] - ends[:, :1])
    b0, b1 = (touched.index(b) for b in line.ends)
    return {
        "name": line.name,
        "bodies": [b0, b1],
        "levers": [_unit(line.line.from_point_b_m), _unit(line.line.to_point_b_m)],
        "points": count,
        "ends": packed(ends),
        "deflection": packed(deflection),
        "tension": packed(np.where(tension > 0.0, tension, 0.0)),
        "angles": packed(np.stack([line.shape.in_plane_rad, line.shape.across_rad], axis=1)[kept]),
        "out": [round(float(length), 3) for length in line.length[kept]],
    }


def _resampled(points: np.ndarray, tension: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """(count, 3) places evenly spaced along the points that are out, and (count - 1,) tensions between them."""
    points, tension = points[np.isfinite(points[:, 0])], tension[np.isfinite(tension)]
    arc = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    at = np.linspace(0.0, arc[-1], count)
    even = np.stack([np.interp(at, arc, points[:, j]) for j in range(3)], axis=1)
    middle = 0.5 * (at[:-1] + at[1:])
    return even, tension[np.clip(np.searchsorted(arc, middle, side="right") - 1, 0, len(tension) - 1)]


def _body(record: RunRecord, b: int, kept: np.ndarray, turn: np.ndarray) -> dict[str, Any]:
    """Name and attitude to the orbital axes, its quaternion's sign without jumps; a point mass has none."""
    from scipy.spatial.transform import Rotation

    if record.scenario.body[b].kind != "rigid":
        return {"name": record.bodies[b]}
    q_bo = (Rotation.from_matrix(turn) * Rotation.from_quat(record.of("q_bi", b)[kept])).as_quat()
    flips = np.cumprod(np.concatenate([[1.0], np.where(np.sum(q_bo[1:] * q_bo[:-1], axis=1) < 0.0, -1.0, 1.0)]))
    return {"name": record.bodies[b], "turn": packed(q_bo * flips[:, None])}


def packed(values: np.ndarray) -> dict[str, Any]:
    """An array as little-endian 16-bit integers in base64, with what one of them is worth."""
    scale = float(np.max(np.abs(values))) / FULL or 1.0
    whole = np.round(values / scale).astype("<i2")
    return {"scale": scale, "data": base64.b64encode(np.ascontiguousarray(whole).tobytes()).decode("ascii")}


def _unit(point: Any) -> list[float]:
    """A lever's direction; zeros where it has none."""
    size = float(np.linalg.norm(point))
    return [round(float(x) / size, 6) if size > 0.0 else 0.0 for x in point]


def _round_down(value: float) -> int:
    """The largest of 1, 2, 5, 10, 20, ... 1000 that is not above a value."""
    return max(step for step in (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000) if step <= value)
