"""`passo calibrate thermistor`: finds the β of a thermistor from true temperatures, step by
step."""

from __future__ import annotations

import argparse
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

from passo.cli.machine_option import add_machine
from passo.errors import ConfigError, ExitStatus, InputError

if TYPE_CHECKING:
    from passo.cli.answers import Answers
    from passo.config.heat import Heater
    from passo.config.thermistor import Ntc
    from passo.heat.calibration import Point

_ROUNDS_C = (20, 10, 5)
_START_C = {"hotend": 160, "bed": 40, "chamber": 40}
_END_C = 240  # above this, PTFE in a hotend degrades
_THERE = {"hotend": "into the nozzle", "bed": "onto the bed", "chamber": "into the chamber"}

_GUIDE = """\
Put a thermometer that you trust {there}. Heat only; nothing moves. At each temperature
below wait two minutes, then type what the thermometer says (Enter alone leaves a point out, b goes
back to the one before, q ends the round). Never go above {end} °C. After each round send the new β,
run an autotune (M303) and go on with smaller steps.
{file} keeps the answers: if this is cut off, start it again there and go on."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the options of `passo calibrate`."""
    parser.add_argument("what", choices=("thermistor",), help="what to calibrate")
    add_machine(parser)
    parser.add_argument("--heater", default="hotend", help="the heater's name; default: hotend")
    parser.add_argument("--beta", type=float, help="the β in use, if not the machine file's")
    parser.add_argument(
        "--points",
        nargs="+",
        metavar="SHOWN:TRUE",
        help="temperatures that were shown and measured before; without them, guides the procedure",
    )


def run(arguments: argparse.Namespace) -> int:
    """Guides the user through the rounds of measurements, or computes β from the points on the
    command line. Raises ConfigError, InputError."""
    heater, number = _heater(arguments)
    ntc = _thermistor(arguments, heater)
    if arguments.points:
        points = sorted((_point(text) for text in arguments.points), key=lambda p: p.shown_c)
        for before, point in pairwise(points):
            _check_order(before, point)
        print(_result(ntc, number, points))
        return ExitStatus.DONE
    from passo.cli.answers import Answers

    end_c = int(min(_END_C, heater.max_c))
    of = f"passo calibrate thermistor: {arguments.heater} of {arguments.machine}, β {ntc.beta_k:g}"
    answers = Answers(Path(f"thermistor-{arguments.heater}.txt"), of)
    print(_GUIDE.format(there=_THERE[heater.kind], end=end_c, file=answers.path))
    if answers.again:
        print(f"It holds {answers.again} answers. To start again, delete it.")
    for step in _ROUNDS_C:
        ladder = range(_START_C[heater.kind], end_c + 1, step)
        points, ended = _round(answers, _heats(heater, number), ladder)
        if points:
            print(_result(ntc, number, points))
            ntc = _chosen(ntc, points)
        if ended:
            return ExitStatus.DONE
    answers.forget()
    return ExitStatus.DONE


def _heater(arguments: argparse.Namespace) -> tuple[Heater, int | None]:
    """The heater to calibrate, and its H number in commands."""
    from passo import config
    from passo.config.findings import did_you_mean
    from passo.config.heater_numbers import number_of

    machine = config.load(arguments.machine)
    heater = machine.heaters.get(arguments.heater)
    if heater is None or heater.sensor.kind != "thermistor":
        limit = "the name of a heater with a thermistor"
        hint = did_you_mean(arguments.heater, machine.heaters)
        raise ConfigError.of(
            "config.value", hint=hint, key="--heater", value=arguments.heater, limit=limit
        )
    return heater, number_of(machine, arguments.heater)


def _thermistor(arguments: argparse.Namespace, heater: Heater) -> Ntc:
    from passo.config.sensors import Thermistor
    from passo.config.thermistor import Ntc
    from passo.heat.calibration import MAX_BETA_K, MIN_BETA_K

    sensor = heater.sensor
    assert isinstance(sensor, Thermistor)
    beta_k = sensor.beta_k if arguments.beta is None else arguments.beta
    if not MIN_BETA_K <= beta_k <= MAX_BETA_K:
        limit = f"a β from {MIN_BETA_K:g} to {MAX_BETA_K:g} K"
        raise ConfigError.of("config.value", key="--beta", value=beta_k, limit=limit)
    return Ntc(sensor.r25_ohm, beta_k, sensor.c_per_k)


def _heats(heater: Heater, number: int | None) -> str:
    """The command that sets the heater's target, without the number."""
    if heater.kind == "hotend":
        return f"M104 T{number} S" if number else "M104 S"
    return "M140 S" if heater.kind == "bed" else "M141 S"


def _point(text: str, advice: str = "") -> Point:
    """Parses a point. Raises InputError, with `advice`, if it is implausible even for a thermistor
    with a wrong β."""
    from passo.heat.calibration import FAR, Point

    try:
        shown, true = (float(word.replace(",", ".")) for word in text.split(":"))
    except ValueError:
        shown = true = 0.0
    if not (0 < shown <= 400 and 0 < true <= 400):
        raise InputError.of("input.point", hint=advice, value=text)
    if abs(true - shown) > FAR * shown:
        limit = f"{(1 - FAR) * shown:.0f} to {(1 + FAR) * shown:.0f}"
        raise InputError.of("input.point-far", value=true, key=shown, limit=limit)
    return Point(shown, true)


def _check_order(before: Point, point: Point) -> None:
    """Raises InputError if the readings rise but the true temperatures do not."""
    if point.shown_c > before.shown_c and point.true_c <= before.true_c:
        raise InputError.of(
            "input.point-order",
            value=point.true_c,
            key=point.shown_c,
            limit=before.true_c,
            before=before.shown_c,
        )


def _round(answers: Answers, heats: str, ladder: range) -> tuple[list[Point], bool]:
    """Asks for the points of one round; returns them, and whether the input has ended. `heats`: see
    `_heats`. The round ends before the true temperature exceeds the last step of `ladder`."""
    print(f"\nRound in steps of {ladder.step} °C")
    points: list[Point] = []
    at = 0
    while at < len(ladder):
        celsius = ladder[at]
        if points and (likely_c := celsius + points[-1].true_c - points[-1].shown_c) > ladder.stop:
            print(f"{celsius} °C would truly be {likely_c:.0f} °C or so: the round ends here.")
            return points, False
        word = answers.ask(f"{heats}{celsius}, wait 2 min, true °C: ")
        if word is None or word.lower() == "q":
            return points, word is None
        if word.lower() == "b":
            at = max(at - 1, 0)
            points = [point for point in points if point.shown_c < ladder[at]]
            continue
        try:
            if word:
                point = _point(f"{celsius}:{word}", "Type the true one alone, as 187")
                if points:
                    _check_order(points[-1], point)
                points.append(point)
        except InputError as error:
            print(error)
        else:
            at += 1
    return points, False


def _result(ntc: Ntc, number: int | None, points: list[Point]) -> str:
    """Both results with their residuals."""
    from passo.heat.calibration import by_averages, by_least_squares

    rule, fit = by_averages(ntc, points), by_least_squares(ntc, points)
    lines = [f"{'shown':>8} {'true':>8} {'averages':>9} {'fit':>9}   what β would say off by, °C"]
    for p, a, b in zip(points, rule.residuals_c, fit.residuals_c, strict=True):
        off = " ".join(f"{round(x, 1) + 0.0:+9.1f}" for x in (a, b))  # no -0.0
        lines.append(f"{p.shown_c:8.1f} {p.true_c:8.1f} {off}")
    lines.append(f"{'rms':>17} {rule.rms_c:9.1f} {fit.rms_c:9.1f}")
    lines.append(f"{'β in K':>17} {rule.beta_k:9.0f} {fit.beta_k:9.0f}")
    to_use = f"beta_k = {fit.beta_k:.0f} in the machine file"
    if number is not None:
        to_use = f"M305 H{number} B{fit.beta_k:.0f}, then M303 H{number} U, then M500"
    lines.append(f"To use the fit: {to_use}.")
    return "\n".join(lines)


def _chosen(ntc: Ntc, points: list[Point]) -> Ntc:
    """The thermistor with the fitted β, from which the next round starts."""
    from dataclasses import replace

    from passo.heat.calibration import by_least_squares

    return replace(ntc, beta_k=float(round(by_least_squares(ntc, points).beta_k)))
