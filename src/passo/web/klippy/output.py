"""Lines of consoles in the form of Klipper's clients: `// ` and information, `!! ` and an error."""

from __future__ import annotations


def shown(text: str) -> str:
    """A line for a console. Answers such as those of M105 and M114 stay as they are, as do lines
    that have a prefix."""
    if text.startswith("echo: "):
        return text  # as Klipper's own
    for ours, prefix in (("echo:", "// "), ("Error:", "!! ")):
        if text.startswith(ours):
            return prefix + text.removeprefix(ours).strip()
    return text


def failed(text: str) -> str:
    """An error: its first line after `!! `; if it has more lines, before that all of it as
    information."""
    lines = text.strip().splitlines() or [""]
    before = [f"// {line}" for line in lines] if len(lines) > 1 else []
    return "\n".join([*before, f"!! {lines[0]}"])
