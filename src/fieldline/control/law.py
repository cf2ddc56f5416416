"""What a law is: a kernel, the parameters that a person may set, the room its memory takes, the commands it gives.

A law's kernel is a pure function `(t, measurement, memory, params)` of the time [s] since the run's start, what is
measured, the law's own memory (a float array, zeros at the start, changed in place) and its packed parameters. It returns
one float array: the command's groups, always in the order `COMMANDS`,

    dipole        3   wanted magnetic moment, body axes [A m^2]
    wheel_torque  3   wanted torque of the wheels on the body, body axes [N m]
    thrust        n   of each thruster, 0 to 1
    current       n   of each conductor of the body, then of each circuit of a line that ends (to_body) on it [A]
    reel          n   of each reel on the body: rate [m/s] or tension [N]
    attachment    n   of each sliding attachment on the body: place along its axis [m]

`pack` turns a person's table of parameters into the float array: it refuses what is unknown, misplaced or senseless, and
derives the gains that were not given.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from fieldline.errors import InputError, nearest, shown

COMMANDS = ("dipole", "wheel_torque", "thrust", "current", "reel", "attachment")


@dataclass(frozen=True)
class Parameter:
    """One number, vector, switch or word that a person may set.

    `kind`: "number", "positive", "not negative", "vector" (3 numbers), "quaternion" (4), "switch", "choice" or "names" (a
    list of words).
    `default` None: required, or where `derived` worked out from the spacecraft and its orbit; `doc` says how.
    """

    unit: str
    doc: str
    default: object | None = None
    kind: str = "number"
    derived: bool = False
    choices: tuple[str, ...] = ()


@dataclass(frozen=True)
class LineEnd:
    """End of a line on the body: attachment [m], mode of a reel there ("" for none), directions in which it slides.

    shortest_m, longest_m: unstretched length that the reel can leave out [m]; lag_s: time constant of its rate.
    """

    point_b_m: tuple[float, float, float]
    reel: str = ""
    slider_axes_b: tuple[tuple[float, float, float], ...] = ()
    shortest_m: float = 0.0
    longest_m: float = 1e300
    lag_s: float = 0.0


@dataclass(frozen=True)
class DesignContext:
    """What a gain may be derived from: the spacecraft, its orbit and the nominal field along it.

    inertia_kg_m2 (3, 3); mean_motion_rad_s; inclination_rad; period_s between two calls of the law; moment_max_a_m2 (3,)
    of the torquers about the body axes; wheel_axes_b (n, 3) unit vectors; field_along_orbit() gives seconds (n,) and the
    on-board model's field [T] in orbital and in inertial axes, (n, 3) each, over one orbit or more; mass_kg, conductors and
    thrusters (records) of the body, radius_m of its orbit; lines that are attached to it, in the order of the measurement.
    """

    inertia_kg_m2: np.ndarray
    mean_motion_rad_s: float
    inclination_rad: float
    period_s: float
    moment_max_a_m2: np.ndarray
    wheel_axes_b: np.ndarray
    field_along_orbit: Callable[[], tuple[np.ndarray, np.ndarray, np.ndarray]]
    mass_kg: float = np.nan
    radius_m: float = np.nan
    conductors: tuple = ()
    thrusters: tuple = ()
    lines: tuple[LineEnd, ...] = ()


@dataclass(frozen=True)
class Law:
    """One law of the registry: see the module's text."""

    name: str
    kernel: Callable
    parameters: dict[str, Parameter]
    memory: int
    commands: tuple[str, ...]
    doc: str
    pack: Callable[[Mapping, DesignContext], np.ndarray]
    reference: bool = False  # whether it reads measurement.field_i, which costs a field model at every call
    optional: tuple[str, ...] = ()  # of its commands: those that a body need not have the actuators for


def complete(law: str, parameters: Mapping[str, Parameter], table: Mapping) -> dict:
    """Checked values of every parameter: floats, arrays, booleans, words; None where one is to be derived.

    Errors: `InputError` for a key that the law has not, a required one that is missing, or a value of the wrong kind.
    """
    for key in table:
        if key not in parameters:
            raise InputError(f'the law "{law}" has no parameter "{shown(str(key))}"; {nearest(str(key), parameters)}')
    values = {}
    for key, parameter in parameters.items():
        given = table.get(key, parameter.default)
        if given is None and not parameter.derived:
            raise InputError(f'the law "{law}" needs {key} [{parameter.unit}]: {parameter.doc}.')
        values[key] = None if given is None else _checked(law, key, parameter, given)
    return values


def _checked(law: str, key: str, parameter: Parameter, given):
    """One value as its kind demands it."""
    where = f'{key} of the law "{law}"'
    if parameter.kind == "switch":
        if not isinstance(given, (bool, np.bool_)):
            raise InputError(f"{where} is a switch, true or false; got {shown(repr(given))}.")
        return bool(given)
    if parameter.kind == "choice":
        if given not in parameter.choices:
            hint = nearest(str(given), parameter.choices)
            raise InputError(f'{where} is one of {", ".join(parameter.choices)}; got "{shown(str(given))}"; {hint}')
        return given
    if parameter.kind == "names":
        if not isinstance(given, list | tuple) or not all(isinstance(one, str) for one in given):
            raise InputError(f"{where} is a list of names; got {shown(repr(given))}.")
        return tuple(given)
    return _numbers(where, parameter, given)


def _numbers(where: str, parameter: Parameter, given):
    """A float, or an array of three or four, finite and of the sign that its kind demands."""
    length = {"vector": 3, "quaternion": 4}.get(parameter.kind)
    wanted = f"{length} numbers" if length else "a number"
    try:
        value = np.asarray(given, dtype=float)
    except (TypeError, ValueError):
        raise InputError(f"{where} must be {wanted} [{parameter.unit}]; got {shown(repr(given))}.") from None
    if isinstance(given, (bool, np.bool_)) or value.shape != ((length,) if length else ()) or not np.isfinite(value).all():
        raise InputError(f"{where} must be {wanted} [{parameter.unit}], finite; got {shown(repr(given))}.")
    if parameter.kind == "positive" and not value > 0.0:
        raise InputError(f"{where} must be more than zero [{parameter.unit}]; got {float(value):g}.")
    if parameter.kind == "not negative" and value < 0.0:
        raise InputError(f"{where} must not be negative [{parameter.unit}]; got {float(value):g}.")
    if parameter.kind == "quaternion":
        size = float(np.linalg.norm(value))
        if abs(size - 1.0) > 1e-3:
            raise InputError(f"{where} must be a unit quaternion, scalar last (x, y, z, w); its length is {size:g}.")
        return value / size
    return value if length else float(value)
