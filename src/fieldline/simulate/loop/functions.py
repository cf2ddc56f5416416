"""The types of functions that a run is given: laws, loads and the call back into Python.

A compiled function is passed by its address, so that the loop is compiled once, and kept, whatever laws it runs. Plain
Python is reached through one C callback, `call(which, t)`: 0.3 microseconds on top of the function itself.
"""

from __future__ import annotations

import ctypes

import numpy as np
from numba import njit, types
from numba.extending import typeof_impl

from fieldline.sensing.measurement import Measurement

VECTOR = types.float64[::1]
MEASUREMENT = types.NamedUniTuple(VECTOR, len(Measurement._fields), Measurement)
LAW = VECTOR(types.float64, MEASUREMENT, VECTOR, VECTOR)  # (t, measurement, memory, params) -> commands
LOAD = VECTOR(types.float64, VECTOR, VECTOR)  # (t, state, params) -> force_i and torque_b, or an event's quantity
CALL = types.int64(types.int64, types.float64)
SLOTS = 8  # compiled laws of a run, and compiled loads and events


@njit(LAW, cache=True)
def no_law(t, measurement, memory, params):
    """Fills an empty slot."""
    return np.zeros(0)


@njit(LOAD, cache=True)
def no_load(t, state, params):
    """Fills an empty slot."""
    return np.zeros(6)


class Functions(tuple):
    """Functions of one signature, as the loop takes them.

    A plain tuple of functions is one for Numba too, but it warns, at each call, that its search for their common signature
    is experimental; here nothing is searched.
    """

    signature: object

    def __new__(cls, functions, signature):
        """`signature` is LAW or LOAD."""
        made = super().__new__(cls, functions)
        made.signature = signature
        return made


@typeof_impl.register(Functions)
def _type_of_functions(functions, context):
    """Numba's type of them."""
    return types.UniTuple(types.FunctionType(functions.signature), len(functions))


class Callback(types.WrapperAddressProtocol):
    """A Python function of (which, t) that compiled code calls; it returns 0, or 1 where it failed."""

    def __init__(self, function):
        """`function` must not raise: what it raises is lost in compiled code."""
        self.function = function
        self._pointer = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_int64, ctypes.c_double)(function)

    def __call__(self, which, t):
        """For runs without compilation."""
        return self.function(which, t)

    def __wrapper_address__(self):
        """Where the callback lies."""
        return ctypes.cast(self._pointer, ctypes.c_void_p).value

    def signature(self):
        """Numba's signature of it."""
        return CALL
