"""Templates of G-code in Klipper's language: Jinja2 in its sandbox, with bounds on time and size.

The sandbox protects the computer's data, but does not prevent an endless loop or a text that fills
the memory. So each loop, call and filter here counts steps, and each value has a maximum size.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sized
from functools import wraps
from itertools import islice
from typing import Any, cast

from jinja2 import TemplateSyntaxError, nodes, pass_context
from jinja2.exceptions import SecurityError, TemplateError, TemplateRuntimeError, UndefinedError
from jinja2.filters import FILTERS
from jinja2.runtime import Context, Macro, Undefined
from jinja2.sandbox import SandboxedEnvironment
from jinja2.utils import missing
from jinja2.visitor import NodeTransformer

from passo.gcode.template_words import in_words, kind_of, known_names

# For one call, including all macros that it calls.
MAX_STEPS = 100_000  # less than a second
MAX_LINES, MAX_BYTES = 10_000, 1_000_000  # of its result
MAX_CHARACTERS = 65_536  # of one text within a template
MAX_ITEMS = 10_000  # in one list, including nested lists, or in a range
_MAX_BITS = 4096  # of an integer
_MAX_WIDTH = 1000  # columns to which a text is padded
_MAX_DIGITS = 30  # decimals that a number is rounded to
_ITEM = 64  # characters of a text that count as one item of a list

# Methods of values that templates may call. All others of these types are refused.
_METHODS: Mapping[type, str] = {
    str: "capitalize center count endswith find format index isalpha isdigit islower isnumeric"
    " isspace isupper join ljust lower lstrip partition removeprefix removesuffix replace rfind"
    " rindex rjust rpartition rsplit rstrip split splitlines startswith strip swapcase title"
    " upper zfill",
    list: "__delitem__ __setitem__ append clear copy count extend index insert pop remove reverse"
    " sort",
    tuple: "count index",
    dict: "__delitem__ __setitem__ clear copy get items keys pop popitem setdefault update values",
    int: "",
    float: "is_integer",
}
_FILTERS = (
    "abs batch capitalize count d default dictsort first float format int items join last length"
    " list lower map max min reject rejectattr replace reverse round select selectattr sort string"
    " title trim unique upper wordcount tojson"
)
_WIDE = re.compile(r"\d{4,}|\*|\{[^{}]*\{")  # a format with a large width, or a width from a value


class TemplateFault(Exception):
    """An error in a template, with its line (None: in the template as a whole)."""

    def __init__(self, reason: str, line: int | None = None) -> None:
        super().__init__(reason)
        self.reason, self.line = reason, line


class Budget:
    """The steps, bytes and lines that one call may still use, including all macros that it
    calls."""

    def __init__(self) -> None:
        self._steps, self._bytes, self._lines = MAX_STEPS, MAX_BYTES, MAX_LINES

    def spend(self, steps: int) -> None:
        """Raises TemplateFault if no steps are left."""
        self._steps -= steps
        if self._steps < 0:
            text = f"it takes more than {MAX_STEPS:,} steps: loops, calls and filters"
            raise TemplateFault(text)

    def write(self, text: str) -> None:
        """Raises TemplateFault if there is no space for this text."""
        self._bytes -= len(text.encode("utf-8", "replace"))
        self._lines -= text.count("\n")
        if self._bytes < 0:
            raise TemplateFault(f"it becomes more than {MAX_BYTES:,} bytes")
        if self._lines <= 0:
            raise TemplateFault(f"it becomes more than {MAX_LINES:,} lines")


class Template:
    """One template. Rendering has no effect except that of the functions it calls."""

    def __init__(self, text: str) -> None:
        """Raises TemplateFault, with the line, if the text is not a template."""
        self._environment = _Environment()
        try:
            self._template = self._environment.from_string(text)
        except TemplateSyntaxError as error:
            raise TemplateFault(error.message or "a syntax error", error.lineno) from None
        except (RecursionError, MemoryError, SyntaxError, ValueError, TemplateError) as error:
            raise TemplateFault(_sentence(error)) from None

    def render(self, values: Mapping[str, Any], budget: Budget) -> str:
        """The rendered text. Raises TemplateFault with the line of the error, also if the budget is
        used up. A PassoError of a function among `values` passes through."""
        self._environment.begin(budget)
        parts: list[str] = []
        try:
            context = self._template.new_context(dict(values))
            for part in self._template.root_render_func(context):
                budget.write(part)
                parts.append(part)
        except TemplateFault as fault:
            raise TemplateFault(fault.reason, self._line_of(fault)) from None
        except _ORDINARY as error:
            raise TemplateFault(_sentence(error), self._line_of(error)) from None
        return "".join(parts)

    def _line_of(self, error: BaseException) -> int | None:
        """The innermost line of the template in the traceback of the error."""
        line, trace = None, error.__traceback__
        while trace is not None:
            if "__jinja_template__" in trace.tb_frame.f_globals:
                line = self._template.get_corresponding_lineno(trace.tb_lineno)
            trace = trace.tb_next
        return line


_ORDINARY = (
    *(TemplateError, ArithmeticError, AttributeError, LookupError, TypeError, ValueError),
    *(RecursionError, MemoryError),
)


def _sentence(error: BaseException) -> str:
    if isinstance(error, RecursionError):
        return "it is nested too deeply"
    return in_words(str(error).rstrip(".")) or "it fails"


class _Missing(Undefined):
    """A name without a value: it is false in a condition, and `default` replaces it. Writing it
    into G-code is an error; plain Jinja2 would write an empty text."""

    __slots__ = ()
    __str__ = Undefined._fail_with_undefined_error  # pyright: ignore[reportPrivateUsage]

    def __init__(
        self,
        hint: str | None = None,
        obj: Any = missing,
        name: str | None = None,
        exc: type[TemplateRuntimeError] = UndefinedError,
    ) -> None:
        if obj is not missing and exc is SecurityError:
            hint = f"{name!r} of {kind_of(obj)} is unsafe in a macro"
        elif obj is not missing:
            hint = f"{kind_of(obj)} has no {name!r}{known_names(obj)}"
        super().__init__(hint, obj, name, exc)


class _Bounded(NodeTransformer):
    """Adds counters to a template: to loops, comparisons, joined texts and list literals."""

    def visit_For(self, node: nodes.For) -> nodes.Node:  # noqa: N802
        written = sum(len(data.data) for data in node.find_all(nodes.TemplateData))
        self.generic_visit(node)
        node.iter = _filter(cast("nodes.Expr", node.iter), "_counted", nodes.Const(written))
        return node

    def visit_Concat(self, node: nodes.Concat) -> nodes.Node:  # noqa: N802
        self.generic_visit(node)
        return _filter(nodes.List(node.nodes, lineno=node.lineno), "_concatenated")

    def visit_Compare(self, node: nodes.Compare) -> nodes.Node:  # noqa: N802
        self.generic_visit(node)
        node.expr = _filter(node.expr, "_weighed")
        for operand in node.ops:
            operand.expr = _filter(operand.expr, "_weighed")
        return node

    def visit_List(self, node: nodes.List) -> nodes.Node:  # noqa: N802
        self.generic_visit(node)
        return _filter(node, "_sized")

    def visit_Dict(self, node: nodes.Dict) -> nodes.Node:  # noqa: N802
        self.generic_visit(node)
        return _filter(node, "_sized")

    def visit_Tuple(self, node: nodes.Tuple) -> nodes.Node:  # noqa: N802
        self.generic_visit(node)
        return _filter(node, "_sized") if node.ctx == "load" else node


def _filter(node: nodes.Expr, name: str, *arguments: nodes.Expr) -> nodes.Filter:
    return nodes.Filter(node, name, list(arguments), [], None, None, lineno=node.lineno)


class _Environment(SandboxedEnvironment):
    """The environment of one template, so that the counts of a rendering belong to it alone."""

    intercepted_binops = frozenset({"+", "-", "*", "/", "//", "%", "**"})

    def __init__(self) -> None:
        super().__init__(
            variable_start_string="{",
            variable_end_string="}",
            undefined=_Missing,
            extensions=["jinja2.ext.do"],
            finalize=self._written,
            optimized=False,  # compute nothing while a machine file is loaded
        )
        self.filters = {name: self._limited(name, FILTERS[name]) for name in _FILTERS.split()}
        self.filters["sum"] = self._limited("sum", self._sum)
        for function in (self._counted, self._concatenated, self._weighed, self._sized):
            self.filters[function.__name__] = function
        kept = ("dict", "namespace", "cycler", "joiner")
        self.globals = {name: self.globals[name] for name in kept} | {"range": self._range}
        self._budget, self._characters = Budget(), 0

    def begin(self, budget: Budget) -> None:
        """Starts a rendering. The rendering may write eight times the size of its result, because
        blocks that are stored in variables count too."""
        self._budget, self._characters = budget, 8 * MAX_BYTES

    def _parse(self, source: str, name: str | None, filename: str | None) -> nodes.Template:
        return _Bounded().visit(super()._parse(source, name, filename))

    # -- what may be done -------------------------------------------------------------------------

    def is_safe_attribute(self, obj: Any, attr: str, value: Any) -> bool:
        """See SandboxedEnvironment; allows only the methods of values that are listed here."""
        if isinstance(obj, tuple) and attr in getattr(cast("object", obj), "_fields", ()):
            return True
        for kind, methods in _METHODS.items():
            if isinstance(obj, kind):
                return attr in methods.split()
        return super().is_safe_attribute(obj, attr, value)

    def call(  # pyright: ignore[reportIncompatibleMethodOverride]
        self, context: Context, obj: Any, *args: Any, **kwargs: Any
    ) -> Any:
        """See SandboxedEnvironment."""
        self._budget.spend(1)
        owner = getattr(obj, "__self__", None)
        if isinstance(obj, Macro):
            self._write(MAX_CHARACTERS // _ITEM)
        elif isinstance(owner, str):
            args = self._of_text(obj.__name__, owner, args)
        elif isinstance(owner, list) and args:
            self._grow(cast("list[object]", owner), args)
        elif isinstance(owner, dict) and (args or kwargs):
            self._grow(cast("dict[object, object]", owner), (*args, kwargs))
        return self._sized(super().call(context, obj, *args, **kwargs))

    def _grow(self, owner: Sized, args: tuple[Any, ...]) -> None:
        """Checks that a list or a table may grow by its arguments."""
        added = 1
        for arg in args:
            self._sized(arg)
            added += len(cast("Sized", arg)) if isinstance(arg, list | tuple | dict) else 0
        self._fit(len(owner) + added, MAX_ITEMS, "items in a list")

    def wrap_str_format(self, value: Any) -> Callable[..., str] | None:
        """See SandboxedEnvironment."""
        wrapped = super().wrap_str_format(value)
        if wrapped is not None:
            self._refuse_wide(str(value.__self__))
        return wrapped

    def call_binop(self, context: Context, operator: str, left: Any, right: Any) -> Any:
        """See SandboxedEnvironment."""
        self._budget.spend(1)
        if operator == "**":
            bits = _bits(left) * abs(right) if isinstance(right, int | float) else 0
            self._fit(bits, _MAX_BITS, "bits in a number")
        elif operator == "*":
            for one, other in ((left, right), (right, left)):
                if isinstance(one, Sized) and isinstance(other, int):
                    self._fit(len(one) * other, _most_of(one), "items or characters")
        elif operator == "%" and isinstance(left, str):
            self._refuse_wide(left)
        return self._sized(super().call_binop(context, operator, left, right))

    def _of_text(self, method: str, text: str, args: tuple[Any, ...]) -> tuple[Any, ...]:
        """Checks the arguments of a text method, whose result must not become too long."""
        if method in ("center", "ljust", "rjust", "zfill") and args:
            self._fit(args[0], _MAX_WIDTH, "columns")
        elif method == "join" and args:
            args = (self._joinable(args[0], text), *args[1:])
        elif method == "replace" and len(args) > 1:
            self._replaceable(text, args[0], args[1])
        self._budget.spend(len(text) // _ITEM)
        return args

    def _limited(self, name: str, function: Callable[..., Any]) -> Callable[..., Any]:
        """A filter that counts steps, and whose result is limited in size."""
        # the context or the environment is its first argument
        passes = hasattr(function, "jinja_pass_arg")

        @wraps(function)
        def limited(*args: Any, **kwargs: Any) -> Any:
            given = list(args[1:] if passes else args)
            self._budget.spend(1 + _weight(given[0]))
            if name == "join":
                between = given[1] if len(given) > 1 else kwargs.get("d", "")
                attribute = given[2] if len(given) > 2 else kwargs.get("attribute")
                if attribute is None:
                    given[0] = self._joinable(given[0], str(between))
            elif name == "replace" and len(given) > 2:
                self._replaceable(str(given[0]), str(given[1]), str(given[2]))
            elif name == "format":
                self._refuse_wide(str(given[0]))
            elif name == "batch":
                self._fit(given[1], MAX_ITEMS, "items in a list")
            elif name == "round":
                precision = given[1] if len(given) > 1 else kwargs.get("precision", 0)
                self._fit(abs(precision), _MAX_DIGITS, "decimals")
            elif name == "tojson" and ("indent" in kwargs or len(given) > 1):
                raise TypeError("tojson takes no indent here")
            return self._sized(function(*(args[:1] if passes else ()), *given, **kwargs))

        return limited

    def _range(self, *args: int) -> range:
        for number in args:
            self._fit(abs(number), 2**31, "as a bound of a range")
        found = range(*args)
        self._fit(len(found), MAX_ITEMS, "items")
        return found

    def _sum(
        self, values: Iterable[Any], attribute: str | int | None = None, start: Any = 0
    ) -> Any:
        total = start
        for value in values:
            self._budget.spend(1)
            part = value if attribute is None else self.getitem(value, attribute)
            if not isinstance(part, int | float):
                raise TypeError(f"sum takes numbers, not {part!r:.40}")
            total += part
        return total

    # -- bounds -----------------------------------------------------------------------------------

    @pass_context
    def _written(self, _: Context, value: Any) -> Any:
        """The text that an expression writes."""
        text = value if isinstance(value, str) else str(value)
        self._write(len(text))
        return text

    def _write(self, characters: int) -> None:
        self._characters -= characters
        if self._characters < 0:
            raise TemplateFault("it writes too much text")

    def _counted(self, values: Any, written: int) -> Iterator[Any]:
        """The items of a loop; each of them costs steps, and the `written` characters of the loop's
        body."""
        for value in values:
            self._budget.spend(1)
            self._write(written)
            yield value

    def _concatenated(self, parts: list[Any]) -> str:
        return "".join(self._joinable(parts, ""))

    def _weighed(self, value: Any) -> Any:
        self._budget.spend(_weight(value))
        return value

    def _sized(self, value: Any) -> Any:
        """The value, unless it is too large."""
        if isinstance(value, str):
            self._fit(len(value), MAX_CHARACTERS, "characters in a text")
        elif isinstance(value, int):
            self._fit(value.bit_length(), _MAX_BITS, "bits in a number")
        elif isinstance(value, list | tuple | dict):
            count = sum(1 for _ in islice(_items(cast("object", value)), MAX_ITEMS + 1))
            self._budget.spend(count)
            self._fit(count, MAX_ITEMS, "items in a list")
        return cast("object", value)

    def _joinable(self, values: Iterable[Any], between: str) -> list[str]:
        texts: list[str] = []
        size = 0
        for value in values:
            self._budget.spend(1)
            texts.append(str(value))
            size += len(texts[-1]) + len(between)
            self._fit(size, MAX_CHARACTERS + len(between), "characters in a text")
        return texts

    def _replaceable(self, text: str, old: str, new: str) -> None:
        self._fit(len(text) + text.count(old) * len(new), MAX_CHARACTERS, "characters in a text")

    def _refuse_wide(self, form: str) -> None:
        if _WIDE.search(form):
            raise TemplateFault(f"a format pads to more than {_MAX_WIDTH} columns: {form:.40}")

    def _fit(self, size: float, most: int, what: str) -> None:
        if size > most:
            raise TemplateFault(f"it makes more than {most:,} {what}")


def _bits(value: object) -> int:
    return value.bit_length() if isinstance(value, int) else 1


def _most_of(value: Sized) -> int:
    return MAX_CHARACTERS if isinstance(value, str) else MAX_ITEMS


def _weight(value: object) -> int:
    """The number of steps for a visit of the whole value."""
    if isinstance(value, str):
        return len(value) // _ITEM
    if isinstance(value, list | tuple | dict):
        return sum(1 for _ in islice(_items(cast("object", value)), MAX_ITEMS))
    return 0


def _items(value: object) -> Iterator[object]:
    """The items of a list or a table and of all nested ones; an item in two places counts twice."""
    if isinstance(value, dict):
        value = list(cast("dict[object, object]", value).values())
    if isinstance(value, list | tuple):
        for item in cast("list[object]", value):
            yield item
            yield from _items(item)
