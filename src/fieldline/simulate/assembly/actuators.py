"""All actuators of a scenario along one axis, kind after kind: whose software commands each, within what limits."""

from __future__ import annotations

import numpy as np

from fieldline.dynamics.parameters import Inputs, Plant
from fieldline.simulate.assembly.circuits import command_limits, told_at_first
from fieldline.simulate.assembly.lines import sliders
from fieldline.simulate.assembly.plant import each
from fieldline.simulate.loop import records as loop

KINDS = ("dipole", "wheel_torque", "thrust", "current", "current", "reel", "attachment")  # the group that commands each kind


def actuators_of(scenario) -> loop.Actuators:
    """Torquers, wheels, thrusters, conductors, circuits, reels and sliders."""
    kinds = _kinds(scenario)
    everything = [one for kind in kinds for one in kind]
    body, target, lower, limit, quantum = (list(column) for column in zip(*everything, strict=True)) if everything else ([],) * 5
    thrusters = each(scenario.body, "thruster")
    return loop.Actuators(
        body=np.array(body, dtype=np.int64),
        ends=np.cumsum([len(kind) for kind in kinds]).astype(np.int64),
        target=np.array(target, dtype=np.int64),
        share=_shares(scenario, len(everything)),
        lower=np.array(lower, dtype=float),
        limit=np.array(limit, dtype=float),
        quantum=np.array(quantum, dtype=float),
        off=np.zeros(len(scenario.body), dtype=np.int64),
        wanted=np.zeros(len(everything)),
        least=np.array([one.minimum_on_time_s for _, one in thrusters], dtype=float),
        until=np.full(len(thrusters), loop.NEVER),
    )


def _kinds(scenario) -> list[list[tuple[int, int, float, float, float]]]:
    """(body, row of its kind, lower limit, upper limit, quantum) of each actuator, kind by kind."""
    bodies, lines = scenario.body, scenario.line
    at_end = [scenario.index_of(line.to_body) for line in lines]
    return [
        [(b, k, -m.moment_max_a_m2, m.moment_max_a_m2, m.quantum_a_m2) for k, (b, m) in enumerate(each(bodies, "magnetorquer"))],
        [(b, k, -w.torque_max_n_m, w.torque_max_n_m, w.quantum_n_m) for k, (b, w) in enumerate(each(bodies, "wheel"))],
        [(b, k, 0.0, 1.0, 0.0) for k, (b, _) in enumerate(each(bodies, "thruster"))],
        [(b, k, -c.current_max_a, c.current_max_a, 0.0) for k, (b, c) in enumerate(each(bodies, "conductor"))],
        [(at_end[k], k, *command_limits(line.circuit), 0.0) for k, line in enumerate(lines) if obeys(line)],
        [(at_end[k], k, *_reel_limits(line.reel), 0.0) for k, line in enumerate(lines) if line.reel is not None],
        [(_body_of(scenario, k, one), j, -one.travel_m, one.travel_m, 0.0) for j, (k, one) in enumerate(sliders(scenario))],
    ]


def obeys(line) -> bool:
    """Whether a law commands a line's circuit."""
    return line.circuit is not None and line.circuit.commanded


def _reel_limits(reel) -> tuple[float, float]:
    """Least and largest command of a reel."""
    return (-reel.rate_max_m_s, reel.rate_max_m_s) if reel.mode == "rate" else (0.0, reel.tension_max_n)


def _body_of(scenario, k: int, slider) -> int:
    """The body that a slider of line k is on."""
    return scenario.index_of(getattr(scenario.line[k], f"{slider.end}_body"))


def _shares(scenario, count: int) -> np.ndarray:
    """(count, 3): rows of the pseudo-inverse of the axes, for torquers and wheels; a wheel's motor turns the body back."""
    share = np.zeros((count, 3))
    first = 0
    for key, sign in (("magnetorquer", 1.0), ("wheel", -1.0)):
        pairs = each(scenario.body, key)
        for body in range(len(scenario.body)):
            rows = [k for k, (owner, _) in enumerate(pairs) if owner == body]
            if rows:
                axes = np.array([pairs[k][1].axis_b for k in rows])
                share[[first + k for k in rows]] = sign * np.linalg.pinv(axes.T)
        first += len(pairs)
    return share


def inputs_of(scenario, plant: Plant) -> Inputs:
    """No command yet: reels do what their records say, sliders stand where they start."""
    torquers = len(plant.torquers.body)
    place = np.array([one.start_m for _, one in sliders(scenario)], dtype=float)
    reels = [line.reel for line in scenario.line]
    told = [0.0 if reel is None else reel.rate_m_s if reel.mode == "rate" else reel.tension_n for reel in reels]
    return Inputs(
        dipole_from=np.zeros(torquers),
        dipole_to=np.zeros(torquers),
        dipole_since=np.zeros(torquers),
        wheel_torque=np.zeros(len(plant.wheels.body)),
        thrust=np.zeros(len(plant.thrusters.body)),
        current=np.zeros(len(plant.conductors.body)),
        circuit=told_at_first(scenario),
        reel=np.array(told, dtype=float),
        slide_from=place.copy(),
        slide_to=place.copy(),
        slide_since=np.zeros(len(place)),
    )
