"""A line as HTTP explains it: the data of `passo explain`."""

import asyncio

from tests.web.local_site import local_client

from passo.library.printer import Printer, run

API = "/api/v1/explain"


def asked(tmp_path, call):
    """What a live printer answers, with a file on its card."""
    (tmp_path / "a.gcode").write_text("G28\nG1 X20 F6000\nG1 X40\nM104 S200\n")

    async def main():
        async with Printer("i3", card=str(tmp_path)) as printer:
            client = local_client(printer._bridge)
            return await asyncio.to_thread(call, client)

    return run(main())


def test_line_of_a_file_has_moves_steps_and_bytes(tmp_path):
    answer = asked(tmp_path, lambda web: web.get(f"{API}?path=a.gcode&line=2")).json()
    assert (answer["place"], answer["line"]) == ("a.gcode:2", "G1 X20 F6000")
    assert [command["code"] for command in answer["commands"]] == ["G1"]
    (move,) = answer["moves"]
    assert (move["end_mm"][0], move["cruise_speed"], move["speed_limit"]) == (20, 100, "feedrate")
    assert {one["motor"]: one["count"] for one in answer["steps"]}["x"] == 1600
    assert answer["wire"][0]["text"].startswith("queue_step oid=0")
    assert answer["wire"][0]["payload"] in answer["frame"]


def test_typed_line_is_explained_and_nothing_moves(tmp_path):
    answer = asked(tmp_path, lambda web: web.post(API, json={"line": "G1 X10 F3000"})).json()
    assert answer["moves"][0]["end_mm"][0] == 10
    assert answer["junction_before"].startswith("the machine stops there")


def test_line_that_the_file_does_not_have_is_named(tmp_path):
    answer = asked(tmp_path, lambda web: web.get(f"{API}?path=a.gcode&line=9")).json()
    assert answer["error"]["code"] == "input.no-line"
    assert answer["error"]["message"].startswith("a.gcode:9: ")


def test_lines_before_and_after_join_the_line(tmp_path):
    lines = {"before": "M204 S500\nG1 X10 F3000", "line": "G1 X30", "after": "G1 X50"}
    answer = asked(tmp_path, lambda web: web.post(API, json=lines)).json()
    (move,) = answer["moves"]
    assert (move["start_mm"][0], move["end_mm"][0], move["acceleration"]) == (10, 30, 500)
    assert move["start_speed"] == move["end_speed"] == 50
