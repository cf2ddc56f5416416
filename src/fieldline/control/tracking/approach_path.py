"""The commanded way from one place beside a target to another: a rest, a smooth move, and a last rate at its end.

    s(t) = (10 - 4 k) t^3 + (7 k - 15) t^4 + (6 - 3 k) t^5,   t from 0 to 1                         (1)

starts from rest, ends with s = 1, without acceleration, at the rate k over the mean rate: k = 0 stops, as for a standoff;
otherwise the target is met at the closing rate that a docking port wants. Along a straight line in axes h; afterwards the
place is held.

Source of the polynomial: the quintic of Flash and Hogan (1985), J. Neuroscience 5(7):1688, with an end rate.
"""

from __future__ import annotations

from numba import njit


@njit(cache=True, error_model="numpy")
def path(t, params, at, place, rate, push):
    """Fill place [m], rate [m/s] and acceleration [m/s^2] (3,), axes h, at time t [s].

    params from `at` on: start (3) [m], end (3) [m], when the move begins [s], how long it takes [s], k of (1).
    """
    begin, length, k = params[at + 6], params[at + 7], params[at + 8]
    share = (t - begin) / length if length > 0.0 else (1e9 if t >= begin else -1.0)
    done, speed, change = 0.0, 0.0, 0.0
    if share >= 1.0:
        done = 1.0
    elif share > 0.0:
        a, b, c = 10.0 - 4.0 * k, 7.0 * k - 15.0, 6.0 - 3.0 * k
        done = share**3 * (a + share * (b + share * c))
        speed = share**2 * (3.0 * a + share * (4.0 * b + share * 5.0 * c)) / length
        change = share * (6.0 * a + share * (12.0 * b + share * 20.0 * c)) / (length * length)
    for j in range(3):
        way = params[at + 3 + j] - params[at + j]
        place[j] = params[at + j] + done * way
        rate[j] = speed * way
        push[j] = change * way
