"""The report as its reader meets it."""

import json
import re
import time

import numpy as np
import pytest

from fieldline.errors import InputError
from fieldline.report import report_html, write_figures, write_report
from fieldline.report.calibration_report import CalibratedFlight, calibration_html
from fieldline.report.markup import number

MOST_BYTES = 5_000_000


@pytest.fixture(scope="module")
def html(estimate):
    return report_html(estimate)


def test_the_page_needs_no_network(html):
    outside = re.findall(r'(?:src|href)="(?!#|data:)[^"]*"|url\((?!#|"#)[^)]*\)|@import|<script|<link', html)
    assert outside == []
    assert len(html.encode()) < MOST_BYTES


def test_the_verdict_comes_first(html):
    body = html[html.index("<main>") :]
    assert body.index("Attitude within 2 to 3 deg") < body.index("<table") < body.index("<figure")


def test_every_chapter_is_there(html):
    names = ("field", "motion", "residuals", "candidates", "calibration", "judgement", "input", "provenance")
    positions = [html.index(f'<section id="{name}">') for name in names]
    assert positions == sorted(positions)
    for expected in ("IGRF-14", "ab" * 32, "residuals nine times the best&#x27;s", "full+gain", "14 missing seconds"):
        assert expected in html


def test_every_figure_says_what_to_look_for_and_what_it_shows(html):
    figures = re.findall(r"<figure>.*?</figure>", html, flags=re.S)
    assert len(figures) == 12
    for one in figures:
        assert re.search(r'<svg role="img" aria-label="[^"]{20,}"', one)
        assert re.search(r"<figcaption>.{20,}</figcaption>", one, flags=re.S)


def test_words_from_a_file_cannot_become_markup(html):
    assert "no spikes &lt;script&gt;" in html


def test_identifiers_are_not_repeated_but_for_equal_definitions(html):
    assert not re.search(r' id="(figure|axes|patch|text|line2d)_\d+"', html)


def test_the_same_estimate_gives_the_same_page(estimate, html):
    assert report_html(estimate) == html


def test_colours_of_the_verdict(make_estimate):
    def state(**verdict):
        return re.search(r'class="verdict (\w+)"', report_html(make_estimate(samples=60, **verdict)))[1]

    assert state() == "doubtful"  # a judge failed
    assert state(extras=False) == "usable"
    assert state(usable=False) == "refused"


def test_what_gives_doubt_is_said_at_the_head(make_estimate):
    html = report_html(make_estimate(samples=60))
    head = html[html.index('class="verdict') : html.index("<table")]
    assert "Doubt: sun-sensor hits on -x, -z: 91.2 % (5,012 of 5,494 samples agree)" in head
    assert "Doubt" not in report_html(make_estimate(samples=60, extras=False))


def test_refined_constants_stand_beside_those_by_magnitude(plain_estimate):
    estimate = plain_estimate.copy()
    verdict = json.loads(estimate.attrs["verdict_json"])
    verdict["calibration"]["refined"] = [
        {"name": "bias_x_tesla", "value": 1.00423e-4, "std": 1.3e-7, "by_magnitude": 9.9803e-5},
        {"name": "drift_x_tesla_s", "value": 2.5e-9, "std": 2e-10, "by_magnitude": 2.1e-9},
        {"name": "gain_0", "value": 0.01, "std": 0.001, "by_magnitude": 0.012},
    ]
    verdict["motion"] = {"model": "rigid body", "words": "inertia found", "inertia_ratio": np.diag([0.5, 1.0, 1.5]).tolist()}
    verdict["noise"] = {"white_nt": 392.0, "slow_nt": None}
    estimate.attrs["verdict_json"] = json.dumps(verdict)
    html = report_html(estimate)
    assert "<td>bias x [µT]</td><td>99.80</td><td>100.42</td><td>0.13</td>" in html
    assert "<td>drift x [nT/s]</td><td>2.10</td><td>2.50</td><td>0.2</td>" in html
    assert "gain 0" not in html
    assert "Rigid body: inertia found." in html
    assert "392 nT" in html


def test_without_judges_there_is_no_judgement(plain_estimate):
    html = report_html(plain_estimate)
    assert 'id="judgement"' not in html
    assert "gyro" not in html


@pytest.mark.parametrize("samples", [2, 3, 12])
def test_a_handful_of_samples_can_be_drawn(make_estimate, samples):
    assert "</html>" in report_html(make_estimate(samples=samples))


def test_missing_values_can_be_drawn(make_estimate):
    estimate = make_estimate(samples=300)
    for name in ("residual_b", "field_b", "nis", "omega_std_b", "gyro_b"):
        estimate[name].values[100:180] = np.nan
    assert "</html>" in report_html(estimate)


def test_figures_are_written_as_png_and_svg(plain_estimate, tmp_path):
    written = write_figures(plain_estimate, tmp_path / "flight_figures")
    names = {path.name for path in written}
    assert {"field.png", "field.svg", "track.png", "whiteness.svg"} <= names
    assert (tmp_path / "flight_figures" / "field.png").read_bytes().startswith(b"\x89PNG")
    assert (tmp_path / "flight_figures" / "field.svg").read_text().startswith("<?xml")


def test_a_report_without_a_folder_is_refused(plain_estimate, tmp_path):
    with pytest.raises(InputError, match="does not exist"):
        write_report(plain_estimate, tmp_path / "nowhere" / "flight.html")


def test_matplotlib_is_left_as_it_was(plain_estimate):
    import matplotlib

    before = dict(matplotlib.rcParams)
    report_html(plain_estimate)
    assert dict(matplotlib.rcParams) == before


@pytest.mark.slow
def test_a_million_samples_make_a_small_page(make_estimate):
    estimate = make_estimate(samples=1_000_000)
    start = time.perf_counter()
    html = report_html(estimate)
    assert len(html.encode()) < MOST_BYTES
    assert time.perf_counter() - start < 30.0  # about 7 s; linear in the samples


def test_the_report_on_a_calibration_shows_every_flight(estimate):
    import json

    summary = json.loads(estimate.attrs["verdict_json"])["calibration"]
    fields = {"field_s": estimate["field_raw_s"].values, "field_b": estimate["field_b"].values}
    flights = [
        CalibratedFlight(
            name=name,
            time_utc=estimate["time"].values,
            magnitude_tesla=np.linalg.norm(estimate["field_i"].values, axis=1),
            used=np.ones(estimate.sizes["time"], dtype=bool),
            summary=summary,
            lines=["5,586 samples"],
            **fields,
        )
        for name in ("a.csv", "b.csv")
    ]
    html = calibration_html(flights, {"model": "IGRF-14"}, {})
    assert html.count("<figure>") == 4
    assert "bias (99.80, -30.10, -28.60) ± 0.12 µT, leaves 612, 612 nT RMS" in html
    assert "a.csv" in html and "b.csv" in html


@pytest.mark.parametrize(
    "value, digits, shown",
    [
        (779.947, 3, "780"),
        (2023.65, 6, "2023.65"),
        (1043.2, 3, "1043"),
        (76366.27, 3, "76,366"),
        (-0.02, 3, "−0.02"),
        (100.0, 3, "100"),
        (1.5e-7, 3, "1.5e−07"),
        (0.0, 3, "0"),
        (float("nan"), 3, "–"),
        (float("inf"), 3, "inf"),
    ],
)
def test_numbers_as_they_are_read(value, digits, shown):
    assert number(value, digits) == shown
