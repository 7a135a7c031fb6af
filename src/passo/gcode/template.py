"""Templates of G-code in Klipper's language: Jinja2 in its sandbox, with bounds on time and size.

The sandbox protects the computer's data, but does not prevent an endless loop or a text that fills
the memory. So each loop, call and filter here counts steps, and each value has a maximum size.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sized
from random import Random
from typing import Any, cast

from jinja2 import TemplateSyntaxError, nodes, pass_context
from jinja2.exceptions import SecurityError, TemplateError, TemplateRuntimeError, UndefinedError
from jinja2.runtime import Context, Macro, Undefined
from jinja2.sandbox import SandboxedEnvironment
from jinja2.utils import missing
from jinja2.visitor import NodeTransformer

from passo.gcode.template_bounds import MAX_CHARACTERS, Bounds, Budget, TemplateFault
from passo.gcode.template_filters import REFUSED, Library
from passo.gcode.template_words import in_words, kind_of, known_names

__all__ = ["Budget", "Template", "TemplateFault"]

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

    def render(self, values: Mapping[str, Any], budget: Budget, seed: str = "") -> str:
        """The rendered text. The same `seed` gives the same random numbers. Raises TemplateFault
        with the line of the error, also if the budget is used up. A PassoError
        of a function among `values` passes through."""
        self._environment.begin(budget, seed)
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
    *(TemplateError, ArithmeticError, AssertionError, AttributeError, LookupError),
    *(MemoryError, RecursionError, TypeError, ValueError),
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
    """Adds counters to a template: to loops, comparisons, joined texts, parts and literals of
    lists. Refuses the filters and functions that are not allowed."""

    def visit_Filter(self, node: nodes.Filter) -> nodes.Node:  # noqa: N802
        return self._allowed(node, node.name)

    def visit_Name(self, node: nodes.Name) -> nodes.Node:  # noqa: N802
        return self._allowed(node, node.name if node.ctx == "load" else "")

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
        node.expr = _filter(node.expr, "_sized")
        for operand in node.ops:
            searched = operand.op in ("in", "notin")
            operand.expr = _filter(operand.expr, "_searched" if searched else "_sized")
        return node

    def visit_List(self, node: nodes.List) -> nodes.Node:  # noqa: N802
        return self._sized(node)

    def visit_Dict(self, node: nodes.Dict) -> nodes.Node:  # noqa: N802
        return self._sized(node)

    def visit_Tuple(self, node: nodes.Tuple) -> nodes.Node:  # noqa: N802
        return self._sized(node) if node.ctx == "load" else self.generic_visit(node)

    def visit_Getitem(self, node: nodes.Getitem) -> nodes.Node:  # noqa: N802
        return self._sized(node) if isinstance(node.arg, nodes.Slice) else self.generic_visit(node)

    def _sized(self, node: nodes.Expr) -> nodes.Node:
        self.generic_visit(node)
        return _filter(node, "_sized")

    def _allowed(self, node: nodes.Expr, name: str) -> nodes.Node:
        if name in REFUSED:
            reason = f"{name} is not allowed in a macro: {REFUSED[name]}"
            raise TemplateSyntaxError(reason, node.lineno)
        return self.generic_visit(node)


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
        self._bounds, self._random, self._seed = Bounds(Budget()), None, ""
        library = Library(lambda: self._bounds, self._source)
        self.filters, self.tests = library.filters, library.tests
        self.globals = library.functions
        for function in (self._counted, self._concatenated, self._searched, self._sized):
            self.filters[function.__name__] = function

    def begin(self, budget: Budget, seed: str) -> None:
        """Starts a rendering."""
        self._bounds, self._random, self._seed = Bounds(budget), None, seed

    def _source(self) -> Random:
        self._random = self._random or Random(self._seed)
        return self._random

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
        bounds = self._bounds
        bounds.budget.spend(1)
        for value in (*args, *kwargs.values()):
            bounds.sized(value)
        owner = getattr(obj, "__self__", None)
        if isinstance(obj, Macro):
            bounds.write(MAX_CHARACTERS // 64)
        elif isinstance(owner, str):
            args = self._of_text(obj.__name__, owner, args)
        elif isinstance(owner, list | tuple | dict):
            bounds.method(cast("Sized", owner), obj.__name__, (*args, kwargs))
        return bounds.sized(super().call(context, obj, *args, **kwargs))

    def wrap_str_format(self, value: Any) -> Callable[..., str] | None:
        """See SandboxedEnvironment."""
        wrapped = super().wrap_str_format(value)
        if wrapped is not None:
            self._bounds.form(str(value.__self__))
        return wrapped

    def call_binop(self, context: Context, operator: str, left: Any, right: Any) -> Any:
        """See SandboxedEnvironment."""
        bounds = self._bounds
        bounds.budget.spend(1)
        if operator == "**":
            bounds.power(left, right)
        elif operator == "*":
            bounds.product(left, right)
        elif operator == "%" and isinstance(left, str):
            bounds.form(left)
            bounds.sized(right)
        return bounds.sized(super().call_binop(context, operator, left, right))

    def _of_text(self, method: str, text: str, args: tuple[Any, ...]) -> tuple[Any, ...]:
        """Checks the arguments of a text method, whose result must not become too long."""
        bounds = self._bounds
        bounds.sized(text)
        if method in ("center", "ljust", "rjust", "zfill") and args:
            bounds.columns(args[0])
        elif method == "join" and args:
            args = (bounds.texts(args[0], text), *args[1:])
        elif method == "replace" and len(args) > 1:
            bounds.replaceable(text, args[0], args[1])
        return args

    # -- bounds -----------------------------------------------------------------------------------

    @pass_context
    def _written(self, _: Context, value: Any) -> Any:
        """The text that an expression writes."""
        text = value if isinstance(value, str) else str(self._bounds.sized(value))
        self._bounds.write(len(text))
        return text

    def _counted(self, values: Any, written: int) -> Iterator[Any]:
        return self._bounds.counted(values, written)

    def _concatenated(self, parts: list[Any]) -> str:
        return "".join(self._bounds.texts(parts, ""))

    def _searched(self, value: Any) -> Any:
        """The right side of `in`. The size of a table does not matter there."""
        return cast("object", value) if isinstance(value, dict) else self._bounds.sized(value)

    def _sized(self, value: Any) -> Any:
        return self._bounds.sized(value)
