"""The satellite that tests of ensembles fly: a tumbler with a residual dipole, stopped by B-dot."""

TABLE = {
    "time": {"start_utc": "2026-03-01T00:00:00Z", "duration_s": 20.0, "output_step_s": 5.0},
    "integrator": {"step_s": 0.5},
    "environment": {"field_degree": 2},
    "orbit": {"elements": {"altitude_km": 500.0, "inclination_deg": 97.4}},
    "body": [
        {
            "name": "sat",
            "mass_kg": 4.0,
            "inertia_kg_m2": [[0.02, 1e-3, 0.0], [1e-3, 0.03, -2e-3], [0.0, -2e-3, 0.035]],
            "rate_deg_s": [8.0, -5.0, 3.0],
            "residual_dipole_a_m2": [0.01, -0.02, 0.005],
            "gravity_gradient": True,
            "magnetometer": {"rate_hz": 1.0},
            "magnetorquer": [{"axis_b": axis, "moment_max_a_m2": 0.1} for axis in ([1, 0, 0], [0, 1, 0], [0, 0, 1])],
        }
    ],
    "software": [{"law": "b-dot", "rate_hz": 1.0}],
}
