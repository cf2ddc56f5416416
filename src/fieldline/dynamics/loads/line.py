"""A massless visco-elastic line between two points: it pulls, and never pushes.

    T = max(0, E A (l - l0) / l0 + c (dl/dt) / l0)   where l > l0, else 0                                   (1)

l: distance of the attachment points; l0: unstretched length; c [N s]: tension per rate of strain. The damping cannot
turn the pull into a push, and a slack line does nothing. Force and torque on either end follow; momentum and angular
momentum of the pair are conserved to rounding, since both ends take the same force along the line that joins them.

Source: the massless tether of the 1982 DUMBEL program (Smithsonian Astrophysical Observatory), s. 3.1.
"""

from __future__ import annotations

from fieldline.compiled import kernel
from fieldline.frames.vectors import dot, norm, scale, sub


@kernel
def line_tension(stretched, rate, length, stiffness, damping):
    """T [N] at a length [m] and its rate [m/s]; equation (1)."""
    if stretched <= length:
        return 0.0
    return max(0.0, (stiffness * (stretched - length) + damping * rate) / length)


@kernel
def line_pull(from_i, from_rate_i, to_i, to_rate_i, length, stiffness, damping):
    """Force [N] on the end at `from_i` (the other takes its opposite), axes as given."""
    chord = sub(to_i, from_i)
    stretched = norm(chord)
    if stretched <= length:
        return (0.0, 0.0, 0.0)
    rate = dot(chord, sub(to_rate_i, from_rate_i)) / stretched
    return scale(line_tension(stretched, rate, length, stiffness, damping) / stretched, chord)
