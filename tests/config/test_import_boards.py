"""A printer.cfg without the name of its board: the board is known by its pins."""

import re
from pathlib import Path

import pytest

from passo import config
from passo.cli.main import main
from passo.config.board import Board
from passo.config.importing.formats import imported
from passo.config.pin_names import bare

HEAD = """\
[printer]
kinematics: cartesian
max_velocity: 300
max_accel: 3000
"""
AXIS = """\
[stepper_{axis}]
step_pin: {step}
dir_pin: {dir}
enable_pin: {enable}
microsteps: 16
rotation_distance: 40
endstop_pin: {endstop}
position_endstop: 0
position_max: 200
"""
EXTRUDER = """\
[extruder]
step_pin: {step}
dir_pin: {dir}
enable_pin: {enable}
microsteps: 16
rotation_distance: 33.5
nozzle_diameter: 0.4
filament_diameter: 1.75
heater_pin: {heater}
sensor_type: EPCOS 100K B57560G104F
sensor_pin: {sensor}
control: watermark
min_temp: 0
max_temp: 250
"""
WITH_SOCKETS = [
    name for name in config.shipped_boards() if len(config.load_board(name).sockets) >= 4
]


def printer_cfg(board: Board) -> str:
    """A printer on the sockets of a board, with heater and sensor on whatever it has first."""
    pins = [
        {"step": board.pin(s.step), "dir": board.pin(s.direction), "enable": board.pin(s.enable)}
        for s in board.sockets.values()
    ]
    switches = [bare(board.pin(name)) for name in board.endstops]
    text = HEAD
    for axis, motor, switch in zip("xyz", pins, switches, strict=False):
        text += AXIS.format(axis=axis, endstop=switch, **motor)
    heater, sensor = next(iter(board.outputs)), next(iter(board.thermistors))
    text += EXTRUDER.format(heater=board.pin(heater), sensor=board.pin(sensor), **pins[3])
    return f"{text}[mcu]\nserial: /dev/ttyACM0\n"


def motors(board: Board) -> list[tuple[str, str, str]]:
    """The pins of the first four sockets."""
    return [(s.step, s.direction, s.enable) for s in board.sockets.values()][:4]


@pytest.mark.parametrize("name", WITH_SOCKETS)
def test_every_shipped_board_is_known_by_its_pins(tmp_path: Path, name: str) -> None:
    path, board = tmp_path / "printer.cfg", config.load_board(name)
    path.write_text(printer_cfg(board))
    found = config.load_text(imported(path).text(""), "x.toml").board
    assert (motors(found), found.is_klippers) == (motors(board), True)
    path.write_text(f"# {name}\n{printer_cfg(board)}")
    assert config.load_text(imported(path).text(""), "x.toml").board.base == name


def test_similar_boards_are_distinguished_by_driver_wiring(tmp_path: Path) -> None:
    path = tmp_path / "printer.cfg"
    for name in ("skr-1.3", "skr-1.4"):
        board = config.load_board(name)
        driver = f"[tmc2209 stepper_x]\nuart_pin: {board.sockets['X'].uart}\nrun_current: 0.8\n"
        path.write_text(f"{printer_cfg(board)}{driver}")
        assert config.load_text(imported(path).text(""), "x.toml").board.base == name


def test_board_with_a_wrong_motor_is_unknown(tmp_path: Path) -> None:
    path, board = tmp_path / "printer.cfg", config.load_board("octopus")
    text = printer_cfg(board)
    socket = board.sockets["MOTOR1"]
    path.write_text(text.replace(socket.direction, "PH7"))
    assert config.load_text(imported(path).text(""), "x.toml").board.base == "klipper"


@pytest.mark.parametrize(
    ("port", "clock_hz", "moves"),
    [
        ("usb-Klipper_stm32h723xx_12-if00", 400_000_000, 1024),
        ("usb-Klipper_rp2040_12-if00", 12_000_000, 1024),
        ("usb-1a86_USB_Serial-if00-port0", 16_000_000, 256),
    ],
)
def test_unknown_board_has_the_chip_of_its_port(
    tmp_path: Path, port: str, clock_hz: int, moves: int, capsys: pytest.CaptureFixture[str]
) -> None:
    path, mine = tmp_path / "printer.cfg", tmp_path / "mine.toml"
    text = printer_cfg(config.load_board("octopus")).replace("PF12", "PH7")
    path.write_text(text.replace("ttyACM0", f"serial/by-id/{port}"))
    mine.write_text(imported(path).text(""))
    board = config.load(mine).board
    assert (board.base, board.clock_hz, board.move_count) == ("klipper", clock_hz, moves)
    assert main(["check", str(mine)]) == 0
    assert ("up to 25 µs" in capsys.readouterr().out) == (moves < 1024)


def test_pins_named_gpio_are_those_of_an_rp2040(tmp_path: Path) -> None:
    path, text = tmp_path / "printer.cfg", printer_cfg(config.load_board("octopus"))
    for number, pin in enumerate(dict.fromkeys(re.findall(r"P[A-G]\d+", text))):
        text = re.sub(rf"{pin}\b", f"gpio{number}", text)
    path.write_text(text)
    board = config.load_text(imported(path).text(""), "x.toml").board
    assert (board.base, board.clock_hz, board.move_count) == ("klipper", 12_000_000, 1024)
