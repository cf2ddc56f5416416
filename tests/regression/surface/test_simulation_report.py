"""The report on a simulated run, and the numbers that it opens with."""

import re

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import fieldline as fl
from fieldline.errors import InputError
from fieldline.report.geometry import orbital_axes_i
from fieldline.report.pointing import pointing_of
from fieldline.report.run_numbers import run_numbers
from fieldline.report.run_record import RunRecord
from fieldline.report.run_relative_figures import relative_o
from fieldline.report.run_sensor_figures import attitude_error, residuals
from fieldline.report.simulation_report import is_run, simulation_figures, simulation_html
from fieldline.simulate.scenario import Scenario
from simulated_runs import EVERYTHING, TUMBLE

OF_LINE = {"shape_line_1", "libration_line_1", "tension_line_1", "ends_line_1"}
FIGURES = "rates pointing attitude torques torquers wheels rods knowledge sensors"


@pytest.fixture(scope="module")
def run():
    return fl.simulate(Scenario.from_toml(EVERYTHING))


@pytest.fixture(scope="module")
def html(run):
    return simulation_html(run)


def test_the_page_needs_no_network(html):
    assert (
        re.findall(
            r'(?:src|href)="(?!#|data:)[^"]*"|url\((?!#|"#)[^)]*\)|@import|<script (?!type="application/json")|<link', html
        )
        == []
    )
    assert len(html.encode()) < 5_000_000


def test_every_chapter_is_there_in_order(html):
    names = (
        "motion",
        "bodies",
        "lines",
        "field",
        "loads",
        "actuators",
        "knowledge",
        "sensors",
        "events",
        "scenario",
        "provenance",
    )
    positions = [html.index(f'<section id="{name}">') for name in names]
    assert positions == sorted(positions)
    for expected in ("Flown to its end, 1200 s.", "solar pressure", "slow", "IGRF-14", "rest_length_m = 99.0"):
        assert expected in html


def test_words_from_the_scenario_cannot_become_markup(html):
    assert "sensors &lt;and &amp; signs&gt;" in html and "<and" not in html


def test_every_figure_says_what_to_look_for_and_what_it_shows(run):
    pictures = simulation_figures(run)
    assert {p.name for p in pictures} == {f"{name}_1" for name in FIGURES.split()} | {"separation", "relative", "field"} | OF_LINE
    for picture in pictures:
        assert len(picture.caption) > 30 and len(picture.alt) > 30
        for axes in picture.figure.axes:
            assert axes.lines, f"an empty panel in {picture.name}"
            assert "nan" not in picture.alt and "nan" not in picture.caption


def test_the_same_run_gives_the_same_page(run, html):
    assert simulation_html(run) == html


def test_write_report_tells_runs_from_estimates(run, estimate, tmp_path):
    assert is_run(run) and not is_run(estimate)
    assert "Flown to its end" in fl.write_report(run, tmp_path / "run.html").read_text()
    assert "Attitude from flight.csv" in fl.write_report(estimate, tmp_path / "estimate.html").read_text()


def test_a_partial_run_is_flagged_in_red(run):
    partial = run.isel(time=slice(0, 60)).assign_attrs(complete=0, outcome="interrupted at t = 118 s of 1200 s.")
    page = simulation_html(partial)
    head = page[page.index("<main>") : page.index("<table")]
    assert '<div class="verdict refused"' in head and "Partial" in head and "Interrupted at t = 118 s" in head


def test_one_output_is_too_few_for_a_report(run):
    with pytest.raises(InputError, match="a report needs two"):
        simulation_html(run.isel(time=slice(0, 1)))


def with_attitude(run, rotvec_b):
    """The run with its first body turned by a rotation vector from the orbital axes."""
    record = RunRecord(run)
    dcm_io = np.swapaxes(orbital_axes_i(record.of("position_i", 0), record.of("velocity_i", 0)), -1, -2)
    changed = run.copy(deep=True)
    changed["q_bi"].values[:, 0] = (Rotation.from_matrix(dcm_io) * Rotation.from_rotvec(rotvec_b)).as_quat()
    return changed


def test_pointing_is_the_turn_from_the_target(run):
    turned = with_attitude(run, np.radians([0.3, -0.4, 1.2]))
    pointing = pointing_of(RunRecord(turned), 0)
    assert pointing.words == "the orbital axes"
    assert np.allclose(pointing.error_deg, [0.3, -0.4, 1.2], atol=1e-9)
    told = run_numbers(turned)["bodies"]["main"]["pointing"]
    assert told["rms_deg"] == pytest.approx(1.3) and told["worst_deg"] == pytest.approx(1.3)


def test_a_tracked_line_is_off_about_the_axes_across_it(run):
    scenario = Scenario.from_toml(EVERYTHING).replace(software=[], event=[])
    law = {"law": "three-coil", "body": "main", "parameters": {"target_i": [0.0, 2.0, 0.0], "sensor_limit_arcsec": 1.2}}
    scenario = scenario.replace(software=[law])
    changed = run.copy(deep=True).assign_attrs(scenario_toml=scenario.to_toml())
    on_line = Rotation.from_euler("z", 90.0, degrees=True)  # body x along inertial y
    changed["q_bi"].values[:, 0] = (on_line * Rotation.from_rotvec([0.0, np.radians(0.5), 0.0])).as_quat()
    assert np.allclose(pointing_of(RunRecord(changed), 0).error_deg, [0.0, 0.5, 0.0], atol=1e-9)
    changed["q_bi"].values[:, 0] = (on_line * Rotation.from_rotvec([0.0, 0.0, np.radians(0.5)])).as_quat()
    assert np.allclose(pointing_of(RunRecord(changed), 0).error_deg, [0.0, 0.0, 0.5], atol=1e-9)


def test_rest_is_from_when_the_rate_stays_low(run):
    tumbling = run.copy(deep=True)
    rate = np.full(len(run["time"]), np.radians(0.1))
    rate[:100] = np.radians(3.0)
    rate[150:201] = np.radians(0.6)  # not for good before this
    tumbling["omega_bi_b"].values[:, 0] = rate[:, None] * [0.0, 1.0, 0.0]
    assert run_numbers(tumbling)["bodies"]["main"]["at_rest_after_s"] == pytest.approx(402.0)
    tumbling["omega_bi_b"].values[-1, 0] = [0.1, 0.0, 0.0]
    assert "at_rest_after_s" not in run_numbers(tumbling)["bodies"]["main"]


def test_saturation_is_the_worst_torquers_share(run):
    changed = run.copy(deep=True)
    changed["torquer_moment"].values[:] = 0.0
    changed["torquer_moment"].values[: len(run["time"]) // 4, 1] = -0.02
    shares = run_numbers(changed)["bodies"]["main"]["saturated_share"]
    assert shares["torquers"] == pytest.approx(0.25, abs=0.002)


def test_residuals_are_the_sensors_errors(run):
    found = {one.title.split(",")[0]: one for one in residuals(RunRecord(run), 0)}
    assert set(found) == {"magnetometer", "gyro", "star tracker", "navigation", "sun sensors"}
    magnetometer = found["magnetometer"].values
    assert np.allclose(magnetometer.mean(axis=0), [100.0, 0.0, 0.0], atol=4.0)
    assert np.allclose(magnetometer.std(axis=0), 20.0, atol=3.0)
    assert np.allclose(np.nanstd(found["star tracker"].values, axis=0), [20.0, 20.0, 60.0], rtol=0.15)
    assert np.allclose(found["navigation"].values.std(axis=0), 5.0, rtol=0.15)
    assert len(found["gyro"].seconds) == len(run["time"])


def test_what_is_not_known_is_no_error():
    q = Rotation.from_rotvec([[0.1, 0.0, 0.0], [0.0, 0.2, 0.0]]).as_quat()
    known = np.array([[np.nan] * 4, (Rotation.from_quat(q[1]) * Rotation.from_rotvec([0.0, 0.0, 0.01])).as_quat()])
    error = attitude_error(q, known)
    assert np.isnan(error[0]).all() and np.allclose(error[1], [0.0, 0.0, 0.01])


def test_relative_places_are_the_offsets_at_the_start(run):
    assert np.allclose(relative_o(RunRecord(run), 1)[0], [0.0, 0.0, 100.01], atol=1e-3)


def test_a_free_body_has_a_plain_report():
    """No actuators, nothing known on board: the chapters that have nothing to show are left out."""
    text = re.sub("^(magnetometer|duration_s).*$", "", TUMBLE, flags=re.MULTILINE)
    run = fl.simulate(Scenario.from_toml(text.replace("[time]", "[time]\nduration_s = 300.0")))
    page = simulation_html(run)
    for name in ("bodies", "actuators", "knowledge", "sensors", "events"):
        assert f'<section id="{name}">' not in page
    assert "at_rest_after_s" not in run_numbers(run)["bodies"]["satellite"]
