"""Three axes by the field alone, proportional and rate terms projected across it.

    T = -J (w_n^2 theta + 2 z w_n w),   M = B x T / B^2                                            (35)

gives the torque T less its part along B. It converges for gains that are small against the field's turning, because only
then the missing part averages out over the orbit: w_n not given is half the mean motion n. The satellite's own gravity
gradient must hold it, or be weak against J w_n^2.

Sources: Wisniewski and Blanke (1999), Automatica 35(7):1201; Lovera and Astolfi (2004), Automatica 40(8):1405.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from fieldline.control import residual_dipole, target
from fieldline.control.law import Law, Parameter, complete
from fieldline.control.readings import field_known, lifted, wheel_momentum_b
from fieldline.control.residual_dipole import cancelling_moment, packed_filter, packed_wheels, residual_estimate
from fieldline.control.saturation import as_command, shortened
from fieldline.control.target import packed_target, pointing_error
from fieldline.frames.vectors import add, cross, dot, scale

STIFFNESS = target.SIZE
RATE_GAIN = STIFFNESS + 9
MOMENT_MAX = RATE_GAIN + 9
FILTER = MOMENT_MAX + 3
WHEELS = FILTER + residual_dipole.SIZE
MEMORY = residual_dipole.MEMORY


@njit(cache=True)
def _times(params, first, v):
    """A 3 x 3 matrix of the params times a vector."""
    p = params[first : first + 9]
    return (
        p[0] * v[0] + p[1] * v[1] + p[2] * v[2],
        p[3] * v[0] + p[4] * v[1] + p[5] * v[2],
        p[6] * v[0] + p[7] * v[1] + p[8] * v[2],
    )


@njit(cache=True)
def magnetic_pd(t, measurement, memory, params):
    """Moment (35), and what cancels residual dipole and torque if they are estimated.

    Where field, attitude or rate is not known, only the residual dipole as last estimated is cancelled.
    """
    momentum_b = wheel_momentum_b(measurement, params, WHEELS)
    dipole, own_torque = residual_estimate(t, measurement, momentum_b, memory, 0, params, FILTER)
    known, theta, rate, _ = pointing_error(measurement, params, 0)
    if not (known and field_known(measurement)):
        return as_command(shortened(scale(-1.0, dipole), params, MOMENT_MAX)[0])
    pull, damp = _times(params, STIFFNESS, theta), _times(params, RATE_GAIN, rate)
    torque = (-pull[0] - damp[0], -pull[1] - damp[1], -pull[2] - damp[2])
    field = lifted(measurement.field_b)
    moment = scale(1.0 / dot(field, field), cross(field, torque))  # (35)
    moment = add(moment, cancelling_moment(field, dipole, own_torque))
    return as_command(shortened(moment, params, MOMENT_MAX)[0])


PARAMETERS = {
    **target.PARAMETERS,
    "natural_frequency_rad_s": Parameter("rad/s", "w_n; derived as half the mean motion", kind="positive", derived=True),
    "damping_ratio": Parameter("", "z", 0.7, "positive"),
    "moment_max_a_m2": Parameter("A m^2", "largest moment per axis; derived from the torquers", kind="vector", derived=True),
    **residual_dipole.CANCEL_PARAMETERS,
}


def _pack(table, context) -> np.ndarray:
    values = complete("magnetic-pd", PARAMETERS, table)
    w = values["natural_frequency_rad_s"]
    w = 0.5 * context.mean_motion_rad_s if w is None else w
    inertia = np.asarray(context.inertia_kg_m2, dtype=float).ravel()
    most = context.moment_max_a_m2 if values["moment_max_a_m2"] is None else values["moment_max_a_m2"]
    gains = (w**2 * inertia, 2.0 * values["damping_ratio"] * w * inertia)
    pieces = (*gains, most, packed_filter(values, context, values["cancel_residual"]), packed_wheels(context))
    return np.concatenate([packed_target(values), *pieces])


LAWS = (
    Law("magnetic-pd", magnetic_pd, PARAMETERS, MEMORY, ("dipole",), "holds three axes by the field alone, projected PD", _pack),
)
