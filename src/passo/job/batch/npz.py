"""Arrays in NumPy's .npz format, written without NumPy.

A .npz is a zip of .npy files; a .npy is a magic, a version, a header dict and the raw values
(NumPy enhancement proposal 1).
"""

from __future__ import annotations

import os
import zipfile
from collections.abc import Mapping
from pathlib import Path

from passo.job.durable_files import replaced

INT64, INT8, FLOAT64 = "<i8", "|i1", "<f8"
_SIZES = {INT64: 8, INT8: 1, FLOAT64: 8}


def npy_header(kind: str, count: int | None) -> bytes:
    """The header of a .npy file, padded to 64 bytes, for `count` values in a row, or a single value
    (None)."""
    shape = "()" if count is None else f"({count},)"
    text = f"{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}"
    room = -(10 + len(text) + 1) % 64
    text += " " * room + "\n"
    return b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text.encode("latin-1")


def write_npz(
    path: str | os.PathLike[str], arrays: Mapping[str, tuple[str, bytes | bytearray]], alone: str
) -> None:
    """Writes `arrays`: name → (kind, raw little-endian values). A name in `alone` is written as a
    single value. The file appears completely or not at all. Raises OSError.
    """
    with (
        replaced(Path(path)) as temporary,
        zipfile.ZipFile(temporary, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive,
    ):
        for name, (kind, data) in arrays.items():
            entry = zipfile.ZipInfo(f"{name}.npy", (1980, 1, 1, 0, 0, 0))
            entry.compress_type = zipfile.ZIP_DEFLATED
            with archive.open(entry, "w", force_zip64=True) as member:
                count = None if name == alone else len(data) // _SIZES[kind]
                member.write(npy_header(kind, count))
                member.write(data)
