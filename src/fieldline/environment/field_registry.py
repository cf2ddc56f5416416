"""Magnetic field models by name.

    field_model("IGRF-14", degree=8)                                        the standard field to degree 8
    field_model("centred-dipole", moment_e=(0.0, 0.0, -7.7e22))             a dipole of one's own at the Earth's centre

`MAGNETIC_FIELDS` lists every model once; the laws that hold for all (no curl, no divergence) are tested over the list.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import lru_cache
from numbers import Real

import numpy as np

from fieldline.environment.coefficients import igrf14, wmm2025
from fieldline.environment.field_record import MOST_YEARS_CARRIED, FieldModel
from fieldline.errors import InputError, nearest

FOREVER = (-9999.0, 9999.0)  # decimal years of a model that does not know time


def field_model(
    model: str | FieldModel,
    *,
    degree: int | None = None,
    order: int | None = None,
    until_year: float | None = None,
    moment_e=None,
    position_e=None,
) -> FieldModel:
    """The model of a name, or a model itself, up to a degree and an order.

    Parameters
    ----------
    model : one of `MAGNETIC_FIELDS` (upper and lower case and hyphens do not matter), or a FieldModel.
    degree, order : highest degree and order of the harmonics; all by default.
    until_year : carry the last secular variation on past the model's end, at the user's risk (IGRF-14, WMM2025, dipole).
    moment_e : (3,) [A m^2] for "centred-dipole", (D, 3) for "displaced-dipoles"; ITRS axes.
    position_e : (D, 3) [m], ITRS axes, for "displaced-dipoles".

    Raises
    ------
    InputError : unknown name, an option that the model does not have or lacks, or one out of range.
    """
    options = {"until_year": until_year, "moment_e": moment_e, "position_e": position_e}
    given = {name: value for name, value in options.items() if value is not None}
    if given and isinstance(model, FieldModel):
        raise InputError(f"{', '.join(given)} cannot be given with a finished FieldModel ({model.name}); give its name.")
    kept = isinstance(model, str | FieldModel) and all(isinstance(k, int | np.integer | None) for k in (degree, order))
    if kept and not given:
        return _kept(model, degree, order)
    whole = model if isinstance(model, FieldModel) else _made(model, given)
    return whole.truncated(degree, order)


@lru_cache(maxsize=32, typed=True)
def _kept(model: str | FieldModel, degree: int | None, order: int | None) -> FieldModel:
    """A model without further options; kept, since its tables cost milliseconds."""
    whole = model if isinstance(model, FieldModel) else _made(model, {})
    return whole.truncated(degree, order)


def _made(name: str, given: dict) -> FieldModel:
    """The factory of `name` called with the options given."""
    plain = {_plain(known): known for known in MAGNETIC_FIELDS}
    if not isinstance(name, str) or _plain(name) not in plain:
        raise InputError(f'unknown field model "{name}"; {nearest(str(name), MAGNETIC_FIELDS)}')
    name = plain[_plain(name)]
    factory = MAGNETIC_FIELDS[name]
    parameters = inspect.signature(factory).parameters
    for option in given:
        if option not in parameters:
            raise InputError(f'field model "{name}" has no option {option}; it takes {_listed(parameters)}.')
    missing = [p.name for p in parameters.values() if p.default is p.empty and p.name not in given]
    if missing:
        raise InputError(f'field model "{name}" needs {_listed(missing)}; give them to field_model("{name}", ...).')
    return factory(**given)


def _igrf14(until_year: float | None = None) -> FieldModel:
    """IGRF-14: degree 13; definitive to 2020, provisional for 2025, then a forecast."""
    model = FieldModel(
        name="IGRF-14",
        version="14th generation, November 2024",
        years=(1900.0, 2030.0),
        predictive_from=2025.0,
        source="IAGA Working Group V-MOD (2024), doi:10.5281/zenodo.14012302",
        degree=13,
        order=13,
        coefficients=igrf14(),
    )
    return _carried_on(model, until_year)


def _wmm2025(until_year: float | None = None) -> FieldModel:
    """World Magnetic Model 2025: degree 12, made in 2024 for 2025 to 2030."""
    model = FieldModel(
        name="WMM2025",
        version="WMM-2025, 13 November 2024",
        years=(2025.0, 2030.0),
        predictive_from=2025.0,
        source="NOAA NCEI and British Geological Survey (2024), doi:10.25921/aqfd-sd83",
        degree=12,
        order=12,
        coefficients=wmm2025(),
    )
    return _carried_on(model, until_year)


def _dipole(until_year: float | None = None) -> FieldModel:
    """The first degree of IGRF-14: a tilted, centred dipole that changes with time. Wrong by 24 % RMS at 500 km."""
    model = replace(_igrf14().truncated(1), name="dipole", version="IGRF-14, degree 1")
    return _carried_on(model, until_year)


def _centred_dipole(moment_e) -> FieldModel:
    """One dipole at the Earth's centre, moment_e (3,) [A m^2], the same at all times."""
    moment = _vectors("moment_e", moment_e, "A m^2")
    if moment.shape != (1, 3):
        raise InputError(f'moment_e of "centred-dipole" is one vector (3,) [A m^2]; got {np.shape(moment_e)}.')
    return _dipoles("centred-dipole", np.zeros((1, 3)), moment)


def _displaced_dipoles(position_e, moment_e) -> FieldModel:
    """Dipoles at position_e (D, 3) [m] with moment_e (D, 3) [A m^2], fixed in the Earth, the same at all times."""
    position = _vectors("position_e", position_e, "m")
    moment = _vectors("moment_e", moment_e, "A m^2")
    if position.shape != moment.shape:
        raise InputError(f"position_e and moment_e must be alike, (D, 3); got {position.shape} and {moment.shape}.")
    outside = np.linalg.norm(position, axis=1) > 6.3e6
    if outside.any():
        raise InputError(f"position_e row {int(np.argmax(outside))} lies outside the Earth: dipoles belong inside. In metres?")
    return _dipoles("displaced-dipoles", position, moment)


def _dipoles(name: str, position: np.ndarray, moment: np.ndarray) -> FieldModel:
    """A model of dipoles alone."""
    return FieldModel(
        name=name,
        version=f"{len(position)} of given moment",
        years=FOREVER,
        predictive_from=None,
        source="given by the user",
        dipole_position_e=position,
        dipole_moment_e=moment,
    )


def _carried_on(model: FieldModel, until_year: float | None) -> FieldModel:
    """The model with its last secular variation carried on to `until_year`."""
    if until_year is None or model.coefficients is None:
        return model
    first, last = model.years
    most = last + MOST_YEARS_CARRIED
    if not isinstance(until_year, Real) or not last <= until_year <= most:
        raise InputError(f"until_year of {model.name} must lie in {last:g} to {most:g}; got {until_year!r}.")
    if until_year == last:
        return model
    carried = model.coefficients.extended(float(until_year))
    version = f"{model.version}; carried on from {last:g} to {until_year:g}"
    return replace(model, years=(first, float(until_year)), version=version, coefficients=carried)


def _vectors(name: str, value, unit: str) -> np.ndarray:
    """(D, 3) finite floats, one's own copy."""
    try:
        vectors = np.array(value, dtype=float, ndmin=2)
    except (ValueError, TypeError):
        vectors = np.empty((0, 0))
    if vectors.ndim != 2 or vectors.shape[1] != 3 or not np.isfinite(vectors).all():
        raise InputError(f"{name} must be finite vectors (D, 3) [{unit}]; got {value!r:.80}.")
    return vectors


def _plain(name: str) -> str:
    """A name without case, hyphens and spaces."""
    return "".join(c for c in name.lower() if c.isalnum())


def _listed(names: Iterable[str]) -> str:
    """Names in a sentence."""
    return " and ".join(names) or "no options"


MAGNETIC_FIELDS: dict[str, Callable[..., FieldModel]] = {
    "IGRF-14": _igrf14,
    "WMM2025": _wmm2025,
    "dipole": _dipole,
    "centred-dipole": _centred_dipole,
    "displaced-dipoles": _displaced_dipoles,
}
