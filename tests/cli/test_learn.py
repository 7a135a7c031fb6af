"""`passo learn` and `passo calculate`."""

import io
import json
import re
import signal
import subprocess
import sys
from urllib.request import urlopen

import pytest

from passo.cli.main import main


class Terminal(io.StringIO):
    def isatty(self):
        return True


def test_the_list_names_lessons_by_chapter(capsys):
    assert main(["learn"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "Motion"
    assert any(line.startswith("  steps-per-mm ") for line in lines)


def test_a_lesson_asks_until_the_answer_is_right(capsys, monkeypatch):
    monkeypatch.setattr(sys, "stdin", Terminal("6,25\n100\n\n"))
    assert main(["learn", "steps-per-mm"]) == 0
    out = capsys.readouterr().out
    assert "✗ Those are full steps" in out
    assert out.index("✗") < out.index("✓ 3200 steps in one rotation")
    assert "src/passo/config/motion.py:" in out


def test_a_lesson_runs_its_experiment_with_other_values_in_italian(capsys):
    words = ["learn", "trapezoid-and-triangle", "--lang", "it", "--set", "length_mm=4"]
    assert main(words) == 0
    out = capsys.readouterr().out
    assert "triangolo" in out
    assert main(["learn", "trapezoid-and-triangle", "--set", "length_mm=x"]) == 4
    assert "expected 0.5 to 200" in capsys.readouterr().err


def test_answers_are_for_teachers(capsys):
    assert main(["learn", "steps-per-mm", "--answers"]) == 0
    assert "Answer: 2560 steps/mm" in capsys.readouterr().out
    assert main(["learn", "--json"]) == 0
    found = {one["name"]: one for one in json.loads(capsys.readouterr().out)}
    assert found["steps-per-mm"]["questions"][1]["answer"] == pytest.approx(2560)


def test_a_calculator_prints_its_numbers(capsys):
    assert main(["calculate", "steps-per-mm", "drive=screw", "lead_mm=0.8"]) == 0
    assert "4000 steps/mm" in capsys.readouterr().out
    assert main(["calculate", "steps-per-mm", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["values"]["teeth"] == 20
    assert main(["calculate"]) == 0
    assert "steps-per-mm" in capsys.readouterr().out
    assert main(["calculate", "nothing"]) == 4


def test_the_page_of_the_course_is_served_on_a_simulated_printer():
    """A process, because the page has a thread and ends by a signal."""
    command = [sys.executable, "-m", "passo", "learn", "--page"]
    served = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        assert served.stdout is not None
        line = next(line for line in served.stdout if "http" in line)
        address = re.findall(r"http://[\d.]+:\d+", line)[0]
        with urlopen(f"{address}/api/v1/lessons/steps-per-mm", timeout=30) as answer:
            assert json.load(answer)["title"] == "Steps per millimetre"
    finally:
        served.send_signal(signal.SIGINT)
        assert served.wait(30) == 0
        served.stdout.close()
