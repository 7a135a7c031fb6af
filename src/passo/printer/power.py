"""Whether the power supply of motors and heaters is on."""

from __future__ import annotations

from passo.errors import CommandError


class Power:
    """The power supply of one printer. `on` is always true without a pin that switches it."""

    def __init__(self) -> None:
        self.on = True

    def require(self) -> None:
        """Raises CommandError while the power supply is off."""
        if not self.on:
            raise CommandError.of("command.no-mains")
