"""One file per paper: its set-ups as plain functions that return Datasets.

`CASES` names them for the command line, with module and function; `case_named` loads one.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import Any

from fieldline.errors import InputError, nearest

CASES = {
    "natanson_1990": ("natanson_1990", "run"),
    "ames_1961_field": ("ames_1961", "field"),
    "ames_1961_pointing": ("ames_1961", "pointing"),
    "ames_1961_dump": ("ames_1961", "dump"),
    "ames_1961_coil": ("ames_1961", "coil"),
    "ames_1961_observatory": ("ames_1961", "observatory"),
    "afit_1992_vehicle": ("afit_1992", "vehicle"),
    "afit_1992_model": ("afit_1992", "linear_model"),
    "afit_1992_controllability": ("afit_1992", "controllability"),
    "afit_1992_failures": ("afit_1992", "failures"),
    "afit_1992_lqr": ("afit_1992", "lqr"),
    "afit_1992_turning_field": ("afit_1992", "turning_field"),
    "afit_1992_field": ("afit_1992", "field"),
    "afit_1992_lost_field": ("afit_1992", "lost_field"),
    "afit_1992_transfer": ("afit_1992", "transfer"),
    "afit_1992_flown": ("afit_1992", "flown"),
    "afit_1992_linear_range": ("afit_1992", "linear_range"),
    "afit_1992_docking": ("afit_1992", "docking_standards"),
    "afit_1992_orbit_change": ("afit_1992", "orbit_change"),
    "sao_1982_stationary": ("sao_1982", "stationary"),
    "sao_1982_stability": ("sao_1982", "stability"),
    "sao_1982_stability_chart": ("sao_1982", "stability_chart"),
    "sao_1982_spin": ("sao_1982", "spin"),
    "sao_1982_thruster": ("sao_1982", "thruster"),
    "sao_1982_annex": ("sao_1982", "annex_run"),
    "tp3123": ("tp3123", "run"),
}


def case_named(name: str) -> Callable[..., Any]:
    """The function of a case, which returns a Dataset of every signal; hyphens serve as well as underscores."""
    plain = name.replace("-", "_")
    if plain not in CASES:
        raise InputError(f'there is no case "{name}"; {nearest(plain, CASES)}')
    module, function = CASES[plain]
    return getattr(import_module(f"fieldline.cases.{module}"), function)
