"""The card: a folder of the host, a FAT32 image or a block device, used in the same way."""

from passo.card.api import Card, Entry, Reader, Writer
from passo.card.folder import FolderCard

__all__ = ["Card", "Entry", "FolderCard", "Reader", "Writer"]
