"""Lines that hang in orbit: how they rest, how they move a little, how to start them, and what a run shows of them.

strand, grid                what a line is made of; its masses and springs, or its continuum
statics                     the state of rest: orbital rate, stretch, tension
eigenmodes, tether_modes    frequencies and shapes in the plane, across it and along the line
closed_forms                libration at large angles, rods, strings
starts, waves               states to begin a run with: straight, hanging, librating, skiprope, pulses
modal, budget               amplitudes of lateral modes, energy and momentum of a line in motion
"""

from fieldline.analysis.tether.budget import line_budget
from fieldline.analysis.tether.closed_forms import libration_ratio, rod_frequencies, string_frequency
from fieldline.analysis.tether.eigenmodes import eigenmotions
from fieldline.analysis.tether.grid import chain_grid, continuum_grid
from fieldline.analysis.tether.modal import modal_amplitudes
from fieldline.analysis.tether.starts import Ends, LineState, hanging, librating, rod_tension, straight
from fieldline.analysis.tether.statics import Hanging, hang, inextensible_rate, inextensible_tension
from fieldline.analysis.tether.strand import Strand, Stretches, cut, point_masses
from fieldline.analysis.tether.tether_modes import hanging_line, tether_modes
from fieldline.analysis.tether.waves import lateral_mode, pulse, skiprope

__all__ = [
    "Strand",
    "Stretches",
    "cut",
    "point_masses",
    "chain_grid",
    "continuum_grid",
    "Hanging",
    "hang",
    "hanging_line",
    "inextensible_rate",
    "inextensible_tension",
    "eigenmotions",
    "tether_modes",
    "libration_ratio",
    "rod_frequencies",
    "string_frequency",
    "Ends",
    "LineState",
    "straight",
    "hanging",
    "librating",
    "rod_tension",
    "skiprope",
    "pulse",
    "lateral_mode",
    "modal_amplitudes",
    "line_budget",
]
