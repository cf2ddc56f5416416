"""The gain of a plan while no limit is active: what `tracking-predictive` then is, and by which its loop is judged.

    K_k = (R + B_k' P_k+1 B_k)^-1 B_k' P_k+1 A,   P_k = Q + A' P_k+1 (A - B_k K_k),   P_N = P          (1)

K_0 is what a plan of N stages from now gives: u = u_r - K_0(t) e, linear, changing with the field as time goes on. So the
loop of the law within its limits has multipliers like that of any gain.

Source: Rawlings, Mayne and Diehl (2017), Model Predictive Control, 2nd ed., s. 1.3.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np


def plan_gains(A: np.ndarray, inputs_of: Callable[[int], np.ndarray], Q, R, P, stages: int) -> np.ndarray:
    """(N, m, n) first gains K_0 of (1) from N instants; inputs_of(k) (N, n, m): B of the stage k ahead of each instant.

    A (n, n) over a stage, Q (n,) and R (m,) diagonals of a stage's cost, P (n, n) of the cost after the last.
    """
    ahead, gains = np.asarray(P, dtype=float), np.empty(0)
    for k in reversed(range(stages)):
        B = inputs_of(k)
        back = np.swapaxes(B, 1, 2) @ ahead
        gains = np.linalg.solve(np.diag(R) + back @ B, back @ A)
        ahead = np.diag(Q) + A.T @ ahead @ (A - B @ gains)
        ahead = 0.5 * (ahead + np.swapaxes(ahead, 1, 2))
    return gains
