"""The drivers of motors, with the registers of those that have some."""

from __future__ import annotations

from typing import TYPE_CHECKING, get_args

from passo.config.drivers import DriverName
from passo.config.trinamic import CHIPS, chip_of

if TYPE_CHECKING:
    from passo.config.importing.draft import KeyPath
    from passo.config.importing.marlin.conversion import Job

_KNOWN: tuple[str, ...] = get_args(DriverName)
_UART = tuple(name for name, chip in CHIPS.items() if chip.buses[0] == "uart")
_OWN_TIMES = {"POLOLU": "A4988", "TMC26X": "TMC2660", "A5984": "A5984"}
_ALWAYS_MM_S = 1e6  # no motor is faster: silent at any speed


def put_driver(job: Job, path: KeyPath, name: str) -> None:
    """Converts the driver of the motor with this name in Marlin: X, Z2, E0."""
    defines, put = job.defines, job.draft.put
    first = name if name.startswith("E") else name[0]
    define = defines.first(f"{name}_DRIVER_TYPE", f"{first}_DRIVER_TYPE")
    if define is None:
        return
    written = defines.text(define) or ""
    kind = written.removesuffix("_STANDALONE")
    kind = _OWN_TIMES.get(kind, kind)
    if kind not in _KNOWN:
        text = f"Passo does not know the driver {written}: it has the times of an A4988"
        job.changed(define, text)
        return
    put((*path, "driver"), kind, defines.place(define))
    chip = chip_of(kind)
    if written.endswith("_STANDALONE") or chip is None:
        return
    current = defines.number(f"{name}_CURRENT", f"{first}_CURRENT")
    pins = _pins(job, name, kind, path[-1])
    if current is None or not pins:
        what = "its current" if current is None else "the pins that set it"
        text = f"Passo does not know {what}: give steppers.{path[-1]}.tmc, or it runs as wired"
        job.decide(define, text)
        return
    tmc = (*path, "tmc")
    job.rows("driver", name=path[-1], motor=name, axis=first)
    resistor = "driver_reference" if chip == "TMC2240" else "driver_sense"
    job.rows(resistor, name=path[-1], motor=name, axis=first)
    hold = defines.number("HOLD_MULTIPLIER")
    if hold is not None and hold.value > 0 and CHIPS[chip].currents.hold:
        put((*tmc, "hold_current_a"), round(current.value * hold.value / 1000, 4), hold.place)
    if CHIPS[chip].addresses > 1 and kind in _UART:
        job.rows("tmc2209", name=path[-1], motor=name)
    for key, pin in pins.items():
        put((*tmc, key), pin, None)
    group = "STEALTHCHOP_XY" if first in "XY" else f"STEALTHCHOP_{name[0]}"
    if defines.on(group) and CHIPS[chip].mode:
        limit = defines.number(f"{name}_HYBRID_THRESHOLD", f"{name[:2]}_HYBRID_THRESHOLD")
        if defines.on("HYBRID_THRESHOLD") and limit is not None:
            job.put((*tmc, "stealthchop_below_mm_s"), limit)
        else:
            put((*tmc, "stealthchop_below_mm_s"), _ALWAYS_MM_S, job.place(group))


def _pins(job: Job, name: str, kind: str, stepper: str) -> dict[str, str | None]:
    """The pins through which a driver is set up. A pin comes from the configuration; None means the
    pin of the socket. Empty if the pins are not known."""
    pins, names = job.pins, job.pins.board.pins
    socket = pins.board.sockets[str(job.draft.keys[("steppers", stepper, "socket")][0])]
    if kind in _UART:
        send = pins.given(f"{name}_SERIAL_TX_PIN")
        receive = pins.given(f"{name}_SERIAL_RX_PIN") or send
        if receive is None:
            return {"uart_pin": None} if socket.uart else {}
        return {"uart_pin": receive, **({"tx_pin": send} if send and send != receive else {})}
    select = pins.given(f"{name}_CS_PIN")
    found = {
        key: pins.given(f"TMC_{define}") or (f"TMC_{board}" if f"TMC_{board}" in names else None)
        for key, define, board in (
            ("clock_pin", "SW_SCK", "SCK"),
            ("mosi_pin", "SW_MOSI", "MOSI"),
            ("miso_pin", "SW_MISO", "MISO"),
        )
    }
    known: dict[str, str | None] = {key: pin for key, pin in found.items() if pin}
    if len(known) < 3 or not (select or socket.select):
        return {}
    return known | ({"cs_pin": select} if select else {})
