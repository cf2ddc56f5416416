"""A calibration as a file: JSON with its schema's version, read back with every entry checked."""

from __future__ import annotations

import json
from dataclasses import asdict, fields
from pathlib import Path

import numpy as np

from fieldline.errors import InputError
from fieldline.estimation.calibration.clock import ClockScan
from fieldline.estimation.calibration.model import Terms
from fieldline.estimation.calibration.record import Calibration
from fieldline.estimation.calibration.selection import Candidate
from fieldline.estimation.calibration.spline import UniformSpline
from fieldline.files import write_text_whole

SCHEMA = "fieldline-calibration"
VERSION = 1


def to_json(calibration: Calibration) -> str:
    """JSON text: SI units, plus the human summary."""
    document = {"schema": SCHEMA, "version": VERSION}
    for entry in fields(Calibration):
        value = getattr(calibration, entry.name)
        if entry.name == "terms":
            value = asdict(value)
        elif entry.name == "candidates":
            value = [asdict(candidate) for candidate in value]
        elif entry.name == "clock":
            value = None if value is None else asdict(value)
        elif entry.name == "epoch_utc":
            value = None if value is None else str(value)
        document[entry.name] = value.tolist() if isinstance(value, np.ndarray) else value
    document["summary"] = calibration.summary()
    return json.dumps(_plain(document), indent=1)


def from_json(text: str, name: str = "calibration") -> Calibration:
    """The Calibration of `to_json`'s text.

    Errors: InputError when the text is not JSON, not a calibration, of a later version, or damaged.
    """
    try:
        document = json.loads(text)
    except ValueError as error:
        raise InputError(f'"{name}" is not JSON ({error}); expected a file that `fieldline calibrate` wrote.') from error
    if not isinstance(document, dict) or document.get("schema") != SCHEMA:
        raise InputError(f'"{name}" is not a calibration: its "schema" is not "{SCHEMA}". Make one with `fieldline calibrate`.')
    if document.get("version") != VERSION:
        raise InputError(
            f'"{name}" has schema version {document.get("version")!r}; this Fieldline reads version {VERSION}. '
            "Calibrate again, or use the Fieldline that wrote it."
        )
    try:
        calibration = _rebuilt(document)
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise InputError(f'"{name}" is a damaged calibration: {error!r}. Calibrate again.') from error
    size = calibration.terms.size
    sound = calibration.values.shape == (size,) and calibration.covariance.shape == (size, size)
    if not (sound and np.isfinite(calibration.values).all() and np.isfinite(calibration.covariance).all()):
        raise InputError(f'"{name}" is a damaged calibration: its {size} parameters are not all there. Calibrate again.')
    return calibration


def write_calibration(calibration: Calibration, path: str | Path) -> Path:
    """Write `to_json`'s text, whole or not at all."""
    return write_text_whole(path, to_json(calibration) + "\n")


def read_calibration(path: str | Path) -> Calibration:
    """The Calibration in a file of `write_calibration`; errors as `from_json`, and InputError for a missing file."""
    try:
        text = Path(path).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is not text"
        raise InputError(f'cannot read the calibration "{path}": {reason}.') from error
    return from_json(text, str(path))


def _rebuilt(document: dict) -> Calibration:
    """The record from its JSON entries."""
    values = {entry.name: document[entry.name] for entry in fields(Calibration)}
    terms = dict(values["terms"])
    terms["splines"] = tuple(UniformSpline(**spline) for spline in terms["splines"])
    values["terms"] = Terms(**terms)
    if not (values["terms"].bias and values["terms"].matrix == "full"):
        raise ValueError("bias and matrix must be present")
    values["values"] = np.array(values["values"], dtype=float)
    values["covariance"] = np.array(values["covariance"], dtype=float).reshape(len(values["values"]), -1)
    values["candidates"] = tuple(Candidate(**candidate) for candidate in values["candidates"])
    values["sentences"] = tuple(values["sentences"])
    if values["epoch_utc"] is not None:
        values["epoch_utc"] = np.datetime64(values["epoch_utc"], "ns")
    if values["clock"] is not None:
        scan = values["clock"]
        values["clock"] = ClockScan(**{**scan, "offsets_s": tuple(scan["offsets_s"]), "rms_tesla": tuple(scan["rms_tesla"])})
    return Calibration(**values)


def _plain(value):
    """NumPy scalars as Python's, infinities and NaN as null."""
    if isinstance(value, dict):
        return {key: _plain(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(one) for one in value]
    if isinstance(value, np.generic):
        value = value.item()
    return None if isinstance(value, float) and not np.isfinite(value) else value
