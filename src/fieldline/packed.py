"""Records of many arrays, given to compiled code as one pointer.

Numba passes a NamedTuple by value, array by array, seven numbers each or more: a plant of three hundred arrays is two
thousand arguments of every function that takes it, and the compiler works on them in each. `pack(record)` writes where
the arrays lie, and what numbers the record holds, into one row of words,

    array of n axes: address, n lengths      number: itself      tuple of numbers: one after the other
    record in the record: its words, in its place                                                            (1)

and compiled code gets the row's address. An attribute there is a load at a place known when the code is compiled; a record
in the record is the address of its part of the row, and costs nothing. The words never change while the code runs, and the
compiler is told so (`invariant.load`): it may keep what it has loaded across stores into arrays. Arrays belong to the
Python object; compiled code neither counts references to them nor frees them.

In plain Python a Packed has the attributes of its record; with JIT off `pack` gives the record itself.
Arrays must be C-contiguous; a number keeps its type (float, int, bool), those in a tuple are floats.
"""

from __future__ import annotations

import struct
from functools import cache
from hashlib import sha256
from typing import NamedTuple

import numpy as np
from llvmlite import ir
from numba import config, types
from numba.core.imputils import impl_ret_borrowed
from numba.core.typing.templates import AttributeTemplate
from numba.extending import NativeValue, infer_getattr, lower_getattr_generic, models, register_model, unbox
from numba.np.arrayobj import make_array, populate_array
from numba.np.numpy_support import from_dtype

WORD = 8  # bytes


class Place(NamedTuple):
    """Where an attribute is in the row of words, and what it is to compiled code."""

    word: int
    kind: types.Type


class PackedType(types.Type):
    """What compiled code knows of a packed record: the place and the kind of each attribute."""

    def __init__(self, record: type, kinds: tuple[types.Type, ...]):
        self.record = record
        self.kinds = kinds
        self.places = {}
        at = 0
        for name, kind in zip(record._fields, kinds, strict=True):
            self.places[name] = Place(at, kind)
            at += words_of(kind)
        self.words = at
        whole = f"{record.__module__}.{record.__qualname__}({', '.join(map(str, kinds))})"
        super().__init__(name=f"Packed({record.__qualname__} {sha256(whole.encode()).hexdigest()[:16]})")


def words_of(kind: types.Type) -> int:
    """How many words an attribute takes; equation (1)."""
    if isinstance(kind, PackedType):
        return kind.words
    if isinstance(kind, types.Array):
        return 1 + kind.ndim
    return len(kind) if isinstance(kind, types.BaseTuple) else 1


@cache
def packed_type(record: type, kinds: tuple[types.Type, ...]) -> PackedType:
    """The type of a record, made once: Numba's types are slow to make."""
    return PackedType(record, kinds)


@cache
def array_type(dtype: np.dtype, axes: int, writeable: bool) -> types.Array:
    """The type of a C-contiguous array."""
    return types.Array(from_dtype(dtype), axes, "C", readonly=not writeable)


class Packed:
    """A NamedTuple of arrays, numbers, tuples of numbers and such NamedTuples, for compiled code; see the module.

    Its own names begin with an underscore, which no field of a NamedTuple does.
    """

    __slots__ = ("_address", "_numba_type_", "_record", "_words")

    def __init__(self, record):
        self._record = record
        words = bytearray()
        self._numba_type_ = _write(record, words, type(record).__name__)
        self._words = np.frombuffer(words, dtype=np.int64)
        self._address = self._words.ctypes.data

    def __getattr__(self, name: str):
        return getattr(self._record, name)


def pack(record):
    """What kernels take for a record: a Packed; with JIT off the record itself, whose attributes are nearer."""
    return record if config.DISABLE_JIT else Packed(record)


def _write(record, words: bytearray, where: str) -> PackedType:
    """Append a record's words; its type."""
    kinds = []
    for name, value in zip(record._fields, record, strict=True):
        if isinstance(value, np.ndarray):
            if not (value.flags.c_contiguous and value.flags.aligned):
                raise TypeError(f"{where}.{name} must be a C-contiguous array; its strides are {value.strides}")
            kinds.append(array_type(value.dtype, value.ndim, value.flags.writeable))
            words += struct.pack(f"{1 + value.ndim}q", value.__array_interface__["data"][0], *value.shape)
        elif hasattr(value, "_fields"):
            kinds.append(_write(value, words, f"{where}.{name}"))
        elif isinstance(value, tuple):
            kinds.append(types.UniTuple(types.float64, len(value)))
            words += struct.pack(f"{len(value)}d", *value)
        elif isinstance(value, float | np.floating):
            kinds.append(types.float64)
            words += struct.pack("d", value)
        else:
            kinds.append(types.boolean if isinstance(value, bool | np.bool_) else types.int64)
            words += struct.pack("q", int(value))
    return packed_type(type(record), tuple(kinds))


@register_model(PackedType)
class PackedModel(models.PrimitiveModel):
    """The address of a row of words."""

    def __init__(self, manager, kind):
        super().__init__(manager, kind, ir.IntType(64).as_pointer())


@unbox(PackedType)
def take_address(kind, packed, c):
    """The address out of the Python object."""
    number = c.pyapi.object_getattr_string(packed, "_address")
    address = c.pyapi.long_as_voidptr(number)
    c.pyapi.decref(number)
    return NativeValue(c.builder.bitcast(address, ir.IntType(64).as_pointer()))


@infer_getattr
class PackedAttributes(AttributeTemplate):
    """Types of the attributes."""

    key = PackedType

    def generic_resolve(self, packed, name):
        """The kind of an attribute; None where there is none of that name."""
        place = packed.places.get(name)
        return None if place is None else place.kind


@lower_getattr_generic(PackedType)
def load_attribute(context, builder, packed, row, name):
    """An attribute out of the row of words."""
    place = packed.places[name]
    kind = place.kind
    if isinstance(kind, PackedType):
        return builder.gep(row, [ir.Constant(ir.IntType(64), place.word)], inbounds=True)
    if isinstance(kind, types.Array):
        return _load_array(context, builder, kind, row, place.word)
    if isinstance(kind, types.BaseTuple):
        return context.make_tuple(builder, kind, [_load(builder, row, place.word + i, ir.DoubleType()) for i in range(len(kind))])
    if kind == types.boolean:
        word = _load(builder, row, place.word, ir.IntType(64))
        return builder.icmp_signed("!=", word, ir.Constant(ir.IntType(64), 0))
    return _load(builder, row, place.word, context.get_value_type(kind))


def _load(builder, row, word: int, wanted):
    """One word, as a value of the wanted LLVM type."""
    at = builder.gep(row, [ir.Constant(ir.IntType(64), word)], inbounds=True)
    value = builder.load(builder.bitcast(at, wanted.as_pointer()))
    value.set_metadata("invariant.load", builder.module.add_metadata([]))
    return value


def _load_array(context, builder, kind, row, word: int):
    """An array without an owner, which nobody counts."""
    whole = make_array(kind)(context, builder)
    item = context.get_data_type(kind.dtype)
    data = _load(builder, row, word, item.as_pointer())
    length = ir.IntType(64)
    shape = [_load(builder, row, word + 1 + i, length) for i in range(kind.ndim)]
    size = context.get_abi_sizeof(item)
    strides = [ir.Constant(length, size)]
    for extent in reversed(shape[1:]):
        strides.insert(0, builder.mul(strides[0], extent, flags=["nsw"]))
    populate_array(whole, data=data, shape=shape, strides=strides, itemsize=ir.Constant(length, size), meminfo=None)
    return impl_ret_borrowed(context, builder, kind, whole._getvalue())
