"""Line numbers, checksums and requests to send again, over links that damage what they carry."""

import random
import re
import tracemalloc

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from passo.gcode import line_protocol
from passo.gcode.line_protocol import LONGEST, Line, LineProtocol, Refusal

# Words by which OctoPrint knows that a resend follows and does not disconnect.
COMMUNICATION = re.compile("line number|linenumber|checksum|format error|expected line", re.I)


def checked(text):
    total = 0
    for byte in text.encode("latin-1"):
        total ^= byte
    return f"{text}*{total}"


def numbered(number, text):
    return checked(f"N{number} {text}")


def fed(protocol, *lines):
    return protocol.feed("".join(f"{line}\n" for line in lines).encode("latin-1"))


@pytest.fixture
def protocol():
    return LineProtocol()


def test_the_checksum_is_the_exclusive_or_of_all_before_it():
    assert numbered(0, "M110 N0") == "N0 M110 N0*125"  # as OctoPrint says hello
    assert numbered(1, "M115") == "N1 M115*39"


def test_numbered_lines_are_taken_in_their_order(protocol):
    assert fed(protocol, numbered(1, "M115"), numbered(2, "G1 X1")) == [
        Line("M115", 1),
        Line("G1 X1", 2),
    ]
    assert protocol.last == 2


@pytest.mark.parametrize(
    ("line", "reason"),
    [
        (numbered(5, "G1 X1")[:-1] + "9", "checksum mismatch"),
        ("N4 G1 X1", "No Checksum with line number"),
        (numbered(5, "G1 X1"), "Line Number is not Last Line Number+1"),
        (numbered(2, "G1 X1"), "Line Number is not Last Line Number+1"),
        (numbered(4, "G1 X1" + " " * LONGEST)[:-1] + "x", "No Checksum with line number"),
        (numbered(4, "M486 A" + "x" * LONGEST).replace("xx", "xy", 1), "checksum mismatch"),
        # A damaged N: in a stream with numbers nothing with a checksum comes without one.
        ("O" + numbered(4, "G1 X1")[1:], "checksum mismatch"),
        ("N", "checksum mismatch"),  # torn off by a line end that nobody sent
        ("73", "checksum mismatch"),
        (numbered(4, "G1 X1") + numbered(5, "G1 X2"), "checksum mismatch"),
    ],
)
def test_a_damaged_line_is_asked_for_again(protocol, line, reason):
    fed(protocol, numbered(0, "M110 N3"))
    (refusal,) = fed(protocol, line)
    assert refusal[:2] == (f"{reason}, Last Line: 3", 4)
    assert COMMUNICATION.search(reason)
    assert fed(protocol, numbered(4, "G1 X1")) == [Line("G1 X1", 4)]


@pytest.mark.parametrize(
    ("line", "last"),
    [
        ("N0 M110 N0*125", 0),
        (numbered(-1, "M110 N-1"), -1),
        (numbered(7, "M110"), 7),
        (numbered(9, "M110 L41"), 41),
        (numbered(9, "m110 n41"), 41),
        ("M110 N-1", -1),
        ("m110N12", 12),
        ("M110 L0", 0),
        ("M110", 77),
        ("M1100 N3", 77),
        (checked("M110 N-1"), -1),
        ("M110 N2147483646", 2147483646),
        (numbered(1, "M110 N2147483646"), 2147483646),
        (numbered(3_000_000_000, "M110"), 3_000_000_000),
        ("M110 N999999999999999998", 999_999_999_999_999_998),
        ("M110 N00000000000000000000012", 12),
    ],
)
def test_m110_sets_the_number_of_the_last_line(protocol, line, last):
    protocol.last = 77
    assert isinstance(fed(protocol, line)[0], Line)
    assert protocol.last == last
    assert fed(protocol, numbered(last + 1, "G28")) == [Line("G28", last + 1)]


@pytest.mark.parametrize("line", ["M110 N1234567890123456789", numbered(1, "M110 L" + "9" * 5000)])
def test_a_line_number_of_too_many_digits_sets_nothing(protocol, line):
    (refusal,) = fed(protocol, line)
    assert "the line number has more than 18 digits" in refusal.reason
    assert (refusal.resend, protocol.last) == (None, 0)


def of_size(number, text, size):
    """A numbered line of so many bytes."""
    for end in "xyz123":
        for count in (2, 3, 4):
            line = numbered(number, text.ljust(size - count - len(f"N{number} "), end))
            if len(line) == size:
                return line
    raise AssertionError(size)


@pytest.mark.parametrize("size", [4097, 5000, LONGEST - 1, LONGEST])
def test_a_long_line_is_taken(protocol, size):
    line = of_size(1, "EXCLUDE_OBJECT_DEFINE NAME=ring POLYGON=[[100.5,50.25],[10,20]] ", size)
    assert fed(protocol, line, numbered(2, "G1 X1")) == [
        Line(line[3 : line.rindex("*")], 1),
        Line("G1 X1", 2),
    ]


@pytest.mark.parametrize("over", [1, 2, 3, 15, 16, 17, 40, 3 * LONGEST])
def test_a_line_beyond_all_limits_is_left_out_and_counted(protocol, over):
    line = of_size(1, "M486 A", LONGEST + over)
    refusal, following = fed(protocol, line, numbered(2, "G1 X1"))
    assert refusal.reason == f"line 1 is longer than {LONGEST} characters and is left out"
    assert (refusal.resend, refusal.lost) == (None, True)
    assert following == Line("G1 X1", 2)
    (again,) = fed(protocol, line)  # out of its order, but known
    assert again == Refusal("line 1 has come already", None)


@pytest.mark.parametrize(
    "line", [numbered(1, "G1 X1 ;" + "c" * LONGEST), "G1 X1 ;" + "c" * LONGEST]
)
def test_a_comment_may_be_of_any_length(protocol, line):
    assert [found.text for found in fed(protocol, line)] == ["G1 X1"]


@pytest.mark.parametrize(
    "text",
    [
        "M486 S0 Aspanner 13*10.stl",
        "M486 Aspanner 13*10",
        "M486 S0 A2*3",
        "M117 3*4",
        "M0 screw M3*10",
        "M23 plate 2*3",
        "EXCLUDE_OBJECT_START NAME=plate_2*3",
        "PRINT_START PART=2*3",
    ],
)
@pytest.mark.parametrize("before", [[], [numbered(1, "G28")]])
def test_a_star_in_a_text_is_not_a_checksum(protocol, text, before):
    fed(protocol, *before)
    (found,) = fed(protocol, text)
    # Amid numbered lines a file's name or a message may be what is left of one.
    damaged = bool(before) and text.startswith(("M0", "M23"))
    assert found == (Line(text) if not damaged else Refusal("checksum mismatch, Last Line: 1", 2))


@pytest.mark.parametrize("text", ["G1 X10*3", "M104 S200*1", "X10*3", "T1*3"])
def test_a_wrong_checksum_of_words_is_asked_for_again(protocol, text):
    assert fed(protocol, text) == [Refusal("checksum mismatch, Last Line: 0", 1)]


def test_the_checksum_of_a_label_with_a_star_is_the_last_one(protocol):
    assert fed(protocol, numbered(1, "M486 Aspanner 13*10")) == [Line("M486 Aspanner 13*10", 1)]
    assert fed(protocol, checked("M486 Aspanner 13*10")) == [
        Refusal("checksum mismatch, Last Line: 1", 2)
    ]
    protocol = LineProtocol()
    assert fed(protocol, checked("M486 Aspanner 13*10")) == [Line("M486 Aspanner 13*10")]


def test_bare_lines_between_numbered_ones_change_no_count(protocol):
    found = fed(protocol, numbered(1, "G28"), "M105", "PRINT_START A=1", numbered(2, "G1 X1"))
    assert found == [
        Line("G28", 1),
        Line("M105"),
        Line("PRINT_START A=1"),
        Line("G1 X1", 2),
    ]


def test_a_line_that_comes_twice_is_taken_once(protocol):
    fed(protocol, numbered(1, "G1 X1"), numbered(2, "G1 X2"))
    for number in (1, 2):
        again = fed(protocol, numbered(number, f"G1 X{number}"))
        assert again == [Refusal(f"line {number} has come already", None)]
    assert fed(protocol, numbered(3, "G1 X1")) == [Line("G1 X1", 3)]


def test_a_host_that_restarts_its_numbers_gets_a_resend(protocol):
    fed(protocol, numbered(1, "G1 X1"), numbered(2, "G1 X2"))
    assert fed(protocol, numbered(1, "G28"))[0].resend == 3
    assert fed(protocol, "M110 N0", numbered(1, "G1 X1"))[1] == Line("G1 X1", 1)


@pytest.mark.parametrize(
    ("sent", "text"),
    [
        ("G1 X1 ; a comment", "G1 X1"),
        ("  g1 x1  ", "g1 x1"),
        ("G1 X1 ; 3*4", "G1 X1"),
        ("M117 a;b 5*3", "M117 a;b 5*3"),
        ("M118 A1 x;y", "M118 A1 x;y"),
        (checked("G1 X1"), "G1 X1"),
        ("G1\tX1", "G1\tX1"),
    ],
)
def test_line_without_number_is_taken_as_is(protocol, sent, text):
    assert fed(protocol, sent) == [Line(text)]


@pytest.mark.parametrize("ending", [b"\n", b"\r\n", b"\r", b"\n\r", b"\n\n\n"])
def test_line_ends(protocol, ending):
    assert protocol.feed(b"G28" + ending + b"M105" + ending) == [Line("G28"), Line("M105")]


def test_blank_lines_and_comments_are_not_lines(protocol):
    assert fed(protocol, "", "  ", "; a comment", "\t;") == []


def test_line_protocol_survives_arbitrary_bytes(protocol):
    found = protocol.feed(b"\x00G1 X\x001\xff\xfe\n" + bytes(range(14, 127)) + b"\nM105\n")
    assert found[-1] == Line("M105")
    assert found[0] == Line("G1 X1\udcff\udcfe")


def test_a_checksum_counts_bytes_that_are_not_text(protocol):
    text = numbered(1, "M117 \xb0C")
    assert fed(protocol, text) == [Line("M117 \udcb0C", 1)]


def test_a_line_without_end_takes_no_memory(protocol):
    tracemalloc.start()
    for _ in range(160):
        assert protocol.feed(b"x" * (1 << 16)) == []
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert most < 1 << 20
    assert fed(protocol, "", "M105") == [
        Refusal(
            f"this line is longer than {LONGEST} characters and is left out",
            None,
            "x" * LONGEST,
            lost=True,
        ),
        Line("M105"),
    ]


SHORT = 300  # in place of LONGEST
WILD = st.lists(
    st.one_of(
        st.binary(max_size=30),
        st.sampled_from([b"\n", b"\r\n", b"N1 G1*", b"G28\n", b"x" * (SHORT - 3), b"x" * 5]),
        st.builds(lambda n: (numbered(n, "G1 X1") + "\n").encode(), st.integers(-2, 4)),
        st.builds(
            lambda n: (numbered(1, "M486 A" + "z" * n) + "\n").encode(), st.integers(280, 320)
        ),
        st.builds(lambda n: f"M110 N{n}\n".encode(), st.integers(-2, 4)),
    ),
    max_size=12,
)


@settings(deadline=None)
@given(WILD, st.randoms(use_true_random=False))
def test_lines_do_not_depend_on_how_bytes_are_cut(pieces, chance):
    data = b"".join(pieces)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(line_protocol, "LONGEST", SHORT)
        at_once = LineProtocol().feed(data)
        protocol, found = LineProtocol(), []
        while data:
            size = chance.choice((1, 2, 7, 64, SHORT))
            found += protocol.feed(data[:size])
            data = data[size:]
    assert found == at_once


def damaged(chance, data):
    """A line with its end as the link delivers it."""
    fault = chance.randrange(6)
    if fault == 0:
        return b""  # lost
    if fault == 1:
        return data + data
    at = chance.randrange(len(data))
    if fault == 2:
        return data[:at] + data[at + 1 :]
    if fault == 3:
        return data[:at] + bytes([chance.randrange(256)]) + data[at:]
    byte = chance.choice([b for b in range(256) if b != data[at]])
    return data[:at] + bytes([byte]) + data[at + 1 :]


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("window", [1, 2, 5])
def test_every_line_arrives_once_and_in_order_over_a_bad_link(seed, window):
    """A host that sends from the line asked for on, keeps so many lines in flight, and when it
    hears nothing more sends the last one again."""
    chance = random.Random(seed)
    wanted = [f"G1 X{chance.randrange(1000)} Y{i}" for i in range(300)]
    protocol, taken = LineProtocol(), []
    following, in_flight, rounds = 1, 0, 0
    answers = [("ok", None)]
    protocol.feed(b"N0 M110 N0*125\n")
    while len(taken) < len(wanted):
        rounds += 1
        assert rounds < 10_000
        while in_flight < window and following <= len(wanted):
            data = (numbered(following, wanted[following - 1]) + "\n").encode()
            if chance.random() < 0.1:
                data = damaged(chance, data)
            answers += protocol.feed(data)
            following, in_flight = following + 1, in_flight + 1
        if not answers:
            following, in_flight = max(1, following - 1), 0
            answers += protocol.feed(b"\n")
            continue
        answer, in_flight = answers.pop(0), max(0, in_flight - 1)
        if isinstance(answer, Line):
            taken.append(answer.text)
        elif isinstance(answer, Refusal) and answer.resend is not None:
            following = min(following, answer.resend)
    assert taken == wanted
