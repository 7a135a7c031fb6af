"""A print from the card: its program, its end, and where its motors are then."""

from __future__ import annotations

from tests.support.scenario import Scenario

SQUARE = "M302 P1\nG28\nG1 Z0.2 F600\n" + "".join(
    f"G1 X{10 + 50 * (i % 2)} Y{10 + 50 * (i // 2 % 2)} E{i / 10} F6000\n" for i in range(60)
)


def printed(s: Scenario, within_s: float = 200) -> None:
    """Waits for the end of the print."""
    s.host.expect("^Done printing file$", within_s)


def steps(s: Scenario) -> dict[str, int]:
    """Net steps that the board has made, by motor."""
    return {x.name: s.board.net_steps(x.name) for x in s.board.board.steppers}
