/* SPDX-License-Identifier: MIT
 *
 * The program neph-mesh, the only code that uses Assimp (scenes/mesh_program.h has the protocol).
 * No exception leaves it.
 */
#include "scenes/mesh_program.h"
#include "scenes/mesh_check.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <fstream>
#include <limits>
#include <memory>
#include <new>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sysexits.h>
#include <unistd.h>

#include <assimp/BaseImporter.h>
#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

namespace
{

/* Memory for libraries, stacks, and lists of fixed size. */
constexpr uint64_t base_memory_bytes = uint64_t{512} << 20;
constexpr size_t listed_names_max = 8;

/* Largest error of a coordinate by rounding, in sizes of the mesh. */
constexpr double error_max = 1e-4;

/* The arguments from neph. */
struct request {
    const char *path;
    uint64_t limit_bytes;
    int64_t triangles_max;
    const char *object; /* nullptr: all */
};

/* ---- files ----------------------------------------------------------------------------------- */

std::string real_path(const std::string &path)
{
    const std::unique_ptr<char, decltype(&free)> real(realpath(path.c_str(), nullptr), free);
    return real ? real.get() : "";
}

class stream : public Assimp::IOStream
{
  public:
    stream(FILE *opened, size_t bytes) : file(opened), size_bytes(bytes)
    {
    }
    ~stream() override
    {
        fclose(file);
    }
    stream(const stream &) = delete;
    stream &operator=(const stream &) = delete;

    size_t Read(void *to, size_t size, size_t count) override
    {
        return fread(to, size, count, file);
    }
    size_t Write(const void *, size_t, size_t) override
    {
        return 0;
    }
    aiReturn Seek(size_t offset, aiOrigin origin) override
    {
        constexpr int from[] = {SEEK_SET, SEEK_CUR, SEEK_END};
        return fseek(file, static_cast<long>(offset), from[origin]) == 0 ? aiReturn_SUCCESS
                                                                         : aiReturn_FAILURE;
    }
    size_t Tell() const override
    {
        return static_cast<size_t>(ftell(file));
    }
    size_t FileSize() const override
    {
        return size_bytes;
    }
    void Flush() override
    {
    }

  private:
    FILE *file;
    size_t size_bytes;
};

/* The mesh file, and the buffers of a glTF file below its folder. */
class folder_files : public Assimp::IOSystem
{
  public:
    folder_files(const std::string &mesh_path, bool has_buffers, uint64_t limit)
        : path(mesh_path), opens_buffers(has_buffers), left_bytes(limit)
    {
        const size_t slash = path.rfind('/');
        named_folder = slash == std::string::npos ? "" : path.substr(0, slash + 1);
        folder = real_path(named_folder.empty() ? "." : named_folder);
    }
    bool Exists(const char *name) const override
    {
        return name == path || opens_buffers; /* else Open() says it */
    }
    char getOsSeparator() const override
    {
        return '/';
    }
    /* Importers ignore files that they do not find, or say it in other words: check() throws. */
    Assimp::IOStream *Open(const char *asked, const char *mode) override
    {
        if (mode[0] != 'r' || (asked != path && !opens_buffers))
            return nullptr;
        const std::string found = asked == path || access(asked, F_OK) == 0 ? asked : decode(asked);
        const char *name = found.c_str();
        const std::string fault = name == path ? "" : find_fault(name);
        struct stat info = {};
        FILE *file = fault.empty() ? open_regular(name, info) : nullptr;
        if (file)
            return new stream(file, static_cast<size_t>(info.st_size));
        if (first_fault.empty())
            first_fault = fault.empty() ? words("'%.300s' cannot be opened", shown(name)) : fault;
        return nullptr;
    }
    void Close(Assimp::IOStream *opened) override
    {
        delete opened;
    }
    void check() const
    {
        if (!first_fault.empty())
            throw bad_file(first_fault);
    }

  private:
    /* "%20" of a URI is a space. */
    static std::string decode(const std::string &uri)
    {
        std::string text;
        for (size_t i = 0; i < uri.size(); i++) {
            unsigned byte = 0;
            const bool is_coded = uri[i] == '%' && i + 2 < uri.size() &&
                                  isxdigit(static_cast<unsigned char>(uri[i + 1])) &&
                                  isxdigit(static_cast<unsigned char>(uri[i + 2])) &&
                                  sscanf(uri.c_str() + i + 1, "%2x", &byte) == 1;
            text += is_coded ? static_cast<char>(byte) : uri[i];
            i += is_coded ? 2 : 0;
        }
        return text;
    }
    const char *shown(const char *name) const
    {
        return strncmp(name, named_folder.c_str(), named_folder.size()) == 0
                   ? name + named_folder.size()
                   : name;
    }
    std::string find_fault(const char *name) const
    {
        const std::string real = real_path(name);
        if (shown(name)[0] == '/' ||
            (!real.empty() && real.compare(0, folder.size() + 1, folder + "/") != 0))
            return words("it names '%.300s', which is outside its folder\tcopy that file beside it "
                         "and name it there",
                         shown(name));
        if (real.empty())
            return words("it names '%.300s', which does not exist in its folder", shown(name));
        return "";
    }
    /* O_NONBLOCK: a named pipe must be refused, not waited for. */
    FILE *open_regular(const char *name, struct stat &info)
    {
        const int fd = open(name, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
        const bool is_fine = fd >= 0 && fstat(fd, &info) == 0 && S_ISREG(info.st_mode) &&
                             static_cast<uint64_t>(info.st_size) <= left_bytes;
        FILE *file = is_fine ? fdopen(fd, "rb") : nullptr;
        if (!file && fd >= 0)
            close(fd);
        if (file && name != path)
            left_bytes -= static_cast<uint64_t>(info.st_size);
        return file;
    }

    std::string path, named_folder, folder, first_fault;
    bool opens_buffers;
    uint64_t left_bytes;
};

/* ---- the formats ----------------------------------------------------------------------------- */

/* A line with those that continue it; `count` is how many. */
bool read_obj_line(std::istream &file, std::string &line, long &count)
{
    std::string more;
    line.clear();
    for (count = 0; std::getline(file, more); line.back() = ' ') {
        count++;
        line += more;
        if (!line.empty() && line.back() == '\r')
            line.pop_back();
        if (line.empty() || line.back() != '\\')
            return true;
    }
    return count > 0;
}

/* Numbers of a line as Assimp 5.2 counts them: words that begin with a digit or a sign. */
int count_numbers(const std::string &line)
{
    int count = 0;
    for (size_t i = 1; i < line.size() && line[i] != '#'; i++)
        count += strchr(" \t", line[i - 1]) && line[i] != 0 && strchr("0123456789+-", line[i]);
    return count;
}

/* Assimp 5.2 leaves out a vertex that has not 3, 4 or 6 numbers, so that faces name others, and
 * reads 0x1 as 0. */
int64_t check_obj_vertices(const char *path, const mesh_limits &limits)
{
    const int64_t faces = check_obj(path, limits);
    std::ifstream file(path, std::ios::binary);
    std::string line;
    for (long number = 1, lines = 0; read_obj_line(file, line, lines); number += lines) {
        const char *text = line.c_str() + strspn(line.c_str(), " \t");
        if (text[0] != 'v' || (text[1] != ' ' && text[1] != '\t'))
            continue;
        const int count = count_numbers(line);
        if ((count != 3 && count != 4 && count != 6) || strcspn(text, "xX#") < strcspn(text, "#"))
            throw bad_file(words("line %ld, '%.60s': Assimp would leave this vertex out\twrite 3 "
                                 "numbers, each with a digit before its point, and after them "
                                 "nothing, a weight, or a colour of 3",
                                 number, line.c_str()));
    }
    return faces;
}

/* Assimp 5.2 reads a part of the strips of a PLY file, or none. */
int64_t check_ply_faces(const char *path, const mesh_limits &limits)
{
    const int64_t faces = check_ply(path, limits);
    std::ifstream file(path, std::ios::binary);
    std::string line;
    while (std::getline(file, line) && line.compare(0, 10, "end_header") != 0)
        if (line.compare(0, 17, "element tristrips") == 0)
            throw bad_file("its triangles are strips ('element tristrips')\twrite them as faces");
    return faces;
}

struct format {
    const char *extension;
    const char *importer; /* the start of its name in Assimp */
    bool has_buffers;
    int64_t (*check)(const char *path, const mesh_limits &limits);
};

constexpr format formats[] = {
    {".obj", "Wavefront Object Importer", false, check_obj_vertices},
    {".ply", "Stanford Polygon Library (PLY) Importer", false, check_ply_faces},
    {".gltf", "glTF2 Importer", true, check_gltf},
    {".glb", "glTF2 Importer", true, check_gltf},
};

const format &find_format(const std::string &path)
{
    for (const format &each : formats) {
        const size_t length = strlen(each.extension);
        if (path.size() > length &&
            strcasecmp(path.c_str() + path.size() - length, each.extension) == 0)
            return each;
    }
    throw bad_file("its name must end in .obj, .ply, .gltf or .glb");
}

/* Assimp has 50 importers, and takes another one than the name's for some contents. */
void keep_importer(Assimp::Importer &assimp, const char *name)
{
    std::vector<Assimp::BaseImporter *> others;
    for (size_t i = 0; i < assimp.GetImporterCount(); i++)
        if (strncmp(assimp.GetImporterInfo(i)->mName, name, strlen(name)) != 0)
            others.push_back(assimp.GetImporter(i));
    for (Assimp::BaseImporter *other : others) {
        assimp.UnregisterLoader(other);
        delete other;
    }
    if (assimp.GetImporterCount() != 1)
        throw std::runtime_error(
            words("Assimp has %zu importers '%s'", assimp.GetImporterCount(), name));
}

/* ---- triangles ------------------------------------------------------------------------------- */

using matrix = aiMatrix4x4t<double>;

class triangles
{
  public:
    explicit triangles(const request &of_neph) : from(of_neph), table(1024, 0)
    {
    }

    void add(const aiScene &scene)
    {
        find_parts(scene, *scene.mRootNode, matrix(), !from.object);
        if (!is_found)
            throw bad_file(words("it has no object '%.60s'; %s%s", from.object,
                                 names.empty() ? "none has a name" : "it has ",
                                 list_names().c_str()));
        for (const part &each : parts) {
            has_normals &= has_vectors(*each.mesh, each.mesh->mNormals, 1e-12f);
            has_uv &= has_vectors(*each.mesh, each.mesh->mTextureCoords[0], 0.0f);
        }
        check_steps();
        for (const part &each : parts)
            add_mesh(*each.mesh, each.placed);
        if (indices.empty())
            throw bad_file("it has no triangles");
        const double bytes = static_cast<double>(corners.size() * sizeof(corners[0]) +
                                                 indices.size() * sizeof(indices[0]));
        if (bytes + sizeof(neph_mesh_header) > static_cast<double>(from.limit_bytes))
            throw bad_file(words("its mesh needs %.0f MiB of memory, and the limit is %.0f MiB",
                                 bytes / 0x1p20, static_cast<double>(from.limit_bytes) / 0x1p20));
    }

    void write(const char *mesh_path) const
    {
        const neph_mesh_header header = {static_cast<int64_t>(corners.size()),
                                         static_cast<int64_t>(indices.size() / 3), has_normals,
                                         has_uv};
        std::ofstream out(mesh_path, std::ios::binary);
        out.exceptions(std::ios::failbit | std::ios::badbit);
        out.write(reinterpret_cast<const char *>(&header), sizeof(header));
        out.write(reinterpret_cast<const char *>(corners.data()),
                  static_cast<std::streamsize>(corners.size() * sizeof(corners[0])));
        out.write(reinterpret_cast<const char *>(indices.data()),
                  static_cast<std::streamsize>(indices.size() * sizeof(indices[0])));
        out.close();
    }

  private:
    /* A mesh at a node, with the node's transform. */
    struct part {
        const aiMesh *mesh;
        matrix placed;
    };

    /* The meshes at and below a node, if the object is the node, one above it, or the mesh. */
    void find_parts(const aiScene &scene, const aiNode &node, const matrix &parent, bool is_inside)
    {
        const matrix placed = parent * matrix(node.mTransformation);
        is_inside |= is_object(node.mName);
        for (unsigned i = 0; i < node.mNumMeshes; i++) {
            const aiMesh &mesh = *scene.mMeshes[node.mMeshes[i]];
            if (is_object(mesh.mName) || is_inside)
                parts.push_back({&mesh, placed});
        }
        for (unsigned i = 0; i < node.mNumChildren; i++)
            find_parts(scene, *node.mChildren[i], placed, is_inside);
    }
    bool is_object(const aiString &name)
    {
        const bool is = !from.object || strcmp(name.C_Str(), from.object) == 0;
        is_found |= is;
        note_name(name.C_Str());
        return is;
    }
    /* Whether all of these are finite and no shorter. */
    static bool has_vectors(const aiMesh &mesh, const aiVector3D *vectors, float length_min)
    {
        for (unsigned i = 0; vectors && i < mesh.mNumVertices; i++) {
            const float length = vectors[i].Length();
            if (!(std::isfinite(length) && length >= length_min))
                return false;
        }
        return vectors;
    }

    void note_name(const char *name)
    {
        if (names.size() <= listed_names_max && name[0])
            names.insert(name);
    }
    std::string list_names() const
    {
        std::string list;
        for (const std::string &name : names)
            list += words("%s'%.40s'", list.empty() ? "" : ", ", name.c_str());
        return names.size() > listed_names_max ? list + ", ..." : list;
    }

    /* Assimp has rounded coordinates to float32, as those of a map far from its origin. */
    void check_steps() const
    {
        const float huge = std::numeric_limits<float>::max();
        aiVector3D low(huge), high(-huge);
        for (const part &each : parts)
            for (unsigned v = 0; v < each.mesh->mNumVertices; v++)
                for (unsigned i = 0; i < 3; i++) {
                    low[i] = std::min(low[i], each.mesh->mVertices[v][i]);
                    high[i] = std::max(high[i], each.mesh->mVertices[v][i]);
                }
        const double size = static_cast<double>((high - low).Length());
        double farthest = 0.0;
        for (unsigned i = 0; i < 3; i++)
            farthest = std::max(farthest, static_cast<double>(std::max(-low[i], high[i])));
        if (size > 0.0 && std::isfinite(size) && farthest * 0x1p-24 > error_max * size)
            throw bad_file(words("its size is %g and its coordinates reach %g, where float32 has "
                                 "steps of %g\tmove it nearer to its origin",
                                 size, farthest, farthest * 0x1p-23));
    }

    /* Faces with one or two corners are points and lines, which a mesh may have, too. */
    void add_mesh(const aiMesh &mesh, const matrix &placed)
    {
        const bool is_mirror = placed.Determinant() < 0.0;
        for (unsigned f = 0; f < mesh.mNumFaces; f++) {
            const aiFace &face = mesh.mFaces[f];
            if (face.mNumIndices < 3)
                continue;
            if (face.mNumIndices > 3)
                throw bad_file("it has a polygon that Assimp could not triangulate");
            if (static_cast<int64_t>(indices.size() / 3) >= from.triangles_max)
                refuse_triangles({0, from.triangles_max});
            for (unsigned corner = 0; corner < 3; corner++)
                indices.push_back(find_corner(
                    make_corner(mesh, face.mIndices[is_mirror ? 2 - corner : corner], placed)));
        }
    }

    neph_mesh_corner make_corner(const aiMesh &mesh, unsigned vertex, const matrix &placed) const
    {
        neph_mesh_corner made = {};
        const aiVector3t<double> position = placed * aiVector3t<double>(mesh.mVertices[vertex]);
        const double p[] = {position.x, position.y, position.z};
        for (int i = 0; i < 3; i++)
            made.position[i] = p[i] + 0.0; /* no -0 */
        if (!std::isfinite(p[0] + p[1] + p[2])) {
            const aiVector3D &v = mesh.mVertices[vertex];
            throw bad_file(words("object '%.60s' has a vertex at (%g, %g, %g)", mesh.mName.C_Str(),
                                 static_cast<double>(v.x), static_cast<double>(v.y),
                                 static_cast<double>(v.z)));
        }
        if (has_normals)
            set_normal(mesh.mNormals[vertex], placed, made.normal);
        if (has_uv) {
            made.uv[0] = mesh.mTextureCoords[0][vertex].x + 0.0f;
            made.uv[1] = mesh.mTextureCoords[0][vertex].y + 0.0f;
        }
        return made;
    }

    /* By the inverse transposed, up to a positive factor: each row of cofactors is a cross product
     * of the other two rows. A matrix that mirrors has a negative factor between the two. */
    static void set_normal(const aiVector3D &normal, const matrix &m, double made[3])
    {
        const aiVector3t<double> rows[3] = {
            {m.a1, m.a2, m.a3}, {m.b1, m.b2, m.b3}, {m.c1, m.c2, m.c3}};
        const aiVector3t<double> of_file(normal);
        const double sign = m.Determinant() < 0.0 ? -1.0 : 1.0;
        double square = 0.0;
        for (int i = 0; i < 3; i++) {
            made[i] = sign * ((rows[(i + 1) % 3] ^ rows[(i + 2) % 3]) * of_file) + 0.0;
            square += made[i] * made[i];
        }
        for (int i = 0; i < 3; i++)
            made[i] /= std::sqrt(square);
    }

    /* The index of a vertex with these bits, which is added if there is none. The table is half
     * empty; an entry is an index + 1. */
    int32_t find_corner(const neph_mesh_corner &corner)
    {
        if (2 * corners.size() >= table.size())
            grow_table();
        int32_t &entry = find_entry(corner);
        if (entry == 0) {
            corners.push_back(corner);
            entry = static_cast<int32_t>(corners.size());
        }
        return entry - 1;
    }
    int32_t &find_entry(const neph_mesh_corner &corner)
    {
        uint64_t hash = 0xcbf29ce484222325, eight = 0;
        for (size_t i = 0; i < sizeof(corner); i += sizeof(eight)) {
            memcpy(&eight, reinterpret_cast<const char *>(&corner) + i, sizeof(eight));
            hash = (hash ^ eight) * 0x9e3779b97f4a7c15;
            hash ^= hash >> 32;
        }
        size_t at = hash & (table.size() - 1);
        while (table[at] != 0 &&
               memcmp(&corners[static_cast<size_t>(table[at] - 1)], &corner, sizeof(corner)) != 0)
            at = (at + 1) & (table.size() - 1);
        return table[at];
    }
    void grow_table()
    {
        table.assign(2 * table.size(), 0);
        for (size_t i = 0; i < corners.size(); i++)
            find_entry(corners[i]) = static_cast<int32_t>(i + 1);
    }

    const request &from;
    std::set<std::string> names; /* of objects, for a message */
    std::vector<part> parts;
    std::vector<neph_mesh_corner> corners;
    std::vector<int32_t> indices, table;
    bool has_normals = true, has_uv = true, is_found = false;
};

/* ---- all ------------------------------------------------------------------------------------- */

void check_indices(const aiScene &scene)
{
    for (unsigned m = 0; m < scene.mNumMeshes; m++)
        for (unsigned f = 0; f < scene.mMeshes[m]->mNumFaces; f++)
            for (unsigned i = 0; i < scene.mMeshes[m]->mFaces[f].mNumIndices; i++)
                if (scene.mMeshes[m]->mFaces[f].mIndices[i] >= scene.mMeshes[m]->mNumVertices)
                    throw bad_file(words("face %u names vertex %u of %u", f,
                                         scene.mMeshes[m]->mFaces[f].mIndices[i],
                                         scene.mMeshes[m]->mNumVertices));
}

void check_face_count(const aiScene &scene, int64_t declared)
{
    int64_t faces = 0;
    for (unsigned m = 0; m < scene.mNumMeshes; m++)
        for (unsigned f = 0; f < scene.mMeshes[m]->mNumFaces; f++)
            faces += scene.mMeshes[m]->mFaces[f].mNumIndices > 2;
    if (faces < declared)
        throw bad_file(words("%lld of its %lld faces name vertices that do not exist",
                             static_cast<long long>(declared - faces),
                             static_cast<long long>(declared)));
}

/* With the name of an object, limits are for it, not for the file. */
void read_mesh(const char *mesh_path, const request &of_neph)
{
    const format &of = find_format(of_neph.path);
    const mesh_limits limits = {of_neph.object ? INT64_MAX : 3 * of_neph.triangles_max,
                                of_neph.object ? INT64_MAX : of_neph.triangles_max};
    const int64_t declared = of.check(of_neph.path, limits);
    folder_files *files = new folder_files(of_neph.path, of.has_buffers, of_neph.limit_bytes);
    Assimp::Importer assimp;
    assimp.SetIOHandler(files); /* which owns it */
    keep_importer(assimp, of.importer);
    const aiScene *scene = assimp.ReadFile(of_neph.path, 0);
    files->check();
    if (!scene)
        throw bad_file(words("Assimp says: %.400s", assimp.GetErrorString()));
    check_indices(*scene);
    check_face_count(*scene, declared);
    scene = assimp.ApplyPostProcessing(aiProcess_Triangulate);
    if (!scene || !scene->mRootNode)
        throw bad_file("damaged: Assimp could not triangulate it");
    triangles made(of_neph);
    made.add(*scene);
    made.write(mesh_path);
}

/* The hard limit of processor time ends without the signal that says so. */
void limit_resource(int resource, uint64_t maximum)
{
    const rlimit both = {maximum, resource == RLIMIT_CPU ? maximum + 1 : maximum};
    if (setrlimit(static_cast<__rlimit_resource>(resource), &both) != 0)
        throw std::runtime_error("setrlimit failed");
}

int run_read(int argc, char **argv)
{
    const request of_neph = {argv[3], strtoull(argv[4], nullptr, 10), strtoll(argv[6], nullptr, 10),
                             argc > 7 ? argv[7] : nullptr};
    try {
        limit_resource(RLIMIT_CORE, 0);
        limit_resource(RLIMIT_CPU, strtoull(argv[5], nullptr, 10));
        limit_resource(RLIMIT_FSIZE, of_neph.limit_bytes);
        limit_resource(RLIMIT_AS, base_memory_bytes + 3 * of_neph.limit_bytes);
        read_mesh(argv[2], of_neph);
        return EX_OK;
    } catch (const std::bad_alloc &) {
        fprintf(stderr, "damaged, or it needs far more memory than the limit of %.0f MiB\n",
                static_cast<double>(of_neph.limit_bytes) / 0x1p20);
    } catch (const std::exception &error) {
        fprintf(stderr, "%s\n", error.what());
    } catch (...) {
        fprintf(stderr, "Assimp failed without a message\n");
    }
    return EX_DATAERR;
}

} // namespace

std::string words(const char *format, ...)
{
    char text[900];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof(text), format, arguments);
    va_end(arguments);
    return text;
}

void refuse_triangles(const mesh_limits &limits)
{
    throw bad_file(words("it has more than %lld triangles, or three times as many vertices\tmake "
                         "it simpler in a modelling program, "
                         "or read one object of it",
                         static_cast<long long>(limits.triangles_max)));
}

int main(int argc, char **argv)
{
    if (argc >= 7 && argc <= 8 && strcmp(argv[1], "read") == 0)
        return run_read(argc, argv);
    fprintf(stderr, "neph runs this program to read mesh files\n");
    return EX_USAGE;
}
