"""Covariance of attitude error a, rate error r and coloured measurement error c, as six 3 x 3 blocks.

    P = [[aa, ar, ac], [., rr, rc], [., ., cc]]          (aa, ar, rr, ac, rc, cc), each nine floats

Steps F = [[Phi, Psi, 0], [0, Lam, 0], [0, 0, f I]], measurement H = [h, 0, I] with h = [b x]. The adjoint (lam, Lam) of the
smoother has the same blocks. `coloured` false leaves the last three blocks alone: they are zero, and half the work.
"""

from __future__ import annotations

from math import sqrt

from numba import njit

from fieldline.frames.matrices import (
    IDENTITY,
    inverse,
    matadd,
    matmul,
    matmul_t,
    matscale,
    matsub,
    matvec,
    symmetric,
    transpose,
)
from fieldline.frames.vectors import add, scale, sub

BLOCKS = 54  # floats of one covariance in a row of an array
ZERO9 = (0.0,) * 9


@njit(cache=True)
def load(rows, k):
    """Row k of an (n, 54) array as six blocks."""
    r = rows[k]
    return (
        (r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7], r[8]),
        (r[9], r[10], r[11], r[12], r[13], r[14], r[15], r[16], r[17]),
        (r[18], r[19], r[20], r[21], r[22], r[23], r[24], r[25], r[26]),
        (r[27], r[28], r[29], r[30], r[31], r[32], r[33], r[34], r[35]),
        (r[36], r[37], r[38], r[39], r[40], r[41], r[42], r[43], r[44]),
        (r[45], r[46], r[47], r[48], r[49], r[50], r[51], r[52], r[53]),
    )


@njit(cache=True)
def store(rows, k, p):
    """Six blocks as row k of an (n, 54) array."""
    for i in range(6):
        for j in range(9):
            rows[k, 9 * i + j] = p[i][j]


@njit(cache=True, inline="always")
def step_forward(p, phi, psi, lam, fade, drive, noise, h, coloured):
    """F P F^T + Q; drive [T^2] is what the coloured error gains over the step, noise s of the rate."""
    aa, ar, rr, ac, rc, cc = p
    s2 = noise * noise
    h = abs(h)
    left = matadd(matmul(phi, aa), matmul_t(psi, ar))
    right = matadd(matmul(phi, ar), matmul(psi, rr))
    aa = matadd(matadd(matmul_t(left, phi), matmul_t(right, psi)), matscale(s2 * h * h * h / 3.0, IDENTITY))
    ar = matadd(matmul_t(right, lam), matscale(0.5 * s2 * h * h, IDENTITY))
    rr = matadd(matmul_t(matmul(lam, rr), lam), matscale(s2 * h, IDENTITY))
    if coloured:
        ac = matscale(fade, matadd(matmul(phi, ac), matmul(psi, rc)))
        rc = matscale(fade, matmul(lam, rc))
        cc = matadd(matscale(fade * fade, cc), matscale(drive, IDENTITY))
    return (symmetric(aa), ar, symmetric(rr), ac, rc, symmetric(cc))


@njit(cache=True, inline="always")
def measurement_gain(p, h, r, coloured):
    """P H^T (three blocks) and S = H P H^T + R."""
    aa, ar, _, ac, rc, cc = p
    ga = matmul_t(aa, h)
    gr = matmul_t(transpose(ar), h)
    gc = ZERO9
    if coloured:
        ga = matadd(ga, ac)
        gr = matadd(gr, rc)
        gc = matadd(matmul_t(transpose(ac), h), cc)
    return ga, gr, gc, symmetric(matadd(matadd(matmul(h, ga), gc), r))


@njit(cache=True, inline="always")
def updated(p, ga, gr, gc, s_inv, coloured):
    """P - P H^T S^-1 H P."""
    aa, ar, rr, ac, rc, cc = p
    ka, kr = matmul(ga, s_inv), matmul(gr, s_inv)
    aa = symmetric(matsub(aa, matmul_t(ka, ga)))
    ar = matsub(ar, matmul_t(ka, gr))
    rr = symmetric(matsub(rr, matmul_t(kr, gr)))
    if coloured:
        ac = matsub(ac, matmul_t(ka, gc))
        rc = matsub(rc, matmul_t(kr, gc))
        cc = symmetric(matsub(cc, matmul_t(matmul(gc, s_inv), gc)))
    return (aa, ar, rr, ac, rc, cc)


@njit(cache=True)
def step_backward(adjoint, phi, psi, lam, fade, coloured):
    """F^T Lam F of the adjoint's matrix."""
    aa, ar, rr, ac, rc, cc = adjoint
    across = matadd(matmul(aa, psi), matmul(ar, lam))
    turned = matmul(transpose(phi), across)
    down = matadd(matmul(transpose(psi), across), matmul(transpose(lam), matadd(matmul(transpose(ar), psi), matmul(rr, lam))))
    aa = symmetric(matmul(transpose(phi), matmul(aa, phi)))
    if coloured:
        rc = matscale(fade, matadd(matmul(transpose(psi), ac), matmul(transpose(lam), rc)))
        ac = matscale(fade, matmul(transpose(phi), ac))
        cc = matscale(fade * fade, cc)
    return (aa, turned, symmetric(down), ac, rc, cc)


@njit(cache=True)
def measured_adjoint(adjoint, h, ka, kr, kc, s_inv, coloured):
    """C^T Lam C + H^T S^-1 H with C = I - K H."""
    aa, ar, rr, ac, rc, cc = adjoint
    ma = matadd(matmul(aa, ka), matmul(ar, kr))
    mr = matadd(matmul(transpose(ar), ka), matmul(rr, kr))
    mc = ZERO9
    if coloured:
        ma = matadd(ma, matmul(ac, kc))
        mr = matadd(mr, matmul(rc, kc))
        mc = matadd(matadd(matmul(transpose(ac), ka), matmul(transpose(rc), kr)), matmul(cc, kc))
    n = matadd(matmul(transpose(ka), ma), matmul(transpose(kr), mr))
    if coloured:
        n = matadd(n, matmul(transpose(kc), mc))
    n = matadd(n, s_inv)
    ht = transpose(h)
    mah = matmul(ma, h)
    aa = symmetric(matadd(matsub(aa, matadd(mah, transpose(mah))), matmul(ht, matmul(n, h))))
    ar = matsub(ar, matmul_t(ht, mr))
    if coloured:
        ac = matadd(matsub(ac, matadd(matmul_t(ht, mc), ma)), matmul(ht, n))
        rc = matsub(rc, mr)
        cc = symmetric(matadd(matsub(cc, matadd(mc, transpose(mc))), n))
    return (aa, ar, rr, ac, rc, cc)


@njit(cache=True)
def times(p, va, vr, vc, coloured):
    """P v for a vector in three parts."""
    aa, ar, rr, ac, rc, cc = p
    ua = add(matvec(aa, va), matvec(ar, vr))
    ur = add(matvec(transpose(ar), va), matvec(rr, vr))
    uc = (0.0, 0.0, 0.0)
    if coloured:
        ua = add(ua, matvec(ac, vc))
        ur = add(ur, matvec(rc, vc))
        uc = add(add(matvec(transpose(ac), va), matvec(transpose(rc), vr)), matvec(cc, vc))
    return ua, ur, uc


@njit(cache=True)
def smoothed(p, adjoint, coloured):
    """P - P Lam P, its aa, ar and rr blocks (with cc along the diagonal of the coloured error)."""
    aa, ar, rr, ac, rc, cc = p
    laa, lar, lrr, lac, lrc, lcc = adjoint
    # rows of P Lam: (a, r, c) x (a, r, c)
    raa = matadd(matmul(aa, laa), matmul_t(ar, lar))
    rar = matadd(matmul(aa, lar), matmul(ar, lrr))
    rra = matadd(matmul(transpose(ar), laa), matmul_t(rr, lar))
    rrr = matadd(matmul(transpose(ar), lar), matmul(rr, lrr))
    if coloured:
        raa = matadd(raa, matmul_t(ac, lac))
        rar = matadd(rar, matmul_t(ac, lrc))
        rra = matadd(rra, matmul_t(rc, lac))
        rrr = matadd(rrr, matmul_t(rc, lrc))
    saa = matsub(aa, matadd(matmul(raa, aa), matmul_t(rar, ar)))
    sar = matsub(ar, matadd(matmul(raa, ar), matmul(rar, rr)))
    srr = matsub(rr, matadd(matmul(rra, ar), matmul(rrr, rr)))
    if coloured:
        rac = matadd(matadd(matmul(aa, lac), matmul(ar, lrc)), matmul(ac, lcc))
        rrc = matadd(matadd(matmul(transpose(ar), lac), matmul(rr, lrc)), matmul(rc, lcc))
        saa = matsub(saa, matmul_t(rac, ac))
        sar = matsub(sar, matmul_t(rac, rc))
        srr = matsub(srr, matmul_t(rrc, rc))
        rca = matadd(matadd(matmul(transpose(ac), laa), matmul_t(transpose(rc), lar)), matmul_t(cc, lac))
        rcr = matadd(matadd(matmul(transpose(ac), lar), matmul(transpose(rc), lrr)), matmul_t(cc, lrc))
        rcc = matadd(matadd(matmul(transpose(ac), lac), matmul(transpose(rc), lrc)), matmul(cc, lcc))
        cc = matsub(cc, matadd(matadd(matmul(rca, ac), matmul(rcr, rc)), matmul(rcc, cc)))
    return (symmetric(saa), sar, symmetric(srr), ac, rc, symmetric(cc))


@njit(cache=True)
def transposed_gain(ka, kr, kc, va, vr, vc, coloured):
    """K^T v for a vector in three parts."""
    out = add(matvec(transpose(ka), va), matvec(transpose(kr), vr))
    if coloured:
        out = add(out, matvec(transpose(kc), vc))
    return out


@njit(cache=True)
def inverted(s):
    """S^-1, symmetric to rounding."""
    return symmetric(inverse(s))


@njit(cache=True, inline="always", error_model="numpy")
def whitened(s, v):
    """L^-1 v with L L^T = S: a vector whose covariance is S becomes one of covariance I."""
    l00 = sqrt(s[0])
    l10, l20 = s[3] / l00, s[6] / l00
    l11 = sqrt(s[4] - l10 * l10)
    l21 = (s[7] - l20 * l10) / l11
    l22 = sqrt(s[8] - l20 * l20 - l21 * l21)
    x = v[0] / l00
    y = (v[1] - l10 * x) / l11
    return (x, y, (v[2] - l20 * x - l21 * y) / l22)


@njit(cache=True)
def vectors_back(va, vr, vc, phi, psi, lam, fade):
    """F^T v for a vector in three parts."""
    return (
        matvec(transpose(phi), va),
        add(matvec(transpose(psi), va), matvec(transpose(lam), vr)),
        scale(fade, vc),
    )


@njit(cache=True)
def innovated(va, vc, h, g):
    """V - H^T g: the parts a and c of the adjoint's vector after a measurement."""
    return sub(va, matvec(transpose(h), g)), sub(vc, g)
