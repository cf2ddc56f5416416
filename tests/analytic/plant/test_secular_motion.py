"""What loads do to an orbit and to a pair on a line in the long run, against closed forms."""

import numpy as np
import pytest

import fieldline as fl
import plant_flights as pf
from fieldline.constants import EARTH_EQUATORIAL_RADIUS_M, EARTH_GM_M3_S2, EARTH_J2, EARTH_ROTATION_RATE_RAD_S

POINT = pf.body(kind="point")
AIR = {"model": "exponential", "reference_density_kg_m3": 1e-11, "reference_altitude_km": 200.0, "scale_height_km": 60.0}


def slope(x, y):
    return np.polyfit(x, y, 1)[0]


@pytest.mark.parametrize("inclination", [35.0, 97.0])
def test_the_oblateness_turns_the_node(inclination):
    """Omega' = -3/2 n J2 (R/a)^2 cos i, to the next order in J2 (a part in 300)."""
    orbit = {"elements": {"altitude_km": 600.0, "inclination_deg": inclination}}
    flight = pf.flown(
        POINT, seconds=86400.0, output=120.0, orbit=orbit, environment={"gravity": "j2"}, integrator={"step_s": 20.0}
    )
    seconds, states = pf.rows(flight)
    normal = np.cross(states[:, 0, :3], states[:, 0, 3:6])
    node = np.unwrap(np.arctan2(normal[:, 0], -normal[:, 1]))
    a = EARTH_EQUATORIAL_RADIUS_M + 600e3
    n = np.sqrt(EARTH_GM_M3_S2 / a**3)
    expected = -1.5 * n * EARTH_J2 * (EARTH_EQUATORIAL_RADIUS_M / a) ** 2 * np.cos(np.radians(inclination))
    assert np.isclose(slope(seconds, node), expected, rtol=8e-3)


@pytest.mark.parametrize("method, error", [("rk4", 2e-4), ("dop853", 6e-4)])
def test_drag_takes_the_orbit_down(method, error):
    """Over the equator, where height and wind are constant: da/dt = -rho C_D A / m sqrt(mu a) (1 - w/n)^2."""
    orbit = {"elements": {"altitude_km": 450.0, "inclination_deg": 0.0}}
    record = pf.body(kind="point", mass_kg=20.0, drag={"area_m2": 0.5, "drag_coefficient": 2.2})
    environment = {"gravity": "point", "uniform_field_i_tesla": pf.UNIFORM, "atmosphere": AIR}
    flight = pf.flown(
        record, seconds=20000.0, output=50.0, orbit=orbit, environment=environment, integrator={"method": method, "step_s": 10.0}
    )
    seconds, states = pf.rows(flight)
    axis = -0.5 * EARTH_GM_M3_S2 / pf.orbit_energy(states)
    a, n = axis.mean(), np.sqrt(EARTH_GM_M3_S2 / axis.mean() ** 3)
    height = 1e-3 * (a - 6378137.0)
    density = 1e-11 * np.exp(-(height - 200.0) / 60.0)
    expected = -density * 2.2 * 0.5 / 20.0 * np.sqrt(EARTH_GM_M3_S2 * a) * (1.0 - EARTH_ROTATION_RATE_RAD_S / n) ** 2
    assert np.isclose(slope(seconds, axis), expected, rtol=error)  # dop853 is let off with millimetres a step


def test_sunlight_pushes_in_the_sun_and_not_in_the_shadow():
    record = pf.body(kind="point", solar_pressure={"area_m2": 3.0, "reflectivity_coefficient": 1.4})
    dataset = fl.simulate(pf.scenario(record, seconds=6000.0, output=20.0))
    force = np.linalg.norm(dataset.force_i.sel(load="solar_pressure").values[:, 0], axis=1)
    sunlit = dataset.sunlit.values[:, 0]
    assert {0.0, 1.0} <= set(sunlit)
    assert np.all(force[sunlit == 0.0] == 0.0)
    # 1 March: the Sun is 0.991 au away
    assert np.allclose(force[sunlit == 1.0], 1361.0 / 299792458.0 / 0.991**2 * 1.4 * 3.0, rtol=2e-3)


MASS, LENGTH, STIFFNESS = 20.0, 1000.0, 2e4


def dumbbell(along=0.0, across=0.0, **more):
    """A small mass on a line under a great one on a circle, tilted by small angles [rad], at the stretch of its tension."""
    stretched = LENGTH * (1.0 + 3.0 * pf.MEAN_MOTION**2 * MASS * LENGTH / STIFFNESS)
    offset = stretched * np.array([np.sin(along), np.sin(across), np.cos(along) * np.cos(across)])
    bodies = (
        pf.body("ship", kind="point", mass_kg=2e7),
        pf.body("probe", kind="point", mass_kg=MASS, offset_o_m=offset.tolist()),
    )
    line = {"from_body": "ship", "to_body": "probe", "rest_length_m": LENGTH, "stiffness_n": STIFFNESS, "damping_n_s": 2e4}
    return pf.scenario(*bodies, seconds=12000.0, output=10.0, integrator={"step_s": 0.5}, line=[line | more])


def offsets(dataset):
    """(n, 3) [m] of the second body from the first, orbital axes: along, against the normal, down."""
    r, v = dataset.position_i.values[:, 0], dataset.velocity_i.values[:, 0]
    down = -r / np.linalg.norm(r, axis=1)[:, None]
    against = -np.cross(r, v)
    against /= np.linalg.norm(against, axis=1)[:, None]
    apart = dataset.position_i.values[:, 1] - r
    return np.stack([np.sum(apart * axis, axis=1) for axis in (np.cross(against, down), against, down)], axis=1)


def frequency(seconds, values):
    """[rad/s] from all zero crossings, each by a cubic through four samples."""
    at = np.flatnonzero(values[:-1] * values[1:] < 0)
    zeros = []
    for k in at[(at > 0) & (at < len(values) - 2)]:
        x, y = seconds[k - 1 : k + 3] - seconds[k], values[k - 1 : k + 3]
        roots = np.roots(np.polyfit(x, y, 3))
        zeros.append(seconds[k] + min((r.real for r in roots if abs(r.imag) < 1e-9), key=lambda r: abs(r - 0.5 * (x[1] + x[2]))))
    return np.pi * (len(zeros) - 1) / (zeros[-1] - zeros[0])


@pytest.mark.parametrize("plane, ratio", [("along", np.sqrt(3.0)), ("across", 2.0)])
def test_a_dumbbell_swings_at_the_root_of_three_in_its_plane_and_twice_across(plane, ratio):
    dataset = fl.simulate(dumbbell(**{plane: 0.02}))
    offset = offsets(dataset)
    swing = offset[:, 0 if plane == "along" else 1] / np.linalg.norm(offset, axis=1)
    if plane == "along":
        swing = swing - swing.mean()  # gravity's next order bends the rest position by 1e-4
    assert np.isclose(frequency(dataset.seconds.values, swing) / pf.MEAN_MOTION, ratio, rtol=1e-3)
    assert np.isclose(np.abs(swing).max(), 0.02, rtol=0.05)


def test_a_hanging_line_bears_three_times_the_orbits_pull():
    """T = 3 n^2 m L, and the next order of gravity, L / r = 1.5e-4."""
    dataset = fl.simulate(dumbbell())
    tension = np.linalg.norm(dataset.force_i.sel(load="lines").values, axis=2)
    length = np.linalg.norm(offsets(dataset), axis=1)
    # force on both ends is one, in opposite ways
    assert np.abs(dataset.force_i.sel(load="lines").sum("body").values).max() < 1e-15
    assert np.allclose(tension[:, 1] / (3.0 * pf.MEAN_MOTION**2 * MASS * length), 1.0, atol=1e-3)


def test_a_slack_line_does_nothing():
    slack = fl.simulate(dumbbell(along=0.1, rest_length_m=1500.0))
    none = fl.simulate(dumbbell(along=0.1).replace(line=[]))
    apart = np.linalg.norm(offsets(slack), axis=1)
    first = apart < 1500.0
    stop = len(first) if first.all() else int(np.argmin(first))
    assert stop > 20
    assert np.array_equal(slack.position_i.values[: stop - 1], none.position_i.values[: stop - 1])
