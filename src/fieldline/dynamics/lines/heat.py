"""Temperature of a segment: what it takes in, what it gives off, and what follows from it.

    mu c dT/dt = q - pi d eps sigma T^4                                                                    (1)
    q = d [alpha (q_s + q_a) + eps q_e] + q_air + R' I^2                                                   (2)
    R' = R'_0 [1 + beta (T - T_0)]                                                                         (3)

mu: mass per length, c: specific heat, d: diameter (of a tape, circumference over pi), alpha and eps: absorptivity for
sunlight, emissivity. q_s, q_a, q_e are those of `environment.radiation`, q_air that of `lines.air`. A line has one
temperature through its section and conducts none along itself: over 100 m, aluminium takes weeks. The unstretched length
is l0 [1 + a (T - T_0)].

Radiation alone, and without anything taken in, cools by

    T^-3 = T(0)^-3 + 3 pi d eps sigma t / (mu c),      tau = mu c / (4 pi d eps sigma T^3)                  (4)

tau, some 100 s for a tape of 50 micrometres and 300 s for a line of 2.5 mm, bounds the step of an explicit method to 2.8 tau.
"""

from __future__ import annotations

from math import pi

from fieldline.compiled import kernel
from fieldline.constants import STEFAN_BOLTZMANN_W_M2_K4


@kernel
def line_heating(light, infrared, air, ohmic, diameter, absorptivity, emissivity):
    """q [W/m] of equation (2); light, infrared [W/m^2]: of `light_on_line`; air, ohmic [W/m]."""
    return diameter * (absorptivity * light + emissivity * infrared) + air + ohmic


@kernel
def warming(temperature, heating, diameter, emissivity, capacity):
    """dT/dt [K/s] of equation (1); capacity: mu c [J/m/K]."""
    return (heating - pi * diameter * emissivity * STEFAN_BOLTZMANN_W_M2_K4 * temperature**4) / capacity


@kernel
def balance_temperature(heating, diameter, emissivity):
    """Temperature [K] at which (1) rests."""
    return (heating / (pi * diameter * emissivity * STEFAN_BOLTZMANN_W_M2_K4)) ** 0.25


@kernel
def warm_resistance(resistance, temperature, coefficient, reference):
    """R' [ohm/m] of equation (3)."""
    return resistance * (1.0 + coefficient * (temperature - reference))
