"""Estimators of the library that a scenario may name, as laws are named: what they take, and how they are made.

    [[software]]
    law = "magnetometer-attitude"
    role = "estimator"
    rate_hz = 0.5

An estimator is called as (t, measurement, memory, params) like a law, keeps what it knows to itself, and returns q_bi and
omega_bi_b, or None while it knows nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from fieldline.control import DesignContext, Parameter
from fieldline.control.law import complete
from fieldline.errors import InputError


@dataclass(frozen=True)
class Estimator:
    """One estimator of the registry; `make(table, context)` gives the callable of one run."""

    name: str
    parameters: dict[str, Parameter]
    doc: str
    make: Callable[[Mapping, DesignContext], Callable]
    commands: tuple[str, ...] = ()


MAGNETOMETER_PARAMETERS = {
    "inertia_kg_m2": Parameter(
        "kg m^2", "principal moments as known on board; derived as the body's own tensor", kind="vector", derived=True
    ),
    "window_s": Parameter("s", "time over which readings are gathered before attitude is looked for", 2400.0, "positive"),
    "step_s": Parameter("s", "between the readings of that search", 10.0, "positive"),
    "retry_s": Parameter("s", "until the search is tried again", 300.0, "positive"),
    "revise_s": Parameter("s", "between two revisions of residual dipole and constant torque", 5400.0, "positive"),
    "rate_max_deg_s": Parameter("deg/s", "no search while the field turns faster in body axes", 1.0, "positive"),
    "std_max_deg": Parameter("deg", "no attitude is told that is less certain, 1 sigma of all axes", 10.0, "positive"),
    "bias_std_nt": Parameter("nT", "how large the magnetometer's bias may be, 1 sigma per axis", 1000.0, "positive"),
    "torque_noise_n_m": Parameter(
        "N m", "torque that the motion lacks, 1 sigma per axis, changing within a minute", 3e-9, "positive"
    ),
    "duty_cycle": Parameter("", "part of the time for which a commanded dipole is in force", 1.0, "positive"),
}
TORQUE_TIME_S = 60.0


def _magnetometer_attitude(table: Mapping, context: DesignContext):
    """`fieldline.estimation.onboard.OnboardEstimator` from checked parameters."""
    from fieldline.estimation.onboard import OnboardEstimator

    values = complete("magnetometer-attitude", MAGNETOMETER_PARAMETERS, table)
    moments = values["inertia_kg_m2"]
    inertia = np.asarray(context.inertia_kg_m2, dtype=float) if moments is None else np.diag(moments)
    least = float(np.linalg.eigvalsh(inertia)[0])
    if least <= 0.0:
        raise InputError(f'inertia_kg_m2 of the law "magnetometer-attitude" must be positive; got {list(moments)}.')
    return OnboardEstimator(
        inertia,
        window_s=values["window_s"],
        step_s=max(values["step_s"], context.period_s),
        retry_s=values["retry_s"],
        revise_s=values["revise_s"],
        rate_max_deg_s=values["rate_max_deg_s"],
        std_max_deg=values["std_max_deg"],
        bias_std_tesla=1e-9 * values["bias_std_nt"],
        duty_cycle=values["duty_cycle"],
        rate_noise_rad_s_sqrt_s=values["torque_noise_n_m"] / least * float(np.sqrt(TORQUE_TIME_S)),
    )


ESTIMATORS: dict[str, Estimator] = {
    one.name: one
    for one in (
        Estimator(
            "magnetometer-attitude",
            MAGNETOMETER_PARAMETERS,
            "attitude and rate from magnetometer and orbit alone, nothing known at the start",
            _magnetometer_attitude,
        ),
    )
}
