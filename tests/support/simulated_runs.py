"""Scenarios that the tests of `fieldline simulate` fly: one with something of everything, and a free tumble."""

EVERYTHING = """
name = "everything"
description = "Two bodies on a line, one with all actuators and sensors <and & signs>"
seed = 3

[time]
start_utc = 2026-03-01T00:00:00Z
duration_s = 1200.0
output_step_s = 2.0

[integrator]
method = "rk4"
step_s = 0.5

[environment]
field = "IGRF-14"
field_degree = 4
atmosphere.model = "layered"

[orbit.elements]
altitude_km = 500.0
inclination_deg = 60.0

[[body]]
name = "main"
mass_kg = 40.0
inertia_kg_m2 = [4.0, 4.2, 3.0]
attitude = { euler_321_deg = [5.0, -3.0, 2.0], axes = "orbital" }
rate_axes = "orbital"
rate_deg_s = [0.0, 0.0, 0.0]
gravity_gradient = true
drag = { area_m2 = 0.2, center_of_pressure_b_m = [0.0, 0.0, 0.02] }
solar_pressure = { area_m2 = 0.2, center_of_pressure_b_m = [0.0, 0.02, 0.0] }
magnetorquer = [
    { axis_b = [1.0, 0.0, 0.0], moment_max_a_m2 = 0.02 },
    { axis_b = [0.0, 1.0, 0.0], moment_max_a_m2 = 0.02 },
    { axis_b = [0.0, 0.0, 1.0], moment_max_a_m2 = 0.02 },
]
wheel = [
    { axis_b = [1.0, 0.0, 0.0], momentum_max_n_m_s = 0.5, torque_max_n_m = 0.002 },
    { axis_b = [0.0, 1.0, 0.0], momentum_max_n_m_s = 0.5, torque_max_n_m = 0.002 },
    { axis_b = [0.0, 0.0, 1.0], momentum_max_n_m_s = 0.5, torque_max_n_m = 0.002 },
]
hysteresis_rod = [
    { axis_b = [1.0, 0.0, 0.0], volume_m3 = 8.0e-8, saturation_tesla = 0.025, coercivity_a_m = 12.0, remanence_tesla = 0.004 },
]
magnetometer = { rate_hz = 1.0, bias_nt = [100.0, 0.0, 0.0], noise_std_nt = 20.0 }
gyro = { rate_hz = 1.0, noise_std_deg_s = 0.001 }
star_tracker = { rate_hz = 1.0, noise_std_arcsec = [20.0, 20.0, 60.0], boresight_b = [0.0, 0.0, -1.0] }
sun_sensor = { rate_hz = 0.5 }
navigation = { rate_hz = 1.0, position_noise_std_m = [5.0, 5.0, 5.0] }

[[body]]
name = "end"
kind = "point"
mass_kg = 2.0
offset_o_m = [0.0, 0.0, 100.01]

[[line]]
from_body = "main"
from_point_b_m = [0.0, 0.0, 0.5]
to_body = "end"
rest_length_m = 99.0
stiffness_n = 50.0
damping_n_s = 50.0

[[software]]
body = "main"
law = "wheel-pointing-with-desaturation"
rate_hz = 1.0
parameters = { target = "nadir", natural_frequency_rad_s = 0.05 }

[[event]]
kind = "rate"
name = "slow"
rate_deg_s = 0.08
"""

TUMBLE = """
name = "tumble"
seed = 1

[time]
start_utc = 2026-03-01T00:00:00Z
duration_s = 11400.0
output_step_s = 4.0

[integrator]
method = "rk4"
step_s = 1.0

[orbit.elements]
altitude_km = 500.0
inclination_deg = 97.4
raan_deg = 30.0

[[body]]
name = "satellite"
mass_kg = 4.0
inertia_kg_m2 = [0.050, 0.060, 0.030]
attitude = { random = true }
rate_deg_s = [2.0, -1.0, 1.5]
gravity_gradient = true
magnetometer = { rate_hz = 0.25, bias_nt = [300.0, -150.0, 80.0], gain = [1.01, 0.99, 1.0], noise_std_nt = 40.0 }
"""


def with_law(body: str, rate_hz: float = 1.0, output_step_s: float = 10.0) -> str:
    """A short tumble whose satellite runs a plain law of the user's own, in law.py beside the scenario."""
    text = TUMBLE.replace("duration_s = 11400.0", "duration_s = 600.0")
    text = text.replace("output_step_s = 4.0", f"output_step_s = {output_step_s}")
    return text + (
        "magnetorquer = [{ axis_b = [0.0, 1.0, 0.0], moment_max_a_m2 = 0.2 }]\n"
        f'[[software]]\nlaw = "law.py:{body}"\nrate_hz = {rate_hz}\ncommands = ["dipole"]\ncompiled = false\n'
    )


LAWS = """
def steady(t, measurement, memory, params):
    return [0.0, 0.1 if t < 100.0 else -0.05, 0.0]


def fails(t, measurement, memory, params):
    if t > 300.0:
        raise ValueError("no field today")
    return [0.0, 0.0, 0.0]


def stopped(t, measurement, memory, params):
    if t > 300.0:
        raise KeyboardInterrupt
    return [0.0, 0.0, 0.0]


def fails_at_once(t, measurement, memory, params):
    raise ValueError("never")
"""
