"""Commands for progress and time of prints, pauses that a print requests, and filament changes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from passo.console.session import Session
from passo.errors import CommandError, PassoError
from passo.gcode.command import Command
from passo.gcode.parameters import TOOL, ignored, integer, number, rest
from passo.gcode.registry import Kind, Subject, When, command
from passo.job.live.job_state import JobState
from passo.job.live.park import check_words
from passo.job.live.slicer_layers import MAX_LAYERS
from passo.job.live.statistics import spoken
from passo.printer.wait_requests import Reply, Wait, WaitForProcedure
from passo.services.jobs import Jobs

if TYPE_CHECKING:
    from passo.printer.control import Control
    from passo.printer.inputs.buttons import Buttons


class JobCommands:
    """M31, M73, M75 to M77, M530 to M532, M600 to M602 of one printer."""

    def __init__(self, control: Control, buttons: Buttons, jobs: Jobs) -> None:
        self._control, self._runner, self._progress = control, jobs.runner, jobs.progress
        self._host_pause, self._buttons = jobs.host_pause, buttons
        control.state.go_on_listeners.append(self._end_asking)
        jobs.runner.watchers.append(self._job_changed)

    def _job_changed(self, was: JobState, state: JobState) -> None:
        if state is JobState.PAUSED:
            self._control.state.tell("// action:paused")
        elif was is JobState.PAUSED:
            self._control.prompts.answered()
            if state.prints:
                self._control.state.tell("// action:resumed")

    @command(
        "M31",
        Subject.PRINTS,
        When.IMMEDIATE,
        "Reports the print time.",
        kind=Kind.QUIET,
    )
    def _time(self, _: Command, reply: Reply) -> Wait | None:
        reply.say(f"echo:Print time {spoken(self._progress.printed_s)}")
        return None

    @command(
        "M75",
        Subject.PRINTS,
        When.IMMEDIATE,
        "Starts the print timer.",
        rest(),
        kind=Kind.QUIET,
    )
    def _start_timer(self, _: Command, __: Reply) -> None:
        self._progress.timer(runs=True)

    @command(
        "M76",
        Subject.PRINTS,
        When.IMMEDIATE,
        "Pauses the print timer.",
        rest(),
        kind=Kind.QUIET,
    )
    def _pause_timer(self, _: Command, __: Reply) -> None:
        self._progress.timer(runs=False)

    @command(
        "M77",
        Subject.PRINTS,
        When.IMMEDIATE,
        "Stops the print timer and reports it.",
        rest(),
        kind=Kind.QUIET,
    )
    def _stop_timer(self, _: Command, __: Reply) -> Wait | None:
        """Does nothing for a print from the card, whose timer does not depend on its file."""
        self._progress.timer(runs=False)
        self._control.state.tell(f"echo:Print time {spoken(self._progress.printed_s)}")
        self._progress.stop_timer()
        return None

    @command(
        "M530",
        Subject.PRINTS,
        When.IMMEDIATE,
        "Starts (S1) or ends (S0) the print of a host, for the print timer.",
        number("S", "1: it begins, 0: it ends", default=0),
        ignored("L"),
        kind=Kind.QUIET,
    )
    def _host_print(self, command: Command, reply: Reply) -> Wait | None:
        """A host reports that its print begins or ends."""
        begins = command.value("S") > 0
        self._progress.host_print(begins=begins)
        reply.say("echo:Start Printing" if begins else "echo:Stop Printing")
        return None

    @command(
        "M531",
        Subject.PRINTS,
        When.IMMEDIATE,
        "Sets the name of a host's print.",
        rest("name", "the name of the print"),
        kind=Kind.QUIET,
    )
    def _host_name(self, command: Command, _: Reply) -> Wait | None:
        self._progress.name_host_print(command.text.strip())
        return None

    @command(
        "M532",
        Subject.PRINTS,
        When.IMMEDIATE,
        "Sets the progress, as M73 P.",
        number("X", "the progress", "%", 0, 100, clamped=True),
        ignored("L"),
        kind=Kind.QUIET,
    )
    def _host_progress(self, command: Command, _: Reply) -> Wait | None:
        if (percent := command.value("X", None)) is not None:
            self._progress.percent = _percent(percent)
        return None

    @command(
        "SET_PRINT_STATS_INFO",
        Subject.PRINTS,
        When.IMMEDIATE,
        "Sets the layers that a slicer has counted, in place of those of the file.",
        integer("TOTAL_LAYER", "the number of layers; 0: unknown", 0, MAX_LAYERS),
        integer("CURRENT_LAYER", "the layer that is printed", 0, MAX_LAYERS),
        kind=Kind.QUIET,
    )
    def _tell_layers(self, command: Command, _: Reply) -> Wait | None:
        self._progress.slicer_layers.set(
            command.integer("TOTAL_LAYER", None), command.integer("CURRENT_LAYER", None)
        )
        return None

    @command(
        "M73",
        Subject.PRINTS,
        When.IMMEDIATE,
        "Sets the progress that a slicer has calculated; without parameters it reports the"
        " progress.",
        number("P", "the progress", "%", 0, 100, clamped=True, alone=True),
        number("R", "the time that is left", "min", 0, clamped=True, alone=True),
        ignored("Q S C D"),
        kind=Kind.QUIET,
    )
    def _tell_progress(self, command: Command, reply: Reply) -> Wait | None:
        percent, minutes = command.value("P", None), command.value("R", None)
        if percent is not None:
            self._progress.percent = _percent(percent)
        if minutes is not None:
            self._progress.minutes_left = max(minutes, 0.0)
        if percent is not None or minutes is not None:
            return None
        parts: list[str] = []
        times, share = self._progress.times(), self._progress.share_done()
        if share is not None:
            parts.append(f"{round(100 * share, 1):g}%")
        if times is not None:
            parts.append(f"{(times[1] - times[0]) / 60:.1f} min left")
        elif share is not None and self._progress.percent is None:
            parts[0] += " of the file"
        if self._progress.minutes_left is not None and times is None:
            parts.append(f"{self._progress.minutes_left:g} min left")
        reply.say(f"echo:Progress: {', '.join(parts) or 'nothing is printed'}")
        return None

    @command(
        "M600",
        Subject.FILAMENT,
        When.EXCLUSIVE,
        "Parks, waits for the user to change the filament, and returns. E retracts, Z raises the"
        " nozzle, X and Y are the position; U unloads there, L loads when the hotend has reached"
        " S. T must be the tool in use; B is not used.",
        TOOL,
        number("E", "how much is retracted", "mm"),
        number("Z", "how much the nozzle is raised", "mm"),
        number("X Y", "where the nozzle waits", "mm"),
        number("U", "how much is unloaded", "mm"),
        number("L", "how much is loaded", "mm"),
        number("S", "the temperature of the hotend", "°C"),
        number("B", "has no effect"),
        kind=Kind.USER,
    )
    def _change_filament(self, command: Command, reply: Reply) -> Wait | None:
        """M600. Raises CommandError for a tool that is not active, and for a temperature or a
        position that is out of reach."""
        words = command.words()
        check_words(words, self._control.machine)
        tool = self._control.rig.job.tool
        if words.get("T", tool) != tool:
            raise CommandError.bad_value("T", words["T"], f"{tool}, the tool in use")
        if "S" in words:
            hotend = self._control.machine.heaters[
                self._control.rig.commands.set_points.heater("hotend")
            ]
            if not hotend.min_c < words["S"] <= hotend.max_c:
                limit = f"{hotend.min_c:g} to {hotend.max_c:g} C"
                raise CommandError.bad_value("S", words["S"], limit)
        if "B" in words and self._control.machine.beeper is None:
            reply.note("M600 B", "M600 does not beep: there is no beeper")
        return self._stand_by("Change the filament, then continue with M108", words, reply)

    @command(
        "M601",
        Subject.PRINTS,
        When.EXCLUSIVE,
        "Parks, waits for the user, and returns.",
        kind=Kind.USER,
    )
    def _pause(self, _: Command, reply: Reply) -> Wait | None:
        by_file = self._runner.printing_from(reply)
        return self._stand_by("Paused; continue with M108", {}, reply, by_file=by_file)

    @command(
        "M226",
        Subject.STOPS,
        When.EXCLUSIVE,
        "Waits until button P, counted from 0 in the machine file, is pressed (S1, the default) or"
        " released (S0), or has the other state (S-1); M108 ends the wait. Without P it pauses, as"
        " M601.",
        integer("P", "the button", 0),
        integer("S", "1: pressed, 0: released, -1: the other state", -1, 1, default=1),
        kind=Kind.USER,
    )
    def _wait_for_button(self, command: Command, reply: Reply) -> Wait | None:
        names = list(self._control.machine.buttons)
        at, level = command.integer("P", None), command.integer("S")
        if at is None:
            return self._pause(command, reply)
        if at not in range(len(names)):
            none = "a button of the machine file: it has none"
            limit = f"0 to {len(names) - 1}" if names else none
            raise CommandError.bad_value("P", at, limit)
        name = names[at]

        async def wait() -> None:
            pressed, state = self._buttons.pressed, self._control.state
            wanted = level > 0 if level >= 0 else not pressed.get(name)
            reply.say(f"echo:busy: waits for button {name}")
            await self._control.rig.queue.until(
                lambda: state.interrupted or pressed.get(name, False) == wanted, idly=True
            )
            state.raise_if_halted()

        return WaitForProcedure(wait)

    def _stand_by(
        self, text: str, words: Mapping[str, float], reply: Reply, *, by_file: bool = False
    ) -> Wait | None:
        """Pauses and parks a print from a file, on a command of any console; during a pause, it
        only lifts the nozzle at its position. A host that prints is asked to pause, and its lines
        wait. `by_file`: see `Runner.pause`."""

        def gone() -> bool:
            return isinstance(reply, Session) and reply.gone

        async def stand_by() -> None:
            if self._runner.is_suspended():
                await self._host_pause.park_and_wait(self._runner.park, text, words, gone)
            elif self._runner.active:
                self._pause_file(text.replace("M108", "M24"), words, by_file=by_file)
            else:
                await self._host_pause.stand_by(text, words, gone)

        return WaitForProcedure(stand_by)

    def _pause_file(self, text: str, words: Mapping[str, float], *, by_file: bool) -> None:
        self._control.state.tell(f"echo:{text}")
        self._runner.pause(words, by_file=by_file)
        self._control.prompts.ask(text, awaited=False)

    @command(
        "M876",
        Subject.STOPS,
        When.IMMEDIATE,
        "Answers a prompt.",
        number("S P", "the answer"),
        kind=Kind.QUIET,
    )
    def _answer(self, command: Command, reply: Reply) -> Wait | None:
        """M876. The answer to a wait took effect when the line was received. Raises
        CommandError."""
        if command.has("S") and self._asks:
            self._runner.start()
        elif not command.has("S", "P"):
            reply.say("M876 P1")
        return None

    @property
    def _asks(self) -> bool:
        """Whether a paused file waits for the user."""
        person = self._control.prompts
        return self._runner.state is JobState.PAUSED and person.asking and not person.awaited

    def _end_asking(self) -> None:
        if self._asks:
            try:
                self._runner.start()
            except PassoError as error:
                self._control.state.tell(f"echo:{error}")

    @command(
        "M602",
        Subject.PRINTS,
        When.IMMEDIATE,
        "Resumes the print after a pause.",
        kind=Kind.SERVED,
    )
    def _resume(self, _: Command, __: Reply) -> Wait | None:
        """M602. A wait for the user has ended when the line was received. Raises CommandError."""
        if self._runner.state is JobState.PAUSED:
            self._runner.start()
        return None


def _percent(given: float) -> float:
    return min(max(given, 0.0), 100.0)
