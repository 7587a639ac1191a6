#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Before and after: `neph flicker BEFORE AFTER` and `neph compare -r REFERENCE BEFORE AFTER` as a
user runs them, and attempts to obtain a wrong "better"."""
import json
import random
import re
import unittest
import xml.etree.ElementTree

import frames
import neph_case

WIDTH, HEIGHT = 48, 32
COUNT = 64
PLACES = ("worst_tile_x", "worst_tile_y", "seen_period", "coherent_radius", "flicker_frames")


def encoded(value):
    """sRGB codes."""
    return round(255 * (1.055 * value ** (1 / 2.4) - 0.055))


class Compare(neph_case.NephCase):
    def write(self, folder, value_at, count=COUNT, kind="exr", width=WIDTH, height=HEIGHT):
        """Writes frames with the values `value_at(frame, x, y)`."""
        path = self.folder / folder
        path.mkdir()
        for frame in range(count):
            values = [value_at(frame, x, y) for y in range(height) for x in range(width)]
            file = path / f"f.{frame:03}.{kind}"
            if kind == "exr":
                frames.grey_exr(file, width, height, values)
            else:
                rgb = bytes(code for value in values for code in 3 * [encoded(value)])
                file.write_bytes(frames.png_bytes(width, height, rgb))
        return path

    def blinking(self, folder, height, seed, **more):
        """A disk that blinks once in four frames, in noise."""
        draw = random.Random(seed)
        return self.write(folder, lambda frame, x, y: 0.4 + draw.gauss(0, 0.01) + height *
                          (frame % 4 == 1) * ((x - 36) ** 2 + (y - 8) ** 2 < 40), **more)

    def line(self, *words, **more):
        return self.neph(*words, "-q", **more).stdout

    # ---- the sentence ------------------------------------------------------------------------

    def test_one_command_says_whether_it_is_better(self):
        for kind in ("exr", "png"):
            before, after = (self.blinking(f"{kind}_{name}", height, seed, kind=kind)
                             for name, height, seed in (("before", 0.2, 1), ("after", 0.05, 2)))
            done = self.neph("flicker", before, after)
            lines = done.stdout.splitlines()
            self.assertRegex(lines[0], rf"^{after.name}: [\d.]+ times the threshold, "
                                       rf"{before.name}: [\d.]+; better, p < 0.001, in 64 of 64 "
                                       r"frames; worst at \(\d+, \d+\), period 4 frames$")
            self.assertEqual(lines[1], "no reference: change of the scene itself counts as "
                                       "flicker; bias and lag are not known")
            self.assertLessEqual(len(lines), 10)
            x, y = map(int, re.search(r"worst at \((\d+), (\d+)\)", lines[0]).groups())
            self.assertTrue(abs(x - 36) <= 8 and abs(y - 8) <= 8, lines[0])  # the disk, +- a tile
            self.assertRegex(self.line("flicker", after, before), "; worse, p < 0.001, in 64 of 64")
            self.assertRegex(self.line("flicker", before, before), r"^test: .*, other: .*; equal;")
            # The words that a shell makes of patterns.
            words = [*sorted(before.iterdir()), *sorted(after.iterdir())]
            self.assertEqual(self.line("flicker", *words), lines[0] + "\n")

    def test_a_reference_is_named_by_r(self):
        reference = self.write("reference", lambda frame, x, y: 0.4, count=1) / "f.000.exr"
        before, after = self.blinking("before", 0.2, 1), self.blinking("after", 0.05, 2)
        text = self.line("flicker", "-r", reference, before, after)
        self.assertRegex(text, "^after: .* before: .*; better, p < 0.001, in 64 of 64 frames")
        self.assertEqual(text, self.line("flicker", "-r", reference, after, "--versus", before))
        text = self.line("compare", "-r", reference, before, after)
        self.assertRegex(text, r"^after: rel_rmse 0\.\d+, before: 0\.\d+; better, p < 0.001, in "
                               r"\d+ of 64 frames$")
        # Without -r the first operand is the reference, and the output says so.
        named, first = (self.neph("compare", *words, after).stdout.splitlines()
                        for words in (("-r", reference), (reference,)))
        self.assertEqual(first[1], f"reference: {reference}")
        self.assertEqual([named[0], *named[1:]], [first[0], *first[2:]])
        self.neph("compare", after, code=64, said="a reference and a test")
        self.neph("flicker", "-r", reference, before, after, "--versus", before, code=64,
                  said="both name another test")

    def test_the_place_of_the_largest_error(self):
        reference = self.write("reference", lambda frame, x, y: 0.4, count=1) / "f.000.exr"
        test = self.write("test", lambda *place: 0.65 if place == (1, 5, 3) else 0.4, count=3)
        words = "-r", reference, test
        self.assertEqual(self.json("compare", *words)["largest_error"],
                         {"frame": 1, "x": 5, "y": 3, "channel": "R",
                          "reference": 0.4000000059604645, "test": 0.6499999761581421})
        self.assertIn("largest error of radiance: R of pixel (5, 3) in frame 1: 0.65, reference "
                      "0.4\n", self.neph("compare", *words, "--all").stdout)
        self.assertIsNone(self.json("compare", reference, reference)["largest_error"])
        self.assertNotIn("largest_error", self.json("compare", *words, "-m", "ssim"))

    def test_the_histogram_of_errors(self):
        reference = self.write("reference", lambda frame, x, y: 0.4, count=1) / "f.000.exr"
        test = self.write("test", lambda frame, x, y: (0.4, 0.398, 0.6, 8.0)[x % 4], count=2)
        words = "compare", "-r", reference, test
        found = self.json(*words)["error_histogram"]
        edges, part = found["edges"], 2 * 3 * WIDTH * HEIGHT // 4
        self.assertEqual([edges[0], edges[10], edges[11], edges[-1]], [-10, -1e-4, 1e-4, 10])
        self.assertEqual([found[name] for name in ("below", "above", "not_finite")], [0, part, 0])
        self.assertEqual({edges[i]: count for i, count in enumerate(found["counts"]) if count},
                         {-1e-4: part, edges[6]: part, edges[18]: part})
        line = ("relative error of samples of radiance, below -10 %: 0 %; to -1 %: 0 %; to -0.1 %: "
                "25 %; to 0.1 %: 25 %; to 1 %: 0 %; to 10 %: 0 %; above: 50 %")
        self.assertIn(line, self.neph(*words, "--all").stdout.splitlines())
        self.neph(*words, "--page", self.folder / "page")
        self.assertIn(line, (self.folder / "page/data.json").read_text())
        self.assertNotIn("error_histogram", self.json(*words, "-m", "flip"))

    def test_both_values_and_no_places(self):
        before, after = self.blinking("before", 0.2, 1), self.blinking("after", 0.05, 2)
        found = self.json("flicker", before, after, "--csv", self.folder / "out.csv")
        self.assertIsNone(found["reference"])
        rows = {row["metric"]: row for row in found["versus"] if row["mask"] == "all"}
        for row in rows.values():
            self.assertAlmostEqual(row["test"] - row["other"], row["difference"],
                                   delta=1e-9 * (abs(row["test"]) + abs(row["other"])))
        alone = self.json("flicker", before)
        for row in alone["measurements"]:
            if row["metric"] in rows and row["mask"] == "all":
                self.assertAlmostEqual(row["value"], rows[row["metric"]]["other"],
                                       delta=1e-5 * abs(row["value"]) + 1e-7, msg=row["metric"])
        for name in PLACES:
            self.assertNotIn(name, rows)
            self.assertIn(name, {row["metric"] for row in found["measurements"]})
        for row in found["measurements"]:  # no measure that needs a reference
            self.assertNotRegex(row["metric"], "^(reference_|age_._bias|phase_age|half_life|resid)")
        table = self.neph("flicker", before, after, "--all").stdout
        self.assertRegex(table.splitlines()[0], "; better, ")
        self.assertNotRegex(table, r"worst_tile_x +[\d.e+]+ +[\d.e+]+ ")
        self.assertIn(",other,difference,", (self.folder / "out.csv").read_text().splitlines()[0])

    # ---- attacks -----------------------------------------------------------------------------

    def test_noise_is_not_better(self):
        """All tiles change together: over tiles one test is significantly better, over time it is
        not."""
        sure = 0
        for seed in (10, 20, 30):  # one pair in twenty differs by chance; none of these
            first, second = (self.jitter(f"{seed}_{part}", seed + part) for part in (0, 1))
            found = self.json("flicker", first, second)
            row = next(row for row in found["versus"] if row["metric"] == "seen_contrast")
            sure += row["p"] < 0.001
            self.assertGreater(found["versus_movement"]["frames"]["p"], 0.05)
            self.assertIn("; not told apart, p = ", self.line("flicker", first, second))
        self.assertGreater(sure, 0)

    def jitter(self, folder, seed):
        draw = random.Random(seed)
        light = [0.4 + draw.gauss(0, 0.01) for _ in range(COUNT)]
        return self.write(folder, lambda frame, x, y: light[frame] + draw.gauss(0, 0.002))

    def test_few_black_and_unequal_sequences(self):
        dark = self.write("dark", lambda frame, x, y: 0.0, count=20)
        self.assertRegex(self.line("flicker", dark, dark, "--frozen-ok"), "; equal$")
        self.neph("flicker", dark, dark, code=1, said="20 test frames are bit for bit")
        one = self.write("one", lambda frame, x, y: 0.5, count=1)
        self.neph("flicker", one, code=2, said="at least 16 frames")
        few = [self.blinking(f"few_{part}", 0.2 - 0.1 * part, part, count=16) for part in (0, 1)]
        self.assertRegex(self.line("flicker", *few), r"; not told apart, p = 0.1\d, lower in 16 of "
                         r"16 frames \(p-values of flicker need 24 frames after the warm-up\)")
        self.neph("flicker", dark, few[0], code=65, silent=True,
                  said=("20 frames of 'dark'", "16 of 'few_0'"))

    def test_incomparable_input_is_refused_early(self):
        first = self.blinking("first", 0.2, 1)
        second = self.blinking("second", 0.2, 2)
        small = self.write("small", lambda frame, x, y: 0.5, width=8, height=8)
        frames.grey_exr(second / "f.063.exr", 8, 8, [0.5] * 64)  # the last frame
        maps = self.folder / "maps"
        pictures = self.write("pictures", lambda frame, x, y: 0.5, kind="png")
        for words, said in (((first, small), "48x32"), ((first, second), "f.063.exr"),
                            ((second,), "f.063.exr"), ((first, pictures), "no common scale"),
                            ((first, "-m", "lag"), "lag needs a reference"),
                            ((first, "--fail-above", "half_life_p50=4"), "lag needs a reference"),
                            ((first, "--second-reference", pictures), "needs a reference")):
            done = self.neph("flicker", *words, "--maps", maps, code=None, said=said, silent=True)
            self.assertIn(done.returncode, (64, 65), words)
        self.neph("compare", "-r", first, second, code=65, said="f.063.exr", silent=True)
        self.assertFalse(maps.exists())  # it is created before the first frame is measured
        self.neph("flicker", first, "-m", "std_p95", "--maps", maps)
        self.assertTrue(maps.exists())

    # ---- JUnit and the page ------------------------------------------------------------------

    def cases(self, path):
        suite = xml.etree.ElementTree.parse(path).getroot()
        return {case.get("name"): [child.get("message") for child in case] for case in suite}

    def test_a_case_for_each_limit(self):
        after, out = self.blinking("after", 0.05, 2), self.folder / "junit.xml"
        self.neph("flicker", after, "-m", "a4_p95", "--junit", out, "--fail-above",
                  "seen_contrast=0.001", "--fail-above", "a4_p95=1", code=1)
        cases = self.cases(out)
        self.assertEqual(set(cases), {"radiance:seen_contrast@all <= 0.001",
                                      "radiance:a4_p95@all <= 1"})
        self.assertEqual(cases["radiance:a4_p95@all <= 1"], [])
        message, = cases["radiance:seen_contrast@all <= 0.001"]
        self.assertRegex(message, r"is [\d.]+, above the limit 0\.001")
        nowhere = self.folder / "nowhere"
        self.neph("compare", nowhere, after, "--junit", out, "--fail-above", "mae=1", code=66)
        self.assertEqual(self.cases(out), {"radiance:mae@all <= 1": [
            f"there is no file '{nowhere}'"]})
        still = self.write("still", lambda frame, x, y: 0.5)
        self.neph("flicker", still, "--junit", out, code=1)
        self.assertRegex(self.cases(out)["measured"][0], "63 of 64 test frames are bit for bit")

    def test_the_page_has_all(self):
        reference = self.write("reference", lambda frame, x, y: 0.4, count=1) / "f.000.exr"
        before, after = self.blinking("before", 0.2, 1), self.blinking("after", 0.05, 2)
        for verb, words, series, maps in (
                ("flicker", (before, after), "movement", {"seen_contrast", "a4", "std"}),
                ("compare", ("-r", reference, before, after), "rel_rmse", {"relative", "flip"})):
            page = self.folder / verb
            done = self.neph(verb, *words, "-q", "--page", page)
            self.assertIn(f"page: {page}/index.html", done.stderr)
            data = json.loads((page / "data.json").read_text())
            self.assertEqual(data["verdict"][0], done.stdout.strip())
            self.assertEqual(data["series"][0]["id"], series)
            self.assertEqual([len(data["series"][0][side]) for side in ("test", "other")],
                             [COUNT, COUNT])
            self.assertEqual({item["name"] for item in data["maps"]}, maps)
            self.assertEqual({item["side"] for item in data["maps"]}, {0, 1})
            self.assertEqual([item["frame"] % 4 for item in data["frames"]], [1, 1, 1])
            for item in [*data["maps"], *(image for frame in data["frames"]
                                          for image in frame["images"])]:
                self.assertGreater((page / item["src"]).stat().st_size, 0)
            self.assertLess(sum(file.stat().st_size for file in page.rglob("*")), 20e6)
        mine = self.put("mine/notes.txt")
        self.neph("flicker", before, after, "--page", mine.parent, code=64, silent=True)


if __name__ == "__main__":
    unittest.main()
