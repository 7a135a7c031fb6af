"""Who a board is: asked over a wire that loses, cuts and repeats."""

import pytest

from passo.board.dictionary import DictionaryError
from passo.board.identify import Identification

from .fakes import Board, packed

LONG = packed(enumerations={"pin": {f"P{i}": i for i in range(200)}})


def talk(board: Board, cut: int | None = None, most: int = 200) -> tuple[Identification, float]:
    """Lets both talk until done; virtual seconds that it took."""
    found, now = Identification(), 0.0
    for _ in range(most):
        data, again = found.poll(now)
        if not data:
            now = again
            continue
        answer = board.answer(data)
        for i in range(0, len(answer), cut or max(len(answer), 1)):
            found.feed(answer[i : i + (cut or len(answer))])
        if found.dictionary:
            break
    return found, now


@pytest.mark.parametrize("cut", [None, 1, 3])
def test_a_dictionary_is_read_piece_by_piece(cut: int | None) -> None:
    board = Board(LONG)
    found, now = talk(board, cut)
    assert found.dictionary is not None
    assert found.compressed == LONG
    assert found.dictionary.version == "0.1.0-test"
    assert board.questions == -(-len(LONG) // 40) + 1
    assert now == 0.0


def test_another_sequence_number_costs_a_retry() -> None:
    board = Board(packed(), sequence=7)
    found, now = talk(board)
    assert found.dictionary is not None
    assert now == 0.0


def test_lost_frames_are_asked_for_again() -> None:
    found, now = talk(Board(packed(), deaf=3))
    assert found.dictionary is not None
    assert now == pytest.approx(0.75)


def test_identify_stops_when_dictionary_is_complete() -> None:
    found, now = talk(Board(packed()))
    assert found.poll(now) == (b"", now + 0.25)
    found.feed(b"\x7e noise \x7e")
    assert found.dictionary is not None


def test_damaged_dictionary_is_named() -> None:
    with pytest.raises(DictionaryError):
        talk(Board(b"no dictionary"))


def test_noise_before_frames_is_skipped() -> None:
    found = Identification()
    data, _ = found.poll(0.0)
    found.feed(b"\x00garbage\x7e" + Board(packed()).answer(data))
    assert len(found.compressed) == 40
