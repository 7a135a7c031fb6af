"""Motors of axes and towers, with their sockets and directions."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from passo.config.importing.draft import Place, bad
from passo.config.importing.marlin.arms import ARMS
from passo.config.importing.marlin.drivers import put_driver

if TYPE_CHECKING:
    from passo.config.importing.draft import KeyPath
    from passo.config.importing.marlin.conversion import Job


def put_motor(job: Job, index: int, letter: str, motor: str, subtracts: bool) -> None:
    """Converts the motor of an axis or a tower, and further motors of the same axis."""
    axis = letter.upper()
    job.needed_list("DEFAULT_AXIS_STEPS_PER_UNIT")
    names = [axis, *further_motors(job, axis)]
    turns = job.kind == "scara" and letter in ARMS
    for number, name in enumerate(names):
        stepper = motor if number == 0 else f"{motor}{number}"
        path = ("steppers", stepper)
        job.rows("arm" if turns else "stepper", name=stepper, index=str(index))
        if number == 0:
            put_socket(job, path, name, axis)
        elif not job.part(name, partial(put_socket, job, path, name, axis)):
            job.draft.keys = {k: v for k, v in job.draft.keys.items() if k[:2] != path}
            continue
        _put_inversion(job, path, axis, name if number else None, subtracts)
        put_driver(job, path, name)
        if job.kind == "delta":
            job.rows("tower", name=stepper, index=str(index))


def further_motors(job: Job, axis: str) -> list[str]:
    """The names of further motors of an axis: Z2, Z3."""
    defines = job.defines
    named = [
        f"{axis}{number}" for number in (2, 3, 4) if defines.first(f"{axis}{number}_DRIVER_TYPE")
    ]
    if named:
        return named
    old = (f"{axis}_DUAL_STEPPER_DRIVERS", f"{axis}_TWO_STEPPER_DRIVERS", f"{axis}_TWO_STEPPER")
    count = defines.number("NUM_Z_STEPPER_DRIVERS") if axis == "Z" else None
    if count is not None and count.value > 1:
        return [f"Z{number}" for number in range(2, count.whole(1, 4) + 1)]
    return [f"{axis}2"] if defines.on(*old) else []


def put_socket(job: Job, path: KeyPath, name: str, axis: str) -> None:
    """Sets the socket of a motor. As in Marlin, further motors use the sockets after those of the
    extruders."""
    socket = job.pins.socket(name)
    if socket is None and not name.startswith("E") and name != axis:
        taken = [value for key, (value, _) in job.draft.keys.items() if key[-1] == "socket"]
        own = {job.pins.socket(letter) for letter in "XYZ"}
        further = [value for value in taken if value not in own]
        socket = job.pins.socket(f"E{job.extruders + len(further)}")
    if socket is None:
        place = Place(job.defines.files[0].name, 1)
        limit = f"a socket; {job.pins.board.name} has {', '.join(job.pins.board.sockets)}"
        raise bad(place, f"motor {name}", name, limit)
    job.draft.put((*path, "socket"), socket, None)


def _put_inversion(
    job: Job, path: KeyPath, axis: str, further: str | None, subtracts: bool
) -> None:
    defines = job.defines
    found = defines.number(f"INVERT_{axis}_DIR")
    inverted = bool(found and found.value) != subtracts
    if further is not None:
        against = (f"INVERT_{further}_VS_{axis}_DIR", f"INVERT_{axis}2_VS_{axis}_DIR")
        inverted = inverted != defines.on(*against)
    job.draft.put((*path, "invert"), inverted or None, found.place if found else None)
    for name, usual in ((f"{axis}_ENABLE_ON", 0), (f"INVERT_{axis}_STEP_PIN", 0)):
        value = defines.number(name)
        if value is not None and value.value != usual:
            job.decide(
                name, "the board file has drivers that are enabled by a low level: name pins"
            )
