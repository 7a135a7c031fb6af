"""Pins of machines: found by any of their names, owned once, and able to do what they are for."""

import json
import zlib
from pathlib import Path

import pytest
from tests.support.klipper_board import dictionary, on_its_pins

from passo import config
from passo.config.board_defaults import bindings
from passo.config.board_files import shipped_tables
from passo.config.toml_lines import key_lines
from passo.errors import ConfigError
from passo.printer.setup.boards import board_description


def problems_of(text: str, file: str = "my.toml") -> list[str]:
    with pytest.raises(ConfigError) as caught:
        config.load_text(text, file)
    return [str(problem) for problem in caught.value.problems]


def place(text: str, row: str) -> str:
    """The place of the first row of a text that is this."""
    return f"my.toml:{text.splitlines().index(row) + 1}"


def board_place(name: str, *keys: str) -> str:
    """The place of a key in the file of a shipped board."""
    return f"boards/{name}.toml:{key_lines(shipped_tables(name)[1][0].text)[keys]}"


@pytest.mark.parametrize("name", ["D10", "PB4", "!D10"])
def test_a_pin_has_one_owner_under_all_its_names(i3_text: str, name: str) -> None:
    text = i3_text.replace('pin = "D9"', f'pin = "{name}"')
    (problem,) = problems_of(text)
    owner = place(text, 'pin = "D10"')
    assert f"PB4 belongs to heaters.hotend.pin ({owner})" in problem


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ('"D9"', '"^D9"', "fans.part.pin is '^D9': expected no ^ before PH6: it does nothing here"),
        ('"D10"', '"~D10"', "heaters.hotend.pin is '~D10': expected no ~ before PB4"),
        ('"T0"', '"^T0"', "heaters.hotend.sensor_pin is '^T0': expected no ^ before PK5"),
        ('"D9"', '"!!D9"', "fans.part.pin is '!!D9': expected at most one ! before D9"),
        ('"T0"', '"!T0"', "heaters.hotend.sensor_pin is '!T0': expected no ! before PK5"),
        ('"^X_MIN"', '"~X_MIN"', "homing.x.pin is '~X_MIN': expected no ~ before PE5"),
        (
            'socket = "X"',
            'socket = "X"\nstep_pin = "^X_STEP"',
            "steppers.x.step_pin is '^X_STEP': expected no ^ before PF0",
        ),
    ],
)
def test_pin_mark_without_effect_is_refused(i3_text: str, old: str, new: str, says: str) -> None:
    (problem,) = problems_of(i3_text.replace(old, new, 1))
    assert says in problem


def test_marks_reach_the_description_of_the_board(i3_text: str) -> None:
    text = i3_text.replace('"D9"', '"!D9"').replace('"^X_MIN"', '"!^X_MIN"')
    text = text.replace('socket = "X"', 'socket = "X"\nstep_pin = "!X_STEP"')
    plain, marked = (board_description(config.load_text(each)) for each in (i3_text, text))
    assert marked.steppers[0].step_pin == f"!{plain.steppers[0].step_pin}"
    assert [e.pin.replace("!", "") for e in marked.endstops] == [e.pin for e in plain.endstops]
    assert [e.name for e in marked.endstops if "!" in e.pin] == ["x"]
    changed = set(marked.outputs) - set(plain.outputs)
    assert [(o.name, o.pin[0]) for o in changed] == [("part", "!")]


def test_motors_that_share_their_enable_pin_agree_on_it(i3_text: str) -> None:
    alike = i3_text.replace('socket = "Y"', 'socket = "Y"\nenable_pin = "X_ENABLE"')
    config.load_text(alike)
    (problem,) = problems_of(alike.replace('"X_ENABLE"', '"!X_ENABLE"'))
    assert "steppers.y.enable_pin is '!X_ENABLE': expected !PD7, as it stands at steppers.x" in (
        problem
    )


def test_fan_cannot_use_the_bed_output_of_a_hhf(i3_text: str) -> None:
    text = i3_text.replace('pin = "D9"', 'pin = "D8"')
    (problem,) = problems_of(text)
    owner = place(text, 'pin = "D8"')
    assert problem.startswith("my.toml:")
    assert problem.endswith(
        "fans.part.pin is 'D8': expected a pin of its own: PH5 belongs to heaters.bed.pin"
        f" ({owner}). Change or remove it."
    )


@pytest.mark.parametrize(("socket", "pin", "key"), [("X", "PB0", "select"), ("Y", "PL0", "detect")])
def test_drivers_on_spi_and_the_card_share_no_select(
    i3_text: str, socket: str, pin: str, key: str
) -> None:
    text = i3_text.replace(f'socket = "{socket}"', f'socket = "{socket}"\ndriver = "TMC2130"')
    config.load_text(text)
    (problem,) = problems_of(text + 'fitted = ["card"]\n')
    assert f"steppers.{socket.lower()}.socket is '{socket}': expected a pin of its own" in problem
    assert f"{pin} belongs to board.card.{key} ({board_place('ramps', 'card', key)})" in problem


def test_fitted_parts_are_listed_once(i3_text: str) -> None:
    (problem,) = problems_of(i3_text + 'fitted = ["card", "card"]\n')
    assert "board.fitted[1] is 'card': expected each thing once" in problem


def test_two_displays_cannot_use_one_plug(i3_text: str) -> None:
    both = '["reprap-discount-smart", "reprap-discount-full-graphic"]'
    problems = problems_of(i3_text + f"fitted = {both}\n")
    keys = ("select", "mosi", "sck", "beeper", "encoder_a", "encoder_b", "click", "kill")
    assert len(problems) == len(keys)
    for key, problem in zip(keys, problems, strict=True):
        assert f"board.displays.reprap-discount-full-graphic.{key} is " in problem
        assert "belongs to board.displays.reprap-discount-smart." in problem


def test_microstep_pins_belong_to_the_motor_in_their_socket() -> None:
    (problem,) = problems_of(FOUR_PI.replace('pin = "HE1"', 'pin = "PC30"'))
    owner = place(FOUR_PI, 'socket = "X"')
    assert "fans.part.pin is 'PC30': expected a pin of its own: PC30 belongs to" in problem
    assert f"steppers.x.socket ({owner})" in problem
    free = FOUR_PI.replace('pin = "HE1"', 'pin = "PC24"')  # MS2 of U, which is empty
    pins = {b.key: (b.name, b.pin) for b in bindings(config.load_text(free))}
    assert (pins["steppers.z.ms1"], pins["steppers.z.ms2"]) == (("Z_MS1", "PB6"), ("Z_MS2", "PB5"))
    (problem,) = problems_of(free.replace('socket = "Y"', 'socket = "Y"\nmicrosteps = 8'))
    assert (
        "steppers.y.microsteps is 8: expected what the pins of its socket can choose: 1, 2, 4, 16"
        in problem
    )


def test_two_names_of_a_4pi_endstop_pin_conflict() -> None:
    text = FOUR_PI + 'endstops = { Y_MAX = "PC17" }\n'
    (problem,) = problems_of(text.replace('"^Y_MIN"', '"^Y_MAX"'))
    assert "homing.z.pin is '^Z_MIN': expected a pin of its own: PC17 belongs to homing.y.pin" in (
        problem
    )


def test_console_pins_cannot_be_used(i3_text: str) -> None:
    (problem,) = problems_of(i3_text.replace('pin = "D9"', 'pin = "D1"'))
    owner = board_place("ramps", "console")
    assert "fans.part.pin is 'D1': expected a pin of its own: PE1 belongs to" in problem
    assert f"board.console ({owner})" in problem


def test_reserved_pin_conflict_names_its_purpose() -> None:
    text = config.shipped_text("i3") + 'reserved = { "a fan for the drivers" = ["D9"] }\n'
    (problem,) = problems_of(text)
    assert "PH6 belongs to board.reserved.a fan for the drivers (my.toml:" in problem


def test_a_sensor_needs_an_analog_input(i3_text: str) -> None:
    (problem,) = problems_of(i3_text.replace('sensor_pin = "T0"', 'sensor_pin = "D11"'))
    assert "heaters.hotend.sensor_pin is 'D11': expected an analog input; free here: " in problem
    free = problem.partition("free here: ")[2].removesuffix(". Change or remove it.").split(", ")
    # X, Y and their directions and enables take A0, A1, A2, A6, A7 and A8; the bed's is A14.
    assert free == [
        *("D57 (PF3)", "D58 (PF4)", "D59 (PF5)", "D63 (PK1)", "D64 (PK2)", "D65 (PK3)"),
        *("MAX6675_SELECT (PK4)", "D67 (PK5)", "D69 (PK7)"),
    ]


def test_a_laser_needs_hardware_pwm(i3_text: str) -> None:
    (problem,) = problems_of(i3_text + '[laser]\npin = "D42"\n')
    assert "laser.pin is 'D42': expected a pin with hardware PWM; free here: " in problem
    free = problem.partition("free here: ")[2]
    # All other timers time steps; the hotend has PB4, the fan PH6.
    assert free == "LED (PB7), SERVO3 (PG5). Change or remove it."


def test_a_timer_does_one_thing(i3_text: str) -> None:
    (problem,) = problems_of(i3_text + '[laser]\npin = "D5"\n')
    assert "laser.pin is 'D5': expected a pin whose timer is free: TIMER3 times steps; free" in (
        problem
    )


def test_a_compare_unit_times_one_motor(i3_text: str) -> None:
    text = i3_text + 'sockets.Y.compare = "TIMER3A"\n'
    (problem,) = problems_of(text)
    owner = place(text, 'socket = "X"')
    assert f"compare unit of its own: TIMER3A belongs to steppers.x.socket ({owner})" in problem


def test_a_chip_with_compare_units_has_no_more_motors() -> None:
    fifth = '[steppers.z1]\nsteps_per_mm = 400.0\nstep_pin = "PA1"\ndirection_pin = "PA2"\n'
    (problem,) = problems_of(MELZI + fifth)
    assert "steppers.z1.step_pin is 'PA1': expected at most 4 motors on one ATmega1284P" in problem


@pytest.mark.parametrize(
    ("line", "says"),
    [
        (
            'sockets.Y.compare = "TIMER2A"',
            "board.sockets.Y.compare is 'TIMER2A': expected a compare",
        ),
        ('fitted = ["kard"]', "board.fitted[0] is 'kard': expected what has a place on this board"),
        ('variant = "HBH"', "board.variant is 'HBH': expected one of the board's variants"),
        ('numbering = "mega"', "board.numbering is 'mega': expected a numbering of pins"),
    ],
)
def test_missing_messages_of_a_board_are_named(i3_text: str, line: str, says: str) -> None:
    (problem,) = (p for p in problems_of(i3_text + line + "\n") if says in p)
    assert "Did you mean" in problem or "Known here" in problem


def test_unknown_pin_is_named(i3_text: str) -> None:
    (problem,) = problems_of(i3_text.replace('pin = "D9"', 'pin = "PM9"'))
    assert "fans.part.pin is 'PM9': expected a pin of ATmega2560 or a name on the board" in problem


def test_motors_may_share_their_enable_pin_and_nothing_else() -> None:
    assert config.load_text(MELZI).board.name == "Melzi"
    (problem,) = problems_of(MELZI.replace('pin = "FAN"', 'pin = "PD6"'))
    assert "fans.part.pin is 'PD6'" in problem
    assert "PD6 belongs to steppers.x.socket" in problem


def test_functions_without_a_pin_use_the_boards_default() -> None:
    text = MELZI
    for line in ('pin = "HE0"\n', 'sensor_pin = "HE0_TEMP"\n', 'pin = "BED"\n', 'pin = "FAN"\n'):
        assert line in text
        text = text.replace(line, "")
    machine = config.load_text(text)
    assert machine.heaters["hotend"].pin == "HE0"
    assert machine.heaters["hotend"].sensor_pin == "HE0_TEMP"
    assert machine.heaters["bed"].pin == "BED"
    assert machine.fans["part"].pin == "FAN"


def test_any_function_may_be_rebound(i3_text: str) -> None:
    text = i3_text.replace('pin = "D9"', 'pin = "D11"').replace('"^X_MIN"', '"^X_MAX"')
    text = text.replace('socket = "E0"', 'socket = "E0"\nstep_pin = "D40"')
    rebound = {b.key: (b.pin, b.original) for b in bindings(config.load_text(text)) if b.rebound}
    assert rebound == {
        "steppers.e.step_pin": ("PG1", "PA4"),
        "fans.part.pin": ("PB5", "PH6"),
        "homing.x.pin": ("^PE4", "PE5"),
    }


def test_fans_on_outputs_for_fans_are_not_rebound() -> None:
    """The order of fans in a file does not say which output each has."""
    text = config.shipped_text("voron-2-4")
    for pins, rebound in (
        (("FAN1", "FAN0"), []),
        (("FAN0", "FAN5"), []),
        (("HE3", "FAN0"), ["fans.part.pin"]),
    ):
        changed = text.replace('pin = "FAN0"', f'pin = "{pins[0]}"', 1)
        changed = changed.replace('"FAN1"\nfollows', f'"{pins[1]}"\nfollows')
        found = bindings(config.load_text(changed))
        assert [b.key for b in found if b.key.startswith("fans") and b.rebound] == rebound


def test_motors_in_other_sockets_and_with_pins_of_their_own(i3_text: str) -> None:
    text = i3_text.replace('socket = "X"', 'socket = "?"').replace('socket = "Y"', 'socket = "X"')
    text = text.replace('socket = "?"', 'socket = "Y"').replace('socket = "Z"', 'socket = "E1"')
    own = 'step_pin = "D23"\ndirection_pin = "E0_DIR"\nenable_pin = "!D27"'
    text = text.replace('socket = "E0"', own)
    rebound = {
        b.key.removeprefix("steppers."): (b.name, b.original_name)
        for b in bindings(config.load_text(text))
        if b.rebound
    }
    words = {"step": "STEP", "direction": "DIR", "enable": "ENABLE"}
    moved = {"x": ("Y", "X"), "y": ("X", "Y"), "z": ("E1", "Z")}
    assert rebound == {
        f"{motor}.{key}_pin": (f"{there}_{word}", f"{own}_{word}")
        for motor, (there, own) in moved.items()
        for key, word in words.items()
    } | {"e.step_pin": ("D23", "E0_STEP"), "e.enable_pin": ("!D27", "E0_ENABLE")}


def test_sockets_of_second_motor_and_crossed_belts() -> None:
    for name, keys in (("big-fish-i3", ["z", "z1"]), ("corexy", ["a", "b"])):
        machine = config.load(name)
        found = {b.key: b.original_name for b in bindings(machine)}
        for key in keys:
            assert found[f"steppers.{key}.step_pin"] == f"{machine.steppers[key].socket}_STEP"


def test_shipped_machines_leave_every_pin_where_its_board_has_it() -> None:
    elsewhere = {
        "four-pi": [
            "heaters.hotend.sensor_pin",
            "heaters.hotend2.sensor_pin",
            "heaters.bed.sensor_pin",
        ],
        "ramps-13": ["fans.part.pin"],
    }
    for name in config.shipped_machines():
        rebound = [b.key for b in bindings(config.load(name)) if b.rebound]
        assert rebound == elsewhere.get(name, [])


DICTIONARY = {
    "enumerations": {"pin": {"PA0": [0, 16], "PB0": [16, 16], "ADC_TEMPERATURE": 254}},
    "config": {"CLOCK_FREQ": 72_000_000, "MCU": "stm32f103xe"},
    "commands": {},
    "responses": {},
}


@pytest.mark.parametrize("packed", [False, True])
def test_a_board_of_klippers_has_the_pins_of_its_dictionary(tmp_path: Path, packed: bool) -> None:
    raw = json.dumps(DICTIONARY).encode()
    (tmp_path / "board.dict").write_bytes(zlib.compress(raw) if packed else raw)
    file = str(tmp_path / "my.toml")
    machine = config.load_text(KLIPPER, file)
    assert machine.board.clock_hz == 72_000_000
    assert machine.board.pin("!PB15") == "!PB15"
    (problem,) = problems_of(KLIPPER.replace('"PA5"', '"PC5"'), file)
    assert "heaters.hotend.pin is 'PC5': expected a pin of the board's dictionary" in problem


def test_pins_of_a_linux_process(tmp_path: Path) -> None:
    """Names have a slash, and several of them are one pin."""
    told = dictionary(chip="linux", newer=True)
    (tmp_path / "board.dict").write_text(json.dumps(told))
    file = str(tmp_path / "my.toml")
    text = on_its_pins(KLIPPER, told)
    board = config.load_text(text, file).board
    assert board.clock_hz == 50_000_000
    assert board.pin("!gpiochip1/gpio11") == "!gpiochip1/gpio11"
    assert board.pin("gpiochip0/gpio8") == board.pin("gpio8") == "gpio8"
    assert board.pin("pwmchip7/pwm15") == "pwmchip7/pwm15"
    twice = text.replace('pin = "gpiochip0/gpio7"', 'pin = "gpio6"')
    (problem,) = problems_of(twice, file)
    assert (
        "fans.part.pin is 'gpio6': expected a pin of its own: gpio6 belongs to heaters.bed.pin"
        in problem
    )
    (problem,) = problems_of(text.replace("gpiochip0/gpio7", "gpiochip9/gpio0"), file)
    assert "fans.part.pin is 'gpiochip9/gpio0': expected a pin of the board's dict" in problem


def test_a_board_of_klippers_keeps_what_its_dictionary_reserves(tmp_path: Path) -> None:
    reserves = {"RESERVE_PINS_USB": "PA11,PA12", "RESERVE_PINS_crystal": "PH0,PH1"}
    told = {**DICTIONARY, "config": {**DICTIONARY["config"], **reserves}}
    (tmp_path / "board.dict").write_text(json.dumps(told))
    file = str(tmp_path / "my.toml")
    reserved = config.load_text(KLIPPER, file).board.reserved
    assert reserved == {"USB": ["PA11", "PA12"], "crystal": []}
    text = KLIPPER.replace('pin = "PA7"', 'pin = "PA12"')
    (problem,) = problems_of(text, file)
    assert (
        "fans.part.pin is 'PA12': expected a pin of its own: PA12 belongs to board.reserved.USB"
        in problem
    )
    own = KLIPPER + 'reserved = { relay = ["PB15"], USB = [] }\n'
    loaded = config.load_text(own.replace('pin = "PA7"', 'pin = "PA12"'), file)
    assert loaded.board.reserved == {"USB": [], "crystal": [], "relay": ["PB15"]}


def test_clock_of_klippers_board_may_be_left_to_its_firmware(tmp_path: Path) -> None:
    bare = KLIPPER.replace('dictionary = "board.dict"\n', "")
    board, text = config.load_text(bare).board, bare + "clock_hz = 72_000_000\n"
    assert (board.clock_hz, board.knows_clock) == (16_000_000, False)
    known = config.load_text(text).board
    assert (known.clock_hz, known.knows_clock) == (72_000_000, True)
    assert (learned := board.with_clock(72_000_000)).knows_clock
    assert learned.budget_spec() == known.budget_spec()
    own = config.load_text(bare + "budget = { cycles_per_step = 200 }\n").board
    assert (budget := own.with_clock(72_000_000).budget)
    assert (budget.cycles_per_step, budget.cycles_per_command) == (200, 1950)
    alone = bare.replace('base = "klipper"', 'name = "mine"\nmcu = "atmega2560"\nmove_count = 256')
    missing = "board.clock_hz is missing: expected the frequency of the board's clock"
    assert any(missing in problem for problem in problems_of(alone))
    (missing,) = problems_of(KLIPPER, str(tmp_path / "my.toml"))
    assert "board.dictionary is 'board.dict': expected a file to read" in missing


@pytest.mark.parametrize(
    "content",
    [
        b"{}",
        b"[]",
        b"null",
        b"\x00",
        b'{"config": {"CLOCK_FREQ": 1e999}, "enumerations": {"pin": {}}}',
        b'{"config": {"CLOCK_FREQ": 72000000}, "enumerations": {"pin": []}}',
        b'{"config": {"CLOCK_FREQ": 72000000}, "enumerations": {"pin": {"PA0": [0]}}}',
        b'{"config": {"CLOCK_FREQ": 72000000}, "enumerations": {"pin": {"PA0": "x"}}}',
        b'{"config": {"CLOCK_FREQ": 72000000}, "enumerations": [1]}',
    ],
)
def test_a_file_that_is_not_a_dictionary_is_named(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "board.dict").write_bytes(content)
    (broken,) = problems_of(KLIPPER, str(tmp_path / "my.toml"))
    assert "expected a data dictionary of Klipper's protocol" in broken


def _with(text: str, changes: dict[str, str]) -> str:
    for old, new in changes.items():
        assert old in text
        text = text.replace(old, new)
    return text


FOUR_PI = _with(
    config.shipped_text("i3"),
    {
        'base = "ramps"': 'base = "4pi"',
        'socket = "E0"': 'socket = "E"',
        'pin = "D10"': 'pin = "HE0"',
        'pin = "D8"': 'pin = "BED"',
        'sensor_pin = "T1"': 'sensor_pin = "T2"',
        'pin = "D9"': 'pin = "HE1"',
    },
)
MELZI = _with(
    config.shipped_text("i3"),
    {
        'base = "ramps"': 'base = "melzi"',
        'socket = "E0"': 'socket = "E"',
        'pin = "D10"': 'pin = "HE0"',
        'sensor_pin = "T0"': 'sensor_pin = "HE0_TEMP"',
        'pin = "D8"': 'pin = "BED"',
        'sensor_pin = "T1"': 'sensor_pin = "BED_TEMP"',
        'pin = "D9"': 'pin = "FAN"',
        '"^X_MIN"': '"^X_STOP"',
        '"^Y_MIN"': '"^Y_STOP"',
        '"^Z_MIN"': '"^Z_STOP"',
    },
)
KLIPPER = _with(
    config.shipped_text("i3"),
    {
        'base = "ramps"': 'base = "klipper"\ndictionary = "board.dict"',
        'socket = "X"': 'step_pin = "PB0"\ndirection_pin = "PB1"\nenable_pin = "!PB2"',
        'socket = "Y"': 'step_pin = "PB3"\ndirection_pin = "PB4"\nenable_pin = "!PB5"',
        'socket = "Z"': 'step_pin = "PB6"\ndirection_pin = "PB7"\nenable_pin = "!PB8"',
        'socket = "E0"': 'step_pin = "PB9"\ndirection_pin = "PB10"\nenable_pin = "!PB11"',
        'pin = "D10"': 'pin = "PA5"',
        'sensor_pin = "T0"': 'sensor_pin = "PA0"',
        'pin = "D8"': 'pin = "PA6"',
        'sensor_pin = "T1"': 'sensor_pin = "PA1"',
        'pin = "D9"': 'pin = "PA7"',
        '"^X_MIN"': '"^PA8"',
        '"^Y_MIN"': '"^PA9"',
        '"^Z_MIN"': '"^PA10"',
    },
)


@pytest.mark.parametrize(
    ("written", "is_taken"),
    [("HE0", True), ("!PC8", True), ("!HE0", True), ("PC8", False)],
)
def test_heater_pin_that_is_active_low_must_be_inverted(written: str, is_taken: bool) -> None:
    """A Duet switches its heaters on with a low level; `!HE0` is for a relay that inverts."""
    text = config.shipped_text("delta").replace('"HE0"', f'"{written}"')
    if is_taken:
        machine = config.load_text(text)
        assert machine.pin(machine.heaters["hotend"].pin) == (
            "PC8" if written == "!HE0" else "!PC8"
        )
        return
    (problem,) = problems_of(text)
    assert (
        "heaters.hotend.pin is 'PC8': expected HE0 or !PC8, since here it is on when low;"
        " !HE0 is on when high" in problem
    )


def test_klippers_firmware_uses_its_chip_in_its_own_way(i3_text: str) -> None:
    """Passo's times steps with the timer of D6."""
    text = i3_text.replace("[board]", '[laser]\npin = "D6"\n\n[board]')
    (problem,) = problems_of(text)
    assert "expected a pin whose timer is free: TIMER4" in problem
    config.load_text(text.replace("[board]", '[board]\nfirmware = "klipper"'))


def test_klipper_board_may_exceed_its_compare_units() -> None:
    motor = '[steppers.x1]\nsteps_per_mm = 80.0\nstep_pin = "PA1"\ndirection_pin = "PA2"\n'
    sockets = {'"E0"': '"E"', '"D10"': '"HE0"', '"D8"': '"BED"', '"D9"': '"FAN"'}
    sockets |= {f"{axis}_MIN": f"{axis}_STOP" for axis in "XYZ"}
    sockets |= {'"T0"': '"HE0_TEMP"', '"T1"': '"BED_TEMP"', '"ramps"': '"melzi"'}
    text = config.shipped_text("i3")
    for old, new in sockets.items():
        text = text.replace(old, new)
    text = text.replace("[extruders.e]", f"{motor}[extruders.e]")
    assert any("at most 4 motors on one ATmega1284P" in p for p in problems_of(text))
    config.load_text(text.replace("[board]", '[board]\nfirmware = "klipper"'))


@pytest.mark.parametrize("name", ["prusa-mk3s", "voron-0", "voron-2-4"])
def test_fan_with_the_name_of_a_heater_has_an_output_of_its_own(name):
    machine = config.load(name)
    heater, fan = machine.heaters["hotend"], machine.fans["hotend"]
    outputs = {o.name: o.pin for o in board_description(machine).outputs}
    assert outputs["hotend"] == machine.pin(heater.pin)
    assert outputs["hotend-fan"] == machine.pin(fan.pin)
