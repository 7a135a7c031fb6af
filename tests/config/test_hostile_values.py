"""Whatever stands in a machine file, loading ends in a machine or in problems with a line."""

import re

from hypothesis import given, settings
from hypothesis import strategies as st

from passo import config
from passo.errors import ConfigError

VALUES = st.sampled_from(
    [
        "-1",
        "0",
        "1e400",
        "nan",
        "true",
        "''",
        "'x'",
        "[]",
        "[[1]]",
        "{}",
        "{ k = [] }",
        "1979-05-27",
        "'\\u0000'",
    ]
)


@settings(max_examples=300, derandomize=True, deadline=None)
@given(st.data())
def test_line_is_found_for_any_value(data: st.DataObject) -> None:
    lines = config.shipped_text(data.draw(st.sampled_from(config.shipped_machines()))).splitlines()
    places = [index for index, line in enumerate(lines) if line.strip() and line[0] != "#"]
    for index in data.draw(st.lists(st.sampled_from(places), min_size=1, max_size=4, unique=True)):
        value = data.draw(VALUES)
        if lines[index].startswith("["):
            name = re.sub(r"[][]", "", lines[index]).replace(".", "_")
            lines[index] = f"[{name}.{data.draw(st.sampled_from(['x', 'tools', '1']))}]"
        else:
            lines[index] = f"{lines[index].partition(' =')[0]} = {value}"
    try:
        machine = config.load_text("\n".join(lines), "any.toml")
    except ConfigError as error:
        assert all(problem.line and problem.line <= len(lines) for problem in error.problems)
        assert all(str(problem).startswith("any.toml:") for problem in error.problems)
    else:
        assert len(machine.core_spec()["steppers"]) == len(machine.steppers)
