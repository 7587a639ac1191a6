/* SPDX-License-Identifier: MIT
 *
 * neph's side of the protocol with neph-vdb: finds it, runs it, and checks every number it returns.
 */
#include "scenes/volume_vdb.h"

#include "base/files.h"
#include "base/helper.h"
#include "scenes/volume_file.h"
#include "scenes/volume_format.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_VDB_LAYOUT_COUNT == 2, "a new kind");

enum { UUID_BYTES = 40, BOX_BYTES = 80 };

/* Zip is read at 50 MB/s or more; a file that takes ten times as long is treated as hostile. */
static const size_t cpu_bytes_per_s = 5000000;
static const size_t cpu_start_s = 10;
static const double wall_per_cpu = 20.0; /* on a busy machine */

static const float padding = 1e-9f; /* NEPH_VDB_BLENDER */

static const struct neph_helper helper = {
    .name = "neph-vdb",
    .variable = "NEPH_VDB",
    .built = NEPH_VDB_PROGRAM,
    .library = "OpenVDB",
    .reads = "OpenVDB files",
    .missing = "it is built together with neph; copy it into the folder of neph, or set the "
               "variable NEPH_VDB to its path",
};

enum neph_status neph_volume_find_openvdb(char **program, struct neph_diag *diag)
{
    return neph_helper_find(&helper, program, diag);
}

/* ---- reading --------------------------------------------------------------------------------- */

/* Formats "all", or "i,j,k,i,j,k". */
static void format_box(const struct neph_volume_box *box, char text[BOX_BYTES])
{
    if (box)
        snprintf(text, BOX_BYTES, "%d,%d,%d,%d,%d,%d", box->first[0], box->first[1], box->first[2],
                 box->last[0], box->last[1], box->last[2]);
    else
        snprintf(text, BOX_BYTES, "all");
}

static const char *get_use(const struct neph_volume_request *request)
{
    return request->counts_zeros ? "active" : request->is_fitted ? "fit" : "file";
}

static enum neph_status run_reader(const struct neph_volume_request *request, size_t file_bytes,
                                   const struct neph_shared *voxels, struct neph_diag *diag)
{
    const size_t cpu_s = cpu_start_s + file_bytes / cpu_bytes_per_s;
    char memory_limit[32], cpu_limit[32], side_max[32], index_box[BOX_BYTES];
    snprintf(memory_limit, sizeof(memory_limit), "%zu", request->memory_limit_bytes);
    snprintf(cpu_limit, sizeof(cpu_limit), "%zu", cpu_s);
    snprintf(side_max, sizeof(side_max), "%d", NEPH_GRID_SIDE_MAX);
    format_box(request->index_box, index_box);
    const char *argv[NEPH_HELPER_ARGUMENTS_MAX] = {
        NULL,      "read",   voxels->path,     request->path, memory_limit,
        cpu_limit, side_max, get_use(request), index_box,     request->grid_name};
    return neph_helper_run(&helper, argv, wall_per_cpu * (double)cpu_s, diag);
}

/* The output of the program. */
struct voxels {
    const unsigned char *bytes;
    size_t size, used;
};

static bool read_bytes(struct voxels *voxels, void *to, size_t size)
{
    if (size > voxels->size - voxels->used)
        return false;
    memcpy(to, voxels->bytes + voxels->used, size);
    voxels->used += size;
    return true;
}

static enum neph_status check_placement(const struct neph_vdb_placement *placement,
                                        struct neph_axis_turn *turn, struct neph_block *block,
                                        struct neph_diag *diag)
{
    for (int axis = 0; axis < 3; axis++) {
        const int64_t side = placement->size[axis];
        if (side < 1 || side > NEPH_GRID_SIDE_MAX)
            return neph_fail(diag, NEPH_ERR_INPUT,
                             "%" PRId64 " nodes along %c; a side must be 1..%d", side, "xyz"[axis],
                             NEPH_GRID_SIDE_MAX);
        block->size[axis] = (int)side;
        turn->axis[axis] = placement->axis[axis];
        turn->is_reversed[axis] = placement->is_reversed[axis] != 0;
    }
    const double *o = placement->origin, *h = placement->spacing;
    block->origin = (struct neph_vec3){o[0], o[1], o[2]};
    block->spacing = (struct neph_vec3){h[0], h[1], h[2]};
    return neph_axis_turn_is_sound(turn)
               ? NEPH_OK
               : neph_fail(diag, NEPH_ERR_INPUT, "damaged: OpenVDB read nonsense from it");
}

/* A grid of zeros, and the places of its values. */
static enum neph_status create_grid(const struct neph_volume_request *request,
                                    const struct neph_vdb_placement *placement,
                                    struct neph_turned_block *turned, struct neph_grid **grid,
                                    struct neph_diag *diag)
{
    struct neph_axis_turn turn;
    struct neph_block block;
    const enum neph_status status = check_placement(placement, &turn, &block, diag);
    return status ? status : neph_volume_create_grid(request, &turn, &block, turned, grid, diag);
}

static bool is_inside(const int64_t size[3], const struct neph_vdb_block *block)
{
    for (int axis = 0; axis < 3; axis++)
        if (block->first[axis] < 0 || block->last[axis] < block->first[axis] ||
            block->last[axis] >= size[axis])
            return false;
    return true;
}

static bool read_vdb_row(struct voxels *voxels, const struct neph_vdb_block *block, float *to,
                         ptrdiff_t step)
{
    const int count = block->last[0] - block->first[0] + 1;
    for (int i = 0; i < count; i++) {
        to[i * step] = block->value;
        if (!block->is_uniform && !read_bytes(voxels, &to[i * step], sizeof(*to)))
            return false;
    }
    return true;
}

static bool read_block(struct voxels *voxels, const int64_t size[3],
                       const struct neph_turned_block *turned, float *values)
{
    struct neph_vdb_block block;
    if (!read_bytes(voxels, &block, sizeof(block)) || !is_inside(size, &block))
        return false;
    const ptrdiff_t *step = turned->step;
    for (int k = block.first[2]; k <= block.last[2]; k++)
        for (int j = block.first[1]; j <= block.last[1]; j++) {
            float *row = values + turned->first + block.first[0] * step[0] + j * step[1] +
                         k * step[2];
            if (!read_vdb_row(voxels, &block, row, step[0]))
                return false;
        }
    return true;
}

/* `box`: the voxels by their indices in the file. */
static enum neph_status read_grid(const struct neph_volume_request *request, struct voxels *voxels,
                                  struct neph_grid **grid, struct neph_volume_box *box,
                                  struct neph_diag *diag)
{
    struct neph_vdb_placement placement;
    struct neph_turned_block turned;
    if (!read_bytes(voxels, &placement, sizeof(placement)))
        return neph_fail(diag, NEPH_ERR_INPUT, "damaged: OpenVDB failed without a message");
    struct neph_grid *made = NULL;
    enum neph_status status = create_grid(request, &placement, &turned, &made, diag);
    while (!status && voxels->used < voxels->size)
        if (!read_block(voxels, placement.size, &turned, made->values))
            status = neph_fail(diag, NEPH_ERR_INPUT, "damaged: OpenVDB read nonsense from it");
    for (int axis = 0; axis < 3 && !status; axis++) {
        box->first[axis] = placement.first[axis];
        box->last[axis] = (int)(placement.first[axis] + placement.size[axis] - 1);
    }
    if (status)
        neph_grid_destroy(made);
    else
        *grid = made;
    return status;
}

static enum neph_status map_and_read(const struct neph_volume_request *request,
                                     const struct neph_shared *shared, struct neph_grid **grid,
                                     struct neph_volume_box *box, struct neph_diag *diag)
{
    const void *bytes = NULL;
    struct voxels voxels = {.used = 0};
    enum neph_status status = neph_shared_map(shared, &bytes, &voxels.size, diag);
    voxels.bytes = bytes;
    if (!status)
        status = read_grid(request, &voxels, grid, box, diag);
    if (bytes)
        munmap((void *)bytes, voxels.size);
    return status;
}

static enum neph_status read_one(const struct neph_volume_request *request,
                                 const struct neph_volume_source *source, struct neph_grid **grid,
                                 struct neph_volume_box *box, struct neph_diag *diag)
{
    struct neph_shared voxels;
    enum neph_status status = neph_shared_create("neph-vdb-voxels", &voxels, diag);
    if (status)
        return status;
    status = run_reader(request, source->size_bytes, &voxels, diag);
    if (!status)
        status = map_and_read(request, &voxels, grid, box, diag);
    neph_shared_destroy(&voxels);
    return status;
}

static bool is_placed_alike(const struct neph_grid *a, const struct neph_grid *b)
{
    const struct neph_vec3 moved = neph_vec3_sub(a->origin_m, b->origin_m),
                           scaled = neph_vec3_sub(a->spacing_m, b->spacing_m);
    return neph_vec3_length(moved) == 0.0 && neph_vec3_length(scaled) == 0.0;
}

/* The radii of the voxels of `grid`, and the extinctions in place of its values. */
static enum neph_status apply_radii(const struct neph_volume_request *request,
                                    const struct neph_volume_source *source,
                                    const struct neph_volume_box *box, struct neph_grid *grid,
                                    struct neph_diag *diag)
{
    struct neph_volume_request of_radii = *request;
    struct neph_volume_box same;
    struct neph_grid *radii = NULL;
    of_radii.grid_name = request->radius_name;
    of_radii.index_box = box;
    of_radii.is_fitted = of_radii.counts_zeros = false;
    enum neph_status status = read_one(&of_radii, source, &radii, &same, diag);
    if (!status && !is_placed_alike(grid, radii)) {
        status = neph_fail(diag, NEPH_ERR_INPUT,
                           "grid '%.60s' has another transform than the grid of the density",
                           request->radius_name);
        neph_hint(diag, "resample one of them with openvdb::tools::resampleToMatch");
    }
    if (!status)
        status = neph_droplet_voxels_convert(&request->droplets, grid->size, grid->values,
                                             radii->values, grid->note, diag);
    neph_grid_destroy(radii);
    return status;
}

/* The program opens the file again by its path; `source` has only shown that it is readable. */
enum neph_status neph_volume_read_vdb(const struct neph_volume_request *request,
                                      const struct neph_volume_source *source,
                                      struct neph_grid **grid, struct neph_diag *diag)
{
    struct neph_volume_box box;
    struct neph_grid *made = NULL;
    enum neph_status status = read_one(request, source, &made, &box, diag);
    if (!status && request->radius_name)
        status = apply_radii(request, source, &box, made, diag);
    if (status)
        neph_grid_destroy(made);
    else
        *grid = made;
    return status;
}

/* ---- writing --------------------------------------------------------------------------------- */

static float node_or_padding(const struct neph_grid *grid, int i, int j, int k)
{
    if (i < 0 || j < 0 || k < 0 || i >= grid->size[0] || j >= grid->size[1] || k >= grid->size[2])
        return padding;
    const size_t row = (size_t)k * (size_t)grid->size[1] + (size_t)j;
    return grid->values[row * (size_t)grid->size[0] + (size_t)i];
}

static struct neph_vdb_placement world_placement(const struct neph_grid *grid)
{
    const struct neph_vec3 o = grid->origin_m, h = grid->spacing_m;
    return (struct neph_vdb_placement){.origin = {o.x, o.y, o.z},
                                       .spacing = {h.x, h.y, h.z},
                                       .size = {grid->size[0], grid->size[1], grid->size[2]}};
}

static float world_value(const struct neph_grid *grid, int i, int j, int k)
{
    return node_or_padding(grid, i, j, k);
}

/* Blender's (x, y, z) is the world's (x, -z, y): its y runs from the last z of the grid downwards.
 * The padding moves the first index by one spacing, the voxel's lower corner by another half. */
static struct neph_vdb_placement blender_placement(const struct neph_grid *grid)
{
    const struct neph_vec3 o = grid->origin_m, h = grid->spacing_m;
    const double last_z = o.z + (grid->size[2] - 1) * h.z;
    return (struct neph_vdb_placement){
        .origin = {o.x - 1.5 * h.x, -last_z - 1.5 * h.z, o.y - 1.5 * h.y},
        .spacing = {h.x, h.z, h.y},
        .size = {grid->size[0] + 2, grid->size[2] + 2, grid->size[1] + 2}};
}

static float blender_value(const struct neph_grid *grid, int i, int j, int k)
{
    return node_or_padding(grid, i - 1, k - 1, grid->size[2] - j);
}

static const struct {
    struct neph_vdb_placement (*placement)(const struct neph_grid *grid);
    float (*value)(const struct neph_grid *grid, int i, int j, int k);
} layouts[] = {
    [NEPH_VDB_WORLD] = {world_placement, world_value},
    [NEPH_VDB_BLENDER] = {blender_placement, blender_value},
};

static bool put_rows(FILE *out, const struct neph_grid *grid, enum neph_vdb_layout layout,
                     const int64_t size[3], float *row)
{
    for (int k = 0; k < size[2]; k++)
        for (int j = 0; j < size[1]; j++) {
            for (int i = 0; i < size[0]; i++)
                row[i] = layouts[layout].value(grid, i, j, k);
            if (fwrite(row, sizeof(*row), (size_t)size[0], out) != (size_t)size[0])
                return false;
        }
    return true;
}

static enum neph_status put_grid(const char *voxels_path, const struct neph_grid *grid,
                                 enum neph_vdb_layout layout, struct neph_diag *diag)
{
    const struct neph_vdb_placement placement = layouts[layout].placement(grid);
    float *row = malloc((size_t)placement.size[0] * sizeof(*row));
    if (!row)
        return neph_fail_memory(diag);
    FILE *out = fopen(voxels_path, "wbe");
    bool done = out && fwrite(&placement, sizeof(placement), 1, out) == 1 &&
                put_rows(out, grid, layout, placement.size, row);
    if (out && fclose(out) != 0)
        done = false;
    free(row);
    return done ? NEPH_OK : neph_fail(diag, NEPH_ERR_MEMORY, "no memory for a copy of the voxels");
}

/* The hash of the values in the form of a UUID. */
static void format_uuid(const char hash[NEPH_HASH_HEX_SIZE], char uuid[UUID_BYTES])
{
    snprintf(uuid, UUID_BYTES, "%.8s-%.4s-%.4s-%.4s-%.12s", hash, hash + 8, hash + 12, hash + 16,
             hash + 20);
}

static enum neph_status write_file(const char *temporary, const struct neph_grid *grid,
                                   enum neph_vdb_layout layout, struct neph_diag *diag)
{
    struct neph_shared voxels;
    enum neph_status status = neph_shared_create("neph-vdb-voxels", &voxels, diag);
    if (status)
        return status;
    char uuid[UUID_BYTES];
    format_uuid(grid->hash, uuid);
    const char *argv[NEPH_HELPER_ARGUMENTS_MAX] = {NULL, "write", voxels.path, temporary, uuid};
    status = put_grid(voxels.path, grid, layout, diag);
    if (!status)
        status = neph_helper_run(&helper, argv, 0.0, diag);
    neph_shared_destroy(&voxels);
    return status;
}

enum neph_status neph_volume_write_vdb(const char *path, const struct neph_grid *grid,
                                       enum neph_vdb_layout layout, struct neph_diag *diag)
{
    if (strlen(grid->hash) != NEPH_HASH_HEX_SIZE - 1)
        return neph_fail(diag, NEPH_ERR_INTERNAL, "a grid must be sealed before it is written");
    char *temporary = NULL;
    struct neph_diag inner = {.line = 0};
    enum neph_status status = neph_file_temporary(path, &temporary, diag);
    if (status)
        return status;
    status = write_file(temporary, grid, layout, &inner);
    if (!status) {
        status = neph_file_commit(temporary, path, diag);
    } else {
        neph_fail(diag, status, "cannot write '%s': %s", path, inner.message);
        neph_hint(diag, "%s", inner.hint);
    }
    unlink(temporary);
    free(temporary);
    return status;
}
