"""What `--announce` makes known in the local network. The network is a list; a real one was looked
at by hand."""

import asyncio

import pytest
from tests.web.local_site import ID

import passo
from passo.errors import InputError
from passo.web.announcement import Announcement


class Registry:
    def __init__(self, refusal=None):
        self.services, self.closed, self.refusal = [], False, refusal

    async def async_register_service(self, info, *, allow_name_change=False):
        assert allow_name_change  # two printers of one name
        if self.refusal:
            raise self.refusal
        self.services.append(info)

    async def async_close(self):
        self.closed = True


def test_slicers_and_browsers_find_the_page_until_the_end():
    async def main():
        announcement, registry = Announcement("i3", "192.168.1.5", 4000, ID), Registry()
        running = asyncio.ensure_future(announcement.run(lambda: registry))
        await asyncio.sleep(0)
        await asyncio.sleep(0)
        assert not running.done()
        assert [one.type for one in registry.services] == [
            "_http._tcp.local.",
            "_octoprint._tcp.local.",
            "_passo._tcp.local.",
        ]
        for one in registry.services:
            assert one.name.startswith("i3 on ") and one.name.endswith(one.type)
            assert (one.port, one.parsed_addresses()) == (4000, ["192.168.1.5"])
            assert one.properties[b"path"] == b"/"
            assert (one.properties[b"id"], one.properties[b"name"]) == (ID.encode(), b"i3")
            assert one.server == f"{announcement.host_name}."
        running.cancel()
        await asyncio.wait([running])
        assert registry.closed

    asyncio.run(main())


def test_long_names_fit_into_a_label():
    announcement = Announcement("ü" * 60, "::", 4000, ID)
    label = announcement.services[0].name.removesuffix("._http._tcp.local.")
    assert len(label.encode()) <= 63
    addresses = announcement.services[0].parsed_addresses()
    assert "127.0.0.1" not in addresses and "::1" not in addresses


def test_network_that_refuses_is_a_line_in_the_log(caplog):
    registry = Registry(OSError(101, "Network is unreachable"))
    asyncio.run(Announcement("i3", "192.168.1.5", 4000, ID).run(lambda: registry))
    assert "The printer is not announced: Network is unreachable" in caplog.text
    assert registry.closed


def test_web_interface_of_this_computer_alone_is_not_announced():
    async def main():
        async with passo.Printer("i3") as printer:
            printer.open_http(announce=True)

    with pytest.raises(InputError, match=r"only this computer reaches it at 127\.0\.0\.1"):
        passo.run(main())
