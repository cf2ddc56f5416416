"""Lawrence (1992), AFIT/GA/ENY/92D-05: its vehicles on the full plant.

The thesis has no such flights; the numbers are of an independent re-derivation with its own non-linear motion.
"""

import numpy as np
import pytest

from fieldline.cases.afit_1992 import docking_standards, flown, linear_range, orbit_change
from fieldline.errors import InputError

SIX_HOURS = 25_000.0


def test_over_the_equator_the_frozen_gain_holds_with_its_offset_across():
    found = flown("standoff", "frozen")
    across = np.abs(found["place_h_m"].values[:, 2] - 100.0)
    assert across.max() == pytest.approx(10.9, abs=0.05)
    assert float(found["rms_m"][2]) == pytest.approx(6.4, abs=0.15)
    assert float(found["peak_current_a"]) == pytest.approx(917.0, abs=0.5)
    assert np.isnan(float(found["tumble_s"]))


def test_feed_forward_is_the_main_gain():
    found = flown("standoff", "turning", duration_s=SIX_HOURS)
    assert found["rms_m"].values.max() < 0.1  # from 6.5 m


def test_at_the_designs_own_inclination_the_frozen_gain_tumbles():
    found = flown("standoff", "frozen", 28.5, duration_s=SIX_HOURS)
    assert float(found["tumble_s"]) == pytest.approx(21_000.0, abs=1000.0)


@pytest.mark.parametrize("controller", ["allocated", "scheduled", "periodic"])
def test_the_mended_ones_hold_there(controller):
    found = flown("standoff", controller, 28.5, duration_s=SIX_HOURS)
    assert found["rms_m"].values.max() < 0.1 and float(found["angle_deg"].max()) < 0.01


@pytest.mark.parametrize(("scale", "end"), [(0.7, (-487.0 + 100.0, 0.0)), (1.3, (0.0, 308.0 + 200.0))])
def test_a_field_off_by_a_third_leaves_hundreds_of_metres(scale, end):
    found = flown("standoff", "frozen", field_scale=scale)
    along = float(found["place_h_m"][-1, 1])
    assert min(end) - 60.0 < along < max(end) + 60.0 and abs(along - 100.0) > 300.0


def test_the_disturbance_estimate_takes_them_out():
    found = flown("standoff", "allocated", 28.5, field_scale=0.7, disturbance_s=600.0, duration_s=SIX_HOURS)
    assert found["rms_m"].values.max() < 0.15


WITHIN = {"place_m": (5.0, 100.0, 10.0), "current_max_a": 125.0, "thrust_max_n": 10.0, "duration_s": SIX_HOURS, "rate_hz": 0.2}
OFF = {"low": {"field_scale": 0.7}, "high": {"field_scale": 1.3}, "real": {"field": "IGRF-14", "onboard": "dipole"}}


@pytest.mark.parametrize("truth", OFF)
@pytest.mark.parametrize("controller", ["allocated", "scheduled", "periodic", "predictive"])
def test_no_law_is_lost_by_a_wrong_field_and_the_learned_load_gives_the_place_back(controller, truth):
    way = WITHIN | OFF[truth] | ({"rate_hz": 0.1} if controller == "predictive" else {})
    blind, learned = (flown("standoff", controller, 28.5, disturbance_s=one, **way) for one in (0.0, 600.0))
    off, left = (float(np.linalg.norm(one["rms_m"].values)) for one in (blind, learned))
    assert 0.3 < off < 2.0 and left < (0.75 if truth == "real" else 0.25) * off
    assert float(learned["peak_current_a"]) <= 125.0 and float(learned["angle_deg"].max()) < 0.1


AHEAD = {"place_m": (0.0, 100.0, 0.0), "start_m": (0.0, 110.0, 0.0), "current_max_a": 125.0, "thrust_max_n": 10.0}


@pytest.mark.parametrize(
    ("controller", "more", "holds"),
    [
        ("scheduled", {"field": "IGRF-14", "duration_s": SIX_HOURS}, False),
        ("periodic", {"field": "IGRF-14", "duration_s": SIX_HOURS}, True),
        ("periodic", {"duration_s": 45_000.0}, False),  # nothing turns it for longer than its pitch takes to grow
        ("periodic", {"duration_s": 45_000.0, "towers_m": (330.0, 310.0)}, True),  # gravity does
        ("predictive", {"duration_s": 45_000.0, "towers_m": (330.0, 310.0), "rate_hz": 0.1}, True),
    ],
)
def test_where_the_field_across_vanishes_knowing_what_comes_and_gravity_hold(controller, more, holds):
    found = flown("standoff", controller, 78.5, disturbance_s=600.0, **AHEAD, **more)
    assert np.isnan(float(found["tumble_s"])) == holds
    assert not holds or (found["rms_m"].values.max() < 0.1 and float(found["angle_deg"].max()) < 0.1)


def test_drag_oblateness_eccentricity_and_a_dipole_on_board():
    more = {"gravity": "j2", "drag_area_m2": 500.0, "eccentricity": 0.002, "disturbance_s": 600.0}
    found = flown("standoff", "periodic", 28.5, field="IGRF-14", onboard="dipole", duration_s=SIX_HOURS, **more)
    assert found["rms_m"].values.max() < 3.0 and float(found["angle_deg"].max()) < 1.0


def test_what_125_amperes_cannot_hold_is_refused_with_the_nearest():
    with pytest.raises(InputError, match=r"nearest on the way to it that can is \(14\.\d+, 14\.\d+, 14\.\d+\) m"):
        flown("standoff", "allocated", current_max_a=125.0, thrust_max_n=10.0)


LIMITED = {"current_max_a": 125.0, "thrust_max_n": 10.0, "rate_hz": 0.1, "field": "IGRF-14"}


@pytest.mark.parametrize(("controller", "left"), [("allocated", 1.0), ("predictive", 0.01)])
def test_a_step_beyond_the_limits_is_taken_within_them(controller, left):
    ways = {"place_m": (0.0, 100.0, 0.0), "start_m": (0.0, 300.0, 0.0), "duration_s": 20_000.0}
    found = flown("standoff", controller, 28.5, **ways, **LIMITED)
    assert float(found["peak_current_a"]) <= 125.0
    assert float(found["error_m"][-1]) < left and float(found["angle_deg"].max()) < 0.5


def test_the_linear_motion_is_wrong_in_proportion_to_the_distance():
    found = linear_range((100.0, 1000.0), (5.0, 15.0))
    error = found["place_error"].values
    assert error[:, 1] == pytest.approx(10.0 * error[:, 0], rel=0.01)
    assert 1e-4 < error[:, 0].min() and error[:, 0].max() < 3.5e-4  # at 100 m over an orbit
    assert found["pitch_error"].values[1] > 0.01 > found["pitch_error"].values[0]


def test_docking_over_twenty_runs():
    found = docking_standards(20)
    table = found["table"].to_pandas()
    assert found.attrs["contacts"] == 20
    assert table.loc["lateral_m", "worst"] < 0.1 and table.loc["axial_m", "p95"] < 0.03
    assert table.loc["closing_rate_m_s", "mean"] == pytest.approx(0.005, abs=2e-4)
    assert table.loc["lateral_rate_m_s", "p95"] < 2.5e-4
    assert table.loc["angle_deg", "worst"] < 0.1
    again = docking_standards(20)
    assert np.array_equal(found["table"].values, again["table"].values)


def test_a_climb_averaged_flown_and_by_the_closed_form():
    found = orbit_change(440.0, inclination_deg=0.0, days=1.0, flown_days=1.0)
    climb = float(found["altitude_m"][-1]) - 400e3
    assert climb == pytest.approx(7876.0, rel=0.002)
    assert float(found["closed_altitude_m"][-1]) - 400e3 == pytest.approx(climb, rel=0.005)
    assert float(found["flown_altitude_m"][-1]) - 400e3 == pytest.approx(climb, rel=0.01)


def test_the_plane_turned_at_one_height():
    found = orbit_change(400.0, 28.6, days=1.0, flown_days=1.0)
    turned = float(found["inclination_deg"][-1]) - 28.5
    assert 0.005 < turned < 0.05
    assert float(found["flown_inclination_deg"][-1]) - 28.5 == pytest.approx(turned, rel=0.1)
    assert abs(float(found["altitude_m"][-1]) - 400e3) < 1500.0


def test_contacts_that_take_less_in_the_dark_climb_slower():
    light = orbit_change(440.0, days=0.5, flown_days=0.0)
    dark = orbit_change(440.0, days=0.5, flown_days=0.0, contact_dark_a=12.5)
    climbs = [float(one["altitude_m"][-1]) - 400e3 for one in (light, dark)]
    assert 0.5 * climbs[0] < climbs[1] < 0.8 * climbs[0]


@pytest.mark.parametrize("inclination", [0.0, 28.5])
def test_the_plant_climbs_slower_by_what_its_contacts_lose_in_the_dark(inclination):
    found = orbit_change(440.0, inclination_deg=inclination, days=1.0, flown_days=1.0, contact_dark_a=12.5)
    orbit = slice(-46, None)  # of outputs: the swing within one is not of the averages
    flown_m = float(found["flown_altitude_m"][orbit].mean()) - 400e3
    averaged = float(found["altitude_m"].interp(seconds=found["flown_seconds"][orbit]).mean()) - 400e3
    assert flown_m == pytest.approx(averaged, rel=0.015)
    assert flown_m < 0.7 * (float(found["closed_altitude_m"][-1]) - 400e3)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: flown("standof"), 'did you mean "standoff"'),
        (lambda: flown(controller="lqr"), "unknown"),
        (lambda: flown(place_m=(1.0, 2.0)), "three places"),
        (lambda: flown(towers_m=(1.0, 2.0, 3.0)), "two lengths"),
        (lambda: linear_range((0.0, 1.0)), "rising numbers above zero"),
        (lambda: docking_standards(1), "runs must be"),
        (lambda: orbit_change(400.0), "nothing is to change"),
        (lambda: orbit_change(50.0), "to_altitude_km must be"),
    ],
)
def test_bad_input(call, words):
    with pytest.raises(InputError, match=words):
        call()
