"""The reference page of all boards, made from their files."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from passo.config.board import Board, Socket
from passo.config.board_files import load_board, shipped_boards
from passo.config.chips import Chip

_SLOW_DRIVERS_US, _QUICK_DRIVERS_US = 2, 0.1  # pulses

_HEAD = """# Boards

Made from the files in `src/passo/config/boards/` and `chips/` (`tools/references/boards.py`). A
machine names a board as `base` in its table `[board]`. In front of a pin `!` says that it is on, or
pressed, when low. How a board gets its firmware: [Set up a board](../how-to/set-up-a-board.md).

Every board also knows the pins of its microcontroller (`PB4`), the numbers printed beside them
(`D10`, `A13`), and the pins of its sockets (`X_STEP`, `X_DIR`, `X_ENABLE`).

A budget is what the planner keeps to: shares of the processor's time for steps and for commands,
and what the serial link carries. How it was measured:
[How fast](firmware.md#how-fast).

"""


def reference() -> str:
    """The page, in Markdown."""
    return _HEAD + "\n".join(line for name in shipped_boards() for line in _board(name))


def _board(name: str) -> Iterator[str]:
    board = load_board(name)
    yield f"## {name}\n"
    yield f"{_capital(board.description)}.\n"
    for note in board.notes:
        yield f"**Note**: {note}\n"
    if board.chip is not None:
        yield from _facts(board, board.chip)
    elif board.sockets:
        yield f"- clock {board.clock_hz / 1e6:g} MHz\n"
    yield from _motors(board)
    yield from _named(board)
    yield from _functions(board)
    yield from _plugs(board)


def _facts(board: Board, chip: Chip) -> Iterator[str]:
    kib = f"{chip.flash_bytes // 1024} KiB of flash, {chip.ram_bytes // 1024} KiB of RAM"
    yield f"- {chip.name}: {kib}; clock {board.clock_hz / 1e6:g} MHz, {board.move_count} moves"
    if board.console:
        receive, transmit = board.console.pins
        only = "; its own connector is USB only" if board.incomplete else ""
        uart = f"{board.console.uart}, receives on {receive}, sends on {transmit}"
        yield f"- console: {uart}, {board.console.baud} baud{only}"
    if board.flash:
        yield f"- flashed with {board.flash.method}"
        yield from (f"- before: {text}" for text in board.flash.before)
        yield from (f"- after: {text}" for text in board.flash.after)
    yield from _budget(board)
    if board.pullup_ohm:
        yield f"- pull-up resistors of its thermistors: {board.pullup_ohm:g} Ω"
    yield ""


def _budget(board: Board) -> Iterator[str]:
    """The budget that the planner uses when the board is on its serial line."""
    budget = board.budget
    if budget is None:
        return
    serial = {"link": "serial", "baud": board.console.baud if board.console else board.baud}
    wired = board.model_copy(update=serial)
    rates = wired.budget_spec(_SLOW_DRIVERS_US) or {}
    quick = wired.budget_spec(_QUICK_DRIVERS_US) or {}
    steps = f"{rates['steps_s']:.0f} steps/s"
    if quick["steps_s"] > rates["steps_s"]:
        steps += f" with pulses of {_SLOW_DRIVERS_US:g} µs"
        steps += f" ({quick['steps_s']:.0f} with {_QUICK_DRIVERS_US:g} µs)"
    cycles = f"{budget.cycles_per_step:g} cycles a step, {budget.cycles_per_command:g} a command"
    bounds = {
        "commands": "the processor bounds",
        "slots": "its move slots bound",
        "link": "the link bounds",
    }[rates["bound"]]
    yield (
        f"- budget: {cycles}, at {(budget.cpu_hz or board.clock_hz) / 1e6:g} MHz; of all motors"
        f" together {steps}, and {rates['commands_s']:.0f} commands/s, which {bounds}"
    )


def _motors(board: Board) -> Iterator[str]:
    if not board.sockets:
        return
    rows = [
        (
            name,
            *(_printed(board, pin) for pin in (s.step, s.direction, s.enable)),
            s.compare or "",
            _printed(board, s.select) if s.select else "",
            _uart(s),
            ", ".join(_printed(board, pin) for pin in s.microstep),
        )
        for name, s in board.sockets.items()
    ]
    heads = ("motor", "step", "direction", "enable", "compare unit", "select", "UART", "MS1, MS2")
    yield from _table(heads, rows)


def _uart(socket: Socket) -> str:
    if socket.uart is None or socket.uart_send is None:
        return socket.uart or ""
    return f"{socket.uart}, sends on {socket.uart_send}, address {socket.address}"


def _named(board: Board) -> Iterator[str]:
    rows: list[tuple[str, ...]] = []
    for kind, pins in (
        ("output", board.outputs),
        ("thermistor", board.thermistors),
        ("endstop", board.endstops),
    ):
        rows += [(kind, name, pin, _abilities(board, pin)) for name, pin in pins.items()]
    if rows:
        yield from _table(("socket", "name", "pin", "can do"), rows)


def _abilities(board: Board, pin: str) -> str:
    """The functions of a pin other than on and off."""
    chip, bare = board.chip, pin.lstrip("!^~")
    if chip is None:
        return ""
    able = [f"ADC {chip.adc[bare]}"] if bare in chip.adc else []
    free = (p for p in chip.pwm.get(bare, ()) if not chip.timers[p.timer].firmware)
    return ", ".join([*able, *(f"PWM {p.timer}{p.channel}" for p in free)])


def _functions(board: Board) -> Iterator[str]:
    variants = board.variants or ({"": board.functions} if board.functions else {})
    rows = [
        (variant, key, function.output, function.sensor or "")
        for variant, functions in variants.items()
        for key, function in functions.items()
    ]
    if rows:
        yield from _table(("variant", "meant for", "output", "sensor"), rows)


def _plugs(board: Board) -> Iterator[str]:
    plugs = [("card", board.card), *board.displays.items(), *_reserved(board)]
    rows = [
        (name, ", ".join(f"{key} {_printed(board, pin)}" for key, pin in pins.items()))
        for name, pins in plugs
        if pins
    ]
    if rows:
        yield from _table(("plug", "pins"), rows)


def _reserved(board: Board) -> Iterator[tuple[str, dict[str, str]]]:
    for what, pins in board.reserved.items():
        yield f"reserved: {what}", {str(i): pin for i, pin in enumerate(pins)}


def _printed(board: Board, pin: str) -> str:
    """The pin, with the number printed beside it if there is one."""
    bare = pin.lstrip("!^~")
    names = (n for n, p in board.pins.items() if p == bare and n[-1:].isdigit() and n != bare)
    number = next((n for n in names if n.rstrip("0123456789") in ("D", "T", "GP")), None)
    return f"{pin} ({number})" if number else pin


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]


def _table(head: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> Iterator[str]:
    """A Markdown table without the columns that are empty in every row."""
    rows = list(rows)
    kept = [i for i in range(len(head)) if any(row[i] for row in rows)]
    yield f"| {' | '.join(head[i] for i in kept)} |"
    yield f"|{'---|' * len(kept)}"
    for row in rows:
        yield f"| {' | '.join(row[i] for i in kept)} |"
    yield ""
