"""The machine file as the sections of a printer.cfg, for the keys that clients and macros read."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from passo.config.exporting.settings import typed

if TYPE_CHECKING:
    from collections.abc import Mapping

    from passo.config.exporting.settings import Sections

Object = dict[str, Any]

# Clients warn if these macros are missing, although Passo has the commands without them.
_BUILT_IN = ("PAUSE", "RESUME", "CANCEL_PRINT")


def configfile(sections: Sections, folder: str, unsaved: Mapping[str, Mapping[str, str]]) -> Object:
    """The object configfile. Its `settings` are typed values in lower-case sections, with the
    defaults of Klipper; its `config` has the values of the machine as texts. `folder` is the folder
    of the card, or empty; `unsaved` are the settings that SAVE_CONFIG would store."""
    own = {name.lower() for name in sections.texts}
    added = {
        f"gcode_macro {name}": {"gcode": name}
        for name in _BUILT_IN
        if f"gcode_macro {name}".lower() not in own
    }
    card = {
        name: value for name, value in sections.texts["virtual_sdcard"].items() if name != "path"
    }
    added["virtual_sdcard"] = card | ({"path": folder} if folder else {})
    return {
        "settings": {
            **sections.settings,
            **{name.lower(): typed(name, values) for name, values in added.items()},
        },
        "config": sections.texts | added,
        "warnings": [],
        "save_config_pending": bool(unsaved),
        "save_config_pending_items": {name: dict(values) for name, values in unsaved.items()},
    }
