"""What is a fault and what is only a slow or a fast satellite: synthetic fields with known faults."""

import numpy as np
import pytest

from fieldline.telemetry.quality import find_faults

NT = 1e-9


def orbit_field(seconds, rate_rad_s, quantum_nt, noise_nt=50.0, seed=1, axis=(0.2, 0.9, 0.4)):
    """(n, 3) nT: a polar dipole field along the orbit, seen from a body that spins at `rate_rad_s`."""
    from scipy.spatial.transform import Rotation

    u = 2 * np.pi * seconds / 5600.0
    field_i = 25e3 * np.stack([1.5 * np.sin(2 * u), 0.2 * np.cos(u), 1.0 - 3.0 * np.sin(u) ** 2], axis=-1)
    axis = np.array(axis) / np.linalg.norm(axis)
    field = Rotation.from_rotvec(-rate_rad_s * seconds[:, None] * axis).apply(field_i) + np.array([40e3, -12e3, 7e3])
    field += np.random.default_rng(seed).normal(size=field.shape) * noise_nt
    return np.round(field / quantum_nt) * quantum_nt if quantum_nt else field


FLIGHTS = {
    "spinner at 46 deg a step": (1.0, np.radians(46.0), 76.92, 300.0),
    "tumbler": (1.0, np.radians(3.0), 100.0, 100.0),
    "Earth-pointing, 0.1 uT": (5.0, 2 * np.pi / 5600.0, 100.0, 20.0),
    "Earth-pointing, 644 nT": (5.0, 2 * np.pi / 5600.0, 644.0, 0.0),
    "Earth-pointing, 644 nT, 1 Hz": (1.0, 2 * np.pi / 5600.0, 644.0, 0.0),
    "inertial, 644 nT": (2.0, 0.0, 644.0, 0.0),
    "inertial, no noise": (2.0, 0.0, 0.0, 0.0),
    "slow, floats": (10.0, np.radians(0.1), 0.0, 5.0),
}


@pytest.mark.parametrize("name", FLIGHTS)
@pytest.mark.parametrize("count", [60, 1000, 5000])
def test_a_sound_flight_has_no_fault(name, count):
    step, rate, quantum, noise = FLIGHTS[name]
    seconds = np.arange(count) * step
    faults = find_faults(seconds, orbit_field(seconds, rate, quantum, noise), NT)
    assert not faults.any().any(), {key: int(part.sum()) for key, part in faults._asdict().items()}


@pytest.mark.parametrize("name", FLIGHTS)
def test_a_calibrated_coarse_field_is_not_stuck(name):
    """A matrix over quantised axes leaves no lattice, and whole rows still repeat."""
    step, rate, quantum, noise = FLIGHTS[name]
    seconds = np.arange(4000) * step
    matrix = np.array([[1.02, 0.011, -0.007], [0.011, 0.97, 0.019], [-0.007, 0.019, 1.01]])
    faults = find_faults(seconds, orbit_field(seconds, rate, quantum, noise) @ matrix, NT)
    assert not faults.any().any(), {key: int(part.sum()) for key, part in faults._asdict().items()}


@pytest.mark.parametrize("name", FLIGHTS)
@pytest.mark.parametrize("axes", [(0,), (0, 1, 2)])
def test_a_stuck_sensor_is_found(name, axes):
    step, rate, quantum, noise = FLIGHTS[name]
    # A slow field must stand still for long to be missed, and with steps of a fortieth of the field for longer.
    length = 40 if rate > 0.01 else int((1500.0 if quantum == 644.0 else 900.0) / step)
    seconds = np.arange(8000) * step
    field = orbit_field(seconds, rate, quantum, noise)
    start = 2050
    for axis in axes:
        field[start : start + length, axis] = field[start, axis]
    faults = find_faults(seconds, field, NT)
    assert faults.stuck[start + 1 : start + length].all()
    assert faults.stuck.sum() <= 1.1 * length  # a value may have repeated before it froze


@pytest.mark.parametrize("name", FLIGHTS)
@pytest.mark.parametrize("size_nt", [60e3, -25e3])
def test_single_spikes_are_found_and_only_they(name, size_nt):
    step, rate, quantum, noise = FLIGHTS[name]
    seconds = np.arange(4000) * step
    field = orbit_field(seconds, rate, quantum, noise)
    where = np.array([100, 777, 2500, 3990])
    field[where, [0, 1, 2, 0]] += size_nt
    faults = find_faults(seconds, field, NT)
    assert list(np.flatnonzero(faults.any())) == list(where)
    assert list(np.flatnonzero(faults.spikes)) == list(where)


def test_wild_numbers_and_fill_values():
    seconds = np.arange(3000.0)
    field = orbit_field(seconds, 0.8, 76.92)
    field[10] = 0.0
    field[20] = -9999.0
    field[30, 1] = 1e31
    field[40, 2] = np.nan
    field[50] = 3e7
    field[60:64, 0] = 8e6
    faults = find_faults(seconds, field, NT)
    assert list(np.flatnonzero(faults.sentinel)) == [10, 20, 30]
    assert list(np.flatnonzero(faults.nan)) == [40]
    assert list(np.flatnonzero(faults.spikes | faults.stuck)) == [50, 60, 61, 62, 63]


def test_a_value_that_is_only_like_a_fill_value_stays():
    seconds = np.arange(3000.0)
    field = np.round(orbit_field(seconds, 0.8, 1.0))
    field[100, 0] = -9999.0 if field[:, 0].min() < -9999.0 < field[:, 0].max() else 32767.0
    assert not find_faults(seconds, field, NT).sentinel.any()


def test_saturation_is_found():
    seconds = np.arange(4000.0)
    field = orbit_field(seconds, 0.8, 76.92)
    limit = np.quantile(field[:, 0], 0.9)
    at = field[:, 0] >= limit
    field[at, 0] = limit
    faults = find_faults(seconds, field, NT)
    assert faults.saturated[at].mean() > 0.99
    assert not faults.saturated[~at].any()


def test_a_log_faster_than_its_sensor_keeps_the_first_of_each_value():
    seconds = np.arange(4000.0)
    field = orbit_field(seconds, 0.3, 76.92)[np.arange(4000) // 5 * 5]
    faults = find_faults(seconds, field, NT)
    assert np.array_equal(np.flatnonzero(~faults.held), np.arange(0, 4000, 5))
    assert not (faults.stuck | faults.spikes | faults.saturated).any()


def test_gaps_make_no_faults():
    seconds = np.delete(np.arange(5000.0), np.r_[100:103, 900:1700, 2500, 4000:4100])
    faults = find_faults(seconds, orbit_field(seconds, 0.8, 76.92, 300.0), NT)
    assert not faults.any().any()


def test_a_loud_part_is_not_a_heap_of_spikes():
    """Detumbling, then quiet: the error of interpolation differs a hundredfold between the parts."""
    seconds = np.arange(6000.0)
    angle = np.concatenate([np.cumsum(np.linspace(1.2, 0.01, 2000)), np.full(4000, np.linspace(1.2, 0.01, 2000).sum())])
    field = 30e3 * np.stack([np.cos(angle), np.sin(angle), 0.3 * np.cos(seconds / 400)], axis=-1)
    field += np.random.default_rng(4).normal(size=field.shape) * 50.0
    faults = find_faults(seconds, field, NT)
    assert not faults.spikes.any()


def test_switched_disturbances_of_a_dirty_satellite_are_not_thrown_out():
    """Earth-pointing, 5 s, 0.1 uT steps, currents that switch by microteslas: their edges may go, their levels may not."""
    rng = np.random.default_rng(0)
    seconds = np.arange(6000) * 5.0
    level, start = np.zeros((6000, 3)), 0
    while start < 6000:
        length = int(rng.exponential(60)) + 1
        level[start : start + length] = rng.normal(size=3) * 2500 * (rng.random() < 0.5)
        start += length
    field = np.round((orbit_field(seconds, 2 * np.pi / 5600.0, 0.0, 60.0) + level) / 100.0) * 100.0
    faults = find_faults(seconds, field, NT)
    assert not (faults.stuck | faults.held | faults.saturated | faults.sentinel).any()
    assert faults.spikes.mean() < 0.02


def test_nutation_and_uneven_sampling_are_no_faults():
    from scipy.spatial.transform import Rotation

    seconds = np.arange(5000.0)
    turn = Rotation.from_rotvec(np.radians(50) * seconds[:, None] * np.array([0, 0, 1.0]))
    turn *= Rotation.from_rotvec(np.radians(17) * seconds[:, None] * np.array([0.3, 0.5, 0.81]))
    field = np.round((turn.apply(orbit_field(seconds, 0.0, 0.0, 100.0)) + 5e4) / 77.0) * 77.0
    assert not find_faults(seconds, field, NT).any().any()
    uneven = np.sort(np.random.default_rng(2).uniform(0, 6000, 3000))
    assert not find_faults(uneven, orbit_field(uneven, np.radians(20), 100.0, 200.0), NT).any().any()
