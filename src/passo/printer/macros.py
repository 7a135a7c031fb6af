"""Macros of the machine file: expands calls to lines, and stores variables."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator, Mapping
from copy import deepcopy
from typing import TYPE_CHECKING, Any, cast

from passo import _core
from passo.config.exporting.settings import Sections
from passo.config.macros import literal
from passo.config.part_names import found_name
from passo.errors import CommandError
from passo.gcode.command import Command
from passo.gcode.parameters import text
from passo.gcode.registry import Subject, When, command
from passo.printer.klipper.objects import Object, Objects, objects
from passo.printer.saved_variables import SavedVariables
from passo.printer.stand_ins import StandIns

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig
    from passo.gcode.template import Budget, Template
    from passo.printer.status import Status
    from passo.printer.wait_requests import Reply

_VARIABLE = re.compile(r"[a-z_][a-z0-9_]{0,99}", re.ASCII)
_MAX_SAVED = 1000  # maximum number of variables of SAVE_VARIABLE
_MACRO = "gcode_macro "  # what the objects of macros are called
MAX_DEPTH = 16  # nested macros

Respond = Callable[[str], object]


class EmergencyStop(Exception):
    """A template has called action_emergency_stop."""


class _Raised(Exception):
    """A template has called action_raise_error."""


class PrinterTree(Mapping[str, Object]):
    """The value `printer` of a template. An object is found by its name in any case. It is made on
    demand, once for each rendering, and belongs to the rendering alone."""

    def __init__(self, found: Objects) -> None:
        self._found = found
        self._made: dict[str, Object] = {}

    def __getitem__(self, name: object) -> Object:
        """The object of this name. Raises KeyError."""
        written = str(name).strip()
        if written not in self._made:
            known = found_name(self._found, written)
            if known is None:
                raise KeyError(written)
            made = self._found[known]()
            # variables are copies already, and a template may change what they hold
            self._made[written] = made if known.startswith(_MACRO) else deepcopy(made)
        return self._made[written]

    def __iter__(self) -> Iterator[str]:
        """The names of all objects."""
        return iter(self._found)

    def __len__(self) -> int:
        """The number of objects."""
        return len(self._found)


class Macros:
    """The macros of one printer or of one program, with the values of their variables. `saved` are
    those of SAVE_VARIABLE. `watchers` are called with each macro call and its resulting text,
    `remote_listeners` with each call of a method of a remote client: its name and its arguments.
    """

    def __init__(self, machine: MachineConfig, saved: SavedVariables | None = None) -> None:
        self._machine, self._sections = machine, Sections(machine)
        self._names = machine.macro_names
        self.stand_ins = StandIns(self._sections)
        self._saved = saved or SavedVariables()
        self.variables: dict[str, dict[str, Any]] = {
            name: macro.values() for name, macro in machine.macros.items()
        }
        self._templates: dict[str, Template] = {}  # by their texts
        self._rendered = 0
        self._budgets: dict[bool, Budget] = {}
        self.watchers: list[Callable[[Command, str], None]] = []
        self.remote_listeners: list[Callable[[str, Mapping[str, Any]], None]] = []

    @property
    def saved(self) -> dict[str, Any]:
        """The variables of SAVE_VARIABLE by name."""
        return self._saved.values

    def expand(
        self,
        job: _core.Job,
        command: Command,
        status: Status,
        respond: Respond,
        *,
        console: bool = False,
    ) -> None:
        """Expands a call, and makes the job read the lines next. Call it after the job's event
        MACRO. `respond` receives lines of action_respond_info. `console`: the call comes from a
        console, not from a file. Raises CommandError, and EmergencyStop."""
        code, name = command.code, self._names[command.code]
        depth = job.program.macro_depth
        if depth >= MAX_DEPTH:
            raise CommandError.of("macro.nested", axis=code, limit=MAX_DEPTH)
        budget = self._budgets.get(console)
        if depth == 0 or budget is None:
            from passo.gcode.template import Budget

            budget = self._budgets[console] = Budget()
        variables = deepcopy(self.variables)
        values = {
            **variables[name],
            "params": _params(command),
            "rawparams": command.text,
            "variables": dict(variables[name]),
        }
        gcode = self._machine.macros[name].gcode
        text = self._gcode(name, gcode, values, variables, status, budget, respond)
        for watcher in self.watchers:
            watcher(command, text)
        job.program.insert(text.encode("utf-8", "surrogateescape"), code)

    def rendered(self, name: str, text: str, status: Status, respond: Respond) -> str:
        """The lines of the template `text` of the machine file, which is not a macro; `name` is its
        key. Raises as `expand`."""
        from passo.gcode.template import Budget

        budget = self._budgets[True] = Budget()
        variables = deepcopy(self.variables)
        return self._gcode(name, text, {}, variables, status, budget, respond)

    def value(self, name: str, text: str, values: Mapping[str, Any], status: Status) -> str:
        """What the template `text` of the machine file writes, which is not G-code; `name` is its
        key, `values` are its variables. Raises CommandError."""
        from passo.gcode.template import Budget

        printer = self._tree(status, deepcopy(self.variables))
        everything = {"printer": printer, **values}
        return self._render(name, text, everything, Budget(), f"{status.time_s}")

    def _keep(self, name: str, variables: Mapping[str, Mapping[str, Any]]) -> None:
        """Keeps what a template has changed within lists and tables of variables. Raises
        CommandError."""
        for macro, values in variables.items():
            for variable, value in values.items():
                if value == self.variables[macro][variable]:
                    continue
                try:
                    self.variables[macro][variable] = literal(repr(value))
                except ValueError:
                    reason = f"{variable} of {macro} can hold texts, numbers, lists and tables only"
                    raise CommandError.of("macro.whole", axis=name, value=reason) from None

    @command(
        "SET_GCODE_VARIABLE",
        Subject.MACROS,
        When.PLANNED,
        "Sets a variable of a macro, until the program ends.",
        text("MACRO", "the macro", required=True),
        text("VARIABLE", "its variable", required=True),
        text("VALUE", "the value, as Python writes it", required=True),
    )
    def set_variable(self, command: Command, _: Reply) -> None:
        """Raises CommandError."""
        macro, wanted = command.string("MACRO"), command.string("VARIABLE")
        name = found_name(self.variables, macro)
        if name is None:
            raise CommandError.of("macro.unknown", axis=macro, value=_names(self.variables))
        variable = found_name(self.variables[name], wanted)
        if variable is None:
            known = _names(self.variables[name])
            raise CommandError.of("macro.no-variable", axis=name, value=wanted, limit=known)
        self.variables[name][variable] = _value(variable, command.string("VALUE"))

    @command(
        "SAVE_VARIABLE",
        Subject.MACROS,
        When.PLANNED,
        "Stores a variable that all macros read as printer.save_variables.variables.NAME, also"
        " after a restart.",
        text("VARIABLE", "the name: small letters, digits and _", required=True),
        text("VALUE", "the value, as Python writes it", required=True),
    )
    def save_variable(self, command: Command, _: Reply) -> None:
        """SAVE_VARIABLE. Raises CommandError, without any change of variables."""
        name = command.string("VARIABLE")
        if not _VARIABLE.fullmatch(name):
            limit = "a name of small letters, digits and _"
            raise CommandError.of("command.value", axis="VARIABLE", value=name, limit=limit)
        # in the form that JSON stores: a list in place of a tuple
        value = json.loads(json.dumps(_value(name, command.string("VALUE"))))
        saved = {**self.saved, name: value}
        if len(saved) > _MAX_SAVED:
            limit = f"one of the {_MAX_SAVED:,} that are stored already"
            raise CommandError.of("command.value", axis="VARIABLE", value=name, limit=limit)
        self._saved.save(saved)

    def calls(self, code: str) -> bool:
        """Whether a command with this code calls a macro."""
        return code in self._names

    def take_variables(self, other: Macros) -> None:
        """Copies the values of variables from another program."""
        self.variables = deepcopy(other.variables)

    def _gcode(
        self,
        name: str,
        text: str,
        values: Mapping[str, Any],
        variables: dict[str, dict[str, Any]],
        status: Status,
        budget: Budget,
        respond: Respond,
    ) -> str:
        def respond_info(message: object) -> str:
            respond(str(message))
            return ""

        functions: dict[str, Any] = {
            "action_respond_info": respond_info,
            "action_raise_error": _raise_error,
            "action_emergency_stop": _stop,
            "action_call_remote_method": self._call_remote_method,
        }
        self._rendered += 1
        # the clock decides what is random: so a program that is only planned stays the same
        seed = f"{status.time_s} {self._rendered}"
        everything = {"printer": self._tree(status, variables), **functions, **values}
        lines = self._render(name, text, everything, budget, seed)
        self._keep(name, variables)
        return lines

    def _render(
        self,
        name: str,
        text: str,
        values: Mapping[str, Any],
        budget: Budget,
        seed: str,
    ) -> str:
        from passo.gcode.template import Template, TemplateFault

        template = self._templates.get(text)
        try:
            if template is None:
                template = self._templates[text] = Template(text)
            return template.render(values, budget, seed)
        except TemplateFault as fault:
            where = {"axis": name, "value": fault.reason}
            if fault.line is None:
                raise CommandError.of("macro.whole", **where) from None
            raise CommandError.of("macro.template", **where, limit=fault.line) from None
        except _Raised as raised:
            raise CommandError.of("macro.raised", axis=name, value=str(raised)) from None

    def _call_remote_method(self, method: object = "", **arguments: object) -> str:
        if not all(_plain(value) for value in arguments.values()):
            raise _Raised(f"{method}: arguments are texts, numbers, lists and tables")
        for listener in self.remote_listeners:
            listener(str(method), arguments)
        return ""

    def _tree(self, status: Status, variables: dict[str, dict[str, Any]]) -> PrinterTree:
        found = objects(self._machine, self._sections, status, variables)
        saved = deepcopy(self.saved)
        found = self.stand_ins.objects | found
        return PrinterTree(found | {"save_variables": lambda: {"variables": saved}})


def _raise_error(message: object = "") -> str:
    raise _Raised(str(message))


def _stop(message: object = "") -> str:
    raise EmergencyStop(str(message))


def _params(command: Command) -> dict[str, str]:
    """The parameters of a call: KEY=VALUE of a named command, or the words of a numbered command by
    letter; its own letter and number are among them, as in Klipper."""
    if command.name:
        return command.pairs()
    words = _core.split_text(command.text)
    given = {letter: text or "" for letter, _, text in words if "A" <= letter <= "Z"}
    return {command.code[:1]: command.code[1:]} | given


def _value(variable: str, written: str) -> Any:
    """The value that a command gives a variable. Raises CommandError."""
    try:
        return literal(written)
    except ValueError:
        raise CommandError.of("macro.value", axis=variable, value=written) from None


def _names(known: Mapping[str, object]) -> str:
    return ", ".join(known) or "none"


def _plain(value: object) -> bool:
    """Whether a value has only types that a machine file can contain."""
    if isinstance(value, dict):
        content = cast("dict[object, object]", value)
        return all(isinstance(key, str) and _plain(item) for key, item in content.items())
    if isinstance(value, list | tuple):
        return all(_plain(item) for item in cast("list[object]", value))
    return value is None or isinstance(value, bool | int | float | str)
