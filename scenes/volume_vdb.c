/* SPDX-License-Identifier: MIT
 *
 * neph's side of the program neph-vdb: find it, run it, and check every number that it hands over.
 */
#include "scenes/volume_vdb.h"

#include "base/child.h"
#include "base/files.h"
#include "scenes/volume_file.h"
#include "scenes/volume_format.h"

#include <errno.h>
#include <inttypes.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sysexits.h>
#include <unistd.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_VDB_LAYOUT_COUNT == 2, "a new kind");

enum { REASON_BYTES = 700, PATH_BYTES = 64, UUID_BYTES = 40, ARGUMENTS_MAX = 8 };

/* Zip is read at 50 MB/s and more; a file that takes ten times as long is not honest. */
static const size_t cpu_bytes_per_s = 5000000;
static const size_t cpu_start_s = 10;
static const double wall_per_cpu = 20.0; /* of a busy machine */

static const float padding = 1e-9f; /* NEPH_VDB_BLENDER */

static const char program_name[] = "neph-vdb";

/* ---- the program and what it says ------------------------------------------------------------ */

enum neph_status neph_volume_find_openvdb(char **program, struct neph_diag *diag)
{
    const char *named = getenv("NEPH_VDB");
    char *path = named && named[0] ? strdup(named) : neph_path_beside_program(program_name);
    if (!path)
        path = strdup(NEPH_VDB_PROGRAM);
    if (!path)
        return neph_fail_memory(diag);
    if (neph_child_program_exists(path)) {
        *program = path;
        return NEPH_OK;
    }
    neph_fail(diag, NEPH_ERR_UNAVAILABLE,
              "there is no program '%s', which alone knows OpenVDB files", path);
    neph_hint(diag, "it is built together with neph; copy it into the folder of neph, or let the "
                    "variable NEPH_VDB name it");
    free(path);
    return NEPH_ERR_UNAVAILABLE;
}

/* Anonymous memory that another process can open by path. */
struct shared {
    int fd;
    char path[PATH_BYTES];
};

static enum neph_status shared_create(const char *name, struct shared *shared,
                                      struct neph_diag *diag)
{
    shared->fd = memfd_create(name, MFD_CLOEXEC);
    if (shared->fd < 0)
        return neph_fail(diag, NEPH_ERR_MEMORY, "memfd_create: %s", strerror(errno));
    snprintf(shared->path, sizeof(shared->path), "/proc/%ld/fd/%d", (long)getpid(), shared->fd);
    return NEPH_OK;
}

static void shared_destroy(struct shared *shared)
{
    if (shared->fd >= 0)
        close(shared->fd);
}

/* The last line of the log, in printable ASCII: names in damaged files may be anything. */
static void last_line(int log_fd, char reason[REASON_BYTES])
{
    struct stat info = {.st_size = 0};
    fstat(log_fd, &info);
    const off_t start = info.st_size > REASON_BYTES - 1 ? info.st_size - (REASON_BYTES - 1) : 0;
    ssize_t length = pread(log_fd, reason, REASON_BYTES - 1, start);
    while (length > 0 && reason[length - 1] == '\n')
        length--;
    reason[length > 0 ? length : 0] = '\0';
    const char *newline = strrchr(reason, '\n');
    if (newline)
        memmove(reason, newline + 1, strlen(newline + 1) + 1);
    for (char *at = reason; *at; at++)
        if ((unsigned char)*at < ' ' || (unsigned char)*at > '~')
            *at = '?';
}

static enum neph_status explain(const struct neph_child_result *result, int log_fd,
                                struct neph_diag *diag)
{
    char reason[REASON_BYTES];
    last_line(log_fd, reason);
    if (result->signal == SIGXCPU)
        return neph_fail(diag, NEPH_ERR_INPUT,
                         "damaged: OpenVDB took %.0f s without coming to an end", result->cpu_s);
    if (result->signal)
        return neph_fail(diag, NEPH_ERR_INPUT, "damaged: OpenVDB crashed on it (signal %d)",
                         result->signal);
    switch (result->exit_code) {
    case EX_DATAERR:
        return neph_fail(diag, NEPH_ERR_INPUT, "%s", reason);
    case EX_IOERR:
        return neph_fail(diag, NEPH_ERR_IO, "%s", reason);
    case EX_OSERR:
        return neph_fail(diag, NEPH_ERR_MEMORY, "%s", reason);
    }
    return neph_fail(diag, NEPH_ERR_UNAVAILABLE, "%s does not work: exit code %d, '%s'",
                     program_name, result->exit_code, reason);
}

/* Where neph found its own libraries, this other half of it finds its own. */
static char *library_folders(void)
{
    const char *folders = getenv("LD_LIBRARY_PATH");
    return neph_format("LD_LIBRARY_PATH=%s", folders ? folders : "");
}

/* argv[0] is filled in here. */
static enum neph_status run_program(const char *argv[ARGUMENTS_MAX], double time_limit_s,
                                    struct neph_diag *diag)
{
    char *program = NULL, *libraries = NULL;
    struct shared log;
    enum neph_status status = neph_volume_find_openvdb(&program, diag);
    if (!status && !(libraries = library_folders()))
        status = neph_fail_memory(diag);
    if (!status)
        status = shared_create("neph-vdb-log", &log, diag);
    if (!status) {
        argv[0] = program;
        const struct neph_child_params params = {
            .argv = argv,
            .log_path = log.path,
            .environment = (const char *const[]){libraries, NULL},
            .time_limit_s = time_limit_s};
        struct neph_child_result result = {0};
        status = neph_child_run(&params, &result, diag);
        if (status == NEPH_ERR_ENGINE)
            status = explain(&result, log.fd, diag);
        shared_destroy(&log);
    }
    free(libraries);
    free(program);
    return status;
}

/* ---- reading --------------------------------------------------------------------------------- */

static enum neph_status run_reader(const struct neph_volume_request *request,
                                   const struct shared *voxels, struct neph_diag *diag)
{
    const size_t cpu_s = cpu_start_s + request->file_bytes / cpu_bytes_per_s;
    char memory_limit[32], cpu_limit[32];
    snprintf(memory_limit, sizeof(memory_limit), "%zu", request->memory_limit_bytes);
    snprintf(cpu_limit, sizeof(cpu_limit), "%zu", cpu_s);
    const char *argv[ARGUMENTS_MAX] = {NULL,         "read",    voxels->path,      request->path,
                                       memory_limit, cpu_limit, request->grid_name};
    return run_program(argv, wall_per_cpu * (double)cpu_s, diag);
}

/* What the program handed over. */
struct voxels {
    const unsigned char *bytes;
    size_t size, used;
};

static bool take(struct voxels *voxels, void *to, size_t size)
{
    if (size > voxels->size - voxels->used)
        return false;
    memcpy(to, voxels->bytes + voxels->used, size);
    voxels->used += size;
    return true;
}

static enum neph_status create_grid(const struct neph_volume_request *request,
                                    const struct neph_vdb_placement *placement,
                                    struct neph_grid **grid, struct neph_diag *diag)
{
    int size[3];
    for (int axis = 0; axis < 3; axis++) {
        const int64_t side = placement->size[axis];
        if (side < 1 || side > NEPH_GRID_SIDE_MAX)
            return neph_fail(diag, NEPH_ERR_INPUT,
                             "%" PRId64 " nodes along %c; a side must be 1..%d", side, "xyz"[axis],
                             NEPH_GRID_SIDE_MAX);
        size[axis] = (int)side;
    }
    enum neph_status status = neph_volume_check_size(request, size, diag);
    if (status)
        return status;
    const double *o = placement->origin, *h = placement->spacing;
    return neph_grid_create(size, (struct neph_vec3){o[0], o[1], o[2]},
                            (struct neph_vec3){h[0], h[1], h[2]}, grid, diag);
}

static bool is_inside(const struct neph_grid *grid, const struct neph_vdb_block *block)
{
    for (int axis = 0; axis < 3; axis++)
        if (block->first[axis] < 0 || block->last[axis] < block->first[axis] ||
            block->last[axis] >= grid->size[axis])
            return false;
    return true;
}

static bool take_block(struct voxels *voxels, struct neph_grid *grid)
{
    struct neph_vdb_block block;
    if (!take(voxels, &block, sizeof(block)) || !is_inside(grid, &block))
        return false;
    const size_t count = (size_t)(block.last[0] - block.first[0] + 1);
    for (int k = block.first[2]; k <= block.last[2]; k++)
        for (int j = block.first[1]; j <= block.last[1]; j++) {
            const size_t row = (size_t)k * (size_t)grid->size[1] + (size_t)j;
            float *to = grid->values + row * (size_t)grid->size[0] + block.first[0];
            if (!block.is_uniform && !take(voxels, to, count * sizeof(*to)))
                return false;
            for (size_t i = 0; block.is_uniform && i < count; i++)
                to[i] = block.value;
        }
    return true;
}

static enum neph_status take_grid(const struct neph_volume_request *request, struct voxels *voxels,
                                  struct neph_grid **grid, struct neph_diag *diag)
{
    struct neph_vdb_placement placement;
    if (!take(voxels, &placement, sizeof(placement)))
        return neph_fail(diag, NEPH_ERR_INPUT, "damaged: OpenVDB gave up on it without a word");
    struct neph_grid *made = NULL;
    enum neph_status status = create_grid(request, &placement, &made, diag);
    while (!status && voxels->used < voxels->size)
        if (!take_block(voxels, made))
            status = neph_fail(diag, NEPH_ERR_INPUT, "damaged: OpenVDB read nonsense from it");
    if (status)
        neph_grid_destroy(made);
    else
        *grid = made;
    return status;
}

static enum neph_status map_and_take(const struct neph_volume_request *request, int fd,
                                     struct neph_grid **grid, struct neph_diag *diag)
{
    struct stat info;
    if (fstat(fd, &info) != 0)
        return neph_fail(diag, NEPH_ERR_IO, "fstat: %s", strerror(errno));
    struct voxels voxels = {.size = (size_t)info.st_size};
    void *bytes = voxels.size > 0 ? mmap(NULL, voxels.size, PROT_READ, MAP_SHARED, fd, 0) : NULL;
    if (bytes == MAP_FAILED)
        return neph_fail(diag, NEPH_ERR_MEMORY, "mmap: %s", strerror(errno));
    voxels.bytes = bytes;
    enum neph_status status = take_grid(request, &voxels, grid, diag);
    if (bytes)
        munmap(bytes, voxels.size);
    return status;
}

/* The program opens the file by its path again; `file` only proved that it can be read. */
enum neph_status neph_volume_read_vdb(const struct neph_volume_request *request, FILE *file,
                                      struct neph_grid **grid, struct neph_diag *diag)
{
    (void)file;
    struct shared voxels;
    enum neph_status status = shared_create("neph-vdb-voxels", &voxels, diag);
    if (status)
        return status;
    status = run_reader(request, &voxels, diag);
    if (!status)
        status = map_and_take(request, voxels.fd, grid, diag);
    shared_destroy(&voxels);
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
    return (struct neph_vdb_placement){
        {o.x, o.y, o.z}, {h.x, h.y, h.z}, {grid->size[0], grid->size[1], grid->size[2]}};
}

static float world_value(const struct neph_grid *grid, int i, int j, int k)
{
    return node_or_padding(grid, i, j, k);
}

/* Blender's (x, y, z) is the world's (x, -z, y): its y runs from the last z of the grid down. The
 * padding moves the first index by one spacing, the voxel's lower corner by another half. */
static struct neph_vdb_placement blender_placement(const struct neph_grid *grid)
{
    const struct neph_vec3 o = grid->origin_m, h = grid->spacing_m;
    const double last_z = o.z + (grid->size[2] - 1) * h.z;
    return (struct neph_vdb_placement){{o.x - 1.5 * h.x, -last_z - 1.5 * h.z, o.y - 1.5 * h.y},
                                       {h.x, h.z, h.y},
                                       {grid->size[0] + 2, grid->size[2] + 2, grid->size[1] + 2}};
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
    struct shared voxels;
    enum neph_status status = shared_create("neph-vdb-voxels", &voxels, diag);
    if (status)
        return status;
    char uuid[UUID_BYTES];
    format_uuid(grid->hash, uuid);
    const char *argv[ARGUMENTS_MAX] = {NULL, "write", voxels.path, temporary, uuid};
    status = put_grid(voxels.path, grid, layout, diag);
    if (!status)
        status = run_program(argv, 0.0, diag);
    shared_destroy(&voxels);
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
