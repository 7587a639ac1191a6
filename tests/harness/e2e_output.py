#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Where neph writes: it removes or overwrites no file of the user, and simultaneous or killed runs
leave complete files."""
import json
import os
import pathlib
import shutil
import signal
import subprocess
import time
import unittest

import neph_case

NEPH = neph_case.NEPH
ROOT = pathlib.Path(os.environ["NEPH_SOURCE_DIR"])
SMALL = ["validate", "scattering_slab_above", "-e", "exact", "-e", "oracle", "--no-charts",
         "--size", "8x6", "-q"]


def tree(folder):
    """The content of a folder: any change to it shows."""
    return {str(path.relative_to(folder)): (path.read_bytes(), path.stat().st_mtime_ns)
            if path.is_file() else None for path in folder.rglob("*")}


class Output(neph_case.NephCase):
    def put(self, name, text="mine"):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)

    def assert_refused(self, *arguments, naming):
        before = tree(self.folder)
        self.neph(*arguments, code=64, said=(str(naming), "-o"))  # the message suggests it
        self.assertEqual(tree(self.folder), before)

    def test_folders_of_the_user_are_unchanged(self):
        self.put("a/report/thesis.tex")
        self.assert_refused(*SMALL, "-o", self.folder / "a", naming=self.folder / "a/report")
        self.put("b/store/tmp/photo.jpg")
        self.assert_refused(*SMALL, "-o", self.folder / "b", naming=self.folder / "b/store")
        self.put("c/report/data.json", '{"format": "neph-report-1"}')
        self.put("c/report/notes.txt")
        self.assert_refused(*SMALL, "-o", self.folder / "c", naming=self.folder / "c/report")
        self.put("d/report")
        self.assert_refused(*SMALL, "-o", self.folder / "d", naming=self.folder / "d/report")
        self.put("e/store/notes.txt")
        self.assert_refused("study", "march", "height_fog_up", "-o", self.folder / "e",
                            naming=self.folder / "e/store")

    def test_other_files_beside_report_and_store_stay(self):
        for name in ("report.new/draft.txt", "store.bak/frames/x", ".neph-report-notes/x", "tmp/x",
                     "notes.txt"):
            self.put(name)
        before = tree(self.folder)
        for _ in range(2):
            self.neph(*SMALL, "-o", self.folder)
        after = tree(self.folder)
        self.assertEqual({name: after.get(name) for name in before}, before)
        self.assertEqual({path.name for path in self.folder.iterdir()},
                         {"report", "store", "report.new", "store.bak", ".neph-report-notes", "tmp",
                          "notes.txt"})

    def test_stores_and_reports_of_before_the_marker_are_recognised(self):
        self.neph(*SMALL, "-o", self.folder)
        for name in ("report", "store"):
            (self.folder / name / ".neph-owned").unlink()
        (self.folder / "store/.neph-lock").unlink(missing_ok=True)
        shutil.rmtree(self.folder / "report/view")  # as before reports had viewers
        (self.folder / "report/images/x").mkdir()
        self.neph(*SMALL, "-o", self.folder)
        self.assertFalse((self.folder / "report/images/x").exists())
        for name in ("report", "store"):
            self.assertTrue((self.folder / name / ".neph-owned").exists())

    def test_empty_outputs_are_refused_everywhere(self):
        frame = self.folder / "frame.exr"
        for arguments in (SMALL + ["-o", ""], SMALL + ["--output="],
                          ["render", "absorbing_slab", "-o", ""],
                          ["render", "absorbing_slab", "-e", "tracer", "--checkpoint", ""],
                          ["export", "absorbing_slab", "-o", ""],
                          ["fly", "absorbing_slab", "-o", ""],
                          ["bake", "voxel_grid", "-o", ""],
                          ["benchmark", "absorbing_slab", "-o", ""],
                          ["study", "march", "height_fog_up", "-o", ""],
                          ["compare", frame, frame, "--maps", ""],
                          ["compare", frame, frame, "--csv", ""],
                          ["flicker", "--reference", frame, frame, "--maps", ""]):
            self.neph(*arguments, cwd=self.folder, code=64, said="is empty")
            self.assertEqual(list(self.folder.iterdir()), [])

    def test_a_size_that_an_engine_refuses_ends_the_run_before_the_work(self):
        self.neph("validate", "absorbing_slab", "-e", "exact,march", "--size", "5000x3000", "-o",
                  "out", cwd=self.folder, code=64, said="march renders sides of 1..4096 pixels")
        self.assertEqual(list((self.folder / "out").rglob("*.exr")), [])

    def test_two_scenes_of_one_name_are_refused(self):
        text = (ROOT / "scenes/catalog/absorbing_slab.yaml").read_text()
        self.put("a/absorbing_slab.yaml", text)
        self.put("b/absorbing_slab.yaml",
                 text.replace("extinction_per_m: 1", "extinction_per_m: 2"))
        pairs = [("a/absorbing_slab.yaml", "b/absorbing_slab.yaml"),
                 ("a/absorbing_slab.yaml", "a/../a/absorbing_slab.yaml")]
        for pair in pairs + [("absorbing_slab", "b/absorbing_slab.yaml"),
                             ("absorbing_slab", "absorbing_slab")]:
            before = tree(self.folder)
            done = self.neph("validate", *pair, "-e", "exact", "-e", "oracle", "--no-charts", "-q",
                             "--size", "8x6", "-o", "out", cwd=self.folder, code=64)
            for name in pair:
                self.assertIn(f"'{name}'", done.stderr)
            self.assertFalse((self.folder / "out/report").exists())

    def test_runs_at_the_same_time_share_a_folder(self):
        for _ in range(2):
            runs = [subprocess.Popen([NEPH, *SMALL, "fence_backlit", "--json", "-o",
                                      str(self.folder)], stdout=subprocess.PIPE,
                                     stderr=subprocess.PIPE, text=True) for _ in range(4)]
            for run, (output, complaints) in [(run, run.communicate(timeout=120)) for run in runs]:
                self.assertEqual((run.returncode, "is not used" in complaints), (0, False),
                                 complaints)
                for scene in json.loads(output)["scenes"]:
                    self.assertEqual({frame["status"] for frame in scene["frames"]}, {"rendered"})
            self.assertEqual({path.name for path in self.folder.iterdir()}, {"report", "store"})
            self.assertEqual(list((self.folder / "store/tmp").iterdir()), [])
            report = self.folder / "report"
            data = json.loads((report / "data.json").read_text())
            for scene in data["scenes"]:
                for frame in scene["frames"]:
                    self.assertTrue((report / frame["picture"]).exists())
            self.assertTrue((report / "index.html").exists())

    def test_leftovers_of_a_kill_are_removed(self):
        command = [NEPH, "validate", "-e", "oracle", "voxel_grid", "--no-charts", "-q", "--size",
                   "640x360", "-o", str(self.folder)]
        child = subprocess.Popen(command, stderr=subprocess.DEVNULL)
        until = time.monotonic() + 60
        while not list(self.folder.glob("store/tmp/*")) and time.monotonic() < until:
            time.sleep(0.02)
        child.send_signal(signal.SIGKILL)
        child.wait()
        self.assertTrue(list(self.folder.glob("store/tmp/*"))
                        and list(self.folder.glob(".neph-report-*")))
        self.neph(*SMALL, "-o", self.folder)
        self.assertEqual(list((self.folder / "store/tmp").iterdir()), [])
        self.assertEqual({path.name for path in self.folder.iterdir()}, {"report", "store"})

    def test_a_killed_render_leaves_nothing_for_good(self):
        render = [NEPH, "render", "voxel_grid", "-e", "oracle", "-q", "--size", "640x360", "-o",
                  str(self.folder)]
        child = subprocess.Popen(render, stderr=subprocess.DEVNULL)
        until = time.monotonic() + 60
        while not list(self.folder.glob(".neph-scratch*")) and time.monotonic() < until:
            time.sleep(0.02)
        child.send_signal(signal.SIGKILL)
        child.wait()
        self.assertTrue(list(self.folder.iterdir()))
        self.neph("render", "absorbing_slab", "-e", "exact", "--size", "8x6", "-q", "-o",
                  self.folder)
        self.assertEqual([path.name for path in self.folder.iterdir()],
                         ["absorbing_slab_exact_0000.exr"])

    def test_edited_seconds_are_not_reused(self):
        def seconds_and_reuse():
            done = self.neph(*SMALL, "--json", "-o", self.folder)
            frame = json.loads(done.stdout)["scenes"][0]["frames"][0]
            return frame["wall_s"], frame["reused"], done.stderr
        seconds_and_reuse()
        [record] = [path for path in (self.folder / "store/frames").glob("*/job.json")
                    if '"exact"' in path.read_text()]
        honest = json.loads(record.read_text())
        record.write_text(json.dumps({**honest, "wall_s": 1e-9}))
        seconds, reused, complaints = seconds_and_reuse()
        self.assertEqual((seconds == 1e-9, reused), (False, False))
        self.assertIn(str(record.parent), complaints)
        seconds, reused, complaints = seconds_and_reuse()
        self.assertEqual((reused, str(record.parent) in complaints), (True, False))

    def test_export_overwrites_no_files_of_the_user(self):
        self.put("work/scene.pov", "// months of work")
        self.assert_refused("export", "absorbing_slab", "-e", "povray", "-o", self.folder / "work",
                            naming=self.folder / "work")
        for _ in range(2):  # it replaces its own folder
            self.neph("export", "absorbing_slab", "-e", "povray", "-o", self.folder / "new")

    def test_inputs_are_not_overwritten(self):
        self.neph("render", "absorbing_slab", "-e", "exact", "--size", "8x6", "-q", "-o",
                  self.folder)
        frame = self.folder / "absorbing_slab_exact_0000.exr"
        own = frame.rename(self.folder / "flip_radiance_0003.exr")
        before = tree(self.folder)
        self.neph("compare", own, own, "-m", "flip", "--maps", self.folder, code=64, said=str(own))
        own.rename(self.folder / "absorbing_slab_realtime_0000.exr")
        self.neph("render", "absorbing_slab", "-e", "realtime", "--size", "8x6", "-q", "-o",
                  self.folder, "--depth", self.folder / "absorbing_slab_realtime_0000.exr", code=64,
                  said="--depth")
        self.assertEqual(list(tree(self.folder).values()), list(before.values()))

    def test_render_adds_only_its_frame(self):
        self.put(".neph-scratch.1/log", "kept by an older version")
        self.put("notes.txt")
        before = tree(self.folder)
        for _ in range(2):
            self.neph("render", "absorbing_slab", "-e", "exact", "--size", "8x6", "-q", "-o",
                      self.folder)
        after = tree(self.folder)
        after.pop("absorbing_slab_exact_0000.exr")
        self.assertEqual(after, before)


if __name__ == "__main__":
    unittest.main()
