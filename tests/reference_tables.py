#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""reference_tables.py DATA.json TABLES.h: the numbers of a reference as C, for tests to include.

DATA.json is {"declaration of an array in C": [row, ...]}. Lists become braces, objects become
designated initialisers, floats keep their bits, texts in capitals are names in C."""
import json
import math
import pathlib
import re
import sys


def c_value(value):
    if isinstance(value, dict):
        return "{%s}" % ", ".join(f".{name} = {c_value(part)}" for name, part in value.items())
    if isinstance(value, list):
        return "{%s}" % ", ".join(map(c_value, value))
    if isinstance(value, float):
        return value.hex() if math.isfinite(value) else str(value).replace("inf", "INFINITY")
    is_name = isinstance(value, str) and re.fullmatch("[A-Z][A-Z0-9_]+", value)
    return value if is_name else json.dumps(value)


def write(path, tables):
    """Writes a DATA.json with one row per line."""
    path.write_text("{%s\n}\n" % ",".join(
        "\n%s: [\n%s\n]" % (json.dumps(name), ",\n".join(json.dumps(row) for row in rows))
        for name, rows in tables.items()), encoding="utf-8")


if __name__ == "__main__":
    tables = json.loads(pathlib.Path(sys.argv[1]).read_text(encoding="utf-8"))
    pathlib.Path(sys.argv[2]).write_text("".join(
        "static const %s = {\n%s};\n" % (name, "".join(f"    {c_value(row)},\n" for row in rows))
        for name, rows in tables.items()), encoding="utf-8")
