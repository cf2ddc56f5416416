"""The periodic linear-quadratic regulator: gains over a period, with the proof of the solution.

    dx/dt = a(t) x + b(t) u,   u = -K(t) x,   K the least integral of x'q x + u'r u                 (1)

with everything of period T, given at N equal steps. The Riccati equation is solved by `control.periodic_system`, either for
an input that is held over each step (`control="held"`, as flight software gives it) or for one that may change at any time
(`control="continuous"`). What proves a solution comes with it: the residual of P after a turn around the period, and the
Floquet multipliers of the closed loop.
"""

from __future__ import annotations

import numpy as np

from fieldline.analysis.floquet import as_ring, characteristic_exponents, check_period, multipliers_of
from fieldline.analysis.margins import held_delay, periodic_ranges
from fieldline.control.periodic_system import (
    continuous_gains,
    continuous_steps,
    held_gains,
    held_problem,
    held_steps,
    periodic_solution,
    product,
    reach,
    transitions,
)
from fieldline.errors import InputError, NoEstimateError, nearest, shown

KINDS = ("held", "continuous")
STABLE = 1.0 - 1e-9  # a multiplier beyond it is not told from one on the circle
SETTLED = 1e-6  # of |P|: a residual beyond it is no solution


def periodic_regulator(a, b, q, r, period_s: float, control: str = "held", *, margins: bool = False):
    """Gains of the regulator (1) over a period, as a Dataset.

    a (N, n, n) [1/s], b (N, n, m), q (N, n, n) and r (N, m, m) at N equal steps over `period_s` [s], each also once for the
    whole period, (n, n) and so on; q symmetric and not negative, r symmetric and positive. `control`: "held" or
    "continuous". Constant coefficients throughout are one step of the length `period_s`.

    The Dataset has gain (time, control, state), riccati (time, state, state_also) = P with x'P x the cost from there on,
    multiplier and pole [1/s] (mode) of the closed loop, complex; attributes residual and doublings. With `margins` also
    gain_margin_low and _high, between which a factor on all inputs leaves every multiplier inside the unit circle, the same of
    each input alone (control), and delay_margin_s, the longest delay in whole steps of inputs held over each step: see `margins`.
    Errors: `InputError` for shapes and signs; `NoEstimateError` where no stabilising solution exists: a motion that does not
    decay by itself and that the input does not reach, or that the cost does not see.
    """
    if control not in KINDS:
        raise InputError(f'control must be "held" or "continuous"; got "{shown(str(control))}"; {nearest(str(control), KINDS)}')
    period = check_period(period_s)
    a, b, q, r = _checked(a, b, q, r)
    if control == "held":
        held = held_problem(a, b, q, r, period)
        steps, factor = held_steps(held)
    else:
        held = None
        steps, factor = continuous_steps(a, reach(b, r), q, period)
    riccati, closed, residual, doublings = periodic_solution(steps)
    multipliers = multipliers_of(product(closed)) if doublings > 0 else np.array([np.inf])
    if doublings < 0 or residual > SETTLED or not abs(multipliers[0]) < STABLE:
        raise NoEstimateError(_why_not(doublings, residual, multipliers))
    riccati = riccati / factor
    gains = continuous_gains(b, r, riccati) if held is None else held_gains(held, riccati)
    found = _dataset(gains, riccati, multipliers, period, {"residual": residual, "doublings": doublings, "control": control})
    if not margins:
        return found
    if held is None:
        return _with_margins(found, lambda f: transitions(a - (b * f) @ gains, period), held_problem(a, b, q, r, period))
    return _with_margins(found, lambda f: held.phi - (held.gamma * f) @ gains, held)


def _with_margins(found, steps_of, held):
    """The Dataset with the ranges of gain of steps_of(factors) and the delay of its gains, held."""
    gains = found["gain"].values
    ranges = periodic_ranges(steps_of, gains.shape[1])
    delay = held_delay(held.phi, held.gamma, gains, found.attrs["period_s"] / len(gains))
    for at, name in enumerate(("gain_margin_low", "gain_margin_high")):
        found[name] = (), ranges[0][at], {"units": "1", "long_name": "factor on all inputs that leaves the loop stable"}
        found[f"{name}_of"] = "control", [one[at] for one in ranges[1:]], {"units": "1", "long_name": "the same, one input alone"}
    found["delay_margin_s"] = (), delay, {"units": "s", "long_name": "delay of all inputs, in whole steps, that leaves it stable"}
    return found


def _checked(a, b, q, r) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """All four on the same ring of nodes."""
    shapes = {name: np.shape(m) for name, m in (("a", a), ("b", b), ("q", q), ("r", r))}
    count = max((shape[0] for shape in shapes.values() if len(shape) == 3), default=1)
    n = shapes["a"][-1] if len(shapes["a"]) >= 2 else 0
    m = shapes["b"][-1] if len(shapes["b"]) >= 2 else 0
    a, b = as_ring("a", a, n, n, count), as_ring("b", b, n, m, count)
    q, r = as_ring("q", q, n, n, count), as_ring("r", r, m, m, count)
    for name, weight, least in (("q", q, 0.0), ("r", r, 1e-14)):
        size = float(np.abs(weight).max(initial=0.0))
        if not np.allclose(weight, np.swapaxes(weight, 1, 2), rtol=1e-9, atol=1e-12 * size):
            raise InputError(f"{name} must be symmetric.")
        smallest = float(np.linalg.eigvalsh(weight).min())
        if smallest < least * size - 1e-12 * size * (name == "q") or (name == "r" and smallest <= 0.0):
            kind = "not have negative eigenvalues" if name == "q" else "be positive definite"
            raise InputError(f"{name} must {kind}; its smallest eigenvalue is {smallest:g}.")
    return a, b, q, r


def _why_not(doublings: int, residual: float, multipliers: np.ndarray) -> str:
    """The sentence for a regulator that does not exist."""
    found = (
        "its Riccati equation does not settle"
        if doublings < 0
        else f"the closed loop's largest multiplier is {abs(multipliers[0]):.6g} and the equation's residual {residual:.1e}"
    )
    return (
        f"no stabilising periodic regulator was found: {found}. A motion that does not decay by itself must be reached by the "
        "input over the period and seen by the cost; check b and q, or weigh the input less."
    )


def _dataset(gains, riccati, multipliers, period: float, attributes: dict):
    """Everything with its axes and units."""
    import xarray as xr

    count = gains.shape[0]
    return xr.Dataset(
        {
            "gain": (("time", "control", "state"), gains, {"long_name": "K of u = -K x"}),
            "riccati": (("time", "state", "state_also"), riccati, {"long_name": "P, cost to come x'P x"}),
            "multiplier": (("mode",), multipliers, {"long_name": "Floquet multipliers of the closed loop"}),
            "pole": (("mode",), characteristic_exponents(multipliers, period), {"units": "1/s"}),
        },
        coords={"time": ("time", np.arange(count) * period / count, {"units": "s"})},
        attrs={"period_s": period, **attributes},
    )
