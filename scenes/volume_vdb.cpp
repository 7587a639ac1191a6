/* SPDX-License-Identifier: MIT
 *
 * The program neph-vdb: the one place that knows OpenVDB (scenes/volume_vdb.h says why it is a
 * program). No exception leaves it.
 */
#include "scenes/volume_vdb.h"
#include "scenes/openvdb_grids.h"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <fstream>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
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

/* Libraries, stacks, and the file's own tables of contents. */
constexpr uint64_t base_memory_bytes = uint64_t{512} << 20;
constexpr int32_t grids_max = 1024;
constexpr size_t listed_names_max = 8;

/* Off the diagonal of a transform, relative to its scale: rounding of a rotation by zero. */
constexpr double shear_max = 1e-9;

/* The file is to blame, in words for its owner. */
struct bad_file : std::runtime_error {
    using std::runtime_error::runtime_error;
};

[[gnu::format(printf, 1, 2)]] std::string words(const char *format, ...)
{
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof(text), format, arguments);
    va_end(arguments);
    return text;
}

void limit(int resource, uint64_t maximum)
{
    const rlimit both = {maximum, maximum};
    if (setrlimit(static_cast<__rlimit_resource>(resource), &both) != 0)
        throw std::runtime_error("setrlimit failed");
}

/* ---- the table of contents ------------------------------------------------------------------- */

struct entry {
    openvdb::io::GridDescriptor descriptor;
    openvdb::GridBase::Ptr grid; /* empty */

    std::string name() const
    {
        return openvdb::io::GridDescriptor::nameAsString(descriptor.uniqueName());
    }
};

/* openvdb::io::File never asks whether a read came short, and would fill a truncated grid with what
 * happens to be in memory. This reads the same way from a stream that throws at the end of the
 * file, and stops between the topology and the voxels to look at the size. */
class archive : openvdb::io::Archive
{
  public:
    explicit archive(const char *path)
    {
        stream.exceptions(std::ios::failbit | std::ios::badbit | std::ios::eofbit);
        stream.open(path, std::ios::binary);
        readHeader(stream);
        openvdb::io::setStreamMetadataPtr(stream, state, false);
        setFormatVersion(stream); /* which the parts of the file ask for */
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
            throw bad_file(words("it says that it holds %d grids", count));
        std::vector<entry> entries(static_cast<size_t>(count));
        for (entry &each : entries) {
            each.grid = each.descriptor.read(stream);
            each.descriptor.seekToEnd(stream);
        }
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

std::string list_names(const std::vector<entry> &entries)
{
    std::string list;
    for (size_t i = 0; i < entries.size() && i < listed_names_max; i++)
        list += words("%s'%.40s'", i > 0 ? ", " : "", entries[i].name().c_str());
    return entries.size() > listed_names_max ? list + ", ..." : list;
}

entry &choose(std::vector<entry> &entries, const char *wanted)
{
    if (entries.empty())
        throw bad_file("it holds no grid");
    if (!wanted && entries.size() == 1)
        return entries[0];
    const std::string name = wanted ? wanted : "density";
    for (entry &each : entries)
        if (each.name() == name)
            return each;
    throw bad_file(
        words("it has no grid '%.60s'; it has %s", name.c_str(), list_names(entries).c_str()));
}

/* ---- what a density must be ------------------------------------------------------------------ */

void check_kind(const entry &chosen)
{
    const openvdb::GridBase &grid = *chosen.grid;
    const std::string name = chosen.name();
    if (!grid.isType<FloatGrid>())
        throw bad_file(words("grid '%.60s' is of type %.60s; only grids of float or half can be a "
                             "density",
                             name.c_str(), grid.type().c_str()));
    if (chosen.descriptor.isInstance())
        throw bad_file(words("grid '%.60s' only repeats grid '%.60s' in another place",
                             name.c_str(), chosen.descriptor.instanceParentName().c_str()));
}

/* Whether a medium may have this class is known after its metadata is read. */
void check_class(const entry &chosen)
{
    const openvdb::GridClass grid_class = chosen.grid->getGridClass();
    if (grid_class != openvdb::GRID_FOG_VOLUME && grid_class != openvdb::GRID_UNKNOWN)
        throw bad_file(words("grid '%.60s' is a %s, not a fog volume", chosen.name().c_str(),
                             openvdb::GridBase::gridClassToMenuName(grid_class).c_str()));
}

/* index * spacing + origin, or a refusal. */
void get_placement(const entry &chosen, double origin[3], double spacing[3])
{
    const std::string name = chosen.name();
    const openvdb::math::MapBase::ConstPtr map = chosen.grid->transform().baseMap();
    if (!map->isLinear())
        throw bad_file(words("grid '%.60s' is placed by a frustum; only scale and translation are "
                             "possible",
                             name.c_str()));
    const openvdb::math::Mat4d m = map->getAffineMap()->getMat4();
    for (int i = 0; i < 3; i++) {
        spacing[i] = m(i, i);
        origin[i] = m(3, i);
        for (int j = 0; j < 3; j++)
            if (i != j && !(std::fabs(m(i, j)) <= shear_max * std::fabs(m(i, i))))
                throw bad_file(words("grid '%.60s' is rotated or sheared; only scale and "
                                     "translation are possible",
                                     name.c_str()));
        if (!(spacing[i] > 0.0) || !std::isfinite(spacing[i]) || !std::isfinite(origin[i]))
            throw bad_file(words("grid '%.60s' has the scale %g and the offset %g on axis %c; the "
                                 "scale must be above 0 and both finite",
                                 name.c_str(), spacing[i], origin[i], "xyz"[i]));
    }
}

void check_size(const CoordBBox &box, uint64_t memory_limit_bytes)
{
    double sides[3];
    for (int i = 0; i < 3; i++)
        sides[i] = static_cast<double>(box.max()[i]) - box.min()[i] + 1.0;
    const double bytes = sides[0] * sides[1] * sides[2] * sizeof(float);
    if (!(bytes <= static_cast<double>(memory_limit_bytes)))
        throw bad_file(words("%.0f x %.0f x %.0f nodes need %.0f MiB of memory, and the limit is "
                             "%.0f MiB; resample the volume to fewer nodes",
                             sides[0], sides[1], sides[2], bytes / 0x1p20,
                             static_cast<double>(memory_limit_bytes) / 0x1p20));
}

/* What the metadata promise, so that a giant is refused before its topology is read. */
void check_promised_size(const entry &chosen, uint64_t memory_limit_bytes)
{
    const auto low = chosen.grid->getMetadata<openvdb::Vec3IMetadata>("file_bbox_min");
    const auto high = chosen.grid->getMetadata<openvdb::Vec3IMetadata>("file_bbox_max");
    if (low && high && low->value()[0] <= high->value()[0])
        check_size(CoordBBox(Coord(low->value()), Coord(high->value())), memory_limit_bytes);
}

void check_voxel_count(const entry &chosen, const FloatTree &tree)
{
    const auto promised = chosen.grid->getMetadata<openvdb::Int64Metadata>("file_voxel_count");
    const auto found = static_cast<int64_t>(tree.activeVoxelCount());
    if (promised && promised->value() != found)
        throw bad_file(words("damaged: it says that grid '%.60s' has %lld active voxels, and %lld "
                             "are there",
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

/* The voxels of one grid on their way out. */
class exporter
{
  public:
    exporter(block_writer &to, const CoordBBox &active) : out(to), box(active)
    {
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

    void leaf(const FloatTree::LeafNodeType &node)
    {
        neph_vdb_block block;
        if (!start_block(node.getNodeBoundingBox(), block))
            return;
        float values[FloatTree::LeafNodeType::SIZE];
        size_t count = 0;
        const Coord corner = box.min();
        for (int k = block.first[2]; k <= block.last[2]; k++)
            for (int j = block.first[1]; j <= block.last[1]; j++)
                for (int i = block.first[0]; i <= block.last[0]; i++)
                    values[count++] = node.getValue(corner.offsetBy(i, j, k));
        out.put(&block, sizeof(block));
        out.put(values, count * sizeof(values[0]));
    }

  private:
    /* Cut to the box; false when nothing is left. A tree whose nodes overlap is damaged, and would
     * take more time to copy than its size allows. */
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
            block.first[i] = where.min()[i] - box.min()[i];
            block.last[i] = where.max()[i] - box.min()[i];
        }
        return true;
    }

    block_writer &out;
    const CoordBBox box;
    uint64_t covered = 0;
};

void export_voxels(const FloatTree &tree, const CoordBBox &box, block_writer &out)
{
    exporter to(out, box);
    FloatTree::ValueAllCIter tile = tree.cbeginValueAll();
    tile.setMaxDepth(FloatTree::ValueAllCIter::LEAF_DEPTH - 1);
    for (; tile; ++tile)
        to.tile(tile.getBoundingBox(), *tile);
    for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf)
        to.leaf(*leaf);
}

neph_vdb_placement placement_of(const entry &chosen, const CoordBBox &box)
{
    neph_vdb_placement placement;
    get_placement(chosen, placement.origin, placement.spacing);
    for (int i = 0; i < 3; i++) {
        placement.origin[i] += placement.spacing[i] * box.min()[i];
        placement.size[i] = box.dim()[i];
    }
    return placement;
}

void read_volume(const char *voxels, const char *path, uint64_t memory_limit_bytes,
                 const char *grid_name)
{
    archive file(path);
    std::vector<entry> entries = file.contents();
    entry &chosen = choose(entries, grid_name);
    check_kind(chosen);
    file.read_metadata(chosen);
    check_class(chosen);
    check_promised_size(chosen, memory_limit_bytes);
    file.read_topology(chosen);

    const FloatTree &tree = openvdb::gridConstPtrCast<FloatGrid>(chosen.grid)->tree();
    if (tree.background() != 0.0f)
        throw bad_file(words("grid '%.60s' has a density of %g everywhere outside its voxels; it "
                             "must be 0",
                             chosen.name().c_str(), static_cast<double>(tree.background())));
    CoordBBox box;
    if (!tree.evalActiveVoxelBoundingBox(box))
        throw bad_file(words("grid '%.60s' has no active voxel", chosen.name().c_str()));
    check_size(box, memory_limit_bytes);
    check_voxel_count(chosen, tree);
    const neph_vdb_placement placement = placement_of(chosen, box);

    file.read_voxels(chosen);
    block_writer out(voxels);
    out.put(&placement, sizeof(placement));
    export_voxels(tree, box, out);
    out.finish();
}

int run_read(int argc, char **argv)
{
    const uint64_t memory_limit_bytes = strtoull(argv[4], nullptr, 10);
    /* A thread asks for tens of MiB of addresses, and some machines have hundreds of processors. */
    const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
    mallopt(M_ARENA_MAX, 1);
    try {
        limit(RLIMIT_CORE, 0);
        limit(RLIMIT_CPU, strtoull(argv[5], nullptr, 10));
        limit(RLIMIT_AS, base_memory_bytes + 3 * memory_limit_bytes);
        openvdb::initialize();
    } catch (const std::exception &error) {
        fprintf(stderr, "OpenVDB does not start: %s\n", error.what());
        return EX_OSERR;
    }
    try {
        read_volume(argv[2], argv[3], memory_limit_bytes, argc > 6 ? argv[6] : nullptr);
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
        fprintf(stderr, "OpenVDB failed without a word\n");
    }
    return EX_DATAERR;
}

/* ---- writing --------------------------------------------------------------------------------- */

/* OpenVDB puts a random UUID into each file. The same grid shall give the same bytes. */
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
    openvdb::tools::copyFromDense(dense, *grid, -1.0f); /* no tolerance at all: no tiles */
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
        fprintf(stderr, "OpenVDB failed without a word\n");
    }
    return EX_IOERR;
}

} // namespace

int main(int argc, char **argv)
{
    if ((argc == 6 || argc == 7) && strcmp(argv[1], "read") == 0)
        return run_read(argc, argv);
    if (argc == 5 && strcmp(argv[1], "write") == 0)
        return run_write(argv);
    fprintf(stderr, "neph-vdb is a part of neph, which runs it; scenes/volume_vdb.h explains\n");
    return EX_USAGE;
}
