"""Lines of a console that are written to a file."""

from __future__ import annotations

from passo.card import Writer
from passo.errors import CardError


class Upload:
    """Lines of one console that are written to a file instead of being carried out, until M29; with
    `log` they are carried out as well. Without a writer, because none could be opened, they are
    discarded."""

    def __init__(self, writer: Writer | None, name: str, *, log: bool = False) -> None:
        self.writer, self.name, self.log = writer, name, log
        self.numbered = False  # its lines are numbered
        self.told = False  # the console was told that its lines are discarded
        self._failure: CardError | None = None

    @property
    def takes_all(self) -> bool:
        """Whether there is a file, and its lines are not carried out."""
        return self.writer is not None and not self.log

    def write(self, text: str) -> None:
        """Writes one line, byte by byte as it came. Raises CardError with the first line that
        cannot be written; later lines are discarded, and `finish` raises the same error."""
        if self.writer is None or self._failure:
            return
        try:
            self.writer.write(text.encode("ascii", "surrogateescape") + b"\n")
        except CardError as error:
            self._failure = error
            raise

    def lose(self, reason: str) -> None:
        """Records that one of its lines was refused; `finish` reports it."""
        self._failure = self._failure or CardError.of("card.line-refused", self.name, value=reason)

    def finish(self) -> bool:
        """Makes the file durable; False if there is none. Raises CardError: then the card holds
        what it held before."""
        if self.writer is None:
            return False
        if self._failure:
            self.writer.abort()
            raise self._failure
        self.writer.close()
        return True

    def abort(self) -> None:
        """Discards the file: the card holds what it held before."""
        if self.writer is not None:
            self.writer.abort()
            self.writer = None
