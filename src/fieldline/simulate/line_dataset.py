"""The lines of a flight in its Dataset: shape, tension, length, current of each, under its own name."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from fieldline.dynamics.layout import starts_in_state
from fieldline.dynamics.parameters import NO_CIRCUIT, STATE
from fieldline.simulate.assembly.lines import line_names


def put_lines(data, flight, rows: int) -> None:
    """For each line NAME: line_position_i_NAME, line_velocity_i_NAME, tension_NAME, deployed_length_NAME, feed_rate_NAME, ..."""
    for k, name in enumerate(line_names(flight.scenario)):
        _shape(data, flight, rows, k, name)
        _length(data, flight, rows, k, name)
        _along(data, flight, rows, k, name)


def _set(data, name: str, dims, values, units: str, words: str, axes: str = "") -> None:
    """One variable with its attributes."""
    data[name] = (dims, values, {"units": units, "long_name": words} | ({"axes": axes} if axes else {}))


def _shape(data, flight, rows: int, k: int, name: str) -> None:
    """Places and velocities of all points, both attachments included; NaN for nodes that are not out."""
    state = flight.record.state[:rows]
    nodes, _, _ = starts_in_state(flight.plant)
    first, last = flight.plant.lines.first[k : k + 2]
    out = flight.record.nodes[:rows, k]
    points = np.full((rows, last - first + 2, 6), np.nan)
    inner = state[:, nodes + 6 * first : nodes + 6 * last].reshape(rows, last - first, 6)
    there = np.arange(last - first) < out[:, None]
    points[:, 1:-1][there] = inner[there]
    for end, place in ((0, 0), (1, -1)):
        points[:, place] = _attachment(flight, state, k, end)
    dims = ("time", f"point_{name}", "axis")
    _set(data, f"line_position_i_{name}", dims, points[..., :3], "m", f"points of {name}, from its from_body to its to_body", "i")
    _set(data, f"line_velocity_i_{name}", dims, points[..., 3:], "m s-1", f"velocity of the points of {name}", "i")


def _attachment(flight, state, k: int, end: int) -> np.ndarray:
    """(rows, 6) of an attachment."""
    lines, row = flight.plant.lines, state[:, STATE * flight.plant.lines.body[k, end] :][:, :STATE]
    point = np.tile(lines.point[k, 3 * end : 3 * end + 3], (len(state), 1))
    rate = row[:, 10:13]
    sliders = flight.plant.sliders
    before = flight.actuators.ends[5]
    for s in np.flatnonzero((sliders.line == k) & (sliders.end == end)):
        point = point + flight.record.actuators[: len(state), before + s, None] * sliders.axis[s]
    turn = Rotation.from_quat(row[:, 6:10])
    return np.hstack([row[:, :3] + turn.apply(point), row[:, 3:6] + turn.apply(np.cross(rate, point))])


def _length(data, flight, rows: int, k: int, name: str) -> None:
    """Unstretched length that is out, and the rate of the feed."""
    lines = flight.plant.lines
    _, feeds, _ = starts_in_state(flight.plant)
    feed = flight.record.state[:rows, feeds + 2 * k : feeds + 2 * k + 2]
    segments = slice(lines.first[k] + k, lines.first[k + 1] + k)
    full = np.append(0.0, np.cumsum(np.where(lines.reel[k], lines.spacing[k], lines.rest[segments])))
    length = feed[:, 0] + full[flight.record.nodes[:rows, k]]
    _set(data, f"deployed_length_{name}", "time", length, "m", f"unstretched length of {name} that is out")
    _set(data, f"feed_rate_{name}", "time", feed[:, 1], "m s-1", f"rate at which {name} is paid out")


def _along(data, flight, rows: int, k: int, name: str) -> None:
    """Tension, and where there are any, temperature and current of each segment; NaN for segments that are not out."""
    lines, record = flight.plant.lines, flight.record
    segments = slice(lines.first[k] + k, lines.first[k + 1] + k + 1)
    there = np.arange(segments.stop - segments.start) <= record.nodes[:rows, k, None]
    dims = ("time", f"segment_{name}")
    _set(data, f"tension_{name}", dims, np.where(there, record.tension[:rows, segments], np.nan), "N", f"tension along {name}")
    if lines.warm[k + 1] > lines.warm[k]:
        first = starts_in_state(flight.plant)[2]
        warmth = record.state[:rows, first + lines.warm[k] : first + lines.warm[k + 1]]
        _set(data, f"temperature_{name}", dims, np.where(there, warmth, np.nan), "K", f"temperature along {name}")
    if flight.plant.circuits.kind[k] != NO_CIRCUIT:
        current = np.where(there, record.current[:rows, segments], np.nan)
        _set(data, f"current_{name}", dims, current, "A", f"current along {name}, from from_body on")
        for j, (key, units, words) in enumerate((("emf", "V", "electromotive force"), ("power", "W", "power delivered"))):
            _set(data, f"{key}_{name}", "time", record.circuit[:rows, k, j], units, f"{words} of {name}")
        _set(data, f"lorentz_force_i_{name}", ("time", "axis"), record.circuit[:rows, k, 2:5], "N", f"field on {name}", "i")
    if np.any(record.circuit[:rows, k, 5:8]):
        _set(data, f"drag_force_i_{name}", ("time", "axis"), record.circuit[:rows, k, 5:8], "N", f"air on {name}", "i")
