"""The tank changes its orbit: by the closed form of chapter 5, by averages over orbit and day, and flown on the plant.

Its conductors along x and y, in pairs of equal currents, so that no moment is left; the towers are chosen so that C > B > A
and gravity keeps it upright. A contact may take less current in the dark: averages and plant know that, the closed form does not.
"""

from __future__ import annotations

import numpy as np

from fieldline.cases.afit_1992.earth import SOURCE
from fieldline.cases.afit_1992.flown import START_UTC, vehicle_scenario
from fieldline.cases.ames_1961.dipole_field import settings_text
from fieldline.cases.erbs_like import number
from fieldline.constants import EARTH_EQUATORIAL_RADIUS_M, SECONDS_PER_DAY
from fieldline.design.conductor import spiral_radius
from fieldline.design.tracking_vehicle import tank_with_towers
from fieldline.environment.sun import sun_direction_i
from fieldline.errors import InputError

STEP_S = 10.0
MOST_FLOWN_DAYS = 10.0


def orbit_change(
    to_altitude_km: float = 410.0,
    to_inclination_deg: float | None = None,
    *,
    altitude_km: float = 400.0,
    inclination_deg: float = 28.5,
    days: float = 3.0,
    flown_days: float = 1.0,
    contact_light_a: float = 125.0,
    contact_dark_a: float = 125.0,
    resistance_ohm: float = 1.0,
):
    """Height and inclination over `seconds`, averaged, flown and by the closed form.

    Parameters
    ----------
    to_altitude_km, to_inclination_deg : wanted; the inclination of the start by default.      altitude_km, inclination_deg.
    days : of the averages.      flown_days : of the plant, up to 10.
    contact_light_a, contact_dark_a : most current of a contact.      resistance_ohm : of each circuit.

    Returns
    -------
    Dataset: altitude_m, inclination_deg, power_w over seconds; flown_altitude_m (semi-major axis), flown_inclination_deg over
    flown_seconds; closed_altitude_m (constant thrust of full current at the mean field); energy_j, charge_c.
    """
    from fieldline.analysis.orbit_transfer import orbit_transfer

    settings = dict(locals())
    settings.pop("orbit_transfer")
    for name, least, most in (("days", 0.1, 3650.0), ("flown_days", 0.0, MOST_FLOWN_DAYS), ("resistance_ohm", 0.0, 1e6)):
        number(name, settings[name], least, most)
    for name in ("to_altitude_km", "altitude_km"):
        number(name, settings[name], 150.0, 5000.0)
    number("inclination_deg", inclination_deg, 0.0, 180.0)
    _refuse_nothing(settings)
    sun_i = sun_direction_i(np.datetime64(START_UTC))
    made = tank_with_towers(vertical_m=330.0, horizontal_m=310.0, thruster=False)
    pairs = [one for one in made.conductors if one.name[-1] in "udew"]
    tilt = inclination_deg if to_inclination_deg is None else number("to_inclination_deg", to_inclination_deg, 0.0, 180.0)
    found = orbit_transfer(
        pairs,
        made.mass_kg,
        1e3 * altitude_km,
        np.radians(inclination_deg),
        to_altitude_m=1e3 * to_altitude_km,
        to_inclination_rad=np.radians(tilt),
        duration_s=days * SECONDS_PER_DAY,
        contact_light_a=number("contact_light_a", contact_light_a, 0.0),
        contact_dark_a=number("contact_dark_a", contact_dark_a, 0.0),
        resistance_ohm=resistance_ohm,
        time_utc="2025-03-01",
        **_sun_over(sun_i, np.radians(inclination_deg)),
    )
    flown = _flown(made, pairs, tilt, sun_i, settings) if flown_days > 0.0 else None
    return _dataset(found, flown, _closed(found, made, pairs, settings), settings)


def _sun_over(sun_i: np.ndarray, inclination: float) -> dict[str, float]:
    """Where the Sun stands for an orbit whose node is on the vernal equinox."""
    ahead, normal = (
        np.array([0.0, np.cos(inclination), np.sin(inclination)]),
        np.array([0.0, -np.sin(inclination), np.cos(inclination)]),
    )
    return {
        "sun_argument_rad": float(np.arctan2(ahead @ sun_i, sun_i[0])),
        "sun_elevation_rad": float(np.arcsin(normal @ sun_i)),
    }


def _closed(found, made, pairs, settings) -> np.ndarray:
    """(k,) [m] heights of a constant thrust: full current of the vertical conductors in the mean field across the orbit."""
    from fieldline.environment.orbit_field import field_on_orbit_h

    radius = EARTH_EQUATORIAL_RADIUS_M + 1e3 * settings["altitude_km"]
    u, w = np.linspace(0.0, 2.0 * np.pi, 48, endpoint=False)[:, None], np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
    field = field_on_orbit_h(radius, np.radians(settings["inclination_deg"]), u, w, np.datetime64("2025-03-01"))
    length = sum(one.length_m for one in pairs if one.direction_b[0] == 1.0)
    current = min(settings["contact_light_a"], pairs[0].current_max_a)
    way = np.sign(settings["to_altitude_km"] - settings["altitude_km"])
    thrust = way * current * length * abs(float(field[..., 2].mean()))
    heights = spiral_radius(radius, thrust / made.mass_kg, found["seconds"].values) - EARTH_EQUATORIAL_RADIUS_M
    end = 1e3 * settings["to_altitude_km"]
    return np.minimum(heights, end) if way >= 0 else np.maximum(heights, end)


def _flown(made, pairs, tilt: float, sun_i: np.ndarray, settings) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(seconds, height of the semi-major axis [m], inclination [deg]) on the plant, the means of an orbit."""
    from fieldline.orbit.elements import elements_from_state
    from fieldline.simulate.run import simulate

    parameters = {"altitude_km": settings["to_altitude_km"], "inclination_deg": tilt}
    if settings["contact_dark_a"] < settings["contact_light_a"]:
        parameters |= {"contact_dark_a": settings["contact_dark_a"], "sun_i": sun_i.tolist()}
    scenario = vehicle_scenario(
        made,
        "orbit-by-current",
        parameters,
        inclination_deg=settings["inclination_deg"],
        place_m=np.zeros(3),
        duration_s=settings["flown_days"] * SECONDS_PER_DAY,
        rate_hz=0.05,
        step_s=STEP_S,
        output_s=120.0,
    )
    body = scenario.to_dict()["body"][1]
    names = {one.name for one in pairs}
    body["conductor"] = [one for one in body["conductor"] if one["name"] in names]
    limit = min(settings["contact_light_a"], 125.0)
    body["conductor"] = [one | {"current_max_a": limit} for one in body["conductor"]]
    body = {key: value for key, value in body.items() if key != "offset_o_m"}
    elements = {"altitude_km": settings["altitude_km"], "inclination_deg": settings["inclination_deg"]}
    run = simulate(scenario.replace(body=[body], orbit={"elements": elements}))
    found = [
        elements_from_state(r, v) for r, v in zip(run["position_i"].values[:, 0], run["velocity_i"].values[:, 0], strict=True)
    ]
    axis = np.array([one.semi_major_axis_m for one in found]) - EARTH_EQUATORIAL_RADIUS_M
    return run["seconds"].values, axis, np.degrees([one.inclination_rad for one in found])


def _dataset(found, flown, closed: np.ndarray, settings: dict):
    """The three ways."""
    import xarray as xr

    data = found.assign(closed_altitude_m=("seconds", closed, {"units": "m", "long_name": "height by constant thrust"}))
    if flown is not None:
        data = data.assign_coords(flown_seconds=("flown_seconds", flown[0], {"units": "s"}))
        data["flown_altitude_m"] = xr.DataArray(flown[1], dims="flown_seconds", attrs={"units": "m"})
        data["flown_inclination_deg"] = xr.DataArray(flown[2], dims="flown_seconds", attrs={"units": "degree"})
    end, tilt = float(found["altitude_m"][-1]) / 1e3, float(found["inclination_deg"][-1])
    data.attrs = {
        "title": f"{settings['days']:g} days of current: {settings['altitude_km']:g} to {end:.4g} km, "
        f"{settings['inclination_deg']:g} to {tilt:.4g} deg",
        "case": "afit_1992_orbit_change",
        "source": f"{SOURCE}, chapters 5 and 6",
        "settings_json": settings_text(settings),
    }
    return data


def _refuse_nothing(settings: dict) -> None:
    """InputError where nothing is to change."""
    if settings["to_altitude_km"] == settings["altitude_km"] and settings["to_inclination_deg"] in (
        None,
        settings["inclination_deg"],
    ):
        raise InputError("nothing is to change: give to_altitude_km or to_inclination_deg other than those of the start.")
