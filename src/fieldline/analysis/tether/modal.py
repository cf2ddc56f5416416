"""How much of each lateral mode there is in a line's deflection from its chord, and how fast that changes.

    sum over nodes of m |q - sum_k a_k f_k(s)|^2 = min,    f_k = sin(k pi s / L) unless shapes are given     (1)

q: deflection (node, 2) as `fieldline.analysis.line_shape` gives it, s / L: share of the chord, f_k less the straight line
between its ends. The same fit of the rate of q gives the rate of a_k.
"""

from __future__ import annotations

import numpy as np

from fieldline.analysis.line_shape import LineShape
from fieldline.errors import InputError


def modal_amplitudes(shape: LineShape, mass_kg, *, modes: int = 3, shapes=None) -> tuple[np.ndarray, np.ndarray]:
    """Amplitudes and rates (time, mode, 2) [m, m/s] of equation (1), mode 1 first; NaN of modes that have no node to show.

    Parameters
    ----------
    shape : of `shape_of_line`.
    mass_kg : (point,) weights of the points; those of the attachments do not count.
    modes : how many; at most the number of nodes is given.
    shapes : (modes, point) lateral shapes in the order of the points, such as the `out_of_plane_shape` of `tether_modes` from
        mode 1 on, in their place: the points must then be out all the time.

    Raises
    ------
    InputError : a number of modes that is none, or arrays that do not fit.
    """
    count = shape.along_m.shape[1]
    mass = np.asarray(mass_kg, dtype=float)
    if mass.shape != (count,) or not np.isfinite(mass).all() or np.any(mass < 0.0):
        raise InputError(f"mass_kg must have shape ({count},), one mass a point, none below zero; got shape {mass.shape}.")
    part = np.abs(shape.along_m) / shape.chord_m[:, None]
    basis = _basis(part, modes, shapes)
    out = np.isfinite(part) & (np.arange(count) > 0) & (np.arange(count) < count - 1)
    weight = np.where(out, mass, 0.0)
    fits = np.arange(basis.shape[1]) < (weight > 0.0).sum(axis=1, keepdims=True)
    basis = np.where(out[:, None], basis, 0.0)
    left = np.where(
        fits[:, :, None] & fits[:, None, :], np.einsum("tkp,tp,tlp->tkl", basis, weight, basis), np.eye(basis.shape[1])
    )
    both = np.concatenate([shape.deflection_m, shape.deflection_rate_m_s], axis=-1)
    right = np.einsum("tkp,tp,tpj->tkj", basis, weight, np.where(out[..., None], both, 0.0))
    found = np.where(fits[..., None], np.linalg.solve(left, right), np.nan)
    return found[..., :2], found[..., 2:]


def _basis(part: np.ndarray, modes: int, shapes) -> np.ndarray:
    """(time, mode, point) f_k at shares (time, point) of the chord."""
    nodes = part.shape[1] - 2
    if shapes is None:
        if isinstance(modes, bool) or not isinstance(modes, int | np.integer) or modes < 1:
            raise InputError(f"modes must be a whole number above zero; got {modes!r}.")
        return np.sin(np.pi * np.arange(1, min(int(modes), nodes) + 1)[None, :, None] * part[:, None])
    given = np.asarray(shapes, dtype=float)
    if given.ndim != 2 or given.shape[1] != nodes + 2 or not 1 <= given.shape[0] <= nodes:
        raise InputError(f"shapes must have shape (modes, {nodes + 2}), one mode to {nodes}; got {given.shape}.")
    if not np.isfinite(part).all():
        raise InputError("shapes are given, but some points of the line are not out all the time: leave shapes out.")
    return given[None] - given[None, :, :1] - (given[:, -1:] - given[:, :1])[None] * part[:, None]
