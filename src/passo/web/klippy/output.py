"""Lines of consoles as Klipper's clients know them: `// ` and information, `!! ` and an error."""

from __future__ import annotations


def shown(text: str) -> str:
    """A line that a console would receive. Answers as those of M105 and M114 stay as they are, and
    lines that have a prefix."""
    if text.startswith("echo: "):
        return text  # as Klipper's own
    for ours, prefix in (("echo:", "// "), ("Error:", "!! ")):
        if text.startswith(ours):
            return prefix + text.removeprefix(ours).strip()
    return text


def failed(text: str) -> str:
    """An error: its first line after `!! `, before that all of it as information if it has more."""
    lines = text.strip().splitlines() or [""]
    before = [f"// {line}" for line in lines] if len(lines) > 1 else []
    return "\n".join([*before, f"!! {lines[0]}"])
