"""Current of a bare line: closed forms of Sanmartin, Martinez-Sanchez and Ahedo (1993), and SciPy's boundary-value solver.

The theory's own units: length L* and current E / R' such that, where no ions are collected,
    di/dx = (3/4) sqrt(phi),   dphi/dx = i - 1,   i^2 - 2 i = phi^1.5 - phi_A^1.5
"""

import numpy as np
import pytest
from scipy.integrate import quad, solve_bvp
from scipy.optimize import brentq

from fieldline.constants import ATOMIC_MASS_KG, ELECTRON_MASS_KG
from fieldline.dynamics.lines.bare import bare_currents, bare_work, gathering

pytestmark = pytest.mark.kernels

FIELD, DENSITY = 0.15, 3e11  # [V/m], [1/m^3]
DIAMETER, RESISTANCE = 2.0 * 0.025 / np.pi, 2.82e-8 / (0.025 * 5e-5)  # a tape of aluminium, 25 mm by 50 micrometres
NO_IONS = 1e30  # [u]


def flown(length, segments=8, *, resistance=RESISTANCE, cathode_at_b=True, drop=0.0, load=0.0, thermal=1e-4, ion=16.0, emf=None):
    """(mean currents, load's power, cathode's power, V and I at the cells' ends) of a uniform line."""
    along = np.full(segments, FIELD * length / segments) if emf is None else np.array(emf)
    out, work = np.empty(segments), bare_work(segments)
    gather = np.full(segments, gathering(DIAMETER, DENSITY) * length / segments)
    ohm = np.full(segments, resistance * length / segments)
    powers = bare_currents(-along if cathode_at_b else along, ohm, gather, cathode_at_b, drop, load, thermal, ion, work, out)
    cells = segments * -(-64 // segments)
    return out, *powers, work[0][0, : cells + 1].copy(), work[0][1, : cells + 1].copy()


def natural_length(resistance=RESISTANCE):
    """L* [m], from  g sqrt(E L*) L* = (3/4) E / R'."""
    return (0.75 * FIELD**0.5 / (resistance * gathering(DIAMETER, DENSITY))) ** (2.0 / 3.0)


def test_a_short_line_takes_what_the_field_alone_asks():
    length = 0.01 * natural_length()
    out, *_, current = flown(length, 4)
    exact = gathering(DIAMETER, DENSITY) * (2.0 / 3.0) * np.sqrt(FIELD) * length**1.5
    assert current[-1] == pytest.approx(exact, rel=2e-3)  # ohmic part: order of L / L*
    share = np.linspace(0.0, 1.0, 5)
    integral = exact * (share + 0.4 * (1.0 - share) ** 2.5)
    assert -out == pytest.approx(np.diff(integral) * 4, rel=3e-3)
    assert -out.mean() / current[-1] == pytest.approx(0.6, abs=1e-3)


@pytest.mark.parametrize("ratio", [0.3, 1.0, 2.5, 3.9])
def test_the_anodic_line_of_the_closed_form(ratio):
    """phi_A from  x = integral of dphi / (1 - i),  1 - i = sqrt(1 - phi_A^1.5 + phi^1.5), over the line's length."""

    def reached(top):
        return quad(lambda phi: 1.0 / np.sqrt(1.0 - top**1.5 + phi**1.5), 0.0, top, epsabs=1e-12)[0]

    top = float(brentq(lambda top: reached(top) - ratio, 1e-6, 1.0 - 1e-13, xtol=1e-15))  # pyright: ignore
    exact = FIELD / RESISTANCE * (1.0 - np.sqrt(1.0 - top**1.5))
    length = ratio * natural_length()
    _, _, _, potential, current = flown(length, 16, ion=NO_IONS)
    assert current[-1] == pytest.approx(exact, rel=2e-4)
    assert potential[0] == pytest.approx(top * FIELD * natural_length(), rel=1e-3)


def test_a_long_line_carries_the_field_over_its_resistance():
    """Beyond 4 L* current and potential stay at E / R' and zero; near the anode the rise is that of the limit phi_A = 1."""
    star = natural_length()
    for ratio in (8.0, 40.0):
        _, _, _, potential, current = flown(ratio * star, 32, ion=NO_IONS)
        x = np.linspace(0.0, ratio, current.size)
        assert current[x > 4.5] == pytest.approx(FIELD / RESISTANCE, rel=1e-3)
        assert np.abs(potential[x > 4.5]).max() < 1e-3 * FIELD * star
        assert potential[0] == pytest.approx(FIELD * star, rel=2e-2 if ratio > 10.0 else 2e-3)


def reference(length, drop, load, thermal, ion):
    """I at 2,001 places from the anode by SciPy's collocation, on a mesh of its own."""
    whole, most = FIELD * length, gathering(DIAMETER, DENSITY) * length * np.sqrt(FIELD * length)
    ions = np.sqrt(ELECTRON_MASS_KG / (ion * ATOMIC_MASS_KG))

    def rates(_, y):
        v = y[0] * whole
        law = v / (v * v + thermal * thermal) ** 0.25
        law = np.where(v > 0.0, law, ions * law)
        gathered = gathering(DIAMETER, DENSITY) * length * law / most
        return np.vstack([RESISTANCE * y[1] * most * length / whole - 1.0, gathered])

    def ends(a, b):
        return np.array([a[1], b[0] + (drop + load * b[1] * most) / whole])

    x = 1.0 - (1.0 - np.linspace(0.0, 1.0, 300)) ** 2
    found = solve_bvp(rates, ends, x, np.vstack([0.8 * (1.0 - x), 0.1 * x]), tol=1e-6, max_nodes=100_000)
    assert found.status == 0
    return found.sol(np.linspace(0.0, 1.0, 2001))[1] * most


@pytest.mark.parametrize(
    ("length", "drop", "load"), [(500.0, 0.0, 0.0), (500.0, 20.0, 20.0), (500.0, 0.0, 300.0), (5000.0, 30.0, 100.0)]
)
def test_ions_drop_and_load_against_a_boundary_value_solver(length, drop, load):
    out, load_w, drop_w, _, current = flown(length, 10, drop=drop, load=load, thermal=0.1)
    exact = reference(length, drop, load, 0.1, 16.0)
    means = [np.trapezoid(exact[200 * k : 200 * k + 201], dx=1.0 / 200.0) for k in range(10)]
    assert -out == pytest.approx(means, abs=1e-3 * exact.max())
    assert current[-1] == pytest.approx(exact[-1], rel=5e-4)
    assert load_w == pytest.approx(load * exact[-1] ** 2, rel=1e-3)
    assert drop_w == pytest.approx(drop * exact[-1], rel=1e-3)


def test_energy_of_the_circuit():
    """emf I = ohmic + load + cathode + what the gathered charges bring to the line, over the cells' own numbers."""
    length, segments = 3000.0, 12
    out, load_w, drop_w, potential, current = flown(length, segments, drop=20.0, load=50.0, thermal=0.1)
    made = FIELD * length * -out.mean()
    middle = 0.5 * (current[1:] + current[:-1])
    ohmic = np.sum(middle**2) * RESISTANCE * length / middle.size
    brought = np.sum(0.5 * (potential[1:] + potential[:-1]) * np.diff(current))
    assert made == pytest.approx(ohmic + load_w + drop_w + brought, rel=1e-9)


def test_the_cathode_at_the_other_end_is_the_mirror_image():
    one = flown(800.0, 5, drop=5.0, load=10.0)[0]
    other = flown(800.0, 5, drop=5.0, load=10.0, cathode_at_b=False)[0]
    assert other == pytest.approx(-one[::-1], rel=1e-12)
    assert one.max() < 0.0 < other.min()


@pytest.mark.parametrize("emf", [[-1.0, -2.0, 1.0], [3.0, 4.0, 5.0], [0.0, 0.0, 0.0]])
def test_no_current_against_the_cathode_or_below_what_it_needs(emf):
    out, load_w, drop_w, *_ = flown(30.0, 3, drop=13.0, emf=emf)
    assert not out.any() and (load_w, drop_w) == (0.0, 0.0)


def test_converges_for_any_line():
    """The residual of the equations is small wherever Newton's method starts from nothing: 150 random lines."""
    rng = np.random.default_rng(5)
    for _ in range(150):
        segments = int(rng.integers(1, 40))
        length = 10.0 ** rng.uniform(1.0, 4.5)
        emf = FIELD * length / segments * rng.uniform(-0.3, 2.0, segments)
        resistance = 10.0 ** rng.uniform(-3.0, 2.0)
        out, *_, potential, current = flown(
            length, segments, resistance=resistance, drop=rng.uniform(0.0, 30.0), load=10.0 ** rng.uniform(-1.0, 4.0),
            thermal=0.1, emf=emf,
        )  # fmt: skip
        assert np.isfinite(out).all()
        if not out.any():
            continue
        each = (current.size - 1) // segments
        drive = np.repeat(emf, each) / each
        ohm = resistance * length / (segments * each)
        middle = 0.5 * (current[1:] + current[:-1])
        assert np.abs(np.diff(potential) - ohm * middle + drive).max() < 1e-6 * abs(emf).sum()
        assert current[0] == pytest.approx(0.0, abs=1e-6 * current.max())
