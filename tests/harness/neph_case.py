# SPDX-License-Identifier: MIT
"""What tests of whole commands have in common: a folder of their own, and neph run."""
import os
import pathlib
import subprocess
import tempfile
import unittest

NEPH = os.environ["NEPH"]


class NephCase(unittest.TestCase):
    surroundings = os.environ  # of neph, before those of a call
    timeout_s = 600

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def neph(self, *arguments, code=0, said=(), silent=False, program=NEPH, cwd=None,
             **environment):
        """Run neph: it ends with that code (None: any) and says all of `said` on stderr; `silent`:
        and nothing on stdout."""
        done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True,
                              timeout=self.timeout_s, cwd=cwd,
                              env={**self.surroundings, **environment})
        if code is not None:
            self.assertEqual(done.returncode, code, (arguments, done.stderr))
        for words in [said] if isinstance(said, str) else said:
            self.assertIn(words, done.stderr, arguments)
        if silent:
            self.assertEqual(done.stdout, "", arguments)
        return done
