"""The maintenance items of the printers."""

from __future__ import annotations

from collections.abc import Mapping

from passo.errors import WebError
from passo.hub.parts import Parts
from passo.hub.records import PrinterRow, ServiceRow
from passo.hub.wishes import ServiceInterval, ServiceItem

_HOUR_S = 3600.0


def item_of(row: ServiceRow, printer: PrinterRow) -> ServiceItem:
    """An item, with what its printer has printed since it was done."""
    hours = (printer.printed_s - row.at_s) / _HOUR_S
    prints, filament_mm = printer.prints - row.at_prints, printer.filament_mm - row.at_mm
    due = any(
        every is not None and used >= every
        for every, used in (
            (row.every_h, hours),
            (row.every_prints, prints),
            (row.every_mm, filament_mm),
        )
    )
    return ServiceItem(
        row.item,
        row.every_h,
        row.every_prints,
        row.every_mm,
        hours,
        prints,
        filament_mm,
        due,
        row.done_s,
        row.done_by,
    )


def due_items(printer: PrinterRow, items: Mapping[tuple[str, str], ServiceRow]) -> tuple[str, ...]:
    """The names of the items of a printer that are due."""
    return tuple(
        sorted(
            row.item
            for row in items.values()
            if row.printer == printer.id and item_of(row, printer).due
        )
    )


class ServiceItems:
    """The maintenance items."""

    def __init__(self, parts: Parts) -> None:
        self._parts, self._store = parts, parts.store

    async def service_items(self, printer: str) -> list[ServiceItem]:
        """The items of a printer. Raises WebError."""
        row = self._parts.printer(printer)
        items = (item for item in self._store.service_items.values() if item.printer == printer)
        return sorted((item_of(item, row) for item in items), key=lambda item: item.item)

    async def set_service_item(
        self, printer: str, item: str, interval: ServiceInterval, user: str
    ) -> ServiceItem:
        """Makes or changes an item; a new one counts from now. Raises WebError."""
        row = self._parts.printer(printer)
        known = self._store.service_items.get((printer, item))
        new = known is None
        service = known or ServiceRow(printer, item)
        fields: dict[str, object] = {
            "every_h": interval.every_h,
            "every_prints": interval.every_prints,
            "every_mm": interval.every_mm,
        }
        if new or interval.done:
            fields |= {
                "at_s": row.printed_s,
                "at_prints": row.prints,
                "at_mm": row.filament_mm,
            }
        if interval.done:
            fields |= {"done_s": self._parts.wall_s(), "done_by": user}
        what = f"{row.name}: {item} {'done' if interval.done else 'set'}"
        with self._store.change(user, what, printer=printer) as change:
            if new:
                change.add(service)
            service = change.set(service, **fields)
        return item_of(service, row)

    async def remove_service_item(self, printer: str, item: str, user: str) -> None:
        """Removes an item. Raises WebError."""
        row = self._parts.printer(printer)
        known = self._store.service_items.get((printer, item))
        if known is None:
            raise WebError.of("web.not-found", value=f"maintenance item {item} of {row.name}")
        with self._store.change(user, f"{row.name}: {item} removed", printer=printer) as change:
            change.remove(known)
