"""Point masses at the ends of lines, fixed in the body that carries them: how its accelerations follow from its loads.

    M a + alpha x S = F',    (I + J) alpha + S x a = N'                                                   (1)
    F' = F - omega x (omega x S),    N' = N - omega x ((I + J) omega)
    [I + J - (S^2 E - S S^T) / M] alpha = N' - S x F' / M,    a = (F' - alpha x S) / M                      (2)

M the mass of the body and its end masses m at the places p, S = sum m p, J = sum m (p^2 E - p p^T), a the acceleration of
the body's own centre of mass. F and N hold the end masses' weight; a wheel's momentum carried round is in N. All in body
axes. (2) is (1) with a eliminated: what is left of the inertia is positive definite for any places and masses.
"""

from __future__ import annotations

from fieldline.compiled import inner
from fieldline.frames.matrices import inverse, matadd, matscale, matvec
from fieldline.frames.vectors import cross, dot, scale, sub


@inner
def spread(end_mass):
    """J of an end mass's ten numbers, as a 9-tuple."""
    xx, yy, zz, xy, xz, yz = end_mass[4], end_mass[5], end_mass[6], end_mass[7], end_mass[8], end_mass[9]
    return (xx, xy, xz, xy, yy, yz, xz, yz, zz)


@inner
def burdened_rates(omega, mass, inertia, end_mass, force_b, torque_b):
    """(a, alpha) of equation (2), body axes [m/s^2, rad/s^2]; `force_b`, `torque_b`: everything that acts, weights too."""
    total = mass + end_mass[0]
    s = (end_mass[1], end_mass[2], end_mass[3])
    both = matadd(inertia, spread(end_mass))
    push = sub(force_b, cross(omega, cross(omega, s)))
    turn = sub(torque_b, cross(omega, matvec(both, omega)))
    square = dot(s, s)
    off = (
        s[0] * s[0] - square, s[0] * s[1], s[0] * s[2],
        s[1] * s[0], s[1] * s[1] - square, s[1] * s[2],
        s[2] * s[0], s[2] * s[1], s[2] * s[2] - square,
    )  # fmt: skip
    left = matadd(both, matscale(1.0 / total, off))
    alpha = matvec(inverse(left), sub(turn, scale(1.0 / total, cross(s, push))))
    return scale(1.0 / total, sub(push, cross(alpha, s))), alpha
