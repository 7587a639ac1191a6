#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Write the scenes of the suites `motion` and `motion_test` beside this file."""
import pathlib
import textwrap

import test_scenes
import tuning_scenes
from parts import FRAMES, RATE_HZ, camera, listed

HEAD = """# SPDX-License-Identifier: MIT
# Written by motion.py. Pixels are those of 384x216, frames those of 30 Hz.
name: {name}
title: {title}
description: >
{description}
{camera}
frames: {{count: {frames}, rate_hz: {rate_hz}}}
{sun}
"""


def write(scene):
    told = " ".join(scene["isolates"].split()) + " The reference is " + (
        scene.get("reference", "engine `exact`, in every frame") + ".")
    text = HEAD.format(
        name=scene["name"], title=scene["title"], frames=FRAMES, rate_hz=RATE_HZ,
        description=textwrap.fill(told, 100, initial_indent="  ", subsequent_indent="  "),
        camera=camera(scene["camera"], scene["fov_deg"]), sun=scene["sun"])
    if "wind" in scene:
        text += f"wind: {{velocity_m_per_s: {listed(scene['wind'])}}}\n"
    text += f"background_w_per_m2_sr: {listed(scene['sky'])}\nscattering: single\n"
    for kind in ("solids", "media"):
        text += f"{kind}:\n" + "\n".join(scene[kind]) + "\n"
    text += f"display: {{exposure_ev: {scene['ev']:g}}}\n"
    pathlib.Path(__file__).with_name(scene["name"] + ".yaml").write_text(text)


for each in tuning_scenes.SCENES + test_scenes.SCENES:
    write(each)
