"""Loads on a segment that moves through air and field, from what `Ambient` holds.

    F = I (p1 - p0) x B + F_drag                                                                          (1)

I: current, positive from A to B; B: the Earth's field in the middle of the segment; F_drag as in `lines.air`.
"""

from __future__ import annotations

from fieldline.compiled import inner
from fieldline.dynamics.lines.air import segment_drag
from fieldline.frames.vectors import add, cross, scale, sub, vec


@inner
def segment_load(t, k, s, p0, v0, p1, v1, dcm_ei, lines, ambient):
    """Force [N] on segment s of line k between two points, inertial axes; half of it acts at either end."""
    push = scale(ambient.current[s], cross(sub(p1, p0), vec(ambient.field_i, s)))
    if ambient.density[s] == 0.0:
        return push
    pole = (dcm_ei[6], dcm_ei[7], dcm_ei[8])
    return add(push, segment_drag(p0, v0, p1, v1, pole, ambient.density[s], lines.diameter[s], lines.drag_coefficient[s]))
