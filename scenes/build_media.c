/* SPDX-License-Identifier: MIT
 *
 * Media from a scene file: defaults, textures made, voxels read and put in place.
 */
#include "scenes/build.h"

#include "base/files.h"
#include "scenes/bake.h"
#include "scenes/grid.h"
#include "scenes/horizon.h"
#include "scenes/media.h"
#include "scenes/volume_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static struct neph_vec3 vec3(const double v[3])
{
    return (struct neph_vec3){v[0], v[1], v[2]};
}

static struct neph_rgb rgb(const double v[3])
{
    return (struct neph_rgb){v[0], v[1], v[2]};
}

static struct neph_bounds build_bounds(const struct neph_raw_bounds *bounds)
{
    if (bounds)
        return (struct neph_bounds){vec3(bounds->min_m), vec3(bounds->max_m)};
    return (struct neph_bounds){{-INFINITY, -INFINITY, -INFINITY}, {INFINITY, INFINITY, INFINITY}};
}

/* What all kinds have; the rest is left 0. `bounds` may be NULL. */
static struct neph_medium start_medium(enum neph_medium_kind kind,
                                       const struct neph_raw_optics *optics,
                                       const struct neph_raw_bounds *bounds)
{
    const double *color = optics->extinction_color;
    return (struct neph_medium){
        .kind = kind,
        .bounds = build_bounds(bounds),
        .extinction_color = color ? rgb(color) : (struct neph_rgb){1, 1, 1},
        .albedo = rgb(optics->albedo),
        .phase = {optics->phase ? *optics->phase : NEPH_PHASE_ISOTROPIC,
                  optics->asymmetry_g ? *optics->asymmetry_g : 0},
    };
}

static struct neph_medium build_homogeneous(const struct neph_raw_homogeneous *raw)
{
    struct neph_medium medium = start_medium(NEPH_MEDIUM_HOMOGENEOUS, &raw->optics, &raw->bounds);
    medium.layer_count = 1;
    medium.layers[0].extinction_per_m = raw->extinction_per_m;
    return medium;
}

static struct neph_medium build_height_fog(const struct neph_raw_height_fog *raw)
{
    struct neph_medium medium = start_medium(NEPH_MEDIUM_HEIGHT_FOG, &raw->optics, raw->bounds);
    medium.layer_count = (int)(raw->layers ? raw->layers_count : raw->unreal_layers_count);
    for (int i = 0; i < medium.layer_count; i++) {
        if (raw->layers) {
            medium.layers[i] = raw->layers[i];
            continue;
        }
        const struct neph_raw_unreal_layer *unreal = &raw->unreal_layers[i];
        medium.layers[i] = neph_fog_layer_from_unreal(&(struct neph_unreal_fog){
            unreal->fog_density, unreal->fog_height_falloff, unreal->fog_height_m});
    }
    return medium;
}

static struct neph_medium build_gaussian(const struct neph_raw_gaussian *raw)
{
    struct neph_medium medium = start_medium(NEPH_MEDIUM_GAUSSIAN, &raw->optics, raw->bounds);
    medium.extinction_per_m = raw->extinction_per_m;
    medium.gaussian = (struct neph_gaussian){vec3(raw->center_m), raw->width_m};
    return medium;
}

static struct neph_medium build_shell(const struct neph_raw_shell *raw)
{
    struct neph_medium medium = start_medium(NEPH_MEDIUM_SHELL, &raw->optics, &raw->bounds);
    medium.extinction_per_m = raw->extinction_per_m;
    medium.shell = (struct neph_shell){vec3(raw->center_m), raw->radius_m, raw->scale_height_m};
    return medium;
}

static enum neph_status build_grid(const struct neph_raw_grid *raw, struct neph_medium *medium,
                                   struct neph_diag *diag)
{
    *medium = start_medium(NEPH_MEDIUM_GRID, &raw->optics, raw->bounds);
    medium->extinction_per_m = raw->extinction_per_m;
    enum neph_status status = neph_grid_create(raw->size, vec3(raw->origin_m), vec3(raw->spacing_m),
                                               &medium->grid, diag);
    for (unsigned i = 0; i < raw->values_count && !status; i++)
        medium->grid->values[i] = (float)raw->values[i];
    return status ? status : neph_grid_seal(medium->grid, diag);
}

/* "$NAME/rest" starts in a folder, or is a file, that the environment names; a relative path starts
 * at the scene file. For the caller to free. */
static enum neph_status resolve_file(const char *file, const char *scene_path, char **path,
                                     struct neph_diag *diag)
{
    const char *slash = strrchr(scene_path, '/');
    if (file[0] == '$') {
        const size_t length = strcspn(file + 1, "/");
        char *name = strndup(file + 1, length);
        const char *value = name ? getenv(name) : NULL;
        free(name);
        if (!value || !*value) {
            neph_fail(diag, NEPH_ERR_NOT_FOUND, "'%s': the environment variable %.*s is not set",
                      file, (int)length, file + 1);
            neph_hint(diag, "export %.*s=/path/to/the/volume", (int)length, file + 1);
            return NEPH_ERR_NOT_FOUND;
        }
        *path = neph_format("%s%s", value, file + 1 + length);
    } else if (file[0] == '/' || !slash) {
        *path = strdup(file);
    } else {
        *path = neph_format("%.*s/%s", (int)(slash - scene_path), scene_path, file);
    }
    return *path ? NEPH_OK : neph_fail_memory(diag);
}

/* Scale and move it so that the block of voxels has its longest side and its centre. */
static enum neph_status place_volume(struct neph_grid *grid, const struct neph_raw_volume *raw,
                                     struct neph_diag *diag)
{
    const struct neph_vec3 sides_m = {grid->size[0] * grid->spacing_m.x,
                                      grid->size[1] * grid->spacing_m.y,
                                      grid->size[2] * grid->spacing_m.z};
    const double longest = fmax(sides_m.x, fmax(sides_m.y, sides_m.z));
    const double scale = raw->longest_side_m / longest;
    const struct neph_vec3 spacing_m = neph_vec3_scale(grid->spacing_m, scale);
    const struct neph_vec3 half_m = neph_vec3_scale(neph_vec3_sub(sides_m, grid->spacing_m),
                                                    0.5 * scale);
    return neph_grid_place(grid, neph_vec3_sub(vec3(raw->center_m), half_m), spacing_m, diag);
}

static enum neph_status build_volume(const struct neph_raw_volume *raw, const char *scene_path,
                                     struct neph_medium *medium, struct neph_diag *diag)
{
    *medium = start_medium(NEPH_MEDIUM_GRID, &raw->optics, raw->bounds);
    medium->extinction_per_m = raw->extinction_per_m;
    const size_t limit_bytes = raw->memory_limit_mib ? (size_t)*raw->memory_limit_mib << 20
                                                     : NEPH_GRID_NODES_MAX * sizeof(float);
    char *path = NULL;
    enum neph_status status = resolve_file(raw->file, scene_path, &path, diag);
    if (!status)
        status = neph_volume_read(path, raw->file, raw->grid, limit_bytes, &medium->grid, diag);
    free(path);
    return status ? status : place_volume(medium->grid, raw, diag);
}

static double number_or(const double *value, double otherwise)
{
    return value ? *value : otherwise;
}

static enum neph_status build_horizon(const struct neph_raw_horizon *raw,
                                      struct neph_medium *medium, struct neph_diag *diag)
{
    const struct neph_horizon_params article = neph_horizon_defaults();
    *medium = start_medium(NEPH_MEDIUM_HORIZON, &raw->optics, &raw->bounds);
    medium->extinction_per_m = raw->extinction_per_m;
    return neph_horizon_create(
        &(struct neph_horizon_params){
            .seed = raw->seed ? (uint64_t)*raw->seed : article.seed,
            .planet_radius_m = number_or(raw->planet_radius_m, article.planet_radius_m),
            .bottom_m = number_or(raw->bottom_m, article.bottom_m),
            .thickness_m = number_or(raw->thickness_m, article.thickness_m),
            .coverage = number_or(raw->coverage, article.coverage),
            .density = number_or(raw->density, article.density),
            .texture_scale_m = number_or(raw->texture_scale_m, article.texture_scale_m),
            .base_repeats = number_or(raw->base_repeats, article.base_repeats),
            .detail_repeats = number_or(raw->detail_repeats, article.detail_repeats),
            .wind_m = raw->wind_m ? vec3(raw->wind_m) : article.wind_m,
        },
        &medium->horizon, diag);
}

static const struct neph_raw_optics *optics_of(const struct neph_raw_medium *raw)
{
    return raw->homogeneous  ? &raw->homogeneous->optics
           : raw->height_fog ? &raw->height_fog->optics
           : raw->gaussian   ? &raw->gaussian->optics
           : raw->shell      ? &raw->shell->optics
           : raw->grid       ? &raw->grid->optics
           : raw->volume     ? &raw->volume->optics
                             : &raw->horizon->optics;
}

/* From here on the medium is its voxels, for all engines alike. */
static enum neph_status make_voxels(struct neph_medium *medium, int nodes, struct neph_diag *diag)
{
    const struct neph_bounds box = neph_medium_support(medium);
    struct neph_bake bake = {.grid = NULL};
    enum neph_status status = neph_medium_bake(medium, &box, nodes, &bake, diag);
    if (!status) {
        const struct neph_medium voxels = neph_medium_from_bake(medium, &bake);
        bake.grid = NULL; /* the medium has it */
        neph_medium_finish(medium);
        *medium = voxels;
    }
    neph_bake_finish(&bake);
    return status;
}

static enum neph_status build_medium(const struct neph_raw_medium *raw, const char *scene_path,
                                     struct neph_medium *medium, struct neph_diag *diag)
{
    const int *nodes = optics_of(raw)->voxels;
    enum neph_status status = NEPH_OK;
    if (raw->volume)
        status = build_volume(raw->volume, scene_path, medium, diag);
    else if (raw->grid)
        status = build_grid(raw->grid, medium, diag);
    else if (raw->horizon)
        status = build_horizon(raw->horizon, medium, diag);
    else
        *medium = raw->homogeneous  ? build_homogeneous(raw->homogeneous)
                  : raw->height_fog ? build_height_fog(raw->height_fog)
                  : raw->gaussian   ? build_gaussian(raw->gaussian)
                                    : build_shell(raw->shell);
    return status || !nodes ? status : make_voxels(medium, *nodes, diag);
}

enum neph_status neph_build_media(const struct neph_raw_scene *raw, struct neph_document *document,
                                  const char *path, struct neph_scene *scene,
                                  struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (unsigned i = 0; i < raw->media_count && !status; i++) {
        scene->medium_count++; /* what is half made is freed with the scene */
        status = build_medium(&raw->media[i], path, &scene->media[i], diag);
        if (status) {
            char place[NEPH_SCENE_PATH_MAX];
            snprintf(place, sizeof(place), "media[%u]", i);
            neph_document_locate(document, neph_document_find(document, place), diag);
        }
    }
    return status;
}
