"""An orbit from positions that the telemetry itself carries, smoothed in inertial axes.

    r_i = dcm_ei^T r_e,   then a least-squares spline of degree 5 in time,  v_i = dr_i/dt       (1)

Knots lie at samples at least 120 s apart, so that the noise of positions taken every second averages out, where sparser
positions are passed through. The spline's own error in a low orbit is under 3 cm where positions come every 60 s or
faster; every 300 s it is 1 m within and 120 m at the ends. Pauses over 300 s are not bridged
and nothing is extrapolated. A smooth path that does not fall as gravity asks,

    d = rms |a + GM r / |r|^3| / rms |GM r / |r|^3|                                            (2)

but would if its columns were inertial, is refused with that guess; the oblateness that (2) leaves out is 0.2 %.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fieldline.constants import EARTH_GM_M3_S2
from fieldline.errors import InputError
from fieldline.frames.earth_orientation import EarthOrientation
from fieldline.frames.earth_rotation import dcm_ei
from fieldline.frames.time import as_utc, iso_utc
from fieldline.orbit.ephemeris_orbit import EphemerisOrbit
from fieldline.orbit.orbit import BLOCK

DEGREE = 5
KNOT_SPACING_S = 120.0
MAX_PAUSE_S = 300.0
FEWEST_POSITIONS = 4
RADIUS_M = (6.3e6, 1e10)  # from below the ground at the poles to beyond the Moon
SCATTER_WARN_M = 2000.0
FALLS = 0.02  # (2) below this: the path falls freely
FLIES_OTHERWISE = 0.05  # and above this it does not
FEWEST_KNOTS_TO_JUDGE = 6


@dataclass(frozen=True, kw_only=True, eq=False)
class SplinePath:
    """A smoothing spline between two times, GCRS axes."""

    first_utc: np.datetime64
    last_utc: np.datetime64
    spline: object  # scipy.interpolate.BSpline of seconds since first_utc
    scatter_m: float
    samples: int

    @property
    def words(self) -> str:
        """How it was made, for the record."""
        return (
            f"spline of degree {self.spline.k} with {len(self.spline.t) - 2 * self.spline.k - 1} pieces through {self.samples} "
            f"positions, which scatter about it by {self.scatter_m:.3g} m RMS"
        )

    def state(self, flat: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Position [m] and velocity [m/s], (n, 3), equation (1)."""
        seconds = (flat - self.first_utc).astype(np.int64) * 1e-9
        return self.spline(seconds), self.spline(seconds, 1)


def orbit_from_positions(
    time_utc, position_e_m, *, eop: EarthOrientation | None = None, name: str = "telemetry"
) -> EphemerisOrbit:
    """The orbit through positions in Earth-fixed axes, equation (1).

    Parameters
    ----------
    time_utc : (n,) datetime64, UTC, increasing.
    position_e_m : (n, 3) [m], ITRS axes; rows that are not finite are left out.
    eop : measured Earth orientation; UT1 = UTC without it (no matter for positions asked back in ITRS).
    name : what the orbit is called in reports.

    Errors: InputError for fewer than four positions, times out of order, radii that are no satellite's, axes that look
    inertial. Times outside the positions, or in pauses over 300 s, are refused when asked for.
    """
    times, position_e = _usable(as_utc(time_utc).reshape(-1), np.asarray(position_e_m, dtype=float))
    paths, alone = [], 0
    for piece in np.split(np.arange(times.size), np.flatnonzero(np.diff(times) > _ns(MAX_PAUSE_S)) + 1):
        if piece.size < FEWEST_POSITIONS:
            alone += piece.size
            continue
        path = _path(times[piece], _to_inertial(times[piece], position_e[piece], eop))
        _refuse_inertial(path, times[piece], position_e[piece])
        paths.append(path)
    if not paths:
        raise InputError(
            f"the {times.size} positions from {iso_utc(times[0], 0)} to {iso_utc(times[-1], 0)} give no orbit: "
            f"{FEWEST_POSITIONS} are needed without a pause over {MAX_PAUSE_S:g} s. Give a TLE, OMM or OEM with --orbit instead."
        )
    return EphemerisOrbit(name=name, kind="positions", eop=eop, paths=tuple(paths), remarks=tuple(_remarks(paths, alone)))


def _usable(times: np.ndarray, position_e: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Times and finite positions, once shape, order and radius hold."""
    if position_e.shape != (times.size, 3):
        raise InputError(f"position_e_m must be ({times.size}, 3) [m], as many as times; got shape {position_e.shape}.")
    finite = np.isfinite(position_e).all(axis=1)
    times, position_e = times[finite], position_e[finite]
    if times.size < FEWEST_POSITIONS:
        raise InputError(f"an orbit needs {FEWEST_POSITIONS} positions at least; {times.size} of {finite.size} are finite.")
    late = np.flatnonzero(np.diff(times) <= _ns(0.0))
    if late.size:
        raise InputError(f"the position at {iso_utc(times[late[0] + 1])} is not after the one before it; sort the times first.")
    with np.errstate(over="ignore"):
        radius = np.linalg.norm(position_e, axis=1)
    if radius.min() < RADIUS_M[0] or radius.max() > RADIUS_M[1]:
        bad = radius.min() if radius.min() < RADIUS_M[0] else radius.max()
        guess = " Are the columns in km? Multiply by 1000." if 6.3e3 < np.median(radius) < 1e6 else ""
        raise InputError(f"a position lies {bad:.6g} m from the Earth's centre; a satellite flies beyond 6.4e+06 m.{guess}")
    return times, position_e


def _to_inertial(times: np.ndarray, position_e: np.ndarray, eop: EarthOrientation | None) -> np.ndarray:
    """Equation (1), in blocks."""
    position_i = np.empty_like(position_e)
    for start in range(0, times.size, BLOCK):
        block = slice(start, start + BLOCK)
        position_i[block] = np.einsum("nji,nj->ni", dcm_ei(times[block], eop), position_e[block])
    return position_i


def _path(times: np.ndarray, position_i: np.ndarray) -> SplinePath:
    """The least-squares spline of one piece without long pauses."""
    from scipy.interpolate import make_interp_spline

    seconds = (times - times[0]).astype(np.int64) * 1e-9
    knots = _knots(seconds)
    if len(knots) + DEGREE + 1 >= seconds.size:  # as many coefficients as positions
        spline = make_interp_spline(seconds, position_i, k=min(DEGREE, seconds.size // 2 * 2 - 1))
    else:
        spline = _least_squares_spline(seconds, position_i, knots)
    scatter = float(np.sqrt(np.mean(np.sum((spline(seconds) - position_i) ** 2, axis=1))))
    return SplinePath(first_utc=times[0], last_utc=times[-1], spline=spline, scatter_m=scatter, samples=seconds.size)


def _least_squares_spline(seconds: np.ndarray, position_i: np.ndarray, knots: np.ndarray):
    """The spline of given interior knots that is nearest to the positions, by banded normal equations.

    They square the condition number, about 1e4 for this degree, which costs 0.01 mm here; the orthogonal way of
    `make_lsq_spline` took 10 times as long.
    """
    from scipy.interpolate import BSpline
    from scipy.linalg import solveh_banded

    ends = [seconds[0]] * (DEGREE + 1), [seconds[-1]] * (DEGREE + 1)
    all_knots = np.concatenate((ends[0], knots, ends[1]))
    size = len(knots) + DEGREE + 1
    band, right = np.zeros((DEGREE + 1, size)), np.zeros((size, 3))
    for start in range(0, seconds.size, BLOCK):
        block = slice(start, start + BLOCK)
        basis = BSpline.design_matrix(seconds[block], all_knots, DEGREE)
        normal = (basis.T @ basis).tocsr()
        for offset in range(DEGREE + 1):
            band[DEGREE - offset, offset:] += normal.diagonal(offset)
        right += basis.T @ position_i[block]
    return BSpline(all_knots, solveh_banded(band, right), DEGREE)


def _knots(seconds: np.ndarray) -> np.ndarray:
    """Interior knots: samples at least KNOT_SPACING_S after the knot before, and before the end."""
    knots, last = [], 0.0
    while True:
        index = np.searchsorted(seconds, last + KNOT_SPACING_S)
        if index >= seconds.size or seconds[index] > seconds[-1] - KNOT_SPACING_S:
            return np.array(knots)
        last = seconds[index]
        knots.append(last)


def _refuse_inertial(path: SplinePath, times: np.ndarray, position_e: np.ndarray) -> None:
    """InputError when the columns fall freely as they stand, and not as Earth-fixed ones, equation (2)."""
    fixed = _free_fall_misfit(path)
    if fixed > FLIES_OTHERWISE and (inertial := _free_fall_misfit(_path(times, position_e))) < FALLS:
        raise InputError(
            f"the positions do not move as a satellite does in Earth-fixed axes (acceleration off by {fixed:.0%} of gravity) "
            f"but do in inertial ones ({inertial:.1%}). Are the columns in GCRS, J2000 or TEME? Give ITRS (ECEF) ones, or a TLE."
        )


def _free_fall_misfit(path: SplinePath) -> float:
    """Equation (2) in the inner part of a path; NaN, which no limit catches, where it is too short to say."""
    knots = path.spline.t[path.spline.k + 1 : -path.spline.k - 1]
    if len(knots) < FEWEST_KNOTS_TO_JUDGE:
        return float("nan")
    inner = knots[1:-1]  # the spline's second derivative is poor at its ends
    position, acceleration = path.spline(inner), path.spline(inner, 2)
    gravity = -EARTH_GM_M3_S2 * position / np.linalg.norm(position, axis=1, keepdims=True) ** 3
    return float(np.linalg.norm(acceleration - gravity) / np.linalg.norm(gravity))


def _remarks(paths: list[SplinePath], alone: int) -> list[str]:
    """What the user should know of the positions."""
    remarks = []
    worst = max(path.scatter_m for path in paths)
    if worst > SCATTER_WARN_M:
        remarks.append(f"the positions scatter about a smooth path by {worst:.3g} m RMS: rounded, or of mixed units?")
    if len(paths) > 1:
        remarks.append(f"the positions pause for over {MAX_PAUSE_S:g} s {len(paths) - 1} times; nothing is interpolated there.")
    if alone:
        remarks.append(f"{alone} positions stand alone between pauses and are not used.")
    return remarks


def _ns(seconds: float) -> np.timedelta64:
    """A time span."""
    return np.timedelta64(round(seconds * 1e9), "ns")
