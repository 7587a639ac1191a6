#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""scripts/package, scripts/snapshot and the Containerfile. By night a .deb and a .tar.gz are made
of this build: dpkg installs the one below a folder, neph runs from there, and dpkg removes it."""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import unittest

from neph_case import NEPH, ROOT, NephCase, scratch
from night import of_the_night

DAY = "20261130T000000Z"
SYSTEM = "/usr/bin/python3"  # Debian's, which has numpy
SCENES = "share/nephelometer/scenes/catalog/absorbing_slab.yaml"
# Each kind of file that neph installs, below the prefix.
FILES = ["bin/neph", "bin/neph-vdb", "lib/libneph_metrics.so", "lib/libneph_metrics.so.0",
         "include/neph_metrics.h", "lib/pkgconfig/neph_metrics.pc",
         "lib/cmake/neph_metrics/neph_metrics-config.cmake", SCENES,
         "share/nephelometer/renderer/blue_noise.png",
         "share/nephelometer/scripts/report/report.js", "share/man/man1/neph.1",
         "share/man/man1/neph-compare.1", "share/bash-completion/completions/neph",
         "share/doc/nephelometer/LICENSE", "share/doc/nephelometer/docs/library.md"]
MODULE = {"__init__.py", "_frames.py", "_installed.py", "_library.py"}


def run(*words, **environment):
    clean = {name: value for name, value in os.environ.items() if not name.startswith("NEPH_")}
    return subprocess.run([str(word) for word in words], capture_output=True, text=True,
                          timeout=800, env={**clean, **environment}, check=False)


def succeed(*words, **environment):
    done = run(*words, **environment)
    assert done.returncode == 0, (words, done.stdout, done.stderr)
    return done.stdout


def files_below(folder):
    """Files and links, relative to the folder."""
    return {str(path.relative_to(folder)) for path in folder.rglob("*")
            if path.is_symlink() or not path.is_dir()}


class Container(NephCase):
    def setUp(self):
        super().setUp()
        self.lines = [line for line in (ROOT / "Containerfile").read_text().splitlines()
                      if line and not line.startswith("#")]

    def of(self, instruction):
        return [line.split(" ", 1)[1] for line in self.lines if line.startswith(instruction + " ")]

    def test_steps_are_scripts_that_a_test_runs(self):
        tests = "".join(path.read_text() for path in (ROOT / "tests/harness").glob("e2e_*.py"))
        for step in self.of("RUN"):
            words = [word for word in step.split() if not word.startswith("--mount=")]
            self.assertRegex(words[0], "^/src/scripts/", step)
            script = ROOT / words[0].removeprefix("/src/")
            self.assertTrue(os.access(script, os.X_OK), step)
            self.assertIn(f"scripts/{script.name}", tests, step)
            for option in words[1:]:
                self.assertTrue(option == "${DAY}" or option in script.read_text(), step)
        self.assertEqual(len(self.of("RUN")), 4)
        self.assertEqual((self.of("COPY"), self.of("ENTRYPOINT")), ([". /src"], ['["neph"]']))

    def test_base_and_packages_are_those_of_a_day(self):
        base, day = (line.split("=", 1)[1] for line in self.of("ARG") if "=" in line)
        self.assertRegex(base, r"^docker\.io/library/debian:bookworm-20\d{6}-slim$")
        self.assertEqual(day, DAY)
        for line in self.of("FROM"):
            self.assertEqual(line.split()[0], "${BASE}")

    def test_results_of_builds_are_not_copied(self):
        ignored = (ROOT / ".dockerignore").read_text().split()
        for name in ("build", "out", ".git", "**/node_modules"):
            self.assertIn(name, ignored)


class Snapshot(NephCase):
    def snapshot(self, day):
        return run("bash", ROOT / "scripts/snapshot", day, self.folder)

    def test_apt_reads_the_archives_of_that_day_only(self):
        self.put("sources.list", "deb http://deb.debian.org/debian bookworm main\n")
        self.put("sources.list.d/other.list", "deb http://deb.debian.org/debian sid main\n")
        self.assertEqual(self.snapshot(DAY).returncode, 0)
        said = succeed("apt-get", "-o", f"Dir::Etc::sourcelist={self.folder}/sources.list",
                       "-o", f"Dir::Etc::sourceparts={self.folder}/sources.list.d",
                       "-o", f"Dir::State::lists={self.folder}", "--print-uris", "update")
        uris = re.findall(r"^'(\S+)/dists/\S+/InRelease'", said, re.MULTILINE)
        self.assertEqual(sorted(uris), sorted(
            f"http://snapshot.debian.org/archive/{archive}/{DAY}"
            for archive in ("debian", "debian", "debian-security")))

    def test_today_changes_nothing(self):
        self.assertEqual(self.snapshot("today").returncode, 0)
        self.assertEqual(files_below(self.folder), set())

    def test_a_day_that_is_none(self):
        for day in ("", "2026-11-30", f"{DAY}/../x"):
            done = self.snapshot(day)
            self.assertEqual((done.returncode, files_below(self.folder)), (64, set()))
            self.assertIn(f"'{day}' is no day: {DAY}", done.stderr)


class Refusals(NephCase):
    def test_arguments(self):
        done = run(ROOT / "scripts/package", "--remove")
        self.assertEqual((done.returncode, done.stdout), (64, ""))
        self.assertIn("usage: scripts/package [--no-charts | --install | --try] [FOLDER]",
                      done.stderr)
        done = run(ROOT / "scripts/package", "--install", self.folder)
        self.assertEqual((done.returncode, done.stdout), (66, ""))
        self.assertIn(f"no neph_*.deb in {self.folder}: run scripts/package", done.stderr)


class Targets(unittest.TestCase):
    def test_scripts_build_all_that_is_installed(self):
        """scripts/package and scripts/ci build only these targets."""
        build = pathlib.Path(NEPH).parent
        rules = "".join(path.read_text() for path in build.rglob("cmake_install.cmake"))
        installed = {str((build / name).resolve().relative_to(build)) for name in re.findall(
            rf'TYPE (?:EXECUTABLE|SHARED_LIBRARY|PROGRAM)\b.*?FILES\s+"{build}/([^"]+)"', rules)}
        said = succeed("bash", "-c", f'. "{ROOT}/scripts/setup.sh"; echo ${{installed_targets[@]}}')
        inputs = succeed("ninja", "-C", build, "-t", "inputs", *said.split()).splitlines()
        self.assertLessEqual({"neph", "neph-vdb", "library/libneph_metrics.so.0.1.0"}, installed)
        self.assertEqual(installed - set(inputs), set())


@of_the_night
@unittest.skipUnless(shutil.which("dpkg-shlibdeps") and shutil.which("file"),
                     "skipped: no dpkg-dev, file")
class Package(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = scratch(cls.addClassCleanup)
        # cpack starts a program for each file: with those of charts, minutes.
        said = succeed(ROOT / "scripts/package", "--no-charts", cls.folder,
                       NEPH_BUILD=str(pathlib.Path(NEPH).parent))
        deb, archive = said.splitlines()
        assert deb.endswith(".deb") and archive.endswith(".tar.gz"), said
        cls.deb, cls.tree = deb, cls.folder / "tree"
        succeed("dpkg-deb", "-x", deb, cls.tree)
        (cls.folder / "moved").mkdir()
        succeed("tar", "-xf", archive, "-C", cls.folder / "moved")
        cls.moved, = (cls.folder / "moved").iterdir()

    def check_program(self, prefix):
        """Program, scenes and module of a tree that is neither installed nor built here."""
        neph = prefix / "bin/neph"
        self.assertEqual(succeed(neph, "--version"), succeed(NEPH, "--version"))
        self.assertIn("absorbing_slab", succeed(neph, "scenes"))
        frame = self.folder / "frame.exr"
        succeed(neph, "render", "absorbing_slab", "-e", "exact", "--size", "8x6", "-q", "-o", frame)
        module, = prefix.rglob("neph/__init__.py")
        said = succeed(SYSTEM if os.path.exists(SYSTEM) else sys.executable, "-c",
                       "import neph; print(neph.__file__, neph._library.find(), neph.version())",
                       PYTHONPATH=str(module.parent.parent), PYTHONDONTWRITEBYTECODE="")
        there, library, version = said.split()
        self.assertEqual(there, str(module))
        self.assertTrue(os.path.samefile(library, prefix / "lib/libneph_metrics.so.0"))
        self.assertIn(version, succeed(neph, "--version"))

    def test_both_have_all_files(self):
        others = []
        for prefix in self.tree / "usr", self.moved / "usr":
            found = files_below(prefix)
            self.assertEqual(set(FILES) - found, set())
            modules = {name for name in found if "-packages/neph/" in name}
            self.assertEqual({pathlib.Path(name).name for name in modules}, MODULE)
            others.append(found - modules)
        self.assertEqual(*others)
        # Debian's place. An archive has the place of this Python in any prefix.
        self.assertTrue((self.tree / "usr/lib/python3/dist-packages/neph/__init__.py").exists())

    def test_what_it_depends_on(self):
        fields = dict(line.split(": ", 1) for line in
                      succeed("dpkg-deb", "-f", self.deb).splitlines() if ": " in line)
        for name in ("python3", "libc6", "libsqlite3-0", "zlib1g", "libyaml-0-2"):
            self.assertRegex(fields["Depends"], rf"\b{name}\b")
        self.assertEqual(fields["Recommends"], "libvulkan1, mesa-vulkan-drivers, python3-numpy")
        for name in ("blender", "povray", "ffmpeg", "python3-pandas", "python3-matplotlib"):
            self.assertIn(name, fields["Suggests"])
        self.assertIn(fields["Version"], succeed(NEPH, "--version"))
        self.assertNotIn("SPIRV-Tools", succeed("readelf", "-d", self.tree / "usr/bin/neph"))

    def test_neph_runs_from_a_package_that_is_unpacked(self):
        self.check_program(self.tree / "usr")
        self.check_program(self.moved / "usr")

    def test_removed_without_leavings(self):
        """dpkg below a folder, with the scripts of the package but not its dependencies."""
        root = self.folder / "root"
        (root / "var/lib/dpkg").mkdir(parents=True)
        (root / "var/lib/dpkg/status").touch()
        before = files_below(root)
        dpkg = ("dpkg", f"--root={root}", "--force-script-chrootless", "--force-depends",
                "--force-not-root", f"--log={self.folder}/dpkg.log")
        succeed(*dpkg, "-i", self.deb)
        self.check_program(root / "usr")
        caches = list(root.rglob("neph/__pycache__/*.pyc"))
        self.assertGreater(len(caches), 2)  # of Python's, which dpkg does not know
        succeed(*dpkg, "-r", "neph")
        left = {name for name in files_below(root) - before if not name.startswith("var/lib/dpkg")}
        self.assertEqual(left, set())
        self.assertFalse((root / "usr").exists())


if __name__ == "__main__":
    unittest.main()
