#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Lists of packages, and scripts/matrix with small scripts in place of debootstrap and chroots."""
import contextlib
import importlib.machinery
import importlib.util
import io
import json
import os
import pathlib
import subprocess
import tempfile
import unittest
from unittest import mock

ROOT = pathlib.Path(os.environ["NEPH_SOURCE_DIR"])
LOADER = importlib.machinery.SourceFileLoader("matrix", str(ROOT / "scripts/matrix"))
matrix = importlib.util.module_from_spec(importlib.util.spec_from_loader("matrix", LOADER))
LOADER.exec_module(matrix)

DEBOOTSTRAP = """#!/bin/sh
[ "$2" != broken ] || { echo no such release; exit 1; }
mkdir -p "$3/etc/dpkg/dpkg.cfg.d" "$3/usr/sbin" "$3/root"
"""
# The last argument is the command that scripts/matrix runs in a chroot, the one before it the
# chroot.
UNSHARE = """#!/bin/sh
while [ $# -gt 2 ]; do shift; done
case "$1 $2" in
*dpkg-query*) printf 'gcc 4:12.2\\nblender \\nmesa-vulkan-drivers 22.3.6\\n' ;;
*bad*scripts/test) echo one; echo two; exit 8 ;;
*bad*scripts/package) exit 1 ;;
*scripts/package) mkdir -p "$1/root/nephelometer/scripts" "$1/root/nephelometer/build/packages"
    touch "$1/root/nephelometer/build/packages/neph.deb" "$1/installed" ;;
*.bare*scripts/package*--try) [ ! -e "$1/installed" ] &&
    [ -e "$1/root/nephelometer/build/packages/neph.deb" ] ;;
*--try) exit 9 ;;
*interrupted*scripts/test) kill -INT $PPID; sleep 0.1 ;;
esac
"""


def packages():
    lines = (ROOT / "scripts/packages.txt").read_text().splitlines()
    return [line.split("#")[0].split() for line in lines if not line.startswith("#")]


class Packages(unittest.TestCase):
    def test_every_line_has_its_fields(self):
        for line in packages():
            self.assertEqual(len(line), 4, line)
            self.assertIn(line[2], ("build", "package", "validate", "test", "night"))

    def test_the_page_lists_the_packages_of_the_file(self):
        page = (ROOT / "docs/building.md").read_text()
        for system, column, command in (("ubuntu", 0, "apt-get install"),
                                        ("fedora", 3, "dnf install")):
            mark = f"<!-- written by scripts/packages.txt: {system} -->"
            section = page.split(mark)[1].split("<!-- end -->")[0]
            for need in ("build", "package", "validate", "test"):
                names = [name for line in packages() if line[2] == need
                         for name in line[column].split(",") if name != "-" and name[-1] != "?"]
                if system == "ubuntu":
                    names = [name for name in names if name != "chromium"]
                line = section.split(f"# {need}\n")[1].split("\n\n")[0].split("```")[0]
                self.assertEqual(line.replace("\\\n", " ").split(), [*command.split(), *names])

    def test_a_package_of_newer_releases_is_installed_where_apt_knows_it(self):
        with tempfile.TemporaryDirectory() as folder:
            for name, text in (("apt-cache", 'test "$KNOWN" = yes'), ("dpkg-query", "false")):
                program = pathlib.Path(folder, name)
                program.write_text(f"#!/bin/sh\n{text}\n")
                program.chmod(0o755)
            names = pathlib.Path(folder, "scripts/packages.txt")
            names.parent.mkdir()
            names.write_text(f"new? - build -\nhere? {folder} build -\nold sh build -\n")
            for known, missing in (("yes", ["new"]), ("no", [])):
                done = subprocess.run(
                    ["bash", "-c",
                     f". {ROOT}/scripts/setup.sh; root={folder}; missing_packages build"],
                    env={**os.environ, "KNOWN": known, "PATH": f"{folder}:{os.environ['PATH']}"},
                    capture_output=True, text=True, check=True)
                self.assertEqual(done.stdout.split(), missing)


class Matrix(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.output = self.folder / "results/day.json"
        for name, text in (("debootstrap", DEBOOTSTRAP), ("unshare", UNSHARE),
                           ("git", "#!/bin/sh\necho 0123abcd\n")):
            program = self.folder / "bin" / name
            program.parent.mkdir(exist_ok=True)
            program.write_text(text)
            program.chmod(0o755)

    def run_matrix(self, *releases):
        stdout, stderr = io.StringIO(), io.StringIO()
        path = f"{self.folder / 'bin'}:{os.environ['PATH']}"
        with contextlib.redirect_stdout(stdout), contextlib.redirect_stderr(stderr), \
                mock.patch.dict(os.environ, PATH=path), mock.patch("os.geteuid", lambda: 0):
            code = matrix.main([*releases, "--folder", str(self.folder / "chroots"),
                                "-o", str(self.output)])
        return code, stdout.getvalue(), stderr.getvalue()

    def rows(self):
        return {row["release"]: row for row in json.loads(self.output.read_text())["rows"]}

    def test_rows_of_several_runs_stand_in_one_file(self):
        self.assertEqual(self.run_matrix("good")[0], 0)
        code, table, said = self.run_matrix("bad")
        self.assertEqual(code, 1)
        self.assertRegex(table, r"\| good (\| pass, [^|]* ){4}\| 22.3.6 \| 4:12.2 \| - \| - \|")
        self.assertRegex(table, r"\| bad \| pass, .* \| \*\*exit code 8\*\*, [^|]*"
                                r"\| \*\*exit code 1\*\*, [^|]*\| not run \|")
        self.assertIn("bad: scripts/test: **exit code 8**", said)
        self.assertEqual(list(self.rows()), ["good", "bad"])
        self.assertEqual(self.rows()["bad"]["results"][1]["end"], ["one", "two"])
        self.assertEqual(self.rows()["bad"]["commit"], "0123abcd")

    def test_a_release_that_may_fail(self):
        with mock.patch.object(matrix, "MAY_FAIL", {"bad", "broken"}):
            code, table, said = self.run_matrix("broken", "bad", "good")
        self.assertEqual(code, 0)
        self.assertIn("no such release", said)
        self.assertIn("| bad |", table)
        self.assertEqual(self.run_matrix("broken")[0], 1)

    def test_frames_of_each_engine_are_counted(self):
        report = {"verdict": "pass", "counts": {"expected": 3},
                  "engines": [{"name": "cycles", "version": "Blender 4.3.2", "available": True},
                              {"name": "povray", "version": "", "available": False}],
                  "scenes": [{"frames": [{"engine": "cycles", "status": "rendered"},
                                         {"engine": "povray", "status": "missing"}]},
                             {"frames": [{"engine": "cycles", "status": "rendered"}]}]}
        data = self.folder / matrix.CLONE / "out/validate/report/data.json"
        data.parent.mkdir(parents=True)
        data.write_text(json.dumps(report))
        row = {"report": matrix.read_report(self.folder)}
        self.assertEqual(row["report"]["expected"], 3)
        self.assertEqual([matrix.describe_engine(row, name)
                          for name in ("cycles", "povray", "none")],
                         ["Blender 4.3.2, 2 rendered", "missing, 1 missing", "-"])

    def test_finished_chroots_are_kept(self):
        with self.assertRaises(KeyboardInterrupt):
            self.run_matrix("good", "interrupted")
        self.assertEqual([len(row["results"]) for row in self.rows().values()], [4, 1])

    def test_a_file_of_something_else_is_not_overwritten(self):
        self.output.parent.mkdir()
        earlier = '{"rows": [{"release": "good", "results": [], "versions": {}, ' \
                  '"report": {"engines": {"cycles": "3.4"}}}]}'
        for text in ("no JSON", "[]", earlier):
            self.output.write_text(text)
            with self.assertRaises(SystemExit) as stopped:
                self.run_matrix("good")
            self.assertEqual(stopped.exception.code, 65)
            self.assertEqual(self.output.read_text(), text)


if __name__ == "__main__":
    unittest.main()
