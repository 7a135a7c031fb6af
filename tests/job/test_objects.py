"""Objects of a print from the card that clients cancel: replies, pauses, restarts, power cuts."""

from __future__ import annotations

import pytest
from tests.support.scenario import Host, Scenario

from passo.config import load

PLACES = {"Würfel 1": 50, 'B;(2) "x"': 100, "c": 150}  # X of each object


def sliced(layers: int = 6) -> str:
    """Three objects, each a line of 20 mm along Y in each layer, with retraction between them."""
    lines = ["M302 P1", "G28", "M83", "G1 Z5 F600"]
    lines += [
        f"EXCLUDE_OBJECT_DEFINE NAME='{name}' CENTER={x},20 POLYGON=[[{x},10],[{x},30]]"
        for name, x in PLACES.items()
    ]
    for layer in range(1, layers + 1):
        for name, x in PLACES.items():
            lines += [
                f"EXCLUDE_OBJECT_START NAME='{name}'",
                f"G1 Z{layer + 0.5} F600",
                f"G1 X{x} Y10 F6000",
                f"G1 Z{layer} F600",
                "G1 E2 F1200",
                "G1 Y30 E1 F600",
                "G1 E-2 F1200",
                f"EXCLUDE_OBJECT_END NAME='{name}'",
            ]
    return "\n".join([*lines, "G1 Z20 F600", "G1 X10 Y90 F6000", "M118 end code"]) + "\n"


@pytest.fixture
def places(tmp_path):
    (tmp_path / "card").mkdir()
    (tmp_path / "card" / "a.g").write_text(sliced(), encoding="utf-8")
    return {"card": str(tmp_path / "card"), "state": str(tmp_path / "state")}


class Laid:
    """Where the head has laid filament: (layer, X), in order."""

    def __init__(self, s: Scenario) -> None:
        self.lines: list[tuple[int, int]] = []
        s.printer.lifetime.as_time_passes(lambda: self._look(s))

    def _look(self, s: Scenario) -> None:
        at = s.positions()
        place = round(at["z"]), round(at["x"])
        printing = place[1] in PLACES.values() and abs(at["z"] - place[0]) < 0.01
        laying = printing and 12 < at["y"] < 28 and s.assembly.services.jobs.runner.active
        laying = laying and not s.printer.rig.job.stops.suspended
        if laying and (not self.lines or self.lines[-1] != place):
            self.lines.append(place)


def started(s: Scenario) -> Laid:
    s.host.ok("M32 a.g")
    laid = Laid(s)
    assert s.until(lambda: laid.lines != [], 200)
    return laid


def all_but(*left_out: tuple[int, int]) -> list[tuple[int, int]]:
    every = [(layer, x) for layer in range(1, 7) for x in PLACES.values()]
    return [place for place in every if place not in left_out]


def test_a_cancelled_object_is_printed_no_further(places):
    with Scenario("i3", **places) as s:
        laid = started(s)
        answer = s.host.ok("M486 P1")
        last = int(answer[0].split("line ")[1].split()[0])
        done = sum(
            n + 1 < last for n, x in enumerate(sliced().splitlines()) if x == "G1 Y30 E1 F600"
        )
        planned = all_but()[:done]
        assert answer == [
            f'echo:Object 1 B;(2) "x" is cancelled; moves up to line {last} are planned already'
            " and still printed",
            "ok",
        ]
        assert s.host.ok("M486 P1")[0] == 'echo:Object 1 B;(2) "x" is cancelled already'
        s.host.expect("^end code$", 600)
        s.host.expect("^Done printing file$", 60)
        left_out = [(n, 100) for n in range(1, 7) if (n, 100) not in planned]
        assert len(left_out) >= 4
        assert laid.lines == all_but(*left_out)
        assert s.printer.rig.job.machine_position[3] == pytest.approx(18 - len(left_out))


def test_objects_are_listed_with_what_is_printed_now(places):
    with Scenario("i3", **places) as s:
        laid = started(s)
        assert laid.lines == [(1, 50)]
        s.host.ok("EXCLUDE_OBJECT NAME=C")
        for line in ("M486", "EXCLUDE_OBJECT"):
            assert s.host.ok(line) == [
                "echo:Objects: 3",
                "echo:0 Würfel 1: printed now",
                'echo:1 B;(2) "x"',
                "echo:2 c: cancelled",
                "ok",
            ]
        s.host.expect("^Done printing file$", 600)


@pytest.mark.parametrize(
    ("order", "number"),
    [
        ("M486 P2", 2),
        ("M486 C", 0),
        ("EXCLUDE_OBJECT CURRENT=1", 0),
        ("EXCLUDE_OBJECT NAME=c", 2),
        ('exclude_object name="C"', 2),
        ("EXCLUDE_OBJECT NAME=Würfel 1", 0),
        ("EXCLUDE_OBJECT NAME='würfel 1'", 0),
    ],
)
def test_each_way_to_cancel_one_and_to_take_it_back(places, order, number):
    with Scenario("i3", **places) as s:
        started(s)
        s.host.send_bytes(order.encode() + b"\n")
        s.host.expect(f"^echo:Object {number} .*is cancelled; moves up to line", 1)
        objects = s.assembly.services.jobs.objects
        assert [one.cancelled for one in objects.all] == [i == number for i in range(3)]
        back = f"M486 U{number}" if order[0] == "M" else "EXCLUDE_OBJECT RESET=1"
        assert s.host.ok(back)[0].startswith(f"echo:Object {number} ")
        assert not any(one.cancelled for one in objects.all)
        s.host.ok("M524")


def test_the_status_names_the_objects(places):
    with Scenario("i3", **places) as s:
        started(s)
        s.host.ok("M486 P2")
        job = s.printer.status.read().job
        assert job is not None and job.current_object == 0
        assert [(o.number, o.name, o.cancelled) for o in job.objects] == [
            (0, "Würfel 1", False),
            (1, 'B;(2) "x"', False),
            (2, "c", True),
        ]
        assert [o.centre_mm for o in job.objects] == [(50, 20), (100, 20), (150, 20)]
        assert job.objects[0].outline_mm == ((50, 10), (50, 30))


def test_an_object_is_cancelled_in_a_pause(places):
    with Scenario("i3", **places) as s:
        laid = started(s)
        s.host.ok("M25")
        s.passes(10)
        s.host.ok("M486 P2")
        s.host.ok("G91")
        s.host.ok("G1 X5 F6000")
        s.host.ok("G90")
        s.host.ok("M24")
        s.host.expect("^Done printing file$", 600)
        assert [x for layer, x in laid.lines if layer > 2].count(150) == 0
        assert [place for place in laid.lines if place[1] != 150] == all_but(
            *((n, 150) for n in range(1, 7))
        )
        assert s.positions()["x"] == 10


def test_with_all_objects_cancelled_the_print_runs_to_its_end(places):
    with Scenario("i3", **places) as s:
        laid = started(s)
        for number in range(3):
            s.host.ok(f"M486 P{number}")
        s.host.expect("^end code$", 60)
        s.host.expect("^Done printing file$", 60)
        assert max(layer for layer, _ in laid.lines) <= 2
        assert (s.positions()["x"], s.positions()["y"], s.positions()["z"]) == (10, 90, 20)
        # Retracted once, however many retractions were skipped.
        assert s.printer.rig.job.machine_position[3] == pytest.approx(len(laid.lines))


def test_another_print_begins_with_all_objects(places):
    with Scenario("i3", **places) as s:
        started(s)
        for number in range(3):
            s.host.ok(f"M486 P{number}")
        s.host.expect("^Done printing file$", 60)
        laid = started(s)
        assert not any(one.cancelled for one in s.assembly.services.jobs.objects.all)
        s.host.expect("^Done printing file$", 600)
        assert laid.lines == all_but()


def test_a_cancelled_object_stays_so_after_a_power_cut(places):
    with Scenario("i3", **places) as s:
        laid = started(s)
        s.host.ok("M486 P1")
        assert s.until(lambda: laid.lines[-1] == (3, 150), 200)
        s.passes(1.5)
        left = s.positions()
    with Scenario("i3", **places) as s:
        for axis in "xyz":
            s.board.place(axis, left[axis])
        s.host.ok("M302 P1")
        laid = Laid(s)
        s.host.ok("M1000", 600)
        assert [one.cancelled for one in s.assembly.services.jobs.objects.all] == [
            False,
            True,
            False,
        ]
        s.host.expect("^Done printing file$", 600)
        assert laid.lines[-6:] == [(n, x) for n in (4, 5, 6) for x in (50, 150)]
        assert 100 not in [x for _, x in laid.lines]


def test_failed_object_commands_name_the_reason(places):
    with Scenario("i3", **places) as s:
        wrong = "echo:no file that labels its objects is being printed"
        assert s.host.ok("M486 P0")[0].startswith(wrong)
        assert s.host.ok("EXCLUDE_OBJECT NAME=c")[0].startswith(wrong)
        started(s)
        assert s.host.ok("M486 P3")[0].startswith(
            "echo:3 is not an object of this print: expected 0 to 2, or a name"
        )
        assert s.host.ok("EXCLUDE_OBJECT NAME=d")[0].startswith("echo:d is not an object")
        assert s.host.ok("M486 X")[0].startswith("echo:X names no object: expected P, U or C")
        note = s.host.ok("M486 S1")
        assert note[0].startswith("echo:M486 labels objects of a file on the card")
        assert s.host.ok("M486 S1") == ["ok"]
        assert Host(s).ok("EXCLUDE_OBJECT_START NAME=c")[0].startswith("echo:EXCLUDE_OBJECT_START")
        s.host.ok("M524")


def test_a_name_of_several_objects_must_be_numbered(places, tmp_path):
    text = "M302 P1\nM83\nM486 T2\n"
    text += "".join(f'M486 S{i} A"cube"\nG1 X{i + 10} E1 F60\nM486 S-1\n' for i in range(2))
    (tmp_path / "card" / "b.g").write_text("G28\n" + text)
    with Scenario("i3", **places) as s:
        s.host.ok("M32 b.g")
        s.passes(5)
        answer = s.host.ok("EXCLUDE_OBJECT NAME=Cube")[0]
        assert answer.startswith("echo:several objects have the name Cube: 0, 1")
        assert s.host.ok("M486 P1")[0].startswith("echo:Object 1 cube is cancelled")


def test_no_object_is_cancelled_where_a_laser_would_burn(tmp_path):
    (tmp_path / "a.g").write_text("M486 T1\nM486 S0\nG92 X0\nG1 X10 F60\nM486 S-1\n")
    assert load("laser").laser is not None
    with Scenario("laser", card=str(tmp_path)) as s:
        s.host.ok("M32 a.g")
        s.passes(2)
        assert s.host.ok("M486 P0")[0].startswith("echo:objects cannot be cancelled on a machine")


def test_consoles_are_served_while_a_large_object_is_skipped(tmp_path):
    moves = "".join(f"G1 X{i % 100} E1 F6000\n" for i in range(100_000))
    (tmp_path / "a.g").write_text(
        f"M302 P1\nG92 X0\nM486 P0\nM486 S0\nM118 begins\n{moves}M486 S-1\n"
    )
    seen = set[int]()
    with Scenario("i3", card=str(tmp_path)) as s:
        runner = s.assembly.services.jobs.runner

        def look(_: str = "") -> None:
            """In each turn of the event loop; no time passes while moves are skipped."""
            seen.add(runner.offset)
            if runner.active and runner.offset < runner.size:
                s.loop.call_soon(look)

        s.printer.state.listeners.append(lambda text: look() if text == "begins" else None)
        s.host.ok("M32 a.g")
        s.host.expect("^Done printing file$", 60)
        assert len(seen) > runner.size / (1 << 14)
