"""The SD card: a folder of the host, a FAT32 image or a block device, used in the same way.

`open_card(path)` returns a `Card`; `api.py` defines its interface. This package does not depend on
printers.
"""

from pathlib import Path

from passo.card.api import Card, Entry, Reader, Writer
from passo.card.folder import FolderCard

__all__ = ["Card", "Entry", "FolderCard", "Reader", "Writer", "open_card"]


def open_card(path: str | Path) -> Card:
    """The card at a path: a folder as such, anything else as a FAT32 image or block device.

    Raises CardError: `card.absent`, `card.busy`, `card.format`.
    """
    if Path(path).is_dir():
        return FolderCard(path)
    from passo.card.fat import FatCard

    return FatCard(path)
