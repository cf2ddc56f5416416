"""Any body that cones about a known axis while it measures a known vector: a spinning satellite that nutates.

Axes c about the cone's axis take the place of (U, V, W). A body that also spins about its own axis turns C1 and C2 with the
spin; C3 is the part along that axis and does not. The spin shows in the part of the field across the axes, as the yaw of
the skiprope does,

    a3(t) = AZ - arg((B_S1 + i B_S2) / i)  (+ tan EL times the tilt)                                               (1)

and a smooth curve through it turns the measurement back; then everything that holds for the skiprope holds:

    signals = cone_signals(seconds, field_b, field_i, body_axis=axis_b, cone_axis=momentum_i)
    estimate_skiprope(signals, tether_length_m=pi, yaw_std_rad=pi, band_hz=(low, high))

with any length for the tether's, and a yaw of which nothing is known beforehand.

Source: the remark in section V of Polites (1991), NASA TP-3123; (1) is ours.
Valid while the tilt is small and the field is not along the axis; samples must come more often than twice a turn, or the
spin rate must be given to within that.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fieldline.errors import InputError
from fieldline.estimation.skiprope.signals import FieldGeometry, SkipropeSignals, skiprope_signals


class Despun(NamedTuple):
    """The field [T] in axes that do not spin, (n, 3), and the smooth spin angle a3 [rad], (n,), taken out of it."""

    field_b: np.ndarray
    spin_rad: np.ndarray


def axes_about(axis) -> np.ndarray:
    """(3, 3) with v_c = dcm @ v: right-handed axes, the third along `axis` (3,), the first across it."""
    given = np.asarray(axis, dtype=float)
    size = np.linalg.norm(given)
    if given.shape != (3,) or not 0.0 < size < np.inf:
        raise InputError(f"axis must be one vector (3,), not zero; got {axis!r}.")
    third = given / size
    across = np.eye(3)[np.abs(third).argmin()]
    first = across - third * (third @ across)
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(third, first), third])


def cone_signals(
    seconds, field_b, field_i, *, body_axis, cone_axis, degree: int | None = 1, spin_rate_rad_s: float = 0.0
) -> SkipropeSignals:
    """Signals of a body that cones about a known axis while it measures a known vector.

    Parameters
    ----------
    seconds : (n,) [s]. field_b : (n, 3) measured, body axes. field_i : (n, 3) known, axes in which the cone's stands still.
    body_axis : (3,) of the body, that cones. cone_axis : (3,) about which it does, on the same side as body_axis.
    degree, spin_rate_rad_s : of the spin, as in `despun`; None for a body that does not spin.

    Errors: those of `axes_about` and `skiprope_signals`.
    """
    measured = np.asarray(field_b, dtype=float) @ axes_about(body_axis).T
    signals = skiprope_signals(seconds, measured, np.asarray(field_i, dtype=float) @ axes_about(cone_axis).T)
    if degree is None:
        return signals
    steady = despun(signals.seconds, signals.field_b, signals.geometry, degree=degree, spin_rate_rad_s=spin_rate_rad_s)
    return SkipropeSignals(signals.seconds, steady.field_b, signals.geometry)


def despun(seconds, field_b, geometry: FieldGeometry, *, degree: int = 1, spin_rate_rad_s: float = 0.0) -> Despun:
    """Turn a spinning body's field (n, 3) [T], third axis the spin's, back about that axis by a polynomial through (1).

    degree : 1 for a constant rate. spin_rate_rad_s : what is known of the rate, where samples are too few for (1) alone.
    """
    times = np.asarray(seconds, dtype=float) - seconds[0]
    measured = np.asarray(field_b, dtype=float)
    across = measured[:, 0] + 1j * measured[:, 1]
    turned = 1j * np.exp(1j * (geometry.azimuth_rad - spin_rate_rad_s * times)) * np.conj(across)
    weight = np.abs(across) / np.linalg.norm(measured, axis=1)
    rest = np.unwrap(np.angle(turned))  # (1)
    scaled = times / max(times[-1], 1.0)
    spin = np.polyval(np.polyfit(scaled, rest, degree, w=weight), scaled) + spin_rate_rad_s * times
    back = across * np.exp(1j * spin)
    return Despun(np.column_stack([back.real, back.imag, measured[:, 2]]), spin)
