"""The page around the chapters: one HTML file with its style inside, which needs no network, and no script but for what moves."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from importlib.resources import files

from fieldline.report.markup import figure, text
from fieldline.report.theme import Picture, svg_text


def page(title: str, subtitle: str, head: str, sections: Sequence[tuple[str, str]], foot: str) -> str:
    """The whole document.

    head : HTML of the verdict and the key numbers.     sections : (name, HTML) in order; the empty ones are left out.
    """
    shown = [(name, html) for name, html in sections if html]
    links = "".join(f'<a href="#{name}">{text(name.capitalize())}</a>' for name, _ in shown)
    style = files("fieldline.report").joinpath("page.css").read_text(encoding="utf-8")
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1"><meta name="color-scheme" content="light dark">'
        f"<title>{text(title)}</title><style>{style}</style></head><body><main>"
        f'<header><p class="brand">Fieldline</p><h1>{text(title)}</h1><p class="subtitle">{text(subtitle)}</p></header>'
        f'{head}<nav aria-label="Sections">{links}</nav>{"".join(html for _, html in shown)}'
        f"<footer>{text(foot)}</footer></main></body></html>\n"
    )


def drawings(pictures: Iterable[Picture | None]) -> str:
    """The figures that there are, with their captions."""
    return "".join(figure(svg_text(p.figure), p.title, p.caption, p.alt) for p in pictures if p is not None)
