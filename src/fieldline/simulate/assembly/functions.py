"""The user's loads and events of a scenario, in slots or behind numbers of the host."""

from __future__ import annotations

import numpy as np

from fieldline.dynamics.parameters import PLAIN_LOAD
from fieldline.simulate.assembly.host import Host, Slots, compiled, function_of, is_compiled
from fieldline.simulate.assembly.lines import line_names
from fieldline.simulate.assembly.plant import loads_of
from fieldline.simulate.loop import records as loop
from fieldline.simulate.loop.functions import LOAD, no_load
from fieldline.simulate.loop.records import PLAIN_EVENT

KIND = {"eclipse": loop.ECLIPSE, "altitude": loop.ALTITUDE, "rate": loop.RATE, "user": loop.USER_EVENT}
DIRECTION = {"both": 0, "rising": 1, "falling": -1}
MOST_EVENTS = 100_000


class UserFunctions:
    """Loads and events of a scenario: compiled ones in slots, plain ones in the host."""

    def __init__(self, scenario, host: Host):
        """Find them all; a function that Numba has compiled stays compiled, any other is called as plain Python."""
        self.slots = Slots(no_load, LOAD, "loads and events")
        self._host = host
        self._plain: list[tuple[object, np.ndarray]] = []
        self.loads, self.load_names = [], []
        owners = [f'body "{body.name}"' for body in scenario.body] + [f'line "{name}"' for name in line_names(scenario)]
        for owner, one in loads_of(scenario):
            where = f'load "{one.function}" of {owners[owner]}'
            number = PLAIN_LOAD + len(self.loads)
            self.loads.append(self._number(one, scenario, where, number))
            self.load_names.append(where)
        self.events = []
        for k, one in enumerate(scenario.event):
            known = one.kind != "user"
            self.events.append(0 if known else self._number(one, scenario, f"event[{k}]", PLAIN_EVENT + k))

    def _number(self, record, scenario, where: str, number: int) -> int:
        """A slot, or the number under which the host calls the function."""
        function = function_of(record.function, scenario.folder, where)
        if is_compiled(function):
            return self.slots.share(compiled(function, LOAD, where))
        parameters = np.array(list(record.parameters.values()), dtype=float)
        self._plain.append((function, parameters))
        self._host.add(number, lambda t: function(t, self._state, parameters))
        return number

    def connect(self, shared) -> None:
        """Let plain functions see the state."""
        self._state = shared.state[:]
        self._state.flags.writeable = False  # of the view alone


def events_of(scenario, numbers: list[int]) -> loop.Events:
    """What the loop watches."""
    events = scenario.event
    level = {"altitude": lambda e: 1e3 * e.altitude_km, "rate": lambda e: np.radians(e.rate_deg_s)}
    return loop.Events(
        kind=np.array([KIND[e.kind] for e in events], dtype=np.int64),
        body=np.array([scenario.index_of(e.body) for e in events], dtype=np.int64),
        level=np.array([level.get(e.kind, lambda _: 0.0)(e) for e in events], dtype=float),
        direction=np.array([DIRECTION[e.direction] for e in events], dtype=np.int64),
        stop=np.array([e.stop for e in events], dtype=np.int64),
        slot=np.array(numbers, dtype=np.int64),
        value=np.zeros(len(events)),
        parameters=np.array([v for e in events for v in e.parameters.values()], dtype=float),
        first=np.cumsum([0, *(len(e.parameters) for e in events)]).astype(np.int64),
        found=np.zeros((MOST_EVENTS if events else 0, 3)),
    )
