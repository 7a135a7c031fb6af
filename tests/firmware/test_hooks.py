"""A further module of the firmware, which is one source file: the core calls what it declares."""

import pytest
from tests.firmware.library import library_with
from tests.support.raw_board import RawBoard

from passo.simulator import dictionary

# A letter for each call: s start, d shutdown, t task, c the end of a shutdown.
MODULE = """#include "command.h"
#include "scheduler.h"

DECL_REPORT("trace calls=%*s");

static uint8_t calls[16], count;
static void note(char call) { if (count < sizeof calls) calls[count++] = (uint8_t)call; }

DECL_START(trace_start);
void trace_start(void) { count = 0; note('s'); }
DECL_TASK(trace_task, INPUTS);
void trace_task(void) { note('t'); }
DECL_ON_SHUTDOWN(trace_shutdown);
void trace_shutdown(void) { note('d'); }
DECL_ON_CLEAR_SHUTDOWN(trace_clear);
void trace_clear(void) { note('c'); }
DECL_WATCH(trace_watches);
bool trace_watches(void) { return true; }

DECL_COMMAND(command_trace, "trace wake=%c", IN_SHUTDOWN);
void command_trace(const uint32_t *args) {
  if (args[0]) task_wake();
  report_bytes(REPORT_TRACE, 0, 0, calls, count);
}
"""


@pytest.fixture
def board(tmp_path, monkeypatch):
    module = tmp_path / "trace.c"
    module.write_text(MODULE, encoding="utf-8")
    library = library_with(tmp_path, module)
    monkeypatch.setattr(dictionary, "firmware_library", lambda: library)
    monkeypatch.setattr("passo.simulator.board.firmware_library", lambda: library)
    return RawBoard()


def calls(board, wake=0):
    [(name, values)] = board.tell(f"trace wake={wake}")
    assert name == "trace"
    return values["calls"]


def test_core_calls_the_hooks_of_a_module_it_does_not_name(board):
    assert calls(board) == b"s"
    assert calls(board, wake=1) == b"s"
    assert calls(board) == b"st"
    [(name, _)] = board.tell("emergency_stop")
    assert name == "shutdown"
    assert calls(board) == b"stdt"
    board.tell("clear_shutdown")
    assert calls(board) == b"stdtc"
    board.tell("reset")
    board.sequence = 0
    board.read()
    assert calls(board) == b"s"


def test_an_output_is_kept_if_a_module_watches(board):
    board.configure()
    board.tell("survive_arm")
    assert board.tell("survive_output oid=7 value=1 seconds=5") == []
    [(_, state)] = board.tell("get_config")
    assert state["is_shutdown"] == 0
