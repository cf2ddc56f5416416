"""What a person may set of a tracking law, and what follows from it and the vehicle: the header that every law has."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fieldline.control.controllable import orbital_scale
from fieldline.control.law import Parameter, complete
from fieldline.control.tracking import onboard_vehicle as own
from fieldline.control.tracking.allocation import COST
from fieldline.control.tracking.reachable import nearest_held
from fieldline.control.tracking.tracking_loop import MOST_CONTROLS
from fieldline.errors import InputError
from fieldline.mechanics.lorentz import conductor_map
from fieldline.mechanics.relative_motion import input_matrix, linearisation_error, motion_matrix
from fieldline.vehicle.conductor import refuse_parallel

LIMITLESS = 1e30
MOST_LINEAR = 0.01  # error of the linear motion's gravity at a place, of the gradient
ATTITUDE_FIRST = 10.0  # weight of moments beside forces where limits do not leave both: a place waits, a tumble does not
QUIET = 1e-2  # weight of the force where attitude alone is held: none is wanted, but it matters less
ACROSS_HO = np.array([[0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])  # orbital axes o to axes h

COMMON = {
    "hold": Parameter("", "place and attitude, or attitude alone", "all", "choice", choices=("all", "attitude")),
    "place_h_m": Parameter(
        "m", "place beside the first body: up, along the velocity, along the orbit's normal", (0.0, 0.0, 0.0), "vector"
    ),
    "from_h_m": Parameter("m", "where the commanded way begins; derived as place_h_m", kind="vector", derived=True),
    "move_begins_s": Parameter("s", "when the commanded way begins", 0.0, "not negative"),
    "move_s": Parameter("s", "how long it takes; 0 is a step", 0.0, "not negative"),
    "closing_rate_m_s": Parameter("m/s", "commanded rate at the way's end", 0.0, "not negative"),
    "angles_deg": Parameter("deg", "commanded small turns about x, y, z from the target's axes", (0.0, 0.0, 0.0), "vector"),
    "field": Parameter("", "the field that it reckons with", "model", "choice", choices=("model", "magnetometer")),
    "field_factor": Parameter("", "by which the model's field is multiplied: a known error of scale", 1.0, "positive"),
    "mass_kg": Parameter("kg", "mass that it reckons with; derived from the body", kind="positive", derived=True),
    "inertia_kg_m2": Parameter(
        "kg m^2", "principal moments that it reckons with; derived from the body", kind="vector", derived=True
    ),
    "disturbance_s": Parameter("s", "time in which a load that nobody ordered is learned; 0 is never", 600.0, "not negative"),
    "filter_s": Parameter(
        "s", "time in which a reading of the place takes over from its forecast; 0: at once", 60.0, "not negative"
    ),
    "contactor_ohm": Parameter("ohm", "resistance of the plasma contacts of each conductor", 0.0, "not negative"),
    "power_max_w": Parameter("W", "most power of all conductors, as heat; 0 is no limit", 0.0, "not negative"),
    "failed": Parameter("", "names of conductors and thrusters that do nothing", (), "names"),
    "unreachable": Parameter(
        "",
        "a place that the limits cannot hold: refuse it, take the nearest on the way to it, or fly on",
        "refuse",
        "choice",
        choices=("refuse", "nearest", "fly"),
    ),
}
WEIGHTS = {
    "position_m": Parameter("m", "error of place that is as bad as the others", 5.0, "positive"),
    "angle_deg": Parameter("deg", "error of an angle that is", 1.0, "positive"),
    "response_s": Parameter(
        "s", "time in which such an error may go: its rate is as bad; derived as 1/(3 n)", kind="positive", derived=True
    ),
    "effort": Parameter("", "weight of controls at their limits beside such errors", 1.0, "positive"),
}


class Known(NamedTuple):
    """What a design starts from."""

    values: dict
    head: np.ndarray  # the row that every law begins with
    names: list[str]  # of the controls
    fields_h: np.ndarray  # (N, 3) [T] over a day
    step_s: float
    motion: np.ndarray  # F (12, 12)
    pushes: np.ndarray  # (12, 6) of loads
    inputs: np.ndarray  # G (N, 12, m)
    limits: np.ndarray  # (m,) larger bound
    mean_motion: float
    radius: float
    load_sizes: np.ndarray  # (6,) loads that all controls together can give, RMS over the day


def known_of(law: str, parameters: dict, table, context) -> Known:
    """Everything that the designs share; InputError for what no vehicle can be told."""
    values = complete(law, parameters, table)
    if not context.conductors and not context.thrusters:
        raise InputError(f'the law "{law}" needs a body with [[body.conductor]]; it has neither conductors nor thrusters.')
    mass = context.mass_kg if values["mass_kg"] is None else values["mass_kg"]
    given = values["inertia_kg_m2"]
    moments = own.principal_inertia(law, context.inertia_kg_m2) if given is None else np.asarray(given, dtype=float)
    controls, names = own.controls_of(context.conductors, context.thrusters, values["failed"], values["contactor_ohm"])
    if len(controls) > MOST_CONTROLS:
        raise InputError(f'the law "{law}" takes up to {MOST_CONTROLS} controls; the body has {len(controls)}.')
    _refuse_one_direction(values, context.conductors, controls)
    seconds, field_o, _ = context.field_along_orbit()
    fields = values["field_factor"] * field_o @ ACROSS_HO.T
    n, radius = context.mean_motion_rad_s, context.radius_m
    effects = effects_of(controls, fields)
    limits = np.maximum(controls[:, own.UPPER], -controls[:, own.LOWER])
    sizes = np.sqrt(((np.abs(effects) @ limits) ** 2).mean(axis=0))
    if not sizes.max() > 0.0:
        raise InputError(f'the law "{law}" has no control left that does anything: all are failed or limited to zero.')
    values["place_h_m"] = _place(law, values, controls, effects, mass, moments, n, radius, sizes)
    head = _head(values, controls, mass, moments, n, radius, sizes, len(context.conductors), len(context.thrusters))
    return Known(
        values=values,
        head=head,
        names=names,
        fields_h=fields,
        step_s=float(seconds[1] - seconds[0]) if len(seconds) > 1 else 1.0,
        motion=motion_matrix(n, radius, moments),
        pushes=input_matrix(mass, moments, np.eye(6)),
        inputs=input_matrix(mass, moments, effects),
        limits=limits,
        mean_motion=n,
        radius=radius,
        load_sizes=sizes,
    )


def _refuse_one_direction(values, conductors, controls: np.ndarray) -> None:
    """InputError where all that works for a place are conductors of one direction, which nothing then pushes along."""
    works = controls[:, own.UPPER] > controls[:, own.LOWER]
    jets = works & (controls[:, own.IS_THRUSTER] > 0.5)
    wires = [one for one, runs in zip(conductors, works[: len(conductors)], strict=True) if runs]
    if values["hold"] == "all" and wires and not jets.any():
        refuse_parallel(wires)


def effects_of(controls: np.ndarray, fields_h: np.ndarray) -> np.ndarray:
    """(N, 6, m) loads of each control in fields_h (N, 3) [T], the body along axes h."""
    wires, points = controls[:, own.WIRE : own.WIRE + 3], controls[:, own.POINT : own.POINT + 3]
    effects = conductor_map(wires, points, fields_h)
    jets = controls[:, own.IS_THRUSTER] > 0.5
    effects[:, :, jets] = np.concatenate([wires[jets], np.cross(points[jets], wires[jets])], axis=1).T
    return effects


def _place(law, values, controls, effects, mass, moments, n, radius, sizes) -> np.ndarray:
    """The place that is to be held, or the nearest to it that the limits allow; see `reachable`."""
    place = np.asarray(values["place_h_m"], dtype=float)
    if values["hold"] == "attitude" or values["unreachable"] == "fly" or not place.any():
        return place
    error = float(linearisation_error(radius, place))
    if error > MOST_LINEAR:
        away = 1e-3 * float(np.linalg.norm(place))
        most, near = 100.0 * MOST_LINEAR, away * MOST_LINEAR / error
        raise InputError(
            f'place_h_m of the law "{law}" is {away:.4g} km from the target, where the linear motion that it reckons with is '
            f"wrong by {100.0 * error:.2g} % of gravity's gradient; {most:g} % is at {near:.3g} km on the way there. Come "
            'nearer, or set unreachable = "fly".'
        )
    weights = 1.0 / np.maximum(sizes, 1e-6 * sizes.max())
    held = nearest_held(place, effects, controls, mass, moments, n, radius, weights)
    if held >= 1.0 - 1e-6:
        return place
    if values["unreachable"] == "nearest":
        return held * place
    asked, near = (", ".join(f"{x:.4g}" for x in one) for one in (place, held * place))
    raise InputError(
        f'place_h_m of the law "{law}": ({asked}) m cannot be held within the limits of the controls for nine tenths of the '
        f"day; the nearest on the way to it that can is ({near}) m. Hold that, a place along the orbit (which needs no force), "
        'raise the limits, lengthen the conductors, or set unreachable = "nearest" or "fly".'
    )


def _head(values, controls, mass, moments, n, radius, sizes, conductors: int, thrusters: int) -> np.ndarray:
    """The row of `onboard_vehicle`."""
    target = float(values["hold"] == "all")
    place = np.asarray(values["place_h_m"], dtype=float)
    start = place if values["from_h_m"] is None else np.asarray(values["from_h_m"], dtype=float)
    distance = float(np.linalg.norm(place - start))
    closing, length = values["closing_rate_m_s"], values["move_s"]
    if closing > 0.0 and not (distance > 0.0 and length > 0.0):
        raise InputError("closing_rate_m_s has a meaning for a way with from_h_m and move_s alone; give both, or leave it out.")
    k = closing * length / distance if closing > 0.0 else 0.0
    if k > 2.5:
        raise InputError(
            f"closing_rate_m_s: {closing:g} m/s after {length:g} s over {distance:g} m would need a run-up backwards; at most "
            f"{2.5 * distance / length:.3g} m/s, or a shorter move_s."
        )
    weights = 1.0 / np.maximum(sizes, 1e-6 * sizes.max())
    weights[3:] *= ATTITUDE_FIRST
    weights = weights / weights.max()
    if target == 0.0:
        weights[:3] = QUIET * weights[3:].max() * np.median(sizes[3:]) / max(np.median(sizes[:3]), 1e-300)
    head = np.zeros(own.TABLE)
    head[own.CONTROLS], head[own.CONDUCTORS], head[own.THRUSTERS] = len(controls), conductors, thrusters
    head[own.MEAN_MOTION], head[own.RADIUS], head[own.FACTOR] = n, radius, values["field_factor"]
    head[own.BY_READING], head[own.TARGET] = float(values["field"] == "magnetometer"), target
    head[own.REACH : own.REACH + 3] = LIMITLESS
    head[own.SETTLE], head[own.FILTER] = values["disturbance_s"], values["filter_s"]
    head[own.ANGLES : own.ANGLES + 3] = np.radians(values["angles_deg"])
    head[own.WEIGHT : own.WEIGHT + 6], head[own.SHARE] = weights, COST
    head[own.POWER_MAX] = values["power_max_w"] or LIMITLESS
    head[own.MASS : own.MASS + 3], head[own.MASS + 3 : own.MASS + 6] = mass, moments
    head[own.PATH : own.MOTION] = [*start, *place, values["move_begins_s"], length, k]
    head[own.MOTION : own.TABLE] = own.motion_rows(n, radius, moments).ravel()
    return np.concatenate([head, controls.ravel()])


def state_weights(known: Known) -> np.ndarray:
    """(12,) diagonal of Q by Bryson's rule."""
    values, n = known.values, known.mean_motion
    response = 1.0 / (3.0 * n) if values["response_s"] is None else values["response_s"]
    size = np.repeat([values["position_m"], np.radians(values["angle_deg"])], 6) * np.tile([1.0, 1.0 / response], 6)
    if values["hold"] == "attitude":
        size[:6] *= 1e6
    return 1.0 / size**2


def scale_of(known: Known) -> np.ndarray:
    """(12,) sizes of the states for the numbers' sake."""
    return orbital_scale(known.mean_motion)
