"""The page of `passo lab`: the trials of a file in a table, and pictures of one corner."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

from passo.job.durable_files import replaced
from passo.learn.labels import duration, label, round_step, ticks
from passo.learn.page import page, section

if TYPE_CHECKING:
    from passo.job.batch.comparison import Comparison, Trial
    from passo.job.batch.quality_watch import CornerSample, ShownCorner

_BEAD_MM = 0.45  # the width of a printed line in the picture
_BEFORE_S, _AFTER_S = -0.02, 0.12  # of the small charts
_WIDE, _HIGH = 240.0, 104.0  # of a small chart, in pixels
_LEFT, _BOTTOM, _TOP = 42.0, 18.0, 6.0  # its margins
_SIDE = 460.0  # of the other pictures
_COLOURS = (1, 0, 3, 4)  # of the ways around the corner: the plain one first


def write_lab_page(found: Comparison, output: Path) -> None:
    """Writes the page, completely or not at all. Raises OSError."""
    text = lab_page(found)
    with replaced(output) as temporary:
        temporary.write_text(text, encoding="utf-8")


def lab_page(found: Comparison) -> str:
    """The text of the page, which needs no network and has no script."""
    name = os.fsencode(Path(found.file).name).decode("utf-8", "backslashreplace")
    best = found.trials[found.best]
    verdict = f"<p><b>{escape(best.name)}</b></p>\n<p>{escape(found.reason())}</p>\n"
    sections = [section("verdict", "The best setting", verdict), _table(found)]
    plain = found.trials[0].corner
    if plain is not None:
        sections += [
            _corner(found, plain),
            _trade(found),
            _cards(
                found,
                "Across the line after that corner: waves are ringing",
                "Deviation of the head to the left of its line over the time since the motors"
                f" passed the corner of line {plain.line}. Grey: {escape(found.trials[0].name)}.",
                "µm",
                lambda sample: sample.across_um,
                lambda trial: f"{trial.quality.ringing_rms_um:.1f} µm",
            ),
        ]
        if any(sample.width > 0 for sample in plain.samples):
            sections.append(
                _cards(
                    found,
                    "Width of the line around that corner: peaks are blobs",
                    "Percent of the width that the file asks for.",
                    "%",
                    lambda sample: 100 * sample.width if sample.width > 0 else 100.0,
                    lambda trial: f"{trial.quality.width_error:.1%}",
                    zero=100.0,
                )
            )
    title = f"{name} on {found.machine}: settings of the motion, compared"
    return page(title, sections, more_style="lab.css")


# -- the table ------------------------------------------------------------------------------------

_COLUMNS: tuple[tuple[str, Callable[[Trial], float], Callable[[Trial], str]], ...] = (
    ("Print time", lambda t: t.print_time_s, lambda t: duration(t.print_time_s)),
    (
        "Ringing, rms",
        lambda t: t.quality.ringing_rms_um,
        lambda t: f"{t.quality.ringing_rms_um:.1f} µm",
    ),
    ("… 10 % off tune", lambda t: t.off_tune_rms_um, lambda t: f"{t.off_tune_rms_um:.1f} µm"),
    (
        "Ringing, peak",
        lambda t: t.quality.ringing_peak_um,
        lambda t: f"{t.quality.ringing_peak_um:.0f} µm",
    ),
    (
        "Corners rounded",
        lambda t: t.quality.rounding_um,
        lambda t: f"{t.quality.rounding_um:.0f} µm",
    ),
    ("Off the path", lambda t: t.quality.off_path_um, lambda t: f"{t.quality.off_path_um:.1f} µm"),
    ("Width error", lambda t: t.quality.width_error, lambda t: f"{t.quality.width_error:.1%}"),
    ("Motor steps", lambda t: t.steps, lambda t: f"{t.steps:,}"),
    ("Board commands", lambda t: t.commands, lambda t: f"{t.commands:,}"),
)


def _table(found: Comparison) -> str:
    heading = "".join(f"<th>{escape(name)}</th>" for name, _, _ in _COLUMNS)
    most = [max(value(trial) for trial in found.trials) or 1.0 for _, value, _ in _COLUMNS]
    rows = ""
    for i, (trial, score) in enumerate(zip(found.trials, found.scores(), strict=True)):
        cells = "".join(
            f'<td><i style="width:{60 * value(trial) / top:.1f}%"></i>{escape(text(trial))}</td>'
            for (_, value, text), top in zip(_COLUMNS, most, strict=True)
        )
        total = f"{score:.3f}" if trial.followed else "-"
        kind = ' class="best"' if i == found.best else ""
        rows += f"<tr{kind}><th>{escape(trial.name)}</th>{cells}<td>{total}</td></tr>\n"
    note = (
        "Ringing: deviation of the head across its line for 0.1 s after each sharp corner. Corners:"
        " distance of the head's way from them, on average. Off the path: of all printed lines,"
        " rms. Width error: mean over all printed lines. The least score is best."
    )
    if not all(trial.followed for trial in found.trials):
        note += " Without a score: the motors did not follow the file."
    quality = found.trials[0].quality
    note += f" {quality.corners:,} corners, {quality.printed_mm / 1000:,.2f} m of lines."
    return section(
        "trials",
        "Every setting, printed on the simulated machine",
        f"<table><thead><tr><th>Setting</th>{heading}<th>Score</th></tr></thead>\n"
        f"<tbody>{rows}</tbody></table>\n<p>{note}</p>\n",
    )


# -- the way around one corner --------------------------------------------------------------------


def _drawn(found: Comparison) -> list[Trial]:
    """The trials in the picture of the corner: the plain one, the best one, the roundest one."""
    trials = found.trials
    roundest = max(range(len(trials)), key=lambda i: trials[i].quality.rounding_um)
    return [trials[i] for i in dict.fromkeys((0, found.best, roundest))]


def _corner(found: Comparison, plain: ShownCorner) -> str:
    x0, y0 = plain.at_mm
    drawn = _drawn(found)
    widest = max(trial.quality.rounding_um for trial in drawn) / 1000
    reach = max(0.5, 2.5 * widest)

    def line(points: Sequence[tuple[float, float]]) -> str:
        return "M" + "L".join(f"{x - x0:.4f} {y0 - y:.4f}" for x, y in points)

    (ax, ay), (bx, by) = plain.before, plain.after
    far = 2 * reach
    wanted = line([(x0 - far * ax, y0 - far * ay), (x0, y0), (x0 + far * bx, y0 + far * by)])
    ways = "".join(
        f'<path class="line c{_COLOURS[n]}" d="{line([s.head_mm for s in trial.corner.samples])}"/>'
        for n, trial in enumerate(drawn)
        if trial.corner is not None
    )
    keys = "".join(
        f'<span class="k c{_COLOURS[n]}"><i class="line"></i>{escape(trial.name)}</span>'
        for n, trial in enumerate(drawn)
    )
    bar = 0.1 if reach < 1.2 else 0.5
    low = reach * 0.92
    drawing = (
        f'<svg viewBox="{-reach:.3f} {-reach:.3f} {2 * reach:.3f} {2 * reach:.3f}" role="img"'
        f' aria-label="The way of the head around one corner">'
        f'<path class="bead" stroke-width="{_BEAD_MM}" d="{wanted}"/>'
        f'<path class="plan" d="{wanted}"/>{ways}'
        f'<path class="bar" d="M{-low:.3f} {low:.3f}h{bar}"/></svg>'
    )
    return section(
        "drawing",
        f"The corner that rings most: line {plain.line}, X{x0:.1f} Y{y0:.1f}",
        f'<p class="legend">{keys}</p>\n{drawing}\n<p>True to scale; the bar at the lower left is'
        f" {bar:g} mm. The dashed line is the file, the band a line of {_BEAD_MM:g} mm.</p>\n",
    )


# -- ringing against rounding ---------------------------------------------------------------------


def _trade(found: Comparison) -> str:
    """Each shaper as a point: corners rounded, the mean of ringing on tune and off tune."""
    points = [
        (
            trial.quality.rounding_um,
            (trial.quality.ringing_rms_um + trial.off_tune_rms_um) / 2,
            trial.name,
        )
        for trial in found.trials
        if "advance" not in trial.name and "junction" not in trial.name
    ]
    x_step = round_step(max(x for x, _, _ in points) or 1.0, 5)
    y_step = round_step(max(y for _, y, _ in points) or 1.0, 5)
    x_most = x_step * (int(max(x for x, _, _ in points) / x_step) + 1)
    y_most = y_step * (int(max(y for _, y, _ in points) / y_step) + 1)
    left, bottom = 44.0, 40.0
    wide, high = _SIDE - left - 20, 360 - bottom - 12

    def at(x: float, y: float) -> tuple[float, float]:
        return left + wide * x / x_most, 12 + high * (1 - y / y_most)

    grid = "".join(
        f'<path class="frame" d="M{left} {at(0, v)[1]:.1f}h{wide:.1f}"/>'
        f'<text x="{left - 6}" y="{at(0, v)[1] + 4:.1f}" text-anchor="end">'
        f"{label(v, y_step)}</text>"
        for v in ticks(0, y_most, y_step)
    )
    grid += "".join(
        f'<text x="{at(v, 0)[0]:.1f}" y="{12 + high + 16:.1f}" text-anchor="middle">'
        f"{label(v, x_step)}</text>"
        for v in ticks(0, x_most, x_step)
    )
    placed = [at(x, y) for x, y, _ in points]
    taken = [(px - 5, py - 5, px + 5, py + 5) for px, py in placed]
    dots = ""
    for (px, py), (_, _, name) in zip(placed, points, strict=True):
        text_x, text_y, anchor, box = _free_place(px, py, name, taken, left + wide)
        taken.append(box)
        dots += (
            f'<circle class="c0" cx="{px:.1f}" cy="{py:.1f}" r="4.5"/>'
            f'<text class="name" x="{text_x:.1f}" y="{text_y:.1f}" text-anchor="{anchor}">'
            f"{escape(name)}</text>"
        )
    under = (
        f'<text x="{left + wide / 2:.0f}" y="{12 + high + 34:.0f}" text-anchor="middle">'
        "corners rounded by, µm</text>"
    )
    drawing = (
        f'<svg viewBox="0 0 {_SIDE:.0f} 360" role="img"'
        f' aria-label="Ringing against rounding of corners">{grid}{dots}{under}</svg>'
    )
    return section(
        "drawing",
        "What a shaper costs: ringing in µm against rounding",
        f"{drawing}\n<p>Near the lower left corner is best. Ringing is the mean of that on tune and"
        " 10 % off tune.</p>\n",
    )


_Box = tuple[float, float, float, float]


def _free_place(
    x: float, y: float, text: str, taken: Sequence[_Box], most_x: float
) -> tuple[float, float, str, _Box]:
    """Where a label next to a point covers nothing: X, Y, anchor, and the box that it takes."""
    wide = 6.8 * len(text)
    places = [
        (x + across, y + down, anchor, (left, y + down - 11, left + wide, y + down + 3))
        for across, anchor, down, left in (
            (8, "start", 4, x + 8),
            (0, "middle", -9, x - wide / 2),
            (0, "middle", 18, x - wide / 2),
            (-8, "end", 4, x - 8 - wide),
            (6, "start", -20, x + 6),
            (6, "start", 30, x + 6),
            (-6, "end", -20, x - 6 - wide),
        )
    ]

    def covers(box: _Box) -> int:
        x0, y0, x1, y1 = box
        hits = sum(x0 < b[2] and x1 > b[0] and y0 < b[3] and y1 > b[1] for b in taken)
        return hits + (x1 > most_x + 20)

    return min(places, key=lambda place: covers(place[3]))


# -- small charts, one for each trial -------------------------------------------------------------


def _cards(
    found: Comparison,
    title: str,
    note: str,
    unit: str,
    value: Callable[[CornerSample], float],
    figure: Callable[[Trial], str],
    zero: float = 0.0,
) -> str:
    """A small chart for each trial, all in one scale, with the first trial in grey."""
    curves = [
        [(s.s, value(s)) for s in trial.corner.samples if _BEFORE_S <= s.s <= _AFTER_S]
        if trial.corner
        else []
        for trial in found.trials
    ]
    values = [v for curve in curves for _, v in curve] + [zero]
    step = round_step(max(values) - min(values) or 1.0, 4)
    low = step * int(min(values) / step - (min(values) < 0))
    high = step * (int(max(values) / step) + 1)

    def x(seconds: float) -> float:
        return _LEFT + (_WIDE - _LEFT) * (seconds - _BEFORE_S) / (_AFTER_S - _BEFORE_S)

    def y(v: float) -> float:
        return _TOP + (_HIGH - _BOTTOM - _TOP) * (high - v) / (high - low)

    def path(curve: Sequence[tuple[float, float]]) -> str:
        return "M" + "L".join(f"{x(t):.1f} {y(v):.1f}" for t, v in curve) if curve else ""

    grid = "".join(
        f'<path class="frame" d="M{_LEFT} {y(v):.1f}H{_WIDE}"/><text x="{_LEFT - 4}"'
        f' y="{y(v) + 4:.1f}" text-anchor="end">{label(v, step)}</text>'
        for v in ticks(low, high, step)
    )
    grid += "".join(
        f'<text x="{x(ms / 1000):.1f}" y="{_HIGH - 3}" text-anchor="middle">{ms}</text>'
        for ms in (0, 50, 100)
    )
    grid += (
        f'<path class="zero" d="M{_LEFT} {y(zero):.1f}H{_WIDE}"/>'
        f'<path class="corner" d="M{x(0):.1f} {_TOP}V{_HIGH - _BOTTOM}"/>'
    )
    cards = ""
    for i, trial in enumerate(found.trials):
        plain = f'<path class="plain" d="{path(curves[0])}"/>' if i else ""
        kind = ' class="best"' if i == found.best else ""
        cards += (
            f"<figure{kind}><figcaption><b>{escape(trial.name)}</b><span>{figure(trial)}</span>"
            f'</figcaption><svg viewBox="0 0 {_WIDE:.0f} {_HIGH:.0f}" role="img"'
            f' aria-label="{escape(trial.name)}">{grid}{plain}'
            f'<path class="this" d="{path(curves[i])}"/></svg></figure>\n'
        )
    text = f"{note} Vertical: {unit}; horizontal: ms since the corner."
    return section("cards", title, f"<p>{text}</p>\n<div>{cards}</div>\n")
