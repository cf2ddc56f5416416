"""Laws of a reel: rates, a profile, and Rupp's tension.

    reel-exponential    u = r of (50)                                                                      (52)
    reel-profile        u -> +-min(u_max, sqrt(a (2 x - a t_s^2))), or x / t_s where x = |L_t - L| < a t_s^2  (53)
    reel-tension        T = m (3 n^2 L + k (L' - r)),   m = m_far + mu L / 2                               (54)

(53) speeds up by a per second and slows down by it, and dies away with t_s over the last metres.
With the defaults k = 4 n and, in (50), a = 0.75 n, (54) is near its target T = m (3 n^2 L + 4 n L' + 3 n^2 (L - L_t)):
stretch e = L / L_t - 1 and swing th in the orbit's plane then obey

    e'' + 4 n e' + 3 n^2 e = 2 n th',   th'' + 3 n^2 th = -2 n e'                                          (55)

whose four roots are twice -n (1 +- i sqrt 2): no other k and a make the slowest motion die faster. In retrieval the
same coupling holds the in-plane swing while c_in is below about 0.4 n. Where the line runs towards the end of what the reel
holds, and would not stop within L' / k, it is stopped evenly over x, three quarters of the room that is left:

    T >= m (g L + L'^2 / (2 x)) out,    T <= m (g L - L'^2 / (2 x)) in                                      (56)
    g = ph'^2 + ((th' - n) cos ph)^2 + n^2 (3 (cos th cos ph)^2 - 1)

g being 3 n^2 at rest, and where the swing is not known.

Sources: Rupp (1975), NASA TM X-64963, for a tension that is linear in length and rate; the gains are own derivation.
"""

from __future__ import annotations

from math import cos, isfinite, sqrt

import numpy as np
from numba import njit

from fieldline.control import line_length
from fieldline.control.law import Law, Parameter, complete
from fieldline.control.line_length import packed_length, packed_targets, reel_of, swing, wanted_length, wanted_rate

FAR_MASS, LINEAR_MASS, GAIN, LEAST, MOTION = range(line_length.SIZE, line_length.SIZE + 5)
LINE, TARGET = range(2)
SPEED, ACCELERATION, SETTLING = range(4, 7)  # after the two targets
CALLED, ASKED, HAS_CALLED = range(3)
STOPPING, HAIR = 0.75, 1e-4  # of the room that is left; of the length, kept for what the tension does between two calls


@njit(cache=True)
def _one(value):
    """A number as the array that a law returns."""
    command = np.empty(1)
    command[0] = value
    return command


@njit(cache=True)
def reel_exponential(t, measurement, memory, params):
    """Equation (52); no rate where the length is not known."""
    _, rate = wanted_rate(t, measurement, params, 0)
    return _one(rate)


@njit(cache=True)
def reel_profile(t, measurement, memory, params):
    """Equation (53)."""
    j = int(params[LINE])
    if j >= measurement.line_length.shape[0] or not isfinite(measurement.line_length[j]):
        return _one(0.0)
    if memory[HAS_CALLED] < 0.5:
        rate = measurement.line_rate[j]
        memory[ASKED] = rate if isfinite(rate) else 0.0
        memory[CALLED] = t
        memory[HAS_CALLED] = 1.0
    left = wanted_length(t, params, TARGET) - measurement.line_length[j]
    last = params[ACCELERATION] * params[SETTLING] ** 2
    size = sqrt(params[ACCELERATION] * (2.0 * abs(left) - last)) if abs(left) > last else abs(left) / params[SETTLING]
    wanted = min(params[SPEED], size) if left > 0.0 else -min(params[SPEED], size)
    most = params[ACCELERATION] * (t - memory[CALLED])
    memory[CALLED] = t
    slows = wanted * memory[ASKED] >= 0.0 and abs(wanted) < abs(memory[ASKED])
    step = wanted - memory[ASKED]
    memory[ASKED] = wanted if slows else memory[ASKED] + min(max(step, -most), most)  # the root slows it at a
    return _one(memory[ASKED])


@njit(cache=True)
def held_by(measurement, n):
    """g of (56) [1/s^2]: what holds a line of constant length taut, by its mass and length."""
    known, th, in_plane, ph, across = swing(measurement)
    if not known:
        return 3.0 * n * n
    return across**2 + ((in_plane - n) * cos(ph)) ** 2 + n * n * (3.0 * (cos(th) * cos(ph)) ** 2 - 1.0)


@njit(cache=True)
def reel_tension(t, measurement, memory, params):
    """Equation (54); the tension of the last call where the length is not known."""
    known, wanted = wanted_rate(t, measurement, params, 0)
    j = int(params[line_length.LINE])
    if known and isfinite(measurement.line_rate[j]):
        length, n = measurement.line_length[j], params[MOTION]
        mass = params[FAR_MASS] + 0.5 * params[LINEAR_MASS] * length
        rate = measurement.line_rate[j]
        tension = mass * (3.0 * n * n * length + params[GAIN] * (rate - wanted))
        room = params[line_length.LONGEST] - length if rate > 0.0 else length - params[line_length.SHORTEST]
        room -= HAIR * length
        if room < abs(rate) / params[GAIN] and rate != 0.0:  # (56)
            stop = 0.5 * rate * rate / max(STOPPING * room, abs(rate) * params[line_length.BRAKE])
            held = mass * length * held_by(measurement, n)
            tension = max(tension, held + mass * stop) if rate > 0.0 else min(tension, held - mass * stop)
        memory[ASKED] = max(tension, params[LEAST])
    return _one(memory[ASKED])


PROFILE_PARAMETERS = {
    **line_length.TARGETS,
    "rate_m_s": Parameter("m/s", "u_max, rate between speeding up and slowing down", kind="positive"),
    "acceleration_m_s2": Parameter("m/s^2", "a, while it speeds up and slows down", 0.01, "positive"),
    "settling_s": Parameter("s", "t_s, time constant of the last metres", 10.0, "positive"),
}
TENSION_PARAMETERS = {
    **line_length.PARAMETERS,
    "far_mass_kg": Parameter("kg", "m_far, mass at the other end of the line", kind="positive"),
    "mass_per_length_kg_m": Parameter("kg/m", "mu of the line", 0.0, "not negative"),
    "gain_per_s": Parameter("1/s", "k, derived: 4 n", kind="positive", derived=True),
    "tension_min_n": Parameter("N", "least tension that is asked for", 0.0, "not negative"),
}


def _pack_exponential(table, context) -> np.ndarray:
    law = "reel-exponential"
    values = complete(law, line_length.PARAMETERS, table)
    reel_of(law, context, "rate")
    return packed_length(law, values, context)


def _pack_profile(table, context) -> np.ndarray:
    values = complete("reel-profile", PROFILE_PARAMETERS, table)
    line = reel_of("reel-profile", context, "rate")
    keys = ("rate_m_s", "acceleration_m_s2", "settling_s")
    return np.array([line, *packed_targets("reel-profile", values, context, line), *(values[key] for key in keys)], dtype=float)


def _pack_tension(table, context) -> np.ndarray:
    law = "reel-tension"
    values = complete(law, TENSION_PARAMETERS, table)
    reel_of(law, context, "tension")
    n = context.mean_motion_rad_s
    gain = 4.0 * n if values["gain_per_s"] is None else values["gain_per_s"]
    own = (values["far_mass_kg"], values["mass_per_length_kg_m"], gain, values["tension_min_n"], n)
    return np.concatenate([packed_length(law, values, context), own])


LAWS = (
    Law(
        "reel-exponential",
        reel_exponential,
        line_length.PARAMETERS,
        1,
        ("reel",),
        "pays a line out or takes it in at a rate in proportion to its length, to a target",
        _pack_exponential,
    ),
    Law(
        "reel-profile",
        reel_profile,
        PROFILE_PARAMETERS,
        3,
        ("reel",),
        "a trapezoid of the rate, to a target length",
        _pack_profile,
    ),
    Law(
        "reel-tension",
        reel_tension,
        TENSION_PARAMETERS,
        3,
        ("reel",),
        "pays out or takes in under a tension that damps the swing in the orbit's plane (Rupp)",
        _pack_tension,
    ),
)
