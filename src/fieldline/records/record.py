"""A record: frozen, every key known, every number finite and of the unit that its key names.

Whole numbers serve where decimals are asked for; text and truth values never pass for numbers. What is refused becomes
one `InputError` with every problem in a sentence of its own.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from pydantic import BaseModel, ConfigDict, ValidationError, model_validator

from fieldline.errors import InputError

MOST_PROBLEMS = 40  # sentences in one message


class RecordError(ValueError):
    """Several things wrong with one record: (key within the record or "", sentence that follows the key)."""

    def __init__(self, found: Sequence[tuple[str, str]]):
        super().__init__("; ".join(f"{key} {text}" if key else text for key, text in found))
        self.found = tuple(found)


class _Checked(type(BaseModel)):
    """Records made in Python are refused in the same words as those of a file."""

    def __call__(cls, *positional: Any, **keys: Any):
        """The record of these keys; InputError lists what is wrong with them."""
        if positional:
            raise InputError(
                f"{cls.__name__} takes its keys by name, for example {cls.__name__}({next(iter(cls.model_fields))}=...)."
            )
        try:
            return super().__call__(**keys)
        except ValidationError as error:
            raise refusal(error, cls, cls.__name__) from None


class Record(BaseModel, metaclass=_Checked):
    """Base of all records; see the module."""

    model_config = ConfigDict(
        strict=True, frozen=True, extra="forbid", allow_inf_nan=False, validate_default=True, use_attribute_docstrings=False
    )

    @model_validator(mode="before")
    @classmethod
    def _plain(cls, given: Any) -> Any:
        """NumPy's numbers and arrays as Python's own."""
        if not isinstance(given, dict):
            return given
        return {key: value.tolist() if isinstance(value, np.generic | np.ndarray) else value for key, value in given.items()}

    @classmethod
    def from_dict(cls, table: Any, source: str = ""):
        """The record of a table (nested dicts and lists, as TOML gives them); `source` names it in messages."""
        try:
            return cls.model_validate(table)
        except ValidationError as error:
            raise refusal(error, cls, source or cls.__name__) from None

    def to_dict(self) -> dict[str, Any]:
        """The keys that were given or differ from their defaults, as plain tables and lists."""
        return self.model_dump(mode="json", exclude_defaults=True)


def refusal(error: ValidationError, model: type[BaseModel], source: str) -> InputError:
    """What pydantic found, as one message: a sentence for each problem."""
    from fieldline.records.words import sentences

    found = sentences(error, model)
    if len(found) == 1:
        return InputError(f"{source}: {found[0]}")
    rest = [f"... and {len(found) - MOST_PROBLEMS} more."] if len(found) > MOST_PROBLEMS else []
    listed = "\n  ".join([*found[:MOST_PROBLEMS], *rest])
    return InputError(f"{source} has {len(found)} problems:\n  {listed}")
