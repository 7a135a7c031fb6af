"""Settings that commands can change, with the source of each value."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta, Struct

from passo.errors import WebError
from passo.gcode.command import numeral
from passo.job.settings_store import Setting
from passo.web.bridge import SettingValue
from passo.web.call import Call
from passo.web.operation import operation
from passo.web.roles import Role


class NewValue(Struct, forbid_unknown_fields=True):
    """A value to set; `settings.list` gives `command` and `word`. The value is a number, or a name
    such as that of an input shaper."""

    command: Annotated[str, Meta(max_length=100)]
    word: Annotated[str, Meta(max_length=40)]
    value: (
        Annotated[float, Meta(ge=-1e9, le=1e9)]
        | Annotated[str, Meta(max_length=40, pattern=r"^[A-Za-z0-9_]+$")]
    )


_ERRORS = ("command.value", "command.halted", "command.failed")


@operation("settings.list", "GET", "/settings", Role.VIEWER)
async def settings(call: Call) -> list[SettingValue]:
    """All settings. `source` is the source of the active value: `file` (the machine file or its
    defaults), `stored` (M500), or `command` (changed since)."""
    return await call.bridge.settings()


@operation("settings.set", "PUT", "/settings", Role.OPERATOR, errors=("web.not-found", *_ERRORS))
async def set_value(call: Call, body: NewValue) -> None:
    """Sets a value until the printer is restarted, or until `settings.store` stores it."""
    known = {(setting.command, setting.word) for setting in await call.bridge.settings()}
    if (body.command, body.word) not in known:
        raise WebError.of("web.not-found", value=f"setting {body.command} {body.word}")
    value = body.value if isinstance(body.value, str) else numeral(body.value)
    await call.commands(Setting(body.command, body.word, value).call())


@operation(
    "settings.store",
    "POST",
    "/settings/store",
    Role.OPERATOR,
    errors=("settings.nowhere", "settings.unwritable", *_ERRORS),
)
async def store(call: Call) -> None:
    """Stores the values that differ from the machine file (M500), durably."""
    await call.command("M500")


@operation(
    "settings.load",
    "POST",
    "/settings/load",
    Role.OPERATOR,
    errors=("settings.nowhere", "settings.none", "settings.unreadable", *_ERRORS),
)
async def load(call: Call) -> None:
    """Restores the stored values (M501)."""
    await call.command("M501")


@operation("settings.reset", "POST", "/settings/reset", Role.OPERATOR, errors=_ERRORS)
async def reset(call: Call) -> None:
    """Restores the values of the machine file (M502); stored values stay stored."""
    await call.command("M502")
