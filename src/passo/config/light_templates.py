"""Templates of colours, which lights follow."""

from __future__ import annotations

from typing import Any

from passo.config.types import Model, PartName, VariableName


class LightTemplate(Model):
    """A template whose text is a colour. SET_LED_TEMPLATE lets LEDs follow it: its text is computed
    twice a second."""

    color: str
    """The template, in the language of macros: it writes red, green, blue and perhaps white, from 0
    to 1, with commas between them. `{render("NAME")}` writes another template's text."""
    variables: dict[VariableName, Any] = {}
    """Variables of the template. SET_LED_TEMPLATE sets them for its LEDs."""


LightTemplates = dict[PartName, LightTemplate]
