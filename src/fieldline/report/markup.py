"""HTML in small pieces; every text from outside goes through `text`, which escapes it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from numbers import Real
from typing import Any


def text(value: Any) -> str:
    """A value as escaped text: numbers short, truth in words, lists joined."""
    if value is None:
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, Real):
        return number(float(value))
    if isinstance(value, (list, tuple)):
        return ", ".join(text(one) for one in value)
    return escape(str(value))


def number(value: float, digits: int = 6) -> str:
    """A number with a few significant digits, thousands apart by commas from 10,000 on, and a true minus."""
    if value != value:
        return "–"
    size = abs(value)
    if size >= 1e15 or (0 < size < 1e-4):
        shown = f"{value:.{digits}g}"
    elif value == int(value) or size >= 10.0**digits:
        shown = f"{value:,.0f}"
    else:
        whole = len(str(int(size))) if size >= 1 else 0
        shown = f"{value:,.{digits - whole}f}" if whole else f"{value:.{digits}g}"
        shown = shown.rstrip("0").rstrip(".") if "." in shown else shown
    return (shown.replace(",", "") if size < 1e4 else shown).replace("-", "−")


def table(heads: Sequence[str], rows: Iterable[Sequence[str]], kind: str = "") -> str:
    """A table of cells that are already HTML; it scrolls by itself where the screen is narrow."""
    head = "".join(f'<th scope="col">{one}</th>' for one in heads)
    body = "".join("<tr>" + "".join(f"<td>{cell}</td>" for cell in row) + "</tr>" for row in rows)
    return f'<div class="scroll"><table class="{kind}"><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>'


def facts(pairs: Iterable[tuple[str, str]]) -> str:
    """A two-column table of names and values that are already HTML."""
    rows = "".join(f'<tr><th scope="row">{name}</th><td>{value}</td></tr>' for name, value in pairs)
    return f'<div class="scroll"><table class="facts">{rows}</table></div>'


def sentences(lines: Iterable[Any]) -> str:
    """A list of sentences."""
    items = "".join(f"<li>{text(line)}</li>" for line in lines)
    return f"<ul>{items}</ul>" if items else ""


def flat(record: dict[str, Any], prefix: str = "") -> list[tuple[str, str]]:
    """A nested record as pairs for `facts`; lists of records become one line each."""
    pairs: list[tuple[str, str]] = []
    for key, value in record.items():
        name = f"{prefix}{key}"
        if isinstance(value, dict):
            pairs += flat(value, f"{name} · ")
        elif isinstance(value, (list, tuple)) and any(isinstance(one, dict) for one in value):
            shown = (", ".join(f"{k} {text(v)}" for k, v in one.items() if v not in ("", None)) for one in value)
            pairs.append((text(name.replace("_", " ")), "<br>".join(shown)))
        elif value not in (None, "", [], ()):
            pairs.append((text(name.replace("_", " ")), _long(text(value))))
    return pairs


def _long(value: str) -> str:
    """Hashes and other long words in a narrow type that may break anywhere."""
    return f"<code>{value}</code>" if len(value) >= 32 and " " not in value else value


def section(name: str, title: str, *parts: str) -> str:
    """A section of the page with its heading; empty where it has no parts."""
    inside = "".join(part for part in parts if part)
    return f'<section id="{name}"><h2>{text(title)}</h2>{inside}</section>' if inside else ""


def figure(svg: str, title: str, caption: str, alt: str) -> str:
    """A figure with its caption; the alternative text replaces the drawing for screen readers."""
    drawing = svg.replace("<svg", f'<svg role="img" aria-label="{escape(alt, quote=True)}"', 1)
    return f"<figure><h3>{text(title)}</h3>{drawing}<figcaption>{text(caption)}</figcaption></figure>"
