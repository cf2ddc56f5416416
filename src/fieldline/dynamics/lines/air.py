"""Air drag on a segment, and the heat that the air brings.

    F = -1/2 rho C_D d |l x w| w,     w = (v0 + v1)/2 - omega_earth x r                                    (1)
    q = 1/2 rho d |e x w| w^2                                                                              (2)

d: diameter (of a tape, circumference over pi); l = p1 - p0, e its direction; w: the segment's speed through air that turns
with the Earth; r its middle. |l x w| d / |w| is the area that the wind sees, for any angle between line and wind. Molecules
rarely meet above 150 km: each gives all of its momentum along the wind, C_D = 2 to 2.4 for diffuse re-emission, and all of
its energy, so (2) is an upper bound that real surfaces reach within 10 %. The flow along a line, thermal motion against
the orbital speed, is left out: it matters where line and wind are parallel within 5 degrees.

Source: Sentman (1961), Free molecule flow theory, LMSC-448514, in the limit of fast flow; Vallado (2013), s. 8.6.2.
"""

from __future__ import annotations

from math import sqrt

from fieldline.compiled import kernel
from fieldline.constants import EARTH_ROTATION_RATE_RAD_S
from fieldline.frames.vectors import add, axpy, cross, dot, norm, scale, sub


@kernel
def wind_past(p0, v0, p1, v1, pole_i):
    """w of (1) [m/s] in the middle of a segment between two points; pole_i: unit vector of the Earth's axis."""
    middle, speed = scale(0.5, add(p0, p1)), scale(0.5, add(v0, v1))
    return axpy(-EARTH_ROTATION_RATE_RAD_S, cross(pole_i, middle), speed)


@kernel
def segment_drag(p0, v0, p1, v1, pole_i, density, diameter, drag_coefficient):
    """Force [N] of equation (1) on a segment between two points, inertial axes; half of it acts at either end."""
    wind = wind_past(p0, v0, p1, v1, pole_i)
    return scale(-0.5 * density * drag_coefficient * diameter * norm(cross(sub(p1, p0), wind)), wind)


@kernel
def air_heating(chord, wind, density, diameter):
    """q [W/m] of equation (2); chord: p1 - p0 [m], of any length above zero."""
    across = cross(chord, wind)
    return 0.5 * density * diameter * sqrt(dot(across, across) / dot(chord, chord)) * dot(wind, wind)
