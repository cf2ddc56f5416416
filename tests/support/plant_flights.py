"""What tests of the plant share: scenarios made of a few words, flights, states at random, energies and momenta."""

import numpy as np
from scipy.spatial.transform import Rotation

from fieldline.constants import EARTH_GM_M3_S2
from fieldline.dynamics.parameters import STATE
from fieldline.dynamics.step import rates_of
from fieldline.simulate.flight import Flight
from fieldline.simulate.scenario import Scenario

RADIUS_M = 6_878_136.6  # 500 km over the equator
MEAN_MOTION = float(np.sqrt(EARTH_GM_M3_S2 / RADIUS_M**3))
CIRCLE = {"elements": {"altitude_km": 500.0, "inclination_deg": 51.6}}
UNIFORM = (2.0e-5, -1.0e-5, 3.0e-5)
INERTIA = ((2.2, 0.04, -0.025), (0.04, 1.5, 0.03), (-0.025, 0.03, 2.6))


def body(name="sat", **more):
    """A rigid body of 10 kg that tumbles at some degrees a second, unless told otherwise."""
    usual = {"name": name, "mass_kg": 10.0}
    if more.get("kind") != "point":
        usual |= {
            "inertia_kg_m2": INERTIA,
            "rate_deg_s": (1.0, -2.0, 3.0),
            "attitude": {"euler_321_deg": (20.0, -30.0, 40.0), "axes": "gcrs"},
        }
    return {key: value for key, value in (usual | more).items() if value is not None}


def scenario(*bodies, seconds=100.0, output=None, environment=None, orbit=None, integrator=None, **tables):
    """A scenario of these bodies about a point mass, 500 km up, in a uniform field."""
    return Scenario.from_dict(
        {
            "time": {
                "start_utc": "2026-03-01T00:00:00Z",
                "duration_s": float(seconds),
                "output_step_s": output or float(seconds),
            },
            "environment": {"gravity": "point", "uniform_field_i_tesla": UNIFORM} if environment is None else environment,
            "orbit": orbit or CIRCLE,
            "integrator": integrator or {},
            "body": list(bodies) or [body()],
            **tables,
        },
        "scenario",
    )


def flown(*bodies, **tables):
    """A finished flight."""
    flight = Flight(scenario(*bodies, **tables))
    flight.fly()
    return flight


def rows(flight):
    """(seconds (n,), states (n, bodies, 13)) that a flight kept."""
    count = int(flight.clock.rows[0])
    bodies = len(flight.scenario.body)
    return flight.record.seconds[:count], flight.record.state[:count, : STATE * bodies].reshape(count, bodies, STATE)


def rest(flight):
    """(n, wheels + rods) of the states that a flight kept."""
    return flight.record.state[: int(flight.clock.rows[0]), STATE * len(flight.scenario.body) :]


def rates(flight, t=0.0, y=None):
    """(dz/dt, log of the loads) of a flight's plant at a state."""
    y = flight.y if y is None else y
    return rates_of(t, y, flight.plant, flight.inputs, flight.loads, flight.host.callback, flight.shared)


def random_state(flight, seed):
    """A state of a flight's plant: low orbits, any attitude, some degrees a second, wheels and rods within their limits."""
    rng = np.random.default_rng(seed)
    y = flight.start.copy()
    for b in range(len(flight.scenario.body)):
        row = y[STATE * b : STATE * (b + 1)]
        if b == 0:
            place = Rotation.random(random_state=rng).as_matrix() @ [RADIUS_M * rng.uniform(0.97, 1.2), 0.0, 0.0]
        else:
            place = y[:3] + 1200.0 * _direction(rng)  # lines of a kilometre are taut
        row[:3] = place
        row[3:6] = y[3:6] + rng.normal(0.0, 1.0, 3) if b else 7600.0 * _direction(rng)
        row[6:10] = Rotation.random(random_state=rng).as_quat()
        row[10:13] = rng.normal(0.0, 0.05, 3)
    wheels = len(flight.plant.wheels.body)
    base = STATE * len(flight.scenario.body)
    y[base : base + wheels] = rng.uniform(-0.9, 0.9, wheels) * flight.plant.wheels.momentum_max
    rods = len(flight.plant.rods.body)
    y[base + wheels : base + wheels + rods] = rng.uniform(-0.7, 0.7, rods) * flight.plant.rods.saturation
    return y


def _direction(rng):
    v = rng.standard_normal(3)
    return v / np.linalg.norm(v)


def turned(states):
    """Rotations body to inertial of states (..., 13)."""
    return Rotation.from_quat(np.reshape(states[..., 6:10], (-1, 4)))


def inertia_of(flight, b=0):
    """(3, 3) [kg m^2]."""
    return np.array(flight.scenario.body[b].inertia_kg_m2, dtype=float)


def spin_energy(flight, states, b=0):
    """(n,) [J] of rotation."""
    omega = states[:, b, 10:13]
    return 0.5 * np.einsum("ni,ij,nj->n", omega, inertia_of(flight, b), omega)


def spin_momentum(flight, states, b=0, wheels=None):
    """(n, 3) [N m s] of rotation about the centre of mass, inertial axes; wheels (n, 3): theirs, body axes."""
    momentum = states[:, b, 10:13] @ inertia_of(flight, b)
    return turned(states[:, b]).apply(momentum if wheels is None else momentum + wheels)


def orbit_energy(states, b=0):
    """(n,) [J/kg] about a point mass."""
    r, v = states[:, b, 0:3], states[:, b, 3:6]
    return 0.5 * np.einsum("ni,ni->n", v, v) - EARTH_GM_M3_S2 / np.linalg.norm(r, axis=1)


def angle_between(q, p):
    """(n,) [rad] between attitudes (n, 4)."""
    return (Rotation.from_quat(q).inv() * Rotation.from_quat(p)).magnitude()


THREE_AXES = np.eye(3).tolist()


def torquers(**more):
    """Three magnetorquers of 1 A m^2 along the body axes."""
    return [{"axis_b": axis, "moment_max_a_m2": 1.0} | more for axis in THREE_AXES]


def wheels(**more):
    """Three wheels along the body axes."""
    return [{"axis_b": axis, "momentum_max_n_m_s": 1.0, "torque_max_n_m": 0.1} | more for axis in THREE_AXES]


def law(name="ramp", commands=("dipole",), parameters=(0.1, 0.0, 0.0), **more):
    """A plain law of `user_functions`, every two seconds."""
    known = {"law": f"user_functions:{name}", "compiled": False, "commands": list(commands), "rate_hz": 0.5}
    return known | {"parameters": {"p": list(parameters)}} | more
