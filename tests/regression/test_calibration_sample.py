"""The flown orbit of SUCHAI-3: what its calibration leaves, and what it finds."""

from importlib.resources import files

import numpy as np
import pytest

import fieldline as fl
from fieldline.environment import magnetic_field
from fieldline.estimation.calibration import calibrate_magnitude
from fieldline.orbit import read_orbit
from fieldline.telemetry import read_telemetry


@pytest.fixture(scope="module")
def flown():
    data = files("fieldline") / "data"
    telemetry = read_telemetry(data / "suchai3_2023-08-24.csv")
    orbit = read_orbit(data / "suchai3.tle")

    def magnitude_at(offset_s):
        times = telemetry.time_utc + np.timedelta64(round(offset_s * 1e9), "ns")
        return np.linalg.norm(magnetic_field(orbit.position_e(times), times), axis=-1)

    return telemetry, magnitude_at


def calibrated(flown, **options):
    telemetry, magnitude_at = flown
    return calibrate_magnitude(
        telemetry.seconds, telemetry.field_s, magnitude_at(0.0), usable=telemetry.usable, magnitude_at=magnitude_at, **options
    )


def test_nine_parameters_leave_two_microtesla(flown):
    found = calibrated(flown, model="full")
    assert found.residual_rms_tesla == pytest.approx(1.95e-6, abs=4e-8)
    assert found.bias_s == pytest.approx([100.6e-6, -29.2e-6, -28.85e-6], abs=3e-7)


def test_the_gain_is_chosen_and_leaves_less_than_seven_tenths(flown):
    found = calibrated(flown, clock_scan=True)
    assert found.model == "full+gain"
    assert found.residual_rms_tesla < 0.7e-6
    assert np.ptp(found.gain_values) == pytest.approx(0.07, abs=0.015)
    assert np.all(found.bias_std_s < 0.5e-6)
    assert found.clock.offsets_s[int(np.argmin(found.clock.rms_tesla))] == pytest.approx(0.0, abs=15.0)
    assert found.clock.sigmas < 3.0


def test_the_panels_step_at_the_edges_of_eclipse_is_taken_out(flown):
    orbit = read_orbit(files("fieldline") / "data" / "suchai3.tle")
    found = fl.calibrate(flown[0], orbit)
    assert found.model == "full+gain+sunlit"
    assert found.residual_rms_tesla < 0.42e-6
    place = found.terms.layout["sunlit"]
    assert found.values[place] == pytest.approx([-0.7e-6, 2.0e-6, -0.2e-6], abs=4e-7)
    assert np.all(found.std[place] < 3e-7)
