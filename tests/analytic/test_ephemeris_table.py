"""The tables of Earth rotation and Sun against the functions that they tabulate."""

import numpy as np
import pytest

from fieldline.environment.ephemeris import dcm_ei_kernel, ephemeris_table, sun_kernel
from fieldline.environment.sun import sun_position_i
from fieldline.errors import InputError
from fieldline.frames.earth_orientation import EarthOrientation
from fieldline.frames.earth_rotation import dcm_ei

START = np.datetime64("2026-03-05T07:12:33.250", "ns")
DAY = 86400.0
STATED, STATED_WITH_EOP, STATED_SUN = 2e-12, 5e-11, 1e-12

pytestmark = pytest.mark.kernels


def moments(duration_s, count=60, seed=4):
    """Whole nanoseconds within the span, its ends among them, as seconds and as times."""
    ns = np.sort(np.random.default_rng(seed).integers(0, round(duration_s * 1e9) + 1, count))
    ns[0], ns[-1] = 0, round(duration_s * 1e9)
    return ns * 1e-9, START + ns.astype("timedelta64[ns]")


def wandering_pole():
    """Daily orientation as it may be measured: UT1 that drifts and bends, and a pole half an arcsecond away."""
    days = np.arange(61090.0, 61140.0)
    ut1 = -37.05 + 1e-3 * np.sin(days / 3.0) - 5e-4 * (days - days[0])
    return EarthOrientation("made", days, ut1, 0.2 + 1e-3 * np.cos(days), 0.4 + 2e-3 * np.sin(days / 2.0))


@pytest.mark.parametrize("duration_s", [0.0, 10.0, 5700.0, 1800.0, 3 * DAY, 400 * DAY])
def test_rotation_and_sun_are_those_of_the_functions(duration_s):
    seconds, times = moments(duration_s)
    table = ephemeris_table(START, duration_s)
    dcm = np.array([dcm_ei_kernel(t, table) for t in seconds]).reshape(-1, 3, 3)
    sun = np.array([sun_kernel(t, table) for t in seconds])
    assert np.abs(dcm - dcm_ei(times)).max() < STATED
    assert np.linalg.norm(sun - sun_position_i(times), axis=1).max() < STATED_SUN * 1.5e11


def test_measured_orientation_is_in_the_table():
    seconds, times = moments(20 * DAY, 300)
    eop = wandering_pole()
    table = ephemeris_table(START, 20 * DAY, eop)
    dcm = np.array([dcm_ei_kernel(t, table) for t in seconds]).reshape(-1, 3, 3)
    assert np.abs(dcm - dcm_ei(times, eop)).max() < STATED_WITH_EOP
    assert np.abs(dcm - dcm_ei(times)).max() > 1e-6  # and it matters


def test_the_rotation_stays_a_rotation():
    table = ephemeris_table(START, DAY)
    dcm = np.reshape(dcm_ei_kernel(12345.678, table), (3, 3))
    assert np.abs(dcm @ dcm.T - np.eye(3)).max() < 1e-11
    assert np.linalg.det(dcm) > 0.0


def test_past_its_ends_the_table_holds_and_the_earth_turns_on():
    table = ephemeris_table(START, 3600.0)
    assert np.isfinite(dcm_ei_kernel(-1e5, table)).all()
    late, later = (np.reshape(dcm_ei_kernel(t, table), (3, 3)) for t in (1e5, 1e5 + 1e3))
    turned = later @ late.T
    assert np.arctan2(turned[0, 1], turned[0, 0]) == pytest.approx(1e3 * table.era_rate, abs=1e-9)
    assert sun_kernel(1e5, table) == sun_kernel(1e6, table)


def test_errors_name_the_argument():
    with pytest.raises(InputError, match=r"duration_s.*-1"):
        ephemeris_table(START, -1.0)
    with pytest.raises(InputError, match=r"duration_s.*nan"):
        ephemeris_table(START, float("nan"))
    with pytest.raises(InputError, match="start_utc must be one time"):
        ephemeris_table([START, START], 1.0)
    with pytest.raises(InputError, match="1900 to 2100"):
        ephemeris_table("2150-01-01", 1.0)
