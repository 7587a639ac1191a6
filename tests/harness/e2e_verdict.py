#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A verdict never passes for lack of rows: broken engines, hostile bytes, nothing to compare."""
import json
import os
import re
import shutil
import unittest

from neph_case import ROOT, NephCase, keep_trial

POVRAY = """#!/bin/sh
case "$1" in --version) echo "POV-Ray 3.7.0.10.unofficial"; exit 0;; esac
printf 'Datei f\\374r Men\\374 fehlt \\302\\233\\342\\200\\256' >&2
exit 1
"""


# Renders the small frame by which neph distinguishes slow from hanging; hangs on others.
SLOW_POVRAY = """#!/bin/sh
case "$*" in *--version*|*W4*) exec %s "$@";; esac
exec sleep 600
""" % shutil.which("povray")


class Verdict(NephCase):
    def put_program(self, name, text):
        """A program that has passed its trial."""
        environment = super().put_program(name, text)
        keep_trial(self.folder / "bin" / name, self.folder, has_voxels=True)
        return {**environment, "XDG_CACHE_HOME": str(self.folder)}

    def validate(self, *engines, scene="scattering_slab_above", output="out", code=1, budget=300,
                 **environment):
        wanted = [word for engine in engines for word in ("-e", engine)]
        wanted += ["--budget", str(budget)]
        done = self.neph("validate", scene, *wanted, "--no-charts", "--size", "16x9", "-q",
                         "--json", "-o", self.folder / output, code=code, **environment)
        frames = {f["engine"]: f for s in json.loads(done.stdout or "{}").get("scenes", [])
                  for f in s["frames"]}
        return done, frames

    def test_an_engine_that_breaks_with_bytes_of_latin_1_is_in_the_report_and_fails_it(self):
        done, frames = self.validate("exact", "oracle", "povray",
                                     **self.put_program("povray", POVRAY))
        self.assertEqual(frames["povray"]["status"], "failed")
        self.assertIn(r"f\xfcr Men\xfc fehlt \u009b\u202e", frames["povray"]["reason"])
        self.assertIn("frames: 3 of 3 in the report, 1 compared with the truth", done.stderr)
        document = json.loads(done.stdout)
        self.assertEqual(document["counts"], {"expected": 3, "reported": 3, "compared": 1})
        logs = re.findall(r"its whole log is '([^']+)'", frames["povray"]["reason"])
        self.assertEqual([os.path.getsize(path) for path in logs], [26], frames["povray"])
        shutil.rmtree(self.folder / "out/store/index")
        done = self.neph("store", "check", "-o", self.folder / "out", code=None)
        self.assertIn("had no database (it was removed, or ", done.stderr)
        self.assertIn("a new one is built from its 2 frames", done.stderr)

    @unittest.skipUnless(shutil.which("povray"), "POV-Ray is not installed")
    def test_what_did_not_fit_its_budget_is_in_the_verdict(self):
        """It is not a failure, and the verdict states that this engine is missing."""
        program = self.put_program("povray", SLOW_POVRAY)
        words = ["exact", "oracle", "povray"]
        done, frames = self.validate(*words, code=0, budget=1, **program)
        self.assertEqual(frames["povray"]["status"], "over_budget", frames["povray"])
        self.assertRegex(frames["povray"]["reason"], "^did not fit into 1 s: by a .* 4x3 px")
        said = "pass, without povray (did not fit its budget)"
        self.assertIn(f"\nverdict: {said}\n", done.stderr)
        self.assertIn("frames: 3 of 3 in the report, 1 compared with the truth", done.stderr)
        document = json.loads(done.stdout)
        self.assertEqual((document["verdict"], document["verdict_text"]), ("pass", said))
        done, _ = self.validate("exact", "povray", budget=1, **program)
        self.assertIn("\nverdict: fail, without povray (did not fit its budget)\n", done.stderr)
        self.assertIn("nothing was compared with a truth", done.stderr)

    def test_an_engine_that_is_not_installed_is_in_the_verdict(self):
        done, _ = self.validate("exact", "oracle", "povray", code=0, PATH="/nonexistent")
        self.assertIn("\nverdict: pass, without povray (not installed)\n", done.stderr)

    def test_the_physics_suite_keeps_the_row_of_a_broken_engine(self):
        document = self.json("validate", "--suite", "physics", "--only", "slab_iso", "-e",
                             "exact", "-e", "povray", "-q", "-o", self.folder, code=1,
                             **self.put_program("povray", POVRAY))
        self.assertEqual(document["verdict"], "fail")
        broken = [row for row in document["physics"]["rows"] if row["engine"] == "povray"
                  and row["status"] == "failed"]
        self.assertGreater(len(broken), 0)
        self.assertEqual(document["counts"]["reported"], document["counts"]["expected"])
        self.assertEqual(document["counts"]["reported"], len(document["physics"]["rows"]))

    def test_an_engine_whose_probe_fails_is_broken_and_not_missing(self):
        def script(text):
            return f"#!/bin/sh\n{text}\n"

        nowhere = str(self.folder / "none")
        cases = [
            ("povray", "povray", script("exit 1"), {}, "exit code 1"),
            ("povray", "povray", script("kill -9 $$"), {}, "signal 9"),
            ("povray", "povray", script("echo hello"), {}, "does not print a version"),
            ("povray", "povray", "#!/no/such/shell\n", {}, "cannot run"),
            ("povray", "povray", POVRAY, {"TMPDIR": nowhere}, "TMPDIR"),
            ("cycles", "blender", script("exit 1"), {}, "exit code 1"),
            ("cycles", "blender", script("exit 1"), {"TMPDIR": nowhere}, "TMPDIR"),
        ]
        for engine, program, text, environment, words in cases:
            _, frames = self.validate("exact", "oracle", engine,
                                      **self.put_program(program, text), **environment)
            self.assertEqual(frames[engine]["status"], "failed", words)
            self.assertIn(words, frames[engine]["reason"])

    def test_what_blender_leaves_is_limited_and_no_file_of_another_kind_is_read(self):
        """A program in place of Blender that fills the disk, or leaves a folder or a pipe as its
        image."""
        version = 'case "$1" in --version) echo "Blender 3.4.1"; exit 0;; esac\n'
        for body, words in (("for i in $(seq 20); do fallocate -l 32M $i.json; done; sleep 60",
                             "more than 512 MiB"),
                            ("mkdir radiance.exr", "'radiance.exr' is a folder"),
                            ("mkfifo radiance.exr", "'radiance.exr' is a pipe")):
            body = "echo '{\"radiance\": 1}' > timing.json; " + body
            _, frames = self.validate("exact", "oracle", "cycles", output=words[-6:], **(
                self.put_program("blender", f"#!/bin/sh\n{version}{body}\n")))
            self.assertEqual(frames["cycles"]["status"], "failed", frames["cycles"])
            self.assertIn(words, frames["cycles"]["reason"])
            kept = [path.stat().st_size
                    for path in self.folder.glob(f"{words[-6:]}/store/failed/**/*")]
            self.assertLess(sum(kept), 80 * 2 ** 20)

    def test_doctor_and_engines_say_broken(self):
        environment = self.put_program("povray", "#!/bin/sh\nexit 1\n")
        done = self.neph("doctor", code=3, **environment)
        self.assertRegex(done.stdout, r"(?m)^broken +povray +.*exit code 1")
        entry, = self.json("engines", "povray", **environment)
        self.assertEqual((entry["available"], entry["broken"]), (False, True))
        self.assertIn("broken: ", self.neph("engines", "povray", **environment).stdout)

    def test_a_folder_that_json_cannot_name_is_refused_before_anything_is_done(self):
        folder = os.fsencode(self.folder) + b"/caf\xe9"
        for words in (["validate", "scattering_slab_above", "-e", "exact"],
                      ["render", "scattering_slab_above"], ["export", "scattering_slab_above"],
                      ["study", "cycles", "voxel_grid"], ["benchmark", "voxel_grid"]):
            done = self.neph(*words, "-o", folder, code=64, text=False)
            self.assertEqual(done.stdout, b"", words)
            self.assertIn(b"--output '" + os.fsencode(self.folder) + rb"/caf\xe9' is not UTF-8",
                          done.stderr)
            self.assertFalse(os.path.exists(folder))

    def test_nothing_compared_is_no_pass(self):
        for engines in (["exact"], ["march_horizon", "exact"], ["povray"]):
            done, frames = self.validate(*engines, PATH="/nonexistent")
            self.assertEqual(len(frames), len(engines), engines)
            self.assertIn("nothing was compared", done.stderr)
            self.assertEqual(json.loads(done.stdout)["verdict"], "fail")

    def test_a_gate_on_what_no_metric_is_called_is_refused_with_its_place(self):
        text = (ROOT / "scenes/catalog/scattering_slab_above.yaml").read_text()
        for metric, words in (("sparkle", "'sparkle' is no metric"),
                              ("seen_share", "not among the numbers of every picture")):
            scene = self.put("scattering_slab_above.yaml",
                             text.replace("metric: rel_bias", f"metric: {metric}", 1))
            done, _ = self.validate("exact", scene=scene, code=65)
            self.assertRegex(done.stderr, r"scattering_slab_above\.yaml:\d+:\d+: "
                             rf"gates\[\d\]\.metric: .*{words}")

    def test_a_gate_that_cannot_be_measured_is_not_kept(self):
        text = (ROOT / "scenes/catalog/scattering_slab_above.yaml").read_text()
        dark = self.put("scattering_slab_above.yaml", text.replace(
            "irradiance_w_per_m2: [3, 3, 3]", "irradiance_w_per_m2: [0, 0, 0]").replace(
                "engine: march", "engine: oracle"))
        done, _ = self.validate("exact", "oracle", scene=dark)
        gates = {(g["engine"], g["metric"]): g
                 for g in json.loads(done.stdout)["scenes"][0]["gates"]}
        self.assertEqual((gates["oracle", "rel_bias"]["value"],
                          gates["oracle", "rel_bias"]["verdict"]), (None, "fail"))
        self.assertEqual(gates["cycles", "rel_bias"]["verdict"], "not_measured")


if __name__ == "__main__":
    unittest.main()
