"""Sensors: what is exact (matrices, digits, limits, blinding) and what is statistical (noise, walk), with fixed seeds."""

import subprocess
import sys
from math import acos, cos, radians, sin

import numpy as np
import pytest

from fieldline.constants import EARTH_EQUATORIAL_RADIUS_M as RADIUS
from fieldline.errors import InputError
from fieldline.frames.attitude import rotation_error_b
from fieldline.sensing.gyro import read_gyro
from fieldline.sensing.magnetometer import read_magnetometer
from fieldline.sensing.measurement import ATTITUDE, FIELD, GYRO, ORBIT, RATE, SUN, new_measurement
from fieldline.sensing.navigation import read_navigation
from fieldline.sensing.sensors import Gyro, Magnetometer, Navigation, StarTracker, SunSensor
from fieldline.sensing.star_tracker import read_star_tracker
from fieldline.sensing.suite import suite
from fieldline.sensing.sun_sensor import read_sun_sensor
from fieldline.simulate import Magnetometer as FlownMagnetometer

pytestmark = pytest.mark.kernels

GAIN = ((1.02, 0.01, -0.02), (0.005, 0.97, 0.03), (-0.01, 0.02, 1.01))
NO_DIPOLE = (0.0, 0.0, 0.0)
IDENTITY = (0.0, 0.0, 0.0, 1.0)
DRAWS = 20_000


def magnetometer(**keys):
    return suite(2, magnetometers=[None, Magnetometer(rate_hz=1, **keys)]).magnetometers


def field_readings(params, fields, dipole=NO_DIPOLE, seed=0):
    rng, out = np.random.default_rng(seed), new_measurement()
    rows = np.empty((len(fields), 3))
    for row, field in zip(rows, fields, strict=True):
        read_magnetometer(0.0, tuple(field), dipole, params, 1, rng, out)
        row[:] = out.field_b
    return rows


def test_a_measurement_starts_with_nothing_known():
    m = new_measurement(6, 3)
    assert m.sun_sensor.shape == (6,) and m.wheel_momentum.shape == (3,)
    assert not m.valid.any() and not m.dipole_b.any() and not m.wheel_momentum.any()
    for name in ("field_b", "field_time_s", "rate_b", "q_bi", "omega_bi_b", "position_i", "velocity_i", "field_i", "sun_sensor"):
        assert np.isnan(getattr(m, name)).all(), name


# ---- magnetometer


def test_the_magnetometer_reads_gain_bias_and_the_torquers_field():
    coupling = ((10.0, 1.0, 2.0), (3.0, -20.0, 4.0), (5.0, 6.0, 30.0))
    params = magnetometer(gain=GAIN, bias_nt=(100.0, -200.0, 300.0), torquer_coupling_nt_a_m2=coupling)
    field, dipole, out = np.array([2e-5, -3e-5, 1e-5]), np.array([0.1, -0.2, 0.3]), new_measurement()
    read_magnetometer(12.5, tuple(field), tuple(dipole), params, 1, np.random.default_rng(0), out)
    expected = np.array(GAIN) @ (field + 1e-9 * np.array(coupling) @ dipole) + 1e-9 * np.array([100.0, -200.0, 300.0])
    assert out.field_b == pytest.approx(expected, rel=1e-14)
    assert out.field_time_s[0] == 12.5 and list(out.valid) == [1, 0, 0, 0, 0, 0]


def test_a_body_without_the_sensor_reads_nothing():
    empty = suite(1)
    out, rng, v = new_measurement(), np.random.default_rng(0), (1.0, 0.0, 0.0)
    read_magnetometer(0.0, v, v, empty.magnetometers, 0, rng, out)
    read_gyro(v, 1.0, empty.gyros, np.zeros((1, 3)), 0, rng, out)
    read_sun_sensor(v, 1.0, v, empty.sun_sensors, 0, rng, out)
    read_star_tracker(IDENTITY, v, v, 1.0, v, empty.star_trackers, 0, rng, out)
    read_navigation(v, v, empty.navigations, 0, rng, out)
    assert not out.valid.any() and np.isnan(out.field_b).all() and np.isnan(out.q_bi).all()
    assert rng.random() == np.random.default_rng(0).random()  # nothing was drawn


def test_the_two_magnetometers_of_the_library_read_the_same():
    """The record that flies along an orbit and the plant's kernel: one model, the same draws."""
    keys = {"noise_std_nt": (50.0, 50.0, 50.0), "quantum_nt": 13.0, "range_nt": 45_000.0}
    params = magnetometer(gain=GAIN, bias_nt=(1e3, -2e3, 3e3), **keys)
    flown = FlownMagnetometer(
        bias_s=np.array([1e-6, -2e-6, 3e-6]),
        matrix=np.linalg.inv(GAIN),
        noise_std_tesla=5e-8,
        quantum_tesla=1.3e-8,
        range_tesla=4.5e-5,
    )
    fields = 3e-5 * np.random.default_rng(3).standard_normal((500, 3))
    ours, theirs = field_readings(params, fields, seed=7), flown.reading(fields, np.random.default_rng(7))
    assert ours == pytest.approx(theirs, rel=1e-12, abs=1e-18)
    assert (np.abs(ours) == 4.5e-5).any()


def test_digits_are_multiples_of_the_quantum_and_the_nearest():
    params = magnetometer(quantum_nt=100.0)
    fields = 3e-5 * np.random.default_rng(1).standard_normal((200, 3))
    rows = field_readings(params, fields)
    assert np.array_equal(rows, params.quantum[1] * np.rint(rows / params.quantum[1]))
    assert np.abs(rows - fields).max() <= 0.5e-7 * (1 + 1e-9)


def test_saturation_holds_the_end_of_the_range_and_stays_valid():
    params, out = magnetometer(range_nt=40_000.0), new_measurement()
    read_magnetometer(0.0, (5e-5, -5e-5, 1e-5), NO_DIPOLE, params, 1, np.random.default_rng(0), out)
    assert out.field_b == pytest.approx([4e-5, -4e-5, 1e-5], rel=1e-15)
    assert out.valid[FIELD] == 1.0


def test_the_magnetometers_noise_has_its_spread_on_each_axis():
    params = magnetometer(noise_std_nt=(10.0, 20.0, 40.0))
    errors = field_readings(params, np.full((DRAWS, 3), 2e-5)) - 2e-5
    assert np.abs(errors.mean(axis=0) / np.array([1e-8, 2e-8, 4e-8])).max() < 4.0 / np.sqrt(DRAWS)
    assert errors.std(axis=0) == pytest.approx([1e-8, 2e-8, 4e-8], rel=0.03)
    assert np.abs(np.corrcoef(errors.T) - np.eye(3)).max() < 0.03


def test_switching_one_noise_off_leaves_the_others_as_they_were():
    both = field_readings(magnetometer(noise_std_nt=(10.0, 10.0, 10.0)), np.zeros((50, 3)), seed=4)
    without = field_readings(magnetometer(noise_std_nt=(10.0, 0.0, 10.0)), np.zeros((50, 3)), seed=4)
    assert np.array_equal(both[:, [0, 2]], without[:, [0, 2]]) and not without[:, 1].any()


# ---- gyro


def test_the_gyro_reads_gain_bias_digits_and_range():
    params = suite(1, gyros=[Gyro(rate_hz=1, gain=GAIN, bias_deg_s=(1.0, -1.0, 0.5), quantum_deg_s=0.01, range_deg_s=10.0)]).gyros
    rate, out = np.radians([3.0, -9.9, 4.0]), new_measurement()
    read_gyro(tuple(rate), 0.0, params, params.bias.copy(), 0, np.random.default_rng(0), out)
    raw = np.array(GAIN) @ np.degrees(rate) + [1.0, -1.0, 0.5]
    assert np.degrees(out.rate_b) == pytest.approx(np.clip(0.01 * np.rint(raw / 0.01), -10.0, 10.0), rel=1e-12)
    assert np.degrees(out.rate_b[1]) == pytest.approx(-10.0)
    assert out.valid[GYRO] == 1.0 and out.valid[RATE] == 1.0
    assert np.array_equal(out.omega_bi_b, out.rate_b)


def test_an_estimators_rate_is_not_replaced_by_the_gyros():
    params, out = suite(1, gyros=[Gyro(rate_hz=1)], rate_estimated=[True]).gyros, new_measurement()
    out.omega_bi_b[:] = 7.0
    read_gyro((1.0, 2.0, 3.0), 0.0, params, np.zeros((1, 3)), 0, np.random.default_rng(0), out)
    assert list(out.omega_bi_b) == [7.0] * 3 and out.valid[RATE] == 0.0 and list(out.rate_b) == [1.0, 2.0, 3.0]


def test_the_gyros_walk_grows_with_the_root_of_time_whatever_the_step():
    for dt, steps in ((0.25, 40), (2.5, 4)):
        params = suite(1, gyros=[Gyro(rate_hz=1, bias_walk_deg_s_sqrt_s=(0.1, 0.2, 0.0))]).gyros
        rng, out, ends = np.random.default_rng(5), new_measurement(), []
        for _ in range(1000):
            bias = np.zeros((1, 3))
            for _ in range(steps):
                read_gyro((0.0, 0.0, 0.0), dt, params, bias, 0, rng, out)
            assert np.array_equal(out.rate_b, bias[0])
            ends.append(np.degrees(bias[0]))
        expected = np.sqrt(dt * steps) * np.array([0.1, 0.2, 0.0])
        assert np.std(ends, axis=0) == pytest.approx(expected, rel=0.08)
        assert np.abs(np.mean(ends, axis=0)).max() < 4.0 * 0.2 * np.sqrt(dt * steps / 1000)


def test_the_gyros_noise_is_white_with_its_spread():
    params = suite(1, gyros=[Gyro(rate_hz=1, noise_std_deg_s=(0.01, 0.02, 0.03))]).gyros
    rng, out, bias, rows = np.random.default_rng(6), new_measurement(), np.zeros((1, 3)), np.empty((5000, 3))
    for row in rows:
        read_gyro((0.0, 0.0, 0.0), 1.0, params, bias, 0, rng, out)
        row[:] = np.degrees(out.rate_b)
    assert rows.std(axis=0) == pytest.approx([0.01, 0.02, 0.03], rel=0.05)
    assert abs(np.corrcoef(rows[1:, 0], rows[:-1, 0])[0, 1]) < 0.06


# ---- sun sensor

ABOVE = (0.0, 0.0, RADIUS + 500e3)


def sun_reading(sun_b, sunlit=1.0, position_b=ABOVE, seed=0, **keys):
    params = suite(2, sun_sensors=[SunSensor(rate_hz=1), SunSensor(rate_hz=1, **keys)]).sun_sensors
    out = new_measurement(6)
    read_sun_sensor(sun_b, sunlit, position_b, params, 1, np.random.default_rng(seed), out)
    assert out.valid[SUN] == 1.0
    return out.sun_sensor


def test_faces_read_the_cosine_of_incidence_times_the_sunlit_part():
    sun = np.array([1.0, -2.0, 2.0]) / 3.0
    assert sun_reading(tuple(sun)) == pytest.approx([1 / 3, 0, 0, 2 / 3, 2 / 3, 0], abs=1e-15)
    assert sun_reading(tuple(sun), sunlit=0.25) == pytest.approx([1 / 12, 0, 0, 1 / 6, 1 / 6, 0], abs=1e-15)


def test_darkness_reads_exactly_zero_however_noisy():
    assert not sun_reading((1.0, 0.0, 0.0), sunlit=0.0, noise_std=0.1, albedo=0.0).any()
    lit = sun_reading((1.0, 0.0, 0.0), noise_std=0.1)
    assert lit[0] != 1.0 and not lit[1:].any()


def test_the_field_of_view_ends_where_it_says():
    inside, outside = radians(59.0), radians(61.0)
    assert sun_reading((cos(inside), sin(inside), 0.0), field_of_view_deg=60.0)[0] == pytest.approx(cos(inside))
    assert sun_reading((cos(outside), sin(outside), 0.0), field_of_view_deg=60.0)[0] == 0.0


def test_the_ground_below_lights_the_face_that_looks_at_it_by_day():
    factor = 0.3 * (RADIUS / ABOVE[2]) ** 2
    assert sun_reading((0.0, 0.0, 1.0), albedo=0.3) == pytest.approx([0, 0, 0, 0, 1, factor], abs=1e-15)
    assert sun_reading((0.0, 0.8, 0.6), albedo=0.3)[5] == pytest.approx(0.6 * factor)
    assert sun_reading((0.0, 0.0, -1.0), sunlit=0.0, albedo=0.3) == pytest.approx(np.zeros(6))  # night below


def test_the_sun_sensors_noise_has_its_spread():
    params = suite(1, sun_sensors=[SunSensor(rate_hz=1, noise_std=0.02)]).sun_sensors
    rng, out = np.random.default_rng(8), new_measurement(6)
    readings = []
    for _ in range(5000):
        read_sun_sensor((1.0, 0.0, 0.0), 1.0, ABOVE, params, 0, rng, out)
        readings.append(out.sun_sensor[0])
    assert np.mean(readings) == pytest.approx(1.0, abs=4 * 0.02 / np.sqrt(5000))
    assert np.std(readings) == pytest.approx(0.02, rel=0.05)


# ---- star tracker

LIMB = radians(67.0)
HEIGHT = RADIUS / sin(LIMB)  # distance from which the Earth's disc has that half-angle
Q = np.array([0.1, -0.5, 0.7, 0.3]) / np.sqrt(0.84)


def star_reading(rate=NO_DIPOLE, sun=(0.0, 0.0, -1.0), sunlit=1.0, position=(0.0, 0.0, HEIGHT), seed=0, **keys):
    params, out = suite(1, star_trackers=[StarTracker(rate_hz=1, **keys)]).star_trackers, new_measurement()
    read_star_tracker(tuple(Q), rate, sun, sunlit, position, params, 0, np.random.default_rng(seed), out)
    assert np.isnan(out.q_bi).all() == (out.valid[ATTITUDE] == 0.0)
    return out


def test_a_perfect_tracker_reads_the_attitude_and_a_bent_one_its_offset():
    assert star_reading().q_bi == pytest.approx(Q, abs=1e-15)
    arcsec = np.radians(1.0 / 3600.0)
    error = rotation_error_b(star_reading(offset_arcsec=(30.0, -20.0, 100.0)).q_bi, Q)
    assert error == pytest.approx(arcsec * np.array([30.0, -20.0, 100.0]), rel=1e-9)


def test_the_trackers_error_has_its_spread_about_each_body_axis():
    params = suite(1, star_trackers=[StarTracker(rate_hz=1, noise_std_arcsec=(5.0, 6.0, 40.0))]).star_trackers
    rng, out, rows = np.random.default_rng(9), new_measurement(), np.empty((5000, 4))
    for row in rows:
        read_star_tracker(tuple(Q), NO_DIPOLE, (0.0, 0.0, -1.0), 1.0, (0.0, 0.0, HEIGHT), params, 0, rng, out)
        row[:] = out.q_bi
    errors = np.degrees(rotation_error_b(rows, np.broadcast_to(Q, rows.shape))) * 3600.0
    assert errors.std(axis=0) == pytest.approx([5.0, 6.0, 40.0], rel=0.04)
    assert np.abs(np.linalg.norm(rows, axis=1) - 1.0).max() < 1e-14


def test_the_tracker_is_blind_above_its_rate():
    limit = radians(1.0)
    assert star_reading(rate=(0.0, 0.999 * limit, 0.0), rate_max_deg_s=1.0).valid[ATTITUDE] == 1.0
    assert star_reading(rate=(0.0, 1.001 * limit, 0.0), rate_max_deg_s=1.0).valid[ATTITUDE] == 0.0
    assert star_reading(rate=(0.0, 9.0, 0.0)).valid[ATTITUDE] == 1.0


@pytest.mark.parametrize(
    ("angle_deg", "sunlit", "sees"), [(29.9, 1.0, 0.0), (30.1, 1.0, 1.0), (5.0, 0.0, 1.0), (29.9, 0.01, 0.0)]
)
def test_the_tracker_is_blind_near_a_sun_in_sight(angle_deg, sunlit, sees):
    angle = radians(angle_deg)
    out = star_reading(sun=(sin(angle), 0.0, cos(angle)), sunlit=sunlit, sun_exclusion_deg=30.0)
    assert out.valid[ATTITUDE] == sees


@pytest.mark.parametrize(("above_limb_deg", "sees"), [(-30.0, 0.0), (-0.1, 0.0), (9.9, 0.0), (10.1, 1.0), (60.0, 1.0)])
def test_the_tracker_is_blind_near_the_limb(above_limb_deg, sees):
    """The boresight is +z; nadir is put that far beyond the Earth's half-angle from it."""
    from_nadir = LIMB + radians(above_limb_deg)
    nadir = np.array([sin(from_nadir), 0.0, cos(from_nadir)])
    assert star_reading(position=tuple(-HEIGHT * nadir), earth_exclusion_deg=10.0).valid[ATTITUDE] == sees


def test_the_earth_itself_hides_the_stars_without_any_exclusion():
    assert star_reading(position=(0.0, 0.0, -HEIGHT)).valid[ATTITUDE] == 0.0
    assert acos(cos(LIMB)) == pytest.approx(LIMB)
    for above, sees in ((-0.1, 0.0), (0.1, 1.0)):
        angle = LIMB + radians(above)
        assert star_reading(position=(-HEIGHT * sin(angle), 0.0, -HEIGHT * cos(angle))).valid[ATTITUDE] == sees


def test_an_outage_leaves_the_noise_after_it_as_it_was():
    params = suite(1, star_trackers=[StarTracker(rate_hz=1, noise_std_arcsec=(5.0, 5.0, 5.0), rate_max_deg_s=1.0)]).star_trackers
    seconds = []
    for first_rate in (0.0, 1.0):
        rng, out = np.random.default_rng(2), new_measurement()
        for rate in (first_rate, 0.0):
            read_star_tracker(tuple(Q), (rate, 0.0, 0.0), (0.0, 0.0, -1.0), 1.0, (0.0, 0.0, HEIGHT), params, 0, rng, out)
        seconds.append(out.q_bi.copy())
    assert np.array_equal(*seconds)


# ---- navigation


def test_the_orbits_offset_is_along_the_track_against_the_normal_and_down():
    position, velocity = (7e6, 0.0, 0.0), (100.0, 7500.0, 0.0)
    params, out = suite(1, navigations=[Navigation(position_offset_o_m=(1000.0, 20.0, 3.0))]).navigations, new_measurement()
    read_navigation(position, velocity, params, 0, np.random.default_rng(0), out)
    assert out.position_i - position == pytest.approx([-3.0, 1000.0, -20.0], abs=1e-8)
    assert list(out.velocity_i) == list(velocity) and out.valid[ORBIT] == 1.0


def test_a_vertical_fall_is_known_where_no_offset_asks_for_axes():
    out = new_measurement()
    read_navigation(
        (7e6, 0.0, 0.0), (-1.0, 0.0, 0.0), suite(1, navigations=[Navigation()]).navigations, 0, np.random.default_rng(0), out
    )
    assert list(out.position_i) == [7e6, 0.0, 0.0]


def test_the_orbits_noise_has_its_spread():
    record = Navigation(position_noise_std_m=(1.0, 2.0, 3.0), velocity_noise_std_m_s=(0.01, 0.02, 0.03))
    params, rng, out = suite(1, navigations=[record]).navigations, np.random.default_rng(3), new_measurement()
    rows = np.empty((5000, 6))
    for row in rows:
        read_navigation((7e6, 0.0, 0.0), (0.0, 7.5e3, 0.0), params, 0, rng, out)
        row[:3], row[3:] = out.position_i - [7e6, 0.0, 0.0], out.velocity_i - [0.0, 7.5e3, 0.0]
    assert rows.std(axis=0) == pytest.approx([1.0, 2.0, 3.0, 0.01, 0.02, 0.03], rel=0.05)
    assert np.abs(np.corrcoef(rows.T) - np.eye(6)).max() < 0.06


# ---- the tables, and the bits


def test_the_tables_are_in_si_and_no_limit_is_infinite():
    tables = suite(
        2, magnetometers=[Magnetometer(rate_hz=1, bias_nt=(1.0, 2.0, 3.0), noise_std_nt=4.0), None], gyros=[None, Gyro(rate_hz=1)]
    )
    assert (
        tables.magnetometers.bias[0] == pytest.approx([1e-9, 2e-9, 3e-9])
        and list(tables.magnetometers.noise_std[0]) == [4e-9] * 3
    )
    assert np.isinf(tables.magnetometers.limit).all() and np.isinf(tables.gyros.limit).all()
    assert list(tables.magnetometers.present) == [1, 0] and list(tables.gyros.present) == [0, 1]
    assert list(tables.sun_sensors.start) == [0, 0, 0] and tables.sun_sensors.normal.shape == (0, 3)
    for table in tables:
        for array in table:
            assert array.flags["C_CONTIGUOUS"] and array.dtype in (np.float64, np.int64)


def test_an_entry_for_each_body_is_asked_for():
    with pytest.raises(InputError, match="gyros needs one entry for each of the 2 bodies; got 3"):
        suite(2, gyros=[None, None, None])
    with pytest.raises(InputError, match="rate_estimated needs one entry for each of the 2 bodies; got 1"):
        suite(2, rate_estimated=[True])


BITS = """
import numpy as np
from fieldline.sensing.gyro import read_gyro
from fieldline.sensing.magnetometer import read_magnetometer
from fieldline.sensing.measurement import new_measurement
from fieldline.sensing.sensors import Gyro, Magnetometer
from fieldline.sensing.suite import suite
s = suite(1, magnetometers=[Magnetometer(rate_hz=1, noise_std_nt=10.0, quantum_nt=0.5)],
    gyros=[Gyro(rate_hz=1, noise_std_deg_s=0.1, bias_walk_deg_s_sqrt_s=0.01)])
rng, out, bias = np.random.default_rng(12), new_measurement(), np.zeros((1, 3))
total = b""
for i in range(2000):
    read_magnetometer(float(i), (1e-5, 2e-5, -3e-5), (0.0, 0.0, 0.0), s.magnetometers, 0, rng, out)
    read_gyro((0.01, 0.02, 0.03), 0.1, s.gyros, bias, 0, rng, out)
    total += out.field_b.tobytes() + out.rate_b.tobytes()
import hashlib
print(hashlib.sha256(total).hexdigest())
"""


def test_compiled_and_plain_python_read_the_same_bits(monkeypatch):
    digests = []
    for off in ("0", "1"):
        monkeypatch.setenv("NUMBA_DISABLE_JIT", off)
        done = subprocess.run([sys.executable, "-c", BITS], capture_output=True, text=True, check=True, timeout=120)
        digests.append(done.stdout.strip())
    assert len(digests[0]) == 64 and digests[0] == digests[1]
