#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Tables of kinds have no silent default: a new phase function, medium, solid, ... does not compile
before every decision by its kind was reviewed. Decisions are switches without a default
(-Wswitch-enum). Files with tables of kinds, and files that compare kinds, state the known number of
kinds. By night each enum gets one more kind, and none of these files may compile."""
import collections
import json
import os
import pathlib
import re
import shlex
import subprocess
import tempfile
import unittest

import night

ROOT = pathlib.Path(os.environ["NEPH_SOURCE_DIR"])
BUILD = pathlib.Path(os.environ["NEPH"]).parent
FOLDERS = ("base", "scenes", "metrics", "truth", "renderer", "harness")

# Enums where a comparison with one kind treats all others alike: files that compare them state the
# number of kinds, too. For all other enums a comparison tests for one value (`outcome ==
# NEPH_OUTCOME_RENDERED`), and a new value is different from it.
COMPARED = ("neph_medium_kind", "neph_solid_kind", "neph_scattering",
            "neph_pattern", "neph_sheet_pattern", "neph_fog_model", "neph_march_lighting",
            "neph_march_mode", "neph_variant_kind", "neph_povray_kind", "neph_png_space",
            "neph_motion_depth", "neph_replicate", "neph_check_weight", "neph_failing_reference",
            "neph_failing_measure", "neph_texel_format", "neph_code_kind", "neph_pool",
            "neph_field_type", "neph_option_kind", "neph_injected_value", "neph_stage_truth",
            "neph_stage_medium", "neph_flip_tone", "neph_shadow_plane", "neph_pool_certainty",
            "neph_interval_kind", "neph_rt_rays", "neph_sky_refill", "neph_view_kind",
            "neph_candidate_motion")

# Sums with computed positions, not kinds.
NO_KINDS = ("neph_flicker_sum",)

# Tables in which a kind needs no row: a pass has a special shader only for some devices.
PARTIAL = {"neph_rt_device_kind": "pass.c"}


def without_comments(text):
    return re.sub(r"/\*.*?\*/", lambda found: re.sub(r"[^\n]", " ", found.group()), text,
                  flags=re.S)


def read_sources():
    return {path.relative_to(ROOT).as_posix(): without_comments(path.read_text())
            for folder in FOLDERS for path in sorted((ROOT / folder).rglob("*.[ch]"))}


class Enum:
    """An enum of a header: its enumerators, and the files with decisions by them."""
    def __init__(self, name, header, body):
        self.name, self.header = name, header
        self.names = re.findall(r"^\s*(\w+)", body.replace(",", "\n"), re.M)
        self.count = self.names[-1]
        self.tables, self.switches, self.comparisons = set(), set(), set()

    def find_places(self, words):
        """The files with a decision of one sort by this enum. `words`: names in such decisions,
        with files."""
        return set().union(*(words[name] for name in self.names if name in words))

    def state(self):
        return f"_Static_assert({self.count} == {len(self.names) - 1},"

    def stating(self):
        return self.tables | (self.comparisons if self.name in COMPARED else set())


def find_words(sources, place):
    """The words in places of one sort, each with its files."""
    words = collections.defaultdict(set)
    for path, text in sources.items():
        for word in re.findall(place, text):
            words[word].add(path)
    return words


def read_enums(sources):
    enums = [Enum(found.group(1), path, found.group(2)) for path, text in sources.items()
             if path.endswith(".h")
             for found in re.finditer(r"\benum (neph_\w+) \{([^}]*)\}", text)]
    decided = {path: re.sub(r"_Static_assert\([^;]*;", "", text) for path, text in sources.items()}
    tables, switches, comparisons = (find_words(decided, place) for place in (
        r"\[(\w+)\] =", r"\bcase (\w+):", r"[=!]= (\w+)"))
    for enum in enums:
        enum.tables = enum.find_places(tables)
        enum.switches = enum.find_places(switches)
        enum.comparisons = enum.find_places(comparisons)
    return [enum for enum in enums if enum.name not in NO_KINDS]


class Kinds(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.sources = read_sources()
        cls.enums = read_enums(cls.sources)

    def test_files_with_tables_of_kinds_state_how_many_they_know(self):
        for enum in self.enums:
            for path in sorted(enum.stating()):
                if pathlib.Path(path).name == PARTIAL.get(enum.name):
                    continue
                with self.subTest(enum=enum.name, file=path):
                    self.assertIn(enum.state(), self.sources[path])

    def test_switches_list_all_kinds(self):
        self.assertIn("-Wswitch-enum", (ROOT / "CMakeLists.txt").read_text())

    def test_phase_functions_have_own_rows(self):
        """A phase function is its file and its line of the registry. Other files only test whether
        scattering is isotropic, and which kinds another program supports."""
        for path, text in self.sources.items():
            self.assertNotRegex(text, r"case NEPH_PHASE_|\[NEPH_PHASE_(?!(KIND_)?COUNT)[A-Z_]+\] =|"
                                      r"[=!]= NEPH_PHASE_(?!ISOTROPIC)", path)

    def compile_with_one_more(self, enum):
        """Returns the files with decisions that still compile."""
        commands = {entry["file"]: entry for entry in
                    json.loads((BUILD / "compile_commands.json").read_text())}
        header = (ROOT / enum.header).read_text()
        at = re.search(rf"\benum {enum.name} \{{", header).end()
        at += re.search(rf"\b{enum.count}\b", header[at:]).start()
        passed = []
        with tempfile.TemporaryDirectory() as folder:
            changed = pathlib.Path(folder) / enum.header
            changed.parent.mkdir(parents=True)
            changed.write_text(header[:at] + "NEPH_ONE_MORE_KIND, " + header[at:])
            for path in sorted(enum.stating() | enum.switches):
                entry = commands.get(str(ROOT / path))
                if path == enum.header or not entry:  # a header: its files are in the list, too
                    continue
                words = shlex.split(entry["command"])
                words = words[:words.index("-o")] + ["-Werror", "-fsyntax-only", str(ROOT / path)]
                words.insert(1, f"-iquote{folder}")
                done = subprocess.run(words, cwd=entry["directory"], capture_output=True, text=True)
                if done.returncode == 0 or not re.search(r"static assertion|switch", done.stderr):
                    passed.append((path, done.stderr))
        return passed

    def test_a_phase_function_without_its_files_does_not_build(self):
        """One more line in the registry: C needs a row, shaders need a case of each function."""
        commands = {entry["file"]: entry for entry in
                    json.loads((BUILD / "compile_commands.json").read_text())}
        entry = commands[str(ROOT / "scenes/phase.c")]
        words = shlex.split(entry["command"])
        words = words[:words.index("-o")]
        kinds = (ROOT / "scenes/phase_kinds.h").read_text()
        with tempfile.TemporaryDirectory() as folder:
            changed = pathlib.Path(folder) / "scenes/phase_kinds.h"
            changed.parent.mkdir()
            changed.write_text(kinds.replace("of(0,", "of(10, ONE_MORE, one_more) of(0,"))
            made = pathlib.Path(folder) / "phase.o"
            subprocess.run([words[0], f"-iquote{folder}", *words[1:], "-o", made, "-c",
                            ROOT / "scenes/phase.c"], cwd=entry["directory"], check=True)
            names = subprocess.run(["nm", "-u", made], capture_output=True, text=True, check=True)
            self.assertIn("neph_phase_one_more", names.stdout)
            shader = subprocess.run(
                ["glslc", "--target-env=vulkan1.2", "-I", folder, "-I", ROOT, "-I",
                 ROOT / "renderer/shaders", ROOT / "renderer/shaders/march.comp",
                 "-o", "/dev/null"],
                capture_output=True, text=True)
            self.assertIn("A new kind", shader.stderr)

    @night.of_the_night
    def test_no_place_compiles_with_one_more_kind(self):
        places = collections.Counter()
        for enum in self.enums:
            if not enum.tables and enum.name not in COMPARED:
                continue
            with self.subTest(enum=enum.name):
                self.assertEqual(self.compile_with_one_more(enum), [])
                places[enum.name] = len(enum.stating() | enum.switches)
        print(f"{sum(places.values())} places of {len(places)} enums")


if __name__ == "__main__":
    unittest.main()
