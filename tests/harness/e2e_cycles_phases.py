#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The phase functions that the installed Blenders have, against `exact`; those before Blender 4.3
refuse them. NEPH_BLENDER names more Blenders than the one of the system."""
import json
import math
import sys
import unittest

import frames
import neph_case

SCENE = """title: a fog beside the sun
camera: {{position_m: [0, 2, 20], look_at_m: [0, 4, 0], vertical_fov_deg: 50}}
sun: {{direction: [1, 0.35, {towards}], irradiance_w_per_m2: [3, 3, 3]}}
scattering: single
media:
  - homogeneous:
      extinction_per_m: 0.05
      albedo: [0.9, 0.6, 0.3]
      {phase}
      bounds: {{min_m: [-30, 0, -30], max_m: [30, 20, 15]}}
"""
PHASES = {
    "rayleigh": {}, "draine": {"asymmetry_g": 0.5, "draine_alpha": 20},
    "cornette_shanks": {"asymmetry_g": 0.6}, "jendersie_deon": {"droplet_diameter_um": 10},
    "double_henyey_greenstein": {"asymmetry_g": 0.8, "second_asymmetry_g": -0.3,
                                 "first_share": 0.7}}
# 256 paths: a pixel has 0.8 % noise, the mean over the frame 4e-4; without steps a bias of 5e-4.
TOLERANCE = 2.5e-3


class CyclesPhases(neph_case.NephCase):
    def engines(self):
        listed = json.loads(self.neph("engines", "--json").stdout)
        return {e["name"]: e["can"] for e in listed
                if e["name"].startswith("cycles") and e["available"]}

    def write(self, name, towards):
        path = self.folder / f"{name}{towards + 1}.yaml"
        phase = "\n      ".join([f"phase: {name}"] +
                                [f"{key}: {value}" for key, value in PHASES[name].items()])
        path.write_text(SCENE.format(phase=phase, towards=towards))
        return path

    def render(self, scene, engine):
        out = self.folder / "out"
        self.neph("render", scene, "-e", engine, "--size", "32x18", "-q", "-o", out,
                  *(() if engine == "exact" else ("-s", "samples=256")))
        channels = frames.read_exr(out / f"{scene.stem}_{engine}_0000.exr")[2]
        return [math.fsum(channels[c]) for c in "RGB"]

    def test_each_against_exact(self):
        for engine, can in self.engines().items():
            for name in PHASES:
                with self.subTest(engine=engine, phase=name):
                    if "Draine" not in can:
                        self.neph("render", self.write(name, 1), "-e", engine, "-o", self.folder,
                                  code=2, said="from 4.3 on")
                        continue
                    for towards in (-1, 1):
                        scene = self.write(name, towards)
                        for a, b in zip(self.render(scene, engine), self.render(scene, "exact")):
                            self.assertAlmostEqual(a / b, 1.0, delta=TOLERANCE)
            if "Draine" not in can:
                print(f"{engine} ({can}): refuses them; a Blender from 4.3 on is not compared",
                      file=sys.stderr)


if __name__ == "__main__":
    sys.exit(unittest.main())
