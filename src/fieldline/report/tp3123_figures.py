"""Figures of the TP-3123 case: the field, the magnetometer's outputs, the filters' outputs with the reading marks on them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fieldline.errors import NoEstimateError
from fieldline.estimation.skiprope import ConeReading, FieldGeometry, FieldKnowledge, read_cone
from fieldline.report.series import legend, line
from fieldline.report.theme import AXIS_COLOURS, FAINT, INK, WARM, label_outer, panels

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MICROTESLA = 1e6
MILLIRADIAN = 1e3
SETTLE_S = 800.0
SUBSCRIPTS = "₁₂₃"


def field_figure(dataset: Any) -> Figure:
    """Figure 5: magnitude, elevation and azimuth of the true field."""
    figure, axes = panels(3, 1, height_in=5.0, row_gap=0.2)
    time = dataset["seconds"].values
    line(axes[0, 0], time, dataset["field_tesla"].values * MICROTESLA, INK, width=1.3)
    axes[0, 0].set_ylabel("magnitude [µT]")
    for one, name in zip(axes[1:, 0], ("elevation", "azimuth"), strict=True):
        line(one, time, np.degrees(dataset[f"{name}_rad"].values), INK, width=1.3)
        one.axhline(0.0, color=FAINT, linewidth=1.0, zorder=0)
        one.set_ylabel(f"{name} [deg]")
    return _finished(figure, axes, time)


def magnetometer_figure(dataset: Any) -> Figure:
    """Figure 6: the three outputs."""
    figure, axes = panels(3, 1, height_in=5.0, row_gap=0.2)
    time = dataset["seconds"].values
    for k, one in enumerate(axes[:, 0]):
        line(one, time, dataset["measured_b"].values[:, k] * MICROTESLA, AXIS_COLOURS[k], width=0.8)
        one.set_ylabel(f"B{SUBSCRIPTS[k]} [µT]")
    return _finished(figure, axes, time)


def filters_figure(dataset: Any) -> Figure:
    """Figure 7: the filters' outputs, the settling shaded, the reading marks on the third."""
    figure, axes = panels(3, 1, height_in=5.8, row_gap=0.2)
    time = dataset["seconds"].values
    for k, one in enumerate(axes[:, 0]):
        values = dataset["filtered"].values[:, k] * MILLIRADIAN
        line(one, time, values, AXIS_COLOURS[k], width=1.2)
        one.axvspan(time[0], min(SETTLE_S, time[-1]), color=FAINT, alpha=0.5, linewidth=0, zorder=0)
        one.axhline(0.0, color=FAINT, linewidth=1.0, zorder=0)
        one.set_ylabel(f"C{SUBSCRIPTS[k]} [mrad]")
        one.set_ylim(-1.15 * np.abs(values).max(), 1.15 * np.abs(values).max())
    reading = read_case(dataset)
    axes[0, 0].set_title(dataset.attrs["title"] if reading is None else words(reading))
    if reading is not None:
        at = reading.maximum_s
        marks = {
            "linestyle": "none",
            "marker": "v",
            "markersize": 4.5,
            "color": WARM,
            "label": "in the field's plane, towards it",
        }
        axes[2, 0].plot(at, np.interp(at, time, dataset["filtered"].values[:, 2] * MILLIRADIAN), **marks)
        legend(axes[2, 0])
    return _finished(figure, axes, time)


def read_case(dataset: Any, azimuth_delay_s: float = 0.0) -> ConeReading | None:
    """The rules' reading of the case, its field errors taken for one sigma; None where it is too short for them."""
    import json

    names = ("field_assumed_tesla", "elevation_assumed_rad", "azimuth_assumed_rad")
    known = FieldGeometry(*(dataset[name].values for name in names))
    told = json.loads(dataset.attrs["settings_json"])
    errors = told["field_scale_error"], *np.radians([told["elevation_error_deg"], told["azimuth_error_deg"]])
    signals = dataset["seconds"].values, dataset["filtered"].values, known, told["filter_frequency_hz"]
    more = {
        "damping": told["damping"],
        "settle_s": SETTLE_S,
        "azimuth_delay_s": azimuth_delay_s,
        "knowledge": FieldKnowledge(*np.abs(errors)),
    }
    try:
        return read_cone(*signals, **more)
    except NoEstimateError:
        return None


def words(reading: ConeReading) -> str:
    """What was read, in a line."""
    sense = {1: "from V towards −U", -1: "from V towards U", 0: "sense not to be told"}[reading.sense]
    amplitude, amplitude_std = np.degrees([reading.amplitude_rad, reading.amplitude_std_rad])
    period_std = reading.frequency_std_hz * reading.period_s**2
    return f"{amplitude:.2f} ± {amplitude_std:.2f} deg, period {reading.period_s:.1f} ± {period_std:.1f} s, {sense}"


def _finished(figure: Figure, axes: Any, time: np.ndarray) -> Figure:
    """The same time axis under all panels."""
    for one in axes[:, 0]:
        one.set_xlim(time[0], time[-1])
    figure.align_ylabels(axes[:, 0])
    label_outer(axes, ("time [s]",))
    return figure


OWN_FIGURES = {"tp3123": filters_figure}
