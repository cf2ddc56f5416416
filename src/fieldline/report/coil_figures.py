"""Power against mass of a coil: the trade that its section decides, and the point that was taken."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from fieldline.report.theme import AXIS_COLOURS, GREY, INK, panels, themed

if TYPE_CHECKING:
    from matplotlib.figure import Figure

HEIGHT_IN = 3.9


def trade_figure(mass_kg: Any, power_w: Any, chosen_kg: float, chosen_w: float, words: str) -> Figure:
    """Power [W] against mass [kg] on logarithmic axes, with the chosen point."""
    with themed():
        figure, axes = panels(1, 1, height_in=HEIGHT_IN)
        one = axes[0, 0]
        draw_trade(one, mass_kg, power_w, chosen_kg, chosen_w)
        one.set_title(words)
    return figure


def draw_trade(one: Any, mass_kg: Any, power_w: Any, chosen_kg: float, chosen_w: float) -> None:
    """The curve on given axes."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

    one.loglog(mass_kg, power_w, color=AXIS_COLOURS[0], linewidth=1.4)
    one.axvline(chosen_kg, color=GREY, linewidth=0.7, linestyle=(0, (3, 3)))
    one.axhline(chosen_w, color=GREY, linewidth=0.7, linestyle=(0, (3, 3)))
    one.plot([chosen_kg], [chosen_w], "o", color=AXIS_COLOURS[1], markersize=6)
    one.annotate(
        f"{chosen_w:.3g} W, {chosen_kg:.3g} kg", (chosen_kg, chosen_w), xytext=(8, 8), textcoords="offset points", color=INK
    )
    for axis in (one.xaxis, one.yaxis):
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0), numticks=12))
        axis.set_minor_locator(NullLocator())
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    one.set_xlabel("mass [kg]")
    one.set_ylabel("power [W]")
