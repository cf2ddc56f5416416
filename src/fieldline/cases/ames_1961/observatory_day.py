"""A day of the Orbiting Astronomical Observatory on one star, by coils alone: where the field is lost and what that costs.

35 degrees of inclination, 805 km, a tenth of a second of arc, 100 dyne cm across the line: the study's figures. The field
turns as the satellite flies, so B_x/B passes zero two to three times an orbit; the line is held by three coils or two
with the constants of `line_pointing` and an integral that takes the constant torque.

The roll is not controlled by the law, and its torque (4) goes as 1/B_x: on its own the vehicle rolls past the 45 degrees
that the study allows within the day. `roll="wheel"` holds it by a wheel about the line, whose momentum is then part of
the price; `roll="free"` lets it go.

Field: the study's dipole, or any model of `fieldline.environment` from a date on. Energy: a coil draws
watts_per_moment2 M^2, by default as the study's coil does (2.21 W at 50 A m^2).
"""

from __future__ import annotations

import numpy as np

from fieldline.cases.ames_1961.dipole_field import ALTITUDE_M, SOURCE, TILT_DEG, field, settings_text, times
from fieldline.cases.ames_1961.line_pointing import (
    INERTIA_KG_M2,
    MOMENT_LIMIT_A_M2,
    SETTLED_ARCSEC,
    dataset_of,
    flown_of,
    state_of,
    three,
    vehicle_of,
)
from fieldline.cases.ames_1961.rotations import about_x, about_y, about_z
from fieldline.cases.erbs_like import number
from fieldline.constants import SECONDS_PER_DAY
from fieldline.errors import InputError

WATTS_PER_MOMENT2 = 2.21 / 50.0**2
FIELD_STEP_S = 2.0  # of the field's table: a straight line over it errs by 2e-6 of the field
ROLLS = ("wheel", "free")
LOST_RATIO = 0.05  # |B_x|/B below which the study sees the response change
ROLL_LIMIT_DEG = 45.0


def observatory(
    coils: int = 3,
    *,
    inclination_deg: float = 35.0,
    altitude_m: float = ALTITUDE_M,
    right_ascension_deg: float = 60.0,
    declination_deg: float = 20.0,
    roll_deg: float = 0.0,
    model: str = "study",
    degree: int | None = None,
    start_utc: str = "2025-06-01T00:00:00",
    duration_s: float = SECONDS_PER_DAY,
    disturbance_n_m=(0.0, 0.0, 1e-5),
    roll: str = "wheel",
    roll_rate_rad_s: float = 0.01,
    natural_rate_rad_s: float = 0.1,
    damping: float = 0.7,
    integral_per_s: float = 0.02,
    sensor_limit_arcsec: float = 3.0,
    inertia_kg_m2=INERTIA_KG_M2,
    moment_limit_a_m2: float = MOMENT_LIMIT_A_M2,
    watts_per_moment2: float = WATTS_PER_MOMENT2,
    tolerance_arcsec: float = SETTLED_ARCSEC,
    step_s: float = 0.02,
    sample_s: float = 1.0,
):
    """Error, roll, moment and cost over a day, as an xarray Dataset over `seconds` with the losses over `loss`.

    Parameters
    ----------
    coils : 3 or 2. inclination_deg, altitude_m : of the orbit, its node at zero right ascension.
    right_ascension_deg, declination_deg, roll_deg : the star and the roll about the line.
    model, degree : "study" (the tilted dipole) or a field model's name, up to a degree, with start_utc.
    disturbance_n_m : constant, in axes that do not turn, x along the line. roll, roll_rate_rad_s : "wheel" or "free".
    watts_per_moment2 : power of a coil over its moment squared [W/(A m^2)^2]. tolerance_arcsec : of each axis.

    Returns
    -------
    Dataset: the signals of `pointing`, along_line (B_x/B), power [W], energy [J]; for each stretch with an error above
    the tolerance loss_start_s, loss_length_s, loss_error_arcsec, loss_field_ratio; within_fraction and other scalars.
    """
    if roll not in ROLLS:
        raise InputError(f"roll must be one of {', '.join(ROLLS)}; got {roll!r}.")
    if coils not in (2, 3):
        raise InputError(f"coils must be 2 or 3; got {coils!r}.")
    settings = dict(locals())
    line_deg = three("right_ascension_deg, declination_deg, roll_deg", (right_ascension_deg, declination_deg, roll_deg))
    seconds = times(duration_s, sample_s)
    field_s = field_along(inclination_deg, altitude_m, line_deg, model, start_utc, duration_s, degree)
    vehicle = vehicle_of(
        inertia_kg_m2=inertia_kg_m2,
        coils=coils,
        natural_rate_rad_s=natural_rate_rad_s,
        damping=damping,
        integral_per_s=integral_per_s,
        compensated=True,
        sensor_limit_arcsec=sensor_limit_arcsec,
        moment_limit_a_m2=moment_limit_a_m2,
        disturbance_i=disturbance_n_m,
        roll_rate_rad_s=number("roll_rate_rad_s", roll_rate_rad_s, 1e-6, 1.0) if roll == "wheel" else 0.0,
    )
    flown = flown_of(state_of((0.0, 0.0), (0.0, 0.0)), seconds, field_s, FIELD_STEP_S, step_s, vehicle)
    dataset = dataset_of(flown, seconds, vehicle, sensor_limit_arcsec).drop_vars(["settling_s", "overshoot_arcsec"])
    _add_costs(dataset, number("watts_per_moment2", watts_per_moment2, 0.0))
    _add_losses(dataset, number("tolerance_arcsec", tolerance_arcsec, 1e-6))
    dataset.attrs = _provenance(settings)
    return dataset


def field_along(inclination_deg, altitude_m, line_deg, model: str, start_utc: str, duration_s: float, degree=None) -> np.ndarray:
    """(n, 3) [T] every FIELD_STEP_S, axes x along the line, by the study's dipole or a field model."""
    names = ("right_ascension_deg", "declination_deg", "roll_deg")
    line = dict(zip(names, line_deg, strict=True))
    span = duration_s + 2.0 * FIELD_STEP_S
    along = field(inclination_deg, altitude_m, TILT_DEG, duration_s=span, step_s=FIELD_STEP_S, **line)
    if model == "study":
        if degree is not None:
            raise InputError('the study\'s dipole has no degree; leave it out, or choose model="IGRF-14".')
        return np.ascontiguousarray(along["field_s"].values)
    field_i = _model_field(along["position_i"].values, along["seconds"].values, model, start_utc, degree)
    right_ascension, declination, roll = np.radians(line_deg)
    return np.ascontiguousarray(about_x(roll, about_y(-declination, about_z(right_ascension, field_i))))


def _model_field(position_i: np.ndarray, seconds: np.ndarray, model: str, start_utc: str, degree) -> np.ndarray:
    """(n, 3) [T], inertial axes, of a field model along the orbit from a date on."""
    from fieldline.environment import magnetic_field
    from fieldline.frames.earth_rotation import dcm_ei
    from fieldline.frames.time import as_utc

    time_utc = as_utc(start_utc, "start_utc") + np.rint(1e9 * seconds).astype("timedelta64[ns]")
    to_earth = dcm_ei(time_utc)
    field_e = magnetic_field(np.einsum("nij,nj->ni", to_earth, position_i), time_utc, model=model, degree=degree)
    return np.einsum("nji,nj->ni", to_earth, field_e)


def _add_costs(dataset, watts_per_moment2: float) -> None:
    """Ratio of the field along the line, power and energy of the coils."""
    field_b = dataset["field_b"].values
    along = field_b[:, 0] / np.linalg.norm(field_b, axis=1)
    power = watts_per_moment2 * (dataset["moment"].values ** 2).sum(axis=1)
    energy = watts_per_moment2 * dataset["moment_squared_s"].values
    dataset["along_line"] = ("seconds", along, {"units": "1", "long_name": "B_x/B, along the tracking line"})
    dataset["power"] = ("seconds", power, {"units": "W", "long_name": "power of the coils"})
    dataset["energy"] = ("seconds", energy, {"units": "J", "long_name": "energy of the coils since the start"})


def _add_losses(dataset, tolerance_arcsec: float) -> None:
    """Each stretch outside the tolerance, and the day in scalars."""
    seconds = dataset["seconds"].values
    worst = np.abs(dataset["error"].values).max(axis=1)
    ratio = np.abs(dataset["along_line"].values)
    found = [slice(a, b) for a, b in stretches(worst > tolerance_arcsec)]
    step = seconds[1] - seconds[0]
    columns = {
        "loss_start_s": ([seconds[one.start] for one in found], "s", "start of a stretch outside the tolerance"),
        "loss_length_s": ([(one.stop - one.start) * step for one in found], "s", "its length"),
        "loss_error_arcsec": ([worst[one].max() for one in found], "arcsec", "its largest error"),
        "loss_field_ratio": ([_least_near(ratio, one) for one in found], "1", "least |B_x|/B in it and 60 samples before"),
    }
    for name, (values, units, words) in columns.items():
        dataset[name] = ("loss", np.array(values, dtype=float), {"units": units, "long_name": words})
    rolled = np.abs(dataset["roll_angle"].values)
    beyond = np.flatnonzero(rolled > ROLL_LIMIT_DEG)
    scalars = {
        "within_fraction": (np.mean(worst <= tolerance_arcsec), "1", "share of the time within the tolerance"),
        "weak_fraction": (np.mean(ratio < LOST_RATIO), "1", f"share of the time with |B_x|/B below {LOST_RATIO}"),
        "crossings": (np.diff(np.signbit(dataset["along_line"].values)).sum(), "1", "times that B_x passes zero"),
        "error_rms_arcsec": (np.sqrt(np.mean(dataset["error"].values ** 2)), "arcsec", "error of an axis, RMS"),
        "error_max_arcsec": (worst.max(), "arcsec", "largest error of an axis"),
        "mean_power_w": (dataset["energy"].values[-1] / seconds[-1], "W", "mean power of the coils"),
        "roll_limit_after_s": (
            seconds[beyond[0]] if beyond.size else np.nan,
            "s",
            f"when the roll passes {ROLL_LIMIT_DEG:g} deg",
        ),
    }
    if "wheel_momentum" in dataset:
        stored = np.abs(dataset["wheel_momentum"].values).max()
        scalars["wheel_momentum_max"] = (stored, "N m s", "largest momentum of the roll wheel")
    for name, (value, units, words) in scalars.items():
        dataset[name] = ((), float(value), {"units": units, "long_name": words})


def stretches(condition: np.ndarray) -> list[tuple[int, int]]:
    """Start and end (past the last) of each run of true."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], condition, [False]]).astype(np.int8)))
    return list(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))


def _least_near(ratio: np.ndarray, one: slice) -> float:
    """The least of a stretch and of what led to it."""
    return float(ratio[max(0, one.start - 60) : one.stop].min())


def _provenance(settings: dict) -> dict:
    words = f"{settings['coils']} coils, roll {settings['roll']}, {settings['model']} field"
    return {
        "title": f"A day on one star: {words}",
        "case": "ames_1961_observatory",
        "source": f"{SOURCE}; scenario beyond the study",
        "settings_json": settings_text(settings),
        "tolerance_arcsec": float(settings["tolerance_arcsec"]),
    }
