"""Names, paths and 8.3 forms."""

import pytest
from tests.support.card_images import code

from passo.card import names
from passo.card.directory import checksum
from passo.errors import CardError


@pytest.mark.parametrize(
    ("path", "parts"),
    [
        ("", []),
        ("/", []),
        ("a.g", ["a.g"]),
        ("//a//b.g/", ["a", "b.g"]),
        ("./a/../b/./c", ["b", "c"]),
        ("../../../etc/passwd", ["etc", "passwd"]),
    ],
)
def test_no_path_leads_out_of_the_image(path: str, parts: list[str]):
    assert names.split(path) == parts


@pytest.mark.parametrize(
    ("name", "taken", "short"),
    [
        ("PRINT.G", (), "PRINT.G"),
        ("print.gco", (), "PRINT.GCO"),
        ("PRINT.G", ("PRINT.G",), "PRINT~1.G"),
        ("print.gcode", (), "PRINT~1.GCO"),
        ("print.gcode", ("PRINT~1.GCO", "PRINT~2.GCO"), "PRINT~3.GCO"),
        ("a long name.with.dots.g", (), "ALONGN~1.G"),
        (".profile", (), "PROFIL~1"),
        ("größe.g", (), "GR__E~1.G"),
        ("日本.g", (), "__~1.G"),
        ("..", (), "_~1"),
        ("a b", (), "AB~1"),
        ("x" * 9, [f"XXXXXX~{n}" for n in range(1, 10)], "XXXXX~10"),
    ],
)
def test_short_names(name: str, taken: tuple[str, ...], short: str):
    assert names.short_name(name, taken) == short


def test_a_folder_s_short_names_depend_on_the_name_alone():
    assert names.stable_short_name("PRINT.G", ()) == "PRINT.G"
    short = names.stable_short_name("Benchy of the day.gcode", ())
    assert short == names.stable_short_name("BENCHY OF THE DAY.GCODE", ()) == "BED3F5~1.GCO"
    assert names.stable_short_name("Benchy of the day.gcode", (short,)) == "BED3F5~2.GCO"


def test_case_does_not_count_and_eszett_stays():
    assert names.fold("Größe.gcode") == "GRÖßE.GCODE"


def test_composed_and_decomposed_accents_are_equal():
    apart = "Gro\N{COMBINING DIAERESIS}ße e\N{COMBINING ACUTE ACCENT}.gcode"
    assert names.fold(apart) == names.fold("GRÖßE É.gcode")
    assert names.stable_short_name(apart, ()) == names.stable_short_name("Größe é.gcode", ())


def test_names_without_ascii_get_distinct_short_names():
    short = [
        names.stable_short_name(f"{name}.gcode", ()) for name in ("日本語", "中国語", "한국어")
    ]
    assert len(set(short)) == 3
    assert all(name.isascii() and len(name) <= 12 for name in short)


@pytest.mark.parametrize(
    "name",
    ["a:b", "a*", "a?", 'a"', "a<", "a|b", "a\\b", "a\nb", "a\x7f", "dot.", "end ", " a", "\ud800"],
)
def test_names_that_fat_cannot_hold_are_refused(name: str):
    with pytest.raises(CardError) as raised:
        names.check(name, f"/{name}")
    assert code(raised) == "card.name"


def test_a_name_has_at_most_255_units():
    names.check("🖨" * 127 + "x", "")
    with pytest.raises(CardError) as raised:
        names.check("🖨" * 128, "")
    assert code(raised) == "card.name"
    assert raised.value.problems[0].values["limit"] == "at most 255 UTF-16 units"


def test_the_checksum_of_a_short_name():
    total = 0
    for byte in b"BENCHY~1GCO":  # the sum of fatgen103, written as rotate and add
        total = (((total >> 1) | (total << 7)) + byte) % 256
    assert checksum(b"BENCHY~1GCO") == total == 0xAA
