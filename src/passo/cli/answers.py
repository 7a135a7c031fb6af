"""Stores the user's answers in a file until the last question, so that an interrupted session can
continue."""

from __future__ import annotations

import sys
from collections import deque
from pathlib import Path

from passo.errors import InputError


class Answers:
    """Answers from standard input. Answers that `path` has from an interrupted session come first,
    as if they were typed again. `of` identifies the session. Raises InputError if the file belongs
    to another session, or cannot be written."""

    def __init__(self, path: Path, of: str) -> None:
        self.path = path
        try:
            if not path.exists():
                self._keep(of)
            first, *kept = path.read_text(encoding="utf-8", errors="replace").splitlines() or [""]
        except OSError as error:
            raise _unwritable(path, error) from None
        if first != of:
            raise InputError.of("input.other-answers", str(path), value=first, limit=of)
        self.again = len(kept)
        self._none = not kept
        self._kept = deque(kept)  # stored answers that are not used yet

    def ask(self, question: str) -> str | None:
        """Asks a question; returns the answer without surrounding blanks, or None if the input has
        ended."""
        print(question, end="", flush=True)
        if self._kept:
            print(self._kept[0])
            return self._kept.popleft()
        answer = sys.stdin.readline()
        if not answer:
            if self._none:
                self.forget()
            return None
        self._none = False
        self._keep(answer.strip())
        return answer.strip()

    def _keep(self, line: str) -> None:
        try:
            with self.path.open("a", encoding="utf-8", errors="replace") as file:
                file.write(f"{line}\n")
        except OSError as error:
            raise _unwritable(self.path, error) from None

    def forget(self) -> None:
        """Deletes the stored answers. Call it when all questions are answered."""
        self.path.unlink(missing_ok=True)


def _unwritable(path: Path, error: OSError) -> InputError:
    return InputError.of("output.unwritable", str(path), value=error.strerror or str(error))
