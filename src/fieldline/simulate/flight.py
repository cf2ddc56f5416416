"""One run: everything that the compiled loop works on, and how it is driven.

    flight = Flight(scenario)
    flight.fly(progress)          # returns when the run is done, stopped or broken, or is interrupted
    dataset = flight.dataset()    # what was simulated, whole or in part

The loop comes back every fraction of a second, so that progress is shown and Ctrl-C is heard.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

from fieldline.dynamics.implicit_step import EVALUATIONS
from fieldline.dynamics.layout import starts_in_state
from fieldline.dynamics.parameters import TANGENT, tangent_size
from fieldline.dynamics.rates import EVENT_AT_WORK, LAW_AT_WORK, LOAD_AT_WORK
from fieldline.dynamics.step import new_shared, new_work
from fieldline.errors import InputError, shown
from fieldline.integrate.tableau import DOP853, RK4
from fieldline.packed import pack
from fieldline.simulate.assembly import boards as made
from fieldline.simulate.assembly.actuators import actuators_of, inputs_of
from fieldline.simulate.assembly.design import Design
from fieldline.simulate.assembly.functions import UserFunctions, events_of
from fieldline.simulate.assembly.host import Host
from fieldline.simulate.assembly.plant import plant_of
from fieldline.simulate.assembly.software import place, software_of, tasks_of
from fieldline.simulate.assembly.start import start_of
from fieldline.simulate.interruption import noted
from fieldline.simulate.loop.fly import fly
from fieldline.simulate.loop.records import Outcome, Run, Stepping
from fieldline.simulate.scenario.line_tolerance import allowed
from fieldline.simulate.scenario.states import period_s, start_states

FLOOR_M = 80e3  # height below which neither orbit nor air models mean anything
NOISE_STREAM = 0x6E6F6973  # keeps the sensors' draws apart from those of the start
TEMPERATURE_TOLERANCE_K = 1e-3
CHUNK_S = 0.2  # of wall time between returns
FIRST_CHUNK = 200  # steps
RAISED_COMPILED = {LAW_AT_WORK: Outcome.LAW_RAISED, LOAD_AT_WORK: Outcome.LOAD_RAISED, EVENT_AT_WORK: Outcome.EVENT_FAILED}


class Flight:
    """A scenario made ready to fly; see the module."""

    def __init__(self, scenario, seed: int | None = None):
        """Everything is checked and made here; `seed` replaces the scenario's."""
        self.scenario = scenario
        self.seed = scenario.seed if seed is None else as_seed(seed)
        self.rng = np.random.default_rng([self.seed, NOISE_STREAM])
        self.duration_s = scenario.time.length_s(period_s(*start_states(scenario)[0]))
        self.host = Host()
        user = UserFunctions(scenario, self.host)
        self.load_names = user.load_names
        self.plant = plant_of(scenario, self.duration_s, user.loads)
        self.y = start_of(scenario, self.plant, self.seed)
        self.start = self.y.copy()
        self.actuators = actuators_of(scenario)
        self.shared = new_shared(self.plant, len(self.actuators.body))
        self.host.connect(self.shared)
        user.connect(self.shared)
        self.software = software_of(scenario, Design(scenario, self.plant))
        self.tasks = tasks_of(self.software, self.actuators)
        self.boards = made.boards_of(scenario)
        self.laws, self.memories, self.parameters = place(self.software, self.tasks, self.boards, self.host)
        middle = scenario.time.start + np.timedelta64(round(0.5e9 * self.duration_s), "ns")
        estimated = [any(t.body == b and t.record.role == "estimator" for t in self.software) for b in range(len(scenario.body))]
        self.sensors = made.sensors_of(scenario, self.plant, estimated, middle)
        self.inputs = inputs_of(scenario, self.plant)
        self.schedule = made.schedule_of(scenario, self.plant, self.software, scenario.time.output_step_s)
        self.stepping = stepping_of(scenario, self.plant, self.duration_s)
        self.events = events_of(scenario, user.events)
        self.record = made.record_of(scenario, self.plant, self.schedule, len(self.actuators.body), self.duration_s)
        self.clock = made.clock_of(scenario.integrator.step_s)
        implicit = scenario.integrator.method == "rosenbrock"
        self.work = new_work(
            self.plant,
            EVALUATIONS if implicit else self.stepping.tableau.evaluations,
            once_a_step=scenario.integrator.field_update == "step",
            implicit=implicit,
        )
        self.loads = user.slots.filled()
        self.run = Run(
            self.y, np.empty_like(self.y), self.plant, self.inputs, self.schedule, self.stepping, self.sensors, self.boards,
            self.tasks, self.actuators, self.events, self.record, self.clock, self.shared, self.work,
        )  # fmt: skip
        self.packed = pack(self.run)
        self.outcome = Outcome.PAUSED
        self.interrupted = False

    def fly(self, progress: Callable[[float], None] | None = None) -> Outcome:
        """Fly to the end, or until something ends the run; `progress` is told the fraction done."""
        chunk = FIRST_CHUNK
        try:
            with noted(self.host):
                while self.outcome == Outcome.PAUSED and self.host.error is None:
                    begun = time.perf_counter()
                    self.outcome = Outcome(self._fly_on(chunk))
                    spent = time.perf_counter() - begun
                    chunk = int(min(max(chunk * CHUNK_S / max(spent, 1e-6), chunk / 4, 10), 4 * chunk, 1e7))
                    if progress is not None:
                        progress(min(self.clock.t[0] / self.duration_s, 1.0))
        except KeyboardInterrupt:
            self.interrupted = True
        except Exception as error:
            self._failed(error)
        if isinstance(self.host.error, KeyboardInterrupt):
            self.interrupted = True
        elif self.host.error is not None and self.outcome in (Outcome.PAUSED, Outcome.DONE):
            self.outcome = Outcome.LOAD_RAISED  # in the last look at the loads, for the record
        return self.outcome

    def _failed(self, error: Exception) -> None:
        """Blame a compiled function of the user's; what an interruption breaks in the compiler is no fault."""
        if isinstance(self.host.error, KeyboardInterrupt):
            return
        if self.shared.culprit[2] == 0:
            raise error
        self.outcome = RAISED_COMPILED[int(self.shared.culprit[2])]
        self.host.error = error

    def _fly_on(self, budget: int) -> int:
        """Some steps of the loop."""
        return fly(budget, self.packed, self.laws, self.memories, self.parameters, self.loads, self.host.callback, self.rng)

    @property
    def complete(self) -> bool:
        """Whether the run went to its end, or to an event that was to stop it."""
        return self.outcome in (Outcome.DONE, Outcome.STOPPED) and not self.interrupted


def as_seed(seed: int) -> int:
    """A seed that the generator takes; InputError for any other."""
    if isinstance(seed, bool) or not isinstance(seed, int | np.integer) or not 0 <= seed < 2**63:
        raise InputError(f"seed must be a whole number from 0 to 2^63 - 1; got {shown(repr(seed))}.")
    return int(seed)


def stepping_of(scenario, plant, duration_s: float) -> Stepping:
    """Method, step and tolerances."""
    integrator = scenario.integrator
    adaptive = integrator.method != "rk4"
    absolute = np.full(tangent_size(plant), integrator.rate_tolerance_rad_s)
    relative, position = allowed(scenario)
    each = [position] * 3 + [integrator.velocity_tolerance_m_s] * 3
    each += [integrator.angle_allowed_rad] * 3 + [integrator.rate_tolerance_rad_s] * 3
    bodies = len(plant.bodies.mass)
    for b in range(bodies):
        absolute[TANGENT * b : TANGENT * (b + 1)] = each
    nodes, feeds, temperatures = (start - bodies for start in starts_in_state(plant))
    absolute[nodes:feeds] = np.tile(each[:6], (feeds - nodes) // 6)
    absolute[feeds:temperatures] = np.tile([each[0], each[3]], (temperatures - feeds) // 2)
    absolute[temperatures:] = TEMPERATURE_TOLERANCE_K
    return Stepping(
        tableau=DOP853 if adaptive else RK4,
        adaptive=adaptive,
        step=(integrator.step_max_s or 1e9) if adaptive else integrator.step_s,
        relative=relative,
        absolute=absolute,
        end=duration_s,
        floor=FLOOR_M,
    )
