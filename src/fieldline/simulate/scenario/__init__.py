"""A scenario: what flies, where and when, under which laws; read from TOML, checked, and written back."""

from fieldline.simulate.scenario.body import AttitudeStart, Body
from fieldline.simulate.scenario.environment import Atmosphere, Environment
from fieldline.simulate.scenario.event import Event
from fieldline.simulate.scenario.integrator import Integrator
from fieldline.simulate.scenario.orbit_start import Elements, OrbitStart, State, SunSynchronous
from fieldline.simulate.scenario.scenario import Scenario
from fieldline.simulate.scenario.software import Software
from fieldline.simulate.scenario.span import Span

__all__ = [
    "Scenario",
    "Span",
    "Integrator",
    "Environment",
    "Atmosphere",
    "OrbitStart",
    "Elements",
    "State",
    "SunSynchronous",
    "Body",
    "AttitudeStart",
    "Software",
    "Event",
]
