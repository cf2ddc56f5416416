"""Earth rotation: GCRS (i), ITRS (e) and SGP4's TEME (t).

    v_e = W R3(ERA) Q v_i                                                               (1)
    v_i = Q^T R3(GMST82 - ERA) v_t                                                      (2)

Q turns GCRS to the celestial intermediate system (IAU 2006/2000A precession-nutation, from X, Y and s), ERA is the
Earth rotation angle of UT1, W is polar motion, R3(a) turns the axes by +a about z. TEME has the true equator and an
equinox such that R3(GMST82) alone turns it to Earth-fixed axes, so (2) follows from (1) with the same pole.

X, Y and s are computed every six hours and interpolated with cubics; ERA and GMST82 are exact at every time.
The interpolation moves a satellite by less than 0.1 mm. UT1 = UTC and no polar motion unless `eop` is given:
|UT1 - UTC| is kept under 0.9 s (418 m at the equator) and was under 0.12 s (56 m) from 2022 to September 2026,
and the pole wanders by 0.6 arcseconds (19 m) at most.

Source: IERS Conventions (2010), TN 36, ch. 5; Vallado, Crawford, Hujsak and Kelso (2006), AIAA 2006-6753, app. C;
the routines are those of ERFA. Valid from 1960, when UTC begins; before that UTC stands for UT1 and TAI alike.
"""

from __future__ import annotations

import warnings

import numpy as np

from fieldline.errors import InputError
from fieldline.frames.earth_orientation import EarthOrientation
from fieldline.frames.time import as_utc, utc_julian

NODE_DAYS = 0.25  # spacing of X, Y, s: the 13.7-day nutation is interpolated to 1e-6 arcseconds
WGS84 = 1  # ERFA's number of the ellipsoid
NO_EOP_STATEMENT = (
    "UT1 = UTC and no polar motion: up to 418 m along the equator (|UT1-UTC| < 0.9 s; under 56 m in 2022-2026) "
    "and 19 m from the pole's wandering"
)


def dcm_ei(time_utc, eop: EarthOrientation | None = None) -> np.ndarray:
    """Rotation from GCRS to ITRS axes, equation (1): v_e = dcm_ei @ v_i.

    Parameters
    ----------
    time_utc : (...) datetime64, UTC.
    eop : measured UT1-UTC and pole (`read_eop`); without it UT1 = UTC and the pole is the z axis.

    Returns
    -------
    (..., 3, 3), orthogonal.
    """
    times = as_utc(time_utc)
    flat = times.reshape(-1)
    turned = _turn_z(earth_rotation_angle(flat, eop), _intermediate_dcm(flat))
    if eop is not None:
        turned = _polar_motion(flat, eop) @ turned
    return turned.reshape(*times.shape, 3, 3)


def dcm_it(time_utc) -> np.ndarray:
    """Rotation from SGP4's TEME to GCRS axes, equation (2): v_i = dcm_it @ v_t; (..., 3, 3).

    The difference GMST82 - ERA grows by 50 arcseconds a year only, so it needs no measured UT1.
    """
    import erfa

    times = as_utc(time_utc)
    flat = times.reshape(-1)
    day, fraction = utc_julian(flat)
    equinox = erfa.gmst82(day, fraction) - erfa.era00(day, fraction)
    turned = _turn_z(-equinox, _intermediate_dcm(flat))  # the transpose of (2)
    return np.swapaxes(turned, -1, -2).reshape(*times.shape, 3, 3)


def earth_rotation_angle(time_utc, eop: EarthOrientation | None = None) -> np.ndarray:
    """ERA(UT1) [rad], the angle of (1), of (...) times."""
    import erfa

    times = as_utc(time_utc)
    day, fraction = utc_julian(times)
    if eop is not None:
        fraction = fraction + eop.ut1_minus_utc_s(times) / 86400.0
    return erfa.era00(day, fraction)


def geodetic_from_itrs(position_e) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Latitude [rad], longitude [rad, -pi to pi] and height [m] over WGS84 of (..., 3) [m], ITRS axes.

    To 5 micrometres below 1,000 km and 2 mm below 100,000 km, poles included (Fukushima 2006, in ERFA).
    """
    import erfa

    position = np.asarray(position_e, dtype=float)
    if position.ndim == 0 or position.shape[-1] != 3:
        raise InputError(f"position_e must be (..., 3) [m]; got shape {position.shape}. Did you pass (3, N)? Use .T.")
    longitude, latitude, height = erfa.gc2gd(WGS84, position)
    return latitude, longitude, height


def itrs_from_geodetic(latitude_rad, longitude_rad, height_m) -> np.ndarray:
    """(..., 3) [m], ITRS axes, of latitude, longitude [rad] and height [m] over WGS84."""
    import erfa

    latitude = np.asarray(latitude_rad, dtype=float)
    if (np.abs(latitude) > np.pi / 2 + 1e-12).any():
        raise InputError(
            f"latitude_rad must lie within -pi/2 and pi/2; got {np.abs(latitude).max():.6g}. Is it in degrees? Use np.radians."
        )
    clipped = np.clip(latitude, -np.pi / 2, np.pi / 2)
    return erfa.gd2gc(WGS84, *np.broadcast_arrays(np.asarray(longitude_rad, dtype=float), clipped, np.asarray(height_m, float)))


def _turn_z(angle: np.ndarray, matrices: np.ndarray) -> np.ndarray:
    """R3(angle) @ matrices, (n, 3, 3)."""
    c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
    turned = np.empty_like(matrices)
    turned[:, 0] = c * matrices[:, 0] + s * matrices[:, 1]
    turned[:, 1] = c * matrices[:, 1] - s * matrices[:, 0]
    turned[:, 2] = matrices[:, 2]
    return turned


def _intermediate_dcm(flat: np.ndarray) -> np.ndarray:
    """Q of (1), (n, 3, 3), at (n,) times."""
    import erfa

    if flat.size == 0:
        return np.zeros((0, 3, 3))
    day, fraction = utc_julian(flat)
    start = np.floor(day.min())
    place = ((day - start) + fraction) / NODE_DAYS  # in node spacings
    cell = np.floor(place).astype(np.int64)
    first, inverse = np.unique(cell, return_inverse=True)
    nodes, where = np.unique(first[:, None] + np.arange(-1, 3), return_inverse=True)
    x, y, s = _cip(start, nodes * NODE_DAYS)
    corner = where.reshape(-1, 4)[inverse.reshape(-1)]
    weights = _cubic_weights(place - cell)
    return erfa.c2ixys(*(np.einsum("nk,nk->n", weights, quantity[corner]) for quantity in (x, y, s)))


def _cip(start_jd: float, days: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """X, Y [direction cosines] and s [rad] of the celestial intermediate pole, IAU 2006/2000A."""
    import erfa

    with warnings.catch_warnings():
        # ERFA calls years before 1960 or far ahead dubious for want of leap seconds: one second moves Q by 1e-11 rad.
        warnings.simplefilter("ignore", erfa.ErfaWarning)
        tai = erfa.utctai(start_jd, days)
    return erfa.xys06a(*erfa.taitt(*tai))


def _cubic_weights(u: np.ndarray) -> np.ndarray:
    """(n, 4) Lagrange weights of the nodes -1, 0, 1, 2 at u in [0, 1)."""
    return np.stack(
        (
            -u * (u - 1.0) * (u - 2.0) / 6.0,
            (u + 1.0) * (u - 1.0) * (u - 2.0) / 2.0,
            -(u + 1.0) * u * (u - 2.0) / 2.0,
            (u + 1.0) * u * (u - 1.0) / 6.0,
        ),
        axis=-1,
    )


def _polar_motion(flat: np.ndarray, eop: EarthOrientation) -> np.ndarray:
    """W of (1), (n, 3, 3); s' is 5e-5 arcseconds a century and taken at the middle."""
    import erfa

    x, y = eop.pole_rad(flat)
    day, fraction = utc_julian(flat)
    return erfa.pom00(x, y, erfa.sp00(day, fraction))
