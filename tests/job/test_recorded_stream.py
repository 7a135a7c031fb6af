"""The laboratory measures a stream of Klipper's batch mode like a print of Passo: here a stream of
the steps of such a print."""

import json
import zlib

import pytest
from tests.job.test_laboratory import L_SHAPE

from passo import _core, config
from passo.errors import InputError
from passo.job.batch.laboratory import run_laboratory
from passo.job.batch.motion_setting import Setting
from passo.job.batch.quality_watch import QualityWatch
from passo.job.batch.recorded_stream import RecordedStream
from passo.job.batch.simulated_print import Print

_I3 = config.load("i3")
COMMANDS = {
    "config_stepper oid=%c step_pin=%c dir_pin=%c invert_step=%c step_pulse_ticks=%u": 5,
    "set_next_step_dir oid=%c dir=%c": 6,
    "queue_step oid=%c interval=%u count=%hu add=%hi": 7,
    "reset_step_clock oid=%c clock=%u": 8,
}
DICTIONARY = {
    "commands": COMMANDS,
    "responses": {},
    "enumerations": {},
    "config": {"CLOCK_FREQ": 16_000_000},
}
_FORMATS = _core.Formats([(number, text) for text, number in COMMANDS.items()])
_MOTORS = ("x", "y", "z", "e")


class Recorder:
    """Encodes messages in frames."""

    def __init__(self):
        self.data, self._count = b"", 0

    def send(self, name, *values):
        self.data += _core.make_frame(_FORMATS.encode(name, list(values)), self._count)
        self._count += 1


def recorded(machine, path, folder, homing=0, inverted="y"):
    """The stream of a print, with steps in advance as of homing; `inverted` motors turn the other
    way. Returns its file, and the quality of the print itself."""
    job = Print(machine)
    for name in _MOTORS:
        job.board.trace_steps(name, 0, 2**62)
    watch = QualityWatch(machine, job)
    job.watch_steps(watch)
    job._watch_first_layer = lambda: None  # it would take the traced steps
    result = job.run(path)
    made = Recorder()
    for oid in range(len(_MOTORS)):
        made.send("config_stepper", oid, 10 + oid, 20 + oid, 0, 32)
    if homing:
        made.send("set_next_step_dir", 0, 0)
        made.send("queue_step", 0, 8000, homing, 0)
    for oid, name in enumerate(_MOTORS):
        before, clock = 0, None
        for start, interval, count, add, direction in job.board.take_commands(name):
            if start != clock:
                made.send("reset_step_clock", oid, start % 2**32)
            if direction != before:
                before = direction
                made.send("set_next_step_dir", oid, int((direction > 0) != (name in inverted)))
            made.send("queue_step", oid, interval, count, add)
            clock = start + interval * count + add * count * (count - 1) // 2
    stream = folder / "klipper.serial"
    stream.write_bytes(made.data)
    (folder / "klipper.dict").write_text(json.dumps(DICTIONARY))
    return stream, watch.measurement(result).quality, result


@pytest.fixture
def corner(tmp_path):
    path = tmp_path / "corner.gcode"
    path.write_text(L_SHAPE)
    return path


def test_stream_has_the_quality_of_its_print(corner, tmp_path):
    shaped = Setting("mzv", advance=True).on(_I3)
    stream, wanted, result = recorded(shaped, corner, tmp_path, homing=3000)
    trial = run_laboratory(_I3, corner, compared=RecordedStream(stream)).trials[-1]
    assert trial.name == "klipper.serial"
    assert trial.quality.corners == wanted.corners
    for name in ("ringing_rms_um", "rounding_um", "off_path_um", "width_error", "printed_mm"):
        assert getattr(trial.quality, name) == pytest.approx(getattr(wanted, name), rel=0.02)
    assert trial.print_time_s == pytest.approx(result.move_time_s, abs=0.05)
    assert trial.steps == sum(result.steps.values())
    assert trial.commands == result.queue_step_commands


def test_dictionary_may_be_compressed_and_have_another_name(corner, tmp_path):
    stream, _, _ = recorded(_I3, corner, tmp_path)
    packed = tmp_path / "other"
    packed.write_bytes(zlib.compress((tmp_path / "klipper.dict").read_bytes()))
    assert RecordedStream(stream, packed).name == str(stream)


def refused(stream, dictionary=None):
    with pytest.raises(InputError) as error:
        RecordedStream(stream, dictionary)
    return str(error.value)


def test_invalid_stream_is_refused_with_its_reason(corner, tmp_path):
    stream, _, _ = recorded(_I3, corner, tmp_path)
    whole = stream.read_bytes()
    assert "cannot be read" in refused(stream, tmp_path / "none.dict")
    assert "is not the data dictionary of a board" in refused(stream, corner)
    stream.write_bytes(corner.read_bytes())
    assert "it has no frames" in refused(stream)
    stream.write_bytes(whole[:200] + b"?" + whole[201:])
    assert "pieces of it are no frames" in refused(stream)
    made = Recorder()
    made.send("queue_step", 3, 100, 1, 0)
    stream.write_bytes(made.data)
    assert "it moves a motor that it has not configured" in refused(stream)
    fewer = dict(list(COMMANDS.items())[:2])
    (tmp_path / "klipper.dict").write_text(json.dumps({**DICTIONARY, "commands": fewer}))
    stream.write_bytes(whole)
    assert "it has a command that the dictionary lacks" in refused(stream)


def test_stream_of_another_file_or_machine_is_refused(corner, tmp_path):
    stream, _, _ = recorded(_I3, corner, tmp_path)
    other = tmp_path / "other.gcode"
    other.write_text(L_SHAPE.replace("X80", "X40"))
    with pytest.raises(
        InputError, match=r"moves the motor x by \d+\.0 mm.* but the print moves it by 60\.0"
    ):
        run_laboratory(_I3, other, compared=RecordedStream(stream))
    with pytest.raises(InputError, match="moves 4 motors, but the machine has 5"):
        run_laboratory(config.load("dual-extruder"), corner, compared=RecordedStream(stream))
