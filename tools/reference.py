"""Writes the generated pages of docs/reference/. Usage: .venv/bin/python -m tools.reference"""

from __future__ import annotations

from pathlib import Path

from tools.references import (
    boards,
    client_stub,
    commands,
    course,
    errors,
    http_api,
    machine_file,
    page_types,
    protocol,
    study_file,
)

from passo.config import sensor_names
from passo.config.importing.aprinter import reference as aprinter_reference
from passo.config.importing.klipper import reference as klipper_reference
from passo.config.importing.marlin import reference as marlin_reference
from passo.config.importing.rrf import reference as rrf_reference

FOLDER = Path(__file__).parents[1] / "docs" / "reference"
PAGES = {
    "aprinter-values.md": aprinter_reference.reference,
    "boards.md": boards.reference,
    "errors.md": errors.reference,
    "gcode.md": commands.reference,
    "klipper-sections.md": klipper_reference.reference,
    "http.md": http_api.reference,
    "hub-http.md": http_api.hub_reference,
    "marlin-defines.md": marlin_reference.reference,
    "reprapfirmware-commands.md": rrf_reference.reference,
    "machine-file.md": machine_file.reference,
    "protocol.md": protocol.reference,
    "sensors.md": sensor_names.reference,
    "study-file.md": study_file.reference,
    "../../src/passo/web/client.pyi": client_stub.stub,
    "../../web-ui/src/api/schema.ts": page_types.page_types,
    "../../web-ui/src/farm/schema.ts": page_types.farm_types,
}


COURSE = FOLDER.parent / "course"


def main() -> None:
    """Writes the pages that have changed, and names them; removes those of removed lessons."""
    pages = {FOLDER / name: page() for name, page in PAGES.items()}
    lessons = {COURSE / name: text for name, text in course.files().items()}
    for path, text in (pages | lessons).items():
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
            print(path)
    for path in COURSE.rglob("*.*"):
        if path not in lessons:
            path.unlink()
            print(f"{path} is removed")


if __name__ == "__main__":
    main()
