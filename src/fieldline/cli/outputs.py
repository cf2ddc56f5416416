"""What a command writes: the files of a STEM, all together or none."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from fieldline.errors import InputError, shown

ENDINGS = (".nc", ".csv", ".aem", ".html", ".json", ".png")


def stem_of(out: Path | None, source: Path, what: str) -> Path:
    """The STEM that was given, without an ending of ours; by default the source's name with `what`, in this folder."""
    if out is None:
        return Path(f"{source.stem}_{what}")
    if exists(out, "--out") and out.is_dir():
        raise InputError(f'--out "{out}" is a folder; give a path without ending in it, for example "{out / source.stem}".')
    return out.with_suffix("") if out.suffix.lower() in ENDINGS else out


def targets(stem: Path, endings: Sequence[str], inputs: Sequence[Path | None]) -> dict[str, Path]:
    """The path of each ending; refused before any work where it cannot be written or would replace an input."""
    paths = {ending: stem.with_name(stem.name + ending) for ending in endings}
    if not stem.parent.is_dir():
        raise InputError(f'--out "{stem}": the folder "{stem.parent}" does not exist. Make it first.')
    refuse_inputs(paths.values(), inputs)
    return paths


def refuse_inputs(paths, inputs: Sequence[Path | None]) -> None:
    """InputError where an output would replace a file that is read."""
    read = {one.resolve() for one in inputs if one is not None}
    for path in paths:
        if exists(path, "the output") and path.exists() and not path.is_file():
            kind = "folder" if path.is_dir() else "device"
            raise InputError(f'the output "{path}" is no file but a {kind}; choose another name.')
        if path.resolve() in read:
            raise InputError(f'the output "{path}" would replace an input of the same name; choose another --out.')


def exists(path: Path, what: str) -> bool:
    """Whether there is such a path; InputError where there can be none, as with a name that is too long."""
    try:
        path.lstat()
        return True
    except FileNotFoundError:
        return False
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise InputError(f'{what} "{shown(str(path), 60)}" cannot be a path: {reason}. Choose another.') from None


def refuse_twins(paths: Sequence[Path | None]) -> None:
    """InputError where two outputs would be one file."""
    seen: set[Path] = set()
    for path in paths:
        if path is not None and path.resolve() in seen:
            raise InputError(f'two outputs of the command would be the same file, "{path}"; give each a name of its own.')
        seen |= {path.resolve()} if path is not None else set()


class Told(int):
    """An exit code whose reason has been told already."""


def wrote(paths: Sequence[Path]) -> str:
    """For example: wrote flight.nc, flight.csv."""
    return "wrote " + ", ".join(str(path) for path in paths)
