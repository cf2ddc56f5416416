"""The thesis's vehicles on the full plant for a day: the regulator of an instant, the mended ones, and what a limit leaves.

Two bodies in the plant's gravity and field, the vehicle rigid, its conductors pushed by the field where it is, its angles
as large as they become. Controllers:

    frozen      u = M r - K x of the field at 33 degrees, as in appendix E
    turning     the same K, but the controls that hold the place from the field as it turns
    allocated   loads of one constant regulator, allocated within limits at each call
    scheduled   over the day the gain of each instant, allocated within limits
    periodic    gains over the day that know how the field turns, allocated within limits
    predictive  the best plan over the next 45 minutes, within limits
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fieldline.cases.afit_1992.approaches import APPROACHES
from fieldline.cases.afit_1992.earth import (
    ALTITUDE_M,
    DIPOLE_TESLA_M3,
    EARTH_RADIUS_M,
    FIELD_ANGLE_DEG,
    POLE_LATITUDE_DEG,
    POLE_LONGITUDE_DEG,
    SOURCE,
    circle,
    frozen_field_h,
)
from fieldline.cases.afit_1992.frozen_model import built
from fieldline.cases.ames_1961.dipole_field import settings_text
from fieldline.cases.erbs_like import number
from fieldline.design.tracking_vehicle import TrackingVehicle
from fieldline.errors import InputError, nearest, shown

if TYPE_CHECKING:
    from fieldline.simulate.scenario.scenario import Scenario

CONTROLLERS = ("frozen", "turning", "allocated", "scheduled", "periodic", "predictive")
FIELDS = ("thesis", "dipole", "IGRF-14")
A_M2_PER_TESLA_M3 = 1e7  # 4 pi / mu0
START_UTC = "2025-03-01T00:00:00"
TUMBLED_DEG = 60.0
UP_AHEAD_ACROSS = (0.5, 0.5, -0.5, 0.5)  # quaternion of body axes along h, from the plant's orbital axes


def flown(
    case: str = "standoff",
    controller: str = "frozen",
    inclination_deg: float = 0.0,
    *,
    field: str = "thesis",
    onboard: str | None = None,
    field_scale: float = 1.0,
    place_m=None,
    start_m=None,
    duration_s: float = 86_164.0,
    rate_hz: float = 1.0,
    step_s: float = 5.0,
    current_max_a: float = 1e5,
    thrust_max_n: float = 1e4,
    disturbance_s: float = 0.0,
    gravity: str = "point",
    drag_area_m2: float = 0.0,
    eccentricity: float = 0.0,
    contact_limit_a: float | None = None,
    towers_m=None,
):
    """A day of a case's vehicle under a controller on the plant, as a Dataset over `seconds`.

    Parameters
    ----------
    case : "standoff", "r-bar" or "v-bar" of appendix E: vehicle and weights.      controller : see the module.
    field : "thesis" (its dipole), "dipole" or "IGRF-14", the truth.      onboard : the model on board; the truth by default.
    field_scale : the truth's field over what is believed of it.
    place_m : held (3,) [m]; the case's own by default.      start_m : where it begins; there by default.
    current_max_a, thrust_max_n : limits; far away by default, as in the thesis.
    disturbance_s : in which unknown loads are learned; 0 never.      gravity, drag_area_m2, eccentricity : of the surroundings.
    contact_limit_a : most current that the plasma takes from a contactor; lowers current_max_a.
    towers_m : vertical and horizontal, (2,) [m]; the case's own by default. (330, 310) keeps upright by gravity.

    Returns
    -------
    Dataset: place_h_m (seconds, axis), error_m and angle_deg (seconds), current_a (seconds, conductor), peak_current_a,
    rms_m (axis; of the second half), tumble_s (from where the body is over 60 deg off; NaN if never).

    Raises
    ------
    InputError : an unknown case, controller or field; a place that the limits cannot hold.
    """
    settings = dict(locals())
    for name, value, known in (("case", case, APPROACHES), ("controller", controller, CONTROLLERS), ("field", field, FIELDS)):
        if not isinstance(value, str) or value not in known:
            raise InputError(f'{name} "{shown(str(value))}" is unknown; {nearest(str(value), known)}')
    own = APPROACHES[case]
    vertical, horizontal = own.towers_m if towers_m is None else _numbers("towers_m", towers_m, 2)
    made = built({"vertical_m": vertical, "horizontal_m": horizontal, "arms": "centre"})
    place = _numbers("place_m", own.target_m if place_m is None else place_m, 3)
    start = place if start_m is None else _numbers("start_m", start_m, 3)
    for name in ("field_scale", "duration_s", "rate_hz", "step_s", "current_max_a", "thrust_max_n"):
        number(name, settings[name], 1e-9)
    limit = current_max_a if contact_limit_a is None else min(current_max_a, number("contact_limit_a", contact_limit_a, 1e-9))
    law, parameters = _law(controller, own.state_weight, place, field_scale, disturbance_s, limit >= 1e4)
    scenario = vehicle_scenario(
        made,
        law,
        parameters,
        inclination_deg=number("inclination_deg", inclination_deg, 0.0, 180.0),
        place_m=start,
        field=field,
        onboard=onboard,
        duration_s=duration_s,
        rate_hz=rate_hz,
        step_s=step_s,
        current_max_a=limit,
        thrust_max_n=thrust_max_n,
        gravity=gravity,
        drag_area_m2=drag_area_m2,
        eccentricity=eccentricity,
    )
    return _dataset(_flight(scenario), place, settings)


def _numbers(name: str, given, count: int) -> np.ndarray:
    """(count,) [m], or a refusal."""
    try:
        lengths = np.asarray(given, dtype=float)
    except (TypeError, ValueError):
        lengths = np.empty(0)
    if lengths.shape != (count,) or not np.isfinite(lengths).all() or np.abs(lengths).max() > 1e5:
        wanted = "three places x, y, z" if count == 3 else "two lengths, vertical and horizontal,"
        raise InputError(f"{name} must be {wanted} in metres, under 100 km; got {given!r}.")
    return lengths


def _law(controller, state_weight, place, field_scale, disturbance_s, free: bool) -> tuple[str, dict]:
    """The plant's law and its parameters."""
    common = {"place_h_m": place.tolist(), "disturbance_s": disturbance_s, "filter_s": 0.0}
    common["unreachable"] = "fly" if free else "refuse"
    if controller in ("frozen", "turning"):
        believed = frozen_field_h(circle(ALTITUDE_M), FIELD_ANGLE_DEG) / field_scale
        own = {
            "frozen_field_h_nt": (1e9 * believed).tolist(),
            "state_weight": state_weight,
            "feed_forward": controller,
            "field_factor": 1.0 / field_scale,
        }
        return "tracking-frozen", common | own
    return f"tracking-{controller}", common | {"field_factor": 1.0 / field_scale}


def vehicle_scenario(
    made: TrackingVehicle,
    law: str,
    parameters: dict,
    *,
    inclination_deg: float,
    place_m,
    field: str = "IGRF-14",
    onboard: str | None = None,
    duration_s: float = 86_164.0,
    rate_hz: float = 1.0,
    step_s: float = 5.0,
    output_s: float = 60.0,
    current_max_a: float = 125.0,
    thrust_max_n: float = 10.0,
    gravity: str = "point",
    drag_area_m2: float = 0.0,
    eccentricity: float = 0.0,
) -> Scenario:
    """A scenario of a target and a vehicle at place_m (3,) [m] beside it, at rest; perfect sensors, Greenwich at the node."""
    from fieldline.frames.earth_rotation import dcm_ei
    from fieldline.simulate.scenario.scenario import Scenario

    turned = dcm_ei(np.datetime64(START_UTC))
    greenwich = float(np.degrees(np.arctan2(turned[0, 1], turned[0, 0])) % 360.0)
    x, y, z = (float(one) for one in place_m)
    size = {"drag": {"area_m2": drag_area_m2}} if drag_area_m2 > 0.0 else {}
    elements = {
        "semi_major_axis_km": 1e-3 * (EARTH_RADIUS_M + ALTITUDE_M),
        "inclination_deg": inclination_deg,
        "raan_deg": greenwich,
        "eccentricity": eccentricity,
    }
    target = {"name": "target", "kind": "point", "mass_kg": 1000.0}
    vehicle = {
        "name": "vehicle",
        "mass_kg": made.mass_kg,
        "inertia_kg_m2": list(made.inertia_kg_m2),
        "gravity_gradient": True,
        "attitude": {"quaternion_bo": UP_AHEAD_ACROSS},
        "rate_deg_s": (0.0, 0.0, 0.0),
        "rate_axes": "orbital",
        "offset_o_m": (y, -z, -x),
        "star_tracker": {"rate_hz": rate_hz},
        "gyro": {"rate_hz": rate_hz},
        "conductor": [one.model_copy(update={"current_max_a": current_max_a}).model_dump() for one in made.conductors],
        "thruster": _pair(made, thrust_max_n),
        **({"onboard": {"field": onboard}} if onboard else {}),
        **size,
    }
    return Scenario.from_dict(
        {
            "name": "tracking vehicle",
            "time": {"start_utc": np.datetime64(START_UTC), "duration_s": duration_s, "output_step_s": output_s},
            "integrator": {"method": "rk4", "step_s": step_s},
            "environment": _environment(field, gravity, drag_area_m2),
            "orbit": {"elements": elements},
            "body": [target, vehicle],
            "software": [{"law": law, "body": "vehicle", "rate_hz": rate_hz, "parameters": parameters}],
        },
        "tracking vehicle",
    )


def _environment(field: str, gravity: str, drag_area_m2: float) -> dict:
    """The truth's surroundings."""
    found: dict = {"gravity": gravity, "field": field}
    if field == "thesis":
        d, w = np.radians([POLE_LATITUDE_DEG, POLE_LONGITUDE_DEG])
        pole = np.array([np.cos(d) * np.cos(w), np.cos(d) * np.sin(w), np.sin(d)])
        found |= {"field": "centred-dipole", "field_moment_e_a_m2": [(A_M2_PER_TESLA_M3 * DIPOLE_TESLA_M3 * pole).tolist()]}
    if drag_area_m2 > 0.0:
        found["atmosphere"] = {"model": "layered"}
    return found


def _pair(made: TrackingVehicle, thrust_max_n: float) -> list[dict]:
    """The thruster pair as two that push one way each."""
    if not made.thrusters:
        return []
    place = np.array(made.thrusters[0].position_b_m)
    rest = {"force_n": thrust_max_n, "specific_impulse_s": made.thrusters[0].specific_impulse_s}
    ways = (("south", 1.0), ("north", -1.0))
    return [{"name": n, "position_b_m": tuple(s * place), "direction_b": (0.0, 0.0, s), **rest} for n, s in ways]


def _flight(scenario):
    """The run; where the body tumbles faster than the step follows, what there is of it."""
    from fieldline.simulate import RunError
    from fieldline.simulate.run import simulate

    try:
        return simulate(scenario)
    except RunError as error:
        return error.dataset


def _dataset(run, place: np.ndarray, settings: dict):
    """Place, angle and currents over the day, and what they come to."""
    import xarray as xr

    from fieldline.simulate.approach import approach

    seen = approach(run)
    seconds = seen["seconds"].values
    error = seen["place_h_m"].values - place
    angle = np.linalg.norm(seen["angle_deg"].values, axis=1)
    over = seconds[angle > TUMBLED_DEG]
    tumble = float(over[0]) if len(over) else float("nan")
    rms = np.sqrt((error[len(error) // 2 :] ** 2).mean(axis=0))
    told = f"tumbles after {tumble:.0f} s" if len(over) else f"holds to {np.linalg.norm(rms):.3g} m RMS"
    attrs = {"units": "m", "axes": "h"}
    return xr.Dataset(
        {
            "place_h_m": (("seconds", "axis"), seen["place_h_m"].values, attrs | {"long_name": "place from the target"}),
            "error_m": ("seconds", np.linalg.norm(error, axis=1), {"units": "m", "long_name": "distance from the wanted place"}),
            "angle_deg": ("seconds", angle, {"units": "degree", "long_name": "turn from the target's axes"}),
            "current_a": (("seconds", "conductor"), seen["current_a"].values, {"units": "A"}),
            "peak_current_a": ((), float(np.abs(seen["current_a"].values).max()), {"units": "A"}),
            "rms_m": ("axis", rms, attrs | {"long_name": "RMS of the error over the second half"}),
            "tumble_s": ((), tumble, {"units": "s", "long_name": "from where the body is 60 deg off; NaN: never"}),
        },
        coords={"seconds": ("seconds", seconds, {"units": "s"}), "axis": list("xyz"), "conductor": seen["conductor"].values},
        attrs={
            "title": f"{settings['case']}, {settings['controller']}, {settings['inclination_deg']:g} deg: {told}",
            "case": "afit_1992_flown",
            "source": f"{SOURCE}, chapter 6",
            "settings_json": settings_text(settings),
            "outcome": run.attrs["outcome"],
        },
    )
