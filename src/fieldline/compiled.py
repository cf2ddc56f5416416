"""How kernels that take records of many arrays are compiled: without counting references.

Numba counts references to every array that it is given at every call. A right-hand side whose parameters were sixty arrays
spent six times its own work on that (4.5 against 0.68 microseconds, measured); a kernel that makes no array has no use
for it. `kernel` is for such functions: they may read, write and slice the arrays they are given, and nothing that
returns a new array may be called from them, nor may one array be assigned to another. Where a function is called that
does return a new array (a user's law), that call sits in a function of its own, which is `counting`.

`inner` is for kernels that compiled code alone calls: they need no way in from Python. Called from Python all the same,
such a kernel crashes the process: a test that wants one wraps it.

`merged` is for inner kernels whose code is put where they are called: small ones in a loop over nodes, and what every
evaluation of the right-hand side goes through (0.58 against 0.54 of plain C's pace). Not for large ones: with the whole
loop merged into one function the compiler takes three times as long.

Records go to compiled code through `fieldline.packed.pack`, as one pointer.

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
