/* SPDX-License-Identifier: MIT */
#include "renderer/gpu_scene.h"

#include "renderer/gpu_mesh_looks.h"
#include "renderer/media/kind.h"
#include "renderer/octaves_fitted.h"
#include "renderer/phase_tables.h"
#include "renderer/relative.h"
#include "renderer/texture.h"
#include "scenes/emission.h"
#include "scenes/grid.h"
#include "scenes/majorant.h"
#include "scenes/media.h"
#include "scenes/phase_colour.h"
#include "scenes/solids.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Does not compile with a new kind: this file then needs a change. */
_Static_assert(NEPH_GPU_DATA_COUNT == 3, "a new kind");
_Static_assert(NEPH_MEDIUM_KIND_COUNT == 8, "a new kind");
_Static_assert(NEPH_SCATTERING_COUNT == 3, "a new kind");
_Static_assert(NEPH_SOLID_KIND_COUNT == 3, "a new kind");

static void set_rgb(float out[3], struct neph_rgb rgb)
{
    out[0] = (float)rgb.r;
    out[1] = (float)rgb.g;
    out[2] = (float)rgb.b;
}

/* The axis and angle of a turned box, as SOLID_TURNED of shaders/solids.glsl and the kinds after
 * it. */
static void set_turn(const struct neph_turn *turn, struct neph_gpu_solid *box)
{
    box->kind = NEPH_GPU_SOLID_TURNED + (uint32_t)turn->axis;
    box->radius_m = (float)turn->cosine;
    box->albedo[3] = (float)turn->sine;
}

struct neph_gpu_solid neph_gpu_solid_pack(const struct neph_solid *solid,
                                          struct neph_vec3 camera_position_m)
{
    struct neph_gpu_solid gpu = {
        .kind = (uint32_t)solid->kind,
        .radius_m = (float)solid->radius_m,
    };
    const bool is_box = solid->kind == NEPH_SOLID_BOX;
    neph_relative_position(gpu.low_m, is_box ? solid->box.min_m : solid->center_m,
                           camera_position_m);
    set_rgb(gpu.albedo, solid->albedo);
    if (is_box) {
        neph_relative_position(gpu.high_m, solid->box.max_m, camera_position_m);
        if (neph_is_turned(&solid->turn))
            set_turn(&solid->turn, &gpu);
        return gpu;
    }
    const struct neph_gpu_globe globe = neph_gpu_globe_from(solid->center_m, solid->radius_m,
                                                            camera_position_m);
    memcpy(gpu.high_m, globe.up, sizeof(gpu.high_m));
    gpu.albedo[3] = globe.camera_altitude_m;
    return gpu;
}

_Static_assert(NEPH_GPU_FITTED_OCTAVES == NEPH_OCTAVES_FITTED_COUNT, "one number of octaves");

/* Contributions are per channel. The scales of the phase function and of the sun's optical depth
 * are common to the channels: separate ones would triple the cost. */
static void fit_octaves(const struct neph_medium *medium, struct neph_gpu_medium *gpu)
{
    const struct neph_rgb albedo = medium->albedo;
    const double g = neph_phase_mean_cosine(&medium->phase);
    const struct neph_octaves mean = neph_octaves_compute(&neph_octaves_fitted, g,
                                                          (albedo.r + albedo.g + albedo.b) / 3.0);
    const double of_channels[3] = {albedo.r, albedo.g, albedo.b};
    for (int c = 0; c < 3; c++)
        gpu->octave_contribution[c] =
            (float)neph_octaves_compute(&neph_octaves_fitted, g, of_channels[c]).contribution;
    gpu->octave_attenuation = (float)mean.attenuation;
    gpu->octave_eccentricity = (float)mean.eccentricity;
}

static struct neph_gpu_medium pack_medium(const struct neph_medium *medium,
                                          struct neph_vec3 camera_m, uint32_t first)
{
    const struct neph_bounds support = neph_medium_support(medium);
    struct neph_gpu_medium gpu = {
        .kind = (uint32_t)medium->kind,
        .phase_kind = (uint32_t)medium->phase.kind,
        .g = (float)medium->phase.g, /* of a table: see place_phase() */
        .extinction_per_m = (float)fmin(medium->extinction_per_m, NEPH_GPU_EXTINCTION_MAX),
    };
    neph_relative_position(gpu.low_m, support.min_m, camera_m);
    neph_relative_position(gpu.high_m, support.max_m, camera_m);
    neph_relative_position(gpu.bounds_low_m, medium->box.min_m, camera_m);
    neph_relative_position(gpu.bounds_high_m, medium->box.max_m, camera_m);
    gpu.turn_axis = (uint32_t)medium->turn.axis;
    gpu.turn_cosine = (float)medium->turn.cosine;
    gpu.turn_sine = (float)medium->turn.sine;
    set_rgb(gpu.albedo, medium->albedo);
    set_rgb(gpu.extinction_color, medium->extinction_color);
    set_rgb(gpu.glow, neph_medium_glow(medium));
    fit_octaves(medium, &gpu);
    neph_gpu_get_kind(medium)->pack(medium, camera_m, first, &gpu);
    return gpu;
}

/* Whether a medium has an effect; others are omitted. */
static bool has_effect(const struct neph_medium *medium)
{
    const struct neph_rgb color = medium->extinction_color;
    return neph_gpu_largest_per_m(medium) > 0.0 &&
           (color.r > 0.0 || color.g > 0.0 || color.b > 0.0);
}

static bool is_black(const float rgb[3])
{
    return rgb[0] <= 0.0f && rgb[1] <= 0.0f && rgb[2] <= 0.0f;
}

struct neph_gpu_lamp neph_gpu_lamp_pack(const struct neph_light *light, struct neph_vec3 camera_m)
{
    struct neph_gpu_lamp lamp = {
        .inner_cosine = light->is_spot ? (float)light->inner_cosine : -2.0f,
        .outer_cosine = light->is_spot ? (float)light->outer_cosine : -3.0f,
    };
    neph_relative_position(lamp.position_m, light->position_m, camera_m);
    set_rgb(lamp.intensity, light->intensity_w_per_sr);
    if (light->is_spot)
        neph_gpu_direction(lamp.axis, light->axis);
    return lamp;
}

static void fill_lights(const struct neph_scene *scene, struct neph_vec3 camera_m,
                        struct neph_gpu_frame *frame)
{
    for (int i = 0; i < scene->light_count; i++)
        frame->lamps[i] = neph_gpu_lamp_pack(&scene->lights[i], camera_m);
    frame->lamp_count = (uint32_t)scene->light_count;
}

/* Camera, sun and sky of a frame. */
static struct neph_gpu_frame pack_frame(const struct neph_scene *scene,
                                        const struct neph_camera *camera, int width_px,
                                        int height_px)
{
    const double half_height = neph_camera_half_height(camera);
    struct neph_gpu_frame gpu = {
        .half_width = (float)(half_height * width_px / height_px),
        .half_height = (float)half_height,
        .width_px = (uint32_t)width_px,
        .height_px = (uint32_t)height_px,
        .solid_count = (uint32_t)neph_gpu_count_plain_solids(scene),
        .octave_count = (uint32_t)scene->octaves.count,
        .octave_factors = {(float)scene->octaves.contribution, (float)scene->octaves.attenuation,
                           (float)scene->octaves.eccentricity},
    };
    neph_gpu_direction(gpu.camera_right, camera->right);
    neph_gpu_direction(gpu.camera_up, camera->up);
    neph_gpu_direction(gpu.camera_forward, camera->forward);
    set_rgb(gpu.background, scene->background_w_per_m2_sr);
    if (scene->sun.present) {
        neph_gpu_direction(gpu.sun_direction, scene->sun.direction);
        set_rgb(gpu.sun_irradiance, scene->sun.irradiance_w_per_m2);
    }
    return gpu;
}

/* --- lists of media ----------------------------------------------------------------------- */

uint32_t neph_gpu_scene_list_media(const struct neph_scene *scene,
                                   const struct neph_medium *media[NEPH_GPU_MEDIA_MAX])
{
    uint32_t count = 0;
    for (int i = 0; i < scene->medium_count; i++)
        if (has_effect(&scene->media[i]))
            media[count++] = &scene->media[i];
    return count;
}

bool neph_gpu_is_same_sun(const struct neph_sun *a, const struct neph_sun *b)
{
    return a->direction.x == b->direction.x && a->direction.y == b->direction.y &&
           a->direction.z == b->direction.z;
}

uint32_t neph_gpu_scene_pack_media(const struct neph_scene *scene,
                                   struct neph_gpu_medium media[NEPH_GPU_MEDIA_MAX])
{
    const struct neph_medium *list[NEPH_GPU_MEDIA_MAX];
    const struct neph_vec3 origin_m = {0.0, 0.0, 0.0};
    const uint32_t count = neph_gpu_scene_list_media(scene, list);
    memset(media, 0, NEPH_GPU_MEDIA_MAX * sizeof(*media));
    for (uint32_t m = 0; m < count; m++)
        media[m] = pack_medium(list[m], origin_m, 0);
    return count;
}

bool neph_find_media_bounds(const struct neph_scene *scene, struct neph_bounds *box)
{
    bool any = false;
    for (int i = 0; i < scene->medium_count; i++) {
        if (neph_medium_is_fog(&scene->media[i]) || !has_effect(&scene->media[i]))
            continue;
        const struct neph_bounds own = neph_medium_support(&scene->media[i]);
        *box = any ? neph_bounds_hull(*box, own) : own;
        any = true;
    }
    return any;
}

/* --- buffers ------------------------------------------------------------------------------ */

/* Upload to a device buffer of at least one element, because an empty buffer cannot be bound. */
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

/* A mapped buffer for all solids: they are relative to the camera and change with it. */
static enum neph_status create_solids(const struct neph_vulkan *vulkan, struct neph_gpu_scene *gpu,
                                      struct neph_diag *diag)
{
    const size_t bytes = sizeof(struct neph_gpu_solids);
    if (bytes > vulkan->limits.maxUniformBufferRange)
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                         "the solids need a uniform buffer of %zu bytes; the device allows %u: "
                         "NEPH_VULKAN_DEVICE selects another device",
                         bytes, vulkan->limits.maxUniformBufferRange);
    return neph_buffer_create(vulkan, NEPH_BUFFER_UPLOAD, bytes, "scene solids", &gpu->buffers[1],
                              diag);
}

static const struct {
    int binding;
    size_t element_bytes;
    const char *name;
} data_buffers[NEPH_GPU_DATA_COUNT] = {
    [NEPH_GPU_VALUES] = {NEPH_GPU_VALUES_BUFFER, sizeof(float), "scene grids"},
    [NEPH_GPU_TEXELS] = {NEPH_GPU_TEXELS_BUFFER, 4 * sizeof(float), "scene textures"},
};

static size_t data_count(const struct neph_medium *medium, enum neph_gpu_data data)
{
    const struct neph_gpu_kind *kind = neph_gpu_get_kind(medium);
    return kind->data == data ? kind->data_count(medium) : 0;
}

/* The number of values in front of the grids. */
static size_t count_phase_values(const struct neph_medium *const *media, uint32_t medium_count)
{
    size_t count = 0;
    for (uint32_t m = 0; m < medium_count; m++)
        count += neph_gpu_phase_table_size(&media[m]->phase);
    return count;
}

static enum neph_status upload_phases(const struct neph_vulkan *vulkan,
                                      const struct neph_medium *const *media,
                                      const struct neph_gpu_scene *gpu, struct neph_diag *diag)
{
    const size_t count = count_phase_values(media, gpu->frame->medium_count);
    size_t at = 0;
    if (count == 0)
        return NEPH_OK;
    float *values = malloc(count * sizeof(*values));
    if (!values)
        return neph_fail_memory(diag);
    for (uint32_t m = 0; m < gpu->frame->medium_count; m++) {
        const size_t own = neph_gpu_phase_table_size(&media[m]->phase);
        if (own > 0)
            neph_gpu_phase_table_write(&media[m]->phase, values + at);
        at += own;
    }
    const enum neph_status status = neph_buffer_upload(
        vulkan, &gpu->buffers[NEPH_GPU_VALUES_BUFFER], 0, values, count * sizeof(*values), diag);
    free(values);
    return status;
}

/* The number of elements in front of those of media. */
static size_t count_first(const struct neph_gpu_scene *gpu, const struct neph_scene *scene,
                          const struct neph_medium *const *media, uint32_t medium_count,
                          enum neph_gpu_data data)
{
    return data == NEPH_GPU_VALUES   ? count_phase_values(media, medium_count)
           : data == NEPH_GPU_TEXELS ? neph_gpu_mesh_words(scene) + gpu->sun_grid_words
                                     : 0;
}

/* Upload the data of one kind of all media, in the order of fill_media(). */
static enum neph_status upload_data(const struct neph_vulkan *vulkan,
                                    const struct neph_scene *scene,
                                    const struct neph_medium *const *media, enum neph_gpu_data data,
                                    struct neph_gpu_scene *gpu, struct neph_diag *diag)
{
    const size_t element_bytes = data_buffers[data].element_bytes;
    struct neph_buffer *buffer = &gpu->buffers[data_buffers[data].binding];
    size_t first = count_first(gpu, scene, media, gpu->frame->medium_count, data), count = first;
    for (uint32_t m = 0; m < gpu->frame->medium_count; m++)
        count += data_count(media[m], data);
    if (count > UINT32_MAX / element_bytes)
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                         "the scene has %zu values for the buffer '%s'; a shader can address %zu",
                         count, data_buffers[data].name, UINT32_MAX / element_bytes);
    enum neph_status status = upload(vulkan, NULL, 0, element_bytes * (count > 0 ? count : 1),
                                     data_buffers[data].name, buffer, diag);
    for (uint32_t m = 0; m < gpu->frame->medium_count && !status; m++) {
        const size_t own = data_count(media[m], data);
        if (own > 0)
            status = neph_gpu_get_kind(media[m])->upload(vulkan, media[m], (uint32_t)first, buffer,
                                                         diag);
        first += own;
    }
    return status;
}

/* On a CPU: the values of grids in pairs, since reading a texel takes a third of the time of
 * reading a word (neph_buffer_create_texel_views()). Omitted if the pairs exceed the largest
 * buffer. */
static enum neph_status upload_pairs(const struct neph_vulkan *vulkan,
                                     const struct neph_medium *const *media,
                                     struct neph_gpu_scene *gpu, struct neph_diag *diag)
{
    const size_t pair_bytes = 2 * sizeof(float);
    const size_t most = vulkan->limits.maxStorageBufferRange / pair_bytes;
    const size_t phases = count_phase_values(media, gpu->frame->medium_count);
    size_t count = phases, first = phases;
    if (!gpu->is_on_cpu)
        return NEPH_OK;
    for (uint32_t m = 0; m < gpu->frame->medium_count; m++)
        count += data_count(media[m], NEPH_GPU_VALUES);
    gpu->has_pairs = count > phases && count <= most;
    enum neph_status status = upload(vulkan, NULL, 0, pair_bytes * (gpu->has_pairs ? count : 1),
                                     "scene grids in pairs", &gpu->pairs, diag);
    for (uint32_t m = 0; m < gpu->frame->medium_count && gpu->has_pairs && !status; m++) {
        const size_t own = data_count(media[m], NEPH_GPU_VALUES);
        if (own > 0)
            status = neph_gpu_get_kind(media[m])->upload_pairs(vulkan, media[m], (uint32_t)first,
                                                               &gpu->pairs, diag);
        first += own;
    }
    if (!status)
        status = neph_buffer_create_texel_views(vulkan, &gpu->pairs, diag);
    gpu->buffers[NEPH_GPU_VALUES_BUFFER].texels = gpu->pairs.texels;
    gpu->pairs.texels = (struct neph_texel_views){{VK_NULL_HANDLE}};
    return status;
}

/* Majorants of a medium; a single cell if its density moves within its bounds. */
static enum neph_status create_medium_majorants(const struct neph_medium *medium, bool flows,
                                                struct neph_majorants **majorants,
                                                struct neph_diag *diag)
{
    const struct neph_bounds box = neph_medium_support(medium);
    const int cell_count = flows ? 1 : neph_medium_facts(medium->kind)->majorant_cells;
    const enum neph_status status = neph_majorants_create(medium, &box, cell_count, majorants,
                                                          diag);
    if (status)
        return status;
    if (flows)
        (*majorants)->extinction_per_m[0] = nextafterf((float)neph_gpu_largest_per_m(medium),
                                                       INFINITY);
    else
        neph_majorants_cover_nodes(*majorants, medium); /* bounds of the values that
                                                           grid_random_node() returns */
    return NEPH_OK;
}

static enum neph_status append(float **values, size_t *count,
                               const struct neph_majorants *majorants, struct neph_diag *diag)
{
    const size_t cells = (size_t)majorants->size[0] * (size_t)majorants->size[1] *
                         (size_t)majorants->size[2];
    float *grown = realloc(*values, (*count + cells) * sizeof(*grown));
    if (!grown)
        return neph_fail_memory(diag);
    memcpy(grown + *count, majorants->extinction_per_m, cells * sizeof(*grown));
    *values = grown;
    *count += cells;
    return NEPH_OK;
}

/* Upload the majorant grids of all media to one buffer. */
static enum neph_status upload_majorants(const struct neph_vulkan *vulkan,
                                         const struct neph_scene *scene,
                                         const struct neph_medium *const *media,
                                         struct neph_gpu_scene *gpu, struct neph_diag *diag)
{
    float *values = NULL;
    size_t count = 0;
    enum neph_status status = NEPH_OK;
    for (uint32_t m = 0; m < gpu->frame->medium_count && !status; m++) {
        const bool flows = scene->wind_key_count > 0 && media[m]->kind == NEPH_MEDIUM_HORIZON;
        struct neph_majorants *majorants = NULL;
        if (neph_medium_is_fog(media[m]))
            continue;
        status = create_medium_majorants(media[m], flows, &majorants, diag);
        if (status)
            break;
        gpu->majorants[m].first = (uint32_t)count;
        for (int axis = 0; axis < 3; axis++)
            gpu->majorants[m].size[axis] = (uint32_t)majorants->size[axis];
        status = append(&values, &count, majorants, diag);
        neph_majorants_destroy(majorants);
    }
    if (!status)
        status = upload(vulkan, values, count, sizeof(float), "scene majorants", &gpu->buffers[3],
                        diag);
    free(values);
    return status;
}

/* --- the scene ---------------------------------------------------------------------------- */

/* Upper bound of the loop iterations of medium_optical_depth(), loop by loop of the shaders. */
static uint64_t count_depth_iterations(const struct neph_medium *medium)
{
    const struct neph_gpu_kind *kind = neph_gpu_get_kind(medium);
    return 16 + (kind->integral_turns ? kind->integral_turns(medium) : 0);
}

/* Append a medium to the frame. */
static struct neph_gpu_medium *add_medium(const struct neph_medium *medium,
                                          struct neph_vec3 camera_m, uint32_t first,
                                          struct neph_gpu_scene *gpu)
{
    struct neph_gpu_medium *made = &gpu->frame->media[gpu->frame->medium_count++];
    *made = pack_medium(medium, camera_m, first);
    gpu->frame->emits |= !is_black(made->glow);
    gpu->constants[0] |= 1u << medium->kind;
    if (neph_medium_is_coloured(medium) || neph_phase_is_coloured(&medium->phase))
        gpu->constants[1] |= NEPH_GPU_COLOURED;
    if (medium->kind == NEPH_MEDIUM_GRID && neph_grid_is_endless(medium->grid))
        gpu->constants[1] |= NEPH_GPU_ENDLESS;
    if (medium->kind == NEPH_MEDIUM_GRID && medium->grid->is_constant)
        gpu->constants[1] |= NEPH_GPU_CONSTANT_CELLS;
    gpu->optical_depth_iterations += 1 + count_depth_iterations(medium);
    return made;
}

/* Sets the table of a medium, if it has one, at index *next of the values. */
static void place_phase(const struct neph_medium *medium, uint32_t *next,
                        struct neph_gpu_scene *gpu, struct neph_gpu_medium *made)
{
    const size_t size = neph_gpu_phase_table_size(&medium->phase);
    if (size == 0)
        return;
    made->phase_kind = NEPH_PHASE_TABLE;
    made->g = (float)*next; /* exact: at most NEPH_GPU_MEDIA_MAX tables are in front of it */
    gpu->constants[1] |= NEPH_GPU_PHASE_TABLES;
    *next += (uint32_t)size;
}

static void set_scattering(const struct neph_scene *scene, bool scatters,
                           struct neph_gpu_frame *frame)
{
    scatters = scatters && scene->scattering != NEPH_SCATTERING_NONE;
    frame->scatters |= scatters && !is_black(frame->sun_irradiance);
    frame->scatters_lamps |= scatters && scene->light_count > 0;
}

/* Write the media of the frame; `media` receives the source of each. */
static void fill_media(const struct neph_scene *scene, struct neph_vec3 camera_m,
                       struct neph_gpu_scene *gpu,
                       const struct neph_medium *media[NEPH_SCENE_MEDIA_MAX])
{
    bool scatters = false;
    uint32_t firsts[NEPH_GPU_DATA_COUNT] = {0}, next_phase = 0;
    const uint32_t listed = neph_gpu_scene_list_media(scene, media);
    for (int data = 0; data < NEPH_GPU_DATA_COUNT; data++)
        firsts[data] = (uint32_t)count_first(gpu, scene, media, listed, data);
    gpu->optical_depth_iterations = 1;
    for (int i = 0; i < scene->medium_count; i++) {
        const struct neph_medium *medium = &scene->media[i];
        const enum neph_gpu_data data = neph_gpu_get_kind(medium)->data;
        if (!has_effect(medium))
            continue;
        struct neph_gpu_medium *made = add_medium(medium, camera_m, firsts[data], gpu);
        place_phase(medium, &next_phase, gpu, made);
        firsts[data] += data == NEPH_GPU_NO_DATA ? 0 : (uint32_t)data_count(medium, data);
        scatters = scatters || !is_black(made->albedo);
    }
    set_scattering(scene, scatters, gpu->frame);
}

_Static_assert((int)NEPH_MEDIUM_KIND_COUNT <= 8 && NEPH_FOG_LAYERS_MAX <= 2 &&
                   NEPH_GPU_KINDS_SHIFT + 4 * NEPH_GPU_KNOWN_MEDIA_MAX <= 32,
               "three bits for a kind, one for its layers");

/* The kinds and layers of up to NEPH_GPU_KNOWN_MEDIA_MAX media, for specialization constant 1. */
static uint32_t encode_known_media(const struct neph_gpu_frame *frame)
{
    uint32_t known = frame->medium_count << NEPH_GPU_MEDIA_SHIFT;
    if (frame->medium_count > NEPH_GPU_KNOWN_MEDIA_MAX)
        return 0;
    for (uint32_t m = 0; m < frame->medium_count; m++) {
        const uint32_t layers = frame->media[m].layer_count > 1 ? 8 : 0;
        known |= (frame->media[m].kind | layers) << (NEPH_GPU_KINDS_SHIFT + 4 * m);
    }
    return known;
}

uint32_t neph_gpu_solid_number(const struct neph_scene *scene, int solid, bool is_mesh)
{
    uint32_t number = 0;
    for (int i = 0; i < solid; i++)
        number += (scene->solids[i].kind == NEPH_SOLID_MESH) == is_mesh;
    return number;
}

/* Returns the number of nodes of solids that are apart. In memory of the host first: it reads them
 * again, and a mapped buffer may be slow to read. */
static uint32_t fill_solids(const struct neph_scene *scene, struct neph_vec3 camera_m,
                            struct neph_gpu_solids *mapped)
{
    struct neph_gpu_solids gpu;
    bool is_apart[NEPH_GPU_SOLIDS_MAX];
    size_t count = 0;
    const struct neph_bounds hull = neph_plain_hull(scene);
    for (int i = 0; i < scene->solid_count; i++)
        if (scene->solids[i].kind != NEPH_SOLID_MESH) {
            is_apart[count] = neph_is_apart(&scene->solids[i], &hull);
            gpu.solids[count++] = neph_gpu_solid_pack(&scene->solids[i], camera_m);
        }
    const uint32_t apart_nodes = neph_solid_tree_build(&gpu, (uint32_t)count, is_apart);
    memcpy(mapped->solids, gpu.solids, count * sizeof(gpu.solids[0]));
    memcpy(mapped->solid_order, gpu.solid_order, (count + 3) / 4 * sizeof(gpu.solid_order[0]));
    memcpy(mapped->solid_nodes, gpu.solid_nodes,
           neph_solid_tree_nodes(count) * sizeof(gpu.solid_nodes[0]));
    return apart_nodes;
}

/* Whether a gap is significant: float32 loses gaps below 1e-6 of the distance between face and
 * camera. */
static bool is_significant_gap(double depth_m, double face_m)
{
    return depth_m > 1e-6 * fabs(face_m);
}

/* Whether a solid is beyond a box as seen from the sun, along at least one axis. */
static bool is_beyond_box(const struct neph_bounds *solid, const struct neph_bounds *box,
                          struct neph_vec3 to_sun, struct neph_vec3 camera_m)
{
    const double low_m[3] = {solid->min_m.x, solid->min_m.y, solid->min_m.z};
    const double high_m[3] = {solid->max_m.x, solid->max_m.y, solid->max_m.z};
    const double box_low_m[3] = {box->min_m.x, box->min_m.y, box->min_m.z};
    const double box_high_m[3] = {box->max_m.x, box->max_m.y, box->max_m.z};
    const double sun[3] = {to_sun.x, to_sun.y, to_sun.z};
    const double eye_m[3] = {camera_m.x, camera_m.y, camera_m.z};
    for (int axis = 0; axis < 3; axis++)
        if ((sun[axis] >= 0.0 &&
             is_significant_gap(box_low_m[axis] - high_m[axis], high_m[axis] - eye_m[axis])) ||
            (sun[axis] <= 0.0 &&
             is_significant_gap(low_m[axis] - box_high_m[axis], low_m[axis] - eye_m[axis])))
            return true;
    return false;
}

/* Whether any solid can cast a shadow on any medium. */
static bool solids_shade(const struct neph_scene *scene, struct neph_vec3 camera_m)
{
    struct neph_bounds box = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    for (int i = 0; i < scene->medium_count; i++)
        if (has_effect(&scene->media[i]))
            box = neph_bounds_hull(box, neph_medium_support(&scene->media[i]));
    for (int i = 0; i < scene->solid_count; i++) {
        const struct neph_bounds solid = neph_solid_bounds(&scene->solids[i]);
        if (!is_beyond_box(&solid, &box, scene->sun.direction, camera_m))
            return true;
    }
    return false;
}

static void place_majorants(struct neph_gpu_scene *gpu)
{
    for (uint32_t m = 0; m < gpu->frame->medium_count; m++) {
        gpu->frame->media[m].majorant_first = gpu->majorants[m].first;
        memcpy(gpu->frame->media[m].majorant_size, gpu->majorants[m].size,
               sizeof(gpu->majorants[m].size));
    }
}

static void set_pairs(struct neph_gpu_scene *gpu)
{
    if (gpu->has_pairs)
        gpu->constants[1] |= NEPH_GPU_PAIRS;
}

/* Fill the frame's buffers; `media` receives the source of each medium. */
static void fill_scene_frame(struct neph_gpu_scene *gpu, const struct neph_scene *scene,
                             double frame, int width_px, int height_px,
                             const struct neph_medium *media[NEPH_SCENE_MEDIA_MAX])
{
    const struct neph_camera camera = neph_scene_camera(scene, frame);
    *gpu->frame = pack_frame(scene, &camera, width_px, height_px);
    gpu->constants[0] = 0;
    gpu->constants[1] = camera.orthographic_height_m > 0.0 ? NEPH_GPU_ORTHOGRAPHIC : 0u;
    gpu->constants[1] |= scene->light_count > 0 ? NEPH_GPU_LAMPS : 0u;
    fill_lights(scene, camera.position_m, gpu->frame);
    fill_media(scene, camera.position_m, gpu, media);
    gpu->constants[1] |= encode_known_media(gpu->frame) | (gpu->is_on_cpu ? NEPH_GPU_ON_CPU : 0u);
    for (int i = 0; i < scene->solid_count; i++)
        if (scene->solids[i].kind != NEPH_SOLID_MESH && neph_is_turned(&scene->solids[i].turn))
            gpu->constants[1] |= NEPH_GPU_TURNED;
    for (int i = 0; i < scene->medium_count; i++)
        gpu->constants[1] |= neph_is_turned(&scene->media[i].turn) ? NEPH_GPU_TURNED_MEDIA : 0u;
    const uint32_t apart_nodes = fill_solids(scene, camera.position_m, gpu->buffers[1].mapped);
    if (neph_sun_grid_fits(&gpu->sun_grid, scene)) {
        gpu->constants[0] |= NEPH_GPU_SUN_GRID;
        gpu->frame->sun_grid = neph_sun_grid_place(&gpu->sun_grid, camera.position_m,
                                                   (uint32_t)neph_gpu_mesh_words(scene));
        gpu->frame->sun_grid.apart_nodes = apart_nodes;
    }
    gpu->solid_iterations = neph_gpu_solid_iterations(scene);
    gpu->frame->meshes = neph_gpu_meshes_place(scene, camera.position_m);
    gpu->frame->meshes.frame_number = (uint32_t)llround(frame);
    gpu->constants[0] |= neph_gpu_count_instances(scene) > 0 ? NEPH_GPU_MESHES : 0u;
    gpu->constants[0] |= neph_gpu_meshes_move(scene) ? NEPH_GPU_MESHES_MOVE : 0u;
    gpu->constants[0] |= neph_gpu_mesh_look_bits(scene);
    gpu->frame->solids_shade = solids_shade(scene, camera.position_m);
    if (gpu->frame->solids_shade || !gpu->is_on_cpu)
        gpu->constants[1] |= NEPH_GPU_SHADED;
    set_pairs(gpu);
    place_majorants(gpu);
}

/* Build the grid before the frame is filled, and upload it behind the meshes. */
static enum neph_status create_sun_grid(const struct neph_scene *scene, struct neph_gpu_scene *gpu,
                                        struct neph_diag *diag)
{
    gpu->sun_grid_words = neph_sun_grid_words(scene);
    return gpu->sun_grid_words > 0 ? neph_sun_grid_create(scene, &gpu->sun_grid, diag) : NEPH_OK;
}

static enum neph_status upload_sun_grid(const struct neph_vulkan *vulkan,
                                        const struct neph_scene *scene, struct neph_gpu_scene *gpu,
                                        struct neph_diag *diag)
{
    const enum neph_status status =
        gpu->sun_grid.width > 0
            ? neph_sun_grid_upload(&gpu->sun_grid, vulkan, &gpu->buffers[NEPH_GPU_TEXELS_BUFFER],
                                   neph_gpu_mesh_words(scene), diag)
            : NEPH_OK;
    neph_sun_grid_free_cells(&gpu->sun_grid);
    return status;
}

static enum neph_status upload_meshes(const struct neph_vulkan *vulkan,
                                      const struct neph_scene *scene, double frame,
                                      struct neph_gpu_scene *gpu, struct neph_diag *diag)
{
    enum neph_status status = neph_gpu_meshes_upload(vulkan, scene,
                                                     neph_scene_camera(scene, frame).position_m,
                                                     &gpu->buffers[NEPH_GPU_TEXELS_BUFFER], diag);
    if (!status)
        status = neph_mesh_motion_create(scene, &gpu->mesh_motion, diag);
    return status || !gpu->is_on_cpu || neph_gpu_count_instances(scene) == 0
               ? status
               : neph_buffer_create(vulkan, NEPH_BUFFER_READBACK, sizeof(uint32_t),
                                    "fault of meshes", &gpu->mesh_readback, diag);
}

enum neph_status neph_gpu_scene_check(const struct neph_vulkan *vulkan,
                                      const struct neph_gpu_scene *gpu, struct neph_diag *diag)
{
    return gpu->mesh_readback.mapped
               ? neph_gpu_meshes_check(vulkan, &gpu->buffers[NEPH_GPU_TEXELS_BUFFER],
                                       &gpu->mesh_readback, diag)
               : NEPH_OK;
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
        status = create_solids(vulkan, gpu, diag);
    if (!status)
        status = create_sun_grid(scene, gpu, diag);
    if (status)
        return status;
    gpu->frame = gpu->buffers[0].mapped;
    gpu->is_on_cpu = vulkan->description.is_cpu;
    fill_scene_frame(gpu, scene, frame, width_px, height_px, media);
    status = upload_data(vulkan, scene, media, NEPH_GPU_VALUES, gpu, diag);
    if (!status)
        status = upload_phases(vulkan, media, gpu, diag);
    if (!status)
        status = upload_pairs(vulkan, media, gpu, diag);
    set_pairs(gpu);
    if (!status && with_majorants)
        status = upload_majorants(vulkan, scene, media, gpu, diag);
    else if (!status)
        status = upload(vulkan, NULL, 0, sizeof(float), "scene majorants", &gpu->buffers[3], diag);
    place_majorants(gpu);
    if (!status)
        status = upload_data(vulkan, scene, media, NEPH_GPU_TEXELS, gpu, diag);
    if (!status)
        status = upload_meshes(vulkan, scene, frame, gpu, diag);
    if (!status)
        status = upload_sun_grid(vulkan, scene, gpu, diag);
    return status;
}

enum neph_status neph_gpu_scene_update(const struct neph_vulkan *vulkan, struct neph_gpu_scene *gpu,
                                       const struct neph_scene *scene, double frame, int width_px,
                                       int height_px, double *gpu_s, struct neph_diag *diag)
{
    const struct neph_medium *media[NEPH_SCENE_MEDIA_MAX];
    fill_scene_frame(gpu, scene, frame, width_px, height_px, media);
    return neph_mesh_motion_update(vulkan, scene, neph_scene_camera(scene, frame).position_m,
                                   &gpu->buffers[NEPH_GPU_TEXELS_BUFFER], &gpu->mesh_motion, gpu_s,
                                   diag);
}

void neph_gpu_scene_add_fog(struct neph_gpu_scene *gpu, const struct neph_scene *scene,
                            const struct neph_medium *fog, double frame)
{
    const struct neph_vec3 camera_m = neph_scene_camera(scene, frame).position_m;
    const uint32_t known = ~0u << NEPH_GPU_MEDIA_SHIFT &
                           ~(NEPH_GPU_PHASE_TABLES | NEPH_GPU_CONSTANT_CELLS | NEPH_GPU_OWN_RAYS |
                             NEPH_GPU_TURNED_MEDIA);
    if (!has_effect(fog))
        return;
    const struct neph_gpu_medium *made = add_medium(fog, camera_m, 0, gpu);
    set_scattering(scene, !is_black(made->albedo), gpu->frame);
    gpu->constants[1] = (gpu->constants[1] & ~known) | encode_known_media(gpu->frame);
    gpu->frame->solids_shade = scene->solid_count > 0; /* the fog is unbounded, so any solid shades
                                                          it */
    gpu->constants[1] |= scene->solid_count > 0 ? NEPH_GPU_SHADED : 0u;
}

void neph_gpu_scene_destroy(const struct neph_vulkan *vulkan, struct neph_gpu_scene *gpu)
{
    for (int m = 0; m < NEPH_GPU_MEDIA_MAX; m++)
        neph_texture_destroy(vulkan, &gpu->textures[m]);
    neph_texture_destroy(vulkan, &gpu->no_texture);
    for (int i = 0; i < NEPH_GPU_SCENE_BUFFERS; i++)
        neph_buffer_destroy(vulkan, &gpu->buffers[i]);
    neph_buffer_destroy(vulkan, &gpu->pairs);
    neph_buffer_destroy(vulkan, &gpu->mesh_readback);
    neph_mesh_motion_destroy(vulkan, &gpu->mesh_motion);
    neph_sun_grid_destroy(&gpu->sun_grid);
    gpu->frame = NULL;
}

void neph_gpu_scene_bind(const struct neph_gpu_scene *gpu, struct neph_dispatch *dispatch)
{
    for (int i = 0; i < NEPH_GPU_SCENE_BUFFERS; i++)
        dispatch->buffers[i] = &gpu->buffers[i];
    for (int m = 0; m < NEPH_GPU_MEDIA_MAX; m++)
        dispatch->images[m] = gpu->textures[m].view ? &gpu->textures[m] : &gpu->no_texture;
}
