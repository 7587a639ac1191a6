/* SPDX-License-Identifier: MIT */
#include "renderer/gpu_scene.h"

#include "scenes/grid.h"
#include "scenes/horizon.h"
#include "scenes/majorant.h"
#include "scenes/media.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* No float32 leaves the shaders' finite world. */
static float relative_m(double position_m, double camera_m)
{
    const double far_m = NEPH_GPU_FAR_M;
    return (float)fmax(-far_m, fmin(far_m, position_m - camera_m));
}

static void set_position(float out[3], struct neph_vec3 position_m, struct neph_vec3 camera_m)
{
    out[0] = relative_m(position_m.x, camera_m.x);
    out[1] = relative_m(position_m.y, camera_m.y);
    out[2] = relative_m(position_m.z, camera_m.z);
}

static void set_direction(float out[3], struct neph_vec3 direction)
{
    out[0] = (float)direction.x;
    out[1] = (float)direction.y;
    out[2] = (float)direction.z;
}

static void set_rgb(float out[3], struct neph_rgb rgb)
{
    out[0] = (float)rgb.r;
    out[1] = (float)rgb.g;
    out[2] = (float)rgb.b;
}

/* The reference height of a fog layer is a free choice: a e^(-b (y - h)) is the same fog for all
 * (a, h) with a e^(b h) fixed. The camera's own height is the best one, because there y is small
 * and keeps its digits; but no further than 20 scale heights from the layer's own, so that the
 * extinction stays well inside float32. */
struct neph_gpu_fog_layer neph_gpu_fog_layer_from(const struct neph_fog_layer *layer,
                                                  double camera_y_m)
{
    const double scale_heights_max = 20.0;
    const double extinction_max_per_m = 1e20; /* exponent_max in shaders/fog.glsl */
    const double exponent_max = 87.0;         /* e^88.8 is the end of float32 */
    const double extinction_min_per_m = 1e-36;
    double extinction_per_m = layer->extinction_per_m;
    double height_m = layer->height_m;
    if (layer->falloff_per_m > 0.0) {
        const double wanted = layer->falloff_per_m * (camera_y_m - layer->height_m);
        const double moved = fmax(-scale_heights_max, fmin(scale_heights_max, wanted));
        extinction_per_m *= exp(-moved);
        height_m = moved == wanted ? camera_y_m : layer->height_m + moved / layer->falloff_per_m;
    } else {
        height_m = camera_y_m;
    }
    extinction_per_m = fmax(extinction_min_per_m, fmin(extinction_max_per_m, extinction_per_m));
    return (struct neph_gpu_fog_layer){
        .extinction_per_m = (float)extinction_per_m,
        .falloff_per_m = (float)layer->falloff_per_m,
        .height_m = relative_m(height_m, camera_y_m),
        .exponent_max = (float)fmin(exponent_max, log(extinction_max_per_m / extinction_per_m)),
    };
}

struct neph_gpu_solid neph_gpu_solid_from(const struct neph_solid *solid,
                                          struct neph_vec3 camera_position_m)
{
    struct neph_gpu_solid gpu = {
        .kind = (uint32_t)solid->kind,
        .radius_m = (float)solid->radius_m,
    };
    const bool is_box = solid->kind == NEPH_SOLID_BOX;
    set_position(gpu.low_m, is_box ? solid->box.min_m : solid->center_m, camera_position_m);
    set_rgb(gpu.albedo, solid->albedo);
    if (is_box) {
        set_position(gpu.high_m, solid->box.max_m, camera_position_m);
        return gpu;
    }
    const struct neph_gpu_globe globe = neph_gpu_globe_from(solid->center_m, solid->radius_m,
                                                            camera_position_m);
    memcpy(gpu.high_m, globe.up, sizeof(gpu.high_m));
    gpu.albedo[3] = globe.camera_altitude_m;
    return gpu;
}

struct neph_gpu_globe neph_gpu_globe_from(struct neph_vec3 center_m, double radius_m,
                                          struct neph_vec3 camera_position_m)
{
    const struct neph_vec3 from_center_m = neph_vec3_sub(camera_position_m, center_m);
    const double distance_m = neph_vec3_length(from_center_m);
    struct neph_gpu_globe globe = {
        .up = {0.0f, 1.0f, 0.0f}, /* any direction will do at the centre */
        .camera_radius_m = (float)fmin(distance_m, NEPH_GPU_FAR_M),
        .camera_altitude_m = relative_m(distance_m, radius_m),
        .radius_m = (float)radius_m,
    };
    if (distance_m > 0.0)
        set_direction(globe.up, neph_vec3_scale(from_center_m, 1.0 / distance_m));
    return globe;
}

/* What a march may leave out, THIN of shaders/fog.glsl. */
static const double thin_optical_depth = 1e-7;

/* The extinction beyond which a medium is opaque within any step, and which times FAR_M is still a
 * float32. */
static const double extinction_max_per_m = 1e20;

static struct neph_gpu_gaussian gaussian_from(const struct neph_medium *medium,
                                              struct neph_vec3 camera_position_m)
{
    const double width_m = medium->gaussian.width_m;
    /* A line outside a sphere of radius r meets at most the whole line's depth at impact r. */
    const double central = medium->extinction_per_m * width_m * sqrt(2.0 * M_PI);
    const double widths = sqrt(2.0 * log(fmax(1.0, central / thin_optical_depth)));
    struct neph_gpu_gaussian gpu = {
        .width_m = (float)width_m,
        .reach_m = relative_m(widths * width_m, 0.0),
    };
    set_position(gpu.center_m, medium->gaussian.center_m, camera_position_m);
    return gpu;
}

static struct neph_gpu_shell shell_from(const struct neph_medium *medium,
                                        struct neph_vec3 camera_position_m)
{
    const struct neph_shell *shell = &medium->shell;
    /* The whole of a level line, Chapman's sqrt(2 pi r H), bounds what is above its height; r is
     * taken where it matters, a few scale heights up, and the excess of 1 covers the rest. */
    const double level_m = sqrt(2.0 * M_PI * (shell->radius_m + 40.0 * shell->scale_height_m) *
                                shell->scale_height_m);
    const double folds = log(fmax(1.0, medium->extinction_per_m * level_m / thin_optical_depth));
    return (struct neph_gpu_shell){
        .globe = neph_gpu_globe_from(shell->center_m, shell->radius_m, camera_position_m),
        .scale_height_m = (float)shell->scale_height_m,
        .reach_m = relative_m((folds + 1.0) * shell->scale_height_m, 0.0),
    };
}

/* With the layer of zeros that shaders/grid.glsl expects. */
static struct neph_gpu_grid grid_from(const struct neph_grid *grid, struct neph_vec3 camera_m)
{
    struct neph_gpu_grid gpu = {.nodes_per_m = {(float)(1.0 / grid->spacing_m.x),
                                                (float)(1.0 / grid->spacing_m.y),
                                                (float)(1.0 / grid->spacing_m.z)}};
    set_position(gpu.origin_m, neph_vec3_sub(grid->origin_m, grid->spacing_m), camera_m);
    for (int axis = 0; axis < 3; axis++)
        gpu.size[axis] = (uint32_t)grid->size[axis] + 2;
    return gpu;
}

_Static_assert(NEPH_HORIZON_BASE_SIDE == 64 && NEPH_HORIZON_DETAIL_SIDE == 32 &&
                   NEPH_HORIZON_WEATHER_SIDE == 256,
               "horizon.glsl's sides");

/* A place along one axis of a periodic texture [texels], from the first texel's. */
static float texel_at(double place_m, double repeats_per_m, int side)
{
    const double repeats = place_m * repeats_per_m;
    return (float)((repeats - floor(repeats)) * side - 0.5);
}

static struct neph_gpu_horizon horizon_from(const struct neph_horizon_params *params,
                                            struct neph_vec3 camera_position_m)
{
    enum { BASE = NEPH_HORIZON_BASE_SIDE, DETAIL = NEPH_HORIZON_DETAIL_SIDE };
    const struct neph_vec3 center_m = {0.0, params->bottom_m - params->planet_radius_m, 0.0};
    const struct neph_vec3 from_m = neph_vec3_sub(camera_position_m, params->wind_m);
    const double from[3] = {from_m.x, from_m.y, from_m.z};
    const double weather_per_m = 1.0 / params->texture_scale_m;
    const double base_per_m = params->base_repeats * weather_per_m;
    const double detail_per_m = params->detail_repeats * weather_per_m;
    struct neph_gpu_horizon gpu = {
        .globe = neph_gpu_globe_from(center_m, params->planet_radius_m, camera_position_m),
        .base_per_m = (float)(base_per_m * BASE),
        .detail_per_m = (float)(detail_per_m * DETAIL),
        .weather_at = {texel_at(from_m.x, weather_per_m, NEPH_HORIZON_WEATHER_SIDE),
                       texel_at(from_m.z, weather_per_m, NEPH_HORIZON_WEATHER_SIDE)},
        .weather_per_m = (float)(weather_per_m * NEPH_HORIZON_WEATHER_SIDE),
        .thickness_m = (float)params->thickness_m,
        .coverage = (float)params->coverage,
        .density = (float)params->density,
        .erosion = (float)(0.8 * exp(-0.75 * params->coverage)),
    };
    for (int axis = 0; axis < 3; axis++) {
        gpu.base_at[axis] = texel_at(from[axis], base_per_m, BASE);
        gpu.detail_at[axis] = texel_at(from[axis], detail_per_m, DETAIL);
    }
    return gpu;
}

/* Layers without extinction are left out: nothing in the shaders has to expect a 0. */
struct neph_gpu_medium neph_gpu_medium_from(const struct neph_medium *medium,
                                            struct neph_vec3 camera_position_m)
{
    const struct neph_bounds support = neph_medium_support(medium);
    struct neph_gpu_medium gpu = {
        .kind = (uint32_t)medium->kind,
        .phase_kind = (uint32_t)medium->phase.kind,
        .g = (float)medium->phase.g,
        .extinction_per_m = (float)fmin(medium->extinction_per_m, extinction_max_per_m),
    };
    set_position(gpu.low_m, support.min_m, camera_position_m);
    set_position(gpu.high_m, support.max_m, camera_position_m);
    set_rgb(gpu.albedo, medium->albedo);
    set_rgb(gpu.extinction_color, medium->extinction_color);
    if (medium->kind == NEPH_MEDIUM_GAUSSIAN)
        gpu.gaussian = gaussian_from(medium, camera_position_m);
    if (medium->kind == NEPH_MEDIUM_SHELL)
        gpu.shell = shell_from(medium, camera_position_m);
    if (medium->kind == NEPH_MEDIUM_GRID)
        gpu.grid = grid_from(medium->grid, camera_position_m);
    if (medium->kind == NEPH_MEDIUM_HORIZON) {
        const struct neph_horizon_params *params = &medium->horizon->params;
        const double density_max = fmax(1.0, 2.0 * params->density);
        gpu.horizon = horizon_from(params, camera_position_m);
        gpu.extinction_per_m = fminf(gpu.extinction_per_m,
                                     (float)(extinction_max_per_m / density_max));
    }
    for (int i = 0; i < medium->layer_count; i++)
        if (medium->layers[i].extinction_per_m > 0.0)
            gpu.layers[gpu.layer_count++] = neph_gpu_fog_layer_from(&medium->layers[i],
                                                                    camera_position_m.y);
    return gpu;
}

static bool is_fog(const struct neph_medium *medium)
{
    return medium->kind == NEPH_MEDIUM_HOMOGENEOUS || medium->kind == NEPH_MEDIUM_HEIGHT_FOG;
}

/* Media that do nothing are left out. */
static bool is_there(const struct neph_medium *medium)
{
    const struct neph_rgb color = medium->extinction_color;
    double extinction_per_m = is_fog(medium) ? 0.0 : medium->extinction_per_m;
    for (int i = 0; i < medium->layer_count; i++)
        extinction_per_m = fmax(extinction_per_m, medium->layers[i].extinction_per_m);
    return extinction_per_m > 0.0 && (color.r > 0.0 || color.g > 0.0 || color.b > 0.0);
}

static bool is_black(const float rgb[3])
{
    return rgb[0] <= 0.0f && rgb[1] <= 0.0f && rgb[2] <= 0.0f;
}

/* The camera, the sun and the sky. */
static struct neph_gpu_frame frame_from(const struct neph_scene *scene,
                                        const struct neph_camera *camera, int width_px,
                                        int height_px)
{
    const double tan_half_height = tan(0.5 * camera->vertical_fov_rad);
    struct neph_gpu_frame gpu = {
        .tan_half_width = (float)(tan_half_height * width_px / height_px),
        .tan_half_height = (float)tan_half_height,
        .width_px = (uint32_t)width_px,
        .height_px = (uint32_t)height_px,
        .solid_count = (uint32_t)scene->solid_count,
        .octave_count = (uint32_t)scene->octaves.count,
        .octave_factors = {(float)scene->octaves.contribution, (float)scene->octaves.attenuation,
                           (float)scene->octaves.eccentricity},
    };
    set_direction(gpu.camera_right, camera->right);
    set_direction(gpu.camera_up, camera->up);
    set_direction(gpu.camera_forward, camera->forward);
    set_rgb(gpu.background, scene->background_w_per_m2_sr);
    if (scene->sun.present) {
        set_direction(gpu.sun_direction, scene->sun.direction);
        set_rgb(gpu.sun_irradiance, scene->sun.irradiance_w_per_m2);
    }
    return gpu;
}

/* --- buffers ------------------------------------------------------------------------------ */

/* A device buffer of at least one element: nothing may be bound that is empty. */
static enum neph_status upload(const struct neph_vulkan *vulkan, const void *data, size_t count,
                               size_t element_bytes, const char *name, struct neph_buffer *buffer,
                               struct neph_diag *diag)
{
    const size_t bytes = (count > 0 ? count : 1) * element_bytes;
    enum neph_status status = neph_buffer_create(vulkan, NEPH_BUFFER_DEVICE, bytes, name, buffer,
                                                 diag);
    if (!status && count > 0)
        status = neph_buffer_upload(vulkan, buffer, 0, data, bytes, diag);
    return status;
}

/* Room for all solids in mapped memory: they move with the camera. */
static enum neph_status create_solids(const struct neph_vulkan *vulkan,
                                      const struct neph_scene *scene, struct neph_gpu_scene *gpu,
                                      struct neph_diag *diag)
{
    const size_t count = scene->solid_count > 0 ? (size_t)scene->solid_count : 1;
    return neph_buffer_create(vulkan, NEPH_BUFFER_UPLOAD, count * sizeof(struct neph_gpu_solid),
                              "scene solids", &gpu->buffers[1], diag);
}

static size_t padded_count(const struct neph_grid *grid)
{
    return (size_t)(grid->size[0] + 2) * (size_t)(grid->size[1] + 2) * (size_t)(grid->size[2] + 2);
}

/* One slab of the padded lattice after the other: no second copy of the grid in memory. */
static enum neph_status upload_grid(const struct neph_vulkan *vulkan,
                                    const struct neph_medium *medium, size_t first,
                                    const struct neph_buffer *buffer, struct neph_diag *diag)
{
    const struct neph_grid *grid = medium->grid;
    const float value_max = (float)(extinction_max_per_m / fmax(1.0, medium->extinction_per_m));
    const size_t nx = (size_t)grid->size[0], ny = (size_t)grid->size[1], nz = (size_t)grid->size[2];
    const size_t slab_count = (nx + 2) * (ny + 2);
    float *slab = malloc(slab_count * sizeof(*slab));
    enum neph_status status = slab ? NEPH_OK : neph_fail_memory(diag);
    for (size_t z = 0; z < nz + 2 && !status; z++) {
        memset(slab, 0, slab_count * sizeof(*slab));
        for (size_t y = 0; z > 0 && z <= nz && y < ny; y++)
            for (size_t x = 0; x < nx; x++)
                slab[(y + 1) * (nx + 2) + 1 + x] = fminf(grid->values[((z - 1) * ny + y) * nx + x],
                                                         value_max);
        status = neph_buffer_upload(vulkan, buffer, (first + z * slab_count) * sizeof(*slab), slab,
                                    slab_count * sizeof(*slab), diag);
    }
    free(slab);
    return status;
}

static enum neph_status upload_grids(const struct neph_vulkan *vulkan,
                                     const struct neph_scene *scene, struct neph_gpu_scene *gpu,
                                     struct neph_diag *diag)
{
    size_t count = 0, first = 0;
    for (int i = 0; i < scene->medium_count; i++)
        if (scene->media[i].kind == NEPH_MEDIUM_GRID)
            count += padded_count(scene->media[i].grid);
    if (count > UINT32_MAX / sizeof(float))
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                         "the voxel grids of scene %s hold %zu nodes; a shader can address %u",
                         scene->name, count, (unsigned)(UINT32_MAX / sizeof(float)));
    enum neph_status status = upload(vulkan, NULL, 0, sizeof(float) * (count > 0 ? count : 1),
                                     "scene grids", &gpu->buffers[2], diag);
    for (int i = 0; i < scene->medium_count && !status; i++) {
        const struct neph_medium *medium = &scene->media[i];
        if (medium->kind != NEPH_MEDIUM_GRID)
            continue;
        status = upload_grid(vulkan, medium, first, &gpu->buffers[2], diag);
        first += padded_count(medium->grid);
    }
    return status;
}

enum {
    base_texels = NEPH_HORIZON_BASE_SIDE * NEPH_HORIZON_BASE_SIDE * NEPH_HORIZON_BASE_SIDE,
    detail_texels = NEPH_HORIZON_DETAIL_SIDE * NEPH_HORIZON_DETAIL_SIDE * NEPH_HORIZON_DETAIL_SIDE,
    weather_texels = NEPH_HORIZON_WEATHER_SIDE * NEPH_HORIZON_WEATHER_SIDE,
    horizon_texels = base_texels + detail_texels + weather_texels,
};

/* Shaders read four channels of every texture. */
static void four_channels(const float *texels, int count, int channels, float *out)
{
    for (int i = 0; i < count; i++)
        for (int c = 0; c < 4; c++)
            *out++ = c < channels ? texels[i * channels + c] : 0.0f;
}

static enum neph_status upload_horizons(const struct neph_vulkan *vulkan,
                                        const struct neph_scene *scene, struct neph_gpu_scene *gpu,
                                        struct neph_diag *diag)
{
    const size_t texel_bytes = 4 * sizeof(float);
    size_t count = 0;
    for (int i = 0; i < scene->medium_count; i++)
        if (scene->media[i].kind == NEPH_MEDIUM_HORIZON)
            count += horizon_texels;
    float *texels = malloc((count + 1) * texel_bytes);
    if (!texels)
        return neph_fail_memory(diag);
    float *out = texels;
    for (int i = 0; i < scene->medium_count; i++) {
        const struct neph_horizon *horizon = scene->media[i].horizon;
        if (scene->media[i].kind != NEPH_MEDIUM_HORIZON)
            continue;
        four_channels(horizon->base, base_texels, 4, out);
        four_channels(horizon->detail, detail_texels, 3, out + 4 * base_texels);
        four_channels(horizon->weather, weather_texels, 4, out + 4 * (base_texels + detail_texels));
        out += 4 * horizon_texels;
    }
    const enum neph_status status = upload(vulkan, texels, count, texel_bytes, "scene textures",
                                           &gpu->buffers[4], diag);
    free(texels);
    return status;
}

/* All majorant grids, one after the other; sizes and places go into the media. */
static enum neph_status upload_majorants(const struct neph_vulkan *vulkan,
                                         const struct neph_medium *const *media,
                                         struct neph_gpu_scene *gpu, struct neph_diag *diag)
{
    float *values = NULL;
    size_t count = 0;
    enum neph_status status = NEPH_OK;
    for (uint32_t m = 0; m < gpu->frame->medium_count && !status; m++) {
        struct neph_gpu_medium *medium = &gpu->frame->media[m];
        struct neph_majorants *majorants = NULL;
        const struct neph_bounds box = neph_medium_support(media[m]);
        if (is_fog(media[m]))
            continue;
        status = neph_majorants_create(media[m], &box, neph_majorants_cell_count(media[m]->kind),
                                       &majorants, diag);
        if (status)
            break;
        neph_majorants_cover_nodes(majorants, media[m]); /* what grid_random_node() looks up */
        const size_t cells = (size_t)majorants->size[0] * (size_t)majorants->size[1] *
                             (size_t)majorants->size[2];
        float *grown = realloc(values, (count + cells) * sizeof(*values));
        if (grown) {
            values = grown;
            memcpy(values + count, majorants->extinction_per_m, cells * sizeof(*values));
            medium->majorant_first = (uint32_t)count;
            for (int axis = 0; axis < 3; axis++)
                medium->majorant_size[axis] = (uint32_t)majorants->size[axis];
            count += cells;
        } else {
            status = neph_fail_memory(diag);
        }
        neph_majorants_destroy(majorants);
    }
    if (!status)
        status = upload(vulkan, values, count, sizeof(float), "scene majorants", &gpu->buffers[3],
                        diag);
    free(values);
    return status;
}

/* --- the scene ---------------------------------------------------------------------------- */

/* Upper bound of the loop turns of medium_optical_depth(), following shaders/ loop by loop. */
static uint64_t depth_turns(const struct neph_medium *medium)
{
    switch (medium->kind) {
    case NEPH_MEDIUM_GRID:
        return (uint64_t)(medium->grid->size[0] + medium->grid->size[1] + medium->grid->size[2]) +
               12;
    default:
        return (uint64_t)medium->layer_count + 16; /* loops of other kinds turn at least once */
    }
}

/* Media of the frame, and for each where it came from. */
static void fill_media(const struct neph_scene *scene, struct neph_vec3 camera_m,
                       struct neph_gpu_scene *gpu,
                       const struct neph_medium *media[NEPH_SCENE_MEDIA_MAX])
{
    struct neph_gpu_frame *frame = gpu->frame;
    bool scatters = false;
    uint32_t first = 0, first_texel = 0;
    gpu->optical_depth_turns = 1;
    for (int i = 0; i < scene->medium_count; i++) {
        const struct neph_medium *medium = &scene->media[i];
        struct neph_gpu_medium made = neph_gpu_medium_from(medium, camera_m);
        if (medium->kind == NEPH_MEDIUM_GRID) {
            made.grid.first = first;
            first += (uint32_t)padded_count(medium->grid);
        }
        if (medium->kind == NEPH_MEDIUM_HORIZON) {
            made.horizon.first = first_texel;
            first_texel += horizon_texels;
        }
        if (!is_there(medium))
            continue;
        scatters = scatters || !is_black(made.albedo);
        gpu->constants[0] |= 1u << medium->kind;
        gpu->constants[1] |= neph_medium_is_coloured(medium);
        gpu->optical_depth_turns += 1 + depth_turns(medium);
        media[frame->medium_count] = medium;
        frame->media[frame->medium_count++] = made;
    }
    frame->scatters = scatters && scene->scattering != NEPH_SCATTERING_NONE &&
                      !is_black(frame->sun_irradiance);
}

/* The first buffers, and which medium each of theirs is. */
static void fill(struct neph_gpu_scene *gpu, const struct neph_scene *scene, double frame,
                 int width_px, int height_px, const struct neph_medium *media[NEPH_SCENE_MEDIA_MAX])
{
    const struct neph_camera camera = neph_scene_camera(scene, frame);
    struct neph_gpu_solid *solids = gpu->buffers[1].mapped;
    *gpu->frame = frame_from(scene, &camera, width_px, height_px);
    gpu->constants[0] = gpu->constants[1] = 0;
    fill_media(scene, camera.position_m, gpu, media);
    for (int i = 0; i < scene->solid_count; i++)
        solids[i] = neph_gpu_solid_from(&scene->solids[i], camera.position_m);
}

enum neph_status neph_gpu_scene_create(const struct neph_vulkan *vulkan,
                                       const struct neph_scene *scene, double frame, int width_px,
                                       int height_px, bool with_majorants,
                                       struct neph_gpu_scene *gpu, struct neph_diag *diag)
{
    const struct neph_medium *media[NEPH_SCENE_MEDIA_MAX];
    enum neph_status status = neph_buffer_create(vulkan, NEPH_BUFFER_UPLOAD, sizeof(*gpu->frame),
                                                 "scene frame", &gpu->buffers[0], diag);
    if (!status)
        status = create_solids(vulkan, scene, gpu, diag);
    if (status)
        return status;
    gpu->frame = gpu->buffers[0].mapped;
    fill(gpu, scene, frame, width_px, height_px, media);
    status = upload_grids(vulkan, scene, gpu, diag);
    if (!status && with_majorants)
        status = upload_majorants(vulkan, media, gpu, diag);
    else if (!status)
        status = upload(vulkan, NULL, 0, sizeof(float), "scene majorants", &gpu->buffers[3], diag);
    if (!status)
        status = upload_horizons(vulkan, scene, gpu, diag);
    return status;
}

void neph_gpu_scene_move(struct neph_gpu_scene *gpu, const struct neph_scene *scene, double frame,
                         int width_px, int height_px)
{
    const struct neph_medium *media[NEPH_SCENE_MEDIA_MAX];
    fill(gpu, scene, frame, width_px, height_px, media);
}

void neph_gpu_scene_destroy(const struct neph_vulkan *vulkan, struct neph_gpu_scene *gpu)
{
    for (int i = 0; i < NEPH_GPU_SCENE_BUFFERS; i++)
        neph_buffer_destroy(vulkan, &gpu->buffers[i]);
    gpu->frame = NULL;
}

void neph_gpu_scene_bind(const struct neph_gpu_scene *gpu, struct neph_dispatch *dispatch)
{
    for (int i = 0; i < NEPH_GPU_SCENE_BUFFERS; i++)
        dispatch->buffers[i] = &gpu->buffers[i];
}
