"""The hooks that modules of the firmware declare: what is refused, and the order of the calls."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from passo.toolchain.build import firmware_folder
from passo.toolchain.declarations import TASK_PHASES, DeclarationError, Declarations, gather
from passo.toolchain.tables import dictionary, write_tables

CALLERS = {
    "START": "hooks_start",
    "ON_SHUTDOWN": "hooks_shut_down",
    "ON_CLEAR_SHUTDOWN": "hooks_clear_shutdown",
    "ON_POOL_EMPTY": "hooks_pool_empty",
    "WATCH": "hooks_watch",
}


def gathered(folder: Path, **files: str) -> Declarations:
    """The declarations of these files, read in the order given."""
    sources = [folder / f"{name}.c" for name in files]
    for source, text in zip(sources, files.values(), strict=True):
        source.write_text(text, encoding="utf-8")
    return gather(sources)


def bodies(found: Declarations, folder: Path) -> dict[str, list[str]]:
    """The functions that each generated function calls."""
    found.reports.append("identify_response")
    [source] = write_tables(found, dictionary(found, version="1"), folder)
    functions = re.findall(r"^\w+ (hooks_\w+)\(void\) \{(.*?)\}", source.read_text(), re.S | re.M)
    return {name: re.findall(r"(\w+)\(\)", body) for name, body in functions}


def test_firmware_calls_its_hooks_in_this_order(tmp_path: Path) -> None:
    found = gather(sorted(firmware_folder().glob("core/*.c")))
    assert bodies(found, tmp_path) == {
        "hooks_start": [
            "frame_start",
            "objects_start",
            "scheduler_start",
            "shutdown_start",
            "shutdown_report_none",
            "steppers_start",
            "survive_commits_start",
            "survive_start",
        ],
        "hooks_every_pass": ["survive_task"],
        "hooks_task": [
            "spi_send_last",
            "trsync_task",
            "analog_in_task",
            "buttons_task",
            "counter_task",
            "tmcuart_task",
            "accelerometer_task",
            "neopixel_task",
            "thermocouple_task",
            "shutdown_report",
        ],
        "hooks_shut_down": ["objects_shut_down", "task_wake", "shutdown_report_soon"],
        "hooks_clear_shutdown": ["spi_send_last", "survive_task"],
        "hooks_pool_empty": ["steppers_reclaim"],
        "hooks_watch": ["analog_in_watches", "thermocouple_watches"],
    }


def test_tasks_run_by_phase_then_by_file_then_as_declared(tmp_path: Path) -> None:
    found = gathered(
        tmp_path,
        z="DECL_TASK(z_second, INPUTS);\nDECL_TASK(z_first, DEVICES);\n",
        b="DECL_TASK(b_task,\n          INPUTS);\nDECL_TASK(a_task, INPUTS);\n",
        m="DECL_TASK(always, EVERY_PASS);\nDECL_TASK(last, SHUTDOWN);\n",
    )
    called = bodies(found, tmp_path)
    assert called["hooks_every_pass"] == ["always"]
    assert called["hooks_task"] == ["z_first", "b_task", "a_task", "z_second", "last"]


@pytest.mark.parametrize("kind", CALLERS)
def test_hooks_run_by_file_then_as_declared(tmp_path: Path, kind: str) -> None:
    found = gathered(
        tmp_path,
        b=f"DECL_{kind}(two);\nDECL_{kind}(three);\n",
        a=f"DECL_{kind}(one);\n",
    )
    assert found.called(kind) == ["one", "two", "three"]
    called = bodies(found, tmp_path)
    assert called.pop(CALLERS[kind]) == ["one", "two", "three"]
    assert not any(called.values())


def test_one_function_may_serve_hooks_of_two_kinds(tmp_path: Path) -> None:
    found = gathered(tmp_path, a="DECL_TASK(send, DEVICES);\nDECL_ON_CLEAR_SHUTDOWN(send);\n")
    called = bodies(found, tmp_path)
    assert called["hooks_task"] == called["hooks_clear_shutdown"] == ["send"]
    assert (tmp_path / "tables.c").read_text().count("void send(void);") == 1


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("DECL_START(a);\nDECL_START(a);", "declared twice"),
        ("DECL_TASK(a, INPUTS);\nDECL_TASK(a, BUSES);", "declared twice"),
        ("DECL_TASK(a, SOON);", "the phase is not one of EVERY_PASS, DEVICES"),
        ("DECL_TASK(a);", "as many arguments"),
        ("DECL_START(a, INPUTS);", "as many arguments"),
        ("DECL_ON_SHUTDOWN(a b);", "'a b' is not the name of a function"),
        ("DECL_WATCH(7);", "wrong type"),
        ("DECL_ON_SHUT_DOWN(a);", "unknown"),
        ('DECL_SHUTDOWN(A, "x");', "unknown"),
    ],
)
def test_unusable_declarations_are_refused(tmp_path: Path, text: str, complaint: str) -> None:
    with pytest.raises(DeclarationError, match=f"part.c: DECL_.*{complaint}"):
        gathered(tmp_path, part=text)


def test_the_same_hook_in_two_files_is_refused(tmp_path: Path) -> None:
    with pytest.raises(DeclarationError, match=r"b\.c: DECL_START.*declared twice"):
        gathered(tmp_path, a="DECL_START(x);", b="DECL_START(x);")


def test_the_header_explains_every_hook_and_phase() -> None:
    header = (firmware_folder() / "core/declare.h").read_text(encoding="utf-8")
    for text in (*(f"DECL_{kind}(function)" for kind in CALLERS), "DECL_TASK(function, PHASE)"):
        assert header.count(f"//   {text} ") == 1
    order = [header.index(f"//   {phase} ") for phase in TASK_PHASES]
    assert order == sorted(order)
