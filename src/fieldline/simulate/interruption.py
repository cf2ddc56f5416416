"""Ctrl-C while compiled code runs.

Python hears a signal at the next line of Python, and in a run that is as a rule the first of a function that compiled
code calls back: what is raised there has no caller to go to and would be lost. So the first Ctrl-C is written down where
the loop looks, and a second one, for a law that does not end, is raised as usual.
"""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager


def is_compiling() -> bool:
    """Whether Numba is at work on the loop."""
    module = sys.modules.get("fieldline.simulate.loop.fly")
    return bool(getattr(getattr(module, "fly", None), "is_compiling", False))


@contextmanager
def noted(host) -> Iterator[None]:
    """Within: `host.error` becomes a KeyboardInterrupt at the first SIGINT, unless the program handles it in a way of its own."""
    usual = signal.default_int_handler
    if threading.current_thread() is not threading.main_thread() or signal.getsignal(signal.SIGINT) is not usual:
        yield
        return

    def note(number, frame):
        signal.signal(signal.SIGINT, usual)
        host.error = KeyboardInterrupt()
        if is_compiling():
            raise host.error  # nothing flies yet, and compiling takes long

    def unraised(unraisable, tell=sys.unraisablehook):
        """Say nothing of an interruption that the compiler could not pass on; it is noted."""
        if not isinstance(unraisable.exc_value, KeyboardInterrupt):
            tell(unraisable)

    told = sys.unraisablehook
    signal.signal(signal.SIGINT, note)
    sys.unraisablehook = unraised
    try:
        yield
    finally:
        sys.unraisablehook = told
        signal.signal(signal.SIGINT, usual)
