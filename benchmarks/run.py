"""All benchmarks in one run, as tables of Markdown.

    python benchmarks/run.py [--write docs/benchmarks.md]

Nothing here judges: the figures and what they were hoped to be stand side by side. `make bench` installs the peers first.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

import field
import filter as kalman
import line
import plant
import skiprope
import tracking
from measure import machine, timed, wall

LENGTHS = (1_000, 10_000, 100_000, 1_000_000)
HERE = Path(__file__).parent


def markdown(rows: Sequence[Sequence[str]]) -> list[str]:
    """A table whose first row is its header."""
    lines = ["| " + " | ".join(row) + " |" for row in rows]
    return [lines[0], "|" + "---|" * len(rows[0]), *lines[1:], ""]


def field_chapter() -> list[str]:
    """The field against its peers."""
    rows, notes = field.table()
    text = f"IGRF-14 to degree 13, {field.POINTS:,} points in bulk on one core; in brackets: how many times Fieldline's."
    return ["## Magnetic field", "", text, "", *markdown(rows), *notes, ""]


def filter_chapter() -> list[str]:
    """The filter against C, and the smoother."""
    rows = [("one core", "million samples/s", ""), *kalman.table()]
    text = "The filter that `fieldline attitude` runs, and `benchmarks/filter.c`, compiled now. Hoped for: at least 0.6 of C."
    return ["## Filter and smoother", "", text, "", *markdown(rows)]


def plant_chapter() -> list[str]:
    """The plant against C and Basilisk, and many satellites."""
    return plant.chapter(markdown)


def skiprope_chapter() -> list[str]:
    """A day of the tethered satellite, and its live stream."""
    return skiprope.chapter(markdown)


def line_chapter() -> list[str]:
    """Lines with nodes against C and MoorDyn, and the implicit method against the explicit one."""
    return line.chapter(markdown)


def tracking_chapter() -> list[str]:
    """Flight by current against SciPy and python-control."""
    return tracking.chapter(markdown)


def import_s() -> float:
    """[s] that `import fieldline` takes in a fresh interpreter, the interpreter's own start taken off; best of five."""
    bare = min(wall(sys.executable, "-c", "pass") for _ in range(5))
    return min(wall(sys.executable, "-c", "import fieldline") for _ in range(5)) - bare


def start_chapter() -> list[str]:
    """Import, and the demo from a cold shell with its kernels compiled before."""
    command = [sys.executable, "-c", "from fieldline.cli import main; main()"]
    with tempfile.TemporaryDirectory() as folder:
        demo = [*command, "demo", "--out", folder, "--quiet"]
        wall(*demo)
        rows = [
            ("a new process, best of several", "seconds", "hoped for"),
            ("`import fieldline`", f"{import_s():.3f}", "under 0.3"),
            ("`fieldline --help`", f"{min(wall(*command, '--help') for _ in range(3)):.2f}", ""),
            ("`fieldline demo`, compiled before", f"{min(wall(*demo) for _ in range(2)):.1f}", "under 5"),
        ]
    return ["## From a cold shell", "", *markdown(rows)]


def scaling_chapter() -> list[str]:
    """Cost and memory of the stages against the number of samples."""
    found = []
    for samples in LENGTHS:
        done = subprocess.run(
            [sys.executable, str(HERE / "scaling.py"), str(samples)], check=True, capture_output=True, text=True
        )
        found.append(json.loads(done.stdout))
    rows = [("samples", *(f"{stage} [s]" for stage in found[0]["seconds"]), "peak memory [MB]")]
    for one in found:
        rows.append((f"{one['samples']:,}", *(f"{s:.3g}" for s in one["seconds"].values()), f"{one['peak_mb']:.0f}"))
    text = (
        "Reading a CSV, choosing and fitting the calibration, and one pass of filter and smoother over the whole record; each "
        "length in a process of its own. Hoped for: linear, memory bounded. The libraries alone take some 250 MB."
    )
    return ["## Against the number of samples", "", text, "", *markdown(rows)]


def page() -> str:
    """The whole page."""
    chapters = [
        chapter()
        for chapter in (
            start_chapter,
            field_chapter,
            filter_chapter,
            skiprope_chapter,
            plant_chapter,
            line_chapter,
            tracking_chapter,
            scaling_chapter,
        )
    ]
    head = [
        "# Benchmarks",
        "",
        "Written by `make bench`; figures of one machine, so compare the ratios.",
        "",
        f"{machine()}.",
        "",
    ]
    return "\n".join([*head, *(line for chapter in chapters for line in chapter)]).rstrip() + "\n"


def main() -> None:
    """Print the page, and write it where asked."""
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--write", type=Path, metavar="FILE", help="also write the tables here")
    chosen = options.parse_args()
    texts: list[str] = []
    taken = timed(lambda: texts.append(page()))
    print(texts[0])
    if chosen.write:
        chosen.write.write_text(texts[0], encoding="utf-8")
    print(f"the whole took {taken:.0f} s", file=sys.stderr)


if __name__ == "__main__":
    main()
