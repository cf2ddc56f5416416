"""Calibrations in a file: what `fieldline calibrate` writes and `fieldline attitude --calibration FILE` reads.

One calibration is the file that `write_calibration` makes; several that were found together are a list of such, since
they share all but the gain.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from fieldline.errors import InputError
from fieldline.estimation.calibration import Calibration
from fieldline.estimation.calibration.storage import from_json, to_json
from fieldline.files import read_text
from fieldline.frames.time import seconds_since

SEVERAL = "fieldline-calibrations"


def calibrations_to_json(calibrations: Sequence[Calibration]) -> str:
    """The text of a calibration file."""
    if len(calibrations) == 1:
        return to_json(calibrations[0]) + "\n"
    records = [json.loads(to_json(one)) for one in calibrations]
    return json.dumps({"schema": SEVERAL, "calibrations": records}, indent=1) + "\n"


def read_calibrations(path: str | Path) -> tuple[Calibration, ...]:
    """The calibrations of a file; InputError where it is something else or was damaged."""
    text = read_text(path, "calibration file")
    try:
        document = json.loads(text)
    except ValueError:
        document = None
    if not isinstance(document, dict) or document.get("schema") != SEVERAL:
        return (from_json(text, str(path)),)
    records = document.get("calibrations")
    if not isinstance(records, list) or not records:
        raise InputError(f'"{path}" holds no calibrations; make the file anew with `fieldline calibrate`.')
    return tuple(from_json(json.dumps(record), f"{path}, number {k + 1}") for k, record in enumerate(records))


def nearest_in_time(calibrations: Sequence[Calibration], time_utc: np.ndarray) -> Calibration:
    """The one whose gain was found nearest to these times; the first where none has a gain."""

    def distance_s(one: Calibration) -> float:
        if not len(one.gain_knots_s) or one.epoch_utc is None:
            return 0.0
        middle = float(np.mean(seconds_since(time_utc[[0, -1]], one.epoch_utc)))
        return max(one.gain_knots_s[0] - middle, middle - one.gain_knots_s[-1], 0.0)

    return min(calibrations, key=distance_s)
