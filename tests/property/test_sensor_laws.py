"""Laws of readings: digits and ranges for any value, faces for any Sun, blinding the same in any axes."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fieldline.constants import EARTH_EQUATORIAL_RADIUS_M as RADIUS
from fieldline.sensing.measurement import ATTITUDE, new_measurement
from fieldline.sensing.navigation import from_orbital
from fieldline.sensing.reading import digits
from fieldline.sensing.sensors import StarTracker, SunSensor
from fieldline.sensing.star_tracker import blinded, read_star_tracker
from fieldline.sensing.suite import suite
from fieldline.sensing.sun_sensor import read_sun_sensor

pytestmark = pytest.mark.kernels
QUICK = settings(max_examples=80, deadline=None)

values = st.floats(-1e-3, 1e-3)
quanta = st.sampled_from([0.0, 1e-9, 1.3e-8, 1e-6])
limits = st.sampled_from([1e-5, 6.5e-5, float("inf")])
components = st.floats(-1.0, 1.0)
directions = (
    st.tuples(components, components, components)
    .filter(lambda v: np.hypot(np.hypot(v[0], v[1]), v[2]) > 0.1)
    .map(lambda v: tuple(float(x) for x in np.array(v) / np.linalg.norm(v)))
)


SIX = suite(1, sun_sensors=[SunSensor(rate_hz=1, albedo=0.3)]).sun_sensors
TRACKER = suite(
    1, star_trackers=[StarTracker(rate_hz=1, boresight_b=(0.6, 0.0, 0.8), sun_exclusion_deg=35.0, earth_exclusion_deg=12.0)]
).star_trackers


@QUICK
@given(x=values, quantum=quanta, limit=limits)
def test_a_reading_is_near_within_range_odd_and_read_again_the_same(x, quantum, limit):
    reading = digits(x, quantum, limit)
    assert abs(reading) <= limit
    if abs(x) < limit - quantum:
        assert abs(reading - x) <= 0.5 * quantum * (1 + 1e-6) + 1e-18
    assert digits(-x, quantum, limit) == -reading
    if abs(reading) < limit:  # the range need not end at a digit
        assert digits(reading, quantum, limit) == pytest.approx(reading, rel=1e-12)


@QUICK
@given(x=values, y=values, quantum=quanta, limit=limits)
def test_a_larger_value_never_reads_less(x, y, quantum, limit):
    assert digits(min(x, y), quantum, limit) <= digits(max(x, y), quantum, limit)


def test_what_is_not_a_number_reads_so():
    assert np.isnan(digits(float("nan"), 1e-9, 1e-4))


@QUICK
@given(sun=directions, up=directions, sunlit=st.floats(0.0, 1.0))
def test_opposite_faces_share_the_light_and_nothing_is_negative(sun, up, sunlit):
    out = new_measurement(6)
    position = tuple(float((RADIUS + 4e5) * x) for x in up)
    read_sun_sensor(sun, sunlit, position, SIX, 0, np.random.default_rng(0), out)
    assert (out.sun_sensor >= 0.0).all() and (out.sun_sensor <= 1.3).all()
    night = new_measurement(6)
    read_sun_sensor(sun, 0.0, position, SIX, 0, np.random.default_rng(0), night)
    direct = out.sun_sensor - night.sun_sensor
    assert direct[::2] - direct[1::2] == pytest.approx(sunlit * np.array(sun), abs=1e-12)


@QUICK
@given(sun=directions, up=directions, height=st.floats(2e5, 4e7))
def test_a_tracker_sees_exactly_outside_its_two_cones(sun, up, height):
    position = tuple(float((RADIUS + height) * x) for x in up)
    boresight = np.array([0.6, 0.0, 0.8])
    to_sun = np.degrees(np.arccos(np.clip(boresight @ sun, -1, 1)))
    to_limb = np.degrees(np.arccos(np.clip(-boresight @ up, -1, 1)) - np.arcsin(RADIUS / (RADIUS + height)))
    expected = to_sun < 35.0 or to_limb < 12.0
    if min(abs(to_sun - 35.0), abs(to_limb - 12.0)) > 1e-6:
        assert blinded((0.0, 0.0, 0.0), sun, 1.0, position, TRACKER, 0) == expected
        out = new_measurement()
        read_star_tracker((0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0), sun, 1.0, position, TRACKER, 0, np.random.default_rng(0), out)
        assert out.valid[ATTITUDE] == (0.0 if expected else 1.0)


@QUICK
@given(up=directions, along=directions, offset=st.tuples(*[st.floats(-1e4, 1e4)] * 3))
def test_an_offset_in_orbital_axes_keeps_its_length_and_its_height(up, along, offset):
    if np.linalg.norm(np.cross(up, along)) < 0.01:
        return
    position, velocity = tuple(7e6 * x for x in up), tuple(7.5e3 * x for x in along)
    turned = np.array(from_orbital(offset, position, velocity))
    assert np.linalg.norm(turned) == pytest.approx(np.linalg.norm(offset), rel=1e-12, abs=1e-12)
    assert turned @ up == pytest.approx(-offset[2], abs=1e-7)
    assert from_orbital((1.0, 0.0, 0.0), position, velocity) @ np.array(velocity) > 0.0
