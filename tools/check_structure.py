"""Checks that no file depends on itself by way of others, that core/ is layered, and that no part
is given to another one after its construction.

Imports that only type checkers see count too. Usage: python tools/check_structure.py
"""

from __future__ import annotations

import ast
import re
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
# A folder of core/ includes its own headers and those of the folders before it.
CORE = ["base", "geometry", "machine", "plan", "filters", "steps", "gcode", "motion", "heat"]
CORE += ["link", "sim", "bind"]

Graph = dict[str, set[str]]


def python_imports() -> Graph:
    """The modules that each module of src/passo imports, by name; packages are their __init__."""
    paths = {
        ".".join(path.relative_to(ROOT / "src").with_suffix("").parts).removesuffix(
            ".__init__"
        ): path
        for path in (ROOT / "src" / "passo").rglob("*.py")
    }
    graph: Graph = {}
    for name, path in paths.items():
        found: set[str] = set()
        for node in ast.walk(ast.parse(path.read_bytes())):
            if isinstance(node, ast.Import):
                found.update(alias.name for alias in node.names)
            elif isinstance(node, ast.ImportFrom) and node.module is not None and not node.level:
                for alias in node.names:
                    within = f"{node.module}.{alias.name}"
                    bound = within in paths or alias.name == "_core"
                    found.add(within if bound else node.module)
        graph[name] = {module for module in found if module in paths and module != name}
    return graph


def includes(folder: str, roots: list[str]) -> Graph:
    """The headers that each file of `folder` includes. A source counts as part of its header."""
    paths = [p for p in (ROOT / folder).rglob("*") if p.suffix in (".c", ".h", ".cpp", ".hpp")]
    searched = [ROOT / root for root in roots]
    graph: Graph = {}
    for path in paths:
        found = graph.setdefault(unit(path), set())
        for text in re.findall(r'^#include "([^"]+)"', path.read_text(), re.MULTILINE):
            for place in [path.parent, *searched]:
                if (place / text).is_file():
                    found.add(unit(place / text))
                    break
        found.discard(unit(path))
    return graph


def unit(path: Path) -> str:
    return str(path.relative_to(ROOT).with_suffix(""))


def circles(graph: Graph) -> list[list[str]]:
    """The sets of files that reach each other, by Tarjan's algorithm."""
    order: dict[str, int] = {}
    low: dict[str, int] = {}
    stack: list[str] = []
    found: list[list[str]] = []

    def visit(node: str) -> None:
        order[node] = low[node] = len(order)
        stack.append(node)
        for target in graph.get(node, ()):
            if target not in order:
                visit(target)
            if target in stack:
                low[node] = min(low[node], low[target])
        if low[node] == order[node]:
            circle = stack[stack.index(node) :]
            del stack[stack.index(node) :]
            if len(circle) > 1:
                found.append(sorted(circle))

    sys.setrecursionlimit(10_000)
    for node in sorted(graph):
        if node not in order:
            visit(node)
    return found


def steps_up(graph: Graph) -> list[str]:
    """The files of core/ that include one of a later folder."""
    return [
        f"{name} includes {target}, which is above it"
        for name, targets in sorted(graph.items())
        for target in sorted(targets)
        if target.startswith("core/")
        and CORE.index(target.split("/")[1]) > CORE.index(name.split("/")[1])
    ]


def late_parts() -> list[str]:
    """Assignments into parts of a printer from outside, and of functions to attributes of other
    objects: parts receive these in their constructor, or functions are added to a list."""
    found: list[str] = []
    for path in sorted((ROOT / "src" / "passo").rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_bytes())):
            if not isinstance(node, ast.Assign | ast.AnnAssign):
                continue
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            for target in targets:
                if not isinstance(target, ast.Attribute):
                    continue
                owners = ast.unparse(target.value).split(".")
                of_printer = owners[-1] != "self" and {"printer", "_printer"} & set(owners)
                function = isinstance(node.value, ast.Lambda) and owners != ["self"]
                if of_printer or function:
                    place = f"{path.relative_to(ROOT)}:{node.lineno}"
                    found.append(f"{place}: {ast.unparse(target)} is assigned from outside")
    return found


def main() -> int:
    core = includes("core", ["core", "firmware/hal/host"])
    firmware = includes(
        "firmware", ["firmware/core", "firmware/hal", "firmware/hal/common", "firmware/hal/host"]
    )
    problems = [
        f"circle of {len(circle)} files: {', '.join(circle)}"
        for graph in (python_imports(), core, firmware)
        for circle in circles(graph)
    ]
    problems += steps_up(core) + late_parts()
    print("\n".join(problems) or "No circle of files; core/ is layered; no part is late.")
    return bool(problems)


if __name__ == "__main__":
    raise SystemExit(main())
