#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""`neph compare --partner cvvdp` and `neph flicker --partner cvvdp`, with a program in place of
ColorVideoVDP: the command line, the frames in its files, its output, and its failures. Where the
real one is installed (by night), its answers for equal and for noisy frames."""
import json
import random
import shutil
import unittest

import frames
import neph_case
import night

WIDTH, HEIGHT = 32, 24

# Writes its arguments, and what its files are, into the folder of the test. Its lines are those of
# ColorVideoVDP 0.5.6, which writes the progress of a sequence between them.
FAKE = r'''#!/usr/bin/env python3
import json, os, pathlib, sys
home = pathlib.Path(__file__).parent.parent
words = sys.argv[1:]
files = {path.name: path.stat().st_size for path in pathlib.Path().glob("*.exr")}
(home / "seen.json").write_text(json.dumps({
    "words": words, "files": files, "home": os.environ["HOME"], "folder": os.getcwd(),
    "packages": os.environ.get("PYTHONUSERBASE")}))
for path in pathlib.Path().glob("*.exr"):
    (home / "kept" / path.name).write_bytes(path.read_bytes())
test, ref = words.index("--test"), words.index("--ref")
pairs = list(zip(words[test + 1:ref], words[ref + 1:words.index("--display")]))
scores = json.loads((home / "scores.json").read_text())
line = ('"ColorVideoVDP v0.5.6, 75.4 [pix/deg], Lpeak=200, Lblack=0.2, Lrefl=0.3979 [cd/m^2], '
        '(standard_4k)"')
result = "test, reference, cvvdp\n" + "".join(
    f"{a}, {b}, {score}\n" for (a, b), score in zip(pairs, scores))
print("[INFO] When reporting metric results, please include the following information:\n"
      "[INFO] " + line + "\n 50%|##\r100%|####", file=sys.stderr)
BODY
pathlib.Path(words[words.index("--result") + 1]).write_text(result)
'''


class Partner(neph_case.NephCase):
    def setUp(self):
        super().setUp()
        (self.folder / "kept").mkdir()
        (self.folder / "tmp").mkdir()

    def install(self, *scores, body=""):
        """Puts the program into PATH; it gives these scores."""
        self.put("scores.json", json.dumps(scores))
        found = self.put_program("cvvdp", FAKE.replace("BODY", body))
        return {**found, "TMPDIR": str(self.folder / "tmp"), "HOME": "/home/user"}

    def seen(self):
        return json.loads((self.folder / "seen.json").read_text())

    def write(self, name, value, count=1, width=WIDTH):
        """Frames of one value, the first pixel of each brighter."""
        for i in range(count):
            path = self.folder / f"{name}{f'.{i:02}' if count > 1 else ''}.exr"
            frames.grey_exr(path, width, HEIGHT, [3.0 + i] + [value] * (width * HEIGHT - 1))
        return self.folder / (f"{name}.%02d.exr" if count > 1 else f"{name}.exr")

    def samples(self, name):
        return frames.read_exr(self.folder / "kept" / name)

    def check_is_clean(self):
        self.assertEqual(list((self.folder / "tmp").iterdir()), [])

    # ---- the wire --------------------------------------------------------------------------

    def test_a_frame(self):
        reference, test = self.write("reference", 0.5), self.write("test", 0.25)
        words = "compare", reference, test, "--partner", "cvvdp", "-m", "error"
        program = self.install(8.125)
        found = self.json(*words, "--exposure", 1, **program)
        self.assertEqual(self.seen()["words"], [
            "--test", "test_00000.exr", "--ref", "reference_00000.exr", "--display",
            "standard_4k", "--result", "result.csv"])
        self.assertEqual(self.seen()["home"], self.seen()["folder"])
        self.assertEqual(self.seen()["packages"], "/home/user/.local")
        self.assertEqual(found["partners"], [{
            "name": "cvvdp_jod", "unit": "JOD", "program": "ColorVideoVDP",
            "display": "standard_4k", "frames_as": "sRGB codes, 1 EV", "version": "0.5.6",
            "conditions": "ColorVideoVDP v0.5.6, 75.4 [pix/deg], Lpeak=200, Lblack=0.2, "
                          "Lrefl=0.3979 [cd/m^2], (standard_4k)",
            "values": [{"frame": 0, "test": 8.125}], "not_measured": None}])
        # 0.25 * 2^1, encoded (IEC 61966-2-1); the first pixel is clamped.
        width, height, channels = self.samples("test_00000.exr")[:3]
        self.assertEqual((width, height, sorted(channels)), (WIDTH, HEIGHT, ["B", "G", "R"]))
        self.assertEqual(channels["R"][0], 1.0)
        self.assertAlmostEqual(channels["B"][1], 1.055 * 0.5 ** (1 / 2.4) - 0.055, delta=1e-7)
        line = self.neph(*words, **program).stdout.splitlines()
        self.assertIn("cvvdp_jod 8.1250 JOD: ColorVideoVDP v0.5.6, 75.4 [pix/deg], Lpeak=200, "
                      "Lblack=0.2, Lrefl=0.3979 [cd/m^2], (standard_4k); of sRGB codes, 0 EV", line)
        self.assertLessEqual(len(line), 10)
        self.assertIn("cvvdp_jod 8.1250 JOD: ", self.neph(*words, "--all", **program).stdout)
        self.check_is_clean()

    def test_frames_and_another_test(self):
        reference, before, after = (self.write(name, value, 3) for name, value in (
            ("reference", 0.5), ("before", 0.4), ("after", 0.45)))
        found = self.json("compare", "-r", reference, before, after, "--partner", "cvvdp",
                          "--warm-up", 1, **self.install(9.5, 9.25, 7.0, 6.5))
        self.assertEqual(self.seen()["words"][:10], [
            "--test", "test_00000.exr", "test_00001.exr", "other_00000.exr", "other_00001.exr",
            "--ref", "reference_00000.exr", "reference_00001.exr", "reference_00000.exr",
            "reference_00001.exr"])
        self.assertEqual(found["partners"][0]["values"], [
            {"frame": 0, "test": 9.5, "other": 7.0}, {"frame": 1, "test": 9.25, "other": 6.5}])
        self.assertGreater(self.samples("test_00000.exr")[2]["R"][0],
                           self.samples("test_00000.exr")[2]["R"][1])
        text = self.neph("compare", "-r", reference, before, after, "--partner", "cvvdp",
                         **self.install(9.5, 9.25, 9.75, 7.0, 6.5, 8.0)).stdout
        self.assertIn("cvvdp_jod 9.2500 JOD, of the other test 6.5000 (frame 1, the lowest of 3): ",
                      text)

    def test_a_sequence_in_absolute_luminance(self):
        still, test = self.write("still", 0.5), self.write("test", 0.4, 20)
        found = self.json("flicker", "-r", still, test, "--partner", "cvvdp:standard_hdr_linear",
                          "--white", 80, "--fps", 29.97, "--ppd", 40, **self.install(-1.5))
        self.assertEqual(self.seen()["words"], [
            "--test", "test_%05d.exr", "--ref", "reference_%05d.exr", "--display",
            "standard_hdr_linear", "--result", "result.csv", "--fps", "29.969999999999999",
            "--pix-per-deg", "40"])
        self.assertEqual(len(self.seen()["files"]), 40)
        self.assertEqual(set(self.seen()["files"].values()),
                         {self.seen()["files"]["test_00000.exr"]})
        self.assertEqual(self.samples("reference_00019.exr")[2]["G"][1], 40.0)  # 0.5 * 80 cd/m2
        self.assertEqual(self.samples("test_00019.exr")[2]["G"][0], 22.0 * 80.0)
        self.assertEqual(found["partners"][0]["values"], [{"test": -1.5}])
        self.assertEqual(found["partners"][0]["frames_as"], "cd/m2, white 80, 0 EV")

    # ---- failures --------------------------------------------------------------------------

    def check_failure(self, code, said, program):
        """All else is measured, and the exit code is the program's."""
        reference, test = self.write("reference", 0.5), self.write("test", 0.25)
        done = self.neph("compare", reference, test, "--partner", "cvvdp", "--json", "--junit",
                         self.folder / "junit.xml", code=code,
                         said=["cvvdp_jod was not measured: ", said], **program)
        self.assertIn("cvvdp_jod was not measured", (self.folder / "junit.xml").read_text())
        found = json.loads(done.stdout)
        self.assertIn("rel_rmse", {row["metric"] for row in found["measurements"]})
        (partner,) = found["partners"]
        self.assertEqual((partner["values"], partner["version"]), ([], None))
        self.assertIn(said, partner["not_measured"])
        text = self.neph("compare", reference, test, "--partner", "cvvdp", code=code,
                         **program).stdout
        self.assertIn("\nnot measured: cvvdp_jod: ", text)
        self.check_is_clean()

    def test_without_the_program(self):
        self.check_failure(69, "cvvdp is not installed", {
            "PATH": "/nowhere", "TMPDIR": str(self.folder / "tmp")})
        done = self.neph("doctor", code=None, PATH="/nowhere").stdout
        self.assertIn("pip install cvvdp", done)

    def test_a_program_that_fails(self):
        for body, said in (
                ("sys.exit('no such display')", "no such display"),
                ("os.abort()", "signal"),
                # vq_exception of the real program: a message, and exit code 0
                ("print('[ERROR] File not found', file=sys.stderr); sys.exit()",
                 "the last line of its output: [ERROR] File not found")):
            self.check_failure(3, said, self.install(9, body=body))

    def test_a_sequence_that_is_too_short(self):
        words = self.write("still", 0.5), self.write("test", 0.4, 16)
        done = self.neph("flicker", "-r", *words, "--partner", "cvvdp", code=3,
                         said="needs 17 frames at 60 Hz", **self.install(9, body="sys.exit(1)"))
        self.assertIn("not measured: cvvdp_jod: 'cvvdp' ended with exit code 1", done.stdout)

    def test_output_that_is_not_understood(self):
        for scores in ((), ("nan",), ("inf",), (11,), ("9 9",), ("",)):
            self.check_failure(3, "without the JOD of each pair", self.install(*scores))
        for body in ("result += result", "result += 'x'", "result = '\\0' * 100",
                     "result = result.replace('test_', 'tset_')", "result = 'x' * (17 << 20)"):
            self.check_failure(3, "without the JOD of each pair", self.install(9, body=body))
        wrong = FAKE.replace("ColorVideoVDP v", "FovVideoVDP v")
        program = self.install(9)
        self.put_program("cvvdp", wrong.replace("BODY", ""))
        self.check_failure(3, "without a line with its version", program)

    def test_ctrl_c(self):
        reference, test = self.write("reference", 0.5), self.write("test", 0.25)
        program = self.install(9, body="(home / 'waits').touch(); import time; time.sleep(600)")
        child = self.start("compare", reference, test, "--partner", "cvvdp", "--json", **program)
        self.wait_until((self.folder / "waits").exists, child)
        found = json.loads(self.interrupt(child)[0])
        self.assertIn("stopped by an interrupt", found["partners"][0]["not_measured"])
        self.assertFalse(found["interrupted"])  # neph's own numbers are complete
        self.check_is_clean()

    def test_frames_for_an_hdr_display(self):
        path = self.folder / "pq.exr"
        grey = [0.5] * (WIDTH * HEIGHT)
        path.write_bytes(frames.exr_bytes(WIDTH, HEIGHT, dict.fromkeys("RGB", grey),
                                          [("neph.display", "string", b"PQ")]))
        self.neph("compare", path, path, "--partner", "cvvdp", code=2,
                  said="the frames are for an HDR display (PQ)", **self.install(9))

    def test_refusals(self):
        reference, test = self.write("reference", 0.5), self.write("test", 0.25, 20)
        self.check_refusals(
            (64, "cvvdp:standard_fhd", ("compare", reference, test, "--partner", "vmaf")),
            (64, "cvvdp:standard_fhd", ("compare", reference, test, "--partner", "cvvdp:none")),
            (64, "name it with -r", ("flicker", test, "--partner", "cvvdp")),
            (64, "--z takes no --partner", ("compare", "--z", reference, test, "--partner",
                                            "cvvdp")))

    # ---- the real one ----------------------------------------------------------------------

    @night.of_the_night
    @unittest.skipUnless(shutil.which("cvvdp"), "cvvdp is not installed")
    def test_the_real_program(self):
        draw = random.Random(1)
        noise = [max(0.0, 0.4 + draw.gauss(0, 0.1)) for _ in range(64 * 64)]
        flat = self.folder / "flat.exr"
        noisy = self.folder / "noisy.exr"
        frames.grey_exr(flat, 64, 64, [0.4] * 4096)
        frames.grey_exr(noisy, 64, 64, noise)
        equal, worse = (self.json("compare", flat, test, "--partner", "cvvdp")["partners"][0]
                        ["values"][0]["test"] for test in (flat, noisy))
        self.assertEqual(equal, 10.0)
        self.assertLess(worse, 9.0)


if __name__ == "__main__":
    unittest.main()
