"""A page with charts: one file of HTML that needs no network and is complete without scripts."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from html import escape
from importlib.resources import files


def page(
    title: str,
    sections: Iterable[str],
    data: Mapping[str, object] | None = None,
    more_style: str | None = None,
) -> str:
    """The text of the page. `sections` are HTML; `data` is for the script: `end_s`, `charts` (see
    Chart.data), and optionally `path` (see Toolpath.data); without it, the page has no script.
    `more_style` names a further style sheet."""
    room = files("passo.learn")
    sheets = ["page.css", *([more_style] if more_style else [])]
    style = "".join(room.joinpath(sheet).read_text("utf-8") for sheet in sheets)
    return f"""<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{escape(title)}</title>
<style>
{style}</style>
</head>
<body>
<main>
<h1>{escape(title)}</h1>
{"".join(sections)}</main>
{"" if data is None else _script(data)}</body>
</html>
"""


def _script(data: Mapping[str, object]) -> str:
    script = files("passo.learn").joinpath("page.js").read_text("utf-8")
    # Escape "</", which could end the script early if it is in a file name.
    known = json.dumps(data, separators=(",", ":")).replace("</", "<\\/")
    return f"""<script type="application/json" id="data">{known}</script>
<script>
{script}</script>
"""


def table(title: str, rows: Iterable[tuple[str, str]]) -> str:
    """A section with names and values."""
    cells = "".join(f"<tr><th>{escape(n)}</th><td>{escape(v)}</td></tr>\n" for n, v in rows)
    return section("table", title, f"<table>\n{cells}</table>\n")


def bars(title: str, rows: Iterable[tuple[str, str, float]]) -> str:
    """A section with bars for `rows`: name, value as text, fraction from 0 to 1; largest first."""
    lines = list(rows)
    most = max((share for _, _, share in lines), default=1.0) or 1.0
    cells = "".join(
        f'<tr><th>{escape(name)}</th><td class="bar"><i style="width:{100 * share / most:.1f}%">'
        f"</i></td><td>{escape(value)}</td><td>{100 * share:.1f} %</td></tr>\n"
        for name, value, share in lines
    )
    return section("bars", title, f"<table>\n{cells}</table>\n")


def picture(title: str, drawing: str, legend: str) -> str:
    """A section with a drawing and its legend, both HTML."""
    return section("picture", title, f"{drawing}\n<p>{legend}</p>\n")


def problems(title: str, texts: Iterable[str]) -> str:
    """A section that lists the problems."""
    rows = "".join(f"<li>{escape(text)}</li>\n" for text in texts)
    return section("problems", title, f"<ul>\n{rows}</ul>\n")


def side_by_side(wide: str, narrow: Iterable[str]) -> str:
    """A wide section with narrow ones next to it if the window is wide enough."""
    others = "".join(narrow)
    return wide + (f'<div class="side">\n{others}</div>\n' if others else "")


def zoom_bar() -> str:
    """The buttons that zoom all charts. The script makes them visible."""
    return """<div class="zoom" hidden>
<output id="shown"></output>
<span><button data-do="out" title="Zoom out (-)">\N{MINUS SIGN}</button>\
<button data-do="in" title="Zoom in (+)">+</button>\
<button data-do="left" title="Earlier (left arrow)">\N{LEFTWARDS ARROW}</button>\
<button data-do="right" title="Later (right arrow)">\N{RIGHTWARDS ARROW}</button>\
<button data-do="all" title="The whole print (double click, 0)">All</button></span>
<small>Drag to zoom in; wheel or two fingers zoom; Shift and drag, or one finger, moves; double \
click shows all. A click shows its layer.</small>
</div>
"""


def section(kind: str, title: str, content: str) -> str:
    """A section of a kind that the style sheets know; `content` is HTML."""
    return f'<section class="{kind}">\n<h2>{escape(title)}</h2>\n{content}</section>\n'
