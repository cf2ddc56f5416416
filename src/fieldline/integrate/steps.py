"""One step of an explicit Runge-Kutta method: sums of evaluations, the size of its error, the length of the next step.

    combine:     out = z + h sum_j w_j k_j                                                          (1)
    error_norm:  |h| E5 / sqrt(n (E5 + E3 / 100)),   E = sum_i ((sum_j e_j k_ji) / scale_i)^2       (2)
    error_scale: scale_i = absolute_i + relative max(|z0_i|, |z1_i|)                                (3)
    next_step:   h min(6, max(1/3, 0.9 error^(-1/order)))                                           (4)

A step is good where (2) is at most 1. All arrays are the caller's: z, out, scale (n,), k (evaluations, n); `out` must
not be `z` or a row of `k`. The kernels know no physics and call no function of the caller.

Source: Hairer, Norsett and Wanner (1993), s. II.4 and II.5; equation (2) is the estimate of their dop853.
"""

from __future__ import annotations

from math import sqrt

from numba import njit

SAFETY = 0.9
SHRINK_MOST = 1.0 / 3.0
GROW_MOST = 6.0


@njit(cache=True)
def combine(z, h, k, weights, count, out):
    """z + h times the weighted sum of the first `count` rows of k, into out; zero weights cost nothing (1).

    Four rows a pass: what goes through memory counts, not the sums.
    """
    left = 0
    for j in range(count):
        left += 1 if weights[j] != 0.0 else 0
    begun, at = False, 0
    while left > 4:
        at, rows, w = next_four(weights, at)
        sum_four(k, rows, w, begun, out)
        begun = True
        left -= 4
    if left > 0:
        _, rows, w = next_four(weights[:count], at)
        finish_four(z, h, k, rows, w, left, begun, out)
    else:
        for i in range(z.size):
            out[i] = z[i]


@njit(cache=True)
def next_four(weights, at):
    """(where to go on, rows, their weights) of the next four weights that are not zero; fewer repeat a row with weight zero."""
    r0 = r1 = r2 = r3 = 0
    w0 = w1 = w2 = w3 = 0.0
    found = 0
    while at < weights.size and found < 4:
        w = weights[at]
        if w != 0.0:
            if found == 0:
                r0, w0, r1, r2, r3 = at, w, at, at, at
            elif found == 1:
                r1, w1 = at, w
            elif found == 2:
                r2, w2 = at, w
            else:
                r3, w3 = at, w
            found += 1
        at += 1
    return at, (r0, r1, r2, r3), (w0, w1, w2, w3)


@njit(cache=True)
def sum_four(k, rows, w, begun, out):
    """Add four weighted rows of k to out, or begin it with them."""
    k0, k1, k2, k3 = k[rows[0]], k[rows[1]], k[rows[2]], k[rows[3]]
    if begun:
        for i in range(out.size):
            out[i] = out[i] + w[0] * k0[i] + w[1] * k1[i] + w[2] * k2[i] + w[3] * k3[i]
    else:
        for i in range(out.size):
            out[i] = w[0] * k0[i] + w[1] * k1[i] + w[2] * k2[i] + w[3] * k3[i]


@njit(cache=True)
def finish_four(z, h, k, rows, w, count, begun, out):
    """z + h times the sum of one to four weighted rows, and of what is in out where it is begun."""
    k0, k1, k2, k3 = k[rows[0]], k[rows[1]], k[rows[2]], k[rows[3]]
    if begun:
        for i in range(out.size):
            out[i] = z[i] + h * (out[i] + w[0] * k0[i] + w[1] * k1[i] + w[2] * k2[i] + w[3] * k3[i])
    elif count == 1:
        for i in range(out.size):
            out[i] = z[i] + h * (w[0] * k0[i])
    else:
        for i in range(out.size):
            out[i] = z[i] + h * (w[0] * k0[i] + w[1] * k1[i] + w[2] * k2[i] + w[3] * k3[i])


@njit(cache=True)
def error_scale(z0, z1, absolute, relative, out):
    """The error that each component is allowed in a step, into out; absolute (n,) in the components' units (3)."""
    for i in range(z0.size):
        out[i] = absolute[i] + relative * max(abs(z0[i]), abs(z1[i]))


@njit(cache=True)
def error_norm(h, k, e3, e5, scale):
    """Error of a step over what is allowed, root mean square over the components (2); k[: e5.size] is read."""
    square3, square5 = 0.0, 0.0
    for i in range(scale.size):
        error3, error5 = 0.0, 0.0
        for j in range(e5.size):
            error3 += e3[j] * k[j, i]
            error5 += e5[j] * k[j, i]
        square3 += (error3 / scale[i]) ** 2
        square5 += (error5 / scale[i]) ** 2
    if square5 == 0.0 and square3 == 0.0:
        return 0.0
    return abs(h) * square5 / sqrt((square5 + 0.01 * square3) * scale.size)


@njit(cache=True)
def next_step(h, error, order, rejected):
    """Length of the next try after a step h with this error (4).

    `rejected` says that this step or the one before it was refused: then the step does not grow. A NaN error, which
    comes of a right-hand side that overflowed, shrinks the step the most.
    """
    if error == 0.0:
        factor = GROW_MOST
    elif error > 0.0:
        factor = min(GROW_MOST, max(SHRINK_MOST, SAFETY * error ** (-1.0 / order)))
    else:
        factor = SHRINK_MOST
    return h * min(factor, 1.0) if rejected else h * factor


@njit(cache=True)
def starting_step(z, rate, scale):
    """A first step from the state and its rate: a hundredth of the time in which the rate makes the state (II.4).

    Zero state or rate, measured in `scale`, gives 1e-6: the caller caps the step at the span and lets (4) grow it.
    """
    state2, rate2 = 0.0, 0.0
    for i in range(z.size):
        state2 += (z[i] / scale[i]) ** 2
        rate2 += (rate[i] / scale[i]) ** 2
    size, speed = sqrt(state2 / z.size), sqrt(rate2 / z.size)
    return 1e-6 if size < 1e-5 or speed < 1e-5 else 0.01 * size / speed
