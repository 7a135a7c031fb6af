"""Whether a file fits the printers."""

from __future__ import annotations

from msgspec import Struct

from passo.hub.call import HubCall
from passo.web.operation import operation
from passo.web.roles import Role


class PrinterFit(Struct, frozen=True):
    """Whether a file fits a printer, null while it is being planned; `why` not. `print_s` is its
    estimate on this machine, null if it is not known."""

    printer: str
    fits: bool | None
    why: str
    print_s: float | None


@operation("files.fit", "GET", "/files/{sha256}/fit", Role.VIEWER, errors=("web.not-found",))
async def fit(call: HubCall, sha256: str) -> list[PrinterFit]:
    """Whether a file fits each printer, by the check and the estimate of its machine file. Printers
    without one, as those of Klipper, take each file."""
    call.file(sha256)
    rows: list[PrinterFit] = []
    for printer in call.view().printers:
        found = call.site.fits(sha256, printer.id)
        known = (None, "", None) if found is None else (found.fits, found.why, found.print_s)
        rows.append(PrinterFit(printer.id, *known))
    return rows
