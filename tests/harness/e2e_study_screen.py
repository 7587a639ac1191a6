#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""`neph study screen` as a user runs it, with tiny frames: tables, files, reuse, refused
arguments."""
import json
import unittest
import xml.etree.ElementTree as ElementTree

import frames
import night
from neph_case import StudyCase


class StudyScreen(StudyCase):
    words = ("study", "screen")

    def test_a_table_and_its_files(self):
        # Slices are accurate at the step, whose foot is in the frame; no part of it is hidden.
        words = ("surface_step", "surface_rough", "--size", "24x14", "--samples", "64", "--model",
                 "screen+gi=off+warm_up=0+ssr_rays=1,screen+preset=slices+gi=off+ssr=off+warm_up=0",
                 "--markdown", "a.md", "--quiet")
        found = self.json(*words)["scenes"]
        step = found["surface_step"]["ambient occlusion"]
        few, many = step["models"].values()
        self.assertLess(many["error"], 0.03)
        self.assertLess(step["lost"], 0.1 * step["pixels"])
        self.assertEqual(found["surface_step"]["far"]["behind"], 0.0)
        self.assertGreater(found["surface_rough"]["near"]["thin"], 0.01)
        self.assertEqual(found["surface_step"]["reflections"]["pixels"], 0)
        metal = found["surface_rough"]["reflections"]
        self.assertGreater(metal["pixels"], 200)
        first, second = metal["models"].values()
        self.assertGreater(first["error"], 0.0)
        self.assertIsNone(second["error"])  # it has no reflections
        self.look_at_the_page(found)
        table = (self.folder / "a.md").read_text()
        self.assertIn("**ambient occlusion** [% of the hemisphere]", table)
        self.assertIn("| surface_rough | *no model can* |", table)
        again = self.neph(*words, "--all")
        self.assertEqual((self.folder / "a.md").read_text(), table)
        self.assertIn(table, again.stdout)

    def look_at_the_page(self, found):
        """Checks that the page has an image for each part of a scene, with as many squares of a
        colour as pixels lost for its reason, and no content from a network."""
        page = (self.folder / "out/study/screen/index.html").read_text()
        self.assertNotIn("http://", page)
        self.assertNotIn("https://", page)
        for scene, parts in found.items():
            for part, name in (("ambient occlusion", "ao"), ("indirect light", "indirect"),
                               ("reflections", "reflections")):
                truth = parts[part]
                self.assertEqual(sum(truth["lost_by"].values()), truth["lost"])
                self.assertEqual(f'src="{scene}_{name}.png"' in page, truth["pixels"] > 0)
                if truth["pixels"] > 0:
                    self.count_colours(self.folder / f"out/study/screen/{scene}_{name}.png", truth)

    def count_colours(self, path, truth):
        """Yellow, blue, orange, dark: pixels that are not grey are blended with the colour of their
        reason by three quarters."""
        rows = frames.png_rows(path)
        self.assertEqual((len(rows[0]), len(rows)), (3 * 24 * 4, 14 * 4))
        found = {"off": 0, "behind": 0, "thin": 0}
        for row in rows:
            for x in range(0, len(row), 3):
                red, green, blue = row[x:x + 3]
                if blue > red + 60:
                    found["behind"] += 1
                elif red > blue + 60:
                    found["off" if green > red - 40 else "thin"] += 1
        for reason, squares in found.items():
            self.assertEqual(squares, 16 * truth["lost_by"][reason], (path.name, reason))

    def test_turned_solids_hide_as_they_stand(self):
        """The blocks of the room are rotated. For a ray's hit that is not on the screen, the ray
        has a reason."""
        found = self.json("surface_room", "--size", "32x18", "--samples", "64", "--model",
                          "screen+gi=off+ssr=off+warm_up=0", "--rays", "64", "--quiet")
        truth = found["scenes"]["surface_room"]["ambient occlusion"]
        self.assertGreater(truth["lost"], 40)
        self.assertLess(truth["lost_by"]["else"], 0.02 * truth["lost"])

    def test_pictures_flicker_by_what_rays_leave(self):
        """One ray without history gives different frames; a static scene has one truth."""
        calm, raw = "screen+gi=off", "screen+gi=off+ssr_rays=1+ssr_history=0+ssr_smooth=0"
        found = self.json("surface_rough", "--size", "24x14", "--samples", "32", "--model",
                          f"{calm},{raw}", "--frames", "16", "--quiet")
        over = found["scenes"]["surface_rough"]["over_frames"]
        self.assertEqual(over["frames"], 16)
        for number, times in (("change", 2.0), ("seen", 1.2), ("luma_change", 2.0)):
            self.assertGreater(over["models"][raw][number], times * over["models"][calm][number])
            self.assertGreater(over["models"][calm]["ms"], 0.0)
        self.assertLess(over["models"][calm]["error"], over["models"][raw]["error"])
        # A mark for each model in each of five panels, and the legend's mark. The first model is 1
        # in the panels of light, and not drawn there.
        root = ElementTree.parse(self.folder / "out/study/screen/screen.svg").getroot()
        marks = root.findall("{http://www.w3.org/2000/svg}path[@transform]")
        self.assertEqual(len(marks), 1 + 3 * 2 + 2)
        names = [text.text for text in root.iter("{http://www.w3.org/2000/svg}text")]
        self.assertEqual(names.count("gi=off"), 1)  # one row
        self.assertEqual(names.count("ssr_rays=1+ssr_history=0+ssr_smooth=0"), 1)
        self.assertIn("screen.svg", (self.folder / "out/study/screen/index.html").read_text())

    def test_a_scene_that_moves_has_a_truth_a_frame(self):
        self.neph("surface_ground", "--size", "8x5", "--samples", "2", "--model",
                  "screen+gi=off", "--frames", "64", "--quiet", "--markdown", "a.md")
        self.assertIn("| surface_ground | screen+gi=off | 32 |", (self.folder / "a.md").read_text())

    def test_a_scene_of_one_frame_has_one_truth_for_all(self):
        found = self.json("surface_room", "--size", "8x5", "--samples", "2", "--model",
                          "screen+gi=off", "--frames", "16", "--quiet")
        over = found["scenes"]["surface_room"]["over_frames"]
        self.assertEqual(over["frames"], 16)
        self.assertGreater(over["models"]["screen+gi=off"]["error"], 0.0)

    @night.of_the_night
    def test_cycles_is_a_witness(self):
        """Another program agrees, with the truth and thus with the screen: within 4.5 standard
        errors, from docs/screen.md, which has four times as many pixels."""
        found = self.json("surface_rough", "surface_mirror", "--size", "48x27", "--samples",
                          "1024", "--cycles", "1024", "--model", "screen", "--quiet")["scenes"]
        for part, noise in (("ambient occlusion", 0.002), ("indirect light", 0.072),
                            ("reflections", 0.042)):
            against = found["surface_rough"]["against_cycles"][part]
            ours = found["surface_rough"][part]["models"]["screen"]
            self.assertLess(abs(against["cycles"]["bias"]), noise, part)
            self.assertLess(abs(against["models"]["screen"]["bias"] - ours["bias"]), noise, part)
        refused = found["surface_mirror"]["against_cycles"]["reflections"]["cycles"]
        self.assertIsNone(refused["bias"])

    def test_results_do_not_depend_on_the_number_of_jobs(self):
        results = []
        for jobs in ("1", "2"):
            done = self.neph("surface_step", "surface_rough", "--size", "8x5", "--samples", "2",
                             "--rays", "4", "--model", "screen+gi=off+warm_up=0", "--jobs",
                             jobs, "-o", f"out{jobs}", "--json")
            pages = sorted((self.folder / f"out{jobs}/screen").iterdir())
            results.append((json.loads(done.stdout),
                            [(page.name, page.read_bytes()) for page in pages]))
        self.assertEqual(results[0], results[1])
        self.assertIn("[2/2] part", done.stderr)

    def test_refusals(self):
        little = ("--size", "4x4", "--samples", "2")
        self.check_refusals((64, "no screen", (*little, "--model", "march")),
                            (2, "without solids", (*little, "height_fog_up")),
                            (64, "16 frames", (*little, "--frames", "3")),
                            (66, "nowhere", (*little, "nowhere")))

    def test_a_folder_with_other_files_is_left_alone(self):
        page = self.put("out/study/screen/index.html")
        self.neph("surface_step", "--size", "4x4", "--samples", "2", code=64,
                  said="name another folder with -o")
        self.assertEqual(page.read_text(), "mine")


if __name__ == "__main__":
    unittest.main()
