"""The fans of the tools: which fans M106 without P sets, and how fast."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

    from passo.config.machine import MachineConfig


class ToolFans:
    """The fans of each tool, with its factor. A speed that is commanded without a fan stays when
    the tool changes. Speeds are 0 to 1. `tool` is the active tool."""

    def __init__(self, machine: MachineConfig) -> None:
        first = (n for n, fan in machine.fans.items() if fan.commanded and fan.number == 0)
        usual = tuple(first)[:1]
        self._usual = (usual, 1.0)
        self._tools = [(tuple(t.fans) or usual, t.fan_factor) for t in machine.all_tools]
        self._differ = len(set(self._tools)) > 1
        self._fans = dict.fromkeys(name for fans, _ in self._tools for name in fans)
        self.tool = 0
        self._speed = 0.0

    def set_speed(self, speed: float) -> Mapping[str, float]:
        """Sets the speed of the program. Returns that of each fan of the active tool."""
        self._speed = speed
        return self._speeds()

    def change(self, tool: int, now: Mapping[str, float]) -> Mapping[str, float]:
        """Changes to this tool. Returns the new speeds of fans: those of other tools are off. If
        something else has switched the fans of the old tool off or on, as their speeds `now` show,
        the speed of the program is that."""
        fans, factor = self._of(self.tool)
        on = max((now.get(name, 0.0) for name in fans), default=0.0)
        if factor > 0 and (on > 0) != (self._speed > 0):
            self._speed = min(on / factor, 1.0)
        self.tool = tool
        if not self._differ:
            return {}
        return dict.fromkeys(self._fans, 0.0) | self._speeds()

    def _speeds(self) -> dict[str, float]:
        fans, factor = self._of(self.tool)
        return dict.fromkeys(fans, min(self._speed * factor, 1.0))

    def _of(self, tool: int) -> tuple[tuple[str, ...], float]:
        """The fans and the factor of a tool."""
        return self._tools[tool] if 0 <= tool < len(self._tools) else self._usual
