"""Inputs that boards report: acknowledgements, repeated reports, levels at the start."""

from passo.board.analog_inputs import AnalogReports
from passo.board.description import AnalogInput, Input
from passo.board.inputs import InputReports, groups_of, inversion


def reports() -> InputReports:
    return InputReports({7: (Input("door", "PE5"), Input("roll", "!^PH5"))})


def taken(inputs: InputReports, acknowledged: int, *states: int):
    count, changes = inputs.take(7, acknowledged, bytes(states))
    return count, {change.name: change.levels for change in changes}


def test_reports_become_levels_in_their_order():
    inputs = reports()
    assert taken(inputs, 0, 1) == (1, {"door": (True,), "roll": (False,)})
    assert taken(inputs, 1, 0, 2, 0) == (3, {"door": (False,), "roll": (True, False)})
    assert inputs.levels == {"door": False, "roll": False}


def test_repeated_states_are_acknowledged_and_counted_once():
    inputs = reports()
    assert taken(inputs, 0, 1)[0] == 1
    assert taken(inputs, 0, 1) == (0, {})  # the acknowledgement was still on its way
    assert taken(inputs, 0, 1, 3) == (1, {"roll": (True,)})
    assert taken(inputs, 2, 2) == (1, {"door": (False,)})


def test_state_counter_wraps_after_255():
    inputs = reports()
    for i in range(300):
        assert taken(inputs, i % 256, (i + 1) % 2)[0] == 1
    assert inputs.levels["door"] is False


def test_input_without_a_report_is_released_after_a_time():
    inputs = reports()
    inputs.asked_anew(1000)
    assert inputs.settled(999) == []
    assert [(c.name, c.levels, c.first) for c in inputs.settled(1000)] == [
        ("door", (False,), True),
        ("roll", (False,), True),
    ]
    assert inputs.settled(2000) == []


def test_input_keeps_its_level_until_a_new_question_is_answered():
    inputs = reports()
    taken(inputs, 0, 3)
    inputs.asked_anew(1000)
    assert inputs.levels == {"door": True, "roll": True}
    assert taken(inputs, 0, 1) == (1, {"roll": (False,)})


def test_more_than_eight_inputs_are_divided_into_groups():
    inputs = [Input(f"i{n}", f"{'!' if n % 2 else ''}P{n}") for n in range(11)]
    first, second = groups_of(inputs)
    assert (len(first), len(second)) == (8, 3)
    assert (inversion(first), inversion(second)) == (0b10101010, 0b010)


def test_analog_range_counts_when_two_readings_agree():
    entry = AnalogInput("analog", "PF1", (("up", 0.1, 0.2), ("down", 0.2, 0.5)))
    analog = AnalogReports({3: entry}, 8000)

    def changes(*values: int):
        reports = [("analog_in_state", {"oid": 3, "value": value}) for value in values]
        return [(c.name, c.levels, c.first) for c in analog.take(reports)]

    assert changes(8000) == []
    assert changes(8000) == [("up", (False,), True), ("down", (False,), True)]
    assert changes(1000, 8000, 1000, 1000) == [("up", (True,), False)]  # 0.125 of full scale
    assert changes(1599, 1600, 1599) == []
    assert changes(2000, 3999) == [("up", (False,), False), ("down", (True,), False)]
    assert changes(4000, 4000) == [("down", (False,), False)]
    assert analog.levels == {"up": False, "down": False}
    assert analog.shares == {"analog": 0.5}
