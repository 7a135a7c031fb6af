"""An eddy current sensor in the words of Klipper's firmware of 2026 and before."""

from __future__ import annotations

from tests.support.klipper_board import EDDIES, OLDER_TRIGGER, TRIGGERS

from passo.board.configuration import Oids, commands
from passo.board.description import BoardDescription, Eddy, I2cPins
from passo.board.dictionary import Dictionary
from passo.board.eddy import EddyReader

PART = Eddy("probe", I2cPins("", "", 0x2A, bus="i2c0f"), intb_pin="gpio3")
BOARD = BoardDescription(12_000_000, eddies=(PART,))
TYPES = {"trigger_analog_type": {"abs_ge": 0, "gt": 1}}


class Link:
    """Keeps the commands."""

    def __init__(self, words: dict[str, int]) -> None:
        texts = tuple((number, text) for text, number in (EDDIES | words).items())
        self.dictionary = Dictionary(texts, (), TYPES, {})
        self.board, self.oids = BOARD, Oids.of(BOARD)
        self.said: list[str] = []

    def command(self, text: str) -> None:
        self.dictionary.values(text)
        self.said.append(text)


def armed(link: Link) -> list[str]:
    reader = EddyReader(link, PART)
    reader.threshold_hz = 3_240_000.0
    reader.arm(link.oids.trsyncs["probe"], 5, 64, 2**32 + 1000)
    reader.disarm()
    return link.said


def test_older_firmware_has_a_trigger_for_this_chip_alone() -> None:
    link = Link(OLDER_TRIGGER)
    made = commands(BOARD, link.dictionary)
    assert made[-1] == "config_ldc1612_with_intb oid=2 i2c_oid=1 intb_pin=gpio3"
    raw = round(3_240_000 / (2 * 12e6 / 2**28))
    assert armed(link) == [
        f"ldc1612_setup_home oid=2 clock=1000 threshold={raw} trsync_oid=0 trigger_reason=5"
        " error_reason=64",
        "ldc1612_setup_home oid=2 clock=0 threshold=0 trsync_oid=0 trigger_reason=0 error_reason=0",
    ]


def test_newer_firmware_has_one_trigger_for_all_sensors() -> None:
    link = Link(TRIGGERS)
    assert commands(BOARD, link.dictionary)[-3:] == [
        "config_sos_filter oid=4 max_sections=0",
        "config_trigger_analog oid=3 sos_filter_oid=4",
        "ldc1612_attach_trigger_analog oid=2 trigger_analog_oid=3",
    ]
    said = armed(link)
    assert said[2].startswith("sos_filter_set_offset_scale oid=4 offset=0 scale=1 ")
    assert said[3] == (
        "trigger_analog_home oid=3 trsync_oid=0 trigger_reason=5 error_reason=64 clock=1000"
        " monitor_ticks=30000 monitor_max=3"
    )
    assert said[4].startswith("trigger_analog_home oid=3 ") and "monitor_ticks=0" in said[4]
