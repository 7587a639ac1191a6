#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""scripts/fuzz with scripts in place of the fuzzers: its counts, stored files and messages."""
import concurrent.futures
import json
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import unittest

import night

ROOT = pathlib.Path(os.environ.get("NEPH_SOURCE_DIR")
                    or pathlib.Path(__file__).resolve().parents[2])

BUILD = pathlib.Path(os.environ.get("NEPH", ROOT / "build/release/neph")).parent

# The output of libFuzzer; a corpus that grows by one file each time.
QUIET = """#!/bin/sh
for word; do case $word in -*) ;; *) corpus=$word; break ;; esac; done
echo x > "$corpus/$(ls "$corpus" | wc -l)"
printf '#%s\\tDONE cov: 1\\nstat::number_of_executed_units: %s\\n' 1200 1200 >&2
"""
BROKEN = """#!/bin/sh
for word; do case $word in -artifact_prefix=*) found=${word#*=} ;; esac; done
echo x > "${found}crash-0123"
printf '#77\\tNEW cov: 1\\n==1==ERROR: AddressSanitizer\\n' >&2
exit 77
"""


class Fuzz(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.programs = self.folder / "programs"
        self.programs.mkdir()

    def program(self, name, text):
        path = self.programs / f"fuzz_{name}"
        path.write_text(text)
        path.chmod(0o755)

    def fuzz(self, *arguments, code=0, **options):
        done = subprocess.run([sys.executable, ROOT / "scripts/fuzz", *arguments],
                              capture_output=True, text=True, timeout=60, **options)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done

    def run_over(self, *readers, **options):
        return self.fuzz("--seconds", "2", "--build", self.programs, "--output", self.folder,
                         *readers, **options).stdout

    def readers(self):
        return json.loads((self.folder / "fuzz/fuzz.json").read_text())["readers"]

    def test_inputs_are_counted_over_the_week_and_the_corpus_is_kept(self):
        self.program("exr", QUIET)
        self.program("plan", QUIET)
        self.run_over("exr", "plan")
        said = self.run_over("exr", "plan")
        for run in self.readers():
            self.assertEqual((run["executions"], run["week"], run["corpus"]), (1200, 2400, 2))
            self.assertAlmostEqual(run["seconds_a_night"],
                                   1e7 / 7 / run["per_processor_second"])
            self.assertFalse(run["reaches"])
        self.assertIn("Fuzz: 2400 inputs to 2 readers, none broke; 0 of 2 reach",
                      said.splitlines()[-1])

    def test_findings_are_kept_and_fail(self):
        self.program("exr", QUIET)
        self.program("png", BROKEN)
        said = self.run_over("exr", "png", code=1)
        found = self.folder.resolve() / "fuzz/png/found/crash-0123"
        self.assertTrue(found.is_file())
        self.assertIn(f"png breaks: fuzz_png {found}", said)
        self.assertIn("png BROKE", said.splitlines()[-1])
        self.assertEqual([run["executions"] for run in self.readers()], [1200, 77])

    def test_each_reader_has_a_corpus_and_a_replay(self):
        names = {path.stem.removeprefix("fuzz_") for path in
                 (ROOT / "tests/fuzz").glob("fuzz_*.c")}
        self.assertGreaterEqual(len(names), 12)
        for name in names:
            self.assertTrue(any((ROOT / "tests/fuzz/corpus" / name).iterdir()), name)
        listed = re.search(r"set\(of_the_harness ([a-z0-9 ]+)\)",
                           (ROOT / "tests/fuzz/CMakeLists.txt").read_text())[1].split()
        self.assertLessEqual(set(listed), names)

    @night.of_the_night
    def test_fuzzer_sources_compile_with_clang(self):
        """Otherwise scripts/fuzz does not build: gcc accepts some expressions as constants that
        clang refuses."""
        clang, commands = shutil.which("clang"), BUILD / "compile_commands.json"
        if not clang or not commands.exists():
            self.skipTest("clang is not installed, or the build has no compile_commands.json")
        def refusal(entry):
            words = [word for word in shlex.split(entry["command"]) if word != "-Werror"]
            words = words[next(n for n, word in enumerate(words) if word.startswith("-")):]
            at = words.index("-o")
            done = subprocess.run([clang, "-fsyntax-only", "-w", *words[:at], *words[at + 2:]],
                                  cwd=entry["directory"], capture_output=True, text=True)
            return done.stderr if done.returncode else ""
        entries = [entry for entry in json.loads(commands.read_text())
                   if entry["file"].endswith(".c") and "/tests/" not in entry["file"]]
        self.assertGreater(len(entries), 200)
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            self.assertEqual([said for said in pool.map(refusal, entries) if said], [])

    def test_missing_tools_and_wrong_arguments(self):
        self.assertIn("there is no reader 'pdf'", self.fuzz("pdf", code=2).stderr)
        self.fuzz("--seconds", "0", code=2)
        empty = self.folder / "empty"
        empty.mkdir()
        told = self.fuzz(code=69, env={**os.environ, "PATH": str(empty)}).stderr
        self.assertIn("clang is not installed: apt-get install", told)


if __name__ == "__main__":
    unittest.main()
