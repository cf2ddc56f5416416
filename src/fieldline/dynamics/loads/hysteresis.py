"""Rods of soft iron that take a tumbler's energy by being magnetised to and fro.

    H = axis . B / mu0,     m = V b / mu0 along the axis                                                    (1)
    H_b = tan(pi b / 2 Bs) / k,     k = tan(pi Br / 2 Bs) / Hc                                              (2)
    f = (H - H_b + Hc) / 2 Hc   where H rises,    f = (H_b + Hc - H) / 2 Hc   where it falls                  (3)
    db/dH = (2 Bs k / pi) cos^2(pi b / 2 Bs) f^2                                                            (4)
    dH/dt = axis . (A dB_i/dt - omega x B_b) / mu0                                                          (5)

b: induction of the rod [T], a state of its own. (2) is the middle of the limiting loop whose branches lie Hc to either
side; on the branch that is being followed f = 1 and (4) is that branch's slope; after a turn-back f starts small and
the path closes in on the other branch. Bs, Br, Hc: saturation, remanence, coercivity of the rod as built, that is with
its demagnetisation already in them (they differ from the material's by orders of magnitude in short rods).

Source: the model of Flatley and Henretty (1995), NASA Goddard flight mechanics symposium, with q0 = 0 and p = 2.
Validity: quasi-static (well below 10 Hz), rods that do not feel each other, uniform magnetisation.
"""

from __future__ import annotations

from math import atan, cos, pi, tan

from fieldline.compiled import kernel
from fieldline.constants import MU0_OVER_4PI

MU0 = 4.0 * pi * MU0_OVER_4PI
NEARLY_FULL = 0.99999  # of saturation: beyond it the tangent of (2) has no digits left


@kernel
def middle_field(induction, saturation, remanence, coercivity):
    """H_b [A/m] and k [m/A] of equation (2)."""
    k = tan(0.5 * pi * remanence / saturation) / coercivity
    full = min(max(induction / saturation, -NEARLY_FULL), NEARLY_FULL)
    return tan(0.5 * pi * full) / k, k


@kernel
def induction_rate(field, field_rate, induction, saturation, remanence, coercivity):
    """db/dt [T/s] at H [A/m], dH/dt [A/m/s] and b [T]; equations (3) and (4)."""
    middle, k = middle_field(induction, saturation, remanence, coercivity)
    if field_rate >= 0.0:
        part = (field - middle + coercivity) / (2.0 * coercivity)
    else:
        part = (middle + coercivity - field) / (2.0 * coercivity)
    part = min(max(part, 0.0), 1.0)  # outside the limiting loop, as at a start in a strong field: along its branch
    full = min(max(induction / saturation, -1.0), 1.0)
    slope = (2.0 * saturation * k / pi) * cos(0.5 * pi * full) ** 2
    return slope * part * part * field_rate


@kernel
def resting_induction(field, saturation, remanence, coercivity):
    """Induction [T] on the middle of the loop at H [A/m]: a start without history."""
    k = tan(0.5 * pi * remanence / saturation) / coercivity
    return (2.0 * saturation / pi) * atan(k * field)
