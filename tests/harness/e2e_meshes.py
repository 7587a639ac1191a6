#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Meshes in scene files, from the command line: a mesh of boxes is rendered as the boxes are,
devices render materials as the CPU does, engines name what they lack, and files that are no mesh
are errors with their place."""
import base64
import json
import math
import pathlib
import random
import struct
import unittest
import zlib

import neph_case
from frames import read_exr

BOXES = (((-30, -1, -30), (30, 0, 30)), ((-2, 0, -3), (-1.5, 3, -2.5)), ((0.5, 0, -4), (2, 1, -3)),
         ((-1, 0, -2), (0, 1.5, -1)))
SCENE = """
name: {name}
title: boxes in fog
camera: {{position_m: [0.3, 1.6, 6], look_at_m: [0, 0.8, -2], vertical_fov_deg: 50}}
sun: {{direction: [0.7, 0.5, -0.2], irradiance_w_per_m2: [9, 8, 7]}}
lights: [{{position_m: [1, 2.5, -2], intensity_w_per_sr: [2, 2, 2]}}]
background_w_per_m2_sr: [0.1, 0.2, 0.4]
scattering: {scattering}
media:
  - height_fog:
      layers: [{{extinction_per_m: 0.2, falloff_per_m: 0.5, height_m: 0}}]
      albedo: [0.9, 0.9, 0.9]
solids:
{solids}
"""
FACES = ((1, 5, 7, 3), (2, 4, 8, 6), (1, 2, 6, 5), (3, 7, 8, 4), (1, 3, 4, 2), (5, 6, 8, 7))


def obj_of_boxes():
    lines = []
    for n, (low, high) in enumerate(BOXES):
        for i in range(8):
            lines.append("v " + " ".join(str((low, high)[i >> axis & 1][axis])
                                         for axis in range(3)))
        for face in FACES:
            lines.append("f " + " ".join(str(8 * n + vertex) for vertex in face))
    return "\n".join(lines) + "\n"


def obj_of_ball(rows=6, columns=9):
    """Of radius 1, coarse, with the normals of the ball; the image is twice around it."""
    lines, faces = [], []
    for i in range(rows + 1):
        for j in range(columns + 1):
            polar, around = math.pi * i / rows, 2 * math.pi * j / columns
            at = (math.sin(polar) * math.cos(around), math.cos(polar),
                  math.sin(polar) * math.sin(around))
            lines += ["v {} {} {}".format(*at), "vn {} {} {}".format(*at),
                      f"vt {2 * j / columns} {1 - i / rows}"]
            a, below = i * (columns + 1) + j + 1, (i + 1) * (columns + 1) + j + 1
            if i < rows and j < columns:
                faces += [(a, a + 1, below + 1)] * (i > 0)
                faces += [(a, below + 1, below)] * (i < rows - 1)
    return "\n".join(lines + ["f " + " ".join(f"{n}/{n}/{n}" for n in face)
                              for face in faces]) + "\n"


CORNERS = ((-1, 0), (1, 0), (1, 2), (-1, 2))  # x, y; u and v are 0 or 1


def obj_of_quad(right=1):
    """(u, v) = (0, 0) is the lower left corner."""
    lines = [f"v {min(x, right)} {y} 0" for x, y in CORNERS]
    lines += ["vt 0 0", "vt 1 0", "vt 1 1", "vt 0 1"]
    return "\n".join(lines + ["f 1/1 2/2 3/3 4/4"]) + "\n"


def gltf_of_quad():
    """(u, v) = (0, 0) is the upper left corner."""
    uv = ((0, 1), (1, 1), (1, 0), (0, 0))
    data = (b"".join(struct.pack("<3f", x, y, 0) for x, y in CORNERS) +
            b"".join(struct.pack("<2f", *pair) for pair in uv) +
            struct.pack("<6H", 0, 1, 2, 0, 2, 3))
    views = [{"buffer": 0, "byteOffset": at, "byteLength": size}
             for at, size in ((0, 48), (48, 32), (80, 12))]
    accessors = [{"bufferView": i, "componentType": kind, "count": count, "type": name}
                 for i, (kind, count, name) in enumerate(
                     ((5126, 4, "VEC3"), (5126, 4, "VEC2"), (5123, 6, "SCALAR")))]
    accessors[0].update(min=[-1, 0, 0], max=[1, 2, 0])
    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    primitive = {"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2}
    return json.dumps({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
                       "nodes": [{"mesh": 0}], "meshes": [{"primitives": [primitive]}],
                       "buffers": [{"uri": uri, "byteLength": len(data)}], "bufferViews": views,
                       "accessors": accessors})


def png(rows):
    """8-bit RGB or RGBA."""
    def chunk(kind, data):
        return (struct.pack(">I", len(data)) + kind + data +
                struct.pack(">I", zlib.crc32(kind + data)))
    lines = b"".join(b"\0" + bytes(value for pixel in row for value in pixel) for row in rows)
    header = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8,
                         2 if len(rows[0][0]) == 3 else 6, 0, 0, 0)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) +
            chunk(b"IDAT", zlib.compress(lines)) + chunk(b"IEND", b""))


@unittest.skipUnless(pathlib.Path(neph_case.NEPH).with_name("neph-mesh").exists(),
                     "neph was built without Assimp")
class Meshes(neph_case.NephCase):
    in_folder = True

    def setUp(self):
        super().setUp()
        self.put("boxes.obj", obj_of_boxes())

    def put_scene(self, name, solids, scattering="single"):
        self.put(f"{name}.yaml", SCENE.format(name=name, solids=solids, scattering=scattering))
        return f"{name}.yaml"

    def put_both(self):
        albedo = "albedo: [0.5, 0.4, 0.3]"
        self.put_scene("boxes", "\n".join(f"  - box: {{min_m: {list(low)}, max_m: {list(high)}, "
                                          f"{albedo}}}" for low, high in BOXES))
        self.put_scene("mesh", f"  - mesh: {{file: boxes.obj, {albedo}}}")

    def render(self, name, *words):
        done = self.neph("render", f"{name}.yaml", *words, "--size", "48x27", "-q", "-o", name)
        return read_exr(self.folder / done.stdout.strip())[2]

    def test_a_mesh_of_boxes_is_rendered_as_the_boxes(self):
        self.put_both()
        boxes, mesh = (self.render(name, "-e", "exact") for name in ("boxes", "mesh"))
        for channel in ("R", "G", "B", "volume.R", "transmittance.G", "Z"):
            for a, b in zip(boxes[channel], mesh[channel]):
                self.assertAlmostEqual(a, b, delta=1e-6 * abs(a) if a < 1e9 else 0)

    def test_devices_render_a_mesh_of_boxes_as_the_boxes(self):
        """Both have rays with the same random numbers; distances differ by rounding of float32,
        and so does their light."""
        self.put_both()
        for engine, words in (("march", ()), ("realtime", ()),
                              ("tracer", ("--set", "samples=4"))):
            boxes, mesh = (self.render(name, "-e", engine, *words, "--seed", "7")
                           for name in ("boxes", "mesh"))
            for channel in ("R", "G", "B", "Z"):
                largest = max(a for a in boxes[channel] if a < 1e9)
                for a, b in zip(boxes[channel], mesh[channel]):
                    self.assertAlmostEqual(a, b, delta=1e-5 * largest if a < 1e9 else 0)

    def assert_same(self, a, b, relative):
        for channel in ("R", "G", "B", "Z"):
            largest = max(value for value in a[channel] if value < 1e9)
            for x, y in zip(a[channel], b[channel]):
                self.assertAlmostEqual(x, y, delta=relative * largest if x < 1e9 else 0)

    def test_devices_render_materials_as_the_exact_engine(self):
        """A smooth ball with a texture, and a quad that is cut out. A point has an error of 1e-6 m,
        and the ball's colour changes by all of its range within 0.2 m, so by 5e-6; 2e-5 is for
        grazing angles, at which points have larger errors."""
        draw = random.Random(5)
        self.put("ball.obj", obj_of_ball())
        self.put("quad.obj", obj_of_quad())
        (self.folder / "noise.png").write_bytes(
            png([[tuple(draw.randrange(256) for _ in range(3)) for _ in range(7)]
                 for _ in range(5)]))
        (self.folder / "holes.png").write_bytes(
            png([[(255, 200, 100, 255 * ((x + y) % 2)) for x in range(6)] for y in range(4)]))
        self.put_scene("looks", "  - box: {min_m: [-9, -1, -9], max_m: [9, 0, 9], "
                                "albedo: [0.5, 0.5, 0.5]}\n"
                                "  - mesh: {file: ball.obj, shading: smooth, "
                                "albedo_texture: noise.png, position_m: [1, 1, 0], "
                                "albedo: [0.9, 0.8, 0.7]}\n"
                                "  - mesh: {file: quad.obj, albedo_texture: holes.png, "
                                "alpha: cutout, turn_deg: 20, position_m: [-1, 0.5, -1], "
                                "albedo: [0.9, 0.8, 0.7]}",
                       scattering="none")
        exact = self.render("looks", "-e", "exact")
        for engine, words in (("march", ()), ("tracer", ("--set", "samples=2"))):
            self.assert_same(exact, self.render("looks", "-e", engine, *words), 2e-5)

    def test_devices_render_a_cut_out_as_the_mesh_of_the_rest(self):
        """Shadows in the fog, too: rays have the same random numbers."""
        self.put("quad.obj", obj_of_quad())
        self.put("rest.obj", obj_of_quad(right=0))
        (self.folder / "half.png").write_bytes(
            png([[(255, 255, 255, 255 * (x < 4)) for x in range(8)]]))
        end = "position_m: [0, 0.2, -1], albedo: [0.9, 0.8, 0.7]}"
        self.put_scene("cut", "  - mesh: {file: quad.obj, albedo_texture: half.png, alpha: cutout, "
                              f"{end}")
        self.put_scene("rest", f"  - mesh: {{file: rest.obj, {end}")
        for engine, words in (("march", ()), ("realtime", ()),
                              ("tracer", ("--set", "samples=4"))):
            cut, rest = (self.render(name, "-e", engine, *words, "--seed", "7")
                         for name in ("cut", "rest"))
            self.assert_same(cut, rest, 1e-5)
        self.put_scene("covered", "  - mesh: {file: quad.obj, albedo_texture: half.png, "
                                  f"alpha: coverage, {end}")
        self.neph("render", "covered.yaml", "-e", "exact", "--size", "8x8", "-o", "no", code=None,
                  said="alpha as coverage")

    def test_engines_say_what_they_have(self):
        self.put_both()
        document = self.neph("scenes", "mesh.yaml").stdout
        self.assertIn("mesh 0      48 triangles, closed; left out for having no area: 0", document)
        mesh = self.json("scenes", "mesh.yaml")["meshes"][0]
        self.assertEqual(mesh, {"triangles": 48, "left_out": 0, "inside": "closed"})
        self.render("mesh", "-e", "oracle", "--set", "samples=2")

    def test_devices_render_a_mesh_that_moves(self):
        """The march and `realtime` are compared with boxes that move in test_gpu_meshes.c."""
        motion = ("motion: {keys: [{frame: 0}, {frame: 1, move_m: [1, 0.5, 0]}]}",
                  "position_m: [1, 0.5, 0]", "position_m: [0, 0, 0]")
        for engine, without, words in (
                ("tracer", "#", ("--set", "samples=4", "--seed", "7")),
                ("fog_look", "lights:", ())):
            for name, key in zip(("moving", "there", "here"), motion):
                path = self.folder / self.put_scene(
                    name, f"  - mesh: {{file: boxes.obj, albedo: [0.5, 0.4, 0.3], {key}}}")
                lines = [line for line in path.read_text().split("\n")
                         if not line.startswith(without)]
                path.write_text("\n".join(lines + [
                    "frames: {count: 2}",
                    "fog_look: {inscattering_w_per_m2_sr: [0.1, 0.1, 0.1]}"]))
            moving = self.render("moving", "-e", engine, *words, "--frame", "1")
            there, here = (self.render(name, "-e", engine, *words) for name in ("there", "here"))
            self.assert_same(moving, there, 1e-5)
            self.assertGreater(sum(a != b for a, b in zip(moving["Z"], here["Z"])), 100)

    def test_refused_files(self):
        self.put("text.ply", "no mesh")
        line = SCENE[:SCENE.index("{solids}")].count("\n") + 1
        for words, said in (("file: none.obj", "none.obj"), ("file: text.ply", "text.ply"),
                            ("file: boxes.obj, object: roof", "roof")):
            self.put_scene("bad", f"  - mesh: {{{words}, albedo: [0, 0, 0]}}")
            done = self.neph("scenes", "bad.yaml", code=None, silent=True)
            self.assertIn(done.returncode, (65, 66), done.stderr)
            self.assertIn(said, done.stderr)
            self.assertIn(f"bad.yaml:{line}:", done.stderr)

    def test_textures_of_obj_and_gltf_are_upright(self):
        """Red at the top, blue at the bottom, and of the same pixels in both formats."""
        self.put("quad.obj", obj_of_quad())
        self.put("quad.gltf", gltf_of_quad())
        (self.folder / "flag.png").write_bytes(png([[(255, 0, 0)], [(0, 0, 0)], [(0, 0, 255)]]))
        frames = []
        for kind in ("obj", "gltf"):
            self.put_scene(kind, f"  - mesh: {{file: quad.{kind}, albedo_texture: flag.png, "
                                 "position_m: [0, 0, -3], "
                                 "albedo: [1, 1, 1]}", scattering="none")
            frames.append(self.render(kind, "-e", "exact"))
        for channel in ("R", "G", "B", "Z"):
            for a, b in zip(frames[0][channel], frames[1][channel]):
                self.assertAlmostEqual(a, b, delta=1e-6 * abs(a) if a < 1e9 else 0)
        rows = [{c: frames[0][c][y * 48 + 24] for c in "RBZ"} for y in range(27)]
        rows = [row for row in rows if row["Z"] < 100]
        self.assertGreater(len(rows), 5)
        self.assertGreater(rows[1]["R"], 2 * rows[1]["B"])
        self.assertGreater(rows[-2]["B"], 2 * rows[-2]["R"])

    def test_a_missing_reader_is_named(self):
        self.put_both()
        self.neph("scenes", "mesh.yaml", silent=True, code=69, NEPH_MESH="/nowhere/neph-mesh",
                  said=("/nowhere/neph-mesh", "apt-get install libassimp-dev"))


if __name__ == "__main__":
    unittest.main()
