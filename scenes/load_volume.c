/* SPDX-License-Identifier: MIT
 *
 * The form `volume` of a medium has two placements. `file` is the file's own transform, scaled by
 * `unit_m` and moved by `origin_m`. It does not depend on the voxels, so the frames of a sequence
 * keep their scale and their place when the box of their voxels grows or moves. `fit` gives the
 * block of voxels a centre and a size. A .df3 or a table has no transform, and is always fitted.
 */
#include "scenes/load_volume.h"

#include "base/files.h"
#include "scenes/resolve_path.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_INTERPOLATION_COUNT == 3, "a new interpolation");

#define AT(member) offsetof(struct neph_medium, member)
#define VOLUME(member) offsetof(struct neph_written_volume, member)
#define BOX(member) offsetof(struct neph_volume_box, member)

/* OpenVDB's indices have 32 bits; a box of this size is far beyond any memory limit. */
#define INDEX_MAX 1e9

enum placement { PLACEMENT_FILE, PLACEMENT_FIT };
static const char *const placements[] = {[PLACEMENT_FILE] = "file", [PLACEMENT_FIT] = "fit", NULL};

enum fit_to { FIT_TO_VALUES, FIT_TO_ACTIVE };
static const char *const fits[] = {[FIT_TO_VALUES] = "values", [FIT_TO_ACTIVE] = "active", NULL};

enum up { UP_Y, UP_Z };
static const char *const ups[] = {[UP_Y] = "y", [UP_Z] = "z", NULL};

static const char *const interpolations[] = {[NEPH_INTERPOLATION_OF_FILE] = "file",
                                             [NEPH_INTERPOLATION_TRILINEAR] = "trilinear",
                                             [NEPH_INTERPOLATION_CONSTANT] = "constant",
                                             NULL};

static const struct neph_field index_box_fields[] = {
    {"first", NEPH_WHOLES, BOX(first), "", -INDEX_MAX, INDEX_MAX,
     .note = "indices of the lowest voxel"},
    {"last", NEPH_WHOLES, BOX(last), "", -INDEX_MAX, INDEX_MAX,
     .note = "indices of the highest voxel, which is inside"},
    {0},
};
static const struct neph_record index_box_record = {.size = sizeof(struct neph_volume_box),
                                                    .fields = index_box_fields};

const struct neph_field neph_volume_fields[] = {
    {"file", NEPH_TEXT, VOLUME(file),
     .note =
         ".vdb (float or half grid; no rotation but by 90 degrees), .df3, .nc (NetCDF), or .dat, "
         ".lwc or .txt (cloud of MYSTIC, I3RC or SHDOM; scenes/volume_text.c); absolute, from the "
         "scene file on, or $NAME or $NAME/... from the environment",
     .least = 1, .most = 1000},
    {"grid", NEPH_TEXT, VOLUME(grid),
     .note = "its name in a .vdb; `density[1]` is the second of several `density`; the variable "
             "of a .nc; ext or lwc of a text",
     .least = 1, .most = 64, .standard = "the only one, or `density`"},
    {"radius_grid", NEPH_TEXT, VOLUME(radius_grid),
     .note = "the grid of effective radii (reff of a text), with `water_g_per_m3` or "
             "`droplets_per_cm3`; each voxel "
             "has the extinction of its radius, and the medium's phase function (radius_band_um "
             "gives it others)",
     .least = 1, .most = 64, .standard = "`effective_radius_um` everywhere"},
    {"radius_unit_um", NEPH_NUMBER, VOLUME(radius_unit_um), "um", 1e-6, 1e9,
     .note = "of a radius of 1 in that grid", .standard = "1; the unit that a .nc has"},
    {"radius_band_um", NEPH_THREE, VOLUME(radius_band), "um", 0, NEPH_DROPLET_RADIUS_MAX_UM,
     .note = "[low, peak, high]: the part of each voxel that has the medium's phase function, 1 "
             "where its radius is peak, falling linearly to 0 at low and high; low = peak is 1 "
             "below, peak = high above. Media of one file with bands from peak to peak are one "
             "cloud, its phase function interpolated linearly in the radius",
     .standard = "all radii"},
    {"table_size", NEPH_WHOLES, VOLUME(table_size), "nodes", 1, NEPH_GRID_SIDE_MAX,
     .note = "of a file with numbers and nothing else, whatever its name: x fastest, then y, then "
             "layers from the top down",
     .standard = "a file with a header"},
    {"interpolation", NEPH_WORD, VOLUME(interpolation), .words = interpolations,
     .note = "as of a grid; file: constant where a text gives cells, or a table, else trilinear",
     .standard = "file"},
    {"repeat", NEPH_WHOLES, VOLUME(repeat), "", 0, 1,
     .note = "along the world's x, y, z; 0: without end, as in tables of radiation codes",
     .standard = "[1, 1, 1]"},
    {"axes", NEPH_TEXT, VOLUME(axes),
     .note = "of a .nc: its dimensions along x, y, z, such as `x,y,z`", .least = 5, .most = 200,
     .standard = "the last three, z, y, x"},
    {"time_index", NEPH_WHOLE, VOLUME(time_index), "", 0, 1e9,
     .note = "of a .nc: the place along another dimension, from 0 on",
     .standard = "needed where there are several"},
    {"value_unit", NEPH_TEXT, VOLUME(value_unit),
     .note = "of a .nc or a text: in place of its unit: g/m3, kg/m3, 1/cm3, 1/m, 1/km ..., or "
             "1 for the unit of the density that is given",
     .least = 1, .most = 60, .standard = "its own"},
    {"placement", NEPH_WORD, VOLUME(placement), .words = placements,
     .note = "`file`: size and place from the file (.vdb); `fit`: size and place from `center_m` "
             "and a side",
     .standard = "`fit` if one of its keys is given, else `file`"},
    {"up", NEPH_WORD, VOLUME(up), .words = ups,
     .note = "the file's axis that points up; z: (x, y, z) of the file becomes (x, z, -y)",
     .standard = "y; z of a .nc, a text or a table"},
    {"index_box", NEPH_RECORD, VOLUME(index_box), .record = &index_box_record,
     .note = "the block of voxels by their indices in the file: no others are read",
     .standard = "all that are not 0 of a .vdb, all nodes of others"},
    {"center_m", NEPH_THREE, VOLUME(center_m), "m", -NEPH_FAR_M, NEPH_FAR_M,
     .note = "of the block of voxels", .standard = "needed by `placement: fit`"},
    {"longest_side_m", NEPH_NUMBER, VOLUME(longest_side_m), "m", 1e-3, NEPH_FAR_M,
     .note = "of the block of voxels, which keep the file's proportions; those of a .df3 are cubes",
     .standard = "needed by `placement: fit`, or `size_m`"},
    {"size_m", NEPH_THREE, VOLUME(size_m), "m", 1e-3, NEPH_FAR_M,
     .note = "of the block of voxels, along the world's x, y, z",
     .standard = "needed by `placement: fit`, or `longest_side_m`"},
    {"fit_to", NEPH_WORD, VOLUME(fit_to), .words = fits,
     .note = "the voxels of a .vdb that are the block: all that are not 0, or all active ones",
     .standard = "values"},
    {"origin_m", NEPH_THREE, VOLUME(origin_m), "m", -NEPH_FAR_M, NEPH_FAR_M,
     .note = "`placement: file` puts the file's origin there", .standard = "[0, 0, 0]"},
    {"unit_m", NEPH_NUMBER, VOLUME(unit_m), "m", 1e-6, 1e6,
     .note = "`placement: file`: the file's unit of length; 0.01 where it is a centimetre",
     .standard = "1"},
    {"memory_limit_mib", NEPH_WHOLE, VOLUME(memory_limit_mib), "MiB", 1,
     NEPH_GRID_NODES_MAX * sizeof(float) >> 20, .note = "of voxels in memory, 4 bytes each",
     .standard = "512"},
    {"extinction_per_m", NEPH_NUMBER, AT(extinction_per_m), "1/m", 0, 1e4, .note = "at value 1",
     .standard = NEPH_OR_ANOTHER_DENSITY},
    {"bounds", NEPH_RECORD, AT(bounds), .record = &neph_bounds_record, .standard = "unbounded"},
    {0},
};

/* --- placement ------------------------------------------------------------------------------- */

static const char *const fit_keys[] = {"center_m", "longest_side_m", "size_m", "fit_to", NULL};
static const char *const file_keys[] = {"origin_m", "unit_m", NULL};

/* The first of the keys that the file has; NULL: none. */
static const char *find_first_key(const struct neph_reader *reader, const yaml_node_t *node,
                                  const char *const *keys)
{
    while (*keys && !neph_reader_has(reader, node, *keys))
        keys++;
    return *keys;
}

static enum neph_status refuse(const struct neph_reader *reader, const char *key,
                               const char *message, const char *hint)
{
    neph_refuse(reader, key, "%s", message);
    neph_hint(reader->diag, "%s", hint);
    return NEPH_ERR_INPUT;
}

static enum neph_status check_fit(const struct neph_reader *reader, const yaml_node_t *node,
                                  bool has_transform)
{
    static const char *const hint = "placement: fit needs center_m, and longest_side_m or size_m";
    const bool has_side = neph_reader_has(reader, node, "longest_side_m");
    const bool has_size = neph_reader_has(reader, node, "size_m");
    if (!neph_reader_has(reader, node, "center_m"))
        return refuse(reader, "", "missing key 'center_m'", hint);
    if (!has_side && !has_size)
        return refuse(reader, "", "missing key 'longest_side_m', or 'size_m' for three sides",
                      hint);
    if (has_side && has_size)
        return refuse(reader, "size_m", "longest_side_m is given, too", hint);
    if (!neph_reader_has(reader, node, "fit_to"))
        return NEPH_OK;
    if (!has_transform)
        return refuse(reader, "fit_to", "all nodes of this file are its block",
                      "leave the key out");
    if (neph_reader_has(reader, node, "index_box"))
        return refuse(reader, "fit_to", "index_box already defines the block of voxels",
                      "leave one of the two out");
    return NEPH_OK;
}

/* Derives the placement from the keys that are given. */
static enum neph_status choose_placement(const struct neph_reader *reader, const yaml_node_t *node,
                                         const char *path, struct neph_written_volume *volume)
{
    const char *fit_key = find_first_key(reader, node, fit_keys);
    const char *file_key = find_first_key(reader, node, file_keys);
    const bool has_transform = neph_volume_has_transform(path) &&
                               !neph_reader_has(reader, node, "table_size");
    if (!neph_reader_has(reader, node, "placement"))
        volume->placement = fit_key || !has_transform ? PLACEMENT_FIT : PLACEMENT_FILE;
    if (volume->placement == PLACEMENT_FILE && !has_transform)
        return refuse(reader, "placement", "a .df3 or a table has no size and place",
                      "placement: fit, with center_m, and longest_side_m or size_m");
    if (volume->placement == PLACEMENT_FILE && fit_key)
        return refuse(reader, fit_key, "placement: file takes size and place from the file",
                      "leave the key out, or write placement: fit; origin_m moves what the file "
                      "places, unit_m scales it");
    if (volume->placement == PLACEMENT_FIT && file_key)
        return refuse(
            reader, file_key, "only placement: file has an origin and a unit",
            has_transform
                ? "leave out the keys of placement: fit (center_m and others), or this one"
                : "a .df3 or a table has neither; leave the key out");
    return volume->placement == PLACEMENT_FIT ? check_fit(reader, node, has_transform) : NEPH_OK;
}

static enum neph_status check_index_box(const struct neph_reader *reader,
                                        const struct neph_volume_box *box)
{
    for (int axis = 0; axis < 3; axis++)
        if (box->last[axis] < box->first[axis])
            return neph_refuse(reader, neph_format_path("index_box.last[%d]", axis).text,
                               "%d is below first, %d", box->last[axis], box->first[axis]);
    return NEPH_OK;
}

/* --- the grid -------------------------------------------------------------------------------- */

/* Scales and moves the grid so that the block of voxels has the given size and centre. */
static enum neph_status fit(struct neph_grid *grid, const struct neph_written_volume *volume,
                            struct neph_diag *diag)
{
    const struct neph_vec3 sides = {grid->size[0] * grid->spacing_m.x,
                                    grid->size[1] * grid->spacing_m.y,
                                    grid->size[2] * grid->spacing_m.z};
    const double longest = fmax(sides.x, fmax(sides.y, sides.z));
    const double scale = volume->longest_side_m / longest;
    struct neph_vec3 spacing_m = neph_vec3_scale(grid->spacing_m, scale);
    struct neph_vec3 half_m = neph_vec3_scale(neph_vec3_sub(sides, grid->spacing_m), 0.5 * scale);
    if (volume->longest_side_m == 0.0) { /* size_m is given instead */
        const struct neph_vec3 size_m = volume->size_m;
        spacing_m = (struct neph_vec3){size_m.x / grid->size[0], size_m.y / grid->size[1],
                                       size_m.z / grid->size[2]};
        half_m = neph_vec3_scale(neph_vec3_sub(size_m, spacing_m), 0.5);
    }
    return neph_grid_place(grid, neph_vec3_sub(volume->center_m, half_m), spacing_m, diag);
}

static enum neph_status place_as_file(struct neph_grid *grid,
                                      const struct neph_written_volume *volume,
                                      struct neph_diag *diag)
{
    const struct neph_vec3 origin_m = neph_vec3_along(volume->origin_m, grid->origin_m,
                                                      volume->unit_m);
    const struct neph_vec3 spacing_m = neph_vec3_scale(grid->spacing_m, volume->unit_m);
    enum neph_status status = neph_grid_place(grid, origin_m, spacing_m, diag);
    if (status)
        return status;
    const struct neph_bounds box = neph_grid_support(grid);
    const double *low_m = &box.min_m.x, *high_m = &box.max_m.x;
    for (int axis = 0; axis < 3; axis++)
        if (low_m[axis] < -NEPH_FAR_M || high_m[axis] > NEPH_FAR_M) {
            neph_fail(diag, NEPH_ERR_INPUT,
                      "the file puts the volume at %g to %g m along %c; a world is %g to %g m",
                      low_m[axis], high_m[axis], "xyz"[axis], -NEPH_FAR_M, NEPH_FAR_M);
            neph_hint(diag, "unit_m and origin_m scale and move it, or placement: fit with "
                            "center_m and longest_side_m");
            return NEPH_ERR_INPUT;
        }
    return NEPH_OK;
}

static enum neph_status check_band(const struct neph_reader *reader,
                                   const struct neph_radius_band *band)
{
    const double low_um = band->low_um, peak_um = band->peak_um, high_um = band->high_um;
    if (low_um <= peak_um && peak_um <= high_um && low_um < high_um)
        return NEPH_OK;
    neph_refuse(reader, "radius_band_um", "%g, %g, %g um do not ascend", low_um, peak_um, high_um);
    neph_hint(reader->diag, "[low, peak, high], of which two may be equal");
    return NEPH_ERR_INPUT;
}

/* With radii of its own, a voxel's value must be water or droplets. */
static enum neph_status check_radii(const struct neph_reader *reader, const yaml_node_t *node,
                                    const char *path, struct neph_written_volume *volume)
{
    static const char *const radius_keys[] = {"radius_unit_um", "radius_band_um", NULL};
    struct neph_written_density *density = &volume->common.density;
    const char *key = find_first_key(reader, node, radius_keys);
    if (!volume->radius_grid)
        return key ? neph_refuse(reader, key, "it needs the key radius_grid") : NEPH_OK;
    const bool has_band = neph_reader_has(reader, node, "radius_band_um");
    const enum neph_density_unit unit = neph_find_density(reader, node);
    if (unit != NEPH_DENSITY_WATER && unit != NEPH_DENSITY_DROPLETS &&
        !(has_band && unit == NEPH_DENSITY_EXTINCTION))
        return refuse(reader, "radius_grid", "the values of grid are not said to be of droplets",
                      "give water_g_per_m3 or droplets_per_cm3, 1 where the file has that unit; "
                      "extinction_per_m needs a radius_band_um");
    if (neph_reader_has(reader, node, "effective_radius_um"))
        return refuse(reader, "effective_radius_um", "radius_grid is given, too",
                      "leave one of them out");
    if (!neph_volume_has_transform(path) || neph_reader_has(reader, node, "table_size"))
        return refuse(reader, "radius_grid", "a .df3 or a table has only one grid",
                      "leave the key out");
    density->radius_in_voxels = true;
    density->unit = unit;
    return has_band ? check_band(reader, &volume->radius_band) : NEPH_OK;
}

/* Keys of some formats. */
static enum neph_status check_format_keys(const struct neph_reader *reader, const yaml_node_t *node,
                                          const char *path)
{
    static const char *const netcdf_keys[] = {"axes", "time_index", NULL};
    const bool is_netcdf = neph_volume_is_netcdf(path);
    const bool is_table = neph_reader_has(reader, node, "table_size");
    const char *key = find_first_key(reader, node, netcdf_keys);
    if (key && (!is_netcdf || is_table))
        return refuse(reader, key, "only a .nc has it", "leave the key out");
    if (neph_reader_has(reader, node, "value_unit") &&
        ((!is_netcdf && !neph_volume_is_text(path)) || is_table))
        return refuse(reader, "value_unit", "only a .nc or a text with a header has it",
                      "leave the key out");
    return NEPH_OK;
}

/* Nodes along an axis without end must not be too close (scenes/grid.h). */
static enum neph_status check_spacing(const struct neph_reader *reader,
                                      const struct neph_grid *grid)
{
    const double spacing_m[3] = {grid->spacing_m.x, grid->spacing_m.y, grid->spacing_m.z};
    for (int axis = 0; axis < 3; axis++)
        if (grid->is_endless[axis] && spacing_m[axis] < NEPH_GRID_ENDLESS_SPACING_M)
            return neph_refuse(reader, "repeat",
                               "nodes %g m apart along an axis without end: %g m at least",
                               spacing_m[axis], NEPH_GRID_ENDLESS_SPACING_M);
    return NEPH_OK;
}

/* A file's axis z points up where that is the convention of its format. */
static bool is_z_up(const struct neph_reader *reader, const yaml_node_t *node, const char *path,
                    const struct neph_written_volume *volume)
{
    if (neph_reader_has(reader, node, "up"))
        return volume->up == UP_Z;
    return neph_volume_is_netcdf(path) || neph_volume_is_text(path) ||
           neph_reader_has(reader, node, "table_size");
}

static struct neph_volume_request describe(const struct neph_reader *reader,
                                           const yaml_node_t *node, const char *path,
                                           const struct neph_written_volume *volume)
{
    const bool has_radius_unit = neph_reader_has(reader, node, "radius_unit_um");
    const bool has_band = neph_reader_has(reader, node, "radius_band_um");
    return (struct neph_volume_request){
        .path = path,
        .shown = volume->file,
        .grid_name = volume->grid,
        .radius_name = volume->radius_grid,
        .droplets = {volume->common.density.unit, has_radius_unit ? volume->radius_unit_um : 0.0,
                     volume->common.density.radii.effective_variance,
                     has_band ? &volume->radius_band : NULL},
        .axes = volume->axes,
        .time_index = neph_reader_has(reader, node, "time_index") ? &volume->time_index : NULL,
        .value_unit = volume->value_unit,
        .has_length_unit = neph_reader_has(reader, node, "unit_m"),
        .density = neph_find_density(reader, node),
        .table_size = neph_reader_has(reader, node, "table_size") ? volume->table_size : NULL,
        .interpolation = (enum neph_volume_interpolation)volume->interpolation,
        .is_endless = {volume->repeat[0] == 0, volume->repeat[1] == 0, volume->repeat[2] == 0},
        .memory_limit_bytes = (size_t)volume->memory_limit_mib << 20,
        .is_z_up = is_z_up(reader, node, path, volume),
        .index_box = neph_reader_has(reader, node, "index_box") ? &volume->index_box : NULL,
        .counts_zeros = volume->fit_to == FIT_TO_ACTIVE,
        .is_fitted = volume->placement == PLACEMENT_FIT};
}

enum neph_status neph_finish_volume(struct neph_reader *reader, const yaml_node_t *node,
                                    void *written)
{
    struct neph_written_volume *volume = written;
    struct neph_medium *medium = written;
    const bool has_index_box = neph_reader_has(reader, node, "index_box");
    const bool is_table = neph_reader_has(reader, node, "table_size");
    if (volume->file[0] != '$' && !is_table && !neph_volume_has_known_extension(volume->file))
        return neph_refuse(reader, "file",
                           "'%s' must end in .vdb, .df3, .nc, .dat, .lwc or .txt; or give "
                           "table_size",
                           volume->file);
    const char *path = NULL;
    enum neph_status status = has_index_box ? check_index_box(reader, &volume->index_box) : NEPH_OK;
    if (!status)
        status = neph_resolve_path(reader, volume->file, "/path/to/the/volume", &path);
    if (!status && (is_table || neph_volume_has_known_extension(path)))
        status = choose_placement(reader, node, path, volume);
    if (!status)
        status = check_radii(reader, node, path, volume);
    if (!status)
        status = check_format_keys(reader, node, path);
    if (!status) {
        const struct neph_volume_request request = describe(reader, node, path, volume);
        status = neph_volume_read(&request, &medium->grid, reader->diag);
    }
    if (status)
        return status;
    status = volume->placement == PLACEMENT_FIT ? fit(medium->grid, volume, reader->diag)
                                                : place_as_file(medium->grid, volume, reader->diag);
    return status ? status : check_spacing(reader, medium->grid);
}
