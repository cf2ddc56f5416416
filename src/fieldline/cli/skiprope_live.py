"""The live mode of `fieldline skiprope`: lines as they come, rows of the table as they fall due, words on stderr."""

from __future__ import annotations

import json
import os
import select
import signal
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from fieldline.cli.inputs import Source, earth_orientation, three_names
from fieldline.cli.progress import progress_on_stderr
from fieldline.cli.skiprope import STREAM, Job, chosen, output_paths, settings_of, write_estimate
from fieldline.errors import InputError, NoEstimateError

BLOCK_BYTES = 1 << 16
POLL_S = 0.25
LONGEST_LINE = 1 << 20
NAME = "standard input"


class Live(NamedTuple):
    """The options of the live mode."""

    follow: bool
    state: Path | None
    every_s: float | None
    memory_s: float | None
    silence_s: float
    stop_after_s: float | None


class Tick(NamedTuple):
    """What came: lines, or none for so many seconds; words where the source itself was odd."""

    lines: list[str]
    silent_s: float
    words: str = ""


def watch(job: Job, live: Live) -> int:
    """Read until the stream ends, is interrupted or falls silent; 0 where there is an estimate then, else 1."""
    from fieldline.cli.attitude import read_calibration
    from fieldline.estimation.skiprope_telemetry import SkipropeStream
    from fieldline.telemetry.mapping import read_mapping
    from fieldline.telemetry.stream import RowReader

    paths = output_paths(job)
    read = read_calibration(job.calibration)
    if isinstance(read, str) and read != "none":
        raise InputError(
            f'--calibration {read} needs the whole record; a stream takes "none" or a FILE of `fieldline calibrate`.'
        )
    state = _checked_state(live.state, job)
    source = job.source
    mapping = read_mapping(source.mapping, None, None, three_names(source.mag_columns), source.time_column, source.unit)
    reader = RowReader(NAME if str(job.telemetry) == STREAM else str(job.telemetry), mapping)
    settings = settings_of(job, chosen(read, _now()))
    estimator = SkipropeStream(settings, _orbit(source), memory_s=live.memory_s, every_s=live.every_s)
    if state is not None:
        estimator.resume(state, f'the state "{live.state}"')
        _say(f"going on after {estimator.recent.counts['rows']:,} rows, the newest of {estimator.recent.newest_utc} UTC.", job)
    else:
        print(estimator.header, flush=True)
    try:
        with _stoppable():
            _listen(job, live, reader, estimator)
    except KeyboardInterrupt:
        _say("interrupted.", job)
    return _ended(job, live, reader, estimator, paths)


@contextmanager
def _stoppable() -> Iterator[None]:
    """SIGTERM, by which a service is stopped, taken as Ctrl-C."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def interrupt(number: int, frame: Any) -> None:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGTERM, interrupt)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def _listen(job: Job, live: Live, reader: Any, estimator: Any) -> None:
    """Lines in, rows and words out, until the stream ends."""
    ticks = lines_of_file(job.telemetry) if str(job.telemetry) != STREAM else lines_of_stream(sys.stdin.fileno())
    told_silent = told_bad = False
    first = True
    for tick in ticks:
        if tick.words:
            _say(tick.words, job)
        if tick.lines:
            told_silent = False
            rows = reader.feed(tick.lines)
            if first and len(rows.time_utc):
                first = False
                _check_orbit(
                    estimator.orbit, np.sort(rows.time_utc)[[len(rows.time_utc) // 2]], job
                )  # one wild stamp is no other day
            _give(estimator.take(rows), estimator, live, job)
        if reader.unreadable and not told_bad:
            told_bad = True
            _say(f'a line that is no row of the table is passed over and counted, as others will be: "{reader.first_bad}".', job)
        if tick.silent_s >= live.silence_s and not told_silent:
            told_silent = True
            _say(f"nothing has come for {tick.silent_s:.0f} s; still listening.", job)
        if live.stop_after_s is not None and tick.silent_s >= live.stop_after_s:
            _say(f"nothing has come for {tick.silent_s:.0f} s: ended.", job)
            return


def _give(said: list[Any], estimator: Any, live: Live, job: Job) -> None:
    """Rows to stdout, words to stderr, and the state to its file after each row."""
    for one in said:
        if one.kind == "line":
            print(one.text, flush=True)
        else:
            _say(one.text, job)
    if any(one.kind == "line" for one in said):
        _keep(estimator, live)


def _ended(job: Job, live: Live, reader: Any, estimator: Any, paths: dict[str, Path]) -> int:
    """The state kept, what was passed over told, the files of the last estimate written."""
    _keep(estimator, live)
    if estimator.recent.last_ns is None:
        reader.finish()
        raise NoEstimateError("the stream ended before its second row.")
    for line in _account(reader, estimator):
        _say(line, job)
    said = estimator.finish()
    for one in said:
        if one.kind == "line":
            print(one.text, flush=True)
        else:
            _say(one.text, job)
    solved = estimator.latest
    if solved is None:
        return 1
    if paths:
        from fieldline.estimation.skiprope_telemetry.face import dataset_of

        told = {"name": str(reader.name), "sha256": "", "lines": _account(reader, estimator)}
        estimate = dataset_of(solved, estimator.settings, told)
        with progress_on_stderr(job.quiet) as progress:
            written = write_estimate(estimate, paths, job, progress)
        if not job.quiet:
            print("wrote " + ", ".join(str(path) for path in written), file=sys.stderr)
    return 0 if solved.estimate.detected and solved.estimate.trusted[-1] else 1


def _account(reader: Any, estimator: Any) -> list[str]:
    """What came and what was passed over."""
    counts = dict(estimator.recent.counts)
    lines = [f"{counts.pop('rows'):,} rows, {estimator.lines:,} estimates"]
    words = {
        "repeated": "of a time that was known",
        "behind": "from before the newest",
        "without_field": "without a field",
    }
    lines += [f"{counts[name]:,} rows {what}, passed over" for name, what in words.items() if counts[name]]
    if counts["gaps"]:
        lines.append(f"{counts['gaps']:,} silences of over a minute")
    if counts["restarts"]:
        lines.append(f"begun anew {counts['restarts']:,} times")
    if reader.unreadable:
        lines.append(f"{reader.unreadable:,} lines that could not be read, passed over")
    return lines


def lines_of_stream(descriptor: int) -> Iterator[Tick]:
    """Whole lines of a pipe or terminal as they come; a tick without lines every POLL_S."""
    rest, since = b"", time.monotonic()
    while True:
        ready = select.select([descriptor], [], [], POLL_S)[0]
        if not ready:
            yield Tick([], time.monotonic() - since)
            continue
        block = os.read(descriptor, BLOCK_BYTES)
        if not block:
            if rest:
                yield Tick([_text(rest)], 0.0)
            return
        since = time.monotonic()
        lines, rest = _split(rest + block)
        yield Tick(lines, 0.0)


def lines_of_file(path: Path) -> Iterator[Tick]:
    """Whole lines of a file as it grows, for ever; one that is cut or replaced is read anew from its beginning."""
    if not path.is_file():
        raise InputError(f'telemetry file "{path}" does not exist or is no file, so it cannot be followed. Check the path.')
    offset, rest, since, before = 0, b"", time.monotonic(), path.stat().st_ino
    while True:
        words = ""
        try:
            status = path.stat()
            if status.st_size < offset or status.st_ino != before:
                words = f'"{path}" was cut or replaced: it is read from its beginning again.'
                offset, rest, before = 0, b"", status.st_ino
            with open(path, "rb") as file:
                file.seek(offset)
                block = file.read(BLOCK_BYTES)
        except OSError as error:
            words, block = f'"{path}" cannot be read at present: {error.strerror}.', b""
            time.sleep(POLL_S)
        if block:
            since = time.monotonic()
            offset += len(block)
            lines, rest = _split(rest + block)
            yield Tick(lines, 0.0, words)
            continue
        yield Tick([], time.monotonic() - since, words)
        time.sleep(POLL_S)


def _split(block: bytes) -> tuple[list[str], bytes]:
    """Whole lines, and what is left of the last one."""
    if b"\0" in block:
        raise InputError("the stream holds binary bytes; only text (CSV and its relatives) can be read as it comes.")
    *whole, rest = block.split(b"\n")
    if len(rest) > LONGEST_LINE:
        raise InputError("the stream brought a million bytes without the end of a line; is it text?")
    return [_text(line) for line in whole], rest


def _text(line: bytes) -> str:
    return line.decode("utf-8", errors="replace").lstrip("\ufeff")


def _orbit(source: Source) -> Any:
    """The orbit of the file that was given; None for the rows' own positions."""
    if source.orbit is None:
        return None
    from fieldline.orbit import read_orbit

    return read_orbit(source.orbit, norad_id=source.norad_id, eop=earth_orientation(source.eop))


def _check_orbit(orbit: Any, time_utc: Any, job: Job) -> None:
    """Refuse an orbit that must not be used for the first rows; tell its warnings."""
    if orbit is not None:
        for warning in orbit.check(time_utc, max_age_days=job.source.max_orbit_age_days):
            _say(f"warning: {warning}", job)


def _checked_state(path: Path | None, job: Job) -> Any:
    """The state of an earlier run, None where there is none yet."""
    if path is None:
        return None
    if path.resolve() in {p.resolve() for p in (job.telemetry, job.source.orbit, job.source.mapping) if p is not None}:
        raise InputError(f'--state "{path}" is an input; give it a file of its own.')
    if not path.parent.is_dir():
        raise InputError(f'--state "{path}": the folder "{path.parent}" does not exist. Make it first.')
    if path.is_dir():
        raise InputError(f'--state "{path}" is a folder; give a file in it, which need not exist yet.')
    if not path.exists():
        return None
    from fieldline.files import read_text

    try:
        return json.loads(read_text(path, "state"))
    except ValueError as error:
        raise InputError(f'the state "{path}" is damaged ({error}). Remove it to begin anew.') from error


def _keep(estimator: Any, live: Live) -> None:
    """The state, whole or as it was."""
    if live.state is not None:
        from fieldline.files import write_text_whole

        write_text_whole(live.state, json.dumps(estimator.state()))


def _say(words: str, job: Job) -> None:
    """A sentence on stderr."""
    if not job.quiet:
        print(words, file=sys.stderr, flush=True)


def _now() -> Any:
    """The present as the only time, by which a calibration of several is chosen."""
    return np.array([np.datetime64(time.time_ns(), "ns")])
