#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The dependencies between folders: an include never names a folder above its own."""
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
INCLUDE = re.compile(r'^#include "([a-z_/]+\.h)"', re.MULTILINE)


def sources(folder):
    """Sources of the program. A check_*.c next to a pass is a test, and may include test
    headers."""
    return [path for path in sorted((ROOT / folder).rglob("*.[ch]"))
            if not path.name.startswith("check_")]


def includes(folder):
    return {path: INCLUDE.findall(path.read_text()) for path in sources(folder)}


class House(unittest.TestCase):
    def test_includes_never_point_up(self):
        seen = 0
        for folder, allowed in MAY_INCLUDE.items():
            for path in sources(folder):
                for name in re.findall(r'^#include "([a-z]+)/', path.read_text(), re.MULTILINE):
                    seen += 1
                    if name in MAY_INCLUDE:
                        self.assertIn(name, allowed, f"{path.relative_to(ROOT)} includes {name}/")
        self.assertGreater(seen, 100)

    def test_every_folder_of_the_harness_is_a_room(self):
        # The linker enforces the order: each room is linked only with the rooms below it.
        rooms = re.findall(r"^neph_room\((\w+)", (ROOT / "harness/CMakeLists.txt").read_text(),
                           re.MULTILINE)
        folders = {path.name for path in (ROOT / "harness").iterdir() if path.is_dir()}
        self.assertEqual(folders | {"common"}, set(rooms))

    def test_no_two_files_need_each_other(self):
        # A .c file counts as its .h: the pair needs the includes of both.
        needs = {}
        for folder in MAY_INCLUDE:
            for path, names in includes(folder).items():
                own = path.relative_to(ROOT).with_suffix("").as_posix()
                needs.setdefault(own, set()).update(name[:-2] for name in names if name[:-2] != own)

        def reach(start):
            ahead, seen = [start], set()
            while ahead:
                for there in needs.get(ahead.pop(), ()):
                    if there not in seen:
                        seen.add(there)
                        ahead.append(there)
            return seen

        reached = {start: reach(start) for start in needs}
        circles = {frozenset(there for there in reached[start] if start in reached.get(there, ()))
                   for start in needs if start in reached[start]}
        self.assertEqual({" ".join(sorted(circle)) for circle in circles}, set())

    def test_jansson_is_used_through_the_header_that_minds_its_failures(self):
        users = [path.relative_to(ROOT / "harness").as_posix()
                 for path in (ROOT / "harness").rglob("*.[ch]")
                 if "<jansson.h>" in path.read_text()]
        self.assertEqual(users, ["json.h"])

    def test_command_lines_are_parsed_where_complaints_are_cleaned(self):
        users = [path.relative_to(ROOT / "harness").as_posix()
                 for path in (ROOT / "harness").rglob("*.c")
                 if re.search(r"\bargp_parse\(", path.read_text())]
        self.assertEqual(users, ["options.c"])

    def test_no_shader_rounds_by_a_drivers_two_conversions(self):
        # A driver may remove both conversions: from_halves() of halves.glsl reads a value that was
        # a half for a moment. halves.comp tests whether a NaN stays a NaN; both results are valid
        # there.
        users = [path.name for path in sorted((ROOT / "renderer/shaders").iterdir())
                 if re.search(r"\bunpack(Half2x16)?\(\s*pack", path.read_text())]
        self.assertEqual(users, ["halves.comp"])


if __name__ == "__main__":
    unittest.main()
