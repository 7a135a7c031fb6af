"""Written pages as tests read them: the data that their scripts draw."""

from __future__ import annotations

import json
import re
import sys
from array import array
from base64 import b64decode
from dataclasses import dataclass, field
from html import unescape
from itertools import accumulate
from pathlib import Path
from typing import Any

from passo.cli.main import main


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


class Page:
    """A page that `passo report` or `passo lab` has written. A chart is named by the first word of
    its title."""

    def __init__(self, text: str) -> None:
        self.text = text
        (data,) = re.findall(r'<script type="application/json" id="data">(.*?)</script>', text)
        self.data: dict[str, Any] = json.loads(data)
        (self.title,) = map(unescape, re.findall("<h1>(.*?)</h1>", text, re.DOTALL))

    def charts(self) -> list[str]:
        return [chart["title"].split()[0] for chart in self.data["charts"]]

    def chart(self, name: str) -> dict[str, Any]:
        return self.data["charts"][self.charts().index(name)]

    def names(self, chart: str) -> list[str]:
        """The legend of a chart."""
        return [curve["name"] for curve in self.chart(chart)["curves"]]

    def curves(self, chart: str) -> list[Curve]:
        return [Curve.of(curve["series"]) for curve in self.chart(chart)["curves"]]

    def result(self) -> dict[str, str]:
        """The rows of the table."""
        return dict(self.data["result"])


def report(path: Path, *words: str, status: int = 0) -> Page:
    """The report of a file, next to it."""
    page = path.with_suffix(".html")
    assert main(["report", str(path), "--output", str(page), *words]) == status
    return Page(page.read_text(encoding="utf-8"))
