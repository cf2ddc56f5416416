"""How a line hangs in orbital axes: its chord, how far it bows from it, and how the bow goes round (skiprope).

Points 0..p-1 of a line at r, v in inertial axes, 0 at its from_body; orbital axes o of a centre (r_c, v_c), which turn at
w = r_c x v_c / |r_c|^2,

    x = C_oi (r - r_c),    x' = C_oi (v - v_c - w x (r - r_c))                                                (1)

The chord from end to end, pointed down the line at the start (towards the end that is nearer to the Earth), d = +-chord / L:

    in plane = atan2(d_x, d_z),    across it = asin(d_y)                                                      (2)

Lateral axes e_1, e_2 = the part of y_o across d, made a unit vector, e_1 = e_2 x d, so that for a vertical line they are
x_o (along the track) and y_o (against the orbit's normal). The deflection of a point at s along the chord, and its rate,

    q_k = e_k . (x - x_0),    q_k' = e_k . (x' - x'_0 - (s / L) (x'_1 - x'_0))                                (3)

(3) leaves out the turn of the lateral axes about the chord, of second order in the libration. The bow of a line is the first
half wave in its deflection, b = (b_1, b_2), fitted by least squares over the points to sin(pi s / L). About its mean over a
period it is an ellipse,

    b = mean + a_p exp(i w t) + a_m exp(-i w t),    a_p^2 + a_m^2 = <|b|^2>,    a_p^2 - a_m^2 = <b x b'> / w   (4)

with w^2 = <|b'|^2> / <|b|^2>, means over a sliding period: semi-axes a_p + a_m and |a_p - a_m|, and a circular skiprope turns
right-handed about d (seen from above: clockwise) where a_p is all, left-handed where a_m is.

Valid for chords that are not along the orbit's normal and for one output in half a period, or more.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fieldline.frames.orbital import dcm_oi

STRAIGHT = 1e-7  # deflection over length below which a line counts as straight
LEAST_IN_PERIOD = 3  # outputs


class LineShape(NamedTuple):
    """A line over time in orbital axes; NaN for points that are not out."""

    point_o: np.ndarray  # (n, p, 3) [m] from the centre
    chord_m: np.ndarray  # (n,) [m] from end to end
    down_o: np.ndarray  # (n, 3) the chord's direction d
    in_plane_rad: np.ndarray  # (n,) equation (2), without jumps
    across_rad: np.ndarray  # (n,)
    along_m: np.ndarray  # (n, p) [m] s of each point along the chord, from the from_body
    lateral_o: np.ndarray  # (n, 2, 3) e_1, e_2
    deflection_m: np.ndarray  # (n, p, 2) equation (3)
    deflection_rate_m_s: np.ndarray  # (n, p, 2)
    bow_m: np.ndarray  # (n, 2) first half wave
    bow_rate_m_s: np.ndarray  # (n, 2)

    @property
    def largest_m(self) -> np.ndarray:
        """(n,) [m] largest deflection of any point."""
        return np.nanmax(np.linalg.norm(self.deflection_m, axis=2), axis=1)

    @property
    def bows(self) -> bool:
        """Whether it has nodes that ever leave the chord."""
        return self.point_o.shape[1] > 2 and bool((self.largest_m > STRAIGHT * self.chord_m).any())


class Skiprope(NamedTuple):
    """Equation (4), over a sliding period of the whole run's swing."""

    mean_m: np.ndarray  # (n, 2) the steady bow [m]
    semi_major_m: np.ndarray  # (n,)
    semi_minor_m: np.ndarray  # (n,)
    phase_rad: np.ndarray  # (n,) of the bow about its mean, from e_1 to e_2, without jumps
    rate_rad_s: np.ndarray  # (n,) w of (4)
    sense: np.ndarray  # (n,) -1 to 1: a circle left-handed, a swing in one plane, a circle right-handed about d


def shape_of_line(
    position_i_m: np.ndarray, velocity_i_m_s: np.ndarray, centre_i_m: np.ndarray, centre_velocity_i_m_s: np.ndarray
) -> LineShape:
    """Equations (1) to (3) of points (n, p, 3) [m], [m/s] about centres (n, 3) [m], [m/s], all in inertial axes.

    Points that are not out are NaN; the first and the last, the attachments, are always there.
    """
    turn = dcm_oi(centre_i_m, centre_velocity_i_m_s)
    spin = np.cross(centre_i_m, centre_velocity_i_m_s) / np.sum(centre_i_m**2, axis=1, keepdims=True)
    away = position_i_m - centre_i_m[:, None]
    moving = velocity_i_m_s - centre_velocity_i_m_s[:, None] - np.cross(spin[:, None], away)
    place, rate = (np.einsum("nij,npj->npi", turn, one) for one in (away, moving))
    return _seen(place, rate)


def _seen(place: np.ndarray, rate: np.ndarray) -> LineShape:
    """Equations (2) and (3) of places and rates in orbital axes."""
    chord = place[:, -1] - place[:, 0]
    length = np.maximum(np.linalg.norm(chord, axis=1), 1e-9)
    unit = chord / length[:, None]
    down = unit if unit[0, 2] >= 0.0 else -unit
    lateral = lateral_axes(down)
    from_start, rate_from_start = place - place[:, :1], rate - rate[:, :1]
    along = np.einsum("nj,npj->np", unit, from_start)
    turning = rate_from_start - (along / length[:, None])[..., None] * rate_from_start[:, -1:]
    deflection, deflection_rate = (np.einsum("nkj,npj->npk", lateral, one) for one in (from_start, turning))
    return LineShape(
        point_o=place,
        chord_m=length,
        down_o=down,
        in_plane_rad=np.unwrap(np.arctan2(down[:, 0], down[:, 2])),
        across_rad=np.arcsin(np.clip(down[:, 1], -1.0, 1.0)),
        along_m=along,
        lateral_o=lateral,
        deflection_m=deflection,
        deflection_rate_m_s=deflection_rate,
        bow_m=first_half_wave(along / length[:, None], deflection),
        bow_rate_m_s=first_half_wave(along / length[:, None], deflection_rate),
    )


def lateral_axes(down_o: np.ndarray) -> np.ndarray:
    """(n, 2, 3) e_1 and e_2 of unit vectors (n, 3)."""
    second = np.array([0.0, 1.0, 0.0]) - down_o[:, 1:2] * down_o
    second /= np.maximum(np.linalg.norm(second, axis=1, keepdims=True), 1e-12)
    return np.stack([np.cross(second, down_o), second], axis=1)


def first_half_wave(fraction: np.ndarray, lateral: np.ndarray) -> np.ndarray:
    """(n, 2) least-squares coefficients of sin(pi s / L) in (n, p, 2), s / L (n, p); zero of a line without nodes."""
    wave = np.where(np.isfinite(fraction), np.sin(np.pi * np.clip(fraction, 0.0, 1.0)), 0.0)
    weight = np.sum(wave**2, axis=1)
    total = np.einsum("np,npk->nk", wave, np.where(np.isfinite(lateral), lateral, 0.0))
    return np.where(weight[:, None] > 1e-12, total / np.maximum(weight, 1e-12)[:, None], 0.0)


def skiprope_of(shape: LineShape, seconds: np.ndarray) -> Skiprope | None:
    """Equation (4); None where the line does not bow, or the run is shorter than a period or holds too few outputs of it."""
    if not shape.bows or len(seconds) < 2 * LEAST_IN_PERIOD:
        return None
    bow, rate = _complex(shape.bow_m), _complex(shape.bow_rate_m_s)
    step = float(np.median(np.diff(seconds)))
    period = _period_s(bow, rate)
    width = max(LEAST_IN_PERIOD, round(period / step)) if np.isfinite(period) else len(seconds)
    if width >= len(seconds):
        return None
    mean = _sliding(bow, width)
    swing, pace = bow - mean, rate - _sliding(rate, width)
    size, speed = (_sliding(np.abs(one) ** 2, width) for one in (swing, pace))
    area = _sliding((np.conj(swing) * pace).imag, width)
    frequency = np.sqrt(speed / np.maximum(size, 1e-30))
    difference = np.clip(area / np.maximum(frequency, 1e-30), -size, size)
    right, left = np.sqrt(0.5 * (size + difference)), np.sqrt(0.5 * (size - difference))
    return Skiprope(
        mean_m=np.stack([mean.real, mean.imag], axis=1),
        semi_major_m=right + left,
        semi_minor_m=np.abs(right - left),
        phase_rad=np.unwrap(np.angle(swing)),
        rate_rad_s=frequency,
        sense=difference / np.maximum(size, 1e-30),
    )


def _period_s(bow: np.ndarray, rate: np.ndarray) -> float:
    """The period of the whole run's swing, from its speed over its size."""
    size, speed = float(np.var(bow)), float(np.var(rate))
    return 2.0 * np.pi * np.sqrt(size / speed) if speed > 0.0 else np.inf


def _complex(pair: np.ndarray) -> np.ndarray:
    """(n,) e_1 + i e_2."""
    return pair[:, 0] + 1j * pair[:, 1]


def _sliding(values: np.ndarray, width: int) -> np.ndarray:
    """(n,) means over the `width` values about each; near the ends over the first and the last `width`."""
    total = np.concatenate([[0.0], np.cumsum(values)])
    middle = np.arange(len(values))
    first = np.clip(middle - width // 2, 0, len(values) - width)
    return (total[first + width] - total[first]) / width
