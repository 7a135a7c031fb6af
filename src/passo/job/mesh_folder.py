"""Stored meshes as files in the state folder; each file is complete or absent."""

from __future__ import annotations

from dataclasses import replace
from datetime import datetime
from pathlib import Path

from passo.errors import CommandError
from passo.job.durable_files import fsync_directory, replaced
from passo.levelling.mesh_files import MeshStore, StoredMesh, from_csv, to_csv

_SUFFIX = ".csv"
_MAX_BYTES = 1 << 20


class MeshFolder(MeshStore):
    """The meshes in a folder, one file for each. Files that do not contain a mesh stay
    unchanged."""

    def __init__(self, folder: Path) -> None:
        super().__init__()
        self._folder = folder
        for path in sorted(folder.glob(f"*{_SUFFIX}")):
            try:
                if path.stat().st_size > _MAX_BYTES:
                    raise OSError
                self.all[path.stem] = from_csv(path.read_text("utf-8"), path.stem)
            except (OSError, UnicodeDecodeError):
                self.refused.append(CommandError.of("levelling.mesh-unreadable", str(path)))
            except CommandError as error:
                self.refused.append(error)

    def save(self, stored: StoredMesh) -> None:
        """Stores a mesh with the date of today. When this returns, the mesh survives a power cut.
        Raises CommandError; then the file is unchanged."""
        stored = replace(stored, date=datetime.now().astimezone().strftime("%Y-%m-%d %H:%M"))
        path = self._folder / (stored.name + _SUFFIX)
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            with replaced(path) as temporary:
                temporary.write_text(to_csv(stored), "utf-8")
        except OSError as error:
            reason = str(error.strerror)
            raise CommandError.of("levelling.mesh-unwritable", str(path), value=reason) from None
        super().save(stored)

    def remove(self, name: str) -> None:
        """Removes a mesh and its file. Raises CommandError."""
        super().remove(name)
        path = self._folder / (name + _SUFFIX)
        try:
            path.unlink(missing_ok=True)
            fsync_directory(self._folder)
        except OSError as error:
            reason = str(error.strerror)
            raise CommandError.of("levelling.mesh-unwritable", str(path), value=reason) from None
