"""A conversion in progress, which the parts of a configuration share."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from passo.config.importing.draft import Place
from passo.errors import ConfigError

if TYPE_CHECKING:
    from collections.abc import Callable

    from passo.config.importing.draft import Draft, KeyPath
    from passo.config.importing.marlin.boards import Pins
    from passo.config.importing.marlin.defines import Defines
    from passo.config.importing.numbers import Read


@dataclass
class Job:
    """The input and the output of the conversion, and results that its steps share. With `mk4duo`,
    sensors have the numbers of MK4duo and StuFW, which differ from Marlin's."""

    defines: Defines
    draft: Draft
    pins: Pins
    mk4duo: bool
    kind: str = "cartesian"
    extruders: int = 1
    hotends: dict[int, str] = field(default_factory=dict[int, str])
    trigger_mm: float | None = None

    def needed(self, *names: str) -> Read:
        """A number that every machine needs. Raises ConfigError if it is missing."""
        found = self.defines.number(*names)
        if found is None:
            raise ConfigError.of("import.define", str(self.defines.files[0]), value=names[0])
        return found

    def needed_list(self, *names: str) -> list[Read]:
        """Numbers that every machine needs, at least four. Raises ConfigError if they are
        missing."""
        found = self.defines.numbers(*names)
        if found is None or len(found) < 4:
            raise ConfigError.of("import.define", str(self.defines.files[0]), value=names[0])
        return found

    def put(self, path: KeyPath, found: Read | None, scale: float = 1.0) -> None:
        """Sets a key to a number that was read, times `scale`."""
        if found is not None:
            self.draft.put(path, plain(found.value * scale), found.place)

    def part(self, name: str, convert: Callable[[], None]) -> bool:
        """Converts a part by the define that asks for it. If that is not possible, the part is left
        out, which is reported, and the result is False."""
        found = self.defines.found.get(name)
        place = found[1] if found else Place(self.defines.files[0].name, 1)
        return self.draft.attempt(place, name, convert, "the part")

    def place(self, *names: str) -> Place:
        """The place of the first of these that is defined; at least one is."""
        name = self.defines.first(*names)
        assert name is not None
        return self.defines.place(name)

    def decide(self, name: str, text: str) -> None:
        """Reports a define that the user has to decide about."""
        self.draft.decide(self.place(name), name, text)

    def changed(self, name: str, text: str) -> None:
        """Reports a define that the machine file has in another form."""
        self.draft.changed(self.place(name), name, text)

    def dropped(self, name: str, text: str) -> None:
        """Reports a define that the machine file does not have."""
        self.draft.dropped(self.place(name), name, text)


def plain(value: float) -> float:
    """A number without the rounding error of its calculation."""
    return float(f"{value:.10g}")
