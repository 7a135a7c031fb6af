"""Accelerometers of the simulated printer, whose head and bed are masses on belts."""

from __future__ import annotations

import asyncio
import csv
import re
import sys
import tempfile
from pathlib import Path

import pytest
from tests.support.edited_machine import answers, at_home, edited
from tests.support.scenario import Host, Scenario

import passo
from passo.config.machine import MachineConfig
from passo.gcode.registry import table
from passo.printer.setup.simulated_world import head_dynamics

SPI = 'cs_pin = "D40"\nclock_pin = "D42"\nmosi_pin = "D59"\nmiso_pin = "D64"'
I2C = 'scl_pin = "D40"\nsda_pin = "D42"\ni2c_address = 0x18'


@pytest.fixture(autouse=True)
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of the written files."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    return tmp_path


def machine(
    x_hz: float,
    y_hz: float,
    *,
    chip: str = "adxl345",
    pins: str = SPI,
    firmware: str = "virtual",
    rate: str = "",
) -> MachineConfig:
    """An i3 whose axes vibrate at these frequencies."""
    masses = "".join(
        f"[simulated.masses.{axis}]\nfrequency_hz = {hz}\ndamping = 0.1\n"
        for axis, hz in (("x", x_hz), ("y", y_hz))
    )
    board = ('base = "ramps"', f'base = "ramps"\nfirmware = "{firmware}"')
    return edited("i3", board, more=f'[accelerometer]\nchip = "{chip}"\n{rate}\n{pins}\n{masses}')


def shapers(s: Scenario) -> dict[str, tuple[str, float]]:
    """The shapers in use, by axis."""
    status = s.printer.rig.commands.filters.shaper_status()
    return {axis: (one.type, one.frequency_hz) for axis, one in status.items()}


def peak(file: Path) -> tuple[float, float]:
    """Frequency and density of the highest row of a spectrum."""
    rows = list(csv.reader(file.read_text().splitlines()))[1:]
    return max(((float(row[0]), float(row[4])) for row in rows), key=lambda row: row[1])


def ringing_um(s: Scenario, line: str, axis: int) -> float:
    """The amplitude of the vibration of an axis when a move has ended, um."""
    head = head_dynamics(s.machine, s.printer.board)
    head.follow(True)
    clock = s.printer.rig.connection.now
    s.host.ok(line)
    s.host.ok("M400")
    seen: list[tuple[float, float]] = []
    while clock < s.printer.rig.connection.now:
        clock += s.printer.rig.queue.hz // 1000
        head.run(clock)
        seen.append((clock, head.ringing[axis]))
    return 1000 * next(amplitude for at, amplitude in seen if at >= head.last_step)


def test_calibration_finds_the_shapers_that_end_the_ringing(files: Path) -> None:
    with at_home(machine(50, 35)) as s:
        s.host.ok("G1 X100 Y100 Z20 F6000")
        s.host.ok("M204 P3000 T3000")
        before = [ringing_um(s, "G1 X120 F6000", 0), ringing_um(s, "G1 Y120 F6000", 1)]
        line = "SHAPER_CALIBRATE FREQ_START=28 FREQ_END=57 HZ_PER_SEC=2 NAME=one"
        said = answers(s, line)
        found = shapers(s)
        assert found["x"] == ("mzv", pytest.approx(50, abs=2))
        assert found["y"] == ("mzv", pytest.approx(35, abs=2))
        assert "// Recommended shaper_type_x = mzv, shaper_freq_x = 5" in "\n".join(said)
        assert any(text.startswith("// mzv at 50") and "zv cuts less" in text for text in said)
        s.host.ok("G1 X100 Y100 Z20 F6000")
        after = [ringing_um(s, "G1 X120 F6000", 0), ringing_um(s, "G1 Y120 F6000", 1)]
        assert all(least < 0.06 * most for least, most in zip(after, before, strict=True))
        line = "FREQ_START=48 FREQ_END=52 HZ_PER_SEC=2"
        answers(s, f"TEST_RESONANCES AXIS=X {line} NAME=bare")
        answers(s, f"TEST_RESONANCES AXIS=X {line} INPUT_SHAPING=1 NAME=shaped")
        bare, left = (peak(files / f"resonances_x_{name}.csv")[1] for name in ("bare", "shaped"))
        assert left < 0.02 * bare  # of power
        written = {path.name for path in files.iterdir()}
        assert written == {
            f"{stem}.{kind}"
            for stem in (
                *("calibration_data_x_one", "calibration_data_y_one"),
                *("resonances_x_bare", "resonances_x_shaped"),
            )
            for kind in ("csv", "svg")
        }
        head = (files / "calibration_data_x_one.csv").read_text().split(",")
        assert head[:6] == ["freq", "psd_x", "psd_y", "psd_z", "psd_xyz", "shapers:"]
        assert peak(files / "calibration_data_x_one.csv")[0] == pytest.approx(50, abs=2)


def test_another_frequency_shows_even_if_the_clock_of_the_chip_is_wrong(tmp_path: Path) -> None:
    state = tmp_path / "state"
    with at_home(machine(45, 38.5, rate="rate_hz = 1600"), state=str(state)) as s:
        s.printer.board.boards[""].accelerometers[0].rate_error = 0.04
        answers(s, "SHAPER_CALIBRATE FREQ_START=33 FREQ_END=50 HZ_PER_SEC=2 NAME=b U=1")
        found = shapers(s)
        assert found["x"] == ("mzv", pytest.approx(45, abs=1))
        assert found["y"] == ("mzv", pytest.approx(38.5, abs=1))
    with Scenario(machine(45, 38.5, rate="rate_hz = 1600"), state=str(state)) as s:
        assert shapers(s) == found  # U=1 has stored them


@pytest.mark.parametrize(("chip", "pins"), [("adxl345", SPI), ("lis2dw", SPI), ("lis2dw", I2C)])
def test_the_firmware_measures_as_the_model_of_the_board(chip: str, pins: str, files: Path) -> None:
    """At rest to the last bit; and what vibrates, and when."""
    with at_home(machine(50, 35, chip=chip, pins=pins)) as s:
        said = answers(s, "ACCELEROMETER_QUERY")
        x, y, z = (float(v) for v in said[0].partition(": ")[2].split(","))
        assert (x, y, z) == pytest.approx((0, 0, 9806), abs=250)
    with at_home(machine(50, 35, chip=chip, pins=pins, firmware="passo")) as s:
        assert answers(s, "ACCELEROMETER_QUERY") == said
        begun_s = s.printer.rig.queue.now_s
        answers(s, "TEST_RESONANCES AXIS=X OUTPUT=raw_data FREQ_START=48 FREQ_END=50 NAME=a")
        rows = list(csv.reader((files / "raw_data_x_a.csv").read_text().splitlines()))
    assert rows[0] == ["#time", "accel_x", "accel_y", "accel_z"]
    times = [float(row[0]) for row in rows[1:]]
    assert begun_s < times[0] < times[-1] < s.printer.rig.queue.now_s
    rate_hz = (len(times) - 1) / (times[-1] - times[0])
    assert rate_hz == pytest.approx(3200 if chip == "adxl345" else 1600, rel=1e-3)
    assert max(abs(float(row[1])) for row in rows[1:]) > 10_000
    assert max(abs(float(row[2])) for row in rows[1:]) < 300


@pytest.mark.parametrize(
    ("chip", "bus"),
    [
        ("adxl345", 'spi_bus = "spi2_PB2_PB11_PB10"\ncs_pin = "PB1"'),
        ("adxl345", 'spi_bus = "spidev0.0"'),
        ("lis2dw", 'i2c_bus = "i2c1"'),
    ],
)
def test_a_simulated_chip_answers_on_a_bus_of_the_chip(chip: str, bus: str) -> None:
    with at_home(machine(50, 35, chip=chip, pins=bus, firmware="klipper")) as s:
        said = answers(s, "ACCELEROMETER_QUERY")
        x, y, z = (float(v) for v in said[0].partition(": ")[2].split(","))
        assert (x, y, z) == pytest.approx((0, 0, 9806), abs=250)


def test_resonance_errors_are_reported(files: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with Scenario(machine(50, 35)) as s:
        chip = s.printer.board.boards[""].accelerometers[0]
        (text,) = answers(s, "TEST_RESONANCES AXIS=X")
        assert "axis X is not homed" in text
        s.host.ok("G28", 60)
        for point in ("1,2", "nan,1,2", "a"):
            (text,) = answers(s, f"SHAPER_CALIBRATE POINT={point}")
            assert "expected X,Y,Z in mm" in text
        (text,) = answers(s, "TEST_RESONANCES AXIS=Q")
        assert "AXIS is Q: expected X, Y, Z, or a direction such as 1,-1" in text
        *_, text = answers(s, "TEST_RESONANCES AXIS=X POINT=5,100,20")
        assert "the vibration along X needs" in text and "the axis ends at 0 mm" in text
        chip.plugged = False
        (text,) = answers(s, "ACCELEROMETER_QUERY")
        assert "the accelerometer ADXL345 at " in text and "does not answer" in text
        assert "Check that it is plugged in" in text
        chip.plugged = True
        (files / "numpy.py").write_text("raise RuntimeError('torn')")
        monkeypatch.setenv("PYTHONPATH", str(files))
        (text,) = answers(s, "MEASURE_AXES_NOISE")
        assert "the calculation of spectra failed: RuntimeError: torn" in text
        x, y, z = s.positions()["x"], s.positions()["y"], s.positions()["z"]
        s.host.send("TEST_RESONANCES AXIS=1,1 NAME=c")
        s.host.expect("Testing axis axis=0.707,0.707,0.000", 60)
        s.passes(5)
        s.host.send("M410")
        assert s.until(lambda: s.printer.rig.queue.standing, 2)
        s.host.expect("^ok")
        s.host.ok(f"G1 X{x:g} Y{y:g} Z{z:g} F6000")
        s.host.ok("M400")
        assert (s.positions()["x"], s.positions()["y"]) == pytest.approx((x, y), abs=0.02)
    with Scenario("i3") as s:
        (text,) = answers(s, "SHAPER_CALIBRATE")
        assert "no [accelerometer]" in text


def test_accelerometer_off_the_moved_part_is_detected() -> None:
    """The noise of a chip that lies on the table is no resonance."""
    with at_home(machine(50, 35)) as s:
        s.printer.board.boards[""].accelerometers[0].put_down()
        *_, text = answers(s, "SHAPER_CALIBRATE AXIS=X FREQ_START=30 FREQ_END=33 HZ_PER_SEC=2")
        assert "while its axis vibrated" in text and "Fix it to the part" in text
        assert shapers(s)["x"][1] == 0


@pytest.mark.parametrize("firmware", ["virtual", "passo"])
def test_unanswered_i2c_accelerometer_is_reported(firmware: str) -> None:
    with Scenario(machine(50, 35, chip="lis2dw", pins=I2C, firmware=firmware)) as s:
        chip = s.printer.board.boards[""].accelerometers[0]
        chip.plugged = False
        (text,) = answers(s, "ACCELEROMETER_QUERY")
        assert "LIS2DW at address 0x18 of PG1 and PL7 does not answer: START_NACK" in text
        assert "Check its cable, its supply, and i2c_address" in text
        chip.plugged = True
        for nacks, plugged, says in (
            (5, True, "accelerometer values (x, y, z): "),  # its FIFO keeps the samples
            (0, False, "does not answer: START_NACK"),
            (0, True, "accelerometer values (x, y, z): "),  # the board has not shut down
        ):
            s.host.send("ACCELEROMETER_QUERY")
            s.passes(0.2)
            chip.nacks, chip.plugged = nacks, plugged
            s.host.expect(re.escape(says), 5)
            s.host.expect("^ok")
            chip.plugged = True
        chip.rate_error = 19.0  # more samples than its FIFO holds until the board reads it
        (text,) = answers(s, "ACCELEROMETER_QUERY")
        assert "overflowed 200 times in 6400 samples, of at most 2%" in text
        assert "Lower rate_hz" in text


SWEEP = "FREQ_START=20 FREQ_END=40 HZ_PER_SEC=2"
SHAKING = [f"TEST_RESONANCES AXIS=X {SWEEP}", f"SHAPER_CALIBRATE {SWEEP}", "MEASURE_AXES_NOISE"]


@pytest.mark.parametrize("line", SHAKING)
def test_missing_package_is_reported_before_the_first_move(
    line: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    code = line.split()[0]
    with at_home(machine(50, 35)) as s:
        row = table()[code]
        assert s.printer.dispatch.has(row)
        monkeypatch.setitem(sys.modules, "numpy", None)
        assert not s.printer.dispatch.has(row)
        before_s, place = s.printer.rig.queue.now_s, s.positions()
        said = "\n".join(s.host.ok(line, 1))
        assert f"{code} needs the Python package numpy, which is not installed. Inst" in said
        assert s.printer.rig.queue.now_s - before_s < 1
        s.passes(1)
        assert s.positions() == place
        assert "accelerometer values" in "\n".join(answers(s, "ACCELEROMETER_QUERY"))


HEATERS = "SET_HEATER_TEMPERATURE HEATER={} TARGET={}"


@pytest.mark.parametrize("line", SHAKING)
def test_other_consoles_do_not_wait_for_a_measurement(line: str) -> None:
    with at_home(machine(50, 35)) as s:
        other = Host(s)
        s.host.send(line)
        s.passes(1)
        before_s = s.printer.rig.queue.now_s
        heaters = s.printer.rig.connection.heaters
        for code, heater, celsius in [
            ("M104 S60", "hotend", 60),
            ("M140 S40", "bed", 40),
            (HEATERS.format("extruder", 70), "hotend", 70),
            (HEATERS.format("heater_bed", 0), "bed", 0),
            ("TURN_OFF_HEATERS", "hotend", 0),
        ]:
            other.ok(code, 0.1)
            assert heaters[heater].target == celsius
        for code in ("M106 S128", "M105", "HELP", "STATUS", "M114", "M119", "M115"):
            other.ok(code, 0.1)
        assert s.printer.rig.commands.outputs.fans["part"] == pytest.approx(128 / 255)
        assert "HEATER is no: expected" in other.ok(HEATERS.format("no", 1), 0.1)[0]
        assert s.printer.rig.queue.now_s - before_s < 0.5
        s.host.expect("^ok", 60)


def test_scripts_of_clients_do_not_wait_for_a_measurement() -> None:
    async def main() -> None:
        async with passo.Printer(machine(50, 35)) as printer:
            bridge, loop = printer._bridge, asyncio.get_running_loop()
            await bridge.run("G28\nM400")
            shaking = asyncio.create_task(bridge.run(SHAKING[0]))
            await asyncio.sleep(1)
            began_s = loop.time()
            await bridge.run("M106 S128")
            await bridge.run("M104 S60\n" + HEATERS.format("heater_bed", 40))
            (report,) = await bridge.run("M105")
            assert "/60.00" in report and "/40.00" in report
            assert loop.time() - began_s < 0.5
            # these two are one program: the heater goes off after the move
            moves = asyncio.create_task(bridge.run("G1 X50 F6000\nM400"))
            await asyncio.sleep(0.1)
            off = asyncio.create_task(bridge.run("M104 S0"))
            await asyncio.sleep(1)
            assert not (shaking.done() or moves.done() or off.done())
            await off
            assert shaking.done() and moves.done()

    passo.run(main(), clock="virtual")
