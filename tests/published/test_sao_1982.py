"""Smithsonian Astrophysical Observatory (1982), NASA-CR-170721, section 2: numbers of the report, and where they are wrong.

The numbers beside the report's are of an independent re-derivation; the report's slips are listed in
docs/theory/spinning_subsatellite.md.
"""

import numpy as np
import pytest

from fieldline.analysis.spinning_subsatellite import (
    SpinningSubsatellite,
    characteristic_coefficients,
    critical_angle,
    first_order_angles,
    four_angle_margin,
    spin_for_angle,
    stationary_angles,
)
from fieldline.analysis.spinning_subsatellite.stability import frequencies, squared_exponents
from fieldline.cases.sao_1982 import PRINTED_SPIN_RAD_S, report_body, stability, stability_chart, stationary
from fieldline.cases.sao_1982.dumbbell import dumbbell, natural_length
from fieldline.errors import InputError

EXAMPLE = SpinningSubsatellite(  # of (21): 0.5 m and 0.3 m radii of gyration, 10 km of tether, all over the mass
    axial_inertia_kg_m2=0.25, transverse_inertia_kg_m2=0.09, tension_n=2.7 / 67.0, offset_m=0.1, orbital_rate_rad_s=1e-3
)
ARCSECOND = np.pi / 648000.0


def test_rate_and_tension_of_the_test_case():
    """Printed: n = 1.178021398e-3 rad/s, F = 0.8342029979e6 dyn."""
    two = dumbbell(100.0, 86363.0, 6578e3, 6598e3, 3.986013e14)
    assert two.orbital_rate_rad_s == pytest.approx(1.178021398e-3, abs=5e-13)
    assert two.orbital_rate_rad_s == pytest.approx(1.17802139839214e-3, rel=1e-14)
    assert two.tension_n == pytest.approx(8.34202997894832, rel=1e-14)
    assert two.tension_n == pytest.approx(8.342029979, abs=5e-10)
    assert two.mean_radius_m == pytest.approx(6597976.7984, abs=1e-4)
    assert 3.0 * two.orbital_rate_rad_s**2 * 20e3 * two.reduced_mass_kg == pytest.approx(8.3167765, abs=1e-6)  # (1): 0.3 % low


def test_printed_spin_is_the_hanging_rate_about_the_axis():
    """Printed: r = 0.04919339283 rad/s at 20 deg; for C = 2 A it is the inverted branch's phi' too."""
    body = report_body(orbital_rate_rad_s=1.178021398e-3, tension_n=8.342029979)
    theta = np.radians(20.0)
    about_axis = spin_for_angle(body, theta) + body.orbital_rate_rad_s * np.cos(theta)
    assert about_axis == pytest.approx(-PRINTED_SPIN_RAD_S, abs=5e-12)
    assert about_axis == pytest.approx(0.049193392829679, abs=2e-14)
    unrounded = dumbbell(100.0, 86363.0, 6578e3, 6598e3, 3.986013e14)
    exact = report_body(orbital_rate_rad_s=unrounded.orbital_rate_rad_s, tension_n=unrounded.tension_n)
    assert spin_for_angle(exact, theta) + exact.orbital_rate_rad_s * np.cos(theta) == pytest.approx(0.049193392813371, abs=2e-14)
    assert spin_for_angle(body, -theta) == pytest.approx(PRINTED_SPIN_RAD_S, abs=5e-12)
    other = report_body(axial_inertia_kg_m2=1.5e5)
    assert spin_for_angle(other, -theta) != pytest.approx(-spin_for_angle(other, theta) - 1e-3 * np.cos(theta), rel=1e-3)


@pytest.mark.parametrize(
    ("spin", "tangent", "angle_deg", "corrections"),
    [
        (0.1, 161.19, 89 + 38.67 / 60, (-0.0508, 0.0508)),
        (0.01, 1611.9, 89 + 57.87 / 60, (-0.0051, 0.0051)),
        (1.0, 16.12, 86 + 27.0 / 60, (-0.505, 0.505)),
    ],
)
def test_the_example_of_21(spin, tangent, angle_deg, corrections):
    """tan theta0 = F d / (C phi' n); the report prints 89 deg 43' for 0.1 rad/s and tan = 10 for 0.01."""
    found = stationary_angles(EXAMPLE, spin)
    beta = np.arctan2(EXAMPLE.stiffness_n_m, 0.25 * spin * 1e-3)
    assert np.tan(beta) == pytest.approx(tangent, rel=1e-4 if tangent > 20 else 1e-3)
    assert np.degrees(found) == pytest.approx([angle_deg, angle_deg + 180.0], abs=1.5e-2 / 60)
    away = (found - [beta, beta + np.pi]) / ARCSECOND
    assert away == pytest.approx(corrections, abs=6e-4)
    assert first_order_angles(EXAMPLE, spin) == pytest.approx(found, abs=1e-12)


def test_size_of_q():
    assert np.hypot(0.25 * 0.01 * 1e-3, EXAMPLE.stiffness_n_m) / 1e-6 == pytest.approx(4029.9, abs=0.05)


def test_four_angles_where_the_report_has_two():
    slow = stationary([1e-5, 1e-4, 1e-2], offset_m=1e-3)
    assert list(slow["number"].values) == [4, 4, 2]
    assert four_angle_margin(report_body(offset_m=1e-3), 1e-4) > 0.0 > four_angle_margin(report_body(offset_m=1e-3), 1e-2)
    assert (stationary()["number"].values == 2).all()  # the report's own body is far outside the astroid


@pytest.mark.parametrize(
    ("theta_deg", "mu", "periods_s"),
    [(20.0, (-6839.717, -1.130595), (64.492, 5016.18)), (200.0, (-6798.594, -1.134409), (64.687, 5007.74))],
)
def test_exponents_of_the_test_case(theta_deg, mu, periods_s):
    body, theta = report_body(), np.radians(theta_deg)
    assert body.kappa == pytest.approx(30.056291, abs=5e-7)
    assert squared_exponents(body.kappa, theta) == pytest.approx(mu, abs=6e-4)
    assert 2.0 * np.pi / frequencies(body, theta) == pytest.approx(periods_s, abs=6e-3)


def test_middle_coefficient_of_43_at_the_second_branch():
    """What is left of p1 where A n^2 is small: -257.1 as printed, 813.5 right, over A^2 n^4."""
    kappa, theta = 30.056291, np.radians(200.0)
    sine, cosine = np.sin(theta), np.cos(theta)
    rest = 1.0 + sine**2 - 3.0 * cosine**2
    printed = sine * (kappa**2 * cosine**2 + kappa * rest)
    right = kappa**2 * cosine**2 + kappa * sine * rest
    assert (printed, right) == pytest.approx((-257.1, 813.5), abs=0.05)
    _, p1, _ = characteristic_coefficients(kappa, theta)
    assert float(p1) * sine == pytest.approx(right, rel=0.03)


@pytest.mark.parametrize(
    ("kappa", "angle_deg"), [(1, 205.83), (3, 221.38), (10, 238.08), (30.056291, 250.0857), (100, 258.72), (1000, 266.38)]
)
def test_critical_angles(kappa, angle_deg):
    assert np.degrees(critical_angle(kappa)) == pytest.approx(angle_deg, abs=5e-3 if kappa != 30.056291 else 5e-5)


def test_spin_at_the_critical_angle():
    """r0 = 6.21293e-3 rad/s, beside 6.45834e-3 of a sleeping top."""
    body = report_body()
    theta = critical_angle(body.kappa)
    about_axis = spin_for_angle(body, theta) + body.orbital_rate_rad_s * np.cos(theta)
    assert about_axis == pytest.approx(6.21293e-3, abs=5e-9)
    top = 2.0 * np.sqrt(body.transverse_inertia_kg_m2 * body.stiffness_n_m) / body.axial_inertia_kg_m2
    assert top == pytest.approx(6.45834e-3, abs=5e-9)


GROWTH = {  # theta0 [deg]: linear growth over n
    20: 0.0, 200: 0.0, 45: 0.0, 225: 0.0, 60: 0.0, 240: 0.0, 75: 0.0, 255: 3.657099, 80: 0.0, 260: 4.748010, 85: 0.0,
    265: 5.275192, 95: 0.0, 275: 5.275192, 160: 0.0, 340: 0.0,
}  # fmt: skip


def test_the_whole_motion_agrees_on_both_sides_of_the_boundary():
    """A push of 1e-4 rad over 20 orbits: stays within 1.5e-4, or ends 2 to 3.2 rad away."""
    found = stability(list(GROWTH), orbits=20.0)
    growth = found["growth"].values / found.attrs["orbital_rate_rad_s"]
    assert growth == pytest.approx(list(GROWTH.values()), abs=1e-6)
    stays = growth == 0.0
    away = found["away"].values
    assert (away[stays] < 1.5e-4).all() and (away[stays] > 0.9e-4).all()
    assert ((away[~stays] > 2.0) & (away[~stays] < 3.2)).all()
    assert found["axial_drift"].values.max() < 5e-8 and found["jacobi_drift"].values.max() < 5e-8
    assert list(found["kind"].values[stays]) == ["minimum", "gyroscopic"] * 3 + ["minimum"] * 5 + ["gyroscopic"]


def test_the_chart_is_bounded_by_the_critical_spin():
    chart = stability_chart(np.geomspace(1e-3, 0.2, 15), np.geomspace(0.02, 2.0, 9))
    upper = chart["kind"].values == "gyroscopic"
    for j in range(9):
        fast = chart["spin"].values > float(chart["critical_spin"][j])
        assert np.array_equal(upper[:, j].any(axis=1), fast)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: stationary(axial_inertia_kg_m2=-3.0), "axial_inertia_kg_m2"),
        (lambda: stability([180.0]), "multiple of 180"),
        (lambda: stability([]), "list"),
        (lambda: stability("steep"), "theta_deg must be a number or a list .*steep"),
        (lambda: stationary("fast"), "spin_rad_s must be a number or a list .*fast"),
        (lambda: stability_chart(spin_rad_s="fast"), "spin_rad_s must be"),
        (lambda: stability_chart(offset_m=[-1.0, 1.0]), "offset_m must be above zero"),
        (lambda: stability(orbits=-1.0), "orbits"),
        (lambda: dumbbell(1.0, 1.0, 7e6, 6e6, 4e14), "above lower_radius_m"),
        (lambda: natural_length(1e4, 8.0, 0.0), "stiffness_n"),
    ],
)
def test_refusals(call, words):
    with pytest.raises(InputError, match=words):
        call()
