"""The reference is what the table says and true; links lead somewhere; the README's code runs."""

from __future__ import annotations

import json
import lzma
import re
from pathlib import Path

import pytest
from tools.reference import PAGES as MADE_PAGES
from tools.references import machine_file

import passo
from passo.catalogue import CATALOGUE
from passo.gcode.registry import Subject, table
from passo.toolchain import protocol_words
from passo.toolchain.build import firmware_folder
from passo.toolchain.declarations import gather, message_name

ROOT = Path(__file__).parents[2]
PAGES = [
    page
    for pattern in ("*.md", "docs/**/*.md", "examples/*.md", "bench/*.md", "tests/*.md")
    for page in ROOT.glob(pattern)
]


@pytest.mark.parametrize("name", sorted(MADE_PAGES))
def test_generated_page_is_up_to_date(name):
    written = (ROOT / "docs/reference" / name).read_text(encoding="utf-8")
    assert written == MADE_PAGES[name](), "make reference"


def test_each_command_is_in_the_reference_once():
    page = (ROOT / "docs/reference/gcode.md").read_text(encoding="utf-8")
    listed = re.findall(r"^\| ([A-Z]\w*[\d.]*(?: [AH]\d?)?|T) \|", page, re.MULTILINE)
    assert sorted(listed) == sorted(table())


def test_commands_without_an_effect_have_no_handler():
    async def handled():
        async with passo.Printer("i3") as printer:
            told = {}
            for row in table().values():
                if row.subject is Subject.NO_EFFECT:
                    try:
                        told[row.code] = (await printer.send(row.code)).text
                    except passo.CommandError as error:
                        told[row.code] = str(error)
            return told

    told = passo.run(handled(), clock="virtual")
    assert len(told) > 40
    assert all("does nothing here" in text for text in told.values())


def test_every_key_of_the_machine_file_has_help():
    found = list(machine_file.tables())
    keys = [key for table in found for key in table.keys]
    assert len(keys) > 250
    assert [key.name for key in keys if not re.search(r"^[A-Zβ].*[.…]$", key.help)] == []
    axis = next(table for table in found if table.heading == "`[axes.NAME]`")
    assert next(key[1:4] for key in axis.keys if key.name == "speed_mm_s") == (
        "mm/s",
        "0.001 to 1000000",
        "*required*",
    )


def test_every_error_of_the_catalogue_is_listed():
    page = (ROOT / "docs/reference/errors.md").read_text(encoding="utf-8")
    assert set(re.findall(r"^\| `([\w.-]+)`", page, re.MULTILINE)) == CATALOGUE.keys()
    assert "{" not in page


def test_the_reference_of_the_protocol_leaves_nothing_out():
    found = gather(sorted(firmware_folder().glob("core/*.c")))
    commands = [name for words in protocol_words.COMMANDS.values() for name in words]
    assert sorted(commands) == sorted(message_name(c.format) for c in found.commands)
    assert sorted(protocol_words.REPORTS) == sorted(map(message_name, found.reports))
    assert protocol_words.SHUTDOWNS.keys() == found.shutdowns.keys()
    assert protocol_words.CONSTANTS.keys() >= found.constants.keys()
    assert protocol_words.ENUMERATIONS.keys() == found.enumerations.keys()


@pytest.mark.parametrize(
    ("text", "x_mm", "least_s"),
    [
        ("X10 F6000", [10], 0.1),  # a move without a command
        ("G1 X10 T4", [10], 4.0),  # i3 has no tool 4: seconds
        ("G1 X10 T0", [10], 0.0),  # but it has a tool 0
        ("G1 X10 M400", [10], 0.0),
        ("G1 X10\nG91 X10", [10, 20], 0.0),
        ("G1 X10 G1 X20", [10, 20], 0.0),
        ("T0 G1 X10", [10], 0.0),
        ("N7 G1 X5 (five) Y5 ; X6", [5], 0.0),
        ("G1 X1E5", [1], 0.0),
    ],
)
def test_words_belong_to_commands_as_in_the_reference(tmp_path, text, x_mm, least_s):
    path = tmp_path / "words.gcode"
    path.write_text(f"G28\n{text}\n")
    moves = list(passo.Machine.load("i3").plan(path))
    assert [move.core.end_mm[0] for move in moves] == x_mm
    assert moves[-1].end_s >= least_s


def test_links_of_documents_exist():
    links = [
        (page, target, anchor)
        for page in PAGES
        for target, anchor in re.findall(
            r"\]\(([^):#]*)#?([^):]*)\)", page.read_text(encoding="utf-8")
        )
    ]
    assert len(links) > 100
    broken = [
        f"{page.relative_to(ROOT)}: {target}#{anchor}"
        for page, target, anchor in links
        if not (to := page.parent / target if target else page).exists()
        or (anchor and anchor not in anchors(to))
    ]
    assert broken == []


def anchors(page: Path) -> set[str]:
    """The anchors of a page's headings, as web views of Markdown make them."""
    headings = re.findall(r"^#+ (.*)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", h.lower()).replace(" ", "-") for h in headings}


def test_the_index_leads_to_every_page():
    text = (ROOT / "docs/README.md").read_text(encoding="utf-8")
    linked = {(ROOT / "docs" / target).resolve() for target in re.findall(r"\]\(([^):#]+)", text)}
    folders = ("tutorial", "how-to", "reference", "explanation")
    pages = {page for folder in folders for page in ROOT.glob(f"docs/{folder}/*.md")}
    assert sorted(pages - linked) == []


def test_the_code_of_the_readme_runs(tmp_path, monkeypatch, capsys):
    (tmp_path / "build").mkdir()
    example = lzma.decompress((ROOT / "examples/demo.gcode.xz").read_bytes())
    (tmp_path / "build/demo.gcode").write_bytes(example)
    monkeypatch.chdir(tmp_path)
    (code,) = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(), re.DOTALL)
    exec(compile(code, "README.md", "exec"), {})
    limits, result = capsys.readouterr().out.splitlines()
    assert "'feedrate'" in limits
    assert "'x': 400, 'y': 14592, 'z': 60000" in result


def test_missing_klipper_messages_are_named():
    told = json.loads((ROOT / "tests/support/klipper.json").read_text(encoding="utf-8"))
    ours = {message_name(c.format) for c in gather(firmware_folder().glob("core/*.c")).commands}
    lacking = {message_name(text) for text in told["commands"]} - ours
    named = set(re.findall(r"\w+", " ".join(protocol_words.LACKING)))
    assert lacking == named & {message_name(text) for text in told["commands"]} - {"config_stepper"}
    assert {"spi_set_bus", "i2c_set_bus", "debug_read"} <= lacking
    assert not named & (ours - {"config_stepper"})
