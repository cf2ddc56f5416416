"""What the loop starts from: sensors, boards, actuators, schedule, commands, and the record that it fills."""

from __future__ import annotations

from math import ceil

import numpy as np

from fieldline.dynamics.load_log import LOADS
from fieldline.dynamics.parameters import Plant, state_size, tangent_size
from fieldline.errors import InputError
from fieldline.sensing.measurement import Measurement
from fieldline.sensing.suite import suite
from fieldline.simulate.assembly.plant import fresh, no_field
from fieldline.simulate.loop import records as loop

KINDS = {
    "navigation": loop.NAVIGATION,
    "magnetometer": loop.MAGNETOMETER,
    "gyro": loop.GYRO,
    "sun_sensor": loop.SUN_SENSOR,
    "star_tracker": loop.STAR_TRACKER,
}  # in the order in which they are read
OF_LINES = ("tension", "line_length", "line_rate")
MOST_NUMBERS = 4e8  # of a record: 3 GB


def boards_of(scenario) -> loop.Boards:
    """One row a body, nothing known yet."""
    bodies = scenario.body
    count = len(bodies)
    faces = np.array([len(b.sun_sensor.normals_b) if b.sun_sensor else 0 for b in bodies], dtype=np.int64)
    wheels = np.array([len(b.wheel) for b in bodies], dtype=np.int64)
    widths = dict.fromkeys(Measurement._fields, 3)
    lines = np.array([sum(b.name in (line.from_body, line.to_body) for line in scenario.line) for b in bodies], dtype=np.int64)
    widths |= {"field_time_s": 1, "q_bi": 4, "valid": 6, "sun_sensor": int(faces.max()), "wheel_momentum": int(wheels.max())}
    widths |= dict.fromkeys(OF_LINES, int(lines.max()))
    rows = {name: np.full((count, width), np.nan) for name, width in widths.items()}
    for name in ("valid", "wheel_momentum", "dipole_b", *OF_LINES):
        rows[name][:] = 0.0
    return loop.Boards(**rows, faces=faces, wheels=wheels, lines=lines)


def measurement_row(boards: loop.Boards, b: int) -> Measurement:
    """What a plain Python law sees of body b: views that the loop keeps up to date, and that the law cannot write to."""
    rows = {name: getattr(boards, name)[b] for name in Measurement._fields}
    rows["sun_sensor"] = rows["sun_sensor"][: boards.faces[b]]
    rows["wheel_momentum"] = rows["wheel_momentum"][: boards.wheels[b]]
    rows |= {name: rows[name][: boards.lines[b]] for name in OF_LINES}
    for row in rows.values():
        row.flags.writeable = False  # of the view alone
    return Measurement(**rows)


def onboard_model(scenario, body):
    """The field model that flies on a body: its own, or that of the environment; None where that is uniform."""
    from fieldline.environment.field_registry import field_model

    if body.onboard is not None and scenario.environment.uniform_field_i_tesla is None:
        return field_model(body.onboard.field, degree=body.onboard.field_degree)
    return scenario.environment.field_model()


def sensors_of(scenario, plant: Plant, estimated: list[bool], middle) -> loop.Sensors:
    """The sensors; the field model on board is that of the first body that names one."""
    bodies = scenario.body
    chosen = next((b for b in bodies if b.onboard is not None), bodies[0])
    model = onboard_model(scenario, chosen)
    table = suite(
        len(bodies),
        magnetometers=[b.magnetometer for b in bodies],
        gyros=[b.gyro for b in bodies],
        sun_sensors=[b.sun_sensor for b in bodies],
        star_trackers=[b.star_tracker for b in bodies],
        navigations=[b.navigation for b in bodies],
        rate_estimated=estimated,
    )
    field = no_field() if model is None else fresh(model.at(middle))
    return loop.Sensors(suite=fresh(table), gyro_bias=table.gyros.bias.copy(), field=field)


def schedule_of(scenario, plant: Plant, software, step_s: float) -> loop.Schedule:
    """Lines' surroundings, sensors, estimators, laws, duty cycles, outputs, in the order in which they are done at one time."""
    rows = []
    for key, kind in KINDS.items():
        for b, body in enumerate(scenario.body):
            sensor = getattr(body, key)
            if sensor is not None:
                rows.append((kind, b, 1.0 / sensor.rate_hz, sensor.phase_s))
    order = sorted(range(len(software)), key=lambda i: software[i].record.role != "estimator")
    rows += [(loop.TASK, i, 1.0 / software[i].record.rate_hz, software[i].record.phase_s) for i in order]
    for b, body in enumerate(scenario.body):
        if body.duty_cycle is not None:
            cycle = body.duty_cycle
            rows += [(loop.TORQUE_ON, b, cycle.period_s, 0.0), (loop.TORQUE_OFF, b, cycle.period_s, cycle.torque_on_s)]
    if any(plant.lines.exposed) or plant.lines.warm[-1]:
        rows.insert(0, (loop.AMBIENT, 0, scenario.integrator.line_update_s, 0.0))
    rows.append((loop.OUTPUT, 0, step_s, 0.0))
    kind, who, period, phase = zip(*rows, strict=True)
    return loop.Schedule(
        kind=np.array(kind, dtype=np.int64),
        who=np.array(who, dtype=np.int64),
        period=np.array(period, dtype=float),
        phase=np.array(phase, dtype=float),
        count=np.zeros(len(rows), dtype=np.int64),
    )


def record_of(scenario, plant: Plant, schedule: loop.Schedule, actuators: int, duration_s: float) -> loop.Record:
    """Room for everything that the run will leave behind."""
    bodies = len(scenario.body)
    rows = int(duration_s / scenario.time.output_step_s + 1e-6) + 2
    samples = 0
    for kind, period, phase in zip(schedule.kind, schedule.period, schedule.phase, strict=True):
        if kind in KINDS.values() and phase <= duration_s:
            samples += int((duration_s - phase) / period + 1e-6) + 2
    widest = max([4, *(len(b.sun_sensor.normals_b) for b in scenario.body if b.sun_sensor)])
    lines, segments = len(plant.lines.nodes), len(plant.lines.rest)
    row = state_size(plant) + bodies * (11 + 6 * len(LOADS)) + 2 * segments + 9 * lines
    numbers = rows * row + samples * (2 + widest)
    if numbers > MOST_NUMBERS:
        raise InputError(
            f"the run would keep {rows} outputs and {samples} readings, {8e-9 * numbers:.1f} GB. Raise output_step_s, lower the "
            "sensors' rate_hz, or shorten the run."
        )
    return loop.Record(
        seconds=np.zeros(rows),
        state=np.zeros((rows, state_size(plant))),
        field_i=np.zeros((rows, bodies, 3)),
        sunlit=np.zeros((rows, bodies)),
        actuators=np.zeros((rows, actuators)),
        known=np.zeros((rows, bodies, 7)),
        loads=np.zeros((rows, len(LOADS), bodies, 6)),
        nodes=np.zeros((rows, lines), dtype=np.int64),
        tension=np.zeros((rows, segments)),
        current=np.zeros((rows, segments)),
        circuit=np.zeros((rows, lines, 8)),
        samples=np.zeros((samples, 2 + widest)),
        start=np.zeros((bodies, 4)),
        z=np.zeros(tangent_size(plant)),
        rate=np.zeros(tangent_size(plant)),
        unfrozen=np.zeros((0, 3)),
    )


def clock_of(first_step_s: float) -> loop.Clock:
    """At the start."""
    whole = {name: np.zeros(1, dtype=np.int64) for name in ("rows", "samples", "events")}
    return loop.Clock(t=np.zeros(1), h=np.array([first_step_s]), steps=np.zeros(2, dtype=np.int64), **whole)


def depth_of(records) -> int:
    """Commands that may wait at once."""
    return max([2, *(ceil(one.delay_s * one.rate_hz) + 2 for one in records)])
