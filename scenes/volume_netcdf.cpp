/* SPDX-License-Identifier: MIT
 *
 * The program neph-netcdf, the only code that uses NetCDF (scenes/volume_netcdf.h has the
 * protocol). No exception leaves it.
 */
#include "scenes/volume_netcdf.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

#include <netcdf.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sysexits.h>

namespace
{

/* Memory for libraries, stacks, and the file's own tables of contents. */
constexpr uint64_t base_memory_bytes = uint64_t{512} << 20;
constexpr size_t listed_names_max = 12;

/* A fault of the file, in words for the user; after a tab the way out. */
struct bad_file : std::runtime_error {
    using std::runtime_error::runtime_error;
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

void check(int status)
{
    if (status != NC_NOERR)
        throw bad_file(words("NetCDF says: %s", nc_strerror(status)));
}

struct request {
    const char *path;
    uint64_t memory_limit_bytes;
    int64_t side_max;
    int64_t time; /* -1: not given */
    const char *axes, *index_box, *variable;
    const char *radius; /* nullptr: none */
};

/* ---- the table of contents ------------------------------------------------------------------- */

struct dimension {
    int id;
    std::string name;
    size_t size;
};

struct variable {
    int id;
    std::string name;
    nc_type type;
    std::vector<dimension> dimensions;
};

class file
{
  public:
    explicit file(const char *path)
    {
        check(nc_open(path, NC_NOWRITE, &id));
    }
    ~file()
    {
        nc_close(id);
    }
    file(const file &) = delete;
    file &operator=(const file &) = delete;

    variable describe(int variable_id) const
    {
        char name[NC_MAX_NAME + 1] = "";
        int rank = 0, ids[NC_MAX_VAR_DIMS];
        variable of = {variable_id, "", NC_NAT, {}};
        check(nc_inq_var(id, variable_id, name, &of.type, &rank, ids, nullptr));
        of.name = name;
        for (int i = 0; i < rank; i++) {
            dimension each = {ids[i], "", 0};
            check(nc_inq_dim(id, ids[i], name, &each.size));
            each.name = name;
            of.dimensions.push_back(each);
        }
        return of;
    }

    std::vector<variable> list() const
    {
        int count = 0;
        check(nc_inq_nvars(id, &count));
        std::vector<variable> all;
        for (int i = 0; i < count; i++)
            all.push_back(describe(i));
        return all;
    }

    /* An attribute of text; "": there is none. */
    std::string text(int variable_id, const char *name) const
    {
        nc_type type = NC_NAT;
        size_t length = 0;
        if (nc_inq_att(id, variable_id, name, &type, &length) != NC_NOERR || type != NC_CHAR ||
            length > 4096)
            return "";
        std::string value(length, '\0');
        check(nc_get_att_text(id, variable_id, name, value.data()));
        return value.substr(0, value.find('\0'));
    }

    /* An attribute of one number. */
    bool number(int variable_id, const char *name, double &value) const
    {
        nc_type type = NC_NAT;
        size_t length = 0;
        return nc_inq_att(id, variable_id, name, &type, &length) == NC_NOERR && type != NC_CHAR &&
               length == 1 && nc_get_att_double(id, variable_id, name, &value) == NC_NOERR;
    }

    int id = -1;
};

std::string list_names(const std::vector<std::string> &names)
{
    std::string list;
    for (size_t i = 0; i < names.size() && i < listed_names_max; i++)
        list += words("%s'%.40s'", i > 0 ? ", " : "", names[i].c_str());
    return names.size() > listed_names_max ? list + ", ..." : list;
}

/* The variables that can be voxels. */
std::vector<std::string> list_volumes(const std::vector<variable> &all)
{
    std::vector<std::string> names;
    for (const variable &each : all)
        if (each.dimensions.size() >= 3)
            names.push_back(each.name);
    return names;
}

const variable &find_variable(const std::vector<variable> &all, std::string name, const char *key)
{
    const std::vector<std::string> volumes = list_volumes(all);
    if (volumes.empty())
        throw bad_file("it has no variable with three dimensions");
    if (name == "-" && volumes.size() == 1)
        name = volumes[0];
    for (const variable &each : all)
        if (each.name == name)
            return each;
    throw bad_file(words("%s; those with three dimensions are %s\tname one with the key %s",
                         name == "-" ? "it has several variables"
                                     : words("it has no variable '%.60s'", name.c_str()).c_str(),
                         list_names(volumes).c_str(), key));
}

/* ---- the length of a classic file ------------------------------------------------------------ */

/* The header of the classic formats (CDF-1, 2 and 5), as NetCDF's "File Format Specifications" has
 * it. The library reads zeros beyond the end of such a file, so its length is compared with the end
 * of the data that the header declares. */
class classic_header
{
  public:
    explicit classic_header(const char *path) : file(fopen(path, "rb"), fclose)
    {
        char magic[4] = {};
        if (!file || fread(magic, 1, 4, file.get()) != 4 || memcmp(magic, "CDF", 3) != 0)
            return;
        version = magic[3];
        records = count();
        std::vector<uint64_t> lengths = read_lengths();
        skip_attributes();
        read_variables(lengths);
    }

    /* The end of the data; 0 for files of another format. */
    uint64_t end() const
    {
        const bool is_counted = records != (version == 5 ? UINT64_MAX : UINT32_MAX);
        uint64_t last = fixed_end;
        if (records > 0 && is_counted && record_bytes > 0)
            last = std::max(last, records_end + (records - 1) * record_bytes);
        return last;
    }

  private:
    uint64_t number(int bytes)
    {
        unsigned char data[8] = {};
        if (fread(data, 1, static_cast<size_t>(bytes), file.get()) != static_cast<size_t>(bytes))
            throw bad_file("truncated: it ends in its header");
        uint64_t value = 0;
        for (int i = 0; i < bytes; i++)
            value = value << 8 | data[i];
        return value;
    }
    uint64_t count()
    {
        return number(version == 5 ? 8 : 4);
    }
    void skip(uint64_t bytes)
    {
        if (bytes > 1U << 30 || fseek(file.get(), static_cast<long>((bytes + 3) / 4 * 4), SEEK_CUR))
            throw bad_file("damaged: its header declares impossible lengths");
    }
    static uint64_t type_bytes(uint64_t type)
    {
        constexpr uint64_t bytes[] = {0, 1, 1, 2, 4, 4, 8, 1, 2, 4, 8, 8};
        return type < sizeof(bytes) / sizeof(bytes[0]) ? bytes[type] : 0;
    }
    std::vector<uint64_t> read_lengths()
    {
        std::vector<uint64_t> lengths;
        number(4); /* the tag of a list */
        for (uint64_t left = count(); left > 0; left--) {
            skip(count());
            lengths.push_back(count());
        }
        return lengths;
    }
    void skip_attributes()
    {
        number(4);
        for (uint64_t left = count(); left > 0; left--) {
            skip(count());
            const uint64_t type = number(4), values = count();
            skip(values > 1U << 30 ? UINT64_MAX : values * type_bytes(type));
        }
    }
    void read_variables(const std::vector<uint64_t> &lengths)
    {
        uint64_t record_variables = 0, unpadded = 0;
        number(4);
        for (uint64_t left = count(); left > 0; left--) {
            bool is_record = false;
            double values = 1.0;
            skip(count());
            const uint64_t rank = count();
            for (uint64_t i = 0; i < rank; i++) {
                const uint64_t id = count();
                if (id >= lengths.size())
                    throw bad_file("damaged: its header declares impossible dimensions");
                is_record |= i == 0 && lengths[id] == 0;
                values *= lengths[id] == 0 ? 1.0 : static_cast<double>(lengths[id]);
            }
            skip_attributes();
            const double bytes = values * static_cast<double>(type_bytes(number(4)));
            count(); /* vsize, which is wrong for large variables */
            const uint64_t begin = number(version == 1 ? 4 : 8);
            if (bytes > 1e15 || begin > UINT64_C(1) << 60)
                throw bad_file("damaged: its header declares impossible lengths");
            const uint64_t whole = static_cast<uint64_t>(bytes);
            (is_record ? records_end : fixed_end) = std::max(is_record ? records_end : fixed_end,
                                                             begin + whole);
            record_bytes += is_record ? (whole + 3) / 4 * 4 : 0;
            record_variables += is_record;
            unpadded = is_record ? whole : unpadded;
        }
        if (record_variables == 1)
            record_bytes = unpadded;
    }

    std::unique_ptr<FILE, int (*)(FILE *)> file;
    char version = 0;
    uint64_t records = 0, fixed_end = 0, records_end = 0, record_bytes = 0;
};

void check_length(const char *path)
{
    struct stat info = {};
    const uint64_t end = classic_header(path).end();
    if (stat(path, &info) == 0 && static_cast<uint64_t>(info.st_size) < end)
        throw bad_file(words("truncated: it has %lld bytes, and its header declares %llu",
                             static_cast<long long>(info.st_size),
                             static_cast<unsigned long long>(end)));
}

/* ---- dimensions ------------------------------------------------------------------------------ */

/* The position among the dimensions of a variable of those along x, y, z. */
using axes = std::array<size_t, 3>;

size_t find_dimension(const variable &of, const std::string &name)
{
    std::vector<std::string> names;
    for (size_t i = 0; i < of.dimensions.size(); i++) {
        if (of.dimensions[i].name == name)
            return i;
        names.push_back(of.dimensions[i].name);
    }
    throw bad_file(words("variable '%.60s' has no dimension '%.60s'; it has %s\t"
                         "axes names those along x, y, z, such as axes: \"x,y,z\"",
                         of.name.c_str(), name.c_str(), list_names(names).c_str()));
}

axes find_axes(const variable &of, const char *given)
{
    const size_t rank = of.dimensions.size();
    if (rank < 3)
        throw bad_file(
            words("variable '%.60s' has %zu dimensions; voxels have three", of.name.c_str(), rank));
    if (strcmp(given, "-") == 0)
        return {rank - 1, rank - 2, rank - 3};
    axes found = {};
    std::string rest = given;
    for (size_t i = 0; i < 3; i++) {
        const size_t comma = rest.find(',');
        if ((comma == std::string::npos) != (i == 2))
            throw bad_file("axes are three names\tsuch as axes: \"x,y,z\"");
        found[i] = find_dimension(of, rest.substr(0, comma));
        rest = i < 2 ? rest.substr(comma + 1) : "";
    }
    if (found[0] == found[1] || found[1] == found[2] || found[0] == found[2])
        throw bad_file("axes name a dimension twice");
    return found;
}

/* The block of a variable that is read: all of x, y, z or a box, and one place along others. */
struct slab {
    axes along;
    std::vector<size_t> start, count;
};

size_t choose_time(const variable &of, const dimension &time, const request &of_neph)
{
    if (time.size == 1 && of_neph.time < 0)
        return 0;
    if (of_neph.time < 0)
        throw bad_file(words("variable '%.60s' has %zu places along '%.60s'\tchoose one with "
                             "time_index: 0 to %zu",
                             of.name.c_str(), time.size, time.name.c_str(), time.size - 1));
    if (static_cast<uint64_t>(of_neph.time) >= time.size)
        throw bad_file(words("time_index %lld is outside 0 to %zu, the places along '%.60s'",
                             static_cast<long long>(of_neph.time), time.size - 1,
                             time.name.c_str()));
    return static_cast<size_t>(of_neph.time);
}

void apply_box(const variable &of, const char *text, slab &block)
{
    long long first[3], last[3];
    if (sscanf(text, "%lld,%lld,%lld,%lld,%lld,%lld", &first[0], &first[1], &first[2], &last[0],
               &last[1], &last[2]) != 6)
        throw std::runtime_error("an index box is six numbers");
    for (size_t i = 0; i < 3; i++) {
        const dimension &along = of.dimensions[block.along[i]];
        if (first[i] < 0 || last[i] < first[i] || last[i] >= static_cast<long long>(along.size))
            throw bad_file(words("index_box reaches from %lld to %lld along '%.60s', which has 0 "
                                 "to %zu",
                                 first[i], last[i], along.name.c_str(), along.size - 1));
        block.start[block.along[i]] = static_cast<size_t>(first[i]);
        block.count[block.along[i]] = static_cast<size_t>(last[i] - first[i] + 1);
    }
}

slab choose_slab(const variable &of, const request &of_neph)
{
    slab block = {find_axes(of, of_neph.axes), {}, {}};
    bool has_time = false;
    for (size_t i = 0; i < of.dimensions.size(); i++) {
        const dimension &each = of.dimensions[i];
        const bool is_axis = i == block.along[0] || i == block.along[1] || i == block.along[2];
        if (each.size == 0)
            throw bad_file(words("dimension '%.60s' is empty", each.name.c_str()));
        if (!is_axis && each.size > 1 && has_time)
            throw bad_file(words("variable '%.60s' has two dimensions beside x, y, z\twrite a file "
                                 "with one of their places, such as with ncks -d",
                                 of.name.c_str()));
        const bool is_time = !is_axis && (each.size > 1 || !has_time);
        block.start.push_back(is_axis ? 0 : is_time ? choose_time(of, each, of_neph) : 0);
        block.count.push_back(is_axis ? each.size : 1);
        has_time |= !is_axis && each.size > 1;
    }
    if (strcmp(of_neph.index_box, "all") != 0)
        apply_box(of, of_neph.index_box, block);
    return block;
}

void check_size(const slab &block, const request &of_neph, int variables)
{
    double nodes = 1.0;
    for (size_t i = 0; i < 3; i++) {
        const size_t side = block.count[block.along[i]];
        nodes *= static_cast<double>(side);
        if (static_cast<int64_t>(side) > of_neph.side_max)
            throw bad_file(words("%zu nodes along %c; a side may have at most %lld\tread a part of "
                                 "it with the key index_box",
                                 side, "xyz"[i], static_cast<long long>(of_neph.side_max)));
    }
    const double bytes = nodes * variables * sizeof(float);
    if (bytes > static_cast<double>(of_neph.memory_limit_bytes))
        throw bad_file(words("its values need %.0f MiB of memory, and the limit is %.0f MiB\t"
                             "read a part of it with the key index_box",
                             bytes / 0x1p20,
                             static_cast<double>(of_neph.memory_limit_bytes) / 0x1p20));
}

/* ---- values ---------------------------------------------------------------------------------- */

/* The numbers that stand for missing values. */
std::vector<double> list_missing(const file &in, const variable &of)
{
    std::vector<double> list;
    double value = 0.0;
    for (const char *name : {"_FillValue", "missing_value"})
        if (in.number(of.id, name, value))
            list.push_back(value);
    if (!in.number(of.id, "_FillValue", value)) {
        if (of.type == NC_FLOAT)
            list.push_back(static_cast<double>(NC_FILL_FLOAT));
        if (of.type == NC_DOUBLE)
            list.push_back(NC_FILL_DOUBLE);
        if (of.type == NC_SHORT)
            list.push_back(NC_FILL_SHORT);
        if (of.type == NC_INT)
            list.push_back(NC_FILL_INT);
    }
    return list;
}

struct unpacking {
    double scale = 1.0, offset = 0.0;
    std::vector<double> missing;
};

bool is_missing(double value, const unpacking &by)
{
    for (const double missing : by.missing)
        if (value == missing)
            return true;
    return std::isnan(value);
}

/* Reads the block a plane of its slowest dimension at a time. */
std::vector<float> read_values(const file &in, const variable &of, const slab &block)
{
    const size_t rank = of.dimensions.size();
    unpacking by;
    in.number(of.id, "scale_factor", by.scale);
    in.number(of.id, "add_offset", by.offset);
    by.missing = list_missing(in, of);
    if (of.type == NC_CHAR || of.type == NC_STRING || of.type > NC_STRING)
        throw bad_file(words("variable '%.60s' has no numbers", of.name.c_str()));

    size_t strides[3] = {1, block.count[block.along[0]], 0}, all = 1, plane = 1, slowest = rank;
    strides[2] = strides[1] * block.count[block.along[1]];
    std::vector<size_t> steps(rank, 0); /* in the result */
    for (size_t i = 0; i < 3; i++)
        steps[block.along[i]] = strides[i];
    for (size_t i = 0; i < rank; i++) {
        all *= block.count[i];
        if (slowest == rank && steps[i] > 0)
            slowest = i;
        else
            plane *= block.count[i];
    }
    std::vector<float> values(all);
    std::vector<double> buffer(plane);
    std::vector<size_t> start = block.start, count = block.count;
    count[slowest] = 1;
    size_t missing = 0, first_missing = 0;
    for (size_t k = 0; k < block.count[slowest]; k++) {
        start[slowest] = block.start[slowest] + k;
        check(nc_get_vara_double(in.id, of.id, start.data(), count.data(), buffer.data()));
        std::vector<size_t> at(rank, 0);
        for (size_t n = 0; n < plane; n++) {
            size_t to = k * steps[slowest];
            for (size_t i = 0; i < rank; i++)
                to += at[i] * steps[i];
            if (is_missing(buffer[n], by) && missing++ == 0)
                first_missing = to;
            values[to] = static_cast<float>(buffer[n] * by.scale + by.offset);
            for (size_t i = rank; i-- > 0 && ++at[i] == count[i];)
                at[i] = 0;
        }
    }
    if (missing > 0)
        throw bad_file(words("variable '%.60s' has %zu missing values, the first at index (%zu, "
                             "%zu, %zu) along x, y, z\tfill them, such as with cdo setmisstoc,0 "
                             "in.nc out.nc, or leave them out with index_box",
                             of.name.c_str(), missing, first_missing % strides[1],
                             first_missing / strides[1] % block.count[block.along[1]],
                             first_missing / strides[2]));
    return values;
}

/* The coordinate variable of a dimension: of its name, along nothing else. */
std::vector<double> read_coordinates(const file &in, const std::vector<variable> &all,
                                     const dimension &along, size_t start, size_t count,
                                     neph_netcdf_axis &axis)
{
    std::vector<double> values(count);
    for (size_t i = 0; i < count; i++)
        values[i] = static_cast<double>(start + i);
    snprintf(axis.name, sizeof(axis.name), "%s", along.name.c_str());
    axis.size = static_cast<int64_t>(count);
    for (const variable &each : all) {
        if (each.name != along.name || each.dimensions.size() != 1 ||
            each.dimensions[0].id != along.id || each.type == NC_CHAR)
            continue;
        check(nc_get_vara_double(in.id, each.id, &start, &count, values.data()));
        axis.has_coordinates = 1;
        snprintf(axis.unit, sizeof(axis.unit), "%s", in.text(each.id, "units").c_str());
    }
    return values;
}

/* ---- all ------------------------------------------------------------------------------------- */

void put(FILE *out, const void *data, size_t size)
{
    if (fwrite(data, 1, size, out) != size)
        throw std::runtime_error("the memory for voxels cannot be written");
}

void read_volume(const char *voxels, const request &of_neph)
{
    check_length(of_neph.path);
    const file in(of_neph.path);
    const std::vector<variable> all = in.list();
    std::vector<const variable *> chosen = {&find_variable(all, of_neph.variable, "grid")};
    if (of_neph.radius)
        chosen.push_back(&find_variable(all, of_neph.radius, "radius_grid"));
    neph_netcdf_header header = {};
    header.variable_count = static_cast<int64_t>(chosen.size());
    std::vector<slab> blocks;
    for (size_t v = 0; v < chosen.size(); v++) {
        blocks.push_back(choose_slab(*chosen[v], of_neph));
        snprintf(header.names[v], sizeof(header.names[v]), "%s", chosen[v]->name.c_str());
        snprintf(header.units[v], sizeof(header.units[v]), "%s",
                 in.text(chosen[v]->id, "units").c_str());
        for (size_t i = 0; i < 3; i++)
            if (chosen[v]->dimensions[blocks[v].along[i]].id !=
                chosen[0]->dimensions[blocks[0].along[i]].id)
                throw bad_file(words("variables '%.60s' and '%.60s' have other dimensions",
                                     chosen[0]->name.c_str(), chosen[v]->name.c_str()));
    }
    check_size(blocks[0], of_neph, static_cast<int>(chosen.size()));
    std::vector<double> coordinates[3];
    for (size_t i = 0; i < 3; i++) {
        const size_t along = blocks[0].along[i];
        coordinates[i] = read_coordinates(in, all, chosen[0]->dimensions[along],
                                          blocks[0].start[along], blocks[0].count[along],
                                          header.axes[i]);
    }
    FILE *out = fopen(voxels, "wb");
    if (!out)
        throw std::runtime_error("the memory for voxels cannot be opened");
    put(out, &header, sizeof(header));
    for (const std::vector<double> &each : coordinates)
        put(out, each.data(), each.size() * sizeof(double));
    for (size_t v = 0; v < chosen.size(); v++) {
        const std::vector<float> values = read_values(in, *chosen[v], blocks[v]);
        put(out, values.data(), values.size() * sizeof(float));
    }
    if (fclose(out) != 0)
        throw std::runtime_error("the memory for voxels cannot be written");
}

void limit_resource(int resource, uint64_t maximum)
{
    const rlimit both = {maximum, maximum};
    if (setrlimit(static_cast<__rlimit_resource>(resource), &both) != 0)
        throw std::runtime_error("setrlimit failed");
}

int run_read(int argc, char **argv)
{
    const request of_neph = {argv[3],
                             strtoull(argv[4], nullptr, 10),
                             strtoll(argv[6], nullptr, 10),
                             strtoll(argv[7], nullptr, 10),
                             argv[8],
                             argv[9],
                             argv[10],
                             argc > 11 ? argv[11] : nullptr};
    try {
        limit_resource(RLIMIT_CORE, 0);
        limit_resource(RLIMIT_CPU, strtoull(argv[5], nullptr, 10));
        limit_resource(RLIMIT_AS, base_memory_bytes + 3 * of_neph.memory_limit_bytes);
        read_volume(argv[2], of_neph);
        return EX_OK;
    } catch (const std::bad_alloc &) {
        fprintf(stderr, "damaged, or it needs far more memory than the limit of %.0f MiB\n",
                static_cast<double>(of_neph.memory_limit_bytes) / 0x1p20);
    } catch (const std::exception &error) {
        fprintf(stderr, "%s\n", error.what());
    } catch (...) {
        fprintf(stderr, "NetCDF failed without a message\n");
    }
    return EX_DATAERR;
}

} // namespace

int main(int argc, char **argv)
{
    if (argc >= 11 && argc <= 12 && strcmp(argv[1], "read") == 0)
        return run_read(argc, argv);
    fprintf(stderr, "neph runs this program to read NetCDF files\n");
    return EX_USAGE;
}
