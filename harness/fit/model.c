/* SPDX-License-Identifier: MIT
 *
 * Radiance = factor of albedo * volume + what is behind it. With one phase function and the sun as
 * the only light, the volume's dependence on g is that function's at the angle of the ray: only
 * extinction and falloff change the integrals along rays.
 */
#include "harness/fit/model.h"

#include "base/srgb.h"
#include "base/text.h"
#include "base/threads.h"
#include "scenes/emission.h"
#include "scenes/media.h"
#include "scenes/phase_same.h"
#include "truth/transport.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_FIT_UNKNOWN_COUNT == 4, "a new unknown");
_Static_assert(NEPH_SCATTERING_COUNT == 3, "a new kind");
_Static_assert(NEPH_MEDIUM_KIND_COUNT == 8, "a new kind");

/* Light of one ray, for the scene's own albedo and g. */
struct light {
    struct neph_rgb volume, behind, transmittance;
};

struct slot {
    int base; /* id */
    double extinction, falloff;
    bool is_used;
    struct light *lights; /* of all pixels */
};

enum { SLOTS = 96, PREDICTED = NEPH_FIT_VALUES };

struct neph_fit_model {
    const struct neph_scene *scene;
    const struct neph_fit_pixels *pixels;
    struct neph_fit_point own;
    double *cosines; /* between rays and the sun */
    struct slot slots[SLOTS];
    int next;   /* slot to replace */
    int stride; /* between predicted pixels */
};

/* ---- scenes ---------------------------------------------------------------------------------- */

static bool is_fitted_kind(enum neph_medium_kind kind)
{
    return kind == NEPH_MEDIUM_HOMOGENEOUS || kind == NEPH_MEDIUM_HEIGHT_FOG ||
           kind == NEPH_MEDIUM_GAUSSIAN;
}

static enum neph_status refuse(struct neph_diag *diag, const char *why, const char *hint)
{
    neph_fail(diag, NEPH_ERR_UNSUPPORTED, "the scene cannot be fitted: %s", why);
    neph_hint(diag, "%s", hint);
    return NEPH_ERR_UNSUPPORTED;
}

enum neph_status neph_fit_check_scene(const struct neph_scene *scene, struct neph_diag *diag)
{
    char why[256];
    if (scene->medium_count == 0)
        return refuse(diag, "it has no medium in this frame",
                      "give it the medium that the frame was rendered with, as far as you know it");
    for (int m = 0; m < scene->medium_count; m++)
        if (!is_fitted_kind(scene->media[m].kind)) {
            neph_text_format(why, sizeof(why), "medium %d is a %s", m + 1,
                             neph_medium_facts(scene->media[m].kind)->name);
            return refuse(diag, why, "media of kind homogeneous, height_fog and gaussian can be");
        }
    if (scene->scattering == NEPH_SCATTERING_MULTIPLE)
        return refuse(diag, "it has multiple scattering, which has no closed form",
                      "render the frame with `neph render --scattering single` or that of your "
                      "renderer, and say `scattering: single` in the scene");
    if (neph_scene_emits(scene))
        return refuse(diag, "its media emit light", "render it without emission");
    if (!neph_transport_is_exact(scene, why, sizeof(why)))
        return refuse(diag, why, "`neph engines exact` says which scenes have a closed form");
    return NEPH_OK;
}

static bool media_scatter(const struct neph_scene *scene)
{
    for (int m = 0; m < scene->medium_count; m++)
        if (scene->media[m].albedo.r + scene->media[m].albedo.g + scene->media[m].albedo.b > 0.0)
            return true;
    return false;
}

static const char *albedo_obstacle(const struct neph_scene *scene)
{
    if (scene->scattering == NEPH_SCATTERING_NONE)
        return "the scene has no scattering";
    if (!media_scatter(scene))
        return "the scene's albedo is 0";
    return scene->sun.present || scene->light_count > 0 ? NULL
                                                        : "the scene has no light to scatter";
}

static const char *asymmetry_obstacle(const struct neph_scene *scene)
{
    const struct neph_phase *first = &scene->media[0].phase;
    const char *obstacle = albedo_obstacle(scene);
    if (obstacle)
        return obstacle;
    for (int m = 0; m < scene->medium_count; m++) {
        const struct neph_phase *phase = &scene->media[m].phase;
        if (!neph_phase_has(phase->kind, NEPH_PHASE_PARAMETER_G))
            return "a phase function has none";
        if (!neph_phase_is_same(phase, first))
            return "the media have different phase functions";
    }
    return scene->light_count > 0 ? "point lights are scattered by many angles along a ray" : NULL;
}

static const char *falloff_obstacle(const struct neph_scene *scene)
{
    for (int m = 0; m < scene->medium_count; m++)
        for (int l = 0; l < scene->media[m].layer_count; l++)
            if (scene->media[m].layers[l].falloff_per_m > 0.0)
                return NULL;
    return "no medium has one";
}

const char *neph_fit_obstacle(const struct neph_scene *scene, enum neph_fit_unknown unknown)
{
    switch (unknown) {
    case NEPH_FIT_EXTINCTION:
        return NULL;
    case NEPH_FIT_ALBEDO:
        return albedo_obstacle(scene);
    case NEPH_FIT_ASYMMETRY:
        return asymmetry_obstacle(scene);
    case NEPH_FIT_FALLOFF:
        return falloff_obstacle(scene);
    case NEPH_FIT_UNKNOWN_COUNT:
        break;
    }
    return "there is no such unknown";
}

struct neph_fit_point neph_fit_scene_point(const struct neph_scene *scene)
{
    return (struct neph_fit_point){.x = {[NEPH_FIT_ASYMMETRY] = scene->media[0].phase.g}};
}

struct neph_fit_base neph_fit_scene_base(void)
{
    struct neph_fit_base base = {.id = 0};
    for (int m = 0; m < NEPH_SCENE_MEDIA_MAX; m++)
        base.extinction[m] = base.albedo[m] = (struct neph_rgb){1, 1, 1};
    return base;
}

/* ---- light ----------------------------------------------------------------------------------- */

struct job {
    struct neph_scene scene;
    const struct neph_fit_pixels *pixels;
    struct light *lights;
    int stride;
};

static void see_pixel(int row, void *context)
{
    const struct job *job = context;
    const int index = row * job->stride;
    const struct neph_pixel_ray *ray = &job->pixels->list[index].ray;
    const struct neph_ray_light light = neph_transport_ray(&job->scene, ray->origin_m,
                                                           ray->direction);
    job->lights[index] = (struct light){light.volume,
                                        {light.radiance.r - light.volume.r,
                                         light.radiance.g - light.volume.g,
                                         light.radiance.b - light.volume.b},
                                        light.transmittance};
}

static void change_medium(struct neph_medium *medium, const struct neph_fit_base *base, int index,
                          double extinction, double falloff)
{
    medium->extinction_per_m *= extinction;
    medium->extinction_color = neph_rgb_mul(medium->extinction_color, base->extinction[index]);
    medium->albedo = neph_rgb_mul(medium->albedo, base->albedo[index]);
    for (int l = 0; l < medium->layer_count; l++) {
        medium->layers[l].extinction_per_m *= extinction;
        medium->layers[l].falloff_per_m *= falloff;
    }
}

static struct slot *find_slot(struct neph_fit_model *model, const struct neph_fit_base *base,
                              const struct neph_fit_point *point)
{
    for (int i = 0; i < SLOTS; i++) {
        struct slot *slot = &model->slots[i];
        if (slot->is_used && slot->base == base->id &&
            slot->extinction == point->x[NEPH_FIT_EXTINCTION] &&
            slot->falloff == point->x[NEPH_FIT_FALLOFF])
            return slot;
    }
    return NULL;
}

static enum neph_status see(struct neph_fit_model *model, const struct neph_fit_base *base,
                            const struct neph_fit_point *point, const struct light **lights,
                            struct neph_diag *diag)
{
    struct slot *slot = find_slot(model, base, point);
    enum neph_status status = NEPH_OK;
    if (!slot) {
        slot = &model->slots[model->next];
        model->next = (model->next + 1) % SLOTS;
        struct job job = {*model->scene, model->pixels, slot->lights, model->stride};
        const int rows = (model->pixels->count + model->stride - 1) / model->stride;
        for (int m = 0; m < job.scene.medium_count; m++)
            change_medium(&job.scene.media[m], base, m, exp(point->x[NEPH_FIT_EXTINCTION]),
                          exp(point->x[NEPH_FIT_FALLOFF]));
        slot->is_used = false;
        status = neph_parallel_rows(rows, see_pixel, &job, diag);
    }
    if (status)
        return status;
    slot->is_used = true;
    slot->base = base->id;
    slot->extinction = point->x[NEPH_FIT_EXTINCTION];
    slot->falloff = point->x[NEPH_FIT_FALLOFF];
    *lights = slot->lights;
    return NEPH_OK;
}

/* ---- predictions ----------------------------------------------------------------------------- */

double neph_fit_transfer_apply(enum neph_fit_transfer transfer, double value)
{
    if (transfer == NEPH_FIT_LINEAR)
        return value;
    return transfer == NEPH_FIT_ENCODED ? neph_srgb_from_linear(value) : neph_srgb_to_linear(value);
}

double neph_fit_transfer_invert(enum neph_fit_transfer transfer, double value)
{
    if (transfer == NEPH_FIT_LINEAR)
        return value;
    return transfer == NEPH_FIT_ENCODED ? neph_srgb_to_linear(value) : neph_srgb_from_linear(value);
}

/* Phase function of g over that of the scene. */
static double phase_factor(const struct neph_fit_model *model, const struct neph_fit_point *point,
                           int pixel)
{
    struct neph_phase phase = model->scene->media[0].phase;
    if (point->x[NEPH_FIT_ASYMMETRY] == model->own.x[NEPH_FIT_ASYMMETRY])
        return 1.0;
    const double own = neph_phase_per_sr(&phase, model->cosines[pixel]);
    phase.g = point->x[NEPH_FIT_ASYMMETRY];
    return neph_phase_per_sr(&phase, model->cosines[pixel]) / own;
}

static struct neph_rgb apply_opacity(const struct light *light)
{
    const struct neph_rgb through = light->transmittance;
    return neph_rgb_mul(light->volume,
                        (struct neph_rgb){1.0 - through.r, 1.0 - through.g, 1.0 - through.b});
}

enum neph_status neph_fit_predict(struct neph_fit_model *model, const struct neph_fit_base *base,
                                  const struct neph_fit_point *point,
                                  enum neph_fit_transfer transfer, double *predicted,
                                  struct neph_diag *diag)
{
    const struct light *lights;
    const enum neph_status status = see(model, base, point, &lights, diag);
    const double albedo = exp(point->x[NEPH_FIT_ALBEDO]);
    for (int i = 0; i < model->pixels->count && !status; i++, predicted += PREDICTED) {
        if (i % model->stride != 0) {
            memset(predicted, 0, PREDICTED * sizeof(*predicted));
            continue;
        }
        const double factor = albedo * phase_factor(model, point, i);
        const struct light *light = &lights[i];
        const struct neph_rgb volume = base->is_opacity_twice ? apply_opacity(light)
                                                              : light->volume;
        const double radiance[3] = {factor * volume.r + light->behind.r,
                                    factor * volume.g + light->behind.g,
                                    factor * volume.b + light->behind.b};
        for (int c = 0; c < 3; c++)
            predicted[c] = neph_fit_transfer_apply(transfer, radiance[c]);
        predicted[3] = light->transmittance.r;
        predicted[4] = light->transmittance.g;
        predicted[5] = light->transmittance.b;
    }
    return status;
}

enum neph_status neph_fit_model_create(const struct neph_scene *scene,
                                       const struct neph_fit_pixels *pixels,
                                       struct neph_fit_model **model, struct neph_diag *diag)
{
    const size_t count = (size_t)pixels->count;
    struct neph_fit_model *made = calloc(1, sizeof(*made));
    struct light *lights = calloc(SLOTS * count, sizeof(*lights));
    double *cosines = calloc(count, sizeof(*cosines));
    if (!made || !lights || !cosines) {
        free(made);
        free(lights);
        free(cosines);
        return neph_fail_memory(diag);
    }
    made->scene = scene;
    made->pixels = pixels;
    made->own = neph_fit_scene_point(scene);
    made->cosines = cosines;
    made->stride = 1;
    for (size_t i = 0; i < SLOTS; i++)
        made->slots[i].lights = lights + i * count;
    for (size_t i = 0; i < count; i++)
        cosines[i] = neph_vec3_dot(pixels->list[i].ray.direction, scene->sun.direction);
    *model = made;
    return NEPH_OK;
}

void neph_fit_model_thin(struct neph_fit_model *model, int stride)
{
    model->stride = stride;
    for (int i = 0; i < SLOTS; i++)
        model->slots[i].is_used = false;
}

void neph_fit_model_destroy(struct neph_fit_model *model)
{
    if (!model)
        return;
    free(model->slots[0].lights);
    free(model->cosines);
    free(model);
}
