/* SPDX-License-Identifier: MIT
 *
 * Engine `sky`: a planet's atmosphere from tables, as real-time renderers do it; on the CPU in
 * double precision, or on a Vulkan device in float32.
 */
#include "harness/engines/engines.h"

#include "harness/engines/cpu_frame.h"
#include "harness/engines/frame_stats.h"
#include "harness/engines/gpu_frames.h"
#include "harness/engines/vulkan_device.h"
#include "renderer/shortcuts.h"
#include "renderer/sky/device.h"

#include <math.h>
#include <stdio.h>

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
    [OPTION_REFILL] = {"refill", NEPH_OPTION_CHOICE, 0, 0, 0, neph_sky_refills,
                       "with on=device, tables that are filled for each frame of a sequence: only "
                       "stale ones, or, to measure their cost, also the view table, or all"},
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

/* ---- one frame ------------------------------------------------------------------------------- */

static struct neph_rgb rgb(const double value[3])
{
    return (struct neph_rgb){value[0], value[1], value[2]};
}

static struct neph_ray_light see_ray(const void *sky, struct neph_vec3 origin_m,
                                     struct neph_vec3 direction)
{
    const struct neph_sky_light light = neph_sky_see(sky, origin_m, direction);
    return (struct neph_ray_light){.radiance = rgb(light.radiance),
                                   .volume = rgb(light.volume),
                                   .transmittance = rgb(light.transmittance),
                                   .hit_m = light.length_m};
}

static enum neph_status render_on_cpu(const struct neph_shot *shot, struct neph_image **image,
                                      struct neph_diag *diag)
{
    const struct neph_sky_params params = params_of(&shot->settings);
    const struct neph_camera camera = neph_scene_camera(shot->scene, shot->frame);
    struct neph_sky *sky = NULL;
    double error;
    enum neph_status status = neph_sky_create(shot->scene, &params, &sky, diag);
    if (!status)
        status = neph_sky_stand(sky, camera.position_m, diag);
    if (!status)
        status = neph_cpu_frame(shot, see_ray, sky, image, &error, diag);
    neph_sky_destroy(sky);
    return status;
}

/* ---- sequences ------------------------------------------------------------------------------- */

static bool is_on_device(const struct neph_shot *shot)
{
    return shot->settings.values[OPTION_ON] != 0.0;
}

static enum neph_status create(struct neph_vulkan *vulkan, const struct neph_engine *engine,
                               const struct neph_shot *shot, void **renderer,
                               struct neph_diag *diag)
{
    (void)engine;
    if (!vulkan)
        return NEPH_OK;
    const struct neph_sky_params params = params_of(&shot->settings);
    struct neph_sky_pictures *pictures = NULL;
    const enum neph_status status = neph_sky_pictures_create(
        vulkan, shot->scene, &params, shot->width_px, shot->height_px, &pictures, diag);
    *renderer = pictures;
    return status;
}

static void destroy(void *renderer)
{
    neph_sky_pictures_destroy(renderer);
}

static enum neph_status frame(void *renderer, const struct neph_shot *shot,
                              struct neph_image **image, double *gpu_s, struct neph_diag *diag)
{
    struct neph_sky_stats sky;
    if (!renderer)
        return render_on_cpu(shot, image, diag);
    const enum neph_status status = neph_sky_pictures_frame(renderer, shot->scene, shot->frame,
                                                            image, &sky, diag);
    if (status)
        return status;
    const struct neph_frame_stat stats[] = {
        {"sky_tables_ms", 1e3 * sky.tables.air_s},
        {"sky_view_ms", 1e3 * sky.tables.view_s},
        {"sky_picture_ms", 1e3 * sky.picture_s},
    };
    *gpu_s = neph_sky_gpu_s(&sky.tables) + sky.picture_s;
    return neph_frame_stats_set_all(*image, stats, sizeof(stats) / sizeof(stats[0]), diag);
}

static enum neph_status submit(void *renderer, const struct neph_shot *shot,
                               struct neph_flight_cost *cost, struct neph_diag *diag)
{
    (void)cost;
    return renderer ? neph_sky_pictures_frame(renderer, shot->scene, shot->frame, NULL, NULL, diag)
                    : neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                                "a sky on the CPU is never in flight: set on=device");
}

static enum neph_status collect(void *renderer, struct neph_flight_cost *cost,
                                struct neph_diag *diag)
{
    struct neph_sky_stats stats;
    const enum neph_status status = neph_sky_pictures_home(renderer, &stats, diag);
    if (status)
        return status;
    cost->gpu_s = neph_sky_gpu_s(&stats.tables) + stats.picture_s;
    neph_flight_cost_add(cost, "sky picture", stats.picture_s, NAN);
    neph_flight_cost_add_sky(cost, &stats.tables);
    return NEPH_OK;
}

static const struct neph_gpu_renderer gpu = {.create = create,
                                             .destroy = destroy,
                                             .frame = frame,
                                             .submit = submit,
                                             .collect = collect,
                                             .needs_device = is_on_device};

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

/* Report the device, if there is one: its frames are different from the CPU's. */
static void probe(const struct neph_engine *engine, struct neph_shared_device *device,
                  struct neph_engine_info *info)
{
    struct neph_engine_info vulkan;
    neph_vulkan_probe(engine, device, &vulkan);
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
    .sequence = &neph_gpu_sequence,
    .gpu = &gpu,
};
