"""Lines of keys in every shape that TOML allows."""

import tomllib

import pytest

from passo.config.toml_lines import key_lines, line_of

TEXT = '''# comment with [brackets] and "quotes"
name = "a # not a comment"
a.b."c d" = 1

[one]
text = """first
second "quoted" \\""" third
"""
raw = \'\'\'x = 1
[two]\'\'\'
list = [ 1, # one
  [2, 3],
  { k = "v]", "q.r" = \'}\' },
]
inline = { x = 1, y.z = 2 }

[one.sub]
n = 1979-05-27T07:32:00Z

[[many]]
k = 1
[[many]]
k = 2
[many.deep]
d = true
[[many.inner]]
i = 1
[[many.inner]]
i = 2
'''


@pytest.mark.parametrize(
    ("path", "line"),
    [
        (("name",), 2),
        (("a", "b", "c d"), 3),
        (("a",), 3),
        (("one",), 5),
        (("one", "text"), 6),
        (("one", "raw"), 9),
        (("one", "list"), 11),
        (("one", "list", 0), 11),
        (("one", "list", 1, 1), 12),
        (("one", "list", 2, "q.r"), 13),
        (("one", "inline", "y", "z"), 15),
        (("one", "sub", "n"), 18),
        (("many", 0, "k"), 21),
        (("many", 1, "k"), 23),
        (("many", 1, "deep", "d"), 25),
        (("many", 1, "inner", 0, "i"), 27),
        (("many", 1, "inner", 1, "i"), 29),
    ],
)
def test_each_key_has_its_line(path: tuple[str | int, ...], line: int) -> None:
    assert key_lines(TEXT)[path] == line
    assert key_lines(TEXT.replace("\n", "\r\n"))[path] == line


def test_every_key_that_tomllib_finds_has_a_line() -> None:
    lines = key_lines(TEXT)

    def walk(value: object, path: tuple[str | int, ...]) -> int:
        if isinstance(value, dict):
            inside = [walk(item, (*path, key)) for key, item in value.items()]
        elif isinstance(value, list):
            inside = [walk(item, (*path, index)) for index, item in enumerate(value)]
        else:
            inside = []
        assert not path or path in lines, path
        return 1 + sum(inside)

    assert walk(tomllib.loads(TEXT), ()) == 1 + len(lines)


def test_a_missing_key_is_at_its_table() -> None:
    lines = key_lines(TEXT)
    assert line_of(lines, ("one", "sub", "missing")) == 17
    assert line_of(lines, ("nothing", "here")) == 1
