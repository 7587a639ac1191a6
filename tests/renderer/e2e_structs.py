#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""renderer/c_structs.py: C structs have the shader's layout, or the build fails."""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(os.environ["NEPH_SOURCE_DIR"]) / "renderer" / "c_structs.py"


def write_structs(*shaders):
    """The generated header, or the script's error message."""
    with tempfile.TemporaryDirectory() as folder:
        paths = []
        for number, members in enumerate(shaders):
            paths.append(pathlib.Path(folder) / f"{number}.json")
            paths[-1].write_text(
                json.dumps({"types": {"_1": {"name": "TheOne", "members": members}}}))
        header = pathlib.Path(folder) / "structs.h"
        done = subprocess.run([sys.executable, SCRIPT, header, *paths], capture_output=True,
                              text=True)
        return header.read_text() if done.returncode == 0 else done.stderr


def member(name, kind, offset, **more):
    return {"name": name, "type": kind, "offset": offset, **more}


class Structs(unittest.TestCase):
    def test_gaps_become_padding(self):
        text = write_structs([member("place", "vec3", 0), member("kind", "uint", 12),
                              member("at", "vec2", 16), member("up", "uvec3", 32),
                              member("parts", "vec4", 48, array=[3], array_stride=16)])
        self.assertIn(
            "struct neph_gpu_the_one {\n    float place[3];\n    uint32_t kind;\n    float at[2];\n"
            "    uint32_t padding_24[2];\n    uint32_t up[3];\n    uint32_t padding_44[1];\n"
            "    float parts[3][4];\n};", text)

    def test_shaders_must_agree(self):
        self.assertIn("another struct neph_gpu_the_one",
                      write_structs([member("a", "float", 0)], [member("b", "float", 0)]))
        self.assertIn("float a;",
                      write_structs([member("a", "float", 0)], [member("a", "float", 0)]))

    def test_what_c_has_no_like_of_is_refused(self):
        self.assertIn("no C type", write_structs([member("a", "mat3", 0)]))
        self.assertIn("no array",
                      write_structs([member("a", "vec3", 0, array=[2], array_stride=16)]))

    def test_what_is_in_no_buffer_is_left_out(self):
        self.assertNotIn("the_one", write_structs([{"name": "a", "type": "float"}]))
        self.assertNotIn("the_one",
                         write_structs([member("a", "float", 0, array=[0], array_stride=4)]))


if __name__ == "__main__":
    unittest.main()
