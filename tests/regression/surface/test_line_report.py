"""The chapter on lines: numbers of a line whose motion is known, its figures, its motion as a drawing with data inside."""

import base64
import json
import re
from html.parser import HTMLParser

import numpy as np
import pytest

from fieldline.cli.simulate import summary
from fieldline.report.line_animation import MOST_FRAMES, packed
from fieldline.report.line_record import LineRecord
from fieldline.report.run_line_figures import line_pictures
from fieldline.report.run_numbers import run_numbers
from fieldline.report.run_record import RunRecord
from fieldline.report.run_relative_figures import line_pulls
from fieldline.report.simulation_report import simulation_html
from fieldline.report.theme import themed
from line_dataset import ACROSS_RAD, BOW_M, IN_PLANE_RAD, LENGTH_M, SKIPROPE_M, TILT_RAD, line_dataset

VOID = {"meta", "input", "br", "path", "use", "image", "rect"}


@pytest.fixture(scope="module")
def run():
    return line_dataset()


@pytest.fixture(scope="module")
def html(run):
    return simulation_html(run)


def motion(html):
    """The data of the drawing."""
    return json.loads(re.search(r'<script type="application/json" id="motion-data">(.*?)</script>', html, re.S)[1])


def unpacked(array, *shape):
    return array["scale"] * np.frombuffer(base64.b64decode(array["data"]), "<i2").reshape(-1, *shape)


def test_numbers_of_a_known_line(run):
    told = run_numbers(run)["lines"]["tether"]
    assert told["libration_in_plane_deg"] == pytest.approx(np.degrees(IN_PLANE_RAD), rel=1e-3)
    assert told["libration_across_deg"] == pytest.approx(np.degrees(ACROSS_RAD), rel=1e-3)
    assert told["deflection_largest_m"] == pytest.approx((BOW_M + SKIPROPE_M) * np.sin(np.pi * 5 / 11), rel=1e-3)
    assert told["skiprope"]["sense"] == "right-handed"
    assert told["skiprope"]["semi_major_m"] == pytest.approx(SKIPROPE_M, rel=0.03)
    assert (told["tension_lowest_n"], told["slack_spells"]) == (0.0, 1)
    assert told["slack_s"] == pytest.approx(40.0, rel=0.01)
    assert (told["length_start_m"], told["length_end_m"]) == (LENGTH_M, LENGTH_M)
    assert told["temperature_lowest_c"] == pytest.approx(290.0 - 273.15 - 30.0, abs=0.1)
    assert told["power_largest_w"] == pytest.approx(1100.0, rel=1e-3)
    assert told["lowest_altitude_km"] == pytest.approx(300.0 - 20.0 / 3.0, abs=0.5)
    json.dumps(told)


def test_the_lever_leans_from_the_line_where_it_was_tilted(run):
    line = LineRecord(RunRecord(run), "tether")
    leaning, along = line.lever_angle_deg(1), line.lever_angle_deg(0)
    bent = np.degrees(np.pi * (BOW_M + SKIPROPE_M) / LENGTH_M)  # of the line's end against its chord, at most
    assert np.all(np.abs(leaning - np.degrees(TILT_RAD)) < bent + 0.02) and np.all(along < bent + 0.02)


def test_slack_is_said_first_and_only_where_it_is(run, html):
    assert "tether is slack: 39.9 s in 1 spell" in html[: html.index("<table")]
    taut = run.copy(deep=True)
    taut["tension_tether"].values[100:104] = 5.0
    taut["tension_tether"].values[0] = 0.0  # laid out unstretched
    assert run_numbers(taut)["lines"]["tether"]["slack_spells"] == 0
    assert "never slack" in summary(run_numbers(taut))[-1]


def test_the_terminal_tells_of_the_line(run):
    last = summary(run_numbers(run))[-1]
    assert last.startswith("tether: tension 0 to 41.6 N · slack: 39.9 s") and "libration ≤ 12°" in last and "right-handed" in last


@pytest.mark.parametrize("reel", [False, True])
def test_every_figure_is_drawn(reel):
    with themed():
        pictures = line_pictures(RunRecord(line_dataset(rows=301, reel=reel)))
    kinds = ("shape", "libration", "skiprope", "tension", "temperature", "current", "ends")
    assert [p.name for p in pictures] == [f"{kind}_tether" for kind in kinds]
    for picture in pictures:
        assert len(picture.caption) > 30 and len(picture.alt) > 30 and "nan" not in picture.alt
        assert all(axes.lines or axes.collections for axes in picture.figure.axes)


def test_the_drawing_holds_the_run(run, html):
    data = motion(html)
    line = data["lines"][0]
    assert len(data["seconds"]) == 601 and data["follow"] is False
    ends = unpacked(line["ends"], 2, 3)
    assert np.allclose(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1), LENGTH_M, rtol=1e-4)
    deflection = np.linalg.norm(unpacked(line["deflection"], line["points"], 3), axis=2)
    assert deflection.max() == pytest.approx((BOW_M + SKIPROPE_M) * np.sin(np.pi * 5 / 11), rel=0.02)
    assert np.allclose(deflection[:, [0, -1]], 0.0)
    tension = unpacked(line["tension"], line["points"] - 1)
    assert (tension[100:104] == 0.0).all() and tension.max() == pytest.approx(41.6, abs=0.1)
    assert np.allclose(unpacked(line["angles"], 2).max(axis=0), [IN_PLANE_RAD, ACROSS_RAD], rtol=1e-3)
    assert [body["name"] for body in data["bodies"]] == ["orbiter", "subsatellite"] and line["bodies"] == [1, 0]


def test_attitudes_in_the_drawing_do_not_jump(html):
    for body in motion(html)["bodies"]:
        turn = unpacked(body["turn"], 4)
        assert np.allclose(np.linalg.norm(turn, axis=1), 1.0, atol=1e-3)
        assert (np.sum(turn[1:] * turn[:-1], axis=1) > 0.9).all()


def test_long_runs_are_thinned():
    data = motion(simulation_html(line_dataset(rows=2400, reel=True)))
    assert len(data["seconds"]) == MOST_FRAMES and data["follow"] is True
    assert data["seconds"][0] == 0.0 and data["seconds"][-1] == 23990.0
    assert len(json.dumps(data)) < 400_000


def test_nothing_of_a_name_can_end_the_data(run):
    hostile = run.assign_attrs(scenario_toml=run.attrs["scenario_toml"].replace('"orbiter"', '"<!--<script>"'))
    page = simulation_html(hostile)
    assert "<!--<script>" not in page and motion(page)["bodies"][0]["name"] == "<!--<script>"


def test_zeros_pack():
    assert (unpacked(packed(np.zeros((3, 2))), 2) == 0.0).all()


class Balance(HTMLParser):
    """Whether every tag that is opened is closed in turn."""

    def __init__(self):
        super().__init__()
        self.open = []

    def handle_starttag(self, tag, attrs):
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        if tag not in VOID:
            assert self.open.pop() == tag


def test_the_page_is_whole_and_needs_nothing_else(html):
    reader = Balance()
    reader.feed(html)
    assert reader.open == []
    assert re.findall(r'(?:src|href)="(?!#|data:)[^"]*"|url\((?!#|"#)[^)]*\)|@import|<link|\bfetch\(|XMLHttp', html) == []
    assert len(html.encode()) < 2_000_000


def test_a_run_of_older_making_has_no_chapter(run):
    older = run.drop_vars([name for name in run if str(name).endswith("_tether")])
    assert run_numbers(older)["lines"] == {} and '<section id="lines">' not in simulation_html(older)


@pytest.mark.parametrize("reel", [False, True])
def test_lines_pull_at_bodies_with_their_tension(reel):
    """The drawn pull of one line is the tension beside the first body, whatever the half segments weigh."""
    data = line_dataset(reel=reel)
    line = LineRecord(RunRecord(data), "tether")
    pulled = line_pulls(line.run)
    b = min(line.ends)
    tension = line.tension[:, 0] if line.ends[0] == b else line.tension[:, -1]
    if not reel:
        assert pulled.keys() == {b} and pulled[b] == pytest.approx(tension, rel=1e-9, abs=1e-12)
    for end in (0, 1):
        last = np.isfinite(line.tension).sum(axis=1) - 1
        beside = line.tension[np.arange(len(last)), last if end else 0 * last]
        away = line.run.values("position_i")[:, line.ends[1 - end]] - line.run.values("position_i")[:, line.ends[end]]
        assert np.linalg.norm(line.pull_i(end), axis=1) == pytest.approx(beside, rel=1e-9, abs=1e-12)
        assert np.all((line.pull_i(end) * away).sum(axis=1) >= 0.0)
