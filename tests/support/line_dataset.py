"""A run with a line whose motion is known, made by hand in the layout of `fieldline.simulate`, without flying anything.

20 km of line with ten nodes between two rigid bodies on a circular orbit: libration in and across the plane, a steady bow,
a circular skiprope, and on request a reel that pays the line out, its nodes NaN until they are out.
"""

from __future__ import annotations

import numpy as np
import xarray

from fieldline.constants import EARTH_GM_M3_S2

NODES = 10
LENGTH_M = 20e3
RADIUS_M = 6378136.6 + 300e3
RATE = float(np.sqrt(EARTH_GM_M3_S2 / RADIUS_M**3))
IN_PLANE_RAD, ACROSS_RAD = np.radians(12.0), np.radians(5.0)
BOW_M, SKIPROPE_M, SKIPROPE_RATE = 150.0, 40.0, 2.0 * np.pi / 180.0
MASSES_KG = (500.0, 250.0)
TILT_RAD = np.radians(8.0)  # of the first body's lever from the line

SCENARIO = f"""
name = "known line"
description = "A line whose motion is known"

[time]
start_utc = 2026-03-01T00:00:00Z
duration_s = 6000.0
output_step_s = 10.0

[integrator]
method = "rosenbrock"

[orbit.elements]
altitude_km = 300.0
inclination_deg = 28.5

[[body]]
name = "orbiter"
mass_kg = {MASSES_KG[0]}
inertia_kg_m2 = [600.0, 500.0, 400.0]

[[body]]
name = "subsatellite"
mass_kg = {MASSES_KG[1]}
inertia_kg_m2 = [60.0, 55.0, 40.0]
offset_o_m = [0.0, 0.0, -20000.0]

[[line]]
name = "tether"
from_body = "subsatellite"
from_point_b_m = [0.0, 0.0, 0.8]
to_body = "orbiter"
to_point_b_m = [0.0, 0.0, -2.0]
rest_length_m = {LENGTH_M}
stiffness_n = 1.0e5
nodes = {NODES}
mass_per_length_kg_m = 0.008
"""


def line_dataset(*, rows: int = 601, sense: float = 1.0, reel: bool = False) -> xarray.Dataset:
    """The run: B, the orbiter, below; A, the subsatellite, above. `sense`: 1 right-handed about the line downwards, -1 left."""
    seconds = 10.0 * np.arange(rows)
    length = np.full(rows, LENGTH_M) if not reel else np.linspace(2500.0, LENGTH_M, rows)
    feed = np.gradient(length, seconds)
    data = _base(seconds)
    down = _down(seconds)
    points = _points(seconds, length, down, sense)
    centre = data["position_i"].values[:, 0] * 0.0 + _circular(seconds)[0]
    turn = _axes(seconds)
    position = centre[:, None] + np.einsum("nij,npi->npj", turn, points)
    velocity = np.gradient(position, seconds, axis=0, edge_order=2)
    out = _out(length)
    position[~out], velocity[~out] = np.nan, np.nan
    _ends(data, position, velocity, turn)
    _put_line(data, position, velocity, length, feed, out)
    data.attrs = {
        "scenario_toml": _scenario(reel),
        "complete": 1,
        "outcome": "flown to its end.",
        "provenance_json": '{"seed": 0}',
    }
    return data


def _scenario(reel: bool) -> str:
    """The scenario, with a reel where asked."""
    if not reel:
        return SCENARIO
    text = SCENARIO.replace(f"rest_length_m = {LENGTH_M}", "rest_length_m = 2500.0")
    return text + f"reel = {{ total_length_m = {LENGTH_M} }}\n"


def _circular(seconds):
    """Position and velocity of the mass centre."""
    angle = RATE * seconds
    position = RADIUS_M * np.stack([np.cos(angle), np.sin(angle), 0.0 * angle], axis=1)
    velocity = RADIUS_M * RATE * np.stack([-np.sin(angle), np.cos(angle), 0.0 * angle], axis=1)
    return position, velocity


def _axes(seconds):
    """(n, 3, 3) rows: along the track, against the normal, down."""
    position, velocity = _circular(seconds)
    x, z = velocity / (RADIUS_M * RATE), -position / RADIUS_M
    return np.stack([x, np.broadcast_to([0.0, 0.0, -1.0], x.shape), z], axis=1)


def libration(seconds):
    """In plane and across it [rad]."""
    return IN_PLANE_RAD * np.sin(np.sqrt(3.0) * RATE * seconds), ACROSS_RAD * np.cos(2.0 * RATE * seconds)


def _down(seconds):
    """(n, 3) the chord, downwards."""
    theta, phi = libration(seconds)
    return np.stack([np.sin(theta) * np.cos(phi), np.sin(phi), np.cos(theta) * np.cos(phi)], axis=1)


def _points(seconds, length, down, sense):
    """(n, p, 3) places in orbital axes; A up at index 0, the mass centre of the end bodies at zero."""
    fraction = np.linspace(0.0, 1.0, NODES + 2)[None, :] * LENGTH_M / length[:, None]
    fraction[:, -1] = 1.0
    second = np.array([0.0, 1.0, 0.0]) - down[:, 1:2] * down
    second /= np.linalg.norm(second, axis=1, keepdims=True)
    first = np.cross(second, down)
    wave = np.sin(np.pi * np.clip(fraction, 0.0, 1.0))[..., None]
    turning = sense * SKIPROPE_RATE * seconds
    bow = first * (BOW_M + SKIPROPE_M * np.cos(turning))[:, None] + second * (SKIPROPE_M * np.sin(turning))[:, None]
    share = MASSES_KG[0] / sum(MASSES_KG)  # of the chord, from the mass centre up to A
    return (fraction[..., None] - share) * (length[:, None] * down)[:, None] + wave * bow[:, None]


def _out(length):
    """(n, p) which points are out."""
    place = np.linspace(0.0, LENGTH_M, NODES + 2)
    out = place[None, :] < length[:, None] - 500.0
    out[:, -1] = True
    return out


def _base(seconds):
    """Bodies, surroundings and loads, as a run has them."""
    rows = len(seconds)
    start = np.datetime64("2026-03-01T00:00:00", "ns")
    data = xarray.Dataset(
        coords={
            "time": start + np.round(1e9 * seconds).astype("timedelta64[ns]"),
            "seconds": ("time", seconds),
            "body": ["orbiter", "subsatellite"],
            "axis": ["x", "y", "z"],
            "quaternion": ["x", "y", "z", "w"],
            "load": ["lines"],
        }
    )
    for name in ("position_i", "velocity_i", "omega_bi_b", "field_i", "field_b"):
        data[name] = (("time", "body", "axis"), np.zeros((rows, 2, 3)) + 2e-5)
    for name, value in (("latitude_deg", 0.0), ("longitude_deg", 0.0), ("altitude_m", 3e5)):
        data[name] = (("time", "body"), np.full((rows, 2), value))
    data["sunlit"] = (("time", "body"), (np.sin(RATE * seconds) > -0.6).astype(float)[:, None] * np.ones(2))
    data["q_bi"] = (("time", "body", "quaternion"), np.tile([0.0, 0.0, 0.0, 1.0], (rows, 2, 1)))
    for name in ("force_i", "torque_b"):
        data[name] = (("time", "load", "body", "axis"), np.full((rows, 1, 2, 3), 1.0))
    return data


def _ends(data, position, velocity, turn):
    """Bodies at the ends: the orbiter's lever tilted from the line, the subsatellite along it."""
    from scipy.spatial.transform import Rotation

    from fieldline.frames.earth_rotation import geodetic_from_itrs

    line = position[:, -1] - position[:, 0]
    line /= np.linalg.norm(line, axis=1, keepdims=True)  # downwards
    side = np.cross(turn[:, 1], line)
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    tangents = (line, line)
    for b, (lever, place, tilt) in enumerate(((-2.0, -1, TILT_RAD), (0.8, 0, 0.0))):
        z = np.cos(tilt) * tangents[b] + np.sin(tilt) * side
        y = np.cross(z, side)
        y /= np.linalg.norm(y, axis=1, keepdims=True)
        matrix = np.stack([np.cross(y, z), y, z], axis=2)
        data["q_bi"].values[:, b] = Rotation.from_matrix(matrix).as_quat()
        data["position_i"].values[:, b] = position[:, place] - lever * z
        data["velocity_i"].values[:, b] = velocity[:, place]
    data["altitude_m"].values[:] = geodetic_from_itrs(data["position_i"].values)[2]


def _put_line(data, position, velocity, length, feed, out):
    """All variables of the line."""
    rows = len(length)
    point, segment = "point_tether", "segment_tether"
    there = np.concatenate([out[:, 1:-1], np.zeros((rows, 1), dtype=bool)], axis=1)
    last = there.sum(axis=1)
    there[np.arange(rows), last] = True
    along = np.linspace(0.0, 1.0, NODES + 1)[None, :]
    seconds = data["seconds"].values

    def along_line(values):
        return np.where(there, values, np.nan)

    data["line_position_i_tether"] = (("time", point, "axis"), position, {"units": "m"})
    data["line_velocity_i_tether"] = (("time", point, "axis"), velocity, {"units": "m s-1"})
    tension = (20.0 + 12.0 * along) * (length / LENGTH_M)[:, None] * (1.0 + 0.3 * np.sin(2.0 * RATE * seconds))[:, None]
    tension[100:104] = 0.0  # slack for four outputs
    data["tension_tether"] = (("time", segment), along_line(tension), {"units": "N"})
    data["deployed_length_tether"] = ("time", length, {"units": "m"})
    data["feed_rate_tether"] = ("time", feed, {"units": "m s-1"})
    warm = 290.0 + 30.0 * np.sin(RATE * seconds)[:, None] + 5.0 * along
    data["temperature_tether"] = (("time", segment), along_line(warm), {"units": "K"})
    current = 0.4 * (1.0 + 0.2 * np.sin(RATE * seconds))[:, None] + 0.0 * along
    data["current_tether"] = (("time", segment), along_line(current), {"units": "A"})
    data["emf_tether"] = ("time", 3500.0 + 300.0 * np.sin(RATE * seconds), {"units": "V"})
    data["power_tether"] = ("time", 900.0 + 200.0 * np.sin(RATE * seconds), {"units": "W"})
