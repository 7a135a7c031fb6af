"""Reads the dictionary of a board's firmware over the link, and checks that it fits."""

from __future__ import annotations

from contextlib import suppress

from passo.board.description import BoardDescription
from passo.board.dictionary import RUNS_KLIPPERS, RUNS_PASSOS, Dictionary, DictionaryError
from passo.board.exchange import TRIES, Exchange, Values
from passo.board.faults import BoardSilentError
from passo.board.ports import Port
from passo.board.words import check_words
from passo.config.klippers_firmware import ASSUMED_CLOCK_HZ
from passo.errors import MachineError

_CHUNK, _SHORT_CHUNK = 40, 8
_SURVIVE = 2  # version of the extension


def identify(exchange: Exchange) -> None:
    """Reads and checks the dictionary. Raises MachineError if the firmware is too old, and
    DictionaryError if the dictionary does not fit the machine file."""
    read_dictionary(exchange)
    _check_version(exchange)
    _check_clock(exchange)
    check_words(exchange.board, exchange.dictionary)


def reported_clock_hz(port: Port, name: str) -> int:
    """The frequency that the firmware of the board `name` at this port reports for its clock.
    Raises MachineError."""
    exchange = Exchange(BoardDescription(ASSUMED_CLOCK_HZ), port, name)
    try:
        read_dictionary(exchange)
        hz = exchange.dictionary.number("CLOCK_FREQ")
    except DictionaryError as error:
        raise MachineError.of("machine.dictionary", value=str(error)) from None
    finally:
        port.close()
    if hz <= 0:
        raise MachineError.of("machine.dictionary", value="it does not have the clock (CLOCK_FREQ)")
    return hz


def read_dictionary(exchange: Exchange) -> None:
    """Reads the dictionary of the firmware that the board runs now. Raises DictionaryError if it is
    damaged."""
    data = b""
    while True:
        part = (_part(exchange, len(data)) if data else _first_part(exchange))["data"]
        if not isinstance(part, bytes) or not part:
            break
        data += part
    exchange.dictionary = Dictionary.parse(data)
    exchange.link.set_dictionary(
        list(exchange.dictionary.commands),
        list(exchange.dictionary.reports),
        exchange.dictionary.number("RECEIVE_WINDOW"),
    )


def _part(exchange: Exchange, offset: int) -> Values:
    with suppress(BoardSilentError):
        return _chunk(exchange, offset, _CHUNK, tries=1)
    # On a bad link, only short frames arrive undamaged.
    return _chunk(exchange, offset, _SHORT_CHUNK, TRIES - 1)


def _chunk(exchange: Exchange, offset: int, size: int, tries: int) -> Values:
    return exchange.ask_for(
        "identify", [offset, size], "identify_response", {"offset": offset}, tries
    )


def _first_part(exchange: Exchange) -> Values:
    """Drops the first bytes, which may be answers to an earlier host. Their sequence number can be
    wrong, so the number that the board expects is requested again."""
    for _ in range(TRIES - 1):
        with suppress(BoardSilentError):
            return _chunk(exchange, 0, _CHUNK, tries=1)
        exchange.link.restart()
    return _chunk(exchange, 0, _CHUNK, tries=1)


def _check_version(exchange: Exchange) -> None:
    if 0 < exchange.dictionary.number("SURVIVE") < _SURVIVE:
        raise MachineError.of("machine.old-firmware")
    survives = exchange.dictionary.number("SURVIVE") > 0
    if exchange.board.survives not in (None, survives):
        raise DictionaryError(RUNS_PASSOS if survives else RUNS_KLIPPERS)


def _check_clock(exchange: Exchange) -> None:
    hz, wanted = exchange.dictionary.number("CLOCK_FREQ"), exchange.board.clock_hz
    if hz not in (0, wanted):
        raise DictionaryError(
            f"its clock has {hz / 1e6:g} MHz, not {wanted / 1e6:g} MHz (clock_hz)"
        )
