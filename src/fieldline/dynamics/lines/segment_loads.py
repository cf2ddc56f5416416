"""Loads on a segment that moves through air and field, from what `Ambient` holds.

    F = I (p1 - p0) x B                                                                                   (1)

I: current, positive from A to B; B: the Earth's field in the middle of the segment.
"""

from __future__ import annotations

from fieldline.compiled import inner
from fieldline.frames.vectors import cross, scale, sub, vec


@inner
def segment_load(t, k, s, p0, v0, p1, v1, dcm_ei, lines, ambient):
    """Force [N] on segment s of line k between two points, inertial axes; half of it acts at either end."""
    return scale(ambient.current[s], cross(sub(p1, p0), vec(ambient.field_i, s)))
