/* SPDX-License-Identifier: MIT
 *
 * The program make_vdb FOLDER writes OpenVDB files of all kinds for test_volume_file.c, including
 * files that neph itself never writes.
 */
#include "scenes/openvdb_grids.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>

namespace
{

using openvdb::Coord;
using openvdb::FloatGrid;
using openvdb::math::Transform;

/* 5 x 4 x 3 nodes from index (-3, 2, 7): node i, j, k has the value i + 10 j + 100 k. */
FloatGrid::Ptr ramp(const std::string &name)
{
    const FloatGrid::Ptr grid = FloatGrid::create(0.0f);
    for (int k = 0; k < 3; k++)
        for (int j = 0; j < 4; j++)
            for (int i = 0; i < 5; i++)
                grid->tree().setValue(Coord(i - 3, j + 2, k + 7),
                                      static_cast<float>(i + 10 * j + 100 * k));
    grid->setName(name);
    return grid;
}

FloatGrid::Ptr with_value(float value)
{
    const FloatGrid::Ptr grid = ramp("density");
    grid->tree().setValue(Coord(-2, 3, 7), value);
    return grid;
}

openvdb::GridPtrVec placed()
{
    const FloatGrid::Ptr grid = ramp("density");
    const Transform::Ptr transform = Transform::createLinearTransform();
    transform->postScale(openvdb::Vec3d(0.5, 2.0, 0.25));
    transform->postTranslate(openvdb::Vec3d(10.0, -20.0, 30.0));
    grid->setTransform(transform);
    return {grid};
}

/* Water and the effective radius of its droplets, 5 um and 1 more for each i; the same radii at
 * another place, and without the last voxel. */
openvdb::GridPtrVec droplets()
{
    openvdb::GridPtrVec grids{ramp("water")};
    for (const char *name : {"radius", "radius_moved", "radius_short"}) {
        const FloatGrid::Ptr grid = ramp(name);
        for (auto voxel = grid->beginValueOn(); voxel; ++voxel)
            voxel.setValue(static_cast<float>(voxel.getCoord()[0] + 8));
        grids.push_back(grid);
    }
    grids[2]->setTransform(Transform::createLinearTransform(0.5));
    openvdb::gridPtrCast<FloatGrid>(grids[3])->tree().setValueOff(Coord(1, 5, 9), 0.0f);
    return grids;
}

openvdb::GridPtrVec rotated()
{
    const FloatGrid::Ptr grid = ramp("density");
    const Transform::Ptr transform = Transform::createLinearTransform();
    transform->postRotate(0.3, openvdb::math::Y_AXIS);
    grid->setTransform(transform);
    return {grid};
}

/* All 48 rotations by 90 degrees and mirrors, each as grid "turn<order * 8 + signs>": axis i of the
 * index lies along axis orders[order][i] of the world, backwards where signs has bit i. */
openvdb::GridPtrVec turned()
{
    constexpr int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    constexpr double scales[3] = {0.5, 2.0, 0.25}, offsets[3] = {10.0, -20.0, 30.0};
    openvdb::GridPtrVec grids;
    for (int turn = 0; turn < 48; turn++) {
        openvdb::math::Mat4d m = openvdb::math::Mat4d::zero();
        for (int i = 0; i < 3; i++) {
            m(i, orders[turn / 8][i]) = (turn >> i) % 2 == 0 ? scales[i] : -scales[i];
            m(3, i) = offsets[i];
        }
        m(3, 3) = 1.0;
        const FloatGrid::Ptr grid = ramp("turn" + std::to_string(turn));
        grid->setTransform(Transform::createLinearTransform(m));
        grids.push_back(grid);
    }
    return grids;
}

/* A rotation about x by 90 degrees with float32 matrices, or by slightly more. */
openvdb::GridPtrVec about_x(double cosine)
{
    openvdb::math::Mat4d m = openvdb::math::Mat4d::identity();
    m(1, 1) = m(2, 2) = cosine;
    m(1, 2) = 1.0;
    m(2, 1) = -1.0;
    const FloatGrid::Ptr grid = ramp("density");
    grid->setTransform(Transform::createLinearTransform(m));
    return {grid};
}

/* The ramp, and four layers of active zeros around it. */
openvdb::GridPtrVec padded()
{
    const FloatGrid::Ptr grid = ramp("density");
    for (int k = -4; k < 7; k++)
        for (int j = -4; j < 8; j++)
            for (int i = -4; i < 9; i++)
                if (!grid->tree().isValueOn(Coord(i - 3, j + 2, k + 7)))
                    grid->tree().setValueOn(Coord(i - 3, j + 2, k + 7), 0.0f);
    return {grid};
}

/* The ramp, and a voxel with a tiny value at an index along x. */
openvdb::GridPtrVec stray(int i)
{
    const FloatGrid::Ptr grid = ramp("density");
    grid->tree().setValueOn(Coord(i, 3, 8), 1e-6f);
    return {grid};
}

openvdb::GridPtrVec two_of_one_name()
{
    return {with_value(7.0f), ramp("density")};
}

openvdb::GridPtrVec frustum()
{
    const FloatGrid::Ptr grid = ramp("density");
    grid->setTransform(Transform::createFrustumTransform(
        openvdb::BBoxd(openvdb::Vec3d(-4.0), openvdb::Vec3d(12.0)), 0.5, 2.0));
    return {grid};
}

openvdb::GridPtrVec half()
{
    const FloatGrid::Ptr grid = ramp("density");
    grid->setSaveFloatAsHalf(true);
    return {grid};
}

/* An active tile of 8^3 next to one voxel. */
openvdb::GridPtrVec tile()
{
    const FloatGrid::Ptr grid = FloatGrid::create(0.0f);
    grid->tree().fill(openvdb::CoordBBox(Coord(0), Coord(7)), 0.5f);
    grid->tree().setValue(Coord(8, 0, 0), 0.25f);
    grid->setName("density");
    grid->tree().prune();
    return {grid};
}

/* Two voxels so far apart that their box has 2^60 nodes. */
openvdb::GridPtrVec vast()
{
    const FloatGrid::Ptr grid = ramp("density");
    grid->tree().setValue(Coord(1 << 20), 1.0f);
    return {grid};
}

openvdb::GridPtrVec outside()
{
    const FloatGrid::Ptr grid = FloatGrid::create(0.125f);
    grid->tree().setValue(Coord(0), 1.0f);
    grid->setName("density");
    return {grid};
}

openvdb::GridPtrVec empty()
{
    const FloatGrid::Ptr grid = FloatGrid::create(0.0f);
    grid->setName("density");
    return {grid};
}

openvdb::GridPtrVec vectors()
{
    const openvdb::Vec3SGrid::Ptr grid = openvdb::Vec3SGrid::create();
    grid->tree().setValue(Coord(0), openvdb::Vec3s(1.0f));
    grid->setName("density");
    return {grid};
}

openvdb::GridPtrVec level_set()
{
    const float radius = 3.0f, half_width = 3.0f;
    const FloatGrid::Ptr grid = FloatGrid::create(half_width);
    for (int k = -6; k <= 6; k++)
        for (int j = -6; j <= 6; j++)
            for (int i = -6; i <= 6; i++)
                grid->tree().setValue(Coord(i, j, k), std::min(std::hypot(static_cast<float>(i),
                                                                          static_cast<float>(j),
                                                                          static_cast<float>(k)) -
                                                                   radius,
                                                               half_width));
    grid->setName("density");
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    return {grid};
}

openvdb::GridPtrVec instance()
{
    const FloatGrid::Ptr first = ramp("density");
    const FloatGrid::Ptr second = FloatGrid::create(*first); /* shares the tree */
    second->setTree(first->treePtr());
    second->setName("again");
    return {first, second};
}

const struct {
    const char *name;
    std::function<openvdb::GridPtrVec()> make;
} samples[] = {
    {"plain", [] { return openvdb::GridPtrVec{ramp("density")}; }},
    {"placed", placed},
    {"half", half},
    {"droplets", droplets},
    {"tile", tile},
    {"one_of_another_name", [] { return openvdb::GridPtrVec{ramp("smoke")}; }},
    {"several",
     [] {
         return openvdb::GridPtrVec{ramp("heat"), half()[0], ramp("smoke")};
     }},
    {"several_without_density",
     [] {
         return openvdb::GridPtrVec{ramp("heat"), ramp("smoke")};
     }},
    {"none", [] { return openvdb::GridPtrVec{}; }},
    {"rotated", rotated},
    {"turned", turned},
    {"turned_in_float", [] { return about_x(-4.37e-8); }},
    {"turned_too_far", [] { return about_x(1e-3); }},
    {"padded", padded},
    {"grown", [] { return stray(12); }},
    {"stray", [] { return stray(100000); }},
    {"two_of_one_name", two_of_one_name},
    {"frustum", frustum},
    {"vast", vast},
    {"outside", outside},
    {"empty", empty},
    {"vectors", vectors},
    {"level_set", level_set},
    {"instance", instance},
    {"nan", [] { return openvdb::GridPtrVec{with_value(std::nanf(""))}; }},
    {"infinite",
     [] { return openvdb::GridPtrVec{with_value(std::numeric_limits<float>::infinity())}; }},
    {"negative", [] { return openvdb::GridPtrVec{with_value(-0.5f)}; }},
};

} // namespace

int main(int argc, char **argv)
{
    if (argc != 2)
        return 64;
    openvdb::initialize();
    for (const auto &sample : samples) {
        openvdb::io::File file(std::string(argv[1]) + "/" + sample.name + ".vdb");
        file.write(sample.make());
        file.close();
    }
    return 0;
}
