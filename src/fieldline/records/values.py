"""The kinds of value that records hold beyond single numbers: vectors, directions, tensors, lists of records.

Each validator's words follow the key's path: "body[0].wheel[1].axis_b" + " must be three numbers [x, y, z]; got 2."
"""

from __future__ import annotations

from math import hypot, isfinite
from typing import Annotated, Any

import numpy as np
from pydantic import AfterValidator, BeforeValidator, Field, WithJsonSchema

from fieldline.records.words import came

SYMMETRY_TOLERANCE = 1e-9  # relative; below it a difference across the diagonal is rounding
NUMBER = {"type": "number"}
ROW = {"type": "array", "items": NUMBER, "minItems": 3, "maxItems": 3}
ROWS = {"type": "array", "items": ROW, "minItems": 3, "maxItems": 3}
TENSOR_SCHEMA = {"anyOf": [ROW, ROWS]}

Three = tuple[float, float, float]


def _number(value: Any) -> bool:
    """Whether a value is a finite number, and no truth value."""
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < 1e300 and isfinite(value)


def _of_length(count: int, words: str):
    """A check that a list has `count` entries, before its entries are looked at."""

    def check(value: Any) -> Any:
        value = value.tolist() if isinstance(value, np.ndarray) else value
        if not isinstance(value, list | tuple):
            raise ValueError(f"must be {words}; got {came(value)}")
        if len(value) != count:
            raise ValueError(f"must be {words}; got {len(value)} entries")
        return tuple(value)

    return check


def _unit(value: Three) -> Three:
    """A direction of length 1; one that has it already is left as it is to the last digit."""
    length = hypot(*value)
    if length == 0.0:
        raise ValueError("must be a direction; got a vector of zero length")
    if abs(length - 1.0) <= 1e-15:
        return value
    scaled = np.array(value) / np.abs(value).max()  # neither overflow nor underflow in the length
    x, y, z = (scaled / np.linalg.norm(scaled)).tolist()
    return x, y, z


def _unit_quaternion(value: tuple[float, float, float, float]) -> tuple[float, float, float, float]:
    """A unit quaternion; lengths more than 1 % from 1 are a mistake, smaller ones rounding of the user's."""
    length = hypot(*value)
    if not 0.99 < length < 1.01:
        raise ValueError(f"must be a unit quaternion, scalar last; its length is {length:.6g}")
    x, y, z, w = value
    return value if abs(length - 1.0) <= 1e-15 else (x / length, y / length, z / length, w / length)


def _rows(value: Any) -> tuple[Three, Three, Three]:
    """Three rows of three from three numbers (a diagonal) or from three rows."""
    value = value.tolist() if isinstance(value, np.ndarray) else value
    words = "must be three numbers (a diagonal) or three rows of three numbers"
    if not isinstance(value, list | tuple) or len(value) != 3:
        raise ValueError(
            f"{words}; got {len(value)} entries" if isinstance(value, list | tuple) else f"{words}; got {came(value)}"
        )
    if all(_number(x) for x in value):
        x, y, z = map(float, value)
        return (x, 0.0, 0.0), (0.0, y, 0.0), (0.0, 0.0, z)
    for row in value:
        if not isinstance(row, list | tuple) or len(row) != 3 or not all(_number(x) for x in row):
            raise ValueError(f"{words}, all finite; got {came(row)} in it")
    first, second, third = ((float(x), float(y), float(z)) for x, y, z in value)
    return first, second, third


def _symmetric(value: Any) -> tuple[Three, Three, Three]:
    """`_rows` of a tensor that equals its transpose."""
    rows = _rows(value)
    matrix = np.array(rows)
    if np.abs(matrix - matrix.T).max() > SYMMETRY_TOLERANCE * np.abs(matrix).max():
        raise ValueError("must be symmetric; its elements differ across the diagonal")
    return rows


def _dissipative(value: Any) -> tuple[Three, Three, Three]:
    """`_symmetric` without a negative principal value."""
    rows = _symmetric(value)
    least = float(np.linalg.eigvalsh(rows)[0])
    if least < -SYMMETRY_TOLERANCE * float(np.abs(rows).max()):
        raise ValueError(f"must have no negative principal value, or it would feed energy in; got {least:.6g}")
    return rows


def _inertia(value: Any) -> tuple[Three, Three, Three]:
    """`_rows` that a rigid body can have: symmetric, positive, none larger than the sum of the other two."""
    from fieldline.mechanics.rigid_body import as_inertia9

    rows = _rows(value)
    try:
        as_inertia9(rows)
    except ValueError as error:
        raise ValueError(str(error).removeprefix("inertia_kg_m2 ")) from None
    return rows


def _invertible(value: Any) -> tuple[Three, Three, Three]:
    """`_rows` of a gain that loses no axis."""
    rows = _rows(value)
    if abs(np.linalg.det(rows)) < 1e-6:
        raise ValueError("must not lose an axis: its determinant is 0")
    return rows


VECTOR = BeforeValidator(_of_length(3, "three numbers [x, y, z]"))
Vector = Annotated[Three, Field(strict=False), VECTOR, WithJsonSchema(ROW)]
Direction = Annotated[Three, Field(strict=False), VECTOR, AfterValidator(_unit), WithJsonSchema(ROW)]
Quaternion = Annotated[
    tuple[float, float, float, float],
    Field(strict=False),
    BeforeValidator(_of_length(4, "four numbers [x, y, z, w]")),
    AfterValidator(_unit_quaternion),
    WithJsonSchema({"type": "array", "items": NUMBER, "minItems": 4, "maxItems": 4}),
]
Rows = tuple[Three, Three, Three]
Tensor = Annotated[Rows, Field(strict=False), BeforeValidator(_rows), WithJsonSchema(TENSOR_SCHEMA)]
Gain = Annotated[Rows, Field(strict=False), BeforeValidator(_invertible), WithJsonSchema(TENSOR_SCHEMA)]
Symmetric = Annotated[Rows, Field(strict=False), BeforeValidator(_symmetric), WithJsonSchema(TENSOR_SCHEMA)]
Dissipative = Annotated[Rows, Field(strict=False), BeforeValidator(_dissipative), WithJsonSchema(TENSOR_SCHEMA)]
Inertia = Annotated[Rows, Field(strict=False), BeforeValidator(_inertia), WithJsonSchema(TENSOR_SCHEMA)]
SPREAD = {"items": {**NUMBER, "minimum": 0.0}}
IDENTITY = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
ZEROS = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


def _spread(value: Three) -> Three:
    """Standard deviations."""
    if min(value) < 0.0:
        raise ValueError(f"must hold no negative number; got {min(value):.6g}")
    return value


def _spread_of(value: Any) -> Any:
    """One number for all three axes, or one for each."""
    value = value.tolist() if isinstance(value, np.ndarray) else value
    return (value,) * 3 if _number(value) else _of_length(3, "a number or three numbers [x, y, z]")(value)


Spread = Annotated[
    Three,
    Field(strict=False),
    BeforeValidator(_spread_of),
    AfterValidator(_spread),
    WithJsonSchema({"anyOf": [{**NUMBER, "minimum": 0.0}, {**ROW, **SPREAD}]}),
]
