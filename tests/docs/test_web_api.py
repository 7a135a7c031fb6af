"""The commands and programs of the pages about the web API do what the pages say."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

FOLDER = Path(__file__).parents[2] / "docs/how-to"
PAGE = (FOLDER / "use-the-web-api.md").read_text(encoding="utf-8")
PLACE = "http://127.0.0.1:4000"


@pytest.fixture
def served(tmp_path):
    command = [sys.executable, "-m", "passo", "serve", "--machine", "i3", "--clock", "50"]
    command += ["--tcp", "127.0.0.1:0", "--http", "127.0.0.1:0", "--state", str(tmp_path)]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        assert process.stderr is not None
        lines = []
        for line in process.stderr:
            lines.append(line)
            if line.startswith("Serving"):
                break
        yield re.search(r"http://[\d.:]+\d", lines[-1])[0], lines
        process.terminate()


def blocks(kind):
    return re.findall(rf"```{kind}\n(.*?)```", PAGE, re.DOTALL)


def test_examples_of_the_web_api_page_work(served, capsys):
    place, lines = served
    assert any("has no administrator yet" in line for line in lines)
    first, wrong = (block.replace(PLACE, place) for block in blocks("sh"))
    answers = subprocess.run(
        ["sh", "-ec", first], capture_output=True, text=True, timeout=60, check=True
    ).stdout
    assert '"hotend"' in answers
    assert "X:" in answers
    assert "error" not in answers
    refused = subprocess.run(["sh", "-c", wrong], capture_output=True, text=True, timeout=60).stdout
    assert '"code":"web.invalid"' in refused
    names = {}
    for block in blocks("python"):
        exec(block.replace(PLACE, place), names)
    assert capsys.readouterr().out == "60.0\n404 web.not-found\n"
    assert names["script"].status.get().status.halted == ""


def test_each_metric_is_on_the_page_of_prometheus():
    page = (FOLDER / "monitor-with-prometheus.md").read_text(encoding="utf-8")
    source = Path(__file__).parents[2] / "src/passo/web/endpoints/metrics.py"
    text = source.read_text(encoding="utf-8")
    made = set(re.findall(r'"(?:passo_)?((?:state|job|axis|board|queued|fan)_[a-z_]+)"', text))
    made |= set(re.findall(r'\("((?:temperature|target|heater)_[a-z]+(?:_[a-z]+)?)"', text))
    assert len(made) > 10
    assert [name for name in made if f"passo_{name}" not in page] == []
