"""Pointing by wheels, alone or with their momentum drawn out through the field.

    T = -J (w_n^2 theta + 2 z w_n w) + omega x (J omega + H) + J a                                 (34)

is the torque of the wheels on the body: proportional and rate terms of (26) and (27), the gyroscopic torque of body and
wheels taken ahead, and the goal's own change of rate in body axes, a = -w x omega_t. Closed, theta obeys
theta'' + 2 z w_n theta' + w_n^2 theta = 0 for small angles, axis by axis.

With desaturation the coils' moment is (11), less the residual dipole if it is estimated, shortened to what the torquers can
give; its torque M x B is taken ahead: T of (34) less M x B, so that dumping does not disturb the pointing.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from fieldline.control import momentum, residual_dipole, target
from fieldline.control.law import Law, Parameter, complete
from fieldline.control.momentum import dump, packed_dump
from fieldline.control.readings import field_known, finite3, lifted, wheel_momentum_b
from fieldline.control.residual_dipole import packed_filter, packed_wheels, residual_estimate
from fieldline.control.saturation import as_command, shortened
from fieldline.control.target import packed_target, pointing_error
from fieldline.frames.matrices import matvec
from fieldline.frames.vectors import add, axpy, cross, scale, sub

FREQUENCY = target.SIZE
DAMPING = FREQUENCY + 1
INERTIA = DAMPING + 1
POINTING_SIZE = INERTIA + 9
DUMP = POINTING_SIZE
MOMENT_MAX = DUMP + momentum.DUMP_SIZE
FILTER = MOMENT_MAX + 3
FILTER_MEMORY = momentum.MEMORY
ZERO = (0.0, 0.0, 0.0)


@njit(cache=True)
def pointing_torque(measurement, momentum_b, params):
    """Torque (34) [N m]; zero where attitude or rate is not known."""
    known, theta, rate, goal_rate = pointing_error(measurement, params, 0)
    if not (known and finite3(momentum_b)):
        return ZERO
    p = INERTIA
    inertia = (
        params[p],
        params[p + 1],
        params[p + 2],
        params[p + 3],
        params[p + 4],
        params[p + 5],
        params[p + 6],
        params[p + 7],
        params[p + 8],
    )
    w = params[FREQUENCY]
    wish = axpy(-w * w, theta, scale(-2.0 * params[DAMPING] * w, rate))
    wish = sub(wish, cross(rate, goal_rate))
    omega = lifted(measurement.omega_bi_b)
    return add(matvec(inertia, wish), cross(omega, add(matvec(inertia, omega), momentum_b)))  # (34)


@njit(cache=True)
def wheel_pointing(t, measurement, memory, params):
    """Wheels alone: equation (34)."""
    torque = pointing_torque(measurement, wheel_momentum_b(measurement, params, POINTING_SIZE), params)
    return as_command(torque)


@njit(cache=True)
def wheel_pointing_with_desaturation(t, measurement, memory, params):
    """Dipole and wheel torque."""
    momentum_b = wheel_momentum_b(measurement, params, FILTER + residual_dipole.SIZE)
    torque = pointing_torque(measurement, momentum_b, params)
    dipole, own_torque = residual_estimate(t, measurement, momentum_b, memory, FILTER_MEMORY, params, FILTER)
    dumping = dump(measurement, momentum_b, memory, 0, params, DUMP)
    moment, _ = shortened(sub(dumping, dipole), params, MOMENT_MAX)
    if field_known(measurement):
        torque = sub(torque, cross(add(moment, dipole), lifted(measurement.field_b)))
    torque = sub(torque, own_torque)
    command = np.empty(6)
    for j in range(3):
        command[j] = moment[j]
        command[3 + j] = torque[j]
    return command


PARAMETERS = {
    **target.PARAMETERS,
    "natural_frequency_rad_s": Parameter("rad/s", "undamped frequency w_n of each axis", 0.05, "positive"),
    "damping_ratio": Parameter("", "damping ratio z of each axis", 0.7, "positive"),
}
DESATURATION_PARAMETERS = {**PARAMETERS, **momentum.PARAMETERS, **residual_dipole.CANCEL_PARAMETERS}


def _packed_pointing(values: dict, context) -> np.ndarray:
    inertia = np.asarray(context.inertia_kg_m2, dtype=float)
    return np.array([*packed_target(values), values["natural_frequency_rad_s"], values["damping_ratio"], *inertia.ravel()])


def _pack(table, context) -> np.ndarray:
    values = complete("wheel-pointing", PARAMETERS, table)
    return np.concatenate([_packed_pointing(values, context), packed_wheels(context)])


def _pack_desaturation(table, context) -> np.ndarray:
    law = "wheel-pointing-with-desaturation"
    values = complete(law, DESATURATION_PARAMETERS, table)
    filter_numbers = packed_filter(values, context, values["cancel_residual"])
    dumping = (packed_dump(law, values, context), np.asarray(context.moment_max_a_m2, dtype=float))
    return np.concatenate([_packed_pointing(values, context), *dumping, filter_numbers, packed_wheels(context)])


LAWS = (
    Law("wheel-pointing", wheel_pointing, PARAMETERS, 1, ("wheel_torque",), "holds an attitude by wheels", _pack),
    Law(
        "wheel-pointing-with-desaturation",
        wheel_pointing_with_desaturation,
        DESATURATION_PARAMETERS,
        momentum.MEMORY + residual_dipole.MEMORY,
        ("dipole", "wheel_torque"),
        "holds an attitude by wheels and draws their momentum out through the field",
        _pack_desaturation,
    ),
)
