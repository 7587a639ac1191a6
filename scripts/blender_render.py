# SPDX-License-Identifier: MIT
"""The Blender side of the cycles engine: read a JSON spec, build a Blender scene per pass, render.

Run inside an empty folder as
    blender -b --factory-startup --python-exit-code 7 --python blender_render.py -- spec.json
It writes <pass>.exr for every pass of the spec, about.json (what this Blender has) and timing.json.
With a second argument `--save NAME.blend` it saves the scenes for a person to open and renders
nothing.

Written for Blender 3.4, 4.3 and 5.2. Where they differ it looks for the property or the choice that
only some of them have, and never for a number of a version. Every setting is read back: Blender
takes an unknown name, or cuts a value, without a word.

The spec comes from harness/engines/cycles_spec.c. It is data: its strings are compared with the
words known here and are never executed, imported or used as a path.

Laws of Cycles that this file relies on, all measured (tests/harness/test_cycles.c):
- World (x, y, z) is Blender's (x, -z, y).
- A closure whose weight is below 1e-5 per Blender unit is dropped: thin air would not scatter. So
  a unit is not a metre but `unit_m`, chosen by cycles_spec.c to make numbers large; the origin is
  at `origin_m`, the camera, where single precision is finest. Radiances do not change with either.
- VolumeScatter(color c, density s) has sigma_s = c s and no absorption; VolumeAbsorption(c, s) has
  sigma_a = (1 - c) s. With c = albedo and s = sigma_t their sum is a grey medium.
- Phase functions in one place are summed by their nodes' weights, mean over the colours; in 3.4
  direct light meets the plain sum, for two lobes 1.5 to 3 times too bright.
- Where extinction has colour, distances are drawn for one channel and weighed by the product over
  the steps of the mean transmittance of the channels, which is not the mean of the products: in
  uneven media scattering came out 10 % too low and the background 11 % too bright. So such media
  are rendered channel by channel.
- A volume file's voxels are trilinear between the places half a voxel beyond what OpenVDB means,
  clipped to the active ones; cycles_frame.c writes files that undo both (NEPH_VDB_BLENDER).
- Emission(color c, strength s) of a volume adds c s of radiance per unit, exactly within each step.
  Seen by a camera ray it goes to the pass Emit, met by a later ray of a path to the pass of what
  that ray left, and is met even where bounces are at their end. So where light is to be scattered
  once or not at all, emission has a picture of its own, of media that only absorb.
- A sun of angle 0 and energy E gives the irradiance E across its direction.
- A point or spot light of radius 0 and power P has the radiant intensity P / (4 pi). Of a spot it
  falls as smoothstep(cos outer, cos inner, cos), `spot_blend` being the part of 1 - cos outer; in
  3.4 times the cosine. There its nodes divide by the cosine, the Z of its normal in its own axes.
- From 5.0 on a heterogeneous volume is drawn without steps and without bias (null scattering),
  unless `volume_biased` is on; then, and in all versions before, as follows. Images of one sample
  (transmittance, emission) are always marched: without steps one sample is 0 or 1.
- A ray through a heterogeneous volume takes steps of 0.1 * mean edge of the bounding box *
  step rate of the scene * step rate of the material. A ray that would need more than
  volume_max_steps takes longer ones, and loses half a step at its end.
- A ray that scatters at sample 0 writes no depth, so depth has a pass of its own without media.
- volume_bounces = N allows N + 1 scattering events.
"""

import array
import functools
import json
import math
import os
import re
import sys
import time

import bpy
from mathutils import Matrix, Vector

FORMAT = 8  # of the spec; raised together with cycles_spec.c

# The largest that Blender takes. The furnace reads 1.00000 with it (0.967 with Cycles' default of
# 12) at optical depths of 16; some of the light that leaves a medium of 64 has scattered more
# often.
ALL_BOUNCES = 1024
CLIP_START = 1e-6  # Blender units; what is nearer is clipped, media included
CLIP_END = 1e9
FAR_UNITS = 1e9  # so far solids hide where there is no limit
# More steps are not better: their transmittances are multiplied in single precision, and a step of
# optical depth below 6e-8 is lost. Measured at 16384: 5e-5 rms, 3e-4 at most.
STEPS_MAX = 16384

# Only what makes the image physical and reproducible; the reason for each is its bad default.
CYCLES_SETTINGS = {
    "device": "CPU",
    "use_adaptive_sampling": False,
    "use_denoising": False,
    "use_animated_seed": False,
    "sample_clamp_direct": 0.0,
    "sample_clamp_indirect": 0.0,
    "light_sampling_threshold": 0.0,
    "blur_glossy": 0.0,
    "caustics_reflective": False,
    "caustics_refractive": False,
    "film_exposure": 1.0,
    "volume_max_steps": STEPS_MAX,
    # The narrowest filter there is. Sample 0 lies exactly in the pixel centre, the others within
    # 0.005 px of it, but for 0.13 % that an off-by-one in Cycles' table throws up to 0.48 px off.
    "pixel_filter_type": "BLACKMAN_HARRIS",
    "filter_width": 0.01,
    "max_bounces": ALL_BOUNCES,
    "glossy_bounces": 0,
    "transmission_bounces": 0,
    "transparent_max_bounces": ALL_BOUNCES,
    "min_light_bounces": ALL_BOUNCES,  # no Russian roulette before
    "min_transparent_bounces": ALL_BOUNCES,
}


# -- Versions --------------------------------------------------------------------------------------


def has(thing, name: str) -> bool:
    return name in thing.bl_rna.properties


def choices(thing, name: str) -> list[str]:
    """Of a property that is a choice; without it there are none."""
    return [item.identifier for item in thing.bl_rna.properties[name].enum_items] if has(
        thing, name) else []


def put(thing, name: str, value) -> None:
    """Set a property that must be there and must keep the value."""
    if not has(thing, name):
        raise AttributeError(f"Blender {bpy.app.version_string} has no setting '{name}' of "
                             f"{thing.bl_rna.identifier}")
    setattr(thing, name, value)
    kept = getattr(thing, name)
    if isinstance(value, float):
        is_kept = abs(kept - value) <= 1e-6 * abs(value)
    else:
        is_kept = kept == value
    if not is_kept:
        raise ValueError(f"Blender {bpy.app.version_string} made {kept} of '{name}' = {value}")


def stored_settings(material):
    """The material's settings of Cycles as they are stored, without the properties' ranges."""
    if hasattr(material, "bl_system_properties_get"):
        return material.bl_system_properties_get(do_create=True)["cycles"]
    return material["cycles"]


def volume_phases() -> list[str]:
    """The phase functions that a volume's node has; up to Blender 4.2 it has no choice."""
    material = bpy.data.materials.new("phases")
    node = Nodes(material).add("ShaderNodeVolumeScatter")
    words = choices(node, "phase") or ["HENYEY_GREENSTEIN"]
    bpy.data.materials.remove(material)
    return words


def spot_cosine():
    """Whether a spot's light falls with the cosine, too; None: not measured in this version. No
    property tells."""
    return True if bpy.app.version[:2] == (3, 4) else False if bpy.app.version >= (4, 3) else None


def about() -> dict:
    """What this Blender has, for harness/engines/cycles_probe.c."""
    return {
        "version": list(bpy.app.version),
        "has_unbiased": has(bpy.context.scene.cycles, "volume_biased"),
        "phases": volume_phases(),
        "has_spots": spot_cosine() is not None,
    }


def file_root() -> str:
    """The folder of the files beside the spec; for a saved scene relative to it."""
    return "//" if "--save" in sys.argv else os.getcwd()


def axes_to_blender(v) -> Vector:
    """World axes to Blender's."""
    return Vector((v[0], -v[2], v[1]))


class Units:
    """Metres to Blender units; the differences are taken in double precision."""

    def __init__(self, spec: dict):
        self.unit_m, self.origin_m = spec["unit_m"], spec["origin_m"]

    def point(self, p_m) -> Vector:
        return axes_to_blender([(a - b) / self.unit_m for a, b in zip(p_m, self.origin_m)])

    def length(self, length_m: float) -> float:
        return length_m / self.unit_m

    def per_length(self, value_per_m: float) -> float:
        return value_per_m * self.unit_m


def split_color(rgb) -> tuple[float, tuple[float, float, float]]:
    """A colour as its largest channel times a colour within 0..1."""
    largest = max(rgb)
    if largest <= 0.0:
        return 0.0, (0.0, 0.0, 0.0)
    return largest, tuple(channel / largest for channel in rgb)


# -- Shaders ---------------------------------------------------------------------------------------


class Nodes:
    """The node tree of a new material or world, and the few ways we wire it."""

    def __init__(self, owner):
        owner.use_nodes = True
        self.tree = owner.node_tree
        self.tree.nodes.clear()

    def add(self, kind: str, **inputs):
        node = self.tree.nodes.new(kind)
        for name, value in inputs.items():
            self.set(node, name, value)
        return node

    def set(self, node, name: str, value) -> None:
        """Link an output socket, or set a number or a colour."""
        socket = node.inputs[name]
        if isinstance(value, bpy.types.NodeSocket):
            self.tree.links.new(value, socket)
        elif isinstance(value, (tuple, list)):
            socket.default_value = (*value, 1.0)
        else:
            socket.default_value = value

    def math(self, operation: str, a, b=None):
        node = self.tree.nodes.new("ShaderNodeMath")
        node.operation = operation
        for socket, value in zip(node.inputs, (a, b)):
            if isinstance(value, bpy.types.NodeSocket):
                self.tree.links.new(value, socket)
            elif value is not None:
                socket.default_value = value
        return node.outputs[0]


def fog_density(nodes: Nodes, layers: list[dict], scale: float, medium: dict, units: Units):
    """Extinction per unit: a number, or the socket of sum_i bottom_i exp(-falloff_i (y - bottom)).

    The bottom is that of the container, so that every exponential lies in 0..1.
    """
    if all(layer["falloff_per_m"] == 0.0 for layer in layers):
        return units.per_length(scale * sum(layer["bottom_per_m"] for layer in layers))
    position = nodes.add("ShaderNodeNewGeometry").outputs["Position"]
    height = nodes.add("ShaderNodeSeparateXYZ", Vector=position).outputs["Z"]
    above = nodes.math("SUBTRACT", height, units.point((0.0, medium["bottom_m"], 0.0)).z)
    total = None
    for layer in layers:
        exponent = nodes.math("MULTIPLY", above, -units.per_length(layer["falloff_per_m"]))
        bottom = units.per_length(scale * layer["bottom_per_m"])
        density = nodes.math("MULTIPLY", nodes.math("EXPONENT", exponent), bottom)
        total = density if total is None else nodes.math("ADD", total, density)
    return total


def grid_density(nodes: Nodes, grid: dict, scale: float, units: Units):
    """Extinction per unit: the socket of the voxels' density times that of density 1."""
    voxels = nodes.add("ShaderNodeAttribute")
    voxels.attribute_name = "density"
    return nodes.math("MULTIPLY", voxels.outputs["Fac"],
                      units.per_length(scale * grid["extinction_per_m"]))


def add_shaders(nodes: Nodes, a, b):
    both = nodes.add("ShaderNodeAddShader")
    nodes.tree.links.new(a, both.inputs[0])
    nodes.tree.links.new(b, both.inputs[1])
    return both.outputs[0]


def add_emission(nodes: Nodes, shader, emission, density):
    """The shader with emission * density added to it."""
    strength, color = split_color(emission)
    emitter = nodes.add("ShaderNodeEmission", Color=color,
                        Strength=nodes.math("MULTIPLY", density, strength))
    return add_shaders(nodes, shader, emitter.outputs[0])


# The inputs of a node Volume Scatter for each of its phase functions.
PHASE_INPUTS = {"HENYEY_GREENSTEIN": {"Anisotropy"}, "RAYLEIGH": set(),
                "DRAINE": {"Anisotropy", "Alpha"}, "MIE": {"Diameter"}}


def scatter_node(nodes: Nodes, lobe: dict, color, density):
    """Scattering with one phase function."""
    if PHASE_INPUTS.get(lobe["phase"]) != set(lobe["inputs"]):
        raise ValueError("unknown phase function")
    color = tuple(lobe["share"] * c for c in color)
    scatter = nodes.add("ShaderNodeVolumeScatter", Color=color, Density=density)
    if has(scatter, "phase"):
        put(scatter, "phase", lobe["phase"])
    elif lobe["phase"] != "HENYEY_GREENSTEIN":
        raise ValueError(f"Blender {bpy.app.version_string} has one phase function only")
    for name, value in lobe["inputs"].items():
        nodes.set(scatter, name, value)
        kept = scatter.inputs[name].default_value
        if abs(kept - value) > 1e-6 * abs(value):
            raise ValueError(f"Blender {bpy.app.version_string} made {kept} of '{name}' = {value}")
    return scatter


def medium_material(medium: dict, color, emission, scatters: bool, units: Units):
    """sigma_t = color * density and sigma_s = albedo * sigma_t, where the densities of the two
    nodes stand for the brightest channel and their colours are within 0..1. The emission is per
    sigma_t of that channel; None: there is none."""
    material = bpy.data.materials.new("medium")
    nodes = Nodes(material)
    scale, color = split_color(color)
    if "grid" in medium:
        density = grid_density(nodes, medium["grid"], scale, units)
        material.cycles.volume_interpolation = "LINEAR"
    else:
        density = fog_density(nodes, medium["layers"], scale, medium, units)
    albedo = medium["albedo"] if scatters else (0.0, 0.0, 0.0)
    scattering = tuple(a * c for a, c in zip(albedo, color))
    passed = tuple(1.0 - (c - s) for c, s in zip(color, scattering))
    shader = nodes.add("ShaderNodeVolumeAbsorption", Color=passed, Density=density).outputs[0]
    for lobe in medium["lobes"] if max(scattering) > 0.0 else []:
        scatter = scatter_node(nodes, lobe, scattering, density)
        shader = add_shaders(nodes, shader, scatter.outputs[0])
    if emission is not None:
        shader = add_emission(nodes, shader, [e * c for e, c in zip(emission, color)], density)
    output = nodes.add("ShaderNodeOutputMaterial")
    nodes.tree.links.new(shader, output.inputs["Volume"])
    return material


def set_step(material, medium: dict, step_m: float) -> None:
    """Written past the property, which stops at 0.001 (a step of 14 m in a box of 100 km)."""
    edges_m = [b - a for a, b in zip(medium["min_m"], medium["max_m"])]
    if medium["turn"]:  # the edges of the box around it, which the axis keeps or lengthens
        axis, cosine, sine = medium["turn"]
        edges_m = [edge if k == axis else edge * (abs(cosine) + abs(sine))
                   for k, edge in enumerate(edges_m)]
    rate = step_m / (0.1 * sum(edges_m) / 3.0)
    material.cycles.volume_step_rate = 1.0
    stored_settings(material)["volume_step_rate"] = rate
    if abs(material.cycles.volume_step_rate - rate) > 1e-6 * rate:
        raise ValueError(f"Blender {bpy.app.version_string} keeps no step rate of {rate}")


def picture_of(texture: dict):
    """The values of a pattern, as the pixels of a picture that is beside itself on all sides."""
    side = texture["side"]
    picture = bpy.data.images.new("texture", side, side, float_buffer=True, is_data=True)
    picture.pixels = [c for value in texture["pixels"] for c in (value, value, value, 1.0)]
    picture.pack()
    return picture


def base_color(nodes: Nodes, albedo, texture: dict):
    """A colour, or the socket of a mix of two."""
    if texture is None:
        return albedo
    values = nodes.add("ShaderNodeTexImage")
    values.image = picture_of(texture)
    values.interpolation = "Linear" if texture["is_smooth"] else "Closest"
    values.extension = "REPEAT"
    mix = nodes.add("ShaderNodeMixRGB", Fac=values.outputs["Color"], Color1=albedo,
                    Color2=tuple(texture["other"]))
    return mix.outputs["Color"]


@functools.cache
def image_of(name: str, width: int, height: int):
    """Linear values from a file beside the spec."""
    if not re.fullmatch(r"texture[0-9]+\.bin", name):
        raise ValueError("unknown name of a texture")
    values = array.array("f")
    with open(name, "rb") as file:
        values.frombytes(file.read())
    image = bpy.data.images.new("texture", width, height, alpha=True, float_buffer=True,
                                is_data=True)
    put(image, "alpha_mode", "CHANNEL_PACKED")
    image.pixels.foreach_set(values)
    image.pack()
    return image


def texture_node(nodes: Nodes, texture: dict):
    """Bilinear and repeated, at the uv of the mesh."""
    node = nodes.add("ShaderNodeTexImage")
    node.image = image_of(texture["file"], texture["width_px"], texture["height_px"])
    node.interpolation, node.extension = "Linear", "REPEAT"
    return node


def cut_out(nodes: Nodes, shader, texture: dict, is_light: bool):
    """The shader where alpha is at least 1/2, else nothing; or a mix of both by alpha, unless the
    pass is of the parts of 1/2 and more."""
    if texture is None or texture["alpha"] == "ignored":
        return shader
    alpha = texture_node(nodes, texture).outputs["Alpha"]
    if texture["alpha"] == "coverage" and not is_light:
        is_hole = nodes.math("SUBTRACT", 1.0, alpha)
    else:
        is_hole = nodes.math("LESS_THAN", alpha, 0.5)
    hole = nodes.add("ShaderNodeBsdfTransparent", Color=(1.0, 1.0, 1.0))
    both = nodes.add("ShaderNodeMixShader", Fac=is_hole)
    nodes.tree.links.new(shader, both.inputs[1])
    nodes.tree.links.new(hole.outputs[0], both.inputs[2])
    return both.outputs[0]


def surface_shader(nodes: Nodes, albedo, surface: dict, texture: dict):
    """Lambertian, or metal in part. A GlossyBsdf squares its roughness, has no Fresnel term and the
    shadowing of scenes/surface.h. The texture of a mesh is times the albedo."""
    color = albedo
    if texture is not None:
        node = nodes.add("ShaderNodeMixRGB", Fac=1.0, Color2=albedo,
                         Color1=texture_node(nodes, texture).outputs["Color"])
        node.blend_type = "MULTIPLY"
        color = node.outputs["Color"]
    if surface is None:
        return nodes.add("ShaderNodeBsdfDiffuse", Color=color, Roughness=0.0).outputs[0]
    if texture is None:
        color = base_color(nodes, albedo, surface["texture"])
    diffuse = nodes.add("ShaderNodeBsdfDiffuse", Color=color, Roughness=0.0).outputs[0]
    metalness, roughness = surface["metalness"], surface["roughness"]
    if metalness == 0.0:
        return diffuse
    metal = nodes.add("ShaderNodeBsdfGlossy", Color=color, Roughness=roughness)
    metal.distribution = "GGX" if roughness > 0.0 else "SHARP"
    both = nodes.add("ShaderNodeMixShader", Fac=metalness)
    nodes.tree.links.new(diffuse, both.inputs[1])
    nodes.tree.links.new(metal.outputs[0], both.inputs[2])
    return both.outputs[0]


@functools.cache
def solid_material(look: str, is_light: bool):
    """Of the solids whose albedo, surface and texture these are, as JSON; or, in the transmittance
    pass, glowing with radiance 1."""
    material = bpy.data.materials.new("solid")
    nodes = Nodes(material)
    albedo, surface, texture = json.loads(look)
    if is_light:
        shader = nodes.add("ShaderNodeEmission", Color=(1.0, 1.0, 1.0), Strength=1.0).outputs[0]
        # It is seen and lights nothing.
        if has(material.cycles, "emission_sampling"):
            put(material.cycles, "emission_sampling", "NONE")
        else:
            put(material.cycles, "sample_as_light", False)
    else:
        shader = surface_shader(nodes, tuple(albedo), surface, texture)
    shader = cut_out(nodes, shader, texture, is_light)
    output = nodes.add("ShaderNodeOutputMaterial")
    nodes.tree.links.new(shader, output.inputs["Surface"])
    return material


def make_world(scene, radiance_rgb, lights_scene: bool) -> None:
    world = bpy.data.worlds.new("world")
    scene.world = world
    nodes = Nodes(world)
    strength, color = split_color(radiance_rgb)
    background = nodes.add("ShaderNodeBackground", Color=color, Strength=strength)
    output = nodes.add("ShaderNodeOutputWorld")
    nodes.tree.links.new(background.outputs[0], output.inputs["Surface"])
    for kind in ("diffuse", "glossy", "transmission", "scatter"):
        setattr(world.cycles_visibility, kind, lights_scene)
    if not lights_scene:
        world.cycles.sampling_method = "NONE"


# -- Objects ---------------------------------------------------------------------------------------


def add_object(scene, name: str, data):
    thing = bpy.data.objects.new(name, data)
    scene.collection.objects.link(thing)
    return thing


def turned(place, middle, turn):
    """About an axis of our world, whose y is Blender's z and whose z is Blender's -y."""
    axis, cosine, sine = turn
    x, y, z = (a - b for a, b in zip(place, middle))
    if axis == 0:
        way = (x, cosine * y - sine * z, sine * y + cosine * z)
    elif axis == 1:
        way = (cosine * x - sine * y, sine * x + cosine * y, z)
    else:
        way = (cosine * x - sine * z, y, sine * x + cosine * z)
    return tuple(a + b for a, b in zip(middle, way))


def box_mesh(lo_m, hi_m, material, units: Units, turn=None):
    a, b = units.point(lo_m), units.point(hi_m)
    x, y, z = (sorted(pair) for pair in zip(a, b))
    corners = [(p, q, r) for r in z for q in y for p in x]
    if turn:
        middle = tuple(0.5 * (p + q) for p, q in zip(a, b))
        corners = [turned(corner, middle, turn) for corner in corners]
    faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    mesh = bpy.data.meshes.new("box")
    mesh.from_pydata(corners, [], faces)
    mesh.materials.append(material)
    return mesh


def paint_faces(mesh, solid: dict) -> None:
    """Coordinates of its texture: in each face the two of (x, y, z) that lie in it, in this order,
    from the middle of the box, in cells. Pixels of noise have their middles at whole cells."""
    texture = solid["surface"]["texture"]
    half_m = [0.5 * (b - a) for a, b in zip(solid["min_m"], solid["max_m"])]
    shift = 0.5 if texture["is_smooth"] else 0.0
    layer = mesh.uv_layers.new()
    for face in mesh.polygons:
        across = (1, 2, 0)[face.index // 2]  # as box_mesh() lists its faces
        for loop in face.loop_indices:
            corner = mesh.loops[loop].vertex_index  # bits 0, 1, 2: high along x, -z, y
            signs = [1 if corner & 1 else -1, 1 if corner & 4 else -1, -1 if corner & 2 else 1]
            flat_m = [signs[k] * half_m[k] for k in range(3) if k != across]
            layer.data[loop].uv = [(m / texture["cell_m"] + shift) / texture["side"]
                                   for m in flat_m]


@functools.cache
def sphere_mesh(segments: int, look: str, is_light: bool):
    """A UV sphere of radius 1 with smooth normals: `segments` meridians, half as many rings.
    Spheres that look alike share it, so that Cycles keeps it in memory once."""
    rings = segments // 2
    vertices = [(0.0, 0.0, 1.0)]
    for i in range(1, rings):
        theta = math.pi * i / rings
        for j in range(segments):
            phi = 2.0 * math.pi * j / segments
            flat = math.sin(theta)
            vertices.append((flat * math.cos(phi), flat * math.sin(phi), math.cos(theta)))
    vertices.append((0.0, 0.0, -1.0))
    last = len(vertices) - 1
    faces = []
    for j in range(segments):
        k = (j + 1) % segments
        faces.append((0, 1 + j, 1 + k))
        for i in range(rings - 2):
            row, below = 1 + i * segments, 1 + (i + 1) * segments
            faces.append((row + j, below + j, below + k, row + k))
        row = 1 + (rings - 2) * segments
        faces.append((row + j, last, row + k))
    mesh = bpy.data.meshes.new("sphere")
    mesh.from_pydata(vertices, [], faces)
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    mesh.materials.append(solid_material(look, is_light))
    return mesh


def take_array(kind: str, data: bytes, at: int, count: int) -> array.array:
    values = array.array(kind)
    values.frombytes(data[4 * at:4 * (at + count)])
    return values


def smooth_mesh(mesh, normals) -> None:
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    if has(mesh, "use_auto_smooth"):  # up to 4.0; else normals of one's own are always used
        put(mesh, "use_auto_smooth", True)
    mesh.normals_split_custom_set_from_vertices(list(zip(*[iter(normals)] * 3)))


@functools.cache
def file_mesh(name: str, vertex_count: int, triangle_count: int, is_smooth: bool, look: str,
              is_light: bool):
    """Triangles from a file beside the spec, in Blender's axes. Solids of one mesh with the same
    material share it, so that Cycles keeps it in memory once; a material of the object, in place of
    the mesh, would prevent that."""
    if not re.fullmatch(r"mesh[0-9]+\.bin", name):
        raise ValueError("unknown name of a mesh")
    with open(name, "rb") as file:
        data = file.read()
    positions = take_array("f", data, 0, 3 * vertex_count)
    at = 3 * (vertex_count + triangle_count)
    indices = take_array("i", data, 3 * vertex_count, 3 * triangle_count)
    mesh = bpy.data.meshes.new("mesh")
    mesh.from_pydata(list(zip(*[iter(positions)] * 3)), [], list(zip(*[iter(indices)] * 3)))
    mesh.materials.append(solid_material(look, is_light))
    if is_smooth:
        smooth_mesh(mesh, take_array("f", data, at, 3 * vertex_count))
        at += 3 * vertex_count
    if json.loads(look)[2] is not None:
        uv = take_array("f", data, at, 2 * vertex_count)
        layer = mesh.uv_layers.new()
        for loop in mesh.loops:
            layer.data[loop.index].uv = uv[2 * loop.vertex_index:2 * loop.vertex_index + 2]
    return mesh


def add_mesh(scene, solid: dict, look: str, is_light: bool, units: Units) -> None:
    """The mesh's unit vectors x, y, z in the world; Blender's are x, -z, y."""
    thing = add_object(scene, "mesh",
                       file_mesh(solid["file"], solid["vertex_count"], solid["triangle_count"],
                                 solid["is_smooth"], look, is_light))
    for name in ("shadow_terminator_geometry_offset", "shadow_terminator_offset"):
        if has(thing.cycles, name):
            put(thing.cycles, name, 0.0)
    x, y, z = (axes_to_blender(axis) / units.unit_m for axis in solid["axes_m"])
    columns = (x, -z, y, units.point(solid["center_m"]))
    thing.matrix_world = Matrix([[column[i] for column in columns] for i in range(3)] +
                                [[0.0, 0.0, 0.0, 1.0]])


def add_solid(scene, solid: dict, is_light: bool, units: Units) -> None:
    look = json.dumps([solid["albedo"], solid["surface"], solid.get("texture")])
    if solid["kind"] == "box":
        material = solid_material(look, is_light)
        mesh = box_mesh(solid["min_m"], solid["max_m"], material, units, solid.get("turn"))
        if solid["surface"] is not None and solid["surface"]["texture"] is not None:
            paint_faces(mesh, solid)
        add_object(scene, "box", mesh)
    elif solid["kind"] == "sphere":
        thing = add_object(scene, "sphere", sphere_mesh(solid["segments"], look, is_light))
        thing.location = units.point(solid["center_m"])
        thing.scale = [units.length(solid["radius_m"])] * 3
    elif solid["kind"] == "mesh":
        add_mesh(scene, solid, look, is_light, units)
    else:
        raise ValueError("unknown kind of solid")


def add_grid(scene, medium: dict, material, step_m: float, units: Units) -> None:
    """The file holds Blender's axes and units, counted from its origin."""
    name = medium["grid"]["file"]
    if not re.fullmatch(r"medium[0-9]+\.vdb", name):
        raise ValueError("unknown name of a grid")
    volume = bpy.data.volumes.new("medium")
    volume.filepath = os.path.join(os.getcwd(), name)
    volume.render.precision = "FULL"
    volume.render.clipping = 0.0
    volume.render.step_size = units.length(step_m)
    if not volume.grids.load():
        raise ValueError(f"Blender cannot load {name}: {volume.grids.error_message}")
    volume.filepath = os.path.join(file_root(), name)
    volume.materials.append(material)
    add_object(scene, "medium", volume)


def grid_step_m(medium: dict, step: float) -> float:
    """No more steps than Cycles takes, on the longest way through."""
    edges_m = [b - a for a, b in zip(medium["min_m"], medium["max_m"])]
    return max(step * medium["feature_m"], math.hypot(*edges_m) / (0.9 * STEPS_MAX))


def add_medium(scene, medium: dict, render_pass: dict, scatters: bool, emits: bool,
               units: Units) -> None:
    color, channel = medium["extinction_color"], render_pass["channel"]
    emission = medium.get("glow_w_per_m2_sr") if emits else None
    if channel is not None:
        color = (color[channel],) * 3
        emission = emission and (emission[channel],) * 3
    material = medium_material(medium, color, emission, scatters, units)
    if "grid" in medium:
        step_m = grid_step_m(medium, render_pass["grid_step"])
        add_grid(scene, medium, material, step_m, units)
        return
    add_object(scene, "medium", box_mesh(medium["min_m"], medium["max_m"], material, units,
                                           medium["turn"]))
    if medium["feature_m"] is not None:
        set_step(material, medium, medium["feature_m"] * render_pass["step"])


def add_sun(scene, sun: dict) -> None:
    light = bpy.data.lights.new("sun", "SUN")
    light.energy, light.color = split_color(sun["irradiance_w_per_m2"])
    light.angle = 0.0
    light.cycles.max_bounces = ALL_BOUNCES
    thing = add_object(scene, "sun", light)
    thing.rotation_mode = "QUATERNION"
    thing.rotation_quaternion = axes_to_blender(sun["direction"]).to_track_quat("Z", "Y")


def add_lamp(scene, lamp: dict, units: Units) -> None:
    """A point, or a spot: Blender shines it along its -Z."""
    cone = lamp["cone"]
    light = bpy.data.lights.new("lamp", "SPOT" if cone else "POINT")
    energy, light.color = split_color(lamp["intensity_w_per_sr"])
    light.energy = energy * 4.0 * math.pi / units.unit_m**2
    light.shadow_soft_size = 0.0
    light.cycles.max_bounces = ALL_BOUNCES
    thing = add_object(scene, "lamp", light)
    thing.location = units.point(lamp["position_m"])
    if cone:
        outer, inner = cone["outer_cosine"], cone["inner_cosine"]
        light.spot_size = 2.0 * math.acos(outer)
        light.spot_blend = (inner - outer) / (1.0 - outer)
        thing.rotation_mode = "QUATERNION"
        thing.rotation_quaternion = axes_to_blender(cone["axis"]).to_track_quat("-Z", "Y")
        if spot_cosine():
            divide_by_cosine(light)


def divide_by_cosine(light) -> None:
    nodes = Nodes(light)
    normal = nodes.add("ShaderNodeTexCoord").outputs["Normal"]
    along = nodes.add("ShaderNodeSeparateXYZ", Vector=normal).outputs["Z"]
    cosine = nodes.math("ABSOLUTE", along)
    emitter = nodes.add("ShaderNodeEmission", Color=(1.0, 1.0, 1.0),
                        Strength=nodes.math("DIVIDE", 1.0, cosine))
    output = nodes.add("ShaderNodeOutputLight")
    nodes.tree.links.new(emitter.outputs[0], output.inputs["Surface"])


def add_camera(scene, camera: dict, units: Units) -> None:
    data = bpy.data.cameras.new("camera")
    data.sensor_fit = "VERTICAL"
    data.sensor_height = 24.0
    if "orthographic_height_m" in camera:
        data.type = "ORTHO"
        data.ortho_scale = units.length(camera["orthographic_height_m"])  # of the sensor's fit
    else:
        data.lens = 12.0 / math.tan(camera["vertical_fov_rad"] / 2.0)
    data.clip_start, data.clip_end = CLIP_START, CLIP_END
    thing = add_object(scene, "camera", data)
    right, up, forward = (axes_to_blender(camera[k]) for k in ("right", "up", "forward"))
    columns = (right, up, -forward, units.point(camera["position_m"]))
    matrix = Matrix.Identity(4)
    for j, column in enumerate(columns):
        for i in range(3):
            matrix[i][j] = column[i]
    thing.matrix_world = matrix
    scene.camera = thing


# -- Scenes ----------------------------------------------------------------------------------------


def set_cycles(scene, spec: dict, render_pass: dict) -> None:
    scene.render.engine = "CYCLES"
    for name, value in CYCLES_SETTINGS.items():
        put(scene.cycles, name, value)
    if has(scene.cycles, "volume_biased"):
        put(scene.cycles, "volume_biased", not render_pass["is_unbiased"])
    elif render_pass["is_unbiased"]:
        raise ValueError(f"Blender {bpy.app.version_string} has volumes in steps only")
    multiple = spec["scattering"] == "multiple" and render_pass["kind"] == "radiance"
    scene.cycles.diffuse_bounces = ALL_BOUNCES if multiple else 0
    scene.cycles.volume_bounces = ALL_BOUNCES if multiple else 0
    if any(solid["surface"] is not None for solid in spec["solids"]):
        scene.cycles.glossy_bounces = ALL_BOUNCES if multiple else 0
        scene.cycles.caustics_reflective = True
    scene.cycles.samples = render_pass["samples"]
    scene.cycles.seed = render_pass["seed"]
    scene.cycles.volume_step_rate = 1.0


def set_output(scene, spec: dict, path: str) -> None:
    render = scene.render
    render.resolution_x, render.resolution_y = spec["width_px"], spec["height_px"]
    render.resolution_percentage = 100
    render.pixel_aspect_x = render.pixel_aspect_y = 1.0
    render.film_transparent = False
    render.dither_intensity = 0.0
    render.use_compositing = render.use_sequencer = False
    render.threads_mode = "FIXED"
    render.threads = spec["threads"]
    image = render.image_settings
    if "MULTI_LAYER_IMAGE" in choices(image, "media_type"):
        put(image, "media_type", "MULTI_LAYER_IMAGE")
    image.file_format = "OPEN_EXR_MULTILAYER"
    image.color_depth = "32"
    image.exr_codec = "ZIP"
    if has(image, "use_exr_interleave"):  # else it has a part for each layer
        put(image, "use_exr_interleave", True)
    render.use_file_extension = True
    render.filepath = path
    scene.view_settings.view_transform = "Raw"


def set_layers(scene, emits: bool, has_surfaces: bool) -> None:
    layer = scene.view_layers[0]
    layer.name = "pass"
    layer.use_pass_combined = layer.use_pass_z = True
    layer.use_pass_emit = emits
    layer.cycles.use_pass_volume_direct = layer.cycles.use_pass_volume_indirect = True
    if has_surfaces:
        layer.use_pass_diffuse_direct = layer.use_pass_diffuse_indirect = True
        layer.use_pass_glossy_direct = layer.use_pass_glossy_indirect = True
        layer.use_pass_diffuse_color = layer.use_pass_glossy_color = True
        layer.use_pass_ambient_occlusion = True


def pass_name(render_pass: dict) -> str:
    channel = render_pass["channel"]
    return render_pass["kind"] if channel is None else f"{render_pass['kind']}{int(channel)}"


def build(spec: dict, render_pass: dict):
    """One Blender scene: "radiance" as it is; "emission" of media that do not scatter, with black
    solids in the dark; "transmittance" of black media before a world and solids of radiance 1,
    whose image is exp(-optical depth); "depth" of the solids alone. A pass of one channel gives all
    channels that one's extinction; only that one is right in its image."""
    kind = render_pass["kind"]
    if kind not in ("radiance", "emission", "transmittance", "depth"):
        raise ValueError("unknown kind of pass")
    if spec["scattering"] not in ("none", "single", "multiple"):
        raise ValueError("unknown scattering")
    emits = kind == "emission" or (kind == "radiance" and spec["scattering"] == "multiple")
    scene = bpy.data.scenes.new(pass_name(render_pass))
    units = Units(spec)
    set_cycles(scene, spec, render_pass)
    surface_layers = spec["surface_layers"] if kind == "radiance" else None
    set_layers(scene, emits and any("glow_w_per_m2_sr" in medium for medium in spec["media"]),
               surface_layers is not None)
    set_output(scene, spec, os.path.join(file_root(), scene.name))
    add_camera(scene, spec["camera"], units)
    if kind == "radiance":
        make_world(scene, spec["background_w_per_m2_sr"], spec["environment_light"])
        if spec["sun"] is not None:
            add_sun(scene, spec["sun"])
        for lamp in spec["lights"]:
            add_lamp(scene, lamp, units)
    else:
        make_world(scene, (0.0,) * 3 if kind == "emission" else (1.0,) * 3, False)
    if surface_layers is not None:
        distance_m = surface_layers["ao_distance_m"]
        scene.world.light_settings.distance = (
            FAR_UNITS if distance_m is None else units.length(distance_m))
    for solid in spec["solids"]:
        if kind == "emission":
            solid = {**solid, "albedo": (0.0, 0.0, 0.0), "surface": None}
        add_solid(scene, solid, kind in ("transmittance", "depth"), units)
    scatters = kind == "radiance" and spec["scattering"] != "none"
    for medium in spec["media"] if kind != "depth" else []:
        add_medium(scene, medium, render_pass, scatters, emits, units)
    return scene


def render(scene) -> float:
    """Render to the scene's file; seconds of wall time."""
    start = time.perf_counter()
    bpy.ops.render.render(scene=scene.name, write_still=True)
    return time.perf_counter() - start


def main(arguments: list[str]) -> None:
    with open(arguments[0], encoding="utf-8") as file:
        spec = json.load(file)
    if spec["format"] != FORMAT:
        raise ValueError(f"spec of format {spec['format']}, this script reads {FORMAT}")
    bpy.ops.wm.read_factory_settings(use_empty=True)
    empty = bpy.context.scene
    scenes = [build(spec, render_pass) for render_pass in spec["passes"]]
    if arguments[1:2] == ["--save"]:
        bpy.context.window.scene = scenes[0]
        bpy.data.scenes.remove(empty)
        bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath(arguments[2]))
        return
    with open("about.json", "w", encoding="utf-8") as file:
        json.dump(about(), file)
    seconds = {scene.name: render(scene) for scene in scenes}
    with open("timing.json", "w", encoding="utf-8") as file:
        json.dump(seconds, file)


main(sys.argv[sys.argv.index("--") + 1 :])
