#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Capabilities and limits that the compiled shaders use, compared with the table of device
requirements (docs/devices.md): each one has a row of the table or is guaranteed by Vulkan 1.2.
Also: frames do not depend on the contents of uninitialized memory."""
import array
import os
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(os.environ["NEPH_SOURCE_DIR"], "tests/harness")))

import frames
import neph_case

GENERATED = pathlib.Path(os.environ["NEPH"]).parent / "renderer/generated"
SOURCES = neph_case.ROOT / "renderer"
HEADER_WORDS = 5
(OP_EXTENSION, OP_ENTRY_POINT, OP_EXECUTION_MODE, OP_CAPABILITY, OP_TYPE_BOOL, OP_TYPE_INT,
 OP_TYPE_FLOAT, OP_TYPE_VECTOR, OP_TYPE_ARRAY, OP_TYPE_STRUCT, OP_TYPE_POINTER, OP_CONSTANT,
 OP_SPEC_CONSTANT, OP_VARIABLE) = 10, 15, 16, 17, 20, 21, 22, 23, 28, 30, 32, 43, 50, 59
LOCAL_SIZE, WORKGROUP, PUSH_CONSTANT = 17, 4, 9

# Capabilities: part of Vulkan 1.2 (), or rows of the table.
CAPABILITIES = {
    1: (),  # Shader
    11: ("shaderInt64",),
    47: (),  # ImageBuffer
    49: ("shaderStorageImageExtendedFormats",),
    61: ("subgroupSupportedOperations", "subgroupSupportedStages"),  # GroupNonUniform
    62: ("subgroupSupportedOperations",),  # GroupNonUniformVote
    5305: (),  # StorageTexelBufferArrayDynamicIndexing, which pack_shader.py removes
}
# Guaranteed minimum of each limit without a row.
THREADS, SHARED_BYTES, PUSH_BYTES = 128, 16384, 128


def instructions(words):
    at = HEADER_WORDS
    while at < len(words):
        length = words[at] >> 16
        yield words[at] & 0xFFFF, words[at + 1:at + length]
        at += length


class Module:
    """The declarations of a shader."""
    def __init__(self, path):
        self.capabilities, self.extensions, self.threads = set(), 0, 0
        self.bytes_in = {WORKGROUP: 0, PUSH_CONSTANT: 0}
        self.sizes, constants, targets = {}, {}, {}
        for operation, words in instructions(array.array("I", path.read_bytes())):
            if operation == OP_CAPABILITY:
                self.capabilities.add(words[0])
            elif operation == OP_EXTENSION:
                self.extensions += 1
            elif operation == OP_EXECUTION_MODE and words[1] == LOCAL_SIZE:
                self.threads = words[2] * words[3] * words[4]
            elif operation == OP_TYPE_BOOL:
                self.sizes[words[0]] = 4
            elif operation in (OP_TYPE_INT, OP_TYPE_FLOAT):
                self.sizes[words[0]] = words[1] // 8
            elif operation == OP_TYPE_VECTOR:
                self.sizes[words[0]] = self.size_of(words[1]) * words[2]
            elif operation in (OP_CONSTANT, OP_SPEC_CONSTANT):
                constants[words[1]] = words[2]
            elif operation == OP_TYPE_ARRAY:
                self.sizes[words[0]] = self.size_of(words[1]) * constants.get(words[2], 1)
            elif operation == OP_TYPE_STRUCT:
                self.sizes[words[0]] = sum(map(self.size_of, words[1:]))
            elif operation == OP_TYPE_POINTER:
                targets[words[0]] = words[2]
            elif operation == OP_VARIABLE and words[2] in self.bytes_in:
                self.bytes_in[words[2]] += self.size_of(targets[words[0]])

    def size_of(self, name):
        return self.sizes.get(name, 0)


class Requirements(neph_case.NephCase):
    def test_shaders_use_what_has_a_row(self):
        rows = {row["name"] for row in self.json("doctor", code=None)["vulkan"]}
        shaders = [path.relative_to(SOURCES) for path in SOURCES.rglob("*.comp")]
        self.assertGreater(len(shaders), 60)
        for path in shaders:
            module = Module(GENERATED / f"{path}.spv")
            with self.subTest(str(path)):
                self.assertLessEqual(module.capabilities, set(CAPABILITIES))
                for capability in module.capabilities:
                    self.assertLessEqual(set(CAPABILITIES[capability]), rows)
                self.assertEqual(module.extensions, 0)
                self.assertTrue(0 < module.threads <= THREADS)
                self.assertLessEqual(module.bytes_in[WORKGROUP], SHARED_BYTES)
                self.assertLessEqual(module.bytes_in[PUSH_CONSTANT], PUSH_BYTES)

    def test_fresh_memory_may_hold_anything(self):
        """lavapipe's memory is malloc()'s, which fills it with a byte's complement."""
        for engine, scene, *words in (
                ("march", "voxel_grid"), ("tracer", "grid_cloud_multiple", "-s", "samples=4"),
                ("realtime", "fence_backlit", "-p", "ours", "--frames", "3")):
            found = []
            for byte in ("1", "85"):
                folder = self.folder / engine / byte
                self.neph("render", scene, "-e", engine, *words, "--size", "24x16", "-q", "-o",
                          folder, MALLOC_PERTURB_=byte)
                found.append([frames.read_exr(path)[2] for path in sorted(folder.glob("*.exr"))])
            self.assertEqual(*found, engine)


if __name__ == "__main__":
    unittest.main()
