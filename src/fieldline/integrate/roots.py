"""Where a function crosses zero within a step, as a state machine: the caller evaluates, these kernels choose where.

    left = evaluations(b - a, tolerance)
    while b - a > tolerance and left > 0:
        x = next_guess(a, fa, b, fb, left, tolerance)
        a, fa, b, fb = narrow(a, fa, b, fb, x, f(x))
        left -= 1

and the crossing is at b, the side on which it has happened: a run resumed there does not meet it again. The rule is
interpolate, truncate, project (ITP): the secant's point, moved towards the middle by 0.2 (b - a)^2, and held so near
the middle that bisection's number of evaluations is exceeded by one at most, however flat or kinked f is.

a < b are fractions of a step, within 0..1 (the truncation is scaled to that); fa and fb differ in sign.

Source: I. F. D. Oliveira and R. H. C. Takahashi (2021), ACM Trans. Math. Softw. 47(1):5, with k1 = 0.2, k2 = 2, n0 = 1.
"""

from __future__ import annotations

from math import ceil, log2

from numba import njit

TRUNCATION = 0.2
SPARE_EVALUATIONS = 1


@njit(cache=True)
def bracketed(fa, fb, direction):
    """Has f crossed zero, from fa to fb, upwards (direction > 0), downwards (< 0) or either way (0)?

    Arriving at zero is a crossing and leaving it is none, so that a crossing at a step's end counts once.
    """
    upwards = fa < 0.0 <= fb and direction >= 0
    return upwards or (fa > 0.0 >= fb and direction <= 0)


@njit(cache=True)
def evaluations(width, tolerance):
    """Evaluations that suffice to narrow a bracket of this width to the tolerance."""
    if width <= tolerance:
        return 0
    return ceil(log2(width / tolerance)) + SPARE_EVALUATIONS


@njit(cache=True)
def next_guess(a, fa, b, fb, left, tolerance):
    """Where to evaluate next, with `left` evaluations left, this one counted."""
    middle = 0.5 * (a + b)
    secant = (fb * a - fa * b) / (fb - fa)
    inward = 1.0 if middle >= secant else -1.0
    shift = TRUNCATION * (b - a) ** 2
    truncated = secant + inward * shift if shift <= abs(middle - secant) else middle
    slack = 0.5 * tolerance * 2.0**left - 0.5 * (b - a)
    if abs(truncated - middle) <= slack:
        return truncated
    return middle - inward * max(slack, 0.0)


@njit(cache=True)
def narrow(a, fa, b, fb, x, fx):
    """The bracket (a, fa, b, fb) after f(x) = fx; a zero met exactly closes it at x."""
    if fx == 0.0:
        return x, fx, x, fx
    if (fx > 0.0) == (fa > 0.0):
        return x, fx, b, fb
    return a, fa, x, fx
