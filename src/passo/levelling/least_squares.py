"""Linear least squares by Householder reflections (Golub & Van Loan, Matrix Computations, 5.2-5.4).

With column pivoting the diagonal of R decreases, so it shows the rank too. Problems here have at
most some 100 rows and 9 columns: plain Python is fast enough.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot, sqrt

RANK_LIMIT = 1e-4
"""The minimum of a diagonal element of R, relative to the first. A column below it would amplify
the noise of probes at least 10 000 times."""


class RankError(ValueError):
    """The rows do not determine all unknowns: `rank` of `unknowns`."""

    def __init__(self, rank: int, unknowns: int) -> None:
        super().__init__(rank, unknowns)
        self.rank, self.unknowns = rank, unknowns


def solve(rows: Sequence[Sequence[float]], values: Sequence[float]) -> list[float]:
    """The x that minimises the sum of (row · x - value)². Columns are scaled to length 1 first.
    Raises RankError if the rows do not determine x."""
    n = len(rows[0])
    lengths = [sqrt(sum(row[k] ** 2 for row in rows)) or 1.0 for k in range(n)]
    matrix = [[row[k] / lengths[k] for k in range(n)] for row in rows]
    right = [float(value) for value in values]
    order, diagonal = _reduce(matrix, right)
    rank = sum(abs(d) > RANK_LIMIT * abs(diagonal[0]) for d in diagonal) if diagonal[0] else 0
    if rank < n:
        raise RankError(rank, n)
    solution = [0.0] * n
    for k in reversed(range(n)):
        known = sum(matrix[k][m] * solution[order[m]] for m in range(k + 1, n))
        solution[order[k]] = (right[k] - known) / diagonal[k]
    return [x / length for x, length in zip(solution, lengths, strict=True)]


def _reduce(matrix: list[list[float]], right: list[float]) -> tuple[list[int], list[float]]:
    """Computes R in place, above the diagonal of `matrix`, and reflects `right` too. Returns the
    order of the columns and the diagonal of R."""
    n = len(matrix[0])
    order, diagonal = list(range(n)), [0.0] * n
    for k in range(min(n, len(matrix))):
        squares = [sum(row[m] ** 2 for row in matrix[k:]) for m in range(k, n)]
        pivot = k + squares.index(max(squares))
        order[k], order[pivot] = order[pivot], order[k]
        for row in matrix:
            row[k], row[pivot] = row[pivot], row[k]
        length = hypot(*(row[k] for row in matrix[k:]))
        if not length:
            break
        diagonal[k] = -length if matrix[k][k] > 0 else length
        normal = [row[k] for row in matrix[k:]]
        normal[0] -= diagonal[k]
        half = -diagonal[k] * normal[0]  # half of the square of the normal
        for m in range(k + 1, n):
            part = sum(u * row[m] for u, row in zip(normal, matrix[k:], strict=True)) / half
            for u, row in zip(normal, matrix[k:], strict=True):
                row[m] -= part * u
        part = sum(u * b for u, b in zip(normal, right[k:], strict=True)) / half
        for i, u in enumerate(normal, k):
            right[i] -= part * u
    return order, diagonal
