"""A stream of whatever: no line ends it, what is kept rises in time and stays bounded, and a state gives back every bit."""

import json

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from fieldline.errors import InputError
from fieldline.telemetry.mapping import read_mapping
from fieldline.telemetry.recent import Recent
from fieldline.telemetry.stream import RowReader, Rows

HEADER = "time_utc,mag_x_nT,mag_y_nT,mag_z_nT"
GOOD = [f"2026-01-01T00:00:{k:02d}Z,{20000 + k},{-k},{k}.5" for k in range(3)]
START_NS = 1_700_000_000 * 10**9
cells = st.one_of(
    st.sampled_from(["", "nan", "-9999", "1e400", "2026-01-01T00:00:09Z", "2026-13-01T00:00:00Z", "1.5", "0", "inf", "NaT"]),
    st.text(max_size=12),
)
any_line = st.one_of(st.lists(cells, max_size=6).map(",".join), st.text(max_size=60))


@given(st.lists(any_line, max_size=25))
def test_no_line_stops_the_reader(lines):
    reader = RowReader("stream", read_mapping(None))
    rows = reader.feed([HEADER, *GOOD, *lines])
    assert len(rows.time_utc) >= 3 and not np.isnat(rows.time_utc).any()
    assert (np.isfinite(rows.field_s).all(axis=1) | np.isnan(rows.field_s).all(axis=1)).all()
    assert np.allclose(rows.field_s[0], [2e-5, 0.0, 5e-10], rtol=1e-12)


@given(st.lists(any_line, max_size=25))
def test_a_beginning_of_whatever_is_a_table_or_refused_in_words(lines):
    reader = RowReader("stream", read_mapping(None))
    try:
        reader.feed(lines)
        reader.finish()
    except InputError as error:
        assert 10 < len(str(error)) < 3000


steps = st.one_of(
    st.integers(1, 3 * 10**9), st.integers(-(10**9), 10**9), st.sampled_from([0, -100 * 10**9, 100 * 10**9, -(10**13), 10**13])
)


@given(st.lists(steps, min_size=1, max_size=200), st.lists(st.integers(1, 50), min_size=1, max_size=20))
def test_what_is_kept_rises_and_is_bounded(steps, cuts):
    ns = START_NS + np.cumsum(np.array(steps, dtype=np.int64))
    ns = ns[(ns > 10**18) & (ns < 3 * 10**18)]
    rows = Rows(
        ns.astype("datetime64[ns]"), np.tile(3e-5 + 1e-9 * np.arange(len(ns))[:, None], (1, 3)), np.full(len(ns), np.nan),
        np.full((len(ns), 3), np.nan),
    )  # fmt: skip
    recent, first = Recent(300.0), 0
    for cut in [*cuts, len(ns)]:
        recent.take(rows.where(slice(first, first + cut)))
        first += cut
    kept = recent.stretch()
    times = kept.time_utc.astype(np.int64)
    assert (np.diff(times) > 0).all()
    if len(times):
        assert times[-1] - times[0] <= 300 * 10**9 and recent.last_ns - times[-1] < 10**9
    assert recent.counts["rows"] == len(ns)


@given(st.lists(st.integers(1, 3 * 10**9), min_size=1, max_size=120), st.integers(0, 120), st.booleans())
def test_a_state_goes_on_as_the_stream_would(steps, cut, fast):
    ns = START_NS + np.cumsum(np.array(steps, dtype=np.int64) // (20 if fast else 1))
    ns = np.unique(ns)
    draw = np.random.default_rng(len(ns))
    rows = Rows(
        ns.astype("datetime64[ns]"), 3e-5 * draw.standard_normal((len(ns), 3)), draw.standard_normal(len(ns)),
        np.full((len(ns), 3), np.nan),
    )  # fmt: skip
    rows.field_s[::7] = np.nan
    whole, parted = Recent(100.0), Recent(100.0)
    whole.take(rows)
    parted.take(rows.where(slice(0, cut)))
    parted = Recent.from_state(json.loads(json.dumps(parted.state())))
    parted.take(rows.where(slice(max(cut - 5, 0), None)))  # the last five are sent again
    for one, other in zip(whole.stretch(), parted.stretch(), strict=True):
        assert np.array_equal(one, other, equal_nan=one.dtype.kind == "f")
