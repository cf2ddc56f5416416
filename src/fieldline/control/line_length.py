"""How fast a line should grow, from its length and its swing: what the laws of a reel share.

    r = clip(a (L_t - L), -c_in L, c_out L) - L (K_th th' + K_ph (ph^2 - (ph' / 2n)^2) n)                    (50)

L: unstretched length out, L_t: the one that is wanted. Far from it the length grows or shrinks exponentially, near it the
rate dies away. th: angle in the orbit's plane from the vertical, from z_o towards x_o; ph: out of it, towards y_o. A
line of two masses obeys, for small ph and with e = L'/L,

    th'' + 2 e (th' - n) + 3 n^2 sin th cos th = 0,    ph'' + 2 e ph' + 4 n^2 ph = 0                         (51)

so that paid out at e = c it leans by sin 2 th = 4 c / (3 n), and no angle holds it beyond c = 3 n / 4. Reeled in it
swings ever wider. (50) makes the in-plane swing decay at n K_th, less c_in, whatever its size; out of the plane it pays
out as the line swings through the vertical and takes in where it turns, which holds a small swing to about
ph^2 = 2 c_in / (n K_ph).

A reel ends at L_min and L_max. Towards either a rate is held to what brings the line to rest there,

    -(L - L_min) / t_b <= r <= (L_max - L) / t_b,    t_b = 4 (lag + period)                                  (51b)

which with t_b = 4 lag is the fastest approach of a reel with a lag that does not run over; the period is that of the law's
calls.

Sources: Rupp (1975), NASA TM X-64963; SAO (1982), section 3.2, after Kalaghan et al. (1978), for deployment; (51) from
the equations of two masses on a massless line, own derivation.
"""

from __future__ import annotations

from math import asin, atan2, isfinite, sin

import numpy as np
from numba import njit

from fieldline.control.law import LineEnd, Parameter
from fieldline.control.orbital_axes import orbital_rate
from fieldline.control.readings import finite3, lifted, orbit_known
from fieldline.errors import InputError
from fieldline.frames.vectors import cross, dot, norm, scale, sub, unit

LINE, TARGET, LATER, SECOND, APPROACH, OUT, IN, FASTEST, IN_PLANE, ACROSS, MOTION, SHORTEST, LONGEST, BRAKE = range(14)
SIZE = 14
NEVER = 1e300  # [s]
LEAN_RAD = 0.349065850398866  # 20 degrees, of the line while it is paid out at the rate that is derived
BRAKING = 4.0  # of (51b)
NO_END = LineEnd((0.0, 0.0, 0.0))
MOST_OF_MOTION = 0.75  # c_out / n beyond which no angle holds the line


@njit(cache=True)
def swing(measurement):
    """(known, th, th', ph, ph') of the line to the first body [rad, rad/s], equation (51)."""
    away, speed = lifted(measurement.relative_position_i), lifted(measurement.relative_velocity_i)
    if not (orbit_known(measurement) and finite3(away) and finite3(speed)) or dot(away, away) == 0.0:
        return False, 0.0, 0.0, 0.0, 0.0
    r, v = lifted(measurement.position_i), lifted(measurement.velocity_i)
    down = scale(-1.0 / norm(r), r)
    aside = unit(cross(v, r))
    ahead = cross(aside, down)
    side = 1.0 if dot(away, down) > 0.0 else -1.0
    u = scale(side / norm(away), away)
    turn = sub(scale(1.0 / dot(away, away), cross(away, speed)), orbital_rate(r, v))  # of u in orbital axes
    rate = cross(turn, u)
    across = min(max(dot(u, aside), -1.0), 1.0)
    flat = 1.0 - across * across
    if flat < 1e-6:
        return False, 0.0, 0.0, 0.0, 0.0
    x, z = dot(u, ahead), dot(u, down)
    in_plane_rate = (z * dot(rate, ahead) - x * dot(rate, down)) / flat
    return True, atan2(x, z), in_plane_rate, asin(across), dot(rate, aside) / flat**0.5


@njit(cache=True)
def wanted_length(t, params, first):
    """L_t now [m]: params from `first` on hold the target, a time, and the target from then on."""
    return params[first] if t < params[first + 1] else params[first + 2]


@njit(cache=True)
def wanted_rate(t, measurement, params, first):
    """(known, r) of equation (50) [m/s]; params from `first` on."""
    j = int(params[first + LINE])
    if j >= measurement.line_length.shape[0] or not isfinite(measurement.line_length[j]):
        return False, 0.0
    length, n = measurement.line_length[j], params[first + MOTION]
    rate = params[first + APPROACH] * (wanted_length(t, params, first + TARGET) - length)
    rate = min(max(rate, -params[first + IN] * length), params[first + OUT] * length)
    if params[first + IN_PLANE] > 0.0 or params[first + ACROSS] > 0.0:
        known, _, in_plane, across, across_rate = swing(measurement)
        if known:
            wave = across * across - (across_rate / (2.0 * n)) ** 2
            rate -= length * (params[first + IN_PLANE] * in_plane + params[first + ACROSS] * n * wave)
    rate = min(max(rate, -params[first + FASTEST]), params[first + FASTEST])
    if params[first + BRAKE] > 0.0:  # (51b)
        rate = min(rate, max(params[first + LONGEST] - length, 0.0) / params[first + BRAKE])
        rate = max(rate, -max(length - params[first + SHORTEST], 0.0) / params[first + BRAKE])
    return True, rate


TARGETS = {
    "target_length_m": Parameter("m", "L_t, unstretched length that is wanted in the end", kind="positive"),
    "second_from_s": Parameter("s", "time from which another length is wanted; derived: never", kind="positive", derived=True),
    "second_target_length_m": Parameter("m", "that length; derived: the first", kind="positive", derived=True),
}
PARAMETERS = {
    **TARGETS,
    "rate_out_per_s": Parameter(
        "1/s", "c_out, derived: 0.75 n sin 40 deg, at which the line leans by 20 deg", kind="positive", derived=True
    ),
    "rate_in_per_s": Parameter("1/s", "c_in, derived: 0.2 n", kind="positive", derived=True),
    "approach_per_s": Parameter("1/s", "a, derived: 0.75 n", kind="positive", derived=True),
    "rate_max_m_s": Parameter(
        "m/s", "largest rate that is asked for; under a tension the line keeps to it within a sixth", 100.0, "positive"
    ),
    "in_plane_damping": Parameter(
        "", "K_th, which needs the place of the first body at the line's other end", 0.0, "not negative"
    ),
    "out_of_plane_damping": Parameter("", "K_ph, which needs the same", 0.0, "not negative"),
}


def packed_length(law: str, values: dict, context) -> np.ndarray:
    """The `SIZE` numbers, from checked parameters; InputError for a rate at which no angle holds the line."""
    n = context.mean_motion_rad_s
    out = values["rate_out_per_s"]
    out = MOST_OF_MOTION * n * sin(2.0 * LEAN_RAD) if out is None else out
    if out >= MOST_OF_MOTION * n:
        raise InputError(
            f'rate_out_per_s of the law "{law}" must be less than {MOST_OF_MOTION * n:.4g} 1/s, three quarters of the mean '
            f"motion, beyond which no angle holds the line; got {out:g}."
        )
    pace = [0.2 * n if values["rate_in_per_s"] is None else values["rate_in_per_s"]]
    approach = MOST_OF_MOTION * n if values["approach_per_s"] is None else values["approach_per_s"]
    damping = [values["in_plane_damping"], values["out_of_plane_damping"]]
    line = reel_of(law, context)
    ends = context.lines[line] if context.lines else NO_END
    brake = [ends.shortest_m, ends.longest_m, BRAKING * (ends.lag_s + context.period_s)]
    targets = packed_targets(law, values, context, line)
    return np.array([line, *targets, approach, out, *pace, values["rate_max_m_s"], *damping, n, *brake])


def packed_targets(law: str, values: dict, context, line: int) -> list[float]:
    """First target, time of the second, second target; InputError for one of the latter without the other, or out of reach."""
    when, second = values["second_from_s"], values["second_target_length_m"]
    if (when is None) != (second is None):
        raise InputError(f'the law "{law}" needs second_from_s and second_target_length_m together, or neither.')
    ends = context.lines[line] if context.lines else NO_END
    for key in ("target_length_m", "second_target_length_m"):
        if values[key] is not None and not ends.shortest_m <= values[key] <= ends.longest_m:
            raise InputError(
                f'{key} of the law "{law}" must be what the reel can do, from shortest_length_m = {ends.shortest_m:g} m to '
                f"total_length_m = {ends.longest_m:g} m; got {values[key]:g} m."
            )
    first = values["target_length_m"]
    return [first, NEVER, first] if when is None else [first, when, second]


def reel_of(law: str, context, mode: str | None = None) -> int:
    """Which of the lines on the body has the reel; InputError for a reel of another mode, or more reels than one."""
    reels = [(k, line.reel) for k, line in enumerate(context.lines) if line.reel]
    if len(reels) > 1:
        raise InputError(f'the law "{law}" works one reel, and the body has {len(reels)}; put the others on bodies of their own.')
    if not reels:
        return 0
    line, has = reels[0]
    if mode is not None and has != mode:
        raise InputError(f'the law "{law}" commands a {mode}, and the reel has mode = "{has}"; give it mode = "{mode}".')
    return line
