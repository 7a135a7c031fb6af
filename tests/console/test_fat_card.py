"""A FAT32 image as the card of a printer: uploaded, printed, full."""

import errno
import os
import subprocess

import pytest
from tests.support.card_devices import BlockDevice
from tests.support.card_images import ENVIRONMENT, run
from tests.support.scenario import Scenario

from passo.errors import CardError


@pytest.fixture
def image(tmp_path):
    path = tmp_path / "card.img"
    with path.open("wb") as file:
        file.truncate(34 << 20)
    run("mkfs.fat", "-F", "32", path)
    return path


def clean(image):
    words = ["fsck.fat", "-n", str(image)]
    found = subprocess.run(words, env=ENVIRONMENT, capture_output=True, check=False)
    return found.returncode == 0


def test_uploaded_file_prints_and_survives(image):
    with Scenario("i3", card=str(image)) as s:
        assert s.host.ok("M28 a long name.gcode")[0] == "Writing to file: a long name.gcode"
        for line in ("G28 X", "G1 X12 F6000", "M29"):
            s.host.ok(line)
        assert s.host.ok("M20")[1] == "ALONGN~1.GCO 19"
        s.host.ok("M32 ALONGN~1.GCO")
        s.host.expect("Done printing", 60)
        assert s.positions()["x"] == 12.0
    assert clean(image)
    with Scenario("i3", card=str(image)) as s:
        assert 'ALONGN~1.GCO 19 "a long name.gcode"' in s.host.ok("M20 L")
        s.host.ok("M30 A LONG NAME.GCODE")
        assert len(s.host.ok("M20")) == 3
    assert clean(image)


def test_a_block_device_is_printed_from_and_released(image, monkeypatch):
    device = BlockDevice(image, monkeypatch)
    with Scenario("i3", card=str(image)) as s:
        s.host.ok("M28 a long name.gcode")
        for line in ("G28 X", "G1 X12 F6000", "M29"):
            s.host.ok(line)
        s.host.ok("M32 ALONGN~1.GCO")
        s.host.expect("Done printing", 60)
        assert s.positions()["x"] == 12.0
        s.host.ok("M22")
        mounted = os.open(image, os.O_RDONLY | os.O_EXCL)  # refused if the card still had it
        assert "in use: it is mounted" in s.host.ok("M21")[0]
        os.close(mounted)
        assert s.host.ok("M21")[0] == "SD card ok"
        assert s.host.ok("M20 L")[1] == 'ALONGN~1.GCO 19 "a long name.gcode"'
        with pytest.raises(OSError, match="busy"):
            os.open(image, os.O_RDONLY | os.O_EXCL)
    assert [bool(flags & os.O_EXCL) for flags in device.opened] == [True] * 3
    assert clean(image)


def test_a_full_card_keeps_its_files_and_reports_it(image):
    with Scenario("i3", card=str(image)) as s:
        s.host.ok("M28 a.g")
        s.host.ok("G28 X")
        s.host.ok("M29")
        s.host.ok("M28 a.g")
        line = b"M117 " + b"y" * 4000 + b"\n"
        for _ in range(36):
            s.host.send_bytes(line * 256)
        told = [heard for heard in s.host.heard if "the card is full" in heard]
        assert len(told) == 1  # with the first line that is not kept
        answer = s.host.ok("M29", 10)[0]
        assert answer.startswith("echo:error writing to file a.g: ")
        assert "the card is full" in answer
        s.host.ok("M32 a.g")
        s.host.expect("Done printing", 60)
    assert clean(image)


def test_regular_file_is_not_accepted_as_a_card(tmp_path):
    (tmp_path / "not.img").write_bytes(b"no file system" * 1000)
    with pytest.raises(CardError, match="FAT32"), Scenario("i3", card=str(tmp_path / "not.img")):
        pass


def test_nothing_is_stored_in_an_image_that_was_deleted(image):
    with Scenario("i3", card=str(image)) as s:
        s.host.ok("M28 a.g")
        s.host.ok("G28 X")
        image.unlink()
        answer = s.host.ok("M29")[0]
        assert answer.startswith("echo:error writing to file a.g: ")
        assert "was removed while in use, or fails: it was deleted" in answer


def test_a_device_that_refuses_to_be_written_is_write_protected(image, monkeypatch):
    """As loop devices, and those of blockdev --setro, do only then."""

    def refused(*_):
        raise OSError(errno.EPERM, os.strerror(errno.EPERM))

    with Scenario("i3", card=str(image)) as s:
        monkeypatch.setattr(os, "pwrite", refused)
        assert "it is write-protected" in s.host.ok("M28 a.g")[0]
        assert s.host.ok("M29") == ["ok"]
        assert s.host.ok("M20")[0] == "Begin file list"
