"""Where the linear equations of relative motion hold: the plant beside them, over one orbit, from near to far.

A body is let go at rest in the target's axes, at so many metres up, along or across, and drifts for an orbit: the plant's
two bodies in a point's gravity against `free_translation`. And a rigid body is let go pitched by so many degrees, against
`free_motion`. The error of a place is told as a part of the distance that the motion went through.
"""

from __future__ import annotations

import numpy as np

from fieldline.cases.afit_1992.earth import ALTITUDE_M, SOURCE
from fieldline.cases.afit_1992.flown import vehicle_scenario
from fieldline.cases.ames_1961.dipole_field import settings_text
from fieldline.constants import EARTH_GM_M3_S2
from fieldline.design.tracking_vehicle import tank_with_towers
from fieldline.errors import InputError
from fieldline.mechanics.relative_motion import free_motion, free_translation

DIRECTIONS = ("up", "along", "across")
GOOD = 0.01


def linear_range(offsets_m=(10.0, 100.0, 1000.0, 10_000.0, 50_000.0), angles_deg=(1.0, 5.0, 10.0, 15.0, 30.0, 45.0)):
    """Errors of the linear motion over an orbit, as a Dataset over offset_m and angle_deg.

    Returns
    -------
    Dataset: place_error (direction, offset_m), greatest error of the place over the greatest distance; pitch_error
    (angle_deg), greatest error of the angle over its greatest; good_to_m (direction) and good_to_deg, where they pass 1 %.

    Raises
    ------
    InputError : offsets or angles that are not positive, rising numbers within 100 km and 80 deg.
    """
    settings = {"offsets_m": offsets_m, "angles_deg": angles_deg}
    offsets, angles = _rising("offsets_m", offsets_m, 1e5), _rising("angles_deg", angles_deg, 80.0)
    place = np.array([[_place_error(offset, k) for offset in offsets] for k in range(3)])
    pitch = np.array([_pitch_error(angle) for angle in angles])
    return _dataset(offsets, angles, place, pitch, settings)


def _rising(name: str, given, most: float) -> np.ndarray:
    """(k,) positive numbers in order, or a refusal."""
    try:
        values = np.atleast_1d(np.asarray(given, dtype=float))
    except (TypeError, ValueError):
        values = np.empty(0)
    if values.ndim != 1 or not len(values) or not (np.diff(values) > 0.0).all() or not 0.0 < values[0] <= values[-1] <= most:
        raise InputError(f"{name} must be rising numbers above zero, up to {most:g}; got {given!r}.")
    return values


def _drift(place, angle_deg: float = 0.0):
    """A run of an orbit without control, and the mean motion of its target."""
    from fieldline.simulate.run import simulate

    made = tank_with_towers(vertical_m=330.0, horizontal_m=310.0)
    scenario = vehicle_scenario(
        made, "tracking-allocated", {}, inclination_deg=0.0, place_m=place, duration_s=5552.0, output_s=40.0
    )
    half = 0.5 * np.radians(angle_deg)
    # (0.5, 0.5, -0.5, 0.5) times a turn about the body's z, scalar last
    c, s = np.cos(half), np.sin(half)
    quaternion = (0.5 * (c + s), 0.5 * (c - s), 0.5 * (s - c), 0.5 * (c + s))
    run = simulate(scenario.replace(software=[], **{"body.1.attitude": {"quaternion_bo": quaternion}}))
    radius = float(np.linalg.norm(run["position_i"].values[0, 0]))
    return run, float(np.sqrt(EARTH_GM_M3_S2 / radius**3)), radius, made.inertia_kg_m2


def _place_error(offset: float, direction: int) -> float:
    """Greatest error of the place over the greatest distance."""
    from fieldline.simulate.approach import relative_motion_h

    start = np.zeros(3)
    start[direction] = offset
    run, n, _, _ = _drift(start)
    place, rate, _ = relative_motion_h(run, 1)
    state = np.column_stack([place[0], rate[0]]).ravel()
    linear = free_translation(n, run["seconds"].values, state)[:, ::2]
    return float(np.linalg.norm(place - linear, axis=1).max() / np.linalg.norm(place, axis=1).max())


def _pitch_error(angle_deg: float) -> float:
    """Greatest error of a pitch that swings, over its greatest."""
    from fieldline.simulate.approach import approach

    run, n, radius, inertia = _drift(np.zeros(3), angle_deg)
    seen = approach(run)
    pitch = np.radians(seen["angle_deg"].values[:, 2])
    state = np.zeros(12)
    state[10], state[11] = pitch[0], np.radians(seen["angle_rate_deg_s"].values[0, 2])
    linear = free_motion(n, radius, inertia, run["seconds"].values, state)[:, 10]
    return float(np.abs(pitch - linear).max() / np.abs(pitch).max())


def _crossing(x: np.ndarray, error: np.ndarray) -> float:
    """Where the error passes 1 %, on straight lines of the logarithms; the last x if it does not."""
    over = np.flatnonzero(error > GOOD)
    if not len(over) or over[0] == 0:
        return float(x[-1] if not len(over) else x[0])
    k = over[0]
    share = np.log(GOOD / error[k - 1]) / np.log(error[k] / error[k - 1])
    return float(x[k - 1] * (x[k] / x[k - 1]) ** share)


def _dataset(offsets, angles, place, pitch, settings):
    """The errors and where they pass 1 %."""
    import xarray as xr

    unit = {"units": "1"}
    good = [_crossing(offsets, one) for one in place]
    return xr.Dataset(
        {
            "place_error": (("direction", "offset_m"), place, unit | {"long_name": "error over an orbit, part of the distance"}),
            "pitch_error": ("angle_deg", pitch, unit | {"long_name": "error over an orbit, part of the amplitude"}),
            "good_to_m": ("direction", np.array(good), {"units": "m", "long_name": "start from which the error is above 1 %"}),
            "good_to_deg": ((), _crossing(angles, pitch), {"units": "degree", "long_name": "pitch from which it is above 1 %"}),
        },
        coords={"direction": list(DIRECTIONS), "offset_m": offsets, "angle_deg": angles},
        attrs={
            "title": f"Linear motion beside the plant over an orbit at {ALTITUDE_M / 1e3:g} km",
            "case": "afit_1992_linear_range",
            "source": f"{SOURCE}, chapter 6: the range of the linear equations",
            "settings_json": settings_text({key: list(np.atleast_1d(value)) for key, value in settings.items()}),
        },
    )
