"""Each transition of a print and of its pause, by the commands of a host, and no other one."""

import pytest
from tests.support.scenario import Host, Scenario

from passo.job.live.job_state import PAUSES, TRANSITIONS, JobState

LINE = "G91\n" + "G1 X1 F600\nG1 X-1\n" * 40
FILES = {
    "a.g": LINE,
    "b.g": LINE,
    "short.g": "G91\nG1 X1 F600\n",
    "wrong.g": "G91\nG1 X5 F600\nG1 X900\nG1 X-5\n",
    "homes.g": "G28 X\n" + LINE,
}
N, R, A, P, H, B, F = (
    JobState.NONE,
    JobState.READY,
    JobState.APPROACHING,
    JobState.PRINTING,
    JobState.PAUSED,
    JobState.RETURNING,
    JobState.FAILED,
)
# What the host sends, each after the state of the line before was reached; the states at its end.
WALKS = {
    "select-release": (("M23 a.g", R), ("M22", N)),
    "print-to-the-end": (("G28\nM23 short.g\nM24", P), ("", R)),
    "pause-and-return": (("G28\nM23 a.g\nM24", P), ("M25", H), ("M24", B), ("", P)),
    "pause-while-homing": (("M23 homes.g\nM24", P), *[("", P)] * 5, ("M25", H), ("M24", P)),
    "cancel": (("G28\nM23 a.g\nM24", P), ("M524", R)),
    "cancel-in-a-pause": (("G28\nM23 a.g\nM24", P), ("M25", H), ("M524", R)),
    "cancel-on-the-way-back": (("G28\nM23 a.g\nM24", P), ("M25", H), ("M24", B), ("M524", R)),
    "pause-on-the-way-back": (("G28\nM23 a.g\nM24", P), ("M25", H), ("M24", B), ("M25", H)),
    "stop-on-the-way-back": (("G28\nM23 a.g\nM24", P), ("M25", H), ("M24", B), ("M410", F)),
    "halt-in-a-pause": (("G28\nM23 a.g\nM24", P), ("M25", H), ("M112", H), ("M999", F)),
    "fail-and-go-on": (("G28\nM23 wrong.g\nM24", F), ("M24", R)),
    "fail-and-give-up": (("G28\nM23 wrong.g\nM24", F), ("M524", R)),
    "fail-and-release": (("G28\nM23 wrong.g\nM24", F), ("M22", N)),
    "cancel-and-start": (("G28\nM23 a.g\nM24", P), ("M524\nM24", P)),
    "stop-and-start": (("G28\nM23 a.g\nM24", P), ("M410\nM24", P)),
    "start-and-release": (("G28\nM23 a.g\nM24", P), ("M524\nM24\nM22", N)),
    "start-and-select": (("G28\nM23 a.g\nM24", P), ("M524\nM24\nM23 b.g", R)),
}


class Walk:
    """A printer, and the transitions of its print so far."""

    def __init__(self, folder):
        card = folder / "card"
        card.mkdir()
        for name, text in FILES.items():
            (card / name).write_text(text)
        self.s = Scenario("i3", card=str(card), state=str(folder / "state"))
        self.seen = set()
        runner = self.s.assembly.services.jobs.runner
        for watchers in (runner.watchers, runner._pause.states.watchers):
            watchers.append(lambda was, now: self.seen.add((was, now)))

    def reach(self, lines, state):
        if lines:
            self.s.host.send(*lines.split("\n"))
        runner = self.s.assembly.services.jobs.runner
        assert self.s.until(lambda: runner.state is state, 200), (lines, runner.state)
        self.s.passes(0.0 if state is B else 0.2 if state.active else 1.0)


def walked(folder, steps):
    folder.mkdir()
    walk = Walk(folder)
    with walk.s:
        for lines, state in steps:
            walk.reach(lines, state)
    return walk.seen


def approached(folder):
    """A print that a halt has interrupted is resumed, and pauses as soon as it can: M1000, M25."""
    folder.mkdir()
    walk = Walk(folder)
    with walk.s:
        walk.reach("G28\nM302 P1\nM23 a.g\nM24", P)
        walk.s.passes(3)
        walk.s.host.send("M112")
        walk.s.passes(1)
        walk.s.host.ok("M999")
        walk.s.host.send("M1000")
        walk.s.passes(0.5)
        assert "will pause once" in Host(walk.s).ok("M25")[0]
        walk.s.passes(60)
    return walk.seen


@pytest.mark.parametrize("name", WALKS)
def test_random_walk_uses_only_table_transitions(tmp_path, name):
    seen = walked(tmp_path / name, WALKS[name])
    assert seen
    assert all(now in (TRANSITIONS | PAUSES)[was] for was, now in seen)


def test_each_transition_of_the_job_table_is_used(tmp_path):
    seen = set()
    for name, steps in WALKS.items():
        seen |= walked(tmp_path / name, steps)
    seen |= approached(tmp_path / "resumed")
    table = {(was, now) for was, ways in (TRANSITIONS | PAUSES).items() for now in ways}
    assert seen == table


def test_undefined_job_transition_raises(tmp_path):
    walk = Walk(tmp_path)
    with walk.s, pytest.raises(RuntimeError, match="from NONE to PAUSED"):
        walk.s.assembly.services.jobs.runner._states.enter(JobState.PAUSED)
