"""One file per paper: its set-ups as plain functions that return Datasets.

`CASES` names them for the command line; `case_named` loads one.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import Any

from fieldline.errors import InputError, nearest

CASES = ("natanson_1990",)


def case_named(name: str) -> Callable[..., Any]:
    """The function `run` of a case, which returns a Dataset of every signal."""
    if name not in CASES:
        raise InputError(f'there is no case "{name}"; {nearest(name, CASES)}')
    return import_module(f"fieldline.cases.{name}").run
