"""`passo serve --log`: the file's lines, its rotation, and what a full disk does."""

from __future__ import annotations

import asyncio
import json
import logging
import re
import subprocess
import sys
from datetime import datetime

import pytest
from tests.support.scenario import Scenario

import passo
from passo.cli import log_file
from passo.cli.log_file import LogFile
from passo.cli.main import main
from passo.cli.serve import _logged
from passo.events import Message

LOG = logging.getLogger("passo.test")


def serve(*words, lines):
    """`passo serve --stdin` on these lines, in fast time."""
    command = [sys.executable, "-m", "passo", "serve", "--machine", "i3", "--stdin"]
    command += ["--http", "none"]
    return subprocess.run(
        [*command, "--clock", "fast", *words], input=lines, capture_output=True, text=True
    )


def test_json_lines_have_time_print_time_level_and_code(tmp_path):
    path = tmp_path / "log"
    done = serve("--log", str(path), "--log-format", "json", lines="G28\nG1 X999\nM112\n")
    assert (done.returncode, done.stderr) == (0, "Serving i3 on standard input.\n")
    records = [json.loads(line) for line in path.read_text().splitlines()]
    assert [r["message"] for r in records if r["logger"] == "passo.library.printer"] == [
        "Printer i3 started by Passo 0.1.0",
        "Printer i3 closed",
    ]
    for record in records:
        assert datetime.fromisoformat(record["time"]).utcoffset() is not None
        assert record["logger"].startswith("passo.")
    (halt,) = [r for r in records if r["level"] == "ERROR"]
    assert (halt["code"], halt["part"]) == ("machine.emergency-stop", "job")
    assert halt["print_s"] >= 0
    (report,) = tmp_path.glob("log-halt-0001-*.txt")
    assert "code:   machine.emergency-stop" in report.read_text()
    said = f"The report of this halt is in {report}. Attach it when you ask for help"
    assert said in [r["message"] for r in records]


def test_text_lines_have_time_print_time_level_logger_and_code(tmp_path):
    path = tmp_path / "log"
    log = LogFile(str(path), "text", "info")
    with log, log.following(lambda: 12.3456, print):
        LOG.info("two\nlines, and \x1b[1m")
        LOG.error("halted", extra={"code": "machine.idle"})
        LOG.debug("not at this level")
    time = r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{3}[+-]\d\d:\d\d 12\.346 s"
    assert re.fullmatch(
        rf"{time} INFO passo\.test: two\n    lines, and \\x1b\[1m\n"
        rf"{time} ERROR passo\.test: halted \[machine\.idle\]\n",
        path.read_text(),
    )


def test_json_has_values_that_json_lacks_as_text(tmp_path):
    path = tmp_path / "log"
    with LogFile(str(path), "json", "info"):
        LOG.info("x", extra={"value": float("nan"), "limit": (1, 2), "axis": "x"})
    record = json.loads(path.read_text())
    assert (record["value"], record["limit"], record["axis"]) == ("nan", "(1, 2)", "x")


def test_a_full_file_is_renamed_and_five_are_kept(tmp_path, monkeypatch):
    monkeypatch.setattr(log_file, "MAX_BYTES", 2000)
    with LogFile(str(tmp_path / "log"), "text", "info"):
        for number in range(300):
            LOG.info("record %d", number)
    files = sorted(path.name for path in tmp_path.iterdir())
    assert files == ["log", *(f"log.{n}" for n in range(1, 6))]
    assert all(path.stat().st_size <= 2000 for path in tmp_path.iterdir())
    assert "record 299" in (tmp_path / "log").read_text()


def test_a_full_disk_is_reported_once_and_the_print_continues(tmp_path):
    (tmp_path / "part.g").write_text("G28\nG1 X20 F3000\n")
    told = []
    log = LogFile("/dev/full", "text", "debug")
    with log.following(lambda: 0.0, told.append), log, Scenario(card=str(tmp_path)) as s:
        s.host.ok("M32 part.g")
        s.host.expect("Done printing file", 60)
        assert s.positions()["x"] == 20
    assert told == ["The log /dev/full is not complete: No space left on device"]


def test_records_that_a_slow_disk_does_not_take_are_dropped(tmp_path, monkeypatch):
    monkeypatch.setattr(log_file, "_MAX_WAITING", 10)
    told = []
    log = LogFile(str(tmp_path / "log"), "text", "info")
    log._listener.start = lambda: None  # a disk that takes nothing
    with log.following(lambda: 0.0, told.append), log:
        for number in range(20):
            LOG.info("record %d", number)
        log._handler.queue.get_nowait()
        del log._listener.start
        log._listener.start()
    assert told == [f"The log {tmp_path / 'log'} is not complete: 10 records wait for the disk"]
    assert len((tmp_path / "log").read_text().splitlines()) == 9


def test_a_log_that_fails_is_a_line_on_standard_error():
    done = serve("--log", "/dev/full", lines="G28\nM105\n")
    failed = "The log /dev/full is not complete: No space left on device"
    assert done.returncode == 0
    assert sorted(done.stderr.splitlines()) == ["Serving i3 on standard input.", failed]
    assert "ok T:25.0" in done.stdout


def test_the_consoles_show_that_the_log_has_failed(tmp_path):
    log = LogFile("/dev/full", "text", "warning")

    async def heard():
        async with passo.Printer("i3") as printer, _logged(printer, log):
            messages = printer.events()
            first = asyncio.ensure_future(anext(messages))
            await asyncio.sleep(0)
            LOG.warning("the disk is full by now")
            return await asyncio.wait_for(first, 10)

    with log:
        event = passo.run(heard())
    assert event == Message("echo:The log /dev/full is not complete: No space left on device")


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--log", "/nowhere/log"], "--log /nowhere/log: No such file or directory"),
        (["--log", "/"], "--log /: Is a directory"),
        (["--log-level", "debug"], "--log-level and --log-format need --log FILE"),
    ],
)
def test_a_log_that_cannot_be_opened_is_one_sentence(capsys, words, sentence):
    assert main(["serve", "--machine", "i3", "--stdin", *words]) == 2
    assert capsys.readouterr().err == f"passo serve: error: {sentence}\n"


def test_closed_log_restores_levels_and_handlers(tmp_path):
    loggers = [logging.getLogger(name) for name in ("passo", "asyncio")]
    before = [(logger.level, list(logger.handlers)) for logger in loggers]
    with LogFile(str(tmp_path / "log"), "text", "debug"):
        assert loggers[0].level == logging.DEBUG
    assert [(logger.level, logger.handlers) for logger in loggers] == before
