"""What a stretched segment carries from one of its points to the other: the blocks of its Jacobian.

With e along the chord d (length l, unstretched length l0), w = d' in the turning axes, k = E A / l0, c' = c / l0, T the tension,
the force on the segment's first point changes by K dd + C dw,

    K = (k - T/l) e e^T + (T/l) E + (c'/l) e (w - (e . w) e)^T,    C = c' e e^T                              (1)
    P = s^2 K + s C,    Q = s^2 K,    s = gamma h                                                           (2)

A slack segment, and one whose damping holds the tension at zero, carries nothing. Beside a reel the length l0 = L
moves too, at the rate u = L'. With T_L = -(E A l / L^2), T_u = -(c l / L^2) and pi = -(s^2 T_L + s T_u),

    m_r U_u = s m_r u' + e . (P dU + Q dx') + s^2 T_L L' - pi U_u       where the reel follows its tension         (3)
    U_u = s u' / (1 + s/lag)                                            where it follows a rate                    (4)

so that a reel that gives way carries P less (pi / (m_r + pi)) e e^T P.

A slack segment that may go taut within the step is entered as if it were taut with no tension: otherwise the snap, met by
stages that know nothing of its stiffness, throws the points apart (a slack tape of 500 m was found to gain 2 m/s, with
steps of 0.05 s). With any matrix the method keeps its order, and its error estimate judges the step.
"""

from __future__ import annotations

from math import sqrt

from fieldline.compiled import inner
from fieldline.frames.matrices import matadd, matscale
from fieldline.frames.vectors import axpy, dot, scale

AHEAD = 4.0  # steps gamma h that a slack segment is looked ahead by; see the module's text
NO_BLOCK = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@inner
def outer(a, b):
    """a b^T."""
    return (
        a[0] * b[0], a[0] * b[1], a[0] * b[2],
        a[1] * b[0], a[1] * b[1], a[1] * b[2],
        a[2] * b[0], a[2] * b[1], a[2] * b[2],
    )  # fmt: skip


@inner
def segment_blocks(chord, chord_rate, rest, stiffness, damping, tension, s):
    """(P, Q) of (2) and e; chord [m] and its rate in turning axes [m/s], T [N]."""
    length = sqrt(dot(chord, chord))
    e = scale(1.0 / length, chord)
    if tension <= 0.0 and length + AHEAD * s * abs(dot(e, chord_rate)) < rest:
        return NO_BLOCK, NO_BLOCK, e
    k, c, t = stiffness / rest, damping / rest, tension / length
    across = scale(c / length, axpy(-dot(e, chord_rate), e, chord_rate))
    both = outer(e, e)
    bend = matadd(matscale(k - t, both), outer(e, across))
    elastic = matscale(s * s, (bend[0] + t, bend[1], bend[2], bend[3], bend[4] + t, bend[5], bend[6], bend[7], bend[8] + t))
    return matadd(elastic, matscale(s * c, both)), elastic, e


@inner
def feed_slopes(length, rest, stiffness, damping, s):
    """(T_L, pi) of a segment beside a reel [N/m, kg]."""
    slope = -stiffness * length / (rest * rest)
    return slope, -s * s * slope + s * damping * length / (rest * rest)
