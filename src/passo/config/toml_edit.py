"""Changes single values in the text of a machine file, and keeps comments and order."""

from __future__ import annotations

import re

from passo.config.toml_lines import Path, key_lines

_COMMENT = r'((?:"[^"]*"|[^"#])*?)(\s*#.*)?'


def with_value(text: str, path: Path, value: str) -> str:
    """The TOML text with `value`, a single-line TOML value, at the key `path`. A missing key is
    added to its table, and a missing table at the end. Raises ValueError for a key within an array
    or an inline table, and for an existing value over several lines."""
    lines = text.splitlines()
    *table, key = path
    at = key_lines(text).get(path)
    if at is not None:
        name = re.escape(str(key))
        old = re.fullmatch(rf"(\s*(?:[\w.]*\.)?{name}\s*=\s*){_COMMENT}", lines[at - 1])
        if old is None or old[2].strip() in ("[", "{", '"""', "'''"):
            raise ValueError(f"line {at} cannot be changed in place")
        lines[at - 1] = f"{old[1]}{value}{old[3] or ''}"
        return "".join(f"{line}\n" for line in lines)
    if any(isinstance(part, int) for part in table):
        raise ValueError("a key within an array")
    header = f"[{'.'.join(map(str, table))}]"
    added = f"{key} = {value}"
    if not table:
        return f"{added}\n{text}"
    if header in lines:
        lines.insert(lines.index(header) + 1, added)
    else:
        lines += ["", header, added]
    return "".join(f"{line}\n" for line in lines)
