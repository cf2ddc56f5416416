"""The plant's equations once more, in NumPy, from textbooks and from a scenario's records: nothing of `fieldline.dynamics`.

What is given, because it has tests of its own: the Earth's attitude and the Sun at a time, geodetic height.
Sources: Montenbruck and Gill (2000), ch. 3; Wertz (1978), ch. 16 to 18; Flatley and Henretty (1995).
"""

import numpy as np
from scipy.spatial.transform import Rotation

from fieldline.environment.ephemeris import dcm_ei_kernel, sun_kernel
from fieldline.frames.geodetic import geodetic_kernel
from textbook_line import TextbookLine

GM, RADIUS, J2 = 3.986004418e14, 6378136.6, 1.0826359e-3
SPIN = 7.292115e-5
LIGHT, SOLAR_CONSTANT, AU, SUN_RADIUS = 299792458.0, 1361.0, 1.495978707e11, 6.957e8
MU0 = 4e-7 * np.pi


def tensor(value):
    value = np.array(value, dtype=float)
    return np.diag(value) if value.shape == (3,) else value


class Textbook:
    """forces and torques by name: {load: (force_i, torque_b)} of every body, and the rates of the state."""

    def __init__(self, flight, t, y):
        self.scenario, self.t, self.y = flight.scenario, t, np.array(y)
        self.inputs = flight.inputs
        self.nodes_out = flight.plant.lines.nodes
        self.ei = np.reshape(dcm_ei_kernel(t, flight.plant.surroundings.ephemeris), (3, 3))
        self.later = np.reshape(dcm_ei_kernel(t + 1.0, flight.plant.surroundings.ephemeris), (3, 3))
        self.sun = np.array(sun_kernel(t, flight.plant.surroundings.ephemeris))
        self.rows = self.y[: 13 * len(self.scenario.body)].reshape(-1, 13)
        self.tail = self.y[13 * len(self.scenario.body) :]
        self.loads = [{} for _ in self.rows]
        self.end_masses = [[] for _ in self.rows]  # (mass, place in the body) of lines' ends; None: at its centre
        self.extra = np.zeros(len(self.tail))
        self.gyro = np.zeros((len(self.rows), 3))
        self._work()

    def _work(self):
        torquer = wheel = thruster = rod = conductor = 0
        wheels = sum(len(b.wheel) for b in self.scenario.body)
        for b, record in enumerate(self.scenario.body):
            r, v, turn, omega = self.rows[b, :3], self.rows[b, 3:6], Rotation.from_quat(self.rows[b, 6:10]), self.rows[b, 10:13]
            self._outside(b, record, r, v, turn)
            zero = np.zeros(3)
            for k, one in enumerate(record.thruster, thruster):
                force = self.inputs.thrust[k] * one.force_n * np.array(one.direction_b)
                self._add(b, "thrusters", turn.apply(force), np.cross(one.position_b_m, force))
            thruster += len(record.thruster)
            for k, one in enumerate(record.conductor, conductor):
                wire = one.length_m * np.array(one.direction_b)
                force = self.inputs.current[k] * np.cross(wire, turn.inv().apply(self.field(r, self.ei)))
                self._add(b, "conductors", turn.apply(force), np.cross(one.position_b_m, force))
            conductor += len(record.conductor)
            if record.kind == "point":
                continue
            inertia = tensor(record.inertia_kg_m2)
            field = turn.inv().apply(self.field(r, self.ei))
            if record.gravity_gradient:
                up = turn.inv().apply(r / np.linalg.norm(r))
                self._add(b, "gravity_gradient", zero, 3 * GM / np.linalg.norm(r) ** 3 * np.cross(up, inertia @ up))
            for k, one in enumerate(record.magnetorquer, torquer):
                self._add(b, "torquers", zero, np.cross(self._dipole(k, one) * np.array(one.axis_b), field))
            torquer += len(record.magnetorquer)
            still = np.array(record.residual_dipole_a_m2) + tensor(record.induced_dipole_a_m2_tesla) @ field
            self._add(b, "dipoles", zero, np.cross(still, field))
            induced = -tensor(record.eddy_damping_n_m_s_tesla2) @ np.cross(field, omega)
            self._add(b, "eddy_currents", zero, np.cross(induced, field))
            self._add(b, "disturbance", zero, record.disturbance_torque_b_n_m + turn.inv().apply(record.disturbance_torque_i_n_m))
            for k, one in enumerate(record.hysteresis_rod, rod):
                self._rod(b, wheels + k, one, r, v, turn, omega, field)
            rod += len(record.hysteresis_rod)
            for k, one in enumerate(record.wheel, wheel):
                momentum, torque = self.tail[k], self.inputs.wheel_torque[k]
                self.extra[k] = torque
                self._add(b, "wheels", zero, -torque * np.array(one.axis_b))
                self.gyro[b] += momentum * np.array(one.axis_b)
            wheel += len(record.wheel)
        self._lines()
        self._user()

    def _add(self, b, name, force, torque):
        old = self.loads[b].get(name, (np.zeros(3), np.zeros(3)))
        self.loads[b][name] = (old[0] + force, old[1] + torque)

    def _outside(self, b, record, r, v, turn):
        self._add(b, "gravity", record.mass_kg * self.pull(r), np.zeros(3))
        if record.drag is not None:
            wind = v - np.cross(SPIN * self.ei[2], r)
            air = self.scenario.environment.atmosphere
            height = geodetic_kernel(tuple(self.ei @ r))[2]
            density = air.reference_density_kg_m3 * np.exp(-(height / 1e3 - air.reference_altitude_km) / air.scale_height_km)
            force = -0.5 * density * record.drag.drag_coefficient * record.drag.area_m2 * np.linalg.norm(wind) * wind
            self._add(b, "drag", force, np.cross(record.drag.center_of_pressure_b_m, turn.inv().apply(force)))
        if record.solar_pressure is not None:
            light = record.solar_pressure
            away = r - self.sun
            pressure = SOLAR_CONSTANT / LIGHT * (AU / np.linalg.norm(away)) ** 2
            force = self.sunlit(r) * pressure * light.reflectivity_coefficient * light.area_m2 * away / np.linalg.norm(away)
            self._add(b, "solar_pressure", force, np.cross(light.center_of_pressure_b_m, turn.inv().apply(force)))

    def pull(self, r):
        """Gravity at a place [m/s^2]."""
        distance = np.linalg.norm(r)
        g = -GM * r / distance**3
        if self.scenario.environment.gravity == "j2":
            pole = self.ei[2]
            z = r @ pole
            g = g - 1.5 * J2 * GM * RADIUS**2 / distance**5 * ((1 - 5 * z**2 / distance**2) * r + 2 * z * pole)
        return g

    def sunlit(self, r):
        """Share of the Sun's disc that is not behind the Earth's, by areas of circular segments."""
        to_sun = self.sun - r
        a, b = np.arcsin(SUN_RADIUS / np.linalg.norm(to_sun)), np.arcsin(RADIUS / np.linalg.norm(r))
        c = np.arctan2(np.linalg.norm(np.cross(-r, to_sun)), -r @ to_sun)
        if c >= a + b:
            return 1.0
        if c <= b - a:
            return 0.0
        x, y = np.arccos((c * c + a * a - b * b) / (2 * c * a)), np.arccos((c * c + b * b - a * a) / (2 * c * b))
        hidden = a * a * (x - np.sin(x) * np.cos(x)) + b * b * (y - np.sin(y) * np.cos(y))
        return 1.0 - hidden / (np.pi * a * a)

    def field(self, r, ei):
        """Of the scenario's centred dipole, or its uniform field [T], inertial axes."""
        environment = self.scenario.environment
        if environment.uniform_field_i_tesla is not None:
            return np.array(environment.uniform_field_i_tesla)
        moment, distance = ei.T @ np.array(environment.field_moment_e_a_m2[0]), np.linalg.norm(r)
        return 1e-7 * (3 * r * (moment @ r) / distance**5 - moment / distance**3)

    def _dipole(self, k, one):
        start, end, since = self.inputs.dipole_from[k], self.inputs.dipole_to[k], self.inputs.dipole_since[k]
        if one.time_constant_s == 0.0:
            return end
        return start + (end - start) * (1 - np.exp(-(self.t - since) / one.time_constant_s))

    def _rod(self, b, k, one, r, v, turn, omega, field):
        """Flatley and Henretty: B = 2 Bs/pi atan(K (H -+ Hc)) are the limiting branches."""
        ahead = self.field(r + v, self.later) - self.field(r, self.ei)
        rising = turn.inv().apply(ahead) - np.cross(omega, field)
        axis = np.array(one.axis_b)
        strength, rate, b_rod = axis @ field / MU0, axis @ rising / MU0, self.tail[k]
        steep = np.tan(np.pi * one.remanence_tesla / (2 * one.saturation_tesla)) / one.coercivity_a_m
        middle = np.tan(np.pi * b_rod / (2 * one.saturation_tesla)) / steep
        side = 1.0 if rate >= 0 else -1.0
        part = np.clip((one.coercivity_a_m + side * (strength - middle)) / (2 * one.coercivity_a_m), 0, 1)
        slope = 2 * one.saturation_tesla * steep / np.pi * np.cos(np.pi * b_rod / (2 * one.saturation_tesla)) ** 2
        self.extra[k] = slope * part**2 * rate
        self._add(b, "hysteresis", np.zeros(3), np.cross(b_rod * one.volume_m3 / MU0 * axis, field))

    def _lines(self):
        """Every line of the scenario: see `textbook_line`."""
        wheels = sum(len(b.wheel) for b in self.scenario.body)
        rods = sum(len(b.hysteresis_rod) for b in self.scenario.body)
        nodes = wheels + rods
        feeds = nodes + 6 * sum(line.nodes for line in self.scenario.line)
        slider = 0
        for k, line in enumerate(self.scenario.line):
            one = TextbookLine(self, k, line, nodes, feeds + 2 * k, slider)
            for b, force, torque in one.on_bodies:
                self._add(b, "lines", force, torque)
            for b, mass, point in one.end_masses:
                self.end_masses[b].append((mass, point))
            self.extra[nodes : nodes + one.rates.size] = one.rates
            self.extra[feeds + 2 * k : feeds + 2 * k + 2] = one.feed_rates
            nodes += 6 * line.nodes
            slider += len(line.slider)

    def _user(self):
        import user_functions

        for b, record in enumerate(self.scenario.body):
            for one in record.load:
                function = getattr(user_functions, one.function.split(":")[1])
                six = getattr(function, "py_func", function)(self.t, self.rows[b], list(one.parameters.values()))
                self._add(b, "user", np.array(six[:3]), np.array(six[3:]))

    def _burdened(self, b, record, force, torque):
        """Newton and Euler for a body and the point masses fixed in it, column by column of the 6 x 6 mass matrix, body axes."""
        turn, omega, inertia = Rotation.from_quat(self.rows[b, 6:10]), self.rows[b, 10:13], tensor(record.inertia_kg_m2)
        moved = record.mass_kg + sum(mass for mass, point in self.end_masses[b] if point is None)
        points = [(mass, np.array(point)) for mass, point in self.end_masses[b] if point is not None]
        columns = []
        for unit in np.eye(6):
            a, alpha = unit[:3], unit[3:]
            pushes = [mass * (a + np.cross(alpha, point)) for mass, point in points]
            levers = [np.cross(point, push) for (_, point), push in zip(points, pushes, strict=True)]
            columns.append(np.concatenate([moved * a + sum(pushes), inertia @ alpha + sum(levers)]))
        inward = [mass * np.cross(omega, np.cross(omega, point)) for mass, point in points]
        force = turn.inv().apply(force) - sum(inward)
        torque = torque - sum(np.cross(point, f) for (_, point), f in zip(points, inward, strict=True))
        both = np.linalg.solve(
            np.array(columns).T, np.concatenate([force, torque - np.cross(omega, inertia @ omega + self.gyro[b])])
        )
        return turn.apply(both[:3]), both[3:]

    def rates(self):
        """dz/dt with sigma = 0: velocity, acceleration, rate, angular acceleration; wheels and rods."""
        out = []
        for b, record in enumerate(self.scenario.body):
            force = sum(f for f, _ in self.loads[b].values())
            if record.kind == "point":
                out += [*self.rows[b, 3:6], *(force / (record.mass_kg + sum(m for m, _ in self.end_masses[b]))), *np.zeros(6)]
                continue
            if self.end_masses[b]:
                torque = sum(n for _, n in self.loads[b].values())
                along, turning = self._burdened(b, record, force, torque)
                out += [*self.rows[b, 3:6], *along, *self.rows[b, 10:13], *turning]
                continue
            out += [*self.rows[b, 3:6], *(force / record.mass_kg)]
            torque = sum(n for _, n in self.loads[b].values())
            omega, inertia = self.rows[b, 10:13], tensor(record.inertia_kg_m2)
            whole = inertia @ omega + self.gyro[b]
            out += [*omega, *np.linalg.solve(inertia, torque - np.cross(omega, whole))]
        return np.array([*out, *self.extra])
