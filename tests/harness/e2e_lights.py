#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Lights with keys: a frame of the moving scene has the bits of a scene with static lights at the
places of that frame."""
import unittest

import frames
import neph_case
import night

SCENE = """
title: A point light and a spot in fog over the ground
camera: {{position_m: [0, 2, 9], look_at_m: [0, 1.8, 0], vertical_fov_deg: 42}}
frames: {{count: 5, rate_hz: 30}}
scattering: {scattering}
lights:
{lights}
solids:
  - box: {{min_m: [-14, -2, -14], max_m: [14, 0, 14], albedo: [0.3, 0.3, 0.3]}}
  - sphere: {{center_m: [0.6, 2.1, 0.3], radius_m: 0.6, albedo: [0.5, 0.5, 0.5]}}
media:
  - homogeneous: {{extinction_per_m: 0.1, albedo: [0.9, 0.9, 0.9],
                  bounds: {{min_m: [-12, 0.5, -12], max_m: [12, 7, 7]}}}}
"""

# In frame 3 the first light is halfway, and the spot has just gone on.
MOVING = """
  - keys:
      - {frame: 2, position_m: [-2, 2.5, 1], intensity_w_per_sr: [40, 20, 10]}
      - {frame: 4, position_m: [-1, 3.5, 0], intensity_w_per_sr: [20, 20, 40]}
  - cone: {axis: [0, -1, 0], inner_deg: 20, outer_deg: 30}
    keys:
      - {frame: 0, position_m: [1, 4, 1], intensity_w_per_sr: [0, 0, 0]}
      - {frame: 3, position_m: [2, 5, 1], intensity_w_per_sr: [60, 60, 60], axis: [-3, -4, 0],
         cut: true}"""
STATIC = """
  - {position_m: [-1.5, 3, 0.5], intensity_w_per_sr: [30, 20, 25]}
  - {position_m: [2, 5, 1], intensity_w_per_sr: [60, 60, 60],
     cone: {axis: [-3, -4, 0], inner_deg: 20, outer_deg: 30}}"""

# Without a history, and with few paths.
SETTINGS = {"realtime": ("-p", "off"), "oracle": ("-s", "samples=4"), "tracer": ("-s", "samples=4")}

PROGRAM = """#!/usr/bin/env python3
import json, sys
sys.dont_write_bytecode = True
sys.path.insert(0, {examples!r})
import fog
if sys.argv[1] == "--version":
    print("test program")
    sys.exit()
job = json.load(open("job.json"))
width, height = job["size_px"]
rows = [light["position_m"] + light["intensity_w_per_sr"] + (light["cone"] or {{}}).get("axis", [])
        for light in job["lights"]]
# Frames have no negative values.
rows = [[10 + value for value in row + [0] * (width - len(row))] for row in rows]
fog.write_frame("frame.exr", width, height, {{c: rows for c in "RGB"}})
"""


class Lights(neph_case.NephCase):
    surroundings = neph_case.VALIDATED

    def render(self, name, lights, engine, scattering, frame=3):
        scene = self.put(f"{name}.yaml", SCENE.format(lights=lights, scattering=scattering))
        result, = self.json("render", scene, "-e", engine, "--frame", frame, "--seed", 1,
                            "--size", "24x14", "-o", self.folder / name,
                            *SETTINGS.get(engine, ()))
        return frames.read_exr(self.folder / result["exr"])[2]

    def check(self, engine, scattering="single"):
        moving, static = (self.render(name, lights, engine, scattering)
                          for name, lights in (("moving", MOVING), ("static", STATIC)))
        self.assertEqual(moving.keys(), static.keys())
        for channel in static:
            self.assertEqual(moving[channel], static[channel], (engine, channel))
        return moving

    def test_frames_are_those_of_static_lights(self):
        for engine in ("march", "realtime"):
            self.check(engine)
        before = self.render("before", MOVING, "exact", "single", frame=2)
        self.assertNotEqual(self.check("exact")["R"], before["R"])
        for engine in ("oracle", "tracer"):
            self.check(engine, "multiple")

    @night.of_the_night
    def test_other_renderers_get_the_lights_of_the_frame(self):
        for engine in ("cycles", "povray"):
            self.check(engine)

    def test_programs_get_the_lights_of_the_frame(self):
        program = self.put("program.py", PROGRAM.format(
            examples=str(neph_case.ROOT / "docs/examples")))
        program.chmod(0o755)
        scene = self.put("moving.yaml", SCENE.format(lights=MOVING, scattering="single"))
        results = self.json("render", scene, "-e", "command", "--frames", 4, "--size", "9x2", "-o",
                            self.folder / "frames", NEPH_COMMAND=str(program))
        found = [value - 10 for value in frames.read_exr(self.folder / results[3]["exr"])[2]["R"]]
        self.assertEqual(found[:9], [-1.5, 3, 0.5, 30, 20, 25, 0, 0, 0])
        self.assertEqual(found[9:15], [2, 5, 1, 60, 60, 60])
        for value, expected in zip(found[15:], (-0.6, -0.8, 0), strict=True):
            self.assertAlmostEqual(value, expected, delta=2.0 ** -21)  # floats of the file


if __name__ == "__main__":
    unittest.main()
