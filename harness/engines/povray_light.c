/* SPDX-License-Identifier: MIT */
#include "harness/engines/povray_light.h"

#include "scenes/emission.h"
#include "scenes/media.h"
#include "scenes/phase_same.h"
#include "scenes/solids.h"
#include "scenes/surfaces.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_SCATTERING_COUNT == 3, "a new kind");

/* Accuracy of radiance: 1e-4 of the value, or 1e-6 of the brightest pixel. */
static const double radiance_relative = 1e-4;
static const double radiance_of_peak = 1e-6;
/* Accuracy of radiance with point lights, whose pixels may be 1e6 times brighter than others: this
 * part of the median. */
static const double radiance_of_median = 1e-4;
/* An image counts as black below this part of the largest light that the scene could scatter. */
static const double radiance_black = 1e-13;

/* ---- Light ---------------------------------------------------------------------------------- */

/* The sources of an image by colour: their weights decide which colours need a render of their
 * own. */
enum { SOURCES_MAX = NEPH_SCENE_SOLIDS_MAX + 1 };

struct sources {
    int count;
    bool has_texture; /* of a mesh: its colours have all ratios */
    double weights[3][SOURCES_MAX];
};

static bool is_source(const struct sources *sources, int i, struct neph_rgb weight)
{
    return sources->weights[0][i] == weight.r && sources->weights[1][i] == weight.g &&
           sources->weights[2][i] == weight.b;
}

/* Add a source, once for each weight. If the table is full, its last entry keeps the larger weight,
 * with channels that differ so that they are never proportional. */
static void add_source(struct sources *sources, struct neph_rgb weight)
{
    for (int i = 0; i < sources->count; i++)
        if (is_source(sources, i, weight))
            return;
    if (sources->count == SOURCES_MAX) {
        const double most = fmax(weight.r, fmax(weight.g, weight.b));
        for (int channel = 0; channel < 3; channel++)
            sources->weights[channel][SOURCES_MAX - 1] = fmax(
                sources->weights[channel][SOURCES_MAX - 1], most * (1.0 + 1e-3 * channel));
        return;
    }
    for (int channel = 0; channel < 3; channel++)
        sources->weights[channel][sources->count] = neph_povray_component(weight, channel);
    sources->count++;
}

static double brightest_source(const struct sources *sources, int channel)
{
    double brightest = 0.0;
    for (int i = 0; i < sources->count; i++)
        brightest = fmax(brightest, sources->weights[channel][i]);
    return brightest;
}

bool neph_povray_same_extinction(const struct neph_scene *scene, int a, int b)
{
    for (int i = 0; i < scene->medium_count; i++) {
        const struct neph_rgb color = scene->media[i].extinction_color;
        if (neph_povray_component(color, a) != neph_povray_component(color, b))
            return false;
    }
    return true;
}

/* Whether all solids reflect two colours equally. */
static bool same_albedo(const struct neph_scene *scene, int a, int b)
{
    for (int i = 0; i < scene->solid_count; i++) {
        const struct neph_rgb colors[2] = {scene->solids[i].albedo,
                                           scene->solids[i].surface.texture.other};
        for (int c = 0; c < 2; c++)
            if (neph_povray_component(colors[c], a) != neph_povray_component(colors[c], b))
                return false;
    }
    return true;
}

/* The factor between two colours; 0: they are not proportional within rounding. With light between
 * solids, proportional sources are not enough: albedos must be equal, too. */
static double proportion(const struct neph_scene *scene, const struct sources *sources, int from,
                         int to)
{
    if (sources->has_texture || !neph_povray_same_extinction(scene, from, to) ||
        (scene->scattering == NEPH_SCATTERING_MULTIPLE && !same_albedo(scene, from, to)))
        return 0.0;
    double from_peak = brightest_source(sources, from), to_peak = brightest_source(sources, to);
    for (int i = 0; i < sources->count; i++) {
        double difference = sources->weights[to][i] / to_peak -
                            sources->weights[from][i] / from_peak;
        if (fabs(difference) > 1e-14)
            return 0.0;
    }
    return to_peak / from_peak;
}

/* An already rendered colour that is proportional to `channel`, with the factor; or `channel`
 * itself. */
static int representative(const struct neph_scene *scene, const struct sources *sources,
                          int channel, struct neph_povray_reading *const readings[3],
                          double *factor)
{
    for (int earlier = 0; earlier < channel; earlier++) {
        if (!readings[earlier])
            continue;
        *factor = proportion(scene, sources, earlier, channel);
        if (*factor > 0.0)
            return earlier;
    }
    *factor = 1.0;
    return channel;
}

void neph_povray_light_free(struct neph_povray_light *light)
{
    for (int channel = 0; channel < 3; channel++)
        free(light->planes[channel]);
}

enum neph_status neph_povray_light_make(size_t pixel_count, struct neph_povray_light *light,
                                        struct neph_diag *diag)
{
    for (int channel = 0; channel < 3; channel++) {
        light->planes[channel] = calloc(pixel_count, sizeof(double));
        if (!light->planes[channel])
            return neph_fail_memory(diag);
    }
    return NEPH_OK;
}

static void add_readings(double *plane, const struct neph_povray_reading *readings, double factor,
                         size_t count)
{
    for (size_t i = 0; i < count; i++)
        plane[i] += factor * readings[i].value;
}

/* Render the colours of one image and add them to `light`. No pixel of a colour exceeds
 * `bound_per_source` times its brightest source. */
static enum neph_status add_picture(struct neph_povray_session *session, const char *name,
                                    struct neph_povray_pass pass, const struct sources *sources,
                                    double bound_per_source, struct neph_povray_light *light,
                                    struct neph_diag *diag)
{
    static const char letters[] = "rgb";
    struct neph_povray_reading *readings[3] = {NULL, NULL, NULL};
    enum neph_status status = NEPH_OK;
    for (int channel = 0; !status && channel < 3; channel++) {
        double factor = 1.0, wall_s = 0.0;
        double bound = bound_per_source * brightest_source(sources, channel);
        if (!(bound > 0.0))
            continue;
        int shown = representative(session->shot.scene, sources, channel, readings, &factor);
        if (shown == channel) {
            char file[32];
            snprintf(file, sizeof(file), "%.24s-%c", name, letters[channel]);
            struct neph_povray_target target = {.relative = radiance_relative,
                                                .absolute = radiance_black * bound,
                                                .absolute_of_peak = radiance_of_peak};
            if (session->shot.scene->light_count > 0)
                target.absolute_of_median = radiance_of_median;
            pass.channel = channel;
            status = neph_povray_expose(session, file, pass, bound, &target, &readings[channel],
                                        &wall_s, diag);
            session->cost.render_s += wall_s;
        }
        if (!status)
            add_readings(light->planes[channel], readings[shown], factor, session->pixel_count);
    }
    for (int channel = 0; channel < 3; channel++)
        free(readings[channel]);
    return status;
}

/* Upper bound of the radiance in a pixel, per unit of irradiance, from media of one phase function
 * and albedo 1: p(cos) (1 - T), without loss of sunlight on its way. */
static double brightest_scattering_per_sr(const struct neph_povray_session *session,
                                          const struct neph_phase *phase)
{
    const struct neph_shot *shot = &session->shot;
    const struct neph_camera *camera = &session->world.camera;
    double brightest = 0.0;
    for (size_t pixel = 0; pixel < session->pixel_count; pixel++) {
        size_t width = (size_t)shot->width_px;
        const struct neph_pixel_ray ray = neph_camera_ray(camera, shot->width_px, shot->height_px,
                                                          (double)(pixel % width),
                                                          (double)(pixel / width));
        const struct neph_rgb depths = neph_scene_optical_depth(shot->scene, ray.origin_m,
                                                                ray.direction, 0.0, INFINITY);
        double depth = fmax(depths.r, fmax(depths.g, depths.b));
        double phase_per_sr = neph_phase_per_sr(
            phase, neph_vec3_dot(shot->scene->sun.direction, ray.direction));
        brightest = fmax(brightest, phase_per_sr * -expm1(-depth));
    }
    return brightest;
}

/* Upper bound of the extinction of all media together, in any colour. */
static double densest_per_m(const struct neph_povray_session *session)
{
    double sum_per_m = 0.0;
    for (int i = 0; i < session->shot.scene->medium_count; i++) {
        const struct neph_rgb color = session->shot.scene->media[i].extinction_color;
        if (session->world.containers[i].used)
            sum_per_m += session->world.containers[i].extinction_per_m *
                         fmax(color.r, fmax(color.g, color.b));
    }
    return sum_per_m;
}

/* The largest pi / h over all pixels' rays, where h is the distance of ray and light: the integral
 * of 1/d^2 along the ray. */
static double closest_per_m(const struct neph_povray_session *session, struct neph_vec3 light_m)
{
    const struct neph_shot *shot = &session->shot;
    double most_per_m = 0.0;
    for (size_t pixel = 0; pixel < session->pixel_count; pixel++) {
        const size_t width = (size_t)shot->width_px;
        const struct neph_pixel_ray ray = neph_camera_ray(&session->world.camera, shot->width_px,
                                                          shot->height_px, (double)(pixel % width),
                                                          (double)(pixel / width));
        const struct neph_vec3 way_m = neph_vec3_sub(light_m, ray.origin_m);
        const double height_m = neph_vec3_length(neph_vec3_cross(way_m, ray.direction));
        most_per_m = fmax(most_per_m, M_PI / fmax(height_m, 1e-6));
    }
    return most_per_m;
}

/* Upper bound of the radiance in a pixel, per unit of radiant intensity, from media of one phase
 * function and albedo 1 and from all lights, without loss of light on its way. */
static double brightest_light_per_m2(const struct neph_povray_session *session,
                                     const struct neph_phase *phase)
{
    const double phase_per_sr = fmax(neph_phase_per_sr(phase, 1.0), neph_phase_per_sr(phase, -1.0));
    double sum_per_m = 0.0;
    for (int i = 0; i < session->shot.scene->light_count; i++)
        sum_per_m += closest_per_m(session, session->shot.scene->lights[i].position_m);
    return sum_per_m * densest_per_m(session) * phase_per_sr;
}

static struct sources scattering_sources(const struct neph_povray_session *session,
                                         const struct neph_phase *phase)
{
    const struct neph_scene *scene = session->shot.scene;
    struct sources sources = {.count = 0};
    for (int i = 0; i < scene->medium_count; i++) {
        const struct neph_medium *medium = &scene->media[i];
        if (!session->world.containers[i].used || !neph_phase_is_same(phase, &medium->phase))
            continue;
        if (scene->sun.present)
            add_source(&sources, neph_rgb_mul(medium->albedo, scene->sun.irradiance_w_per_m2));
        for (int l = 0; l < scene->light_count; l++)
            add_source(&sources, neph_rgb_mul(medium->albedo, scene->lights[l].intensity_w_per_sr));
    }
    return sources;
}

/* Whether an earlier medium has the same phase function, so that its pass includes this medium. */
static bool is_repeated(const struct neph_povray_session *session, int medium)
{
    const struct neph_scene *scene = session->shot.scene;
    for (int i = 0; i < medium; i++) {
        if (session->world.containers[i].used &&
            neph_phase_is_same(&scene->media[i].phase, &scene->media[medium].phase))
            return true;
    }
    return false;
}

enum neph_status neph_povray_add_volume(struct neph_povray_session *session,
                                        struct neph_povray_light *volume, struct neph_diag *diag)
{
    const struct neph_scene *scene = session->shot.scene;
    enum neph_status status = NEPH_OK;
    if (!(scene->sun.present || scene->light_count > 0) ||
        scene->scattering == NEPH_SCATTERING_NONE)
        return NEPH_OK;
    for (int i = 0; !status && i < scene->medium_count; i++) {
        if (!session->world.containers[i].used || is_repeated(session, i))
            continue;
        char name[32];
        struct neph_povray_pass pass = {.kind = NEPH_POVRAY_VOLUME, .phase = scene->media[i].phase};
        struct sources sources = scattering_sources(session, &pass.phase);
        snprintf(name, sizeof(name), "volume%d", i + 1);
        const double bound = (scene->sun.present ? brightest_scattering_per_sr(session, &pass.phase)
                                                 : 0.0) +
                             brightest_light_per_m2(session, &pass.phase);
        status = add_picture(session, name, pass, &sources, bound, volume, diag);
    }
    return status;
}

/* Add the emission. No pixel exceeds the brightest medium as if it were opaque. */
enum neph_status neph_povray_add_emission(struct neph_povray_session *session,
                                          struct neph_povray_light *volume, struct neph_diag *diag)
{
    const struct neph_scene *scene = session->shot.scene;
    struct neph_povray_pass pass = {.kind = NEPH_POVRAY_EMISSION};
    struct sources sources = {.count = 0};
    for (int i = 0; i < scene->medium_count; i++)
        if (session->world.containers[i].used)
            add_source(&sources, neph_medium_glow(&scene->media[i]));
    return add_picture(session, "emission", pass, &sources, 1.0, volume, diag);
}

/* Distance from a point to a box; 0 inside. */
static double distance_m(const struct neph_bounds *box, struct neph_vec3 point_m)
{
    const struct neph_vec3 out_m = {
        fmax(0.0, fmax(box->min_m.x - point_m.x, point_m.x - box->max_m.x)),
        fmax(0.0, fmax(box->min_m.y - point_m.y, point_m.y - box->max_m.y)),
        fmax(0.0, fmax(box->min_m.z - point_m.z, point_m.z - box->max_m.z))};
    return neph_vec3_length(out_m);
}

/* Add the lights as sources, each with its irradiance at the nearest point of the solid's bounding
 * box, which is an upper bound for spheres.
 */
static void add_point_lit(struct sources *sources, const struct neph_scene *scene,
                          const struct neph_solid *solid, struct neph_rgb color)
{
    const struct neph_bounds box = neph_solid_bounds(solid);
    for (int l = 0; l < scene->light_count; l++) {
        const double near_m = fmax(1e-3, distance_m(&box, scene->lights[l].position_m));
        add_source(sources, neph_rgb_scale(neph_rgb_mul(color, scene->lights[l].intensity_w_per_sr),
                                           scene->light_count / (M_PI * near_m * near_m)));
    }
}

static void add_sunlit(struct sources *sources, const struct neph_scene *scene,
                       struct neph_rgb color)
{
    if (scene->sun.present)
        add_source(sources,
                   neph_rgb_scale(neph_rgb_mul(color, scene->sun.irradiance_w_per_m2), 1.0 / M_PI));
}

enum neph_status neph_povray_add_surface(struct neph_povray_session *session,
                                         struct neph_povray_light *surface, struct neph_diag *diag)
{
    const struct neph_scene *scene = session->shot.scene;
    struct neph_povray_pass pass = {.kind = NEPH_POVRAY_SURFACE};
    struct sources sources = {.has_texture = neph_scene_mesh_looks(scene) & NEPH_LOOK_TEXTURE};
    add_source(&sources, scene->background_w_per_m2_sr);
    for (int i = 0; i < scene->solid_count; i++)
        add_sunlit(&sources, scene, scene->solids[i].albedo);
    for (int i = 0; i < scene->solid_count; i++)
        add_point_lit(&sources, scene, &scene->solids[i], scene->solids[i].albedo);
    for (int i = 0; i < scene->solid_count; i++) {
        const struct neph_surface *look = &scene->solids[i].surface;
        if (!neph_is_textured(look))
            continue;
        add_sunlit(&sources, scene, look->texture.other);
        add_point_lit(&sources, scene, &scene->solids[i], look->texture.other);
    }
    return add_picture(session, "surface", pass, &sources, 1.0, surface, diag);
}
