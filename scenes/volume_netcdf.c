/* SPDX-License-Identifier: MIT
 *
 * neph's side of the protocol with neph-netcdf: runs it, checks every number it returns, converts
 * units, and makes even nodes of its coordinates.
 */
#include "scenes/volume_netcdf.h"

#include "base/helper.h"
#include "scenes/file_units.h"
#include "scenes/volume_file.h"
#include "scenes/volume_format.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_UNIT_KIND_COUNT == 7, "a new kind");

enum { BOX_BYTES = 80 };

/* As for OpenVDB: 5 MB/s of a compressed file, on a busy machine. */
static const size_t cpu_bytes_per_s = 5000000;
static const size_t cpu_start_s = 10;
static const double wall_per_cpu = 20.0;

static const struct neph_helper helper = {
    .name = "neph-netcdf",
    .variable = "NEPH_NETCDF",
    .built = NEPH_NETCDF_PROGRAM,
    .library = "NetCDF",
    .reads = "NetCDF files",
    .missing = "install NetCDF and build neph again: sudo apt-get install libnetcdf-dev",
};

enum neph_status neph_volume_find_netcdf(char **program, struct neph_diag *diag)
{
    return neph_helper_find(&helper, program, diag);
}

/* The output of the program, and what is made of it. */
struct volume {
    struct neph_netcdf_header header;
    int size[3];
    double *levels[3];     /* owned; in metres, or in the unit of the file */
    bool is_reversed[3];   /* they descend in the file; here they ascend */
    float *values, *radii; /* owned; radii: NULL without */
    double first[3], spacing[3];
    char note[NEPH_GRID_NOTE_SIZE];
};

static void finish_volume(struct volume *volume)
{
    for (int axis = 0; axis < 3; axis++)
        free(volume->levels[axis]);
    free(volume->values);
    free(volume->radii);
}

/* ---- the program ----------------------------------------------------------------------------- */

static enum neph_status run_program(const struct neph_volume_request *request, size_t file_bytes,
                                    const struct neph_shared *voxels, struct neph_diag *diag)
{
    const size_t cpu_s = cpu_start_s + file_bytes / cpu_bytes_per_s;
    const struct neph_volume_box *box = request->index_box;
    char memory[32], cpu[32], side[32], time[32], index_box[BOX_BYTES] = "all";
    snprintf(memory, sizeof(memory), "%zu", request->memory_limit_bytes);
    snprintf(cpu, sizeof(cpu), "%zu", cpu_s);
    snprintf(side, sizeof(side), "%d", NEPH_GRID_SIDE_MAX);
    snprintf(time, sizeof(time), "%d", request->time_index ? *request->time_index : -1);
    if (box)
        snprintf(index_box, sizeof(index_box), "%d,%d,%d,%d,%d,%d", box->first[0], box->first[1],
                 box->first[2], box->last[0], box->last[1], box->last[2]);
    const char *argv[NEPH_HELPER_ARGUMENTS_MAX] = {NULL,
                                                   "read",
                                                   voxels->path,
                                                   request->path,
                                                   memory,
                                                   cpu,
                                                   side,
                                                   time,
                                                   request->axes ? request->axes : "-",
                                                   index_box,
                                                   request->grid_name ? request->grid_name : "-",
                                                   request->radius_name};
    return neph_helper_run(&helper, argv, wall_per_cpu * (double)cpu_s, diag);
}

static enum neph_status refuse_output(struct neph_diag *diag)
{
    return neph_fail(diag, NEPH_ERR_INPUT, "damaged: NetCDF read nonsense from it");
}

struct output {
    const unsigned char *bytes;
    size_t size, used;
};

static bool take(struct output *output, void *to, size_t size)
{
    if (size > output->size - output->used)
        return false;
    memcpy(to, output->bytes + output->used, size);
    output->used += size;
    return true;
}

static bool ends(const char text[NEPH_NETCDF_TEXT_SIZE])
{
    return memchr(text, '\0', NEPH_NETCDF_TEXT_SIZE);
}

static bool is_sound(const struct neph_netcdf_header *header, int variables)
{
    bool sound = header->variable_count == variables;
    for (int axis = 0; axis < 3; axis++)
        sound &= header->axes[axis].size >= 1 && header->axes[axis].size <= NEPH_GRID_SIDE_MAX &&
                 ends(header->axes[axis].name) && ends(header->axes[axis].unit);
    for (int v = 0; v < 2; v++)
        sound &= ends(header->names[v]) && ends(header->units[v]);
    return sound;
}

static enum neph_status take_numbers(struct output *output, void **numbers, size_t count,
                                     size_t size, struct neph_diag *diag)
{
    *numbers = calloc(count, size);
    if (!*numbers)
        return neph_fail_memory(diag);
    return take(output, *numbers, count * size) ? NEPH_OK : refuse_output(diag);
}

static enum neph_status take_volume(const struct neph_volume_request *request,
                                    struct output *output, struct volume *volume,
                                    struct neph_diag *diag)
{
    const int variables = request->radius_name ? 2 : 1;
    if (!take(output, &volume->header, sizeof(volume->header)) ||
        !is_sound(&volume->header, variables))
        return refuse_output(diag);
    for (int axis = 0; axis < 3; axis++)
        volume->size[axis] = (int)volume->header.axes[axis].size;
    enum neph_status status = neph_volume_check_size(request, volume->size, diag);
    for (int axis = 0; axis < 3 && !status; axis++)
        status = take_numbers(output, (void **)&volume->levels[axis], (size_t)volume->size[axis],
                              sizeof(double), diag);
    const size_t count = (size_t)volume->size[0] * (size_t)volume->size[1] *
                         (size_t)volume->size[2];
    if (!status)
        status = take_numbers(output, (void **)&volume->values, count, sizeof(float), diag);
    if (!status && request->radius_name)
        status = take_numbers(output, (void **)&volume->radii, count, sizeof(float), diag);
    return status;
}

/* ---- units of values ------------------------------------------------------------------------- */

static enum neph_status convert_values(const struct neph_volume_request *request,
                                       struct volume *volume, size_t count, struct neph_diag *diag)
{
    double factor = 1.0;
    const enum neph_status status = neph_volume_find_unit(request, volume->header.names[0],
                                                          volume->header.units[0], &factor, diag);
    for (size_t i = 0; i < count && !status && factor != 1.0; i++)
        volume->values[i] = (float)(factor * (double)volume->values[i]);
    return status;
}

static enum neph_status convert_radii(const struct neph_volume_request *request,
                                      struct volume *volume, struct neph_diag *diag)
{
    struct neph_droplet_voxels droplets = request->droplets;
    double factor = 1.0;
    if (droplets.radius_unit_um == 0.0) {
        const char *unit = volume->header.units[1];
        if (neph_unit_find(unit, &factor) != NEPH_UNIT_LENGTH) {
            neph_fail(diag, NEPH_ERR_INPUT, "variable '%s' has %s%.60s%s, which is no length",
                      volume->header.names[1], *unit ? "the unit '" : "no unit", unit,
                      *unit ? "'" : "");
            neph_hint(diag, "radius_unit_um is used in place of it: 1 for um, 1e6 for m");
            return NEPH_ERR_INPUT;
        }
        droplets.radius_unit_um = 1e6 * factor;
    }
    return neph_droplet_voxels_convert(&droplets, volume->size, volume->values, volume->radii,
                                       volume->note, diag);
}

/* ---- coordinates ----------------------------------------------------------------------------- */

static enum neph_status refuse_axis(const struct neph_netcdf_axis *axis, const char *what,
                                    const char *unit, struct neph_diag *diag)
{
    neph_fail(diag, NEPH_ERR_INPUT, "dimension '%s' has %s%s%s", axis->name, what, unit,
              *unit ? "'" : "");
    neph_hint(diag, "unit_m: 1 takes coordinates as metres; placement: fit with center_m and "
                    "size_m takes even nodes without coordinates");
    return NEPH_ERR_INPUT;
}

/* Whether coordinates ascend; with `sign` -1: descend. */
static bool ascends(const double *levels, int count, double sign)
{
    for (int i = 0; i < count; i++)
        if (!isfinite(levels[i]) || (i > 0 && !(sign * (levels[i] - levels[i - 1]) > 0.0)))
            return false;
    return true;
}

/* Coordinates in metres. `*are_known` false: the file has none that are lengths, and a fitted block
 * does not need them. */
static enum neph_status read_axis(const struct neph_volume_request *request, struct volume *volume,
                                  int axis, bool *are_known, struct neph_diag *diag)
{
    const struct neph_netcdf_axis *own = &volume->header.axes[axis];
    double *levels = volume->levels[axis], factor = 1.0;
    const int count = volume->size[axis];
    const bool is_length = neph_unit_find(own->unit, &factor) == NEPH_UNIT_LENGTH;
    *are_known = own->has_coordinates && (is_length || request->has_length_unit);
    if (!*are_known && request->is_fitted)
        return NEPH_OK;
    if (!own->has_coordinates)
        return refuse_axis(own, "no coordinate variable", "", diag);
    if (!*are_known)
        return *own->unit
                   ? refuse_axis(own, "coordinates that are no lengths, in '", own->unit, diag)
                   : refuse_axis(own, "coordinates without a unit", "", diag);
    volume->is_reversed[axis] = count > 1 && levels[0] > levels[1];
    if (!ascends(levels, count, volume->is_reversed[axis] ? -1.0 : 1.0))
        return refuse_axis(own, "coordinates that neither ascend nor descend", "", diag);
    if (count == 1 && !request->is_fitted)
        return refuse_axis(own, "one place, which has no thickness", "", diag);
    *are_known = count > 1;
    for (int i = 0; i < count; i++)
        levels[i] *= is_length ? factor : 1.0;
    return NEPH_OK;
}

static void reverse_levels(double *levels, int count)
{
    for (int i = 0; i < count / 2; i++) {
        const double low = levels[i];
        levels[i] = levels[count - 1 - i];
        levels[count - 1 - i] = low;
    }
}

/* Reverses the values along an axis. */
static void reverse_values(struct volume *volume, int axis)
{
    const int *size = volume->size;
    const size_t strides[3] = {1, (size_t)size[0], (size_t)size[0] * (size_t)size[1]};
    const int a = axis == 0 ? 1 : 0, b = axis == 2 ? 1 : 2;
    for (int k = 0; k < size[b]; k++)
        for (int j = 0; j < size[a]; j++) {
            float *line = volume->values + (size_t)k * strides[b] + (size_t)j * strides[a];
            for (int i = 0; i < size[axis] / 2; i++) {
                float *low = &line[(size_t)i * strides[axis]],
                      *high = &line[(size_t)(size[axis] - 1 - i) * strides[axis]], kept = *low;
                *low = *high;
                *high = kept;
            }
        }
}

/* Even nodes along an axis whose coordinates ascend. */
static enum neph_status make_even(const struct neph_volume_request *request, struct volume *volume,
                                  int axis, struct neph_diag *diag)
{
    const struct neph_volume_levels levels = {
        axis, {volume->levels[axis], volume->size[axis], false}, volume->header.axes[axis].name};
    struct neph_even_levels even;
    const enum neph_status status = neph_volume_make_even(
        request, &levels, volume->size, &volume->values, &even, volume->note, diag);
    volume->first[axis] = even.first;
    volume->spacing[axis] = even.spacing;
    return status;
}

static enum neph_status place_axes(const struct neph_volume_request *request, struct volume *volume,
                                   struct neph_diag *diag)
{
    bool are_known[3];
    enum neph_status status = NEPH_OK;
    for (int axis = 0; axis < 3 && !status; axis++)
        status = read_axis(request, volume, axis, &are_known[axis], diag);
    const bool all_known = !status && are_known[0] && are_known[1] && are_known[2];
    for (int axis = 0; axis < 3 && !status; axis++) {
        volume->first[axis] = 0.0;
        volume->spacing[axis] = 1.0;
        if (volume->is_reversed[axis]) {
            reverse_levels(volume->levels[axis], volume->size[axis]);
            reverse_values(volume, axis);
        }
        if (all_known)
            status = make_even(request, volume, axis, diag);
    }
    return status;
}

/* ---- all ------------------------------------------------------------------------------------- */

enum neph_status neph_volume_take_netcdf(const struct neph_volume_request *request,
                                         const void *bytes, size_t size, struct neph_grid **grid,
                                         struct neph_diag *diag)
{
    struct output output = {.bytes = bytes, .size = size};
    struct volume *volume = calloc(1, sizeof(*volume));
    if (!volume)
        return neph_fail_memory(diag);
    enum neph_status status = take_volume(request, &output, volume, diag);
    if (!status)
        status = convert_values(
            request, volume,
            (size_t)volume->size[0] * (size_t)volume->size[1] * (size_t)volume->size[2], diag);
    if (!status && request->radius_name)
        status = convert_radii(request, volume, diag);
    if (!status)
        status = place_axes(request, volume, diag);
    if (!status)
        status = neph_volume_make_grid(request, volume->size, volume->first, volume->spacing,
                                       volume->values, volume->note, grid, diag);
    finish_volume(volume);
    free(volume);
    return status;
}

enum neph_status neph_volume_read_netcdf(const struct neph_volume_request *request,
                                         const struct neph_volume_source *source,
                                         struct neph_grid **grid, struct neph_diag *diag)
{
    struct neph_shared shared;
    const void *bytes = NULL;
    size_t size = 0;
    enum neph_status status = neph_shared_create("neph-netcdf-voxels", &shared, diag);
    if (status)
        return status;
    status = run_program(request, source->size_bytes, &shared, diag);
    if (!status)
        status = neph_shared_map(&shared, &bytes, &size, diag);
    if (!status)
        status = neph_volume_take_netcdf(request, bytes, size, grid, diag);
    if (bytes)
        munmap((void *)bytes, size);
    neph_shared_destroy(&shared);
    return status;
}
