"""Klipper's methods, with a printer that only writes down what it is asked."""

import asyncio
from dataclasses import replace

import pytest
from tests.web.fake_bridge import STATUS
from tests.web.klippy.client import Served

from passo.errors import CommandError, ConfigError, MachineError
from passo.events import Message, RemoteCall
from passo.printer.status import EndedJob, FaultStatus, JobStatus, PrinterState

HALTED = replace(
    STATUS,
    state=PrinterState.HALTED,
    halted="Emergency stop",
    faults=(FaultStatus("machine.emergency-stop", "machine", "Emergency stop", "Send M999"),),
)


def run(test, **options):
    """Runs a test in a loop of its own."""

    async def main():
        await test(Served(**options))

    asyncio.run(main())


def test_info_has_what_moonraker_needs():
    async def test(served):
        info = await served.client().ask("info", client_info={"program": "Moonraker"})
        assert (info["state"], info["state_message"]) == ("ready", "Printer is ready")
        assert info["software_version"] == "passo-0.1.0"
        assert {"klipper_path", "python_path", "process_id", "user_id"} <= info.keys()

    run(test)


def test_each_listed_endpoint_is_answered():
    async def test(served):
        client = served.client()
        params = {"script": "M105", "objects": {}, "remote_method": "reboot_machine"}
        for endpoint in (await client.ask("list_endpoints"))["endpoints"]:
            answer = await client.ask(endpoint, **params)
            assert answer.get("error") is None, endpoint

    run(test)


def test_unknown_methods_and_wrong_arguments_are_named():
    async def test(served):
        client = served.client()
        for method, params, message in (
            ("a/b", {}, "webhooks: No registered callback for path 'a/b'"),
            ("gcode/script", {}, "Missing Argument [script]"),
            ("gcode/script", {"script": 1}, "Invalid Argument Type [script]"),
            ("objects/query", {"objects": []}, "Invalid Argument Type [objects]"),
            ("objects/query", {"objects": {"fan": "speed"}}, "Invalid Argument Type [objects]"),
            ("objects/subscribe", {"objects": {}, "response_template": 1}, None),
        ):
            answer = await client.ask(method, **params)
            assert answer["error"] == "WebRequestError"
            assert message is None or answer["message"] == message

    run(test)


def test_request_without_an_id_is_carried_out_and_not_answered():
    async def test(served):
        client = served.client()
        client.connection.receive(b'{"method": "emergency_stop"}\x03no JSON\x03{"id": 1}\x03')
        await asyncio.sleep(0.01)
        assert served.bridge.asked == ["emergency stop"]
        assert (client.answers, client.pushed) == ({}, [])

    run(test)


def test_fault_of_the_program_is_answered_and_survived():
    async def test(served):
        client = served.client()
        served.bridge.endstops = lambda: 1 / 0
        answer = await client.ask("query_endstops/status")
        assert "ZeroDivisionError" in answer["message"]
        assert await client.ask("gcode/script", script="M105") == {}

    run(test)


def test_each_listed_object_answers_a_complete_dict():
    async def test(served):
        client = served.client()
        names = (await client.ask("objects/list"))["objects"]
        answer = await client.ask("objects/subscribe", objects=dict.fromkeys(names))
        assert answer["eventtime"] == 100.0
        assert set(answer["status"]) == set(names)
        assert all(answer["status"].values())
        assert {"virtual_sdcard", "display_status", "pause_resume"} <= set(names)
        served.engine.tell_changes()
        assert [list(p["params"]["status"]) for p in client.pushed] in ([], [["system_stats"]])

    run(test)


def test_clients_receive_changes_by_their_own_templates():
    async def test(served):
        one, other = served.client(), served.client()
        await one.ask("objects/subscribe", objects={"fan": None}, response_template={"method": "a"})
        await other.ask("objects/subscribe", objects={"toolhead": None, "fan": ["rpm"]})
        served.bridge.show(replace(STATUS, fans={"part": 0.5}))
        served.engine.tell_changes()
        served.engine.tell_changes()
        news = {"eventtime": 100.0, "status": {"fan": {"speed": 0.5}}}
        assert one.pushed == [{"method": "a", "params": news}]
        assert other.pushed == []

    run(test)


def test_print_that_ends_at_once_is_reported_as_one_print():
    async def test(served):
        client = served.client()
        await client.ask("objects/subscribe", objects={"print_stats": ["state"]})
        job = JobStatus("a.gcode", 0.5, 1, 1, None, 1.0, None, path="/a.gcode")
        printing = replace(STATUS, state=PrinterState.PRINTING, job=job)
        served.bridge.show(printing)
        served.bridge.show(replace(STATUS, ended=EndedJob("done", "", job)))
        states = [p["params"]["status"]["print_stats"]["state"] for p in client.pushed]
        assert states == ["printing", "complete"]

    run(test)


def test_script_is_answered_at_its_end_and_sent_to_all():
    async def test(served):
        client, other = served.client(), served.client()
        await client.ask("gcode/subscribe_output", response_template={"method": "out"})
        await other.ask("gcode/subscribe_output", response_template={"key": 3})
        served.bridge.answers["G28\nM105"] = ("T:25.0 /0.0", "echo:done")
        assert await client.ask("gcode/script", script="G28\nM105") == {}
        served.bridge.tell(Message("// action:paused"))
        heard = ["T:25.0 /0.0", "// done", "// action:paused"]
        assert [p["params"]["response"] for p in client.pushed] == heard
        assert other.pushed[0] == {"key": 3, "params": {"response": "T:25.0 /0.0"}}

    run(test)


def test_failed_script_is_answered_with_its_error():
    async def test(served):
        client = served.client()
        await client.ask("gcode/subscribe_output", response_template={})
        served.bridge.answers["G1 X999"] = CommandError.of("input.not-homed", axis="X")
        answer = await client.ask("gcode/script", script="G1 X999")
        assert answer["message"].startswith("axis X is not homed")
        assert client.pushed[0]["params"]["response"] == f"!! {answer['message']}"

    run(test)


def test_prints_are_paused_resumed_and_cancelled_by_commands():
    async def test(served):
        client = served.client()
        for what in ("pause", "resume", "cancel"):
            assert await client.ask(f"pause_resume/{what}") == {}
        assert served.bridge.asked == ["PAUSE", "RESUME", "CANCEL_PRINT"]

    run(test)


def test_endstops_are_shown_as_they_were_asked_for():
    async def test(served):
        client = served.client()
        states = {"x": "open", "y": "open", "z": "TRIGGERED"}
        assert await client.ask("query_endstops/status") == states
        answer = await client.ask("objects/query", objects={"query_endstops": None})
        assert answer["status"]["query_endstops"]["last_query"] == {"x": 0, "y": 0, "z": 1}

    run(test)


def test_halted_printer_is_shut_down_and_reports_why():
    async def test(served):
        client = served.client()
        await client.ask("gcode/subscribe_output", response_template={})
        await client.ask("objects/subscribe", objects={"webhooks": None})
        served.bridge.show(HALTED)
        served.engine.tell_changes()
        webhooks = client.pushed[0]["params"]["status"]["webhooks"]
        assert client.pushed[1]["params"]["response"] == "// Klipper state: Shutdown"
        assert webhooks["state"] == "shutdown"
        assert webhooks["state_message"].startswith("Emergency stop\nSend M999 [machine.emergency")
        commands = await client.ask("objects/query", objects={"gcode": ["commands"]})
        known = commands["status"]["gcode"]["commands"]
        assert "M112" in known and "G28" not in known

    run(test)


def test_printer_that_starts_again_ends_the_connections():
    async def test(served):
        served.bridge.show(HALTED)
        served.bridge.show(replace(HALTED, link="restarting"))
        assert served.restarts == []
        served.bridge.show(STATUS)
        assert served.restarts == [False]

    run(test)


def test_failed_start_is_an_error():
    async def test(served):
        served.bridge.show(replace(HALTED, started=False))
        assert (await served.client().ask("info"))["state"] == "error"

    run(test)


@pytest.mark.parametrize(
    ("line", "method", "asked", "yet"),
    [
        ("restart", "gcode/restart", ["restart program"], False),
        ("FIRMWARE_restart ; at last", "gcode/firmware_restart", [], True),
    ],
)
def test_restart_is_asked_for_by_methods_and_scripts(line, method, asked, yet):
    async def test(served):
        client = served.client()
        assert await client.ask("gcode/script", script=f"M105\n{line}\nG28") == {}
        assert served.bridge.asked == ["M105", *asked]
        assert await client.ask(method) == {}
        assert served.restarts == [yet, yet]

    run(test)


def test_restart_is_refused_during_a_print_and_the_connection_stays():
    async def test(served):
        refusal = CommandError.of("job.printing", value="part.gcode")
        served.bridge.answers["restart program"] = refusal
        answer = await served.client().ask("gcode/restart")
        assert "part.gcode is being printed" in answer["message"]
        assert served.restarts == []

    run(test)


def test_restart_restarts_the_boards_where_nothing_starts_the_program():
    async def test(served):
        served.bridge.answers["restart program"] = ConfigError.of("machine.no-restart")
        assert await served.client().ask("gcode/restart") == {}
        assert served.restarts == [True]

    run(test)


def test_restart_of_a_script_that_fails_before_it_is_left_out():
    async def test(served):
        served.bridge.answers["G28"] = MachineError.of("machine.emergency-stop")
        answer = await served.client().ask("gcode/script", script="G28\nRESTART")
        assert (answer["error"], served.restarts) == ("WebRequestError", [])

    run(test)


def test_methods_that_macros_call_are_called_at_the_client_that_has_them():
    async def test(served):
        client, other = served.client(), served.client()
        template = {"method": "timelapse_newframe"}
        await client.ask(
            "register_remote_method", remote_method="frame", response_template=template
        )
        await other.ask("gcode/subscribe_output", response_template={"method": "output"})
        served.bridge.tell(RemoteCall("frame", {"hidden": True}))
        assert client.pushed == [{**template, "params": {"hidden": True}}]
        assert other.pushed == []
        served.bridge.tell(RemoteCall("unknown", {}))
        assert "calls unknown, but no client" in other.pushed[0]["params"]["response"]

    run(test)
