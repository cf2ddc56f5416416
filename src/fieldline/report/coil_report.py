"""The report on a designed coil: its numbers, and the trade of power against mass that it was taken from."""

from __future__ import annotations

from typing import Any

TRADE = (
    "Every point gives the same moment with the same shape; only the conducting section changes. Without a core, power times "
    "mass is the same at all of them. Twice the wire halves the power."
)
ALT = "Power falls as mass rises, a straight line on logarithmic axes, with the chosen coil marked."


def coil_html(design: Any, given: dict[str, Any]) -> str:
    """The page as text; `given` is what the user asked for."""
    from fieldline import __version__
    from fieldline.report.coil_figures import trade_figure
    from fieldline.report.markup import facts, flat, section, sentences, text
    from fieldline.report.page import drawings, page
    from fieldline.report.theme import Picture
    from fieldline.report.verdict import panel

    curve = design.trade_curve()
    drawn = trade_figure(curve["mass_kg"].values, curve["power_w"].values, design.mass_kg, design.power_w, design.loop.words)
    sentence = f"{design.turns:,} turns, {design.current_a:.4g} A, {design.power_w:.3g} W, {design.mass_kg:.3g} kg"
    head = panel("doubtful" if design.cautions else "usable", "Designed", sentence, list(design.cautions))
    sources = [f"{design.metal.name}: {design.metal.source}", "White, Shigemoto and Bourquin (1961), equations (13) to (19)"]
    return page(
        f"Coil for {design.moment_a_m2:.4g} A m²",
        f"{design.loop.words}, {design.metal.name}",
        head,
        [
            ("numbers", section("numbers", "Numbers", facts([(text(name), text(value)) for name, value in design.rows()]))),
            ("trade", section("trade", "Power against mass", drawings([Picture("trade", "The trade", TRADE, ALT, drawn)]))),
            ("asked", section("asked", "Asked for", facts(flat(given)))),
            ("sources", section("sources", "Sources", sentences(sources))),
        ],
        f"Fieldline {__version__}. Coil losses alone: no leads, no driver.",
    )
