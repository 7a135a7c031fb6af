"""Writes the generated pages of docs/reference/. Usage: .venv/bin/python tools/reference.py"""

from __future__ import annotations

from pathlib import Path

from passo import catalogue_reference
from passo.config import board_reference, machine_reference, sensor_names
from passo.config.importing.klipper import reference as klipper_reference
from passo.config.importing.marlin import reference as marlin_reference
from passo.gcode import reference as command_reference
from passo.toolchain import protocol_reference
from passo.web import client_stub, http_reference, page_types

FOLDER = Path(__file__).parents[1] / "docs" / "reference"
PAGES = {
    "boards.md": board_reference.reference,
    "errors.md": catalogue_reference.reference,
    "gcode.md": command_reference.reference,
    "klipper-sections.md": klipper_reference.reference,
    "http.md": http_reference.reference,
    "marlin-defines.md": marlin_reference.reference,
    "machine-file.md": machine_reference.reference,
    "protocol.md": protocol_reference.reference,
    "sensors.md": sensor_names.reference,
    "../../src/passo/web/client.pyi": client_stub.stub,
    "../../web-ui/src/api/schema.ts": page_types.page_types,
}


def main() -> None:
    """Writes the pages that have changed, and names them."""
    for name, page in PAGES.items():
        path, text = FOLDER / name, page()
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")
            print(path)


if __name__ == "__main__":
    main()
