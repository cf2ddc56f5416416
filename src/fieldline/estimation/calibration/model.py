"""How a magnetometer's reading becomes a field whose magnitude can be compared with a model's.

    w       = gain_s(t) field_s - bias - drift (t - t_r) - C dipole - c current - p sunlit         (1)
    field_b = gain_b(t) D w                                                                        (2)
    r       = |field_b| - |B_ref| (1 + s^2 / |B_ref|^2)                                            (3)
    d       = r / |D u|,   u = field_b / |field_b|                                                 (4)

`gain_s` multiplies the whole reading (a supply or reference voltage, the sensitivity of the bridge: whatever the
sensor sees, a magnet beside it included), `gain_b` only what is left without the bias (an offset of the electronics);
one of them at most differs from 1. D is symmetric: |R D w| = |D w| for every rotation R, so that of the nine numbers of
a general matrix only the six of its symmetric (polar) factor can be seen in magnitudes.

The noise e of a reading enters r as u . D e, so that minimising r^2 would reward a D that shrinks the noise: along an axis
that the field hardly takes, a huge bias behind a tiny D explains the magnitudes with less noise than the truth does. The
distance d of the reading from the surface |field_b| = |B_ref|, whose noise does not depend on D, has no such reward. (3)
carries the mean of the noise across the field, which lengthens every reading: s is the noise of one axis.

With g = gain_b, V = D u, n = |V| and the direction

    a = (u - d (1 - u u^T) D V / (n |field_b|)) / n                                                (5)

the derivatives of d are

    d/d bias = -g D a        d/d gain_s = a . D field_s        d/d gain_b = a . D w
    d/d D_ij = (M_ij + M_ji) / (1 + delta_ij),   M = g a w^T - d V u^T / n^2                       (6)

Everything here is in units of a typical field (`Samples.unit_tesla`), of the arc, and of the largest command.
Source: Alonso and Shuster, J. Astronaut. Sci. 50 (2002) 61 (bias) and 50 (2002) 477 (scale, non-orthogonality), for
(1) and (2) with constant terms; gains and couplings derived here.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from fieldline.estimation.calibration.spline import UniformSpline

CHUNK = 16384
SYMMETRIC = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
TINY = 1e-12
LARGEST_NOISE = 0.1  # of the field: beyond, what is left is not noise


@dataclass(frozen=True, slots=True)
class Samples:
    """Usable samples of one or several flights, scaled; `flight` is non-decreasing."""

    seconds: np.ndarray
    field_s: np.ndarray
    magnitude: np.ndarray
    flight: np.ndarray
    arc: np.ndarray  # time from the middle of the arc, in arc lengths
    temperature: Any = None  # (n,) or None
    dipole: Any = None  # (n, 3) or None
    current: Any = None  # (n,) or None
    sunlit: Any = None  # (n,) or None

    def __len__(self) -> int:
        return len(self.seconds)

    def take(self, which: np.ndarray | slice) -> Samples:
        """The samples that an index, a slice or a mask selects."""
        pick = lambda values: None if values is None else values[which]
        return Samples(
            self.seconds[which], self.field_s[which], self.magnitude[which], self.flight[which], self.arc[which],
            pick(self.temperature), pick(self.dipole), pick(self.current), pick(self.sunlit),
        )  # fmt: skip

    def lengthened(self, noise: float) -> Samples:
        """The same samples with the magnitudes that readings of this noise have in the mean, (3)."""
        noise = min(noise, LARGEST_NOISE)
        return replace(self, magnitude=self.magnitude + noise**2 / self.magnitude)

    def thinned(self, most: int) -> Samples:
        """At most so many samples, taken at random: an even step could fall in step with a spin."""
        if len(self) <= most:
            return self
        rng = np.random.default_rng(20020701)
        return self.take(np.sort(rng.choice(len(self), most, replace=False)))

    def chunks(self) -> Iterator[tuple[slice, Samples]]:
        """Runs of at most CHUNK samples, each within one flight."""
        edges = np.flatnonzero(np.diff(self.flight)) + 1
        for first, last in zip([0, *edges], [*edges, len(self)], strict=True):
            for low in range(first, last, CHUNK):
                piece = slice(low, min(low + CHUNK, last))
                yield piece, self.take(piece)


@dataclass(frozen=True)
class Terms:
    """Which terms of (1) and (2) a candidate has, and where each lies in its parameter vector."""

    name: str
    bias: bool = False
    matrix: str = "none"  # "none" | "scale" (a common factor) | "full" (six numbers)
    gain: str = "none"  # "none" | "reading" | "field"
    temperature: bool = False
    drift: bool = False
    dipole: bool = False
    current: bool = False
    sunlit: bool = False
    splines: tuple[UniformSpline, ...] = field(default=())

    @cached_property
    def layout(self) -> dict[str, slice]:
        """Name of each term that is present -> its place."""
        sizes = {
            "bias": 3 * self.bias,
            "matrix": {"none": 0, "scale": 1, "full": 6}[self.matrix],
            "temperature": int(self.temperature),
            "drift": 3 * self.drift,
            "dipole": 9 * self.dipole,
            "current": 3 * self.current,
            "sunlit": 3 * self.sunlit,
            "gain": sum(spline.size for spline in self.splines) if self.gain != "none" else 0,
        }
        places, start = {}, 0
        for name, size in sizes.items():
            if size:
                places[name] = slice(start, start + size)
                start += size
        return places

    @cached_property
    def size(self) -> int:
        """Number of parameters."""
        return max((place.stop for place in self.layout.values()), default=0)

    @property
    def slow(self) -> bool:
        """Whether a term changes with time as slowly as an orbit does."""
        return self.gain != "none" or self.temperature or self.drift or self.sunlit

    def gain_slice(self, flight: int) -> slice:
        """Place of one flight's spline coefficients."""
        start = self.layout["gain"].start + sum(spline.size for spline in self.splines[:flight])
        return slice(start, start + self.splines[flight].size)

    def part(self, theta: np.ndarray, name: str, otherwise: np.ndarray) -> np.ndarray:
        """A term's parameters, or what stands for them where the term is absent."""
        return theta[self.layout[name]] if name in self.layout else otherwise

    def matrix_of(self, theta: np.ndarray) -> np.ndarray:
        """D (3, 3)."""
        part = self.part(theta, "matrix", np.ones(1))
        return part[0] * np.eye(3) if len(part) == 1 else symmetric(part)

    def bias_of(self, theta: np.ndarray) -> np.ndarray:
        """Bias (3,)."""
        return self.part(theta, "bias", np.zeros(3))


def symmetric(six: np.ndarray) -> np.ndarray:
    """(3, 3) from xx, yy, zz, xy, xz, yz."""
    xx, yy, zz, xy, xz, yz = six
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def gain_of(terms: Terms, theta: np.ndarray, samples: Samples) -> np.ndarray:
    """(n,) gain of samples of one flight: spline and temperature together."""
    gain = np.ones(len(samples))
    if "gain" in terms.layout:
        flight = int(samples.flight[0])
        gain += terms.splines[flight].values(samples.seconds, theta[terms.gain_slice(flight)])
    if terms.temperature:
        gain += theta[terms.layout["temperature"]] * samples.temperature
    return gain


def corrected(terms: Terms, theta: np.ndarray, samples: Samples) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(field_b (n, 3), w (n, 3), gain (n,)) of samples of one flight; equations (1) and (2)."""
    gain = gain_of(terms, theta, samples)
    on_field = terms.gain == "field"
    w = (samples.field_s if on_field else gain[:, None] * samples.field_s) - terms.bias_of(theta)
    if terms.drift:
        w -= samples.arc[:, None] * theta[terms.layout["drift"]]
    if terms.dipole:
        w -= samples.dipole @ theta[terms.layout["dipole"]].reshape(3, 3).T
    if terms.current:
        w -= samples.current[:, None] * theta[terms.layout["current"]]
    if terms.sunlit:
        w -= samples.sunlit[:, None] * theta[terms.layout["sunlit"]]
    field_b = w @ terms.matrix_of(theta)  # D is symmetric
    return (gain[:, None] * field_b if on_field else field_b), w, gain


def magnitudes(terms: Terms, theta: np.ndarray, samples: Samples) -> np.ndarray:
    """(n,) |field_b|, flight after flight."""
    out = np.empty(len(samples))
    for piece, part in samples.chunks():
        out[piece] = np.linalg.norm(corrected(terms, theta, part)[0], axis=1)
    return out


def gain_sums(terms: Terms, samples: Samples) -> np.ndarray:
    """(parameters,) mean of the gain's basis over the samples: its product with the parameters is the mean gain less 1."""
    sums = np.zeros(terms.size)
    if "gain" in terms.layout:
        for _, part in samples.chunks():
            flight = int(part.flight[0])
            first, weights = terms.splines[flight].weights(part.seconds)
            np.add.at(sums, terms.gain_slice(flight).start + first[:, None] + np.arange(4), weights)
    return sums / len(samples)


def field_jacobian(terms: Terms, theta: np.ndarray, part: Samples) -> tuple[np.ndarray, np.ndarray]:
    """The parameters that field_b of these samples (one flight) depends on (m,), and its derivatives (n, 3, m)."""
    _, w, gain = corrected(terms, theta, part)
    matrix, n = terms.matrix_of(theta), len(part)
    outer_gain = gain[:, None] if terms.gain == "field" else np.ones((n, 1))
    to_w = outer_gain[:, :, None] * matrix
    along = (w if terms.gain == "field" else part.field_s) @ matrix
    columns: list[np.ndarray] = []
    if terms.bias:
        columns.append(-to_w)
    if terms.matrix != "none":
        units = np.array([symmetric(row) for row in np.eye(6)])
        six = np.einsum("kij,nj->nik", units, outer_gain * w)
        columns.append(six if terms.matrix == "full" else six[:, :, :3].sum(axis=2, keepdims=True))
    if terms.temperature:
        columns.append((along * part.temperature[:, None])[:, :, None])
    if terms.drift:
        columns.append(-to_w * part.arc[:, None, None])
    if terms.dipole:
        columns.append(-(to_w[:, :, :, None] * part.dipole[:, None, None, :]).reshape(n, 3, 9))
    if terms.current:
        columns.append(-to_w * part.current[:, None, None])
    if terms.sunlit:
        columns.append(-to_w * part.sunlit[:, None, None])
    where = np.arange(sum(c.shape[2] for c in columns))
    if "gain" in terms.layout:
        flight = int(part.flight[0])
        local, basis = terms.splines[flight].columns(part.seconds)
        columns.append(along[:, :, None] * basis[:, None, :])
        start = terms.gain_slice(flight).start
        where = np.concatenate([where, np.arange(start + local.start, start + local.stop)])
    return where, np.concatenate(columns, axis=2) if columns else np.empty((n, 3, 0))


def field_std(terms: Terms, theta: np.ndarray, covariance: np.ndarray, samples: Samples) -> np.ndarray:
    """(n, 3) 1-sigma error of field_b along each axis that the parameters' covariance causes."""
    out = np.zeros((len(samples), 3))
    for piece, part in samples.chunks():
        where, jacobian = field_jacobian(terms, theta, part)
        half = jacobian @ covariance[np.ix_(where, where)]
        out[piece] = np.sqrt(np.maximum(np.einsum("nik,nik->ni", half, jacobian), 0.0))
    return out
