"""Imports the drivers of motors: their buses, currents, registers, and [autotune_tmc]."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.config.importing.klipper.buses import wires_of
from passo.config.pin_names import named_on, placed
from passo.config.pin_names import section as board_path
from passo.config.trinamic import CHIPS, Chip, ChipName, chip_of
from passo.config.trinamic.known_motors import known_motors

if TYPE_CHECKING:
    from passo.config.importing.draft import KeyPath
    from passo.config.importing.klipper.cfg import Section
    from passo.config.importing.klipper.conversion import Import

_FIELD = "driver_"
_ALWAYS_MM_S = 1e6  # no motor is faster: silent at any speed
_STRONG_NM = 0.3  # a motor with less torque does not have it to spare for silence
_STALL = ("sgthrs", "sgt", "sg4_thrs")
# Of [motor_constants]: the keys of `motor`, with the factor of their unit.
_CONSTANTS = {
    "resistance": ("resistance_ohm", 1.0),
    "inductance": ("inductance_mh", 1000.0),
    "holding_torque": ("holding_torque_nm", 1.0),
    "max_current": ("max_current_a", 1.0),
}


def put_driver(job: Import, motor: Section, path: KeyPath) -> None:
    """Imports the driver of the motor at `path`, if the file sets its registers."""
    found = [s for s in job.config.sections.values() if s.rest == motor.name]
    tunings = [s for s in found if s.kind == "autotune_tmc"]
    for section in (s for s in found if s.kind.startswith("tmc")):
        job.used.add(section.name)
        chip = chip_of(section.kind.upper())
        if chip is None:
            text = "Passo does not set this driver's registers: it runs as its pins are wired"
            job.draft.dropped(section.place, f"[{section.name}]", text)
            job.leave_out(section)
            continue
        if _put_chip(job, section, path, chip, tunings):
            for tuning in tunings:
                _put_tuning(job, tuning, motor, path, CHIPS[chip])
    job.used.update(tuning.name for tuning in tunings)


def _put_chip(
    job: Import, section: Section, path: KeyPath, chip: ChipName, tunings: list[Section]
) -> bool:
    """Imports a driver; False if its bus is not known."""
    by_uart = "uart" in CHIPS[chip].buses and "uart_pin" in section.options
    wires = {} if by_uart else wires_of(job, section, "cs_pin")
    select = job.pins.of(section, "cs_pin")
    board, bus = placed(select or "")[0], section.text("spi_bus")
    if not by_uart and not wires and bus and (*board_path(board), "link") in job.draft.keys:
        wires = {"spi_bus": named_on(board, bus)}
    if not by_uart and not wires and "uart" not in CHIPS[chip].buses[:1]:
        run = section.number("run_current")
        text = "Passo does not know the pins of its SPI bus"
        text += f": give driver and tmc of steppers.{path[-1]}"
        if bus:
            text += f", with spi_bus = {named_on(board, bus)!r} once its board has link and port"
        if run is not None:
            text += f", with run_current_a = {run:g}"
        job.draft.decide(section.at("spi_bus"), f"[{section.name}]", text)
        job.leave_out(section)
        for tuning in tunings:
            job.draft.dropped(tuning.place, f"[{tuning.name}]", "its driver is left out")
            job.leave_out(tuning)
        return False
    job.draft.put((*path, "driver"), chip, section.place)
    job.put("driver", section, name=path[-1])
    for key, pin in wires.items():
        job.draft.put((*path, "tmc", key), pin, section.at("spi_bus"))
    if CHIPS[chip].addresses > 1 and by_uart:
        job.put("driver_address", section, name=path[-1])
    if chip == "TMC2660":
        job.put("tmc2660", section, name=path[-1])
    else:
        _put_hold(job, section, path)
    _put_registers(job, section, path, CHIPS[chip])
    return True


def _put_hold(job: Import, section: Section, path: KeyPath) -> None:
    """Imports the current at standstill; in Klipper it is at most the run current."""
    run, hold = section.number("run_current"), section.number("hold_current")
    if run is None or hold is None or hold <= run:
        job.put("driver_hold", section, name=path[-1])
        return
    text = "it is that of the moving motor, as in Klipper"
    job.draft.changed(section.at("hold_current"), f"hold_current in [{section.name}]", text)


def _put_registers(job: Import, section: Section, path: KeyPath, chip: Chip) -> None:
    """Imports the options `driver_NAME` as fields of registers."""
    fields = chip.settable
    for option in [o for o in section.options if o.startswith(_FIELD)]:
        name = option.removeprefix(_FIELD)
        if name in _STALL:
            continue
        what = f"{option} in [{section.name}]"
        text = section.text(option).lower()
        number = {"true": 1.0, "false": 0.0}.get(text)
        value = section.number(option) if number is None else number
        if name not in fields or value is None:
            job.draft.dropped(section.at(option), what, "Passo sets this field itself")
            continue
        least, most = chip.bounds(name)
        if value != int(value) or not least <= value <= most:
            raise section.wrong(option, f"a whole number from {least} to {most}")
        job.draft.put((*path, "tmc", "registers", name), int(value), section.at(option))


def _put_tuning(job: Import, tuning: Section, motor: Section, path: KeyPath, chip: Chip) -> None:
    """Imports [autotune_tmc]: the constants of the motor, and the mode that its goal selects."""
    name = tuning.text("motor")
    constants = job.config.get(f"motor_constants {name}")
    tmc = (*path, "tmc")
    torque_nm: float | None = None
    if constants is None and (known := known_motors().get(name.lower())) is not None:
        for key, value in known.items():
            job.draft.put((*tmc, "motor", key), value, tuning.at("motor"))
        torque_nm = known["holding_torque_nm"]
        job.put("autotune", tuning, name=path[-1])
    elif constants is None:
        text = f"give {'.'.join(tmc)}.motor from the data sheet of {name}"
        job.draft.decide(tuning.at("motor"), f"motor in [{tuning.name}]", text)
    else:
        job.used.add(constants.name)
        constants.used.update(constants.options)
        for option, (key, factor) in _CONSTANTS.items():
            value = constants.needed(option) * factor
            job.draft.put((*tmc, "motor", key), round(value, 9), constants.at(option))
        torque_nm = constants.needed("holding_torque")
        job.put("autotune", tuning, name=path[-1])
    tuning.used |= {"voltage", "extra_hysteresis"}
    for option in (o for o in _STALL if o in tuning.options and o not in tuning.used):
        text = "homing.AXIS.stall.threshold has it, or STALL_CALIBRATE finds it"
        job.draft.dropped(tuning.at(option), f"{option} in [{tuning.name}]", text)
        tuning.used.add(option)
    for option, field in (("tbl", "tbl"), ("toff", "toff"), ("pwm_freq", "pwm_freq")):
        value = tuning.whole(option)
        if value is not None and field in chip.settable:
            job.draft.put((*tmc, "registers", field), value, tuning.at(option))
    _put_goal(job, tuning, motor, tmc, torque_nm, chip)


def _put_goal(
    job: Import,
    tuning: Section,
    motor: Section,
    tmc: KeyPath,
    torque_nm: float | None,
    chip: Chip,
) -> None:
    goal = tuning.text("tuning_goal", "auto").lower()
    if goal == "autoswitch" or not chip.mode:
        return  # the threshold of the driver's own section counts
    silent = goal == "silent"
    xy = motor.name in ("stepper_x", "stepper_y", "stepper_x1", "stepper_y1")
    if goal == "auto" and torque_nm is None and not xy:
        text = "the threshold of the driver counts, because the torque of the motor is not known"
        job.draft.changed(tuning.at("tuning_goal"), f"tuning_goal in [{tuning.name}]", text)
        return
    if goal == "auto":
        silent = not xy and torque_nm is not None and torque_nm > _STRONG_NM
    key, place = (*tmc, "stealthchop_below_mm_s"), tuning.at("tuning_goal")
    job.draft.keys.pop(key, None)
    if silent:
        job.draft.put(key, _ALWAYS_MM_S, place)
    text = f"the driver uses {'stealthChop' if silent else 'spreadCycle'} at any speed"
    job.draft.changed(place, f"tuning_goal {goal} in [{tuning.name}]", text)
