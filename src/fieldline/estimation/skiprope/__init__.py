"""Coning from a magnetometer and a known field: skiprope of a tethered satellite, nutation of a spinning one.

    geometry = field_geometry(field_c)                           the known field in the axes of the cone
    corrected = corrected_signals(field_b, geometry)             three harmonics
    tuning = tune(seconds, corrected, 0.005)                     bandpass filters, tuned to what they show
    reading = read_cone(seconds, tuning.filtered, geometry, tuning.frequency_hz)
    tether_azimuth(reading, seconds), midpoint_deflection(reading.amplitude_rad, length_m)

or, beyond the source, by least squares without a filter,

    cone_at(harmonic_cone(seconds, field_b, geometry, 0.005), seconds)

or everything at once, with the frequency found and the word whether there is a cone at all,

    estimate = estimate_skiprope(skiprope_signals(seconds, field_b, field_c), tether_length_m=20e3)

Source: Polites (1991), NASA TP-3123.
"""

from fieldline.estimation.skiprope.bandpass import (
    FilterState,
    bandpass,
    bandpass_response,
    filter_bank,
    group_delay_s,
    lowpass,
    settling_time_s,
)
from fieldline.estimation.skiprope.bound import Bound, cramer_rao
from fieldline.estimation.skiprope.by_kalman import KalmanSettings
from fieldline.estimation.skiprope.coning import axes_about, cone_signals, despun
from fieldline.estimation.skiprope.cycles import extremes, fit_cycles, zero_crossings
from fieldline.estimation.skiprope.estimate import METHODS, RULES, estimate_skiprope
from fieldline.estimation.skiprope.harmonic import (
    HarmonicCone,
    circular_parts,
    cone_at,
    fit_harmonics,
    harmonic_cone,
    refined_frequency,
    smoothed,
)
from fieldline.estimation.skiprope.live import LiveEstimate, LiveSkiprope
from fieldline.estimation.skiprope.position import (
    in_field_plane,
    midpoint_deflection,
    midpoint_position,
    next_in_plane,
    tether_azimuth,
    tilt_azimuth,
)
from fieldline.estimation.skiprope.reading import ConeReading, FieldKnowledge, read_cone
from fieldline.estimation.skiprope.rotary import Detection, Line, detect
from fieldline.estimation.skiprope.signals import (
    ORBITAL_FROM_CONE,
    FieldGeometry,
    SkipropeSignals,
    corrected_signals,
    field_geometry,
    field_vector,
    skiprope_signals,
    yaw_signal,
)
from fieldline.estimation.skiprope.solution import PlaneCrossings, SkipropeEstimate
from fieldline.estimation.skiprope.tuning import Tuning, tune

__all__ = [
    "estimate_skiprope",
    "METHODS",
    "RULES",
    "SkipropeEstimate",
    "PlaneCrossings",
    "SkipropeSignals",
    "skiprope_signals",
    "detect",
    "LiveSkiprope",
    "LiveEstimate",
    "KalmanSettings",
    "cramer_rao",
    "Bound",
    "Detection",
    "Line",
    "field_geometry",
    "field_vector",
    "FieldGeometry",
    "ORBITAL_FROM_CONE",
    "corrected_signals",
    "yaw_signal",
    "bandpass",
    "lowpass",
    "filter_bank",
    "FilterState",
    "bandpass_response",
    "group_delay_s",
    "settling_time_s",
    "tune",
    "Tuning",
    "zero_crossings",
    "extremes",
    "fit_cycles",
    "read_cone",
    "ConeReading",
    "FieldKnowledge",
    "tilt_azimuth",
    "tether_azimuth",
    "midpoint_deflection",
    "midpoint_position",
    "in_field_plane",
    "next_in_plane",
    "harmonic_cone",
    "fit_harmonics",
    "smoothed",
    "refined_frequency",
    "circular_parts",
    "cone_at",
    "HarmonicCone",
    "cone_signals",
    "axes_about",
    "despun",
]
