#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""same_measurements.py finds each planted change in a file, and ignores measured times. The script
runs by hand; nothing is rendered here."""
import contextlib
import io
import pathlib
import sqlite3
import struct
import tempfile
import unittest

import frames
import same_measurements as same

CASE = "pick"
DATA = '{"scene": "fog", "rows": [{"error": 0.25, "wall_s": 1.5, "unit": "1"}], "none": null}'


def write_record(folder):
    """One case, as a run leaves it."""
    files = folder / CASE / "files"
    files.mkdir(parents=True)
    (folder / CASE / "00.command.txt").write_text("neph pick height_fog_level\n")
    (folder / CASE / "00.code").write_text("0\n")
    (folder / CASE / "00.stdout").write_text(f"wrote {folder}/out in 2.5 s\nerror 0.25\n")
    (folder / CASE / "00.stderr").write_text("[1/2] frame 0: ok, 0.3 s (about 4 s left)\n")
    (files / "data.json").write_text(DATA)
    (files / "data.js").write_text(f"window.NEPH_REPORT = {DATA};\n")
    (files / "a.csv").write_text("scene,error,seconds\nfog,0.25,1.5\n")
    (files / "a.md").write_text("| scene | error | ms |\n| --- | ---: | ---: |\n| fog | 1 | 2 |\n")
    write_frame(files / "frame.exr", 1.0, "0.5")
    with contextlib.closing(sqlite3.connect(files / "neph.sqlite")) as database:
        database.execute("CREATE TABLE jobs (key TEXT, wall_s REAL, frame INTEGER)")
        database.execute("INSERT INTO jobs VALUES ('k', 1.5, 3)")
        database.commit()


def write_frame(path, value, gpu_ms):
    path.write_bytes(frames.exr_bytes(2, 2, {"R": [value, 2, 3, 4]}, attributes=[
        ("neph.stats.gpu_ms", "string", gpu_ms.encode()), ("neph.seed", "string", b"7")]))


class SameMeasurements(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.before, self.after = (pathlib.Path(folder.name) / name for name in ("before", "after"))
        write_record(self.before)
        write_record(self.after)

    def differences(self):
        return same.compare_case(CASE, self.before / CASE, self.after / CASE)

    def change(self, name, old, new):
        path = self.after / CASE / name
        text = path.read_text()
        self.assertIn(old, text)
        path.write_text(text.replace(old, new, 1))

    def test_two_equal_records(self):
        self.assertEqual(self.differences(), [])

    def test_times_and_folders_may_differ(self):
        self.change("00.stdout", "2.5 s", "12.25 s")
        self.change("00.stderr", "0.3 s (about 4 s left)", "11 s")
        for name in ("data.json", "data.js"):
            self.change(f"files/{name}", '"wall_s": 1.5', '"wall_s": 2.75')
        self.change("files/a.csv", "1.5", "1.25")
        self.change("files/a.md", "| 2 |", "| 3 |")
        write_frame(self.after / CASE / "files/frame.exr", 1.0, "0.4375")
        self.update_database("wall_s = 2.0")
        self.assertEqual(self.differences(), [])

    def update_database(self, words):
        path = self.after / CASE / "files/neph.sqlite"
        with contextlib.closing(sqlite3.connect(path)) as database:
            database.execute(f"UPDATE jobs SET {words}")
            database.commit()

    def test_planted_changes_are_found_where_they_are(self):
        for name, old, new, place in (
                ("00.code", "0", "1", "line 1"),
                ("00.stdout", "error 0.25", "error 0.26", "line 2"),
                ("00.stderr", "frame 0", "frame 1", "line 1"),
                ("files/data.json", "0.25", "0.250000000000000001", "rows[0].error"),
                ("files/data.json", "0.25", "0.250", "rows[0].error"),
                ("files/data.json", '"wall_s": 1.5', '"wall_s": null', "rows[0].wall_s"),
                ("files/data.json", ', "wall_s": 1.5', "", "rows[0].wall_s"),
                ("files/data.json", '"error": 0.25, "wall_s": 1.5', '"wall_s": 1.5, "error": 0.25',
                 "order"),
                ("files/data.json", '"none": null', '"none": null, "more": []', "more"),
                ("files/data.js", "0.25", "0.35", "rows[0].error"),
                ("files/a.csv", "fog,0.25", "fog,0.24", "line 2, error"),
                ("files/a.csv", ",error,seconds\nfog,0.25", ",seconds\nfog", "columns"),
                ("files/a.md", "| 1 |", "| 1.0 |", "line 3")):
            with self.subTest(name, new=new):
                whole = (self.after / CASE / name).read_text()
                self.change(name, old, new)
                found = self.differences()
                self.assertEqual(found[0][:2], (name, place))
                self.assertNotEqual(found[0][2], found[0][3])
                (self.after / CASE / name).write_text(whole)
        self.assertEqual(self.differences(), [])

    def test_pixels_attributes_rows_and_files(self):
        frame = self.after / CASE / "files/frame.exr"
        write_frame(frame, 1.0000001, "0.5")
        [(name, place, _, _)] = self.differences()
        self.assertEqual((name, place), ("files/frame.exr", "row 0, packed bytes from 0"))
        write_frame(frame, 1.0, "0.5")
        frame.write_bytes(frame.read_bytes().replace(b"\1\0\0\x007", b"\1\0\0\x008"))
        self.assertEqual([place for _, place, _, _ in self.differences()], ["neph.seed (string)"])
        frame.unlink()
        self.assertEqual(self.differences(), [("files/frame.exr", "file", "is there", None)])
        write_frame(frame, 1.0, "0.5")
        self.update_database("frame = 4")
        self.assertEqual(self.differences(),
                         [("files/neph.sqlite", "jobs[0].frame", "3", "4")])

    def test_numbers_of_a_form_may_differ_and_its_keys_not(self):
        form = "benchmark"
        for folder in (self.before, self.after):
            (folder / CASE).rename(folder / form)
        path = self.after / form / "files/data.json"
        path.write_text(DATA.replace("0.25", "0.5"))
        self.assertEqual(same.compare_case(form, self.before / form, self.after / form), [])
        path.write_text(DATA.replace("error", "errors"))
        found = same.compare_case(form, self.before / form, self.after / form)
        self.assertEqual({place for _, place, _, _ in found}, {"rows[0].error", "rows[0].errors"})

    def run_main(self, *arguments):
        output = io.StringIO()
        with contextlib.redirect_stdout(output), contextlib.redirect_stderr(output):
            try:
                code = same.main([*map(str, arguments)])
            except SystemExit as end:
                code = end.code
        return code, output.getvalue()

    def test_exit_codes_and_the_report(self):
        arguments = ("--quick", "--only", "^pick:", "--before-from", self.before, "--compare",
                     self.after)
        code, said = self.run_main(*arguments)
        self.assertEqual((code, "0 differences" in said), (0, True), said)
        self.change("files/data.json", "0.25", "0.26")
        code, said = self.run_main(*arguments)
        self.assertEqual(code, 1)
        self.assertIn("files/data.json, rows[0].error:\n    before: '0.25'\n    after:  '0.26'",
                      said)
        self.assertEqual(self.run_main("only_one")[0], 2)
        self.assertEqual(self.run_main("--record", self.before, "no_such_program")[0], 2)
        self.assertEqual(self.run_main("--list", "--only", "no_such_words")[0], 2)

    def test_a_re_rendered_frame_is_a_difference(self):
        (self.after / CASE / "rendered_anew.txt").write_text("out/store/frames/k/job.json\n")
        (self.before / CASE / "rendered_anew.txt").write_text("out/store/frames/k/job.json\n")
        code, said = self.run_main("--only", "^pick:", "--before-from", self.before, "--compare",
                                   self.after)
        self.assertEqual(code, 1)
        self.assertIn("out/store/frames/k/job.json", said)

    def test_both_programs_get_one_build_id(self):
        note = struct.pack("<III", 4, 20, 3) + b"GNU\0"
        first, second = (same.with_same_build_id(b"code" + note + 20 * byte + b"more")
                         for byte in (b"a", b"b"))
        self.assertEqual(first, second)
        self.assertEqual(len(first), 4 + len(note) + 24)
        self.assertRaises(same.CannotCompare, same.with_same_build_id, b"no note")

    def test_a_folder_of_the_user_is_unchanged(self):
        mine = self.after / "pick" / "00.command.txt"
        mine.unlink()
        self.assertRaises(same.CannotCompare, same.run_case, "no_program", "pick", [], self.after,
                          None)
        self.assertTrue((self.after / "pick" / "files").is_dir())

    def test_the_table_is_whole(self):
        cases = same.all_commands(False, None)
        for case, source in same.STARTS_WITH.items():
            self.assertLess(list(cases).index(source), list(cases).index(case))
        self.assertLessEqual(set(same.FORM_ONLY), set(cases))
        quick = same.all_commands(True, None)
        self.assertEqual(quick, {case: cases[case] for case in quick})
        for rule in same.KEY_RULES + same.TEXT_RULES + same.PRESENCE_RULES + same.ROW_RULES:
            self.assertGreater(len(rule[-1]), 3)  # a reason


if __name__ == "__main__":
    unittest.main()
