"""Circuits of every mode under a law that commands them: they obey within their limits and take energy from the motion."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import plant_flights as pf
from fieldline.simulate.run_dataset import dataset_of

pytestmark = [pytest.mark.kernels, pytest.mark.flight]
WIRE = {"resistance_ohm_per_m": 0.05, "commanded": True}
CIRCUITS = {
    "profile": {"mode": "profile", "commanded": True, "current_max_a": 1.0},
    "series": WIRE | {"mode": "series", "load_ohm": 40.0, "contactor_ohm": 3.0, "collector_radius_m": [0.5, 0.8]},
    "bare": WIRE | {"mode": "bare", "load_ohm": 15.0, "cathode_drop_v": 18.0, "cathode": "from"},
}
ROPE = {
    "name": "rope",
    "from_body": "low",
    "to_body": "high",
    "rest_length_m": 2000.0,
    "nodes": 2,
    "stiffness_n": 5000.0,
    "damping_n_s": 500.0,
    "mass_per_length_kg_m": 0.004,
    "diameter_m": 0.012,
}


def flown(circuit, told, inclination=40.0):
    """Eight seconds at 420 km, a law at the upper end that says `told` once a second; rows of every second, a Dataset."""
    flight = pf.flown(
        pf.body("low", kind="point", mass_kg=60.0),
        pf.body("high", kind="point", mass_kg=40.0, offset_o_m=(0.0, 0.0, -2000.2)),
        line=[ROPE | {"circuit": circuit}], environment={"gravity": "point", "plasma": {"model": "chapman"}},
        seconds=8.0, output=1.0, integrator={"step_s": 0.1},
        orbit={"elements": {"altitude_km": 420.0, "inclination_deg": inclination, "true_anomaly_deg": 70.0}},
        software=[pf.law("steady", ("current",), (told,), body="high", rate_hz=1.0)],
    )  # fmt: skip
    assert flight.outcome.name == "DONE"
    return dataset_of(flight)


def full(mode):
    """The current [A] of each segment at the end under full command."""
    if mode not in FULL:
        FULL[mode] = flown(CIRCUITS[mode], 1.0)["current_rope"].values[-1]
        assert np.abs(FULL[mode]).max() > 0.02
    return FULL[mode]


FULL = {}


@pytest.mark.parametrize("mode", CIRCUITS)
@given(told=st.floats(-3.0, 3.0))
@example(told=0.0)
@example(told=2.5)
@example(told=-2.5)
@settings(max_examples=10, deadline=None)
def test_a_circuit_obeys_within_its_limits(mode, told):
    """A profile has the current it is told, within its limit; the others that part of their full current."""
    data = flown(CIRCUITS[mode], told)
    part = np.clip(told, -1.0 if mode == "profile" else 0.0, 1.0)
    current = data["current_rope"].values
    assert current[-1] == pytest.approx(part * full(mode), rel=2e-4, abs=1e-9)
    force = np.linalg.norm(data["lorentz_force_i_rope"].values[-1])
    assert (force > 0.0) == (abs(part) > 1e-200)
    if mode != "profile":
        power = data["power_rope"].values[-1]
        driven = float(data["emf_rope"].values[-1]) * current[-1].mean()
        assert driven >= 0.0 and 0.0 <= power <= driven * (1.0 + 1e-6) + 1e-12


@pytest.mark.parametrize("inclination", [40.0, 140.0], ids=["eastward", "westward"])
def test_current_of_a_circuit_without_a_source_only_brakes(inclination):
    """Either way round, and whichever end is the cathode: the field's push on the line is against its way through the plasma."""
    for cathode in ("from", "to"):
        for circuit in (CIRCUITS["series"], CIRCUITS["bare"] | {"cathode": cathode}):
            data = flown(circuit, 1.0, inclination)
            speed = data["velocity_i"].values[1:].mean(axis=1)
            wind = speed - 7.292115e-5 * np.cross([0.0, 0.0, 1.0], data["position_i"].values[1:].mean(axis=1))
            push = data["lorentz_force_i_rope"].values[1:]
            assert np.all((push * wind).sum(axis=1) <= 1e-9 * np.linalg.norm(push, axis=1) * 8e3)
            assert np.abs(push).max() > (1e-3 if circuit["mode"] == "series" else -1.0)
