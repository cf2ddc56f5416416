"""A hanging line on a grid: nodes and straight segments, or polynomials that show the continuum.

Both are masses m at points and springs between them,

    strain at the stations = D u,    force of the springs on the points = -D' (w T)                          (1)

u: displacement of the points from where they are without tension; w: unstretched length that a station stands for. For nodes
and segments D takes differences, one station a segment. For the continuum each material is one polynomial through the
Gauss, Lobatto and Legendre points, which are its stations as well, with their weights as w and mu w as masses: the error of
what is smooth falls faster than any power of the number of points.

Source: Canuto, Hussaini, Quarteroni and Zang (2006), Spectral Methods, section 2.3 (points, weights and D).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fieldline.analysis.tether.strand import Strand, Stretches, point_masses

DEGREE, DEGREE_OF_SEVERAL = 40, 28  # of the polynomials of a continuum: thirteen half waves to nine digits or more


class Grid(NamedTuple):
    """A line along s, its unstretched length from the lower end."""

    place: np.ndarray  # (p,) [m], s of the points
    mass: np.ndarray  # (p,) [kg], bodies at the ends included
    station: np.ndarray  # (q,) [m], s where strain and tension are known
    weight: np.ndarray  # (q,) [m]
    stiffness: np.ndarray  # (q,) [N]
    slope: np.ndarray  # (q, p) [1/m], D of equation (1)


def chain_grid(strand: Strand, lower_kg: float, upper_kg: float) -> Grid:
    """Nodes and segments, bodies of lower_kg and upper_kg at the ends."""
    place = np.concatenate([[0.0], np.cumsum(strand.rest)])
    rows = np.arange(len(strand.rest))
    slope = np.zeros((len(rows), len(rows) + 1))
    slope[rows, rows], slope[rows, rows + 1] = -1.0 / strand.rest, 1.0 / strand.rest
    middle = 0.5 * (place[:-1] + place[1:])
    return Grid(place, point_masses(strand, lower_kg, upper_kg), middle, strand.rest, strand.stiffness, slope)


def continuum_grid(stretches: Stretches, lower_kg: float, upper_kg: float) -> Grid:
    """One polynomial for each material."""
    count = len(stretches.length)
    degree = DEGREE if count == 1 else DEGREE_OF_SEVERAL
    x, w, d = lobatto(degree)
    points = degree * count + 1
    place, mass = np.zeros(points), np.zeros(points)
    station, weight, slope = [], [], np.zeros((count * (degree + 1), points))
    start = 0.0
    for k, (length, linear_mass) in enumerate(zip(stretches.length, stretches.linear_mass, strict=True)):
        mine = slice(degree * k, degree * (k + 1) + 1)
        at = start + 0.5 * length * (x + 1.0)
        place[mine] = at
        mass[mine] += 0.5 * length * linear_mass * w
        slope[(degree + 1) * k : (degree + 1) * (k + 1), mine] = d * (2.0 / length)
        station.append(at)
        weight.append(0.5 * length * w)
        start += length
    mass[0] += lower_kg
    mass[-1] += upper_kg
    stiffness = np.repeat(stretches.stiffness, degree + 1)
    return Grid(place, mass, np.concatenate(station), np.concatenate(weight), stiffness, slope)


def lobatto(degree: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Gauss, Lobatto and Legendre points x (degree + 1,) on [-1, 1], their weights, and the matrix of differentiation."""
    legendre = np.polynomial.legendre.Legendre.basis(degree)
    inner = np.sort(legendre.deriv().roots().real)
    for _ in range(3):
        inner = inner - legendre.deriv(1)(inner) / legendre.deriv(2)(inner)
    x = np.concatenate([[-1.0], inner, [1.0]])
    values = legendre(x)
    weight = 2.0 / (degree * (degree + 1) * values**2)
    apart = x[:, None] - x[None, :] + np.eye(degree + 1)
    d = values[:, None] / values[None, :] / apart
    np.fill_diagonal(d, 0.0)
    np.fill_diagonal(d, -d.sum(axis=1))
    return x, weight, d
