"""M1000 after the power has gone at any moment: what it prints begins where the print was cut off,
or a little before, and ends as if nothing had happened."""

import random
import re
import shutil
from bisect import bisect_right

import pytest
from tests.job.test_filtered_prints import DELAY_S, FILTERED
from tests.job.test_journal import journal_of
from tests.support.scenario import Scenario

from passo import config
from passo.job.live.journal_keeper import EVERY_S
from passo.motion.motion_queue import TICK_S

# Power cuts of each machine: while it homes and warms up, and while it prints. What the file itself
# makes different is found on the first; the others add their geometry, or their tools.
# bench/faults.py makes more cuts.
CUTS = {"i3": (8, 24), "corexy": (2, 7), "delta": (2, 7), "dual-extruder": (2, 7)}
HORIZON_S = EVERY_S + 2 * TICK_S  # between two records, each noticed a tick late at most
SPEED_MM_S = 50.0
Z_MM_S = 10.0
FILAMENT = 0.05  # mm by mm of path
SIDES_MM = (12.0, 8.0, -12.0, -8.0)  # of a ring: along X, Y, X and Y
RINGS = (6, 1)  # of the two parts of a layer; six take longer than a horizon
HOP_MM = 0.4  # from one part to the other
LAYERS = 3
PRIME_MM = 5.0  # see Park
STEP_MM = 1 / 80  # the coarsest of these machines
HEAD = ["M302 P1", "G28", "M109 S45", "M106 S128", "G92 E0", "G1 X10 Y10 Z5 F600"]


def rings():
    """A file, and where each of its lines that moves ends: X, Y, Z and E by its number."""
    lines, ends = HEAD[:], {len(HEAD): (10.0, 10.0, 5.0, 0.0)}
    e = 0.0

    def add(text, *end):
        lines.append(text)
        ends[len(lines)] = end

    for layer in range(1, LAYERS + 1):
        z = round(0.2 * layer, 1)
        for part, high in enumerate((z, z + HOP_MM)):
            x, y, _, _ = ends[len(lines)]
            add(f"G1 Z{high:.1f} F{60 * Z_MM_S}", x, y, high, e)
            x = y = 10.0 + 20.0 * part
            add(f"G1 X{x} Y{y} F9000", x, y, high, e)
            add(f"G1 Z{z} F{60 * Z_MM_S}", x, y, z, e)
            for at in range(4 * RINGS[part]):
                mm = SIDES_MM[at % 4] * (1 - at // 4 / 8)  # each ring within the one before
                x, y = (x, y + mm) if at % 2 else (x + mm, y)
                e = round(e + abs(mm) * FILAMENT, 3)
                add(f"G1 X{x} Y{y} E{e} F{60 * SPEED_MM_S}", x, y, z, e)
    return "".join(f"{line}\n" for line in lines), ends


TEXT, ENDS = rings()


class Cuts:
    """One print of a machine, and what the power would leave of it at random instants: what is on
    the disk, and where the motors are. `counts`: instants while it homes and warms up, and while it
    prints. With filters the motors follow the plan `delay_s` later, and the filament leads by up to
    `lead_mm`."""

    def __init__(self, machine, counts, seed, directory, delay_s=0.0, lead_mm=0.0):
        self.machine, self.directory = machine, directory
        self.delay_s, self.lead_mm = delay_s, lead_mm
        (directory / "card").mkdir()
        (directory / "card" / "rings.gcode").write_text(TEXT)
        self.starts, self.clocks, self.left = [], [], []
        with self.printer("whole") as s:
            s.host.ok("M32 rings.gcode")
            begun = s.loop.time()
            assert s.until(lambda: self.filament(s) > 0, 100)
            prints, ends = s.loop.time() - begun, self.ended(s) - begun
            self.end = self.nozzle(s)
            self.targets = {n: h.target for n, h in s.printer.rig.connection.heaters.items()}
        generator = random.Random(seed)
        before, printing = counts
        instants = [generator.uniform(0, prints) for _ in range(before)]
        instants += [generator.uniform(prints, ends) for _ in range(printing)]
        with self.printer("cut") as s:
            s.printer.rig.job.results.keep_moves(True)
            s.host.ok("M32 rings.gcode")
            begun = s.loop.time()
            for number, instant in enumerate(sorted(instants)):
                s.passes(begun + instant - s.loop.time())
                s.printer.rig.queue.look()  # the board is ahead of the host
                shutil.copytree(directory / "cut", directory / str(number))
                self.left.append((s.positions(), self.filament(s)))
                self.clocks.append(s.printer.rig.queue.now)
                self.starts += [
                    (m.core.start_ticks if hasattr(m, "core") else m.start_ticks, m.line)
                    for m in s.printer.rig.job.results.take_moves()
                    if m.line
                ]
            self.hz = s.printer.rig.queue.hz

    def printer(self, state):
        places = {"card": self.directory / "card", "state": self.directory / state}
        return Scenario(self.machine, **{name: str(path) for name, path in places.items()})

    def filament(self, s):
        return sum(s.positions()[name] for name in self.machine.extruders)

    def nozzle(self, s):
        """Where it is, by the motors."""
        geometry, motors = self.machine.geometry, s.positions()
        return geometry.forward(tuple(motors[name] for name in geometry.actuators))

    def ended(self, s):
        """The loop's time at the end of the print."""
        s.host.expect("Done printing", 100)
        return s.loop.time()

    def z_off_mm(self, number):
        """How far Z may be from where it is kept: what it goes from one look at it to the next."""
        under_way = {self.line_at(number, ago) for ago in (0, 2 * TICK_S + self.delay_s)}
        moves = any("Z" in TEXT.split("\n")[line - 1] for line in under_way)
        return 0.03 + (Z_MM_S * (TICK_S + self.delay_s) if moves else 0.0)

    def line_at(self, number, ago_s):
        """The line whose move was under way so long before a cut; 0: none."""
        clock = self.clocks[number] - ago_s * self.hz
        at = bisect_right(self.starts, (clock, len(TEXT)))
        return self.starts[at - 1][1] if at else 0


def goes_on(cuts, number):
    """The print after a cut; returns the line that it has gone on with, 0 for its beginning."""
    left, pushed = cuts.left[number]

    def reached(s, place, z_off_mm):
        assert cuts.nozzle(s)[:2] == pytest.approx(place[:2], abs=0.03), number
        assert cuts.nozzle(s)[2] == pytest.approx(place[2], abs=z_off_mm), number

    with cuts.printer(str(number)) as s:
        for stepper in cuts.machine.geometry.actuators:
            s.board.place(stepper, left[stepper])
        s.host.send("M1000")
        answer = s.host.expect("echo:Printing rings.gcode from", 100)
        found = re.search(r" from line (\d+)$", answer)
        line = int(found[1]) if found else 0
        earliest = cuts.line_at(number, HORIZON_S + cuts.delay_s)
        assert earliest <= line <= cuts.line_at(number, 0), number
        begins, primed, z_off_mm = 0.0, 0.0, 0.03
        if line:
            *place, begins = ENDS.get(line - 1, (*cuts.machine.home_point, 0.0))
            primed, z_off_mm = PRIME_MM, cuts.z_off_mm(number)
            reached(s, place, z_off_mm)
            again = pushed - begins
            most = max(abs(mm) for mm in SIDES_MM) + HORIZON_S * SPEED_MM_S
            assert -STEP_MM <= again <= most * FILAMENT + cuts.lead_mm, number
            assert s.board.temperature("hotend") > 43
        assert cuts.filament(s) == pytest.approx(primed, abs=STEP_MM), number
        cuts.ended(s)
        reached(s, cuts.end, z_off_mm)
        rest = ENDS[max(ENDS)][3] - begins
        assert cuts.filament(s) == pytest.approx(primed + rest, abs=2 * STEP_MM), number
        assert {n: h.target for n, h in s.printer.rig.connection.heaters.items()} == cuts.targets
    assert journal_of(cuts.directory / str(number)) is None
    return line


def filtered_cuts(machine, seed, printing, directory):
    """Cuts of a print with all filters of FILTERED."""
    advance_s = next(iter(machine.extruders.values())).advance_s
    lead_mm = advance_s * SPEED_MM_S * FILAMENT
    return Cuts(machine, (2, printing), seed, directory, DELAY_S, lead_mm)


def all_resumed(cuts):
    """The lines with which the print continues after each cut."""
    lines = [goes_on(cuts, number) for number in range(len(cuts.left))]
    assert lines == sorted(lines)
    return lines


@pytest.mark.parametrize("machine", CUTS)
def test_resume_skips_nothing_and_repeats_at_most_a_horizon(machine, tmp_path):
    _, printing = CUTS[machine]
    lines = all_resumed(Cuts(config.load(machine), CUTS[machine], machine, tmp_path))
    assert lines[0] == 0
    assert len(set(lines)) > printing / 4


def test_filtered_print_resumes_where_it_was_cut(tmp_path):
    """With shaped axes and an advanced extruder; bench/faults.py makes more cuts."""
    lines = all_resumed(filtered_cuts(FILTERED, 1, 5, tmp_path))
    assert len(set(lines)) > 2
