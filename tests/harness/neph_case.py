# SPDX-License-Identifier: MIT
"""Common parts of tests of whole commands: a folder of their own, and running neph."""
import hashlib
import json
import os
import pathlib
import signal
import subprocess
import tempfile
import time
import unittest

NEPH = os.environ["NEPH"]
ROOT = pathlib.Path(os.environ["NEPH_SOURCE_DIR"])
VALIDATED = {**os.environ, "NEPH_VULKAN_VALIDATION": "1"}


def scratch(at_the_end):
    """Creates a folder; `at_the_end`, a test's addCleanup or its class's addClassCleanup, removes
    it."""
    folder = tempfile.TemporaryDirectory(prefix="neph-test-")
    at_the_end(folder.cleanup)
    return pathlib.Path(folder.name)


def words_of(arguments):
    return [word if isinstance(word, bytes) else str(word) for word in arguments]


def run(*arguments, program=NEPH, surroundings=os.environ, timeout_s=600, cwd=None, text=True,
        **environment):
    """Runs neph with these variables changed."""
    return subprocess.run([program, *words_of(arguments)], capture_output=True, text=text,
                          timeout=timeout_s, cwd=cwd, env={**surroundings, **environment})


class NephCase(unittest.TestCase):
    surroundings = os.environ  # the environment of neph, before the changes of a call
    words = ()  # of each command, before the arguments of a call
    in_folder = False  # whether neph runs in the test's folder

    def setUp(self):
        self.folder = scratch(self.addCleanup)

    def put(self, name, text="mine"):
        """Writes a file into the test's folder."""
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        return path

    def put_program(self, name, text):
        """Writes a script in place of a program; returns an environment in which it is found
        first."""
        path = self.put(f"bin/{name}", text)
        path.chmod(0o755)
        return {"PATH": f"{path.parent}:/usr/bin:/bin"}

    def where(self, cwd=None):
        return cwd or (self.folder if self.in_folder else None)

    def neph(self, *arguments, code=0, said=(), silent=False, cwd=None, **options):
        """Runs neph. It must exit with this code (None: any) and print all of `said` on stderr;
        `silent`: and nothing on stdout. Further options are passed to run()."""
        done = run(*self.words, *arguments, cwd=self.where(cwd),
                   **{"surroundings": self.surroundings, **options})
        if code is not None:
            self.assertEqual(done.returncode, code, (arguments, done.stdout, done.stderr))
        for words in [said] if isinstance(said, str) else said:
            self.assertIn(words, done.stderr, arguments)
        if silent:
            self.assertEqual(done.stdout, "", arguments)
        return done

    def json(self, *arguments, **expected):
        """The document that neph prints."""
        return json.loads(self.neph(*arguments, "--json", **expected).stdout)

    def check_refusals(self, *cases, before=(), **options):
        """Each case: (exit code, one or several parts of the message, arguments after `before`)."""
        for code, said, arguments in cases:
            done = self.neph(*before, *arguments, code=code, silent=True, **options)
            for words in [said] if isinstance(said, str) else said:
                self.assertIn(words, " ".join(done.stderr.split()), arguments)

    def start(self, *arguments, niceness=0, **environment):
        """Starts neph in the background."""
        def prepare():
            signal.signal(signal.SIGINT, signal.SIG_DFL)  # a shell's background job ignores it
            os.nice(niceness)
        child = subprocess.Popen([NEPH, *words_of(self.words + arguments)], text=True,
                                 stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                 cwd=self.where(), env={**self.surroundings, **environment},
                                 preexec_fn=prepare)
        for stream in (child.stdout, child.stderr):
            self.addCleanup(stream.close)
        return child

    def wait_until(self, condition, child=None, seconds=300):
        """Waits for the condition, or until the child has ended."""
        end = time.monotonic() + seconds
        while not condition() and (not child or child.poll() is None):
            self.assertLess(time.monotonic(), end)
            time.sleep(0.01)

    def interrupt(self, child):
        """Sends Ctrl-C; returns its stdout and stderr."""
        child.send_signal(signal.SIGINT)
        said = child.communicate(timeout=120)
        self.assertEqual(child.returncode, 130, said)
        return said

    def stamps(self, folder):
        """The modification time of each entry of a folder: rendering again changes it."""
        return {path: path.stat().st_mtime_ns for path in folder.iterdir()}


class StudyCase(NephCase):
    """Tests of studies that render on a device, in the test's folder."""
    surroundings = VALIDATED
    in_folder = True


def keep_trial(program, cache, data_file=None, **found):
    """Writes the result of a trial of this program into neph's cache folder, under the file name
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
