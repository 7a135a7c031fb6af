"""Writes lines of a console to a file."""

from __future__ import annotations

from passo.card import Writer
from passo.errors import CardError


class Upload:
    """Writes the lines of one console to a file until M29, instead of executing them; with `log`
    they are executed too. Without a writer, because the file could not be opened, the lines are
    discarded."""

    def __init__(self, writer: Writer | None, name: str, *, log: bool = False) -> None:
        self.writer, self.name, self.log = writer, name, log
        self.numbered = False  # whether its lines are numbered
        self.reported = False  # whether the console was informed that its lines are discarded
        self._failure: CardError | None = None

    @property
    def takes_all(self) -> bool:
        """Whether all lines go into a file without being executed."""
        return self.writer is not None and not self.log

    def write(self, text: str) -> None:
        """Writes one line with exactly its received bytes. Raises CardError for the first line that
        cannot be written; later lines are discarded, and `finish` raises the same error."""
        if self.writer is None or self._failure:
            return
        try:
            self.writer.write(text.encode("ascii", "surrogateescape") + b"\n")
        except CardError as error:
            self._failure = error
            raise

    def lose(self, reason: str) -> None:
        """Records that one of the lines was refused; `finish` raises this."""
        self._failure = self._failure or CardError.of("card.line-refused", self.name, value=reason)

    def finish(self) -> bool:
        """Makes the file durable. Returns False if there is no file. Raises CardError; then the
        card keeps its earlier content."""
        if self.writer is None:
            return False
        if self._failure:
            self.writer.abort()
            raise self._failure
        self.writer.close()
        return True

    def abort(self) -> None:
        """Discards the file; the card keeps its earlier content."""
        if self.writer is not None:
            self.writer.abort()
            self.writer = None
