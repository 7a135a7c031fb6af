"""Whether a file fits a printer is found out once for each content and machine."""

from __future__ import annotations

import asyncio
from pathlib import Path

import pytest
from tests.support.farm_world import play

from passo.config.load import shipped_text
from passo.hub.fits import FileFits, find_fit
from passo.hub.link import Refused, Unreachable
from passo.hub.matching import Fit

I3 = shipped_text("i3")
PART, OTHER = "a" * 64, "b" * 64


class Machines:
    """The machine files of printers; an exception is raised in place of one."""

    def __init__(self, **texts: str | Exception) -> None:
        self.texts, self.asked = texts, 0

    async def __call__(self, printer: str) -> str:
        self.asked += 1
        found = self.texts[printer]
        if isinstance(found, Exception):
            raise found
        return found


class Work:
    """Counts what is planned."""

    def __init__(self) -> None:
        self.done: list[tuple[str, str]] = []

    def __call__(self, text: str, path: Path) -> Fit:
        self.done.append((text, path.name))
        return Fit(fits=text != "small", why="too large", print_s=60.0)


def fits_of(machines: Machines, work: Work, changes: list[int]) -> FileFits:
    return FileFits(machines, lambda sha256: Path(sha256), lambda: changes.append(1), work)


def test_equal_machines_share_one_plan():
    async def test():
        work, changes = Work(), []
        fits = fits_of(Machines(a="i3", b="i3", c="small"), work, changes)
        assert [fits(PART, printer) for printer in "abc"] == [None] * 3
        await asyncio.sleep(1)
        assert [fits(PART, printer) for printer in "abc"] == [None] * 3  # now it is planned
        await asyncio.sleep(1)
        assert [fits(PART, printer).fits for printer in "abc"] == [True, True, False]
        assert sorted(work.done) == [("i3", PART), ("small", PART)]
        assert fits(OTHER, "a") is None
        await asyncio.sleep(1)
        assert fits(OTHER, "a").print_s == 60.0
        assert len(changes) == 6  # three machine files, three plans
        await fits.close()

    play(test)


def test_changed_machine_file_is_planned_again():
    async def test():
        machines, work = Machines(a="i3"), Work()
        fits = fits_of(machines, work, [])
        for _ in range(3):
            fits(PART, "a")
            await asyncio.sleep(1)
        machines.texts["a"] = "small"
        assert fits(PART, "a").fits
        await asyncio.sleep(300)
        fits(PART, "a")  # asks again
        await asyncio.sleep(1)
        assert fits(PART, "a") is None
        await asyncio.sleep(1)
        assert not fits(PART, "a").fits
        assert machines.asked == 2
        await fits.close()

    play(test)


@pytest.mark.parametrize(
    ("answer", "fit", "asked"),
    [
        ("", Fit(fits=True), 1),
        (Refused("web.role", "no", "Ask"), Fit(fits=True), 1),
        (Unreachable("no answer"), None, 3),
    ],
    ids=["no machine file", "refused", "unreachable"],
)
def test_printer_without_a_machine_file(answer, fit, asked):
    async def test():
        machines, work = Machines(a=answer), Work()
        fits = fits_of(machines, work, [])
        for _ in range(8):
            found = fits(PART, "a")
            await asyncio.sleep(10)
        assert (found, machines.asked, work.done) == (fit, asked, [])
        await fits.close()

    play(test)


@pytest.mark.parametrize(
    ("program", "fits", "why"),
    [
        ("G28\nG1 X50 Y50 F3000\n", True, ""),
        ("G28\nG1 X900 F3000\n", False, "line 2: "),
    ],
)
def test_file_is_planned_for_the_machine_of_the_printer(tmp_path, program, fits, why):
    path = tmp_path / "part.gcode"
    path.write_text(program)
    found = find_fit(I3, path)
    assert (found.fits, found.why[: len(why)]) == (fits, why)
    assert (found.print_s is not None and found.print_s > 1) == fits


def test_machine_file_that_needs_other_files_is_not_checked(tmp_path):
    path = tmp_path / "part.gcode"
    path.write_text("G28\n")
    assert find_fit("name = 3\n", path) == Fit(fits=True)
