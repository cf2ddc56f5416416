"""Events against times found independently: where a quantity crosses, which way, and what a stop does."""

import numpy as np
import pytest
from scipy.optimize import brentq

import fieldline as fl
import plant_flights as pf
from fieldline.environment.eclipse import eclipse
from fieldline.frames.earth_rotation import dcm_ei, geodetic_from_itrs

START = np.datetime64("2026-03-01T00:00:00", "ns")
MICROSECOND = 1e-6
METHODS = {"rk4": {"step_s": 5.0}, "dop853": {"method": "dop853"}}
ELLIPSE = {"elements": {"semi_major_axis_km": 7000.0, "eccentricity": 0.03, "inclination_deg": 63.0}}
POINT = pf.body(kind="point")


def found(flight):
    """(n, 3) rows of events: which, when, which way."""
    return flight.events.found[: int(flight.clock.events[0])]


def fine(orbit, seconds):
    """Positions (n, 3) [m] of the two-body orbit at any times, by Kepler's equation."""
    e = orbit["elements"]
    axis, ecc, tilt = 1e3 * e["semi_major_axis_km"], e["eccentricity"], np.radians(e["inclination_deg"])
    mean = np.sqrt(3.986004418e14 / axis**3) * np.asarray(seconds, dtype=float)
    big = mean.copy()
    for _ in range(60):
        big = big - (big - ecc * np.sin(big) - mean) / (1.0 - ecc * np.cos(big))
    x, y = axis * (np.cos(big) - ecc), axis * np.sqrt(1 - ecc**2) * np.sin(big)
    return np.stack([x, y * np.cos(tilt), y * np.sin(tilt)], axis=-1)


def crossings(quantity, seconds, step=10.0):
    """Times at which a function of time is zero, bisected from a grid, with the way it goes."""
    grid = np.arange(0.0, seconds + step / 2, step)
    values = np.array([quantity(t) for t in grid])
    out = []
    for k in np.flatnonzero(values[:-1] * values[1:] < 0):
        out.append((brentq(quantity, grid[k], grid[k + 1], xtol=1e-9), np.sign(values[k + 1] - values[k])))
    return out


def plane_event(name, z, **more):
    return {"kind": "user", "name": name, "function": "user_functions:height", "parameters": {"z": z}} | more


def time_of(t):
    return START + np.timedelta64(round(1e9 * t), "ns")


@pytest.mark.parametrize("method", METHODS)
def test_eclipses_altitudes_and_planes_are_met_to_a_microsecond(method):
    flight = pf.flown(
        POINT,
        seconds=12000.0,
        orbit=ELLIPSE,
        integrator=METHODS[method] | {"relative_tolerance": 1e-12, "position_tolerance_m": 1e-6},
        event=[
            {"kind": "eclipse"},
            {"kind": "altitude", "altitude_km": 650.0},
            plane_event("node", 0.0),
            plane_event("up", 1e6, direction="rising"),
            plane_event("down", 1e6, direction="falling"),
        ],
    )

    def dark(t):
        return eclipse(fine(ELLIPSE, t), time_of(t)) - 0.5

    def height(t):
        return geodetic_from_itrs(dcm_ei(np.array([time_of(t)]))[0] @ fine(ELLIPSE, t))[2] - 650e3

    def plane(z):
        return lambda t: fine(ELLIPSE, t)[2] - z

    expected = [crossings(dark, 12000.0), crossings(height, 12000.0), crossings(plane(0.0), 12000.0)]
    both = crossings(plane(1e6), 12000.0)
    expected += [[one for one in both if one[1] > 0], [one for one in both if one[1] < 0]]
    events = found(flight)
    for k, times in enumerate(expected):
        mine = events[events[:, 0] == k]
        mine = mine[np.argsort(mine[:, 1])]
        if k == 2:
            mine = mine[mine[:, 1] > 0]
        assert len(mine) == len(times) >= 2
        # the orbit of rk4 at 5 s is 2e-5 m off after two turns, that of Kepler's equation is exact
        assert np.abs(mine[:, 1] - [t for t, _ in times]).max() < (20 if method == "rk4" else 2) * MICROSECOND
        assert np.array_equal(mine[:, 2], [way for _, way in times])


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("when", [37.123456, 40.0, 50.0, 0.4])
def test_a_stop_is_where_it_should_be(method, when):
    """Also where the event falls on the end of a step, and in the first one."""
    event = [{"kind": "user", "function": "user_functions:clock", "parameters": {"at": when}, "stop": True}]
    flight = pf.flown(seconds=100.0, output=1.0, integrator=METHODS[method], event=event)
    assert flight.outcome.name == "STOPPED"
    assert abs(flight.clock.t[0] - when) < MICROSECOND
    assert flight.complete
    seconds, _ = pf.rows(flight)
    assert abs(seconds[-1] - when) < MICROSECOND  # the moment itself is the last row
    assert len(seconds) == int(np.ceil(when)) + 1 and np.all(np.diff(seconds) > 0)
    assert len(found(flight)) == 1
    # the state left is that of the stop
    assert np.abs(flight.y[:3] - pf.flown(seconds=when).y[:3]).max() < 1e-4


@pytest.mark.parametrize("method", METHODS)
def test_the_first_of_several_stops_in_one_step_counts(method):
    """Four events within one step: the earlier are kept, the stop ends the run, what lies behind it is not told."""

    def event(name, at, stop=False):
        return {"kind": "user", "name": name, "function": "user_functions:clock", "parameters": {"at": at}, "stop": stop}

    events = [event("late", 33.9), event("stop", 32.5, True), event("later stop", 33.0, True), event("early", 31.25)]
    dataset = fl.simulate(pf.scenario(seconds=100.0, output=10.0, integrator=METHODS[method], event=events))
    assert list(dataset.event_name.values) == ["early", "stop"]
    seconds = (dataset.event_time.values - START).astype(float) * 1e-9
    assert np.allclose(seconds, [31.25, 32.5], atol=MICROSECOND)
    assert dataset.attrs["complete"] == 1 and "32.5" in dataset.attrs["outcome"]


@pytest.mark.parametrize("method", METHODS)
def test_a_rate_threshold_is_met_where_torque_and_inertia_say(method):
    """A sphere spun up from rest by a constant torque passes 1 deg/s at w I / N."""
    record = pf.body(inertia_kg_m2=(2.0, 2.0, 2.0), rate_deg_s=(0.0, 0.0, 0.0), disturbance_torque_b_n_m=(3e-4, 0.0, 4e-4))
    event = [{"kind": "rate", "rate_deg_s": 1.0}]
    flight = pf.flown(record, seconds=100.0, integrator=METHODS[method], event=event)
    assert len(found(flight)) == 1
    assert abs(found(flight)[0, 1] - np.radians(1.0) * 2.0 / 5e-4) < MICROSECOND


def test_an_event_of_the_users_that_fails_ends_the_run(tmp_path):
    (tmp_path / "mine.py").write_text("def bad(t, state, parameters):\n    return [1.0] if t < 20 else 1 / 0\n")
    event = [{"kind": "user", "name": "mine", "function": "mine.py:bad"}]
    scenario = pf.scenario(seconds=100.0, event=event)
    scenario._folder = tmp_path
    with pytest.raises(fl.InputError, match="ZeroDivisionError"):
        fl.simulate(scenario)
