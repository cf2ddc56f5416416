"""Files that appear whole or not at all: written beside their place, then renamed into it."""

from __future__ import annotations

import codecs
import hashlib
import os
import tempfile
from collections.abc import Callable
from pathlib import Path

from fieldline.errors import InputError


def write_whole(path: str | Path, write: Callable[[Path], None]) -> Path:
    """Let `write` fill a temporary file in the same folder, flush it to disk and rename it to `path`.

    Whatever stops `write` (an error, Ctrl-C, a full disk) leaves the old file as it was and no partial one.
    """
    path = Path(path)
    if not path.parent.is_dir():
        raise InputError(f'cannot write "{path}": the folder "{path.parent}" does not exist. Make it first.')
    try:
        handle, name = tempfile.mkstemp(prefix=f".{path.stem}-", suffix=path.suffix, dir=path.parent)
    except OSError as error:
        raise InputError(f'cannot write in "{path.parent}": {error.strerror}. Choose another place with --out.') from error
    os.close(handle)
    beside = Path(name)
    try:
        write(beside)
        with open(beside, "rb") as written:
            os.fsync(written.fileno())
        os.chmod(beside, 0o666 & ~_umask())
        os.replace(beside, path)
    except OSError as error:
        raise InputError(f'could not write "{path}": {error.strerror or error}. Nothing was changed there.') from error
    finally:
        beside.unlink(missing_ok=True)
    return path


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
    strange = sum((c < " " and c not in "\t\n\r\f\x1a") or "\x7f" <= c <= "\x9f" for c in text[:65536])
    if strange:
        raise InputError(f'the {what} "{path.name}" is binary, not text ({strange} control characters at its beginning).')
    return text


def sha256_of(path: str | Path) -> str:
    """Hex digest of a file's bytes, read in blocks."""
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _umask() -> int:
    """The process's umask, which can only be read by setting it."""
    mask = os.umask(0)
    os.umask(mask)
    return mask
