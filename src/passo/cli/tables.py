"""Short tables in plain text."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from passo.learn.labels import duration

if TYPE_CHECKING:
    from passo.job.batch.board_load import BudgetUse
    from passo.job.batch.comparison import Comparison
    from passo.job.batch.estimate import Estimate
    from passo.job.batch.result import PrintResult
    from passo.study.report import FileRows


def columns(rows: Sequence[Sequence[str]], numbers: int = 0) -> str:
    """Rows with a heading first, aligned in columns; the last `numbers` columns to the right."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    left = len(widths) - numbers
    lines = (
        "  ".join(
            cell.ljust(width) if i < left else cell.rjust(width)
            for i, (cell, width) in enumerate(zip(row, widths, strict=True))
        )
        for row in rows
    )
    return "\n".join(line.rstrip() for line in lines)


def rows(pairs: Sequence[tuple[str, str]]) -> str:
    """Pairs aligned in two columns."""
    width = max(len(name) for name, _ in pairs)
    return "\n".join(f"{name:<{width}}  {text}" for name, text in pairs)


def shares(parts: Mapping[str, float], most: int = 12) -> list[tuple[str, str]]:
    """The largest parts with their time and their fraction of the total."""
    total = sum(parts.values()) or 1.0
    largest = sorted(parts.items(), key=lambda item: -item[1])[:most]
    return [
        (f"  {name}", f"{duration(seconds):>17}  {seconds / total:6.1%}")
        for name, seconds in largest
        if seconds / total >= 0.0005
    ]


def _lengths(parts: Mapping[str, float]) -> str:
    return ", ".join(f"{name} {mm:.1f} mm" for name, mm in parts.items()) or "none"


def _budget(use: BudgetUse, file: str) -> list[tuple[str, str]]:
    """The highest load, and the places and reasons where the file is slowed, or the tolerance of
    steps is widened."""
    densest = [(f"  {name}", share) for name, share in use.shares()]
    pairs = [("at its densest", ""), *densest] if densest else []
    pairs += [
        (f"more than {limit}", f"{place.load:.2f} times at {file}:{place.line}")
        for limit, place in use.limits()
    ]
    if use.unsure_s > 0:
        pairs.append(("may come late there", use.advice))
    if use.widened_s > 0:
        text = f"up to {use.tolerance_us:.1f} µs, for {duration(use.widened_s)}"
        pairs.append(("wider step tolerance", text))
    return pairs


def print_table(result: PrintResult) -> str:
    """The result of a print."""
    total = sum(result.steps.values())
    right = result.final_steps == result.net_steps_expected
    pairs = [
        ("file", result.file),
        ("machine", result.machine),
        ("lines, moves, arcs", f"{result.lines:,}, {result.moves:,}, {result.arcs:,}"),
        ("layers", f"{result.layers:,}"),
        *([("first layer", str(result.first_layer))] if result.first_layer else []),
        ("print time", duration(result.print_time_s)),
        (
            "  moving, heating, waiting",
            ", ".join(
                duration(seconds)
                for seconds in (result.move_time_s, result.heat_time_s, result.dwell_time_s)
            ),
        ),
        ("filament", _lengths(result.filament_mm)),
        ("end position", _lengths(result.final_position_mm)),
        ("motor steps", f"{total:,} in {result.queue_step_commands:,} commands"),
        (
            "net steps at the end",
            "as expected on every motor" if right else "WRONG: " + "; ".join(result.errors),
        ),
        (
            "step time error",
            "{max:.2f} µs at most, {rms:.2f} µs rms".format(**result.step_error_us),
        ),
        ("bytes on the wire", f"{result.wire_bytes:,}"),
        ("stream", result.stream_hash),
        *_budget(result.budget, result.file),
        ("time by limit", ""),
        *shares(result.limits, 6),
        (
            "computer time",
            f"{result.cpu_s['total']:.2f} s, {result.process_peak_rss_mb:.0f} MB"
            f" ({result.print_time_s / max(result.cpu_s['total'], 1e-9):,.0f} times real time)",
        ),
    ]
    return rows(pairs)


def estimate_table(estimate: Estimate) -> str:
    """Time and filament of a file, by layer, feature and limit."""
    layers = [seconds for seconds in estimate.layers_s if seconds > 0]
    pairs = [
        ("file", estimate.file),
        ("machine", estimate.machine),
        ("time", duration(estimate.total_s)),
        (
            "  moving, heating, waiting",
            ", ".join(
                duration(seconds)
                for seconds in (estimate.moving_s, estimate.heating_s, estimate.dwell_s)
            ),
        ),
        ("filament", _lengths(estimate.filament_mm)),
        ("moves, layers", f"{estimate.moves:,}, {estimate.layers:,}"),
        (
            "layer time",
            f"{duration(min(layers))} to {duration(max(layers))}" if layers else "none",
        ),
        *_budget(estimate.budget, estimate.file),
        ("by feature", ""),
        *shares(estimate.features_s),
        ("by limit", ""),
        *shares(estimate.limits_s),
    ]
    return rows(pairs)


def lab_table(found: Comparison) -> str:
    """The trials of a laboratory as a table in which the best one is marked, and the reason for the
    choice."""
    heading = ["", "setting", "print time", "ringing", "10% off", "peak", "corners", "off path"]
    lines = [[*heading, "width", "steps", "commands", "score"]]
    for i, (trial, score) in enumerate(zip(found.trials, found.scores(), strict=True)):
        quality = trial.quality
        deviations = (
            quality.ringing_rms_um,
            trial.off_tune_rms_um,
            quality.ringing_peak_um,
            quality.rounding_um,
            quality.off_path_um,
        )
        lines.append(
            [
                "*" if i == found.best else "",
                trial.name,
                duration(trial.print_time_s),
                *(f"{um:.1f} µm" for um in deviations),
                f"{quality.width_error:.1%}",
                f"{trial.steps:,}",
                f"{trial.commands:,}",
                f"{score:.3f}" if trial.followed else "-",
            ]
        )
    return f"{columns(lines, 10)}\n\n{found.reason()}"


def study_table(found: Sequence[FileRows]) -> str:
    """The best row of each file of a study."""
    lines = [["file", "best", "time", "ringing", "width", "unbeaten", "failed"]]
    for each in found:
        best = each.best
        if best is None:
            figures = ["-", "-", "-", "-"]
        else:
            ringing, width = best.ringing_um, best.width_error
            figures = [
                best.name,
                duration(best.time_s),
                "-" if ringing is None else f"{ringing:.1f} µm",
                "-" if width is None else f"{width:.1%}",
            ]
        counts = [str(sum(row.front for row in each.rows)), str(sum(each.failed.values()))]
        lines.append([each.file, *figures, *counts])
    return columns(lines, 5)
