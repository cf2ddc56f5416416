"""What tests of laws share: a measurement with everything known, and a design context that needs no flight."""

from dataclasses import replace

import numpy as np

from fieldline.control import LAWS
from fieldline.sensing.measurement import new_measurement
from fieldline.vehicle import Conductor, Thruster
from tiny_flight import TinyFlight

REQUIRED = {
    "three-coil": {"target_i": (1.0, 0.0, 0.0)},
    "two-coil": {"target_i": (1.0, 0.0, 0.0)},
    "reel-exponential": {"target_length_m": 2e4},
    "reel-profile": {"target_length_m": 2e4, "rate_m_s": 2.0},
    "reel-tension": {"target_length_m": 2e4, "far_mass_kg": 100.0},
}
NUMBERS = {"dipole": 3, "wheel_torque": 3, "reel": 1}  # of each group, of what has one reel and nothing else that is told
FLIGHT = TinyFlight(inertia=(5.0, 6.0, 2.0), altitude_km=600.0, inclination_deg=70.0, moment_max=2.0, period_s=1.0)
AXES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
CONTEXT = FLIGHT.context(orbits=1)
CARRIER = replace(
    CONTEXT,
    mass_kg=60.0,
    radius_m=6.978e6,
    conductors=tuple(Conductor(position_b_m=AXES[k - 1], direction_b=AXES[k], length_m=3.0) for k in range(3)),
    thrusters=tuple(Thruster(position_b_m=AXES[k], direction_b=AXES[k - 2], force_n=0.05) for k in range(3)),
)  # for laws of currents: three conductors and three thrusters


def context_of(name):
    """What the law of a name is designed for."""
    return CARRIER if "current" in LAWS[name].commands else CONTEXT


def numbers_of(name):
    """How many numbers the law of a name returns."""
    given = NUMBERS | ({"current": 3, "thrust": 3} if "current" in LAWS[name].commands else {})
    return sum(given.get(group, 0) for group in LAWS[name].commands)


PACKED = {name: law.pack(REQUIRED.get(name, {}), context_of(name)) for name, law in LAWS.items()}


def known_measurement(field_b=(2e-5, -1e-5, 1.5e-5), omega_b=(0.0, 0.0, 0.0), q_bi=(0.0, 0.0, 0.0, 1.0), time_s=0.0):
    """Everything valid; a place on the orbit, three wheels at rest."""
    measurement = new_measurement(0, 3, 1)
    measurement.tension[:], measurement.line_length[:], measurement.line_rate[:] = 5.0, 500.0, 0.1
    measurement.relative_position_i[:], measurement.relative_velocity_i[:] = (500.0, 20.0, -10.0), (0.1, -0.2, 0.5)
    measurement.field_b[:], measurement.field_time_s[0] = field_b, time_s
    measurement.field_i[:] = field_b
    measurement.rate_b[:] = measurement.omega_bi_b[:] = omega_b
    measurement.q_bi[:] = np.asarray(q_bi, dtype=float) / np.linalg.norm(q_bi)
    measurement.position_i[:], measurement.velocity_i[:] = (6.97e6, 0.0, 0.0), (0.0, 2600.0, 7100.0)
    measurement.valid[:] = 1.0
    return measurement


def called(name, measurement, t=0.0, memory=None, params=None):
    """The command of a law at one call."""
    memory = np.zeros(LAWS[name].memory) if memory is None else memory
    return LAWS[name].kernel(t, measurement, memory, PACKED[name] if params is None else params)
