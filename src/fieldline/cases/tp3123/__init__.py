"""Polites (1991): bandpass filters on magnetometer signals to reconstruct a tethered satellite's skiprope, NASA TP-3123.

run             section IV: the signals of a flight, corrected and filtered
fly             the flight alone, at 16 Hz: orbit, field, attitude, magnetometer
six_dipoles     the field model of its program
record_along    the motion along any orbit, as telemetry
listed_gain     gain and phase as its program prints them
random_scenario a flight with everything drawn by chance, `score` what an estimate of it is off by
"""

from fieldline.cases.tp3123.dipoles import six_dipoles
from fieldline.cases.tp3123.flight import Flight, fly, true_cone
from fieldline.cases.tp3123.reconstruction import listed_gain, run
from fieldline.cases.tp3123.record import FlightRecord, record_along
from fieldline.cases.tp3123.scenarios import Scenario, Score, random_scenario, score

__all__ = [
    "run",
    "fly",
    "Flight",
    "true_cone",
    "six_dipoles",
    "listed_gain",
    "record_along",
    "FlightRecord",
    "random_scenario",
    "Scenario",
    "score",
    "Score",
]
