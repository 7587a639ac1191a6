# SPDX-License-Identifier: MIT
"""What tests of studies have in common: a folder of their own, in which neph runs."""
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

NEPH = os.environ["NEPH"]
ENVIRONMENT = {**os.environ, "NEPH_VULKAN_VALIDATION": "1"}


class StudyCase(unittest.TestCase):
    words = ()  # of each command, before the arguments of a test

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def run_neph(self, *arguments):
        return subprocess.run([NEPH, *map(str, self.words + arguments)], cwd=self.folder,
                              env=ENVIRONMENT, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              text=True, timeout=300)

    def succeed(self, *arguments):
        done = self.run_neph(*arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done

    def measure(self, *arguments):
        return json.loads(self.succeed(*arguments, "--json").stdout)

    def check_refusals(self, *cases):
        """Each (exit code, what the error says, arguments)."""
        for code, said, arguments in cases:
            done = self.run_neph(*arguments)
            self.assertEqual(done.returncode, code, (arguments, done.stderr))
            self.assertIn(said, " ".join(done.stderr.split()), arguments)
            self.assertEqual(done.stdout, "")
