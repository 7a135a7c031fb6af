"""Each transition of the links' state, by what happens to the boards, and no other one."""

import pytest
from tests.job.test_lost_link import FIRMWARE, break_link
from tests.job.test_place_lost import turned_by_hand
from tests.support.disturbed_prints import reset
from tests.support.scenario import Scenario

from passo.errors import MachineError
from passo.printer.recovery.link_state import TRANSITIONS, LinkState

UP, AWAY, LOST, HALTED, STARTS = (
    LinkState.CONNECTED,
    LinkState.RECONNECTING,
    LinkState.PLACE_LOST,
    LinkState.HALTED,
    LinkState.RESTARTING,
)


def broken_for_a_moment(s, _):
    break_link(s, 0.3)


def turned_meanwhile(s, monkeypatch):
    with turned_by_hand(s, monkeypatch):
        break_link(s, 1.0)
        s.passes(1)


def halted_meanwhile(s, _):
    s.printer.rig.connection.main.port.unplug()
    s.passes(0.5)
    s.host.send("M112")
    s.passes(1)


def reset_once(s, _):
    reset(s)


def halted_as_the_place_is_lost(s, _):
    s.printer.supervisor.watchers.append(
        lambda _, now: s.printer.stops.halt("by the test") if now is LOST else None
    )
    reset(s)


def halted_and_revived(s, _):
    s.host.send("M112")
    s.passes(1)
    s.host.ok("M999")


def not_found_again(s, monkeypatch):
    def gone(_):
        raise MachineError.of("machine.program", value="no board")

    monkeypatch.setattr("passo.printer.printer.reconnected", gone)
    s.host.send("M112")
    s.passes(1)
    s.host.send("M999")


WALKS = {
    broken_for_a_moment: [AWAY, UP],
    turned_meanwhile: [AWAY, LOST, STARTS, UP],
    halted_meanwhile: [AWAY, HALTED],
    reset_once: [LOST, STARTS, UP],
    halted_as_the_place_is_lost: [LOST, HALTED],
    halted_and_revived: [HALTED, STARTS, UP],
    not_found_again: [HALTED, STARTS, HALTED],
}


@pytest.mark.parametrize("happens", WALKS, ids=lambda happens: happens.__name__)
def test_events_lead_to_link_states(happens, monkeypatch):
    with Scenario(FIRMWARE) as s:
        seen = [s.printer.supervisor.link]
        s.printer.supervisor.watchers.append(lambda was, now: seen.append(now))
        s.host.ok("G28", 60)
        s.host.send("G1 X100 F600")
        s.passes(1)
        happens(s, monkeypatch)
        s.passes(2)
        assert seen == [UP, *WALKS[happens]]


def test_link_state_table_has_all_transitions():
    walked = {way for states in WALKS.values() for way in zip([UP, *states], states, strict=False)}
    assert walked == {(was, now) for was, ways in TRANSITIONS.items() for now in ways}


def test_undefined_link_transition_raises():
    with Scenario(FIRMWARE) as s, pytest.raises(RuntimeError, match="from CONNECTED to RESTARTING"):
        s.printer.supervisor._enter(STARTS)
