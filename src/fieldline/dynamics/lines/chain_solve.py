"""A chain of nodes between two attachments, condensed onto them and solved in time and memory linear in its nodes.

    D_i U_i + P_(i-1) (U_i - U_(i-1)) + P_i (U_i - U_(i+1)) = b_i,    i = 1..N                              (1)

U_0 = U_a, U_(N+1) = U_b are the ends, D_i (the mass with what turns with the axes) and P_j (what segment j carries) 3 x 3
blocks, none of them symmetric. Eliminated from node 1 on,

    D~_i = D_i + P_(i-1) + P_i - P_(i-1) D~_(i-1)^-1 P_(i-1),      L_i = P_(i-1) D~_(i-1)^-1                 (2)
    b~_i = b_i + L_i b~_(i-1),      E_i = L_i E_(i-1),   E_1 = P_0                                           (3)
    D~_i U_i = b~_i + E_i U_a + P_i U_(i+1)                                                                 (4)

and what the chain does to its ends is, with F_1 = P_0 and F_(i+1) = F_i D~_i^-1 P_i,

    on a:  sum F_i D~_i^-1 b~_i - S_aa U_a - S_ab U_b,   S_aa = P_0 - sum F_i D~_i^-1 E_i,   S_ab = -F_(N+1)    (5)
    on b:  P_N D~_N^-1 b~_N - S_ba U_a - S_bb U_b,       S_bb = P_N - P_N D~_N^-1 P_N,   S_ba = -P_N D~_N^-1 E_N  (6)

A chain without nodes is its one segment: S_aa = S_bb = P_0 = -S_ab = -S_ba. Where the masses are positive and the P
nearly symmetric and not negative, elimination needs no pivots.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fieldline.compiled import inner
from fieldline.frames.matrices import inverse, matadd, matmul, matscale, matsub, matvec
from fieldline.frames.vectors import add, put, vec

NONE = (0.0, 0.0, 0.0)


class Chain(NamedTuple):
    """Blocks of all lines, 3 x 3 row by row: one row a segment or a node, counted as in `Lines`."""

    carried: np.ndarray  # (segments, 9) P_j
    elastic: np.ndarray  # (segments, 9) the part of P_j that is due to places
    pivot: np.ndarray  # (nodes, 9) D_i, and once factorised D~_i^-1
    link: np.ndarray  # (nodes, 9) L_i
    near: np.ndarray  # (nodes, 9) F_i D~_i^-1
    far: np.ndarray  # (nodes, 9) E_i
    load: np.ndarray  # (nodes, 3) b_i, b~_i after `condense`, U_i after `spread_out`
    ends: np.ndarray  # (lines, 4, 9) S_aa, S_ab, S_ba, S_bb


def new_chain(nodes: int, lines: int) -> Chain:
    """Arrays for so many nodes and lines."""
    blocks = [np.zeros((rows, 9)) for rows in (nodes + lines, nodes + lines, nodes, nodes, nodes, nodes)]
    return Chain(*blocks, np.zeros((nodes, 3)), np.zeros((lines, 4, 9)))


@inner
def block(rows, k):
    """Row k of an (n, 9) array as a 9-tuple."""
    return (
        rows[k, 0], rows[k, 1], rows[k, 2], rows[k, 3], rows[k, 4], rows[k, 5], rows[k, 6], rows[k, 7], rows[k, 8],
    )  # fmt: skip


@inner
def keep(rows, k, m):
    """Store a 9-tuple as row k of an (n, 9) array."""
    rows[k, 0], rows[k, 1], rows[k, 2] = m[0], m[1], m[2]
    rows[k, 3], rows[k, 4], rows[k, 5] = m[3], m[4], m[5]
    rows[k, 6], rows[k, 7], rows[k, 8] = m[6], m[7], m[8]


@inner
def factorise_chain(k, first, nodes, chain):
    """Equations (2) to (6) for the nodes of line k, which start at row `first`: their D_i are in chain.pivot."""
    ahead = block(chain.carried, first + k)  # P_0
    on_a, to_b, from_a = ahead, ahead, ahead  # S_aa, F_i, E_i
    link = ahead
    on_b = ahead
    for i in range(first, first + nodes):
        behind, ahead = ahead, block(chain.carried, i + k + 1)
        diagonal = matadd(matadd(block(chain.pivot, i), behind), ahead)
        if i > first:
            diagonal = matsub(diagonal, matmul(link, behind))  # (2): link is L_i
            from_a = matmul(link, from_a)
        pivot = inverse(diagonal)
        near = matmul(to_b, pivot)
        keep(chain.pivot, i, pivot)
        keep(chain.near, i, near)
        keep(chain.far, i, from_a)
        on_a = matsub(on_a, matmul(near, from_a))
        to_b = matmul(near, ahead)
        link = matmul(ahead, pivot)
        if i + 1 < first + nodes:
            keep(chain.link, i + 1, link)
    if nodes > 0:
        on_b = matsub(ahead, matmul(link, ahead))
        from_a = matmul(link, from_a)
    keep(chain.ends[k], 0, on_a)
    keep(chain.ends[k], 1, matscale(-1.0, to_b))
    keep(chain.ends[k], 2, matscale(-1.0, from_a))
    keep(chain.ends[k], 3, on_b)


@inner
def condense(k, first, nodes, chain):
    """What the loads b_i do to the ends: (on a, on b); equations (3), (5), (6)."""
    on_a, reduced = NONE, NONE
    for i in range(first, first + nodes):
        reduced = vec(chain.load, i) if i == first else add(vec(chain.load, i), matvec(block(chain.link, i), reduced))
        put(chain.load, i, reduced)
        on_a = add(on_a, matvec(block(chain.near, i), reduced))
    if nodes == 0:
        return NONE, NONE
    last = first + nodes - 1
    return on_a, matvec(block(chain.carried, last + k + 1), matvec(block(chain.pivot, last), reduced))


@inner
def spread_out(k, first, nodes, u_a, u_b, chain):
    """U_i of the nodes into chain.load, from those of the ends; equation (4)."""
    u = u_b
    for i in range(first + nodes - 1, first - 1, -1):
        push = add(vec(chain.load, i), matvec(block(chain.far, i), u_a))
        push = add(push, matvec(block(chain.carried, i + k + 1), u))
        u = matvec(block(chain.pivot, i), push)
        put(chain.load, i, u)
