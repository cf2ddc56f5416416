"""The shape of a rigid body as five free numbers, every value of which is a possible body.

    M = exp(S),  S symmetric with zero trace          M: second moments of mass, sum m x x^T, any scale  (1)
    J = tr(M) I - M                                   J: inertia                                         (2)

M is positive, so J obeys the triangle inequality of principal moments by construction; only ratios of J move a body
without torque, so the trace is free to be zero. S = 0 is a sphere.
"""

from __future__ import annotations

import numpy as np

SHAPE_STD = 0.8  # prior spread of each number: ratios of second moments within about 1 : 5

_BASIS = np.array(
    [
        [[1, 0, 0], [0, -1, 0], [0, 0, 0]],
        [[1, 0, 0], [0, 1, 0], [0, 0, -2]] / np.sqrt(3.0),
        [[0, 1, 0], [1, 0, 0], [0, 0, 0]],
        [[0, 0, 1], [0, 0, 0], [1, 0, 0]],
        [[0, 0, 0], [0, 0, 1], [0, 1, 0]],
    ],
    dtype=float,
) / np.sqrt(2.0)


def inertia_of(shape: np.ndarray) -> np.ndarray:
    """(3, 3) inertia of five shape numbers, scaled to a mean principal moment of 1; equations (1) and (2)."""
    values, vectors = np.linalg.eigh(np.einsum("k,kij->ij", shape, _BASIS))
    moments = (vectors * np.exp(values)) @ vectors.T
    inertia = np.trace(moments) * np.eye(3) - moments
    return 3.0 * inertia / np.trace(inertia)


def shape_of(inertia: np.ndarray) -> np.ndarray:
    """Five shape numbers of a (3, 3) inertia; the inverse of `inertia_of` but for the scale."""
    inertia = np.asarray(inertia, dtype=float)
    moments = 0.5 * np.trace(inertia) * np.eye(3) - inertia
    values, vectors = np.linalg.eigh(moments)
    # a flat plate has a zero second moment across it; keep its logarithm finite
    logs = np.log(np.maximum(values, 1e-6 * values.max()))
    matrix = (vectors * (logs - logs.mean())) @ vectors.T
    return np.einsum("ij,kij->k", matrix, _BASIS)
