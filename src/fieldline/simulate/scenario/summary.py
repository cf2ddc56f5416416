"""What was understood of a scenario, for a person to look over before it runs."""

from __future__ import annotations

from collections.abc import Iterator
from math import hypot

import numpy as np

from fieldline.constants import EARTH_EQUATORIAL_RADIUS_M, EARTH_GM_M3_S2
from fieldline.simulate.scenario.body import SENSORS
from fieldline.simulate.scenario.coarseness import longest_step_s
from fieldline.simulate.scenario.line_tolerance import allowed
from fieldline.simulate.scenario.states import period_s, start_states

LABEL = 12  # columns of the first word


def summary(scenario) -> str:
    """Lines for the terminal: time, orbit, environment, integrator, bodies, lines, software, events."""
    states = start_states(scenario)
    title = f"{scenario.name}: {scenario.description}" if scenario.description else scenario.name
    rows = [*_run(scenario, states[0]), *_bodies(scenario), *_rest(scenario)]
    return "\n".join([" ".join(title.split()), *(f"  {label:<{LABEL}}{text}" for label, text in rows)])


def _run(scenario, state) -> Iterator[tuple[str, str]]:
    """Time, orbit, environment, integrator."""
    period = period_s(*state)
    length = scenario.time.length_s(period)
    yield (
        "time",
        f"{scenario.time.start_utc}, {_duration(length)} ({length / period:.3g} orbits), "
        f"{length / scenario.time.output_step_s + 1:,.0f} samples every {scenario.time.output_step_s:g} s",
    )
    yield "orbit", _orbit(*state)
    yield "environment", ", ".join(_surroundings(scenario.environment))
    yield "integrator", _integrator(scenario, length)
    yield "seed", str(scenario.seed)


def _duration(length_s: float) -> str:
    """A time span in the unit that suits it."""
    for unit, size in (("days", 86400.0), ("hours", 3600.0), ("minutes", 60.0)):
        if length_s >= 2.0 * size:
            return f"{length_s / size:.4g} {unit}"
    return f"{length_s:.4g} s"


def _orbit(position_i: np.ndarray, velocity_i: np.ndarray) -> str:
    """Osculating perigee, apogee, inclination, period."""
    radius, momentum = float(np.linalg.norm(position_i)), np.cross(position_i, velocity_i)
    axis = 1.0 / (2.0 / radius - float(velocity_i @ velocity_i) / EARTH_GM_M3_S2)
    spread = axis * np.sqrt(max(0.0, 1.0 - float(momentum @ momentum) / (EARTH_GM_M3_S2 * axis)))
    low, high = (1e-3 * (axis + sign * spread - EARTH_EQUATORIAL_RADIUS_M) for sign in (-1.0, 1.0))
    inclination = np.degrees(np.arccos(momentum[2] / np.linalg.norm(momentum)))
    minutes = period_s(position_i, velocity_i) / 60.0
    return f"{low:.1f} x {high:.1f} km over the equatorial radius, inclination {inclination:.2f} deg, period {minutes:.2f} min"


def _surroundings(environment) -> Iterator[str]:
    """Field, gravity, air."""
    if environment.uniform_field_i_tesla is not None:
        yield f"uniform field of {1e9 * hypot(*environment.uniform_field_i_tesla):,.0f} nT"
    else:
        model = environment.field_model()
        yield f"field {model.name}" + (f" to degree {model.degree}" if model.degree else "")
    degree = f" to degree {environment.gravity_degree or 20}" if environment.gravity == "harmonic" else ""
    yield f"gravity {environment.gravity}{degree}"
    yield f"air {environment.atmosphere.model}"
    if environment.plasma.model != "none":
        yield f"plasma {environment.plasma.model}"


def _integrator(scenario, length_s: float) -> str:
    """Method, step, and what it costs."""
    one = scenario.integrator
    field = "at each stage" if one.field_update == "stage" else "once per step"
    if one.method != "rk4":
        return f"{one.method}, error of a step {allowed(scenario)[1]:.2g} m, field {field}"
    steps = length_s / longest_step_s(scenario)
    return f"rk4, step {one.step_s:g} s, field {field}: at least {steps:,.0f} steps"


def _bodies(scenario) -> Iterator[tuple[str, str]]:
    """Each body with its loads, actuators and sensors."""
    for body in scenario.body:
        inertia = ""
        if body.inertia_kg_m2 is not None:
            inertia = ", principal moments " + ", ".join(f"{x:.4g}" for x in np.linalg.eigvalsh(body.inertia_kg_m2)) + " kg m^2"
        yield "body", f"{body.name}: {body.kind}, {body.mass_kg:g} kg{inertia}"
        yield "  start", _start(body)
        yield "  loads", ", ".join(_loads(body)) or "gravity alone"
        yield "  actuators", ", ".join(_actuators(body)) or "none"
        yield "  sensors", ", ".join(_sensors(body)) or "none"


def _start(body) -> str:
    """Attitude, rate and place."""
    attitude = "along the orbital axes"
    if body.attitude is not None:
        keys = ("quaternion_bi", "quaternion_bo", "euler_321_deg")
        given = next((key for key in keys if getattr(body.attitude, key) is not None), None)
        attitude = f"{given} = {list(getattr(body.attitude, given))}" if given else "attitude at random"
    rate = f"{body.random_rate_deg_s:g} deg/s about a random axis" if body.random_rate_deg_s else "at rest"
    if body.rate_deg_s is not None and any(body.rate_deg_s):
        rate = f"{hypot(*body.rate_deg_s):.4g} deg/s"
    against = "the orbital axes" if body.rate_axes == "orbital" else "the stars"
    place = f", {hypot(*body.offset_o_m):g} m from the first body" if body.offset_o_m is not None else ""
    if body.hang is not None:
        place = f", hanging {_swing(body.hang)}"
    return ("a point" if body.kind == "point" else f"{attitude}, {rate} against {against}") + place


def _swing(hang) -> str:
    """How a body hangs on its line."""
    way = "upwards" if hang.upward else "downwards"
    angles = f"{hang.in_plane_deg:g} deg in the plane, {hang.out_of_plane_deg:g} deg across it"
    moves = hang.in_plane_rate_deg_s or hang.out_of_plane_rate_deg_s
    return f"{way}, {angles}, {'swinging' if moves else 'without rates'}"


def _loads(body) -> Iterator[str]:
    """The loads that are on."""
    if body.gravity_gradient:
        yield "gravity gradient"
    if any(body.residual_dipole_a_m2):
        yield f"residual dipole {hypot(*body.residual_dipole_a_m2):.3g} A m^2"
    switched = {
        "induced_dipole_a_m2_tesla": "induced dipole",
        "eddy_damping_n_m_s_tesla2": "eddy damping",
        "disturbance_torque_b_n_m": "disturbance torque in body axes",
        "disturbance_torque_i_n_m": "disturbance torque in inertial axes",
        "drag": "drag",
        "solar_pressure": "solar pressure",
    }
    yield from (words for key, words in switched.items() if getattr(body, key) != type(body).model_fields[key].default)
    if body.hysteresis_rod:
        yield f"{len(body.hysteresis_rod)} hysteresis rods"
    yield from (one.function for one in body.load)


def _actuators(body) -> Iterator[str]:
    """What can be commanded."""
    limits = {
        "magnetorquer": ("torquers", "moment_max_a_m2", "A m^2"),
        "wheel": ("wheels", "momentum_max_n_m_s", "N m s"),
        "thruster": ("thrusters", "force_n", "N"),
    }
    for key, (words, limit, unit) in limits.items():
        each = getattr(body, key)
        if each:
            sizes = " and ".join(f"{size:g}" for size in sorted({getattr(one, limit) for one in each})[:3])
            yield f"{len(each)} {words if len(each) > 1 else words[:-1]} of {sizes} {unit}"


def _sensors(body) -> Iterator[str]:
    """What is measured, and how often."""
    for key in SENSORS:
        one = getattr(body, key)
        if one is not None:
            yield f"{key.replace('_', ' ')} at {one.rate_hz:g} Hz"
    if body.duty_cycle is not None:
        yield f"torquers on for {body.duty_cycle.torque_on_s:g} of every {body.duty_cycle.period_s:g} s"


def _of_line(line) -> str:
    """What a line has besides length and stiffness."""
    circuit = f"{line.circuit.mode} circuit" if line.circuit else ""
    parts = [f"{line.nodes} nodes" if line.nodes else "", "reel" if line.reel else "", "heat" if line.heat else "", circuit]
    if line.start is not None and line.start.skiprope_amplitude_m > 0.0:
        parts.append(f"skiprope {line.start.skiprope_amplitude_m:g} m {line.start.skiprope_sense}")
    if line.start is not None and line.start.pulse_amplitude_m != 0.0:
        parts.append(f"pulse {line.start.pulse_amplitude_m:g} m")
    return "".join(f", {part}" for part in parts if part)


def _rest(scenario) -> Iterator[tuple[str, str]]:
    """Lines, software, events."""
    for line in scenario.line:
        yield "line", f"{line.from_body} to {line.to_body}: {line.rest_length_m:g} m, {line.stiffness_n:g} N{_of_line(line)}"
    for task in scenario.software:
        body = scenario.body[scenario.index_of(task.body)].name
        given = ", ".join(f"{key} = {value}" for key, value in task.parameters.items()) or "parameters derived or default"
        delay = f", {task.delay_s:g} s late" if task.delay_s else ""
        yield "software", f"{task.name or task.law} ({task.law}, {task.role}) on {body} at {task.rate_hz:g} Hz{delay}; {given}"
    for event in scenario.event:
        threshold = next((f" {x:g}" for x in (event.altitude_km, event.rate_deg_s) if x is not None), "")
        yield "event", f"{event.name or event.kind}: {event.kind}{threshold}{', ends the run' if event.stop else ''}"
