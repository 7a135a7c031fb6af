"""Forms in pieces of any size, and names beyond ASCII in each way that clients write them."""

from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.web.slicers import recorded

from passo.errors import InputError
from passo.web.files.form import Field, FileBegins, FileData, FileEnds, Form, decoded_name

SENT = recorded.cura()
TYPE, BODY = SENT["headers"]["Content-Type"], SENT["content"]


def parts(pieces, content_type=TYPE):
    form = Form(content_type)
    found = [part for piece in pieces for part in form.feed(piece)]
    form.finish()
    return found


def cut(body, places):
    edges = [0, *sorted(places), len(body)]
    return [body[a:b] for a, b in pairwise(edges)]


@given(st.lists(st.integers(0, len(BODY)), max_size=30))
def test_a_form_is_the_same_however_it_is_cut(places):
    found = parts(cut(BODY, places))
    data = b"".join(part.data for part in found if isinstance(part, FileData))
    assert data == recorded.GCODE
    assert [part for part in found if not isinstance(part, FileData)] == [
        Field("path", "//"),
        FileBegins("file", "CE3_part.gcode"),
        FileEnds(),
        Field("select", "true"),
        Field("print", "true"),
    ]


@given(st.integers(0, len(BODY) - 1), st.binary(max_size=12), st.integers(0, 12))
@settings(max_examples=300)
def test_a_damaged_form_is_read_or_refused(at, junk, gone):
    """Nothing but the one kind of error, whatever comes."""
    body = BODY[:at] + junk + BODY[at + gone :]
    try:
        found = parts([body])
    except InputError as error:
        assert error.problems[0].code == "upload.malformed"
    else:
        assert sum(isinstance(p, FileBegins) for p in found) == sum(
            isinstance(p, FileEnds) for p in found
        )


@given(st.binary(max_size=200))
def test_any_body_is_read_or_refused(body):
    with pytest.raises(InputError):
        parts([body])


@pytest.mark.parametrize("gone", [1, 3, 40])
def test_a_form_that_breaks_off_is_refused(gone):
    body = BODY.rstrip()
    with pytest.raises(InputError, match="ends before its last boundary"):
        parts([body[:-gone]])


@pytest.mark.parametrize(
    ("head", "says"),
    [
        (b'Content-Disposition: form-data; name="a"\r\n' + b"X-A: b\r\n" * 200, "upload|header"),
        (b"Content-Disposition: form-data\r\n", "no name"),
        (b'Content-Disposition: form-data; name="a"; x="' + b"y" * 100_000 + b'"\r\n', "header"),
    ],
)
def test_hostile_headers_are_refused(head, says):
    with pytest.raises(InputError, match=says):
        parts([b"--b\r\n" + head + b"\r\nvalue\r\n--b--\r\n"], "multipart/form-data; boundary=b")


def test_fields_are_few_and_short():
    many = recorded.form(*[(f'name="f{i}"', b"x") for i in range(40)], boundary="b")
    long = recorded.form(('name="f"', b"x" * 9000), boundary="b")
    for body in (many, long):
        with pytest.raises(InputError, match="more than"):
            parts([body], "multipart/form-data; boundary=b")


@pytest.mark.parametrize(
    "kind", ["", "text/plain", "multipart/form-data", "multipart/mixed; boundary=b"]
)
def test_body_that_is_not_a_form_is_refused(kind):
    with pytest.raises(InputError, match="expected multipart/form-data"):
        Form(kind)


@pytest.mark.parametrize(
    "about",
    [
        'filename="größe.gcode"'.encode(),
        'filename="größe.gcode"'.encode("latin-1"),
        b'filename="=?UTF-8?B?Z3LDtsOfZS5nY29kZQ==?="',
        b'filename="=?utf-8?q?gr=C3=B6=C3=9Fe=2Egcode?="',
        b"filename=\"gr__e.gcode\"; filename*=UTF-8''gr%C3%B6%C3%9Fe.gcode",
        b"filename*=iso-8859-1'de'gr%F6%DFe.gcode",
        "filename=größe.gcode".encode(),
    ],
)
def test_each_encoding_of_a_file_name_is_read(about):
    body = b'--b\r\nContent-Disposition: form-data; name="file"; ' + about + b"\r\n\r\nG28\r\n--b--"
    found = parts([body], "multipart/form-data; boundary=b")
    assert found[0] == FileBegins("file", "größe.gcode")


@given(st.binary(max_size=60))
def test_any_name_is_decoded(raw):
    assert isinstance(decoded_name(raw), str)
