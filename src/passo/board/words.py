"""The messages that a configured board must have, checked against its dictionary."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

from passo.board.configuration import has_triggers
from passo.board.description import BoardDescription
from passo.board.dictionary import Dictionary, DictionaryError


class _Words(NamedTuple):
    """Names with their parameters; a board has exactly one of the names between bars. Reports may
    have further parameters."""

    commands: tuple[str, ...]
    reports: tuple[str, ...]


_ALWAYS = _Words(
    ("get_config", "get_uptime", "get_clock", "emergency_stop"),
    (
        "config is_config crc is_shutdown move_count | config is_config crc move_count is_shutdown",
        "uptime high clock",
        "clock clock",
        "shutdown clock static_string_id",
        "is_shutdown static_string_id",
    ),
)
_STEPPERS = _Words(
    (
        "queue_step oid interval count add",
        "set_next_step_dir oid dir",
        "reset_step_clock oid clock",
        "stepper_get_position oid",
        "stepper_stop_on_trigger oid trsync_oid",
    ),
    ("stepper_position oid pos",),
)
_ENDSTOPS = _Words(
    (
        "endstop_home oid clock sample_ticks sample_count rest_ticks pin_value trsync_oid"
        " trigger_reason",
        "endstop_query_state oid",
        "trsync_start oid report_clock report_ticks expire_reason",
        "trsync_set_timeout oid clock",
        "trsync_trigger oid reason",
    ),
    (
        "endstop_state oid homing next_clock pin_value",
        "trsync_state oid can_trigger trigger_reason clock",
    ),
)
_ANALOG = "query_analog_in oid clock sample_ticks sample_count rest_ticks"
_ANALOG_RANGE = "min_value max_value range_check_count"
_SENSORS = _Words(
    (f"{_ANALOG} bytes_per_report {_ANALOG_RANGE} | {_ANALOG} {_ANALOG_RANGE}",),
    ("analog_in_state oid next_clock values | analog_in_state oid next_clock value",),
)
_CONVERTER = "query_thermocouple oid clock rest_ticks min_value max_value"
_CONVERTERS = _Words(
    (f"{_CONVERTER} max_invalid_count | {_CONVERTER}",),
    ("thermocouple_result oid next_clock value fault",),
)
_SWITCHED = _Words(("queue_digital_out oid clock on_ticks", "update_digital_out oid value"), ())
_PULSED = _Words(("queue_pwm_out oid clock value",), ())
_UARTS = _Words(("tmcuart_send oid write read",), ("tmcuart_response oid read",))
_SPI = _Words(
    ("spi_send oid data", "spi_transfer oid data"), ("spi_transfer_response oid response",)
)
_I2C = _Words(("i2c_transfer oid write read_len",), ("i2c_response oid i2c_bus_status response",))
_INPUTS = _Words(
    ("buttons_query oid clock rest_ticks retransmit_count invert", "buttons_ack oid count"),
    ("buttons_state oid ack_count state",),
)
_COUNTERS = _Words(
    ("query_counter oid clock poll_ticks sample_ticks",),
    ("counter_state oid next_clock count count_clock",),
)
_CHAINS = _Words(
    ("neopixel_update oid pos data", "neopixel_send oid"), ("neopixel_result oid success",)
)
_TRIGGERS = _Words(
    (
        "sos_filter_set_offset_scale oid offset scale scale_frac_bits auto_offset",
        "trigger_analog_set_raw_range oid raw_min raw_max",
        "trigger_analog_set_trigger oid trigger_analog_type trigger_value",
        "trigger_analog_home oid trsync_oid trigger_reason error_reason clock monitor_ticks"
        " monitor_max",
    ),
    (),
)
_OLDER_TRIGGER = _Words(
    ("ldc1612_setup_home oid clock threshold trsync_oid trigger_reason error_reason",), ()
)
_EDDIES = _Words(
    ("query_ldc1612 oid rest_ticks",),
    (
        "sensor_bulk_data oid sequence data",
        "sensor_bulk_status oid clock query_ticks next_sequence buffered possible_overflows",
    ),
)
_OLDER_I2C = _Words(
    ("i2c_write oid data", "i2c_read oid reg read_len"), ("i2c_read_response oid response",)
)


def check_words(board: BoardDescription, dictionary: Dictionary) -> None:
    """Raises DictionaryError if the dictionary lacks a message that is needed to drive the board,
    or has it with other parameters. Messages of the configuration are checked during the
    configuration.
    """
    commands, reports = (
        {name: words for _, text in texts for name, *words in (text.split(),)}
        for texts in (dictionary.commands, dictionary.reports)
    )
    for needed in _needed(board, dictionary):
        for word in needed.commands:
            _check(word, commands)
        for word in needed.reports:
            _check(word, reports, may_go_on=True)


def _needed(board: BoardDescription, dictionary: Dictionary) -> Iterator[_Words]:
    kinds = {output.kind for output in board.outputs}
    yield _ALWAYS
    if board.steppers:
        yield _STEPPERS
    if board.endstops or board.eddies or board.endstops_elsewhere:
        yield _ENDSTOPS
    if board.analog_inputs or any(sensor.spi is None for sensor in board.sensors):
        yield _SENSORS
    if any(sensor.spi is not None for sensor in board.sensors):
        yield _CONVERTERS
    if kinds - {"pwm"}:
        yield _SWITCHED
    if "pwm" in kinds:
        yield _PULSED
    if board.uarts:
        yield _UARTS
    if board.spi_devices:
        yield _SPI
    if board.inputs:
        yield _INPUTS
    if board.counters:
        yield _COUNTERS
    if board.chains:
        yield _CHAINS
    if board.eddies:
        yield _EDDIES
        yield _TRIGGERS if has_triggers(dictionary) else _OLDER_TRIGGER
    if board.i2c_devices:
        yield _OLDER_I2C if dictionary.takes("i2c_read", "reg") else _I2C


def _check(word: str, declared: Mapping[str, list[str]], *, may_go_on: bool = False) -> None:
    forms = [form.split() for form in word.split(" | ")]
    name = forms[0][0]
    if name not in declared:
        raise DictionaryError(f"the board has no message {name!r}")
    found = [name, *(parameter.split("=")[0] for parameter in declared[name])]
    if not any(found == form or (may_go_on and found[: len(form)] == form) for form in forms):
        raise DictionaryError(f"the board has {' '.join(found)!r}, where {word!r} is needed")
