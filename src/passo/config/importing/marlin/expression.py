"""The C expressions in configurations: arithmetic, comparisons, and Marlin's tests such as
ENABLED(). Nothing is compiled or run."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from typing import NamedTuple, Protocol

_TOKEN = re.compile(
    r"\s*(?:(0[xX][0-9a-fA-F]+|(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)[fFuUlL]*"
    r"|([A-Za-z_]\w*)|(&&|\|\||==|!=|<=|>=|<<|>>|[-+*/%<>!~&|^?:(),])|(\S))"
)
_LEVELS = (
    ("||",),
    ("&&",),
    ("|",),
    ("^",),
    ("&",),
    ("==", "!="),
    ("<", "<=", ">", ">="),
    ("<<", ">>"),
    ("+", "-"),
    ("*", "/", "%"),
)
_TESTS: Mapping[str, Callable[[Number, Number], bool]] = {
    "==": lambda left, right: left == right,
    "!=": lambda left, right: left != right,
    "<": lambda left, right: left < right,
    "<=": lambda left, right: left <= right,
    ">": lambda left, right: left > right,
    ">=": lambda left, right: left >= right,
    "&&": lambda left, right: bool(left and right),
    "||": lambda left, right: bool(left or right),
}
_BITS: Mapping[str, Callable[[int, int], int]] = {
    "<<": lambda left, right: left << right,
    ">>": lambda left, right: left >> right,
    "&": lambda left, right: left & right,
    "|": lambda left, right: left | right,
    "^": lambda left, right: left ^ right,
}
_SUMS: Mapping[str, Callable[[Number, Number], Number]] = {
    "+": lambda left, right: left + right,
    "-": lambda left, right: left - right,
    "*": lambda left, right: left * right,
}
_CASTS = {"double", "float", "int", "long", "int8_t", "int16_t", "int32_t", "uint8_t", "uint16_t"}
_CONSTANTS = {"true": 1, "false": 0, "HIGH": 1, "LOW": 0}
_MAX_STEPS = 2000  # of one expression with all that its names stand for
_MAX_DEPTH = 40
_MAX_TOKENS = 500
_LARGEST = 1e18  # of a value within an expression

Number = int | float


class Unreadable(Exception):
    """The text is not an expression that can be evaluated; `names` are the unknown names in it."""

    def __init__(self, *names: str) -> None:
        super().__init__(*names)
        self.names = names


class Names(Protocol):
    """The values of names for an expression."""

    def text_of(self, name: str) -> str | None:
        """The definition of the name; None if it is not defined."""
        ...

    def is_on(self, name: str) -> bool:
        """Whether the option is enabled."""
        ...

    def derived(self, name: str, argument: str | None) -> Number | None:
        """The value that Marlin derives from its options; None if that is not known here."""
        ...


class _Token(NamedTuple):
    kind: str  # number, name, sign
    text: str


def _tokens(text: str) -> list[_Token]:
    tokens: list[_Token] = []
    for match in _TOKEN.finditer(text):
        number, name, sign, other = match.groups()
        if other is not None or len(tokens) == _MAX_TOKENS:
            raise Unreadable
        kind = "number" if number else "name" if name else "sign"
        tokens.append(_Token(kind, number or name or sign))
    return tokens


def value_of(text: str, names: Names) -> Number:
    """The value of an expression, with C's division of whole numbers. Raises Unreadable, also for
    an unknown name."""
    return _Reader(names).value(text, 0)


class _Reader:
    """Evaluates by recursive descent. All expressions that names stand for count as one."""

    def __init__(self, names: Names) -> None:
        self._names = names
        self._steps = 0
        self._tokens: list[_Token] = []
        self._at = 0
        self._depth = 0

    def value(self, text: str, depth: int) -> Number:
        """The value of a whole text."""
        outer = self._tokens, self._at, self._depth
        self._tokens, self._at, self._depth = _tokens(text), 0, depth
        result = self._choice()
        if self._at != len(self._tokens):
            raise Unreadable
        self._tokens, self._at, self._depth = outer
        return result

    def _peek(self) -> str:
        return self._tokens[self._at].text if self._at < len(self._tokens) else ""

    def _take(self) -> _Token:
        self._steps += 1
        if self._at >= len(self._tokens) or self._steps > _MAX_STEPS:
            raise Unreadable
        self._at += 1
        return self._tokens[self._at - 1]

    def _expect(self, sign: str) -> None:
        if self._take().text != sign:
            raise Unreadable

    def _choice(self) -> Number:
        self._depth += 1
        if self._depth > _MAX_DEPTH:
            raise Unreadable
        condition = self._binary(0)
        if self._peek() == "?":
            self._take()
            first = self._choice()
            self._expect(":")
            second = self._choice()
            condition = first if condition else second
        self._depth -= 1
        return condition

    def _binary(self, level: int) -> Number:
        if level == len(_LEVELS):
            return self._unary()
        left = self._binary(level + 1)
        while self._peek() in _LEVELS[level]:
            sign = self._take().text
            left = _applied(sign, left, self._binary(level + 1))
        return left

    def _unary(self) -> Number:
        signs: list[str] = []
        while self._peek() in ("-", "+", "!", "~"):
            signs.append(self._take().text)
        value = self._primary()
        for sign in reversed(signs):
            if sign == "-":
                value = -value
            elif sign == "!":
                value = int(not value)
            elif sign == "~":
                value = ~int(value)
        return value

    def _primary(self) -> Number:
        token = self._take()
        if token.kind == "number":
            return _number(token.text)
        if token.text == "(":
            return self._within()
        if token.kind != "name":
            raise Unreadable
        if token.text == "defined":
            bracketed = self._peek() == "("
            if bracketed:
                self._take()
            name = self._take().text
            if bracketed:
                self._expect(")")
            return int(self._names.text_of(name) is not None)
        if self._peek() == "(":
            self._take()
            if token.text in _CASTS:
                value = self._within()
                return float(value) if token.text in ("double", "float") else int(value)
            return self._called(token.text)
        return self._named(token.text)

    def _within(self) -> Number:
        value = self._choice()
        self._expect(")")
        return value

    def _named(self, name: str) -> Number:
        text = self._names.text_of(name)
        if text is not None:
            return self.value(text, self._depth + 1)
        if name in _CONSTANTS:
            return _CONSTANTS[name]
        found = self._names.derived(name, None)
        if found is None:
            raise Unreadable(name)
        return found

    def _called(self, function: str) -> Number:
        if function in ("TERN", "TERN_"):
            on = self._names.is_on(self._take().text)
            values: list[Number] = []
            while self._take().text == ",":
                values.append(self._choice())
            return (values[0] if on else values[1]) if len(values) == 2 else 0
        arguments: list[str] = []
        while self._peek() != ")":
            arguments.append(self._take().text)
            if self._peek() == ",":
                self._take()
        self._take()
        on = [self._names.is_on(name) for name in arguments]
        tests: Mapping[str, bool] = {
            **dict.fromkeys(("ENABLED", "ANY", "EITHER"), any(on)),
            **dict.fromkeys(("ALL", "BOTH"), all(on)),
            **dict.fromkeys(("DISABLED", "NONE"), not any(on)),
        }
        if function in tests:
            return int(tests[function])
        found = self._names.derived(function, arguments[0] if arguments else "")
        if found is None:
            raise Unreadable(f"{function}()")
        return found


def _number(text: str) -> Number:
    if text[:2].lower() == "0x":
        return _limited(int(text, 16))
    value = _limited(float(text))
    return int(text) if text.isdigit() else value


def _limited(value: Number) -> Number:
    """A value that further steps can calculate with. Raises Unreadable for any other."""
    if not abs(value) <= _LARGEST:
        raise Unreadable
    return value


def _applied(sign: str, left: Number, right: Number) -> Number:
    if sign in _TESTS:
        return int(_TESTS[sign](left, right))
    if sign in _BITS:
        if sign in ("<<", ">>") and not 0 <= right <= 31:
            raise Unreadable
        return int(_limited(_BITS[sign](int(left), int(right))))
    result = _divided(sign, left, right) if sign in "/%" else _SUMS[sign](left, right)
    whole = isinstance(left, int) and isinstance(right, int)
    return int(_limited(result)) if whole else _limited(result)


def _divided(sign: str, left: Number, right: Number) -> Number:
    """Whole numbers are cut towards 0."""
    if not right:
        raise Unreadable
    if isinstance(left, int) and isinstance(right, int):
        quotient = abs(left) // abs(right) * (1 if (left < 0) == (right < 0) else -1)
        return quotient if sign == "/" else left - quotient * right
    if sign == "%":
        raise Unreadable
    return left / right
