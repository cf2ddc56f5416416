"""Orbits: where the satellite was, from elements, ephemerides or positions."""

from fieldline.orbit.orbit import Orbit
from fieldline.orbit.positions import orbit_from_positions
from fieldline.orbit.reading import read_orbit

__all__ = ["Orbit", "read_orbit", "orbit_from_positions"]
