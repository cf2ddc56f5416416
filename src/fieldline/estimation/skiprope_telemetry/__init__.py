"""The skiprope of flown telemetry: from a file and an orbit (`estimate_skiprope`), or from rows that come (`SkipropeStream`)."""

from fieldline.estimation.skiprope_telemetry.face import estimate_skiprope
from fieldline.estimation.skiprope_telemetry.mounting import Mounting
from fieldline.estimation.skiprope_telemetry.skiprope_stream import SkipropeStream
from fieldline.estimation.skiprope_telemetry.solving import METHODS, SkipropeSettings
from fieldline.estimation.skiprope_telemetry.tether import TetherLengths, read_tether_lengths

__all__ = [
    "estimate_skiprope",
    "SkipropeStream",
    "Mounting",
    "SkipropeSettings",
    "METHODS",
    "TetherLengths",
    "read_tether_lengths",
]
