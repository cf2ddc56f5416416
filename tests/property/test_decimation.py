"""Series made short for drawing keep what the eye would see."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fieldline.report.decimation import band, cloud, envelope, with_gaps

sizes = st.integers(1, 4000)
seeds = st.integers(0, 2**32 - 1)


@given(sizes, seeds, st.integers(5, 50))
def test_an_envelope_keeps_ends_and_extremes_in_order(n, seed, buckets):
    draw = np.random.default_rng(seed)
    x, y = np.arange(n, dtype=float), draw.normal(size=n)
    short_x, short_y = envelope(x, y, buckets)
    assert len(short_x) <= 2 * buckets + 4
    assert (np.diff(short_x) > 0).all()
    assert short_x[0] == x[0] and short_x[-1] == x[-1]
    assert short_y.min() == y.min() and short_y.max() == y.max()
    assert np.array_equal(y[short_x.astype(int)], short_y)


def test_a_single_spike_in_a_million_samples_survives():
    y = np.zeros(1_000_000)
    y[345_678] = 7.0
    x, short = envelope(np.arange(1_000_000.0), y)
    assert len(x) < 2000
    assert short.max() == 7.0


def test_an_envelope_passes_over_nan():
    y = np.sin(np.arange(10_000.0))
    y[::3] = np.nan
    assert np.nanmax(envelope(np.arange(10_000.0), y, 50)[1]) == np.nanmax(y)


@given(sizes, seeds)
def test_a_band_holds_every_sample(n, seed):
    draw = np.random.default_rng(seed)
    x, low = np.arange(n, dtype=float), draw.normal(size=n)
    _, shown_low, shown_high = band(x, low, low + 1.0, 20)
    assert shown_low.min() == low.min() and shown_high.max() == (low + 1.0).max()


@given(sizes, seeds)
def test_a_cloud_leaves_no_cell_empty(n, seed):
    draw = np.random.default_rng(seed)
    x, y = draw.random(n), draw.normal(size=n)
    keep = cloud(x, y, 30, 10)
    assert len(keep) <= max(300, 60)

    def cells(of):
        low, high = [min(v.min() for v in (x,)), y.min()], [x.max(), y.max()]
        span = [max(h - a, 1e-300) for a, h in zip(low, high, strict=True)]
        column = np.minimum(((x[of] - low[0]) / span[0] * 30).astype(int), 29)
        row = np.minimum(((y[of] - low[1]) / span[1] * 10).astype(int), 9)
        return set(zip(column.tolist(), row.tolist(), strict=True))

    assert len(cells(keep)) >= len(cells(np.arange(n))) - 2  # rounding at a cell's edge may move a point


def test_a_cloud_leaves_out_what_is_not_finite():
    assert list(cloud(np.arange(4.0), np.array([1.0, np.nan, np.inf, 2.0]))) == [0, 3]


@pytest.mark.parametrize("widest, breaks", [(1.5, 1), (20.0, 0)])
def test_a_line_breaks_over_a_gap(widest, breaks):
    x = np.array([0.0, 1.0, 2.0, 12.0, 13.0])
    time, values = with_gaps(x, x, widest)
    assert np.isnan(values).sum() == breaks
    assert len(time) == len(values) == 5 + breaks
