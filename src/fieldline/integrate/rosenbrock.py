"""ROS34PW2, a linearly implicit method of order 3 that keeps its order whatever matrix stands for the Jacobian.

With alpha, Gamma (lower, the diagonal gamma), b of the method and any matrix A (a W-method),

    k_i = h f(t + c_i h, z + sum_j alpha_ij k_j) + h A sum_(j<=i) Gamma_ij k_j,    z1 = z + sum_j b_j k_j     (1)

which in U = Gamma k needs no product with A,

    (1/(h gamma) - A) U_i = f(t + c_i h, z + sum_j a_ij U_j) + sum_j (c_ij / h) U_j,    z1 = z + sum_j m_j U_j  (2)
    a = alpha Gamma^-1,    c = 1/gamma - Gamma^-1,    m = b Gamma^-1                                        (3)

One matrix serves all four stages. With A = df/dz the method is L-stable and its last stage is the step's end (stiffly
accurate); the closer A is to that for what is stiff, the longer the step. What A leaves out is taken as an explicit method
takes it. The second weights give order 2 with any A, and the error of a step e = sum_j (m - m^)_j U_j.

Source: J. Rang and L. Angermann (2005), New Rosenbrock W-methods of order 3 for partial differential algebraic equations
of index 1, BIT 45:761; the numbers fulfil its conditions for order 3 with any A to rounding (tested).
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np
from numba import njit

GAMMA = 0.4358665215084590
ALPHA = (
    (0.0, 0.0, 0.0, 0.0),
    (0.8717330430169180, 0.0, 0.0, 0.0),
    (0.8445706001536942, -0.1129906423648419, 0.0, 0.0),
    (0.0, 0.0, 1.0, 0.0),
)
LOWER = (
    (GAMMA, 0.0, 0.0, 0.0),
    (-0.8717330430169180, GAMMA, 0.0, 0.0),
    (-0.9033805701304408, 0.05418067238809533, GAMMA, 0.0),
    (0.2421238070609535, -1.223250583904515, 0.5452602553351021, GAMMA),
)
WEIGHTS = (0.2421238070609535, -1.223250583904515, 1.5452602553351021, GAMMA)
SECOND_WEIGHTS = (0.3781090314581937, -0.09604229221242318, 0.5, 0.5 * GAMMA)


class Rosenbrock(NamedTuple):
    """A method in the form (2); float64 arrays."""

    gamma: float
    a: np.ndarray  # (s, s) strictly lower
    c: np.ndarray  # (s, s) strictly lower
    m: np.ndarray  # (s,)
    error: np.ndarray  # (s,) weights of the error of a step
    nodes: np.ndarray  # (s,) c_i, the stages' times
    order: int  # of the error of a step in its length, less one: what `next_step` takes


def _ros34pw2() -> Rosenbrock:
    """The method, by equation (3)."""
    alpha, inverse = np.array(ALPHA), np.linalg.inv(LOWER)
    return Rosenbrock(
        gamma=GAMMA,
        a=np.tril(alpha @ inverse, -1),
        c=np.tril(-inverse, -1),
        m=np.array(WEIGHTS) @ inverse,
        error=(np.array(WEIGHTS) - np.array(SECOND_WEIGHTS)) @ inverse,
        nodes=alpha.sum(axis=1),
        order=3,
    )


ROS34PW2 = _ros34pw2()


def amplification(z) -> np.ndarray:
    """R(z): by what a step multiplies the solution of z' = lambda z with A = lambda, z = h lambda complex, (...,).

        R(z) = 1 + z b^T (E - z (alpha + Gamma))^-1 1

    1 - |R(i w h)| is the part of an undamped oscillation of the rate w that a step takes away.
    """
    z = np.asarray(z, dtype=complex)
    both = np.array(ALPHA) + np.array(LOWER)
    stages = np.linalg.solve(np.eye(4) - z[..., None, None] * both, np.ones((*z.shape, 4, 1)))[..., 0]
    return 1.0 + z * (stages @ np.array(WEIGHTS))


@njit(cache=True)
def sum_stages(z, stages, weights, count, out):
    """z + sum_j w_j U_j over the first `count` rows, into out; the step's length is in the rows."""
    for i in range(z.size):
        out[i] = z[i]
    for j in range(count):
        w = weights[j]
        if w != 0.0:
            for i in range(z.size):
                out[i] += w * stages[j, i]


@njit(cache=True)
def stage_error(stages, weights, scale):
    """Error of a step over what is allowed, root mean square over the components; NaN where the step went wrong."""
    total = 0.0
    for i in range(scale.size):
        error = 0.0
        for j in range(weights.size):
            error += weights[j] * stages[j, i]
        total += (error / scale[i]) ** 2
    return sqrt(total / scale.size)
