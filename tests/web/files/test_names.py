"""Names that clients send stay on the card."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from passo.errors import CardError, InputError
from passo.web.files.names import confined, program


@pytest.mark.parametrize(
    ("sent", "path"),
    [
        ("a.gcode", "/a.gcode"),
        ("/toys//a.gcode", "/toys/a.gcode"),
        ("", "/"),
        ("/", "/"),
        ("gro\u0308\u00dfe.gcode", "/größe.gcode"),  # from a Mac: o and its dots apart
        ("console.gcode", "/console.gcode"),
        ("a" * 249 + ".gcode", "/" + "a" * 249 + ".gcode"),
    ],
)
def test_upload_paths_are_resolved(sent, path):
    assert confined(sent) == path


@pytest.mark.parametrize(
    "sent",
    [
        "../a.gcode",
        "toys/../../a.gcode",
        "..",
        "./a.gcode",
        "a\0.gcode",
        "a\n.gcode",
        "C:\\a.gcode",
        "..\\a.gcode",
        "C:a.gcode",
        "CON.gcode",
        "aux",
        "toys/LPT1.gcode",
        "com¹.gcode",
        "nul .gcode",
        "a.gcode.",
        "a.gcode ",
        " a.gcode",
        'a".gcode',
        "a?.gcode",
        "a|b.gcode",
        "a" * 250 + ".gcode",
        "a/" * 600,
        "\ud800.gcode",
        "a\u2028.gcode",
    ],
)
def test_a_name_that_no_file_should_have_is_refused(sent):
    with pytest.raises(CardError) as raised:
        confined(sent)
    assert raised.value.problems[0].code == "card.name"


@pytest.mark.parametrize(
    ("sent", "path"),
    [
        ("Body_01*_PLA.gcode", "/Body_01__PLA.gcode"),
        ('12:30 "fast"?.gcode', "/12_30 _fast__.gcode"),
        ("a<b>/c|d.gcode", "/a_b_/c_d.gcode"),
        ("C:\\toys\\a.gcode", "/C__toys_a.gcode"),
        (" a .gcode ", "/a .gcode"),
        ("toys./a.gcode.", "/toys/a.gcode"),
    ],
)
def test_names_of_uploads_are_cleaned(sent, path):
    assert program(sent) == path


@pytest.mark.parametrize(
    "sent",
    [
        "../a.gcode",
        "toys/.. /a.gcode",
        "./a.gcode",
        "a\0.gcode",
        "a\n.gcode",
        "CON.gcode",
        "aux /b.g",
    ],
)
def test_a_cleaned_name_is_still_confined(sent):
    with pytest.raises(CardError) as raised:
        program(sent)
    assert raised.value.problems[0].code == "card.name"


@given(st.text())
def test_any_text_is_confined_or_refused(text):
    try:
        path = confined(text)
    except CardError:
        return
    assert path.startswith("/")
    assert not {"", ".", ".."} & set(path.split("/")[1:]) or path == "/"
    assert confined(path) == path


@pytest.mark.parametrize(
    ("name", "code"),
    [
        ("a.bgcode", "upload.binary"),
        ("a.BGCODE", "upload.binary"),
        ("a.stl", "upload.kind"),
        ("a.gcode.3mf", "upload.kind"),
        ("gcode", "upload.kind"),
        ("/", "card.name"),
    ],
)
def test_only_programs_are_taken(name, code):
    with pytest.raises((CardError, InputError)) as raised:
        program(name)
    assert raised.value.problems[0].code == code
