"""A tracking line held on a star by three coils or two (figure 5 of the study), in a field that stands or turns.

The study prints neither figure 5's curves nor the constants of its computer. Assumed: 1,356 kg m^2 (1,000 slug ft^2)
about every axis, a field of 0.25e-4 T, 50 A m^2 a coil at most (the torque of 5,000 dyne cm in a field of 0.1 gauss),
w_n = 0.1 rad/s and zeta = 0.7, the field still in inertial axes. w_n was chosen so that B_x/B = 0.01 settles in the
100 s or so that the study tells of: a calibration, no confirmation. What matters is limit, zeta and the quotient

    M_max B_x / (J w_n^2 A_limit)                                                                          (1)

alone; all times go as 1/w_n. The gains of (2) of `flight` are K_p = J w_n^2, K_d = 2 zeta J w_n. With an integral of rate
a = `integral_per_s` the closed loop is put at (s^2 + 2 zeta w_n s + w_n^2)(s + a) by the compensation

    K_p = J (w_n^2 + 2 zeta w_n a),   K_d = J (2 zeta w_n + a),   K_i = J w_n^2 a                          (2)

Without it the gains stay as they were, and the loop is unstable for a >= 2 zeta w_n: the study's warning.
"""

from __future__ import annotations

import numpy as np

from fieldline.cases.ames_1961.dipole_field import SOURCE, settings_text, times
from fieldline.cases.ames_1961.flight import STATES, Vehicle, fly
from fieldline.cases.erbs_like import number
from fieldline.errors import InputError
from fieldline.frames.attitude import quat_exp
from fieldline.mechanics.rigid_body import as_inertia9

ARCSECOND_RAD = np.pi / 648000.0
INERTIA_KG_M2 = 1356.0
FIELD_TESLA = 0.25e-4
MOMENT_LIMIT_A_M2 = 50.0
NATURAL_RATE_RAD_S = 0.1
DAMPING = 0.7
SETTLED_ARCSEC = 0.1
WORDS = {"equal": "B_y = B_z", "y-zero": "B_y = 0", "z-zero": "B_z = 0"}
TRANSVERSE = tuple(WORDS)
FIELD_STEP_S = 0.05  # of a turning field's table


def pointing(
    coils: int = 3,
    field_ratio: float = 0.05,
    transverse: str = "equal",
    error_arcsec=(6.0, 0.0),
    sensor_limit_arcsec: float = 1.2,
    *,
    rate_arcsec_s=(0.0, 0.0),
    disturbance_n_m=(0.0, 0.0, 0.0),
    field_ratio_rate_per_s: float = 0.0,
    field_roll_rate_deg_s: float = 0.0,
    measured_field_scale=(1.0, 1.0, 1.0),
    integral_per_s: float = 0.0,
    compensated: bool = True,
    small_angle: bool = False,
    natural_rate_rad_s: float = NATURAL_RATE_RAD_S,
    damping: float = DAMPING,
    inertia_kg_m2=INERTIA_KG_M2,
    field_tesla: float = FIELD_TESLA,
    moment_limit_a_m2: float = MOMENT_LIMIT_A_M2,
    duration_s: float = 400.0,
    step_s: float = 0.002,
    sample_s: float = 0.1,
):
    """How the line comes to its star from an error, as an xarray Dataset over `seconds`.

    Parameters
    ----------
    coils : 3, the least moment (8), or 2, M_x = 0 (10).
    field_ratio : B_x/B at the start; transverse : "equal" (B_y = B_z), "y-zero" (B_y = 0) or "z-zero".
    error_arcsec, rate_arcsec_s : A_y, A_z and their rates at the start.
    sensor_limit_arcsec : of each error's signal.
    disturbance_n_m : constant torque, inertial axes that are the body's while the line is on its star.
    field_ratio_rate_per_s : change of B_x/B at a constant B. field_roll_rate_deg_s : turning of the rest about the line.
    measured_field_scale : factors on the field that the law takes for true; (-1, 1, 1) is a wrong sign of B_x.
    small_angle : the analogue computer's kinematics, (4) of `flight`, instead of the rigid body's.
    integral_per_s, compensated : the integral's rate a, and whether the other gains follow it (2).
    inertia_kg_m2 : one number for all axes, three or (3, 3); the gains take J_y and J_z's mean.

    Returns
    -------
    Dataset: error and sensor [arcsec] over line (y, z), roll_angle [deg], rate [arcsec/s], moment [A m^2], field_b [T],
    torque [N m], limited (share of time with a coil at its limit), settling_s and overshoot_arcsec over line.
    """
    _refuse(coils, transverse)
    settings = dict(locals())
    seconds = times(duration_s, sample_s)
    field_i, field_step = _field_table(
        field_tesla, field_ratio, field_ratio_rate_per_s, transverse, field_roll_rate_deg_s, duration_s
    )
    vehicle = vehicle_of(
        inertia_kg_m2=inertia_kg_m2,
        coils=coils,
        natural_rate_rad_s=natural_rate_rad_s,
        damping=damping,
        integral_per_s=integral_per_s,
        compensated=compensated,
        sensor_limit_arcsec=sensor_limit_arcsec,
        moment_limit_a_m2=moment_limit_a_m2,
        measured_field_scale=measured_field_scale,
        disturbance_i=disturbance_n_m,
        small_angle=small_angle,
    )
    state = state_of(_two("error_arcsec", error_arcsec), _two("rate_arcsec_s", rate_arcsec_s), small_angle)
    flown = flown_of(state, seconds, field_i, field_step, step_s, vehicle)
    dataset = dataset_of(flown, seconds, vehicle, sensor_limit_arcsec)
    dataset.attrs.update(
        title=f"{coils} coils, B_x/B = {field_ratio:g}, {WORDS[transverse]}, from {_shown(error_arcsec)} arcsec",
        case="ames_1961_pointing",
        source=f"{SOURCE}; constants assumed",
        settings_json=settings_text(settings),
    )
    return dataset


def vehicle_of(
    *,
    inertia_kg_m2,
    coils,
    natural_rate_rad_s,
    damping,
    integral_per_s,
    compensated,
    sensor_limit_arcsec,
    moment_limit_a_m2,
    measured_field_scale=(1.0, 1.0, 1.0),
    disturbance_i=(0.0, 0.0, 0.0),
    roll_rate_rad_s=0.0,
    small_angle=False,
) -> Vehicle:
    """The checked numbers as `fly` takes them; gains by (2)."""
    matrix = np.asarray(inertia_kg_m2, dtype=float)
    inertia, inverse = as_inertia9(np.full(3, float(matrix)) if matrix.ndim == 0 else matrix)
    w = number("natural_rate_rad_s", natural_rate_rad_s, 1e-4, 10.0)
    spread = 2.0 * number("damping", damping, 0.0, 10.0) * w
    a = number("integral_per_s", integral_per_s, 0.0, 10.0)
    extra = a if compensated else 0.0
    j = 0.5 * (inertia[4] + inertia[8])
    return Vehicle(
        inertia=inertia,
        inertia_inv=inverse,
        coils=int(coils),
        gain_p=j * (w * w + spread * extra),
        gain_d=j * (spread + extra),
        gain_i=j * w * w * a,
        sensor_limit=number("sensor_limit_arcsec", sensor_limit_arcsec, 1e-3, 1e5) * ARCSECOND_RAD,
        moment_limit=number("moment_limit_a_m2", moment_limit_a_m2, 1e-6),
        field_scale=three("measured_field_scale", measured_field_scale),
        disturbance_i=three("disturbance_n_m", disturbance_i),
        roll_rate=number("roll_rate_rad_s", roll_rate_rad_s, 0.0, 1.0),
        small_angle=bool(small_angle),
    )


def state_of(error_arcsec, rate_arcsec_s, small_angle=False) -> np.ndarray:
    """The state at the start: the body is turned by minus the errors about y and z."""
    turn = -ARCSECOND_RAD * np.asarray(error_arcsec, dtype=float)
    rate = -ARCSECOND_RAD * np.asarray(rate_arcsec_s, dtype=float)
    state = np.zeros(STATES)
    state[12:14] = -turn
    state[5:7] = rate
    if not small_angle:
        state[:4] = quat_exp((0.0, float(turn[0]), float(turn[1])))
    else:
        state[3] = 1.0
    return state


def flown_of(state, seconds, field_i, field_step, step_s, vehicle):
    """(states, moments, fields_b, full_share) at `seconds`, at a step that divides their interval."""
    number("step_s", step_s, 1e-6, float(seconds[1] - seconds[0]))
    interval = float(seconds[1] - seconds[0])
    each = int(np.ceil(interval / step_s - 1e-9))
    count = len(seconds)
    states, moments, fields_b, share = np.empty((count, STATES)), np.empty((count, 3)), np.empty((count, 3)), np.zeros(count)
    fly(state, field_i, field_step, interval / each, each, vehicle, seconds, states, moments, fields_b, share)
    return states, moments, fields_b, share


def errors_arcsec(states: np.ndarray) -> np.ndarray:
    """(n, 2) A_y and A_z [arcsec] of states (n, 12)."""
    x, y, z, w = states[:, :4].T
    star_b = np.stack([w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)])
    return np.stack([-np.arctan2(star_b[2], star_b[0]), np.arctan2(star_b[1], star_b[0])], axis=1) / ARCSECOND_RAD


def settling(seconds: np.ndarray, error: np.ndarray, within: float = SETTLED_ARCSEC) -> np.ndarray:
    """(2,) [s]: when each error last came within the limit; NaN where it is outside at the end."""
    outside = np.abs(error) > within
    last = np.array([np.flatnonzero(column)[-1] + 1 if column.any() else 0 for column in outside.T])
    return np.where(last < len(seconds), seconds[np.minimum(last, len(seconds) - 1)], np.nan)


def overshoot(error: np.ndarray) -> np.ndarray:
    """(2,): the largest error on the other side of zero than the start; below zero where it started at zero."""
    start = np.where(error[0] < 0.0, -1.0, 1.0)
    return np.maximum(0.0, (-start * error).max(axis=0))


def dataset_of(flown, seconds, vehicle: Vehicle, sensor_limit_arcsec: float):
    """The signals with their units."""
    import xarray as xr

    states, moments, fields_b, share = flown
    error = states[:, 12:14] / ARCSECOND_RAD if vehicle.small_angle else errors_arcsec(states)
    rolled = np.degrees(states[:, 11])
    line, axis = ("seconds", "line"), ("seconds", "axis")
    variables = {
        "error": (line, error, {"units": "arcsec", "long_name": "angle from line to star"}),
        "sensor": (line, np.clip(error, -sensor_limit_arcsec, sensor_limit_arcsec), {"units": "arcsec", "long_name": "sensor"}),
        "roll_angle": ("seconds", rolled, {"units": "deg", "long_name": "roll about the line, integral of its rate"}),
        "rate": (axis, states[:, 4:7] / ARCSECOND_RAD, {"units": "arcsec s-1", "long_name": "body rate", "axes": "b"}),
        "moment": (axis, moments, {"units": "A m2", "long_name": "moment of the coils", "axes": "b"}),
        "field_b": (axis, fields_b, {"units": "T", "long_name": "field", "axes": "b"}),
        "torque": (axis, np.cross(moments, fields_b), {"units": "N m", "long_name": "torque of the coils", "axes": "b"}),
        "limited": ("seconds", share, {"units": "1", "long_name": "share of the time before with a coil at its limit"}),
        "moment_squared_s": ("seconds", states[:, 10], {"units": "A2 m4 s", "long_name": "integral of the moment squared"}),
        "settling_s": (
            "line",
            settling(seconds, error),
            {"units": "s", "long_name": f"within {SETTLED_ARCSEC} arcsec from then on"},
        ),
        "overshoot_arcsec": ("line", overshoot(error), {"units": "arcsec", "long_name": "largest error past zero"}),
    }
    if vehicle.roll_rate > 0.0:
        variables["wheel_momentum"] = ("seconds", states[:, 9], {"units": "N m s", "long_name": "momentum of the roll wheel"})
    coords = {"seconds": ("seconds", seconds, {"units": "s"}), "line": ["y", "z"], "axis": list("xyz")}
    return xr.Dataset(variables, coords=coords)


def three(name: str, values) -> tuple[float, float, float]:
    """Three finite numbers as a tuple, or a refusal."""
    return tuple(_finite(name, values, 3))


def _two(name: str, values) -> np.ndarray:
    return _finite(name, values, 2)


def _finite(name: str, values, count: int) -> np.ndarray:
    """`count` finite numbers, or a refusal."""
    try:
        array = np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        array = np.empty(0)
    if array.shape != (count,) or not np.isfinite(array).all():
        raise InputError(f"{name} must be {count} finite numbers; got {values!r}.")
    return np.array([float(x) for x in array])


def _refuse(coils, transverse) -> None:
    if coils not in (2, 3):
        raise InputError(f"coils must be 2 or 3; got {coils!r}.")
    if transverse not in TRANSVERSE:
        raise InputError(f"transverse must be one of {', '.join(TRANSVERSE)}; got {transverse!r}.")


def _field_table(field_tesla: float, ratio: float, ratio_rate: float, transverse: str, roll_rate_deg_s: float, duration_s: float):
    """(n, 3) [T] and its step [s]: B_x/B goes at its rate, the rest of B turns about x at its own."""
    number("field_tesla", field_tesla, 1e-9, 1e-3)
    turned = np.radians(number("field_roll_rate_deg_s", roll_rate_deg_s, -10.0, 10.0))
    changes = ratio_rate or turned
    seconds = np.arange(0.0, duration_s + FIELD_STEP_S, FIELD_STEP_S) if changes else np.array([0.0, duration_s])
    along = number("field_ratio", ratio, -1.0, 1.0) + number("field_ratio_rate_per_s", ratio_rate, -1.0, 1.0) * seconds
    if np.abs(along).max() > 1.0:
        raise InputError(f"field_ratio goes to {along[-1]:g} in {duration_s:g} s; |B_x/B| is 1 at most. Take a smaller rate.")
    across = np.sqrt(1.0 - along * along)
    y, z = {"equal": (np.sqrt(0.5), np.sqrt(0.5)), "y-zero": (0.0, 1.0), "z-zero": (1.0, 0.0)}[transverse]
    c, s = np.cos(turned * seconds), np.sin(turned * seconds)
    return field_tesla * np.stack([along, (y * c - z * s) * across, (z * c + y * s) * across], axis=1), float(seconds[1])


def _shown(pair) -> str:
    return " and ".join(f"{value:g}" for value in pair)
