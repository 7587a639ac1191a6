#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""`neph fit`: frames with planted mistakes, with noise, and bad input."""
import array
import math
import random
import shutil
import unittest

import frames
from neph_case import NephCase

SIZE = 32, 18
SLAB = """title: A slab before a wall
camera: {{position_m: [0, 0.9, 6], look_at_m: [0, 0.7, -2], vertical_fov_deg: 40}}
sun: {{direction: [0.5, 0.45, -0.74], irradiance_w_per_m2: [3, 2.5, 2]}}
background_w_per_m2_sr: [0.2, 0.3, 0.4]
scattering: single
solids:
  - box: {{min_m: [-1, -1, -4], max_m: [1, 1.2, -3.5], albedo: [0.4, 0.5, 0.6]}}
media:
  - homogeneous:
      extinction_per_m: {extinction}
      albedo: [{albedo}, {albedo}, {albedo}]
      phase: henyey_greenstein
      asymmetry_g: {g}
      bounds: {{min_m: [-3, 0, -3], max_m: [3, 1.5, 0]}}
"""
FOG = """title: Fog over ground
camera: {{position_m: [0, 3, 0], look_at_m: [0, 2.6, -10], vertical_fov_deg: 50}}
sun: {{direction: [0.3, 0.7, -0.6], irradiance_w_per_m2: [3, 3, 3]}}
background_w_per_m2_sr: [0.1, 0.2, 0.4]
scattering: single
solids:
  - box: {{min_m: [-200, -2, -300], max_m: [200, 0, 20], albedo: [0.3, 0.3, 0.2]}}
media:
  - height_fog:
      layers: [{{extinction_per_m: {extinction}, falloff_per_m: {falloff}, height_m: 0}}]
      albedo: [{albedo}, {albedo}, {albedo}]
      phase: henyey_greenstein
      asymmetry_g: {g}
"""
# The text of a scene, and its own values.
SCENES = {"slab": (SLAB, {"extinction": 0.8, "albedo": 0.8, "g": 0.6}),
          "fog": (FOG, {"extinction": 0.08, "albedo": 0.6, "g": 0.3, "falloff": 0.4})}
LN2, LN10, FOUR_PI = math.log(2), math.log(10), 4 * math.pi


def encode(value):
    return 12.92 * value if value <= 0.0031308 else 1.055 * value**(1 / 2.4) - 0.055


def scattering_added(own):
    """The extinction is the scattering, and absorption is added to it."""
    w = own["albedo"]
    return {"extinction": own["extinction"] * (2 - w), "albedo": 1 / (2 - w)}


# name of the mistake: the values of the frame's scene, from those of the scene.
PLANTED = {
    "exp2 taken for exp": lambda own: {"extinction": own["extinction"] * LN2},
    "10^x taken for exp (base-10 optical density)":
        lambda own: {"extinction": own["extinction"] * LN10},
    "extinction taken for scattering": scattering_added,
    "density in 1/m taken for 1/km": lambda own: {"extinction": own["extinction"] / 1000},
}
FORMS = {"RGB": (), "Z": ("Z",), "transmittance": ("transmittance.",)}


class FitCase(NephCase):
    def render(self, name, engine="exact", **changes):
        """Channels of a frame of that scene with changed values."""
        text, own = SCENES[name]
        scene = self.put("made/frame.yaml", text.format(**{**own, **changes}))
        self.neph("render", scene, "-e", engine, "--size", "{}x{}".format(*SIZE), "-q", "-o",
                  self.folder / "made")
        return frames.read_exr(self.folder / f"made/frame_{engine}_0000.exr")[2]

    def scene(self, name, **changes):
        text, own = SCENES[name]
        return self.put(f"{name}.yaml", text.format(**{**own, **changes}))

    def write(self, channels, kept=(), change=None, name="frame.exr", size=SIZE):
        """A file with R, G and B, changed, and the channels that begin with one of `kept`."""
        got = {c: array.array("f", map(change, v) if change and c in "RGB" else v)
               for c, v in channels.items() if c in ("R", "G", "B") or c.startswith(tuple(kept))}
        (self.folder / name).write_bytes(frames.exr_bytes(*size, got))
        return self.folder / name

    def found(self, frame, scene, *more, code):
        return self.json("fit", frame, scene, *more, code=code)

    def check_factor(self, found, unknown, factor):
        """Within 3 %, by what is determined; else it is within the ends that are said."""
        for estimate in (found[unknown], found[unknown]["with_held"]):
            if estimate["determined"]:
                self.assertAlmostEqual(estimate["value"] / factor, 1, delta=0.03)
                low, high = estimate["interval"]
                self.assertTrue(low <= factor * 1.0001 and factor <= high * 1.0001, estimate)
                return
        self.assertEqual(unknown, "extinction")
        self.assertLessEqual(found[unknown]["at_least"], factor)

    def check_mistake(self, found, name):
        self.assertEqual([mistake["name"] for mistake in found["mistakes"]], [name],
                         found["sentence"])
        self.assertIn(name, found["sentence"])


class Mistakes(FitCase):
    def test_planted_mistakes_are_named(self):
        for scene_name, (_, own) in SCENES.items():
            scene = self.scene(scene_name)
            for name, plant in PLANTED.items():
                changes = plant(own)
                channels = self.render(scene_name, **changes)
                for form, kept in FORMS.items():
                    with self.subTest(scene=scene_name, mistake=name, form=form):
                        found = self.found(self.write(channels, kept), scene, code=1)
                        self.check_mistake(found, name)
                        self.check_factor(found, "extinction",
                                          changes["extinction"] / own["extinction"])
                        if found["albedo"]["determined"]:
                            self.check_factor(found, "albedo",
                                              changes.get("albedo", own["albedo"]) / own["albedo"])

    def test_four_pi(self):
        for scene_name in SCENES:
            channels = self.render(scene_name)
            scene = self.scene(scene_name)
            for name, factor in (("a missing 4 pi", FOUR_PI), ("a 4 pi too much", 1 / FOUR_PI)):
                scattered = {**channels,
                             **{c: [r + (factor - 1) * v
                                    for r, v in zip(channels[c], channels[f"volume.{c}"])]
                                for c in "RGB"}}
                for form, kept in FORMS.items():
                    with self.subTest(scene=scene_name, mistake=name, form=form):
                        found = self.found(self.write(scattered, kept), scene, code=1)
                        self.check_mistake(found, name)
                        self.check_factor(found, "albedo", factor)

    def test_opacity_applied_twice(self):
        """Light of the volume, blended by the opacity of its ray once more."""
        for scene_name in SCENES:
            channels, scene = self.render(scene_name), self.scene(scene_name)
            blended = {**channels, **{
                c: [r - v * t for r, v, t in zip(channels[c], channels[f"volume.{c}"],
                                                 channels[f"transmittance.{c}"])] for c in "RGB"}}
            for form, kept in FORMS.items():
                with self.subTest(scene=scene_name, form=form):
                    found = self.found(self.write(blended, kept), scene, code=1)
                    self.check_mistake(found, "opacity applied twice")

    def test_srgb(self):
        for scene_name in SCENES:
            channels, scene = self.render(scene_name), self.scene(scene_name)
            for change, key in ((encode, "srgb_codes"),
                                (lambda code: ((code + 0.055) / 1.055)**2.4 if code > 0.04045
                                 else code / 12.92, "decoded")):
                for form, kept in FORMS.items():
                    with self.subTest(scene=scene_name, transfer=key, form=form):
                        found = self.found(self.write(channels, kept, change), scene, code=1)
                        self.assertEqual((found["transfer"]["name"], found["mistakes"]), (key, []))
                        self.assertTrue(found["transfer"]["sure"])
                        self.assertIn("sRGB codes", found["sentence"])
                        self.check_factor(found, "extinction", 1)

    def test_thin_media_need_a_transmittance(self):
        """Of a thin medium R, G and B tell extinction times albedo."""
        text = SLAB.replace("[0.2, 0.3, 0.4]", "[0, 0, 0]").replace("[0.4, 0.5, 0.6]", "[0, 0, 0]")
        SCENES["dark"] = text, SCENES["slab"][1]
        self.addCleanup(SCENES.pop, "dark")
        channels = self.render("dark", extinction=0.8 / 1000)
        without, with_it = (self.found(self.write(channels, kept), self.scene("dark"), code=1)
                            for kept in ((), ("transmittance.",)))
        self.assertFalse(without["albedo"]["determined"])
        self.assertIsNone(without["albedo"]["value"])
        self.assertAlmostEqual(without["extinction_times_albedo"]["value"], 1e-3, delta=3e-5)
        self.assertTrue(with_it["albedo"]["determined"])
        self.check_factor(with_it, "extinction", 1e-3)

    def test_factors_without_a_name(self):
        found = self.found(self.write(self.render("slab", extinction=0.8 * 1.7, g=0.2)),
                           self.scene("slab"), code=1)
        self.assertEqual(found["mistakes"], [])
        self.assertIn("extinction x 1.7", found["sentence"])
        self.assertIn("no known mistake", found["sentence"])
        self.assertIn("asymmetry 0.2 in place of 0.6", found["sentence"])

    def test_two_mistakes_of_one_factor(self):
        """An albedo of 0.7 is nearly ln 2."""
        found = self.found(self.write(self.render("fog", extinction=0.08 * LN2, albedo=0.7)),
                           self.scene("fog", albedo=0.7), code=1)
        self.assertEqual([mistake["name"] for mistake in found["mistakes"]],
                         ["exp2 taken for exp", "scattering taken for extinction"])

    def test_falloff(self):
        """exp2 in the profile as well: density and falloff have the same factor."""
        found = self.found(self.write(self.render("fog", extinction=0.08 * LN2, falloff=0.4 * LN2)),
                           self.scene("fog"), code=1)
        self.check_factor(found, "falloff", LN2)
        self.check_mistake(found, "exp2 taken for exp")
        self.assertEqual(found["falloff_mistake"], "exp2 taken for exp")

    def test_a_pair_that_is_not_determined(self):
        """From above only the column of a fog is visible: extinction over falloff."""
        text = SCENES["fog"][0].replace("position_m: [0, 3, 0], look_at_m: [0, 2.6, -10]",
                                        "position_m: [0, 90, 0], look_at_m: [0, 0, -30]")
        SCENES["above"] = text, SCENES["fog"][1]
        self.addCleanup(SCENES.pop, "above")
        found = self.found(self.write(self.render("above", extinction=0.08 * LN2)),
                           self.scene("above"), code=1)
        self.assertFalse(found["extinction"]["determined"] or found["falloff"]["determined"])
        self.assertTrue(found["falloff"]["held"])
        self.check_factor(found, "extinction", LN2)
        self.check_mistake(found, "exp2 taken for exp")


class Agreement(FitCase):
    def test_a_frame_agrees(self):
        for name in SCENES:
            frame, scene = self.write(self.render(name)), self.scene(name)
            found = self.found(frame, scene, code=0)
            self.assertTrue(found["agrees"] and found["transfer"]["name"] == "linear")
            for unknown in ("extinction", "albedo"):
                self.check_factor(found, unknown, 1)
            self.assertAlmostEqual(found["asymmetry"]["value"], SCENES[name][1]["g"], delta=1e-3)
            said = self.neph("fit", frame, scene).stdout
            self.assertIn(f"agrees with {name}\n", said)
            self.assertIn("95 % interval", said)
            self.assertIn("held fixed:", said)
            self.assertEqual(self.neph("fit", frame, scene, "-q").stdout,
                             said.splitlines(keepends=True)[0])

    def test_noise(self):
        """Gaussian noise of a tenth of the mean: intervals hold the truth and the verdict stays."""
        rng = random.Random(48)
        for name, changes, code in (("slab", {}, 0), ("slab", {"extinction": 0.8 * LN2}, 1)):
            channels = self.render(name, **changes)
            sigma = 0.1 * sum(channels["G"]) / len(channels["G"])
            noisy = self.write(channels, change=lambda v: v + rng.gauss(0, sigma))
            found = self.found(noisy, self.scene(name), code=code)
            low, high = found["extinction"]["interval"]
            factor = changes.get("extinction", 0.8) / 0.8
            self.assertTrue(low < factor < high and high / low > 1.005, found["extinction"])
            self.assertLess(high / low, 1.2)
            if code:
                self.assertIn("exp2 taken for exp", found["sentence"])

    def test_errors_along_a_horizon(self):
        """A row that is too dark has one error, not one for each pixel: intervals hold the
        truth."""
        channels = self.render("fog")
        for c in "RGB":
            for at in range(7 * SIZE[0], 8 * SIZE[0]):
                channels[c][at] *= 0.985
        found = self.found(self.write(channels), self.scene("fog"), code=0)
        for unknown in ("extinction", "albedo", "falloff"):
            low, high = found[unknown]["interval"]
            self.assertTrue(low < 1 < high and high / low < 1.2, found[unknown])

    def test_outliers(self):
        channels = self.render("slab")
        for at in range(5, SIZE[0] * SIZE[1], 53):
            channels["G"][at] = 40.0
        found = self.found(self.write(channels), self.scene("slab"), code=0)
        self.assertGreater(found["pixels"]["outliers"], 5)

    def test_what_is_free(self):
        frame = self.write(self.render("slab", extinction=0.8 * LN2))
        found = self.found(frame, self.scene("slab"), "--free", "extinction", code=1)
        self.assertEqual([found[unknown]["free"] for unknown in
                          ("extinction", "albedo", "asymmetry", "falloff")],
                         [True, False, False, False])
        self.check_mistake(found, "exp2 taken for exp")
        self.assertEqual(found["falloff"]["held_because"], "no medium has one")


@unittest.skipUnless(shutil.which("povray"), "POV-Ray is not installed")
class AnotherRenderer(FitCase):
    def test_frames_of_povray(self):
        """Factors within 3 %, and the mistake that was planted or none. POV-Ray cuts the fog off
        below the horizon, where it has 1 % less light."""
        for name, changes, factors, mistakes in (
                ("slab", {"extinction": 0.8 / LN2, "albedo": 0.6}, (1 / LN2, 0.75), []),
                ("fog", {"extinction": 0.08 / LN2}, (1 / LN2, 1), ["exp taken for exp2"])):
            with self.subTest(scene=name):
                channels = self.render(name, "povray", **changes)
                found = self.found(self.write(channels, "Z"), self.scene(name), code=1)
                for unknown, factor in zip(("extinction", "albedo"), factors):
                    self.assertTrue(found[unknown]["determined"])
                    self.assertAlmostEqual(found[unknown]["value"] / factor, 1, delta=0.03)
                self.assertEqual([mistake["name"] for mistake in found["mistakes"]], mistakes)


class Channels(FitCase):
    def test_depth(self):
        """In centimetres, along the ray, and of pixels that show something else."""
        channels, scene = self.render("slab"), self.scene("slab")
        centimetres = {**channels, "Z": [100 * z for z in channels["Z"]]}
        found = self.found(self.write(centimetres, ("Z",)), scene, code=0)["pixels"]
        self.assertAlmostEqual(found["depth_factor"], 100, delta=0.01)
        hidden = {c: list(v) for c, v in channels.items()}
        for at in range(3 * SIZE[0]):
            hidden["Z"][at] = 1.0
            hidden["R"][at] = hidden["G"][at] = hidden["B"][at] = 5.0
        found = self.found(self.write(hidden, ("Z",)), scene, "--pixels", 2000, code=0)["pixels"]
        self.assertEqual(found["other_depth"], 3 * SIZE[0])
        half = math.tan(math.radians(20)) / SIZE[1]
        rays = {**channels, "Z": [
            z * math.hypot(1, half * (2 * (at % SIZE[0]) + 1 - SIZE[0]),
                           half * (2 * (at // SIZE[0]) + 1 - SIZE[1]))
            for at, z in enumerate(channels["Z"])]}
        found = self.found(self.write(rays, ("Z",)), scene, code=0)["pixels"]
        self.assertTrue(found["depth_is_distance"])
        self.assertEqual(found["depth_factor"], 1)

    def test_transmittance_of_another_name(self):
        channels, scene = self.render("slab", extinction=0.8 / 1000), self.scene("slab")
        channels["view.T"] = channels["transmittance.G"]
        channels["A"] = [1 if z < 1e9 else 1 - t
                         for t, z in zip(channels["transmittance.G"], channels["Z"])]
        for name, kept in (("view.T", ("view.",)), ("A", ("A",)),
                           ("transmittance", ("transmittance.",))):
            found = self.found(self.write(channels, kept), scene, "--transmittance", name, code=1)
            self.assertTrue(found["albedo"]["determined"], name)
            self.check_factor(found, "extinction", 1e-3)

    def test_a_crop(self):
        channels, scene = self.render("slab"), self.scene("slab")
        width, height, left, top = 24, 15, 7, 2
        crop = {c: array.array("f", [channels[c][(top + y) * SIZE[0] + left + x]
                                     for y in range(height) for x in range(width)]) for c in "RGB"}
        path = self.folder / "crop.exr"
        path.write_bytes(frames.exr_bytes(width, height, crop, corner=(left, top), display=SIZE))
        self.found(path, scene, code=0)

    def test_refusals(self):
        channels, scene = self.render("slab"), self.scene("slab")
        frame = self.write(channels, ("Z", "transmittance."))
        black = self.write({c: [0.0] * len(channels[c]) for c in "RGB"}, name="black.exr")
        bad = self.write({**channels, "R": [math.nan] + list(channels["R"][1:])}, name="nan.exr")
        far = self.write({**channels, "Z": [3.0] * len(channels["Z"])}, ("Z",), name="far.exr")
        tiny = self.write({c: channels[c][:6] for c in "RGB"}, name="tiny.exr", size=(3, 2))
        text = scene.read_text()
        multiple = self.put("multiple.yaml", text.replace("scattering: single",
                                                          "scattering: multiple"))
        empty = self.put("empty.yaml", text[:text.index("media:")])
        isotropic = self.put("isotropic.yaml", text.replace("henyey_greenstein", "isotropic")
                             .replace("      asymmetry_g: 0.6\n", ""))
        self.check_refusals(
            (2, ("black.exr", "black"), (black, scene)),
            (1, ("nan.exr", "NaN"), (bad, scene)),
            (65, ("depths", "% of the pixels", "--depth"), (far, scene)),
            (2, ("pixels are left", "16"), (tiny, scene)),
            (2, ("no closed form", "scattering: single"), (frame, multiple)),
            (2, "no medium", (frame, empty)),
            (2, ("grid", "homogeneous"), (frame, "voxel_grid")),
            (2, "emit", (frame, "glowing_slab")),
            (64, ("--free asymmetry", "has none"), (frame, isotropic, "--free", "asymmetry")),
            (64, "--free haze", (frame, scene, "--free", "haze")),
            (65, ("no channel 'T'", "--transmittance"), (frame, scene, "--transmittance", "T")),
            (65, "no transmittance", (frame, scene, "--transmittance", "Z")),
            (66, "missing.exr", (self.folder / "missing.exr", scene)),
            (64, "which frame", (frame,)),
            before=("fit",))


if __name__ == "__main__":
    unittest.main(verbosity=2)
