"""Discrete software on a continuous plant: when commands act, what becomes of them on the way, and what sensors see."""

import numpy as np
import pytest

import plant_flights as pf
from fieldline.dynamics.load_log import LOADS
from fieldline.simulate.loop.records import NEVER
from plant_flights import law, torquers, wheels

pytestmark = [pytest.mark.kernels, pytest.mark.flight]


def moments(flight):
    """(seconds, (n, actuators) in effect)."""
    count = int(flight.clock.rows[0])
    return flight.record.seconds[:count], flight.record.actuators[:count]


@pytest.mark.parametrize("delay", [0.0, 0.7, 1.9])
@pytest.mark.parametrize("method", ["rk4", "dop853"])
def test_commands_are_held_and_delayed(method, delay):
    """Call k at 2 k s commands 0.1 (k + 1): in effect from 2 k + delay until the next."""
    flight = pf.flown(
        pf.body(magnetorquer=torquers()), seconds=12.0, output=0.25, integrator={"method": method}, software=[law(delay_s=delay)]
    )
    seconds, dipole = moments(flight)
    between = np.abs((seconds - delay) / 2.0 - np.round((seconds - delay) / 2.0)) > 1e-6
    expected = 0.1 * np.maximum(0, np.floor((seconds - delay) / 2.0) + 1)
    assert np.allclose(dipole[between, 0], expected[between], atol=1e-15)
    assert flight.tasks.runs[0] == 7


def test_commands_are_rounded_and_cut():
    record = pf.body(magnetorquer=torquers(moment_max_a_m2=0.45, quantum_a_m2=0.2))
    flight = pf.flown(record, seconds=20.0, output=2.0, software=[law(parameters=(0.11, -0.11, 0.0))])
    _, dipole = moments(flight)
    call = np.arange(1, len(dipole) + 1)
    whole = np.clip(0.2 * np.round(0.11 * call / 0.2), None, 0.45)
    assert np.allclose(dipole[:, 0], whole, atol=1e-15)
    assert np.array_equal(dipole[:, 1], -dipole[:, 0])


def test_tasks_of_several_rates_and_phases_do_not_disturb_each_other():
    """1 Hz from 0.3 s, 3 Hz from 0: each at its times, to the last call, and their commands add in no way."""
    software = [
        law(name="ramp", rate_hz=1.0, phase_s=0.3) | {"name": "slow"},
        law(name="ramp", commands=("wheel_torque",), parameters=(1e-4, 0.0, 0.0), rate_hz=3.0) | {"name": "fast"},
    ]
    flight = pf.flown(pf.body(magnetorquer=torquers(), wheel=wheels()), seconds=7.0, output=0.1, software=software)
    assert list(flight.tasks.runs) == [7, 22]
    seconds, known = moments(flight)
    apart = np.abs(3 * seconds - np.round(3 * seconds)) > 1e-6
    # a wheel gives the body the opposite of what its motor gets
    assert np.allclose(known[apart, 3], -1e-4 * (np.floor(3 * seconds[apart]) + 1), atol=1e-15)
    assert np.allclose(known[:, 0], 0.1 * (np.floor(seconds - 0.3 + 1e-6) + 1), atol=1e-15)


def test_a_torquer_with_a_time_constant_follows_its_command_exponentially():
    record = pf.body(magnetorquer=torquers(time_constant_s=0.8))
    flight = pf.flown(record, seconds=8.0, output=0.1, software=[law(parameters=(0.1, 0.0, 0.0))])
    seconds, dipole = moments(flight)
    expected, start = [], 0.0
    for t in seconds:
        k = int(np.floor(t / 2.0 + 1e-9))
        start = 0.0
        for call in range(k):
            start = 0.1 * (call + 1) + (start - 0.1 * (call + 1)) * np.exp(-2.0 / 0.8)
        expected.append(0.1 * (k + 1) + (start - 0.1 * (k + 1)) * np.exp(-(t - 2.0 * k) / 0.8))
    assert np.allclose(dipole[:, 0], expected, atol=1e-12)


COUPLED = {"rate_hz": 1.0, "torquer_coupling_nt_a_m2": (2000.0, 2000.0, 2000.0)}


def disturbance(flight):
    """(n,) [T] by which the magnetometer's readings miss the field: a body at rest in a uniform field."""
    samples = flight.record.samples[: int(flight.clock.samples[0])]
    true = pf.turned(flight.start[None, :13]).inv().apply(pf.UNIFORM)
    return samples[:, 1], np.linalg.norm(samples[:, 2:5] - true, axis=1)


def test_a_duty_cycle_keeps_the_torquers_out_of_the_readings():
    """Read at the start of the period, before the torquers go on, or in their pause, and at no other time."""
    record = {"rate_deg_s": (0.0, 0.0, 0.0), "inertia_kg_m2": (1e9, 1e9, 1e9), "magnetorquer": torquers()}
    steady = law(name="steady", parameters=(0.5, 0.0, 0.0), rate_hz=0.5)
    cycle = {"period_s": 2.0, "torque_on_s": 1.4}
    for phase, rate, clean in ((0.0, 0.5, True), (1.7, 0.5, True), (0.8, 0.5, False), (0.0, 1.0, None)):
        sensor = COUPLED | {"phase_s": phase, "rate_hz": rate}
        flight = pf.flown(pf.body(**record, magnetometer=sensor, duty_cycle=cycle), seconds=20.0, software=[steady])
        times, error = disturbance(flight)
        expected = np.where((times % 2.0 > 1e-6) & (times % 2.0 < 1.4), 1e-6, 0.0)  # 2,000 nT/(A m2) times 0.5 A m2
        assert np.allclose(error, expected, atol=1e-14)
        assert clean is None or bool(np.all(error < 1e-14)) == clean
    flight = pf.flown(pf.body(**record, magnetometer=COUPLED), seconds=20.0, software=[steady])
    assert np.allclose(disturbance(flight)[1][1:], 1e-6, atol=1e-14)


def test_the_duty_cycles_torque_is_its_share():
    """On 1.4 s in 2 s: the torquers' angular impulse is 0.7 of that without a cycle; late commands wait for the next part."""
    heavy = {"rate_deg_s": (0.0, 0.0, 0.0), "inertia_kg_m2": (1e6, 1e6, 1e6), "magnetorquer": torquers()}
    steady = law(name="steady", parameters=(0.5, 0.1, 0.0), rate_hz=0.5)
    whole = pf.flown(pf.body(**heavy), seconds=40.0, software=[steady]).y[10:13]
    part = pf.flown(pf.body(**heavy, duty_cycle={"period_s": 2.0, "torque_on_s": 1.4}), seconds=40.0, software=[steady]).y[10:13]
    assert np.allclose(part, 0.7 * whole, rtol=1e-9)


@pytest.mark.parametrize("method", ["rk4", "dop853"])
def test_thruster_pulses_give_their_impulse_exactly(method):
    """0.37 of each period of 2 s, 5 N on 10 kg: the velocity gained is the impulse over the mass, and so is the spin."""
    thruster = {"position_b_m": (0.0, 0.3, 0.0), "direction_b": (1.0, 0.0, 0.0), "force_n": 5.0}
    record = pf.body(
        rate_deg_s=(0.0, 0.0, 0.0), inertia_kg_m2=(1e9, 1e9, 1e9), thruster=[thruster], attitude={"quaternion_bi": (0, 0, 0, 1)}
    )
    pulse = law(name="steady", commands=("thrust",), parameters=(0.37,))
    with_pulses = pf.flown(record, seconds=20.0, integrator={"method": method, "step_s": 0.5}, software=[pulse])
    without = pf.flown(record, seconds=20.0, integrator={"method": method, "step_s": 0.5})
    impulse = 10 * 0.37 * 2.0 * 5.0
    # gravity's gradient over the metres gained is 1e-6 of a m/s
    assert np.allclose((with_pulses.y - without.y)[3:6], [impulse / 10.0, 0.0, 0.0], atol=2e-3)
    assert np.allclose(with_pulses.y[10:13], [0.0, 0.0, -0.3 * impulse / 1e9], rtol=1e-12, atol=1e-20)


def test_short_pulses_are_left_out_and_full_ones_do_not_blink():
    thruster = {"position_b_m": (0.0, 0.0, 0.0), "direction_b": (1.0, 0.0, 0.0), "force_n": 5.0, "minimum_on_time_s": 0.5}
    for share, on in ((0.24, 0.0), (0.25, 0.5), (1.0, 2.0), (7.0, 2.0), (-1.0, 0.0)):
        pulse = law(name="steady", commands=("thrust",), parameters=(share,))
        flight = pf.flown(pf.body(thruster=[thruster]), seconds=20.0, output=0.2, software=[pulse])
        seconds, told = moments(flight)
        push = flight.record.loads[: len(seconds), LOADS.index("thrusters"), 0, :3]
        expected = (seconds % 2.0 < on - 1e-6) | (2.0 - seconds % 2.0 < 1e-6 if on > 0 else False)
        assert np.array_equal(np.linalg.norm(push, axis=1) > 0.0, expected), share
        assert np.all(told[1:, 0] == min(max(share, 0.0), 1.0)), "the result keeps what was commanded"


@pytest.mark.parametrize("method", ["rk4", "dop853"])
def test_a_wheel_stops_taking_torque_where_it_is_full(method):
    """Full at 0.0505 N m s after 5.05 s: the body keeps what it had, and the whole momentum stays."""
    record = pf.body(wheel=wheels(momentum_max_n_m_s=0.0505))
    torque = law(name="steady", commands=("wheel_torque",), parameters=(-0.01, 0.0, 0.0))
    flight = pf.flown(record, seconds=20.0, output=0.5, integrator={"method": method, "step_s": 0.5}, software=[torque])
    seconds, states = pf.rows(flight)
    momentum = pf.rest(flight)[:, 0]
    before = seconds < 5.05
    assert np.allclose(momentum[before], 0.01 * seconds[before], atol=1e-12)
    assert np.all(momentum[~before] <= 0.0505 + 1e-9) and np.all(momentum[~before] > 0.0505 - 1e-6)
    whole = pf.spin_momentum(flight, states, wheels=np.array([momentum, 0 * momentum, 0 * momentum]).T)
    assert np.abs(whole - whole[0]).max() < 1e-7 * np.linalg.norm(whole[0])


def test_a_full_wheel_still_gives_back():
    record = pf.body(wheel=wheels(momentum_max_n_m_s=0.05, momentum_n_m_s=0.05))
    torque = law(name="steady", commands=("wheel_torque",), parameters=(0.01, 0.0, 0.0))
    flight = pf.flown(record, seconds=3.0, software=[torque])
    assert np.isclose(pf.rest(flight)[-1, 0], 0.02, atol=1e-12)


def test_a_wanted_torque_is_the_bodys():
    """The convention: wheel_torque is what the body gets; three skew wheels share it so that their sum is it."""
    skew = [wheels()[0] | {"axis_b": axis} for axis in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.6, 0.0, 0.8), (0.0, 0.6, -0.8))]
    heavy = pf.body(inertia_kg_m2=(10.0, 10.0, 10.0), rate_deg_s=(0.0, 0.0, 0.0), wheel=skew)
    torque = law(name="steady", commands=("wheel_torque",), parameters=(0.01, -0.02, 0.03))
    flight = pf.flown(heavy, seconds=2.0, software=[torque])
    assert np.allclose(flight.y[10:13], np.array([0.01, -0.02, 0.03]) * 2.0 / 10.0, rtol=1e-9)


SENSED = {"magnetometer": {"rate_hz": 2.0, "noise_std_nt": 100.0}, "gyro": {"rate_hz": 4.0, "noise_std_deg_s": 0.01}}


def waving(name, compiled, **more):
    software = [law(name=name, parameters=(2e4, 1e-3, 0.1)) | {"compiled": compiled, "name": "wave"}]
    return pf.Flight(pf.scenario(pf.body(magnetorquer=torquers(), **SENSED), seconds=60.0, output=1.0, software=software, **more))


def test_a_law_in_python_and_the_same_compiled_give_the_same_bits():
    flights = [waving("wave", False), waving("compiled_wave", True), waving("compiled_wave", False)]
    for flight in flights:
        flight.fly()
    assert np.abs(flights[0].record.actuators).max() > 0.01
    for other in flights[1:]:
        assert np.array_equal(flights[0].record.state, other.record.state)
        assert np.array_equal(flights[0].record.samples, other.record.samples)
        assert np.array_equal(flights[0].record.actuators, other.record.actuators)


@pytest.mark.parametrize("method", ["rk4", "dop853"])
def test_how_often_the_loop_comes_back_does_not_change_a_bit(method):
    """One step at a time, seven, or all at once; and a pause in the middle."""
    flights = [waving("compiled_wave", True, integrator={"method": method}) for _ in range(3)]
    for flight, budget in zip(flights, (1, 7, 10**7), strict=True):
        while flight._fly_on(budget) == 0:
            pass
    for other in flights[1:]:
        assert np.array_equal(flights[0].record.state, other.record.state)
        assert np.array_equal(flights[0].record.samples, other.record.samples)
        assert np.array_equal(flights[0].y, other.y)
        assert np.array_equal(flights[0].clock.steps, other.clock.steps)


def test_one_seed_one_flight():
    flights = [waving("compiled_wave", True) for _ in range(2)]
    flights.append(pf.Flight(flights[0].scenario, seed=1))
    for flight in flights:
        flight.fly()
    assert np.array_equal(flights[0].record.samples, flights[1].record.samples)
    assert not np.array_equal(flights[0].record.samples, flights[2].record.samples)


def test_an_estimator_tells_the_controller():
    """Unknown until 10 s, then what the estimator says; at equal times the estimator comes first, whatever the file's order."""
    q = (0.1, 0.2, 0.3, float(np.sqrt(1 - 0.14)))
    estimator = {
        "law": "user_functions:knows_later", "compiled": False, "role": "estimator", "rate_hz": 1.0,
        "parameters": {"from_s": 10.0, "told": [*q, 0.01, 0.02, 0.03]},
    }  # fmt: skip
    controller = law(name="listens", parameters=()) | {"rate_hz": 1.0, "memory": 24}
    flight = pf.flown(
        pf.body(magnetorquer=torquers(), wheel=wheels(momentum_n_m_s=0.02)),
        seconds=20.0,
        output=1.0,
        software=[controller, estimator],
    )
    memory = flight.software[0].memory
    assert np.allclose(memory[0:7], [*q, 0.01, 0.02, 0.03]) and memory[23] == 21
    assert list(memory[7:13]) == [0, 0, 0, 1, 1, 1]
    assert np.allclose(memory[16:19], 0.02) and np.allclose(memory[20:23], pf.UNIFORM)
    seconds, dipole = moments(flight)
    assert np.allclose(dipole[:, 0], np.where(seconds >= 10.0, 1e-5, 0.0))
    known = flight.record.known[: len(seconds), 0]
    assert np.isnan(known[seconds < 10.0]).all() and np.allclose(known[seconds >= 10.0], [*q, 0.01, 0.02, 0.03])


def test_an_empty_queue_is_never_due():
    flight = waving("compiled_wave", True)
    flight.fly()
    assert np.all(flight.tasks.pending == NEVER)


def test_perfect_sensors_read_the_truth():
    record = pf.body(
        magnetometer={"rate_hz": 1.0, "phase_s": 0.5},
        gyro={"rate_hz": 2.0},
        navigation={"rate_hz": 0.5},
        star_tracker={"rate_hz": 1.0},
        sun_sensor={"rate_hz": 1.0},
    )
    flight = pf.flown(record, seconds=30.0, output=0.5, integrator={"step_s": 0.25})
    _, states = pf.rows(flight)
    samples = flight.record.samples[: int(flight.clock.samples[0])]
    turn = pf.turned(states[:, 0])
    truth = {
        "navigation": states[:, 0, :3],
        "magnetometer": turn.inv().apply(pf.UNIFORM),
        "gyro": states[:, 0, 10:13],
        "star_tracker": states[:, 0, 6:10],
    }
    order = ["navigation", "magnetometer", "gyro", "sun_sensor", "star_tracker"]
    for j, name in enumerate(order):
        mine = samples[samples[:, 0] == j]
        assert len(mine) == {"gyro": 61, "navigation": 16, "magnetometer": 30}.get(name, 31)
        if name == "sun_sensor":
            continue
        at = np.round(mine[:, 1] / 0.5).astype(int)
        width = truth[name].shape[1]
        told = mine[:, 2 : 2 + width]
        if name == "star_tracker":
            told = told * np.sign(np.sum(told * truth[name][at], axis=1))[:, None]
        assert np.allclose(told, truth[name][at], rtol=1e-12, atol=1e-15)
