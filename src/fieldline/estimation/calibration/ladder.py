"""The candidates, from none to many terms, and where each one's fit starts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fieldline.estimation.calibration.fit import NEARLY_SETTLED, Fit, fit, prior_of
from fieldline.estimation.calibration.model import SYMMETRIC, Samples, Terms
from fieldline.estimation.calibration.spline import SHORTEST_GAIN_ARC_S, UniformSpline, spline_over
from fieldline.estimation.calibration.start import centred_bias, centred_matrix

ENOUGH = 1500  # samples that tell one start from another
BASIC = {
    "none": Terms("none"),
    "bias": Terms("bias", bias=True),
    "bias+scale": Terms("bias+scale", bias=True, matrix="scale"),
    "full": Terms("full", bias=True, matrix="full"),
}


def flight_splines(samples: Samples, spacing_s: float) -> tuple[UniformSpline, ...]:
    """One spline per flight over its own span; empty where a single flight is too short for one."""
    spans = [samples.seconds[samples.flight == k][[0, -1]] for k in range(int(samples.flight.max()) + 1)]
    if len(spans) == 1 and spans[0][1] - spans[0][0] < max(SHORTEST_GAIN_ARC_S, 2.0 * spacing_s):
        return ()
    return tuple(spline_over(first, last, spacing_s) for first, last in spans)


def extensions(terms: Terms, samples: Samples, splines: tuple[UniformSpline, ...], flights: int) -> list[Terms]:
    """Every candidate that has one term more than `terms` has."""
    out = []
    if splines and terms.gain == "none":
        for where, word in (("reading", "gain"), ("field", "field-gain")):
            out.append(replace(terms, name=f"{terms.name}+{word}", gain=where, splines=splines))
    if samples.temperature is not None and not terms.temperature:
        out.append(replace(terms, name=f"{terms.name}+temperature", temperature=True))
    if flights == 1 and not terms.drift:
        out.append(replace(terms, name=f"{terms.name}+drift", drift=True))
    if samples.dipole is not None and not terms.dipole:
        out.append(replace(terms, name=f"{terms.name}+dipole", dipole=True))
    if samples.current is not None and not terms.current:
        out.append(replace(terms, name=f"{terms.name}+current", current=True))
    if samples.sunlit is not None and not terms.sunlit:
        out.append(replace(terms, name=f"{terms.name}+sunlit", sunlit=True))
    return out


def embed(fit_: Fit, terms: Terms) -> np.ndarray:
    """Parameters of a richer candidate that say the same as a simpler one's."""
    theta = np.zeros(terms.size)
    if terms.matrix == "scale":
        theta[terms.layout["matrix"]] = fit_.terms.matrix_of(fit_.theta)[0, 0]
    elif terms.matrix == "full":
        theta[terms.layout["matrix"]] = [fit_.terms.matrix_of(fit_.theta)[i, j] for i, j in SYMMETRIC]
    for name, place in fit_.terms.layout.items():
        if name in terms.layout and name != "matrix":
            theta[terms.layout[name]] = fit_.theta[place]
    return theta


def best_fit(terms: Terms, samples: Samples, simpler: Fit | None = None) -> Fit:
    """The lowest cost among the fits from the simpler candidate and from the centred starts."""
    prior = prior_of(terms, samples)
    few = samples.thinned(ENOUGH)
    starts = [embed(simpler, terms)] if simpler is not None else []
    if terms.size <= 9:
        starts += _centred_starts(terms, few)
    rough = [fit(terms, start, few, prior, settled=NEARLY_SETTLED) for start in starts or [prior.mean.copy()]]
    # Costs at unlike scales do not compare; the scale itself does.
    best = min(rough, key=lambda one: one.cost + len(few) * np.log(one.scale))
    return fit(terms, best.theta, samples, prior, scale=best.scale, settled=NEARLY_SETTLED)


def _centred_starts(terms: Terms, samples: Samples) -> list[np.ndarray]:
    """Parameter vectors from the linear solutions."""
    out = []
    whole = centred_matrix(samples) if terms.matrix == "full" else None
    alone = centred_bias(samples) if terms.bias else None
    for bias, matrix in [whole, (alone, np.eye(3))] if whole else [(alone, np.eye(3))]:
        if bias is not None:
            theta = np.zeros(terms.size)
            theta[terms.layout["bias"]] = bias
            if terms.matrix != "none":
                six = [matrix[i, j] for i, j in SYMMETRIC]
                theta[terms.layout["matrix"]] = six if terms.matrix == "full" else six[:1]
            out.append(theta)
    return out
