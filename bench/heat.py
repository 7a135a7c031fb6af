"""How the simulated hotend of the i3 is controlled: the table of docs/explanation/heat.md.

    .venv/bin/python bench/heat.py

From 25 to 210 °C in still air for 240 s, then with its fan at full speed for 120 s.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from tests.heat.oven import Oven
from tests.heat.test_tune import relay, tuned

TARGET_C = 210.0
NEAR_C = 0.5  # what counts as settled


def by_rule(rule: int) -> str:
    """The control that M303 finds with a rule."""
    oven = Oven()
    tune = relay(oven, TARGET_C, rule=rule)
    tuned(oven, tune)
    gains = tune.result
    assert gains is not None
    return f"control = {{ kind = 'pid', kp = {gains.kp}, ki = {gains.ki}, kd = {gains.kd} }}"


def last_far(rows: list[tuple[float, float, float, float]], begin: float) -> float:
    """Seconds from `begin` to the last row that is not settled."""
    return max((s - begin for s, body, _, _ in rows if abs(body - TARGET_C) > NEAR_C), default=0.0)


def main() -> None:
    controls = {
        "PID, gains left out": "",
        "PID, fan not in its model": (
            "model = { rise_c = 380.0, time_constant_s = 120.0, fan_loss = 0.0 }"
        ),
        "PID, tuned by rule 0": by_rule(0),
        "PID, tuned by rule 2": by_rule(2),
        "model": "control = { kind = 'model' }",
    }
    for name, control in controls.items():
        oven = Oven(control)
        begin = oven.now_s
        oven.heat(TARGET_C)
        rise = oven.run(240)
        over = max(0.0, *(body - TARGET_C for _, body, _, _ in rise))
        gust = oven.now_s
        oven.blow(1.0)
        wind = oven.run(120)
        worst = max((body - TARGET_C for _, body, _, _ in wind), key=abs)
        print(
            f"{name:25}  overshoot {over:.1f} °C, settled {last_far(rise, begin):.0f} s, "
            f"fan {worst:+.1f} °C, {last_far(wind, gust):.0f} s"
        )


if __name__ == "__main__":
    main()
