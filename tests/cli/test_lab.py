"""`passo lab`: the table, JSON and the page."""

import json
import re

import pytest
from tests.learn.pages import Page

from passo.cli.main import main
from passo.errors import ExitStatus

SQUARE = "G92 E0\nG1 X20 Y20 F6000\nG1 X80 E2.4\nG1 Y80 E4.8\nG1 X60 Y60 E5.9\n"


@pytest.fixture
def square(tmp_path):
    path = tmp_path / "<square>.gcode"
    path.write_text(SQUARE)
    return path


def test_lab_prints_a_table_with_the_best_setting(square, capsys):
    assert main(["lab", str(square), "--weight", "ringing"]) == ExitStatus.DONE
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].split()[:2] == ["setting", "print"]
    assert sum(line.startswith("*") for line in lines) == 1
    assert "With the weight on ringing (walls without waves, before all else)" in lines[-1]


def test_lab_writes_json_and_a_page_without_network(square, tmp_path, capsys):
    page = tmp_path / "lab.html"
    assert main(["lab", str(square), "--json", "--output", str(page)]) == ExitStatus.DONE
    found = json.loads(capsys.readouterr().out)
    names = [trial["name"] for trial in found["trials"]]
    assert found["best"] in names
    assert names[0] == "none"
    assert {"ringing_rms_um", "off_tune_rms_um", "width_error", "steps", "score"} <= set(
        found["trials"][0]
    )
    shown = Page(page.read_text())
    assert shown.title == "<square>.gcode on i3: settings of the motion, compared"
    text = shown.text.replace("http://www.w3.org/2000/svg", "")  # the name of SVG
    assert not re.search(r"https?:|//[a-z]|\bsrc=|<link|@import|url\(", text)
    assert [row["name"] for row in shown.data["trials"]["rows"]] == names
    assert names[shown.data["best"]] == found["best"]
    assert [len(cards["trials"]) for cards in shown.data["cards"]] == 2 * [len(names)]
    assert shown.data["corner"]["at_mm"][0] == 80


def test_file_without_corners_gets_a_page_without_pictures(square, tmp_path):
    square.write_text("G92 E0\nG1 X80 E2.4 F6000\n")
    page = tmp_path / "lab.html"
    assert main(["lab", str(square), "--output", str(page)]) == ExitStatus.DONE
    shown = Page(page.read_text())
    assert shown.data["corner"] is None
    assert len(shown.data["trials"]["rows"]) > 5


def test_lab_does_not_replace_its_file(square, capsys):
    assert main(["lab", str(square), "--output", str(square)]) == ExitStatus.USAGE
    assert "it is the G-code itself" in capsys.readouterr().err
    assert square.read_text() == SQUARE


def test_lab_names_a_bad_line_and_an_unwritable_page(square, tmp_path, capsys):
    missing = str(tmp_path / "no" / "lab.html")
    assert main(["lab", str(square), "--output", missing]) == ExitStatus.BAD_INPUT
    assert "lab.html" in capsys.readouterr().err
    square.write_text("G1 X900 F6000\n")
    assert main(["lab", str(square), "--json"]) == ExitStatus.BAD_INPUT
    assert "X 900.000 mm is beyond" in json.loads(capsys.readouterr().out)["errors"][0]
