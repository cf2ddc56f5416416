"""The currents that hold a vehicle still, and how far a limit on them reaches.

    G u = -F x,   H x = r,   rates zero                                                             (1)

Two answers: the u of least norm, as a pseudo-inverse or a quadratic regulator shares the work, and the largest share of r
that any u within its limits can hold (a linear programme). Limits are per control; infinite where there is none.
"""

from __future__ import annotations

import numpy as np

from fieldline.errors import InputError, NoEstimateError

MISSED = 1e-9  # part of the loads that may be left over where a plant is said to hold


def needed_loads(F, H, reference) -> np.ndarray:
    """(n,) -F x of the state (n,) that shows the reference (p,) and is still."""
    return -F @ (np.asarray(H).T @ np.asarray(reference, dtype=float))


def holding_controls(F, G, H, reference) -> np.ndarray:
    """(m,) controls of least norm that hold the reference (p,); NoEstimateError where the plant cannot, with what is missed."""
    loads = needed_loads(F, H, reference)
    rows = np.abs(G).max(axis=1)
    rows = np.where(rows > 0.0, rows, 1.0)[:, None]
    u = np.linalg.pinv(G / rows, rcond=1e-12) @ (loads / rows[:, 0])
    missed = np.abs((G @ u - loads) / rows[:, 0])
    if missed.max() > MISSED * max(np.abs(loads / rows[:, 0]).max(), 1e-300):
        raise NoEstimateError(
            "no currents hold this place and attitude: a part of the force that they must give lies along the field, where "
            "conductors cannot push. Add a thruster across the orbit's plane, or hold a place whose force is across the field."
        )
    return u


def held_share(controls, limits) -> float:
    """The largest share of a held reference at which `controls` (m,), in proportion, stay within limits (m,); at most 1."""
    controls, limits = np.abs(np.asarray(controls, dtype=float)), np.asarray(limits, dtype=float)
    used = controls > 0.0
    return float(min(1.0, np.min(limits[used] / controls[used]))) if used.any() else 1.0


def most_held_share(F, G, H, reference, limits) -> tuple[float, np.ndarray]:
    """(largest share of the reference that controls within limits (m,) can hold, those controls); at most 1."""
    from scipy.optimize import linprog

    limits = np.asarray(limits, dtype=float)
    if not (limits > 0.0).all():
        raise InputError(f"limits must be positive; got {limits.min():g} as the smallest.")
    loads = needed_loads(F, H, reference)
    rows = np.abs(G).max(axis=1)
    kept = rows > 0.0
    balance = np.column_stack([G[kept] / rows[kept, None], -loads[kept] / rows[kept]])
    size = max(np.abs(balance[:, -1]).max(), 1e-300)
    column = np.ones(balance.shape[1])
    column[-1] = 1.0 / size  # the share in units that are of the size of a current
    bounds = [(-limit if np.isfinite(limit) else None, limit if np.isfinite(limit) else None) for limit in limits] + [(0.0, size)]
    cost = np.zeros(balance.shape[1])
    cost[-1] = -1.0
    found = linprog(cost, A_eq=balance * column, b_eq=np.zeros(kept.sum()), bounds=bounds, method="highs")
    if not found.success:
        raise NoEstimateError(f"the largest hold was not found: {found.message}")
    return max(0.0, float(found.x[-1] / size)), found.x[:-1]


def refuse_unreachable(share: float, reference, limits_words: str) -> None:
    """InputError where less than the whole reference is held, with the nearest along the way to it that is."""
    if share < 1.0 - 1e-9:
        nearest = ", ".join(f"{part:.4g}" for part in share * np.asarray(reference, dtype=float)[:3])
        asked = ", ".join(f"{part:.4g}" for part in np.asarray(reference, dtype=float)[:3])
        raise InputError(
            f"({asked}) m cannot be held within {limits_words}: the nearest on the way to it that can is ({nearest}) m. "
            "Raise the limit, lengthen the conductors, or hold a place along the orbit, which needs no force."
        )
