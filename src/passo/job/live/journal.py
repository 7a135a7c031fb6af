"""The journal of a print: the state needed to resume it after a crash or power loss."""

from __future__ import annotations

import json
import os
import re
import zlib
from contextlib import suppress
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, Self, cast

from passo.job.durable_files import fsync_directory, replaced
from passo.motion.axis_slots import slot_of_axis

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig
    from passo.job.live.reader import Reader
    from passo.printer.control import Control
    from passo.printer.settings import Settings

_HEAD_BYTES = 1 << 16  # beginning of the file, to recognise it
_LONGEST = 1 << 16  # maximum bytes of a record
_CHANGE = "change"  # key of a record of a change
# Settings that change the meaning of a program; those of heaters, drivers and timeouts do not.
_MEANING = re.compile(
    "(?:M(?:92|20[0-9]|218|302|603)|SET_(?:VELOCITY_LIMIT|INPUT_SHAPER|PRESSURE_ADVANCE)) "
)


Change = tuple[int, list[str]]  # bytes of the file, and the commands that apply after them


def meaning(settings: Settings) -> list[str]:
    """Commands for the settings of the printer that change the meaning of a program."""
    return [line for line in settings.lines() if _MEANING.match(line)]


def crc_of_macros(machine: MachineConfig) -> int:
    """A checksum of the macros of a machine file; 0 without macros."""
    crc = 0
    for name, macro in sorted(machine.macros.items()):
        crc = zlib.crc32(f"{name}\0{macro.model_dump_json()}\0".encode(), crc)
    return crc


@dataclass(frozen=True, slots=True)
class Program:
    """The file that is being printed: its path on the card, and marks to recognise it. It also has
    the state at the start of the print: commands for the `settings` and the `modes` of the printer,
    the machine positions of all axes, the offset of the active tool and whether it is applied, the
    program positions including E, and the axes, by number, that were not homed. `changes` are the
    later changes of settings and modes by consoles, each with the number of bytes of the file that
    were read before it. `macros` is the `crc_of_macros` of the machine. `allow` are the fields of
    Skips that were allowed for this print; `run` is its run id, or empty."""

    machine: str
    path: str
    size: int
    crc: int
    settings: list[str] = field(default_factory=list[str], compare=False)
    modes: list[str] = field(default_factory=list[str], compare=False)
    machine_mm: list[float] = field(default_factory=list[float], compare=False)
    program_mm: list[float] = field(default_factory=list[float], compare=False)
    unhomed: list[int] = field(default_factory=list[int], compare=False)
    changes: list[Change] = field(default_factory=list[Change], compare=False)
    macros: int = field(default=0, compare=False)
    allow: list[str] = field(default_factory=list[str], compare=False)
    run: str = field(default="", compare=False)

    @classmethod
    def of(cls, machine: str, path: str, reader: Reader) -> Self:
        """The program of `reader`, which is at its beginning afterwards. Raises CardError."""
        reader.seek(0)
        crc, left = 0, _HEAD_BYTES
        while left and (piece := reader.read(left)):
            crc, left = zlib.crc32(piece, crc), left - len(piece)
        reader.seek(0)
        return cls(machine, path, reader.size, crc)

    def begun(self, control: Control, settings: Settings) -> Self:
        """A copy with the present state of the printer as start state."""
        job, axes = control.rig.job, len(control.machine.axes)
        due = [*job.tools.offset_due, *[0.0] * (axes - 3)]
        return replace(
            self,
            settings=meaning(settings),
            modes=job.modes.gcode.split("\n"),
            machine_mm=[job.machine_position[slot_of_axis(i)] + due[i] for i in range(axes)],
            program_mm=job.program_position,
            unhomed=job.locked_axes,
            macros=crc_of_macros(control.machine),
        )


@dataclass(frozen=True, slots=True)
class Moment:
    """The progress of a print at `print_s`: the line of the current move (0: no move yet), the Z of
    the machine, and the state that is not in the file. `babysteps_mm` are the babysteps that
    consoles have sent, by axis. `overrides` are the speed, flow and fan factors at the start of the
    print, with later changes by consoles (see Overrides)."""

    line: int
    print_s: float
    z_mm: float = 0.0
    targets_c: dict[str, float] = field(default_factory=dict[str, float])
    overrides: dict[str, tuple[int, float]] = field(default_factory=dict[str, tuple[int, float]])
    babysteps_mm: dict[str, float] = field(default_factory=dict[str, float])
    origins: dict[str, int] = field(default_factory=dict[str, int])  # see Positions.origins


class Journal:
    """One print's journal in a directory. Each line of the file has its own checksum, so that a
    line that was damaged by a power cut is ignored. Raises OSError."""

    def __init__(self, directory: Path) -> None:
        self.path = directory / "journal"
        self._file: IO[bytes] | None = None

    @property
    def open(self) -> bool:
        """Whether a print is being recorded."""
        return self._file is not None

    def begin(self, program: Program, moment: Moment) -> None:
        """Call this when a print begins or resumes: replaces the previous record at once. Durable
        when it returns. If it raises, no print can be resumed, because the previous print has
        ended."""
        self.leave()
        file: IO[bytes] | None = None
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            with replaced(self.path) as new:
                file = new.open("wb")  # write on under the final name
                file.write(_line(asdict(replace(program, changes=[]))))
                file.writelines(_line({_CHANGE: change}) for change in program.changes)
                file.write(_line(asdict(moment)))
                file.flush()
        except OSError:
            if file is not None:
                _close(file)
            self.end()
            raise
        self._file = file

    def record(self, moment: Moment) -> None:
        """Records a moment. Durable when it returns."""
        self._append(asdict(moment))

    def record_change(self, change: Change) -> None:
        """Records a change by a console. Durable when it returns."""
        self._append({_CHANGE: change})

    def _append(self, content: dict[str, Any]) -> None:
        assert self._file is not None
        self._file.write(_line(content))
        self._file.flush()
        os.fsync(self._file.fileno())

    def end(self) -> None:
        """Call this at the end of a print: removes the record. Durable when it returns."""
        self.leave()
        if self.path.exists():
            self.path.unlink()
            fsync_directory(self.path.parent)

    def leave(self) -> None:
        """Stops recording, and keeps the record on disk."""
        if self._file is not None:
            _close(self._file)
            self._file = None

    def read(self) -> tuple[Program, Moment] | None:
        """The interrupted print and its last moment; None if there is no readable record."""
        program: Program | None = None
        moment: Moment | None = None
        try:
            with self.path.open("rb") as file:
                while content := _checked(file.readline(_LONGEST)):
                    if program is None:
                        program = Program(**content)
                    elif _CHANGE in content:
                        offset, lines = content[_CHANGE]
                        program.changes.append((int(offset), [str(line) for line in lines]))
                    else:
                        moment = Moment(**content)
                        tuples = {n: (int(at), v) for n, (at, v) in moment.overrides.items()}
                        moment = replace(moment, overrides=tuples)
        except (OSError, TypeError, ValueError, AttributeError):
            pass  # the record before the damage is valid
        return (program, moment) if program and moment else None


def _line(content: dict[str, Any]) -> bytes:
    text = json.dumps(content, separators=(",", ":")).encode()
    return b"%08x %s\n" % (zlib.crc32(text), text)


def _close(file: IO[bytes]) -> None:
    """Closes the file. Errors are ignored here, because the write that failed has reported them."""
    with suppress(OSError):
        file.close()


def _checked(line: bytes) -> dict[str, Any] | None:
    """The content of a line; None if its checksum is wrong or its content is invalid."""
    crc, _, text = line.removesuffix(b"\n").partition(b" ")
    try:
        if int(crc, 16) != zlib.crc32(text):
            return None
        content = json.loads(text)
    except ValueError:
        return None
    return cast("dict[str, Any]", content) if isinstance(content, dict) else None
