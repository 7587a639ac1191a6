#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Several Blenders, and broken ones, on the command line. Shell scripts replace them: they print a
version and write prepared images. The cache folder already has the results of their trials, except
where the trial itself fails."""
import json
import re
import sys
import unittest

import frames
import neph_case

WIDTH, HEIGHT = 16, 9
SCENE = "height_fog_down"
SIZE = ("--size", f"{WIDTH}x{HEIGHT}")
SCRIPT = "scripts/blender_render.py"
SEEN = {"has_voxels": True, "has_unbiased": False, "has_phases": False, "has_spots": True}


def image(value, *layers):
    plane = [value] * (WIDTH * HEIGHT)
    return frames.exr_bytes(WIDTH, HEIGHT, {f"pass.{layer}.{c}": plane
                                            for layer in layers for c in "RGB"})


def depth():
    return frames.exr_bytes(WIDTH, HEIGHT, {"pass.Depth.Z": [1e10] * (WIDTH * HEIGHT)})


class Blenders(neph_case.NephCase):
    def setUp(self):
        super().setUp()
        self.surroundings = {**neph_case.os.environ, "XDG_CACHE_HOME": str(self.folder)}

    def blender(self, name, version, found=None, radiance=1.0, transmittance=0.5, parts=1):
        """A folder with a Blender; `found`: the cached result of its trial, which it would not pass
        itself."""
        folder = self.folder / name
        folder.mkdir()
        files = {"radiance": image(radiance, "Combined", "VolumeDir", "VolumeInd"),
                 "transmittance": image(transmittance, "Combined"), "depth": depth()}
        for pass_name, data in files.items():
            marked = bytearray(data)
            marked[5] |= 0x10 if parts > 1 else 0
            (folder / f"{pass_name}.exr").write_bytes(marked)
        (folder / "timing.json").write_text('{"radiance": 0.25}')
        program = folder / "blender"
        program.write_text("#!/bin/sh\n"
                           f'[ "$1" = --version ] && exec echo "Blender {version}"\n'
                           f"cp '{folder}'/*.exr '{folder}'/timing.json .\n")
        program.chmod(0o755)
        if found:
            neph_case.keep_trial(program, self.folder, SCRIPT, **found)
        return folder

    def engines(self, *blenders):
        named = ":".join(map(str, blenders))
        listed = json.loads(self.neph("engines", "--json", NEPH_BLENDER=named).stdout)
        return {e["name"]: e for e in listed if e["name"].startswith("cycles")}

    def test_further_ones_are_engines_named_by_their_versions(self):
        new = {**SEEN, "has_unbiased": True, "has_voxels": False, "has_phases": True}
        found = self.engines(self.blender("a", "3.4.1", SEEN), self.blender("b", "5.2.2", new),
                             self.blender("c", "5.2.0", new) / "blender",
                             self.blender("d", "of today"))
        self.assertEqual(list(found), ["cycles", "cycles@5.2", "cycles@5.2-2", "cycles@unknown"])
        self.assertEqual([e["version"] for e in found.values()],
                         ["Blender 3.4.1", "Blender 5.2.2", "Blender 5.2.0", ""])
        self.assertEqual([e["available"] for e in found.values()], [True, True, True, False])
        self.assertTrue(found["cycles@unknown"]["broken"])
        self.assertEqual(found["cycles"]["can"],
                         "voxels; volumes in steps; Henyey-Greenstein only")
        self.assertEqual(found["cycles@5.2"]["can"],
                         "no voxels: it was built without them; volumes without bias, or in steps; "
                         "Henyey-Greenstein, two of them, Rayleigh, Draine and Jendersie-d'Eon")

    def test_the_option_goes_before_the_variable(self):
        good, other = self.blender("a", "3.4.1", SEEN), self.blender("b", "4.3.2", SEEN)
        done = self.neph("engines", "cycles", "--blender", other, NEPH_BLENDER=str(good))
        self.assertIn("Blender 4.3.2", done.stdout)
        self.neph("render", SCENE, "-e", "cycles", "--blender", "/nonexistent", "-o", self.folder,
                  code=69, said="NEPH_BLENDER: '/nonexistent' is no program that can be run")

    def test_several_stand_beside_each_other(self):
        both = f"{self.blender('a', '3.4.1', SEEN)}:{self.blender('b', '4.3.2', SEEN)}"
        for engine in ("cycles", "cycles@4.3"):
            self.neph("render", SCENE, "-e", engine, *SIZE, "-o", self.folder / "out", "-q",
                      NEPH_BLENDER=both)
        names = sorted(path.name for path in (self.folder / "out").glob("*.exr"))
        self.assertEqual(names, [f"{SCENE}_cycles@4.3_0000.exr", f"{SCENE}_cycles_0000.exr"])
        texts = frames.read_exr(self.folder / "out" / names[0])[3]
        self.assertEqual((texts["neph.engine"], texts["neph.engine_version"]),
                         ("cycles@4.3", "Blender 4.3.2"))
        self.neph("render", SCENE, "-e", "cycles@5.2", "-o", self.folder, NEPH_BLENDER=both,
                  code=64, said="there is no engine 'cycles@5.2'")

    def test_the_page_uses_images_by_name(self):
        page = (neph_case.ROOT / "scripts/report/report.js").read_text()
        allowed = re.search(r"/(\^\(images.*?\$)/\.test\(path\)", page)[1]
        self.assertRegex("images/fog/cycles@5.2.png", allowed)
        self.assertNotRegex("images/fog/cycles:5.2.png", allowed)

    def validate(self, blender, engine="cycles"):
        """Returns the report's text about it; the verdict is not a pass."""
        done = self.neph("validate", SCENE, "-e", "exact", "-e", engine, *SIZE, "-q", "--json",
                         "--no-charts", "-s", f"{engine}:step=1", "-o", self.folder / "out",
                         code=None, NEPH_BLENDER=str(blender))
        self.assertNotEqual(done.returncode, 0)
        report = json.loads(done.stdout)
        self.assertEqual(report["verdict"], "fail")
        frame, = [f for f in report["scenes"][0]["frames"] if f["engine"] == engine]
        self.assertEqual(frame["status"], "failed")
        return frame["reason"]

    def test_none_of_the_bad_ones_passes(self):
        for name, words, options in (
                ("black", "Blender gave a black frame", {"radiance": 0.0}),
                ("empty", "Blender has left a medium out", {"transmittance": 1.0}),
                ("parts", "truncated or damaged", {"parts": 3})):
            with self.subTest(name):
                self.assertIn(words, self.validate(self.blender(name, "3.4.1", SEEN, **options)))

    def test_one_that_fails_its_trial_fails_the_run(self):
        reason = self.validate(self.blender("untried", "9.0.0"))
        self.assertIn("Blender 9.0.0", reason)

    def test_one_without_voxels_says_so(self):
        fog = {**SEEN, "has_voxels": False}
        self.neph("render", "voxel_grid", "-e", "cycles", *SIZE, "-o", self.folder / "out", code=2,
                  said="built without them (NanoVDB)",
                  NEPH_BLENDER=str(self.blender("fog", "5.2.2", fog)))

    def test_phase_functions_of_an_old_one(self):
        """Sky and fog have Rayleigh's and Henyey-Greenstein's; the fog is given the others."""
        text = (neph_case.ROOT / f"scenes/catalog/{SCENE}.yaml").read_text()
        old = str(self.blender("old", "3.4.1", SEEN))
        for phase, words in (
                ("draine\n      draine_alpha: 2\n      asymmetry_g: 0.5", "has from 4.3 on"),
                ("double_henyey_greenstein\n      asymmetry_g: 0.8\n"
                 "      second_asymmetry_g: -0.2\n      first_share: 0.9", "NEPH_BLENDER names it"),
                ("draine\n      draine_alpha: 501\n      asymmetry_g: 0.5", "takes 0 to 500"),
                ("povray_mie_hazy", "povray_mie_hazy, which Cycles does not have")):
            with self.subTest(phase):
                path = self.folder / f"{SCENE}.yaml"
                path.write_text(re.sub(r"phase: .*(\n *asymmetry_g: .*)?", f"phase: {phase}", text))
                self.assertIn(phase, path.read_text())
                self.neph("render", path, "-e", "cycles", *SIZE, "-o", self.folder / "out", code=2,
                          said=words, NEPH_BLENDER=old)

    def test_values_below_0_are_for_unbiased_volumes(self):
        new = {**SEEN, "has_unbiased": True}
        old, unbiased = (self.blender(name, "5.2.2", found, radiance=-0.25)
                         for name, found in (("old", SEEN), ("new", new)))
        command = ("render", SCENE, "-e", "cycles", *SIZE, "-o", self.folder / "out", "-q")
        self.neph(*command, NEPH_BLENDER=str(old), code=3, said="negative values")
        self.neph(*command, "-s", "volume_biased=on", NEPH_BLENDER=str(unbiased), code=3,
                  said="negative values")
        self.neph(*command, NEPH_BLENDER=str(unbiased))
        texts = frames.read_exr(self.folder / "out" / f"{SCENE}_cycles_0000.exr")[3]
        self.assertEqual(texts["neph.signed_noise"],
                         f"unbiased volumes: {WIDTH * HEIGHT} pixels are below 0, by "
                         f"{-0.25 * WIDTH * HEIGHT:g} in sum")
        self.assertNotIn("neph.cycles.step_m", texts)
        self.neph(*command, "-s", "volume_biased=off", NEPH_BLENDER=str(old), code=2,
                  said="volumes in steps only")

    def test_no_study_of_steps_where_there_are_none(self):
        new = self.blender("new", "5.2.2", {**SEEN, "has_unbiased": True})
        self.neph("study", "steps", "cycles", SCENE, "-o", self.folder / "out", code=2,
                  said=("cycles takes no steps with these settings: Blender 5.2.2",
                        "volume_biased=on"), NEPH_BLENDER=str(new))


if __name__ == "__main__":
    sys.exit(unittest.main())
