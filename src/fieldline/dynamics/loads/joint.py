"""Angular damping where a line is attached: a torque against the change of the angle between lever and line.

    N = beta theta' u,   u = r x F / |r x F|,   cos theta = r . F  (unit vectors from here on)               (1)
    theta' = -(r' . F + r . F') / |r x F|                               away from alignment                  (2)
    theta' = u . (r' x F + r x F') / (r . F)                            near alignment                       (3)
    N = beta (r' x F + r x F') / (r . F)                                at it                                (4)
    r' = omega x r,   F' = (p' - F (F . p')) / |p|                                                          (5)

r: lever from the centre of mass to the attachment; F: direction of the line's pull on it, along p from the attachment to
the line's other end. (2) and (3) are the same number; the first loses its digits where r and F are parallel, the second
where they are at right angles, so each is used on its side of 45 degrees. A motion that keeps theta, the lever round a
cone about the line, is not damped. The torque has no reaction on the line: it stands for a stiff last piece of it.

Source: Arnold (1978), Annex III of NASA-CR-170721, s. III-1.4, with the dots and hats restored that its print lost in
theta' near alignment, in (4) and in (5).
"""

from __future__ import annotations

from math import sqrt

from fieldline.compiled import kernel
from fieldline.frames.vectors import add, axpy, cross, dot, norm, scale

ALIGNED = 1e-14  # |r x F| below which its direction is rounding


@kernel
def direction_rate(chord, chord_rate):
    """F [-] and F' [1/s] of a chord p and its rate; equation (5)."""
    length = norm(chord)
    along = scale(1.0 / length, chord)
    return along, scale(1.0 / length, axpy(-dot(along, chord_rate), along, chord_rate))


@kernel
def joint_torque(lever, omega, chord, chord_rate, damping):
    """N [N m] of (1) from lever and chord [m], rates [rad/s, m/s] and beta [N m s], tuples in the same inertial axes."""
    arm = scale(1.0 / sqrt(dot(lever, lever)), lever)
    arm_rate = cross(omega, arm)
    pull, pull_rate = direction_rate(chord, chord_rate)
    across, along = cross(arm, pull), dot(arm, pull)
    sine = norm(across)
    turning = add(cross(arm_rate, pull), cross(arm, pull_rate))
    if sine < ALIGNED:
        return scale(damping / along, turning)  # (4)
    u = scale(1.0 / sine, across)
    if abs(along) > sine:
        rate = dot(u, turning) / along  # (3)
    else:
        rate = -(dot(arm_rate, pull) + dot(arm, pull_rate)) / sine  # (2)
    return scale(damping * rate, u)  # (1)
