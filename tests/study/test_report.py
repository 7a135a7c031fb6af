"""What `passo batch` shows, and what it compares."""

import json
import os
import signal
import subprocess
import sys

import pytest
from tests.study.test_run import PART

import passo
from passo.cli.main import main
from passo.study.report import compare

STUDY = """files = ["*.gcode"]
machines = ["i3"]
[grid]
"limits.print_accel_mm_s2" = [1000.0, 3000.0]
"""


LONG = STUDY.replace("[1000.0, 3000.0]", str([500.0 + i for i in range(200)]))


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.gcode").write_text(PART.format(x=20))
    (tmp_path / "b.gcode").write_text(PART.format(x="2.0.5"))
    (tmp_path / "study.toml").write_text(STUDY)
    return tmp_path


def test_table_names_the_fastest_row_of_a_file(folder, capsys):
    assert main(["batch", "study.toml", "--output", "out", "--jobs", "1"]) == 1
    assert capsys.readouterr().out == "4 cases: 2 input, 2 ok\nout/results.csv\n"
    assert main(["batch", "report", "out"]) == 0
    table = capsys.readouterr().out.splitlines()
    assert "a.gcode  i3: limits.print_accel_mm_s2 = 3000.0" in table[1]
    assert table[1].split()[-2:] == ["1", "0"]  # one row is unbeaten, none failed
    assert table[2].split() == ["b.gcode", "-", "-", "-", "-", "0", "2"]
    assert "limits.print_accel_mm_s2 = 1000.0" in (folder / "out/report.html").read_text()


def test_front_has_the_rows_that_none_beats(folder):
    columns = (
        "id,file,machine,set n,status,print_time_s,corners,printed_mm,ringing_rms_um,"
        "ringing_peak_um,rounding_um,largest_rounding_um,off_path_um,largest_off_path_um,"
        "width_error,lost,off_tune_rms_um,steps,commands"
    )
    figures = {  # time, ringing, width, lost
        "fast": (10.0, 30.0, 0.10, 0.0),
        "calm": (20.0, 10.0, 0.10, 0.0),
        "even": (20.0, 30.0, 0.01, 0.0),
        "beaten": (20.0, 30.0, 0.10, 0.0),
        "lost": (1.0, 1.0, 0.0, 0.5),
    }
    lines = [
        f"0,a.gcode,i3,{name},ok,{s},1,100,{um},1,1,1,1,1,{width},{lost},{um},1,1"
        for name, (s, um, width, lost) in figures.items()
    ]
    (folder / "results.csv").write_text("\n".join([columns, *lines]) + "\n")
    (found,) = compare(folder)
    assert [row.setting["n"] for row in found.rows if row.front] == ["fast", "calm", "even"]
    assert found.best is not None and found.best.front


def test_report_without_results_is_an_error(folder, capsys):
    assert main(["batch", "report", "nothing"]) == 4
    assert "holds no results" in capsys.readouterr().err


@pytest.mark.parametrize(
    "words", [["study.toml"], ["report"], ["study.toml", "out"], ["report", "a", "--output", "b"]]
)
def test_usage_names_both_forms(folder, capsys, words):
    assert main(["batch", *words]) == 2
    assert "passo batch report FOLDER" in capsys.readouterr().err


def test_events_are_rows_and_progress(folder, capsys):
    main(["batch", "study.toml", "--output", "out", "--jobs", "1", "--events"])
    events = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert len([event for event in events if "row" in event]) == 4
    assert events[-1]["progress"] == {
        "cases": 4,
        "done": 4,
        "reused": 0,
        "statuses": {"ok": 2, "input": 2},
    }


def test_killed_study_continues_with_the_same_bytes(folder):
    (folder / "study.toml").write_text(LONG)
    command = [sys.executable, "-m", "passo", "batch", "study.toml", "--jobs", "1", "--output"]
    subprocess.run([*command, "whole"], check=False, stdout=subprocess.DEVNULL)
    with subprocess.Popen([*command, "cut", "--events"], stdout=subprocess.PIPE, text=True) as cut:
        assert cut.stdout is not None
        for line in cut.stdout:
            if "row" in line:
                break
        os.kill(cut.pid, signal.SIGKILL)
        cut.stdout.read()  # ends when the processes of the study have ended, too
    kept = (folder / "cut/results.jsonl").read_bytes()
    assert 1 <= kept.count(b"\n") < 400
    subprocess.run([*command, "cut"], check=False, stdout=subprocess.DEVNULL)
    for name in ("results.csv", "results.parquet"):
        assert (folder / "cut" / name).read_bytes() == (folder / "whole" / name).read_bytes()
    assert (folder / "cut/results.jsonl").read_bytes().startswith(kept)


def test_ctrl_c_keeps_the_rows(folder):
    (folder / "study.toml").write_text(LONG)
    command = [sys.executable, "-m", "passo", "batch", "study.toml", "--output", "out", "--events"]
    with subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        process_group=0,
        # as in a terminal: a background job of a shell begins with it ignored
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    ) as study:
        assert study.stdout is not None and study.stderr is not None
        first = next(line for line in study.stdout if "row" in line)
        os.killpg(study.pid, signal.SIGINT)
        study.stdout.read()
        assert study.stderr.read() == "Interrupted.\n"
    assert study.returncode == 130
    kept = (folder / "out/results.jsonl").read_text()
    assert json.dumps(json.loads(first)["row"]) in kept.splitlines()
    assert not (folder / "out/results.csv").exists()


def test_cache_spares_the_cases_of_other_studies(folder):
    first = passo.batch(["*.gcode"], ["i3"], jobs=0, cache="shared")
    (folder / "a.gcode").rename(folder / "c.gcode")
    events = []

    from passo.study.cache import Cache
    from passo.study.engine import Inline
    from passo.study.plan import plan_study
    from passo.study.run import run_study
    from passo.study.study_file import Study

    study = Study(files=["c.gcode"], machines=["i3"])
    rows = run_study(
        plan_study(study, folder),
        Inline(),
        folder / "two",
        lambda progress, _: events.append(progress.reused),
        Cache(folder / "shared"),
    )
    assert events[-1] == 1
    assert rows[0] == first[0] | {"file": "c.gcode"}
    assert (folder / "two/results.jsonl").read_text().count("\n") == 1


def test_other_file_as_a_cache_is_refused(folder, capsys):
    words = ["batch", "study.toml", "--output", "out", "--cache", "a.gcode"]
    assert main(words) == 4
    assert "cannot be used as a cache" in capsys.readouterr().err


def test_wrong_option_of_a_call_is_an_error(folder):
    with pytest.raises(passo.ConfigError) as raised:
        passo.batch(["a.gcode"], options={"unknown": "hide"}, jobs=0)
    assert "options.unknown is 'hide'" in str(raised.value)


def test_prints_and_measurements_are_rows(folder):
    (printed,) = passo.batch(["a.gcode"], ["i3"], what="print", jobs=0)
    assert printed["steps"]["x"] == 80 * (20 + 60)
    assert printed["stream_hash"] and "cpu_s" not in printed
    shapers = {f"shaping.{axis}": {"type": "ei", "frequency_hz": 50} for axis in "xy"}
    plain, calm = passo.batch(["a.gcode"], ["i3"], [{}, shapers], what="lab", jobs=0)
    assert calm["ringing_rms_um"] < 0.6 * plain["ringing_rms_um"]
    assert plain["corners"] == 1


def test_changed_file_is_not_kept(folder):
    def change(progress, rows):
        if not rows:
            (folder / "a.gcode").write_text("G1 X1\n")

    from passo.study.engine import Inline
    from passo.study.plan import plan_study
    from passo.study.run import run_study
    from passo.study.study_file import Study

    plan = plan_study(Study(files=["a.gcode"], machines=["i3"]), folder)
    (row,) = run_study(plan, Inline(), folder / "out", change)
    assert (row["status"], row["code"]) == ("changed", "study.changed")
    assert (folder / "out/results.jsonl").read_text() == ""
