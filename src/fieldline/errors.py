"""What can go wrong, in words: which input, what came, what was expected, what to try.

Exit codes of the command line follow the class: `InputError` 2, `NoEstimateError` 1.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable


class FieldlineError(Exception):
    """Base of every error that Fieldline raises on purpose; its text is written for the user."""

    exit_code = 2


class InputError(FieldlineError, ValueError):
    """The input cannot be used as it is: the message names it and says what to try."""


class NoEstimateError(FieldlineError):
    """The job ran, but the data do not support an estimate."""

    exit_code = 1


def shown(text: str, length: int = 40) -> str:
    """A piece of the input as a message can show it: short, and no character that a terminal would obey."""
    return "".join(c if c.isprintable() else "?" for c in " ".join(text[: 4 * length].split()))[:length]


def raised(error: BaseException, length: int = 300) -> str:
    """What a function of the user's own raised: kind and text, on one line, whatever its text does."""
    try:
        text = shown(str(error), length)
    except Exception:  # an exception's own __str__ may fail
        text = ""
    return f"{type(error).__name__}: {text}" if text else type(error).__name__


def nearest(word: str, known: Iterable[str]) -> str:
    """A clause that names the nearest known word, or lists all of them when none is near."""
    known = sorted(known)
    close = difflib.get_close_matches(word.lower(), [k.lower() for k in known], n=1, cutoff=0.55)
    if close:
        match = next(k for k in known if k.lower() == close[0])
        return f'did you mean "{match}"?'
    return "known: " + ", ".join(known)
