"""The steppers against closed forms: orders as measured, a free body by Jacobi's functions, outputs between steps."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation
from scipy.special import ellipj, ellipk

import plant_flights as pf

MOMENTS = (1.0, 1.7, 2.2)
OMEGA = np.radians((4.0, -3.0, 2.5))
SECONDS = 200.0


def spinner(**integrator):
    """A free asymmetric body about its principal axes, far from everything that turns it."""
    record = pf.body(inertia_kg_m2=MOMENTS, rate_deg_s=tuple(np.degrees(OMEGA)))
    return pf.flown(record, seconds=SECONDS, output=SECONDS, integrator=integrator)


def jacobi(times):
    """(n, 3) rates [rad/s] of the free asymmetric body: dn about the axis that the motion encloses, sn about the middle one.

    Landau and Lifshitz, Mechanics, s. 37. The phase is that at which the motion passes through OMEGA.
    """
    one, two, three = MOMENTS
    energy2, square = np.dot(MOMENTS, OMEGA**2), np.dot(np.square(MOMENTS), OMEGA**2)
    if square > energy2 * two:  # about the largest moment
        first, third = 0, 2
        a, c = one, three
    else:
        first, third = 2, 0
        a, c = three, one
    # sizes of the rates about the enclosing axis c, the middle one and the other
    size_a = np.sqrt((energy2 * c - square) / (a * (c - a)))
    size_m = np.sqrt((energy2 * c - square) / (two * (c - two)))
    size_c = np.sqrt((square - energy2 * a) / (c * (c - a)))
    speed = (
        np.sqrt((c - two) * (square - energy2 * a) / (one * two * three))
        if c > two
        else np.sqrt((two - c) * (energy2 * a - square) / (one * two * three))
    )
    k2 = (two - a) * (energy2 * c - square) / ((c - two) * (square - energy2 * a))

    def shape(u):
        sn, cn, dn, _ = ellipj(u, k2)
        rate = np.empty((*np.shape(u), 3))
        rate[..., first], rate[..., 1], rate[..., third] = size_a * cn, size_m * sn, size_c * dn
        return rate

    period = 4.0 * ellipk(k2)
    for flip_first, flip_middle, flip_third in np.ndindex(2, 2, 2):
        sign = np.ones(3)
        sign[first], sign[1], sign[third] = 1 - 2 * flip_first, 1 - 2 * flip_middle, 1 - 2 * flip_third
        # Euler's equation at one place tells whether this choice of signs moves on or back
        u, h = 0.3, 1e-6
        slope = sign * (shape(u + h) - shape(u - h)) / (2 * h) * speed
        w = sign * shape(u)
        if not np.allclose(slope, -np.cross(w, np.multiply(MOMENTS, w)) / MOMENTS, atol=1e-7):
            continue
        if np.sign(OMEGA[third]) != sign[third]:
            continue
        starts = np.linspace(0.0, period, 4001)
        near = starts[np.argmin(np.linalg.norm(sign * shape(starts) - OMEGA, axis=1))]
        gap = period / 2000

        def miss(u, sign=sign, h=h):
            return (sign * shape(u) - OMEGA) @ (sign * (shape(u + h) - shape(u - h)))

        phase = brentq(miss, near - gap, near + gap, xtol=1e-15)
        if np.linalg.norm(sign * shape(phase) - OMEGA) < 1e-9:
            return sign * shape(phase + speed * times)
    raise AssertionError("no branch passes through the start")


@pytest.mark.parametrize(
    "integrator", [{"step_s": 0.25}, {"method": "dop853", "relative_tolerance": 1e-12}], ids=["rk4", "dop853"]
)
def test_a_free_asymmetric_body_follows_jacobis_functions(integrator):
    record = pf.body(inertia_kg_m2=MOMENTS, rate_deg_s=tuple(np.degrees(OMEGA)))
    seconds, states = pf.rows(pf.flown(record, seconds=SECONDS, output=2.0, integrator=integrator))
    assert np.abs(states[:, 0, 10:13] - jacobi(seconds)).max() < 1e-8


def test_the_momentum_of_a_free_body_stays_where_it_points():
    """And with the rates right, attitude is right but for the turn about the momentum, which the axisymmetric body tells."""
    record = pf.body(inertia_kg_m2=MOMENTS, rate_deg_s=tuple(np.degrees(OMEGA)))
    flight = pf.flown(record, seconds=SECONDS, output=2.0, integrator={"step_s": 0.25})
    momentum = pf.spin_momentum(flight, pf.rows(flight)[1])
    assert np.abs(momentum - momentum[0]).max() < 1e-8 * np.linalg.norm(momentum[0])


@pytest.mark.parametrize("integrator, error", [({"step_s": 0.25}, 1e-8), ({"method": "dop853"}, 1e-7)], ids=["rk4", "dop853"])
def test_an_axisymmetric_body_turns_about_its_momentum_and_its_axis(integrator, error):
    """q(t) = q0 exp(I w0 t / 2 A) exp((1 - C/A) w3 t / 2 about the axis): two turns at constant rates."""
    a, c = 1.0, 1.6
    record = pf.body(inertia_kg_m2=(a, a, c), rate_deg_s=tuple(np.degrees(OMEGA)))
    seconds, states = pf.rows(pf.flown(record, seconds=SECONDS, output=5.0, integrator=integrator))
    start = Rotation.from_quat(states[0, 0, 6:10])
    about_momentum = Rotation.from_rotvec(np.outer(seconds, np.array([a, a, c]) * OMEGA / a))
    about_axis = Rotation.from_rotvec(np.outer(seconds, [0.0, 0.0, (1.0 - c / a) * OMEGA[2]]))
    exact = start * about_momentum * about_axis
    assert pf.angle_between(states[:, 0, 6:10], exact.as_quat()).max() < error


@pytest.mark.parametrize("method, step", [("rk4", 1.0), ("rk4", 4.5), ("dop853", 1.0)])
def test_a_constant_rate_is_exact_however_long_the_step(method, step):
    """6 deg/s: 27 deg in a step of 4.5 s; DOP853 makes steps of several turns."""
    record = pf.body(inertia_kg_m2=(1.0, 1.5, 2.0), rate_deg_s=(0.0, 6.0, 0.0), attitude={"quaternion_bi": (0.0, 0.0, 0.0, 1.0)})
    seconds, states = pf.rows(pf.flown(record, seconds=900.0, output=90.0, integrator={"method": method, "step_s": step}))
    exact = Rotation.from_rotvec(np.outer(seconds, [0.0, np.radians(6.0), 0.0]))
    assert pf.angle_between(states[:, 0, 6:10], exact.as_quat()).max() < 5e-13
    assert np.abs(np.linalg.norm(states[:, 0, 6:10], axis=1) - 1.0).max() < 4e-16


def end_error(exact, **integrator):
    """(metres, radians, rad/s) by which a flight misses an end; everything at once in it."""
    *_, last = pf.rows(whole_flight(**integrator))[1]
    return (
        np.linalg.norm(last[0, :3] - exact[0, :3]),
        pf.angle_between(last[:1, 6:10], exact[:1, 6:10])[0],
        np.linalg.norm(last[0, 10:13] - exact[0, 10:13]),
    )


def whole_flight(**integrator):
    """Loads of every smooth kind, so that the order is that of the whole right-hand side."""
    record = pf.body(
        residual_dipole_a_m2=(2.0, -1.0, 3.0), gravity_gradient=True, eddy_damping_n_m_s_tesla2=(1e3, 2e3, 1e3),
        drag={"area_m2": 50.0, "center_of_pressure_b_m": (0.1, 0.0, 0.2)},
        wheel=[{"axis_b": (0, 0, 1), "momentum_n_m_s": 0.05, "momentum_max_n_m_s": 1.0, "torque_max_n_m": 1.0}],
    )  # fmt: skip
    air = {"model": "exponential", "reference_density_kg_m3": 2.5e-10, "reference_altitude_km": 200.0, "scale_height_km": 60.0}
    environment = {"gravity": "j2", "field_degree": 2, "atmosphere": air}
    return pf.flown(record, seconds=600.0, environment=environment, integrator=integrator)


TIGHT = {
    "method": "dop853",
    "relative_tolerance": 1e-14,
    "position_tolerance_m": 1e-7,
    "velocity_tolerance_m_s": 1e-10,
    "angle_tolerance_rad": 1e-13,
    "rate_tolerance_rad_s": 1e-14,
}


def test_rk4_is_of_fourth_order():
    exact = pf.rows(whole_flight(**TIGHT))[1][-1]
    order = np.log2(np.divide(end_error(exact, step_s=1.0), end_error(exact, step_s=0.5)))
    assert np.all(np.abs(order[1:] - 4.0) < 0.3), order  # the orbit's error is rounding at such steps: see the next test


def test_rk4_on_an_orbit_is_of_fourth_order():
    point = pf.body(kind="point")
    exact = pf.rows(pf.flown(point, seconds=6000.0, integrator=TIGHT))[1][-1, 0, :3]
    misses = [
        np.linalg.norm(pf.rows(pf.flown(point, seconds=6000.0, integrator={"step_s": step}))[1][-1, 0, :3] - exact)
        for step in (30.0, 15.0)
    ]
    assert abs(np.log2(misses[0] / misses[1]) - 4.0) < 0.15


def test_dop853_is_of_eighth_order():
    """Against the tolerance, on which the step depends by the eighth root: the step's order, from steps taken and errors made."""
    exact = pf.rows(whole_flight(**TIGHT))[1][-1]
    errors, steps = [], []
    for tolerance in (1e-6, 1e-9, 1e-12):
        allowed = {"position_tolerance_m": 1e6, "velocity_tolerance_m_s": 1e3}  # the orbit shall not choose the step
        flight = whole_flight(
            method="dop853",
            relative_tolerance=1e-14,
            angle_tolerance_rad=tolerance,
            rate_tolerance_rad_s=0.1 * tolerance,
            **allowed,
        )
        last = pf.rows(flight)[1][-1]
        errors.append(pf.angle_between(last[:1, 6:10], exact[:1, 6:10])[0])
        steps.append(flight.clock.steps[0])
    orders = -np.diff(np.log(errors)) / np.diff(np.log(steps))
    assert np.all(orders > 6.5) and np.all(orders < 10.5), (orders, errors, steps)


@pytest.mark.parametrize("method, error", [("rk4", 2e-6), ("dop853", 1e-7)])
def test_outputs_between_steps_are_the_motion(method, error):
    """DOP853 interpolates its outputs, RK4 steps to them: both agree with a fine flight at odd times."""
    record = pf.body(residual_dipole_a_m2=(2.0, -1.0, 3.0))
    fine = pf.rows(pf.flown(record, seconds=300.0, output=0.7, integrator=TIGHT | {"step_max_s": 0.7}))
    seconds, states = pf.rows(pf.flown(record, seconds=300.0, output=0.7, integrator={"method": method, "step_s": 1.0}))
    assert np.array_equal(seconds, fine[0])
    assert np.allclose(seconds, 0.7 * np.arange(len(seconds)), atol=1e-9)
    assert pf.angle_between(states[:, 0, 6:10], fine[1][:, 0, 6:10]).max() < error
    assert np.abs(states[:, 0, :3] - fine[1][:, 0, :3]).max() < 1e-5


def quaternion_rk4(q, omega, step, count, inertia):
    """The usual way: four components of q as plain numbers, made a unit quaternion after each step."""
    inverse = np.linalg.inv(inertia)

    def rate(s):
        v, w, o = s[:3], s[3], s[4:]
        turn = [*(0.5 * (w * o + np.cross(v, o))), -0.5 * v @ o]
        return np.array([*turn, *(inverse @ -np.cross(o, inertia @ o))])

    s = np.array([*q, *omega])
    for _ in range(count):
        k1 = rate(s)
        k2 = rate(s + 0.5 * step * k1)
        k3 = rate(s + 0.5 * step * k2)
        k4 = rate(s + step * k3)
        s = s + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        s[:4] /= np.linalg.norm(s[:4])
    return s


@pytest.mark.parametrize("nutation", [0.02, 0.5])
def test_the_step_on_the_manifold_earns_its_place(nutation):
    """A spinner of 10 deg/s, ten minutes in steps of 1 s: tens of times nearer the truth than quaternions as plain numbers."""
    rate = np.radians(10.0) * np.array([np.sin(nutation), 0.0, np.cos(nutation)])
    inertia = np.diag([1.0, 1.1, 1.4])
    record = pf.body(inertia_kg_m2=(1.0, 1.1, 1.4), rate_deg_s=tuple(np.degrees(rate)))
    flight = pf.flown(record, seconds=600.0, integrator={"step_s": 1.0})
    start, end = flight.start, pf.rows(flight)[1][-1:, 0]
    exact = pf.rows(pf.flown(record, seconds=600.0, integrator=TIGHT))[1][-1:, 0]
    plain = quaternion_rk4(start[6:10], start[10:13], 1.0, 600, inertia)
    ours = pf.angle_between(end[:, 6:10], exact[:, 6:10])[0]
    theirs = pf.angle_between(plain[None, :4], exact[:, 6:10])[0]
    assert theirs > (30.0 if nutation > 0.1 else 300.0) * ours, (ours, theirs)


def test_the_tight_flight_is_scipys():
    """The reference of the tests above is not only our own: SciPy's DOP853 on Euler's equation and the quaternion."""
    record = pf.body(inertia_kg_m2=pf.INERTIA)
    flight = pf.flown(record, seconds=300.0, integrator=TIGHT)
    inertia = np.array(pf.INERTIA)

    def rate(_, s):
        v, w, o = s[:3], s[3], s[4:]
        return [*(0.5 * (w * o + np.cross(v, o))), -0.5 * v @ o, *np.linalg.solve(inertia, -np.cross(o, inertia @ o))]

    told = solve_ivp(rate, (0.0, 300.0), flight.start[6:13], "DOP853", rtol=1e-13, atol=1e-15).y[:, -1]
    last = pf.rows(flight)[1][-1:, 0]
    assert pf.angle_between(last[:, 6:10], told[None, :4])[0] < 1e-11
    assert np.abs(last[0, 10:13] - told[4:]).max() < 1e-13
