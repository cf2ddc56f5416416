"""Gravity against closed forms, an evaluation in spherical coordinates, and the motion that it must cause."""

from math import factorial

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import lpmv

from fieldline.constants import EARTH_EQUATORIAL_RADIUS_M, EARTH_GM_M3_S2, EARTH_J2
from fieldline.environment.gravity import (
    gravity_acceleration,
    gravity_kernel,
    gravity_model,
    gravity_potential_kernel,
    harmonic_gravity,
)
from fieldline.errors import InputError

pytestmark = pytest.mark.kernels

MODELS = {
    "point": gravity_model("point"),
    "j2": gravity_model("j2"),
    "harmonic 2": gravity_model("harmonic", 2),
    "harmonic 20": gravity_model("harmonic"),
    "harmonic 70": gravity_model("harmonic", 70),
}
every_model = pytest.mark.parametrize("gravity", MODELS.values(), ids=list(MODELS))
POLE = (0.0, 0.0, 6.8e6)


def places(count=12, radius=6.8e6, seed=1):
    """Random places and the pole, where a formula in angles breaks."""
    rows = np.random.default_rng(seed).standard_normal((count, 3))
    return [POLE, *(tuple(radius * row / np.linalg.norm(row)) for row in rows)]


def differences(function, r_e, step=20.0):
    """Central differences of fourth order of a function of place, one row a component of the place."""
    rows = []
    for axis in np.eye(3):
        near, far = (np.subtract(function(r_e + h * axis), function(r_e - h * axis)) for h in (step, 2 * step))
        rows.append((8.0 * near - far) / (12.0 * step))
    return np.array(rows)


@every_model
def test_acceleration_is_the_potentials_slope(gravity):
    for r_e in places():
        slope = differences(lambda r: gravity_potential_kernel(tuple(r), gravity), np.array(r_e))
        # U = 6e7 rounds to 7e-9, over 20 m: 1e-9 m/s^2.
        assert np.abs(-slope - gravity_kernel(r_e, gravity)).max() < 2e-9


@every_model
def test_laplace(gravity):
    for r_e in places():
        gradient = differences(lambda r: gravity_kernel(tuple(r), gravity), np.array(r_e))
        assert abs(np.trace(gradient)) < 1e-15 * 1e3  # of 2e-6 a second squared, by differences
        assert np.abs(gradient - gradient.T).max() < 1e-12


def test_oblateness_in_closed_form_is_the_harmonic_of_degree_two():
    c = np.zeros((3, 3))
    c[2, 0] = -EARTH_J2 / np.sqrt(5.0)
    harmonic = harmonic_gravity(c, 0.0 * c, EARTH_GM_M3_S2, EARTH_EQUATORIAL_RADIUS_M)
    for r_e in places():
        closed, summed = gravity_kernel(r_e, MODELS["j2"]), gravity_kernel(r_e, harmonic)
        assert np.abs(np.subtract(closed, summed)).max() < 1e-14
        potentials = [gravity_potential_kernel(r_e, g) for g in (MODELS["j2"], harmonic)]
        assert potentials[0] == pytest.approx(potentials[1], rel=1e-15)


def test_the_constants_oblateness_is_the_models():
    c20 = gravity_kernel(POLE, MODELS["harmonic 2"])[2] + MODELS["harmonic 2"].gm / POLE[2] ** 2
    j2 = gravity_kernel(POLE, MODELS["j2"])[2] + EARTH_GM_M3_S2 / POLE[2] ** 2
    assert c20 == pytest.approx(j2, rel=1e-6)  # zero-tide both; tide-free would be 9e-6 off


def test_potential_by_legendre_functions_in_angles():
    """Degrees to 8 with random coefficients, by SciPy's functions (which carry (-1)^m) and the norms written out."""
    degree, gm, radius = 8, 4e14, 6.4e6
    rng = np.random.default_rng(5)
    c, s = rng.standard_normal((2, degree + 1, degree + 1)) * 1e-3
    gravity = harmonic_gravity(c, s, gm, radius)
    for r_e in places()[1:]:
        r = np.linalg.norm(r_e)
        longitude, sine = np.arctan2(r_e[1], r_e[0]), r_e[2] / r
        total = 1.0
        for n in range(2, degree + 1):
            for m in range(n + 1):
                norm = np.sqrt((2 - (m == 0)) * (2 * n + 1) * factorial(n - m) / factorial(n + m))
                wave = c[n, m] * np.cos(m * longitude) + s[n, m] * np.sin(m * longitude)
                total += (radius / r) ** n * norm * (-1) ** m * lpmv(m, n, sine) * wave
        assert gravity_potential_kernel(r_e, gravity) == pytest.approx(-gm / r * total, rel=1e-14)


def test_lower_degrees_are_a_truncation():
    far = (0.0, 3e7, 2e7)
    assert np.allclose(gravity_kernel(far, MODELS["harmonic 20"]), gravity_kernel(far, MODELS["harmonic 70"]), rtol=1e-15)
    near = places()[3]
    assert np.abs(np.subtract(*(gravity_kernel(near, MODELS[name]) for name in ("harmonic 20", "harmonic 70")))).max() > 1e-6


@pytest.mark.parametrize("inclination_deg", [28.5, 63.4, 98.0])
def test_the_node_drifts_as_the_textbook_says(inclination_deg):
    """Secular drift -3 pi J2 (R/p)^2 cos i a revolution, to the first order in J2 (Vallado 2013, equation 9-37)."""
    radius, inclination = 7.0e6, np.radians(inclination_deg)
    speed = np.sqrt(EARTH_GM_M3_S2 / radius)
    start = np.array([radius, 0.0, 0.0, 0.0, speed * np.cos(inclination), speed * np.sin(inclination)])
    revolutions = 8

    def motion(t, y):
        return np.concatenate([y[3:], gravity_kernel(tuple(y[:3]), MODELS["j2"])])

    def rises(t, y):
        return y[2]

    rises.direction = 1.0
    span = (0.0, (revolutions + 0.5) * 2.0 * np.pi * radius / speed)
    found = solve_ivp(motion, span, start, "DOP853", events=rises, rtol=1e-10, atol=1e-3).y_events[0]
    node = np.unwrap(np.arctan2(found[:, 1], found[:, 0]))
    drift = (node[-1] - node[0]) / (len(node) - 1)
    expected = -3.0 * np.pi * EARTH_J2 * (EARTH_EQUATORIAL_RADIUS_M / radius) ** 2 * np.cos(inclination)
    assert len(node) >= revolutions
    assert drift == pytest.approx(expected, rel=5e-3)  # second order in J2


def test_energy_is_conserved_about_an_earth_that_stands_still():
    gravity = MODELS["harmonic 20"]
    start = np.array([6.9e6, 0.0, 0.0, 0.0, 1000.0, 7500.0])
    end = solve_ivp(
        lambda t, y: np.concatenate([y[3:], gravity_kernel(tuple(y[:3]), gravity)]), (0.0, 6e3), start, "DOP853", rtol=1e-12
    ).y[:, -1]

    def energy(y):
        return 0.5 * y[3:] @ y[3:] + gravity_potential_kernel(tuple(y[:3]), gravity)

    assert energy(end) == pytest.approx(energy(start), rel=1e-10)


def test_the_face_takes_any_shape():
    position = np.array(places(5)).reshape(2, 3, 3)
    out = gravity_acceleration(position, "j2")
    assert out.shape == (2, 3, 3)
    assert tuple(out[1, 2]) == gravity_kernel(tuple(position[1, 2]), MODELS["j2"])
    assert np.linalg.norm(gravity_acceleration(POLE)) == pytest.approx(8.6, abs=0.1)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("harmonc",), 'did you mean "harmonic"'),
        (("harmonic", 1), "2 to 70; got 1"),
        (("harmonic", 71), "2 to 70; got 71"),
        (("harmonic", 8.0), r"got 8\.0"),
        (("harmonic", True), "got True"),
        (("j2", 2), '"j2" has no degree'),
    ],
)
def test_errors_say_what_is_meant(arguments, words):
    with pytest.raises(InputError, match=words):
        gravity_model(*arguments)


def test_coefficients_of_another_shape_are_refused():
    with pytest.raises(InputError, match=r"\(N\+1, N\+1\).*\(3, 4\)"):
        harmonic_gravity(np.zeros((3, 4)), np.zeros((3, 4)), 4e14, 6.4e6)
    with pytest.raises(InputError, match="kilometres"):
        gravity_acceleration([7000.0, 0.0, 0.0])
