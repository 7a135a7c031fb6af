"""Files on the SD card: list, print, upload, delete. The texts are Marlin's, which hosts parse."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from passo.console.session import Session
from passo.console.upload import Upload
from passo.errors import CardError, CommandError, PassoError
from passo.gcode.command import Command, unescaped
from passo.gcode.parameters import flag, ignored, integer, number, rest, text
from passo.gcode.registry import Kind, Subject, When, command
from passo.job.live.job_state import JobState
from passo.printer.unfit_commands import ALL
from passo.printer.wait_requests import Reply, Wait, WaitForMoves
from passo.services.jobs import Jobs

if TYPE_CHECKING:
    from passo.printer.control import Control


_Action = Callable[["CardCommands", Command, Reply], None]


def _guarded(action: _Action) -> Callable[[CardCommands, Command, Reply], None]:
    """Makes a handler from an action. A failure, also of the card, is reported to the console."""

    def handler(self: CardCommands, command: Command, reply: Reply) -> None:
        try:
            action(self, command, reply)
        except PassoError as error:
            if command.code in ("M23", "M32"):
                name = _unquoted(command.text)
                reply.fail(f"file.open failed, File: {name}. {error}", error.problems)
            else:
                reply.fail(str(error), error.problems)

    return handler


class CardCommands:
    """M20 to M36, M524, M928, and Klipper's commands for prints."""

    def __init__(self, control: Control, jobs: Jobs) -> None:
        self._rig, self._state = control.rig, control.state
        self._runner, self._files = jobs.runner, jobs.files
        self._directory = PurePosixPath("/")

    # -- the card ---------------------------------------------------------------------------------

    @command(
        "M21",
        Subject.CARD,
        When.IMMEDIATE,
        "Mounts the SD card.",
        kind=Kind.QUIET,
    )
    @_guarded
    def _mount(self, _: Command, reply: Reply) -> None:
        if not (self._files.mounted and self._runner.engaged):
            self._files.mount()
            self._directory = PurePosixPath("/")
        reply.say("SD card ok")

    @command(
        "M22",
        Subject.CARD,
        When.IMMEDIATE,
        "Releases the SD card.",
        kind=Kind.SERVED,
        not_in_files=True,
    )
    @_guarded
    def _release(self, _: Command, reply: Reply) -> None:
        self._files.release()
        self._directory = PurePosixPath("/")
        reply.say("SD card released")

    # -- names ------------------------------------------------------------------------------------

    def _place(self, name: str) -> str:
        return str(self._directory / name)

    def _existing(self, text: str) -> str:
        """The path that a command names. The whole text is tried first, and then the text after a
        capital F."""
        name = _unquoted(text)
        if not name:
            raise CommandError.of("card.no-name")
        try:
            self._files.card.find(self._place(name))
        except CardError:
            inner = unescaped(name[1:]) if name[:1] == "F" else ""
            if not inner or not self._files.there(self._place(inner)):
                raise
            name = inner
        return self._place(name)

    # -- commands ---------------------------------------------------------------------------------

    @command(
        "M20",
        Subject.CARD,
        When.IMMEDIATE,
        "Lists the programs on the SD card, with long names (L) and times (T); D lists one"
        " directory.",
        rest("L T, D(directory)", "L: long names, T: times, D: one directory"),
        kind=Kind.QUIET,
    )
    @_guarded
    def _list(self, command: Command, reply: Reply) -> None:
        text = command.text
        if text[:1].upper() == "D":
            directory = self._place(unescaped(text[1:]))
            for entry in self._files.card.list(directory):
                reply.say(f"{'d' if entry.is_directory else 'f'} {entry.name}")
            return
        flags, programs = text.upper().split(), self._files.programs()
        reply.say("Begin file list")
        for directory, entry in programs:
            line = f"{directory}{entry.short_name} {entry.size}"
            if "T" in flags:
                line += f" 0x{entry.fat_timestamp:08X}"
            if "L" in flags:
                line += f' "{entry.name}"'
            reply.say(line)
        reply.say("End file list")

    @command(
        "M23",
        Subject.CARD,
        When.IMMEDIATE,
        "Selects a file to print. D and R select the directory that names count from.",
        rest("name, or F(file) D(directory) R", "the file, or the directory that names count from"),
        kind=Kind.SERVED,
        not_in_files=True,
    )
    @_guarded
    def _choose(self, command: Command, reply: Reply) -> None:
        self._select(command.text, reply)

    def _select(self, text: str, reply: Reply) -> bool:
        """Selects a file, or changes the directory; returns True for a file."""
        letter, rest = text[:1].upper(), unescaped(text[1:])
        try:
            path = self._existing(text)
        except CardError:
            if letter == "R" and not rest:
                self._directory = PurePosixPath("/")
                return False
            if letter != "D":
                raise
            self._files.card.list(self._place(rest))
            self._directory = self._directory / rest
            return False
        self._files.open(path)
        reply.say(f"File opened: {self._runner.name} Size: {self._runner.size}")
        reply.say("File selected")
        return True

    @command(
        "M32",
        Subject.CARD,
        When.IMMEDIATE,
        "Selects a file and prints it.",
        rest("name", "the file"),
        kind=Kind.SERVED,
        not_in_files=True,
    )
    @_guarded
    def _select_and_start(self, command: Command, reply: Reply) -> None:
        if self._select(command.text, reply):  # a directory cannot be printed
            self._runner.start()

    @command(
        "M24",
        Subject.CARD,
        When.IMMEDIATE,
        "Starts the selected file, or resumes after a pause. U1 also starts a file with unknown"
        " commands that may move the machine, or with bed levelling.",
        integer("S", "the byte at which the print begins", 0),
        flag("U", "also a file that is refused otherwise"),
        ignored("T"),
        kind=Kind.SERVED,
        not_in_files=True,
    )
    @_guarded
    def _start(self, command: Command, _: Reply) -> None:
        if self._rig.job.stops.suspended and not self._runner.active:
            return  # a host's print is suspended, so no other print may start
        if command.has("S") and self._runner.state is not JobState.PAUSED:
            self._runner.seek(command.integer("S"))
        self._runner.start(skips=ALL if command.flag("U") else None)

    @command(
        "PAUSE",
        Subject.PRINTS,
        When.IMMEDIATE,
        "Pauses the print, as M25. As the command that a macro PAUSE has renamed, it moves nothing:"
        " the macro parks the nozzle.",
        kind=Kind.USER,
        in_turn=True,
    )
    @_guarded
    def _pause_by_name(self, _: Command, reply: Reply) -> None:
        replaced = "PAUSE" in self._rig.machine.macro_names
        self._runner.pause(by_file=self._runner.printing_from(reply), by_macro=replaced)

    @command(
        "M25",
        Subject.CARD,
        When.IMMEDIATE,
        "Pauses the print: brakes on the path, and parks.",
        kind=Kind.USER,
        in_turn=True,
    )
    @_guarded
    def _pause(self, _: Command, reply: Reply) -> None:
        self._runner.pause(by_file=self._runner.printing_from(reply))

    @command(
        "RESUME",
        Subject.PRINTS,
        When.IMMEDIATE,
        "Ends a pause, as M24.",
        kind=Kind.SERVED,
    )
    @_guarded
    def _resume(self, _: Command, reply: Reply) -> None:
        """Resumes a print that is paused or has failed at a line. Without one, it does nothing, as
        in Klipper."""
        if self._runner.state in (JobState.PAUSED, JobState.FAILED):
            self._runner.start()
        else:
            reply.say("echo:No print is paused, so none is resumed")

    @command(
        "SDCARD_PRINT_FILE",
        Subject.PRINTS,
        When.IMMEDIATE,
        "Selects a file by its path on the card, and prints it.",
        text("FILENAME", "the path on the card"),
        kind=Kind.SERVED,
        not_in_files=True,
    )
    @_guarded
    def _print_file(self, command: Command, reply: Reply) -> None:
        """Prints a file; the path starts at the card's root."""
        name = command.string("FILENAME")
        if not name:
            raise CommandError.of("card.no-name")
        self._files.open(str(PurePosixPath("/") / name))
        reply.say(f"File opened: {self._runner.name} Size: {self._runner.size}")
        self._runner.start()

    @command(
        "SDCARD_RESET_FILE",
        Subject.PRINTS,
        When.IMMEDIATE,
        "No file is selected any more.",
        kind=Kind.SERVED,
        not_in_files=True,
    )
    @_guarded
    def _forget_file(self, _: Command, __: Reply) -> None:
        self._runner.release()

    @command(
        "SDCARD_LOOP_DESIST",
        Subject.PRINTS,
        When.IMMEDIATE,
        "Ends the loops of the file that is printed, after their present round.",
        kind=Kind.SERVED,
        not_in_files=True,
    )
    @_guarded
    def _desist(self, _: Command, __: Reply) -> None:
        self._runner.file.loops.desist()

    @command(
        "M26",
        Subject.CARD,
        When.IMMEDIATE,
        "Sets the byte at which the next start begins; in a pause S0 cancels the print.",
        integer("S", "the byte", 0, default=0),
        ignored("T"),
        kind=Kind.SERVED,
        not_in_files=True,
    )
    @_guarded
    def _seek(self, command: Command, _: Reply) -> None:
        offset = command.integer("S")
        if self._runner.state is JobState.PAUSED and offset == 0:
            self._runner.cancel()  # hosts cancel with M25 and M26 S0
            return
        self._runner.seek(offset)

    @command(
        "M27",
        Subject.CARD,
        When.IMMEDIATE,
        "Reports the progress of the print, with S every S seconds; C reports the name of the"
        " file.",
        flag("C", "the name of the file"),
        number("S", "how often; 0: no more", "s"),
        kind=Kind.QUIET,
    )
    @_guarded
    def _progress(self, command: Command, reply: Reply) -> None:
        every_s = command.value("S", None)
        if command.flag("C"):
            name = self._runner.name
            reply.say(f"Current file: {name}" if name else "Current file: (no file)")
        elif every_s is not None and isinstance(reply, Session):
            reply.report_every("card", every_s, lambda: reply.hear(self.progress()))
        else:
            reply.say(self.progress())

    def progress(self) -> str:
        """The progress in the text that hosts parse."""
        if not self._runner.active or self._state.halted:
            return "Not SD printing"
        return f"SD printing byte {self._runner.offset}/{self._runner.size}"

    @command(
        "M28",
        Subject.CARD,
        When.IMMEDIATE,
        "Writes the lines that follow into a file, until M29.",
        rest("name", "the file"),
        kind=Kind.SERVED,
        not_in_files=True,
    )
    @_guarded
    def _upload(self, command: Command, reply: Reply) -> None:
        self._begin_writing(command.text, reply, log=False)

    @command(
        "M928",
        Subject.CARD,
        When.IMMEDIATE,
        "Writes the lines that follow into a file as M28, and carries them out as well.",
        rest("name", "the file"),
        kind=Kind.SERVED,
        not_in_files=True,
    )
    @_guarded
    def _log(self, command: Command, reply: Reply) -> None:
        self._begin_writing(command.text, reply, log=True)

    def _begin_writing(self, text: str, reply: Reply, *, log: bool) -> None:
        if not isinstance(reply, Session):
            raise CommandError.of("card.no-console")
        # only the letter, without a name
        name = "" if text.strip().upper() == "F" else _unquoted(text)
        if reply.upload is not None and reply.upload.writer is not None:
            raise CardError.of("card.busy", reply.upload.name, value="it is being written")
        upload = Upload(None, name, log=log)
        if not log:
            # set it first: even after an error, the next lines must not be executed
            reply.upload = upload
        if not name:
            raise CommandError.of("card.no-name")
        upload.name = self._new_name(name)
        path = self._place(upload.name)
        upload.writer = self._files.create(path)
        reply.upload = upload
        reply.say(f"Writing to file: {upload.name}")

    def _new_name(self, name: str) -> str:
        """The name for a new file, by the rule of `_existing`: that of a file that is there, else
        the text after a capital F."""
        if name[:1] != "F" or len(name) == 1 or self._files.there(self._place(name)):
            return name
        return unescaped(name[1:])

    @command(
        "M29",
        Subject.CARD,
        When.IMMEDIATE,
        "Ends the file that is written, and stores it on the SD card.",
        rest(),
        kind=Kind.SERVED,
    )
    @_guarded
    def _end_upload(self, _: Command, reply: Reply) -> None:
        if not isinstance(reply, Session) or reply.upload is None:
            return
        upload, reply.upload = reply.upload, None
        try:
            if upload.finish():
                reply.say("Done saving file.")
        except CardError as error:
            reply.fail(f"error writing to file {upload.name}: {error}", error.problems)

    @command(
        "M30",
        Subject.CARD,
        When.IMMEDIATE,
        "Deletes a file. In a program it ends the program.",
        rest("name", "the file"),
    )
    @_guarded
    def _delete(self, command: Command, reply: Reply) -> None:
        if self._runner.printing_from(reply):
            self._rig.commands.ended = True  # in a program, M30 ends it
            return
        try:
            path = self._existing(command.text)
            self._files.remove(path)
        except CardError as error:
            reply.fail(f"Deletion failed, File: {_unquoted(command.text)}. {error}", error.problems)
            return
        reply.say(f"File deleted:{path.removeprefix('/')}")

    @command(
        "M33",
        Subject.CARD,
        When.IMMEDIATE,
        "Reports the long name of a file; without a name it cancels the print.",
        rest("name", "the file"),
        kind=Kind.QUIET,
    )
    @_guarded
    def _long_name(self, command: Command, reply: Reply) -> None:
        if not command.text.strip():
            self._runner.cancel()
            return
        path = PurePosixPath(self._existing(command.text))
        parts = ["/"]
        for part in path.parts[1:]:
            parts.append(self._files.card.find(str(PurePosixPath(*parts, part))).name)
        reply.say(str(PurePosixPath(*parts)))

    @command(
        "M34",
        Subject.CARD,
        When.IMMEDIATE,
        "Reports that files are always sorted by name.",
        rest(),
        kind=Kind.QUIET,
    )
    @_guarded
    def _no_sorting(self, _: Command, reply: Reply) -> None:
        reply.say("echo:Files are always listed by name")

    @command(
        "M36",
        Subject.CARD,
        When.IMMEDIATE,
        "Reports size and time of a file.",
        rest("name", "the file"),
        kind=Kind.QUIET,
    )
    @_guarded
    def _info(self, command: Command, reply: Reply) -> None:
        path = self._existing(command.text) if command.text.strip() else self._runner.path
        if not path:
            raise CommandError.of("job.no-file")
        entry = self._files.card.find(path)
        reply.say(
            f"File: {entry.name} Short: {entry.short_name} Size: {entry.size}"
            f" Modified: {entry.modified:%Y-%m-%d %H:%M:%S}"
        )

    @command(
        "CANCEL_PRINT",
        Subject.PRINTS,
        When.IMMEDIATE,
        "Cancels the print, as M524. As the command that a macro CANCEL_PRINT has renamed, it waits"
        " until the moves of the macro are done.",
        kind=Kind.SERVED,
        in_turn=True,
    )
    def _cancel_by_name(self, _: Command, reply: Reply) -> Wait | None:
        replaced = "CANCEL_PRINT" in self._rig.machine.macro_names and self._runner.active
        if replaced and not self._runner.printing_from(reply):
            return WaitForMoves(self._runner.cancel)
        self._runner.cancel()  # a command of the file comes after its moves
        return None

    @command(
        "M524",
        Subject.PRINTS,
        When.IMMEDIATE,
        "Cancels the print.",
        kind=Kind.SERVED,
        in_turn=True,
    )
    @_guarded
    def _cancel(self, _: Command, __: Reply) -> None:
        self._runner.cancel()


def _unquoted(text: str) -> str:
    name = text.strip(" \t")
    return name[1:-1] if len(name) > 1 and name[0] == name[-1] == '"' else name
