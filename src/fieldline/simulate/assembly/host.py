"""The user's own functions: found by name, compiled where asked, called back where not, and blamed by name.

A function is named "file.py:function", the file beside the scenario, or "module:function". Compiled functions go into the
loop's slots; plain ones are called through the `Host`, which keeps what they raise.
"""

from __future__ import annotations

import importlib
import importlib.util
import re
from pathlib import Path

import numpy as np

from fieldline.errors import InputError, nearest, raised, shown
from fieldline.simulate.loop.functions import SLOTS, Callback, Functions


def function_of(name: str, folder: Path, where: str):
    """The function of a name; InputError says what is missing."""
    place, _, attribute = name.rpartition(":")
    if place.endswith(".py"):
        module = _module_of_file(folder / place, where)
    else:
        try:
            module = importlib.import_module(place)
        except (Exception, SystemExit) as error:
            raise InputError(f'{where} names "{name}", but importing {place} failed: {raised(error)}.') from None
    found = getattr(module, attribute, None)
    if not callable(found):
        names = [n for n in dir(module) if callable(getattr(module, n)) and not n.startswith("_")]
        raise InputError(f'{where} names "{name}", but {place} has no function "{attribute}"; {nearest(attribute, names)}')
    return found


def _module_of_file(path: Path, where: str):
    """A Python file as a module, under a name of its own."""
    if not path.is_file():
        raise InputError(f"{where} names the file {path.name}, which does not lie in {path.parent}. Is the path relative to it?")
    spec = importlib.util.spec_from_file_location(f"fieldline_user_{path.stem}", path)
    if spec is None or spec.loader is None:
        raise InputError(f"{where} names {path.name}, which Python cannot load as a module.")
    module = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except (Exception, SystemExit) as error:
        raise InputError(f"{where} names {path.name}, which fails as it is loaded: {raised(error)}.") from None
    return module


def is_compiled(function) -> bool:
    """Whether Numba has it in hand already."""
    return hasattr(function, "py_func")


def compiled(function, signature, where: str):
    """The function compiled for a signature; InputError where Numba cannot, or where it returns something else."""
    from numba import config, njit

    if config.DISABLE_JIT:
        return function
    try:
        dispatcher = function if is_compiled(function) else njit(function)
        dispatcher.compile(signature.args)
    except Exception as error:  # Numba raises its own errors, and Python's for a wrong count of arguments
        raise InputError(
            f"{where} cannot be compiled by Numba: {_gist(str(error))} It is called with {len(signature.args)} arguments. Write "
            "it with numbers, tuples and NumPy arrays alone, or set compiled = false to run it as plain Python."
        ) from None
    returned = dispatcher.overloads[tuple(signature.args)].signature.return_type
    if returned != signature.return_type:
        raise InputError(
            f"{where} must return a one-dimensional float64 array when compiled; Numba finds that it returns {returned}. Use "
            "np.array([...]), or set compiled = false."
        )
    return dispatcher


def _gist(message: str) -> str:
    """What Numba's message says beyond that it failed, and in which line of the function."""
    lines = [re.sub(r"\x1b\[[0-9;]*m", "", line).strip() for line in message.splitlines()]
    lines = [line for line in lines if line and not line.startswith(("Failed in nopython", "During: resolving"))]
    place = next((found[1] for line in lines if (found := re.search(r'File ".*", (line \d+)', line))), "")
    telling = next((line for line in lines if not line.startswith("File ")), "no reason given")
    return f"{shown(telling, 200).rstrip('.:')}{f', {place}' if place else ''}."


class Host:
    """Plain Python functions of a run, by number, and what went wrong in them."""

    def __init__(self):
        """Empty; `connect` gives it the arrays through which it answers."""
        self.functions: dict[int, object] = {}
        self.error: BaseException | None = None
        self.callback = Callback(self._call)
        self._reply = np.zeros(1)
        self._replies = np.zeros(1, dtype=np.int64)

    def add(self, which: int, function) -> None:
        """`function(t)` answers calls of number `which`."""
        self.functions[which] = function

    def connect(self, shared) -> None:
        """Answer into these arrays."""
        self._reply, self._replies = shared.reply, shared.replies

    def _call(self, which: int, t: float) -> int:
        """Called from compiled code; whatever happens, it returns. After an error it calls nothing any more."""
        if self.error is not None:
            return 1
        try:
            answer = self.functions[which](t)
            if answer is None:
                self._replies[0] = 0
                return 0
            values = np.asarray(answer)
            if np.iscomplexobj(values):
                raise TypeError("it returned complex numbers; take their real parts")
            values = np.asarray(values, dtype=float).ravel()
            self._replies[0] = values.size
            kept = min(values.size, self._reply.size)  # too many numbers are refused by their count
            self._reply[:kept] = values[:kept]
            return 0
        except BaseException as error:
            self.error = error
            return 1


class Slots:
    """Compiled functions of one kind, in the loop's few places."""

    def __init__(self, filler, signature, what: str):
        """`filler` fills the places that stay empty; all have one signature."""
        self._filler, self._signature, self._what = filler, signature, what
        self.functions: list = []

    def add(self, function) -> int:
        """A slot of its own for a function; InputError where none is left."""
        if len(self.functions) == SLOTS:
            raise InputError(
                f"a run takes {SLOTS} compiled {self._what}, the library's counted. Write the others in plain Python (for a law "
                "compiled = false), or fly fewer bodies with software in one run."
            )
        self.functions.append(function)
        return len(self.functions) - 1

    def share(self, function) -> int:
        """The slot of a function that remembers nothing: the one it has already, or a new one."""
        return self.functions.index(function) if function in self.functions else self.add(function)

    def filled(self) -> Functions:
        """All slots."""
        return Functions([*self.functions, *(self._filler,) * (SLOTS - len(self.functions))], self._signature)
