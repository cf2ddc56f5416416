"""Torque of the Earth's field on what is magnetic in a body.

    N = (m_commanded + m_residual + P B + m_eddy) x B                                                      (1)
    m_eddy = K (omega x B)                                                                                 (2)
    m_commanded(t) = to + (from - to) exp(-(t - since) / tau)      of each torquer, along its axis           (3)

All in body axes. P [A m2/T]: polarisability of soft parts. K [N m s/T2], symmetric and not negative: currents that the
body's turn through the field drives, dB_b/dt = -omega x B; their torque takes energy, N . omega = -(omega x B) K
(omega x B) <= 0. The field's own change along the orbit, some 1e-3 rad/s of turn, is left out of (2): a tumbler's rate
decays towards zero and not towards that of the field.

The force grad(m . B) on a dipole, 1e-11 N for 1 A m2, is left out.
Source: Wertz (1978), Spacecraft Attitude Determination and Control, s. 17.2.
"""

from __future__ import annotations

from math import exp

from fieldline.compiled import kernel
from fieldline.frames.matrices import matvec
from fieldline.frames.vectors import add, axpy, cross, vec


@kernel
def torquer_moment(t, k, torquers, inputs):
    """Moment [A m^2] of torquer k along its axis; equation (3)."""
    target = inputs.dipole_to[k]
    lag = torquers.lag[k]
    if lag <= 0.0:
        return target
    return target + (inputs.dipole_from[k] - target) * exp(-(t - inputs.dipole_since[k]) / lag)


@kernel
def commanded_dipole(t, b, torquers, inputs):
    """Dipole [A m^2] of all torquers of body b, body axes."""
    dipole = (0.0, 0.0, 0.0)
    for k in range(torquers.body.shape[0]):
        if torquers.body[k] == b:
            dipole = axpy(torquer_moment(t, k, torquers, inputs), vec(torquers.axis, k), dipole)
    return dipole


@kernel
def row9(rows, k):
    """Row k of an (n, 9) array as a tuple."""
    return (
        rows[k, 0],
        rows[k, 1],
        rows[k, 2],
        rows[k, 3],
        rows[k, 4],
        rows[k, 5],
        rows[k, 6],
        rows[k, 7],
        rows[k, 8],
    )


@kernel
def eddy_torque(field_b, omega, eddy):
    """Torque [N m] of equation (2), body axes."""
    return cross(matvec(eddy, cross(omega, field_b)), field_b)


@kernel
def dipole_torque(field_b, b, bodies):
    """Torque [N m] of the residual and the induced dipole of body b, body axes."""
    return cross(add(vec(bodies.residual, b), matvec(row9(bodies.induced, b), field_b)), field_b)
