"""When who waits for a temperature goes on: not before it has stayed there."""

import pytest
from tests.support.scenario import Scenario

from passo import config
from passo.errors import ConfigError

OVER = 1e-9


def scenario(lines: str = "") -> Scenario:
    text = config.shipped_text("i3").replace("max_c = 285.0\n", f"max_c = 285.0\n{lines}\n", 1)
    return Scenario(config.load_text(text))


def heater(s: Scenario):
    return s.printer.rig.connection.heaters["hotend"]


def near(s: Scenario, target: float, within: float = 300.0) -> float:
    """When the sensor is first within 1 °C."""
    assert s.until(lambda: abs(heater(s).celsius - target) <= 1 + OVER, within)
    return s.loop.time()


def done(s: Scenario, within: float = 300.0) -> float:
    s.host.expect("^ok", within)
    return s.loop.time()


@pytest.mark.parametrize(
    ("lines", "seconds"),
    [
        ("", 10.0),
        ("control = { kind = 'model' }", 10.0),
        ("arrival = { seconds = 25 }", 25.0),
        ("arrival = { seconds = 0 }", 0.0),
        ("control = { kind = 'bang-bang' }", 0.0),
    ],
)
def test_a_wait_ends_when_the_temperature_has_stayed_there(lines, seconds):
    with scenario(lines) as s:
        s.host.send("M109 S200")
        begin = near(s, 200)
        assert done(s) - begin == pytest.approx(seconds, abs=0.3)
        assert heater(s).celsius == pytest.approx(200, abs=1 + OVER)


def test_temperature_that_leaves_the_window_restarts_the_time():
    with scenario() as s:
        s.host.send("M109 S200")
        near(s, 200)
        s.passes(2)
        s.board.force_heater("hotend", 0.0)  # its power is somebody else's for a while
        assert s.until(lambda: heater(s).celsius < 196.5, 20)
        s.board.force_heater("hotend", None)
        s.host.silent(0.1, "^ok")
        begin = near(s, 200)
        assert done(s) - begin == pytest.approx(10, abs=0.3)


def test_temperature_that_has_settled_needs_no_wait():
    with scenario() as s:
        s.host.ok("M109 S200", 300)
        begin = s.loop.time()
        s.host.ok("M109 S200")
        s.host.ok("M116")
        assert s.loop.time() - begin < 0.5
        s.board.force_heater("hotend", 0.0)
        assert s.until(lambda: heater(s).celsius < 196.5, 20)
        s.board.force_heater("hotend", None)
        s.host.send("M109 S200")
        begin = near(s, 200)
        assert done(s) - begin == pytest.approx(10, abs=0.3)


def test_a_new_target_is_waited_for_from_the_beginning():
    with scenario() as s:
        s.host.send("M109 S200")
        near(s, 200)
        s.passes(5)
        s.printer.outputs.targets.set_target("hotend", 210.0, at_once=True)
        begin = near(s, 210)
        assert done(s) - begin == pytest.approx(10, abs=0.3)


def test_heater_already_too_warm_is_not_waited_for():
    with scenario() as s:
        s.host.ok("M109 S200", 300)
        begin = s.loop.time()
        s.host.ok("M109 S150")
        assert s.loop.time() - begin < 0.5
        s.host.send("M109 R150")
        begin = near(s, 150)
        assert done(s) - begin == pytest.approx(10, abs=0.3)


def test_a_wait_ends_without_the_last_degree():
    """Without an integral the temperature ends two degrees below."""
    control = "control = { kind = 'pid', kp = 51.0, ki = 0.0, kd = 0.0 }"
    with scenario(f"{control}\narrival = {{ window_c = 0.2 }}") as s:
        s.host.send("M109 S200")
        assert s.until(lambda: heater(s).celsius >= 197, 300)
        begin = s.loop.time()
        assert done(s) - begin == pytest.approx(60, abs=0.6)
        assert 197 < heater(s).celsius < 199


def test_a_sensor_of_coarse_steps_arrives_too():
    with scenario() as s:
        s.host.ok("M109 S281", 300)  # a step of the converter is 1.7 °C there
        assert heater(s).celsius == pytest.approx(281, abs=2.5)


@pytest.mark.parametrize(
    ("arrival", "says"),
    [
        ("{ window_c = 2, leaves_c = 1.5 }", "leaves_c is 1.5: expected at least window_c"),
        ("{ leaves_c = 0.5 }", "leaves_c is 0.5: expected at least window_c"),
        ("{ window_c = 4 }", "window_c is 4: expected at most leaves_c, 3"),
        ("{ seconds = -1 }", "seconds is -1: expected a number of at least 0"),
    ],
)
def test_unreachable_arrival_is_refused(arrival, says):
    with pytest.raises(ConfigError) as error:
        scenario(f"arrival = {arrival}")
    assert f"heaters.hotend.arrival.{says}" in str(error.value)
