"""Sensors at their times: the truth in, a reading on the body's board and in the record."""

from __future__ import annotations

from fieldline.compiled import inner
from fieldline.dynamics.layout import three
from fieldline.dynamics.loads.magnetic import commanded_dipole
from fieldline.dynamics.parameters import STATE
from fieldline.dynamics.rates import field_at
from fieldline.environment.eclipse import sunlit_kernel
from fieldline.environment.ephemeris import dcm_ei_kernel, sun_kernel
from fieldline.frames.attitude import to_body
from fieldline.frames.vectors import sub, unit
from fieldline.sensing.gyro import read_gyro
from fieldline.sensing.magnetometer import read_magnetometer
from fieldline.sensing.navigation import read_navigation, read_relative
from fieldline.sensing.star_tracker import read_star_tracker
from fieldline.sensing.sun_sensor import read_sun_sensor
from fieldline.simulate.loop.flight_software import measurement_of
from fieldline.simulate.loop.records import GYRO, MAGNETOMETER, NAVIGATION, STAR_TRACKER, SUN_SENSOR


@inner
def keep(t, row, values, record, clock):
    """Store a reading with the row of the schedule that it comes from."""
    place = clock.samples[0]
    if place < record.samples.shape[0]:
        clock.samples[0] = place + 1
        record.samples[place, 0] = row
        record.samples[place, 1] = t
        for j in range(values.shape[0]):
            record.samples[place, 2 + j] = values[j]


@inner
def sample(t, row, kind, b, run, rng):
    """Read one sensor of body b."""
    y, plant, sensors, boards, record, clock = run.y, run.plant, run.sensors, run.boards, run.record, run.clock
    board = measurement_of(boards, b)
    suite = sensors.suite
    r, v, omega = three(y, STATE * b), three(y, STATE * b + 3), three(y, STATE * b + 10)
    q = (y[STATE * b + 6], y[STATE * b + 7], y[STATE * b + 8], y[STATE * b + 9])
    if kind == MAGNETOMETER:
        dcm_ei = dcm_ei_kernel(t, plant.surroundings.ephemeris)
        field_b = to_body(q, field_at(r, dcm_ei, plant.surroundings))
        dipole = commanded_dipole(t, b, plant.torquers, run.inputs)
        read_magnetometer(t, field_b, dipole, suite.magnetometers, b, rng, board)
        keep(t, row, board.field_b, record, clock)
    elif kind == GYRO:
        first = run.schedule.count[row] <= 1
        read_gyro(omega, 0.0 if first else run.schedule.period[row], suite.gyros, sensors.gyro_bias, b, rng, board)
        keep(t, row, board.rate_b, record, clock)
    elif kind == NAVIGATION:
        read_navigation(r, v, suite.navigations, b, rng, board)
        if b > 0:
            read_relative(sub(r, three(y, 0)), sub(v, three(y, 3)), suite.navigations, b, rng, board)
        keep(t, row, board.position_i, record, clock)
    else:
        sun_i = sun_kernel(t, plant.surroundings.ephemeris)
        sun_b = to_body(q, unit(sub(sun_i, r)))
        sunlit = sunlit_kernel(r, sun_i)
        if kind == SUN_SENSOR:
            read_sun_sensor(sun_b, sunlit, to_body(q, r), suite.sun_sensors, b, rng, board)
            keep(t, row, board.sun_sensor, record, clock)
        elif kind == STAR_TRACKER:
            read_star_tracker(q, omega, sun_b, sunlit, to_body(q, r), suite.star_trackers, b, rng, board)
            keep(t, row, board.q_bi, record, clock)
