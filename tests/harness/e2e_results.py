#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Measurements as data: quotes in the documentation equal their files, and scripts/results reports
each difference."""
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(os.environ["NEPH_SOURCE_DIR"])
FILE = {"date": "2026-11-01", "host": "a host", "what": "seen", "command": "true", "tables": {
    "seen": [{"scene": "rail", "ours": 0.125, "ue": 2.5}, {"scene": "sky air", "ours": 0.375}],
    "odd": [{"a: b": "x, y: z", "mean": 1, "scene, preset": 2}]}}
INDEX = "<!-- written by scripts/results --write -->\n<!-- end -->\n"


def results(*words, root):
    return subprocess.run([ROOT / "scripts/results", *words], text=True, capture_output=True,
                          env=os.environ | {"NEPH_SOURCE_DIR": str(root)}, check=False)


class Project(unittest.TestCase):
    def test_each_quote_is_the_number_of_its_file(self):
        done = results("--check", root=ROOT)
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_each_file_says_where_it_comes_from(self):
        paths = list((ROOT / "results").glob("*/*.json"))
        self.assertGreater(len(paths), 5)
        for path in paths:
            data = json.loads(path.read_text())
            with self.subTest(path.name):
                self.assertRegex(path.stem, r"^\d{4}-\d\d-\d\d$")
                self.assertEqual(data["date"], path.stem)
                self.assertEqual([key for key in ("host", "what", "command", "code")
                                  if not data.get(key)], [])
                self.assertEqual([code for code in data["code"] if not (ROOT / code).exists()], [])


class Tool(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.root = pathlib.Path(self.folder.name)
        (self.root / "results/flicker").mkdir(parents=True)
        (self.root / "results/flicker/2026-11-01.json").write_text(json.dumps(FILE))
        (self.root / "results/README.md").write_text(INDEX)
        (self.root / "docs").mkdir()

    def page(self, text):
        (self.root / "README.md").write_text(text)

    def written(self, quote):
        self.page(f"a {quote} b\n")
        done = results("--write", root=self.root)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return (self.root / "README.md").read_text().removeprefix("a ").removesuffix(" b\n")

    def test_a_quote_is_written_and_checked(self):
        quote = "<!--= flicker/seen scene=rail: ours .2f -->{}<!--/-->"
        self.assertEqual(self.written(quote.format("0.99")), quote.format("0.12"))
        self.assertEqual(results("--check", root=self.root).returncode, 0)
        self.page("one\n" + quote.format("0.13"))
        done = results("--check", root=self.root)
        self.assertEqual(done.returncode, 1)
        self.assertIn("README.md:2: differs from results/; scripts/results --write", done.stderr)

    def test_rows_are_summed_up(self):
        for function, value in (("min", "0.125"), ("max", "0.375"), ("mean", "0.250"),
                                ("median", "0.250")):
            quote = f"<!--= flicker/seen: {function} ours .3f -->"
            self.assertEqual(self.written(f"{quote}<!--/-->"), f"{quote}{value}<!--/-->")
        quote = "<!--= flicker/seen: count ours -->"
        self.assertEqual(self.written(f"{quote}<!--/-->"), f"{quote}2<!--/-->")

    def test_a_table_has_a_dash_where_there_is_no_value(self):
        quote = '<!--=table flicker/seen scene="sky air": scene, ours .1%, ue -->'
        self.assertEqual(self.written(f"{quote}<!--/-->"),
                         f"{quote}\n| scene | ours | ue |\n| --- | ---: | --- |\n"
                         "| sky air | 37.5% | - |\n<!--/-->")

    def test_names_with_spaces_stand_in_quotation_marks(self):
        for words, value in (("""flicker/odd "a: b=x, y: z": mean""", "1"),
                             ("""flicker/odd: "scene, preset" .1f""", "2.0")):
            quote = f"<!--= {words} -->"
            self.assertEqual(self.written(f"{quote}<!--/-->"), f"{quote}{value}<!--/-->")

    def test_a_quote_without_its_number_is_an_error(self):
        faults = {"nothing: ours": "results/nothing has no file; there are flicker",
                  "flicker: ours": "has no table ''; there are 'seen', 'odd'",
                  "flicker/seen scene=wood: ours": "no row",
                  "flicker/seen ours": "no ': COLUMN'",
                  "flicker/seen scene='rail: ours": "No closing quotation",
                  "flicker/seen: ours": "2 rows, one is wanted",
                  "flicker/seen scene=rail: theirs": "no column 'theirs'",
                  "flicker/seen scene=rail: scene .2f": "by the format '.2f'"}
        for words, fault in faults.items():
            self.page(f"\n<!--= {words} --><!--/-->\n")
            for flag in ("--write", "--check"):
                done = results(flag, root=self.root)
                self.assertEqual(done.returncode, 1)
                self.assertIn("README.md:2: ", done.stderr)
                self.assertIn(fault, done.stderr)

    def test_a_subject_is_measured_again(self):
        plan = FILE | {"command": 'printf "scene,ours\\nrail,0.5\\n" >$OUT/seen.csv', "tables": {}}
        (self.root / "results/flicker/2026-11-01.json").write_text(json.dumps(plan))
        done = results("flicker", root=self.root)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        path = self.root / done.stdout.strip()
        data = json.loads(path.read_text())
        self.assertEqual(data["tables"], {"seen": [{"scene": "rail", "ours": 0.5}]})
        self.assertEqual((data["date"], data["what"]), (path.stem, "seen"))

    def test_a_subject_that_cannot_be_measured_leaves_no_file(self):
        for command, fault in (("false", "exit code 1"), ("true", "left no $OUT/*.csv"),
                               ("neph conform FOLDER", "measured by hand")):
            plan = FILE | {"command": command}
            (self.root / "results/flicker/2026-11-01.json").write_text(json.dumps(plan))
            done = results("flicker", root=self.root)
            self.assertEqual(done.returncode, 1)
            self.assertIn(fault, done.stderr)
            self.assertEqual(len(list((self.root / "results/flicker").iterdir())), 1)


if __name__ == "__main__":
    unittest.main()
