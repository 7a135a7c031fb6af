"""The two lags of a heater from its response to a step of power."""

from __future__ import annotations

from math import exp, log

Rows = list[tuple[float, float]]

_NUDGE = 1e-5  # step of a logarithm, for a numerical derivative


def step_response(t_s: float, rise_c: float, time_constant_s: float, lag_s: float) -> float:
    """The temperature rise at a time after a power step: two first-order lags in series with
    different time constants."""
    slow = time_constant_s * exp(-t_s / time_constant_s)
    fast = lag_s * exp(-t_s / lag_s)
    return rise_c * (1 - (slow - fast) / (time_constant_s - lag_s))


def fit_step(rows: Rows, start_c: float) -> tuple[float, float, float]:
    """(rise °C, time constant s, lag s) that fit rows of (s, °C) best by least squares: the
    Gauss-Newton method, damped (D. Marquardt, 1963)."""
    end_s, end_c = rows[-1]
    logs = [log(2 * (end_c - start_c)), log(1.5 * end_s), log(0.02 * end_s)]
    damping, error = 1e-3, _squares(rows, start_c, logs)
    for _ in range(100):
        normal, slope = _normal_equations(rows, start_c, logs)
        for k in range(3):
            normal[k][k] *= 1 + damping
        step = _solve(normal, slope)
        trial = [a + b for a, b in zip(logs, step, strict=True)]
        trial_error = _squares(rows, start_c, trial)
        if trial_error < error:
            small = error - trial_error < 1e-9 * error
            logs, error, damping = trial, trial_error, damping / 4
            if small:
                break
        else:
            damping *= 8
            if damping > 1e9:
                break
    rise, time_constant, lag = (exp(x) for x in logs)
    return rise, time_constant, lag


def _errors(rows: Rows, start_c: float, logs: list[float]) -> list[float]:
    rise, time_constant, lag = (exp(x) for x in logs)
    return [c - start_c - step_response(t, rise, time_constant, lag) for t, c in rows]


def _squares(rows: Rows, start_c: float, logs: list[float]) -> float:
    return sum(e * e for e in _errors(rows, start_c, logs))


def _normal_equations(
    rows: Rows, start_c: float, logs: list[float]
) -> tuple[list[list[float]], list[float]]:
    errors = _errors(rows, start_c, logs)
    columns: list[list[float]] = []
    for k in range(3):
        nudged = [x + (_NUDGE if i == k else 0) for i, x in enumerate(logs)]
        moved = _errors(rows, start_c, nudged)
        columns.append([(a - b) / _NUDGE for a, b in zip(errors, moved, strict=True)])
    normal = [[sum(a * b for a, b in zip(u, v, strict=True)) for v in columns] for u in columns]
    return normal, [sum(a * e for a, e in zip(u, errors, strict=True)) for u in columns]


def _solve(matrix: list[list[float]], right: list[float]) -> list[float]:
    """The solution of three linear equations, by Gaussian elimination with pivots."""
    rows = [[*row, value] for row, value in zip(matrix, right, strict=True)]
    for k in range(3):
        pivot = max(range(k, 3), key=lambda i: abs(rows[i][k]))
        rows[k], rows[pivot] = rows[pivot], rows[k]
        for i in range(3):
            if i != k:
                factor = rows[i][k] / rows[k][k]
                rows[i] = [a - factor * b for a, b in zip(rows[i], rows[k], strict=True)]
    return [rows[k][3] / rows[k][k] for k in range(3)]
