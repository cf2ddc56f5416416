"""A line that hangs straight up and down in a circular orbit: how fast it goes round, how far it stretches, how it pulls.

In axes that turn with the orbit at n the springs balance weight and centrifugal force at every point,

    D' (w T) = m (n^2 r - GM / r^2),    T = E A D u,    r = r0 + s + u                                       (1)

one of the points, or the centre of mass, stands at a given radius, and the sum of (1) over all points gives

    n^2 sum(m r) = GM sum(m / r^2)                                                                           (2)

(1) is solved for u and n together by Newton's method. Without stretch, with r1 and r2 the radii of the ends,

    n^2 = GM {m1 / r1^2 + m2 / r2^2 + mu (1/r1 - 1/r2)} / {m1 r1 + m2 r2 + mu (r2^2 - r1^2) / 2}             (3)
    T(r) = m1 (GM / r1^2 - n^2 r1) + mu {GM (1/r1 - 1/r) - n^2 (r^2 - r1^2) / 2}                             (4)

Valid for a point Earth; the bodies' own sizes, air and heat are left out.
"""

from __future__ import annotations

from math import sqrt
from typing import Literal, NamedTuple, get_args

import numpy as np

from fieldline.analysis.tether.grid import Grid
from fieldline.constants import EARTH_GM_M3_S2
from fieldline.errors import InputError, nearest

Anchor = Literal["upper", "lower", "centre"]
MOST_STRAIN = 1.0  # beyond it a line is not elastic, and hardly a line


class Hanging(NamedTuple):
    """A line at rest in the orbit's turning axes."""

    rate: float  # n [rad/s]
    radius: np.ndarray  # (p,) [m], from the Earth's centre, rising
    tension: np.ndarray  # (q,) [N], at the grid's stations
    stretch: np.ndarray  # (p,) [m], u: displacement against the unstretched line, zero at the lower end
    grid: Grid

    @property
    def height(self) -> np.ndarray:
        """(p,) [m] above the lower end, along the stretched line."""
        return self.grid.place + self.stretch

    @property
    def centre_radius(self) -> float:
        """[m] of the mass centre."""
        return float(self.grid.mass @ self.radius / self.grid.mass.sum())


def hang(grid: Grid, radius_m: float, anchor: Anchor = "upper", gm_m3_s2: float = EARTH_GM_M3_S2) -> Hanging:
    """The state of rest (1) of a line whose upper end, lower end or mass centre is at radius_m [m].

    Raises
    ------
    InputError : an anchor that is none of the three, or a line so soft that it has no state of rest.
    """
    if anchor not in get_args(Anchor):
        raise InputError(f'anchor is "{anchor}"; {nearest(str(anchor), get_args(Anchor))}')
    mass, points = grid.mass, len(grid.mass)
    hold = {"upper": np.eye(points)[-1], "lower": np.eye(points)[0], "centre": mass / mass.sum()}[anchor]
    springs = grid.slope.T @ ((grid.weight * grid.stiffness)[:, None] * grid.slope)
    straight = radius_m + grid.place - hold @ grid.place
    unit = gm_m3_s2 / radius_m**3
    u, ratio, last = np.zeros(points), 1.0, np.inf
    for _ in range(40):
        r = straight + u
        push = mass * (ratio * unit * r - gm_m3_s2 / r**2) - springs @ u
        matrix = np.zeros((points + 1, points + 1))
        matrix[:points, :points] = springs - np.diag(mass * (ratio * unit + 2.0 * gm_m3_s2 / r**3))
        matrix[:points, points] = -mass * unit * r
        matrix[points, :points] = hold
        step = np.linalg.solve(matrix, np.append(push, -hold @ u))
        u, ratio = u + step[:points], ratio + step[points]
        size = float(np.abs(step[:points]).max() / np.abs(u).max(initial=1e-300))
        if size < 1e-13 or (size < 1e-9 and size > 0.5 * last):
            break
        last = size
    else:
        raise InputError(_soft(grid))
    tension = grid.stiffness * (grid.slope @ u)
    if not (ratio > 0.0 and np.all(np.abs(tension) < MOST_STRAIN * grid.stiffness)):
        raise InputError(_soft(grid))
    return Hanging(sqrt(ratio * unit), straight + u, tension, u - u[0], grid)


def _soft(grid: Grid) -> str:
    """What to say of a line that its load stretches to more than twice its length."""
    return (
        f"axial_stiffness_n = {grid.stiffness.min():g} N is too soft for a line of {grid.place[-1]:g} m with these masses: "
        "it stretches to more than twice its length. Is the unit newton (Young's modulus times cross-section)?"
    )


def inextensible_rate(
    lower_m: float, upper_m: float, lower_kg: float, upper_kg: float, linear_mass: float, gm_m3_s2: float = EARTH_GM_M3_S2
) -> float:
    """n [rad/s] of a line that does not stretch, from radius lower_m to upper_m [m]; equation (3)."""
    weight = lower_kg / lower_m**2 + upper_kg / upper_m**2 + linear_mass * (1.0 / lower_m - 1.0 / upper_m)
    moment = lower_kg * lower_m + upper_kg * upper_m + 0.5 * linear_mass * (upper_m**2 - lower_m**2)
    return sqrt(gm_m3_s2 * weight / moment)


def inextensible_tension(
    radius_m, rate_rad_s: float, lower_m: float, lower_kg: float, linear_mass: float, gm_m3_s2: float = EARTH_GM_M3_S2
):
    """T [N] at radii (...) [m] of a line that does not stretch; equation (4)."""
    r = np.asarray(radius_m, dtype=float)
    end = lower_kg * (gm_m3_s2 / lower_m**2 - rate_rad_s**2 * lower_m)
    return end + linear_mass * (gm_m3_s2 * (1.0 / lower_m - 1.0 / r) - 0.5 * rate_rad_s**2 * (r**2 - lower_m**2))
