"""Gauss coefficients of the published models, read from the files that their makers distribute.

A model is piecewise linear in time between epochs: IGRF-14 has one every five years from 1900 to 2025 and its
predictive secular variation is written as an epoch at 2030; WMM2025 has one epoch and rates for five years.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib import resources

import numpy as np

from fieldline.constants import IGRF_REFERENCE_RADIUS_M

NANOTESLA = 1e-9


@dataclass(frozen=True, eq=False, kw_only=True)
class GaussCoefficients:
    """Schmidt semi-normalised coefficients at their epochs; linear between, nothing outside.

    epochs : (E,) [decimal year]      g, h : (E, N+1, N+1) [T], indexed [epoch, n, m]      radius_m : the sphere r = a.
    """

    epochs: np.ndarray
    g: np.ndarray
    h: np.ndarray
    radius_m: float = IGRF_REFERENCE_RADIUS_M

    def __post_init__(self):
        for array in (self.epochs, self.g, self.h):
            array.flags.writeable = False

    @property
    def degree(self) -> int:
        """Highest degree n."""
        return self.g.shape[-1] - 1

    def truncated(self, degree: int, order: int) -> GaussCoefficients:
        """The same up to `degree` and `order`."""
        kept = np.arange(degree + 1) <= order
        g = self.g[:, : degree + 1, : degree + 1] * kept
        h = self.h[:, : degree + 1, : degree + 1] * kept
        return GaussCoefficients(epochs=self.epochs, g=g, h=h, radius_m=self.radius_m)

    def extended(self, year: float) -> GaussCoefficients:
        """The same with its last rate carried on to `year`."""
        step = (year - self.epochs[-1]) / (self.epochs[-1] - self.epochs[-2])
        g, h = (np.concatenate([c, c[-1:] + step * (c[-1:] - c[-2:-1])]) for c in (self.g, self.h))
        return GaussCoefficients(epochs=np.append(self.epochs, year), g=g, h=h, radius_m=self.radius_m)


@cache
def igrf14() -> GaussCoefficients:
    """IGRF-14 as IAGA gives it in its .shc file: one column an epoch, h_nm in the row of order -m."""
    epochs, *rows = [line.split() for line in _lines("igrf14.shc")][1:]
    years = np.array(epochs, dtype=float)
    degree = max(int(row[0]) for row in rows)
    g, h = _zeros(len(years), degree), _zeros(len(years), degree)
    for n, m, *values in rows:
        (h if int(m) < 0 else g)[:, int(n), abs(int(m))] = np.array(values, dtype=float) * NANOTESLA
    return GaussCoefficients(epochs=years, g=g, h=h)


@cache
def wmm2025() -> GaussCoefficients:
    """WMM2025 as NCEI and BGS give it in their .COF file: n, m, g, h [nT], their rates [nT/year]."""
    head, *rows = [line.split() for line in _lines("wmm2025.cof") if not line.startswith("9999")]
    degree = max(int(row[0]) for row in rows)
    g, h = _zeros(2, degree), _zeros(2, degree)
    for row in rows:
        n, m = int(row[0]), int(row[1])
        values = np.array(row[2:], dtype=float) * NANOTESLA
        g[:, n, m] = values[0], values[0] + 5.0 * values[2]
        h[:, n, m] = values[1], values[1] + 5.0 * values[3]
    epoch = float(head[0])
    return GaussCoefficients(epochs=np.array([epoch, epoch + 5.0]), g=g, h=h)


def _lines(name: str) -> list[str]:
    """The lines of a data file in the package, without comments."""
    text = (resources.files("fieldline") / "data" / name).read_text(encoding="ascii")
    return [line for line in text.splitlines() if line.strip() and not line.startswith("#")]


def _zeros(epochs: int, degree: int) -> np.ndarray:
    """An empty set of coefficients."""
    return np.zeros((epochs, degree + 1, degree + 1))
