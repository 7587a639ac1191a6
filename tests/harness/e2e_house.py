#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The arrows of the house: an include names a folder, and never one above its own."""
import os
import pathlib
import re
import unittest

ROOT = pathlib.Path(os.environ["NEPH_SOURCE_DIR"])
MAY_INCLUDE = {
    "base": {"base"},
    "scenes": {"scenes", "base"},
    "truth": {"truth", "scenes", "base"},
    "metrics": {"metrics", "base"},
    "renderer": {"renderer", "scenes", "base"},
    "harness": {"harness", "renderer", "truth", "metrics", "scenes", "base"},
}


class House(unittest.TestCase):
    def test_includes_never_point_up(self):
        seen = 0
        for folder, allowed in MAY_INCLUDE.items():
            for path in sorted((ROOT / folder).rglob("*.[ch]")):
                for name in re.findall(r'^#include "([a-z]+)/', path.read_text(), re.MULTILINE):
                    seen += 1
                    if name in MAY_INCLUDE:
                        self.assertIn(name, allowed, f"{path.relative_to(ROOT)} includes {name}/")
        self.assertGreater(seen, 100)

    def test_jansson_is_used_through_the_header_that_minds_its_failures(self):
        users = [path.relative_to(ROOT / "harness").as_posix() for path in (ROOT / "harness").rglob("*.[ch]")
                 if "<jansson.h>" in path.read_text()]
        self.assertEqual(users, ["json.h"])

    def test_command_lines_are_parsed_where_complaints_are_cleaned(self):
        users = [path.relative_to(ROOT / "harness").as_posix() for path in (ROOT / "harness").rglob("*.c")
                 if re.search(r"\bargp_parse\(", path.read_text())]
        self.assertEqual(users, ["cli.c"])


if __name__ == "__main__":
    unittest.main()
