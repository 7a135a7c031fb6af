"""Shipped boards: every name leads to a pin, no pin serves two, and all is as wired by the makers.

The tables below are those of APrinter's and StuFW's boards, in the numbers printed on the boards.
"""

import pytest

from passo import config
from passo.config.board import Board, joined_marks

BOARDS = [name for name in config.shipped_boards() if config.load_board(name).chip]
KLIPPERS = [name for name in config.shipped_boards() if name not in {*BOARDS, "klipper"}]
MEGA = ("ramps", "mks-gen", "mks-gen-l")

# board: socket: step, direction, enable; all enable low
MOTORS = {
    "radds": {
        "X": ("D24", "D23", "D26"),
        "Y": ("D17", "D16", "D22"),
        "Z": ("D2", "D3", "D15"),
        "E1": ("A7", "A6", "A8"),
        "E2": ("A10", "A9", "A11"),
        "E3": ("D51", "D53", "D49"),
    },
    "ramps-fd": {
        "X": ("A9", "A8", "D48"),
        "Y": ("A11", "A10", "D46"),
        "Z": ("A13", "A12", "D44"),
        "E0": ("D36", "D28", "D42"),
        "E1": ("D43", "D41", "D39"),
        "E2": ("D32", "D47", "D45"),
    },
    "duet-0.6": {
        "X": ("PD4", "PD5", "PD6"),
        "Y": ("PD0", "PD1", "PD2"),
        "Z": ("PC25", "PC26", "PC27"),
        "E0": ("PA0", "PA1", "PA5"),
    },
    "4pi": {
        "X": ("PC28", "PB8", "PC31"),
        "Y": ("PC23", "PA31", "PA22"),
        "Z": ("PA27", "PC27", "PB7"),
        "E": ("PC26", "PB2", "PB13"),
        "U": ("PB1", "PC25", "PC13"),
    },
    "melzi": {
        "X": ("PD7", "PC5", "PD6"),
        "Y": ("PC6", "PC7", "PD6"),
        "Z": ("PB3", "PB2", "PA5"),
        "E": ("PB1", "PB0", "PD6"),
    },
    "stm32f429-discovery": {
        "X": ("PG3", "PG2", "PB2"),
        "Y": ("PD5", "PD7", "PD4"),
        "Z": ("PA9", "PC8", "PA10"),
        "E": ("PC12", "PC11", "PD2"),
    },
    "stm32f407-discovery": {"X": ("PD6", "PD3", "PD7")},
    "pico": {},
    **{
        teensy: {
            "X": ("T0", "T1", "T8"),
            "Y": ("T2", "T3", "T9"),
            "Z": ("T4", "T5", "T10"),
            "E": ("T6", "T7", "T11"),
        }
        for teensy in ("teensy3-mk20dx128", "teensy3-mk20dx256")
    },
    **{
        mega: {
            "X": ("D54", "D55", "D38"),
            "Y": ("D60", "D61", "D56"),
            "Z": ("D46", "D48", "D62"),
            "E0": ("D26", "D28", "D24"),
            "E1": ("D36", "D34", "D30"),
        }
        for mega in MEGA
    },
}
MEGA_SWITCHES = {
    "X_MIN": "D3",
    "X_MAX": "D2",
    "Y_MIN": "D14",
    "Y_MAX": "D15",
    "Z_MIN": "D18",
    "Z_MAX": "D19",
}
SWITCHES = {
    **dict.fromkeys(MEGA, MEGA_SWITCHES),
    "radds": {
        "X_MIN": "D28",
        "Y_MIN": "D30",
        "Z_MIN": "D32",
        "X_MAX": "D34",
        "Y_MAX": "D36",
        "Z_MAX": "D38",
    },
    "ramps-fd": {
        "X_MIN": "D22",
        "Y_MIN": "D24",
        "Z_MIN": "D26",
        "X_MAX": "D30",
        "Y_MAX": "D38",
        "Z_MAX": "D34",
    },
    "duet-0.6": {"X_STOP": "PD7", "Y_STOP": "PD3", "Z_STOP": "PA3", "E0_STOP": "PA7"},
    "4pi": {"X_MIN": "PB16", "Y_MIN": "PA17", "Z_MIN": "PC17", "X_MAX": "PC15", "Z_MAX": "PC18"},
    "melzi": {"X_STOP": "PC2", "Y_STOP": "PC3", "Z_STOP": "PC4"},
    "teensy3-mk20dx128": {"X_MIN": "T12", "Y_MIN": "T14", "Z_MIN": "T15"},
    "teensy3-mk20dx256": {"X_MIN": "T12", "Y_MIN": "T14", "Z_MIN": "T15"},
    "stm32f407-discovery": {"BUTTON": "PA0"},
    "stm32f429-discovery": {"BUTTON": "PA0", "G9": "PG9", "B4": "PB4", "B7": "PB7"},
    "pico": {},
}
SENSORS = {
    "ramps": ["A13", "A14", "A15"],
    "mks-gen": ["A13", "A14", "A15"],
    "mks-gen-l": ["A13", "A14", "A15"],
    "radds": ["A0", "A1", "A2", "A3", "A4"],
    "ramps-fd": ["A0", "A1", "A2", "A3"],
    "duet-0.6": ["PA4", "PA6"],
    "4pi": ["PC16", "PB4", "PA30", "PB3"],
    "melzi": ["PA6", "PA7"],
    "teensy3-mk20dx128": ["A2"],
    "teensy3-mk20dx256": ["A2"],
    "stm32f407-discovery": ["PA2", "PA3", "PB0"],
    "stm32f429-discovery": ["PF6", "PC3", "PA5"],
    "pico": [],
}
# board: function: output, sensor
FUNCTIONS = {
    "radds": {
        "hotend0": ("D13", "A0"),
        "hotend1": ("D12", "A1"),
        "hotend2": ("D11", "A2"),
        "bed": ("D7", "A4"),
        "fan0": ("D9", None),
        "fan1": ("D8", None),
    },
    "ramps-fd": {
        "hotend0": ("D9", "A1"),
        "hotend1": ("D10", "A2"),
        "hotend2": ("D11", "A3"),
        "bed": ("D8", "A0"),
        "fan0": ("D12", None),
        "fan1": ("D2", None),
    },
    "duet-0.6": {"hotend0": ("!PC8", "PA6"), "bed": ("!PC24", "PA4"), "fan0": ("!PC2", None)},
    "melzi": {"hotend0": ("PD5", "PA7"), "bed": ("PD4", "PA6"), "fan0": ("PB4", None)},
    "4pi": {"hotend0": ("PA21", "PC16"), "hotend1": ("PA23", "PB4"), "bed": ("PA20", "PA30")},
    "teensy3-mk20dx256": {"hotend0": ("T17", "A2"), "fan0": ("T18", None)},
    "mks-gen": {
        "hotend0": ("D10", "A13"),
        "hotend1": ("D7", "A15"),
        "bed": ("D8", "A14"),
        "fan0": ("D9", None),
    },
    "mks-gen-l": {
        "hotend0": ("D10", "A13"),
        "hotend1": ("D7", "A15"),
        "bed": ("D8", "A14"),
        "fan0": ("D9", None),
    },
}
# StuFW's outputs of a RAMPS. Its HHF also leaves the bed on the pin of its fan: not carried over.
VARIANTS = {
    "HFB": {"hotend0": "D10", "fan0": "D9", "bed": "D8"},
    "HHB": {"hotend0": "D10", "hotend1": "D9", "bed": "D8"},
    "HFF": {"hotend0": "D10", "fan0": "D9", "fan1": "D8"},
    "HHF": {"hotend0": "D10", "hotend1": "D9", "fan0": "D8"},
    "HHH": {"hotend0": "D10", "hotend1": "D9", "hotend2": "D8"},
}
# board: console baud, connector, flash method, clock in MHz
PORTS = {
    "ramps": (250_000, "serial", "avrdude", 16),
    "mks-gen": (250_000, "serial", "avrdude", 16),
    "mks-gen-l": (250_000, "serial", "avrdude", 16),
    "melzi": (250_000, "serial", "avrdude", 16),
    "radds": (115_200, "serial", "bossac", 42),
    "ramps-fd": (115_200, "serial", "bossac", 42),
    "duet-0.6": (250_000, "usb", "bossac", 42),
    "4pi": (250_000, "usb", "bossac", 96),
    "teensy3-mk20dx128": (250_000, "usb", "teensy_loader_cli", 48),
    "teensy3-mk20dx256": (250_000, "usb", "teensy_loader_cli", 72),
    "stm32f407-discovery": (250_000, "usb", "openocd", 84),
    "stm32f429-discovery": (250_000, "usb", "openocd", 84),
    "pico": (250_000, "usb", "uf2", 12),
}
COMPARE = {
    "ramps": ["TIMER3A", "TIMER3B", "TIMER3C", "TIMER4A", "TIMER4B"],
    "melzi": ["TIMER1A", "TIMER1B", "TIMER3A", "TIMER3B"],
}


def pins_of(board: Board) -> list[str]:
    """Every pin that the board's file gives a use, but chip selects and displays, which share."""
    sockets = [p for s in board.sockets.values() for p in (s.step, s.direction, *s.microstep)]
    enables = {s.enable for s in board.sockets.values()}
    named = [
        *board.outputs.values(),
        *board.thermistors.values(),
        *board.endstops.values(),
        *(pin for pins in board.reserved.values() for pin in pins),
        *(board.console.pins if board.console else ()),
    ]
    return [pin.lstrip("!^~") for pin in (*sockets, *enables, *named)]


@pytest.mark.parametrize("name", BOARDS)
def test_every_name_leads_to_a_pin_of_the_chip(name: str) -> None:
    board = config.load_board(name)
    assert board.chip
    others = [
        *board.card.values(),
        *(pin for display in board.displays.values() for pin in display.values()),
        *(pin for pins in board.reserved.values() for pin in pins),
        *(s.select for s in board.sockets.values() if s.select),
    ]
    for pin in (*board.pins.values(), *pins_of(board), *others):
        assert pin.lstrip("!^~") in board.chip.pins
    for function in board.functions.values():
        assert function.output in board.pins
        assert function.sensor is None or function.sensor in board.pins


@pytest.mark.parametrize("name", BOARDS)
def test_no_pin_serves_two(name: str) -> None:
    board = config.load_board(name)
    pins = pins_of(board)
    # Boards print several names beside an output: those of the base, and their own.
    names = board.outputs | board.thermistors
    doubled = len(names) - len(set(names.values()))
    assert len(pins) - doubled == len(set(pins))
    for display in board.displays.values():
        assert len(set(display.values())) == len(display)
        assert not {*display.values(), *board.card.values()} & set(pins)


@pytest.mark.parametrize("name", BOARDS)
def test_motors_are_wired_as_in_the_machine_file(name: str) -> None:
    board = config.load_board(name)
    assert list(board.sockets) == list(MOTORS[name])
    for socket, (step, direction, enable) in MOTORS[name].items():
        it = board.sockets[socket]
        assert (it.step, it.direction) == (board.pin(step), board.pin(direction))
        assert it.enable == board.pin(f"!{enable}")
        assert board.pin(f"{socket}_STEP") == it.step
        assert board.pin(f"{socket}_DIR") == it.direction


@pytest.mark.parametrize("name", BOARDS)
def test_endstops_and_sensors_are_wired_as_in_the_machine_file(name: str) -> None:
    board = config.load_board(name)
    assert board.endstops == {key: board.pin(pin) for key, pin in SWITCHES[name].items()}
    assert {*board.thermistors.values()} == {board.pin(pin) for pin in SENSORS[name]}
    assert board.chip and not {*board.thermistors.values()} - set(board.chip.adc)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_outputs_are_wired_as_in_the_machine_file(name: str) -> None:
    board = config.load_board(name)
    found = {
        key: (board.pin(f.output), board.pin(f.sensor) if f.sensor else None)
        for key, f in board.functions.items()
    }
    assert found == {
        key: (board.pin(output), board.pin(sensor) if sensor else None)
        for key, (output, sensor) in FUNCTIONS[name].items()
    }


def test_variants_of_ramps_have_their_outputs() -> None:
    board = config.load_board("ramps")
    outputs = {v: {k: f.output for k, f in fs.items()} for v, fs in board.variants.items()}
    assert outputs == VARIANTS
    assert board.functions == board.variants["HFB"]
    for functions in board.variants.values():
        used = [f.output for f in functions.values()]
        used += [f.sensor for f in functions.values() if f.sensor]
        assert len(used) == len(set(used))
    sensors = {k: board.pin(f.sensor or "") for k, f in board.variants["HHH"].items()}
    assert sensors == {"hotend0": "PK5", "hotend1": "PK7", "hotend2": "PK6"}


@pytest.mark.parametrize("name", BOARDS)
def test_boards_have_console_flash_method_and_clock(name: str) -> None:
    board = config.load_board(name)
    assert board.console and board.flash
    baud, connector, method, mhz = PORTS[name]
    assert (board.console.baud, board.console.connector) == (baud, connector)
    assert (board.flash.method, board.clock_hz) == (method, mhz * 1_000_000)
    assert len(board.console.pins) == 2
    assert board.incomplete == ("usb" if connector == "usb" else "")


def test_boards_that_need_manual_steps_state_them() -> None:
    need = {n for n in BOARDS if (f := config.load_board(n).flash) and (f.before or f.after)}
    assert need == {*BOARDS} - {"ramps", "mks-gen", "mks-gen-l"}


SELECTS = {
    "ramps": ["D53", "D49", "D40", "D42", "D44"],
    "mks-gen": ["D53", "D49", "D40", "D42", "D44"],
    "mks-gen-l": ["D63", "D64", "D65", "D66", "D12"],
    "radds": ["D25", "D27", "D29", "D31", "D33", "D35"],
}


@pytest.mark.parametrize("name", SELECTS)
def test_chip_selects_of_drivers_are_pins_of_the_board(name: str) -> None:
    board = config.load_board(name)
    found = [socket.select for socket in board.sockets.values()]
    assert found == [board.pin(pin) for pin in SELECTS[name]]


@pytest.mark.parametrize("name", COMPARE)
def test_compare_units_are_those_of_the_chip(name: str) -> None:
    board = config.load_board(name)
    assert board.chip
    units = [s.compare for s in board.sockets.values()]
    assert units == COMPARE[name]
    assert not {*units} - {*board.chip.compare_units}


def test_selects_of_drivers_on_a_ramps() -> None:
    board = config.load_board("ramps")
    selects = {name: socket.select for name, socket in board.sockets.items()}
    told = {"X": "D53", "Y": "D49", "Z": "D40", "E0": "D42", "E1": "D44"}
    assert selects == {name: board.pin(pin) for name, pin in told.items()}


def test_displays_of_a_ramps() -> None:
    board = config.load_board("ramps")
    smart = board.displays["reprap-discount-smart"]
    graphic = board.displays["reprap-discount-full-graphic"]
    told = {"rs": 16, "enable": 17, "d4": 23, "d5": 25, "d6": 27, "d7": 29}
    shared = {"beeper": 37, "encoder_a": 31, "encoder_b": 33, "click": 35, "kill": 41}
    assert smart == {key: board.pin(f"D{n}") for key, n in (told | shared).items()}
    told = {"select": 16, "mosi": 17, "sck": 23}
    assert graphic == {key: board.pin(f"D{n}") for key, n in (told | shared).items()}
    card = {"select": 53, "detect": 49, "mosi": 51, "miso": 50, "sck": 52}
    assert board.card == {key: board.pin(f"D{n}") for key, n in card.items()}


def test_microsteps_and_currents_of_a_4pi() -> None:
    sockets = config.load_board("4pi").sockets
    assert {name: (s.microstep, s.current) for name, s in sockets.items()} == {
        "X": (["PC30", "PC29"], 3),
        "Y": (["PC11", "PC10"], 1),
        "Z": (["PB6", "PB5"], 0),
        "E": (["PB12", "PB11"], 2),
        "U": (["PB0", "PC24"], 5),
    }


def test_a_board_of_klippers_has_no_pins_of_its_own() -> None:
    board = config.load_board("klipper")
    assert (board.pins, board.chip, board.incomplete) == ({}, None, "")


# The first motor, the first hotend with its sensor, the bed and a fan, as in Klipper's examples.
KLIPPERS_PINS = {
    "creality-4.2.2": ("X", "PC2", "PB9", "!PC3", "PA1", "PC5", "PA2", "PA0"),
    "creality-4.2.7": ("X", "PB9", "PC2", "!PC3", "PA1", "PC5", "PA2", "PA0"),
    "ebb-v1.1": ("E", "PD0", "PD1", "!PD2", "PA2", "PA3", None, "PA0"),
    "ebb-v1.2": ("E", "PD0", "PD1", "!PD2", "PB13", "PA3", None, "PA0"),
    "einsy-rambo": ("X", "PC0", "PL0", "!PA7", "PE5", "PF0", "PG5", "PH3"),
    "manta-m8p": ("M1", "PE2", "PB4", "!PC11", "PE3", "PA1", "PB7", "PE6"),
    "octopus": ("MOTOR0", "PF13", "PF12", "!PF14", "PA2", "PF4", "PA1", "PA8"),
    "skr-1.3": ("X", "P2.2", "P2.6", "!P2.1", "P2.7", "P0.24", "P2.5", "P2.3"),
    "skr-1.4": ("X", "P2.2", "P2.6", "!P2.1", "P2.7", "P0.24", "P2.5", "P2.3"),
    "skr-1.4-turbo": ("X", "P2.2", "P2.6", "!P2.1", "P2.7", "P0.24", "P2.5", "P2.3"),
    "skr-2": ("X", "PE2", "PE1", "!PE3", "PB3", "PA2", "PD7", "PB7"),
    "skr-mini-e3-v2": ("X", "PB13", "PB12", "!PB14", "PC8", "PA0", "PC9", "PC6"),
    "skr-mini-e3-v3": ("X", "PB13", "PB12", "!PB14", "PC8", "PA0", "PC9", "PC6"),
    "skr-pico": ("X", "gpio11", "gpio10", "!gpio12", "gpio23", "gpio27", "gpio21", "gpio17"),
    "spider": ("X", "PE11", "PE10", "!PE9", "PB15", "PC0", "PB4", "PB0"),
}


@pytest.mark.parametrize("name", KLIPPERS)
def test_boards_with_the_firmware_of_klipper(name: str) -> None:
    board = config.load_board(name)
    assert board.is_klippers and board.firmware == "klipper" and board.budget
    pins = pins_of(board)
    assert len(pins) == len(set(pins))
    hotend, bed, fan = (board.functions.get(key) for key in ("hotend0", "bed", "fan0"))
    assert hotend and hotend.sensor and fan
    first = next(iter(board.sockets))
    motor = board.sockets[first]
    assert KLIPPERS_PINS[name] == (
        first,
        motor.step,
        motor.direction,
        motor.enable,
        board.pin(hotend.output),
        board.pin(hotend.sensor),
        board.pin(bed.output) if bed else None,
        board.pin(fan.output),
    )


def test_several_drivers_on_one_uart_have_addresses_of_their_own() -> None:
    for name in ("skr-mini-e3-v2", "skr-mini-e3-v3", "skr-pico"):
        sockets = config.load_board(name).sockets.values()
        assert [socket.address for socket in sockets] == [0, 2, 1, 3]
        assert len({(socket.uart, socket.uart_send) for socket in sockets}) == 1


def test_unknown_board_raises_key_error() -> None:
    with pytest.raises(KeyError):
        config.load_board("ramps-2")


@pytest.mark.parametrize(
    ("outer", "inner", "pin"),
    [
        ("D10", "PB4", "PB4"),
        ("!D10", "PB4", "!PB4"),
        ("BED", "!PC24", "!PC24"),
        ("!BED", "!PC24", "PC24"),
        ("^!X_MIN", "PE5", "!^PE5"),
    ],
)
def test_marks_of_a_pin_and_its_name_combine(outer: str, inner: str, pin: str) -> None:
    assert joined_marks(outer, inner) == pin


@pytest.mark.parametrize(
    ("name", "led", "select"),
    [
        ("ramps", "D13", "D53"),
        ("melzi", "PA4", "PA0"),
        ("radds", "D37", "D4"),
        ("ramps-fd", "D13", "D4"),
        ("duet-0.6", "PB24", None),
        ("4pi", "PC22", None),
        ("teensy3-mk20dx256", "T13", None),
        ("stm32f429-discovery", "PG13", None),
        ("stm32f407-discovery", "PD12", None),
        ("pico", "GP25", None),
    ],
)
def test_boards_have_pins_of_lights_and_cards(name: str, led: str, select: str | None) -> None:
    board = config.load_board(name)
    assert board.pin("LED") == board.pin(led)
    assert board.card.get("select") == (board.pin(select) if select else None)


@pytest.mark.parametrize(
    ("name", "clock", "command", "data"),
    [
        ("duet-0.6", "PA19", "PA20", ["PA21", "PA22", "PA23", "PA24"]),
        ("4pi", "PA3", "PA4", ["PA5", "PA6", "PA7", "PA8"]),
    ],
)
def test_cards_on_sdio_have_their_pins(
    name: str, clock: str, command: str, data: list[str]
) -> None:
    card = config.load_board(name).card
    assert [card["clock"], card["command"], *(card[f"data{i}"] for i in range(4))] == [
        clock,
        command,
        *data,
    ]


def test_host_and_firmware_use_the_same_baud_rate() -> None:
    text = config.shipped_text("i3")
    for line, bauds in (
        ("", (250_000, 250_000)),
        ("baud = 115_200\n", (115_200, 115_200)),
        ("console = { baud = 500_000 }\n", (500_000, 500_000)),
        ("baud = 57_600\nconsole = { baud = 500_000 }\n", (57_600, 500_000)),
    ):
        board = config.load_text(text.replace('base = "ramps"\n', f'base = "ramps"\n{line}')).board
        assert board.console
        assert (board.baud, board.console.baud) == bauds
