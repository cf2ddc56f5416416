"""Flown telemetry, sample by sample, as flight software would have had it."""

from types import SimpleNamespace

import numpy as np
import pytest

from fieldline.errors import InputError
from fieldline.sensing.measurement import ATTITUDE, FIELD, GYRO, ORBIT, RATE, SUN, new_measurement
from fieldline.telemetry import Quality, Telemetry, measurements_of
from tests_support import times_utc

COUNT = 6
RNG = np.random.default_rng(1)
FIELD_S = 3e-5 * RNG.standard_normal((COUNT, 3))


def telemetry(**more):
    usable = np.array([True, True, False, True, True, True])
    given = {"usable": usable, **more}
    return Telemetry(
        time_utc=times_utc(COUNT, 2.0), field_s=FIELD_S, quality=Quality(samples=COUNT, usable=5, step_s=2.0), **given
    )


def replayed(*args, **keys):
    """Copies, for the record is overwritten in place."""
    copies = []
    for t, m in measurements_of(*args, **keys):
        copies.append((t, type(m)(*(array.copy() for array in m))))
    return copies


def test_the_field_comes_sample_by_sample_and_a_bad_sample_keeps_the_last():
    flight = replayed(telemetry())
    assert [t for t, _ in flight] == [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]
    assert [m.valid[FIELD] for _, m in flight] == [1, 1, 0, 1, 1, 1]
    assert [m.field_time_s[0] for _, m in flight] == [0, 2, 2, 6, 8, 10]
    for row, (_, m) in enumerate(flight):
        assert np.array_equal(m.field_b, FIELD_S[1 if row == 2 else row])


def test_what_the_file_does_not_hold_is_unknown_as_in_a_new_measurement():
    nothing = new_measurement()
    for _, m in replayed(telemetry()):
        assert not m.valid[1:].any()
        for name in m._fields:
            if name not in ("field_b", "field_time_s", "valid"):
                assert np.array_equal(getattr(m, name), getattr(nothing, name), equal_nan=True), name


def test_one_record_is_overwritten_in_place():
    records = [m for _, m in measurements_of(telemetry())]
    assert all(m is records[0] for m in records)


def test_every_column_of_the_file_reaches_its_place():
    rate, dipole = RNG.standard_normal((2, COUNT, 3))
    rate[3] = np.nan
    sun = {"+x": np.arange(COUNT) * 100.0, "-x": np.full(COUNT, 50.0)}
    flight = replayed(
        telemetry(rate_b=rate, dipole_command_b=dipole, sun_sensor=sun, wheel_speed={"1": np.arange(COUNT) * 10.0}),
        sun_full_scale=1000.0,
        wheel_inertia_kg_m2=0.002,
    )
    for row, (_, m) in enumerate(flight):
        good = row != 3
        assert m.valid[GYRO] == m.valid[RATE] == float(good) and m.valid[SUN] == 1.0
        assert np.array_equal(m.rate_b, rate[row if good else 2]) and np.array_equal(m.omega_bi_b, m.rate_b)
        assert np.array_equal(m.dipole_b, dipole[row])
        assert m.sun_sensor == pytest.approx([0.1 * row, 0.05])
        assert m.wheel_momentum == pytest.approx([0.02 * row])


def test_raw_sun_readings_and_wheel_speeds_are_not_passed_on_without_their_scales():
    flight = replayed(telemetry(sun_sensor={"+x": np.ones(COUNT)}, wheel_speed={"1": np.ones(COUNT)}))
    assert all(m.sun_sensor.size == 0 and m.wheel_momentum.size == 0 and m.valid[SUN] == 0.0 for _, m in flight)


def test_estimates_and_the_orbit_are_what_is_known_on_board():
    q, omega, calibrated = RNG.standard_normal((COUNT, 4)), RNG.standard_normal((COUNT, 3)), 2.0 * FIELD_S
    q[0] = np.nan
    along = SimpleNamespace(**{key: RNG.standard_normal((COUNT, 3)) for key in ("position_i", "velocity_i", "field_i")})
    gyro = RNG.standard_normal((COUNT, 3))
    flight = replayed(telemetry(rate_b=gyro), field_b=calibrated, q_bi=q, omega_bi_b=omega, reference=along)
    for row, (_, m) in enumerate(flight):
        assert m.valid[ATTITUDE] == float(row > 0) and m.valid[RATE] == m.valid[ORBIT] == 1.0
        assert np.array_equal(m.q_bi, q[row], equal_nan=True) and np.array_equal(m.omega_bi_b, omega[row])
        assert np.array_equal(m.rate_b, gyro[row])
        for key in ("position_i", "velocity_i", "field_i"):
            assert np.array_equal(getattr(m, key), getattr(along, key)[row])
    assert np.array_equal(flight[5][1].field_b, calibrated[5])


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"q_bi": np.zeros((COUNT, 3))}, r"q_bi must be \(6, 4\), one row a sample; got shape \(6, 3\)"),
        ({"field_b": np.zeros((2, 3))}, r"field_b must be \(6, 3\)"),
        (
            {"reference": SimpleNamespace(position_i=np.zeros((COUNT, 3)), velocity_i=np.zeros(3), field_i=FIELD_S)},
            "velocity_i must be",
        ),
        ({"sun_full_scale": 0.0}, "sun_full_scale must be a positive number; got 0"),
        ({"wheel_inertia_kg_m2": float("nan")}, "wheel_inertia_kg_m2 must be a positive number; got nan"),
    ],
)
def test_what_does_not_fit_is_refused_at_once(keys, words):
    with pytest.raises(InputError, match=words):
        measurements_of(telemetry(), **keys)  # refused by the call, not by the first sample
