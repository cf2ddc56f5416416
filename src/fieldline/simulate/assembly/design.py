"""What the designers of flight software know beforehand: inertia, actuators, and the field along the nominal orbit."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from fieldline.constants import EARTH_GM_M3_S2
from fieldline.mechanics.rigid_body import as_inertia9
from fieldline.simulate.assembly.boards import onboard_model
from fieldline.simulate.scenario.states import start_states

SAMPLES_PER_ORBIT = 120
DAY_S = 86400.0


class Design:
    """design(body, period_s) is the `DesignContext` of a law of that body, called every period_s."""

    def __init__(self, scenario, plant):
        """Kept until a law asks."""
        self._scenario = scenario

    def __call__(self, b: int, period_s: float):
        """The context; the field is worked out when a law asks for it."""
        from fieldline.control import DesignContext

        body = self._scenario.body[b]
        near = 0 if body.offset_o_m is not None else b  # a body beside the first shares its orbit
        position, velocity = start_states(self._scenario)[near]
        momentum = np.cross(position, velocity)
        energy = 0.5 * velocity @ velocity - EARTH_GM_M3_S2 / np.linalg.norm(position)
        axis = -0.5 * EARTH_GM_M3_S2 / energy
        mean_motion = float(np.sqrt(EARTH_GM_M3_S2 / axis**3))
        moments = [np.abs(one.axis_b) * one.moment_max_a_m2 for one in body.magnetorquer]
        return DesignContext(
            inertia_kg_m2=np.eye(3) if body.kind == "point" else np.reshape(as_inertia9(body.inertia_kg_m2)[0], (3, 3)),
            mean_motion_rad_s=mean_motion,
            inclination_rad=float(np.arccos(np.clip(momentum[2] / np.linalg.norm(momentum), -1.0, 1.0))),
            period_s=period_s,
            moment_max_a_m2=np.sum(moments, axis=0) if moments else np.zeros(3),
            wheel_axes_b=np.array([one.axis_b for one in body.wheel]).reshape(-1, 3),
            field_along_orbit=lambda: field_along(self._scenario, b, position, velocity, 2.0 * np.pi / mean_motion),
            mass_kg=body.mass_kg,
            radius_m=float(axis),
            conductors=body.conductor,
            thrusters=body.thruster,
            lines=line_ends_on(self._scenario, body.name),
        )


def line_ends_on(scenario, name: str):
    """Ends of lines on a body, as its laws know them."""
    from fieldline.control.law import LineEnd

    found = []
    for line in scenario.line:
        for end in ("from", "to"):
            if getattr(line, f"{end}_body") == name:
                axes = tuple(one.axis_b for one in line.slider if one.end == end)
                reel = _reel_at(line) if end == "to" and line.reel is not None else {}
                found.append(LineEnd(getattr(line, f"{end}_point_b_m"), slider_axes_b=axes, **reel))
    return tuple(found)


def _reel_at(line) -> dict:
    """What a law may know of a line's reel."""
    reel = line.reel
    lag = reel.lag_s if reel.mode == "rate" else 0.0
    return {"reel": reel.mode, "shortest_m": reel.shortest_length_m, "longest_m": reel.total_length_m, "lag_s": lag}


def field_along(scenario, b: int, position, velocity, period_s: float):
    """(seconds, field_o, field_i) of body b's on-board model over the nominal orbits of about a day from a state [T].

    The orbit has the oblateness but no air; a day lets the Earth turn once under it.
    """
    from fieldline.environment.field import magnetic_field
    from fieldline.frames.earth_rotation import dcm_ei
    from fieldline.frames.orbital import dcm_oi

    position, velocity = nominal_orbit(tuple(position), tuple(velocity), period_s)
    seconds = np.arange(len(position)) * period_s / SAMPLES_PER_ORBIT
    model = onboard_model(scenario, scenario.body[b])
    if model is None:
        field_i = np.broadcast_to(np.array(scenario.environment.uniform_field_i_tesla), position.shape).copy()
    else:
        times = scenario.time.start + (1e9 * seconds).astype("timedelta64[ns]")
        turn = dcm_ei(times)
        field_e = magnetic_field(np.einsum("nij,nj->ni", turn, position), times, model)
        field_i = np.einsum("nji,nj->ni", turn, field_e)
    return seconds, np.einsum("nij,nj->ni", dcm_oi(position, velocity), field_i), field_i


@lru_cache(maxsize=8)
def nominal_orbit(position: tuple, velocity: tuple, period_s: float) -> tuple[np.ndarray, np.ndarray]:
    """Positions and velocities, GCRS axes, over the whole orbits of about a day, with the oblateness alone; kept."""
    from scipy.integrate import solve_ivp

    from fieldline.environment.gravity import gravity_kernel, gravity_model

    gravity = gravity_model("j2")
    orbits = max(1, round(DAY_S / period_s))
    times = np.arange(orbits * SAMPLES_PER_ORBIT) * period_s / SAMPLES_PER_ORBIT

    def rate(_, s):
        return [*s[3:], *gravity_kernel((s[0], s[1], s[2]), gravity)]

    flown = solve_ivp(rate, (0.0, times[-1]), [*position, *velocity], "DOP853", times, rtol=1e-9, atol=1e-3)
    return flown.y[:3].T.copy(), flown.y[3:].T.copy()
