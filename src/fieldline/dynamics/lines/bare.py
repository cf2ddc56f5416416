"""Current along a bare line that collects electrons over its own length, by orbital-motion-limited theory.

With x from the anodic end, V the line's potential against the plasma beside it, I the electrons' current towards the
cathode at the other end, E the motional field along the line and R' its resistance per length,

    dV/dx = R' I - E                                                                                       (1)
    dI/dx = e n d sqrt(2 e / m_e) f(V),     f = V / (V^2 + V_T^2)^(1/4)   for V > 0                         (2)
                                            f = sqrt(m_e / m_i) V / (V^2 + V_T^2)^(1/4)   for V < 0
    I(0) = 0,      V(L) = -(V_c + Z I(L))                                                                   (3)

d: diameter (of a tape, circumference over pi); V_c: what the cathode needs to emit; Z: load between line and cathode;
V_T: the electrons' temperature in volts, which rounds off f = sqrt(V) near zero and changes currents by (V_T / E L)^1.5.
Ions arrive at the far part, where V < 0. A line whose emf has the wrong sign for its cathode carries nothing.

Each cell has its own E, R', n, from those of its segment; V runs linearly within it, so that f's mean over the cell is a
quotient of differences of its integral,

    I1 - I0 = g F[V0, V1],  g = e n d sqrt(2 e / m_e) h;      V1 - V0 = R' h (I0 + I1)/2 - E h              (4)

also where V passes zero. Newton's method on (4) and (3) by one sweep: dI = P dV + q is carried from the anode, with P
never negative since f rises, then dV comes back from the cathode. It holds for long lines too, where V and R' I - E are
zero over kilometres and shooting from either end fails. The cells' error is of second order: 5e-4 of the current for 64.

Source: Sanmartin, Martinez-Sanchez and Ahedo (1993), J. Propul. Power 9(3), 353. Valid for d below the Debye length (some
4 mm by day) and tapes up to four times that; the speed through the plasma raises the real current, by an unsettled factor.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from fieldline.compiled import kernel
from fieldline.constants import ATOMIC_MASS_KG, ELECTRON_MASS_KG, ELEMENTARY_CHARGE_C

LEAST_CELLS = 64
WORK_ROWS = 12  # of the scratch array: V, I and their step, P, q, two terms of the sweep, the same four of a trial
MOST_NEWTON = 100
CONVERGED = 1e-9  # of the total drive and of the largest current
LEAST_STEP = 1.0 / 4096.0  # of a Newton step, below which it is taken as it is


def bare_work(segments: int) -> tuple[np.ndarray, np.ndarray]:
    """Scratch for lines of up to so many segments."""
    return np.empty((WORK_ROWS, LEAST_CELLS + 2 * segments + 1)), np.empty((3, segments))


@kernel
def gathering(diameter, density):
    """e n d sqrt(2 e / m_e) of equation (2) [A/m/V^0.5]."""
    return ELEMENTARY_CHARGE_C * density * diameter * sqrt(2.0 * ELEMENTARY_CHARGE_C / ELECTRON_MASS_KG)


@kernel
def _law(v, thermal, ions):
    """f of equation (2)."""
    value = v / sqrt(sqrt(v * v + thermal * thermal))
    return value if v > 0.0 else ions * value


@kernel
def _slope(v, thermal, ions):
    """df/dV."""
    square = v * v + thermal * thermal
    value = (0.5 * v * v + thermal * thermal) / (square * sqrt(sqrt(square)))
    return value if v > 0.0 else ions * value


@kernel
def _whole(v, thermal, ions):
    """Integral of f from 0 to V."""
    square = v * v + thermal * thermal
    value = 2.0 / 3.0 * (sqrt(square * sqrt(square)) - thermal * sqrt(thermal))
    return value if v > 0.0 else ions * value


@kernel
def _mean(v0, v1, thermal, ions):
    """(mean of f between V0 and V1, its derivatives by V0 and by V1)."""
    step = v1 - v0
    if abs(step) <= 1e-5 * (thermal + abs(v0)):
        middle = 0.5 * (v0 + v1)
        half = 0.5 * _slope(middle, thermal, ions)
        return _law(middle, thermal, ions), half, half
    mean = (_whole(v1, thermal, ions) - _whole(v0, thermal, ions)) / step
    return mean, (mean - _law(v0, thermal, ions)) / step, (_law(v1, thermal, ions) - mean) / step


@kernel
def _sweep(at, drive, resistance, gather, end_of_line, cells, work):
    """Newton's step for (4) and (3) at V, I of rows `at` of `work` into the two rows below; the residual before it, scaled."""
    drop, load, thermal, ions, v_scale, i_scale = end_of_line
    v, i, dv, di, p, q = work[at], work[at + 1], work[at + 2], work[at + 3], work[4], work[5]
    each = cells // drive.shape[0]
    p[0], q[0] = 0.0, -i[0]
    worst = abs(i[0]) / i_scale
    for k in range(cells):
        s = k // each
        half = 0.5 * resistance[s] / each
        g = gather[s] / each
        mean, by0, by1 = _mean(v[k], v[k + 1], thermal, ions)
        rho = i[k] + g * mean - i[k + 1]
        sigma = v[k] + half * (i[k] + i[k + 1]) - drive[s] / each - v[k + 1]
        worst = max(worst, max(abs(rho) / i_scale, abs(sigma) / v_scale))
        back = 1.0 / (1.0 + half * p[k])
        gain = (p[k] + g * by0) * back
        down = 1.0 / (1.0 + gain * half)
        p[k + 1] = (gain + g * by1) * down
        q[k + 1] = (q[k] + rho - gain * (half * q[k] + sigma)) * down
        work[6, k] = half
        work[7, k] = sigma
    end = v[cells] + drop + load * i[cells]
    worst = max(worst, abs(end) / v_scale)
    dv[cells] = -(end + load * q[cells]) / (1.0 + load * p[cells])
    di[cells] = p[cells] * dv[cells] + q[cells]
    for k in range(cells - 1, -1, -1):
        half = work[6, k]
        dv[k] = (dv[k + 1] - half * (di[k + 1] + q[k]) - work[7, k]) / (1.0 + half * p[k])
        di[k] = p[k] * dv[k] + q[k]
    return worst


@kernel
def _solve(drive, resistance, gather, end_of_line, cells, work):
    """V and I at the cells' ends into rows 0 and 1 of `work`; whether Newton's method got there."""
    for k in range(cells + 1):
        work[0, k] = 0.0
        work[1, k] = 0.0
    worst = _sweep(0, drive, resistance, gather, end_of_line, cells, work)
    for _ in range(MOST_NEWTON):
        if worst < CONVERGED:
            return True
        part = 1.0
        while True:
            for k in range(cells + 1):
                work[8, k] = work[0, k] + part * work[2, k]
                work[9, k] = work[1, k] + part * work[3, k]
            tried = _sweep(8, drive, resistance, gather, end_of_line, cells, work)
            if tried < worst or part < LEAST_STEP:
                break
            part *= 0.5
        worst = tried
        for k in range(cells + 1):
            for row in range(4):
                work[row, k] = work[8 + row, k]
    return False


@kernel
def bare_currents(emf, resistance, gather, cathode_at_b, drop, load, thermal, ion_mass_u, work, out):
    """Mean current of every segment [A, positive from A to B] into `out`; (load's power [W], lost at the cathode [W]).

    emf (n,) [V] from A to B.   resistance (n,) [ohm] of each segment.   gather (n,) : `gathering` times the segment's length.
    cathode_at_b : at B, else at A.   drop : V_c [V].   load : Z [ohm].   thermal : V_T [V].   ion_mass_u : of the ions [u].
    work : scratch of `bare_work` for n segments or more.
    """
    cells_work, rows = work
    n = emf.shape[0]
    cells = n * ((LEAST_CELLS + n - 1) // n)
    total, most = 0.0, 0.0
    for j in range(n):
        s = j if cathode_at_b else n - 1 - j
        rows[0, j] = -emf[s] if cathode_at_b else emf[s]
        rows[1, j] = resistance[s]
        rows[2, j] = gather[s]
        total += rows[0, j]
        most += gather[s]
        out[j] = 0.0
    if total <= drop or most <= 0.0:
        return 0.0, 0.0
    ions = sqrt(ELECTRON_MASS_KG / (ion_mass_u * ATOMIC_MASS_KG))
    end_of_line = (drop, load, thermal, ions, total, most * sqrt(total))
    _solve(rows[0, :n], rows[1, :n], rows[2, :n], end_of_line, cells, cells_work)
    last = cells_work[1, cells]
    if last <= 0.0:
        return 0.0, 0.0
    each = cells // n
    for j in range(n):
        mean = 0.0
        for k in range(j * each, (j + 1) * each):
            mean += 0.5 * (cells_work[1, k] + cells_work[1, k + 1]) / each
        out[j if cathode_at_b else n - 1 - j] = -mean if cathode_at_b else mean
    return load * last * last, drop * last
