"""Smithsonian Astrophysical Observatory (1982): Study of tethered satellite active attitude control, NASA-CR-170721.

stationary        where the axis of a spinning subsatellite can stand still against the orbit (s. 2.5)
stability         whether it stays there (s. 2.6, corrected); stability_chart: over spin and offset
spin              the spinning test case of two masses, flown by the plant (s. 3.1.2)
thruster          a constant torque about the tether (s. 3.3)
annex_run         the tests of the 1978 program (Annex III-1.5)
"""

from fieldline.cases.sao_1982.algebra import report_body, stability, stability_chart, stationary
from fieldline.cases.sao_1982.runs import ANNEX_RUNS, PRINTED_SPIN_RAD_S, annex_run, spin, thruster

__all__ = [
    "stationary",
    "stability",
    "stability_chart",
    "report_body",
    "spin",
    "PRINTED_SPIN_RAD_S",
    "thruster",
    "annex_run",
    "ANNEX_RUNS",
]
