"""Does the satellite turn fast enough for terms that change slowly?

A bias seen from a body that turns once per orbit changes the magnitude as slowly as a gain or a drift does, and a fit gives
the one for the other with a small residual and a small stated error. They are apart only where, within a knot of the gain,
the field takes the directions that it takes over the whole arc. With u the unit vector of the field, T the scatter of u
over the arc and W its scatter about the means of windows as long as a knot, the eigenvalues of

    W x = lambda T x                                                                               (1)

are 1 for directions that are sampled anew in every window and 0 for those that are seen once. Two must be fast: a spinner's
axis is slow too and does no harm. Measured: tumbling 0.93 and more, spinning at 46 deg/s 0.98 and more (middle value), held
Earth-pointing 0.10.
"""

from __future__ import annotations

import numpy as np

from fieldline.estimation.calibration.fit import Fit
from fieldline.estimation.calibration.model import Samples, corrected
from fieldline.estimation.calibration.spline import KNOT_SPACING_S

FAST_SHARE = 0.5
WINDOWS_AT_LEAST = 4


def fast_share(one: Fit, samples: Samples) -> float:
    """The middle eigenvalue of (1): 1 where at least two directions are sampled anew in every window."""
    u = np.concatenate([corrected(one.terms, one.theta, part)[0] for _, part in samples.chunks()])
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    window = windows(samples)
    count = np.bincount(window)
    means = np.stack([np.bincount(window, u[:, k]) / count for k in range(3)], axis=1)
    whole = u - u.mean(axis=0)
    values, vectors = np.linalg.eigh(whole.T @ whole)
    floor = 1e-9 * max(values[-1], 1e-30)
    if values[0] <= floor:
        return 0.0  # the directions lie on a circle at most: nothing tells slow terms apart
    inside = (u - means[window]) @ (vectors / np.sqrt(values))
    return float(np.linalg.eigvalsh(inside.T @ inside)[1])


def windows(samples: Samples) -> np.ndarray:
    """(n,) number of the window each sample lies in, without empty ones."""
    span = max(np.ptp(samples.seconds[samples.flight == k]) for k in range(int(samples.flight.max()) + 1))
    length = max(min(KNOT_SPACING_S, span / WINDOWS_AT_LEAST), 1e-9)
    start = np.zeros(int(samples.flight.max()) + 1)
    for k in range(len(start)):
        start[k] = samples.seconds[samples.flight == k][0]
    places = ((samples.seconds - start[samples.flight]) / length).astype(np.int64)
    return np.unique(samples.flight * (places.max() + 1) + places, return_inverse=True)[1]
