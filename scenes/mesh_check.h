/* SPDX-License-Identifier: MIT
 *
 * Checks of mesh files in neph-mesh before Assimp reads them. Assimp 5.2 skips lines of an OBJ file
 * that are no vertices, so that faces name others; it makes up the end of a truncated PLY file, and
 * does not return from one without end_header; it takes integer coordinates of a glTF file as the
 * bits of floats, and leaves out triangles whose vertices do not exist.
 */
#ifndef NEPH_SCENES_MESH_CHECK_H
#define NEPH_SCENES_MESH_CHECK_H

#include <cstdint>
#include <stdexcept>
#include <string>

/* A fault of the file, in words for the user; after a tab the way out. */
struct bad_file : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/* printf, cut after 900 bytes. */
[[gnu::format(printf, 1, 2)]] std::string words(const char *format, ...);

/* A file that has more of them is refused early. */
struct mesh_limits {
    int64_t vertices_max, triangles_max;
};

/* The least number of faces with three corners or more that Assimp must find. They throw bad_file.
 */
int64_t check_obj(const char *path, const mesh_limits &limits);
int64_t check_ply(const char *path, const mesh_limits &limits);
int64_t check_gltf(const char *path, const mesh_limits &limits);

[[noreturn]] void refuse_triangles(const mesh_limits &limits);

#endif
