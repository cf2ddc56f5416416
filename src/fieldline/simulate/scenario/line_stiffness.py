"""Whether a fixed step of rk4 can hold a line's stiffness: its fastest oscillation along it, and what its damping adds.

    w^2 the largest eigenvalue of M^-1 K,  M = diag(m_A, m_1, ..., m_N, m_B),  K of the springs k_j = (E A / l0)_j      (1)
    step <= 2.77 / max(w, tau w^2),   tau = c / E A                                                               (2)

m_A, m_B: the bodies with half of the segments next to them, as if pulled at their centres of mass; a reel's segment is
taken as short as it becomes beside a node. For N equal segments w comes near 2 (N/L) sqrt(E A / mu). (2): the classical
rule is stable to 2.83 on the imaginary axis and to 2.785 on the negative one, and further between: where w and the damping
are of one size, half as long a step again would hold.
"""

from __future__ import annotations

import numpy as np

from fieldline.dynamics.lines.feed import VANISH
from fieldline.simulate.scenario.coarseness import longest_step_s

STABLE = 2.77


def fastest_along(scenario, k: int) -> tuple[float, float]:
    """(w [rad/s], the longest step that rk4 holds [s]) of line k."""
    from scipy.linalg import eigh_tridiagonal

    from fieldline.simulate.assembly.lines import strand_of

    line = scenario.line[k]
    strand = strand_of(line.model_copy(update={"reel": None, "rest_length_m": line.whole_length_m}))
    rest = strand.rest.copy()
    if line.reel is not None and line.nodes > 0:
        rest[-1] *= VANISH
    spring, mass = strand.stiffness / rest, strand.linear_mass * rest
    ends = [scenario.body[scenario.index_of(name)].mass_kg for name in (line.from_body, line.to_body)]
    masses = np.array([ends[0], *np.zeros(line.nodes), ends[1]])
    masses[:-1] += 0.5 * mass
    masses[1:] += 0.5 * mass
    diagonal = (np.append(spring, 0.0) + np.append(0.0, spring)) / masses
    beside = -spring / np.sqrt(masses[:-1] * masses[1:])
    last = len(masses) - 1
    squared = float(eigh_tridiagonal(diagonal, beside, eigvals_only=True, select="i", select_range=(last, last))[0])
    lag = max(_lag(line, part) for part in (line, *line.stretch))
    rate = float(np.sqrt(squared))
    return rate, STABLE / max(rate, lag * squared)


def _lag(line, part) -> float:
    """Tau [s] of a part of a line."""
    damping = line.damping_n_s if part.damping_n_s is None else part.damping_n_s
    return damping / (part.stiffness_n or line.stiffness_n)


def too_stiff(scenario, k: int) -> str | None:
    """Why the step cannot hold line k, with the step and the method that would; None where it can."""
    if scenario.integrator.method != "rk4":
        return None
    step = min(longest_step_s(scenario), scenario.time.output_step_s)
    rate, most = fastest_along(scenario, k)
    if step <= most:
        return None
    return (
        f"is too stiff for rk4 at {step:g} s: it oscillates along itself at up to {rate:.3g} rad/s, damping included the step "
        f'may be {most:.2g} s. Use step_s = {0.9 * most:.1g}, or method = "rosenbrock", whose step the stiffness does not bind'
    )
