"""Lines of consoles for Klipper's clients."""

import pytest

from passo.web.klippy.output import failed, shown


@pytest.mark.parametrize(
    ("line", "text"),
    [
        ("echo:Passo, i3", "// Passo, i3"),
        ("Error:Printer halted: why", "!! Printer halted: why"),
        ("// action:prompt_begin M600", "// action:prompt_begin M600"),
        ("T:25.0 /0.0 B:60.0 /60.0", "T:25.0 /0.0 B:60.0 /60.0"),
    ],
)
def test_lines_have_the_prefix_that_clients_know(line, text):
    assert shown(line) == text


def test_error_shows_its_first_line_after_all_of_it():
    assert failed("X is beyond the limit.") == "!! X is beyond the limit."
    assert failed("too hot\nlook at it") == "// too hot\n// look at it\n!! too hot"
