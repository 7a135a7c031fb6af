"""Effects of lights: their colours, and the commands that start and end them."""

from __future__ import annotations

import pytest
from tests.support.scenario import Scenario

from passo import config
from passo.config.light_effects import LightEffect
from passo.config.load import shipped_text
from passo.errors import ConfigError
from passo.printer.effect_colors import Seen, effect_colors

RED, GREEN, DARK = (1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0)
TABLES = """[lights.head]
kind = "neopixel"
pin = "D11"
count = 3
order = "RGB"
[lights.lamp]
kind = "led"
white_pin = "D6"
pwm_hz = 100.0
start = [0.0, 0.0, 0.0, 0.5]
[light_effects.busy]
light = "head"
leds = [1]
kind = "breathing"
colors = [[1.0, 0.0, 0.0]]
period_s = 2.0
[light_effects.nozzle]
light = "head"
leds = [2, 3]
kind = "heater"
colors = [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]
heater = "hotend"
[light_effects.alarm]
light = "lamp"
kind = "blink"
colors = [[0.0, 0.0, 0.0, 1.0]]
period_s = 1.0
"""


def machine(tables: str = TABLES):
    return config.load_text(shipped_text("i3").replace("[fans.part]", f"{tables}[fans.part]"))


@pytest.fixture
def s():
    with Scenario(machine()) as s:
        s.passes(1)
        yield s


def of(kind: str, count: int, seen: Seen, colors=((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)), **keys):
    shown = [list(color) for color in colors]
    effect = LightEffect(light="a", kind=kind, colors=shown, period_s=4.0, **keys)
    return effect_colors(effect, count, seen)


def test_colours_of_each_kind_at_a_time():
    assert of("steady", 2, Seen(9.0)) == [RED, RED]
    assert of("breathing", 1, Seen(2.0)) == [RED]
    assert of("breathing", 1, Seen(6.0)) == [GREEN]
    assert of("blink", 1, Seen(0.5)) == [RED]
    assert of("blink", 1, Seen(2.5)) == [GREEN]
    assert of("gradient", 2, Seen(0.0)) == [RED, GREEN]
    assert of("gradient", 2, Seen(2.0)) == [GREEN, RED]
    assert of("chase", 8, Seen(1.0))[2] == RED
    assert of("chase", 8, Seen(1.0))[3] == DARK
    assert of("progress", 4, Seen(0.0, progress=0.5)) == [RED, RED, GREEN, GREEN]
    assert of("heater", 1, Seen(0.0, 25.0, 125.0)) == [RED]
    assert of("heater", 1, Seen(0.0, 75.0, 125.0)) == [(0.5, 0.5, 0.0, 0.0)]
    assert of("heater", 1, Seen(0.0, 90.0, 0.0), high_c=80.0) == [GREEN]


def test_fire_changes_between_its_colours_and_repeats():
    moments = [of("fire", 3, Seen(i / 8)) for i in range(20)]
    assert len({moment[0] for moment in moments}) == 20
    assert all(red + green == pytest.approx(1) for m in moments for red, green, _, _ in m)
    assert of("fire", 3, Seen(1.0)) == of("fire", 3, Seen(1.0))


def test_effect_shows_over_the_colours_of_set_led(s):
    s.host.ok("SET_LED LED=head GREEN=1")
    s.host.ok("SET_LED_EFFECT EFFECT=busy")
    s.board.trace_light("head")
    s.passes(2)
    frames = [data for _, data in s.board.take_light("head")]
    assert 15 <= len(frames) <= 21
    assert max(data[0] for data in frames) >= 250
    assert min(data[0] for data in frames) <= 20
    assert all(data[3:] == bytes((0, 255, 0)) * 2 for data in frames)
    s.host.ok("SET_LED_EFFECT EFFECT=busy STOP=1")
    s.passes(1)
    assert s.board.light("head") == bytes((0, 255, 0)) * 3


def test_effects_on_parts_of_one_light_run_together(s):
    s.host.ok("SET_LED_EFFECT EFFECT=busy")
    s.host.ok("SET_LED_EFFECT EFFECT=nozzle")
    s.passes(1)
    assert s.board.light("head")[3:] == bytes((0, 0, 255)) * 2
    s.host.ok("M104 S200")
    s.passes(200)
    red, _, blue = s.board.light("head")[3:6]
    assert red >= 250
    assert blue <= 5
    assert s.printer.status.read().lights["head"][1][0] > 0.95
    s.host.ok("STOP_LED_EFFECTS LEDS=neopixel:head")
    s.passes(1)
    assert s.board.light("head") == bytes(9)


def test_effect_on_outputs_ends_with_their_own_brightness(s):
    s.host.ok("SET_LED_EFFECT EFFECT=alarm")
    seen = set()
    for _ in range(40):
        s.passes(0.05)
        seen.add(s.board.output_value("lights.lamp.white"))
    assert seen == {0, 160_000, 80_000} or seen == {0, 160_000}
    s.host.ok("STOP_LED_EFFECTS")
    s.passes(1)
    assert s.board.output_value("lights.lamp.white") == 80_000


def test_effect_starts_after_the_moves_before_it(s):
    s.host.ok("G92 X0 Y0 Z0")
    s.host.send("G1 X20 F600", "SET_LED_EFFECT EFFECT=nozzle")
    s.passes(1)
    assert s.board.light("head") == bytes(9)
    s.passes(2)
    assert s.board.light("head")[5] == 255


@pytest.mark.parametrize(
    ("keys", "limit"),
    [
        ('light = "haed"\nkind = "steady"', "Did you mean 'head'"),
        ('light = "head"\nkind = "steady"\nleds = [4]', "1 to 3"),
        ('light = "head"\nkind = "heater"', "one of the heaters"),
    ],
)
def test_effects_of_parts_that_are_not_there_are_refused(keys, limit):
    with pytest.raises(ConfigError, match=limit):
        machine(f"{TABLES}[light_effects.wrong]\n{keys}\n")


TEMPLATES = """[light_templates.glow]
color = "{[printer.extruder.target / 300, param_least]|max}, 0, {render('dim', share=0.5)}"
variables = { param_least = 0.0 }
[light_templates.dim]
color = "{0.1 * share}"
[light_templates.broken]
color = "{printer.extruder.target}"
"""


def test_leds_follow_a_template_until_it_ends():
    with Scenario(machine(TABLES + TEMPLATES)) as s:
        s.host.ok("SET_LED LED=head GREEN=1")
        s.host.ok("SET_LED_TEMPLATE LED=head TEMPLATE=Glow PARAM_LEAST=0.5 INDEX=2")
        s.passes(1)
        assert s.printer.status.read().lights["head"] == (GREEN, (0.5, 0.0, 0.05, 0.0), GREEN)
        s.host.ok("M104 S240")
        s.passes(1)
        assert s.board.light("head") == bytes((0, 255, 0, 204, 0, 13, 0, 255, 0))
        s.host.ok("SET_LED_TEMPLATE LED=head TEMPLATE=")
        s.passes(1)
        assert s.board.light("head") == bytes((0, 255, 0) * 3)


def test_template_that_writes_no_colour_is_reported_once():
    with Scenario(machine(TABLES + TEMPLATES)) as s:
        s.host.ok("SET_LED_TEMPLATE LED=head TEMPLATE=broken")
        s.passes(3)
        told = [line for line in s.host.heard if "broken" in line]
        assert len(told) == 1
        assert "two to four numbers from 0 to 1" in told[0]
        assert s.printer.status.read().lights["head"] == (DARK,) * 3
        s.host.ok("SET_LED_TEMPLATE LED=head TEMPLATE=none")
        assert any("glow, dim, broken" in line for line in s.host.heard)
