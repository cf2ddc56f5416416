"""How figures look: one set of colours safe for colour-blind readers, light and dark, and the way to SVG and PNG.

Colours are Okabe and Ito's (2008), "Color Universal Design". In the page's SVG the named colours become CSS variables,
so that a figure follows the page into dark mode.
"""

from __future__ import annotations

import io
import re
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.figure import Figure

INK = "#26323d"
FAINT = "#d9dee3"
GREY = "#848c94"
AXIS_COLOURS = ("#0072b2", "#d55e00", "#009e73")
FOURTH = "#cc79a7"
WARM = "#e69f00"
AXES = ("x", "y", "z")

CSS_VARIABLES = {
    INK: "var(--ink)",
    FAINT: "var(--faint)",
    GREY: "var(--grey)",
    AXIS_COLOURS[0]: "var(--x)",
    AXIS_COLOURS[1]: "var(--y)",
    AXIS_COLOURS[2]: "var(--z)",
    FOURTH: "var(--w)",
    WARM: "var(--warm)",
}

WIDTH_IN = 9.2
RASTER_DPI = 130

_RC = {
    "font.family": ["sans-serif"],
    "font.sans-serif": ["DejaVu Sans"],
    "font.size": 9.0,
    "axes.titlesize": 9.5,
    "axes.titlelocation": "left",
    "axes.titlepad": 5.0,
    "axes.titley": 1.0,  # a fixed place: looking for a free one costs a tenth of the drawing
    "axes.labelsize": 9.0,
    "axes.edgecolor": GREY,
    "axes.linewidth": 0.7,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.facecolor": "none",
    "axes.labelcolor": INK,
    "axes.formatter.useoffset": False,
    "grid.color": FAINT,
    "grid.linewidth": 0.6,
    "text.color": INK,
    "text.parse_math": False,
    "xtick.color": GREY,
    "ytick.color": GREY,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "xtick.labelsize": 8.0,
    "ytick.labelsize": 8.0,
    "xtick.major.size": 3.0,
    "ytick.major.size": 3.0,
    "legend.frameon": False,
    "legend.fontsize": 8.0,
    "legend.handlelength": 1.4,
    "legend.borderaxespad": 0.2,
    "legend.columnspacing": 1.2,
    "lines.linewidth": 1.0,
    "lines.solid_capstyle": "round",
    "figure.facecolor": "none",
    "figure.dpi": RASTER_DPI,
    "savefig.facecolor": "none",
    "svg.fonttype": "none",
    "svg.hashsalt": "fieldline",
    "path.simplify": True,
    "path.simplify_threshold": 0.3,
}


@dataclass(frozen=True)
class Picture:
    """A drawn figure with what the page says of it: a file name, a title, what to look for, and words for who cannot see it."""

    name: str
    title: str
    caption: str
    alt: str
    figure: Figure


def themed() -> AbstractContextManager[None]:
    """The settings of Matplotlib for drawing and writing, restored afterwards."""
    import matplotlib

    return matplotlib.rc_context(_RC)


def panels(
    rows: int,
    columns: int = 1,
    *,
    height_in: float,
    widths: tuple[float, ...] | None = None,
    heights: tuple[float, ...] | None = None,
    row_gap: float = 0.16,
    column_gap: float = 0.16,
    right: float = 0.978,
) -> tuple[Figure, Any]:
    """A figure of the page's width with a (rows, columns) array of axes; margins are fixed, since layout engines cost seconds."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from matplotlib.ticker import MaxNLocator

    figure = Figure(figsize=(WIDTH_IN, height_in))
    FigureCanvasAgg(figure)
    grid = figure.add_gridspec(
        rows,
        columns,
        left=0.078,
        right=right,
        top=1 - 0.34 / height_in,
        bottom=0.48 / height_in,
        hspace=row_gap,
        wspace=column_gap,
        width_ratios=widths,
        height_ratios=heights,
    )
    axes = grid.subplots(squeeze=False)
    for one in axes.flat:  # each tick is drawn in half a millisecond: as many as one reads, no more
        one.xaxis.set_major_locator(MaxNLocator(nbins=6, steps=[1, 2, 2.5, 5, 10]))
        one.yaxis.set_major_locator(MaxNLocator(nbins=5, steps=[1, 2, 2.5, 5, 10]))
    return figure, axes


def label_outer(axes: Any, labels: tuple[str, ...]) -> None:
    """Write the x labels under the lowest row only and hide the tick labels above it."""
    for row in axes[:-1]:
        for one in row:
            one.tick_params(labelbottom=False)
    for one, label in zip(axes[-1], labels, strict=True):
        one.set_xlabel(label)


def svg_text(figure: Figure) -> str:
    """The figure as an SVG element for the page: no XML head, no repeated identifiers, colours as CSS variables."""
    buffer = io.StringIO()
    with themed():
        _print_svg(figure, buffer)
    text = buffer.getvalue()
    text = text[text.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>", "", text, flags=re.S)
    text = re.sub(
        r' id="(?:figure|axes|patch|matplotlib\.axis|xtick|ytick|line2d|text|legend|[A-Za-z]*Collection|image)_\d+"', "", text
    )
    text = re.sub(r'(<svg[^>]*?) width="[^"]*"', r"\1", re.sub(r'(<svg[^>]*?) height="[^"]*"', r"\1", text, count=1), count=1)
    for colour, variable in CSS_VARIABLES.items():
        text = text.replace(f": {colour}", f": {variable}")
    return text.replace("'DejaVu Sans'", "inherit")


def write_svg(figure: Figure, path: Any) -> None:
    """The figure as a file of its own, on white."""
    with themed(), open(path, "w", encoding="utf-8") as file:
        figure.set_facecolor("white")
        _print_svg(figure, file)
        figure.set_facecolor("none")


def write_png(figure: Figure, path: Any) -> None:
    """The figure as PNG, on white."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    with themed():
        figure.set_facecolor("white")
        figure.set_dpi(RASTER_DPI)
        FigureCanvasAgg(figure).print_png(path)
        figure.set_facecolor("none")


def _print_svg(figure: Figure, buffer: Any) -> None:
    """SVG without a date, so that the same estimate gives the same bytes."""
    from matplotlib.backends.backend_svg import FigureCanvasSVG

    figure.set_dpi(RASTER_DPI)  # print_svg leaves 72 behind
    FigureCanvasSVG(figure).print_svg(buffer, metadata={"Date": None, "Creator": None, "Format": None, "Type": None})
