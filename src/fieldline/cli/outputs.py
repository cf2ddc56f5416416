"""What a command writes: the files of a STEM, all together or none."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from fieldline.errors import InputError

ENDINGS = (".nc", ".csv", ".aem", ".html", ".json", ".png")


def stem_of(out: Path | None, source: Path, what: str) -> Path:
    """The STEM that was given, without an ending of ours; by default the source's name with `what`, in this folder."""
    if out is None:
        return Path(f"{source.stem}_{what}")
    if out.is_dir():
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
        if path.resolve() in read:
            raise InputError(f'the output "{path}" would replace an input of the same name; choose another --out.')


def wrote(paths: Sequence[Path]) -> str:
    """For example: wrote flight.nc, flight.csv."""
    return "wrote " + ", ".join(str(path) for path in paths)
