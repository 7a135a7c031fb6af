"""Head and bed of a simulated printer move by the executed steps of whole prints."""

from math import exp, hypot, inf, nan, pi

import pytest
from tests.support.link_bench import Kind

from passo import _core, config
from passo.config.motion import Shaping
from passo.config.shapers import impulses
from passo.config.simulated_motion import SimulatedMass, simulated_masses
from passo.job.batch.simulated_print import Print
from passo.printer.setup.simulated_world import head_dynamics

_DAMPING = 0.1
_SPEEDS = (60, 80, 100, 120, 140, 160, 180, 200)


def printer(name, kind="", real_hz=50.0, **steps_per_mm):
    """A machine whose axes vibrate with `real_hz`, with shapers of this kind for 50 Hz."""
    machine = config.load(name)
    masses = {n: SimulatedMass(frequency_hz=real_hz) for n in "xyz"}
    steppers = {
        n: machine.steppers[n].model_copy(update={"steps_per_mm": steps})
        for n, steps in steps_per_mm.items()
    }
    return machine.model_copy(
        update={
            "shaping": {n: Shaping(type=kind, frequency_hz=50.0) for n in "xy"} if kind else {},
            "board": machine.board.model_copy(update={"firmware": Kind.firmware}),
            "steppers": {**machine.steppers, **steppers},
            "limits": machine.limits.model_copy(
                update={"print_accel_mm_s2": 3000.0, "travel_accel_mm_s2": 3000.0}
            ),
            "simulated": machine.simulated.model_copy(update={"masses": masses}),
        }
    )


def print_moves(machine, folder, *lines):
    """Prints the lines; the job and the head, which has not moved yet."""
    path = folder / "moves.gcode"
    path.write_text("\n".join(lines) + "\n")
    job = Print(machine)
    head = head_dynamics(machine, job.board)
    head.follow(True)
    rows = [row["count"] / row["steps_per_unit"] for row in job.job.motors.statistics()]
    head.place(job.base, rows[: len(machine.geometry.actuators)])
    job.run(path)
    return job, head


def ringing_at_stops(job, head, real_hz=50.0):
    """The ringing of X and Y in µm at each stop of at least 0.1 s, at its last step."""
    hz, clock, found = job.connection.board.clock_hz, job.base, {}
    while clock < job.connection.now:
        clock += round(0.05 * hz)
        head.run(clock)
        still_s = (clock - head.last_step) / hz
        if still_s > 0.1 and head.last_step not in found:
            grown = 1000 * exp(_DAMPING * 2 * pi * real_hz * still_s)
            found[head.last_step] = [um * grown for um in head.ringing[:2]]
    return list(found.values())


@pytest.mark.parametrize(("kind", "um"), [("", 37.67), ("zv", 1.04), ("mzv", 1.43), ("ei", 3.04)])
def test_golden_ringing_of_real_steps(kind, um, tmp_path):
    job, head = print_moves(printer("i3", kind), tmp_path, "G1 X20 F6000")
    end_s = 20 / 100 + 100 / 3000
    if kind:
        end_s += impulses(kind, 50.0, _DAMPING)[-1][1]
    head.run(job.base + end_s * job.connection.board.clock_hz)
    assert head.ringing[0] * 1000 == pytest.approx(um, abs=0.06)
    head.run(job.connection.now)
    assert head.mm == pytest.approx(head.motor_mm, abs=1e-4)


def test_mzv_leaves_little_ringing_on_and_off_tune(tmp_path):
    moves = [f"G1 X{20 if i % 2 else 40} F{60 * v}\nG4 P500" for i, v in enumerate(_SPEEDS)]

    def ringing(kind, real_hz):
        machine = printer("i3", kind, real_hz, x=160.0)
        return hypot(
            *(x for x, _ in ringing_at_stops(*print_moves(machine, tmp_path, *moves), real_hz))
        )

    assert ringing("mzv", 50.0) <= 0.05 * ringing("", 50.0)
    assert ringing("mzv", 45.0) <= 0.12 * ringing("", 45.0)
    assert ringing("mzv", 55.0) <= 0.12 * ringing("", 55.0)


@pytest.mark.parametrize(("name", "motors"), [("i3", "xy"), ("corexy", "ab"), ("delta", "abc")])
def test_axis_vibrates_alike_in_every_geometry(name, motors, tmp_path):
    """Whichever motors make a move along X, here of fine steps."""
    machine = printer(name, **dict.fromkeys(motors, 320.0))
    moves = ["G1 X40 Y20 Z100 F6000", "G4 P900", "G1 X20", "G4 P900"]
    job, head = print_moves(machine, tmp_path, *moves)
    x, y = ringing_at_stops(job, head)[-1]
    assert x == pytest.approx(38.0, abs=1.5)
    assert y == pytest.approx(0, abs=1.0)
    assert head.mm[:2] == pytest.approx((20, 20), abs=0.01)


def test_machine_file_gives_masses_of_axes_where_they_are_not_typical():
    machine = printer("i3", real_hz=33.0)
    masses = simulated_masses("cartesian", {"y": machine.simulated.masses["y"]})
    assert [mass.frequency_hz for mass in masses] == [55.0, 33.0, 110.0]


@pytest.mark.parametrize("bad", [inf, nan])
def test_head_and_quality_refuse_clocks_that_are_not_finite(bad):
    job = Print(config.load("i3"))
    head = head_dynamics(config.load("i3"), job.board)
    quality = _core.PrintQuality(16e6, head)
    for call in (
        lambda: head.run(bad),
        lambda: head.place(bad, [0.0, 0.0, 0.0]),
        lambda: quality.begin(job.job, bad),
        lambda: quality.run(job.job, bad),
    ):
        with pytest.raises(ValueError, match="clock must be a finite number"):
            call()
    with pytest.raises(ValueError, match="one position for each actuator"):
        head.place(0.0, [0.0])
    with pytest.raises(ValueError, match="a position must be a finite number"):
        head.place(0.0, [0.0, 0.0, bad])
    with pytest.raises(ValueError, match="clock_hz must be"):
        _core.PrintQuality(bad, head)
