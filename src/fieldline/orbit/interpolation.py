"""Interpolation between tabulated states: Lagrange and Hermite polynomials over sliding windows of nodes.

    p(t) = c_0 + (t - z_0) (c_1 + (t - z_1) (c_2 + ...)),   v = dp/dt                    (1)

with Newton's divided differences c of the window's nodes z, each node twice for Hermite, where the difference of a
doubled node is the tabulated velocity. The coefficients are found once for each window; velocity is the derivative of
the position's polynomial, so the two always agree.

A Hermite polynomial of degree 7 (four nodes) carries a low orbit through nodes 5 minutes apart to 1 cm in mid-table
and to centimetres at its ends, where the window is one-sided.
Source: Stoer and Bulirsch, Introduction to Numerical Analysis, s. 2.1.3 and 2.1.5.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, kw_only=True, eq=False)
class PolynomialPath:
    """Window polynomials through nodes; serves times from `first_utc` to `last_utc`, both included."""

    first_utc: np.datetime64
    last_utc: np.datetime64
    node_utc: np.ndarray
    nodes: np.ndarray  # (w, m) [in `scale_s` after the window's first node]
    coefficients: np.ndarray  # (w, m, 3) [m]
    scale_s: float
    method: str
    degree: int

    @classmethod
    def through(cls, node_utc, position, velocity, *, method: str, degree: int, useable=(None, None)) -> PolynomialPath:
        """Path through (n, 3) positions [m] and, for HERMITE, velocities [m/s], at n >= 2 increasing times."""
        double = method == "HERMITE"
        points = min((degree + 1) // 2 if double else degree + 1, len(node_utc))
        points = max(points, 2)
        seconds = (node_utc - node_utc[0]).astype(np.int64) * 1e-9
        scale_s = float(np.median(np.diff(seconds)))
        index = np.arange(len(node_utc) - points + 1)[:, None] + np.arange(points)
        nodes = (seconds[index] - seconds[index[:, :1]]) / scale_s
        if double:
            index, nodes = index.repeat(2, axis=1), nodes.repeat(2, axis=1)
        return cls(
            first_utc=node_utc[0] if useable[0] is None else max(useable[0], node_utc[0]),
            last_utc=node_utc[-1] if useable[1] is None else min(useable[1], node_utc[-1]),
            node_utc=node_utc,
            nodes=nodes,
            coefficients=_divided_differences(nodes, position[index], velocity[index] * scale_s if double else None),
            scale_s=scale_s,
            method=method,
            degree=nodes.shape[1] - 1,
        )

    @property
    def words(self) -> str:
        """How it interpolates, for the record."""
        return f"{self.method.capitalize()} of degree {self.degree} through {len(self.node_utc)} states, {self.scale_s:g} s apart"

    def state(self, flat: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Position [m] and velocity [m/s], (n, 3), equation (1)."""
        windows, size = self.nodes.shape
        points = size // 2 if self.method == "HERMITE" else size
        after = np.searchsorted(self.node_utc, flat, side="right") - 1
        window = np.clip(after - (points - 1) // 2, 0, windows - 1)
        t = (flat - self.node_utc[window]).astype(np.int64) * (1e-9 / self.scale_s)
        position = self.coefficients[window, size - 1]
        slope = np.zeros_like(position)
        for k in range(size - 2, -1, -1):
            step = (t - self.nodes[window, k])[:, None]
            slope = slope * step + position
            position = position * step + self.coefficients[window, k]  # (1)
        return position, slope / self.scale_s


def _divided_differences(nodes: np.ndarray, values: np.ndarray, slopes: np.ndarray | None) -> np.ndarray:
    """(w, m, 3) Newton coefficients; `slopes` fill the differences of doubled nodes."""
    table = values.copy()
    size = nodes.shape[1]
    for order in range(1, size):
        gap = nodes[:, order:] - nodes[:, :-order]
        rise = table[:, order:] - table[:, order - 1 : -1]
        doubled = gap == 0.0
        quotient = rise / np.where(doubled, 1.0, gap)[..., None]
        if slopes is not None and order == 1:
            quotient = np.where(doubled[..., None], slopes[:, 1:], quotient)
        table[:, order:] = quotient
    return table
