#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""`neph scenes`: scene templates, all errors of a file, a .vdb in place of a scene."""
import json
import math
import pathlib
import re
import shutil
import subprocess
import sys
import unittest

import frames
import neph_case

SIZE = ("--size", "32x18", "-q")
# Three separate blocks, and a name that no scene may have.
BLOCK = """title: A block
camera: {position_m: [0, 0, 9], look_at_m: [0, 0, 0], vertical_fov_deg: 40}
scattering: none
media:
  - grid: {size: [5, 4, 3], origin_m: [10, 20, -7], spacing_m: [2, 1, 3], extinction_per_m: 1,
      albedo: [0, 0, 0], values: VALUES}
"""
VALUES = [1 + (3 * i) % 7 for i in range(60)]


class Scenes(neph_case.NephCase):
    in_folder = True

    def volume(self):
        """Nodes from (10, 20, -7) to (18, 23, -1) m."""
        self.put("block.yaml", BLOCK.replace("VALUES", str(VALUES)))
        self.neph("bake", "block.yaml", "-o", "Block 1.vdb")
        return self.folder / "Block 1.vdb"

    def rendered(self, scene, name, *words):
        """Planes of a small frame that has light and extinction."""
        self.neph("render", scene, "-e", "march", *SIZE, "-o", "out", *words)
        planes = frames.read_exr(self.folder / "out" / f"{name}_march_0000.exr")[2]
        self.assertGreater(max(planes["G"]), 0)
        self.assertTrue(all(math.isfinite(value) for value in planes["G"]))
        self.assertLess(min(planes["transmittance.G"]), 0.9)
        return planes

    def test_files_to_begin_with(self):
        self.volume()
        for kind, *more in (("fog",), ("cloud",), ("grid",), ("vdb", "--vdb", "Block 1.vdb")):
            with self.subTest(kind=kind):
                file = f"my_{kind}.yaml"
                said = self.neph("scenes", "--new", kind, file, *more).stdout
                self.assertIn(f"{file}: written; `neph scenes {file}` checks it", said)
                text = (self.folder / file).read_text()
                self.assertGreater(text.count("#"), 5)
                self.assertEqual(self.json("scenes", file)["name"], f"my_{kind}")
                for engine in self.json("scenes", file)["engines"]:
                    if engine["engine"] in ("exact", "tracer", "march", "realtime", "cycles"):
                        # Debian's Blender 5 has no voxels.
                        self.assertTrue(engine["can_render"] or
                                        "built without" in engine.get("reason", ""), engine)
                self.rendered(file, f"my_{kind}")

    def test_no_file_is_overwritten_unasked(self):
        mine = self.put("fog.yaml", "mine")
        self.neph("scenes", "--new", "fog", "fog.yaml", code=64, silent=True,
                  said=("'fog.yaml' is there, and is not overwritten", "--force"))
        self.assertEqual(mine.read_text(), "mine")
        self.neph("scenes", "--new", "fog", "fog.yaml", "--force")
        self.assertIn("height_fog", mine.read_text())

    def test_refusals(self):
        self.check_refusals(
            (64, "fog, cloud, grid or vdb", ("--new", "fig", "fig.yaml")),
            (64, "1 to 64 of a-z, 0-9 and _, then .yaml", ("--new", "fog", "My fog.yaml")),
            (64, "1 to 64 of a-z, 0-9 and _, then .yaml", ("--new", "fog", "fog")),
            (64, "name it, such as my_fog.yaml", ("--new", "fog")),
            (64, "--new vdb needs --vdb", ("--new", "vdb", "a.yaml")),
            (64, "--new vdb needs --vdb", ("--new", "fog", "a.yaml", "--vdb", "a.vdb")),
            (64, "belong to --new", ("block.yaml", "--force")),
            (66, "there is no file 'none.vdb'", ("--new", "vdb", "a.yaml", "--vdb", "none.vdb")),
            (66, "there is no file 'none.vdb'", ("none.vdb",)),
            before=("scenes",))
        self.assertFalse((self.folder / "a.yaml").exists())

    def test_all_errors_of_a_file(self):
        self.put("wrong.yaml", BLOCK.replace("VALUES", "[1, -2]").replace("none", "some") +
                 "gates:\n  - {engine: march, quantity: radiance, metric: none, maximum: 1, "
                 "reason: r}\n")
        places = ["wrong.yaml:3:13: scattering: found 'some', expected one of none, single",
                  "wrong.yaml:6:38: media[0].grid.values[1]: -2 is outside 0 to 1e+06",
                  "wrong.yaml:8:49: gates[0].metric: 'none' is no metric"]
        for verb in (("scenes",), ("render",), ("validate", "-o", "out"), ("bake", "-o", "a.vdb")):
            with self.subTest(verb=verb):
                said = self.neph(*verb, "wrong.yaml", code=65, silent=True).stderr
                found = re.findall(r"^wrong\.yaml:.*$", said, re.M)
                self.assertEqual(len(found), len(places), said)
                for line, place in zip(found, places):
                    self.assertTrue(line.startswith(place), (line, place))

    def test_densities(self):
        fog = BLOCK[:BLOCK.index("  - grid")] + (
            "  - homogeneous: {DENSITY, bounds: {min_m: [-50, 0, -50], max_m: [50, 20, 50]},\n"
            "      albedo: [1, 1, 0.9], extinction_color: [1, 1, 2]}\n")
        self.put("fog.yaml", fog.replace("DENSITY", "visibility_2_percent_m: 100"))
        document = self.json("scenes", "fog.yaml")
        [medium] = document["densities"]["media"]
        for key, value, digits in (
                ("extinction_per_m", math.log(50) / 100, 15), ("visibility_2_percent_m", 100, 12),
                ("visibility_5_percent_m", 100 * math.log(20) / math.log(50), 12),
                ("water_g_per_m3", 0.2492, 4), ("droplets_per_cm3", 82.76, 1)):
            self.assertAlmostEqual(medium[key], value, digits, key)
        self.assertAlmostEqual(medium["optical_depth"]["y"], math.log(50) / 5)
        self.assertEqual((medium["effective_radius_um"], medium["effective_radius_assumed"]),
                         (10, True))
        self.assertEqual([words.split(":")[0] for words in medium["untranslated"]],
                         ["extinction_color", "albedo", "densities of Unreal and Filament",
                          "phase"])
        # Each printed density is the same scene; of a wrong one the error names both keys.
        droplets = ", effective_radius_um: 10, effective_variance: 0.1"
        for key in ("extinction_per_m", "visibility_2_percent_m", "visibility_5_percent_m",
                    "water_g_per_m3", "droplets_per_cm3"):
            self.put("fog.yaml", fog.replace("DENSITY", f"{key}: {medium[key]!r}{droplets}"))
            again = self.json("scenes", "fog.yaml")["densities"]["media"][0]
            self.assertAlmostEqual(again["extinction_per_m"] / medium["extinction_per_m"], 1, 14)
            self.assertFalse(again["effective_radius_assumed"])
        self.put("fog.yaml", fog.replace("DENSITY", "optical_depth: 1, extinction_per_m: 1"))
        self.neph("scenes", "fog.yaml", code=65, silent=True, said=(
            "fog.yaml:5:34: media[0].homogeneous.optical_depth: extinction_per_m is given, too",
            "leave one of them out"))

    def test_densities_without_end(self):
        layer = "{optical_depth: 0.5, falloff_per_m: 0.1, height_m: 0}"
        self.put("fog.yaml", BLOCK[:BLOCK.index("  - grid")] +
                 f"  - height_fog: {{layers: [{layer}, {layer}], albedo: [1, 1, 1]}}\n")
        said = self.neph("scenes", "fog.yaml").stdout
        self.assertRegex(said, r"medium 0 layer 1 +at height_m +0\.05 .* infinite +0.5 +infinite\n")
        media = self.json("scenes", "fog.yaml")["densities"]["media"]
        self.assertEqual([(entry["layer"], entry["optical_depth"]["x"], entry["endless_along"])
                          for entry in media], [(0, None, ["x", "z"]), (1, None, ["x", "z"])])

    def test_the_older_name_of_description(self):
        self.put("old.yaml", BLOCK.replace("VALUES", str(VALUES)) + "physics: words\n")
        said = self.neph("scenes", "old.yaml", said="warning: old.yaml:7: the key `physics` is now "
                         "called `description`")
        self.assertIn("\nwords\n", said.stdout)

    def test_scenes_in_motion_are_those_of_their_script(self):
        kept = neph_case.ROOT / "scenes/studies/motion"
        for script in kept.glob("*.py"):
            shutil.copy(script, self.folder)
        subprocess.run([sys.executable, "-B", "motion.py"], cwd=self.folder, check=True)
        written = {file.name: file.read_text() for file in self.folder.glob("*.yaml")}
        self.assertEqual(written, {file.name: file.read_text() for file in kept.glob("*.yaml")})
        suites = json.loads((neph_case.ROOT / "scenes/studies/flicker.json").read_text())["suites"]
        listed = [pathlib.Path(entry["scene"]).name
                  for suite in ("motion", "motion_test") for entry in suites[suite]]
        self.assertEqual(sorted(written), sorted(listed))

    def test_a_vdb_is_a_scene(self):
        vdb = self.volume()
        text = self.neph("scenes", vdb.name).stdout
        self.put("block_1.yaml", text)  # the name of the scene from the file
        self.assertEqual(self.json("scenes", "block_1.yaml")["hash"],
                         self.json("scenes", vdb.name)["hash"])
        self.neph("scenes", "--new", "vdb", "other.yaml", "--vdb", vdb.name)
        self.assertEqual((self.folder / "other.yaml").read_text(), text)
        # The densest vertical column has an optical depth of 20, as the text states.
        columns = [sum(VALUES[20 * k + 5 * j + i] for j in range(4)) / max(VALUES)
                   for k in range(3) for i in range(5)]
        density_1_per_m = float(re.search(r"extinction_per_m: ([0-9.]+)", text)[1])
        self.assertAlmostEqual(density_1_per_m * max(columns) * max(VALUES), 20, delta=20e-5)
        # The whole volume is in the frame: none of it is at the edges, also in a square frame.
        for size in ("48x27", "32x32"):
            planes = self.rendered(vdb.name, "block_1", "--size", size)
            width, height = map(int, size.split("x"))
            passed = planes["transmittance.G"]
            edges = [passed[j * width + i] for j in range(height) for i in range(width)
                     if i in (0, width - 1) or j in (0, height - 1)]
            self.assertGreater(min(edges), 0.999)

    def test_verbs_take_a_vdb(self):
        vdb = self.volume()
        entry = self.json("bake", vdb.name, "-o", "again.vdb")
        self.assertTrue(entry["is_copy"])
        self.assertEqual(entry["size"], [5, 4, 3])
        document = self.json("validate", vdb.name, "-e", "exact", "-e", "march", "-o", "out",
                             "--no-charts", *SIZE)
        self.assertEqual([scene["name"] for scene in document["scenes"]], ["block_1"])

    def test_a_vdb_far_from_the_world(self):
        self.put("far.yaml", BLOCK.replace("VALUES", str(VALUES)).replace("10, 20", "200000, 20"))
        self.neph("bake", "far.yaml", "-o", "far.vdb")
        self.neph("scenes", "far.vdb", code=65, silent=True,
                  said=("spans 199998 to 200010 m along x", "unit_m"))


if __name__ == "__main__":
    unittest.main()
