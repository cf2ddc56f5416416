"""Two-line elements: columns, several sets, the choice among them, age, and what is refused."""

import json

import numpy as np
import pytest
from sgp4.api import Satrec

from fieldline.errors import InputError
from fieldline.frames.time import utc_julian
from fieldline.orbit import read_orbit
from fieldline.orbit.element_orbit import propagate
from fieldline.orbit.tle import checksum, parse_tle

FIRST = (
    "1 52191U 22033AL  23236.44460393  .00026275  00000+0  73805-3 0  9994",
    "2 52191  97.3614 318.0083 0006973 251.7714 108.2771 15.36489879 77757",
)
SECOND = (
    "1 52191U 22033AL  23247.77431173  .00022171  00000+0  61178-3 0  9997",
    "2 52191  97.3601 329.3497 0007739 208.8387 151.2430 15.37072592 79491",
)
ISS = (
    "1 25544U 98067A   20097.82871450  .00000874  00000-0  24271-4 0  9992",
    "2 25544  51.6465 341.5807 0003880  94.4223  26.1197 15.48685836220958",
)
EPOCH = np.datetime64("2023-08-24T10:40:13.779552")
DAY = np.timedelta64(86400, "s")


def written(tmp_path, *lines, end="\n", encoding="utf-8"):
    file = tmp_path / "orbit.txt"
    file.write_bytes((end.join(lines) + end).encode(encoding))
    return file


def with_checksum(line):
    return line[:68] + str(checksum(line))


def test_numbers_of_the_lines(tmp_path):
    elements = read_orbit(written(tmp_path, *FIRST)).sets[0]
    assert (elements.norad_id, elements.epoch_utc) == (52191, EPOCH)
    assert (elements.inclination_deg, elements.node_deg, elements.eccentricity) == (97.3614, 318.0083, 0.0006973)
    assert (elements.perigee_deg, elements.anomaly_deg, elements.motion_rev_day) == (251.7714, 108.2771, 15.36489879)
    assert (elements.drag_per_radius, elements.half_motion_rate_rev_day2) == (0.73805e-3, 0.00026275)


def test_same_states_as_the_package_reads_from_the_lines(tmp_path):
    times = EPOCH + np.arange(0, 3 * 86400, 977) * np.timedelta64(1, "s")
    _, r_km, v_km_s = Satrec.twoline2rv(*FIRST).sgp4_array(*utc_julian(times))
    r, v = propagate(read_orbit(written(tmp_path, *FIRST)).sets[0], times)
    assert np.abs(r - r_km * 1000.0).max() < 0.005  # the epoch as one number keeps 0.3 microseconds: 3 mm
    assert np.abs(v - v_km_s * 1000.0).max() < 1e-5


def test_velocity_is_the_derivative_and_axes_agree(tmp_path):
    orbit = read_orbit(written(tmp_path, *FIRST))
    times = EPOCH + np.arange(-1, 2) * np.timedelta64(1, "s")
    r, v = orbit.state_i(times)
    assert np.abs((r[2] - r[0]) / 2.0 - v[1]).max() < 0.05  # SGP4's own velocity is that good
    assert np.linalg.norm(orbit.position_e(times), axis=1) == pytest.approx(np.linalg.norm(r, axis=1), rel=1e-14)


def test_shapes(tmp_path):
    orbit = read_orbit(written(tmp_path, *FIRST))
    assert orbit.state_i(EPOCH)[0].shape == (3,)
    assert orbit.position_e(np.full((2, 4), EPOCH)).shape == (2, 4, 3)
    assert orbit.state_i(np.full(0, EPOCH))[1].shape == (0, 3)
    json.dumps(orbit.describe(np.full(0, EPOCH)))


@pytest.mark.parametrize(
    ("lines", "end", "encoding"),
    [
        (("SUCHAI-3", *FIRST), "\r\n", "utf-8"),
        (("0 SUCHAI-3", *FIRST), "\n", "utf-8-sig"),
        (("# from the archive", "", "SUCHAI-3  ", *FIRST, ""), "\n", "utf-16"),
        (("SUCHAI-3", *(line + "  \t" for line in FIRST)), "\n", "latin-1"),
        (("SUCHAI-3", *("  " + line.replace("U 22", "U\t22").replace("2 52191 ", "2 52191\t") for line in FIRST)), "\n", "ascii"),
    ],
)
def test_names_line_ends_marks_tabs(tmp_path, lines, end, encoding):
    orbit = read_orbit(written(tmp_path, *lines, end=end, encoding=encoding))
    assert (orbit.name, orbit.kind, orbit.norad_id) == ("SUCHAI-3", "TLE", 52191)


def test_blocks_leave_no_mark(tmp_path, monkeypatch):
    orbit = read_orbit(written(tmp_path, *FIRST, *SECOND))
    times = np.datetime64("2023-08-24", "ns") + np.arange(1000) * np.timedelta64(1111, "s")  # nearly 13 days, both sets
    whole = *orbit.state_i(times), orbit.position_e(times)
    monkeypatch.setattr("fieldline.orbit.orbit.BLOCK", 77)
    for mine, theirs in zip((*orbit.state_i(times), orbit.position_e(times)), whole, strict=True):
        assert np.abs(mine - theirs).max() < 1e-6
    assert orbit.covers(times).all()


def test_a_name_may_begin_with_a_bracket(tmp_path):
    assert read_orbit(written(tmp_path, "[DEB] SUCHAI-3", *FIRST)).name == "[DEB] SUCHAI-3"


def test_a_name_may_begin_with_a_one(tmp_path):
    assert read_orbit(written(tmp_path, "1 KUNS-PF", *FIRST)).name == "1 KUNS-PF"


@pytest.mark.parametrize(("digits", "epoch"), [("57", "1957"), ("99", "1999"), ("00", "2000"), ("56", "2056")])
def test_two_digit_years(digits, epoch):
    line1 = with_checksum(FIRST[0][:18] + digits + FIRST[0][20:])
    assert str(parse_tle(f"{line1}\n{FIRST[1]}", "x")[0].epoch_utc)[:4] == epoch


@pytest.mark.parametrize(("text", "number"), [("A0000", 100000), ("E8493", 148493), ("J0001", 180001), ("Z9999", 339999)])
def test_alpha5(text, number):
    lines = (with_checksum(line[:2] + text + line[7:]) for line in FIRST)
    assert parse_tle("\n".join(lines), "x")[0].norad_id == number


def test_one_set_serves_a_short_arc_without_a_jump(tmp_path):
    orbit = read_orbit(written(tmp_path, *SECOND, *FIRST))
    halfway = np.datetime64("2023-08-30T02:37:37")
    times = halfway + np.arange(-3600, 3600, 10) * np.timedelta64(1, "s")
    speed = np.linalg.norm(np.diff(orbit.state_i(times)[0], axis=0), axis=1) / 10.0
    assert speed.max() < 7700.0
    assert len(orbit.describe(times)["element_epochs_used"]) == 1


def test_long_spans_take_the_nearest_epoch_and_say_where_it_changes(tmp_path):
    orbit = read_orbit(written(tmp_path, *FIRST, *SECOND))
    times = np.datetime64("2023-08-24") + np.arange(14) * DAY
    account = orbit.describe(times)
    assert account["element_epochs_used"] == ["2023-08-24T10:40:13.779Z", "2023-09-04T18:35:00.533Z"]
    assert account["changes"][0]["time_utc"].startswith("2023-08-30T02:37")
    assert 1e3 < account["changes"][0]["jump_m"] < 1e5
    assert max(map(abs, account["age_days"])) == pytest.approx(5.5555, abs=1e-3)
    first, second = propagate(orbit.sets[0], times), propagate(orbit.sets[1], times)
    r = np.linalg.norm(orbit.state_i(times)[0], axis=1)
    assert r[:7] == pytest.approx(np.linalg.norm(first[0], axis=1)[:7])
    assert r[7:] == pytest.approx(np.linalg.norm(second[0], axis=1)[7:])
    json.dumps(account)


def test_of_sets_with_one_epoch_the_last_stays(tmp_path):
    other = with_checksum(FIRST[1][:26] + "0007000" + FIRST[1][33:])
    orbit = read_orbit(written(tmp_path, *FIRST, FIRST[0], other))
    assert [s.eccentricity for s in orbit.sets] == [0.0007]


def test_age_warning_and_refusal(tmp_path):
    orbit = read_orbit(written(tmp_path, *FIRST))
    assert orbit.check(EPOCH + 2 * DAY) == []
    assert "4.0 days" in orbit.check(EPOCH + 4 * DAY)[0]
    assert orbit.describe(EPOCH - 4 * DAY)["age_days"] == [-4.0, -4.0]
    with pytest.raises(InputError, match=r"31\.0 days after the nearest element epoch.*--max-orbit-age-days"):
        orbit.check(EPOCH + 31 * DAY)
    assert orbit.check(EPOCH + 31 * DAY, max_age_days=40.0)
    with pytest.raises(InputError, match="from 2010, the elements from 2023: elements of another year"):
        orbit.check(np.datetime64("2010-03-01"))


def test_a_satellite_that_has_come_down(tmp_path):
    orbit = read_orbit(written(tmp_path, *FIRST))
    with pytest.raises(InputError, match=r"decayed|eccentricity"):
        orbit.state_i(EPOCH + 1500 * DAY)


def test_several_satellites(tmp_path):
    file = written(tmp_path, "SUCHAI-3", *FIRST, "ISS (ZARYA)", *ISS)
    with pytest.raises(InputError, match="2 satellites, NORAD 25544, 52191: choose one"):
        read_orbit(file)
    assert read_orbit(file, norad_id=25544).name == "ISS (ZARYA)"
    with pytest.raises(InputError, match="holds NORAD 25544, 52191, not 7"):
        read_orbit(file, norad_id=7)


BAD_LINES = {
    "checksum": ((FIRST[0][:-1] + "5", FIRST[1]), 'line 1: the checksum is "5" and the digits before it sum to 4'),
    "cut": ((FIRST[0][:60], FIRST[1]), "line 1 has 60 characters; an element line has 69"),
    "no checksum": ((FIRST[0][:68], FIRST[1]), "line 1 has 68 characters"),
    "blank lost": ((FIRST[0].replace("U 22033AL ", "U22033AL  "), FIRST[1]), "column 9 must be blank"),
    "line 1 alone": ((FIRST[0],), "ends after line 1 of a set"),
    "line 2 alone": ((FIRST[1],), "line 2 comes without its line 1"),
    "swapped": ((FIRST[1], FIRST[0]), "Are the two lines swapped"),
    "twice line 1": ((FIRST[0], FIRST[0], FIRST[1]), "line 2: a second line 1"),
    "name between": ((FIRST[0], "SUCHAI-3", FIRST[1]), "expected line 2 of the set begun in line 1"),
    "two objects": ((FIRST[0], ISS[1]), "line 2 is of object 25544, line 1 before it of 52191"),
    "prose": (("Here are the elements that you asked for last week.", *FIRST), "line 1 is neither a name nor an element line"),
    "letter": ((with_checksum(FIRST[0]), with_checksum(FIRST[1][:9] + "x" + FIRST[1][10:])), "the inclination reads"),
    "day 367": ((with_checksum(FIRST[0][:20] + "367" + FIRST[0][23:]), FIRST[1]), "day of the year"),
    "inclination": ((FIRST[0], with_checksum(FIRST[1][:8] + "197.3614" + FIRST[1][16:])), "inclination_deg.*within 0 and 180"),
    "motion": ((FIRST[0], with_checksum(FIRST[1][:52] + "25.36489879" + FIRST[1][63:])), "motion_rev_day.*within"),
    "XP": ((with_checksum(FIRST[0][:62] + "4" + FIRST[0][63:]), FIRST[1]), "SGP4-XP"),
}


@pytest.mark.parametrize("case", BAD_LINES)
def test_damaged_sets_are_named(tmp_path, case):
    lines, words = BAD_LINES[case]
    with pytest.raises(InputError, match=words):
        read_orbit(written(tmp_path, *lines))


NO_ORBITS = {
    "empty": (b"", "is empty"),
    "blank": (b" \n\n\t\n", "is empty"),
    "binary": (bytes(range(256)) * 4, "is binary, not text"),
    "page": (b"<!DOCTYPE html>\n<html><body>404</body></html>", "is a web page, not an orbit"),
    "telemetry": (b"time,mag_x_nT\n2023-08-24T12:00:00,1.0\n", "telemetry and orbit given in each other's place"),
    "no data": (b"No GP data found", 'holds no orbit: its first line is "No GP data found"'),
    "title": (b"SUCHAI-3\n", "holds no orbit"),
    "short": (b"SUCHAI-3\n1 52191U 22033AL  23\n", "was the file cut"),
    "other xml": (b"<?xml version='1.0'?><gpx/>", "XML without an <omm>"),
    "oem xml": (b"<?xml version='1.0'?><oem id='CCSDS_OEM_VERS'/>", "only its text form"),
    "opm": (b"CCSDS_OPM_VERS = 2.0\n", "is a CCSDS OPM"),
}


@pytest.mark.parametrize("case", NO_ORBITS)
def test_files_that_are_no_orbit(tmp_path, case):
    content, words = NO_ORBITS[case]
    file = tmp_path / "orbit.tle"
    file.write_bytes(content)
    with pytest.raises(InputError, match=words):
        read_orbit(file)


def test_missing_file_and_folder(tmp_path):
    with pytest.raises(InputError, match=r"orbit file .*nowhere\.tle. does not exist"):
        read_orbit(tmp_path / "nowhere.tle")
    with pytest.raises(InputError, match="cannot be read"):
        read_orbit(tmp_path)


def test_deep_space_elements(tmp_path):
    """A 12-hour orbit, for which SGP4 adds the Moon, the Sun and resonance (Vallado et al. 2006, satellite 08195)."""
    file = written(
        tmp_path,
        "1 08195U 75081A   06176.33215444  .00000099  00000-0  11873-3 0   813",
        "2 08195  64.1586 279.0717 6877146 264.7651  20.2257  2.00491383225656",
    )
    elements = read_orbit(file).sets[0]
    assert propagate(elements, elements.epoch_utc[None])[0][0] / 1000.0 == pytest.approx(
        [2349.89483350, -14785.93811562, 0.02119378], abs=1e-5
    )
