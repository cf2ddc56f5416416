"""The state y of the plant at the start: orbits, attitudes and rates of the bodies, wheels, rods and lines."""

from __future__ import annotations

import numpy as np

from fieldline.dynamics.loads.hysteresis import MU0, resting_induction
from fieldline.dynamics.parameters import STATE, Plant, state_size
from fieldline.dynamics.rates import field_at
from fieldline.environment.ephemeris import dcm_ei_kernel
from fieldline.frames.attitude import to_body
from fieldline.simulate.assembly.hanging import hang_bodies
from fieldline.simulate.assembly.line_start import start_lines
from fieldline.simulate.assembly.plant import each
from fieldline.simulate.scenario.attitudes import start_attitude
from fieldline.simulate.scenario.states import start_states

UNIT_QUATERNION = (0.0, 0.0, 0.0, 1.0)


def start_of(scenario, plant: Plant, seed: int) -> np.ndarray:
    """State y at the start; random attitudes and rates are drawn by the seed, each body from a stream of its own.

    A wheel's momentum is taken as its whole axial momentum, the share of the body's turn included: a part in a million
    of what a wheel at work holds. Rods start on the middle of their loop in the field that they find.
    """
    y = np.zeros(state_size(plant))
    for b, (body, place) in enumerate(zip(scenario.body, start_states(scenario), strict=True)):
        row = y[STATE * b : STATE * (b + 1)]
        row[0:3], row[3:6] = place
        row[6:10] = UNIT_QUATERNION
        if body.kind == "rigid":
            row[6:10], row[10:13] = start_attitude(body, b, seed, *place)
    base = STATE * len(scenario.body)
    for k, (_, one) in enumerate(each(scenario.body, "wheel")):
        y[base + k] = one.momentum_n_m_s
    _rods(scenario, plant, y)
    start_lines(scenario, plant, y, hang_bodies(scenario, y))
    return y


def _rods(scenario, plant: Plant, y: np.ndarray) -> None:
    """Inductions of the rods."""
    pairs = each(scenario.body, "hysteresis_rod")
    base = STATE * len(scenario.body) + len(plant.wheels.body)
    dcm_ei = dcm_ei_kernel(0.0, plant.surroundings.ephemeris)
    for k, (b, one) in enumerate(pairs):
        row = y[STATE * b : STATE * (b + 1)]
        field_b = to_body(tuple(row[6:10]), field_at(tuple(row[:3]), dcm_ei, plant.surroundings))
        along = float(np.dot(one.axis_b, field_b)) / MU0
        y[base + k] = resting_induction(along, one.saturation_tesla, one.remanence_tesla, one.coercivity_a_m)
