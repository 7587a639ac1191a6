#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The shaders' structs for C: c_structs.py HEADER REFLECTION... writes `struct neph_gpu_<name>` for
every struct that lies in a buffer or among the push constants, from the JSON of spirv-cross. So
each is written once, in GLSL, and C has its fields where the shader has them."""
import json
import pathlib
import re
import sys

SCALARS = {"float": "float", "uint": "uint32_t", "int": "int32_t"}
VECTOR = re.compile(r"(|u|i)vec([234])$")
ELEMENT = {"": "float", "u": "uint32_t", "i": "int32_t"}
TOP = """/* By renderer/c_structs.py: structs of buffers and push constants of shaders/. */
#ifndef NEPH_GENERATED_STRUCTS_H
#define NEPH_GENERATED_STRUCTS_H

#include <stdint.h>
"""


class Shader:
    """The types of one shader in C: of each struct its fields, size and alignment by std430."""

    def __init__(self, types):
        self.types = types

    def c_name(self, key):
        words = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", self.types[key]["name"])
        return f"struct neph_gpu_{words.lower()}"

    def measure(self, type_name):
        """(C type, C array suffix, bytes, alignment)"""
        if type_name in SCALARS:
            return SCALARS[type_name], "", 4, 4
        vector = VECTOR.match(type_name)
        if vector:
            count = int(vector[2])
            return ELEMENT[vector[1]], f"[{count}]", 4 * count, 8 if count == 2 else 16
        if type_name not in self.types:
            sys.exit(f"c_structs.py: no C type for GLSL's {type_name}")
        _, size, alignment = self.layout(type_name)
        return self.c_name(type_name), "", size, alignment

    def layout(self, key):
        fields, end, largest = [], 0, 4
        for member in self.types[key]["members"]:
            c_type, suffix, size, alignment = self.measure(member["type"])
            counts = member.get("array", [])
            if counts and (len(counts) > 1 or member["array_stride"] != size):
                sys.exit(f"c_structs.py: C has no array like {self.c_name(key)}.{member['name']}")
            fields += self.padding(end, member["offset"])
            fields.append(f"{c_type} {member['name']}{''.join(f'[{n}]' for n in counts)}{suffix};")
            end = member["offset"] + size * (counts[0] if counts else 1)
            largest = max(largest, alignment)
        size = -(-end // largest) * largest
        return fields + self.padding(end, size), size, largest

    @staticmethod
    def padding(start, end):
        return [f"uint32_t padding_{start}[{(end - start) // 4}];"] if end > start else []

    def is_shared(self, key):
        """In a buffer, and with an end. Types of local variables have no offsets."""
        members = self.types[key]["members"]
        return all("offset" in member and 0 not in member.get("array", []) for member in members)

    def structs(self):
        """Those within others come first."""
        for key in self.types:
            if self.is_shared(key):
                yield self.c_name(key), self.layout(key)[0]


def header(reflections):
    known = {}
    for path in reflections:
        for name, fields in Shader(json.loads(path.read_text()).get("types", {})).structs():
            if known.setdefault(name, fields) != fields:
                sys.exit(f"c_structs.py: {path.name} has another {name} than the shaders before it")
    bodies = ("\n".join([f"{name} {{"] + [f"    {field}" for field in fields] + ["};"])
              for name, fields in known.items())
    return TOP + "\n" + "\n\n".join(bodies) + "\n\n#endif\n"


def main():
    target, text = pathlib.Path(sys.argv[1]), header([pathlib.Path(name) for name in sys.argv[2:]])
    if not target.exists() or target.read_text() != text:  # else nothing is rebuilt
        target.write_text(text)


if __name__ == "__main__":
    main()
