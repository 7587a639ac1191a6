#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The validation layers on each family of kernels, by night: core and synchronization checks, then
the layer's checks inside shaders (NEPH_VULKAN_VALIDATION=1 and =shaders). Any message fails the
frame. By hand, on any machine with the layers, for example with a newer Mesa:

    NEPH=build/release/neph NEPH_SOURCE_DIR=. python3 tests/harness/e2e_layers.py
"""
import re
import unittest

import neph_case

# Arguments of `neph render` for each family of kernels. Frames have a few work groups.
MARCHES = {
    "fog": "two_layer_fog -e march",
    "point lights": "spot_fence -e march",
    "voxels": "voxel_grid -e march",
    "voxels in a texture": "voxel_grid -e march -s grid_sampling=texture -s sun=marched",
    "sun cache": "voxel_grid -e march -s sun_cache=grid -s sun_cache_voxels=32 -s skip=majorant",
    "cloud shadows": "cloud_shadow -e march -s cloud_shadow=map -s cloud_shadow_texels=64",
    "octaves": "cloud_beside -e march_octaves",
    "clouds of Horizon": "cloud_beside -e march_horizon",
    "fitted octaves": "grid_cloud_multiple -e march_octaves_fitted",
    "traced light": "grid_cloud_multiple -e march_traced",
    "diffused light": "height_fog_multiple -e march_diffused",
    "similarity": "height_fog_multiple -e march_similarity",
    "slab light": "slab_multiple_thin -e march_slab",
    "sky": "sky_aerial -e march_octaves -s sky=tables",
    "looks of fog": "fog_look_evening -e fog_look",
    "sky tables": "sky_earth -e sky",
    "tracer": "grid_cloud_multiple -e tracer -s samples=4",
    "tracer, lights": "lamp_multiple -e tracer -s samples=4",
    "screen": "surface_rough -e screen -p fast",
}
REALTIME = {
    "froxels": "fence_backlit -p ours -s froxels=on",
    "upsampling": "fence_backlit -p ours -s taa=upsampling -s screen_percent=50",
    "locks": "fence_backlit -p ours -s taa=locks -s screen_percent=50",
    "sharpening": "fence_backlit -p ours -s sharpen=on",
    "filter in steps": "fence_backlit -p ours -s atrous=on -s gradient=off",
    "traced light": "grid_cloud_multiple -p ours -s lighting=traced",
    "octaves": "cloud_below -p ours -s lighting=octaves",
}
POST = ("-p unreal", "-s upscale=catmull_rom -s screen_percent=50",
        "-s tone=on -s sharpen=rcas", "-s tone=on -s fxaa=quality_12")


class Layers(neph_case.NephCase):
    def validated(self, family, *words):
        for checks in ("1", "shaders"):
            with self.subTest(family, checks=checks):
                self.neph(*words, "-q", "-o", self.folder / "frames",
                          NEPH_VULKAN_VALIDATION=checks)

    def test_marches(self):
        for family, words in MARCHES.items():
            self.validated(family, "render", *words.split(), "--size", "24x14")

    def test_presets(self):
        refusal = self.neph("render", "fence_backlit", "-e", "realtime", "-p", "no", code=64).stderr
        presets = re.search("engine realtime has: (.*)", refusal)[1].split(", ")
        self.assertIn("ours", presets)
        for preset in presets:
            self.validated(preset, "render", "fence_backlit", "-e", "realtime", "-p", preset,
                           "--size", "40x24", "--frames", "4")

    def test_techniques_of_realtime(self):
        for family, words in REALTIME.items():
            self.validated(family, "render", *words.split(), "-e", "realtime", "--size", "40x24",
                           "--frames", "4")

    def test_post(self):
        self.neph("render", "fence_backlit", "--size", "40x24", "-q", "-o", self.folder)
        [frame] = self.folder.glob("*.exr")
        for words in POST:
            self.validated(words, "post", frame, *words.split())


if __name__ == "__main__":
    unittest.main()
