/* SPDX-License-Identifier: MIT
 *
 * neph's side of the protocol with neph-mesh: runs it and checks every number it returns.
 */
#include "scenes/mesh_file.h"

#include "base/files.h"
#include "base/helper.h"
#include "scenes/mesh_program.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/mman.h>
#include <unistd.h>

/* 20 MB/s and more, on a busy machine. */
static const size_t cpu_bytes_per_s = 5000000;
static const size_t cpu_start_s = 10;
static const double wall_per_cpu = 20.0;

static const struct neph_helper helper = {
    .name = "neph-mesh",
    .variable = "NEPH_MESH",
    .built = NEPH_MESH_PROGRAM,
    .library = "Assimp",
    .reads = "OBJ, PLY and glTF files",
    .missing = "install Assimp and build neph again: sudo apt-get install libassimp-dev",
};

enum neph_status neph_mesh_find_program(char **program, struct neph_diag *diag)
{
    return neph_helper_find(&helper, program, diag);
}

/* ---- the output of the program --------------------------------------------------------------- */

static enum neph_status refuse_output(struct neph_diag *diag)
{
    return neph_fail(diag, NEPH_ERR_INPUT, "damaged: Assimp read nonsense from it");
}

static bool is_header_sound(const struct neph_mesh_header *header, size_t size)
{
    const int64_t vertices = header->vertex_count, triangles = header->triangle_count;
    return vertices >= 1 && vertices <= NEPH_MESH_VERTICES_MAX && triangles >= 1 &&
           triangles <= NEPH_MESH_TRIANGLES_MAX &&
           size == sizeof(*header) + (size_t)vertices * sizeof(struct neph_mesh_corner) +
                       (size_t)triangles * sizeof(int32_t[3]);
}

static enum neph_status allocate(const struct neph_mesh_header *header, struct neph_mesh_data *data,
                                 struct neph_diag *diag)
{
    const size_t vertices = (size_t)header->vertex_count;
    data->vertex_count = (int)header->vertex_count;
    data->triangle_count = (int)header->triangle_count;
    data->positions = calloc(vertices, sizeof(*data->positions));
    data->triangles = calloc((size_t)header->triangle_count, sizeof(*data->triangles));
    if (header->has_normals)
        data->normals = calloc(vertices, sizeof(*data->normals));
    if (header->has_uv)
        data->uv = calloc(vertices, sizeof(*data->uv));
    const bool has_all = data->positions && data->triangles &&
                         (data->normals || !header->has_normals) && (data->uv || !header->has_uv);
    return has_all ? NEPH_OK : neph_fail_memory(diag);
}

static bool take_corner(const struct neph_mesh_corner *corner, int v, struct neph_mesh_data *data)
{
    const double *p = corner->position, *n = corner->normal;
    data->positions[v] = (struct neph_vec3){p[0], p[1], p[2]};
    if (data->normals)
        data->normals[v] = (struct neph_vec3){n[0], n[1], n[2]};
    if (data->uv)
        memcpy(data->uv[v], corner->uv, sizeof(data->uv[v]));
    const double square = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
    return isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]) &&
           (!data->normals || (square > 0.0 && isfinite(square))) &&
           (!data->uv || (isfinite(corner->uv[0]) && isfinite(corner->uv[1])));
}

static bool take_arrays(const unsigned char *bytes, struct neph_mesh_data *data)
{
    bool is_sound = true;
    for (int v = 0; v < data->vertex_count; v++, bytes += sizeof(struct neph_mesh_corner)) {
        struct neph_mesh_corner corner;
        memcpy(&corner, bytes, sizeof(corner));
        is_sound &= take_corner(&corner, v, data);
    }
    _Static_assert(sizeof(*data->triangles) == sizeof(int32_t[3]), "int is int32");
    memcpy(data->triangles, bytes, (size_t)data->triangle_count * sizeof(*data->triangles));
    for (int t = 0; t < data->triangle_count; t++)
        for (int i = 0; i < 3; i++)
            is_sound &= data->triangles[t][i] >= 0 && data->triangles[t][i] < data->vertex_count;
    return is_sound;
}

enum neph_status neph_mesh_take(const void *bytes, size_t size, struct neph_mesh_data *data,
                                struct neph_diag *diag)
{
    struct neph_mesh_header header;
    struct neph_mesh_data made = {0};
    if (size < sizeof(header))
        return refuse_output(diag);
    memcpy(&header, bytes, sizeof(header));
    if (!is_header_sound(&header, size))
        return refuse_output(diag);
    enum neph_status status = allocate(&header, &made, diag);
    if (!status && !take_arrays((const unsigned char *)bytes + sizeof(header), &made))
        status = refuse_output(diag);
    if (status)
        neph_mesh_data_finish(&made);
    else
        *data = made;
    return status;
}

/* ---- the program ----------------------------------------------------------------------------- */

static enum neph_status run_program(const struct neph_mesh_request *request, size_t file_bytes,
                                    const struct neph_shared *mesh, struct neph_diag *diag)
{
    const size_t cpu_s = cpu_start_s + file_bytes / cpu_bytes_per_s;
    char limit[32], cpu[32], triangles[32];
    snprintf(limit, sizeof(limit), "%zu", request->limit_bytes);
    snprintf(cpu, sizeof(cpu), "%zu", cpu_s);
    snprintf(triangles, sizeof(triangles), "%d", NEPH_MESH_TRIANGLES_MAX);
    const char *argv[NEPH_HELPER_ARGUMENTS_MAX] = {NULL,  "read", mesh->path, request->path,
                                                   limit, cpu,    triangles,  request->object};
    return neph_helper_run(&helper, argv, wall_per_cpu * (double)cpu_s, diag);
}

static enum neph_status run_and_take(const struct neph_mesh_request *request, size_t file_bytes,
                                     struct neph_mesh_data *data, struct neph_diag *diag)
{
    struct neph_shared shared;
    const void *bytes = NULL;
    size_t size = 0;
    enum neph_status status = neph_shared_create("neph-mesh", &shared, diag);
    if (status)
        return status;
    status = run_program(request, file_bytes, &shared, diag);
    if (!status)
        status = neph_shared_map(&shared, &bytes, &size, diag);
    if (!status)
        status = neph_mesh_take(bytes, size, data, diag);
    if (bytes)
        munmap((void *)bytes, size);
    neph_shared_destroy(&shared);
    return status;
}

/* ---- all ------------------------------------------------------------------------------------- */

static bool has_known_extension(const char *path)
{
    static const char *const extensions[] = {".obj", ".ply", ".gltf", ".glb"};
    const char *name = strrchr(path, '/');
    const char *extension = strrchr(name ? name : path, '.');
    for (size_t i = 0; extension && i < sizeof(extensions) / sizeof(extensions[0]); i++)
        if (strcasecmp(extension, extensions[i]) == 0)
            return true;
    return false;
}

/* The program opens the file again by its path; this shows only that it is readable. */
static enum neph_status check_file(const struct neph_mesh_request *request, uint64_t *size_bytes,
                                   struct neph_diag *diag)
{
    int fd = -1;
    if (!has_known_extension(request->path)) {
        neph_fail(diag, NEPH_ERR_INPUT, "it is not a mesh file that neph reads");
        neph_hint(diag, "its name must end in .obj, .ply, .gltf or .glb");
        return NEPH_ERR_INPUT;
    }
    enum neph_status status = neph_file_open(request->path, &fd, size_bytes, diag);
    if (status)
        return status;
    close(fd);
    if (*size_bytes == 0)
        return neph_fail(diag, NEPH_ERR_INPUT, "it is empty");
    if (*size_bytes > request->limit_bytes) {
        neph_fail(diag, NEPH_ERR_INPUT, "it has %.0f MiB, and the limit is %.0f MiB",
                  (double)*size_bytes / 0x1p20, (double)request->limit_bytes / 0x1p20);
        neph_hint(diag,
                  "a mesh may have %d triangles, which are 20 MB as binary PLY or glTF: make it "
                  "simpler, or split it into files",
                  NEPH_MESH_TRIANGLES_MAX);
        return NEPH_ERR_INPUT;
    }
    return NEPH_OK;
}

enum neph_status neph_mesh_read(const struct neph_mesh_request *request,
                                struct neph_mesh_data *data, struct neph_diag *diag)
{
    struct neph_diag inner = {.line = 0};
    uint64_t size_bytes = 0;
    enum neph_status status = check_file(request, &size_bytes, &inner);
    if (!status)
        status = run_and_take(request, (size_t)size_bytes, data, &inner);
    if (status) {
        neph_fail(diag, status, "cannot read the mesh '%s': %s",
                  request->shown ? request->shown : request->path, inner.message);
        if (inner.hint[0])
            neph_hint(diag, "%s", inner.hint);
    }
    return status;
}
