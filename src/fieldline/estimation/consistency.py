"""Is the estimate as good as it says? NIS and whiteness of the innovations, and in words.

    NIS = white . white, expectation 3; the mean of n independent ones lies within 3 +- 1.96 sqrt(6 / n)              (1)
    r_1 = sum white_k . white_(k+1) / sum |white_k|^2, for white noise within +- 1.96 / sqrt(3 n)                  (2)

    memory m = 1 + 2 sum_k r_k^2      (`polish.effective_share`): n innovations say as much as n / m white ones would     (3)

Telemetry is not exactly Gaussian, so words allow for a tenth of sigma before they complain.
"""

from __future__ import annotations

import numpy as np

from fieldline.estimation.polish import effective_share

LARGEST_MEMORY = 5.0
GATE = 25.0  # NIS of outliers, which the filter holds back, is counted at most so


def consistency(white: np.ndarray) -> dict:
    """Plain values: nis_mean (per degree of freedom, 1 is right), its 95 % band, lag-one correlation, and words."""
    good = np.isfinite(white).all(axis=1)
    rows = white[good]
    if len(rows) < 10:
        return {"nis_mean": None, "nis_band": None, "whiteness": None, "outliers": 0, "words": "too few samples to say"}
    nis = (rows**2).sum(axis=1)
    mean = float(np.minimum(nis, GATE).mean() / 3.0)
    half = 1.96 * np.sqrt(6.0 / len(nis)) / 3.0
    both = good[1:] & good[:-1]
    pairs = float((white[1:][both] * white[:-1][both]).sum() / max((rows**2).sum(), 1e-300))
    memory = 1.0 / effective_share(white)
    return {
        "nis_mean": mean,
        "nis_band": [1.0 - half, 1.0 + half],
        "whiteness": pairs,
        "whiteness_band": 1.96 / np.sqrt(3.0 * len(rows)),
        "memory": memory,
        "outliers": int((nis > GATE).sum()),
        "words": _words(mean, pairs, memory, len(rows)),
    }


def _words(mean: float, lag_one: float, memory: float, count: int) -> str:
    """One clause: consistent, too optimistic, too pessimistic; and whether residuals remember or repeat."""
    sigma = np.sqrt(mean)
    if sigma > 1.1:
        words = f"too optimistic: residuals are {sigma:.1f} sigma"
    elif sigma < 0.85:
        words = f"too pessimistic: residuals are {sigma:.1f} sigma"
    else:
        words = "consistent in size"
    if memory > LARGEST_MEMORY:
        independent = f"{count:,} samples tell as much as {count / memory:,.0f} independent ones"
        return words + f", but residuals repeat with the spin, or drift: {independent}"
    if abs(lag_one) > 0.3:
        return words + f", but residuals remember their neighbours (correlation {lag_one:.2f})"
    return "consistent" if words == "consistent in size" else words
