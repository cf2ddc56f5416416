"""From a scenario's records to the plant's arrays.

Degrees, kilometres and nanotesla end here; what a body does not carry becomes zeros or rows that are not there. All
arrays are fresh, contiguous and writable, so that the compiled loop meets one set of types whatever the scenario.
"""

from __future__ import annotations

import numpy as np

from fieldline.dynamics.parameters import (
    PLAIN_LOAD,
    Bodies,
    Conductors,
    Plant,
    Rods,
    Surroundings,
    Thrusters,
    Torquers,
    UserLoads,
    Wheels,
)
from fieldline.environment.atmosphere import atmosphere_model
from fieldline.environment.ephemeris import ephemeris_table
from fieldline.environment.field_record import FieldParams
from fieldline.environment.field_registry import field_model
from fieldline.environment.gravity import gravity_model
from fieldline.mechanics.rigid_body import as_inertia9
from fieldline.simulate.assembly.circuits import circuits_of
from fieldline.simulate.assembly.lines import lines_of, sliders_of
from fieldline.simulate.scenario.states import earth_orientation


def plant_of(scenario, duration_s: float, load_slots=()) -> Plant:
    """The plant of a scenario that lasts `duration_s`; `load_slots`: a number for each user's load, body after body."""
    bodies = scenario.body
    surroundings = surroundings_of(scenario, duration_s)
    return Plant(
        surroundings=surroundings,
        bodies=_bodies(bodies),
        torquers=_torquers(bodies),
        wheels=_wheels(bodies),
        thrusters=_thrusters(bodies),
        rods=_rods(bodies),
        conductors=_conductors(bodies),
        lines=lines_of(scenario),
        circuits=circuits_of(scenario),
        sliders=sliders_of(scenario),
        user=_user_loads(scenario, load_slots),
        magnetic=any(map(is_magnetic, bodies)),
    )


def surroundings_of(scenario, duration_s: float) -> Surroundings:
    """Field, gravity, air, Earth rotation and Sun over the run."""
    environment, start = scenario.environment, scenario.time.start
    uniform = environment.uniform_field_i_tesla
    middle = start + np.timedelta64(round(0.5e9 * duration_s), "ns")
    return Surroundings(
        gravity=_gravity(environment),
        field=no_field() if uniform is not None else fresh(environment.field_model().at(middle)),
        uniform_field_i=np.array(uniform if uniform is not None else (0.0, 0.0, 0.0), dtype=float),
        atmosphere=fresh(air_of(environment.atmosphere, start, duration_s)),
        plasma=fresh(environment.plasma.made()),
        ephemeris=fresh(ephemeris_table(start, duration_s, earth_orientation(scenario))),
        rotating=environment.gravity != "point",
    )


def _gravity(environment):
    """Gravity, with a parameter GM of the scenario's own where there is one."""
    gravity = fresh(gravity_model(environment.gravity, environment.gravity_degree))
    own = environment.gravity_gm_m3_s2
    return gravity if own is None else gravity._replace(gm=own)


def air_of(air, start, duration_s: float):
    """The atmosphere of a record."""
    if air.model == "exponential":
        return atmosphere_model(
            "exponential",
            density_kg_m3=air.reference_density_kg_m3,
            height_m=1e3 * air.reference_altitude_km,
            scale_height_m=1e3 * air.scale_height_km,
        )
    if air.model == "msis":
        return atmosphere_model(
            "msis", start_utc=start, duration_s=duration_s, f107_sfu=air.f107, f107_average_sfu=air.f107_average, ap=air.ap
        )
    return atmosphere_model(air.model)


def no_field() -> FieldParams:
    """A field of nothing, of the types of any other."""
    return fresh(
        field_model("centred-dipole", moment_e=(0.0, 0.0, 1.0))
        .at(np.datetime64("2025-01-01"))
        ._replace(dipole_position_e=np.zeros((0, 3)), dipole_moment_e=np.zeros((0, 3)))
    )


def fresh(record):
    """A record with fresh, contiguous, writable arrays, nested records included."""
    kept = {}
    for name, value in zip(record._fields, record, strict=True):
        if isinstance(value, np.ndarray):
            kept[name] = np.array(value, order="C")
        elif isinstance(value, tuple) and hasattr(value, "_fields"):
            kept[name] = fresh(value)
    return record._replace(**kept)


def is_magnetic(body) -> bool:
    """Whether the field turns this body."""
    if body.kind == "point":
        return False
    linear = any(np.any(getattr(body, key)) for key in ("residual_dipole_a_m2", "induced_dipole_a_m2_tesla"))
    return bool(linear or np.any(body.eddy_damping_n_m_s_tesla2) or body.magnetorquer or body.hysteresis_rod or body.conductor)


def tensor9(value) -> np.ndarray:
    """Nine numbers of a diagonal or a (3, 3) tensor."""
    given = np.asarray(value, dtype=float)
    return (np.diag(given) if given.shape == (3,) else given).reshape(9)


def _bodies(bodies) -> Bodies:
    """One row a body."""
    inertias = [as_inertia9(b.inertia_kg_m2) if b.kind == "rigid" else (np.eye(3).ravel(),) * 2 for b in bodies]
    nothing = (0.0, 0.0, 0.0)
    return Bodies(
        mass=np.array([b.mass_kg for b in bodies], dtype=float),
        rigid=np.array([b.kind == "rigid" for b in bodies], dtype=np.int64),
        inertia=np.array([one for one, _ in inertias], dtype=float),
        inertia_inv=np.array([inverse for _, inverse in inertias], dtype=float),
        gravity_gradient=np.array([float(b.gravity_gradient) for b in bodies]),
        residual=_rows([b.residual_dipole_a_m2 for b in bodies], 3),
        induced=_rows([tensor9(b.induced_dipole_a_m2_tesla) for b in bodies], 9),
        eddy=_rows([tensor9(b.eddy_damping_n_m_s_tesla2) for b in bodies], 9),
        drag=np.array([b.drag.drag_coefficient * b.drag.area_m2 if b.drag else 0.0 for b in bodies]),
        drag_point=_rows([b.drag.center_of_pressure_b_m if b.drag else nothing for b in bodies], 3),
        solar=np.array([_pressed(b) for b in bodies]),
        solar_point=_rows([b.solar_pressure.center_of_pressure_b_m if b.solar_pressure else nothing for b in bodies], 3),
        torque_b=_rows([b.disturbance_torque_b_n_m for b in bodies], 3),
        torque_i=_rows([b.disturbance_torque_i_n_m for b in bodies], 3),
    )  # fmt: skip


def _pressed(body) -> float:
    """Area times reflectivity coefficient [m^2] of a body in sunlight."""
    light = body.solar_pressure
    return light.reflectivity_coefficient * light.area_m2 if light else 0.0


def _rows(values, width: int) -> np.ndarray:
    """(n, width) float array, also where n is zero."""
    return np.array([np.ravel(v) for v in values], dtype=float).reshape(-1, width)


def each(owners, key: str) -> list[tuple[int, object]]:
    """(owner's index, record) of every actuator, rod or load of a kind, body after body or line after line."""
    return [(b, one) for b, owner in enumerate(owners) for one in getattr(owner, key)]


def _owners(pairs) -> np.ndarray:
    """Body of each."""
    return np.array([b for b, _ in pairs], dtype=np.int64)


def _floats(values) -> np.ndarray:
    """(n,) float array."""
    return np.array(list(values), dtype=float)


def _torquers(bodies) -> Torquers:
    """Magnetorquers of all bodies."""
    pairs = each(bodies, "magnetorquer")
    return Torquers(_owners(pairs), _rows([one.axis_b for _, one in pairs], 3), _floats(one.time_constant_s for _, one in pairs))


def _wheels(bodies) -> Wheels:
    """Wheels of all bodies."""
    pairs = each(bodies, "wheel")
    return Wheels(_owners(pairs), _rows([one.axis_b for _, one in pairs], 3), _floats(one.momentum_max_n_m_s for _, one in pairs))


def _thrusters(bodies) -> Thrusters:
    """Thrusters of all bodies."""
    pairs = each(bodies, "thruster")
    force = [one.force_n * np.array(one.direction_b) for _, one in pairs]
    return Thrusters(_owners(pairs), _rows([one.position_b_m for _, one in pairs], 3), _rows(force, 3))


def _rods(bodies) -> Rods:
    """Hysteresis rods of all bodies."""
    pairs = each(bodies, "hysteresis_rod")
    return Rods(
        _owners(pairs),
        _rows([one.axis_b for _, one in pairs], 3),
        _floats(one.volume_m3 for _, one in pairs),
        _floats(one.saturation_tesla for _, one in pairs),
        _floats(one.remanence_tesla for _, one in pairs),
        _floats(one.coercivity_a_m for _, one in pairs),
    )


def _conductors(bodies) -> Conductors:
    """Conductors of all bodies."""
    pairs = each(bodies, "conductor")
    wire = [one.length_m * np.array(one.direction_b) for _, one in pairs]
    return Conductors(_owners(pairs), _rows([one.position_b_m for _, one in pairs], 3), _rows(wire, 3))


def loads_of(scenario) -> list[tuple[int, object]]:
    """(body, or the number of bodies plus line; record) of every load of the user's own."""
    return [*each(scenario.body, "load"), *((len(scenario.body) + k, one) for k, one in each(scenario.line, "load"))]


def _user_loads(scenario, slots) -> UserLoads:
    """The user's loads with their slots."""
    pairs = loads_of(scenario)
    parameters = [list(one.parameters.values()) for _, one in pairs]
    first = np.concatenate([[0], np.cumsum([len(p) for p in parameters], dtype=np.int64)]).astype(np.int64)
    numbers = slots if len(slots) == len(pairs) else [PLAIN_LOAD + k for k in range(len(pairs))]
    return UserLoads(_owners(pairs), np.array(numbers, dtype=np.int64), first, _floats(value for p in parameters for value in p))
