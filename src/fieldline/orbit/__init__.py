"""Orbits: where the satellite was, from elements, ephemerides or positions; and where a simulated one starts."""

from fieldline.orbit.elements import Elements, circular_orbit, elements_from_state, state_from_elements
from fieldline.orbit.orbit import Orbit
from fieldline.orbit.positions import orbit_from_positions
from fieldline.orbit.reading import read_orbit
from fieldline.orbit.start import StartState, SunSynchronous, initial_state_i

__all__ = [
    "Orbit",
    "read_orbit",
    "orbit_from_positions",
    "Elements",
    "elements_from_state",
    "state_from_elements",
    "circular_orbit",
    "StartState",
    "SunSynchronous",
    "initial_state_i",
]
