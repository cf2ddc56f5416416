"""Names in results: they become names of variables in NetCDF files and words of reports and terminals."""

from __future__ import annotations

from typing import Annotated

from pydantic import AfterValidator

from fieldline.records.words import came

LONGEST = 100


def _speakable(name: str) -> str:
    """A name that files and terminals can hold."""
    if "/" in name or not name.isprintable():
        raise ValueError(f'must be text without "/" and without control characters; got {came(name)}')
    if len(name) > LONGEST:
        raise ValueError(f"must have at most {LONGEST} characters; got {len(name)}")
    return name


Name = Annotated[str, AfterValidator(_speakable)]
