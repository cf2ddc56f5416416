"""Every kind of bad input through the whole command: an exit code, one paragraph, and not a file touched."""

import re
from datetime import UTC, datetime
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest

from fieldline.cli import main

DATA = Path(str(files("fieldline"))) / "data"
HEAD, *ROWS = (DATA / "suchai3_2023-08-24.csv").read_text().splitlines()[:401]
ELEMENTS = (DATA / "suchai3.tle").read_text()
OLD = {f"flight{ending}": f"old {ending}" for ending in (".nc", ".csv", ".aem", ".html")}


def table(rows=ROWS, head=HEAD) -> bytes:
    return ("\n".join([head, *rows]) + "\n").encode()


def cells(change, rows=ROWS) -> list[str]:
    """The rows with `change(k, row's cells)` in the place of each."""
    return [",".join(change(k, row.split(","))) for k, row in enumerate(rows)]


def with_field(values) -> bytes:
    return table(cells(lambda k, row: [*row[:4], *values(k, row[4:7]), *row[7:]]))


def with_time(words, head="time") -> bytes:
    return table(cells(lambda k, row: [words(int(row[0])), *row[1:]]), HEAD.replace("unix_s", head))


def noise(k, _):
    return [f"{value:.1f}" for value in 3e4 * np.random.default_rng(k).standard_normal(3)]


def day_first(seconds) -> str:
    return datetime.fromtimestamp(seconds, UTC).strftime("%d/%m/%Y %H:%M:%S")


FLIGHTS = {
    "empty": (b"", 2, "is empty"),
    "binary": (bytes(range(256)) * 40, 2, "binary bytes"),
    "header only": (table([]), 2, "a header and no samples"),
    "no axis": (table(cells(lambda k, row: [*row[:6], *row[7:]]), HEAD.replace(",mag_z_nT", "")), 2, "no z axis"),
    "text": (with_field(lambda k, b: ["abc", *b[1:]] if k == 7 else b), 2, 'line 9, column "mag_x_nT": "abc" is not a number'),
    "units of names": (table(head=HEAD.replace("mag_x_nT", "mag_x_uT")), 2, "different units"),
    "units of rows": (
        with_field(lambda k, b: b if k < 200 else [f"{float(v) / 1e3:.6g}" for v in b]),
        2,
        "Two units in one file",
    ),
    "wrong unit": (table(head=HEAD.replace("nT", "uT")), 2, "They look like nT"),
    "local time": (with_time(str, "local_time"), 2, "is in local time"),
    "day first": (with_time(day_first), 2, "write the year first"),
    "milliseconds": (table([row.replace(",", "000,", 1) for row in ROWS]), 2, "looks like Unix time in ms"),
    "years after the elements": (
        with_time(lambda t: str(t + 3 * 365 * 86400), "unix_s"),
        2,
        "elements of another year, or a wrong clock",
    ),
    "no time": (table(cells(lambda k, row: row[1:]), HEAD.removeprefix("unix_s,")), 2, "no time column"),
    "repeated": (table([*ROWS[:9], *ROWS[8:]]), 2, "row 10 .*repeats.*--repair"),
    "unordered": (table([*ROWS[:9], ROWS[10], ROWS[9], *ROWS[11:]]), 2, "before that of the row before it.*--repair"),
    "cut off": (table([*ROWS[:-1], ROWS[-1][:20]]), 2, "Is the line cut off"),
    "one sample": (table(ROWS[:1]), 2, "at least two are needed"),
    "ten samples": (table(ROWS[:10]), 1, "10 usable samples; at least 30"),
    "constant": (with_field(lambda k, b: ["20000", "-10000", "30000"]), 2, "never change"),
    "all NaN": (with_field(lambda k, b: ["nan"] * 3), 2, "no sample with three finite numbers"),
    "noise": (with_field(noise), 1, "even the magnitude"),
}

ORBITS = {
    "wrong checksum": (ELEMENTS.replace("9994", "9995", 1), "checksum"),
    "changed digit": (ELEMENTS.replace("97.3614", "98.3614", 1), "checksum"),
    "empty": ("", "is empty"),
    "one line": (ELEMENTS.splitlines()[0], "line 2 is missing"),
    "swapped": ("\n".join(ELEMENTS.splitlines()[1::-1]), "swapped"),
    "binary": ("\x00\x01" * 500, "binary"),
    "a table": (table().decode(), "orbit"),
}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A new current folder with the outputs of a run before."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "sat.tle").write_text(ELEMENTS)
    (tmp_path / "in.csv").write_bytes(table())
    for name, text in OLD.items():
        (tmp_path / name).write_text(text)
    return tmp_path


def refused(folder, capsys, code, words):
    """Run; check the code, the paragraph, and that everything old still stands and nothing new."""
    before = sorted(path.name for path in folder.iterdir())
    assert main(["attitude", "in.csv", "--orbit", "sat.tle", "--out", "flight", "--quiet"]) == code
    out, err = capsys.readouterr()
    assert not out
    assert err.startswith("fieldline: ")
    assert err.count("\n") == 1
    assert "Traceback" not in err
    assert re.search(words, err), err
    assert sorted(path.name for path in folder.iterdir()) == before
    assert {name: (folder / name).read_text() for name in OLD} == OLD


@pytest.mark.parametrize("kind", FLIGHTS)
def test_bad_telemetry(folder, capsys, kind):
    content, code, words = FLIGHTS[kind]
    (folder / "in.csv").write_bytes(content)
    refused(folder, capsys, code, words)


@pytest.mark.parametrize("kind", ORBITS)
def test_bad_orbits(folder, capsys, kind):
    content, words = ORBITS[kind]
    (folder / "sat.tle").write_text(content)
    refused(folder, capsys, 2, words)


@pytest.mark.parametrize("name", ["in.csv", "sat.tle"])
def test_missing_files(folder, capsys, name):
    (folder / name).unlink()
    refused(folder, capsys, 2, f'"{name}" does not exist')


def test_a_calibration_that_explains_nothing_ends_with_1(folder, capsys):
    (folder / "in.csv").write_bytes(FLIGHTS["noise"][0])
    assert main(["calibrate", "in.csv", "--orbit", "sat.tle", "--out", "sensor", "--quiet"]) == 1
    assert "No usable calibration: the magnitude of in.csv misses the model's" in capsys.readouterr().err
    assert "Not usable" in (folder / "sensor.html").read_text()


def test_a_report_that_has_no_folder_is_refused_before_the_work(folder, capsys):
    (folder / "in.csv").unlink()
    assert main(["attitude", "in.csv", "--orbit", "sat.tle", "--report", "nowhere/r.html"]) == 2
    assert 'the folder "nowhere" does not exist' in capsys.readouterr().err
