"""A linear-quadratic regulator for coefficients frozen at an instant, with the prefilter that makes it follow a command.

    u = M r - K x,   K = R^-1 G' P,   F'P + P F - P G R^-1 G' P + Q = 0                             (1)
    y -> r:   M = -(H (F - G K)^-1 G)^+                                                             (2)

The equation is solved in the time and units of the caller's scales (state = scale x scaled state, time in 1/rate), where
it is well-conditioned, and once more for its residual (a Newton step): with metres, seconds and radians of a vehicle in
orbit its terms span 18 decades. (2) is the least-squares inverse, exact where H (F - G K)^-1 G has full rank: where the
plant can hold every command (`analysis.controllability.steady_state`).

Source: Lawrence (1992), AFIT/GA/ENY/92D-05, (4.7) to (4.9); Kleinman (1968), IEEE Trans. Automatic Control 13:114 (the step).
Valid while F and G stay as they are: on a field that turns the closed loop need not be stable.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fieldline.errors import InputError, NoEstimateError

UNSTABILISABLE = (
    "no regulator makes this plant stable: a motion that does not decay by itself is out of reach of its controls at this "
    "instant. `analysis.controllability_now` names it, `controllability_over` says whether it returns in the orbit."
)


class Regulator(NamedTuple):
    """u = prefilter r - gain x, with the closed loop's poles [1/s], slowest first, P of (1), and its relative residual."""

    gain: np.ndarray  # (m, n)
    prefilter: np.ndarray  # (m, p)
    poles: np.ndarray  # (n,)
    riccati: np.ndarray  # (n, n)
    residual: float


class Response(NamedTuple):
    """What a closed loop does: seconds (k,), state (k, n), control (k, m)."""

    seconds: np.ndarray
    state: np.ndarray
    control: np.ndarray


def frozen_regulator(F, G, H, state_weights, control_weights, *, rate: float = 1.0, scale=1.0) -> Regulator:
    """Gain and prefilter of (1) and (2).

    Parameters
    ----------
    F (n, n), G (n, m), H (p, n) : the plant.      state_weights (n,), control_weights (m,) : diagonals of Q and R.
    rate : [1/s] of the plant's motion.      scale : (n,) sizes of the states, for the numbers' sake alone.

    Raises
    ------
    InputError : weights that are not positive.      NoEstimateError : a plant that no regulator makes stable.
    """
    from scipy.linalg import LinAlgError, solve_continuous_are, solve_continuous_lyapunov

    q, r = _weights("state_weights", state_weights, F.shape[0]), _weights("control_weights", control_weights, G.shape[1])
    size = np.broadcast_to(np.asarray(scale, dtype=float), q.shape)
    f, g = F * size / size[:, None] / rate, G / np.sqrt(r) / size[:, None] / rate
    weight = np.diag(q * size * size)
    try:
        p = solve_continuous_are(f, g, weight, np.eye(g.shape[1]))
    except (LinAlgError, ValueError) as error:
        raise NoEstimateError(UNSTABILISABLE) from error
    closed = f - g @ (g.T @ p)
    left = f.T @ p + p @ f - p @ g @ g.T @ p + weight
    p = p + solve_continuous_lyapunov(closed.T, -left)
    left = f.T @ p + p @ f - p @ g @ g.T @ p + weight
    gain = (g.T @ p) / size / np.sqrt(r)[:, None]
    poles = np.linalg.eigvals(f - g @ (g.T @ p)) * rate
    if not poles.real.max() < 0.0:
        raise NoEstimateError(UNSTABILISABLE)
    order = np.lexsort((poles.imag, -poles.real.round(15)))
    settled = np.linalg.solve(f - g @ (g.T @ p), G / size[:, None] / rate) * size[:, None]
    prefilter = -np.linalg.pinv(H @ settled)
    residual = float(np.abs(left).max() / np.abs(p @ g @ g.T @ p).max())
    return Regulator(gain, prefilter, poles[order], p / np.outer(size, size) / rate, residual)


def respond(F, G, regulator: Regulator, state, references, seconds) -> Response:
    """The closed loop from `state` (n,) at evenly spaced seconds (k,) with the references (k, p) held from each on; exact."""
    from scipy.linalg import expm

    seconds, references = np.asarray(seconds, dtype=float), np.asarray(references, dtype=float)
    n, p = F.shape[0], references.shape[1]
    both = np.zeros((n + p, n + p))
    both[:n, :n], both[:n, n:] = F - G @ regulator.gain, G @ regulator.prefilter
    step = expm(both * (seconds[1] - seconds[0]))
    states = np.empty((len(seconds), n))
    states[0] = state
    for k in range(len(seconds) - 1):
        states[k + 1] = step[:n, :n] @ states[k] + step[:n, n:] @ references[k]
    return Response(seconds, states, references @ regulator.prefilter.T - states @ regulator.gain.T)


def _weights(name: str, given, count: int) -> np.ndarray:
    """(count,) positive, finite weights, or a refusal."""
    weights = np.broadcast_to(np.asarray(given, dtype=float), (count,))
    if not np.isfinite(weights).all() or not (weights > 0.0).all():
        raise InputError(f"{name} must be positive and finite; got {np.asarray(given).min():g} as the smallest.")
    return weights
