#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""scripts/budget.py: input, sums, scaling, and tests over the budget. No absolute times."""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPTS = pathlib.Path(os.environ["NEPH_SOURCE_DIR"]) / "scripts"
sys.path.insert(0, str(SCRIPTS))

import budget  # noqa: E402

BUDGETS = """
# a comment
reference_one    2     s      one copy
reference_all    4     s      a copy on each core
slack            25    %      noise
build_c          100   s      C
tests            2     min    tests
program          1000  bytes  program
first_march      400   ms     a frame   # and a comment
"""
# This machine is half as fast as the limits' machine, and a quarter as fast with all cores busy.
REFERENCES = {"reference_one": 4, "reference_all": 16}


def judge(**measured):
    return budget.judge(budget.read_budgets(BUDGETS), measured, REFERENCES)


class Budgets(unittest.TestCase):
    def test_the_file_of_the_repository(self):
        budgets = budget.read_budgets((SCRIPTS / "budgets.txt").read_text())
        self.assertEqual(set(budgets), {
            "reference_one", "reference_all", "slack", "build_shaders", "slowest_shader", "build_c",
            "build_tests", "tests", "program_gcc12", "program_gcc14", "first_march", "first_ours",
            "first_ours_cold"})
        self.assertEqual(budgets["program_gcc12"][1], budget.EXACT)

    def test_a_wrong_line_is_named(self):
        for line in ("tests 18", "tests 18 hours all", "tests many min all", "slack 1 % twice"):
            with self.assertRaisesRegex(ValueError, "line 10|many"):
                budget.read_budgets(BUDGETS + line)

    def test_times_are_scaled_and_have_slack(self):
        self.assertEqual(judge(build_c=4 * 124, first_march=2 * 0.499, tests=4 * 149)[1], [])
        self.assertEqual(judge(build_c=4 * 126, first_march=2 * 0.501, tests=4 * 151)[1],
                         ["build_c", "tests", "first_march"])
        lines = judge(build_c=4 * 126, tests=4 * 60)[0]
        self.assertRegex(lines[0], r"^! build_c: 126 s, limit 100: C  \*\* OVER ITS LIMIT")
        self.assertEqual(lines[1], "  tests: 1 min, limit 2: tests")

    def test_a_size_is_exact(self):
        self.assertEqual(judge(program=1000)[1], [])
        self.assertEqual(judge(program=1001)[1], ["program"])

    def test_unmeasured_tests_are_reported(self):
        lines, over = judge(build_c=None)
        self.assertEqual(over, [])
        self.assertEqual(len(lines), 4)
        for line in lines:
            self.assertIn("not measured in this run", line)

    def test_commands_of_the_last_build_of_an_output_are_summed(self):
        times = budget.read_command_times([
            "/b/a.inc 10 glslc 1.5 0.5", "/b/a b.o 11 cc 3,25 0,25", "/b/a.inc 10 sed 1 1",
            "an interrupted line", "/b/a.inc 12 glslc 0.5 0.25", "/b/a.inc 12 sed 0.125 0", ""])
        self.assertEqual(times, {"/b/a.inc": 0.875, "/b/a b.o": 3.5})

    def test_a_sum_is_of_all_outputs_or_none(self):
        targets = ["base/a.o: C_COMPILER__neph_base_Release", "b.o: CXX_COMPILER__x_Release",
                   "renderer/s.comp.inc: CUSTOM_COMMAND", "/b/renderer/s.comp.inc: CUSTOM_COMMAND",
                   "renderer/t.comp.inc: CUSTOM_COMMAND", "tests/c.o: C_COMPILER__test_c_Release",
                   "tests/u.comp.inc: CUSTOM_COMMAND", "neph.1: CUSTOM_COMMAND", "all: phony", ""]
        sums = budget.sum_by_budget(targets, {
            "base/a.o": 1, "b.o": 2, "renderer/s.comp.inc": 4, "renderer/t.comp.inc": 8,
            "gone.o": 16, "tests/c.o": 32})
        self.assertEqual(sums, {"build_c": 3, "build_shaders": 12, "slowest_shader": 8,
                                "build_tests": None})

    def test_times_of_a_shell(self):
        self.assertEqual(budget.read_shell_times("0m1.000s 0m1.000s\n2m3.250s 1m0.500s\n"), 183.75)
        told = subprocess.run(["bash", "-c", "sh -c 'exit 0'; times"], capture_output=True,
                              text=True, check=True).stdout
        self.assertGreaterEqual(budget.read_shell_times(told), 0)

    def test_a_timed_command_is_the_command(self):
        with tempfile.TemporaryDirectory() as folder:
            script = "echo; echo said >&2; exit 3"
            done = subprocess.run(
                [SCRIPTS / "timed_command", "out.o", "log", "sh", "-c", script],
                capture_output=True, text=True, cwd=folder)
            self.assertEqual((done.returncode, done.stdout, done.stderr), (3, "\n", "said\n"))
            log = (pathlib.Path(folder) / "log").read_text()
            place = os.path.realpath(folder)
            self.assertRegex(log, rf"^{place}/out.o {os.getpid()} sh [0-9.,]+ [0-9.,]+\n$")


if __name__ == "__main__":
    unittest.main()
