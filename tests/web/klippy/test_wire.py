"""Frames of Klipper's socket."""

import json
from math import inf, nan

import pytest
from hypothesis import given
from hypothesis import strategies as st

from passo.web.klippy.wire import (
    LONGEST,
    Frames,
    FrameTooLongError,
    Request,
    frame_of,
    request_of,
)

TREES = st.recursive(
    st.none() | st.booleans() | st.integers(-(2**53), 2**53) | st.text(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(), inner, max_size=3),
    max_leaves=8,
)


@given(st.lists(st.dictionaries(st.text(), TREES, max_size=4), max_size=5), st.data())
def test_frames_are_the_same_however_they_are_cut(messages, data):
    sent = b"".join(json.dumps(message).encode() + b"\x03" for message in messages)
    cuts = sorted(data.draw(st.lists(st.integers(0, len(sent)), max_size=8)))
    frames = Frames()
    got = [
        frame
        for begin, end in zip([0, *cuts], [*cuts, len(sent)], strict=True)
        for frame in frames.feed(sent[begin:end])
    ]
    assert [json.loads(frame) for frame in got] == messages


def test_end_of_a_frame_within_a_text_is_escaped():
    assert frame_of({"text": "a\x03b"}) == b'{"text":"a\\u0003b"}\x03'


def test_numbers_that_json_does_not_have_are_null():
    assert json.loads(frame_of({"list": [nan, inf], "a": {"b": -inf}})[:-1]) == {
        "list": [None, None],
        "a": {"b": None},
    }


def test_frame_that_is_too_long_is_refused_before_it_ends():
    frames = Frames()
    assert frames.feed(b" " * LONGEST) == []
    with pytest.raises(FrameTooLongError):
        frames.feed(b" ")


def test_requests_have_a_method_parameters_and_an_id():
    assert request_of(b'{"id": "a", "method": "info"}') == Request("info", {}, "a")
    assert request_of(b'{"method": "x", "params": {"y": 1}}') == Request("x", {"y": 1}, None)


@pytest.mark.parametrize(
    ("frame", "reason"),
    [
        (b"", "not JSON"),
        (b"\xff\xfe{}", "not JSON"),
        (b"[" * 100_000, "not JSON"),
        (b"[]", "not an object"),
        (b"{}", "method"),
        (b'{"method": 1}', "method"),
        (b'{"method": "info", "params": []}', "params"),
        (b'{"method": "info", "params": null}', "params"),
    ],
)
def test_an_invalid_request_is_answered_with_the_reason(frame, reason):
    with pytest.raises(ValueError, match=reason):
        request_of(frame)
