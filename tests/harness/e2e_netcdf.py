#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A `volume` from a NetCDF file: place and values of its voxels, units, uneven heights, and the
errors of files. The files are of the classic format, byte by byte, as its specification has it."""
import math
import pathlib
import struct
import unittest

import neph_case

NEPH = pathlib.Path(neph_case.NEPH)

SCENE = """title: A cloud of a simulation
camera: {position_m: [0, 500, 9000], look_at_m: [0, 500, 0], vertical_fov_deg: 40}
scattering: none
media:
  - volume: {file: les.nc, KEYS, albedo: [1, 1, 1]}
"""
CHAR, FLOAT, DOUBLE, SHORT = 2, 5, 6, 3
CODES = {FLOAT: "f", DOUBLE: "d", SHORT: "h"}
X, Y, Z = (3, 2, 4)
HEIGHTS = [50.0, 150.0, 250.0, 350.0]
WATER = [0.1 * (x + 10 * y + 100 * z) for z in range(Z) for y in range(Y) for x in range(X)]


def padded(data):
    return data + bytes(-len(data) % 4)


def name(text):
    return struct.pack(">i", len(text)) + padded(text.encode())


def attribute(key, value):
    if isinstance(value, str):
        return name(key) + struct.pack(">ii", CHAR, len(value)) + padded(value.encode())
    return name(key) + struct.pack(">iid", DOUBLE, 1, value)


def listed(tag, entries):
    return struct.pack(">ii", tag if entries else 0, len(entries)) + b"".join(entries)


def netcdf(dimensions, variables):
    """`variables`: (name, its dimensions, type, attributes, values)."""
    names = list(dimensions)
    data = [padded(struct.pack(f">{len(values)}{CODES[kind]}", *values))
            for _, _, kind, _, values in variables]

    def head(begin):
        entries = []
        for (title, along, kind, attributes, _), block in zip(variables, data):
            entries.append(name(title) + struct.pack(f">i{len(along)}i", len(along),
                                                     *map(names.index, along)) +
                           listed(12, [attribute(*pair) for pair in attributes.items()]) +
                           struct.pack(">iii", kind, len(block), begin))
            begin += len(block)
        return (b"CDF\x01" + bytes(4) +
                listed(10, [name(key) + struct.pack(">i", size)
                            for key, size in dimensions.items()]) +
                bytes(8) + listed(11, entries))
    return head(len(head(0))) + b"".join(data)


def simulation(heights=HEIGHTS, unit="m", values=WATER, kind=FLOAT, extra=(), **attributes):
    """Water and effective radius of 3 x 2 x 4 nodes, 100 m apart."""
    attributes = {"units": "g m-3", **attributes}
    along = ("z", "y", "x")
    return netcdf({"x": X, "y": Y, "z": Z}, [
        ("x", ("x",), DOUBLE, {"units": unit}, [-100.0, 0.0, 100.0]),
        ("y", ("y",), FLOAT, {"units": unit}, [1000.0, 1100.0]),
        ("z", ("z",), FLOAT, {"units": unit}, heights),
        ("lwc", along, kind, {k: v for k, v in attributes.items() if v is not None}, values),
        ("re", along, FLOAT, {"units": "m"}, [(5 + i % X) * 1e-6 for i in range(X * Y * Z)]),
        *extra])


def efficiency(radius_um, variance=0.1):
    """scenes/density_units.h."""
    k = (1 - 2 * variance) / variance
    scale = 2 * math.pi / 0.55 * variance * radius_um
    return 2 + 1.9923861 * math.exp(math.lgamma(k + 4 / 3) - math.lgamma(k + 2) -
                                    2 / 3 * math.log(scale))


def extinction(water, radius_um):
    return 1e-3 * 3 * efficiency(radius_um) * water / (4 * 998.2 * 1e-6 * radius_um)


@unittest.skipUnless(NEPH.with_name("neph-netcdf").exists(), "neph was built without NetCDF")
class NetCDF(neph_case.NephCase):
    in_folder = True

    def scene(self, keys, data=None):
        if data is not None:
            (self.folder / "les.nc").write_bytes(data)
        return self.put("les.yaml", SCENE.replace("KEYS", keys))

    def voxels(self, keys, data=None):
        """The entry of `neph bake`, and the extinctions along the world's x, y, z, x fastest."""
        self.scene(keys, data)
        entry = self.json("bake", "les.yaml", "les.df3")
        self.assertTrue(entry["is_copy"])
        size = entry["size"]
        raw = (self.folder / "les.df3").read_bytes()
        wide = struct.unpack(">3H", raw[:6])
        self.assertEqual(list(wide), [side + 2 for side in size])
        whole = struct.unpack(f">{math.prod(wide)}I", raw[6:])
        largest = (entry["density_maximum"] * entry["extinction_of_density_1_per_m"] /
                   (2 ** 32 - 1))
        return entry, [whole[((k + 1) * wide[1] + j + 1) * wide[0] + i + 1] * largest
                      for k in range(size[2]) for j in range(size[1]) for i in range(size[0])]

    def refused(self, keys, *said, data=None, code=65):
        self.scene(keys, data)
        self.neph("scenes", "les.yaml", code=code, silent=True, said=("les.nc", *said))

    def check_values(self, found, expected):
        self.assertEqual(len(found), len(expected))
        for one, other in zip(found, expected):
            self.assertAlmostEqual(one, other, delta=1e-6 * max(expected))

    def test_place_and_values(self):
        # (x, y, z) of the file is (x, z, -y).
        entry, found = self.voxels("grid: lwc, water_g_per_m3: 1, effective_radius_um: 10",
                                   simulation())
        self.assertEqual((entry["size"], entry["origin_m"], entry["spacing_m"]),
                         ([X, Z, Y], [-100, 50, -1100], [100, 100, 100]))
        self.check_values(found, [extinction(WATER[(k * Y + Y - 1 - j) * X + i], 10)
                                  for j in range(Y) for k in range(Z) for i in range(X)])

    def test_radii_and_units(self):
        # Water in kg/m3, packed; the unit of the radius is that of the file.
        packed = simulation(values=[round(10 * w) for w in WATER], kind=SHORT, units="kg m-3",
                            scale_factor=1e-4)
        _, found = self.voxels("grid: lwc, radius_grid: re, water_g_per_m3: 1", packed)
        self.check_values(found, [extinction(WATER[(k * Y + Y - 1 - j) * X + i], 5 + i)
                                  for j in range(Y) for k in range(Z) for i in range(X)])
        said = self.neph("scenes", "les.yaml").stdout
        self.assertIn("radius_grid: each voxel has its own water", said)
        _, scaled = self.voxels("grid: lwc, extinction_per_m: 2, value_unit: 1/km", simulation())
        self.check_values(scaled, [2e-3 * WATER[(k * Y + Y - 1 - j) * X + i]
                                   for j in range(Y) for k in range(Z) for i in range(X)])

    def test_uneven_heights(self):
        uneven = simulation(heights=[50.0, 150.0, 250.0, 550.0])
        entry, found = self.voxels("grid: lwc, water_g_per_m3: 1, effective_radius_um: 10", uneven)
        self.assertEqual((entry["size"], entry["origin_m"][1]), ([X, 7, Y], 50))
        levels = [0, 1, 2, 2, 3, 3, 3]  # cells end at 100, 200, 400 and 700 m
        self.check_values(found, [extinction(WATER[(k * Y + Y - 1 - j) * X + i], 10)
                                  for j in range(Y) for k in levels for i in range(X)])
        said = self.neph("scenes", "les.yaml").stdout
        self.assertRegex(said, r"4 uneven places along 'z' became 7, 100 m apart: their sum times "
                         r"thickness changed by -?[0-9.]+e-(0[7-9]|1[0-9])|changed by 0.0e\+00")
        [medium] = self.json("scenes", "les.yaml")["densities"]["media"]
        self.assertIn("uneven places", medium["note"])
        self.assertAlmostEqual(medium["largest_value"], max(WATER), 4)
        # Heights in km that descend are the same voxels.
        turned = simulation(heights=[0.55, 0.25, 0.15, 0.05], unit="km",
                            values=[WATER[((Z - 1 - k) * Y + j) * X + i]
                                    for k in range(Z) for j in range(Y) for i in range(X)])
        _, same = self.voxels("grid: lwc, water_g_per_m3: 1, effective_radius_um: 10, "
                              "placement: fit, center_m: [0, 0, 0], size_m: [300, 700, 200]",
                              turned)
        self.check_values(same, found)

    def test_times_axes_and_boxes(self):
        values = [float(t + 1) for t in range(2) for _ in range(X * Y * Z)]
        timed = netcdf({"time": 2, "a": X, "b": Y, "c": Z},
                       [("q", ("time", "a", "b", "c"), DOUBLE, {"units": "g/m3"}, values)])
        keys = ("water_g_per_m3: 1, effective_radius_um: 10, placement: fit, center_m: [0, 0, 0], "
                "longest_side_m: 100")
        self.refused(keys, "has 2 places along 'time'", "time_index: 0 to 1", data=timed)
        self.refused(keys + ", time_index: 2", "time_index 2 is outside 0 to 1")
        entry, found = self.voxels(keys + ", time_index: 1, axes: \"a,b,c\"")
        self.assertEqual(entry["size"], [X, Z, Y])
        self.check_values(found, [extinction(2.0, 10)] * (X * Y * Z))
        self.assertEqual(self.voxels(keys + ", time_index: 0")[0]["size"], [Z, X, Y])
        self.refused(keys + ", time_index: 0, axes: \"a,b,d\"", "no dimension 'd'; it has 'time'")
        self.refused(keys + ", time_index: 0, axes: \"a,b,b\"", "name a dimension twice")
        box = ", time_index: 0, axes: \"a,b,c\", index_box: {first: [1, 0, 2], last: [1, 1, 3]}"
        self.assertEqual(self.voxels(keys + box)[0]["size"], [1, 2, 2])
        self.refused(keys + box.replace("1, 3]", "2, 3]"),
                     "from 0 to 2 along 'b', which has 0 to 1")

    def test_missing_values(self):
        keys = "grid: lwc, water_g_per_m3: 1, effective_radius_um: 10"
        for missing, attributes in ((-999.0, {"missing_value": -999.0}),
                                    (-1e30, {"_FillValue": -1e30}), (math.nan, {}),
                                    (9.969209968386869e36, {})):
            values = WATER[:7] + [missing] + WATER[8:10] + [missing] + WATER[11:]
            kind = DOUBLE if missing == -1e30 else FLOAT
            self.refused(keys, "variable 'lwc' has 2 missing values, the first at index (1, 0, 1)",
                         "setmisstoc", data=simulation(values=values, kind=kind, **attributes))
        self.refused(keys, "negative", data=simulation(values=[-1.0] + WATER[1:]))

    def test_unknown_units(self):
        keys = "grid: lwc, water_g_per_m3: 1, effective_radius_um: 10"
        self.refused(keys, "variable 'lwc' has no unit, and water_g_per_m3 needs g/m3 or kg/m3",
                     "value_unit", data=simulation(units=None))
        self.refused(keys, "variable 'lwc' has the unit 'kg kg-1'", "density of air, such as with "
                     "ncap2 -s 'lwc=lwc*rho'", data=simulation(units="kg kg-1"))
        self.refused("grid: lwc, extinction_per_m: 1", "has the unit 'kg kg-1', and "
                     "extinction_per_m needs 1/m or 1/km")
        # Where only proportions count, any unit will do.
        self.scene("grid: lwc, optical_depth: 10")
        [medium] = self.json("scenes", "les.yaml")["densities"]["media"]
        self.assertAlmostEqual(medium["optical_depth"]["y"], 10)
        self.scene(keys + ", value_unit: 1")
        self.neph("scenes", "les.yaml")
        self.refused(keys, "dimension 'x' has coordinates that are no lengths, in 'hPa'",
                     "placement: fit", data=simulation(unit="hPa"))
        self.scene(keys + ", unit_m: 1")
        self.neph("scenes", "les.yaml")
        self.refused(keys, "dimension 'z' has coordinates that neither ascend nor descend",
                     data=simulation(heights=[0.0, 2.0, 1.0, 3.0]))

    def test_files_and_keys(self):
        keys = "grid: lwc, water_g_per_m3: 1, effective_radius_um: 10"
        whole = simulation()
        self.refused(keys.replace("lwc", "qc"), "it has no variable 'qc'; those with three "
                     "dimensions are 'lwc', 're'", "the key grid", data=whole)
        self.refused(keys.replace("grid: lwc, ", ""), "it has several variables", "'lwc', 're'")
        self.refused(keys.replace("lwc", "x"), "'x' has 1 dimensions; voxels have three")
        self.refused("grid: lwc, radius_grid: none, water_g_per_m3: 1", "no variable 'none'",
                     "radius_grid")
        for data, said in ((b"", "NetCDF says"), (b"nothing", "NetCDF says"),
                           (b"CDF\x01", "ends in its header"), (whole[:100], "in its header"),
                           (whole[:-40], f"has {len(whole) - 40} bytes, and its header declares "
                            f"{len(whole)}"), (b"CDF\x01" + b"\xff" * 400, "damaged")):
            self.refused(keys, said, data=data)
        self.put("other.yaml", SCENE.replace("KEYS", keys + ", axes: \"x,y,z\"")
                 .replace("les.nc", "les.vdb"))
        (self.folder / "les.vdb").write_bytes(b"")
        self.neph("scenes", "other.yaml", code=65, silent=True,
                  said=("volume.axes: only a .nc has it", "leave the key out"))
        self.scene(keys, whole)
        for fake in ('printf x > "$2"', 'yes | head -c 9000 > "$2"', "true"):
            self.put_program("neph-netcdf", f"#!/bin/sh\n{fake}\n")
            self.neph("scenes", "les.yaml", code=65, silent=True,
                      NEPH_NETCDF=str(self.folder / "bin/neph-netcdf"),
                      said="damaged: NetCDF read nonsense from it")
        self.neph("scenes", "les.yaml", code=69, NEPH_NETCDF="/nowhere/neph-netcdf", silent=True,
                  said=("/nowhere/neph-netcdf", "libnetcdf-dev"))


if __name__ == "__main__":
    unittest.main()
