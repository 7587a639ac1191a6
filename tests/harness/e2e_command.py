#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Engine `command`: a user's programs take part like built-in engines, and their faults are
reported and affect nothing else."""
import json
import math
import os
import pathlib
import shutil
import tempfile
import unittest

import neph_case
import night

EXAMPLES = pathlib.Path(os.environ["NEPH_SOURCE_DIR"]) / "docs/examples"

SCENE = """
name: even_fog
title: Even fog before solids
description: Beer's law
camera: {position_m: [0, 2, 0], look_at_m: [1, 3, -10], vertical_fov_deg: 50}
background_w_per_m2_sr: [0.5, 0.6, 0.7]
scattering: none
media:
  - homogeneous: {extinction_per_m: 0.05, albedo: [0, 0, 0],
                  bounds: {min_m: [-1e5, -1e5, -1e5], max_m: [1e5, 1e5, 1e5]}}
solids:
  - sphere: {center_m: [0, 2, -12], radius_m: 3, albedo: [0, 0, 0]}
  - box: {min_m: [-50, -1, -60], max_m: [50, 0, 0], albedo: [0, 0, 0]}
frames: {count: 8, rate_hz: 30}
"""

# The program of a test; the example's files can be imported as `fog`.
PROGRAM = """#!/usr/bin/env python3
import json, os, sys, time
sys.dont_write_bytecode = True
sys.path.insert(0, {examples!r})
import fog
if sys.argv[1] == "--version":
    print("test program")
    sys.exit()
job = json.load(open("job.json"))
width, height = job["size_px"]
def write(value, width=width, height=height):
    fog.write_frame("frame.exr", width, height, {{c: [[value] * width] * height for c in "RGB"}})
{body}
"""


class Command(neph_case.NephCase):
    surroundings = {k: v for k, v in os.environ.items() if k != "NEPH_COMMAND"}

    def setUp(self):
        super().setUp()
        self.scene = self.folder / "even_fog.yaml"
        self.scene.write_text(SCENE)

    def program(self, body):
        path = self.folder / "program.py"
        path.write_text(PROGRAM.format(examples=str(EXAMPLES), body=body))
        path.chmod(0o755)
        return path

    def neph(self, *arguments, program=None, **expected):
        command = {"NEPH_COMMAND": str(program)} if program else {}
        return super().neph(*arguments, cwd=self.folder, TMPDIR=str(self.folder), **command,
                            **expected)

    def render(self, program, *arguments, **expected):
        return self.neph("render", "--scene", self.scene, "-e", "command", "--size", "24x16", "-q",
                         "-o", "frames", *arguments, program=program, **expected)

    def compare(self, a, b, mask="all"):
        found = self.json("compare", a, b)
        return {(m["quantity"], m["metric"]): m["value"]
                for m in found["measurements"] if m["mask"] == mask}

    def test_the_example_is_beers_law(self):
        self.render(EXAMPLES / "fog.py", "-s", "a=0.05")
        self.neph("render", "--scene", self.scene, "-e", "exact", "--size", "24x16", "-q", "-o",
                  "frames")
        numbers = self.compare("frames/even_fog_exact_0000.exr", "frames/even_fog_command_0000.exr")
        # Depth is the same double, rounded to float; the further computation in Python is in
        # double.
        self.assertEqual(numbers["depth", "max_abs"], 0.0)
        self.assertLess(numbers["transmittance", "max_abs"], 2.0 ** -23)

    def test_a_sequence_has_one_folder(self):
        program = self.program("""
open("seen", "a").write("x")
write(1000.0 * job["frame"] + 10.0 * job["picture"] + os.path.getsize("seen"))
""")
        self.render(program, "--frames", "3", "-s", "warm_up=2", "--json")
        again = self.program('write(1000.0 * job["frame"] + 10.0 * (job["frame"] + 2) + '
                             'job["frame"] + 3)')
        self.neph("render", "--scene", self.scene, "-e", "command", "--size", "24x16", "-q", "-o",
                  "wanted", "--frames", "3", program=again)
        for frame in range(3):
            name = f"even_fog_command_{frame:04}.exr"
            self.assertEqual(self.compare(f"wanted/{name}", f"frames/{name}")
                             ["radiance", "max_abs"], 0.0)
        self.assertEqual(list(self.folder.glob("neph-command-*")), [])

    def test_its_reported_cost_is_stored(self):
        program = self.program("""
write(1.0)
data = open("frame.exr", "rb").read()
data = data[:8] + fog.attribute("stats.rays", "string", b"384") + data[8:]
open("frame.exr", "wb").write(data)
""")
        # The attribute shifts the lines by its length: the table of offsets is rewritten.
        program.write_text(program.read_text().replace("data = data[:8]", """import struct
more = len(fog.attribute("stats.rays", "string", b"384"))
start = data.index(struct.pack("<ii", 0, 12 * width)) - 8 * height
table = struct.unpack_from(f"<{height}Q", data, start)
data = (data[:start] + struct.pack(f"<{height}Q", *(t + more for t in table)) +
        data[start + 8 * height:])
data = data[:8]"""))
        done = self.render(program, "--stats", "--json")
        self.assertEqual(json.loads(done.stdout)[0]["stats"]["rays"], 384)

    def test_errors_are_reported(self):
        for body, code, words in (
                ("print('no such texture'); sys.exit(3)", 3, ("exit code 3", "no such texture")),
                ("pass", 3, ("no frame.exr",)),
                ("write(0.5, width + 1)", 3, ("25 x 16", "not 24 x 16")),
                ("write(float('nan'))", 3, ("non-finite",)),
                ("write(-1.0)", 3, ("negative",)),
                ("fog.write_frame('frame.exr', width, height, {'Z': [[1.0] * width] * height})", 3,
                 ("R, G, B",)),
                ("open('frame.exr', 'w').write('not a picture')", 3, ("frame.exr",)),
                ("open('cannot.txt', 'w').write('moving suns\\nat all')", 2,
                 ("cannot: moving suns",))):
            with self.subTest(body):
                done = self.render(self.program(body), code=code)
                for word in words:
                    self.assertIn(word, done.stderr)
                self.assertFalse((self.folder / "frames/even_fog_command_0000.exr").exists())
                for kept in self.folder.glob("neph-command-*/program.log"):
                    self.assertIn(kept.parent.name, done.stderr)
                    shutil.rmtree(kept.parent)

    def test_one_that_hangs_is_ended(self):
        self.render(self.program("time.sleep(600)"), "--time-limit", "1", code=124,
                    said="time limit of 1 s")

    def test_it_is_not_reported_as_missing(self):
        parts = json.loads(self.neph("doctor", "--json", code=None).stdout)["parts"]
        self.assertNotIn("command", [part["name"] for part in parts])
        self.render(None, code=69, said="NEPH_COMMAND")
        done = self.neph("doctor", program=self.program("") / "nowhere", code=3)
        self.assertIn("nowhere --version", done.stdout)

    def test_wrong_output_files_are_its_failure(self):
        """Exit code 3 for every kind of file; neither 74 nor 65, and no hang."""
        later = "if job['picture'] == 0: write(1.0)\nelse: write(1.0); "
        for body, words, frames in (
                ("os.mkdir('frame.exr')", "'frame.exr' is a folder", 1),
                ("os.mkfifo('frame.exr')", "'frame.exr' is a pipe", 1),
                ("os.symlink('/dev/zero', 'frame.exr')", "'frame.exr' is a link to a device", 1),
                ("os.symlink('.', 'frame.exr')", "'frame.exr' is a link to a folder", 1),
                ("os.symlink('nowhere', 'frame.exr')", "'frame.exr' cannot be read", 1),
                ("os.symlink('frame.exr', 'frame.exr')", "'frame.exr' cannot be read", 1),
                ("open('frame.exr', 'w').truncate(2 ** 40)", "File too large", 1),
                ("open('frame.exr', 'w').truncate(2 ** 20)", "frame.exr", 1),
                ("write(1.0, 300, 400)", "300 x 400", 1),
                ("os.mkdir('cannot.txt')", "'cannot.txt' is a folder", 1),
                ("os.mkfifo('cannot.txt')", "'cannot.txt' is a pipe", 1),
                ("open('cannot.txt', 'w').write('no ' * 2000)", "larger than 4096 bytes", 1),
                ("open('cannot.txt', 'w').write('no\\n' * 2000)", "larger than 4096 bytes", 1),
                ("os.unlink('program.log'); os.mkfifo('program.log'); sys.exit(1)", "exit code 1",
                 1),
                (later + "os.unlink('frame.exr'); os.mkdir('frame.exr')", "is a folder", 2)):
            with self.subTest(body):
                self.render(self.program(body), "--frames", frames, code=3, said=words)
                for kept in self.folder.glob("neph-command-*"):
                    shutil.rmtree(kept)

    def test_leftovers_do_not_stop_a_frame(self):
        """Folders, pipes and links at the paths that neph writes next; the target of a link stays
        unchanged."""
        precious = self.folder / "precious"
        precious.write_text("mine")
        for body in ("for name in ('job.json', 'depth.exr'): os.unlink(name); os.mkdir(name)",
                     f"os.unlink('program.log'); os.symlink({str(precious)!r}, 'program.log')",
                     "os.mkdir('a'); os.mkfifo('a/b'); os.symlink('.', 'c')"):
            with self.subTest(body):
                program = self.program(f"write(1.0)\nif job['picture'] == 0:\n    {body}")
                self.render(program, "--frames", "2")
                self.assertEqual(precious.read_text(), "mine")
                self.assertEqual(list(self.folder.glob("neph-command-*")), [])

    def test_it_changes_no_modes_elsewhere(self):
        parts = json.loads(self.neph("doctor", "--json", code=None).stdout)["parts"]
        if not next(part["available"] for part in parts if part["name"] == "confine"):
            self.skipTest("this system does not confine user engines")
        mine = self.folder / "mine"
        mine.write_text("mine")
        mine.chmod(0o600)
        before = mine.stat()
        body = f"""
for change in (lambda: os.chmod({str(mine)!r}, 0o777), lambda: os.utime({str(mine)!r}, (1, 1)),
               lambda: os.chmod({str(self.folder)!r}, 0o777)):
    try:
        change()
    except OSError:
        pass
write(1.0)
os.chmod("frame.exr", 0o640)
"""
        program = self.program(body)
        folder = self.folder.stat().st_mode
        program.write_text(program.read_text().replace(
            'print("test program")',
            f'print("test program")\n    try: os.chmod({str(mine)!r}, 0o777)\n'
            '    except OSError: pass'))
        self.render(program)
        after = mine.stat()
        self.assertEqual((after.st_mode, after.st_mtime, after.st_ctime),
                         (before.st_mode, before.st_mtime, before.st_ctime))
        self.assertEqual(self.folder.stat().st_mode, folder)

    def exceed(self, body, words):
        """An engine that writes too much fails, and only a small part of it is stored."""
        found = self.json("validate", self.scene, "-e", "exact", "-e", "command", "--size", "24x16",
                          "-q", "-o", "out", "--no-charts", program=self.program(body), code=1)
        frame = found["scenes"][0]["frames"][1]
        self.assertEqual(frame["status"], "failed")
        self.assertIn(words, frame["reason"])
        kept = [path.stat() for path in (self.folder / "out").glob("store/failed/**/*")]
        self.assertLess(sum(stat.st_size for stat in kept), 80 * 2 ** 20)
        self.assertLess(len(kept), 1100)
        shutil.rmtree(self.folder / "out")

    def test_written_and_stored_size_limits(self):
        self.exceed("""
for i in range(20):
    with open(f"{i}.json", "wb") as f:
        os.posix_fallocate(f.fileno(), 0, 2 ** 25)
time.sleep(60)""", "more than 512 MiB")

    def test_a_kept_folder_is_reduced_to_fit(self):
        done = self.render(self.program("""
os.mkdir("sub")
for name in ("sub/a", "b", "c", "d"):
    with open(name, "wb") as f:
        os.posix_fallocate(f.fileno(), 0, 25 * 2 ** 20)
sys.exit("no good")"""), code=3)
        left, = (path.parent for path in self.folder.glob("**/removed.txt"))
        self.assertIn(left.name, done.stderr)
        self.assertEqual({path.name for path in left.iterdir()} & {"sub", "b", "c", "d"}
                         and sum(path.stat().st_size for path in left.iterdir()) <= 64 * 2 ** 20,
                         True)
        self.assertFalse((left / "sub").exists())
        self.assertIn("no good", (left / "program.log").read_text())
        self.assertIn("100 MiB", (left / "removed.txt").read_text())

    @night.of_the_night
    def test_all_that_it_writes_is_limited(self):
        self.exceed("f = open('a.log', 'wb')\nos.posix_fallocate(f.fileno(), 0, 600 * 2 ** 20)",
                    "File too large")
        self.exceed("for i in range(20): sys.stdout.write('x' * 2 ** 20)\ntime.sleep(60)",
                    "printed more than 16 MiB")
        self.exceed("for i in range(20000): open(str(i), 'w')\ntime.sleep(60)",
                    "more than 16384 files")

    def test_extra_files_are_not_stored(self):
        program = self.program("""
write(0.0)
os.mkfifo("a.json")
os.mkdir("b.log")
for i in range(3):
    with open(f"{i}.json", "wb") as f: os.posix_fallocate(f.fileno(), 0, 2 ** 25)
""")
        self.neph("validate", self.scene, "-e", "exact", "-e", "command", "--size", "24x16", "-q",
                  "--json", "-o", "out", "--no-charts", program=program)
        kept = [path.stat() for path in (self.folder / "out").glob("store/frames/**/*")]
        self.assertLess(sum(stat.st_blocks * 512 for stat in kept), 80 * 2 ** 20)

    def test_an_engine_that_no_gate_names_is_within_a_factor_of_two(self):
        """A sky of 1 behind fog of optical depth 0.5: the truth is exp(-0.5) everywhere."""
        self.scene.write_text("""
name: even_fog
title: A layer of fog before an even sky
description: Beer's law
camera: {position_m: [0, 0, 0], look_at_m: [0, 0, -10], orthographic_height_m: 4}
background_w_per_m2_sr: [1, 1, 1]
scattering: none
media:
  - homogeneous: {extinction_per_m: 0.5, albedo: [0, 0, 0],
                  bounds: {min_m: [-1e5, -1e5, -2], max_m: [1e5, 1e5, -1]}}
""")
        for factor, code in ((80, 1), (1 / 80, 1), (0, 1), (2.1, 1), (1 / 2.1, 1), (1.9, 0),
                             (1 / 1.9, 0), (1, 0)):
            with self.subTest(factor):
                done = self.neph("validate", self.scene, "-e", "exact", "-e", "command", "--size",
                                 "24x16", "-q", "--json", "--no-charts",
                                 program=self.program(f"write({factor * math.exp(-0.5)})"),
                                 code=code)
                report = json.loads(done.stdout)
                self.assertEqual(report["verdict"], "fail" if code else "pass")
                gates = report["scenes"][0]["gates"]
                self.assertEqual(len(gates), code)
                for gate in gates:
                    self.assertEqual((gate["engine"], gate["metric"], gate["verdict"]),
                                     ("command", "rel_bias", "fail"))
                    self.assertIn("factor of two", gate["reason"])
                    self.assertAlmostEqual(gate["value"], factor - 1, delta=1e-5 * factor + 1e-6)
                self.assertIn("no gate", done.stderr)

    def test_it_is_validated_like_others(self):
        def bias(body, *arguments):
            done = self.neph("validate", self.scene, "-e", "exact", "-e", "command", "--size",
                             "24x16", "-q", "--json", *arguments, program=self.program(body),
                             code=1)  # the truth is black
            frames = json.loads(done.stdout)["scenes"][0]["frames"]
            self.assertEqual([frame["engine"] for frame in frames], ["exact", "command"])
            return [m["value"] for m in frames[1]["measurements"]
                    if (m["quantity"], m["metric"], m["mask"]) == ("radiance", "bias", "all")]
        self.assertEqual(bias("write(0.25)"), [0.25])
        self.assertEqual(bias("write(0.75)"), [0.75])  # another program: not from the store
        tuned = 'write(job["settings"]["b"])'
        self.assertEqual(bias(tuned, "-s", "command:b=0.5"), [0.5])
        self.assertEqual(bias(tuned, "-s", "command:b=0.125"), [0.125])

    @night.of_the_night
    def test_it_is_swept_and_a_step_of_the_sun_reaches_it(self):
        """A variant of a scene is its file, except for the sun and camera, which are in the job."""
        self.scene.write_text(SCENE.replace("background", "sun: {direction: [0, 1, 0], "
                                            "irradiance_w_per_m2: [1, 1, 1]}\nbackground")
                              .replace("scattering: none", "scattering: single")
                              .replace("0.05, albedo", "1.0e-6, albedo"))
        plan = self.folder / "plan.yaml"
        plan.write_text("""title: mine
light: octaves
width_px: 24
height_px: 16
frames: 32
warm_up: 16
truth_samples: 16
rounds: 1
series:
- {name: mine, engine: command, set: a=0.05, vary: b, values: 0.25, flicker: true, lag_at: 0.25}
""")
        seen = tempfile.NamedTemporaryFile(dir="/dev/shm")  # writable when confined
        self.addCleanup(seen.close)
        program = self.program(f"""
light = job["sun"]["irradiance_w_per_m2"][0]
open("{seen.name}", "a").write(f"{{light}}\\n")
write(light * job["settings"]["b"])
""")
        found = self.json("sweep", self.scene, "--plan", plan, "-o", "out", "-q", program=program)
        mine, = found["points"]
        self.assertIsNone(mine["missing"])
        self.assertIsNone(mine["shortcut"]["value"])  # its own model is unknown
        self.assertLess(mine["flicker"]["value"], 0.01)
        self.assertGreater(mine["seconds"], 0.0)
        self.assertIn("-e command", mine["command"])
        suns = pathlib.Path(seen.name).read_text().split()
        self.assertEqual(suns.count("4.0"), 48)  # of 80 frames, from the 32nd on

    @night.of_the_night
    def test_it_is_tried_where_methods_fail(self):
        def verdicts(body):
            done = self.neph("validate", "--suite", "stress", "--only", "fog_none", "--preset",
                             "command+a=0.05", "--preset", "ours", "-o", "stress", "-q", "--json",
                             program=self.program(body), code=None)
            results = json.loads(done.stdout)["results"]
            return done.returncode, {(row["column"], row["measure"]): row["verdict"]
                                     for row in results}
        code, found = verdicts('write(job["settings"]["a"])')  # where there is no light
        self.assertEqual(code, 1)
        self.assertEqual(found["command+a=0.05", "error"], "fail")
        self.assertEqual(found["command+a=0.05", "bad_values"], "pass")
        self.assertEqual(found["ours", "error"], "pass")
        code, found = verdicts('write(0.1 * (job["picture"] % 2))')
        self.assertEqual(found["command+a=0.05", "flicker"], "fail")

    @night.of_the_night
    def test_it_is_compared_with_presets(self):
        def pick(presets):
            found = self.json("pick", self.scene, "--preset", presets, "--size", "24x16",
                              "--frames", "16", "-o", "out", "-q", "--least", "flicker",
                              program=EXAMPLES / "fog.py", code=None)
            return found
        found = pick("ours,command+a=0.05")
        self.assertEqual([row["preset"] for row in found["candidates"]],
                         ["ours", "command+a=0.05"])
        self.assertLess(found["candidates"][1]["flicker"], 0.01)
        found = pick("command+a=0.05")
        self.assertEqual(found["engine"], "command")
        self.assertIn("a=0.05", found["settings"])

    def test_settings_are_for_engines_of_the_run(self):
        for setting, word in (("march:steps=9", "march:steps=9"), ("steps=9", "ENGINE:KEY=VALUE"),
                              ("exact:steps=9", "steps")):
            self.neph("validate", self.scene, "-e", "exact", "-e", "povray", "-q", "-s", setting,
                      code=64, said=word)


if __name__ == "__main__":
    unittest.main()
