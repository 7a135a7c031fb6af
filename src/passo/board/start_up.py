"""Prepares a board for a job: reset, configuration, clock, parts."""

from __future__ import annotations

from collections.abc import Sequence

from passo import _core
from passo.board.configuration import full_scale, heater_options
from passo.board.description import inverted
from passo.board.exchange import STEP_S, TIMEOUT_S, TRIES, Exchange
from passo.board.firmware_identity import read_dictionary
from passo.board.ports import LinkLostError
from passo.errors import MachineError

_RESET_S = 0.05  # a board that received `reset` restarts within this time
_REOPEN_S = 5.0  # and its port is back within this time
_SLOTS_RENEWED = 4  # for each output that the host renews regularly


def configure(exchange: Exchange, lines: Sequence[str], crc: int, *, adopt: bool) -> int:
    """Configures the board with the commands `lines`, after a reset if it was in use. With `adopt`,
    a board with this `crc` keeps its configuration. Returns how many commands the board can hold.
    Raises MachineError, and DictionaryError if the board does not know a command."""
    state = exchange.ask("get_config", "config")
    if not adopt and (state["is_shutdown"] or state["is_config"]):
        _reset(exchange, shut_down=bool(state["is_shutdown"]))
        state = exchange.ask("get_config", "config")
        if state["is_shutdown"] or state["is_config"]:
            raise MachineError.of("machine.no-reset", value=exchange.named("the board"))
    if not state["is_config"]:
        for line in [*lines, f"finalize_config crc={crc}"]:
            exchange.command(line)
        # Drop the answers to earlier questions.
        state = exchange.ask_for("get_config", [], "config", {"is_config": 1})
    return int(state["move_count"])


def _reset(exchange: Exchange, *, shut_down: bool) -> None:
    """Restarts the board, so that it has no configuration. Raises MachineError."""
    known = {text.split(" ", 1)[0] for _, text in exchange.dictionary.commands}
    if "reset" in known:
        exchange.command("reset")
    elif "config_reset" in known:  # a Linux process or a PRU takes it only after a shutdown
        if not shut_down:
            exchange.command("emergency_stop")
            _find_shut_down(exchange)
        exchange.command("config_reset")
    else:
        raise MachineError.of("machine.no-reset", value=exchange.named("the board"))
    try:
        exchange.pass_time(exchange.now + exchange.ticks(_RESET_S))
        exchange.link.restart()
        read_dictionary(exchange)
    except LinkLostError:
        # After the restart, a USB device or the pty of a process is a new device.
        exchange.port.open(_REOPEN_S)
        exchange.link.restart()
        exchange.wire = exchange.port.attach(exchange.link)
        read_dictionary(exchange)


def _find_shut_down(exchange: Exchange) -> None:
    """Waits until the board has reported its shutdown."""
    for _ in range(TRIES):
        exchange.pass_time(exchange.now + exchange.ticks(_RESET_S))
        exchange.link.restart()  # lets questions pass again, also on a live port
        if exchange.ask("get_config", "config")["is_shutdown"]:
            return


def follow_clock(exchange: Exchange) -> None:
    """Follows the clock of the board from now on. Raises LinkLostError if it does not answer."""
    exchange.link.follow_clock(0)  # at once: `now` counts in ticks of the main board
    for _ in range(int(TIMEOUT_S * TRIES / STEP_S)):
        exchange.run(exchange.now)
        if exchange.link.synchronous:
            if isinstance(exchange.wire, _core.LiveWire):
                exchange.wire.use_board_clock()
            return
        exchange.run(exchange.now + exchange.ticks(STEP_S))
    raise exchange.silence("get_uptime")


def add_parts(exchange: Exchange, move_count: int) -> None:
    """Registers the motors, outputs and heaters of the board with the link. The board can hold
    `move_count` commands."""
    renewed = sum(o.max_duration_ticks > 0 for o in exchange.board.outputs)
    slots = move_count - _SLOTS_RENEWED * renewed
    exchange.link.set_slots(max(slots, 1))
    for target, s in zip(exchange.board.stepper_targets, exchange.board.steppers, strict=True):
        turned = s.invert != inverted(s.dir_pin)
        exchange.link.add_stepper(target, s.name, exchange.oids.steppers[s.name], turned)
    heated = {name for h in exchange.board.heaters for name in h.outputs}
    for target, o in zip(exchange.board.output_targets, exchange.board.outputs, strict=True):
        kind = _core.PinKind.PWM if o.kind == "pwm" else _core.PinKind.DIGITAL
        full = full_scale(o, exchange.dictionary)
        low = full if inverted(o.pin) else 0
        # The control loop of a heater renews its output.
        longest = 0 if o.name in heated else o.max_duration_ticks
        exchange.link.add_pin(target, o.name, exchange.oids.outputs[o.name], kind, low, longest)
        if o.kick:
            exchange.link.set_kick(
                target, o.kick.ticks, round(o.kick.power * full), int(o.kick.rise * full)
            )
    for h in exchange.board.heaters:
        options = heater_options(exchange.board, h, exchange.dictionary)
        exchange.heaters[h.name] = exchange.link.add_heater(options)
