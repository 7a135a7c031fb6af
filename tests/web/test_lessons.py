"""The course as HTTP gives it: path, lesson, experiment, answers."""

import pytest
from tests.web.fake_bridge import FakeBridge
from tests.web.local_site import local_client

API = "/api/v1"


@pytest.fixture
def web():
    return local_client(FakeBridge())


def test_path_and_lesson_are_in_the_language_that_is_asked_for(web):
    path = web.get(f"{API}/lessons?language=it").json()
    assert path["chapters"][0]["title"] == "Movimento"
    assert "steps-per-mm" in [one["name"] for one in path["chapters"][0]["lessons"]]
    assert "steps-per-mm" in [one["name"] for one in path["calculators"]]
    lesson = web.get(f"{API}/lessons/steps-per-mm?language=it").json()
    assert lesson["title"] == "Passi al millimetro"
    assert "80 passi/mm" in lesson["paragraphs"][2]
    assert lesson["source"]["code"].strip().startswith("def steps_per_unit")
    assert "answer" not in lesson["questions"][0]
    assert web.get(f"{API}/lessons/nothing").status_code == 404


def test_an_experiment_is_tried_with_values_within_bounds(web):
    for path in ("lessons", "calculators"):
        url = f"{API}/{path}/steps-per-mm/run"
        found = web.post(url, json={"values": {"teeth": 16, "microsteps": "32"}}).json()
        numbers = {one["name"]: one["text"] for one in found["numbers"]}
        assert numbers["steps_per_mm"] == "200"
        assert found["values"]["microsteps"] == 32
        assert len(found["graphs"][0]["curves"][0]["t"]) == 51
        refused = web.post(url, json={"values": {"teeth": 1000}})
        assert (refused.status_code, refused.json()["error"]["code"]) == (400, "learn.value")


def test_answers_are_checked_and_mistakes_have_hints(web):
    def check(question, answer):
        body = {"answer": answer, "language": "en"}
        return web.post(f"{API}/lessons/steps-per-mm/check/{question}", json=body)

    assert check(0, 100).json()["right"] is True
    wrong = check(0, 6.25).json()
    assert wrong["right"] is False
    assert wrong["text"].startswith("Those are full steps")
    assert check(9, 100).status_code == 404
