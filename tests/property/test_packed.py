"""Packed records against the records they are made of: every kind of attribute, as compiled and as plain code reads it."""

from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numba import njit
from numba.core.errors import TypingError

from fieldline.compiled import kernel
from fieldline.packed import Packed

pytestmark = pytest.mark.kernels


class Inside(NamedTuple):
    table: np.ndarray
    gain: float
    count: int


class Outside(NamedTuple):
    rows: np.ndarray
    inside: Inside
    used: bool
    pair: tuple[float, float]
    numbers: np.ndarray
    cube: np.ndarray


class Word(NamedTuple):
    record: bool
    words: int


@kernel
def weighed(record):
    """Every attribute, each with a weight of its own, and a store into an array between two readings of it."""
    total = 0.0
    for i in range(record.rows.shape[0]):
        for j in range(record.rows.shape[1]):
            total += (i + 2 * j + 1) * record.rows[i, j]
    for i in range(record.inside.table.shape[0]):
        total += 100.0 * record.inside.table[i] * record.inside.gain
    if record.used:
        total += 1000.0 * record.inside.count
    for i in range(record.numbers.shape[0]):
        total += record.numbers[i] * record.pair[0]
        record.numbers[i] += 1
        total += record.numbers[i] * record.pair[1]
    return total + record.cube[-1, -1, -1]


@njit
def both(first, second):
    """Types tell two records of one class apart."""
    return weighed(first), weighed(second)


numbers = st.floats(-1e6, 1e6)


def made(seed, rows, columns, used, gain, count, pair):
    rng = np.random.default_rng(seed)
    inside = Inside(rng.normal(size=rows), gain, count)
    whole = rng.integers(-5, 5, size=4)
    return Outside(rng.normal(size=(rows, columns)), inside, used, pair, whole, rng.normal(size=(2, 3, columns)))


@settings(max_examples=30, deadline=None)
@given(
    seed=st.integers(0, 2**31),
    rows=st.integers(0, 4),
    columns=st.integers(1, 5),
    used=st.booleans(),
    gain=numbers,
    count=st.integers(-(2**40), 2**40),
    pair=st.tuples(numbers, numbers),
)
def test_compiled_code_reads_what_python_reads(seed, rows, columns, used, gain, count, pair):
    record = made(seed, rows, columns, used, gain, count, pair)
    expected = getattr(weighed, "py_func", weighed)(made(seed, rows, columns, used, gain, count, pair))
    scale = abs(expected) + 1e3 * abs(count) + 1e2 * abs(gain) + 1e2 * np.abs(pair).max() + 1e3
    assert weighed(Packed(record)) == pytest.approx(expected, abs=1e-12 * scale)
    assert record.numbers.tolist() == (np.array(made(seed, rows, columns, used, gain, count, pair).numbers) + 1).tolist()


def test_an_array_written_to_is_the_records_own():
    record = made(1, 2, 3, True, 1.0, 2, (0.5, 0.25))
    packed, before = Packed(record), record.numbers.copy()
    weighed(packed)
    weighed(packed)
    assert (record.numbers == before + 2).all() and packed.numbers is record.numbers
    assert packed.inside.gain == 1.0 and packed.pair == (0.5, 0.25)


def test_records_of_other_kinds_are_other_types():
    """A read-only array is another type, and cannot be written to."""
    one, other = made(1, 2, 3, True, 1.0, 2, (0.5, 0.25)), made(2, 3, 1, False, 2.0, 3, (1.0, 2.0))
    assert Packed(one)._numba_type_ == Packed(other)._numba_type_
    expected = tuple(getattr(weighed, "py_func", weighed)(made(*way)) for way in WAYS)
    assert both(Packed(one), Packed(other)) == pytest.approx(expected, rel=1e-13)
    other.numbers.flags.writeable = False
    assert Packed(one)._numba_type_ != Packed(other)._numba_type_
    with pytest.raises((TypingError, ValueError)):
        weighed(Packed(other))


WAYS = ((1, 2, 3, True, 1.0, 2, (0.5, 0.25)), (2, 3, 1, False, 2.0, 3, (1.0, 2.0)))


def test_numpy_numbers_are_numbers():
    packed = Packed(Word(np.bool_(True), np.int64(-3)))
    assert packed.record and packed.words == -3
    assert packed._numba_type_ == Packed(Word(False, 7))._numba_type_
    assert packed._words.tolist() == [1, -3]


def test_an_array_that_is_not_whole_is_refused_by_name():
    record = made(1, 4, 4, True, 1.0, 2, (0.5, 0.25))
    with pytest.raises(TypeError, match=r"Outside\.rows must be a C-contiguous array"):
        Packed(record._replace(rows=record.rows[:, ::2]))
    with pytest.raises(TypeError, match=r"Outside\.inside\.table"):
        Packed(record._replace(inside=record.inside._replace(table=np.arange(6.0)[::2])))


def test_an_attribute_that_is_not_there_is_an_error():
    packed = Packed(Word(True, 1))
    with pytest.raises(AttributeError):
        packed.other  # noqa: B018
