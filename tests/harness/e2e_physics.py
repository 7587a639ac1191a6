#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The physics suite and the step study as a user runs them, with few samples: results, exit codes,
images, the page in a browser, and messages for wrong commands."""
import json
import pathlib
import shutil
import struct
import subprocess
import unittest

import neph_case
from neph_case import ROOT, VALIDATED, StudyCase

OURS = ["-e", "exact", "-e", "oracle", "-e", "tracer", "-e", "march"]
SUITE = ["validate", "--suite", "physics", "-q", "--samples", "4"]


def png_size_px(path):
    return list(struct.unpack(">II", path.read_bytes()[16:24]))


class Furnace(unittest.TestCase):
    """One run of the cheapest sample count, checked in all outputs."""

    @classmethod
    def setUpClass(cls):
        cls.folder = neph_case.scratch(cls.addClassCleanup)
        cls.done = neph_case.run(*SUITE, *OURS, "-e", "povray", "--only", "furnace_box_4", "-o",
                                 cls.folder, "--json", surroundings=VALIDATED, PATH="/nonexistent")
        has_run = cls.done.returncode in (0, 1)
        cls.physics = json.loads(cls.done.stdout)["physics"] if has_run else None

    def rows(self, participant):
        return [row for row in self.physics["rows"] if row["participant"] == participant]

    def test_exact_satisfies_the_laws(self):
        self.assertEqual(self.done.returncode, 0, self.done.stderr)
        self.assertEqual(self.physics["verdict"], "pass")
        self.assertEqual([row["verdict"] for row in self.rows("exact") + self.rows("oracle")],
                         ["agrees"] * 2)

    def test_a_single_scattering_march_is_off_and_the_cause_is_named(self):
        row, = self.rows("march")
        self.assertEqual((row["verdict"], row["lowered"]), ("off", True))
        # in-scattered light of higher orders is missing
        self.assertLess(row["deviation"], -0.01)
        self.assertIn("single scattering", row["cause"])
        self.assertIn(row["cause"], row["sentence"])

    def test_intervals_hold_zero_exactly_where_the_verdict_agrees(self):
        measured = [row for row in self.physics["rows"] if row["deviation"] is not None]
        self.assertEqual(self.physics["tests"], len(measured))
        for row in measured:
            low, high = row["interval"]
            self.assertLessEqual(low, row["deviation"])
            self.assertGreaterEqual(high, row["deviation"])
            self.assertEqual(low <= 0.0 <= high, row["verdict"] == "agrees", row)

    def test_unmeasured_rows_have_a_reason(self):
        row, = self.rows("povray")
        self.assertEqual((row["deviation"], row["verdict"], row["pictures"]),
                         (None, "not_measured", []))
        self.assertIn("not available", row["reason"])

    def test_every_view_of_every_check_can_be_looked_at(self):
        report = self.folder / "report"
        for check in self.physics["checks"]:
            self.assertIn("optical depth", check["what"])
            rows = [row for row in self.physics["rows"] if row["check"] == check["name"]
                    and row["deviation"] is not None]
            self.assertGreaterEqual(len(rows), 2, check["name"])
            for v, view in enumerate(check["views"]):
                self.assertNotIn("truth", view)  # drawn on the page, not stored in the data
                for path in [view["picture"], *(row[kind][v] for row in rows
                                                for kind in ("pictures", "differences"))]:
                    self.assertEqual(png_size_px(report / path), view["size_px"], path)

    @unittest.skipUnless(shutil.which("chromium"),
                         "chromium is not installed: the page is not looked at")
    def test_the_page_in_a_browser(self):
        checked = subprocess.run(["node", ROOT / "scripts/report/check_report.mjs", "--quick",
                                  self.folder / "report"],
                                 capture_output=True, text=True, timeout=300)
        self.assertEqual(checked.returncode, 0, checked.stdout + checked.stderr)


class OtherRuns(StudyCase):
    def suite(self, *arguments, code=0):
        document = self.json(*SUITE, *arguments, code=code)
        return document["physics"]

    def test_a_check_of_several_views_shows_them_all(self):
        physics = self.suite("-e", "oracle", "--only", "reciprocity_4")
        self.assertEqual([len(check["views"]) for check in physics["checks"]], [2])
        self.assertEqual([len(row["pictures"]) for row in physics["rows"]], [2])
        self.assertEqual(len(set(physics["rows"][0]["pictures"])), 2)

    def test_two_processes_equal_one(self):
        """And a resumed run does not render again."""
        documents = []
        for jobs in ("1", "2"):
            folder = self.folder / jobs
            words = ("-e", "march", "-e", "oracle", "--only", "furnace_box", "--jobs", jobs, "-o",
                     folder)
            physics = self.suite(*words)
            del physics["seconds"]
            for row in physics["rows"]:
                del row["wall_s"]
                row["exr"] = [pathlib.Path(path).relative_to(folder) for path in row["exr"]]
            documents.append(physics)
            frames = list((folder / "store/frames").rglob("frame.exr"))
            self.assertEqual(len(frames), 2 * 2 * 2)  # checks, engines, passes
        self.assertEqual(documents[0], documents[1])
        kept = {path: path.stat().st_mtime_ns for path in frames}
        self.suite(*words)
        self.assertEqual({path: path.stat().st_mtime_ns
                          for path in (folder / "store/frames").rglob("frame.exr")}, kept)

    def test_the_table_for_people_names_check_participant_and_verdict(self):
        done = self.neph(*SUITE, "-e", "exact", "--only", "furnace_box_4")
        line = next(line for line in done.stdout.splitlines() if line.startswith("furnace_box_4"))
        self.assertEqual([line.split()[k] for k in (1, 2, -1)], ["exact", "rendered", "agrees"])
        self.assertIn("verdict: pass", done.stdout)

    def test_checks_without_tracers_do_not_pass(self):
        row, = self.suite("-e", "exact", "--only", "furnace_clouds", code=1)["rows"]
        self.assertEqual(row["verdict"], "not_measured")
        self.assertIn("cannot: clouds", row["reason"])

    def test_a_study_of_march_finds_its_second_order(self):
        study = self.json("study", "march", "height_fog_up", "--size", "16x9")
        # 5 % of the order: the levels differ from the limit of small steps by at most this.
        self.assertAlmostEqual(study["observed_order"], 2.0, delta=0.1)
        biases = [abs(level["bias"]) for level in study["levels"]]
        self.assertEqual(biases, sorted(biases, reverse=True))
        chosen = study["levels"][study["chosen"]]
        self.assertEqual(study["verdict"], "within")
        self.assertLessEqual(abs(chosen["bias"]) + 2 * chosen["bias_noise"], study["tolerance"])

    def test_wrong_commands_are_usage_errors(self):
        suite = ("validate", "--suite", "physics", "-e", "exact", "-q")
        self.check_refusals(
            (64, ("perpetuum", "furnace"), (*suite, "--only", "perpetuum")),
            (64, "--only", (*suite, "--only", "")),
            (64, ("magic", "neph engines"), (*suite, "-e", "magic")),
            (64, ("-4", "2"), (*suite, "--samples", "-4")),
            (64, ("samples", "2"), (*suite, "--samples", "1")),
            (64, "many", (*suite, "--samples", "many")),
            (64, ("height_fog_up", "--only"), (*suite, "height_fog_up")),
            (64, ("metaphysics", "catalog", "physics"), ("validate", "--suite", "metaphysics")),
            (64, "--suite physics", ("validate", "--only", "furnace")),
            (64, "--suite physics", ("validate", "--samples", "4")),
            (64, ("magic", "cycles"), ("study", "magic", "height_fog_up")),
            (64, ("exact", "no step"), ("study", "exact", "height_fog_up")),
            (64, "scene", ("study", "march")),
            (66, "neph scenes", ("study", "march", "no_such_scene")))


if __name__ == "__main__":
    unittest.main()
