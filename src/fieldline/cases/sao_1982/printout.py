"""A flight as the annex prints it: displacements, tension, Euler angles and direction cosines, momenta (III-2).

Along, across, radial: the attachment from the Shuttle, in a, b, c of the Shuttle at that time (`euler_angles`): b along the
track, c against the plane, a up; the annex's RADIAL, of a subsatellite below, is negative. Tension (TEN) is the elastic part
k (l - l0), friction (FRICT) is b dl/dt; both are zero where the line is slack. On a line with nodes they are those of the
segment next to the subsatellite, and the length is that of all segments.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fieldline.cases.ames_1961.dipole_field import settings_text
from fieldline.cases.sao_1982.euler_angles import cosines_of, euler_angles, xyz_angles
from fieldline.cases.sao_1982.flight import LINE, SOURCE

if TYPE_CHECKING:
    import xarray

ROWS = ["1", "2", "3"]
COLUMNS = ["alpha", "beta", "gamma"]
ANGLES = {"theta": "tilt of the body's z axis", "psi": "node", "phi": "spin"}


def printed(flown: xarray.Dataset, scenario, case: str, title: str, settings: dict) -> xarray.Dataset:
    """The signals of a flight of `flight.scenario_of`, over `seconds`."""
    import xarray as xr

    line, body = scenario.line[0], scenario.body[1]
    place, velocity = flown["position_i"].values, flown["velocity_i"].values
    cosines = cosines_of(flown["q_bi"].values[:, 1])
    omega_b = flown["omega_bi_b"].values[:, 1]
    momentum_b = omega_b @ np.array(body.inertia_kg_m2)
    arm_b = np.array(line.from_point_b_m)
    lever = _to_inertial(cosines, arm_b)
    points, speeds = (flown[f"line_{name}_i_{LINE}"].values for name in ("position", "velocity"))
    swing = _to_inertial(cosines, np.cross(omega_b, arm_b))
    chord = points[:, 1] - place[:, 1] - lever
    first, first_rate = _length_and_rate(chord, speeds[:, 1] - velocity[:, 1] - swing)
    others, other_rates = _length_and_rate(np.diff(points[:, 1:], axis=1), np.diff(speeds[:, 1:], axis=1))
    length, rate = first + others.sum(axis=1), first_rate + other_rates.sum(axis=1)
    rest = line.rest_length_m / (line.nodes + 1)
    taut = first > rest
    tension = np.where(taut, line.stiffness_n * (first - rest) / rest, 0.0)
    friction = np.where(taut, line.damping_n_s * first_rate / rest, 0.0)
    axes = shuttle_axes(place[:, 0], velocity[:, 0])
    turned = cosines @ np.swapaxes(axes, -1, -2)
    displacement = np.einsum("tij,tj->ti", axes, place[:, 1] + lever - place[:, 0])
    arm = lever / np.linalg.norm(lever, axis=1, keepdims=True)
    pull = chord / first[:, None]
    away = np.arctan2(np.linalg.norm(np.cross(arm, pull), axis=1), (arm * pull).sum(axis=1))
    vector = ("seconds", "axis")
    data = xr.Dataset(
        {
            "position_i": (("seconds", "body", "axis"), place, _words("m", "position", "i")),
            "velocity_i": (("seconds", "body", "axis"), velocity, _words("m s-1", "velocity", "i")),
            "along": ("seconds", displacement[:, 1], _words("m", "attachment along the track from the Shuttle")),
            "across": ("seconds", displacement[:, 2], _words("m", "attachment across the plane")),
            "radial": ("seconds", displacement[:, 0], _words("m", "attachment above the Shuttle")),
            "length": ("seconds", length, _words("m", "length of the line")),
            "length_rate": ("seconds", rate, _words("m s-1", "rate of the line's length")),
            "tension": ("seconds", tension, _words("N", "elastic tension")),
            "friction": ("seconds", friction, _words("N", "damping force along the line")),
            "lever_angle": ("seconds", away, _words("rad", "angle between lever and line")),
            "lever_o": (vector, np.einsum("tij,tj->ti", axes, arm), _words("1", "direction of the lever", "a, b, c")),
            "cosines_i": (("seconds", "row", "column"), cosines, _words("1", "direction cosines", "inertial")),
            "cosines_o": (("seconds", "row", "column"), turned, _words("1", "direction cosines", "a, b, c")),
            "omega_b": (vector, omega_b, _words("rad s-1", "angular rate", "b")),
            "omega_i": (vector, _to_inertial(cosines, omega_b), _words("rad s-1", "angular rate", "i")),
            "momentum_b": (vector, momentum_b, _words("N m s", "angular momentum", "b")),
            "momentum_i": (vector, _to_inertial(cosines, momentum_b), _words("N m s", "angular momentum", "i")),
            "xyz_angles_i": (vector, xyz_angles(cosines), _words("rad", "turns about x, y, z", "i")),
        },
        coords={
            "seconds": ("seconds", flown["seconds"].values, {"units": "s"}),
            "body": flown["body"].values,
            "axis": list("xyz"),
            "row": ROWS,
            "column": COLUMNS,
        },
    )
    for suffix, matrices, words in (("", cosines, "inertial axes"), ("_orbital", turned, "axes a, b, c")):
        for (name, meaning), values in zip(ANGLES.items(), euler_angles(matrices), strict=True):
            data[name + suffix] = ("seconds", values, _words("rad", f"{meaning}, {words}"))
    data.attrs = {
        "title": title,
        "case": case,
        "source": SOURCE,
        "settings_json": settings_text(settings),
        "natural_length_m": line.rest_length_m,
        "damping_n_s_m": line.damping_n_s / line.rest_length_m,
        "scenario_toml": scenario.to_toml(),
        "outcome": flown.attrs["outcome"],
        "provenance_json": flown.attrs["provenance_json"],
    }
    return data


def _length_and_rate(chord, chord_rate):
    """Lengths of chords (..., 3), and their rates."""
    length = np.linalg.norm(chord, axis=-1)
    return length, (chord * chord_rate).sum(axis=-1) / length


def shuttle_axes(place, velocity) -> np.ndarray:
    """(n, 3, 3), rows a, b, c in inertial axes."""
    up = place / np.linalg.norm(place, axis=1, keepdims=True)
    normal = np.cross(place, velocity)
    normal = normal / np.linalg.norm(normal, axis=1, keepdims=True)
    return np.stack([up, np.cross(normal, up), normal], axis=1)


def _to_inertial(cosines, vector_b) -> np.ndarray:
    """(n, 3) of vectors (n, 3) or (3,) in body axes."""
    return np.einsum("tji,tj->ti", cosines, np.broadcast_to(vector_b, (len(cosines), 3)))


def _words(units: str, long_name: str, axes: str = "") -> dict:
    """Attributes of a variable."""
    return {"units": units, "long_name": long_name} | ({"axes": axes} if axes else {})
