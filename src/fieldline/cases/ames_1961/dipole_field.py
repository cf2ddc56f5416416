"""The field along a satellite's orbit in inertial axes (figures 1 and 2 of the study), its lines, and when it is lost.

The Earth is the study's: a dipole at its centre, `tilt_deg` from its axis, turning at the Earth's rate; the orbit is a
circle that does not precess. Seen in axes that do not turn, every component is then exactly five lines,

    0,  we,  2n,  2n - we,  2n + we          (we: the Earth's rate, n: the orbit's)                          (1)

because (A10) is linear in the dipole, which has lines 0 and we, and quadratic in the place, which has 0 and 2n. The
study's two sinusoids, at 2n and we, are the largest of them only where the orbit is little inclined.

Assumed, since the study does not say: 805 km (the 500 miles of the Orbiting Astronomical Observatory), node, argument
and the pole's right ascension zero at the start, 3.12e-5 T at the equator on the ground (the dipole of about 1960).
The field over the pole is then 4.37e-5 T at that height; the 0.25e-4 T of the study is met at 2,271 km.
"""

from __future__ import annotations

import numpy as np

from fieldline.cases.ames_1961.rotations import Chain, field_chain, orbital_position
from fieldline.cases.erbs_like import number
from fieldline.constants import EARTH_GM_M3_S2, EARTH_MEAN_RADIUS_M, EARTH_ROTATION_RATE_RAD_S, MU0_OVER_4PI, SECONDS_PER_DAY
from fieldline.errors import InputError

ALTITUDE_M = 805e3
TILT_DEG = 17.0
EQUATORIAL_FIELD_TESLA = 3.12e-5  # of the dipole, on the ground
DIPOLE_MOMENT_A_M2 = EQUATORIAL_FIELD_TESLA * EARTH_MEAN_RADIUS_M**3 / MU0_OVER_4PI
SOURCE = "White, Shigemoto and Bourquin (1961), NASA TN D-1068"
LINES = ("0", "we", "2n", "2n-we", "2n+we")
MOST_SAMPLES = 2_000_000


def field(
    inclination_deg: float = 35.0,
    altitude_m: float = ALTITUDE_M,
    tilt_deg: float = TILT_DEG,
    *,
    duration_s: float = SECONDS_PER_DAY,
    step_s: float = 10.0,
    node_deg: float = 0.0,
    argument_deg: float = 0.0,
    pole_right_ascension_deg: float = 0.0,
    right_ascension_deg: float = 0.0,
    declination_deg: float = 0.0,
    roll_deg: float = 0.0,
    dipole_moment_a_m2: float = DIPOLE_MOMENT_A_M2,
):
    """The dipole's field along a circular orbit, as an xarray Dataset over `seconds`.

    Parameters
    ----------
    inclination_deg, altitude_m : of the orbit, over a sphere of the Earth's mean radius.
    tilt_deg : of the dipole from the Earth's axis (the study's 17; 9.2 in 2025).
    node_deg, argument_deg, pole_right_ascension_deg : of satellite and north magnetic pole at the start.
    right_ascension_deg, declination_deg, roll_deg : the tracking line, x of axes S; all zero: S is the inertial axes.
    dipole_moment_a_m2 : P, positive.

    Returns
    -------
    Dataset: position_i [m], field_i and field_s [T], magnitude [T], normalised_s (over the field above the pole),
    along_line (B_x/B), phi and psi [rad]; attributes: polar field [T], period [s], minima of the magnitude and more.
    """
    _bounded_angles(inclination_deg, tilt_deg)
    number("dipole_moment_a_m2", dipole_moment_a_m2, 1.0)
    seconds = times(duration_s, step_s)
    settings = {key: value for key, value in locals().items() if key != "seconds"}
    radius = EARTH_MEAN_RADIUS_M + number("altitude_m", altitude_m, 100e3, 1e9)
    mean_motion = float(np.sqrt(EARTH_GM_M3_S2 / radius**3))
    argument = np.radians(argument_deg) + mean_motion * seconds
    shape = np.full(seconds.shape, radius)
    position_i = orbital_position(shape, np.radians(node_deg), np.radians(inclination_deg), argument)
    pole = np.radians(pole_right_ascension_deg) + EARTH_ROTATION_RATE_RAD_S * seconds
    line = np.radians([right_ascension_deg, declination_deg, roll_deg])
    chain = field_chain(position_i, pole, np.radians(90.0 - tilt_deg), line, dipole_moment_a_m2)
    polar = 2.0 * MU0_OVER_4PI * dipole_moment_a_m2 / radius**3
    return _dataset(seconds, chain, polar, mean_motion, settings)


def times(duration_s: float, step_s: float) -> np.ndarray:
    """(n,) [s] from zero; InputError where they would be too many."""
    number("duration_s", duration_s, 1e-3)
    number("step_s", step_s, 1e-4, duration_s)
    count = int(np.floor(duration_s / step_s * (1.0 + 1e-12))) + 1
    if count > MOST_SAMPLES:
        raise InputError(
            f"{duration_s:g} s every {step_s:g} s is {count:,} samples; at most {MOST_SAMPLES:,}. Take a longer step."
        )
    return step_s * np.arange(count)


def settings_text(settings: dict) -> str:
    """The arguments of a call as JSON, for its provenance."""
    import json

    kinds = (tuple, list, np.ndarray, np.generic)
    return json.dumps({k: np.asarray(v).tolist() if isinstance(v, kinds) else v for k, v in settings.items()})


def minima_of(magnitude) -> np.ndarray:
    """Indices of the minima inside a series."""
    values = np.asarray(magnitude)
    return 1 + np.flatnonzero((values[1:-1] < values[:-2]) & (values[1:-1] <= values[2:]))


def lines(dataset):
    """Amplitudes of the five lines (1) in each component of normalised_s, by least squares, with what they leave.

    Dataset over line and axis: amplitude (dc with its sign) and phase_rad at the start; residual: largest, over axis.
    """
    import xarray as xr

    seconds = dataset["seconds"].values
    basis, rates = _basis(seconds, dataset.attrs["mean_motion_rad_s"])
    values = dataset["normalised_s"].values
    weights, *_ = np.linalg.lstsq(basis, values, rcond=None)
    cosine, sine = weights[1::2], weights[2::2]
    amplitude = np.vstack([weights[:1], np.hypot(cosine, sine)])
    phase = np.vstack([np.zeros((1, 3)), np.arctan2(-sine, cosine)])
    about = {"units": "1", "long_name": "amplitude over the field above the pole; of the constant, with its sign"}
    return xr.Dataset(
        {
            "amplitude": (("line", "axis"), amplitude, about),
            "phase_rad": (("line", "axis"), phase, {"units": "rad", "long_name": "phase of the cosine at the start"}),
            "residual": ("axis", np.abs(values - basis @ weights).max(axis=0), {"units": "1", "long_name": "largest misfit"}),
        },
        coords={"line": list(LINES), "axis": list("xyz"), "rate_rad_s": ("line", rates, {"units": "rad s-1"})},
    )


def lost_field(dataset, limits=(0.05, 0.01), directions: int = 400):
    """How often a tracking line is nearly across the field, over the whole sky.

    Dataset over direction: right_ascension_deg and declination_deg of lines spread evenly (a golden spiral), crossings
    of B_x = 0 per orbit, and over limit the fraction of time with |B_x|/B below it.
    """
    import xarray as xr

    k = np.arange(int(number("directions", directions, 1, 100_000))) + 0.5
    declination = np.arcsin(1.0 - 2.0 * k / len(k))
    right_ascension = np.mod(np.pi * (1.0 + np.sqrt(5.0)) * k, 2.0 * np.pi)
    level = np.cos(declination)
    line_i = np.stack([level * np.cos(right_ascension), level * np.sin(right_ascension), np.sin(declination)])
    along = dataset["field_i"].values / dataset["magnitude"].values[:, None] @ line_i
    orbits = dataset["seconds"].values[-1] / dataset.attrs["period_s"]
    crossings = (np.diff(np.signbit(along), axis=0)).sum(axis=0) / orbits
    share = np.stack([(np.abs(along) < limit).mean(axis=0) for limit in limits])
    return xr.Dataset(
        {
            "crossings_per_orbit": ("direction", crossings, {"units": "1", "long_name": "times that B_x passes zero, per orbit"}),
            "time_fraction": (("limit", "direction"), share, {"units": "1", "long_name": "time with |B_x|/B below the limit"}),
            "right_ascension_deg": ("direction", np.degrees(right_ascension), {"units": "deg"}),
            "declination_deg": ("direction", np.degrees(declination), {"units": "deg"}),
        },
        coords={"limit": list(limits)},
    )


def across_field_eigenvalues(dataset) -> np.ndarray:
    """(3,), rising: of the mean of I - b b^T, the share of time in which momentum along each axis can be dumped."""
    b = dataset["field_i"].values / dataset["magnitude"].values[:, None]
    return np.linalg.eigvalsh(np.eye(3) - b.T @ b / len(b))


def _basis(seconds: np.ndarray, mean_motion: float) -> tuple[np.ndarray, np.ndarray]:
    """Columns 1, cos, sin of each line's phase, and the lines' rates [rad/s]."""
    we = EARTH_ROTATION_RATE_RAD_S
    rates = np.array([0.0, we, 2.0 * mean_motion, 2.0 * mean_motion - we, 2.0 * mean_motion + we])
    angles = np.multiply.outer(seconds, rates[1:])
    waves = np.stack([np.cos(angles), np.sin(angles)], axis=-1).reshape(len(seconds), -1)
    return np.column_stack([np.ones(len(seconds)), waves]), rates


def _dataset(seconds: np.ndarray, chain: Chain, polar_tesla: float, mean_motion: float, settings: dict):
    """The signals with their units."""
    import xarray as xr

    magnitude = np.linalg.norm(chain.field_i, axis=1)
    vector = ("seconds", "axis")
    variables = {
        "position_i": (vector, chain.position_i, {"units": "m", "long_name": "place of the satellite", "axes": "i"}),
        "field_i": (vector, chain.field_i, {"units": "T", "long_name": "field in inertial axes", "axes": "i"}),
        "field_s": (vector, chain.field_s, {"units": "T", "long_name": "field in the vehicle's axes, x the line", "axes": "s"}),
        "normalised_s": (
            vector,
            chain.field_s / polar_tesla,
            {"units": "1", "long_name": "field_s over the field above the pole"},
        ),
        "magnitude": ("seconds", magnitude, {"units": "T", "long_name": "magnitude of the field"}),
        "along_line": ("seconds", chain.field_s[:, 0] / magnitude, {"units": "1", "long_name": "B_x/B, along the tracking line"}),
        "phi": ("seconds", chain.phi_rad, {"units": "rad", "long_name": "angle about the dipole's axis"}),
        "psi": ("seconds", chain.psi_rad, {"units": "rad", "long_name": "angle from the dipole's axis"}),
    }
    minima = minima_of(magnitude)
    return xr.Dataset(
        variables,
        coords={"seconds": ("seconds", seconds, {"units": "s"}), "axis": list("xyz")},
        attrs={
            "title": f"Field along a circular orbit at {settings['inclination_deg']:g} deg, tilted dipole",
            "case": "ames_1961_field",
            "source": f"{SOURCE}, Appendix A",
            "settings_json": settings_text(settings),
            "polar_field_tesla": polar_tesla,
            "mean_motion_rad_s": mean_motion,
            "period_s": 2.0 * np.pi / mean_motion,
            "minima": len(minima),
            "magnitude_ratio": float(magnitude.max() / magnitude.min()),
        },
    )


def _bounded_angles(inclination_deg: float, tilt_deg: float) -> None:
    """InputError where an angle makes no sense."""
    number("inclination_deg", inclination_deg, 0.0, 180.0)
    number("tilt_deg", tilt_deg, 0.0, 90.0)
