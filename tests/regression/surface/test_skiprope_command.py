"""`fieldline skiprope`: files, exit codes, words, and the live mode, which says what a whole file says."""

import io
import json
import os
import signal
import subprocess
import sys
import threading
import time
from html.parser import HTMLParser

import numpy as np
import pandas as pd
import pytest

import fieldline as fl
from fieldline.cli import main
from fieldline.estimation.skiprope_telemetry import SkipropeSettings, SkipropeStream
from fieldline.estimation.skiprope_telemetry.face import rows_of
from fieldline.telemetry import telemetry_of
from fieldline.telemetry.skiprope_csv import skiprope_columns, skiprope_line
from skiprope_flights import ELEMENTS, LENGTH_M, METHODS, SAMPLE, START, flight, lines_of, sample_orbit, write

ASKED = ["--orbit", ELEMENTS, "--tether-length-m", "20000"]
VOID = {"meta", "link", "br", "img", "hr", "input"}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture(scope="module")
def lines():
    """A flight of an hour, a reading every 2 s."""
    return lines_of(flight().telemetry)


class Page(HTMLParser):
    """Checks that tags nest, and gathers what would be fetched and which anchors there are."""

    def __init__(self):
        super().__init__()
        self.open, self.fetched, self.ids, self.links = [], [], set(), set()

    def handle_starttag(self, tag, attrs):
        given = dict(attrs)
        self.ids.add(given.get("id"))
        for name in ("src", "href", "xlink:href"):
            value = given.get(name) or ""
            if tag == "a" and value.startswith("#"):
                self.links.add(value[1:])
            elif value and not value.startswith(("#", "data:")):
                self.fetched.append(value)
        if tag == "script":
            self.fetched.append("script")
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open and self.open.pop() == tag, tag

    def handle_startendtag(self, tag, attrs):
        self.handle_starttag(tag, attrs)
        if tag not in VOID:
            self.open.pop()


@pytest.mark.kernels
@pytest.mark.parametrize("method", METHODS)
def test_the_sample_by_all_methods(folder, capsys, method):
    """0.75 by 0.5 deg at 4.8 mHz, from the orbit's normal towards the front: docs/gallery/skiprope_sample.py."""
    assert main(["skiprope", SAMPLE, *ASKED, "--method", method, "--out", "a"]) == 0
    out, err = capsys.readouterr()
    assert out.startswith("Skiprope: ") and "towards the front" in out and "wrote a.nc, a.csv, a.html" in out
    assert "2,720 samples" in err and "60 missing seconds" in err
    table = pd.read_csv("a.csv")
    last = table.iloc[-1]
    assert list(table.columns[:6]) == ["time_utc", "amplitude_deg", "frequency_hz", "sense", "phase_deg", "deflection_m"]
    assert last.sense == -1 and last.frequency_hz == pytest.approx(0.0048, rel=0.01)
    assert last.amplitude_deg == pytest.approx(0.625, rel=0.25 if method == "bandpass" else 0.03)
    assert last.deflection_m == pytest.approx(LENGTH_M / np.pi * np.radians(last.amplitude_deg), rel=1e-4)
    waits = [(pd.Timestamp(last[f"crossing_{k}_utc"]) - pd.Timestamp(last.time_utc)).total_seconds() for k in (1, 2, 3)]
    assert 0.0 <= waits[0] < waits[1] < waits[2] < 400.0
    page = Page()
    page.feed((folder / "a.html").read_text())
    assert page.open == [] and page.fetched == [] and page.links <= page.ids
    assert {"crossings", "place", "signals", "settling", "spectrum", "limits"} <= page.links


def test_the_netcdf_gives_the_report_again(folder):
    import xarray

    assert main(["skiprope", SAMPLE, *ASKED, "--out", "a", "--figures", "--quiet"]) == 0
    with xarray.open_dataset("a.nc") as dataset:
        dataset.load()
    fl.write_report(dataset, "again.html")
    assert (folder / "again.html").read_text() == (folder / "a.html").read_text()
    assert json.loads(dataset.attrs["provenance_json"])["settings"]["tether_length_m"] == LENGTH_M
    for name, variable in dataset.data_vars.items():
        assert variable.attrs.get("long_name"), name
        assert variable.dtype.kind in "MUb" or "units" in variable.attrs, name
    drawn = sorted(path.name for path in (folder / "a_figures").iterdir())
    assert drawn == sorted(f"{name}.{kind}" for name in ("place", "settling", "signals", "spectrum") for kind in ("png", "svg"))


def test_json_and_python_say_the_same(folder, capsys):
    assert main(["skiprope", SAMPLE, *ASKED, "--plane", "orbit", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    found = fl.estimate_skiprope(fl.read_telemetry(SAMPLE), fl.read_orbit(ELEMENTS), tether_length_m=LENGTH_M, plane="orbit")
    assert told == json.loads(found.attrs["verdict_json"])
    assert (folder / "skiprope_skiprope.nc").exists()


def test_no_skiprope_ends_with_one_and_a_report_that_says_so(folder, capsys):
    still = flight(skiprope_frequency_hz=0.0)
    write(folder / "still.csv", lines_of(still.telemetry))
    assert main(["skiprope", "still.csv", *ASKED, "--out", "s"]) == 1
    assert capsys.readouterr().out.startswith("No skiprope: ")
    assert len((folder / "s.csv").read_text().splitlines()) == 1
    html = (folder / "s.html").read_text()
    assert "no skiprope found" in html and "a round cone of" in html


@pytest.mark.parametrize(
    "options, words",
    [
        (["--tether-length-m", "-5"], "tether_length_m must be a number from 1"),
        (["--method", "kallman"], 'did you mean "kalman"?'),
        (["--frequency-hz", "0"], "frequency_hz must be a number"),
        (["--plane", "sideways"], "is neither field, orbit, normal nor an azimuth"),
        (["--sensor-axes", "x,y,-z"], "left-handed"),
        (["--attitude-deg", "1,2"], "roll,pitch,yaw"),
        (["--tether", "left"], '"down" or "up"'),
        (["--calibration", "nothing"], "is neither a file nor one of"),
        (["--model", "IGRF-1"], "IGRF-1"),
        (["--state", "x.json"], "is of the live mode"),
        (["--out", "no/such"], 'the folder "no" does not exist'),
        (["--out", "b", "--report", "b.csv"], "two outputs of the command would be the same file"),
        (["--orbit", SAMPLE], "holds no orbit"),
        (["--mag-columns", "a,b"], "three columns"),
    ],
)
def test_options_that_cannot_be(folder, capsys, options, words):
    assert main(["skiprope", SAMPLE, *ASKED, *options]) == 2
    err = capsys.readouterr().err
    assert words in err and "Traceback" not in err and len(err) < 2000
    assert list(folder.iterdir()) == []


def test_a_length_is_asked_for(folder, capsys):
    assert main(["skiprope", SAMPLE, "--orbit", ELEMENTS]) == 2
    assert "tether-length-m" in capsys.readouterr().err


def broken(lines, how, draw):
    """Telemetry as it should not be."""
    lines = list(lines)
    at = int(draw.integers(1, len(lines)))
    match how:
        case "cut":
            lines[at] = lines[at][:9]
        case "words":
            lines[at] = lines[at].replace(",", ",lost,", 1)
        case "shuffled":
            lines[1:] = [lines[1 + k] for k in draw.permutation(len(lines) - 1)]
        case "repeated":
            lines.insert(at, lines[at])
        case "short":
            lines = lines[:40]
        case "two rows":
            lines = lines[:3]
        case "header":
            lines = lines[:1]
        case "frozen":
            lines[1:] = [line.split(",", 1)[0] + "," + lines[1].split(",", 1)[1] for line in lines[1:]]
        case "zeros":
            lines[1:] = [line.split(",", 1)[0] + ",0,0,0" for line in lines[1:]]
        case "noise":
            lines[1:] = [
                line.split(",", 1)[0] + "".join(f",{b:.0f}" for b in 2e4 * draw.standard_normal(3)) for line in lines[1:]
            ]
        case "microtesla":
            lines[0] = lines[0].replace("nT", "uT")
        case "gap":
            lines[200:900] = []
        case "holes":
            lines[1:] = [line if draw.random() < 0.5 else line.split(",", 1)[0] + ",,," for line in lines[1:]]
        case "years later":
            lines[1:] = [line.replace("1992-", "2021-") for line in lines[1:]]
    return lines


HOWS = (
    "cut", "words", "shuffled", "repeated", "short", "two rows", "header", "frozen", "zeros", "noise", "microtesla", "gap",
    "holes", "years later",
)  # fmt: skip


@pytest.mark.parametrize("how", HOWS)
def test_broken_telemetry_ends_in_words(folder, capsys, lines, how):
    write(folder / "b.csv", broken(lines[:1500], how, np.random.default_rng(5)))
    code = main(["skiprope", "b.csv", *ASKED, "--out", "o"])
    out, err = capsys.readouterr()
    assert code == (0 if how in ("gap", "holes") else 1 if how in ("short", "two rows", "noise") else 2)
    assert "Traceback" not in err and "a fault in Fieldline" not in err
    written = sorted(path.name for path in folder.iterdir())
    assert written == (["b.csv", "o.csv", "o.html", "o.nc"] if out else ["b.csv"])
    assert bool(out) == (how in ("gap", "holes"))  # files only where there is something to see


def live(capsys, monkeypatch, lines, *options, ends=True, tether=ASKED):
    """The live mode on a pipe that carries these lines: exit code, rows, words."""
    read, wrote = os.pipe()
    text = "\n".join(lines) + ("\n" if ends else "")

    def pour():
        with os.fdopen(wrote, "w") as sink:
            sink.write(text)

    thread = threading.Thread(target=pour)
    thread.start()
    with os.fdopen(read) as source:
        monkeypatch.setattr(sys, "stdin", source)
        code = main(["skiprope", "-", *tether, *options])
        source.buffer.read()
    thread.join()
    out, err = capsys.readouterr()
    assert "Traceback" not in err and "a fault in Fieldline" not in err
    return code, out.splitlines(), err


@pytest.mark.parametrize("method", METHODS)
def test_live_says_what_a_file_says(method):
    """Every line is the last row of an estimate of the rows before it, within the memory, however the stream was cut."""
    record = flight(6000, 0.5)
    rows = rows_of(record.telemetry)
    said = []
    for size in (701, 64):
        stream = SkipropeStream(
            SkipropeSettings(tether_length_m=LENGTH_M, method=method), sample_orbit(), memory_s=2000.0, every_s=500.0
        )
        said.append([])
        for first in range(0, 6000, size):
            said[-1] += [one.text for one in stream.take(rows.where(slice(first, first + size))) if one.kind == "line"]
    assert said[0] == said[1] and len(said[0]) >= 5
    until = int(START.astype(np.int64)) // (500 * 10**9) * 500 * 10**9 + np.arange(1, 7) * 500 * 10**9
    ns = rows.time_utc.astype(np.int64)
    for line, stop in list(zip(said[0], until, strict=False))[3:]:
        kept = (ns >= stop - 2000 * 10**9) & (ns < stop)
        part = telemetry_of(rows.time_utc[kept], rows.field_s[kept])
        whole = fl.estimate_skiprope(part, sample_orbit(), tether_length_m=LENGTH_M, method=method)
        assert line == skiprope_line(skiprope_columns({str(k): v.values for k, v in whole.variables.items()}))


def test_a_pipe_gives_rows_and_files(folder, capsys, monkeypatch, lines):
    code, rows, err = live(capsys, monkeypatch, lines, "--out", "l", "--every-s", "300", ends=False)
    assert code == 0 and rows[0].startswith("time_utc,amplitude_deg,frequency_hz,sense,phase_deg,deflection_m")
    assert rows[1].split(",")[1:] == [*["", "", "0"], *[""] * 12, "0", *[""] * 9]  # no estimate yet: no crossings, no sides
    assert 10 <= len(rows) <= 14 and all(row.count(",") == rows[0].count(",") for row in rows)
    assert "1,700 rows" in err and "wrote l.nc, l.csv, l.html" in err
    table = pd.read_csv(folder / "l.csv")
    assert table.amplitude_deg.iloc[-1] == pytest.approx(float(rows[-1].split(",")[1]))


def test_a_restart_goes_on_as_if_nothing_had_been(folder, capsys, monkeypatch, lines):
    options = ("--every-s", "400")
    _, whole, _ = live(capsys, monkeypatch, lines, *options)
    _, first, _ = live(capsys, monkeypatch, lines[:900], *options, "--state", "s.json")
    kept = (folder / "s.json").read_text()
    _, resent, err = live(capsys, monkeypatch, lines, *options, "--state", "s.json")
    assert first[:-1] + resent == whole and "going on after 899 rows" in err
    (folder / "s.json").write_text(kept)
    _, fresh, _ = live(capsys, monkeypatch, [lines[0], *lines[900:]], *options, "--state", "s.json")
    assert fresh == resent


@pytest.mark.parametrize(
    "text, words",
    [
        ("", "is empty"),
        ("{", "is damaged"),
        ("[]", "is no state of a skiprope stream"),
        ('{"format": "something else"}', "is no state of a skiprope stream"),
    ],
)
def test_a_state_that_is_none_is_refused(folder, capsys, monkeypatch, lines, text, words):
    (folder / "s.json").write_text(text)
    code, rows, err = live(capsys, monkeypatch, lines[:50], "--state", "s.json")
    assert code == 2 and rows == [] and words in err and (folder / "s.json").read_text() == text


def test_a_state_of_other_settings_or_damaged_is_refused(folder, capsys, monkeypatch, lines):
    live(capsys, monkeypatch, lines[:300], "--state", "s.json")
    code, _, err = live(capsys, monkeypatch, lines[:300], "--state", "s.json", "--method", "kalman")
    assert code == 2 and "was made with method = harmonic, and kalman is asked for now" in err
    state = json.loads((folder / "s.json").read_text())
    for damage in ({"recent": None}, {"due_ns": "soon"}, {"recent": {**state["recent"], "done": {"time_ns": [1]}}}):
        (folder / "s.json").write_text(json.dumps(state | damage))
        code, _, err = live(capsys, monkeypatch, lines[:300], "--state", "s.json")
        assert code == 2 and "is damaged" in err


def test_rows_sent_again_late_or_spoilt_do_not_matter(folder, capsys, monkeypatch, lines):
    options = ("--every-s", "400")
    _, whole, _ = live(capsys, monkeypatch, lines, *options)
    odd = [*lines[:600], *lines[400:600], lines[500], "# a remark", "", *lines[600:601], lines[600], "half a li", *lines[601:]]
    code, rows, err = live(capsys, monkeypatch, odd, *options)
    assert code == 0 and rows == whole
    assert "were sent again; passed over" in err and "1 lines that could not be read" in err
    assert 'a line that is no row of the table is passed over and counted, as others will be: "half a li"' in err


@pytest.mark.parametrize("ahead_s", [3600, 10_000_000])
def test_a_leap_ahead_that_is_taken_back_costs_the_rows_that_leapt(folder, capsys, monkeypatch, lines, ahead_s):
    """Three rows of a wrong clock among the others: they are dropped, and the estimates are as without them."""
    options = ("--every-s", "400", "--method", "kalman")
    _, whole, _ = live(capsys, monkeypatch, lines, *options)
    leapt = [f"{np.datetime64(lines[900].split('Z')[0]) + np.timedelta64(ahead_s + k, 's')}Z,1e4,2e4,3e4" for k in range(3)]
    code, rows, err = live(capsys, monkeypatch, [*lines[:900], *leapt, *lines[900:]], *options)
    assert "were ahead of the clock: dropped" in err and code == 0
    assert rows[-3:] == whole[-3:] and set(whole) <= set(rows)


def test_a_clock_that_goes_back_begins_anew(folder, capsys, monkeypatch, lines):
    """The second half's stamps are those of an hour before, with a field that was not there then."""
    back = [
        lines[0],
        *lines[1:800],
        *(f"{one}Z,{rest.split(',', 1)[1]}" for one, rest in zip(_stamps(-3600.0, 900), lines[800:], strict=False)),
    ]
    code, rows, err = live(capsys, monkeypatch, back, "--every-s", "400")
    assert "the clock went back from 1992-08-04T12:26:36Z to 1992-08-04T11:26:38Z" in err and "begins anew" in err
    assert "begun anew 1 times" in err and len(rows) > 5 and code in (0, 1)


def _stamps(offset_s, count):
    start = START + np.timedelta64(int((1598 + offset_s) * 1e9), "ns")
    return np.datetime_as_string(start + (2e9 * np.arange(count)).astype("timedelta64[ns]"), unit="ms")


def test_silences_are_told(folder, capsys, monkeypatch, lines):
    code, _, err = live(capsys, monkeypatch, [*lines[:600], *lines[700:]], "--every-s", "400")
    assert code == 0 and "no row for 202 s before" in err
    short = [lines[0], *lines[1:200], *(line.replace("1992-08-04", "1992-08-05") for line in lines[200:400])]
    code, _, err = live(capsys, monkeypatch, short, "--every-s", "400")
    assert code == 1 and "longer than the memory: the estimate begins anew" in err


@pytest.mark.parametrize(
    "sent, code, words",
    [
        ([], 2, "is empty"),
        (["# nothing", ""], 2, "no table"),
        (["time_utc,mag_x_nT,mag_y_nT,mag_z_nT"], 2, "header and no samples"),
        (["time_utc,bx,by,bz", "1992-08-04T12:00:00Z,1,2,3", "1992-08-04T12:00:02Z,1,2,3"], 2, "do not say their unit"),
        (["a,b,c", "1,2,3", "2,3,4"], 2, "no time column"),
        (["<html>", "<body>", "</body>"], 2, "is a web page"),
        (["\0\0\0", "\0"], 2, "binary"),
        (
            ["time_utc,mag_x_nT,mag_y_nT,mag_z_nT", "x,y,z,w", "x,y,z,w", "y"],
            1,
            "the stream ended before its second row",
        ),
    ],
)
def test_streams_that_are_none(folder, capsys, monkeypatch, sent, code, words):
    ended, rows, err = live(capsys, monkeypatch, sent)
    assert ended == code and words in err
    assert len(rows) <= 1


@pytest.mark.parametrize(
    "options, words",
    [
        (["--json"], "--json is not of the live mode"),
        (["--figures"], "need --out"),
        (["--calibration", "bias"], "needs the whole record"),
        (["--every-s", "0.2"], "the step must be 1 s or more"),
        (["--memory-s", "50"], "no shorter than the step"),
        (["--memory-s", "0"], "a memory of 0 s"),
        (["--every-s", "0"], "an estimate every 0 s"),
        (["--state", "no/such.json"], 'the folder "no" does not exist'),
        (["--state", ELEMENTS], "is an input"),
        (["--state", "."], "is a folder"),
        (["--silence-s", "soon"], 'got "soon"'),
        (["--silence-s=0"], 'got "0"'),
    ],
)
def test_live_options_that_cannot_be(folder, capsys, monkeypatch, lines, options, words):
    code, _, err = live(capsys, monkeypatch, lines[:10], *options)
    assert code == 2 and words in err


def test_a_file_that_grows_is_followed(folder, capsys, lines):
    """It grows in pieces that end within lines, falls silent, is replaced by a shorter one, and grows again."""
    path = folder / "grow.csv"
    path.write_text("\n".join(lines[:500]) + "\n" + lines[500][:20])

    def grow():
        time.sleep(0.6)
        with open(path, "a") as file:
            file.write(lines[500][20:] + "\n" + "\n".join(lines[501:1000]) + "\n")
        time.sleep(1.2)
        path.write_text("\n".join([lines[0], *lines[1000:1300]]) + "\n")

    thread = threading.Thread(target=grow)
    thread.start()
    code = main(["skiprope", "grow.csv", *ASKED, "--follow", "--silence-s", "0.5", "--stop-after-s", "2.0", "--every-s", "400"])
    thread.join()
    out, err = capsys.readouterr()
    assert code == 0 and "1,299 rows" in err and "could not be read" not in err
    assert "still listening" in err and "was cut or replaced" in err and "ended." in err
    assert len(out.splitlines()) >= 7


def test_following_what_is_not_there(folder, capsys):
    assert main(["skiprope", "none.csv", *ASKED, "--follow"]) == 2
    assert "cannot be followed" in capsys.readouterr().err


@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupt_keeps_the_state(folder, lines, sent):
    path = write(folder / "f.csv", lines[:700])
    command = [sys.executable, "-c", "import sys; from fieldline.cli import main; sys.exit(main())", "skiprope", str(path)]
    command += [*ASKED, "--follow", "--state", "s.json", "--every-s", "400"]
    running = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    deadline = time.monotonic() + 60.0
    while not (folder / "s.json").exists() and time.monotonic() < deadline:
        time.sleep(0.1)
    time.sleep(1.0)
    running.send_signal(sent)
    out, err = running.communicate(timeout=60)
    assert running.returncode in (0, 1) and "interrupted." in err and "Traceback" not in err
    assert json.loads((folder / "s.json").read_text())["recent"]["counts"]["rows"] == 699
    assert len(out.splitlines()) >= 3


@pytest.mark.kernels
def test_a_length_that_changes_and_a_swing(folder, capsys):
    """A reel's table: the deflection is that of the length at each row's time; the swing is taken off."""
    lengths = "time_utc,length_m\n" + "".join(f"{START + np.timedelta64(k, 's')}Z,{20000 - k}\n" for k in (0, 3600))
    write(folder / "flight.csv", lines_of(flight().telemetry))
    (folder / "reel.csv").write_text(lengths)
    asked = ["skiprope", "flight.csv", "--orbit", ELEMENTS, "--tether-lengths", "reel.csv", "--swing-hz", "found", "--out", "a"]
    assert main(asked) == 0
    out, _ = capsys.readouterr()
    assert "followed while 20 km of tether became" in out and "taken off the deflection" in out
    table = pd.read_csv("a.csv")
    at = (pd.to_datetime(table.time_utc).dt.tz_localize(None).to_numpy() - START) / np.timedelta64(1, "s")
    plain = np.radians(table.amplitude_deg) * (20000.0 - at) / np.pi
    assert (table.deflection_m / plain).to_numpy() == pytest.approx(1.0 - (0.0049 / 0.03125) ** 2, abs=0.004)


@pytest.mark.kernels
def test_a_length_that_changes_live(folder, capsys, monkeypatch, lines):
    """The last row of the pipe is the file's; each row's deflection is of the length then; a state of another reel is refused."""
    reel = "time_utc,length_m\n" + "".join(f"{START + np.timedelta64(k, 's')}Z,{20000 - k}\n" for k in (0, 2400))
    (folder / "reel.csv").write_text(reel)
    write(folder / "flight.csv", lines)
    asked = ["--orbit", ELEMENTS, "--tether-lengths", "reel.csv"]
    assert main(["skiprope", "flight.csv", *asked, "--out", "a"]) == 0
    assert "the table of its lengths ends 998 s before the last row" in capsys.readouterr().out
    kept = ("--every-s", "400", "--state", "s.json")
    code, rows, err = live(capsys, monkeypatch, lines, *kept, tether=asked)
    assert err.count("the table of its lengths ends") == 1
    assert code == 0 and rows[-1] == (folder / "a.csv").read_text().splitlines()[-1]
    table = pd.read_csv(io.StringIO("\n".join(rows))).dropna(subset="amplitude_deg")
    at = (pd.to_datetime(table.time_utc).dt.tz_localize(None).to_numpy() - START) / np.timedelta64(1, "s")
    assert len(table) >= 5 and at.min() < 2400.0 < at.max()
    expected = np.radians(table.amplitude_deg) * (20000.0 - np.minimum(at, 2400.0)) / np.pi
    assert table.deflection_m.to_numpy() == pytest.approx(expected.to_numpy(), rel=1e-3)
    (folder / "reel.csv").write_text(reel.replace("20000", "20500"))
    code, _, err = live(capsys, monkeypatch, lines, *kept, tether=asked)
    assert code == 2 and "was made with lengths" in err


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ([], "--tether-lengths"),
        (["--tether-length-m", "20000", "--swing-hz", "quick"], "--swing-hz"),
        (["--tether-length-m", "20000", "--end-mass-kg", "500"], "give both"),
        (["--tether-lengths", "none.csv"], "no such file"),
        (["--tether-lengths", "other.csv"], "have no time in common"),
        (["--tether-length-m", "20000", "--method", "kalman", "--steady-s", "900"], "steady_s"),
    ],
)
def test_what_is_not_known_of_the_tether(folder, capsys, more, words):
    (folder / "other.csv").write_text("time_utc,length_m\n2020-01-01T00:00:00Z,20000\n2020-01-02T00:00:00Z,10000\n")
    assert main(["skiprope", SAMPLE, "--orbit", ELEMENTS, *more]) == 2
    assert words in capsys.readouterr().err
