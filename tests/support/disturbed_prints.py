"""A print that is paused, hurried and asked again and again, and where it would have ended."""

import math
import random

from tests.support.scenario import Scenario

from passo import _core
from passo.config.pin_names import MAIN


def spiral():
    """Short moves and long ones, reversals, retractions, and rests of single motors."""
    generator = random.Random(3)
    lines = ["M302 P1", "G28", "G1 X100 Y100 Z5 F6000", "G92 E0"]
    e = 0.0
    for i in range(700):
        r = 5 + i / 20
        e += 0.02
        x, y = 100 + r * math.cos(i / 7), 100 + r * math.sin(i / 7)
        feed = generator.choice((1200, 3000, 6000, 12000))
        lines.append(f"G1 X{x:.3f} Y{y:.3f} E{e:.4f} F{feed}")
        if i % 60 == 30:
            lines += [f"G2 X{x:.3f} Y{y:.3f} I{-r:.3f} J0.1 P3", f"G1 X{x:.3f} Y{y:.3f}"]
        if i % 90 == 89:
            lines += [f"G1 E{e - 1:.4f} F1800", f"G1 Z{5 + i / 300:.3f}", f"G1 E{e:.4f} F1800"]
    return "\n".join(lines) + "\n"


def steps(s):
    return {x.name: s.board.net_steps(x.name) for x in s.board.board.steppers}


def undisturbed(folder, machine="i3"):
    """The folder with the print as a card, and the motors' net steps at its end. A delta prints it
    in the middle of its bed, without the arcs, which are larger than that."""
    text = spiral()
    if machine == "delta":
        text = text.replace("X100 Y100 Z5 F6000", "X0 Y0 Z5 F6000\nG92 X100 Y100", 1)
        text = "".join(x for x in text.splitlines(keepends=True) if not x.startswith("G2 "))
    (folder / "a.g").write_text(text)
    with Scenario(machine, card=str(folder)) as s:
        s.host.ok("M32 a.g")
        s.host.expect("Done printing", 900)
        return folder, steps(s)


def disturb(s, generator, babystep):
    """Until the print is done; `babystep` may shift it, also in a pause."""
    s.host.ok("M32 a.g")
    s.passes(12)
    while "Done printing file" not in s.host.heard:
        s.passes(generator.expovariate(2.0))
        choice = generator.randrange(7)
        if choice == 0:
            s.host.ok("M25")
            s.passes(generator.uniform(0, 4))
            babystep()
            s.host.ok("M24")
        elif choice == 1:
            s.host.ok(f"M220 S{generator.choice((20, 50, 100, 200, 400))}")
        elif choice == 2:
            s.host.ok(f"M204 P{generator.choice((500, 1500, 3000))}")
        elif choice == 3:
            s.host.ok(f"M106 S{generator.randrange(256)}")
        elif choice == 4:
            s.host.ok("M114 R")
        elif choice == 5:
            babystep()
        assert not s.printer.state.halted


def shift_by_babysteps(s, generator, wanted):
    """The same, shifted again and again: at its end by the sum of it. Returns the sums by axis."""
    sums = {"x": 0.0, "z": 0.0}

    def babystep():
        axis, mm = generator.choice("xzz"), generator.randrange(-20, 20) / 20
        if s.host.ok(f"M290 {axis}{mm}") == ["ok"]:
            sums[axis] += mm

    disturb(s, generator, babystep)
    s.host.ok("M400", 60)
    per_mm = {row["name"]: row["steps_per_unit"] for row in s.printer.rig.job.motors.statistics()}
    for name, net in steps(s).items():
        assert net == wanted[name] + round(sums.get(name, 0.0) * per_mm[name]), name
    return sums


def reset(s, board=MAIN):
    """It begins anew. Whatever number it waits for, one of these frames has it."""
    connection = next(c for c in s.printer.rig.connection.connections if c.name == board)
    dictionary, device = connection.dictionary, connection.port.device
    payload = _core.Formats(dictionary.commands).encode(*dictionary.values("reset"))
    now = s.printer.rig.queue.base + s.printer.rig.queue.now
    for number in range(16):
        device.feed(_core.make_frame(payload, number), now)
