#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""All known ways to hide a regression from a nightly run, each a row of the table in
docs/nightly.md. Scenes are empty fog, and the renderer is a program that copies a frame. Changes
that a test cannot make to its machine (another host, another clock, thirty runs) are in
test_night.c."""
import json
import math
import os
import pathlib
import re
import shutil
import sqlite3
import sys
import tempfile
import unittest

import neph_case
from neph_case import ROOT as SOURCES
from night import of_the_night

sys.dont_write_bytecode = True
sys.path.insert(0, str(SOURCES / "docs/examples"))
import fog  # the example renderer: it writes a frame

SCENE = """
name: {name}
title: Even fog
description: Beer's law
camera: {{position_m: [0, 2, 0], look_at_m: [1, 3, -10], vertical_fov_deg: 50}}
background_w_per_m2_sr: [0.5, 0.6, 0.7]
scattering: none
media:
  - homogeneous: {{extinction_per_m: {extinction}, albedo: [0, 0, 0],
                  bounds: {{min_m: [-100, -100, -100], max_m: [100, 100, 100]}}}}
gates: [{{engine: command, quantity: radiance, metric: rel_rmse, maximum: {gate}, reason: a test}}]
"""

PROGRAM = """#!/bin/sh
if [ "$1" = --version ]; then echo {version}; else {does}; fi
"""

# The first is in both tiers, the second only in the full tier. The test writes both; they are not
# the project's scenes of these names.
SCENES = {"voxel_grid": 0.01, "zz_haze": 0.02}
PLAN = ("--tier", "full", "--only", "catalog voxel_grid", "--only", "catalog zz", "--size", "8x6",
        "-e", "command")
FEWER = PLAN[:4] + PLAN[6:]
ALONE = PLAN[:2] + PLAN[4:]
GOOD, BAD, BROKEN = 0.4, 9.0, math.nan


class Attacks(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        # In memory if possible: half of the time would be spent waiting for a disk.
        memory = "/dev/shm" if os.access("/dev/shm", os.W_OK) else None
        cls.kept = tempfile.TemporaryDirectory(dir=memory)
        cls.addClassCleanup(cls.kept.cleanup)
        cls.root = pathlib.Path(cls.kept.name)
        cls.data, cls.out = cls.root / "data", cls.root / "out"
        cls.catalog = cls.data / "scenes/catalog"
        for folder in (cls.catalog, cls.data / "scenes/stress"):
            folder.mkdir(parents=True)
        for entry in SOURCES.iterdir():
            if entry.name in ("scripts", "docs"):
                (cls.data / entry.name).symlink_to(entry)
        (cls.data / "scenes/studies").symlink_to(SOURCES / "scenes/studies")
        for value in (GOOD, BAD, BROKEN):
            fog.write_frame(str(cls.root / f"{value}.exr"), 8, 6,
                            {c: [[value + 1e-3 * x for x in range(8)]] * 6 for c in "RGB"})
        cls.repair_sources()
        for plan, name in ((ALONE, "alone"), (PLAN, "accepted")):
            cls.neph("nightly", "-q", "--once", *plan, code=1)
            cls.neph("baseline", "accept", "--why", "looked at")
            shutil.copytree(cls.out, cls.root / name)
            shutil.rmtree(cls.out)

    @classmethod
    def repair_sources(cls):
        for path in cls.catalog.iterdir():
            path.unlink()
        for name, extinction in SCENES.items():
            cls.scene(name, extinction)
        cls.program(GOOD)

    def setUp(self):
        self.repair_sources()
        self.begin("accepted")

    def begin(self, accepted):
        """A store with an accepted first run."""
        shutil.rmtree(self.out, ignore_errors=True)
        shutil.copytree(self.root / accepted, self.out)

    @classmethod
    def scene(cls, name, extinction, gate=1e4):
        (cls.catalog / f"{name}.yaml").write_text(
            SCENE.format(name=name, extinction=extinction, gate=gate))

    @classmethod
    def program(cls, value, version="test 1"):
        """The renderer; None: it fails."""
        frame = cls.root / f"{value}.exr"
        does = "echo not today > cannot.txt" if value is None else f"/bin/cp {frame} frame.exr"
        (cls.root / "program").write_text(PROGRAM.format(version=version, does=does))
        (cls.root / "program").chmod(0o755)

    @classmethod
    def neph(cls, *arguments, code=0, device=False):
        none = {} if device else {"VK_DRIVER_FILES": "/nonexistent",
                                  "VK_ICD_FILENAMES": "/nonexistent"}
        nothing = {"PATH": "/nonexistent", **none}
        done = neph_case.run(*arguments, "-o", cls.out, **nothing, NEPH_DATA_DIR=str(cls.data),
                             NEPH_COMMAND=str(cls.root / "program"))
        assert done.returncode == code, f"{arguments}: {done.returncode}\n{done.stdout}" \
                                        f"{done.stderr}"
        return done

    def night(self, *arguments, code=1, plan=PLAN, device=False):
        """Returns the findings of a run: words by kind and series."""
        self.neph("nightly", "-q", "--once", *plan, *arguments, code=code, device=device)
        return self.findings()

    def findings(self):
        data = json.loads((self.out / "nightly/nightly.json").read_text())
        found = {}
        for row in data["findings"]:
            found.setdefault(row["found"], {})[row["series"]] = row["words"]
        return found

    def series(self, scene, metric="radiance rel_rmse/exact"):
        """The series of one of the program's values in the accepted run."""
        [name] = [m["series"] for m in self.document("night-000001")["measurements"]
                  if m["series"].startswith(f"catalog/{scene}@") and
                  m["series"].endswith(f"/command/{metric}")]
        return name

    def document(self, name):
        return json.loads((self.out / f"store/history/{name}.json").read_text())

    def remove_database(self):
        shutil.rmtree(self.out / "store/index")

    # ---------------------------------------------------------------------------------- no attack

    def test_nothing_changed(self):
        self.assertEqual(self.night(code=0), {})
        self.neph("store", "check")

    def test_a_regression_is_found(self):
        self.program(BAD)
        found = self.night()
        self.assertEqual(list(found), ["worse"])
        self.assertIn(self.series("zz_haze"), found["worse"])

    # ------------------------------------------------------------------------------------- scenes

    def test_a_scene_is_deleted(self):
        (self.catalog / "zz_haze.yaml").unlink()
        found = self.night()
        self.assertEqual(list(found), ["lost"])
        self.assertIn("no step 'catalog zz_haze'", found["lost"][self.series("zz_haze")])
        self.assertEqual({name.split("@")[0] for name in found["lost"]}, {"catalog/zz_haze"})
        self.night()  # until it is accepted
        self.neph("baseline", "accept", "--why", "it is gone for good")
        self.assertEqual(self.night(code=0), {})

    def test_the_loss_of_one_series_is_accepted_by_its_name(self):
        (self.catalog / "zz_haze.yaml").unlink()
        lost = self.night()["lost"]
        for series in lost:
            self.neph("baseline", "accept", series, "--why", "it is gone for good")
        self.assertEqual(self.night(code=0), {})
        self.program(BAD)
        self.assertEqual({name.split("@")[0] for name in self.night()["worse"]},
                         {"catalog/voxel_grid"})
        self.neph("baseline", "accept", "catalog/zz_haze@0/no such", "--why", "x", code=66)

    def test_a_scene_is_renamed(self):
        (self.catalog / "zz_haze.yaml").unlink()
        self.scene("zz_mist", SCENES["zz_haze"])
        self.program(BAD)
        found = self.night()
        series = self.series("zz_haze")
        self.assertIn(f"the same scene as '{series.replace('haze', 'mist')}'",
                      found["lost"][series])

    def test_a_scene_is_moved_to_another_suite(self):
        shutil.move(self.catalog / "zz_haze.yaml", self.data / "scenes/stress/zz_haze.yaml")
        try:
            self.assertIn(self.series("zz_haze"), self.night()["lost"])
        finally:
            (self.data / "scenes/stress/zz_haze.yaml").unlink()

    def test_a_scene_is_edited_and_nothing_is_worse(self):
        self.scene("zz_haze", 0.03)
        found = self.night()
        self.assertEqual(list(found), ["edited"])
        [(before, words)] = found["edited"].items()
        self.assertEqual(before, self.series("zz_haze").split("/command")[0])
        self.assertRegex(words, "numbers belong to catalog/zz_haze@[0-9a-f]{8}: this run's "
                                "program rendered the accepted version again, from '")
        [copy] = self.out.glob(f"store/scenes/{before.split('@')[1]}-*/zz_haze.yaml")
        self.assertIn(str(copy), words)
        self.neph("store", "check")
        self.assertEqual(list(self.night()), ["edited"])
        self.neph("baseline", "accept", "--why", "thicker on purpose")
        self.assertEqual(self.night(code=0), {})

    def test_a_scene_is_edited_in_the_night_of_a_regression(self):
        self.scene("zz_haze", 0.03)
        self.program(BAD)
        found = self.night()
        self.assertEqual(set(found), {"worse", "edited"})
        self.assertIn(self.series("zz_haze"), found["worse"])
        self.remove_database()
        shutil.rmtree(self.out / "store/scenes")  # a store from before scenes were copied
        found = self.night()
        self.assertNotIn(self.series("zz_haze"), found["worse"])
        self.assertIn("could not be rendered once more", "".join(found["edited"].values()))

    @of_the_night
    def test_scenes_of_the_other_suites_are_edited(self):
        """On a device. The accepted versions give the accepted values, bit by bit."""
        folder = self.data / "scenes/stress"
        shutil.copy(SOURCES / "scenes/stress/fog_none.yaml", folder)
        self.addCleanup((folder / "fog_none.yaml").unlink)
        shutil.copy(SOURCES / "scenes/catalog/voxel_grid.yaml", self.catalog)
        shutil.rmtree(self.out)
        plan = ("--only", "failure fog_none", "--only", "sweep voxel_grid", "--size", "16x9")
        self.night(plan=plan, device=True)
        self.neph("baseline", "accept", "--why", "looked at")
        accepted = self.values()
        for scene in (folder / "fog_none.yaml", self.catalog / "voxel_grid.yaml"):
            text = scene.read_text()
            scene.write_text(re.sub(r"(vertical_fov_deg: \d+)", r"\g<1>.5", text))
        found = self.night(plan=plan, device=True)
        self.assertEqual({kind: {name.split("@")[0] for name in series}
                          for kind, series in found.items()},
                         {"edited": {"failure/fog_none", "sweep/voxel_grid"}})
        values = self.values()
        self.assertEqual(len(values), 2 * len(accepted))
        self.assertEqual({name: values[name] for name in accepted}, accepted)

    def values(self):
        data = json.loads((self.out / "nightly/nightly.json").read_text())
        return {row["series"]: row["tonight"] for row in data["series"]}

    def test_a_gate_is_loosened(self):
        self.begin("alone")
        self.scene("zz_haze", SCENES["zz_haze"], gate=1e5)
        found = self.night(plan=ALONE)
        self.assertEqual(list(found), ["edited"])
        [(version, words)] = found["edited"].items()
        self.assertIn("its gates", words)
        self.neph("baseline", "accept", f"{version}/all/gates failed", "--why", "as published")
        self.assertEqual(self.night(code=0, plan=ALONE), {})

    def test_a_scene_is_broken(self):
        """And a scene that the quick tier names is deleted."""
        (self.catalog / "zz_haze.yaml").write_text("name: [")
        (self.catalog / "voxel_grid.yaml").unlink()
        self.assertEqual({kind: set(found) for kind, found in self.night().items()},
                         {"step failed": {"catalog zz_haze", "catalog voxel_grid"}})

    # --------------------------------------------------------------------------------------- plan

    def test_a_smaller_tier(self):
        self.assertIn(self.series("zz_haze"), self.night("--tier", "quick")["lost"])

    def test_a_step_less(self):
        self.assertIn(self.series("zz_haze"), self.night(plan=FEWER)["lost"])

    def test_a_chosen_night_is_compared_with_what_was_asked_for(self):
        """By hand, which is not an attack: --against states it, and so does the summary."""
        self.assertEqual(self.night("--against", "1", plan=FEWER, code=0), {})

    def test_an_engine_less(self):
        found = self.night(plan=PLAN[:-2])
        self.assertEqual(list(found), ["missing"])
        self.assertIn(self.series("zz_haze"), found["missing"])

    def test_another_size(self):
        self.assertIn("catalog zz_haze", self.night("--size", "4x3")["another size"])

    # ------------------------------------------------------------------------------------- engine

    def test_an_engine_has_another_version(self):
        self.begin("alone")
        self.program(GOOD, "test 2")
        self.assertEqual(list(self.night(code=0, plan=ALONE)), ["environment"])
        self.program(BAD, "test 2")
        found = self.night(plan=ALONE)
        self.assertIn(self.series("zz_haze"), found["worse elsewhere"])

    def test_an_engine_does_not_render(self):
        self.begin("alone")
        for value in (None, BROKEN):
            self.program(value)
            self.assertIn(self.series("zz_haze"), self.night(plan=ALONE)["missing"])

    # ----------------------------------------------------------------------- database and history

    def history_night(self, code=1):
        return self.night(code=code, plan=ALONE)

    def test_the_database_is_removed(self):
        self.begin("alone")
        self.remove_database()
        self.program(BAD)
        self.assertIn(self.series("zz_haze"), self.history_night()["worse"])

    def test_the_database_is_edited(self):
        self.begin("alone")
        database = sqlite3.connect(self.out / "store/index/neph.sqlite")
        database.execute("UPDATE measurements SET value = 100 WHERE value > 0")
        database.commit()
        database.close()
        self.program(BAD)
        found = self.history_night()
        self.assertIn("differs from its document", found["history damaged"]["night-000001.json"])
        self.neph("store", "check", code=1)
        self.neph("store", "check", "--repair", code=1)
        self.assertIn(self.series("zz_haze"), self.history_night()["worse"])

    def edit_document(self, name, edit):
        path = self.out / f"store/history/{name}.json"
        path.write_text(edit(path.read_text()))

    def test_the_document_of_the_accepted_night_is_edited(self):
        self.begin("alone")
        self.edit_document("night-000001", lambda text: re.sub(r'"value": [1-9][.0-9]*',
                                                               '"value": 100.0', text))
        self.remove_database()
        self.program(BAD)
        self.assertIn("it was changed after it was accepted",
                      self.history_night()["history damaged"]["night-000001.json"])

    def test_the_document_of_the_accepted_night_is_removed(self):
        self.begin("alone")
        (self.out / "store/history/night-000001.json").unlink()
        self.assertIn("night-000001.json", self.history_night()["history damaged"])
        self.remove_database()
        self.assertIn("the history does not have it",
                      self.history_night()["history damaged"]["night-000001.json"])

    def tear_an_acceptance(self, edit, has_database):
        self.begin("alone")
        self.neph("baseline", "accept", self.series("zz_haze"), "--why", "once more")
        before = self.neph("baseline", "list").stdout
        self.edit_document("accept-000001", edit)
        if not has_database:
            self.remove_database()
        self.assertIn("accept-000001.json", self.history_night()["history damaged"])
        said = self.neph("store", "check", code=1).stdout
        self.assertIn("accept-000001.json", said)
        self.assertIn("1 damaged", said)
        said = self.neph("store", "check", "--repair", code=1).stdout
        self.assertIn("restored", said)
        self.assertIn("2 acceptances; 0 damaged", self.neph("store", "check").stdout)
        self.assertEqual(self.neph("baseline", "list").stdout, before)
        self.assertEqual(self.history_night(code=0), {})

    def test_an_acceptance_is_truncated(self):
        self.tear_an_acceptance(lambda text: text[:len(text) // 2], True)

    def test_an_acceptance_is_truncated_and_the_database_is_removed(self):
        self.tear_an_acceptance(lambda text: "", False)

    def test_an_acceptance_is_edited(self):
        self.tear_an_acceptance(lambda text: text.replace('"night": 1', '"night": 2'), True)

    def test_an_acceptance_is_removed(self):
        self.begin("alone")
        (self.out / "store/history/accept-000001.json").unlink()
        found = self.history_night()["history damaged"]
        self.assertIn("it is missing", found["accept-000001.json"])
        self.neph("store", "check", "--repair", code=1)
        self.neph("store", "check")

    def test_an_acceptance_that_nothing_has_is_named(self):
        """As in a store from before scenes were copied."""
        for path in self.out.glob("store/history/*accept*"):
            path.write_text("{") if path.name.startswith("accept") else path.unlink()
        self.remove_database()
        said = self.neph("store", "check", "--repair", code=1).stdout
        self.assertIn("remove it and accept again", said)
        self.assertNotIn("0 damaged", said)

    def test_times_of_files_decide_nothing(self):
        """A clock that was set back or forward. Dates of runs are in test_night.c."""
        self.begin("alone")
        for path in self.out.rglob("*"):
            os.utime(path, (1, 1))
        self.program(BAD)
        self.assertIn(self.series("zz_haze"), self.history_night()["worse"])


if __name__ == "__main__":
    unittest.main()
