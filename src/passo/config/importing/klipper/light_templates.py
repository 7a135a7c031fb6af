"""[display_template]: the templates that SET_LED_TEMPLATE may name."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from passo.config.macros import literal
from passo.config.part_names import part_name
from passo.config.types import VARIABLE

if TYPE_CHECKING:
    from passo.config.importing.klipper.cfg import Section
    from passo.config.importing.klipper.conversion import Import


def put_light_templates(job: Import) -> None:
    """Imports the templates of a printer with lights. Without SET_LED_TEMPLATE, they are those of a
    display."""
    sections = job.config.sections.values()
    texts = (option.text.upper() for section in sections for option in section.options.values())
    if not any("SET_LED_TEMPLATE" in text for text in texts):
        return
    for section in job.config.of("display_template"):
        job.part(section, _put, "the template")


def _put(job: Import, section: Section) -> None:
    name = part_name(section.rest)
    job.put("display_template", section, name=name)
    for option, found in section.options.items():
        if not option.startswith("param_"):
            continue
        section.used.add(option)
        try:
            value = literal(found.text)
        except ValueError:
            value = None
        if not re.fullmatch(VARIABLE, option) or not isinstance(value, bool | int | float | str):
            raise section.wrong(option, "a number or a text in quotes")
        job.draft.put(("light_templates", name, "variables", option), value, found.place)
