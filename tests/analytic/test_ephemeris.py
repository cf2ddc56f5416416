"""OEM and position columns: frames, interpolation and its order, time systems, spans, and what is refused."""

import json

import erfa
import numpy as np
import pytest

from fieldline.errors import InputError
from fieldline.frames.earth_orientation import EarthOrientation
from fieldline.frames.earth_rotation import dcm_ei, dcm_it
from fieldline.orbit import orbit_from_positions, read_orbit
from fieldline.orbit.interpolation import PolynomialPath
from fieldline.orbit.oem import to_gcrs

START = np.datetime64("2023-08-24T12:00:00.000000000")
GM, RADIUS, OMEGA_EARTH = 3.986004418e14, 6.85e6, 7.292115e-5
MOTION = np.sqrt(GM / RADIUS**3)
TILT = np.radians(97.4)


def circle(times):
    """A circular Kepler orbit: position [m] and velocity [m/s], GCRS."""
    angle = MOTION * (times - START).astype(np.int64) * 1e-9
    p, q = np.array([1.0, 0.0, 0.0]), np.array([0.0, np.cos(TILT), np.sin(TILT)])
    c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
    return RADIUS * (c * p + s * q), RADIUS * MOTION * (c * q - s * p)


def grid(count, step_s, start=START):
    return start + (np.arange(count) * step_s * 1e9).astype("timedelta64[ns]")


def in_frame(times, frame):
    """The circle's states in a frame's axes."""
    r, v = circle(times)
    if frame.startswith("ITRF"):
        turn = dcm_ei(times)
        r, v = np.einsum("nij,nj->ni", turn, r), np.einsum("nij,nj->ni", turn, v)
        return r, v - np.cross([0.0, 0.0, OMEGA_EARTH], r)
    if frame == "TEME":
        turn = np.swapaxes(dcm_it(times), -1, -2)
        return np.einsum("nij,nj->ni", turn, r), np.einsum("nij,nj->ni", turn, v)
    if frame == "EME2000":
        bias = erfa.bp06(2451545.0, 0.0)[0]
        return r @ bias.T, v @ bias.T
    return r, v


def oem_segment(times, frame="GCRF", system="UTC", offset_s=0, extra="", acceleration=""):
    r, v = in_frame(times, frame)
    stamps = np.datetime_as_string(times + np.timedelta64(offset_s * 10**9, "ns"), unit="ms")
    states = np.hstack((r, v)) / 1000.0
    rows = "".join(f"{t} {' '.join(f'{x:.9f}' for x in s)}{acceleration}\n" for t, s in zip(stamps, states, strict=True))
    return (
        f"META_START\nOBJECT_NAME = SAT\nOBJECT_ID = 2022-033AL\nCENTER_NAME = EARTH\nREF_FRAME = {frame}\n"
        f"TIME_SYSTEM = {system}\nSTART_TIME = {stamps[0]}\nSTOP_TIME = {stamps[-1]}\n{extra}META_STOP\nCOMMENT states\n{rows}"
    )


def read(tmp_path, *segments):
    file = tmp_path / "orbit"
    file.write_text("CCSDS_OEM_VERS = 2.0\nCREATION_DATE = 2023-08-25T00:00:00\nORIGINATOR = US\n" + "\n".join(segments))
    return read_orbit(file)


def misfit(orbit, times):
    """Largest errors of position [m] and velocity [m/s]."""
    return [np.linalg.norm(a - b, axis=1).max() for a, b in zip(orbit.state_i(times), circle(times), strict=True)]


@pytest.mark.parametrize("frame", ["GCRF", "ICRF", "EME2000", "TEME", "ITRF2014", "ITRF-97", "ITRF"])
def test_frames(tmp_path, frame):
    orbit = read(tmp_path, oem_segment(grid(60, 60.0), frame))
    assert (orbit.kind, orbit.name) == ("OEM", "SAT")
    position, velocity = misfit(orbit, grid(1180, 3.0))
    assert position < 1e-4  # micrometres are written; Hermite of degree 7 leaves 0.01 mm
    assert velocity < 1e-5
    json.dumps(orbit.describe(grid(3, 1.0)))


def test_the_frame_bias_is_seventeen_milliarcseconds_and_signed():
    """IERS Conventions (2010), s. 5.2: the pole of J2000 lies at xi0 = -16.6170, eta0 = -6.8192 mas in GCRS."""
    pole, _ = to_gcrs(np.array([[0.0, 0.0, 1.0]]), np.zeros((1, 3)), START[None], "EME2000", "x")
    assert pole[0, :2] * 648000e3 / np.pi == pytest.approx([-16.6170, -6.8192], abs=1e-3)


@pytest.mark.parametrize(("system", "offset_s"), [("UTC", 0), ("TAI", 37), ("GPS", 18), ("TT", 69.184)])
def test_time_systems(tmp_path, system, offset_s):
    segment = oem_segment(grid(20, 60.0), system=system, offset_s=0)
    orbit = read(tmp_path, segment)
    shift = np.timedelta64(round(offset_s * 1e9), "ns")
    assert orbit.paths[0].first_utc == START - shift
    assert np.abs(orbit.state_i(START - shift)[0] - circle(START[None])[0]).max() < 1e-5


@pytest.mark.parametrize(
    ("method", "degree", "order"), [("HERMITE", 3, 4), ("HERMITE", 7, 8), ("LAGRANGE", 4, 5), ("LAGRANGE", 7, 8)]
)
def test_order_of_interpolation(method, degree, order):
    """Halving the spacing divides the error in mid-table by 2^order."""
    errors = []
    for step in (240.0, 120.0):
        nodes = grid(int(7200 / step) + 1, step)
        path = PolynomialPath.through(nodes, *circle(nodes), method=method, degree=degree)
        assert path.degree == degree
        middle = grid(900, 1.0, START + np.timedelta64(3000, "s"))
        errors.append(np.linalg.norm(path.state(middle)[0] - circle(middle)[0], axis=1).max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.35)


def test_hermite_is_as_good_as_stated():
    nodes = grid(30, 300.0)
    path = PolynomialPath.through(nodes, *circle(nodes), method="HERMITE", degree=7)
    times = grid(8700, 1.0)
    error = np.linalg.norm(path.state(times)[0] - circle(times)[0], axis=1)
    assert error[600:-600].max() < 0.01
    assert error.max() < 0.2


def test_nodes_are_met_and_few_nodes_lower_the_degree(tmp_path):
    nodes = grid(2, 60.0)
    orbit = read(tmp_path, oem_segment(nodes, extra="INTERPOLATION = LAGRANGE\nINTERPOLATION_DEGREE = 5\n"))
    assert "degree 1" in orbit.describe(nodes)["paths"][0]["interpolation"]
    assert misfit(orbit, nodes)[0] < 1e-5


def test_segments_are_kept_apart_and_nothing_is_extrapolated(tmp_path):
    later = START + np.timedelta64(3600, "s")
    orbit = read(tmp_path, oem_segment(grid(20, 60.0, later)), oem_segment(grid(20, 60.0)))
    assert misfit(orbit, np.concatenate((grid(100, 11.0), grid(100, 11.0, later))))[0] < 1e-4
    assert orbit.covers(np.array([START, START + np.timedelta64(1500, "s"), later])).tolist() == [True, False, True]
    for wrong in (START - np.timedelta64(1, "ns"), START + np.timedelta64(1500, "s"), later + np.timedelta64(1141, "s")):
        with pytest.raises(InputError, match="covers 2023-08-24T12:00:00Z to 2023-08-24T12:19:00Z, 2023-08-24T13:00:00Z"):
            orbit.state_i(wrong)
        with pytest.raises(InputError, match="1 of 1 samples lie outside"):
            orbit.check(wrong)
    assert orbit.check(later) == []


def test_useable_span_and_covariance_and_acceleration(tmp_path):
    extra = "USEABLE_START_TIME = 2023-08-24T12:05:00\nUSEABLE_STOP_TIME = 2023-236T12:10:00.5Z\n"
    covariance = "COVARIANCE_START\nEPOCH = 2023-08-24T12:00:00\n1.0\n2.0 3.0\nCOVARIANCE_STOP\n"
    orbit = read(tmp_path, oem_segment(grid(20, 60.0), extra=extra, acceleration=" 0 0 0") + covariance)
    assert orbit.covers(grid(20, 60.0)).sum() == 6
    assert misfit(orbit, grid(300, 1.0, START + np.timedelta64(300, "s")))[0] < 1e-4


def test_a_long_first_segment_serves_after_a_short_one_inside_it(tmp_path):
    inner = START + np.timedelta64(300, "s")
    orbit = read(tmp_path, oem_segment(grid(60, 60.0)), oem_segment(grid(5, 60.0, inner)))
    assert orbit.covers(grid(3500, 1.0)).all()


def test_eop_serves_the_frame(tmp_path):
    """ITRF states are turned with the orbit's own Earth orientation, there and back."""
    eop = EarthOrientation("test", np.array([60000.0, 61000.0]), np.full(2, -36.5), np.full(2, 0.2), np.full(2, 0.4))
    file = tmp_path / "orbit"
    file.write_text("CCSDS_OEM_VERS = 2.0\n" + oem_segment(grid(20, 60.0), "ITRF"))
    with_eop, without = read_orbit(file, eop=eop), read_orbit(file)
    times = grid(100, 11.0)
    assert np.abs(with_eop.position_e(times) - without.position_e(times)).max() < 1e-4
    shift = np.linalg.norm(with_eop.state_i(times)[0] - without.state_i(times)[0], axis=1)
    assert shift.max() == pytest.approx(0.5 * OMEGA_EARTH * RADIUS, rel=0.1)
    assert with_eop.describe(times)["earth_orientation"] == "test"
    assert "UT1 = UTC" in without.describe(times)["earth_orientation"]


GOOD = oem_segment(grid(5, 60.0))
ROW = GOOD.splitlines()[-1]
BAD = {
    "no segment": ("", "without a segment"),
    "no states": (GOOD.split("COMMENT")[0], "0 states; two at least"),
    "no META_STOP": (GOOD.split("META_STOP")[0], "has no META_STOP"),
    "frame": (GOOD.replace("GCRF", "TOD"), 'REF_FRAME is "TOD"; known: GCRF'),
    "centre": (GOOD.replace("EARTH", "MARS BARYCENTER"), "CENTER_NAME is MARS"),
    "time system": (GOOD.replace("= UTC", "= MET"), "TIME_SYSTEM is MET; known: UTC"),
    "columns": (GOOD.replace(ROW, ROW.rsplit(" ", 1)[0]), "line .* has 6 columns"),
    "letter": (GOOD.replace(ROW, ROW[:-3] + "x.y"), "could not convert"),
    "metres": (GOOD.replace(ROW, ROW.split()[0] + " 6850000e3 0 0 0 7.6 0"), "is it written in metres"),
    "nan": (GOOD.replace(ROW, ROW.split()[0] + " nan 0 0 0 7.6 0"), "distances run"),
    "huge": (GOOD.replace(ROW, ROW.split()[0] + " 1e300 0 0 0 7.6 0"), "distances run"),
    "metres a second": (GOOD.replace(ROW, ROW.split()[0] + " 6850 0 0 0 7600 0"), "is it written in m/s"),
    "order": (GOOD + ROW, "is not after the one before it"),
    "epoch": (GOOD.replace(ROW, "24/08/2023 1 2 3 4 5 6"), 'reads "24/08/2023"'),
    "method": (GOOD.replace("META_STOP", "INTERPOLATION = SPLINE\nMETA_STOP"), "INTERPOLATION is SPLINE"),
    "degree": (GOOD.replace("META_STOP", "INTERPOLATION_DEGREE = many\nMETA_STOP"), "expected 1 to 15"),
    "objects": (GOOD + GOOD.replace("2022-033AL", "1998-067A"), "several objects: 1998-067A, 2022-033AL"),
}


@pytest.mark.parametrize("case", BAD)
def test_damaged_messages_are_named(tmp_path, case):
    with pytest.raises(InputError, match=BAD[case][1]):
        read(tmp_path, BAD[case][0])


def test_an_oem_is_not_chosen_from_by_number(tmp_path):
    file = tmp_path / "orbit"
    file.write_text("CCSDS_OEM_VERS = 2.0\n" + GOOD)
    with pytest.raises(InputError, match="leave --norad-id"):
        read_orbit(file, norad_id=5)


# ---- position columns ----


def positions(times):
    return np.einsum("nij,nj->ni", dcm_ei(times), circle(times)[0])


@pytest.mark.parametrize(
    ("step_s", "position_m", "velocity_m_s"), [(1.0, 0.03, 5e-3), (10.0, 0.03, 5e-3), (60.0, 0.03, 5e-3), (300.0, 150.0, 3.0)]
)
def test_positions_give_the_orbit(step_s, position_m, velocity_m_s):
    times = grid(int(6000 / step_s), step_s)
    orbit = orbit_from_positions(times, positions(times))
    between = times[:-1] + np.timedelta64(round(step_s * 0.37e9), "ns")
    assert orbit.kind == "positions"
    error = misfit(orbit, between)
    assert error[0] < position_m
    assert error[1] < velocity_m_s
    assert np.abs(orbit.position_e(between) - positions(between)).max() < position_m


def test_noise_is_smoothed_and_stated():
    times = grid(5600, 1.0)
    noise = np.random.default_rng(5).normal(0.0, 10.0, (5600, 3))
    orbit = orbit_from_positions(times, positions(times) + noise)
    assert misfit(orbit, times[100:-100])[0] < 6.0
    assert misfit(orbit, times[100:-100])[1] < 0.3
    assert orbit.paths[0].scatter_m == pytest.approx(10.0 * np.sqrt(3.0), rel=0.03)
    assert orbit.check(times) == []
    coarse = np.round(positions(times) / 2e4) * 2e4
    assert "scatter about a smooth path" in orbit_from_positions(times, coarse).check(times)[0]


def test_pauses_are_not_bridged():
    times = np.concatenate(
        (grid(600, 1.0), grid(2, 1.0, START + np.timedelta64(1500, "s")), grid(600, 1.0, START + np.timedelta64(2400, "s")))
    )
    orbit = orbit_from_positions(times, positions(times))
    assert misfit(orbit, times[orbit.covers(times)])[0] < 0.03
    assert orbit.covers(times).sum() == 1200
    words = " ".join(orbit.check(times[:600]))
    assert "2 positions stand alone" in words
    assert "pause for over 300 s 1 times" in words
    with pytest.raises(InputError, match="lie outside"):
        orbit.state_i(START + np.timedelta64(1500, "s"))


def test_missing_positions_are_left_out():
    times = grid(600, 1.0)
    holes = positions(times)
    holes[10:30] = np.nan
    assert misfit(orbit_from_positions(times, holes), times)[0] < 0.03


@pytest.mark.parametrize("count", [4, 5, 6, 7, 10, 13])
def test_few_positions(count):
    times = grid(count, 1.0)
    assert misfit(orbit_from_positions(times, positions(times)), grid(count * 4 - 4, 0.25))[0] < 0.01


@pytest.mark.parametrize("seed", range(6))
def test_uneven_times(seed):
    """Bursts and pauses up to the limit never leave the least squares without an answer."""
    rng = np.random.default_rng(seed)
    steps = rng.choice([0.01, 1.0, 30.0, 119.0, 121.0, 299.0], size=60, p=rng.dirichlet(np.ones(6)))
    times = START + (np.cumsum(steps) * 1e9).astype("timedelta64[ns]")
    orbit = orbit_from_positions(times, positions(times))
    assert misfit(orbit, times)[0] < 10.0


def refusals():
    times = grid(6000, 1.0)
    return {
        "inertial": (times, circle(times)[0], "Are the columns in GCRS, J2000 or TEME"),
        "km": (times, positions(times) / 1000.0, "Are the columns in km"),
        "huge": (times, positions(times) * np.logspace(0, 300, 6000)[:, None], "a satellite flies beyond"),
        "zero": (times, positions(times) * np.linspace(0.0, 1.0, 6000)[:, None], "from the Earth's centre"),
        "shape": (times, positions(times).T, r"must be \(6000, 3\)"),
        "three": (times[:3], positions(times[:3]), "needs 4 positions"),
        "none": (times, np.full((6000, 3), np.nan), "0 of 6000 are finite"),
        "order": (times[::-1], positions(times), "sort the times"),
        "sparse": (grid(50, 301.0), positions(grid(50, 301.0)), "without a pause over 300 s"),
    }


@pytest.mark.parametrize("case", refusals())
def test_positions_that_are_no_orbit(case):
    times, position, words = refusals()[case]
    with pytest.raises(InputError, match=words):
        orbit_from_positions(times, position)


def test_what_stands_on_the_ground_is_not_refused():
    """A magnetometer on a bench has a position too, though it does not fall."""
    times = grid(3000, 1.0)
    bench = np.broadcast_to([1.77e6, -5.04e6, -3.48e6], (3000, 3))
    assert np.abs(orbit_from_positions(times, bench).position_e(times) - bench).max() < 0.01
