"""Whether a fixed step of rk4 can hold a line's stiffness: its fastest oscillation along it, and what its damping adds.

    w^2 the largest eigenvalue of M^-1 K,  M = diag(m_A, m_1, ..., m_N, m_B),  K of the springs k_j = (E A / l0)_j      (1)
    l^2 + tau u^2 l + u^2 = 0,   tau = c / E A,   0 < u <= w                                                     (2)
    |1 + z + z^2/2 + z^3/6 + z^4/24| <= 1,   z = l h                                                           (3)

m_A, m_B: the bodies with half of the segments next to them, as if pulled at their centres of mass; a reel's segment is
taken as short as it becomes beside a node. For N equal segments w comes near 2 (N/L) sqrt(E A / mu). The longest step h is
the one up to which (3) holds for both roots of (2) of every oscillation up to the fastest: 2.83 / w without damping,
2.785 / (tau w^2) with much, and up to twice these where the two are of one size.
"""

from __future__ import annotations

import numpy as np

from fieldline.dynamics.lines.feed import VANISH
from fieldline.simulate.scenario.coarseness import longest_step_s

BEYOND = 5.8  # a little more than the longest step of any damping, in 1 / w
TRIED_STEPS = 1_500  # steps and oscillations at which (3) is looked at
TRIED_RATES = 60


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
    rate = float(np.sqrt(squared))
    lags = [_lag(line, part) for part in (line, *line.stretch)]
    return rate, min(held_by_rk4(rate, lag) for lag in (min(lags), max(lags)))


def held_by_rk4(rate: float, lag_s: float) -> float:
    """Longest step [s] of the classical rule for oscillations up to a rate [rad/s] with a damping tau [s]; (2), (3).

    To a thousandth, on the safe side.
    """
    u = np.linspace(1.0 / TRIED_RATES, 1.0, TRIED_RATES)
    half = 0.5 * lag_s * rate * u  # damping ratio of each; of two real roots of (2) this is the faster
    root = u * (-half - np.sqrt(half * half - 1.0 + 0.0j))
    h = np.linspace(0.0, BEYOND / max(1.0, lag_s * rate), TRIED_STEPS)
    z = h[:, None] * root
    grows = (np.abs(1.0 + z * (1.0 + z / 2.0 * (1.0 + z / 3.0 * (1.0 + z / 4.0)))) > 1.0 + 1e-12).any(axis=1)
    return float(h[grows.argmax() - 1]) / rate


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
