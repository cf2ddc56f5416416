"""The study's chain of rotations (its Appendix A): where the satellite is in the dipole's field, and the field it sees.

[a]x, [a]y, [a]z turn the axes by a about x, y or z, so they take a vector's components from the old axes to the new:

    R_I = [-Om]z [-i]x [-th]z (R, 0, 0)                             place in orbit                            (A2)
    R_4 = [-L_M]y [RA_M]z R_I                                       axes 4: x to the north magnetic pole      (A3)
    cos psi = R_x4 / R,  sin phi = R_y4 / w,  cos phi = -R_z4 / w,  w^2 = R_y4^2 + R_z4^2                     (A6)
    B_4 = [-phi]x [-psi]y (-2 cos psi, 0, sin psi) mu0 P / (4 pi R^3)                                         (A7)
        = (1 - 3 R_x4^2/R^2, -3 R_x4 R_y4/R^2, -3 R_x4 R_z4/R^2) mu0 P / (4 pi R^3)                           (A10)
    B_I = [-RA_M]z [L_M]y B_4,       B_S = [Phi_S]x [-D_S]y [RA_S]z B_I                                       (A11, A8)

Om, i, th: node, inclination, argument of the satellite; RA_M, L_M: right ascension and latitude of the north magnetic
pole; RA_S, D_S, Phi_S: where the tracking line looks, and the roll about it. The dipole points to the geographic south.
On the dipole's axis phi is free and is taken as zero.

Source: White, Shigemoto and Bourquin (1961), NASA TN D-1068, Appendix A. Its sketch gives the angular component the
sign of +sin psi along Z_5, which is the one that makes (A7) a dipole.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fieldline.constants import MU0_OVER_4PI


class Chain(NamedTuple):
    """What the chain passes through: (...) angles [rad] and (..., 3) vectors in axes 4, I and S ([m] and [T])."""

    phi_rad: np.ndarray
    psi_rad: np.ndarray
    position_4: np.ndarray
    position_i: np.ndarray
    field_4: np.ndarray
    field_i: np.ndarray
    field_s: np.ndarray


def about_x(angle, v):
    """[angle]x v: components after the axes have turned about x; angle (...), v (..., 3)."""
    x, y, z = np.moveaxis(np.asarray(v, dtype=float), -1, 0)
    c, s = np.cos(angle), np.sin(angle)
    return _stacked(x, c * y + s * z, c * z - s * y)


def about_y(angle, v):
    """[angle]y v."""
    x, y, z = np.moveaxis(np.asarray(v, dtype=float), -1, 0)
    c, s = np.cos(angle), np.sin(angle)
    return _stacked(c * x - s * z, y, s * x + c * z)


def about_z(angle, v):
    """[angle]z v."""
    x, y, z = np.moveaxis(np.asarray(v, dtype=float), -1, 0)
    c, s = np.cos(angle), np.sin(angle)
    return _stacked(c * x + s * y, c * y - s * x, z)


def orbital_position(radius_m, node_rad, inclination_rad, argument_rad):
    """(..., 3) [m], inertial axes; equation (A2)."""
    radius = np.asarray(radius_m, dtype=float)
    start = np.stack([radius, np.zeros_like(radius), np.zeros_like(radius)], axis=-1)
    return about_z(-np.asarray(node_rad), about_x(-np.asarray(inclination_rad), about_z(-np.asarray(argument_rad), start)))


def magnetic_angles(position_4):
    """phi and psi [rad] of a place in axes 4; equation (A6)."""
    x, y, z = np.moveaxis(np.asarray(position_4, dtype=float), -1, 0)
    return np.arctan2(y, np.where((y == 0.0) & (z == 0.0), 1.0, -z)), np.arctan2(np.hypot(y, z), x)


def field_chain(position_i, pole_right_ascension_rad, pole_latitude_rad, line_rad, dipole_moment_a_m2) -> Chain:
    """The whole chain from places (..., 3) [m] in inertial axes to the field in the vehicle's.

    line_rad : (RA_S, D_S, Phi_S) [rad], each (...).      dipole_moment_a_m2 : P [A m^2], positive.
    """
    turn, latitude = np.asarray(pole_right_ascension_rad), np.asarray(pole_latitude_rad)
    position_4 = about_y(-latitude, about_z(turn, position_i))  # (A3)
    phi, psi = magnetic_angles(position_4)
    strength = MU0_OVER_4PI * dipole_moment_a_m2 / np.linalg.norm(position_4, axis=-1) ** 3
    polar = np.stack([-2.0 * strength * np.cos(psi), np.zeros_like(psi), strength * np.sin(psi)], axis=-1)
    field_4 = about_x(-phi, about_y(-psi, polar))  # (A7)
    field_i = about_z(-turn, about_y(latitude, field_4))  # (A11)
    right_ascension, declination, roll = (np.asarray(angle) for angle in line_rad)
    field_s = about_x(roll, about_y(-declination, about_z(right_ascension, field_i)))  # (A8)
    return Chain(phi, psi, position_4, np.asarray(position_i, dtype=float), field_4, field_i, field_s)


def _stacked(x, y, z):
    """Components as the last axis, broadcast to one shape."""
    return np.stack(np.broadcast_arrays(x, y, z), axis=-1)
