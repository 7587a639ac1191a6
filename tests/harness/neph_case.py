# SPDX-License-Identifier: MIT
"""What tests of whole commands have in common: a folder of their own, and neph run."""
import hashlib
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

NEPH = os.environ["NEPH"]
ROOT = pathlib.Path(os.environ["NEPH_SOURCE_DIR"])


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


def keep_trial(program, cache, data_file=None, **found):
    """Leave in neph's cache folder what a trial of that program would have found, under the name
    that harness/engines/trial.c gives it."""
    facts = program.stat()
    data = (ROOT / data_file).read_bytes() if data_file else None
    digest = hashlib.blake2b(data, digest_size=32).hexdigest() if data else ""
    words = (f"2\n{program.resolve()}\n{facts.st_size}\n"
             f"{facts.st_mtime_ns // 10**9}.{facts.st_mtime_ns % 10**9:09}\n{digest}")
    name = hashlib.blake2b(words.encode(), digest_size=32).hexdigest()[:32]
    file = cache / "nephelometer/trials" / f"{name}.json"
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(json.dumps({"program": str(program), **found}))
