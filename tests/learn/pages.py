"""Reports as tests read them: the HTML, and the numbers from which its script draws."""

from __future__ import annotations

import json
import sys
from array import array
from base64 import b64decode
from dataclasses import dataclass, field
from html.parser import HTMLParser
from itertools import accumulate
from pathlib import Path
from typing import Any

from passo.cli.main import main

_VOID = {"meta", "br", "input", "link", "img"}


def unpacked(text: str, kind: str) -> list[Any]:
    """Numbers that a page holds in base64."""
    numbers = array(kind, b64decode(text))
    if sys.byteorder == "big":
        numbers.byteswap()
    return numbers.tolist()


@dataclass
class Curve:
    """A curve of a chart: its corners, or the columns that are known, (lowest, highest, mean)."""

    corners: list[tuple[float, float]] = field(default_factory=list)
    columns: dict[int, tuple[float, float, float]] = field(default_factory=dict)
    width_s: float = 0.0

    @classmethod
    def of(cls, data: dict[str, Any]) -> Curve:
        if "w" not in data:
            times = accumulate(unpacked(data["s"], "f"))
            return cls(list(zip(times, unpacked(data["v"], "f"), strict=True)))
        rows = [unpacked(data[key], "h") for key in ("low", "high", "mean")]
        known = {
            i: tuple(x * data["scale"] for x in row)
            for i, row in enumerate(zip(*rows, strict=True))
            if row[0] != -32_768
        }
        return cls(columns=known, width_s=data["w"])

    @property
    def highest(self) -> float:
        return max([v for _, v in self.corners] or [high for _, high, _ in self.columns.values()])


@dataclass
class Tag:
    name: str
    attributes: dict[str, str | None]
    text: str = ""


class _Reader(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.tags, self.open = list[Tag](), list[Tag]()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(Tag(tag, dict(attrs)))
        if tag not in _VOID:
            self.open.append(self.tags[-1])

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(Tag(tag, dict(attrs)))

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop().name == tag

    def handle_data(self, data: str) -> None:
        for tag in self.open:
            tag.text += data


class Page:
    """A report that `passo report` has written."""

    def __init__(self, text: str) -> None:
        self.text = text
        reader = _Reader()
        reader.feed(text)
        assert reader.open == []  # every element is closed
        self.tags = reader.tags
        script = next(t for t in self.tags if t.attributes.get("id") == "data")
        self.data: dict[str, Any] = json.loads(script.text)

    def all(self, name: str, kind: str = "") -> list[Tag]:
        """Elements of a name, and of a class if that is given."""
        return [
            tag
            for tag in self.tags
            if tag.name == name
            and (not kind or kind in (tag.attributes.get("class") or "").split())
        ]

    def titles(self) -> list[str]:
        return [tag.text for tag in self.all("h2")]

    def names(self, chart: str) -> list[str]:
        """The legend of a chart."""
        index = [c["key"] for c in self.data["charts"]].index(chart)
        section = self.all("section", "chart")[index].text
        legend = section.strip().splitlines()[1]
        return legend.split()

    def curves(self, chart: str) -> list[Curve]:
        return next(
            [Curve.of(curve) for curve in found["curves"]]
            for found in self.data["charts"]
            if found["key"] == chart
        )

    def charts(self) -> list[str]:
        return [chart["key"] for chart in self.data["charts"]]

    def result(self) -> dict[str, str]:
        """The rows of the table."""
        cells = [tag.text for tag in self.tags if tag.name in ("th", "td")]
        return dict(zip(cells[::2], cells[1::2], strict=False))


def report(path: Path, *words: str, status: int = 0) -> Page:
    """The report of a file, next to it."""
    page = path.with_suffix(".html")
    assert main(["report", str(path), "--output", str(page), *words]) == status
    return Page(page.read_text(encoding="utf-8"))
