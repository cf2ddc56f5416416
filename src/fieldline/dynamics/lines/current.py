"""Current in a line that moves through the Earth's field, from its electromotive force and its circuit.

    emf_j = (w_j x B_j) . (p_(j+1) - p_j),       w = v - omega_earth x r                                    (1)

The plasma turns with the Earth, and so does the field in which it has no electric field of its own: w is the speed through
it. A positive emf drives current from A to B; the electrons go the other way, into the line at B and out of it at A.

An insulated line closes its circuit through contactors at its ends. The end that takes electrons in (B for a positive
drive U = sum emf + supply) is a plasma contactor, which takes what is asked, or a sphere of radius a at the potential phi,

    I = J [1 + sqrt(phi / phi_0)],     J = k 2 pi a^2 n e sqrt(T_e / 2 pi m_e),     phi_0 = e B^2 a^2 / (8 m_e)      (2)
    |U| = R I + phi,     R = sum R'_j l_j + load + contactors;      I <= what the other end can emit                 (3)

which is a quadratic in I above J, and I = |U| / R below it. k = 1 is Parker and Murphy's limit along the field lines; the
satellite of TSS-1R collected 2 to 3 times as much (k = 2.5 describes it) since the sphere moves.

Source: Parker and Murphy (1967), J. Geophys. Res. 72, 1631; Thompson et al. (1998), Geophys. Res. Lett. 25, 413 (TSS-1R).
T_e in volts. Valid where the emf is far above the plasma's thermal potential; ion currents of the sphere are left out.
"""

from __future__ import annotations

from math import pi, sqrt

from fieldline.compiled import kernel
from fieldline.constants import ELECTRON_MASS_KG, ELEMENTARY_CHARGE_C
from fieldline.dynamics.lines.air import wind_past
from fieldline.frames.vectors import cross, dot, sub, vec


@kernel
def segment_emf(p0, v0, p1, v1, pole_i, field_i):
    """emf [V] of equation (1) from p0 to p1; field_i [T] in the middle; pole_i: unit vector of the Earth's axis."""
    return dot(cross(wind_past(p0, v0, p1, v1, pole_i), field_i), sub(p1, p0))


@kernel
def line_emfs(points, velocities, pole_i, field_i, out):
    """emf of every segment into `out` (n,), and their sum [V]; points, velocities (n + 1, 3), field_i (n, 3)."""
    total = 0.0
    for j in range(out.shape[0]):
        p0, v0, p1, v1 = vec(points, j), vec(velocities, j), vec(points, j + 1), vec(velocities, j + 1)
        out[j] = segment_emf(p0, v0, p1, v1, pole_i, vec(field_i, j))
        total += out[j]
    return total


@kernel
def sphere_limit(radius, density, field, temperature_ev, gain):
    """(J [A], phi_0 [V]) of equation (2) for a sphere [m] in a plasma [1/m^3] and a field of this strength [T]."""
    charge_to_mass = ELEMENTARY_CHARGE_C / ELECTRON_MASS_KG
    thermal = ELEMENTARY_CHARGE_C * density * sqrt(charge_to_mass * temperature_ev / (2.0 * pi))
    return gain * 2.0 * pi * radius**2 * thermal, charge_to_mass * (field * radius) ** 2 / 8.0


@kernel
def series_current(drive, resistance, collected, scale_potential, emitted):
    """I [A] of equation (3), with the sign of `drive` [V].

    resistance : of everything in the circuit [ohm].   collected, scale_potential : J, phi_0 of the end that takes
    electrons in; collected < 0 for a plasma contactor without limit.   emitted : what the other end can emit [A].
    """
    pull = abs(drive)
    current = pull / resistance
    if collected == 0.0:
        return 0.0
    if 0.0 < collected < current:
        a = scale_potential / collected**2
        rest = pull - resistance * collected
        current = collected + 2.0 * rest / (resistance + sqrt(resistance**2 + 4.0 * a * rest))  # I - J of the quadratic
    current = min(current, emitted)
    return current if drive > 0.0 else -current
