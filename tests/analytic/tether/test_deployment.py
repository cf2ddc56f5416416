"""A line with nodes paid out in proportion to its length: it leans by the constant angle, whatever nodes come out."""

import numpy as np
import pytest

import fieldline as fl
import plant_flights as pf

SHIP_KG = 2e6  # so heavy that it stays on its orbit


@pytest.mark.parametrize("lean_deg, upward", [(15.0, False), (20.0, False), (20.0, True)])
def test_a_line_paid_out_exponentially_leans_at_a_constant_angle(lean_deg, upward):
    """sin 2a = 4 c / (3 n), the end that is fed out ahead below and behind above; 100 m to 2 km in most of an orbit."""
    n = pf.MEAN_MOTION
    c = 0.75 * n * np.sin(2.0 * np.radians(lean_deg))
    hang = {"upward": upward, "in_plane_deg": lean_deg}
    line = {
        "name": "rope",
        "from_body": "probe",
        "to_body": "ship",
        "rest_length_m": 100.0,
        "stiffness_n": 1e5,
        "damping_n_s": 1e5,
        "mass_per_length_kg_m": 1e-3,
        "nodes": 6,
        "reel": {"total_length_m": 2500.0, "rate_m_s": c * 100.0, "lag_s": 0.5},
    }
    law = {"law": "reel-exponential", "body": "ship", "rate_hz": 1.0}
    run = fl.simulate(
        pf.scenario(
            pf.body("ship", kind="point", mass_kg=SHIP_KG),
            pf.body("probe", kind="point", mass_kg=200.0, hang=hang),
            seconds=np.log(20.0) / c,
            output=30.0,
            integrator={"method": "rosenbrock", "step_s": 0.5},
            line=[line],
            software=[law | {"parameters": {"target_length_m": 2500.0, "approach_per_s": 1.0, "rate_out_per_s": c}}],
        )
    )
    shape = fl.line_shape(run)
    length = run["deployed_length_rope"].values
    assert np.isclose(length[-1], 2000.0, rtol=0.02)
    assert np.isfinite(run["line_position_i_rope"].values[..., 0]).sum(axis=1)[-1] >= 6  # nodes have come out
    angle = np.degrees(shape["in_plane"].values)
    assert np.abs(angle - lean_deg).max() < 1.5  # the probe begins without the reel's speed, and swings once for it
    assert np.abs(angle[3 * len(angle) // 4 :] - lean_deg).max() < 0.3
    assert np.abs(shape["across"].values).max() < 1e-9
