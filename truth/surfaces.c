/* SPDX-License-Identifier: MIT */
#include "truth/surfaces.h"

#include "base/threads.h"

#include <stdio.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_REFLECTED_PARTS == 8, "a new kind");
_Static_assert(NEPH_SCATTERING_COUNT == 3, "a new kind");

static const int samples_max = 1 << 30;

/* In the order of enum neph_reflected_part. */
static const char *const part_names[NEPH_REFLECTED_PARTS] = {
    "diffuse_direct",    "diffuse_indirect", "glossy_direct", "glossy_indirect", "ao",
    "diffuse_on_screen", "glossy_on_screen", "ao_on_screen"};
static const char *const color_names[2] = {"diffuse_color", "glossy_color"};
static const char *const normal_names[3] = {"normal.x", "normal.y", "normal.z"};

/* Sums for means and their variances: of the parts, then of the total. */
enum { ALL = NEPH_REFLECTED_PARTS, SUM_COUNT };

struct sums {
    double sum[SUM_COUNT][3], squares[SUM_COUNT][3];
};

struct layers {
    float *mean[SUM_COUNT][3], *variance[SUM_COUNT][3];
    float *color[2][3], *transmittance[3], *volume[3], *normal[3], *depth;
};

struct render {
    const struct neph_scene *scene;
    const struct neph_surfaces_params *params;
    struct neph_reflected_limits limits;
    struct neph_screen screen;
    struct layers layers;
};

/* ---- a pixel --------------------------------------------------------------------------------- */

static void put(float *const layer[3], size_t pixel, struct neph_rgb value)
{
    layer[0][pixel] = (float)value.r;
    layer[1][pixel] = (float)value.g;
    layer[2][pixel] = (float)value.b;
}

static void add(struct sums *sums, int which, struct neph_rgb rgb)
{
    const double value[3] = {rgb.r, rgb.g, rgb.b};
    for (int j = 0; j < 3; j++) {
        sums->sum[which][j] += value[j];
        sums->squares[which][j] += value[j] * value[j];
    }
}

static struct sums sample_pixel(const struct render *render, const struct neph_reflected_view *view,
                                size_t pixel)
{
    struct sums sums = {{{0}}, {{0}}};
    for (int sample = 0; sample < render->params->samples; sample++) {
        struct neph_random random = neph_random_stream(render->params->seed, pixel,
                                                       (uint64_t)sample);
        const struct neph_reflected light = neph_reflected_sample(render->scene, view,
                                                                  &render->limits, &random);
        for (int part = 0; part < NEPH_REFLECTED_PARTS; part++)
            add(&sums, part, light.part[part]);
        add(&sums, ALL, neph_reflected_radiance(view, &light));
    }
    return sums;
}

static void put_sums(const struct render *render, const struct sums *sums, size_t pixel)
{
    const double n = render->params->samples;
    for (int which = 0; which < SUM_COUNT; which++)
        for (int j = 0; j < 3; j++) {
            const double mean = sums->sum[which][j] / n;
            const double spread = sums->squares[which][j] / n - mean * mean;
            render->layers.mean[which][j][pixel] = (float)mean;
            render->layers.variance[which][j][pixel] = (float)(fmax(0.0, spread) / (n - 1.0));
        }
}

static void put_sky(const struct render *render, size_t pixel)
{
    const struct neph_rgb open = {1, 1, 1};
    put(render->layers.mean[ALL], pixel, render->scene->background_w_per_m2_sr);
    put(render->layers.mean[NEPH_AMBIENT], pixel, open);
    put(render->layers.mean[NEPH_AMBIENT_ON_SCREEN], pixel, open);
}

static void put_surface(const struct render *render, const struct neph_reflected_view *view,
                        size_t pixel)
{
    const struct neph_vec3 n = view->hit.shading;
    const double normal[3] = {n.x, n.y, n.z};
    const struct sums sums = sample_pixel(render, view, pixel);
    put_sums(render, &sums, pixel);
    for (int k = 0; k < 2; k++)
        put(render->layers.color[k], pixel, view->color[k]);
    for (int axis = 0; axis < 3; axis++)
        render->layers.normal[axis][pixel] = (float)normal[axis];
}

static void render_row(int row, void *context)
{
    const struct render *render = context;
    const int width_px = render->params->width_px;
    for (int column = 0; column < width_px; column++) {
        const size_t pixel = (size_t)row * (size_t)width_px + (size_t)column;
        const struct neph_pixel_ray ray = neph_camera_ray(&render->screen.camera, width_px,
                                                          render->params->height_px, column, row);
        const struct neph_reflected_view view = neph_reflected_view(render->scene, ray.origin_m,
                                                                    ray.direction);
        if (view.hit.solid)
            put_surface(render, &view, pixel);
        else
            put_sky(render, pixel);
        for (int j = 0; j < 3; j++)
            render->layers.transmittance[j][pixel] = 1.0f;
        render->layers.depth[pixel] =
            (float)(view.hit.t_m * neph_vec3_dot(ray.direction, render->screen.camera.forward));
    }
}

/* ---- the image ------------------------------------------------------------------------------- */

static enum neph_status add_part(struct neph_image *image, int which, struct layers *layers,
                                 struct neph_diag *diag)
{
    char variance[NEPH_IMAGE_NAME_MAX] = "variance";
    if (which < NEPH_REFLECTED_PARTS)
        snprintf(variance, sizeof(variance), "variance.%s", part_names[which]);
    const enum neph_status status = neph_image_add_rgb(
        image, which < NEPH_REFLECTED_PARTS ? part_names[which] : NULL, layers->mean[which], diag);
    return status ? status : neph_image_add_rgb(image, variance, layers->variance[which], diag);
}

static enum neph_status add_layers(struct neph_image *image, struct layers *layers,
                                   struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int which = ALL; which >= 0 && !status; which--) /* R G B first */
        status = add_part(image, which, layers, diag);
    for (int k = 0; k < 2 && !status; k++)
        status = neph_image_add_rgb(image, color_names[k], layers->color[k], diag);
    for (int axis = 0; axis < 3 && !status; axis++)
        status = neph_image_add_channel(image, normal_names[axis], &layers->normal[axis], diag);
    if (!status)
        status = neph_image_add_rgb(image, "volume", layers->volume, diag);
    if (!status)
        status = neph_image_add_rgb(image, "transmittance", layers->transmittance, diag);
    return status ? status : neph_image_add_channel(image, "Z", &layers->depth, diag);
}

static enum neph_status check(const struct neph_scene *scene,
                              const struct neph_surfaces_params *params, struct neph_diag *diag)
{
    char reason[256];
    if (params->samples < 2 || params->samples > samples_max)
        return neph_fail(diag, NEPH_ERR_USAGE, "%d samples: must be 2..%d", params->samples,
                         samples_max);
    if (params->limits.bounces < 0 || params->limits.bounces > NEPH_ALL_BOUNCES)
        return neph_fail(diag, NEPH_ERR_USAGE, "%d bounces: must be 0..%d", params->limits.bounces,
                         NEPH_ALL_BOUNCES);
    if (!(params->limits.ao_distance_m > 0.0))
        return neph_fail(diag, NEPH_ERR_USAGE, "an ambient distance of %g m: must be above 0",
                         params->limits.ao_distance_m);
    if (!neph_reflected_is_supported(scene, reason, sizeof(reason)))
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "surfaces: cannot: %s", reason);
    return NEPH_OK;
}

enum neph_status neph_surfaces_render(const struct neph_scene *scene,
                                      const struct neph_surfaces_params *params,
                                      struct neph_image **frame, struct neph_diag *diag)
{
    struct render render = {.scene = scene,
                            .params = params,
                            .limits = params->limits,
                            .screen = {neph_scene_camera(scene, params->frame),
                                       (double)params->width_px / params->height_px}};
    struct neph_image *image = NULL;
    render.limits.screen = &render.screen;
    if (scene->scattering != NEPH_SCATTERING_MULTIPLE)
        render.limits.bounces = 0;
    enum neph_status status = check(scene, params, diag);
    if (!status)
        status = neph_image_create(params->width_px, params->height_px, &image, diag);
    if (!status)
        status = add_layers(image, &render.layers, diag);
    if (!status)
        status = neph_parallel_rows(params->height_px, render_row, &render, diag);
    if (status) {
        neph_image_destroy(image);
        return status;
    }
    *frame = image;
    return NEPH_OK;
}
