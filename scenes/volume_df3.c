/* SPDX-License-Identifier: MIT
 *
 * POV-Ray's density files, as in its manual (3.7, section 3.4.7.1.8.2, "density_file"): three sizes
 * of 16 bits, then the nodes with x fastest, 8, 16 or 32 bits each, all big-endian; the largest
 * code is a density of 1. The width is not stored: it follows from the file's size.
 */
#include "base/files.h"
#include "scenes/volume_file.h"
#include "scenes/volume_format.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { HEADER_BYTES = 6, WRITTEN_WIDTH_BYTES = 4 };

/* The largest code of a width in bytes. */
static double code_max(int width_bytes)
{
    return (double)((1ull << (8 * width_bytes)) - 1);
}

/* ---- reading --------------------------------------------------------------------------------- */

/* Contents of the header. */
struct header {
    int size[3];
    int width_bytes; /* of a node */
};

static enum neph_status read_header(const struct neph_volume_source *source, struct header *header,
                                    struct neph_diag *diag)
{
    unsigned char bytes[HEADER_BYTES];
    int *size = header->size;
    if (fread(bytes, 1, HEADER_BYTES, source->file) != HEADER_BYTES)
        return neph_fail(diag, NEPH_ERR_INPUT, "shorter than the header of a .df3, 6 bytes");
    for (int axis = 0; axis < 3; axis++)
        size[axis] = bytes[2 * axis] << 8 | bytes[2 * axis + 1];
    const uint64_t nodes = (uint64_t)size[0] * (uint64_t)size[1] * (uint64_t)size[2];
    if (nodes == 0)
        return neph_fail(diag, NEPH_ERR_INPUT, "its header has %d x %d x %d nodes, an empty block",
                         size[0], size[1], size[2]);
    const uint64_t body = source->size_bytes - HEADER_BYTES;
    const uint64_t width = body / nodes;
    if (body % nodes != 0 || (width != 1 && width != 2 && width != 4))
        return neph_fail(diag, NEPH_ERR_INPUT,
                         "its header has %d x %d x %d nodes, but the %llu bytes after it are "
                         "neither 1, 2 nor 4 for each: truncated, or not a .df3",
                         size[0], size[1], size[2], (unsigned long long)body);
    header->width_bytes = (int)width;
    return NEPH_OK;
}

static void decode(const unsigned char *bytes, int count, int width_bytes, float *to,
                   ptrdiff_t step)
{
    const double largest = code_max(width_bytes);
    for (int i = 0; i < count; i++) {
        uint32_t code = 0;
        for (int b = 0; b < width_bytes; b++)
            code = code << 8 | *bytes++;
        to[i * step] = (float)(code / largest);
    }
}

static struct neph_block find_block(const struct neph_volume_box *box)
{
    const int *first = box->first, *last = box->last;
    return (struct neph_block){
        {last[0] - first[0] + 1, last[1] - first[1] + 1, last[2] - first[2] + 1},
        {first[0], first[1], first[2]},
        {1.0, 1.0, 1.0}};
}

/* Copies the rows of one slice that are in the box. */
static void copy_slice(const unsigned char *bytes, const struct header *header,
                       const struct neph_volume_box *box, int k,
                       const struct neph_turned_block *turned, float *values)
{
    const int *first = box->first, *last = box->last;
    for (int j = first[1]; j <= last[1]; j++) {
        const size_t node = (size_t)j * (size_t)header->size[0] + (size_t)first[0];
        float *row = values + turned->first + (j - first[1]) * turned->step[1] +
                     (k - first[2]) * turned->step[2];
        decode(bytes + node * (size_t)header->width_bytes, last[0] - first[0] + 1,
               header->width_bytes, row, turned->step[0]);
    }
}

static enum neph_status read_slices(FILE *file, const struct header *header,
                                    const struct neph_volume_box *box,
                                    const struct neph_turned_block *turned, float *values,
                                    struct neph_diag *diag)
{
    const size_t count = (size_t)header->size[0] * (size_t)header->size[1];
    unsigned char *bytes = malloc(count * (size_t)header->width_bytes);
    if (!bytes)
        return neph_fail_memory(diag);
    enum neph_status status = NEPH_OK;
    for (int k = 0; k <= box->last[2] && !status; k++) {
        if (fread(bytes, (size_t)header->width_bytes, count, file) != count)
            status = neph_fail(diag, NEPH_ERR_IO, "%s",
                               ferror(file) ? strerror(errno) : "it became shorter meanwhile");
        else if (k >= box->first[2])
            copy_slice(bytes, header, box, k, turned, values);
    }
    free(bytes);
    return status;
}

enum neph_status neph_volume_read_df3(const struct neph_volume_request *request,
                                      const struct neph_volume_source *source,
                                      struct neph_grid **grid, struct neph_diag *diag)
{
    struct header header;
    struct neph_volume_box box;
    struct neph_turned_block turned;
    struct neph_grid *made = NULL;
    enum neph_status status = read_header(source, &header, diag);
    if (!status)
        status = neph_volume_find_box(request, header.size, &box, diag);
    if (!status) {
        const struct neph_block block = find_block(&box);
        status = neph_volume_create_grid(request, &neph_axis_turn_none, &block, &turned, &made,
                                         diag);
    }
    if (!status)
        status = read_slices(source->file, &header, &box, &turned, made->values, diag);
    if (status)
        neph_grid_destroy(made);
    else
        *grid = made;
    return status;
}

/* ---- writing --------------------------------------------------------------------------------- */

static void encode(const float *values, size_t count, double maximum, unsigned char *bytes)
{
    for (size_t i = 0; i < count; i++) {
        const double share = maximum > 0.0 ? (double)values[i] / maximum : 0.0;
        const uint32_t code = (uint32_t)(share * code_max(WRITTEN_WIDTH_BYTES) + 0.5);
        for (int b = 0; b < WRITTEN_WIDTH_BYTES; b++)
            *bytes++ = (unsigned char)(code >> (8 * (WRITTEN_WIDTH_BYTES - 1 - b)));
    }
}

/* Encodes one slice of the file: zeros all around, and inside them the slice `values` (NULL: zeros,
 * too). */
static void encode_slice(const struct neph_grid *grid, const float *values, unsigned char *bytes)
{
    const size_t nx = (size_t)grid->size[0], ny = (size_t)grid->size[1];
    memset(bytes, 0, (nx + 2) * (ny + 2) * WRITTEN_WIDTH_BYTES);
    for (size_t j = 0; values && j < ny; j++)
        encode(values + j * nx, nx, grid->maximum,
               bytes + ((j + 1) * (nx + 2) + 1) * WRITTEN_WIDTH_BYTES);
}

static bool write_slices(FILE *file, const struct neph_grid *grid, unsigned char *bytes)
{
    const size_t count = (size_t)grid->size[0] * (size_t)grid->size[1];
    const size_t padded = (size_t)(grid->size[0] + 2) * (size_t)(grid->size[1] + 2);
    for (int k = -1; k <= grid->size[2]; k++) {
        const bool inside = k >= 0 && k < grid->size[2];
        encode_slice(grid, inside ? grid->values + (size_t)k * count : NULL, bytes);
        if (fwrite(bytes, WRITTEN_WIDTH_BYTES, padded, file) != padded)
            return false;
    }
    return true;
}

static enum neph_status write_file(const char *temporary, const struct neph_grid *grid,
                                   struct neph_diag *diag)
{
    const size_t padded = (size_t)(grid->size[0] + 2) * (size_t)(grid->size[1] + 2);
    unsigned char *bytes = malloc(padded * WRITTEN_WIDTH_BYTES);
    if (!bytes)
        return neph_fail_memory(diag);
    unsigned char header[HEADER_BYTES];
    for (int axis = 0; axis < 3; axis++) {
        header[2 * axis] = (unsigned char)((grid->size[axis] + 2) >> 8);
        header[2 * axis + 1] = (unsigned char)(grid->size[axis] + 2);
    }
    FILE *file = fopen(temporary, "wbe");
    bool written = file && fwrite(header, 1, HEADER_BYTES, file) == HEADER_BYTES &&
                   write_slices(file, grid, bytes);
    int error = errno;
    if (file && fclose(file) != 0 && written) {
        written = false;
        error = errno;
    }
    free(bytes);
    return written ? NEPH_OK : neph_fail(diag, NEPH_ERR_IO, "%s", strerror(error));
}

enum neph_status neph_volume_write_df3(const char *path, const struct neph_grid *grid,
                                       struct neph_diag *diag)
{
    char *temporary = NULL;
    struct neph_diag inner = {.line = 0};
    enum neph_status status = neph_file_temporary(path, &temporary, diag);
    if (status)
        return status;
    status = write_file(temporary, grid, &inner);
    if (status)
        neph_fail(diag, status, "cannot write '%s': %s", path, inner.message);
    else
        status = neph_file_commit(temporary, path, diag);
    unlink(temporary);
    free(temporary);
    return status;
}
