#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Media in turned bounds: a box turned by 90 degrees is a box with other sides, engines agree with
`exact` at any angle, and what cannot be turned is refused."""
import unittest

import frames
import neph_case
import night

SCENE = """
title: Fog in boxes that are turned
camera: {{position_m: {eye}, look_at_m: [0, 2, 0], vertical_fov_deg: 50}}
sun: {{direction: [0.3, 0.5, 0.4], irradiance_w_per_m2: [3, 3, 3]}}
background_w_per_m2_sr: [0.2, 0.3, 0.4]
scattering: single
solids:
  - box: {{min_m: [-20, -1, -20], max_m: [20, 0, 20], albedo: [0.4, 0.4, 0.4]}}
media:
{media}
"""
BOX = """
  - homogeneous: {{extinction_per_m: 0.3, albedo: [0.9, 0.9, 0.9], bounds: {bounds}{turn}}}"""
ALONG = "{min_m: [-4, 1, -1], max_m: [4, 4, 1]}"
ACROSS = "{min_m: [-1, 1, -4], max_m: [1, 4, 4]}"
FOGS = """
  - homogeneous: {extinction_per_m: 0.3, albedo: [0.9, 0.9, 0.9], bounds_turn_deg: 30,
                  bounds: {min_m: [-4, 1, -1], max_m: [4, 4, 1]}}
  - height_fog:
      layers: [{extinction_per_m: 0.2, falloff_per_m: 0.5, height_m: 0}]
      albedo: [0.8, 0.9, 1]
      bounds: {min_m: [-6, 0, -7], max_m: [6, 5, -4]}
      bounds_turn_deg: -20
      bounds_turn_axis: z"""
THREE = FOGS + """
  - gaussian: {extinction_per_m: 0.8, center_m: [1, 3, 2], width_m: 1, albedo: [1, 1, 1],
               bounds: {min_m: [-1, 1, 1], max_m: [3, 5, 3]}, bounds_turn_deg: 50,
               bounds_turn_axis: x}"""
VALUES = [0.2 + 0.8 * ((3 * i + 5 * j + 7 * k) % 11) / 10 for k in range(7) for j in range(6)
          for i in range(8)]
# Larger than the bounds, which cut it, with voxels of three sides.
GRID = """
  - grid: {{size: [8, 6, 7], origin_m: [-4.9, 0, -3], spacing_m: [1.4, 0.8, 1], values: {values},
           extinction_per_m: 0.3, albedo: [0.9, 0.9, 0.9], {cells}bounds_turn_deg: {turn},
           bounds_turn_axis: {axis}, bounds: {{min_m: [-4, 1, -1], max_m: [4, 3, 1]}}}}"""
CELLS = ("", "interpolation: constant, ")
EYES = {"outside": "[5, 3, 9]", "inside": "[0.5, 2, 0]", "edge_on": "[8, 4, 0]"}


class TurnedBounds(neph_case.NephCase):
    surroundings = neph_case.VALIDATED

    def render(self, name, media, engine, *flags, eye="outside"):
        scene = self.put(f"{name}.yaml", SCENE.format(media=media, eye=EYES[eye]))
        result, = self.json("render", scene, "-e", engine, "--seed", 1, "--size", "32x18", "-o",
                            self.folder / "out", *flags)
        return self.folder / result["exr"]

    def difference(self, reference, test, quantity="radiance"):
        document = self.json("compare", reference, test)
        return next(row["value"] for row in document["measurements"]
                    if (row["metric"], row["quantity"]) == ("rel_rmse", quantity))

    def test_a_quarter_turn_is_a_box_with_other_sides(self):
        turned = BOX.format(bounds=ALONG, turn=", bounds_turn_deg: 90")
        plain = BOX.format(bounds=ACROSS, turn="")
        for engine in ("exact", "march"):
            found, wanted = (frames.read_exr(self.render(name, media, engine))[2]
                             for name, media in (("turned", turned), ("plain", plain)))
            for channel in "RGB":
                for a, b in zip(found[channel], wanted[channel], strict=True):
                    self.assertAlmostEqual(a, b, delta=1e-5 * max(wanted[channel]))

    def test_engines_agree(self):
        """march: 0.5 % by its steps; the tracers: their noise."""
        for eye in EYES:
            exact = self.render("three", THREE, "exact", eye=eye)
            for engine, flags, limit in (("march", (), 5e-3), ("realtime", ("-p", "off"), 5e-3),
                                         ("tracer", ("-s", "samples=64"), 0.05),
                                         ("oracle", ("-s", "samples=64"), 0.05)):
                test = self.render("three", THREE, engine, *flags, eye=eye)
                self.assertLess(self.difference(exact, test), limit, (eye, engine))

    def test_equal_voxels_are_a_homogeneous_medium(self):
        """Within the rounding of float32."""
        fog = BOX.format(bounds="{min_m: [-4, 1, -1], max_m: [4, 3, 1]}",
                         turn=", bounds_turn_deg: 25")
        for engine in ("exact", "march"):
            plain = self.render("plain", fog, engine, eye="inside")
            for cells in CELLS:
                grid = GRID.format(values=[1] * len(VALUES), turn=25, axis="y", cells=cells)
                voxels = self.render("voxels", grid, engine, eye="inside")
                self.assertLess(self.difference(plain, voxels), 1e-6, (cells, engine))

    def test_engines_agree_on_voxels(self):
        """A degree more or less is 2e-3 to 4e-3. march: 3e-4 by its steps; tracer: 1e-3 by its
        noise."""
        for cells, eyes in zip(CELLS, (EYES, ["edge_on"]), strict=True):
            grids = "".join(GRID.format(values=values, turn=turn, axis=axis, cells=cells)
                            for values, turn, axis in ((VALUES, 25, "y"), (VALUES[::-1], -20, "z")))
            for eye in eyes:
                exact = self.render("grids", grids, "exact", eye=eye)
                for engine, flags, limit in (("march", (), 1e-3),
                                             ("tracer", ("-s", "samples=64"), 2e-3)):
                    test = self.render("grids", grids, engine, *flags, eye=eye)
                    self.assertLess(self.difference(exact, test), limit, (cells, eye, engine))

    def test_paths_of_all_orders_are_equal(self):
        """Means of tracer and oracle over the frame: 4 standard errors."""
        media = THREE.replace("[0.9, 0.9, 0.9]", "[1, 1, 1]")
        scene = self.put("all.yaml", SCENE.format(media=media, eye=EYES["outside"]).replace(
            "single", "multiple"))
        means = []
        for engine in ("tracer", "oracle"):
            result, = self.json("render", scene, "-e", engine, "-s", "samples=64", "--size",
                                "24x14", "-o", self.folder / "all")
            found = frames.read_exr(self.folder / result["exr"])[2]
            pixels = len(found["G"])
            means.append((sum(found["G"]) / pixels, sum(found["variance.G"]) / pixels ** 2))
        (a, a2), (b, b2) = means
        self.assertLess(abs(a - b), 4 * (a2 + b2) ** 0.5)
        self.assertLess((a2 + b2) ** 0.5, 0.01 * a)

    @night.of_the_night
    def test_other_renderers_turn_fogs(self):
        """Transmittance by steps, without noise; radiance with the noise of Cycles. Voxels of such
        bounds differ by 0.004 to 0.03 in transmittance."""
        for eye in EYES:
            exact = self.render("fogs", FOGS, "exact", eye=eye)
            for engine in ("cycles", "povray"):
                test = self.render("fogs", FOGS, engine, eye=eye)
                self.assertLess(self.difference(exact, test, "transmittance"), 2e-4, (eye, engine))
                self.assertLess(self.difference(exact, test), 0.01, (eye, engine))

    @night.of_the_night
    def test_other_renderers_get_voxels(self):
        for engine in ("cycles", "povray"):
            exact = self.render("three", THREE, "exact")
            test = self.render("three", THREE, engine)
            self.assertLess(self.difference(exact, test), 0.1, engine)  # edges of voxels

    def test_refusals(self):
        scene = self.put("unbounded.yaml", SCENE.format(eye=EYES["outside"], media="""
  - height_fog:
      layers: [{extinction_per_m: 0.2, falloff_per_m: 0.5, height_m: 0}]
      albedo: [1, 1, 1]
      bounds_turn_deg: 20"""))
        self.neph("scenes", scene, code=65, said="bounds_turn_deg")
        scene.write_text(scene.read_text() + "\n      bounds_turn_axis: w\n")
        self.neph("scenes", scene, code=65, said="bounds_turn_axis")


if __name__ == "__main__":
    unittest.main()
