"""The LEDs whose colours follow templates."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any

from passo.config.part_names import found_name
from passo.errors import CommandError

if TYPE_CHECKING:
    from passo.config.lights import Color
    from passo.errors import PassoError
    from passo.printer.live_rig import LiveRig
    from passo.printer.status import Status

_PERIOD_S = 0.5
_MAX_DEPTH = 16  # templates within templates
_COLOR = "two to four numbers from 0 to 1 with commas between them"

Values = Mapping[str, Any]


class FollowedTemplates:
    """The templates that the LEDs of one printer's lights follow. `failed` receives the error of a
    template; its LEDs follow it no longer."""

    def __init__(self, rig: LiveRig, failed: Callable[[PassoError], None]) -> None:
        self._rig, self._failed = rig, failed
        self._followed: dict[tuple[str, int], tuple[str, Values]] = {}  # by light and LED, from 0
        self._colors: dict[tuple[str, int], Color] = {}
        self._next_s = 0.0

    def reset(self) -> None:
        """Call this after the boards have started: no light follows a template."""
        self._followed.clear()
        self._colors.clear()

    def follow(self, light: str, leds: Iterable[int], template: str | None, values: Values) -> None:
        """Lets LEDs, from 0, follow a template with these values of its variables; None: they have
        their own colours again."""
        for led in leds:
            self._followed.pop((light, led), None)
            self._colors.pop((light, led), None)
            if template is not None:
                self._followed[light, led] = template, values
        self._next_s = 0.0

    @property
    def active(self) -> bool:
        """Whether a light follows a template."""
        return bool(self._followed)

    def paint(
        self, now_s: float, found: dict[str, list[Color]], base: Callable[[str], Iterable[Color]]
    ) -> None:
        """Adds the colours of the templates to those of the lights that are `found`; `base` gives
        the colours of another light."""
        if self._followed and now_s >= self._next_s:
            self._next_s = now_s + _PERIOD_S
            self._compute()
        for (light, led), color in self._colors.items():
            found.setdefault(light, list(base(light)))[led] = color

    def _compute(self) -> None:
        status = self._rig.commands.status()
        done: dict[str, Color | None] = {}  # LEDs with equal values share a colour
        for place, (template, values) in list(self._followed.items()):
            key = f"{template} {values}"
            if key not in done:
                done[key] = self._color(template, values, status)
            color = done[key]
            if color is None:
                del self._followed[place]
                self._colors.pop(place, None)
            else:
                self._colors[place] = color

    def _color(self, template: str, values: Values, status: Status) -> Color | None:
        try:
            return color_of(template, self._text(template, values, status, 1))
        except CommandError as error:
            self._failed(error)
            return None

    def _text(self, name: str, values: Values, status: Status, depth: int) -> str:
        found = self._rig.machine.light_templates[name]

        def render(other: object, **arguments: Any) -> str:
            known = found_name(self._rig.machine.light_templates, str(other))
            if known is None or depth >= _MAX_DEPTH:
                limit = f"a template in light_templates, within at most {_MAX_DEPTH} others"
                raise CommandError.of("command.value", axis="render", value=str(other), limit=limit)
            return self._text(known, arguments, status, depth + 1)

        variables = {**found.variables, **values, "render": render}
        return self._rig.macros.value(f"light_templates.{name}", found.color, variables, status)


def color_of(template: str, text: str) -> Color:
    """The colour that a template has written. Raises CommandError."""
    try:
        shares = [min(max(float(part), 0.0), 1.0) for part in text.split(",")]
    except ValueError:
        shares = []
    if not 2 <= len(shares) <= 4:
        written = " ".join(text.split())[:60] or "nothing"
        raise CommandError.of("command.value", axis=template, value=written, limit=_COLOR)
    red, green, blue, white = [*shares, 0.0, 0.0][:4]
    return red, green, blue, white
