"""White, Shigemoto and Bourquin (1961), NASA TN D-1068: its Appendix A and the field seen along an orbit.

The study prints two facts that can be checked (two minima an orbit, magnitude within 2:1); the other figures are those
of an independent re-derivation and simulation of it, at 805 km (an orbit of 6,050 s) with 17 degrees of tilt.
"""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fieldline.cases.ames_1961 import across_field_eigenvalues, field, lines, lost_field
from fieldline.cases.ames_1961.dipole_field import DIPOLE_MOMENT_A_M2, minima_of
from fieldline.cases.ames_1961.rotations import about_x, about_y, about_z, field_chain, magnetic_angles, orbital_position
from fieldline.constants import EARTH_MEAN_RADIUS_M, EARTH_ROTATION_RATE_RAD_S
from fieldline.environment import field_model
from fieldline.environment.dipoles import dipoles_kernel
from fieldline.environment.field import field_kernel
from fieldline.errors import InputError

LAST_DIGIT = 5e-9  # eight decimals


def test_vector_of_appendix_a():
    # RA_M, L_M, Om, i, th, RA_S, D_S, Phi_S = 30, 73, 40, 35, 50, 20, 10, 15 deg; R = 1, mu0 P / 4 pi = 1.
    position = orbital_position(1.0, *np.radians([40.0, 35.0, 50.0]))
    chain = field_chain(position, np.radians(30.0), np.radians(73.0), np.radians([20.0, 10.0, 15.0]), 1e7)
    assert chain.position_4 == pytest.approx([0.57340538, 0.72959253, -0.37269425], abs=LAST_DIGIT)
    assert chain.phi_rad == pytest.approx(1.0985261, abs=5e-8)
    assert chain.psi_rad == pytest.approx(0.96013989, abs=LAST_DIGIT)
    assert chain.field_4 == pytest.approx([0.0136188, -1.25505685, 0.64111467], abs=LAST_DIGIT)
    assert chain.field_i == pytest.approx([0.10001567, -1.39147075, 0.20046751], abs=LAST_DIGIT)
    assert chain.field_s == pytest.approx([-0.34131389, -1.22778105, 0.60202967], abs=LAST_DIGIT)


def random_geometries(count, seed=5):
    draw = np.random.default_rng(seed)
    node, argument, turn, right_ascension, roll = draw.uniform(-np.pi, np.pi, (5, count))
    inclination = np.arccos(draw.uniform(-1.0, 1.0, count))
    latitude, declination = np.arcsin(draw.uniform(-1.0, 1.0, (2, count)))
    radius = draw.uniform(6.5e6, 4.2e7, count)
    position = orbital_position(radius, node, inclination, argument)
    return position, turn, latitude, np.stack([right_ascension, declination, roll])


def test_closed_form_and_angles_over_random_geometries():
    position, turn, latitude, line = random_geometries(3000)
    chain = field_chain(position, turn, latitude, line, DIPOLE_MOMENT_A_M2)
    radius = np.linalg.norm(position, axis=1)
    u = chain.position_4 / radius[:, None]
    strength = 1e-7 * DIPOLE_MOMENT_A_M2 / radius**3
    closed = np.stack([1.0 - 3.0 * u[:, 0] ** 2, -3.0 * u[:, 0] * u[:, 1], -3.0 * u[:, 0] * u[:, 2]], axis=1)  # (A10)
    assert chain.field_4 / strength[:, None] == pytest.approx(closed, abs=5e-15)
    cos, sin = np.cos, np.sin
    phi, psi = chain.phi_rad, chain.psi_rad
    assert u == pytest.approx(np.stack([cos(psi), sin(phi) * sin(psi), -cos(phi) * sin(psi)], axis=1), abs=5e-15)  # (A5)
    size = np.linalg.norm(chain.field_s, axis=1) / strength
    assert size.min() > 1.0 - 1e-12 and size.max() < 2.0 + 1e-12


@pytest.mark.kernels
def test_the_chain_is_our_dipole_on_a_turning_earth():
    position, turn, latitude, line = random_geometries(3000, seed=6)
    chain = field_chain(position, turn, latitude, line, DIPOLE_MOMENT_A_M2)
    scale = np.linalg.norm(chain.field_i, axis=1, keepdims=True)
    pole_i = np.stack([np.cos(latitude) * np.cos(turn), np.cos(latitude) * np.sin(turn), np.sin(latitude)], axis=1)
    ours = np.array(
        [dipoles_kernel(tuple(r), np.zeros((1, 3)), -DIPOLE_MOMENT_A_M2 * p[None]) for r, p in zip(position, pole_i, strict=True)]
    )
    assert np.abs((ours - chain.field_i) / scale).max() < 3e-15
    # x of axes S looks at the star, and S is turned about it.
    star = np.stack([np.cos(line[1]) * np.cos(line[0]), np.cos(line[1]) * np.sin(line[0]), np.sin(line[1])], axis=1)
    assert np.abs((chain.field_s[:, 0] - (chain.field_i * star).sum(axis=1)) / scale[:, 0]).max() < 3e-15
    turned = Rotation.from_euler("ZYX", np.stack([line[0], -line[1], line[2]], axis=1)).inv().apply(chain.field_i)
    assert np.abs((turned - chain.field_s) / scale).max() < 3e-15


@pytest.mark.kernels
def test_a_field_model_that_turns_with_the_earth_gives_the_same_day():
    tilt = np.radians(17.0)
    moment = -DIPOLE_MOMENT_A_M2 * np.array([np.sin(tilt), 0.0, np.cos(tilt)])  # the pole at longitude zero
    params = field_model("centred-dipole", moment_e=moment).at(np.datetime64("1961-05-18"))
    day = field(35.0, step_s=97.0, pole_right_ascension_deg=25.0)
    turn = np.radians(25.0) + EARTH_ROTATION_RATE_RAD_S * day["seconds"].values
    position_e = about_z(turn, day["position_i"].values)
    field_e = np.array([field_kernel(tuple(r), params) for r in position_e])
    difference = about_z(-turn, field_e) - day["field_i"].values
    assert np.abs(difference).max() < 3e-15 * day["magnitude"].values.max()


def test_rotations_turn_the_axes():
    assert about_z(np.pi / 2, [1.0, 0.0, 0.0]) == pytest.approx([0.0, -1.0, 0.0])
    assert about_x(np.pi / 2, [0.0, 1.0, 0.0]) == pytest.approx([0.0, 0.0, -1.0])
    assert about_y(np.pi / 2, [0.0, 0.0, 1.0]) == pytest.approx([-1.0, 0.0, 0.0])
    assert magnetic_angles([7e6, 0.0, 0.0])[0] == 0.0  # over the pole phi is free


AMPLITUDES = {  # line: x, y, z; unit: the field above the pole
    "0": (0.0, -0.337, 0.2422),
    "we": (0.0731, None, 0.103),
    "2n": (0.4114, 0.337, 0.236),
    "2n-we": (0.1995, 0.1634, 0.1144),
    "2n+we": (0.0198, None, None),
}


def test_five_lines_and_nothing_else():
    day = field(35.0)
    found = lines(day)
    for name, row in AMPLITUDES.items():
        for axis, value in zip("xyz", row, strict=True):
            if value is not None:
                assert float(found["amplitude"].sel(line=name, axis=axis)) == pytest.approx(
                    value, abs=5e-4 if value in (0.103,) else 6e-5
                )
    assert float(found["residual"].max()) < 2e-14
    assert float(found["amplitude"].sel(line="2n-we", axis="x")) > 2.0 * float(found["amplitude"].sel(line="we", axis="x"))


@pytest.mark.parametrize(
    ("inclination", "minima", "ratio"), [(0, 27, 1.121), (35, 28, 1.691), (60, 28, 1.961), (90, 28, 1.99997)]
)
def test_minima_and_ratio_in_a_day(inclination, minima, ratio):
    day = field(float(inclination))
    assert day.attrs["minima"] == minima
    assert day.attrs["magnitude_ratio"] == pytest.approx(ratio, abs=6e-6 if inclination == 90 else 5e-4)
    assert day.attrs["magnitude_ratio"] < 2.0


@pytest.mark.parametrize("inclination", range(17, 91, 8))
def test_twenty_eight_minima_from_17_degrees_on(inclination):
    day = field(float(inclination), step_s=30.0)
    assert day.attrs["minima"] == 28
    assert day.attrs["minima"] / (86400.0 / day.attrs["period_s"]) == pytest.approx(1.96, abs=5e-3)


def test_ratio_within_one_orbit():
    day = field(35.0)
    magnitude, orbit = day["magnitude"].values, 606
    ratios = [magnitude[k : k + orbit].max() / magnitude[k : k + orbit].min() for k in range(0, len(magnitude) - orbit, 10)]
    assert (min(ratios), max(ratios)) == pytest.approx((1.14, 1.69), abs=5e-3)
    assert len(minima_of(magnitude[:606])) == 2


@pytest.mark.parametrize(("inclination", "crossings"), [(0, 1.6), (35, 2.8), (90, 3.9)])
def test_how_often_the_line_is_across_the_field(inclination, crossings):
    sky = lost_field(field(float(inclination), step_s=30.0))
    assert float(sky["crossings_per_orbit"].mean()) == pytest.approx(crossings, abs=0.05)
    assert sky["time_fraction"].mean("direction").values == pytest.approx([0.050, 0.010], abs=5e-4)


def test_polar_field_is_not_a_quarter_gauss():
    low, high = field(35.0, duration_s=10.0), field(35.0, 2271e3, duration_s=10.0)
    assert low.attrs["period_s"] == pytest.approx(6050.0, abs=0.5)
    assert low.attrs["polar_field_tesla"] == pytest.approx(4.37e-5, abs=5e-8)
    assert 0.5 * low.attrs["polar_field_tesla"] == pytest.approx(2.18e-5, abs=5e-8)
    assert high.attrs["polar_field_tesla"] == pytest.approx(0.25e-4, abs=5e-9)
    over_pole = field_chain([EARTH_MEAN_RADIUS_M + 805e3, 0.0, 0.0], 0.0, 0.0, (0.0, 0.0, 0.0), DIPOLE_MOMENT_A_M2)
    assert over_pole.field_i == pytest.approx([-low.attrs["polar_field_tesla"], 0.0, 0.0], rel=1e-14)


@pytest.mark.parametrize(
    ("inclination", "values"), [(35, (0.516, 0.735, 0.749)), (0, (0.184, 0.907, 0.909)), (90, (0.510, 0.512, 0.978))]
)
def test_eigenvalues_across_the_field(inclination, values):
    assert across_field_eigenvalues(field(float(inclination))) == pytest.approx(values, abs=5e-4)


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"inclination_deg": 200.0}, "inclination_deg"),
        ({"altitude_m": 805.0}, "altitude_m"),
        ({"tilt_deg": -1.0}, "tilt_deg"),
        ({"step_s": 0.0}, "step_s"),
        ({"step_s": 1e-3}, "longer step"),
        ({"dipole_moment_a_m2": float("nan")}, "dipole_moment_a_m2"),
    ],
)
def test_bad_input_is_named(settings, words):
    with pytest.raises(InputError, match=words):
        field(**settings)
