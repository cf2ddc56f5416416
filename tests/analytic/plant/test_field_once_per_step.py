"""The field once per step: what the option leaves out, measured against the field at every stage."""

import numpy as np
import pytest

import fieldline as fl
import plant_flights as pf
from plant_flights import torquers

SMALL = {"inertia_kg_m2": (0.036, 0.036, 0.0067), "mass_kg": 4.0, "residual_dipole_a_m2": (0.005, -0.003, 0.005)}
OVER_THE_POLES = {
    "orbit": {"elements": {"altitude_km": 500.0, "inclination_deg": 97.4}},
    "environment": {"gravity": "j2"},
}


def tumbler(update, step, seconds, rate=2.0, **more):
    """A 3U CubeSat with a residual dipole, tumbling freely."""
    record = pf.body(rate_deg_s=(rate, -rate, rate), gravity_gradient=True, **SMALL, **more)
    integrator = {"step_s": step, "field_update": update}
    return pf.flown(record, seconds=seconds, output=seconds / 20, integrator=integrator, **OVER_THE_POLES)


def detumbler(update, step, seconds):
    """The same under B-dot."""
    record = pf.body(
        rate_deg_s=(5.0, -5.0, 5.0), magnetorquer=torquers(moment_max_a_m2=0.2), magnetometer={"rate_hz": 10.0},
        duty_cycle={"period_s": 2.0, "torque_on_s": 1.4}, gravity_gradient=True, **SMALL,
    )  # fmt: skip
    software = [{"law": "b-dot", "rate_hz": 0.5, "phase_s": 2.0}]
    integrator = {"step_s": step, "field_update": update}
    return pf.flown(
        record,
        seconds=seconds,
        output=seconds / 20,
        integrator=integrator,
        **OVER_THE_POLES,
        software=software,
    )


def apart(one, other):
    """Largest angle between two flights' attitudes [rad], and of their rates [rad/s]."""
    (_, a), (_, b) = pf.rows(one), pf.rows(other)
    angle = pf.angle_between(a[:, 0, 6:10], b[:, 0, 6:10])
    return angle.max(), np.linalg.norm(a[:, 0, 10:13] - b[:, 0, 10:13], axis=1).max()


def test_the_error_goes_with_the_square_of_the_step():
    """The field is that of the middle of the step: half the step, a quarter of the error."""
    errors = [apart(tumbler("step", step, 2000.0), tumbler("stage", step, 2000.0))[0] for step in (2.0, 1.0)]
    assert 3.5 < errors[0] / errors[1] < 4.5
    assert errors[1] < 1e-6


def test_an_adaptive_step_that_could_not_see_it_is_refused():
    with pytest.raises(fl.InputError, match='field_update must be "stage" where the step is adaptive'):
        pf.scenario(integrator={"method": "dop853", "field_update": "step"})


def test_orbits_do_not_know_of_it():
    one, other = tumbler("step", 1.0, 500.0), tumbler("stage", 1.0, 500.0)
    assert np.array_equal(pf.rows(one)[1][:, 0, :6], pf.rows(other)[1][:, 0, :6])


@pytest.mark.slow
def test_over_a_day_a_tumbler_keeps_its_attitude_to_a_hundredth_of_a_degree():
    angle, _ = apart(tumbler("step", 1.0, 86400.0), tumbler("stage", 1.0, 86400.0))
    assert angle < np.radians(0.01)


@pytest.mark.slow
def test_b_dot_ends_at_the_same_rate():
    """Four hours and a half: later a body at rest in the field forgets its start, however it is integrated."""
    one, other = detumbler("step", 0.5, 16000.0), detumbler("stage", 0.5, 16000.0)
    angle, rate = apart(one, other)
    assert np.linalg.norm(pf.rows(one)[1][-1, 0, 10:13]) < np.radians(1.0)
    assert angle < np.radians(0.1) and rate < np.radians(0.001)
