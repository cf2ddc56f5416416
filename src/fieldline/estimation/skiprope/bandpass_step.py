"""The rules of TP-3123, one sample at a time: a pure kernel on a memory array, for ground and on board.

Corrected signals (7) go through the bank of bandpass filters. Thirty-two times a period their outputs are kept in a ring;
a sine through its last period gives phasors zeta_1, zeta_2, zeta_3 at the middle t_m of that period, and from them

    amplitude  |zeta_3|,   tether's azimuth  A(t_m - d) + pi + s arg(zeta_3) + 2 pi s f (t - t_m)                  (1)

with the sense s from the sum of zeta_1 conj(zeta_2) over some ten periods, the field's azimuth A now (d = 0, the paper's
rule) or when the filter heard it (d = 1 / (z wn)), and the frequency f from the slope of the phases of (1) over the last
eight periods. The filter is tuned anew, its state going on, when its phase at f exceeds three degrees, at most once in the
time that it takes to settle.

Deviations are of a single cycle: scatter over eight periods, the ellipse as in `reading`, and with the paper's rule by how much
the azimuth has turned while the filter heard it.

`memory` and `params` are flat float arrays, so that a law may own them (`SIZE`, `PARAMETERS`; zeros at the start).
"""

from __future__ import annotations

from math import asin, atan2, cos, exp, hypot, isfinite, nan, pi, sin, sqrt

from numba import njit

from fieldline.estimation.skiprope.bandpass import bank_kernel

PARAMETERS = ("frequency_hz", "damping", "corrected_rule", "along_body")
PER_PERIOD, RING = 32, 64
PHASES_PER_PERIOD, PHASES = 4, 32
MEMORY_PERIODS = 10.0
HOLD_PERIODS = 0.5
PHASE_TOLERANCE_RAD = 3.0 * pi / 180.0
SETTLED = 2.53  # minus the logarithm of the 8 % that TP-3123 lets stay

STARTED, LAST, FILTER_HZ, NEXT, KEPT, NEXT_PHASE, PHASES_KEPT, RETUNED = range(8)
PRODUCT_RE, PRODUCT_IM, PRODUCT_SIZE, WHOLE, ROUND = range(8, 13)
MIDDLE, AMPLITUDE, PHASE, TETHER, FREQUENCY, FREQUENCY_STD, SCATTER, MEAN, MEAN_SQUARE, WEIGHT, OFF, OFF_WEIGHT, LATE = range(
    13, 26
)
HEAD = 26
CLOCK, COLUMNS = HEAD, HEAD + 3
ROWS = COLUMNS + 9  # ring of (t, y1, y2, y3, azimuth without jumps)
MARKS = ROWS + 5 * RING  # ring of (t, phase of (1) without jumps)
WORK = MARKS + 2 * PHASES
SIZE = WORK + 20


@njit(cache=True, error_model="numpy")
def bandpass_update(t, field_b, field_c, memory, params):
    """Take in one sample: the measured field (3,) [T], body axes, and the known one, axes (U, V, W). True where it was used.

    A sample that is not finite, or not later than the last, changes nothing.
    """
    b = sqrt(field_c[0] ** 2 + field_c[1] ** 2 + field_c[2] ** 2)
    level = hypot(field_c[0], field_c[1])
    good = isfinite(t) and level > 0.0 and isfinite(b + field_b[0] + field_b[1] + field_b[2])
    if not good or (memory[STARTED] > 0.0 and not t > memory[LAST]):
        return False
    if memory[STARTED] == 0.0:
        memory[:] = 0.0
        memory[STARTED], memory[FILTER_HZ], memory[NEXT], memory[NEXT_PHASE], memory[RETUNED] = 1.0, params[0], t, t, t
        memory[CLOCK : COLUMNS + 9], memory[FREQUENCY], memory[FREQUENCY_STD] = nan, params[0], nan
    kept = exp(-(t - memory[LAST]) * memory[FILTER_HZ] / MEMORY_PERIODS) if memory[KEPT] > 0.0 else 1.0
    memory[LAST] = t
    hz, damping = memory[FILTER_HZ], params[1]
    work = memory[WORK:]
    work[0] = t
    work[1], work[2] = (field_b[0] - field_c[0]) / b, (field_b[1] - field_c[1]) / b
    work[3] = (field_b[2] - field_c[2]) / level  # (7)
    bank_kernel(
        work[0:1],
        work[1:4].reshape(1, 3),
        2.0 * pi * hz,
        damping,
        1,
        HOLD_PERIODS / hz,
        memory[CLOCK:COLUMNS],
        memory[COLUMNS : COLUMNS + 9].reshape(3, 3),
        work[4:7].reshape(1, 3),
        work[7:10].reshape(1, 3),
        work[10:11],
    )
    _average_offset(kept, field_b, field_c, memory)
    if t >= memory[NEXT]:
        memory[NEXT] = max(memory[NEXT] + 1.0 / (PER_PERIOD * hz), t)
        _keep(t, atan2(-field_c[0], field_c[1]), memory, damping / (pi * hz))
        _read(t, memory, params)
    return True


@njit(cache=True)
def _average_offset(kept, field_b, field_c, memory):
    """Azimuth of the known field less that of the measured one, over the past ten periods."""
    u = field_c[1] * field_b[1] + field_c[0] * field_b[0]
    v = field_b[0] * field_c[1] - field_b[1] * field_c[0]
    memory[OFF] = kept * memory[OFF] + atan2(v, u)
    memory[OFF_WEIGHT] = kept * memory[OFF_WEIGHT] + 1.0


@njit(cache=True)
def _keep(t, azimuth, memory, gain):
    """The filters' outputs into the ring."""
    count = int(memory[KEPT])
    rows = memory[ROWS:MARKS].reshape(RING, 5)
    row, before = count % RING, (count - 1) % RING
    last = rows[before, 4] if count > 0 else azimuth
    rows[row, 0] = t
    for k in range(3):
        rows[row, 1 + k] = gain * memory[WORK + 7 + k]  # 2 z x2 / wn
    rows[row, 4] = last + (azimuth - last + pi) % (2.0 * pi) - pi
    memory[KEPT] = count + 1.0


@njit(cache=True, error_model="numpy")
def _read(t, memory, params):
    """A sine through the last period, and everything that follows from it."""
    hz, damping = memory[FILTER_HZ], params[1]
    settled = SETTLED / (damping * 2.0 * pi * hz)
    if memory[KEPT] < PER_PERIOD or memory[WORK + 10] < settled + 1.0 / hz:
        return
    rows = memory[ROWS:MARKS].reshape(RING, 5)
    newest = int(memory[KEPT]) - 1
    middle = t - 0.5 / hz
    _sine(rows, newest, middle, 2.0 * pi * memory[FREQUENCY], memory)
    work = memory[WORK:]
    z1, z2, z3 = complex(work[11], work[12]), complex(work[13], work[14]), complex(work[15], work[16])
    kept = exp(-1.0 / (MEMORY_PERIODS * PER_PERIOD))
    product = z1 * z2.conjugate()
    memory[PRODUCT_RE] = kept * memory[PRODUCT_RE] + product.real
    memory[PRODUCT_IM] = kept * memory[PRODUCT_IM] + product.imag
    memory[PRODUCT_SIZE] = kept * memory[PRODUCT_SIZE] + abs(product.imag)
    memory[WHOLE] = kept * memory[WHOLE] + abs(z1) ** 2 + abs(z2) ** 2
    memory[ROUND] = kept * memory[ROUND] + 2.0 * product.imag
    sense = -1.0 if memory[PRODUCT_IM] < 0.0 else 1.0
    delay = 1.0 / (damping * 2.0 * pi * hz)
    now, then = _azimuth_at(rows, newest, middle), _azimuth_at(rows, newest, middle - delay)
    memory[LATE] = 0.0 if params[2] > 0.5 else now - then
    memory[MIDDLE], memory[AMPLITUDE] = middle, abs(z3)
    memory[PHASE] = now - (now - then if params[2] > 0.5 else 0.0) + pi + sense * atan2(z3.imag, z3.real)  # (1)
    size = abs(z3)
    memory[MEAN] = kept * memory[MEAN] + size
    memory[MEAN_SQUARE] = kept * memory[MEAN_SQUARE] + size * size
    memory[WEIGHT] = kept * memory[WEIGHT] + 1.0
    if t >= memory[NEXT_PHASE]:
        memory[NEXT_PHASE] = t + 1.0 / (PHASES_PER_PERIOD * hz)
        _mark(sense, memory)
        _retune(t, settled, memory, damping)


@njit(cache=True)
def _sine(rows, newest, middle, w, memory):
    """Phasors at `middle` of the last period's rows by least squares of 1, cos, -sin; into the room to work."""
    n, c1, s1, cc, cs, ss = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    work = memory[WORK:]
    sums = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    for back in range(PER_PERIOD):
        row = (newest - back) % RING
        phase = w * (rows[row, 0] - middle)
        c, s = cos(phase), -sin(phase)
        n, c1, s1, cc, cs, ss = n + 1.0, c1 + c, s1 + s, cc + c * c, cs + c * s, ss + s * s
        y = (rows[row, 1], rows[row, 2], rows[row, 3])
        sums = (
            (sums[0][0] + y[0], sums[0][1] + c * y[0], sums[0][2] + s * y[0]),
            (sums[1][0] + y[1], sums[1][1] + c * y[1], sums[1][2] + s * y[1]),
            (sums[2][0] + y[2], sums[2][1] + c * y[2], sums[2][2] + s * y[2]),
        )
    cc, cs, ss = cc - c1 * c1 / n, cs - c1 * s1 / n, ss - s1 * s1 / n
    over = cc * ss - cs * cs
    for k in range(3):
        of_c, of_s = sums[k][1] - c1 * sums[k][0] / n, sums[k][2] - s1 * sums[k][0] / n
        work[11 + 2 * k] = (ss * of_c - cs * of_s) / over
        work[12 + 2 * k] = (cc * of_s - cs * of_c) / over


@njit(cache=True)
def _azimuth_at(rows, newest, t):
    """The known azimuth in the ring at a time, the oldest where it is gone."""
    for back in range(1, min(newest, RING - 1) + 1):
        row, after = (newest - back) % RING, (newest - back + 1) % RING
        if rows[row, 0] <= t:
            share = (t - rows[row, 0]) / (rows[after, 0] - rows[row, 0])
            return rows[row, 4] + share * (rows[after, 4] - rows[row, 4])
    return rows[(newest - min(newest, RING - 1)) % RING, 4]


@njit(cache=True, error_model="numpy")
def _mark(sense, memory):
    """The phase of (1) into its ring, and the frequency from the ring's slope."""
    count = int(memory[PHASES_KEPT])
    marks = memory[MARKS:WORK].reshape(PHASES, 2)
    turn = sense * 2.0 * pi * memory[FREQUENCY]
    value = memory[PHASE]
    if count > 0 and memory[MIDDLE] - marks[(count - 1) % PHASES, 0] > 2.0 / memory[FREQUENCY]:
        count = 0  # too long ago to say how many turns lie between
    if count > 0:
        before = (count - 1) % PHASES
        ahead = marks[before, 1] + turn * (memory[MIDDLE] - marks[before, 0])
        value = ahead + (value - ahead + pi) % (2.0 * pi) - pi
    marks[count % PHASES, 0], marks[count % PHASES, 1] = memory[MIDDLE], value
    memory[PHASES_KEPT] = count + 1.0
    n = min(count + 1, PHASES)
    if n < 2 * PHASES_PER_PERIOD:
        return
    t0, p0, tt, tp, pp = 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(n):
        t0, p0 = t0 + marks[k, 0] / n, p0 + marks[k, 1] / n
    for k in range(n):
        dt, dp = marks[k, 0] - t0, marks[k, 1] - p0
        tt, tp, pp = tt + dt * dt, tp + dt * dp, pp + dp * dp
    left = max(pp - tp * tp / tt, 0.0) / (n - 2)
    memory[SCATTER] = left
    memory[FREQUENCY] = abs(tp / tt) / (2.0 * pi)
    memory[FREQUENCY_STD] = sqrt(left / tt * PHASES_PER_PERIOD) / (2.0 * pi)


@njit(cache=True)
def _retune(t, settled, memory, damping):
    """The filter to the frequency that was read, where its phase there is too large."""
    hz, found = memory[FILTER_HZ], memory[FREQUENCY]
    if memory[PHASES_KEPT] < 2 * PHASES_PER_PERIOD or t - memory[RETUNED] < settled or not 0.25 * hz < found < 4.0 * hz:
        return
    r = found / hz
    if abs(atan2(1.0 - r * r, 2.0 * damping * r)) > PHASE_TOLERANCE_RAD:
        memory[FILTER_HZ], memory[RETUNED] = found, t
        memory[PHASES_KEPT] = 0.0
        memory[WEIGHT], memory[MEAN], memory[MEAN_SQUARE] = 0.0, 0.0, 0.0


@njit(cache=True, error_model="numpy")
def bandpass_phasor(t, memory, params, phasor, covariance):
    """Fill the phasor (4,) and covariance (4, 4) at time t [s]; the sense, or 0 where nothing is read yet (and NaN)."""
    if memory[WEIGHT] < 1.0 or memory[PRODUCT_SIZE] <= 0.0:
        phasor[:] = nan
        covariance[:] = nan
        return 0
    agreement = abs(memory[PRODUCT_IM]) / memory[PRODUCT_SIZE]
    lead = abs(memory[PRODUCT_IM]) / hypot(memory[PRODUCT_RE], memory[PRODUCT_IM])
    sense = -1 if memory[PRODUCT_IM] < 0.0 else 1
    told = sense if agreement >= 0.5 and lead >= 0.3 else 0
    ellipse = sqrt(max(memory[WHOLE] - abs(memory[ROUND]), 0.0) / (memory[WHOLE] + abs(memory[ROUND])))
    mean = memory[MEAN] / memory[WEIGHT]
    scatter = max(memory[MEAN_SQUARE] / memory[WEIGHT] - mean * mean, 0.0)
    radial = scatter + 0.5 * ellipse * ellipse * mean * mean
    tangential = memory[SCATTER] + 0.5 * asin(ellipse) ** 2 + (2.0 * pi * memory[FREQUENCY_STD] * (t - memory[MIDDLE])) ** 2
    tangential += memory[LATE] ** 2
    if told == 0 or not isfinite(tangential):
        tangential = pi * pi
    tangential *= mean * mean
    off = memory[OFF] / memory[OFF_WEIGHT] if params[3] > 0.5 else 0.0  # yaw plus azimuth error, see `by_bandpass`
    phase = memory[PHASE] - off + sense * 2.0 * pi * memory[FREQUENCY] * (t - memory[MIDDLE])
    c, s = cos(phase), sense * sin(phase)  # of exp(i sense phase), which turns forward
    along = (c, s, sense * s, -sense * c)  # z1 = exp(i sense phase), z2 = -i sense z1
    across = (-s, c, sense * c, sense * s)
    for i in range(4):
        phasor[i] = mean * along[i]
        for j in range(4):
            covariance[i, j] = radial * along[i] * along[j] + tangential * across[i] * across[j]
    return told


@njit(cache=True)
def bandpass_run(seconds, field_b, field_c, memory, params):
    """Take in n samples; how many were used."""
    used = 0
    for j in range(len(seconds)):
        if bandpass_update(seconds[j], field_b[j], field_c[j], memory, params):
            used += 1
    return used
