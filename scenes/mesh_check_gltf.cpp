/* SPDX-License-Identifier: MIT
 *
 * The JSON of a glTF 2.0 file: its coordinates are floats, and extensions that it requires have no
 * meaning for the shape.
 */
#include "scenes/mesh_check.h"

#include <cstring>
#include <fstream>
#include <memory>
#include <vector>

#include <jansson.h>

namespace
{

enum { FLOAT = 5126 };                                /* componentType */
enum { TRIANGLES = 4, TRIANGLE_STRIP, TRIANGLE_FAN }; /* mode */

/* Starts of the names of required extensions that change pictures only, or that Assimp decodes. */
constexpr const char *fine_extensions[] = {"KHR_materials_", "KHR_texture_", "EXT_texture_",
                                           "KHR_lights_punctual", "KHR_draco_mesh_compression"};

/* The JSON of a .gltf, or the first chunk of a .glb after its two headers, of 12 and 8 bytes. */
std::vector<char> read_json(const char *path)
{
    std::ifstream file(path, std::ios::binary);
    char magic[4] = {};
    uint32_t length = 0;
    std::vector<char> json;
    file.read(magic, sizeof(magic));
    if (memcmp(magic, "glTF", sizeof(magic)) == 0) {
        file.seekg(12);
        file.read(reinterpret_cast<char *>(&length), sizeof(length));
        file.seekg(0, std::ios::end);
        if (!file || file.tellg() < 20 + static_cast<std::streamoff>(length))
            throw bad_file("truncated: it ends before its JSON does");
        file.seekg(20);
        json.resize(length);
    } else {
        file.clear();
        file.seekg(0, std::ios::end);
        json.resize(static_cast<size_t>(file.tellg()));
        file.seekg(0);
    }
    file.read(json.data(), static_cast<std::streamsize>(json.size()));
    return json;
}

void check_extensions(const json_t *root)
{
    size_t i = 0;
    const json_t *each = nullptr;
    json_array_foreach(json_object_get(root, "extensionsRequired"), i, each)
    {
        const char *name = json_string_value(each) ? json_string_value(each) : "";
        bool is_fine = false;
        for (const char *fine : fine_extensions)
            is_fine |= strncmp(name, fine, strlen(fine)) == 0;
        if (!is_fine)
            throw bad_file(words("it requires the extension %.60s, which neph does not read\t"
                                 "write it without: quantized or compressed meshes as floats",
                                 name));
    }
}

const json_t *find_accessor(const json_t *root, const json_t *index)
{
    const json_t *list = json_object_get(root, "accessors");
    return json_is_integer(index) && json_integer_value(index) >= 0
               ? json_array_get(list, static_cast<size_t>(json_integer_value(index)))
               : nullptr;
}

int64_t count_triangles(const json_t *root, const json_t *primitive, const json_t *positions)
{
    const json_t *indices = find_accessor(root, json_object_get(primitive, "indices"));
    const int64_t count = json_integer_value(
        json_object_get(indices ? indices : positions, "count"));
    const json_t *mode = json_object_get(primitive, "mode");
    switch (mode ? json_integer_value(mode) : json_int_t{TRIANGLES}) {
    case TRIANGLES:
        return count / 3;
    case TRIANGLE_STRIP:
    case TRIANGLE_FAN:
        return count > 2 ? count - 2 : 0;
    }
    return 0;
}

int64_t check_primitive(const json_t *root, const json_t *primitive)
{
    constexpr const char *names[] = {"POSITION", "NORMAL"};
    const json_t *attributes = json_object_get(primitive, "attributes");
    for (const char *name : names) {
        const json_t *accessor = find_accessor(root, json_object_get(attributes, name));
        const json_t *type = json_object_get(accessor, "componentType");
        if (accessor && json_integer_value(type) != FLOAT)
            throw bad_file(words("%s has componentType %lld; neph reads floats, %d", name,
                                 static_cast<long long>(json_integer_value(type)), FLOAT));
    }
    const json_t *positions = find_accessor(root, json_object_get(attributes, "POSITION"));
    return positions ? count_triangles(root, primitive, positions) : 0;
}

} // namespace

int64_t check_gltf(const char *path, const mesh_limits &limits)
{
    const std::vector<char> text = read_json(path);
    json_error_t error;
    const std::unique_ptr<json_t, decltype(&json_decref)> root(
        json_loadb(text.data(), text.size(), 0, &error), json_decref);
    if (!root)
        throw bad_file(words("line %d of its JSON: %.160s", error.line, error.text));
    check_extensions(root.get());
    int64_t triangles = 0;
    size_t m = 0, p = 0;
    const json_t *mesh = nullptr, *primitive = nullptr;
    json_array_foreach(json_object_get(root.get(), "meshes"), m, mesh)
        json_array_foreach(json_object_get(mesh, "primitives"), p, primitive)
            triangles += check_primitive(root.get(), primitive);
    if (triangles > limits.triangles_max)
        refuse_triangles(limits);
    return triangles;
}
