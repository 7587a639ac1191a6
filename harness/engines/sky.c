/* SPDX-License-Identifier: MIT
 *
 * Engine `sky`: an atmosphere around a ball from tables, as real-time renderers have it; on the
 * CPU in double precision, or on a Vulkan device in float32.
 */
#include "harness/engines/engines.h"

#include "base/clock.h"
#include "base/threads.h"
#include "harness/engines/frame_stats.h"
#include "harness/engines/own_cost.h"
#include "harness/engines/sky_passes.h"
#include "harness/engines/vulkan_device.h"
#include "renderer/shortcuts.h"
#include "renderer/sky/device.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum {
    OPTION_ON,
    OPTION_MULTIPLE,
    OPTION_STEPS,
    OPTION_VIEW,
    OPTION_VIEW_ELEVATIONS,
    OPTION_VIEW_AZIMUTHS,
    OPTION_DEGREE,
    OPTION_ORDERS,
    OPTION_ALTITUDES,
    OPTION_SUNS,
    OPTION_ABOVE,
    OPTION_BELOW,
    OPTION_AROUND,
    OPTION_TABLE_STEPS,
    OPTION_SUN_ALTITUDES,
    OPTION_SUN_COSINES,
    OPTION_REFILL,
};

static const char *const views[] = {"walk", "table", NULL};
static const char *const machines[] = {"cpu", "device", NULL};
static const char *const closures[] = {"orders", "closure", NULL};

static const struct neph_option options[] = {
    [OPTION_ON] =
        {"on", NEPH_OPTION_CHOICE, 0, 0, 0, machines,
         "in double precision on the CPU, or in float32 on the device of the other Vulkan "
         "engines"},
    [OPTION_MULTIPLE] = {"multiple", NEPH_OPTION_CHOICE, 0, 0, 0, closures,
                         "light scattered more than once: order by order as moments over "
                         "directions, or Hillaire's closure, two orders and a geometric series, "
                         "all isotropic"},
    [OPTION_STEPS] = {"steps", NEPH_OPTION_INTEGER, 48, 2, 4096, NULL, "along a view ray"},
    [OPTION_VIEW] = {"view", NEPH_OPTION_CHOICE, 0, 0, 0, views,
                     "each view ray is walked, or looked up in a table of all views from the "
                     "camera"},
    [OPTION_VIEW_ELEVATIONS] = {"view_elevations", NEPH_OPTION_INTEGER, 48, 2, 1024, NULL,
                                "nodes of that table above the horizon, and as many below it"},
    [OPTION_VIEW_AZIMUTHS] = {"view_azimuths", NEPH_OPTION_INTEGER, 48, 2, 1024, NULL,
                              "and from the sun over half a turn"},
    [OPTION_DEGREE] = {"degree", NEPH_OPTION_INTEGER, 2, 0, NEPH_SKY_DEGREE_MAX, NULL,
                       "of the moments, with multiple=orders: air needs 2, haze more"},
    [OPTION_ORDERS] = {"orders", NEPH_OPTION_INTEGER, 8, 1, 64, NULL,
                       "of scattering and reflection, with multiple=orders"},
    [OPTION_ALTITUDES] = {"altitudes", NEPH_OPTION_INTEGER, 24, 2, 256, NULL,
                          "nodes of the table of moments"},
    [OPTION_SUNS] = {"suns", NEPH_OPTION_INTEGER, 64, 2, 512, NULL,
                     "nodes of that table: elevations of the sun"},
    [OPTION_ABOVE] = {"above", NEPH_OPTION_INTEGER, 8, 1, NEPH_SKY_DIRECTIONS_MAX, NULL,
                      "cosines above a node's horizon that light is gathered from"},
    [OPTION_BELOW] = {"below", NEPH_OPTION_INTEGER, 4, 1, NEPH_SKY_DIRECTIONS_MAX, NULL,
                      "and below it"},
    [OPTION_AROUND] = {"around", NEPH_OPTION_INTEGER, 6, 1, NEPH_SKY_DIRECTIONS_MAX, NULL,
                       "azimuths of each, over half a turn"},
    [OPTION_TABLE_STEPS] = {"table_steps", NEPH_OPTION_INTEGER, 16, 2, 4096, NULL,
                            "along the rays of the table"},
    [OPTION_SUN_ALTITUDES] = {"sun_altitudes", NEPH_OPTION_INTEGER, 64, 2, 1024, NULL,
                              "nodes of the table of transmittance to the sun"},
    [OPTION_SUN_COSINES] = {"sun_cosines", NEPH_OPTION_INTEGER, 256, 2, 4096, NULL,
                            "nodes of that table: cosines of the sun"},
    [OPTION_REFILL] =
        {"refill", NEPH_OPTION_CHOICE, 0, 0, 0, neph_sky_refills,
         "with on=device, what is filled for each picture of many: what is stale, or, "
         "to measure it, also the table of views, or all tables"},
    {.name = NULL},
};

static struct neph_sky_params params_of(const struct neph_settings *settings)
{
    const double *v = settings->values;
    return (struct neph_sky_params){
        .steps = (int)v[OPTION_STEPS],
        .sun_altitudes = (int)v[OPTION_SUN_ALTITUDES],
        .sun_cosines = (int)v[OPTION_SUN_COSINES],
        .view = {v[OPTION_VIEW] != 0.0, (int)v[OPTION_VIEW_ELEVATIONS],
                 (int)v[OPTION_VIEW_AZIMUTHS]},
        .field = {.altitudes = (int)v[OPTION_ALTITUDES],
                  .suns = (int)v[OPTION_SUNS],
                  .degree = (int)v[OPTION_DEGREE],
                  .orders = (int)v[OPTION_ORDERS],
                  .closure = v[OPTION_MULTIPLE] != 0.0,
                  .above = (int)v[OPTION_ABOVE],
                  .below = (int)v[OPTION_BELOW],
                  .around = (int)v[OPTION_AROUND],
                  .steps = (int)v[OPTION_TABLE_STEPS]},
        .refill = (enum neph_sky_refill)(int)v[OPTION_REFILL],
    };
}

/* ---- a picture ------------------------------------------------------------------------------- */

struct job {
    const struct neph_shot *shot;
    const struct neph_sky *sky;
    struct neph_camera camera;
    float *radiance[3], *volume[3], *transmittance[3], *depth;
};

static void store(float *layer[3], size_t pixel, const double value[3])
{
    for (int c = 0; c < 3 && layer[0]; c++)
        layer[c][pixel] = (float)value[c];
}

static void render_row(int row, void *context)
{
    const struct job *job = context;
    const struct neph_shot *shot = job->shot;
    for (int column = 0; column < shot->width_px; column++) {
        const struct neph_pixel_ray ray = neph_camera_ray(&job->camera, shot->width_px,
                                                          shot->height_px, column, row);
        const struct neph_sky_light light = neph_sky_see(job->sky, ray.origin_m, ray.direction);
        const size_t pixel = (size_t)row * (size_t)shot->width_px + (size_t)column;
        store((float **)job->radiance, pixel, light.radiance);
        store((float **)job->volume, pixel, light.volume);
        store((float **)job->transmittance, pixel, light.transmittance);
        if (job->depth)
            job->depth[pixel] = (float)(light.length_m *
                                        neph_vec3_dot(ray.direction, job->camera.forward));
    }
}

static enum neph_status add_layers(struct neph_image *frame, struct job *job,
                                   struct neph_diag *diag)
{
    const unsigned layers = job->shot->layers;
    enum neph_status status = NEPH_OK;
    if (layers & NEPH_LAYER_RADIANCE) {
        status = neph_image_add_rgb(frame, NULL, job->radiance, diag);
        if (!status)
            status = neph_image_add_rgb(frame, "volume", job->volume, diag);
    }
    if (!status && (layers & NEPH_LAYER_TRANSMITTANCE))
        status = neph_image_add_rgb(frame, "transmittance", job->transmittance, diag);
    if (!status && (layers & NEPH_LAYER_DEPTH))
        status = neph_image_add_channel(frame, "Z", &job->depth, diag);
    return status;
}

static enum neph_status render_on_cpu(const struct neph_shot *shot,
                                      const struct neph_sky_params *params,
                                      struct neph_image **frame, struct neph_diag *diag)
{
    struct neph_sky *sky = NULL;
    struct neph_image *image = NULL;
    enum neph_status status = neph_sky_create(shot->scene, params, &sky, diag);
    if (!status)
        status = neph_image_create(shot->width_px, shot->height_px, &image, diag);
    struct job job = {
        .shot = shot, .sky = sky, .camera = neph_scene_camera(shot->scene, shot->frame)};
    if (!status)
        status = neph_sky_stand(sky, job.camera.position_m, diag);
    if (!status)
        status = add_layers(image, &job, diag);
    if (!status)
        status = neph_parallel_rows(shot->height_px, render_row, &job, diag);
    neph_sky_destroy(sky);
    if (status)
        neph_image_destroy(image);
    else
        *frame = image;
    return status;
}

static enum neph_status label(struct neph_image *frame, const struct neph_sky_stats *stats,
                              struct neph_diag *diag)
{
    const struct {
        const char *name;
        double seconds;
    } rows[] = {{"sky_tables_ms", stats->tables.air_s},
                {"sky_view_ms", stats->tables.view_s},
                {"sky_picture_ms", stats->picture_s}};
    enum neph_status status = NEPH_OK;
    for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]) && !status; i++)
        status = neph_frame_stats_set(frame, rows[i].name, 1e3 * rows[i].seconds, diag);
    return status;
}

/* ---- pictures in a row ----------------------------------------------------------------------- */

struct sequence {
    struct neph_open_device *device;    /* NULL: on the CPU */
    struct neph_sky_pictures *pictures; /* of this size */
    int width_px, height_px;
    int sent, home; /* pictures that went on their way, and those no longer on it */
    double sent_s[NEPH_FLIGHT_PICTURES_MAX]; /* the CPU's part of each, by number */
};

static void close_sequence(void *opened)
{
    struct sequence *sequence = opened;
    if (!sequence)
        return;
    neph_sky_pictures_destroy(sequence->pictures);
    neph_device_release(sequence->device);
    free(sequence);
}

static bool is_on_device(const struct neph_shot *shot)
{
    return shot->settings.values[OPTION_ON] != 0.0;
}

static enum neph_status set_up(struct sequence *sequence, const struct neph_shot *shot,
                               struct neph_diag *diag)
{
    const struct neph_sky_params params = params_of(&shot->settings);
    neph_sky_pictures_destroy(sequence->pictures);
    sequence->pictures = NULL;
    sequence->width_px = shot->width_px;
    sequence->height_px = shot->height_px;
    return neph_sky_pictures_create(sequence->device->vulkan, shot->scene, &params, shot->width_px,
                                    shot->height_px, &sequence->pictures, diag);
}

static enum neph_status open_sequence(const struct neph_shot *shot, void **opened,
                                      struct neph_diag *diag)
{
    struct sequence *sequence = calloc(1, sizeof(*sequence));
    if (!sequence)
        return neph_fail_memory(diag);
    enum neph_status status = NEPH_OK;
    if (is_on_device(shot))
        status = neph_device_acquire(shot->device, &sequence->device, diag);
    if (!status && sequence->device)
        status = set_up(sequence, shot, diag);
    if (status)
        close_sequence(sequence);
    else
        *opened = sequence;
    return status;
}

static enum neph_status picture_on_device(struct sequence *sequence, const struct neph_shot *shot,
                                          struct neph_image **frame, double *gpu_s,
                                          struct neph_diag *diag)
{
    struct neph_image *image = NULL;
    struct neph_sky_stats stats;
    sequence->home = sequence->sent; /* those in flight are forgotten */
    const bool fits = shot->width_px == sequence->width_px &&
                      shot->height_px == sequence->height_px && sequence->pictures;
    enum neph_status status = fits ? NEPH_OK : set_up(sequence, shot, diag);
    if (!status)
        status = neph_sky_pictures_frame(sequence->pictures, shot->scene, shot->frame, &image,
                                         &stats, diag);
    if (!status)
        status = label(image, &stats, diag);
    if (status) {
        neph_image_destroy(image);
        return status;
    }
    *gpu_s = neph_sky_gpu_s(&stats.tables) + stats.picture_s;
    *frame = image;
    return NEPH_OK;
}

static enum neph_status next_picture(void *opened, const struct neph_shot *shot,
                                     struct neph_image **frame, struct neph_cost *cost,
                                     struct neph_diag *diag)
{
    struct sequence *sequence = opened;
    const struct neph_stopwatch start = neph_stopwatch_start();
    const struct neph_sky_params params = params_of(&shot->settings);
    double gpu_s = NAN;
    const enum neph_status status = sequence->device
                                        ? picture_on_device(sequence, shot, frame, &gpu_s, diag)
                                        : render_on_cpu(shot, &params, frame, diag);
    if (!status)
        *cost = neph_own_cost(start, gpu_s);
    return status;
}

static enum neph_status send(void *opened, const struct neph_shot *shot, struct neph_diag *diag)
{
    struct sequence *sequence = opened;
    if (!sequence->device)
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                         "a sky on the CPU is never in flight: set on=device");
    const double start_s = neph_wall_s();
    const enum neph_status status = neph_sky_pictures_frame(sequence->pictures, shot->scene,
                                                            shot->frame, NULL, NULL, diag);
    if (!status)
        sequence->sent_s[sequence->sent++ % NEPH_FLIGHT_PICTURES_MAX] = neph_wall_s() - start_s;
    return status;
}

static enum neph_status home(void *opened, struct neph_flight_cost *cost, struct neph_diag *diag)
{
    struct sequence *sequence = opened;
    struct neph_sky_stats stats;
    const enum neph_status status = neph_sky_pictures_home(sequence->pictures, &stats, diag);
    if (status)
        return status;
    *cost = (struct neph_flight_cost){
        .gpu_s = neph_sky_gpu_s(&stats.tables) + stats.picture_s,
        .cpu_s = sequence->sent_s[sequence->home++ % NEPH_FLIGHT_PICTURES_MAX],
        .pass_count = 1,
        .passes = {{.name = "sky picture", .gpu_s = stats.picture_s, .traffic_bytes = NAN}},
    };
    neph_sky_passes_add(&stats.tables, cost);
    return NEPH_OK;
}

/* A picture alone pays for what it is set up with. */
static enum neph_status render(const struct neph_shot *shot, struct neph_image **frame,
                               struct neph_cost *cost, struct neph_diag *diag)
{
    const struct neph_stopwatch start = neph_stopwatch_start();
    void *sequence = NULL;
    enum neph_status status = open_sequence(shot, &sequence, diag);
    if (!status)
        status = next_picture(sequence, shot, frame, cost, diag);
    close_sequence(sequence);
    if (!status)
        *cost = neph_own_cost(start, is_on_device(shot) ? cost->render_s : NAN);
    return status;
}

static const struct neph_engine_sequence sequence_of_sky = {.open = open_sequence,
                                                            .next = next_picture,
                                                            .send = send,
                                                            .home = home,
                                                            .close = close_sequence};

/* ---- the table ------------------------------------------------------------------------------- */

static bool can_render(const struct neph_scene *scene, const struct neph_settings *settings,
                       char *reason, size_t reason_size)
{
    struct neph_sky_air air;
    if (!settings || settings->values[OPTION_ON] == 0.0)
        return neph_sky_air_of(scene, &air, reason, reason_size);
    const struct neph_sky_params params = params_of(settings);
    return neph_sky_device_can(scene, &params, reason, reason_size);
}

/* The device counts, where there is one: its frames are its own. */
static void probe(struct neph_shared_device *device, struct neph_engine_info *info)
{
    struct neph_engine_info vulkan;
    neph_vulkan_probe(device, &vulkan);
    *info = (struct neph_engine_info){.available = true};
    snprintf(info->version, sizeof(info->version), "sky tables, revision %u",
             (unsigned)neph_engine_sky.version);
    if (vulkan.available)
        snprintf(info->device, sizeof(info->device), "CPU; %.*s", 120, vulkan.device);
    else
        snprintf(info->device, sizeof(info->device), "CPU");
}

const struct neph_engine neph_engine_sky = {
    .name = "sky",
    .summary = "an atmosphere around a ball: light of the sun, and of all orders from small tables",
    .rung = NEPH_RUNG_MODEL,
    .bias = "solids throw no shadow into the air, and hide the sky from nothing",
    .is_narrow = true,
    .typical_s = 2.0,
    .options = options,
    .version = 1,
    .probe = probe,
    .can_render = can_render,
    .render = render,
    .sequence = &sequence_of_sky,
};
