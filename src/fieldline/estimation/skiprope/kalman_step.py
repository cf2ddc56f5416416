"""A Kalman filter for the cone, one sample at a time: a pure kernel on a memory array, for ground and on board.

The measured direction is the known one turned by three slow angles, and then by the cone and a second motion about the body's
first two axes,

    b / |b| = C1(o1) C2(o2) C1(s1) C2(s2) C3(s3) B / |B| + noise,   ok = Re zk + Re pk (k = 1, 2)               (1)

(exact, nothing is taken small). The state, 16 numbers:

    s1 s2 s3, their rates         what the body stands askew, and whatever the known field's direction is off, along the orbit:
                                  s'' = -2 z v s' - v^2 s + white noise, v about the orbit's rate, z = 0.7        (2)
    z1, z2, w                     the cone: z' = i w z + noise, so that ellipse, size and frequency may change      (3)
    p1, p2, wp                    the same for the pendulous motion

Two numbers of a sample are used, across the predicted direction; its magnitude is not. Noise is the magnetometer's over |b|,
known from the samples themselves, and a white share of the known field's direction error. A sample further off than `GATE`
deviations is passed over. The mean
of its normalised square innovations over some two periods tells whether the filter still follows: 1 where it is consistent.

Nothing in a sample tells of a turn about the field itself, and a filter that linearises soon believes that it knows it, and
walks off. Each sample therefore also says, weakly, that there is none:

    (b / |b|) . (s1, s2, s3) = 0,     give or take 3 deg in forty seconds                                          (4)

so that the slow part is the least rotation that does.

Between samples the state is carried exactly for a steady w; the covariance to first order in w. Covariance updates keep
it symmetric by construction (one triangle is computed and copied).

`memory` and `params` are flat float arrays, so that a law may own them (`SIZE`, `PARAMETERS`; zeros at the start).
"""

from __future__ import annotations

from math import atan2, cos, exp, isfinite, pi, sin, sqrt

from numba import njit

from fieldline.estimation.skiprope.bandpass import exact_step
from fieldline.frames.vectors import cross, dot, norm, scale, sub, unit

STATES = 16
HEAD = 10  # of the memory, see below
WORK = HEAD + STATES + STATES * STATES  # after head, state and covariance: room to work, and what the noise is known from
NOISE = WORK + STATES
SIZE = NOISE + 18
# started; last and first time [s]; mean NIS; samples used; passed over since, of the last, of all; sums of the azimuth's offset
STARTED, LAST, FIRST, MEAN_NIS, COUNT, MISSED, NIS, ALL_MISSED, OFF, OFF_WEIGHT = range(HEAD)
SLOW, RATE, CONE, CONE_W, SWING, SWING_W = 0, 3, 6, 10, 11, 15
PARAMETERS = (
    "noise_tesla",
    "direction_rad",  # white, a sample
    "slow_rad_s32",  # accelerations of (2), rad/s^2 over sqrt(Hz)
    "cone_rad_s12",  # noise of (3)
    "frequency_rad_s32",
    "swing_rad_s12",
    "swing_frequency_rad_s32",
    "tilt_std_rad",  # first deviations: of s1, s2
    "yaw_std_rad",
    "rate_std_rad_s",
    "cone_std_rad",
    "frequency_std_rad_s",
    "swing_std_rad",
    "swing_frequency_std_rad_s",
    "frequency_rad_s",
    "swing_frequency_rad_s",
    "slow_rate_rad_s",  # v of (2)
)
SLOW_DAMPING = 0.7
SURE_SENSE = 2.0  # deviations by which the turning parts must differ
GATE = 36.0  # of the squared normalised innovation
MOST_MISSED = 20  # passed over in turn: the next is used
PIN_RAD2_S, LONGEST_PIN_S = 0.1, 10.0
GIVEN, NOISE_SAMPLES = 10.0, 500.0  # samples that the given noise counts for, and that the noise is averaged over
LEVEL = 0.25  # of the squared cosine of the field's elevation, 60 deg: its azimuth counts less where it is steeper
OFF_MEMORY_S = 2000.0  # over which the azimuth's offset is averaged


@njit(cache=True)
def covariance_of(memory):
    """(16, 16) view of the covariance in the memory."""
    return memory[HEAD + STATES : HEAD + STATES + STATES * STATES].reshape(STATES, STATES)


@njit(cache=True)
def kalman_start(t, memory, params):
    """Set the memory to the first deviations at time t [s]."""
    memory[:] = 0.0
    memory[STARTED], memory[LAST], memory[FIRST], memory[MEAN_NIS] = 1.0, t, t, 1.0
    memory[HEAD + CONE_W], memory[HEAD + SWING_W] = params[14], params[15]
    deviations = (
        params[7], params[7], params[8], params[9], params[9], params[9],
        params[10], params[10], params[10], params[10], params[11],
        params[12], params[12], params[12], params[12], params[13],
    )  # fmt: skip
    for i in range(STATES):
        memory[HEAD + STATES + i * STATES + i] = deviations[i] * deviations[i]


@njit(cache=True)
def kalman_carry(t, memory, params):
    """Carry state and covariance on to time t [s], later than the last."""
    dt = t - memory[LAST]
    x = memory[HEAD : HEAD + STATES]
    p = covariance_of(memory)
    f11, f12, f21, f22 = exact_step(dt, params[16], SLOW_DAMPING)
    for i in range(3):
        angle, rate = x[SLOW + i], x[RATE + i]
        x[SLOW + i], x[RATE + i] = f11 * angle + f12 * rate, f21 * angle + f22 * rate  # (2)
        for j in range(STATES):
            u, v = p[SLOW + i, j], p[RATE + i, j]
            p[SLOW + i, j], p[RATE + i, j] = f11 * u + f12 * v, f21 * u + f22 * v
        for j in range(STATES):
            u, v = p[j, SLOW + i], p[j, RATE + i]
            p[j, SLOW + i], p[j, RATE + i] = f11 * u + f12 * v, f21 * u + f22 * v
    _turn_pairs(x, p, CONE, CONE_W, dt)
    _turn_pairs(x, p, SWING, SWING_W, dt)
    slow = params[2] * params[2]
    for i in range(3):
        p[SLOW + i, SLOW + i] += slow * dt * dt * dt / 3.0
        p[SLOW + i, RATE + i] += slow * dt * dt / 2.0
        p[RATE + i, SLOW + i] += slow * dt * dt / 2.0
        p[RATE + i, RATE + i] += slow * dt
    for i in range(4):
        p[CONE + i, CONE + i] += params[3] * params[3] * dt  # (3)
        p[SWING + i, SWING + i] += params[5] * params[5] * dt
    p[CONE_W, CONE_W] += params[4] * params[4] * dt
    p[SWING_W, SWING_W] += params[6] * params[6] * dt
    for i in range(STATES):
        for j in range(i):
            p[i, j] = p[j, i]
    memory[LAST] = t


@njit(cache=True)
def _turn_pairs(x, p, first, frequency, dt):
    """Two phasors turned by their frequency, and the covariance with them."""
    c, s = cos(x[frequency] * dt), sin(x[frequency] * dt)
    for k in (first, first + 2):
        re, im = c * x[k] - s * x[k + 1], s * x[k] + c * x[k + 1]
        x[k], x[k + 1] = re, im
        for j in range(STATES):
            u, v, w = p[k, j], p[k + 1, j], p[frequency, j]
            p[k, j], p[k + 1, j] = c * u - s * v - dt * im * w, s * u + c * v + dt * re * w
        for j in range(STATES):
            u, v, w = p[j, k], p[j, k + 1], p[j, frequency]
            p[j, k], p[j, k + 1] = c * u - s * v - dt * im * w, s * u + c * v + dt * re * w


@njit(cache=True)
def predicted(x, known):
    """The direction (1) of a known unit vector, and its derivatives by o1, o2 (cone and swing) and by s1, s2, s3."""
    c1, s1 = cos(x[CONE] + x[SWING]), sin(x[CONE] + x[SWING])
    c2, s2 = cos(x[CONE + 2] + x[SWING + 2]), sin(x[CONE + 2] + x[SWING + 2])
    d1, e1, d2, e2, d3, e3 = cos(x[0]), sin(x[0]), cos(x[1]), sin(x[1]), cos(x[2]), sin(x[2])
    v3 = (d3 * known[0] + e3 * known[1], d3 * known[1] - e3 * known[0], known[2])
    v2 = _about_second(d2, e2, v3)
    slow = _about_first(d1, e1, v2)
    swung = _about_second(c2, s2, slow)
    now = _about_first(c1, s1, swung)
    by_s1 = _about_first(c1, s1, _about_second(c2, s2, (0.0, slow[2], -slow[1])))
    by_s2 = _about_first(c1, s1, _about_second(c2, s2, _about_first(d1, e1, (-v2[2], 0.0, v2[0]))))
    by_s3 = _about_second(d2, e2, (v3[1], -v3[0], 0.0))
    by_s3 = _about_first(c1, s1, _about_second(c2, s2, _about_first(d1, e1, by_s3)))
    return now, (0.0, now[2], -now[1]), _about_first(c1, s1, (-swung[2], 0.0, swung[0])), by_s1, by_s2, by_s3


@njit(cache=True)
def _about_second(c, s, v):
    """V in axes turned about the second."""
    return (c * v[0] - s * v[2], v[1], s * v[0] + c * v[2])


@njit(cache=True)
def _about_first(c, s, v):
    """V in axes turned about the first."""
    return (v[0], c * v[1] + s * v[2], c * v[2] - s * v[1])


@njit(cache=True, error_model="numpy")
def kalman_update(t, field_b, field_c, memory, params):
    """Take in one sample: the measured field (3,) [T], body axes, and the known one, axes (U, V, W). True where it was used.

    A sample that is not finite, or not later than the last, changes nothing.
    """
    since = 1.0
    b, known = (field_b[0], field_b[1], field_b[2]), (field_c[0], field_c[1], field_c[2])
    size, size_known = norm(b), norm(known)
    if not (isfinite(t) and isfinite(size) and isfinite(size_known) and size > 0.0 and size_known > 0.0):
        return False
    if memory[STARTED] == 0.0:
        kalman_start(t, memory, params)
    elif not t > memory[LAST]:
        return False
    else:
        since = min(t - memory[LAST], LONGEST_PIN_S)
        kept = exp(-(t - memory[LAST]) / OFF_MEMORY_S)
        memory[OFF], memory[OFF_WEIGHT] = kept * memory[OFF], kept * memory[OFF_WEIGHT]
        kalman_carry(t, memory, params)
    x = memory[HEAD : HEAD + STATES]
    p = covariance_of(memory)
    expected, by_o1, by_o2, by_s1, by_s2, by_s3 = predicted(x, unit(known))
    off = sub(scale(1.0 / size, b), expected)
    variance = _noise(t, b, memory, params) / (size * size) + params[1] ** 2
    first, second = _across(expected)
    h1 = (dot(first, by_o1), dot(first, by_o2), dot(first, by_s1), dot(first, by_s2), dot(first, by_s3))
    h2 = (dot(second, by_o1), dot(second, by_o2), dot(second, by_s1), dot(second, by_s2), dot(second, by_s3))
    r1, r2 = dot(first, off), dot(second, off)
    work = memory[WORK:NOISE]
    s11, s22 = _inside(p, h1, h1, work) + variance, _inside(p, h2, h2, work) + variance
    s12 = _inside(p, h1, h2, work)
    nis = (s22 * r1 * r1 - 2.0 * s12 * r1 * r2 + s11 * r2 * r2) / (s11 * s22 - s12 * s12)
    weight = max(1.0 / (memory[COUNT] + memory[ALL_MISSED] + 1.0), _share(t, memory, x))
    memory[MEAN_NIS] += (0.5 * min(nis, GATE) - memory[MEAN_NIS]) * min(weight, 1.0)
    if nis > GATE and memory[MISSED] < MOST_MISSED and memory[COUNT] > 0.0:
        memory[MISSED] += 1.0
        memory[ALL_MISSED] += 1.0
        return False
    moved = _take(x, p, work, h1, h2, r1, variance)
    _take(x, p, work, h2, h1, r2 - moved, variance)
    _pin(x, p, work, expected, PIN_RAD2_S / since)
    level = min((known[0] * known[0] + known[1] * known[1]) / (LEVEL * size_known * size_known), 1.0) + 1e-9
    memory[OFF] += level * _azimuth_ahead(x, known)
    memory[OFF_WEIGHT] += level
    memory[MISSED], memory[NIS] = 0.0, nis
    memory[COUNT] += 1.0
    return True


@njit(cache=True)
def _across(direction):
    """Two unit vectors across a direction."""
    helper = (1.0, 0.0, 0.0) if abs(direction[0]) < 0.8 else (0.0, 1.0, 0.0)
    first = unit(cross(direction, helper))
    return first, cross(direction, first)


@njit(cache=True)
def _row(p, i, h):
    """Row i of the covariance times a measurement's five derivatives."""
    swung = h[0] * (p[i, CONE] + p[i, SWING]) + h[1] * (p[i, CONE + 2] + p[i, SWING + 2])
    return swung + h[2] * p[i, SLOW] + h[3] * p[i, SLOW + 1] + h[4] * p[i, SLOW + 2]


@njit(cache=True)
def _along(h, work):
    """A measurement's derivatives times a vector of all states."""
    swung = h[0] * (work[CONE] + work[SWING]) + h[1] * (work[CONE + 2] + work[SWING + 2])
    return swung + h[2] * work[SLOW] + h[3] * work[SLOW + 1] + h[4] * work[SLOW + 2]


@njit(cache=True)
def _inside(p, ha, hb, work):
    """Covariance of two measurements."""
    for i in range(STATES):
        work[i] = _row(p, i, hb)
    return _along(ha, work)


@njit(cache=True)
def _take(x, p, work, h, other, residual, variance):
    """Update by one number; by how much that moves what the other derivatives expect."""
    total = variance + _inside(p, h, h, work)
    gain = residual / total
    for i in range(STATES):
        x[i] += gain * work[i]
        for j in range(i, STATES):
            p[i, j] -= work[i] * work[j] / total
            p[j, i] = p[i, j]
    return gain * _along(other, work)


@njit(cache=True)
def _pin(x, p, work, direction, variance):
    """Update by (4)."""
    total, residual = variance, 0.0
    for i in range(STATES):
        work[i] = direction[0] * p[i, 0] + direction[1] * p[i, 1] + direction[2] * p[i, 2]
    for k in range(3):
        total += direction[k] * work[k]
        residual -= direction[k] * x[k]
    for i in range(STATES):
        x[i] += residual / total * work[i]
        for j in range(i, STATES):
            p[i, j] -= work[i] * work[j] / total
            p[j, i] = p[i, j]


@njit(cache=True)
def _share(t, memory, x):
    """Weight of the newest sample in the mean of two periods, from how often samples have come."""
    interval = (t - memory[FIRST]) / max(memory[COUNT] + memory[ALL_MISSED], 1.0)
    return interval * abs(x[CONE_W]) / (4.0 * pi)


@njit(cache=True)
def _noise(t, b, memory, params):
    """Variance [T^2] of a reading: fourth differences of the last samples where they are even and close, the given one before.

    A motion at w passes with (2 sin(w dt / 2))^4, which is a thousandth for the pendulous one at 1 Hz.
    """
    now = memory[NOISE:]
    sums, steady = 0.0, now[2] != 0.0
    weight = GIVEN * max(1.0 - now[1] / NOISE_SAMPLES, 0.0) if now[1] > 0.0 else GIVEN
    dt = t - now[2]
    for k in range(3):
        steady = steady and abs(now[2 + 4 * k] - now[6 + 4 * k] - dt) < 0.05 * dt and now[6 + 4 * k] != 0.0
    fastest = max(abs(memory[HEAD + CONE_W]), abs(memory[HEAD + SWING_W]))
    for i in range(3):
        fourth = b[i] - 4.0 * now[3 + i] + 6.0 * now[7 + i] - 4.0 * now[11 + i] + now[15 + i]
        sums += fourth * fourth / 210.0
    if steady and dt * fastest < 0.5:
        given = params[0] * params[0]
        mean = (now[0] * now[1] + given * weight) / (now[1] + weight)
        now[1] = min(now[1] + 1.0, NOISE_SAMPLES)
        now[0] += (min(sums, 25.0 * mean) - now[0]) / now[1]
    for j in range(17, 5, -1):
        now[j] = now[j - 4]
    now[2], now[3], now[4], now[5] = t, b[0], b[1], b[2]
    return (now[0] * now[1] + params[0] * params[0] * weight) / (now[1] + weight)


@njit(cache=True)
def _azimuth_ahead(x, known):
    """Azimuth [rad] of the known field less that of the field as the slow angles turn it.

    A turn about the field, which nothing shows at an instant, drops out of it; s3 alone would not do.
    """
    c1, s1, c2, s2, c3, s3 = cos(x[0]), sin(x[0]), cos(x[1]), sin(x[1]), cos(x[2]), sin(x[2])
    u, v, w = c3 * known[0] + s3 * known[1], c3 * known[1] - s3 * known[0], known[2]
    u, w = c2 * u - s2 * w, s2 * u + c2 * w
    v = c1 * v + s1 * w
    return atan2(u * known[1] - v * known[0], u * known[0] + v * known[1])


@njit(cache=True)
def azimuth_off(memory):
    """[rad] yaw plus azimuth error of the known field, averaged over the past."""
    return memory[OFF] / max(memory[OFF_WEIGHT], 1e-9)


@njit(cache=True)
def kalman_frequency(memory):
    """The cone's frequency [Hz], positive, and its deviation, grown as `kalman_phasor`'s."""
    w = memory[HEAD + CONE_W]
    return abs(w) / (2.0 * pi), sqrt(covariance_of(memory)[CONE_W, CONE_W] * max(memory[MEAN_NIS], 1.0)) / (2.0 * pi)


@njit(cache=True)
def kalman_phasor(memory, phasor, covariance, settled, lost):
    """Fill Re z1, Im z1, Re z2, Im z2 (4,) for a positive frequency, and their covariance (4, 4); (sense, trusted).

    The covariance grows by the mean NIS where it is above one. Trusted: phasors' deviation below `settled` of the cone, and a
    mean NIS below `lost`. The sense is 0 where the two turning parts differ by less than two deviations.
    """
    x = memory[HEAD : HEAD + STATES]
    p = covariance_of(memory)
    grown = max(memory[MEAN_NIS], 1.0)
    back = -1.0 if x[CONE_W] < 0.0 else 1.0
    total = 0.0
    for i in range(4):
        phasor[i] = x[CONE + i] * (back if i % 2 else 1.0)
        for j in range(4):
            covariance[i, j] = grown * p[CONE + i, CONE + j] * (back if (i + j) % 2 else 1.0)
        total += covariance[i, i]
    plus = 0.5 * sqrt((phasor[0] - phasor[3]) ** 2 + (phasor[1] + phasor[2]) ** 2)
    minus = 0.5 * sqrt((phasor[0] + phasor[3]) ** 2 + (phasor[1] - phasor[2]) ** 2)
    spread = sqrt(total / 4.0)
    sense = 0
    if abs(plus - minus) > SURE_SENSE * spread:
        sense = 1 if plus > minus else -1
    return sense, spread < settled * max(plus, minus) and memory[MEAN_NIS] < lost


@njit(cache=True)
def kalman_run(seconds, field_b, field_c, memory, params, rows, memories):
    """Take in n samples; at times `rows` (m,), rising, store the memory carried on to there, in memories (m, SIZE).

    A row before the first sample is all zero.
    """
    k = 0
    for j in range(len(seconds) + 1):
        while k < len(rows) and (j == len(seconds) or rows[k] < seconds[j]):
            memories[k] = memory
            if memory[STARTED] > 0.0 and rows[k] > memory[LAST]:
                kalman_carry(rows[k], memories[k], params)
            k += 1
        if j < len(seconds):
            kalman_update(seconds[j], field_b[j], field_c[j], memory, params)


@njit(cache=True)
def kalman_rows(memories, settled, lost, phasors, covariances, numbers):
    """Of memories (m, SIZE): phasors (m, 4), covariances (m, 4, 4), and numbers (m, 6).

    The numbers: sense, trusted, frequency [Hz], its deviation, azimuth offset [rad], mean NIS.
    """
    for k in range(len(memories)):
        sense, good = kalman_phasor(memories[k], phasors[k], covariances[k], settled, lost)
        hz, std = kalman_frequency(memories[k])
        numbers[k, 0], numbers[k, 1], numbers[k, 2], numbers[k, 3] = sense, 1.0 if good else 0.0, hz, std
        numbers[k, 4], numbers[k, 5] = azimuth_off(memories[k]), memories[k][MEAN_NIS]
