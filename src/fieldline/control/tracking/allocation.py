"""Which currents and thrusts give a wanted force and moment: the best within limits, at the least power.

    least  |W (E u - f)|^2 + c sum (u_k / a_k)^2 p_k   with   lower <= u <= upper                    (1)

E (6, m) of `electrodynamic_map`; f the wanted loads; W their weights, one over the size of an error that matters; a_k the
larger bound of a control, p_k its cost (a conductor's power at its limit over the mean of all). c is small: power decides
only between controls that give the loads equally well, or where the loads are out of reach. A failed control has both
bounds 0. A limit on the whole power sum R_k u_k^2 raises c until it holds (by halving: fifty times the work).

In v = u/a (1) is well-scaled, and `bounded_squares` solves it exactly.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from fieldline.control.tracking.bounded_squares import AT_LOWER, AT_UPPER, bounded_least
from fieldline.errors import InputError, NoEstimateError, nearest, shown

COST = 1e-10  # c of (1): of the square of loads, where all controls are at their limits
MET = 1e-3  # of the wanted loads, weighted: what may be missed where they count as met
HALVINGS = 50


class Allocation(NamedTuple):
    """What the controls are told, and what that gives."""

    controls: np.ndarray  # (m,) [A], [N]
    loads: np.ndarray  # (6,) given [N], [N m]
    missed: np.ndarray  # (6,) wanted less given
    at_limit: tuple[str, ...]  # names of the controls at a bound
    reached: bool  # whether the loads are met to 0.1 % of their weighted size


@njit(cache=True, error_model="numpy")
def allocate_kernel(effect, wanted, weight, cost, lower, upper, share, u, held):
    """Solve (1) into u (m,) [A, N], warm from u and held (m,) int64; sets tried, or -1.

    effect (6, m), wanted (6,), weight (6,), cost (m,) p_k, lower, upper (m,), share: c of (1).
    """
    m = u.shape[0]
    H, g, v, low, high, size = np.empty((m, m)), np.empty(m), np.empty(m), np.empty(m), np.empty(m), np.empty(m)
    for j in range(m):
        size[j] = max(abs(lower[j]), abs(upper[j]))
        if size[j] == 0.0:
            size[j] = 1.0
        v[j], low[j], high[j] = u[j] / size[j], lower[j] / size[j], upper[j] / size[j]
    for i in range(m):
        total = 0.0
        for k in range(6):
            total -= weight[k] * weight[k] * effect[k, i] * wanted[k]
        g[i] = total * size[i]
        for j in range(i + 1):
            total = 0.0
            for k in range(6):
                total += weight[k] * weight[k] * effect[k, i] * effect[k, j]
            H[i, j] = total * size[i] * size[j]
            H[j, i] = H[i, j]
    trace = 0.0
    for i in range(m):
        trace = max(trace, H[i, i])
    for i in range(m):
        H[i, i] += share * cost[i] * trace + 1e-14 * trace + 1e-300
    tried = bounded_least(H, g, low, high, v, held)
    for j in range(m):
        u[j] = min(max(v[j] * size[j], lower[j]), upper[j])
    return tried


@njit(cache=True, error_model="numpy")
def power_of(u, resistance):
    """sum R_k u_k^2 [W]."""
    total = 0.0
    for k in range(u.shape[0]):
        total += resistance[k] * u[k] * u[k]
    return total


@njit(cache=True, error_model="numpy")
def allocate_power_kernel(effect, wanted, weight, cost, lower, upper, resistance, power_max, share, u, held):
    """`allocate_kernel` with sum R u^2 <= power_max [W]: c is raised by halving its logarithm's range until it holds."""
    tried = allocate_kernel(effect, wanted, weight, cost, lower, upper, share, u, held)
    if tried < 0 or power_of(u, resistance) <= power_max:
        return tried
    low, high = np.log(share), np.log(share) + 80.0
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        tried = allocate_kernel(effect, wanted, weight, cost, lower, upper, np.exp(middle), u, held)
        if tried < 0:
            return tried
        if power_of(u, resistance) <= power_max:
            high = middle
        else:
            low = middle
    return allocate_kernel(effect, wanted, weight, cost, lower, upper, np.exp(high), u, held)


def allocate(
    effect,
    wanted,
    lower,
    upper,
    *,
    weights=(1.0, 1.0, 1.0, 0.01, 0.01, 0.01),
    resistance_ohm=None,
    power_max_w: float = np.inf,
    failed=(),
    names=None,
) -> Allocation:
    """The controls of (1).

    Parameters
    ----------
    effect : (6, m) of `electrodynamic_map`, loads per ampere and newton.      wanted : (6,) force [N] and moment [N m].
    lower, upper : (m,) bounds [A, N]; a thruster that pushes one way has lower 0.
    weights : (6,) of the loads; a newton counts as much as 100 N m by default.
    resistance_ohm : (m,) of each control's circuit, for least power; all alike where None.      power_max_w : of all.
    failed : controls that do nothing, by name or column.      names : (m,) of the controls; u1, u2, ... by default.

    Raises
    ------
    InputError : shapes, numbers that are not finite, bounds the wrong way round, an unknown name.
    """
    effect, wanted, weights = (np.array(x, dtype=float) for x in (effect, wanted, weights))
    if effect.ndim != 2 or effect.shape[0] != 6 or effect.shape[1] == 0:
        raise InputError(f"effect must have shape (6, m), loads by controls; got {effect.shape}.")
    m = effect.shape[1]
    low, high = np.array(np.broadcast_to(lower, (m,)), dtype=float), np.array(np.broadcast_to(upper, (m,)), dtype=float)
    _check(effect, wanted, weights, low, high)
    labels = [f"u{k}" for k in range(1, m + 1)] if names is None else list(names)
    for one in failed:
        low[_column(one, labels)] = high[_column(one, labels)] = 0.0
    resistance = np.ones(m) if resistance_ohm is None else np.array(np.broadcast_to(resistance_ohm, (m,)), dtype=float)
    if not (np.isfinite(resistance).all() and (resistance >= 0.0).all() and power_max_w > 0.0):
        raise InputError("resistance_ohm must be finite and not negative, power_max_w more than zero.")
    cost = power_costs(resistance, low, high)
    u, held = np.zeros(m), np.zeros(m, dtype=np.int64)
    if allocate_power_kernel(effect, wanted, weights, cost, low, high, resistance, float(power_max_w), COST, u, held) < 0:
        raise NoEstimateError("the allocation did not end: the effects of the controls differ by more than numbers can hold.")
    given = effect @ u
    missed = wanted - given
    at_limit = tuple(labels[k] for k in range(m) if held[k] in (AT_LOWER, AT_UPPER) and high[k] > low[k])
    size = np.linalg.norm(weights * wanted)
    return Allocation(u, given, missed, at_limit, bool(np.linalg.norm(weights * missed) <= MET * max(size, 1e-300)))


def power_costs(resistance, lower, upper) -> np.ndarray:
    """(m,) p_k of (1): power of each control at its larger bound over the mean of all; 1 where nothing is known."""
    size = np.maximum(np.abs(lower), np.abs(upper))
    power = np.asarray(resistance, dtype=float) * size * size
    mean = float(power.mean()) if len(power) else 0.0
    return np.maximum(power / mean, 1e-3) if mean > 0.0 else np.ones(len(size))


def _check(effect, wanted, weights, lower, upper) -> None:
    """InputError for what no allocation can use."""
    for name, value, shape in (("wanted", wanted, (6,)), ("weights", weights, (6,))):
        if value.shape != shape or not np.isfinite(value).all():
            raise InputError(f"{name} must be six finite numbers, force x, y, z and moment x, y, z; got {value}.")
    if not np.isfinite(effect).all():
        raise InputError("effect has elements that are not finite.")
    if not (weights > 0.0).all():
        raise InputError(f"weights must be positive; got {weights.min():g} as the smallest.")
    if not (np.isfinite(lower).all() and np.isfinite(upper).all() and (lower <= 0.0).all() and (upper >= 0.0).all()):
        raise InputError("lower must be finite and not positive, upper finite and not negative: doing nothing is always allowed.")


def _column(one, labels: list[str]) -> int:
    """Column of a control by name or number."""
    if isinstance(one, int | np.integer) and not isinstance(one, bool) and 0 <= one < len(labels):
        return int(one)
    if one not in labels:
        raise InputError(f'failed names no control: "{shown(str(one))}"; {nearest(str(one), labels)}')
    return labels.index(one)
