"""Section 2 of the report for the body of its test case: where the axis can stand, and whether it stays there.

`fieldline.analysis.spinning_subsatellite` has the equations; here are the report's numbers, and Datasets to draw.
"""

from __future__ import annotations

import numpy as np

from fieldline.analysis.spinning_subsatellite import (
    SpinningSubsatellite,
    axis_motion,
    characteristic_coefficients,
    critical_angle,
    critical_spin,
    first_order_angles,
    growth_rate,
    kind_of,
    spin_for_angle,
    stability_map,
)
from fieldline.analysis.spinning_subsatellite.stability import LEAST_KAPPA, MOST_KAPPA, frequencies, squared_exponents
from fieldline.cases.ames_1961.dipole_field import settings_text
from fieldline.cases.erbs_like import number
from fieldline.cases.sao_1982.flight import SOURCE, pair_at
from fieldline.cases.sao_1982.runs import (
    ALTITUDE_M,
    AXIAL_KG_M2,
    LENGTH_M,
    OFFSET_M,
    SHUTTLE_KG,
    SUBSATELLITE_KG,
    TRANSVERSE_KG_M2,
)
from fieldline.errors import InputError, shown

MOST_ROWS = 20_000
PUSH_RAD = 1e-4


def report_body(
    *,
    axial_inertia_kg_m2: float = AXIAL_KG_M2,
    transverse_inertia_kg_m2: float = TRANSVERSE_KG_M2,
    offset_m: float = OFFSET_M,
    tension_n: float | None = None,
    orbital_rate_rad_s: float | None = None,
) -> SpinningSubsatellite:
    """The report's subsatellite at 220 km on 20 km of tether; any number may be another."""
    two = pair_at(ALTITUDE_M, SUBSATELLITE_KG, SHUTTLE_KG, LENGTH_M)
    return SpinningSubsatellite(
        axial_inertia_kg_m2=axial_inertia_kg_m2,
        transverse_inertia_kg_m2=transverse_inertia_kg_m2,
        tension_n=two.tension_n if tension_n is None else tension_n,
        offset_m=offset_m,
        orbital_rate_rad_s=two.orbital_rate_rad_s if orbital_rate_rad_s is None else orbital_rate_rad_s,
    )


def stationary(
    spin_rad_s=None,
    *,
    axial_inertia_kg_m2: float = AXIAL_KG_M2,
    transverse_inertia_kg_m2: float = TRANSVERSE_KG_M2,
    offset_m: float = OFFSET_M,
    tension_n: float | None = None,
    orbital_rate_rad_s: float | None = None,
):
    """Angles at which the axis stands still, (16) to (26), over the spin, as an xarray Dataset.

    spin_rad_s : phi' [rad/s], a list or one number; by default 1e-4 to 1 in equal ratios. The rest: the body,
    its tether's pull and its orbit, by default the report's.

    Returns theta (spin, solution) [rad], two or four in rising order and NaN for the rest; kind and growth [1/s] with it;
    first_order (spin, branch) [rad] of (26); number (spin). Attributes kappa, critical_angle_deg, critical_spin_rad_s.
    """
    settings = dict(locals())
    subsatellite = report_body(
        axial_inertia_kg_m2=axial_inertia_kg_m2,
        transverse_inertia_kg_m2=transverse_inertia_kg_m2,
        offset_m=offset_m,
        tension_n=tension_n,
        orbital_rate_rad_s=orbital_rate_rad_s,
    )
    spins = _few("spin_rad_s", np.geomspace(1e-4, 1.0, 200) if spin_rad_s is None else spin_rad_s)
    data = stability_map(subsatellite, spins, [subsatellite.offset_m]).isel(offset=0).drop_vars("critical_spin")
    first = np.array([first_order_angles(subsatellite, float(spin)) for spin in spins])
    words = {"units": "rad", "long_name": "angle to first order of (C - A) n^2, (26)"}
    data["first_order"] = (("spin", "branch"), first, words)
    data["number"] = ("spin", np.isfinite(data["theta"].values).sum(axis=1), {"long_name": "stationary angles that exist"})
    data.coords["branch"] = ["hanging", "inverted"]
    data.attrs = _attributes(subsatellite, "sao_1982_stationary", "Stationary angles over the spin", settings)
    return data


def stability(
    theta_deg=None,
    *,
    orbits: float = 0.0,
    axial_inertia_kg_m2: float = AXIAL_KG_M2,
    transverse_inertia_kg_m2: float = TRANSVERSE_KG_M2,
    offset_m: float = OFFSET_M,
    tension_n: float | None = None,
    orbital_rate_rad_s: float | None = None,
):
    """The small motion about each angle, by the right (39), and the whole motion beside it, as an xarray Dataset.

    theta_deg : angles [deg], a list or one number, no multiples of 180; by default 1 to 359 in odd degrees. orbits : how long
    the whole motion is followed from a push of 1e-4 rad in theta; 0: not at all. The rest: as in `stationary`.

    Returns, over theta: spin [rad/s] that stands there, p2, p1, p0 of (39) over A^2 n^4, mu_real and mu_imaginary (theta,
    root) [n^2], frequency (theta, root) [rad/s] or NaN, growth [1/s], kind; with orbits also away [rad], the farthest from
    the stationary place, and the drifts of (29) and of the Jacobi integral over their sizes.
    """
    settings = dict(locals())
    import xarray as xr

    subsatellite = report_body(
        axial_inertia_kg_m2=axial_inertia_kg_m2,
        transverse_inertia_kg_m2=transverse_inertia_kg_m2,
        offset_m=offset_m,
        tension_n=tension_n,
        orbital_rate_rad_s=orbital_rate_rad_s,
    )
    degrees = _few("theta_deg", np.arange(1.0, 360.0, 2.0) if theta_deg is None else theta_deg)
    straight = degrees[np.abs(np.remainder(degrees + 90.0, 180.0) - 90.0) < 1e-3]
    if straight.size:
        raise InputError(f"theta_deg must be no multiple of 180: no finite spin stands there; got {straight[0]:.10g}.")
    theta, n = np.radians(degrees), subsatellite.orbital_rate_rad_s
    p2, p1, p0 = characteristic_coefficients(subsatellite.kappa, theta)
    mu, frequency = squared_exponents(subsatellite.kappa, theta), frequencies(subsatellite, theta)
    data = xr.Dataset(
        {
            "spin": ("theta", spin_for_angle(subsatellite, theta), {"units": "rad s-1", "long_name": "stationary spin"}),
            "p2": ("theta", p2),
            "p1": ("theta", p1),
            "p0": ("theta", p0),
            "mu_real": (("theta", "root"), mu.real, {"long_name": "real part of the squared exponent over n^2"}),
            "mu_imaginary": (("theta", "root"), mu.imag, {"long_name": "imaginary part of the squared exponent over n^2"}),
            "frequency": (("theta", "root"), frequency, {"units": "rad s-1", "long_name": "angular frequency, if stable"}),
            "growth": ("theta", growth_rate(subsatellite, theta), {"units": "s-1", "long_name": "rate of growth"}),
            "kind": ("theta", kind_of(subsatellite.kappa, theta)),
        },
        coords={"theta": ("theta", theta, {"units": "rad", "long_name": "stationary angle"})},
        attrs=_attributes(subsatellite, "sao_1982_stability", "Stability of the stationary angles", settings),
    )
    if number("orbits", orbits, 0.0, 200.0) > 0.0:
        _add_whole_motion(data, subsatellite, orbits * 2.0 * np.pi / n)
    return data


def stability_chart(
    spin_rad_s=None,
    offset_m=None,
    *,
    axial_inertia_kg_m2: float = AXIAL_KG_M2,
    transverse_inertia_kg_m2: float = TRANSVERSE_KG_M2,
    tension_n: float | None = None,
    orbital_rate_rad_s: float | None = None,
):
    """`analysis.spinning_subsatellite.stability_map` of the report's subsatellite, over spin [rad/s] and offset [m]."""
    settings = dict(locals())
    subsatellite = report_body(
        axial_inertia_kg_m2=axial_inertia_kg_m2,
        transverse_inertia_kg_m2=transverse_inertia_kg_m2,
        tension_n=tension_n,
        orbital_rate_rad_s=orbital_rate_rad_s,
    )
    spins = _few("spin_rad_s", np.geomspace(2e-4, 0.05, 120) if spin_rad_s is None else spin_rad_s)
    offsets = _few("offset_m", np.geomspace(1e-3, 2.0, 100) if offset_m is None else offset_m)
    if not (offsets > 0.0).all():
        raise InputError(f"offset_m must be above zero [m]; got {offsets.min():g}.")
    data = stability_map(subsatellite, spins, offsets)
    data.attrs = _attributes(subsatellite, "sao_1982_stability_chart", "Stability over spin and offset", settings)
    return data


def _add_whole_motion(data, body: SpinningSubsatellite, duration_s: float) -> None:
    """The farthest that the axis goes after a push, and what should be conserved."""
    away, axial, jacobi = [], [], []
    for theta, spin in zip(data["theta"].values, data["spin"].values, strict=True):
        run = axis_motion(body, float(theta) + PUSH_RAD, float(spin), duration_s, samples=2001)
        still = np.array([np.sin(theta), 0.0, np.cos(theta)])
        axes = run["direction"].values
        away.append(float(np.arctan2(np.linalg.norm(np.cross(axes, still), axis=1), axes @ still).max()))
        axial.append(_drift(run["axial_momentum"].values))
        jacobi.append(_drift(run["jacobi"].values))
    data["away"] = ("theta", away, {"units": "rad", "long_name": "farthest from the stationary place after a push"})
    data["axial_drift"] = ("theta", axial, {"units": "1", "long_name": "drift of C r0 over its size"})
    data["jacobi_drift"] = ("theta", jacobi, {"units": "1", "long_name": "drift of the Jacobi integral over its size"})
    data.attrs |= {"push_rad": PUSH_RAD, "duration_s": duration_s}


def _drift(values: np.ndarray) -> float:
    """Spread of a series over its size."""
    return float(np.ptp(values) / np.abs(values).max())


def _few(name: str, given) -> np.ndarray:
    """The numbers that were given, or InputError for a list that is none, or too long."""
    try:
        values = np.atleast_1d(np.asarray(given, dtype=float))
    except (TypeError, ValueError):
        values = np.empty(0)
    if values.ndim != 1 or not 0 < values.size <= MOST_ROWS or not np.isfinite(values).all():
        raise InputError(f"{name} must be a number or a list of 1 to {MOST_ROWS} finite numbers; got {shown(repr(given))}.")
    return values


def _attributes(body: SpinningSubsatellite, case: str, title: str, settings: dict) -> dict:
    """What a Dataset says of itself."""
    inside = LEAST_KAPPA <= body.kappa <= MOST_KAPPA
    return {
        "title": title,
        "case": case,
        "source": f"{SOURCE}, section 2",
        "settings_json": settings_text(settings),
        "kappa": body.kappa,
        "tension_n": body.tension_n,
        "orbital_rate_rad_s": body.orbital_rate_rad_s,
        "critical_angle_deg": float(np.degrees(critical_angle(body.kappa))) if inside else float("nan"),
        "critical_spin_rad_s": critical_spin(body) if inside else float("nan"),
    }
