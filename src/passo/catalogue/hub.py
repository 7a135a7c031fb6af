"""Errors of the farm: `passo hub`."""

from __future__ import annotations

from collections.abc import Mapping

from passo.catalogue.entry import Entry, ExitStatus


def _hub(says: str, action: str) -> Entry:
    return Entry("hub", says, action, ExitStatus.USAGE)


HUB: Mapping[str, Entry] = {
    "hub.unreachable": _hub(
        "{axis} does not answer: {value}",
        "Check that the printer is on and that its address is right",
    ),
    "hub.refused": _hub("{axis} refuses: {value}", "Look at the page of the printer"),
    "hub.code": _hub(
        "{axis} needs a one-time code",
        "Make one on the page of the printer: Settings, Let a farm in. It is valid for ten minutes",
    ),
    "hub.address": _hub("{value!r} is not the address of a printer", "Give it as http://HOST:PORT"),
    "hub.known": _hub(
        "{axis} is in the farm already, as {value}", "Remove that printer first, or keep it"
    ),
    "hub.state": _hub("{axis} is {value}, which this does not fit", "Wait, or end the run first"),
    "hub.file-used": _hub(
        "{value} is needed by {limit} jobs that are not done", "Cancel these jobs first"
    ),
    "hub.power": _hub(
        "{axis} takes {value} W while it heats, and its power group allows {limit} W",
        "Raise the limit of the group, or choose another group",
    ),
    "hub.limited": _hub(
        "{value} may not use {axis}",
        "Ask an administrator of the farm to add one of its tags to the account",
    ),
    "hub.no-space": _hub(
        "{axis} does not fit on the disk of the hub: {limit} bytes are free",
        "Remove files that no job needs, then send it again",
    ),
    "hub.store": Entry(
        "hub",
        "the data of the farm cannot be used: {value}",
        "Check the folder of --state, its permissions and the free space on the disk",
        ExitStatus.MACHINE_FAULT,
    ),
    "hub.package": _hub("{value} is not installed", "Install it: pip install 'passo[hub]'"),
}
