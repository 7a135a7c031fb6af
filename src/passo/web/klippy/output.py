"""Console lines in the form for Klipper's clients: `// ` before information, `!! ` before an
error."""

from __future__ import annotations


def shown(text: str) -> str:
    """A line for a console. Answers such as those of M105 and M114 stay as they are, as do lines
    that have a prefix."""
    if text.startswith("echo: "):
        return text  # has Klipper's prefix already
    for ours, prefix in (("echo:", "// "), ("Error:", "!! ")):
        if text.startswith(ours):
            return prefix + text.removeprefix(ours).strip()
    return text


def failed(text: str) -> str:
    """An error: its first line after `!! `. If it has more lines, all lines are sent as information
    before it."""
    lines = text.strip().splitlines() or [""]
    before = [f"// {line}" for line in lines] if len(lines) > 1 else []
    return "\n".join([*before, f"!! {lines[0]}"])
