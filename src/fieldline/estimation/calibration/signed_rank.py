"""Wilcoxon's signed ranks: could paired differences of no true sign lean as far to the positive side?

W = sum of the ranks of |x| over the positive x. For at most EXACT differences its distribution over all 2^n choices of
signs is counted; beyond, W is normal with mean n (n + 1) / 4 and variance n (n + 1) (2 n + 1) / 24, with half a rank taken off.
Source: Wilcoxon, Biometrics Bulletin 1 (1945) 80. Differences of exactly zero are dropped; equal ones are ranked as they come.
"""

from __future__ import annotations

import math

import numpy as np

EXACT = 50


def chance_of_lead(differences: np.ndarray) -> float:
    """Probability of a W as large as that of these differences, or larger; 1 where all are zero."""
    x = differences[differences != 0.0]
    n = len(x)
    if n == 0:
        return 1.0
    ranks = np.empty(n, dtype=np.int64)
    ranks[np.argsort(np.abs(x), kind="stable")] = np.arange(1, n + 1)
    lead = int(ranks[x > 0.0].sum())
    if n > EXACT:
        away = lead - 0.5 - 0.25 * n * (n + 1)
        return 0.5 * math.erfc(away / math.sqrt(n * (n + 1) * (2 * n + 1) / 12.0))
    ways = np.zeros(n * (n + 1) // 2 + 1)
    ways[0] = 1.0
    for rank in range(1, n + 1):
        ways[rank:] = ways[rank:] + ways[:-rank]
    return float(ways[lead:].sum() / 2.0**n)
