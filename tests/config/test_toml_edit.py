"""Single values of a TOML text change; all else of it stays as it is."""

import tomllib

import pytest

from passo.config.toml_edit import with_value

_TEXT = """\
# A printer.
name = "mine"  # its name

[axes.x]  # the head
max_mm = 250.0# mm

[homing]
x.pin = "^X#MIN" # has a hash
z = { pin = "A" }

[[tools]]
offset_mm = [
  0.0,
]
"""


@pytest.mark.parametrize(
    ("path", "value", "old", "new"),
    [
        (("name",), '"my"', 'name = "mine"  #', 'name = "my"  #'),
        (("axes", "x", "max_mm"), "2.5", "max_mm = 250.0#", "max_mm = 2.5#"),
        (("homing", "x", "pin"), '"B"', 'pin = "^X#MIN" #', 'pin = "B" #'),
        (("homing", "y"), "1", "[homing]\n", "[homing]\ny = 1\n"),
        (("uuid",), "1", "# A printer.", "uuid = 1\n# A printer."),
        (("idle", "off_s"), "1", "  0.0,\n]\n", "  0.0,\n]\n\n[idle]\noff_s = 1\n"),
        (("tools", 0, "offset_mm"), "", "", ""),
        (("homing", "z", "pin"), "", "", ""),
        (("tools", 1, "offset_mm"), "", "", ""),
    ],
)
def test_edit_changes_only_one_value(
    path: tuple[str | int, ...], value: str, old: str, new: str
) -> None:
    if not value:
        with pytest.raises(ValueError, match=r"in place|array"):
            with_value(_TEXT, path, "1")
        return
    assert with_value(_TEXT, path, value) == _TEXT.replace(old, new)
    assert tomllib.loads(with_value(_TEXT, path, value))
