#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""An installation (`cmake --install`) works from its location, and its manual equals --help."""
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

BUILT = pathlib.Path(os.environ["NEPH"])
KEPT = ["absorbing_slab", "white_furnace"]


def run(*words, **environment):
    clean = {name: value for name, value in os.environ.items() if not name.startswith("NEPH_")}
    return subprocess.run(list(map(str, words)), capture_output=True, text=True, timeout=120,
                          env={**clean, **environment})


class Install(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        done = run("cmake", "--install", BUILT.parent, "--prefix", "/opt/neph",
                   DESTDIR=str(cls.folder))
        assert done.returncode == 0, done.stderr
        cls.prefix = (cls.folder / "opt/neph").rename(cls.folder / "moved")
        cls.neph = cls.prefix / "bin/neph"
        cls.data = cls.prefix / "share/nephelometer"
        for path in (cls.data / "scenes").glob("*/*.yaml"):  # marks this folder
            if path.stem not in KEPT:
                path.unlink()

    def test_scenes_are_those_beside_the_program(self):
        done = run(self.neph, "scenes")
        listed = [line.split()[0] for line in done.stdout.splitlines()]
        self.assertEqual((done.returncode, listed), (0, KEPT), done.stderr)

    def test_it_renders_and_reports(self):
        small = ["--size", "8x6", "-q", "-o", self.folder / "out"]
        done = run(self.neph, "render", "absorbing_slab", "-e", "exact", *small)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue((self.folder / "out/absorbing_slab_exact_0000.exr").exists())
        done = run(self.neph, "validate", "absorbing_slab", "-e", "exact", "-e", "oracle",
                   "--no-charts", *small)
        self.assertEqual(done.returncode, 0, done.stderr)
        page = (self.folder / "out/report/report.js").read_bytes()
        self.assertEqual(page, (self.data / "scripts/report/report.js").read_bytes())

    def test_it_has_the_data_of_its_renderer(self):
        done = run(self.neph, "render", "absorbing_slab", "-e", "realtime", "--size", "8x6", "-q",
                   "-o", self.folder / "out")
        self.assertEqual(done.returncode, 0, done.stderr)
        (self.data / "renderer/blue_noise.png").unlink()
        done = run(self.neph, "render", "absorbing_slab", "-e", "realtime", "--size", "8x6", "-q",
                   "-o", self.folder / "out")
        self.assertEqual(done.returncode, 66, done.stderr)
        self.assertIn(str(self.data / "renderer/blue_noise.png"), done.stderr)

    def test_nothing_is_left_of_the_build(self):
        programs = {path.name for path in (self.prefix / "bin").iterdir()}
        optional = {"neph-image", "neph-mesh", "neph-netcdf"}
        self.assertEqual(programs - optional, {"neph", "neph-vdb"})
        for name in optional:
            self.assertEqual(name in programs, BUILT.with_name(name).exists(), name)
        self.assertTrue((self.data / "scripts/blender_render.py").exists())
        headers = {path.name for path in (self.prefix / "include").iterdir()}
        self.assertEqual(headers, {"neph_metrics.h"})
        libraries = {path.name for path in self.prefix.rglob("*")
                     if ".so" in path.name or path.suffix == ".a"}
        self.assertEqual({name.split(".so")[0] for name in libraries}, {"libneph_metrics"})

    def test_the_manual_has_every_verb_and_option(self):
        folder = self.prefix / "share/man/man1"
        for verb, option in (("render", "--checkpoint=FILE"), ("study-flicker", "--seeds=N"),
                             ("validate", "--budget=S"), ("flicker", "-r, --reference=FILES"),
                             ("compare", "--fail-above=[QUANTITY:]METRIC[@MASK]=LIMIT")):
            text = (folder / f"neph-{verb}.1").read_text().replace("\\-", "-")
            self.assertIn(f"\n.SH NAME\nneph-{verb} - ", text)
            self.assertIn(f"\n.B {option}\n", text.split("\n.SH OPTIONS\n")[1].split("\n.SH ")[0])
            self.assertIn(f"\nneph {verb.replace('study-', 'study ')} ",
                          text.split("\n.SH EXAMPLES\n")[1])
        top = (folder / "neph.1").read_text()
        for name in {path.stem for path in folder.iterdir()} - {"neph"}:
            self.assertIn(f"\n.B {name.replace('-', ' ')}\n", top)
        self.assertIn("130 interrupted", top)
        if shutil.which("groff"):
            pages = sorted(folder.glob("*.1"))
            self.assertEqual(run("groff", "-man", "-Tutf8", "-ww", "-z", *pages).stderr, "")

    def test_bash_completes_verbs_kinds_options_and_scenes(self):
        script = self.prefix / "share/bash-completion/completions/neph"
        complete = ('. "$0"; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _neph; '
                    'echo "${COMPREPLY[@]}"')
        for words, expected in (
                ("neph fli", "flicker"),
                ("neph study ",
                 "steps flicker attribution light sky fog screen convergence phase post"),
                ("neph study flicker --see", "--seed --seeds"), ("neph bake --me", "--medium"),
                ("neph render white", "white_furnace"), ("neph fly white", "white_furnace"),
                ("neph render -e po", "povray"),
                ("neph render -o ", ""), ("neph doctor ", "")):
            done = run("bash", "-c", complete, script, *words.split(" "))
            self.assertEqual((done.stdout.strip(), done.stderr), (expected, ""), words)


if __name__ == "__main__":
    unittest.main()
