"""A force and torque of the user's own, as a function in Python."""

from __future__ import annotations

from typing import Annotated

from pydantic import AfterValidator, Field

from fieldline.records import Record

EXPECTED = 'must name a function as "file.py:function" or "module:function"'


def is_function_name(text: str) -> bool:
    """Whether a text has the form "file.py:function" or "module:function"."""
    place, colon, function = text.rpartition(":")
    return bool(colon) and bool(place.strip()) and function.isidentifier()


def _function_name(text: str) -> str:
    """The text, if it names a function."""
    if not is_function_name(text):
        raise ValueError(f'{EXPECTED}; got "{text[:60]}"')
    return text


FunctionName = Annotated[str, AfterValidator(_function_name)]


class UserLoad(Record):
    """A load written by the user, compiled (`@njit`) or in plain Python."""

    function: FunctionName = Field(
        description='the function: "file.py:function", the file relative to the scenario file, or "module:function"'
    )
    parameters: dict[str, float] = Field(default={}, description="numbers handed to the function as an array, in this order")
