/* SPDX-License-Identifier: MIT
 *
 * Colour. A path is sampled for light of one random channel. Its value in channel j is f_j / mean_k
 * p_k: f_j is the light of the path in channel j, p_k the probability that channel k would have
 * sampled it (balance heuristic). Both are stored divided by the mean of p, so that neither leaves
 * the range of a double. In a grey scene all p are 1.
 */
#include "truth/path.h"

#include "scenes/emission.h"
#include "scenes/lights.h"
#include "scenes/media.h"
#include "scenes/phase_colour.h"
#include "scenes/surfaces.h"
#include "truth/airlight.h"
#include "truth/directions.h"
#include "truth/lamp_draw.h"

#include <math.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_SCATTERING_COUNT == 3, "a new kind");

/* Russian roulette: a path below this part of its initial value may be ended (otherwise its value
 * is raised). */
static const double roulette_below = 0.05;

struct path {
    const struct neph_scene *scene;
    const struct neph_tracker *tracker;
    struct neph_random *random;
    struct neph_tracking_cost *cost;
    struct neph_vec3 at_m, direction; /* away from the camera */
    int channel;
    double value[3];       /* f / mean p */
    double probability[3]; /* p / mean p */
    double roulette;       /* Russian roulette below this value */
    double sun_depth;      /* guessed depth to the sun, if the light from this point must have low
                            * noise; else 0 */
    double sunlit;         /* transmittance of the sunlight at this event, */
    double sunlit_sum;     /* and of all events so far */
    double sunward;        /* what the next event scatters of its sunlight, over that of isotropic
                            * scattering; at least 1 */
    const struct neph_phase *peak; /* draws directions towards the sun; NULL: nothing does */
};

static const struct neph_rgb black = {0, 0, 0};

static struct neph_rgb path_value(const struct path *path)
{
    return (struct neph_rgb){path->value[0], path->value[1], path->value[2]};
}

static void add(struct neph_rgb *sum, struct neph_rgb light)
{
    *sum = neph_rgb_add(*sum, light);
}

/* Multiply both f and p by the ratios of the channels in the last flight. */
static void weigh(struct path *path, const double ratio[3])
{
    double mean = 0.0;
    for (int j = 0; j < 3; j++) {
        path->value[j] *= ratio[j];
        path->probability[j] *= ratio[j];
        mean += path->probability[j] / 3.0;
    }
    for (int j = 0; j < 3; j++) {
        path->value[j] /= mean;
        path->probability[j] /= mean;
    }
}

/* Multiply by an albedo; false: the value is 0. */
static bool reflect(struct path *path, struct neph_rgb albedo)
{
    path->value[0] *= albedo.r;
    path->value[1] *= albedo.g;
    path->value[2] *= albedo.b;
    return path->value[0] > 0.0 || path->value[1] > 0.0 || path->value[2] > 0.0;
}

static double largest_path_value(const struct path *path)
{
    return fmax(path->value[0], fmax(path->value[1], path->value[2]));
}

static bool survives(struct path *path)
{
    const double most = path->sunward * largest_path_value(path);
    if (most >= path->roulette)
        return true;
    if (neph_random_uniform(path->random) * path->roulette >= most)
        return false;
    for (int j = 0; j < 3; j++)
        path->value[j] *= path->roulette / most;
    return true;
}

/* ---- light that arrives at a point ---- */

/* `expected_depth` as in neph_tracker_transmittance(). */
static struct neph_rgb transmittance(const struct path *path, struct neph_vec3 direction,
                                     double expected_depth)
{
    const struct neph_ray ray = {path->at_m, direction, INFINITY};
    return neph_tracker_transmittance(path->tracker, &ray, expected_depth, path->random,
                                      path->cost);
}

/* Sunlight of the path if the point scatters `per_sr` of it towards the camera. */
static struct neph_rgb sunlight(struct path *path, struct neph_rgb per_sr)
{
    path->sunlit = 0.0;
    const struct neph_sun *sun = &path->scene->sun;
    if (!sun->present || (per_sr.r == 0.0 && per_sr.g == 0.0 && per_sr.b == 0.0) ||
        !neph_scene_is_sun_visible(path->scene, path->at_m))
        return black;
    const struct neph_rgb through = transmittance(path, sun->direction, path->sun_depth);
    path->sunlit = fmax(through.r, fmax(through.g, through.b));
    const struct neph_rgb light = neph_rgb_mul(sun->irradiance_w_per_m2, through);
    return neph_rgb_mul(neph_rgb_mul(path_value(path), light), per_sr);
}

/* A part of an extinction, which may be infinite far down in a fog without ground. */
static double scaled(double part, double per_m)
{
    return part > 0.0 ? part * per_m : 0.0; /* 0 * inf */
}

/* Scattering coefficient of all media from one direction into another [1/(m sr)]. */
static struct neph_rgb scattered_per_m_sr(const struct neph_scene *scene, struct neph_vec3 point_m,
                                          double cosine)
{
    struct neph_rgb sum = black;
    for (int m = 0; m < scene->medium_count; m++) {
        const struct neph_medium *medium = &scene->media[m];
        const struct neph_rgb per_m_sr = neph_rgb_scale(
            neph_phase_rgb_per_sr(&medium->phase, cosine),
            neph_medium_extinction_per_m(medium, point_m));
        const struct neph_rgb part = neph_rgb_mul(medium->albedo, medium->extinction_color);
        add(&sum, (struct neph_rgb){scaled(part.r, per_m_sr.r), scaled(part.g, per_m_sr.g),
                                    scaled(part.b, per_m_sr.b)});
    }
    return sum;
}

static struct neph_rgb transmittance_between(const struct path *path, struct neph_vec3 from_m,
                                             struct neph_vec3 direction, double length_m)
{
    const struct neph_ray ray = {from_m, direction, length_m};
    return neph_tracker_transmittance(path->tracker, &ray, 0.0, path->random, path->cost);
}

/* Light times transmittance, 0 if opaque: a fog without ground has unbounded density downwards, and
 * 0 * inf would be NaN. */
static struct neph_rgb attenuated(struct neph_rgb light, struct neph_rgb through)
{
    return (struct neph_rgb){through.r > 0.0 ? light.r * through.r : 0.0,
                             through.g > 0.0 ? light.g * through.g : 0.0,
                             through.b > 0.0 ? light.b * through.b : 0.0};
}

/* Light of a point light that media scatter into the segment from here to `end_m`. */
static struct neph_rgb sample_segment_light(const struct path *path, double end_m)
{
    const struct neph_scene *scene = path->scene;
    if (scene->light_count == 0)
        return black;
    const struct neph_light_point place = neph_light_point_sample(
        scene, path->at_m, path->direction, end_m, path->random);
    if (!(place.density_per_m > 0.0))
        return black;
    const struct neph_vec3 point_m = neph_vec3_along(path->at_m, path->direction, place.t_m);
    const double part = neph_light_falloff(place.light, neph_vec3_scale(place.to_light, -1.0)) /
                        (place.distance_m * place.distance_m * place.density_per_m);
    const struct neph_rgb arriving = neph_rgb_mul(
        neph_rgb_scale(place.light->intensity_w_per_sr, part),
        scattered_per_m_sr(scene, point_m, neph_vec3_dot(path->direction, place.to_light)));
    path->cost->lookups++;
    if (!(arriving.r > 0.0 || arriving.g > 0.0 || arriving.b > 0.0) ||
        !neph_scene_is_visible(scene, point_m, place.light->position_m))
        return black;
    const struct neph_rgb through = neph_rgb_mul(
        transmittance_between(path, path->at_m, path->direction, place.t_m),
        transmittance_between(path, point_m, place.to_light, place.distance_m));
    return neph_rgb_mul(path_value(path), attenuated(arriving, through));
}

/* Light of a point light that the surface at the path's position reflects. */
static struct neph_rgb sample_surface_light(const struct path *path, const struct neph_hit *hit)
{
    double probability;
    const struct neph_light *light = path->scene->light_count == 0
                                         ? NULL
                                         : neph_light_choose(path->scene, path->at_m, &probability,
                                                             path->random);
    if (!light)
        return black;
    const struct neph_lit lit = neph_light_at(light, path->at_m);
    const double cosine = neph_hit_cosine(hit, lit.direction);
    if (cosine <= 0.0 || !neph_scene_is_visible(path->scene, path->at_m, light->position_m))
        return black;
    const struct neph_rgb through = transmittance_between(path, path->at_m, lit.direction,
                                                          lit.distance_m);
    return neph_rgb_scale(
        neph_rgb_mul(path_value(path), neph_rgb_mul(lit.irradiance_w_per_m2, through)),
        cosine / (M_PI * probability));
}

/* Environment light along the path's direction, unscattered. */
static struct neph_rgb sample_environment(const struct path *path)
{
    if (!path->scene->environment_light ||
        neph_scene_hit(path->scene, path->at_m, path->direction).solid)
        return black;
    const struct neph_rgb light = neph_rgb_mul(path->scene->background_w_per_m2_sr,
                                               transmittance(path, path->direction, 0.0));
    return neph_rgb_mul(path_value(path), light);
}

/* ---- events ---- */

/* Weigh by the densities with which the channels would have drawn a direction. */
static void weigh_direction(struct path *path, struct neph_rgb drawn)
{
    double ratio[3];
    neph_direction_ratios(drawn, path->channel, ratio);
    weigh(path, ratio);
}

/* Part of the directions that are drawn towards the sun. It raises the weight of all others, so it
 * is small deep in a cloud, where the next event has no sunlight either, and after many sunlit
 * events. Any part that does not depend on the direction leaves the mean as it is. */
static double sunward_share(struct path *path)
{
    if (!path->peak)
        return 0.0;
    path->sunlit_sum += path->sunlit;
    return path->sunlit / (1.0 + path->sunlit_sum);
}

static struct neph_rgb peak_per_sr(const struct path *path, const struct neph_phase *peak)
{
    return neph_phase_rgb_per_sr(peak, neph_vec3_dot(path->direction, path->scene->sun.direction));
}

/* The weight of a direction; where rounding at the edge of a table leaves no density, 0. */
static double direction_weight(double wanted, double drawn)
{
    return drawn > 0.0 ? wanted / drawn : 0.0;
}

/* Choose a new direction with the density `per_sr()` of the path's channel: `own`, or sometimes one
 * towards a point light, or one around the sun with the density `peak`, because few paths meet a
 * diffraction peak by chance. The value is multiplied by the remaining weight of the scattering. */
static void turn(struct path *path, struct neph_vec3 own,
                 struct neph_rgb (*per_sr)(const void *context, struct neph_vec3 direction),
                 const void *context, bool is_coloured, const struct neph_phase *peak)
{
    const struct neph_scene *scene = path->scene;
    path->direction = own;
    path->sunward = 1.0;
    const bool is_last = scene->scattering != NEPH_SCATTERING_MULTIPLE;
    const double lamp_share = scene->light_count > 0 ? NEPH_LIGHT_DIRECTIONS : 0.0;
    const double sun_share = sunward_share(path);
    if (is_last || lamp_share + sun_share == 0.0) {
        if (is_coloured)
            weigh_direction(path, per_sr(context, own));
        return;
    }
    const double choice = neph_random_uniform(path->random);
    if (choice < lamp_share)
        path->direction = neph_light_direction_sample(scene, path->at_m, path->random);
    else if (choice < lamp_share + sun_share) {
        const struct neph_phase drawn = neph_phase_channel(peak, path->channel);
        path->direction = neph_phase_sample(&drawn, scene->sun.direction, path->random);
    }
    const struct neph_rgb wanted = per_sr(context, path->direction);
    const double lamps = lamp_share > 0.0
                             ? lamp_share *
                                   neph_light_direction_per_sr(scene, path->at_m, path->direction)
                             : 0.0;
    const struct neph_rgb sunward = sun_share > 0.0 ? peak_per_sr(path, peak) : black;
    const double rest = 1.0 - lamp_share - sun_share;
    const struct neph_rgb drawn = {rest * wanted.r + lamps + sun_share * sunward.r,
                                   rest * wanted.g + lamps + sun_share * sunward.g,
                                   rest * wanted.b + lamps + sun_share * sunward.b};
    path->value[0] *= direction_weight(wanted.r, drawn.r);
    path->value[1] *= direction_weight(wanted.g, drawn.g);
    path->value[2] *= direction_weight(wanted.b, drawn.b);
    if (sun_share > 0.0)
        path->sunward = fmax(1.0, 4.0 * M_PI * fmax(sunward.r, fmax(sunward.g, sunward.b)));
    if (is_coloured || (sun_share > 0.0 && neph_phase_is_coloured(peak)))
        weigh_direction(path, drawn);
}

struct scattered {
    const struct neph_phase *phase;
    struct neph_vec3 direction; /* before */
};

static struct neph_rgb scattered_per_sr(const void *context, struct neph_vec3 direction)
{
    const struct scattered *scattered = context;
    return neph_phase_rgb_per_sr(scattered->phase, neph_vec3_dot(scattered->direction, direction));
}

/* Reflection by a diffuse surface, equal in all channels. */
static struct neph_rgb lambertian_per_sr(double cosine)
{
    const double per_sr = fmax(0.0, cosine) / M_PI;
    return (struct neph_rgb){per_sr, per_sr, per_sr};
}

static struct neph_rgb reflected_per_sr(const void *context, struct neph_vec3 direction)
{
    return lambertian_per_sr(neph_hit_cosine(context, direction));
}

/* Move to a collision; add the emission there. */
static void reach_medium(struct path *path, const struct neph_collision *collision,
                         struct neph_rgb *emitted)
{
    path->at_m = neph_vec3_along(path->at_m, path->direction, collision->t_m);
    add(emitted,
        neph_rgb_mul(path_value(path), neph_medium_glow(&path->scene->media[collision->medium])));
}

/* Scatter: add the sunlight, and turn the path; false: it ends. */
static bool leave_medium(struct path *path, int index, struct neph_rgb *light)
{
    const struct neph_medium *medium = &path->scene->media[index];
    if (!reflect(path, medium->albedo))
        return false;
    const double cosine = neph_vec3_dot(path->direction, path->scene->sun.direction);
    add(light, sunlight(path, neph_phase_rgb_per_sr(&medium->phase, cosine)));
    const struct scattered scattered = {&medium->phase, path->direction};
    const struct neph_phase own = neph_phase_channel(&medium->phase, path->channel);
    turn(path, neph_phase_sample(&own, path->direction, path->random), scattered_per_sr, &scattered,
         neph_phase_is_coloured(&medium->phase),
         neph_phase_is_in_shaders(medium->phase.kind) ? path->peak : &medium->phase);
    return largest_path_value(path) > 0.0;
}

/* Move to a surface, without its direct light; false: it absorbs everything. */
static bool reach_surface(struct path *path, const struct neph_hit *hit)
{
    const struct neph_vec3 point_m = neph_vec3_along(path->at_m, path->direction, hit->t_m);
    if (!reflect(path, neph_surface_color(hit, point_m)))
        return false;
    path->at_m = neph_hit_outside_m(hit, point_m);
    return true;
}

/* A path that a smooth mesh would send through its own triangle has no light. */
static bool leaves_outside(const struct path *path, const struct neph_hit *hit)
{
    return largest_path_value(path) > 0.0 && neph_vec3_dot(hit->normal, path->direction) > 0.0;
}

static bool leave_surface(struct path *path, const struct neph_hit *hit)
{
    path->sunlit = 0.5; /* not known here */
    turn(path, neph_cosine_sample(hit->shading, path->random), reflected_per_sr, hit, false,
         path->peak);
    return leaves_outside(path, hit);
}

static bool meet_surface(struct path *path, const struct neph_hit *hit, struct neph_rgb *light)
{
    if (!reach_surface(path, hit))
        return false;
    const struct neph_vec3 own = neph_cosine_sample(hit->shading, path->random);
    const double cosine = neph_hit_cosine(hit, path->scene->sun.direction);
    add(light, sunlight(path, lambertian_per_sr(cosine)));
    add(light, sample_surface_light(path, hit));
    turn(path, own, reflected_per_sr, hit, false, path->peak);
    return leaves_outside(path, hit);
}

/* Trace from an event to the end of the path. `*direct` receives environment light without a
 * further event, `*light` all other light. */
static void follow(struct path *path, struct neph_rgb *direct, struct neph_rgb *light)
{
    /* Relative to the current value, which is small after a first collision in a thin medium. */
    path->roulette = roulette_below * largest_path_value(path);
    for (struct neph_rgb *escaped = direct; survives(path); escaped = light) {
        const struct neph_hit hit = neph_scene_hit(path->scene, path->at_m, path->direction);
        const struct neph_ray ray = {path->at_m, path->direction, hit.t_m};
        add(light, sample_segment_light(path, hit.t_m));
        const struct neph_collision collision = neph_tracker_collide(
            path->tracker, &ray, path->channel, path->random, path->cost);
        if (!neph_tracker_is_grey(path->tracker))
            weigh(path, collision.ratio);
        if (collision.medium < 0 && !hit.solid) {
            if (path->scene->environment_light)
                add(escaped, neph_rgb_mul(path_value(path), path->scene->background_w_per_m2_sr));
            return;
        }
        if (collision.medium >= 0)
            reach_medium(path, &collision, light);
        if (!(collision.medium < 0 ? meet_surface(path, &hit, light)
                                   : leave_medium(path, collision.medium, light)))
            return;
    }
}

/* ---- camera paths ---------------------------------------------------------------------------- */

/* The phase function by which directions are drawn towards the sun: the first that can have a peak.
 * NULL: there is none, or no event after the first. */
static const struct neph_phase *find_peak(const struct neph_scene *scene)
{
    if (!scene->sun.present || scene->scattering != NEPH_SCATTERING_MULTIPLE)
        return NULL;
    for (int m = 0; m < scene->medium_count; m++)
        if (!neph_phase_is_in_shaders(scene->media[m].phase.kind))
            return &scene->media[m].phase;
    return NULL;
}

static struct path path_start(const struct neph_scene *scene, const struct neph_tracker *tracker,
                              const struct neph_view *view, struct neph_random *random,
                              struct neph_tracking_cost *cost)
{
    struct path path = {.scene = scene,
                        .tracker = tracker,
                        .random = random,
                        .cost = cost,
                        .at_m = view->origin_m,
                        .direction = view->direction,
                        .value = {1.0, 1.0, 1.0},
                        .probability = {1.0, 1.0, 1.0},
                        .peak = find_peak(scene)};
    if (!neph_tracker_is_grey(tracker))
        path.channel = (int)(3.0 * neph_random_uniform(random));
    return path;
}

/* Sample the first collision with single scattering: it is the whole path, so only its value is
 * needed. */
static bool enter_lit_volume(struct path *path, const struct neph_flight *flight,
                             struct neph_collision *collision)
{
    *collision = neph_flight_collide_lit(flight, path->random, path->value);
    path->cost->collisions += collision->medium >= 0;
    return collision->medium >= 0;
}

/* Sample the first collision with guessed optical depths: the transmittance from the camera is an
 * estimate, too. */
static bool enter_guessed_volume(struct path *path, const struct neph_guess *guess,
                                 struct neph_collision *collision)
{
    const struct neph_guess_result guessed = neph_guess_sample(guess, path->scene, path->random);
    *collision = guessed.collision;
    if (collision->medium < 0)
        return false;
    const struct neph_ray way = {path->at_m, path->direction, collision->t_m};
    const struct neph_rgb light = neph_tracker_transmittance(
        path->tracker, &way, fmax(1.0, guessed.view_depth), path->random, path->cost);
    path->value[0] = guessed.value[0] * light.r;
    path->value[1] = guessed.value[1] * light.g;
    path->value[2] = guessed.value[2] * light.b;
    path->sun_depth = fmax(1.0, guessed.sun_depth);
    path->cost->collisions++;
    path->cost->lookups++;
    return true;
}

/* Sample the first collision if media differ in brightness: each has its own samples. */
static bool enter_medium_volume(struct path *path, const struct neph_medium_flight *flight,
                                struct neph_collision *collision)
{
    const struct neph_guess_result drawn = neph_medium_flight_sample(flight, path->random);
    struct neph_rgb light = {1, 1, 1};
    *collision = drawn.collision;
    if (collision->medium < 0)
        return false;
    if (!flight->is_exact) {
        const struct neph_ray way = {path->at_m, path->direction, collision->t_m};
        light = neph_tracker_transmittance(path->tracker, &way, fmax(1.0, drawn.view_depth),
                                           path->random, path->cost);
        if (path->scene->scattering == NEPH_SCATTERING_SINGLE)
            path->sun_depth = fmax(1.0, drawn.sun_depth);
        path->cost->lookups++;
    }
    path->value[0] = drawn.value[0] * light.r;
    path->value[1] = drawn.value[1] * light.g;
    path->value[2] = drawn.value[2] * light.b;
    path->cost->collisions++;
    return true;
}

/* Sample the first collision on the view's ray; false: there is none. */
static bool enter_volume(struct path *path, const struct neph_view *view,
                         const struct neph_flight *flight, struct neph_collision *collision)
{
    if (flight && flight->own.is_known)
        return enter_medium_volume(path, &flight->own, collision);
    if (flight && flight->lit.is_known)
        return enter_lit_volume(path, flight, collision);
    if (flight && flight->guess.lit.is_known)
        return enter_guessed_volume(path, &flight->guess, collision);
    if (flight && !flight->is_table)
        flight = NULL;
    const struct neph_ray ray = {path->at_m, path->direction, view->hit.t_m};
    *collision = flight ? neph_flight_collide(flight, path->channel, path->random)
                        : neph_tracker_collide(path->tracker, &ray, path->channel, path->random,
                                               path->cost);
    if (collision->medium < 0)
        return false; /* unscattered light is computed exactly */
    if (!neph_tracker_is_grey(path->tracker))
        weigh(path, collision->ratio);
    path->cost->collisions += flight != NULL;
    for (int j = 0; flight && j < 3; j++)
        path->value[j] *= flight->chance[j];
    return true;
}

/* Whether the only light of the media is singly scattered light of point lights, which segments
 * sample. */
static bool needs_no_collision(const struct neph_scene *scene)
{
    return scene->light_count > 0 && scene->scattering == NEPH_SCATTERING_SINGLE &&
           !scene->sun.present && !scene->environment_light && !neph_scene_emits(scene);
}

static void trace_volume(struct path *path, const struct neph_view *view,
                         const struct neph_flight *flight, struct neph_path_light *light)
{
    struct neph_collision collision;
    if (path->scene->scattering != NEPH_SCATTERING_NONE)
        light->order1 = light->volume = sample_segment_light(path, view->hit.t_m);
    if (needs_no_collision(path->scene) || !enter_volume(path, view, flight, &collision))
        return;
    struct neph_rgb order1 = black;
    reach_medium(path, &collision, &light->volume);
    if (path->scene->scattering == NEPH_SCATTERING_NONE ||
        !leave_medium(path, collision.medium, &order1))
        return;
    if (path->scene->scattering == NEPH_SCATTERING_MULTIPLE)
        follow(path, &order1, &light->volume);
    else
        add(&order1, sample_environment(path));
    add(&light->order1, order1);
    add(&light->volume, order1);
}

/* Trace from the visible surface, lit by everything but direct light of sun and lights. */
static void trace_surface(struct path *path, const struct neph_view *view,
                          struct neph_path_light *light)
{
    if (!reflect(path, view->transmittance) || !reach_surface(path, &view->hit) ||
        !leave_surface(path, &view->hit))
        return;
    if (path->scene->scattering == NEPH_SCATTERING_MULTIPLE)
        follow(path, &light->surface, &light->surface);
    else
        add(&light->surface, sample_environment(path));
}

bool neph_path_has_volume(const struct neph_scene *scene)
{
    return scene->scattering != NEPH_SCATTERING_NONE || neph_scene_emits(scene);
}

struct neph_path_light neph_path_trace(const struct neph_scene *scene,
                                       const struct neph_tracker *tracker,
                                       const struct neph_view *view,
                                       const struct neph_flight *flight, struct neph_random *random,
                                       struct neph_tracking_cost *cost)
{
    struct neph_path_light light = {black, black, black};
    if (neph_path_has_volume(scene) && scene->medium_count > 0) {
        struct path path = path_start(scene, tracker, view, random, cost);
        trace_volume(&path, view, flight, &light);
    }
    const bool lit = scene->environment_light || scene->scattering == NEPH_SCATTERING_MULTIPLE;
    if (view->hit.solid && lit) {
        struct path path = path_start(scene, tracker, view, random, cost);
        trace_surface(&path, view, &light);
    }
    return light;
}

static struct neph_vec3 seen_point_m(const struct neph_view *view)
{
    return neph_vec3_along(view->origin_m, view->direction, view->hit.t_m);
}

static struct neph_rgb seen_color(const struct neph_view *view)
{
    return neph_surface_color(&view->hit, seen_point_m(view));
}

/* Lambertian, lit by the sun through the media: albedo / pi * E cos(theta) T V. */
static struct neph_rgb sunlit_surface(const struct neph_scene *scene, const struct neph_view *view)
{
    const double cosine = neph_hit_cosine(&view->hit, scene->sun.direction);
    if (!scene->sun.present || cosine <= 0.0)
        return black;
    const struct neph_vec3 point_m = neph_hit_outside_m(&view->hit, seen_point_m(view));
    if (!neph_scene_is_sun_visible(scene, point_m))
        return black;
    const struct neph_rgb depth = neph_scene_optical_depth(scene, point_m, scene->sun.direction,
                                                           0.0, INFINITY);
    const struct neph_rgb light = {exp(-depth.r), exp(-depth.g), exp(-depth.b)};
    return neph_rgb_scale(
        neph_rgb_mul(neph_rgb_mul(seen_color(view), scene->sun.irradiance_w_per_m2), light),
        cosine / M_PI);
}

/* Light of point lights that a surface reflects. */
static struct neph_rgb compute_surface_lights(const struct neph_scene *scene,
                                              const struct neph_view *view)
{
    if (scene->light_count == 0)
        return black;
    const struct neph_vec3 point_m = neph_hit_outside_m(&view->hit, seen_point_m(view));
    return neph_rgb_mul(seen_color(view), neph_reflect_lights(scene, point_m, &view->hit));
}

struct neph_view neph_view_create(const struct neph_scene *scene, struct neph_vec3 origin_m,
                                  struct neph_vec3 direction)
{
    struct neph_view view = {.origin_m = origin_m,
                             .direction = direction,
                             .hit = neph_scene_hit(scene, origin_m, direction)};
    const struct neph_rgb depth = neph_scene_optical_depth(scene, origin_m, direction, 0.0,
                                                           view.hit.t_m);
    view.transmittance = (struct neph_rgb){exp(-depth.r), exp(-depth.g), exp(-depth.b)};
    const struct neph_rgb behind = view.hit.solid
                                       ? neph_rgb_add(sunlit_surface(scene, &view),
                                                      compute_surface_lights(scene, &view))
                                       : scene->background_w_per_m2_sr;
    view.unscattered = neph_rgb_mul(behind, view.transmittance);
    return view;
}
