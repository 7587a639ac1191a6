/* SPDX-License-Identifier: MIT
 *
 * The program neph-vdb, the only code that uses OpenVDB (scenes/volume_vdb.h has the reasons). No
 * exception leaves it.
 */
#include "scenes/volume_vdb.h"
#include "scenes/openvdb_grids.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <fstream>
#include <map>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <malloc.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sysexits.h>
#include <unistd.h>

#include <openvdb/io/Compression.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/tools/Dense.h>
#include <tbb/global_control.h>

namespace
{

using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::FloatGrid;
using openvdb::FloatTree;

/* Memory for libraries, stacks, and the file's own tables of contents. */
constexpr uint64_t base_memory_bytes = uint64_t{512} << 20;
constexpr int32_t grids_max = 1024;
constexpr size_t listed_names_max = 8;

/* Largest distance, in voxels, of a node from its place under an exact rotation by 90 degrees:
 * programs that rotate in float32 have a cosine of 4.4e-8, which is 4.5e-5 of a voxel after
 * 1024. */
constexpr double skew_max_voxels = 1e-3;

/* Voxels are stray when they have less than this part of the density and make a side of the box
 * longer by this factor. The detached wisps of the Disney cloud have less, and a factor of 1.03. */
constexpr double stray_density_max = 1e-3;
constexpr double stray_growth_min = 1.1;

/* A fault of the file, in words for the user; after a tab the way out. */
struct bad_file : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/* The arguments from neph. */
struct request {
    const char *path;
    uint64_t memory_limit_bytes;
    int32_t side_max;
    bool is_fitted;
    bool counts_zeros;
    bool has_index_box;
    CoordBBox index_box;
    const char *grid_name; /* nullptr: none */
};

[[gnu::format(printf, 1, 2)]] std::string words(const char *format, ...)
{
    char text[900];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof(text), format, arguments);
    va_end(arguments);
    return text;
}

void limit_resource(int resource, uint64_t maximum)
{
    const rlimit both = {maximum, maximum};
    if (setrlimit(static_cast<__rlimit_resource>(resource), &both) != 0)
        throw std::runtime_error("setrlimit failed");
}

/* ---- the table of contents ------------------------------------------------------------------- */

struct entry {
    openvdb::io::GridDescriptor descriptor;
    openvdb::GridBase::Ptr grid; /* empty */
    std::string label;           /* "density", or "density[1]" where several have the name */

    std::string name() const
    {
        return label;
    }
};

/* The name in the file, without the number that distinguishes grids of the same name. */
std::string plain_name(const entry &each)
{
    return openvdb::io::GridDescriptor::stripSuffix(each.descriptor.uniqueName());
}

/* Labels have OpenVDB's own numbers; where they are missing, the order in the file. */
void set_labels(std::vector<entry> &entries)
{
    for (entry &each : entries)
        each.label = openvdb::io::GridDescriptor::nameAsString(each.descriptor.uniqueName());
    for (entry &each : entries) {
        const std::string label = each.label;
        const auto has_label = [&](const entry &other) { return other.label == label; };
        if (std::count_if(entries.begin(), entries.end(), has_label) < 2)
            continue;
        int number = 0;
        for (entry &same : entries)
            if (has_label(same))
                same.label += words("[%d]", number++);
    }
}

/* openvdb::io::File does not check for short reads, and would fill a truncated grid with arbitrary
 * memory. This class reads in the same way from a stream that throws at the end of the file, and
 * stops between topology and voxels so that the size can be checked. */
class archive : openvdb::io::Archive
{
  public:
    explicit archive(const char *path)
    {
        stream.exceptions(std::ios::failbit | std::ios::badbit | std::ios::eofbit);
        stream.open(path, std::ios::binary);
        readHeader(stream);
        openvdb::io::setStreamMetadataPtr(stream, state, false);
        setFormatVersion(stream); /* read by the parts of the file */
        setLibraryVersion(stream);
        setDataCompression(stream);
        if (fileVersion() < openvdb::OPENVDB_FILE_VERSION_NODE_MASK_COMPRESSION)
            throw bad_file(words("its format, version %u, is older than OpenVDB 3; open it with a "
                                 "newer program and save it again",
                                 fileVersion()));
        if (!inputHasGridOffsets())
            throw bad_file("it was written as a stream, without a table of contents; open it with "
                           "another program and save it again");
    }

    std::vector<entry> contents()
    {
        openvdb::MetaMap of_the_file;
        of_the_file.readMeta(stream);
        const int32_t count = readGridCount(stream);
        if (count < 0 || count > grids_max)
            throw bad_file(words("it declares %d grids", count));
        std::vector<entry> entries(static_cast<size_t>(count));
        for (entry &each : entries) {
            each.grid = each.descriptor.read(stream);
            each.descriptor.seekToEnd(stream);
        }
        set_labels(entries);
        return entries;
    }

    /* The steps of Archive::readGrid(). */
    void read_metadata(entry &chosen)
    {
        chosen.descriptor.seekToGrid(stream);
        readGridCompression(stream);
        state->setHalfFloat(chosen.grid->saveFloatAsHalf());
        chosen.grid->readMeta(stream);
        openvdb::io::setGridClass(stream, chosen.grid->getGridClass());
        chosen.grid->readTransform(stream);
    }
    void read_topology(entry &chosen)
    {
        chosen.grid->readTopology(stream);
    }
    void read_voxels(entry &chosen)
    {
        chosen.grid->readBuffers(stream);
    }

  private:
    openvdb::io::StreamMetadata::Ptr state{new openvdb::io::StreamMetadata}; /* of the stream */
    std::ifstream stream;
};

std::string list_names(const std::vector<entry *> &entries)
{
    std::string list;
    for (size_t i = 0; i < entries.size() && i < listed_names_max; i++)
        list += words("%s'%.40s'", i > 0 ? ", " : "", entries[i]->name().c_str());
    return entries.size() > listed_names_max ? list + ", ..." : list;
}

/* The grid with this label, or the only grid with this name. */
entry &choose_entry(std::vector<entry> &entries, const char *wanted)
{
    if (entries.empty())
        throw bad_file("it has no grid");
    if (!wanted && entries.size() == 1)
        return entries[0];
    const std::string name = wanted ? wanted : "density";
    std::vector<entry *> all, same;
    for (entry &each : entries) {
        if (each.name() == name)
            return each;
        all.push_back(&each);
        if (plain_name(each) == name)
            same.push_back(&each);
    }
    if (same.size() > 1)
        throw bad_file(words("it has %zu grids '%.60s'\tsay which with the key grid, such as "
                             "grid: \"%.40s\"; there are %s",
                             same.size(), name.c_str(), same[0]->name().c_str(),
                             list_names(same).c_str()));
    if (same.size() == 1)
        return *same[0];
    throw bad_file(words("it has no grid '%.60s'; it has %s\tsay which with the key grid",
                         name.c_str(), list_names(all).c_str()));
}

/* ---- requirements for a density -------------------------------------------------------------- */

void check_kind(const entry &chosen)
{
    const openvdb::GridBase &grid = *chosen.grid;
    const std::string name = chosen.name();
    if (!grid.isType<FloatGrid>())
        throw bad_file(words("grid '%.60s' is of type %.60s; only grids of float or half can be a "
                             "density",
                             name.c_str(), grid.type().c_str()));
    if (chosen.descriptor.isInstance())
        throw bad_file(words("grid '%.60s' is an instance of grid '%.60s'", name.c_str(),
                             chosen.descriptor.instanceParentName().c_str()));
}

/* Checks the class of the grid, which is known after its metadata were read. */
void check_class(const entry &chosen)
{
    const openvdb::GridClass grid_class = chosen.grid->getGridClass();
    if (grid_class != openvdb::GRID_FOG_VOLUME && grid_class != openvdb::GRID_UNKNOWN)
        throw bad_file(words("grid '%.60s' is a %s, not a fog volume", chosen.name().c_str(),
                             openvdb::GridBase::gridClassToMenuName(grid_class).c_str()));
}

/* The axis of the world along which an axis of the index lies, with a small skew at most. */
int main_axis(const openvdb::math::Mat4d &m, int i)
{
    int axis = 0;
    for (int j = 1; j < 3; j++)
        if (std::fabs(m(i, j)) > std::fabs(m(i, axis)))
            axis = j;
    return axis;
}

/* Maps axes of the index to axes of the world, forwards or backwards, or throws. */
void place_axes(const entry &chosen, const openvdb::math::Mat4d &m, neph_vdb_placement &placement)
{
    double spacing_along[3] = {0.0, 0.0, 0.0}; /* of the world */
    for (int i = 0; i < 3; i++) {
        const int axis = main_axis(m, i);
        placement.axis[i] = axis;
        placement.is_reversed[i] = m(i, axis) < 0.0;
        placement.spacing[i] = spacing_along[axis] = std::fabs(m(i, axis));
        if (!(placement.spacing[i] > 0.0) || !std::isfinite(placement.spacing[i]) ||
            !std::isfinite(m(3, i)))
            throw bad_file(words("grid '%.60s' has the scale %g and the offset %g on axis %c; the "
                                 "scale must not be 0, and both finite",
                                 chosen.name().c_str(), m(i, axis), m(3, i), "xyz"[i]));
    }
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            if (j != placement.axis[i] &&
                !(static_cast<double>(placement.size[i]) * std::fabs(m(i, j)) <=
                  skew_max_voxels * spacing_along[j]))
                throw bad_file(
                    words("grid '%.60s' is turned by other angles than 90 degrees, or "
                          "sheared\tneph does not resample: resample it onto the axes of "
                          "the world in the program that wrote it "
                          "(openvdb::tools::resampleToMatch), and save it again",
                          chosen.name().c_str()));
}

/* The placement of a box of voxels by the transform of the file. */
neph_vdb_placement compute_placement(const entry &chosen, const CoordBBox &box)
{
    const openvdb::math::MapBase::ConstPtr map = chosen.grid->transform().baseMap();
    if (!map->isLinear())
        throw bad_file(
            words("grid '%.60s' is placed by a frustum\tneph does not resample: resample "
                  "it onto a grid with a linear transform, and save it again",
                  chosen.name().c_str()));
    const openvdb::math::Mat4d m = map->getAffineMap()->getMat4();
    neph_vdb_placement placement = {};
    for (int i = 0; i < 3; i++) {
        placement.size[i] = box.dim()[i];
        placement.first[i] = box.min()[i];
    }
    place_axes(chosen, m, placement);
    for (int j = 0; j < 3; j++)
        placement.origin[j] = m(3, j);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            placement.origin[j] += m(i, j) * box.min()[i];
    return placement;
}

/* ---- choice of the voxels -------------------------------------------------------------------- */

struct sides {
    explicit sides(const CoordBBox &box)
    {
        for (int i = 0; i < 3; i++)
            at[i] = static_cast<double>(box.max()[i]) - box.min()[i] + 1.0;
    }
    double longest() const
    {
        return std::max(at[0], std::max(at[1], at[2]));
    }
    double bytes() const
    {
        return at[0] * at[1] * at[2] * sizeof(float);
    }
    double at[3];
};

bool fits(const request &request_in, const CoordBBox &box)
{
    return sides(box).longest() <= request_in.side_max &&
           sides(box).bytes() <= static_cast<double>(request_in.memory_limit_bytes);
}

/* The key of a scene file for a box. */
std::string format_region_key(const CoordBBox &box)
{
    const Coord low = box.min(), high = box.max();
    return words("index_box: {first: [%d, %d, %d], last: [%d, %d, %d]}", low[0], low[1], low[2],
                 high[0], high[1], high[2]);
}

[[noreturn]] void refuse_size(const request &request_in, const CoordBBox &box,
                              const std::string &hint)
{
    const sides of(box);
    if (of.longest() > request_in.side_max)
        throw bad_file(words("%.0f x %.0f x %.0f voxels from (%d, %d, %d) on; a side may have at "
                             "most %d",
                             of.at[0], of.at[1], of.at[2], box.min()[0], box.min()[1], box.min()[2],
                             request_in.side_max) +
                       "\t" + hint);
    throw bad_file(words("%.0f x %.0f x %.0f nodes need %.0f MiB of memory, and the limit is "
                         "%.0f MiB",
                         of.at[0], of.at[1], of.at[2], of.bytes() / 0x1p20,
                         static_cast<double>(request_in.memory_limit_bytes) / 0x1p20) +
                   "\t" + hint);
}

const char *const smaller = "resample the volume to fewer nodes, or read a part of it with the key "
                            "index_box";

/* Checks the size in the metadata, so that a huge grid is refused before its topology is read. A
 * box that is too large because of stray voxels is examined later. */
void check_promised_size(const entry &chosen, const request &request_in)
{
    const auto low = chosen.grid->getMetadata<openvdb::Vec3IMetadata>("file_bbox_min");
    const auto high = chosen.grid->getMetadata<openvdb::Vec3IMetadata>("file_bbox_max");
    const auto count = chosen.grid->getMetadata<openvdb::Int64Metadata>("file_voxel_count");
    if (!low || !high || !count || low->value()[0] > high->value()[0])
        return;
    const CoordBBox box(Coord(low->value()), Coord(high->value()));
    if (!fits(request_in, box) && static_cast<double>(count->value()) * sizeof(float) >
                                      static_cast<double>(request_in.memory_limit_bytes))
        refuse_size(request_in, box, smaller);
}

using leaf_node = FloatTree::LeafNodeType;

/* All parts of the tree within a box: uniform(box, value) for tiles that are not 0, and
 * leaf(node, box) for voxels. */
template <typename Uniform, typename Leaf>
void for_each_part(const FloatTree &tree, const CoordBBox &within, Uniform uniform, Leaf leaf)
{
    FloatTree::ValueAllCIter tile = tree.cbeginValueAll();
    tile.setMaxDepth(FloatTree::ValueAllCIter::LEAF_DEPTH - 1);
    for (; tile; ++tile) {
        CoordBBox box = tile.getBoundingBox();
        box.intersect(within);
        if (*tile != 0.0f && !box.empty())
            uniform(box, *tile);
    }
    for (auto node = tree.cbeginLeaf(); node; ++node) {
        CoordBBox box = node->getNodeBoundingBox();
        box.intersect(within);
        if (!box.empty())
            leaf(*node, box);
    }
}

/* The smallest box around the values that are not 0. */
CoordBBox find_value_box(const FloatTree &tree, const CoordBBox &within)
{
    CoordBBox box;
    for_each_part(
        tree, within, [&](const CoordBBox &tile, float) { box.expand(tile); },
        [&](const leaf_node &node, const CoordBBox &part) {
            if (!box.empty() && box.isInside(part))
                return;
            for (auto place = part.begin(); place; ++place)
                if (node.getValue(*place) != 0.0f)
                    box.expand(*place);
        });
    return box;
}

double sum_values(const FloatTree &tree, const CoordBBox &within)
{
    double sum = 0.0;
    for_each_part(
        tree, within,
        [&](const CoordBBox &tile, float value) {
            sum += static_cast<double>(value) * static_cast<double>(tile.volume());
        },
        [&](const leaf_node &node, const CoordBBox &part) {
            for (auto place = part.begin(); place; ++place)
                sum += static_cast<double>(node.getValue(*place));
        });
    return sum;
}

/* The sum of the values of each plane across an axis; a plane of zeros has no entry. */
using plane_sums = std::map<int32_t, double>;

void add_tile(const CoordBBox &tile, float value, std::array<plane_sums, 3> &sums)
{
    for (int i = 0; i < 3; i++) {
        const double of_plane = static_cast<double>(value) * static_cast<double>(tile.volume()) /
                                tile.dim()[i];
        for (int64_t plane = tile.min()[i]; plane <= tile.max()[i]; plane++)
            sums[i][static_cast<int32_t>(plane)] += of_plane;
    }
}

void add_leaf(const leaf_node &node, const CoordBBox &part, std::array<plane_sums, 3> &sums)
{
    double own[3][leaf_node::DIM] = {};
    for (auto place = part.begin(); place; ++place)
        for (int i = 0; i < 3; i++)
            own[i][(*place)[i] - part.min()[i]] += static_cast<double>(node.getValue(*place));
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < part.dim()[i]; k++)
            if (own[i][k] != 0.0)
                sums[i][part.min()[i] + k] += own[i][k];
}

std::array<plane_sums, 3> sum_planes(const FloatTree &tree, const CoordBBox &within)
{
    std::array<plane_sums, 3> sums;
    for_each_part(
        tree, within, [&](const CoordBBox &tile, float value) { add_tile(tile, value, sums); },
        [&](const leaf_node &node, const CoordBBox &part) { add_leaf(node, part, sums); });
    return sums;
}

/* The run of neighbouring planes with the largest sum. */
std::pair<int32_t, int32_t> densest_run(const plane_sums &sums)
{
    std::pair<int32_t, int32_t> best(0, -1);
    double best_sum = -1.0, sum = 0.0;
    int32_t first = 0, before = 0;
    for (const auto &[plane, value] : sums) {
        const bool goes_on = sum > 0.0 && plane == before + 1;
        first = goes_on ? first : plane;
        sum = goes_on ? sum + value : value;
        before = plane;
        if (sum > best_sum) {
            best_sum = sum;
            best = {first, plane};
        }
    }
    return best;
}

/* The box without stray voxels, which are separated by empty planes. Empty if no voxels are
 * separated, or if they have too much of the density to be stray. */
CoordBBox box_without_strays(const FloatTree &tree, const CoordBBox &box)
{
    const std::array<plane_sums, 3> sums = sum_planes(tree, box);
    CoordBBox main;
    for (int i = 0; i < 3; i++) {
        const auto [first, last] = densest_run(sums[i]);
        main.min()[i] = first;
        main.max()[i] = last;
    }
    if (main.empty() || main == box ||
        !(sum_values(tree, main) >= (1.0 - stray_density_max) * sum_values(tree, box)))
        return CoordBBox();
    return find_value_box(tree, main);
}

/* Whether any side is much longer in `to`. */
bool is_much_longer(const sides &from, const sides &to)
{
    for (int i = 0; i < 3; i++)
        if (to.at[i] >= stray_growth_min * from.at[i])
            return true;
    return false;
}

/* Refuses a box that is too large, or whose size defines a scale and depends on stray voxels. */
void check_strays(const FloatTree &tree, const request &request_in, const CoordBBox &box)
{
    const bool is_too_large = !fits(request_in, box);
    if (!is_too_large && !request_in.is_fitted)
        return;
    const CoordBBox main = box_without_strays(tree, box);
    const sides all(box), rest(main);
    if (is_too_large && (main.empty() || !fits(request_in, main)))
        refuse_size(request_in, box, smaller);
    if (is_too_large)
        refuse_size(request_in, box,
                    "stray voxels make it so large; leave them out with " +
                        format_region_key(main));
    if (main.empty() || !is_much_longer(rest, all))
        return;
    throw bad_file(
        words("stray voxels decide its size: %.0f x %.0f x %.0f voxels, and %.0f x %.0f x "
              "%.0f hold more than %g %% of the density\t"
              "leave them out with %s, count them with %s, or use the scale of the file: "
              "placement: file, without center_m and a side",
              all.at[0], all.at[1], all.at[2], rest.at[0], rest.at[1], rest.at[2],
              100.0 * (1.0 - stray_density_max), format_region_key(main).c_str(),
              format_region_key(box).c_str()));
}

void check_voxel_count(const entry &chosen, const FloatTree &tree)
{
    const auto promised = chosen.grid->getMetadata<openvdb::Int64Metadata>("file_voxel_count");
    const auto found = static_cast<int64_t>(tree.activeVoxelCount());
    if (promised && promised->value() != found)
        throw bad_file(words("damaged: grid '%.60s' declares %lld active voxels, and has %lld",
                             chosen.name().c_str(), static_cast<long long>(promised->value()),
                             static_cast<long long>(found)));
}

/* ---- voxels for neph ------------------------------------------------------------------------- */

class block_writer
{
  public:
    explicit block_writer(const char *path) : file(fopen(path, "wb"), fclose)
    {
        if (!file)
            throw std::runtime_error("the memory for voxels cannot be opened");
    }

    void put(const void *data, size_t size)
    {
        if (fwrite(data, 1, size, file.get()) != size)
            throw std::runtime_error("the memory for voxels cannot be written");
    }

    void finish()
    {
        if (fclose(file.release()) != 0)
            throw std::runtime_error("the memory for voxels cannot be written");
    }

  private:
    std::unique_ptr<FILE, int (*)(FILE *)> file;
};

/* Writes the voxels of one grid. */
class exporter
{
  public:
    /* `block`: the nodes for neph; nodes outside `active` are 0. */
    exporter(block_writer &to, const CoordBBox &block, const CoordBBox &active)
        : out(to), corner(block.min()), box(block)
    {
        box.intersect(active);
    }

    void tile(const CoordBBox &where, float value)
    {
        neph_vdb_block block;
        if (value == 0.0f || !start_block(where, block))
            return;
        block.is_uniform = 1;
        block.value = value;
        out.put(&block, sizeof(block));
    }

    void leaf(const leaf_node &node)
    {
        neph_vdb_block block;
        if (!start_block(node.getNodeBoundingBox(), block))
            return;
        float values[leaf_node::SIZE];
        size_t count = 0;
        for (int k = block.first[2]; k <= block.last[2]; k++)
            for (int j = block.first[1]; j <= block.last[1]; j++)
                for (int i = block.first[0]; i <= block.last[0]; i++)
                    values[count++] = node.getValue(corner.offsetBy(i, j, k));
        out.put(&block, sizeof(block));
        out.put(values, count * sizeof(values[0]));
    }

  private:
    /* Clips to the box; false when nothing remains. A tree with overlapping nodes is damaged, and
     * would take more time to copy than its size allows. */
    bool start_block(CoordBBox where, neph_vdb_block &block)
    {
        where.intersect(box);
        if (where.empty())
            return false;
        covered += where.volume();
        if (covered > box.volume())
            throw bad_file("damaged: nodes of its tree overlap");
        block = {};
        for (int i = 0; i < 3; i++) {
            block.first[i] = where.min()[i] - corner[i];
            block.last[i] = where.max()[i] - corner[i];
        }
        return true;
    }

    block_writer &out;
    const Coord corner;
    CoordBBox box;
    uint64_t covered = 0;
};

void export_voxels(const FloatTree &tree, const CoordBBox &block, const CoordBBox &active,
                   block_writer &out)
{
    exporter to(out, block, active);
    FloatTree::ValueAllCIter tile = tree.cbeginValueAll();
    tile.setMaxDepth(FloatTree::ValueAllCIter::LEAF_DEPTH - 1);
    for (; tile; ++tile)
        to.tile(tile.getBoundingBox(), *tile);
    for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf)
        to.leaf(*leaf);
}

/* The box that neph gets, after the values were read. */
CoordBBox choose_block(const FloatTree &tree, const request &request_in, const CoordBBox &active)
{
    if (request_in.has_index_box)
        return request_in.index_box;
    CoordBBox box = request_in.counts_zeros ? active : find_value_box(tree, active);
    if (box.empty())
        box = active;
    check_strays(tree, request_in, box);
    return box;
}

void read_volume(const char *voxels, const request &request_in)
{
    archive file(request_in.path);
    std::vector<entry> entries = file.contents();
    entry &chosen = choose_entry(entries, request_in.grid_name);
    check_kind(chosen);
    file.read_metadata(chosen);
    check_class(chosen);
    if (!request_in.has_index_box)
        check_promised_size(chosen, request_in);
    else if (!fits(request_in, request_in.index_box))
        refuse_size(request_in, request_in.index_box, "make index_box smaller");
    file.read_topology(chosen);

    const FloatTree &tree = openvdb::gridConstPtrCast<FloatGrid>(chosen.grid)->tree();
    if (tree.background() != 0.0f)
        throw bad_file(words("grid '%.60s' has a density of %g everywhere outside its voxels; it "
                             "must be 0",
                             chosen.name().c_str(), static_cast<double>(tree.background())));
    CoordBBox active;
    if (!tree.evalActiveVoxelBoundingBox(active))
        throw bad_file(words("grid '%.60s' has no active voxel", chosen.name().c_str()));
    check_voxel_count(chosen, tree);

    file.read_voxels(chosen);
    const CoordBBox block = choose_block(tree, request_in, active);
    const neph_vdb_placement placement = compute_placement(chosen, block);
    block_writer out(voxels);
    out.put(&placement, sizeof(placement));
    export_voxels(tree, block, active, out);
    out.finish();
}

/* "i,j,k,i,j,k" */
CoordBBox parse_box(const char *text)
{
    Coord low, high;
    if (sscanf(text, "%d,%d,%d,%d,%d,%d", &low[0], &low[1], &low[2], &high[0], &high[1],
               &high[2]) != 6)
        throw std::runtime_error("an index box is six numbers");
    return {low, high};
}

request parse_request(int argc, char **argv)
{
    request request_in = {};
    request_in.path = argv[3];
    request_in.memory_limit_bytes = strtoull(argv[4], nullptr, 10);
    request_in.side_max = static_cast<int32_t>(strtol(argv[6], nullptr, 10));
    request_in.is_fitted = strcmp(argv[7], "fit") == 0;
    request_in.counts_zeros = strcmp(argv[7], "active") == 0;
    request_in.has_index_box = strcmp(argv[8], "all") != 0;
    if (request_in.has_index_box)
        request_in.index_box = parse_box(argv[8]);
    request_in.grid_name = argc > 9 ? argv[9] : nullptr;
    return request_in;
}

int run_read(int argc, char **argv)
{
    const uint64_t memory_limit_bytes = strtoull(argv[4], nullptr, 10);
    /* A thread reserves tens of MiB of address space; a machine may have hundreds of processors. */
    const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
    mallopt(M_ARENA_MAX, 1);
    try {
        limit_resource(RLIMIT_CORE, 0);
        limit_resource(RLIMIT_CPU, strtoull(argv[5], nullptr, 10));
        limit_resource(RLIMIT_AS, base_memory_bytes + 3 * memory_limit_bytes);
        openvdb::initialize();
    } catch (const std::exception &error) {
        fprintf(stderr, "OpenVDB does not start: %s\n", error.what());
        return EX_OSERR;
    }
    try {
        read_volume(argv[2], parse_request(argc, argv));
        return EX_OK;
    } catch (const std::bad_alloc &) {
        fprintf(stderr, "damaged, or its tree needs far more memory than the limit of %.0f MiB\n",
                static_cast<double>(memory_limit_bytes) / 0x1p20);
    } catch (const std::ios_base::failure &) {
        fprintf(stderr, "truncated or damaged: it ends in the middle of its data\n");
    } catch (const bad_file &error) {
        fprintf(stderr, "%s\n", error.what());
    } catch (const std::exception &error) {
        fprintf(stderr, "OpenVDB says: %s\n", error.what());
    } catch (...) {
        fprintf(stderr, "OpenVDB failed without a message\n");
    }
    return EX_DATAERR;
}

/* ---- writing --------------------------------------------------------------------------------- */

/* Replaces the random UUID that OpenVDB writes: the same grid must give the same bytes. */
void replace_uuid(const char *path, const std::string &uuid)
{
    constexpr std::streamoff uuid_offset = 8 + 4 + 2 * 4 + 1; /* magic, versions, has offsets */
    std::fstream file;
    file.exceptions(std::ios::failbit | std::ios::badbit | std::ios::eofbit);
    file.open(path, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(uuid_offset);
    file.write(uuid.data(), static_cast<std::streamsize>(uuid.size()));
    file.close();
}

struct mapping {
    explicit mapping(const char *path)
    {
        const int fd = open(path, O_RDONLY | O_CLOEXEC);
        struct stat info = {};
        if (fd >= 0 && fstat(fd, &info) == 0) {
            size = static_cast<size_t>(info.st_size);
            data = mmap(nullptr, size, PROT_READ, MAP_SHARED, fd, 0);
        }
        close(fd);
        if (data == MAP_FAILED)
            throw std::runtime_error("the memory with voxels cannot be mapped");
    }
    ~mapping()
    {
        munmap(data, size);
    }
    mapping(const mapping &) = delete;
    mapping &operator=(const mapping &) = delete;

    void *data = MAP_FAILED;
    size_t size = 0;
};

void write_volume(const char *voxels, const char *path, const char *uuid)
{
    const mapping memory(voxels);
    auto *placement = static_cast<neph_vdb_placement *>(memory.data);
    auto *values = reinterpret_cast<float *>(placement + 1);
    Coord last;
    for (int i = 0; i < 3; i++)
        last[i] = static_cast<int>(placement->size[i]) - 1;

    const FloatGrid::Ptr grid = FloatGrid::create(0.0f);
    const openvdb::tools::Dense<float, openvdb::tools::LayoutXYZ> dense(CoordBBox(Coord(), last),
                                                                        values);
    openvdb::tools::copyFromDense(dense, *grid, -1.0f); /* negative tolerance: no tiles */
    const auto transform = openvdb::math::Transform::createLinearTransform();
    transform->postScale(openvdb::Vec3d(placement->spacing));
    transform->postTranslate(openvdb::Vec3d(placement->origin));
    grid->setTransform(transform);
    grid->setName("density");
    grid->setGridClass(openvdb::GRID_FOG_VOLUME);

    openvdb::io::File file(path);
    file.setCompression(openvdb::io::COMPRESS_ZIP | openvdb::io::COMPRESS_ACTIVE_MASK);
    file.write({grid});
    file.close();
    replace_uuid(path, uuid);
}

int run_write(char **argv)
{
    try {
        openvdb::initialize();
        write_volume(argv[2], argv[3], argv[4]);
        return EX_OK;
    } catch (const std::bad_alloc &) {
        fprintf(stderr, "out of memory\n");
        return EX_OSERR;
    } catch (const std::exception &error) {
        fprintf(stderr, "%s\n", error.what());
    } catch (...) {
        fprintf(stderr, "OpenVDB failed without a message\n");
    }
    return EX_IOERR;
}

} // namespace

int main(int argc, char **argv)
{
    if ((argc == 9 || argc == 10) && strcmp(argv[1], "read") == 0)
        return run_read(argc, argv);
    if (argc == 5 && strcmp(argv[1], "write") == 0)
        return run_write(argv);
    fprintf(stderr, "neph-vdb is a part of neph, which runs it; scenes/volume_vdb.h explains\n");
    return EX_USAGE;
}
