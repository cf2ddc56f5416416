"""Streams of `fieldline skiprope` that are stopped at awkward moments: while the clock is ahead, and set back meanwhile."""

import numpy as np

from fieldline.estimation.skiprope_telemetry import SkipropeSettings, SkipropeStream
from fieldline.estimation.skiprope_telemetry.face import rows_of
from fieldline.telemetry.stream import joined_rows
from skiprope_flights import LENGTH_M, flight, sample_orbit

OPTIONS = {"memory_s": 2000.0, "every_s": 400.0}


def stream():
    return SkipropeStream(SkipropeSettings(tether_length_m=LENGTH_M, method="kalman"), sample_orbit(), **OPTIONS)


def restarted(before):
    """A stream that goes on from another's state."""
    after = stream()
    after.resume(before.state(), "it")
    return after


def shifted(rows, seconds):
    return rows._replace(time_utc=rows.time_utc + np.timedelta64(seconds, "s"))


def lines(said):
    return [one.text for one in said if one.kind == "line"]


def words(said):
    return " ".join(one.text for one in said if one.kind == "word")


def test_a_restart_while_the_clock_is_ahead():
    """Five rows a day ahead, a restart, and the rest: dropped as without the restart, and the last rows as without the leap."""
    rows = rows_of(flight().telemetry)
    plain = stream()
    whole = lines(plain.take(rows))
    first = stream()
    first.take(joined_rows([rows.where(slice(0, 1000)), shifted(rows.where(slice(1000, 1005)), 86400)]))
    second = restarted(first)
    said = second.take(rows.where(slice(1000, None)))
    assert "ahead of the clock: dropped" in words(said) and lines(said)[-1] == whole[-1]


def test_a_clock_set_back_while_nobody_listened():
    """Other rows than are known of those times begin anew after a restart too; the same rows, sent again, do not."""
    rows = rows_of(flight().telemetry)
    first = stream()
    first.take(rows.where(slice(0, 1200)))
    again = restarted(first)
    assert lines(again.take(rows)) and again.recent.counts["restarts"] == 0
    back = restarted(first)
    said = back.take(shifted(rows.where(slice(1200, None)), -1000))
    assert "the clock went back" in words(said) and back.recent.counts["restarts"] == 1
    old = restarted(first)
    assert "passed over until newer ones come" in words(old.take(shifted(rows.where(slice(1200, None)), -80000)))


def test_rows_count_alike_however_a_stream_is_cut():
    """A clock that is set back, in pieces of any size: the same lines."""
    rows = rows_of(flight().telemetry)
    sent = joined_rows([rows.where(slice(0, 800)), shifted(rows.where(slice(800, None)), -3600)])
    said = []
    for size in (len(sent.time_utc), 37):
        one = stream()
        pieces = (sent.where(slice(k, k + size)) for k in range(0, len(sent.time_utc), size))
        said.append([line for piece in pieces for line in lines(one.take(piece))])
    assert said[0] == said[1] and len(said[0]) > 6
