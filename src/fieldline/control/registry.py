"""Every law by its name."""

from __future__ import annotations

from fieldline.control import (
    b_dot,
    magnetic_pd,
    mode_manager,
    momentum,
    reel,
    regulator_design,
    residual_dipole,
    tethered_attitude,
    tracking_line,
    wheel_pointing,
)
from fieldline.control.law import Law
from fieldline.control.tracking import designs as tracking
from fieldline.errors import InputError, nearest, shown

_FAMILIES = (
    b_dot,
    tracking_line,
    momentum,
    wheel_pointing,
    magnetic_pd,
    regulator_design,
    residual_dipole,
    mode_manager,
    reel,
    tethered_attitude,
    tracking,
)

LAWS: dict[str, Law] = {law.name: law for family in _FAMILIES for law in family.LAWS}


def law_named(name: str) -> Law:
    """The law of a name; `InputError` with the nearest one if there is none."""
    if name not in LAWS:
        raise InputError(f'there is no law "{shown(str(name))}"; {nearest(str(name), LAWS)}')
    return LAWS[name]
