"""The process that plans files: what it returns, and how it ends."""

import threading
from functools import partial
from io import BytesIO

import pytest

from passo import config
from passo.errors import CardError, InputError
from passo.library.planning import Planning
from passo.library.planning_work import find_explanation, find_verdict
from passo.printer.unfit_commands import NOTHING

I3 = config.load("i3")
TEXT = b"G28\n" + b"G1 X10 F6000\nG1 X20\n" * 100_000
VERDICT = partial(find_verdict, I3, NOTHING, {}, "a.gcode")


class Broken(BytesIO):
    """A file that cannot be read beyond its first bytes."""

    def read(self, size=-1):
        if self.tell() > 0:
            raise CardError.of("card.not-found", "a.gcode")
        return super().read(size)


def test_planning_process_returns_verdict_and_path():
    paths = []
    found = Planning(VERDICT, BytesIO(TEXT), len(TEXT), paths.append).run()
    assert (found.problems, found.estimate.moves) == ((), 200_000)
    assert [path[:8] for path in paths] == [b"PASSOTP1"]


def test_an_error_of_the_work_has_its_problems():
    work = partial(find_explanation, I3, "a.gcode", 3)
    with pytest.raises(InputError) as raised:
        Planning(work, BytesIO(b"G28\n"), 4).run()
    assert raised.value.problems[0].file == "a.gcode"


def test_an_error_of_the_card_ends_the_work():
    with pytest.raises(CardError):
        Planning(VERDICT, Broken(TEXT), len(TEXT)).run()


@pytest.mark.parametrize("when", ["before", "while reading"])
def test_ended_work_leaves_no_process(when):
    begun = threading.Event()

    class Watched(BytesIO):
        def read(self, size=-1):
            begun.set()
            planning.end()
            return super().read(size)

    planning = Planning(VERDICT, Watched(TEXT), len(TEXT))
    if when == "before":
        planning.end()
    with pytest.raises(RuntimeError, match="has ended"):
        planning.run()
    assert begun.is_set() == (when != "before")
    assert planning.process.returncode is not None
