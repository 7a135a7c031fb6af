"""A page with pictures: one file of HTML that needs no network. It has its data, and the scripts of
`draw/` that draw them; the page of `passo serve` draws with the same ones."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from html import escape
from importlib.resources import files

_STYLES = ("tokens.css", "draw.css", "pages.css")
_SCRIPTS = (
    *("dom", "labels", "series", "chart", "shades", "bars", "gestures", "path", "pages"),
    "scatter",
)
_IMPORT = re.compile(r"^import .*;\n", re.MULTILINE)  # the scripts of a page are one module


def page(title: str, script: str, data: Mapping[str, object]) -> str:
    """The text of the page, whose `script` in `draw/` draws `data`."""
    draw = files("passo.learn") / "draw"
    style = "".join(draw.joinpath(name).read_text("utf-8") for name in _STYLES)
    scripts = [draw.joinpath(f"{name}.js").read_text("utf-8") for name in (*_SCRIPTS, script)]
    # "</" could end the script early if it is in a file name
    known = json.dumps(data, separators=(",", ":")).replace("</", "<\\/")
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
<noscript>The pictures of this page need JavaScript.</noscript>
</main>
<script type="application/json" id="data">{known}</script>
<script type="module">
{_IMPORT.sub("", "".join(scripts))}</script>
</body>
</html>
"""
