"""The error of a step that a scenario's lines can bear, where none is given.

    T = 3 n^2 l0 m1 m2 / (m1 + m2),   allowed = min(1e-4 m, PART T (l / E A)_min), but FINEST_M at least              (1)

n: rate of the orbit at the start; l0: the line's unstretched length, all of it out; m1, m2: the bodies at its ends, each with
half a segment; l, E A of its segments. A stiff line under little tension is stretched by micrometres: errors that are not small
against that make it bounce between slack and taut. The distance from the Earth's centre enters the error of a step by
`relative_tolerance`: it is made as small as (1) asks, as far as double precision, FINEST, bears.
"""

from __future__ import annotations

import numpy as np

USUAL = {"dop853": (1e-9, 1e-3), "rosenbrock": (1e-12, 1e-4), "rk4": (1e-9, 1e-3)}  # over the state [-], in position [m]
PART = 0.01
FINEST, FINEST_M = 1e-14, 1e-7
DISTANCE_M = 7e6


def allowed(scenario) -> tuple[float, float]:
    """Errors of a step over the state [-] and in position [m]: those given, or the method's, with "rosenbrock" those of (1)."""
    integrator = scenario.integrator
    relative, position = USUAL[integrator.method]
    if integrator.method == "rosenbrock" and integrator.position_tolerance_m is None:
        position = min(position, bearable(scenario))
        relative = max(FINEST, min(relative, position / DISTANCE_M))
    return integrator.relative_tolerance or relative, integrator.position_tolerance_m or position


def bearable(scenario) -> float:
    """Error in position [m] of (1), of the line that bears least; without lines the usual."""
    if not scenario.line:
        return USUAL["rosenbrock"][1]
    from fieldline.simulate.scenario.states import period_s, start_states

    rate = 2.0 * np.pi / period_s(*start_states(scenario)[0])
    return max(FINEST_M, PART * min(least_stretch(scenario, line, rate) for line in scenario.line))


def least_stretch(scenario, line, rate: float) -> float:
    """What the stiffest segment of a line is stretched by [m], hanging at rest at an orbital rate [rad/s]."""
    from fieldline.simulate.assembly.lines import strand_of

    strand = strand_of(line.model_copy(update={"reel": None, "rest_length_m": line.whole_length_m}))
    return rest_pull(scenario, line, strand, rate) * float((strand.rest / strand.stiffness).min())


def rest_pull(scenario, line, strand, rate: float) -> float:
    """T of (1) [N] of a strand of a line between its bodies."""
    segments = strand.linear_mass * strand.rest
    ends = [scenario.body[scenario.index_of(name)].mass_kg for name in (line.from_body, line.to_body)]
    masses = np.add(ends, 0.5 * segments[[0, -1]])
    return 3.0 * rate**2 * float(strand.rest.sum()) * float(masses[0] * masses[1] / masses.sum())
