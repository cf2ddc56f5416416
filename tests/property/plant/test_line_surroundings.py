"""What surrounds a line in the plant, derived once more in NumPy from the public models; and what it does to the line."""

import numpy as np
import pytest
from scipy.optimize import brentq

import plant_flights as pf
from fieldline.constants import (
    EARTH_ROTATION_RATE_RAD_S,
    ELECTRON_MASS_KG,
    ELEMENTARY_CHARGE_C,
    STEFAN_BOLTZMANN_W_M2_K4,
)
from fieldline.dynamics.layout import starts_in_state
from fieldline.dynamics.lines.bare import bare_currents, bare_work
from fieldline.environment import eclipse, magnetic_field, sun_position_i
from fieldline.environment.atmosphere import density
from fieldline.environment.plasma import electron_density
from fieldline.environment.radiation import ALBEDO, EARTH_INFRARED_W_M2, line_view
from fieldline.frames.earth_rotation import dcm_ei
from fieldline.simulate.run_dataset import dataset_of

pytestmark = [pytest.mark.kernels, pytest.mark.flight]
AHEAD_S = 1.0  # half of the two seconds for which surroundings are held
ROPE = {
    "name": "rope",
    "from_body": "low",
    "to_body": "high",
    "rest_length_m": 2000.0,
    "nodes": 3,
    "stiffness_n": 5000.0,
    "damping_n_s": 500.0,
    "mass_per_length_kg_m": 0.004,
    "diameter_m": 0.012,
    "drag_coefficient": 2.1,
}
HEAT = {
    "absorptivity": 0.4,
    "emissivity": 0.7,
    "specific_heat_j_kg_k": 800.0,
    "expansion_1_k": 2e-5,
    "start_temperature_k": 263.0,
}
WIRE = {"resistance_ohm_per_m": 0.05, "temperature_coefficient_1_k": 0.004}
TABLE = {"times_s": [0.0, 2.0], "currents_a": [1.0, 3.0], "fractions": [0.0, 1.0], "shares": [1.0, 0.5]}
SPHERES = {"collector_radius_m": [0.5, 0.8], "collector_gain": 2.0}
CIRCUITS = {
    "profile": WIRE | TABLE | {"mode": "profile"},
    "series": WIRE | SPHERES | {"mode": "series", "load_ohm": 40.0, "contactor_ohm": 3.0, "supply_v": -12.0},
    "bare": WIRE | {"mode": "bare", "load_ohm": 15.0, "cathode_drop_v": 18.0},
}


SIDE = {
    "name": "side",
    "from_body": "low",
    "to_body": "aside",
    "rest_length_m": 600.0,
    "nodes": 2,
    "stiffness_n": 5000.0,
    "mass_per_length_kg_m": 0.004,
    "diameter_m": 0.01,
    "drag_coefficient": 0.0,
    "heat": HEAT,
}  # a line before the one that is looked at: three segments, warm, nothing else


def flight_of(circuit=None, heat=HEAT, air="layered", seconds=0.01, output=None, step=0.01, alone=False, **rope):
    """Points on a bent line of three nodes, 420 km up, and on another one, flown for a moment so that they have looked around."""
    environment = {"gravity": "point", "atmosphere": {"model": air}, "plasma": {"model": "chapman"}}
    line = ROPE | {key: value for key, value in (("circuit", circuit), ("heat", heat)) if value} | rope
    flight = pf.Flight(
        pf.scenario(
            pf.body("low", kind="point", mass_kg=60.0),
            pf.body("high", kind="point", mass_kg=40.0, offset_o_m=(150.0, -90.0, -1996.0), offset_rate_o_m_s=(0.3, 0.2, 0.1)),
            pf.body("aside", kind="point", mass_kg=5.0, offset_o_m=(0.0, 20.0, 599.0)),
            line=[line] if alone else [SIDE, line], environment=environment,
            seconds=seconds, output=output, integrator={"step_s": step},
            orbit={"elements": {"altitude_km": 420.0, "inclination_deg": 40.0, "true_anomaly_deg": 70.0}},
        )
    )  # fmt: skip
    nodes, feeds, _ = starts_in_state(flight.plant)
    rows = flight.y[nodes:feeds].reshape(-1, 6)
    rows += np.random.default_rng(4).normal(0.0, (15.0, 15.0, 15.0, 0.3, 0.3, 0.3), rows.shape)
    flight.start[:] = flight.y
    flight.fly()
    assert flight.outcome.name == "DONE"
    return flight


def points(y, flight, ahead=0.0):
    """(5, 3) places [m] and velocities [m/s] of the line's points, moved ahead at their speeds."""
    nodes = starts_in_state(flight.plant)[0] + 12
    rows = np.vstack([y[0:6], y[nodes : nodes + 18].reshape(3, 6), y[13:19]])
    return rows[:, :3] + ahead * rows[:, 3:], rows[:, 3:]


def held_by(flight):
    """What is held around the rope alone."""
    held = flight.shared.ambient
    each = {name: getattr(held, name)[3:] for name in held._fields[: held._fields.index("emf")]}
    return held._replace(**each, **{name: getattr(held, name)[1:] for name in ("emf", "power", "lorentz_i", "drag_i")})


class Around:
    """Field, air, plasma and light in the middle of each of the four segments."""

    def __init__(self, flight):
        time = flight.scenario.time.start + np.timedelta64(round(1e9 * AHEAD_S), "ns")
        place, speed = points(flight.start, flight, AHEAD_S)
        self.chord, middle = np.diff(place, axis=0), 0.5 * (place[1:] + place[:-1])
        turn = dcm_ei(time)
        pole = turn[2]
        self.wind = 0.5 * (speed[1:] + speed[:-1]) - EARTH_ROTATION_RATE_RAD_S * np.cross(pole, middle)
        self.field = magnetic_field(middle @ turn.T, time) @ turn
        self.emf = np.sum(np.cross(self.wind, self.field) * self.chord, axis=1)
        sun = sun_position_i(time)
        self.air = density(middle @ turn.T, turn @ sun, AHEAD_S, flight.plant.surroundings.atmosphere)
        self.electrons = electron_density(middle @ turn.T, turn @ sun, flight.plant.surroundings.plasma)
        self.middle, self.sun, self.lit = middle, sun, eclipse(middle, time)
        grown = 1.0 + 2e-5 * (263.0 - 293.15)
        self.length = 500.0 * grown
        self.resistance = np.full(4, 0.05 * (1.0 + 0.004 * (263.0 - 293.15)) * self.length)

    def across(self, direction):
        """Sine of the angle between a direction and each segment."""
        size = np.linalg.norm(np.cross(self.chord, direction), axis=1)
        return size / np.linalg.norm(self.chord, axis=1) / np.linalg.norm(direction, axis=-1)

    def heating(self, current):
        """[W/m] of each segment."""
        to_sun = self.sun - self.middle
        radius = np.linalg.norm(self.middle, axis=1)
        upright = np.sum(self.chord * self.middle, axis=1) / np.linalg.norm(self.chord, axis=1) / radius
        view = np.array([line_view(c, r) for c, r in zip(upright, radius, strict=True)])
        zenith = np.sum(to_sun * self.middle, axis=1) / np.linalg.norm(to_sun, axis=1) / radius
        strength = 1361.0 * (149597870700.0 / np.linalg.norm(to_sun, axis=1)) ** 2
        light = strength * (self.lit * self.across(to_sun) + ALBEDO * np.maximum(zenith, 0.0) * view)
        blown = 0.5 * self.air * self.across(self.wind) * np.linalg.norm(self.wind, axis=1) ** 3
        return 0.012 * (0.4 * light + 0.7 * EARTH_INFRARED_W_M2 * view + blown) + current**2 * self.resistance / self.length


def expected_current(name, around, flight):
    """The four currents of a circuit."""
    if name == "profile":
        return 2.0 * np.interp([0.125, 0.375, 0.625, 0.875], [0.0, 1.0], [1.0, 0.5])  # half way through the table
    if name == "bare":
        out = np.empty(4)
        gather = ELEMENTARY_CHARGE_C * around.electrons * 0.012 * around.length
        gather *= np.sqrt(2.0 * ELEMENTARY_CHARGE_C / ELECTRON_MASS_KG)
        bare_currents(around.emf, around.resistance, gather, False, 18.0, 15.0, 0.1, 16.0, bare_work(4), out)
        return out
    drive = around.emf.sum() - 12.0
    radius, end = (0.8, 3) if drive > 0.0 else (0.5, 0)
    thermal = np.sqrt(ELEMENTARY_CHARGE_C * 0.1 / (2.0 * np.pi * ELECTRON_MASS_KG))
    least = 2.0 * 2.0 * np.pi * radius**2 * around.electrons[end] * ELEMENTARY_CHARGE_C * thermal
    scale = ELEMENTARY_CHARGE_C * np.sum(around.field[end] ** 2) * radius**2 / (8.0 * ELECTRON_MASS_KG)
    whole = around.resistance.sum() + 43.0

    def left(current):
        return abs(drive) - whole * current - scale * max(0.0, current / least - 1.0) ** 2

    return np.full(4, np.sign(drive) * brentq(left, 0.0, abs(drive) / whole))


@pytest.mark.parametrize("name", CIRCUITS)
def test_surroundings_and_currents(name):
    flight = flight_of(CIRCUITS[name])
    held, around = held_by(flight), Around(flight)
    assert held.field_i == pytest.approx(around.field, rel=1e-7, abs=1e-14)
    assert held.density == pytest.approx(around.air, rel=1e-9)
    assert held.electrons == pytest.approx(around.electrons, rel=1e-9)
    assert held.drive == pytest.approx(around.emf, rel=1e-7)
    assert held.emf == pytest.approx([around.emf.sum()], rel=1e-7)
    assert held.resistance == pytest.approx(around.resistance, rel=1e-12)
    current = expected_current(name, around, flight)
    assert np.abs(current).min() > 1e-3
    assert held.current == pytest.approx(current, rel=1e-6)
    assert held.heating == pytest.approx(around.heating(current), rel=1e-6)
    load = {"profile": np.sum(current * (around.emf - current * around.resistance)), "series": 40.0 * current[0] ** 2}
    if name in load:
        assert held.power == pytest.approx([load[name]], rel=1e-6)
    force = np.cross(current[:, None] * around.chord, around.field)
    assert held.lorentz_i[0] == pytest.approx(force.sum(axis=0), rel=1e-6)
    drag = -0.5 * around.air * 2.1 * 0.012 * np.linalg.norm(np.cross(around.chord, around.wind), axis=1)
    assert held.drag_i[0] == pytest.approx((drag[:, None] * around.wind).sum(axis=0), rel=1e-6)


def test_forces_on_nodes_and_ends_and_temperatures():
    """What air and current add to the rates: half of each segment's load on either of its ends, over that end's mass."""
    flight, still = flight_of(CIRCUITS["bare"]), flight_of(None, air="none")
    held = held_by(flight)
    y = flight.start
    rate, _ = pf.rates(flight, 0.4, y)
    plain, _ = pf.rates(still, 0.4, y)
    place, speed = points(y, flight)
    middle, chord = 0.5 * (place[1:] + place[:-1]), np.diff(place, axis=0)
    pole = dcm_ei(flight.scenario.time.start)[2]
    wind = 0.5 * (speed[1:] + speed[:-1]) - EARTH_ROTATION_RATE_RAD_S * np.cross(pole, middle)
    size = -0.5 * held.density * 2.1 * 0.012 * np.linalg.norm(np.cross(chord, wind), axis=1)
    force = np.cross(held.current[:, None] * chord, held.field_i) + size[:, None] * wind
    load = np.zeros((5, 3))
    load[:-1] += 0.5 * force
    load[1:] += 0.5 * force
    change = rate - plain
    mass = 0.004 * 500.0
    assert change[3:6] == pytest.approx(load[0] / (60.0 + 0.5 * mass + 0.5 * 0.004 * 200.0), rel=1e-5)
    assert change[15:18] == pytest.approx(load[4] / (40.0 + 0.5 * mass), rel=1e-5)
    first = starts_in_state(flight.plant)[0] - 3 + 12
    nodes = change[first : first + 18].reshape(3, 6)[:, 3:]
    assert nodes == pytest.approx(load[1:4] / mass, rel=1e-4, abs=1e-8)
    cooled = np.pi * 0.012 * 0.7 * STEFAN_BOLTZMANN_W_M2_K4 * 263.0**4
    assert rate[-4:] == pytest.approx((held.heating - cooled) / (0.004 * 800.0), rel=1e-9)


def test_length_follows_temperature():
    """A taut straight line pulls less by E A times its expansion as it warms."""
    flight = flight_of(None, air="none")
    y = flight.start.copy()
    pf.rates(flight, 0.0, y)
    cold = flight.shared.tension[3:].copy()
    y[-4:] += 30.0
    pf.rates(flight, 0.0, y)
    warm = flight.shared.tension[3:]
    taut = (cold > 0.0) & (warm > 0.0)
    assert taut.any()
    stretched = np.linalg.norm(np.diff(points(y, flight)[0], axis=0), axis=1)[taut]
    change = 5000.0 * stretched / 500.0 * (1.0 / (1.0 + 2e-5 * (263.0 - 293.15)) - 1.0 / (1.0 + 2e-5 * (293.0 - 293.15)))
    assert (cold - warm)[taut] == pytest.approx(change, rel=0.02)  # the rest: damping, over a longer line


def test_electric_power_is_what_the_motion_loses():
    """About a point mass, E - omega . L of everything falls by the integral of emf I alone, where the plasma turns at omega."""
    profile = {"mode": "profile", "current_a": 1.5}
    bare = {"nodes": 0, "mass_per_length_kg_m": 0.0, "damping_n_s": 0.0}
    flight = flight_of(profile, heat=None, air="none", seconds=100.0, output=2.0, step=0.5, alone=True, **bare)
    data = dataset_of(flight)
    pole = dcm_ei(flight.scenario.time.start)[2]

    def jacobi(y):
        total = 0.0
        for mass, row in ((60.0, y[0:6]), (40.0, y[13:19])):
            r, v = row[:3], row[3:]
            total += mass * (0.5 * v @ v - 3.986004418e14 / np.linalg.norm(r))
            total -= mass * EARTH_ROTATION_RATE_RAD_S * pole @ np.cross(r, v)
        stretch = max(0.0, np.linalg.norm(y[13:16] - y[0:3]) - 2000.0)
        return total + 0.5 * 5000.0 / 2000.0 * stretch**2

    emf, force = data["emf_rope"].values[:-1], data["lorentz_force_i_rope"].values[:-1]  # of the middle of two seconds each
    assert data["current_rope"].values == pytest.approx(1.5)
    lost = jacobi(flight.start) - jacobi(flight.y)
    assert lost == pytest.approx(1.5 * 2.0 * emf.sum(), rel=2e-4)
    speed = data["velocity_i"].values.mean(axis=1)
    work = -2.0 * np.sum(force * 0.5 * (speed[1:] + speed[:-1]))
    assert work == pytest.approx(lost, rel=0.15)  # the Earth's turn is the rest


def test_a_law_switches_the_current():
    """A law at the upper end tells a profile its current, within its limit."""
    profile = {"mode": "profile", "commanded": True, "current_max_a": 0.15}
    environment = {"gravity": "point", "uniform_field_i_tesla": (1e-5, 2e-5, 3e-5)}
    line = {key: value for key, value in ROPE.items() if key not in ("name", "nodes")} | {"circuit": profile, "name": "rope"}
    flight = pf.flown(
        pf.body("low", kind="point", mass_kg=60.0),
        pf.body("high", kind="point", mass_kg=40.0, offset_o_m=(0.0, 0.0, -2000.1)),
        line=[line], environment=environment, seconds=9.0, output=1.0, integrator={"step_s": 0.1},
        software=[pf.law("ramp", ("current",), (0.04,), body="high", rate_hz=0.5)],
    )  # fmt: skip
    current = dataset_of(flight)["current_rope"].values[:, 0]
    assert current[0] == 0.0 and current.max() == pytest.approx(0.15)
    assert np.all(np.diff(current) >= 0.0) and len(np.unique(np.round(current, 9))) > 2


def test_a_line_that_is_paid_out_keeps_its_current_and_its_warmth():
    """Nodes that appear look around at once: no segment that is out is without field, resistance or heat."""
    series = WIRE | {"mode": "series", "load_ohm": 100.0}
    reel = {"total_length_m": 2600.0, "rate_m_s": 8.0, "lag_s": 1.0}
    environment = {"gravity": "point", "atmosphere": {"model": "layered"}}
    flight = pf.flown(
        pf.body("low", kind="point", mass_kg=60.0),
        pf.body("high", kind="point", mass_kg=400.0, offset_o_m=(0.0, 0.0, -2001.0), offset_rate_o_m_s=(0.0, 0.0, -8.0)),
        line=[ROPE | {"heat": HEAT, "circuit": series, "reel": reel, "nodes": 12}],
        environment=environment, seconds=60.0, output=0.5, integrator={"step_s": 0.05, "line_update_s": 10.0},
    )  # fmt: skip
    assert flight.outcome.name == "DONE"
    data = dataset_of(flight)
    current, warmth = data["current_rope"].values, data["temperature_rope"].values
    out = np.isfinite(current)
    assert out.sum(axis=1)[0] == 10 and out.sum(axis=1)[-1] == 12  # segments of 200 m
    assert current[out].min() > 0.5 and np.abs(np.diff(np.nanmean(current, axis=1))).max() < 0.03
    assert np.array_equal(np.isfinite(warmth), out) and 220.0 < np.nanmin(warmth) < np.nanmax(warmth) < 330.0
    rate = np.abs(np.diff(np.nanmean(warmth, axis=1))) / 0.5
    assert rate.max() < 2.0 * np.median(rate) + 0.2
