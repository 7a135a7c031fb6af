"""Which announcements become proposals."""

from __future__ import annotations

import socket

import pytest
from zeroconf.asyncio import AsyncServiceInfo

from passo.hub.discovery import SERVICE, proposed
from passo.hub.proposals import ProposedPrinter

ID = "568f4574-127e-461e-b743-b1ef93b7c0c7"


def announced(address: str = "192.168.1.7", **texts: str) -> AsyncServiceInfo:
    family = socket.AF_INET6 if ":" in address else socket.AF_INET
    return AsyncServiceInfo(
        SERVICE,
        f"i3 on pi.{SERVICE}",
        4000,
        addresses=[socket.inet_pton(family, address)],
        properties=texts,
    )


@pytest.mark.parametrize(
    ("info", "found"),
    [
        (announced(id=ID, name="Left"), ProposedPrinter(ID, "Left", "http://192.168.1.7:4000")),
        (announced(id=ID), ProposedPrinter(ID, "i3 on pi", "http://192.168.1.7:4000")),
        (announced("fd00::7", id=ID), ProposedPrinter(ID, "i3 on pi", "http://[fd00::7]:4000")),
        (announced(name="Left"), None),
        (AsyncServiceInfo(SERVICE, f"i3.{SERVICE}", 4000, properties={"id": ID}), None),
    ],
    ids=["named", "unnamed", "IPv6", "no id", "no address"],
)
def test_announcement_becomes_a_proposal(info, found):
    assert proposed(info) == found
