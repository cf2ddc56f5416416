"""Which scenarios the lanes fly, and what they are given to fly with.

One rigid body; point gravity or J2; a field of harmonics alone; residual dipole, gravity gradient; RK4 with the field at
every stage; a perfect magnetometer read when the law is called; torquers along X, Y and Z that obey at once; the law
"b-dot" on differences, neither filtered nor resting; outputs at law calls; at most one event, a rate that falls and stops
the run. What a scenario has besides is for the plant's own loop.
"""

from __future__ import annotations

import numpy as np

from fieldline.control.b_dot import GAIN, LOW_PASS, RATE_OFF, USE_GYRO
from fieldline.simulate.ensemble.lane_loop import Block, Pace, new_block, rows_of
from fieldline.simulate.ensemble.lanes import LANES, Own, Shared
from fieldline.simulate.loop.records import MAGNETOMETER, OUTPUT, RATE, TASK

WHOLE = 1e-9  # how far a ratio of times may be from a whole number


def covered(flight) -> bool:
    """Do the lanes fly this flight?"""
    return all(test(flight) for test in (_body, _surroundings, _sensor, _law, _torquers, _times, _event))


def alike(one, other) -> bool:
    """Can two covered flights be in one block: is what the lanes share the same?"""
    return _common(one) == _common(other)


def _common(flight):
    """What runs of a block share, as values that compare."""
    scenario = flight.scenario
    times = (flight.duration_s, scenario.time.start_utc, scenario.time.output_step_s)
    return (times, scenario.integrator, scenario.environment, scenario.event, flight.tasks.period[0])


def _body(flight) -> bool:
    """One rigid body without air, light, wheels, jets, rods, lines or loads of the user."""
    plant, bodies = flight.plant, flight.plant.bodies
    others = (plant.wheels.body, plant.thrusters.body, plant.rods.body, plant.lines.nodes, plant.user.body)
    absent = (bodies.induced, bodies.eddy, bodies.drag, bodies.solar, bodies.torque_b, bodies.torque_i)
    one = len(bodies.mass) == 1 and bodies.rigid[0] == 1 and plant.magnetic
    return one and not any(len(part) for part in others) and not any(np.any(part) for part in absent)


def _surroundings(flight) -> bool:
    """Point gravity or J2, and harmonics of the field alone."""
    surroundings = flight.plant.surroundings
    return (
        surroundings.rotating
        and not len(surroundings.gravity.table)
        and not len(surroundings.field.dipole_moment_e)
        and not np.any(surroundings.uniform_field_i)
        and flight.scenario.integrator.method == "rk4"
        and flight.scenario.integrator.field_update == "stage"
    )


def _sensor(flight) -> bool:
    """A magnetometer that reads the truth."""
    sensor = flight.sensors.suite.magnetometers
    plain = np.array_equal(sensor.gain[0], np.eye(3).ravel()) and np.isinf(sensor.limit[0])
    return plain and not any(np.any(part) for part in (sensor.coupling, sensor.bias, sensor.noise_std, sensor.quantum))


def _law(flight) -> bool:
    """B-dot alone, on differences."""
    if len(flight.software) != 1 or flight.software[0].record.law != "b-dot":
        return False
    params = flight.parameters[flight.tasks.slot[0]]
    return flight.tasks.delay[0] == 0.0 and params[USE_GYRO] == params[LOW_PASS] == params[RATE_OFF] == 0.0


def _torquers(flight) -> bool:
    """Along X, Y, Z in this order, each obeying at once."""
    actuators, torquers = flight.actuators, flight.plant.torquers
    along = len(torquers.axis) == 3 and np.array_equal(torquers.axis, np.eye(3)) and np.allclose(actuators.share, np.eye(3))
    return bool(along and not np.any(torquers.lag) and not np.any(actuators.quantum))


def _times(flight) -> bool:
    """Readings with the calls, outputs on calls, nothing else in the schedule."""
    schedule = flight.schedule
    if sorted(schedule.kind) != sorted([MAGNETOMETER, TASK, OUTPUT]) or np.any(schedule.phase):
        return False
    period = {int(kind): float(p) for kind, p in zip(schedule.kind, schedule.period, strict=True)}
    law = period[TASK]
    ratios = (period[OUTPUT] / law, flight.duration_s / law)
    return period[MAGNETOMETER] == law and all(abs(x - round(x)) < WHOLE * max(x, 1.0) and x >= 1.0 for x in ratios)


def _event(flight) -> bool:
    """None, or a rate that falls and stops the run."""
    events = flight.events
    if len(events.kind) == 0:
        return True
    return len(events.kind) == 1 and events.kind[0] == RATE and events.direction[0] == -1 and events.stop[0] == 1


def block_of(flights) -> Block:
    """A block of at most LANES covered flights that are alike."""
    first = flights[0]
    gravity, field = first.plant.surroundings.gravity, first.plant.surroundings.field
    shared = Shared(
        gm=gravity.gm,
        j2=gravity.j2,
        oblate_radius_m=gravity.radius_m,
        basis=field.basis,
        table=field.table,
        ephemeris=first.plant.surroundings.ephemeris,
        lanes=LANES,
    )
    own = Own(
        inertia=rows_of([f.plant.bodies.inertia[0] for f in flights]),
        inverse=rows_of([f.plant.bodies.inertia_inv[0] for f in flights]),
        residual=rows_of([f.plant.bodies.residual[0] for f in flights]),
        gradient=rows_of([f.plant.bodies.gravity_gradient[:1] for f in flights]),
        gain=rows_of([f.parameters[f.tasks.slot[0]][GAIN : GAIN + 1] for f in flights]),
        moment_max=rows_of([f.actuators.limit for f in flights]),
    )
    period = float(first.tasks.period[0])
    pace = Pace(
        period=period,
        steps=max(1, int(np.ceil(period / first.scenario.integrator.step_s - 1e-6))),
        calls=round(first.duration_s / period),
        every=round(first.scenario.time.output_step_s / period),
        rest_rate=float(first.events.level[0]) if len(first.events.level) else 0.0,
        floor=first.stepping.floor,
    )
    return new_block(shared, own, pace, np.array([f.start for f in flights]))
