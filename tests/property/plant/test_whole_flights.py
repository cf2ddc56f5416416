"""Laws of whole flights, with everything at work at once: steppers agree, bodies do not meddle, rods calm a tumbler."""

import numpy as np
import pytest

import plant_flights as pf
from plant_flights import law, torquers, wheels
from plant_loads import AXES, LIGHT, ROD, everything

SENSORS = {"magnetometer": {"rate_hz": 1.0}, "gyro": {"rate_hz": 1.0}}
THRUSTER = {"position_b_m": (0.1, 0.2, 0.0), "direction_b": (0.0, 0.6, 0.8), "force_n": 0.05}
TIGHT = {"method": "dop853", "relative_tolerance": 1e-13, "position_tolerance_m": 1e-6, "angle_tolerance_rad": 1e-12}


def busy(name, scale, **more):
    """A body with sensors, torquers that lag, wheels and a thruster; its three tasks."""
    record = pf.body(
        name,
        magnetorquer=torquers(time_constant_s=0.3),
        wheel=wheels(momentum_n_m_s=0.02 * scale),
        thruster=[THRUSTER],
        gravity_gradient=True,
        residual_dipole_a_m2=(0.1, 0.2, -0.1),
        solar_pressure=LIGHT,
        duty_cycle={"period_s": 2.0, "torque_on_s": 1.4},
        **SENSORS,
        **more,
    )
    tasks = [
        law("wave", parameters=(1e4 * scale, 1e-3, 0.1)) | {"name": f"{name} magnetic", "body": name},
        law("steady", ("wheel_torque",), (1e-3 * scale, -2e-3, 1e-3), delay_s=0.7) | {"name": f"{name} wheels", "body": name},
        law("steady", ("thrust",), (0.3,), rate_hz=0.25) | {"name": f"{name} jets", "body": name},
    ]
    return record, tasks


@pytest.mark.parametrize("method", ["rk4", "dop853"])
def test_bodies_that_no_line_joins_fly_as_if_alone(method):
    """Two in one run, each with its sensors, actuators and software, and each by itself: to the bit with fixed steps."""
    (one, first), (two, second) = busy("one", 1.0), busy("two", 2.0)
    beside = {"offset_o_m": (0.0, 500.0, 100.0)}
    integrator = {"method": method, "step_s": 0.5} | (TIGHT if method == "dop853" else {})
    more = {"seconds": 30.0, "output": 1.0, "integrator": integrator, "environment": {"gravity": "j2", "field_degree": 4}}
    both = pf.flown(one, two | beside, software=first + second, **more)
    alone = pf.flown(one, software=first, **more)
    seconds, states = pf.rows(both)
    assert both.outcome.name == "DONE" and len(seconds) == 31
    _, mine = pf.rows(alone)
    other = pf.Flight(pf.scenario(two, software=second, **more))
    other.y[:13] = both.start[13:26]  # the second body's start, which [orbit] does not give
    other.fly()
    _, theirs = pf.rows(other)
    slack = 0.0 if method == "rk4" else 1e-6
    assert np.abs(states[:, 0] - mine[:, 0]).max() <= slack and np.abs(states[:, 1] - theirs[:, 0]).max() <= slack
    # wheels of the first body come before those of the second
    assert np.abs(pf.rest(both)[:, :3] - pf.rest(alone)).max() <= slack
    assert np.abs(pf.rest(both)[:, 3:] - pf.rest(other)).max() <= slack
    assert np.ptp(states[:, 1, 10:13], axis=0).min() > 1e-4  # the software did something


def test_both_steppers_fly_a_busy_body_to_the_same_end():
    record, tasks = busy("one", 1.0)
    more = {"seconds": 60.0, "software": tasks, "environment": {"gravity": "j2", "field_degree": 4}}
    fixed = pf.flown(record, integrator={"step_s": 0.05}, **more)
    adaptive = pf.flown(record, integrator=TIGHT | {"rate_tolerance_rad_s": 1e-13}, **more)
    assert np.abs(fixed.y - adaptive.y)[:6].max() < 1e-5
    assert np.abs(fixed.y - adaptive.y)[6:].max() < 1e-8


def test_everything_at_once_flies_and_both_steppers_agree():
    """Rods with their corners, lines, air, light, wheels, thrusters and loads of the user's: 20 s of all of it."""
    flights = []
    for integrator in ({"step_s": 0.01}, TIGHT):
        flight = everything(integrator=integrator, seconds=20.0)
        flight.fly()
        assert flight.outcome.name == "DONE"
        flights.append(flight.y)
    # a damped line that goes taut pulls at once: there RK4 is of first order, 1e-4 at this step
    apart = np.abs(flights[0] - flights[1])
    bodies = apart[:39].reshape(3, 13)
    assert bodies[:, :6].max() < 1e-3 and bodies[:, 6:].max() < 3e-4 and apart[39:].max() < 1e-5


@pytest.mark.parametrize("method", ["rk4", "dop853"])
def test_rods_calm_a_tumbler(method):
    """In a uniform field, over many turns: energy goes, and nothing else takes it."""
    rods = [ROD | {"axis_b": axis, "volume_m3": 1e-4} for axis in AXES]
    flight = pf.flown(pf.body(hysteresis_rod=rods), seconds=20000.0, output=2000.0, integrator={"method": method, "step_s": 1.0})
    energy = pf.spin_energy(flight, pf.rows(flight)[1])
    assert np.all(np.diff(energy) < 0.0) and energy[-1] < 0.9 * energy[0]
    assert np.all(np.abs(pf.rest(flight)) <= ROD["saturation_tesla"])
