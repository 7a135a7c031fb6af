"""Lines of a console on their way into a file."""

from __future__ import annotations

from passo.card import Writer
from passo.errors import CardError


class Upload:
    """Lines of one console that go into a file instead of being carried out, until M29; with `log`
    they are carried out as well. Without a writer, because none could be opened, they go nowhere.
    """

    def __init__(self, writer: Writer | None, name: str, *, log: bool = False) -> None:
        self.writer, self.name, self.log = writer, name, log
        self.numbered = False  # its lines come with numbers
        self.told = False  # the console has heard that its lines go nowhere
        self._failure: CardError | None = None

    @property
    def takes_all(self) -> bool:
        """There is a file, and its lines are for nothing else."""
        return self.writer is not None and not self.log

    def write(self, text: str) -> None:
        """Takes one line, byte by byte as it came. Raises CardError with the first that cannot be
        written; those behind it go nowhere, and `finish` says the same."""
        if self.writer is None or self._failure:
            return
        try:
            self.writer.write(text.encode("ascii", "surrogateescape") + b"\n")
        except CardError as error:
            self._failure = error
            raise

    def lose(self, reason: str) -> None:
        """One of its lines was refused, which `finish` says."""
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
        """The card holds what it held before."""
        if self.writer is not None:
            self.writer.abort()
            self.writer = None
