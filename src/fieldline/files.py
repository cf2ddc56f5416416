"""Files that appear whole or not at all: written beside their place, then renamed into it."""

from __future__ import annotations

import codecs
import hashlib
import os
import re
import shutil
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

from fieldline.errors import InputError

CONTROL = re.compile(r"[\x00-\x08\x0b\x0e-\x19\x1b-\x1f\x7f-\x9f]")  # without tab, line ends, and the old mark of a file's end


def write_whole(path: str | Path, write: Callable[[Path], object]) -> Path:
    """Let `write` fill a temporary file in the same folder, flush it to disk and rename it to `path`.

    Whatever stops `write` (an error, Ctrl-C, a full disk) leaves the old file as it was and no partial one.
    """
    return write_together([(Path(path), write)])[0]


def write_together(files: Sequence[tuple[Path, Callable[[Path], object]]]) -> list[Path]:
    """`write_whole` for several files: none is renamed into its place before all of them are written."""
    staged: list[tuple[Path, Path]] = []
    path = Path()
    try:
        for path, write in files:
            beside = _beside(path)
            staged.append((beside, path))
            _written(write, beside, path)
            with open(beside, "rb") as written:
                os.fsync(written.fileno())
        for beside, path in staged:
            os.replace(beside, path)
    except OSError as error:
        raise InputError(f'could not write "{path}": {error.strerror or error}. Nothing was changed there.') from error
    finally:
        for beside, _ in staged:
            shutil.rmtree(beside.parent, ignore_errors=True)
    return [path for _, path in staged]


def _written(write: Callable[[Path], object], beside: Path, path: Path) -> None:
    """Let `write` fill the file beside; one that itself writes whole names the file's own place when it fails."""
    try:
        write(beside)
    except InputError as error:
        raise InputError(str(error).replace(str(beside), str(path))) from error


def _beside(path: Path) -> Path:
    """A path of the same name in a new, hidden folder beside it."""
    if not path.parent.is_dir():
        raise InputError(f'cannot write "{path}": the folder "{path.parent}" does not exist. Make it first.')
    try:
        folder = tempfile.mkdtemp(prefix=f".{path.stem}-", dir=path.parent)
    except OSError as error:
        raise InputError(f'cannot write in "{path.parent}": {error.strerror}. Choose another place with --out.') from error
    return Path(folder) / path.name


def write_text_whole(path: str | Path, text: str) -> Path:
    """`write_whole` for text in UTF-8."""
    return write_whole(path, lambda beside: beside.write_text(text, encoding="utf-8"))


def read_text(path: str | Path, what: str) -> str:
    """A small text file, UTF-8 (or UTF-16 with its mark, or Latin-1); InputError names `what` it should have been."""
    path = Path(path)
    try:
        content = path.read_bytes()
    except FileNotFoundError as error:
        raise InputError(f'the {what} "{path}" does not exist. Is the path right?') from error
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise InputError(f'the {what} "{path}" cannot be read: {reason}.') from error
    marks = {codecs.BOM_UTF8: "utf-8-sig", codecs.BOM_UTF16_LE: "utf-16", codecs.BOM_UTF16_BE: "utf-16"}
    encoding = next((name for mark, name in marks.items() if content.startswith(mark)), "utf-8")
    try:
        text = content.decode(encoding)
    except UnicodeDecodeError:
        text = content.decode("latin-1")
    if not text.strip():
        raise InputError(f'the {what} "{path.name}" is empty.')
    strange = len(CONTROL.findall(text))
    if strange:
        raise InputError(f'the {what} "{path.name}" is binary, not text (it holds {strange} control characters).')
    return text


def sha256_of(path: str | Path) -> str:
    """Hex digest of a file's bytes, read in blocks."""
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
