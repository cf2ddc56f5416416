"""Every load of the plant once: a scenario in which it acts alone, what kind it is, and its potential where it has one.

conservative: the energy of `energy` stays.  dissipative: it never grows.  exchange: whole momentum and angular momentum
stay.  external: none of these; it does what it is told.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

import plant_flights as pf
from fieldline.environment.ephemeris import dcm_ei_kernel
from fieldline.environment.gravity import gravity_potential_kernel
from fieldline.frames.matrices import matvec

AIR = {"model": "exponential", "reference_density_kg_m3": 2.5e-10, "reference_altitude_km": 200.0, "scale_height_km": 60.0}
INDUCED = ((300.0, 20.0, 0.0), (20.0, 500.0, -30.0), (0.0, -30.0, 100.0))
EDDY = ((3000.0, 200.0, 0.0), (200.0, 5000.0, -300.0), (0.0, -300.0, 1000.0))
ROD = {"volume_m3": 1e-5, "saturation_tesla": 0.03, "coercivity_a_m": 12.0, "remanence_tesla": 0.004}
AXES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.6, 0.0, 0.8))


@dataclass(frozen=True)
class Load:
    """One load: `tables` of the scenario, `bodies` in it, `inputs` that command it, `energy` of (flight, states)."""

    name: str
    nature: str
    bodies: tuple = (pf.body(),)
    tables: dict = field(default_factory=dict)
    energy: Callable | None = None
    inputs: dict = field(default_factory=dict)

    def scenario(self, **more):
        return pf.scenario(*self.bodies, **(self.tables | more))

    def flight(self, **more):
        flight = pf.Flight(self.scenario(**more))
        for name, values in self.inputs.items():
            getattr(flight.inputs, name)[:] = values
        return flight


def field_b(flight, states):
    """(n, 3) [T] the uniform field in body axes."""
    return pf.turned(states[:, 0]).inv().apply(pf.UNIFORM)


def oblate_energy(flight, states):
    """[J/kg] of an orbit, by the plant's own potential."""
    seconds, _ = pf.rows(flight)
    surroundings = flight.plant.surroundings
    place = [matvec(dcm_ei_kernel(t, surroundings.ephemeris), tuple(r)) for t, r in zip(seconds, states[:, 0, :3], strict=True)]
    potential = np.array([gravity_potential_kernel(r, surroundings.gravity) for r in place])
    return 0.5 * np.sum(states[:, 0, 3:6] ** 2, axis=1) + potential


def gradient_energy(flight, states):
    """[J] Jacobi's integral of a body on a circular orbit: 1/2 w I w + 3/2 n^2 u I u - n h . (I w), inertial rate w.

    u: up, h: the orbit's normal. With the relative rate w - n h it is 1/2 wr I wr + 3/2 n^2 u I u - 1/2 n^2 h I h.
    """
    r, v = states[:, 0, 0:3], states[:, 0, 3:6]
    normal = np.cross(r, v)
    n = np.linalg.norm(normal, axis=1) / np.sum(r * r, axis=1)
    turn = pf.turned(states[:, 0]).inv()
    up = turn.apply(r / np.linalg.norm(r, axis=1)[:, None])
    normal = turn.apply(normal / np.linalg.norm(normal, axis=1)[:, None])
    inertia = pf.inertia_of(flight)
    pull = 1.5 * n**2 * np.einsum("ni,ij,nj->n", up, inertia, up)
    return pf.spin_energy(flight, states) + pull - n * np.einsum("ni,ij,nj->n", normal, inertia, states[:, 0, 10:13])


def residual_energy(flight, states):
    """[J] 1/2 w I w - m . B."""
    return pf.spin_energy(flight, states) - field_b(flight, states) @ flight.plant.bodies.residual[0]


def induced_energy(flight, states):
    """[J] 1/2 w I w - 1/2 B P B: a dipole that the field itself makes has half the energy of a fixed one."""
    b = field_b(flight, states)
    return pf.spin_energy(flight, states) - 0.5 * np.einsum("ni,ij,nj->n", b, np.array(INDUCED), b)


def torquer_energy(flight, states):
    """[J] 1/2 w I w - m . B, while the command stands."""
    return pf.spin_energy(flight, states) - field_b(flight, states) @ (np.array(AXES).T @ [0.3, -0.2, 0.4])


def line_energy(flight, states):
    """[J] of two bodies, their turning, gravity and the stretch of the line."""
    line = flight.scenario.line[0]
    total = np.zeros(len(states))
    ends = []
    for b, record in enumerate(flight.scenario.body):
        total += record.mass_kg * pf.orbit_energy(states, b)
        point = line.from_point_b_m if b == 0 else line.to_point_b_m
        ends.append(states[:, b, :3] + pf.turned(states[:, b]).apply(point))
        if record.kind == "rigid":
            total += pf.spin_energy(flight, states, b)
    stretch = np.maximum(0.0, np.linalg.norm(ends[1] - ends[0], axis=1) - line.rest_length_m)
    return total + 0.5 * line.stiffness_n / line.rest_length_m * stretch**2


def pair(damping):
    """Two bodies on a kilometre of line, attached off their centres."""
    bodies = (
        pf.body("top", mass_kg=50.0, rate_deg_s=(0.1, -0.2, 0.1)),
        pf.body("bottom", rate_deg_s=(0.0, 0.3, 0.1), offset_o_m=(3.0, 2.0, 1000.4), offset_rate_o_m_s=(0.02, 0.01, -0.01)),
    )
    ends = {"from_body": "top", "from_point_b_m": (0.3, 0.1, 0.5), "to_body": "bottom", "to_point_b_m": (0.0, 0.2, -0.4)}
    return bodies, {"line": [ends | {"rest_length_m": 1000.0, "stiffness_n": 5000.0, "damping_n_s": damping}]}


WHEELS = tuple({"axis_b": axis, "momentum_n_m_s": 0.01, "momentum_max_n_m_s": 0.2, "torque_max_n_m": 0.01} for axis in AXES)
THRUSTER = {"position_b_m": (0.1, 0.2, -0.3), "direction_b": (0.0, 0.6, 0.8), "force_n": 0.2}
TORQUERS = tuple(
    {"axis_b": axis, "moment_max_a_m2": 1.0, "time_constant_s": lag} for axis, lag in zip(AXES, (0.0, 0.5, 0.0), strict=True)
)
DRAG = {"area_m2": 2.0, "center_of_pressure_b_m": (0.1, -0.05, 0.2)}
LIGHT = {"area_m2": 2.0, "center_of_pressure_b_m": (0.1, -0.05, 0.2)}
MOMENTS = [0.3, -0.2, 0.4]

LOADS = (
    Load("gravity", "conservative", energy=lambda flight, states: pf.orbit_energy(states)),
    Load(
        "oblateness",
        "conservative",
        tables={"environment": {"gravity": "j2", "uniform_field_i_tesla": pf.UNIFORM}},
        energy=oblate_energy,
    ),
    Load("free spin", "conservative", energy=pf.spin_energy),
    Load(
        "gravity_gradient",
        "conservative",
        (pf.body(gravity_gradient=True, rate_deg_s=(0.05, -0.1, 0.07)),),
        energy=gradient_energy,
    ),
    Load("residual dipole", "conservative", (pf.body(residual_dipole_a_m2=(2.0, -1.0, 3.0)),), energy=residual_energy),
    Load("induced dipole", "conservative", (pf.body(induced_dipole_a_m2_tesla=INDUCED),), energy=induced_energy),
    Load(
        "torquers",
        "conservative",
        (pf.body(magnetorquer=TORQUERS),),
        energy=torquer_energy,
        inputs={"dipole_from": MOMENTS, "dipole_to": MOMENTS},
    ),
    Load("line", "conservative", *pair(0.0), energy=line_energy),
    Load("eddy_currents", "dissipative", (pf.body(eddy_damping_n_m_s_tesla2=EDDY),), energy=pf.spin_energy),
    Load(
        "drag",
        "dissipative",
        (pf.body(drag={"area_m2": 2.0}),),
        {"environment": {"gravity": "point", "uniform_field_i_tesla": pf.UNIFORM, "atmosphere": AIR}},
        energy=lambda flight, states: pf.orbit_energy(states),
    ),
    Load("damped line", "dissipative", *pair(3000.0), energy=line_energy),
    Load("wheels", "exchange", (pf.body(wheel=WHEELS),), inputs={"wheel_torque": [0.004, -0.002, 0.001]}),
    Load("lines", "exchange", *pair(3000.0)),
    Load("disturbance", "external", (pf.body(disturbance_torque_b_n_m=(1e-4, 2e-4, -1e-4)),)),
    Load("solar_pressure", "external", (pf.body(solar_pressure=LIGHT),)),
    Load("thrusters", "external", (pf.body(thruster=[THRUSTER]),), inputs={"thrust": [0.7]}),
    Load("hysteresis", "dissipative", (pf.body(hysteresis_rod=[ROD | {"axis_b": axis} for axis in AXES]),), energy=None),
    Load("user", "external", (pf.body(load=[{"function": "user_functions:push", "parameters": {"gain": 1e-6}}]),)),
)


def everything(order=(0, 1, 2), **more):
    """All loads at once, bodies in an order: two rigid ones and a point mass on two lines, in a tilted dipole, air and light."""
    every = {
        "residual_dipole_a_m2": (2.0, -1.0, 3.0),
        "induced_dipole_a_m2_tesla": INDUCED,
        "eddy_damping_n_m_s_tesla2": EDDY,
        "gravity_gradient": True,
        "drag": DRAG,
        "solar_pressure": LIGHT,
        "disturbance_torque_b_n_m": (1e-4, 2e-4, -1e-4),
        "disturbance_torque_i_n_m": (-2e-4, 1e-4, 3e-4),
        "hysteresis_rod": [ROD | {"axis_b": axis} for axis in AXES],
        "magnetorquer": TORQUERS,
        "wheel": WHEELS,
        "thruster": [THRUSTER, THRUSTER | {"direction_b": (1.0, 0.0, 0.0)}],
    }
    one = pf.body("one", mass_kg=40.0, load=[{"function": "user_functions:push", "parameters": {"gain": 1e-6}}], **every)
    two = pf.body("two", inertia_kg_m2=(1.0, 1.4, 1.7), offset_o_m=(0.0, 0.0, 1000.2), wheel=WHEELS[:1], thruster=[THRUSTER])
    two |= {"load": [{"function": "user_functions:pull", "parameters": {"force": 1e-9, "torque": 1e-5}}], "drag": DRAG}
    three = pf.body("three", kind="point", offset_o_m=(0.0, 0.0, -1000.2), solar_pressure={"area_m2": 1.0}, thruster=[THRUSTER])
    line = {"rest_length_m": 1000.0, "stiffness_n": 5000.0, "damping_n_s": 300.0, "from_body": "one"}
    lines = [line | {"to_body": "two", "from_point_b_m": (0.3, 0.1, 0.5), "to_point_b_m": (0.0, 0.2, -0.4)}]
    lines += [line | {"name": "other", "to_body": "three", "from_point_b_m": (0.0, 0.1, -0.5)}]
    environment = {
        "field": "centred-dipole",
        "field_moment_e_a_m2": [(1.4e22, -0.5e22, -7.6e22)],
        "gravity": "j2",
        "atmosphere": AIR,
    }
    bodies = [(one, two, three)[b] for b in order]
    if order[0] != 0:  # the first body stands on the orbit; the others where they may
        bodies = [b | {"offset_o_m": (0.0, 0.0, 1.0)} for b in bodies]
        bodies[0] = {key: value for key, value in bodies[0].items() if key != "offset_o_m"}
    flight = pf.Flight(pf.scenario(*bodies, line=lines, environment=environment, **more))
    command(flight, order)
    return flight


def command(flight, order):
    """Commands in effect on all actuators, body after body."""
    thrust, wheels = ((0.3, 0.8), (0.5,), (0.9,)), ((0.004, -0.002, 0.001), (-0.003,), ())
    flight.inputs.dipole_from[:], flight.inputs.dipole_to[:] = MOMENTS, (-0.5, 0.1, 0.7)
    flight.inputs.dipole_since[:] = (-0.3, -0.7, -0.1)
    flight.inputs.wheel_torque[:] = [value for b in order for value in wheels[b]]
    flight.inputs.thrust[:] = [value for b in order for value in thrust[b]]
