"""Progress of a print from the card: M27, M73, M408."""

import json
import re

import pytest
from tests.support.card_print import printed


def test_card_progress_is_reported_automatically(s):
    s.host.ok("M27 S1")
    s.host.expect("^Not SD printing", 2)
    s.host.ok("M32 square.gcode")
    s.host.expect("^SD printing byte", 2)
    s.host.ok("M27 S0")
    s.host.silent(3, "^SD printing")
    assert s.host.ok("M27 C")[0] == "Current file: square.gcode"


def test_progress_is_by_time_not_by_bytes(s, folder):
    # The second half of the bytes takes a tenth of the time.
    slow = "".join(f"G1 X{10 + i % 2 * 100} F1000\n" for i in range(1, 31))
    fast = "".join(f"G1 X{10 + i % 2 * 100} F9999\n" for i in range(1, 31))
    (folder / "two.g").write_text("G28 X\nG1 X10 F6000\n" + slow + fast)
    s.host.ok("M32 two.g")
    start = s.loop.time()
    s.passes(60)
    shown = float(re.search(r"([\d.]+)%", s.host.ok("M73")[0])[1])
    printed(s, 300)
    whole = s.loop.time() - start
    assert shown == pytest.approx(100 * 55 / whole, abs=5)
    assert s.host.ok("M73")[0] == "echo:Progress: nothing is printed"


def test_progress_counts_on_after_a_line_that_failed(s, folder):
    way = "".join(f"G1 X{10 + i % 2 * 50} F600\n" for i in range(20))
    (folder / "half.g").write_text(f"G28 X\n{way}G1 E10001\n{way}")
    s.host.ok("M32 half.g")
    s.host.expect("Print of half.g stopped", 200)
    s.until(lambda: s.printer.rig.queue.standing, 10)
    s.host.ok("M24")
    s.passes(0.1)
    assert float(re.search(r"([\d.]+)%", s.host.ok("M73")[0])[1]) == pytest.approx(50, abs=5)


def test_progress_from_mid_file_counts_bytes_before(s, folder):
    way = "".join(f"G1 X{10 + i % 2 * 50} F600\n" for i in range(40))
    (folder / "a.g").write_text(f"G28 X\n{way}")
    s.host.ok("G28 X", 100)
    s.host.ok("M23 a.g")
    s.host.ok(f"M26 S{len('G28 X ') + len(way) // 4 * 3}")
    s.host.ok("M24")
    for seconds, percent in ((0.5, 75), (25, 87.5)):
        s.passes(seconds)
        assert float(re.search(r"([\d.]+)%, ", s.host.ok("M73")[0])[1]) == pytest.approx(
            percent, abs=1.5
        )
        at = json.loads(s.host.ok("M408 S3")[0])["fractionPrinted"]
        assert at == pytest.approx(percent, abs=1.5)


def test_progress_of_slicer_counts_before_bytes(s, folder):
    (folder / "a.g").write_text("G92 X0 Y0 Z0\n" + "G1 X100 F600\nG1 X0\n" * 9 + "G2 X10\n")
    s.host.ok("M32 a.g")
    s.passes(2)
    assert "% of the file" in s.host.ok("M73")[0]
    s.host.ok("M73 P10 R7")
    assert s.host.ok("M73")[0] == "echo:Progress: 10%, 7 min left"
    assert json.loads(s.host.ok("M408 S3")[0])["fractionPrinted"] == 10
    s.host.ok("M524")
    assert s.host.ok("M73")[0] == "echo:Progress: nothing is printed"
    assert json.loads(s.host.ok("M408 S3")[0])["fractionPrinted"] == 0
    s.host.ok("M26 S13")  # of the next print, too, nothing is known yet
    s.host.ok("M24")
    s.passes(1)
    assert "% of the file" in s.host.ok("M73")[0]
