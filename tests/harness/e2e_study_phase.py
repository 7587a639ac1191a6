# SPDX-License-Identifier: MIT
"""neph study phase: what simpler phase functions lose, and phase functions of scenes as tables."""
import csv
import json
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import frames

NEPH = os.environ["NEPH"]
ROOT = pathlib.Path(os.environ["NEPH_SOURCE_DIR"])


def run(*words, **options):
    return subprocess.run([NEPH, *map(str, words)], capture_output=True, text=True, **options)


SCENE = """title: a fog in front of the sun
camera: {{position_m: [0, 2, 20], look_at_m: [0, 4, 0], vertical_fov_deg: 50}}
sun: {{direction: [0.2, 0.35, {towards}], irradiance_w_per_m2: [3, 3, 3]}}
scattering: single
media:
  - homogeneous:
      extinction_per_m: 0.05
      albedo: [0.9, 0.9, 0.9]
      {phase}
      bounds: {{min_m: [-30, 0, -30], max_m: [30, 20, 15]}}
"""
LAMP = "lights:\n  - {position_m: [3, 5, -4], intensity_w_per_sr: [400, 400, 400]}"
TABLE = "phase: table\n      phase_table: {}"


class StudyPhase(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def write(self, name, phase, towards=-1):
        path = self.folder / f"{name}.yaml"
        path.write_text(SCENE.format(phase=phase, towards=towards))
        return path

    def test_the_study(self):
        """The models have the droplets' mean cosine, except the one that is fitted to them; a
        thick cloud hides more of the difference than a thin one."""
        numbers = self.folder / "phase.csv"
        answer = run("study", "phase", "--optical-depth", "0.3,30", "--nodes", 32, "--csv", numbers,
                     "--json")
        self.assertEqual(answer.returncode, 0, answer.stderr)
        document = json.loads(answer.stdout)
        droplets = document["droplets"]
        self.assertAlmostEqual(droplets["droplets_mean_cosine"], 0.8624, delta=2e-3)
        names = [model["name"] for model in droplets["models"]]
        self.assertEqual(names, ["Henyey-Greenstein", "double Henyey-Greenstein", "Draine",
                                 "Jendersie-d'Eon"])
        for model in droplets["models"][:3]:
            self.assertAlmostEqual(model["mean_cosine"], droplets["droplets_mean_cosine"],
                                   delta=1e-9)
        errors = {model["name"]: model["log_error"] for model in droplets["models"]}
        self.assertLess(errors["Jendersie-d'Eon"], errors["Henyey-Greenstein"])
        with open(numbers, newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), 2 * 4 * 6)
        rms = {(row["optical_depth"], row["model"], row["range"]): float(row["rms"])
               for row in rows}
        for name in names:
            self.assertLess(rms["30", name, "bow"], rms["0.3", name, "bow"])

    def study(self, *words):
        """Rows by radius, sun, engine, model and range; the study with 32 directions."""
        numbers = self.folder / "rows.csv"
        answer = run("study", "phase", "--nodes", 32, "-q", "--csv", numbers, *words)
        self.assertEqual(answer.returncode, 0, answer.stderr)
        with open(numbers, newline="", encoding="utf-8") as file:
            return {(float(row["effective_radius_um"]), float(row["sun_elevation_deg"]),
                     row["engine"], row["model"], row["range"]): row
                    for row in csv.DictReader(file)}

    def test_engines_of_single_scattering(self):
        """In a thin cloud they lack only light that is scattered again: 1 % of the optical depth
        along the longest rays, and as much towards the peak. They get the same models."""
        rows = self.study("--optical-depth", "0.003", "-e", "exact,march,povray", "--size", "24x13")
        for engine in ("exact", "march"):
            for part in ("forward", "side", "bow"):
                row = rows[10, 40, engine, "droplets", part]
                self.assertEqual(row["note"], "single scattering")
                self.assertTrue(-0.015 < float(row["difference"]) < 0, row)
        for key, row in rows.items():
            if key[2] == "march":
                exact = rows[key[:2] + ("exact",) + key[3:]]
                self.assertEqual(row["count"], exact["count"])
                if float(row["count"]) > 0:
                    self.assertAlmostEqual(float(row["difference"]), float(exact["difference"]),
                                           delta=1e-3)
            if key[2:4] in (("povray", "droplets"), ("povray", "Draine")):
                self.assertRegex(row["note"], "not rendered: .")
                self.assertEqual((row["difference"], row["count"]), ("", "0"))

    def test_an_engine_of_all_orders(self):
        """The tracer and doubling agree for droplets without a sharp peak."""
        rows = self.study("--optical-depth", 1, "--effective-radius", 0.5, "-e",
                          "tracer+samples=128", "--size", "24x14", "-o", self.folder / "out")
        for part in ("forward", "side", "bow"):
            row = rows[0.5, 40, "tracer+samples=128", "droplets", part]
            error = float(row["error"])
            self.assertTrue(0 < error < 0.05, row)
            self.assertLess(abs(float(row["difference"])), 4 * error, row)

    def test_models_at_other_radii_and_suns(self):
        """Models keep their parameters; a diameter of 4 um is not in Jendersie-d'Eon's range."""
        rows = self.study("--optical-depth", 0.01, "--other-radii", 2, "--other-elevations", 20)
        self.assertEqual(len(rows), 6 * (2 * 4 + 2 * 3))
        self.assertIn((10, 20, "doubling", "Jendersie-d'Eon", "bow"), rows)
        self.assertNotIn((2, 40, "doubling", "Jendersie-d'Eon", "bow"), rows)
        for words, said in ((("--other-radii", "5,40"), "--other-radii 40: 0.5 to 30 um"),
                            (("--other-elevations", 2), "--other-elevations 2: 3 to 90 degrees"),
                            (("-e", "none"), "there is no engine 'none'"),
                            (("-e", "tracer+none=1"), "none")):
            bad = run("study", "phase", "--optical-depth", 1, *words)
            self.assertEqual(bad.returncode, 64, bad.stderr)
            self.assertIn(said, bad.stderr)

    def test_droplets_as_the_phase_function_of_a_scene(self):
        """The CSV of neph droplets is a table: exact, march and tracer draw the same frame."""
        printed = run("droplets", "--csv", self.folder / "droplets.csv")
        self.assertEqual(printed.returncode, 0, printed.stderr)
        for towards in (-1, 1):
            scene = self.write(f"fog{towards + 1}", TABLE.format("droplets.csv"), towards)
            frames = {}
            for engine in ("exact", "march", "tracer", "realtime"):
                made = run("render", scene, "-e", engine, "--size", "32x18", "-q", "-o",
                           self.folder / "out", *(("-p", "off") if engine == "realtime" else ()))
                self.assertEqual(made.returncode, 0, made.stderr)
                frames[engine] = made.stdout.split()[-1]
            for engine in ("march", "tracer", "realtime"):
                compared = run("compare", frames["exact"], frames[engine], "--json")
                document = json.loads(compared.stdout)
                error = [item["value"] for item in document["measurements"]
                         if item["metric"] == "rel_rmse" and item["quantity"] == "radiance"][0]
                # march: its steps; tracer: none in single scattering by the first collision
                self.assertLess(error, 0.02, engine)

    def render(self, scene, engine, *flags):
        """The channels of a frame."""
        made = run("render", scene, "-e", engine, "--size", "32x18", "-q", "-o",
                   self.folder / "out", *flags)
        self.assertEqual(made.returncode, 0, made.stderr)
        return frames.read_exr(pathlib.Path(made.stdout.split()[-1]))[2]

    def write_channels(self):
        """A table of three channels and the three of its columns: their scenes, by scattering."""
        columns = [[(1 - g * g) / (1 + g * g - 2 * g * math.cos(math.radians(a))) ** 1.5
                    for a in range(181)] for g in (0.2, 0.5, 0.75)]
        tables = {"all": zip(range(181), *columns)}
        tables.update((str(c), zip(range(181), column)) for c, column in enumerate(columns))
        scenes = {}
        for name, rows in tables.items():
            (self.folder / f"{name}.txt").write_text(
                "".join(" ".join(map(repr, row)) + "\n" for row in rows))
            path = self.write(name, TABLE.format(f"{name}.txt"))
            scenes["single", name] = path
            scenes["multiple", name] = path.with_name(f"multiple{name}.yaml")
            text = path.read_text().replace("single", "multiple")
            scenes["multiple", name].write_text(text)
            scenes["lamp", name] = path.with_name(f"lamp{name}.yaml")
            scenes["lamp", name].write_text(re.sub("sun: .*", LAMP, text))
        return scenes

    def test_three_channels_of_single_scattering(self):
        """A table of three channels is three tables: each channel of a frame is that of the frame
        with its column alone, to the digits of float32."""
        scenes = self.write_channels()
        for engine, flags in (("exact", ()), ("march", ()), ("realtime", ("-p", "off"))):
            whole = self.render(scenes["single", "all"], engine, *flags)
            for c, name in enumerate("RGB"):
                own = self.render(scenes["single", str(c)], engine, *flags)[name]
                worst = max(abs(a - b) for a, b in zip(whole[name], own)) / max(own)
                self.assertLess(worst, 2e-6, (engine, name))

    def test_three_channels_of_all_orders(self):
        """The mean of a channel over the frame, to four standard errors. Paths of a scene with
        three channels are drawn by one of them and weighed for the others."""
        scenes = self.write_channels()
        for light, engine, samples, channels in (("multiple", "tracer", 512, "RGB"),
                                                 ("multiple", "oracle", 32, "RGB"),
                                                 ("lamp", "tracer", 256, "B"),
                                                 ("lamp", "oracle", 16, "B")):
            flags = "-s", f"samples={samples}"
            whole = self.render(scenes[light, "all"], engine, *flags)
            for name in channels:
                c = "RGB".index(name)
                own = self.render(scenes[light, str(c)], engine, *flags, "--seed", 5 + c)
                variance = sum(sum(frame[f"variance.{name}"]) for frame in (whole, own))
                z = (sum(whole[name]) - sum(own[name])) / math.sqrt(variance)
                self.assertLess(abs(z), 4.0, (engine, name))

    def test_three_channels_of_traced_light_and_fluxes(self):
        """march_traced to 4 %: the ratio of two frames' means scatters by 0.9 % over five seeds.
        Fluxes of a slab to four standard errors."""
        scenes = self.write_channels()
        whole = self.render(scenes["multiple", "all"], "march_traced")
        fluxes = {}
        for name in ("all", "0", "1", "2"):
            text = scenes["multiple", name].read_text()
            wide = text.replace("[-30, 0, -30]", "[-1.0e+4, 0, -1.0e+4]").replace(
                "[30, 20, 15]", "[1.0e+4, 20, 1.0e+4]")
            self.assertNotEqual(text, wide)
            scenes["multiple", name].write_text(wide)
            answer = run("fluxes", scenes["multiple", name], "--seed", name if name != "all" else 7,
                         "--json")
            self.assertEqual(answer.returncode, 0, answer.stderr)
            fluxes[name] = json.loads(answer.stdout)["fluxes"]
            scenes["multiple", name].write_text(text)
        for c, name in enumerate("RGB"):
            own = self.render(scenes["multiple", str(c)], "march_traced")
            self.assertAlmostEqual(sum(whole[name]) / sum(own[name]), 1.0, delta=0.04, msg=name)
            for flux in ("reflected", "transmitted", "absorbed"):
                mine, alone = fluxes["all"][flux], fluxes[str(c)][flux]
                error = math.hypot(mine["standard_error"][c], alone["standard_error"][0])
                self.assertLess(abs(mine["mean"][c] - alone["mean"][0]), 4.0 * error, (flux, name))

    def test_fog_in_froxels_needs_a_phase_function_of_shaders(self):
        text = (ROOT / "scenes/catalog/fog_hand_over.yaml").read_text()
        for phase, words in (("phase: povray_mie_hazy", "povray_mie_hazy of fog in froxels"),
                             ("phase: rayleigh", None)):
            changed = self.folder / "fog_hand_over.yaml"
            changed.write_text(re.sub(r"^( *)phase: .*(\n *asymmetry_g: .*)?", rf"\1{phase}", text,
                                      count=1, flags=re.MULTILINE))
            self.assertIn(phase, changed.read_text())
            made = run("render", changed, "-e", "realtime", "-p", "ours", "-s", "fog=unreal", "-s",
                       "froxels=on", "--size", "32x18", "-q", "-o", self.folder / "out")
            self.assertEqual(made.returncode == 0, words is None, made.stderr)
            self.assertIn(words or "", made.stderr)

    def test_the_table_is_in_the_hash(self):
        """The values are, and the file's name is not."""
        hashes = []
        for name, values in (("a", "0 1\n180 1\n"), ("b", "0 1\n180 1\n"),
                             ("c", "0 1.5\n180 0.5\n")):
            (self.folder / f"{name}.txt").write_text(values)
            shown = run("scenes", self.write(name, TABLE.format(f"{name}.txt")), "--json")
            self.assertEqual(shown.returncode, 0, shown.stderr)
            hashes.append(json.loads(shown.stdout)["hash"])
        self.assertEqual(hashes[0], hashes[1])
        self.assertNotEqual(hashes[0], hashes[2])

    def test_tables_that_are_none(self):
        for text, words in ((b"0 1\n90 2\n180 1\n", "is 18.8"), (b"0 1\n90 x\n", "line 2"),
                            (b"0 1\n100 1\n90 1\n180 1\n", "not in order"),
                            (b"0 1\n90 -1\n180 1\n", "-1 at 90")):
            (self.folder / "table.txt").write_bytes(text)
            made = run("scenes", self.write("bad", TABLE.format("table.txt")))
            self.assertNotEqual(made.returncode, 0)
            self.assertIn("table.txt", made.stderr)
            self.assertIn(words, made.stderr)
            self.assertIn("bad.yaml:7", made.stderr)
        made = run("scenes", self.write("bad", TABLE.format("$NO_SUCH_TABLE")))
        self.assertIn("NO_SUCH_TABLE is not set", made.stderr)


if __name__ == "__main__":
    unittest.main()
