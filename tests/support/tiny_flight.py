"""A flight small enough for tests of laws: a circular orbit in the field of a rotating tilted dipole, Euler's equation, wheels.

Independent of the library's plant on purpose: a law that works in both does not lean on the plant's habits.
"""

from dataclasses import dataclass, field
from math import cos, pi, sin, sqrt

import numpy as np
from numba import njit

from fieldline.constants import EARTH_GM_M3_S2, EARTH_ROTATION_RATE_RAD_S
from fieldline.control.law import DesignContext
from fieldline.frames.attitude import quat_mul, quat_unit, to_body
from fieldline.frames.matrices import matvec
from fieldline.frames.vectors import add, axpy, cross, dot, scale, sub
from fieldline.mechanics.rigid_body import gravity_gradient_torque
from fieldline.sensing.measurement import new_measurement

EARTH_MOMENT_TESLA_M3 = 7.8e15  # mu0 M / 4 pi
TILT = 0.17  # rad, today's


@njit(cache=True)
def dipole_field_i(t, r_i):
    """Field [T] of a dipole that is tilted and turns with the Earth."""
    angle = EARTH_ROTATION_RATE_RAD_S * t
    axis = (-sin(TILT) * cos(angle), -sin(TILT) * sin(angle), -cos(TILT))
    distance = sqrt(dot(r_i, r_i))
    u = scale(1.0 / distance, r_i)
    return scale(EARTH_MOMENT_TESLA_M3 / distance**3, sub(scale(3.0 * dot(axis, u), u), axis))


@njit(cache=True)
def place(t, radius, inclination):
    """Position [m] and velocity [m/s] on a circular orbit from its node at t = 0."""
    n = sqrt(EARTH_GM_M3_S2 / radius**3)
    c, s = cos(n * t), sin(n * t)
    ci, si = cos(inclination), sin(inclination)
    return (radius * c, radius * s * ci, radius * s * si), (-radius * n * s, radius * n * c * ci, radius * n * c * si)


@njit(cache=True)
def _rates(t, q, omega, h, orbit, inertia, inverse, moment, wheel_torque, fixed_torque, drag):
    r, v = place(t, orbit[0], orbit[1])
    torque = add(cross(moment, to_body(q, dipole_field_i(t, r))), add(wheel_torque, fixed_torque))
    torque = add(torque, gravity_gradient_torque(to_body(q, r), inertia, orbit[2]))
    wind = to_body(q, scale(-1.0 / sqrt(dot(v, v)), v))
    torque = add(torque, cross(drag, wind))
    whole = add(matvec(inertia, omega), h)
    dq = quat_mul(q, (0.5 * omega[0], 0.5 * omega[1], 0.5 * omega[2], 0.0))
    return dq, matvec(inverse, sub(torque, cross(omega, whole))), scale(-1.0, wheel_torque)


@njit(cache=True)
def _moved(q, dq, dt):
    return (q[0] + dt * dq[0], q[1] + dt * dq[1], q[2] + dt * dq[2], q[3] + dt * dq[3])


@njit(cache=True)
def step(t, q, omega, h, dt, orbit, inertia, inverse, moment, wheel_torque, fixed_torque, drag):
    """One classical Runge-Kutta step of attitude, rate and wheel momentum (body axes)."""
    more = (orbit, inertia, inverse, moment, wheel_torque, fixed_torque, drag)
    a0, b0, c0 = _rates(t, q, omega, h, *more)
    a1, b1, c1 = _rates(t + dt / 2, _moved(q, a0, dt / 2), axpy(dt / 2, b0, omega), axpy(dt / 2, c0, h), *more)
    a2, b2, c2 = _rates(t + dt / 2, _moved(q, a1, dt / 2), axpy(dt / 2, b1, omega), axpy(dt / 2, c1, h), *more)
    a3, b3, c3 = _rates(t + dt, _moved(q, a2, dt), axpy(dt, b2, omega), axpy(dt, c2, h), *more)
    q = _moved(_moved(_moved(_moved(q, a0, dt / 6), a1, dt / 3), a2, dt / 3), a3, dt / 6)
    omega = axpy(dt / 6, add(b0, b3), axpy(dt / 3, add(b1, b2), omega))
    return quat_unit(q), omega, axpy(dt / 6, add(c0, c3), axpy(dt / 3, add(c1, c2), h))


@dataclass
class TinyFlight:
    """A satellite that a law steers: perfect sensors unless `noise` says otherwise, three wheels along the body axes."""

    inertia: tuple = (1.0, 1.0, 1.0)
    altitude_km: float = 500.0
    inclination_deg: float = 60.0
    gravity_gradient: bool = True
    residual_dipole: tuple = (0.0, 0.0, 0.0)
    fixed_torque: tuple = (0.0, 0.0, 0.0)  # N m, body axes
    drag: tuple = (0.0, 0.0, 0.0)  # N m: force times the arm of the centre of pressure, body axes
    moment_max: float = 1.0
    period_s: float = 5.0
    substeps: int = 1
    noise: dict = field(default_factory=dict)  # standard deviations: field [T], rate [rad/s], angle [rad]
    seed: int = 0

    def __post_init__(self):
        self.radius = 6371e3 + 1e3 * self.altitude_km
        self.inclination = np.radians(self.inclination_deg)
        self.mean_motion = sqrt(EARTH_GM_M3_S2 / self.radius**3)
        self.orbit_s = 2.0 * pi / self.mean_motion
        self.orbit = (self.radius, float(self.inclination), EARTH_GM_M3_S2 if self.gravity_gradient else 0.0)
        self.matrix = np.diag(self.inertia).astype(float) if np.ndim(self.inertia) == 1 else np.array(self.inertia, dtype=float)

    def context(self, orbits: int = 15) -> DesignContext:
        return DesignContext(
            inertia_kg_m2=self.matrix,
            mean_motion_rad_s=self.mean_motion,
            inclination_rad=float(self.inclination),
            period_s=self.period_s,
            moment_max_a_m2=np.full(3, self.moment_max),
            wheel_axes_b=np.eye(3),
            field_along_orbit=lambda: self.field_along_orbit(orbits),
        )

    def field_along_orbit(self, orbits: int):
        seconds = np.linspace(0.0, orbits * self.orbit_s, 90 * orbits + 1)
        field_i, field_o = np.empty((seconds.size, 3)), np.empty((seconds.size, 3))
        for k, t in enumerate(seconds):
            r, v = place(t, self.radius, self.inclination)
            field_i[k] = dipole_field_i(t, r)
            field_o[k] = self.orbital_dcm(r, v) @ field_i[k]
        return seconds, field_o, field_i

    @staticmethod
    def orbital_dcm(r, v) -> np.ndarray:
        """Rows are the orbital axes in inertial ones: v_o = dcm @ v_i."""
        z = -np.array(r) / np.linalg.norm(r)
        y = -np.cross(r, v) / np.linalg.norm(np.cross(r, v))
        return np.array([np.cross(y, z), y, z])

    def measure(self, into, t, q, omega, h, moment, rng):
        r, v = place(t, self.radius, self.inclination)
        field_i = dipole_field_i(t, r)
        noise = self.noise
        into.field_b[:] = np.array(to_body(q, field_i)) + noise.get("field", 0.0) * rng.standard_normal(3)
        into.field_time_s[0] = t
        into.rate_b[:] = np.array(omega) + noise.get("rate", 0.0) * rng.standard_normal(3)
        into.omega_bi_b[:] = into.rate_b
        e = 0.5 * noise.get("angle", 0.0) * rng.standard_normal(3)
        into.q_bi[:] = quat_unit(quat_mul(q, (e[0], e[1], e[2], 1.0)))
        into.position_i[:], into.velocity_i[:], into.field_i[:] = r, v, field_i
        into.wheel_momentum[:] = h
        into.dipole_b[:] = moment
        into.valid[:] = 1.0

    def fly(self, law, params, orbits, q=(0.0, 0.0, 0.0, 1.0), omega=(0.0, 0.0, 0.0), h=(0.0, 0.0, 0.0), spoil=None):
        """{time, q, omega, h, moment, memory} arrays at the law's calls; `spoil(k, measurement)` may damage a measurement."""
        rng = np.random.default_rng(self.seed)
        measurement, memory = new_measurement(0, 3), np.zeros(law.memory)
        inertia = tuple(map(float, self.matrix.ravel()))
        inverse = tuple(map(float, np.linalg.inv(self.matrix).ravel()))
        q, omega, h = (tuple(map(float, x)) for x in (q, omega, h))
        residual = tuple(map(float, self.residual_dipole))
        fixed, drag = tuple(map(float, self.fixed_torque)), tuple(map(float, self.drag))
        dt = self.period_s / self.substeps
        rows, moment = [], (0.0, 0.0, 0.0)
        for k in range(int(orbits * self.orbit_s / self.period_s)):
            t = k * self.period_s
            self.measure(measurement, t, q, omega, h, moment, rng)
            if spoil is not None:
                spoil(k, measurement)
            moment, wheel = self.split(law, law.kernel(t, measurement, memory, params))
            rows.append((t, *q, *omega, *h, *moment))
            whole = (moment[0] + residual[0], moment[1] + residual[1], moment[2] + residual[2])
            for j in range(self.substeps):
                q, omega, h = step(t + j * dt, q, omega, h, dt, self.orbit, inertia, inverse, whole, wheel, fixed, drag)
        table = np.array(rows)
        return {
            "t": table[:, 0],
            "q": table[:, 1:5],
            "omega": table[:, 5:8],
            "h": table[:, 8:11],
            "moment": table[:, 11:14],
            "memory": memory,
        }

    def split(self, law, command):
        assert np.isfinite(command).all() and len(command) == 3 * len(law.commands)
        groups = {name: tuple(map(float, command[3 * k : 3 * k + 3])) for k, name in enumerate(law.commands)}
        zero = (0.0, 0.0, 0.0)
        moment = tuple(float(x) for x in np.clip(groups.get("dipole", zero), -self.moment_max, self.moment_max))
        return moment, groups.get("wheel_torque", zero)

    def nadir_quaternion(self, t=0.0, turned_rad=(0.0, 0.0, 0.0)):
        """q_bi of a body that is turned by a rotation vector from the orbital axes."""
        from scipy.spatial.transform import Rotation

        orbital = Rotation.from_matrix(self.orbital_dcm(*place(t, self.radius, self.inclination)).T)
        return (orbital * Rotation.from_rotvec(turned_rad)).as_quat()

    def nadir_rotation(self, flown):
        """SciPy rotations from the body to the orbital axes at every row."""
        from scipy.spatial.transform import Rotation

        orbital = np.array([self.orbital_dcm(*place(t, self.radius, self.inclination)).T for t in flown["t"]])
        return Rotation.from_matrix(orbital).inv() * Rotation.from_quat(flown["q"])

    def nadir_error_deg(self, flown) -> np.ndarray:
        """(n,) [deg] angle between body and orbital axes."""
        return np.degrees(self.nadir_rotation(flown).magnitude())
