"""How kernels that take records of many arrays are compiled: without counting references.

Numba counts references to every array of a record at every call. A right-hand side whose parameters are sixty arrays
spends six times its own work on that (4.5 against 0.68 microseconds, measured); a kernel that makes no array has no use
for it. `kernel` is for such functions: they may read, write and slice the arrays they are given, and nothing that
returns a new array may be called from them, nor may one array be assigned to another. Where a function is called that
does return a new array (a user's law), that call sits in a function of its own, which is `counting`.

`inner` is for kernels that compiled code alone calls: the way in from Python, which takes every array of every record
apart, costs some two seconds of compilation each. Called from Python all the same, such a kernel crashes the process: a
test that wants one wraps it.

`merged` is for inner kernels with one caller that take many records: passing five hundred numbers costs more than what
they do with them, so their code is put where it is called (7.0 against 4.0 microseconds a step of the plant's loop).

Kernels let go of the interpreter, so that runs in threads go side by side. Division by zero gives infinity or NaN, for
the caller to find.
"""

from __future__ import annotations

from numba import njit

kernel = njit(cache=True, error_model="numpy", _nrt=False, nogil=True)
inner = njit(cache=True, error_model="numpy", _nrt=False, no_cpython_wrapper=True, no_cfunc_wrapper=True)
merged = njit(cache=True, error_model="numpy", _nrt=False, no_cpython_wrapper=True, no_cfunc_wrapper=True, forceinline=True)
# Said aloud that it counts: a callee inherits what its caller was compiled with.
counting = njit(cache=True, _nrt=True, no_cpython_wrapper=True, no_cfunc_wrapper=True)
