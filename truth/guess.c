/* SPDX-License-Identifier: MIT */
#include "truth/guess.h"

#include "scenes/emission.h"
#include "scenes/media.h"

#include <math.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_SCATTERING_COUNT == 3, "a new kind");

/* Points per segment through a medium. */
enum { WAY_PLACES = 12 };

/* Limit of the light of free flights: mean square over squared mean. */
static const double spread_max = 4.0;

static double channel_mean(struct neph_rgb color)
{
    return (color.r + color.g + color.b) / 3.0;
}

/* Extinction of a medium, mean of the channels. */
static double extinction_per_m(const struct neph_medium *medium, struct neph_vec3 at_m)
{
    return channel_mean(medium->extinction_color) * neph_medium_extinction_per_m(medium, at_m);
}

static double total_per_m(const struct neph_scene *scene, struct neph_vec3 at_m)
{
    double sum_per_m = 0.0;
    for (int m = 0; m < scene->medium_count; m++)
        sum_per_m += extinction_per_m(&scene->media[m], at_m);
    return sum_per_m;
}

/* The hull of all media on the ray; false: there is none, or it is unbounded. */
static bool find_hull(const struct neph_scene *scene, const struct neph_ray *ray, double *low_m,
                      double *high_m)
{
    *low_m = INFINITY;
    *high_m = -INFINITY;
    for (int m = 0; m < scene->medium_count; m++) {
        const struct neph_bounds support = neph_medium_support(&scene->media[m]);
        double t0_m = 0.0, t1_m = ray->end_m;
        if (neph_bounds_clip(&support, ray->origin_m, ray->direction, &t0_m, &t1_m)) {
            *low_m = fmin(*low_m, t0_m);
            *high_m = fmax(*high_m, t1_m);
        }
    }
    return *low_m < *high_m && isfinite(*high_m);
}

/* The optical depth of one medium, as if its extinction color were 1. */
static double guess_own_depth(const struct neph_medium *medium, struct neph_vec3 origin_m,
                              struct neph_vec3 direction, double length_m)
{
    const struct neph_bounds support = neph_medium_support(medium);
    double t0_m = 0.0, t1_m = length_m, sum = 0.0;
    if (neph_medium_has_closed_form(medium))
        return neph_medium_optical_depth(medium, origin_m, direction, 0.0, length_m);
    if (!neph_bounds_clip(&support, origin_m, direction, &t0_m, &t1_m))
        return 0.0;
    const double step_m = (t1_m - t0_m) / WAY_PLACES;
    for (int i = 0; i < WAY_PLACES; i++)
        sum += step_m *
               neph_medium_extinction_per_m(
                   medium, neph_vec3_along(origin_m, direction, t0_m + (i + 0.5) * step_m));
    return sum;
}

struct neph_rgb neph_guess_depth(const struct neph_scene *scene, struct neph_vec3 origin_m,
                                 struct neph_vec3 direction, double length_m)
{
    struct neph_rgb sum = {0, 0, 0};
    for (int m = 0; m < scene->medium_count; m++) {
        const struct neph_medium *medium = &scene->media[m];
        const double own = guess_own_depth(medium, origin_m, direction, length_m);
        sum = neph_rgb_add(sum, neph_rgb_attenuation(medium->extinction_color, own));
    }
    return sum;
}

/* Guessed optical depth to the sun, mean of the channels. */
static double sun_depth(const struct neph_scene *scene, struct neph_vec3 at_m)
{
    double sum = 0.0;
    for (int m = 0; m < scene->medium_count; m++)
        sum += channel_mean(scene->media[m].extinction_color) *
               guess_own_depth(&scene->media[m], at_m, scene->sun.direction, INFINITY);
    return sum;
}

static struct neph_vec3 place_m(const struct neph_guess *guess, double stretches)
{
    return neph_vec3_along(guess->ray.origin_m, guess->ray.direction,
                           guess->t0_m + stretches * guess->stretch_m);
}

/* Guess the depths. They are never 0: the points may have missed some medium, so a little is
 * assumed everywhere. */
static void guess_depths(struct neph_guess *guess, const struct neph_scene *scene)
{
    double own[NEPH_GUESS_STRETCHES], sum = 0.0;
    for (int i = 0; i < NEPH_GUESS_STRETCHES; i++) {
        own[i] = guess->stretch_m * total_per_m(scene, place_m(guess, i + 0.5));
        sum += own[i];
    }
    const double least = sum > 0.0 ? 0.05 * sum / NEPH_GUESS_STRETCHES : 1e-6;
    guess->depth[0] = 0.0;
    for (int i = 0; i < NEPH_GUESS_STRETCHES; i++)
        guess->depth[i + 1] = guess->depth[i] + fmax(own[i], least);
    for (int i = 0; i <= NEPH_LIT_CELLS; i++)
        guess->lit.s[i] = guess->depth[i * NEPH_GUESS_PLACES];
    guess->lit.end = guess->lit.s[NEPH_LIT_CELLS];
}

/* The ratio for spread_max, by the trapezoidal rule. */
static double compute_free_flight_spread(const struct neph_guess *guess)
{
    const struct neph_lit_flight *lit = &guess->lit;
    double mean = 0.0, square = 0.0;
    for (int i = 0; i < NEPH_LIT_CELLS; i++)
        for (int k = i; k <= i + 1; k++) {
            const double light = 0.5 * (lit->s[i + 1] - lit->s[i]) *
                                 exp(-lit->s[k] - guess->sun_depth[k]);
            mean += light;
            square += light * exp(-guess->sun_depth[k]);
        }
    return mean > 0.0 ? square * -expm1(-lit->end) / (mean * mean) : INFINITY;
}

void neph_guess_init(struct neph_guess *guess, const struct neph_scene *scene,
                     const struct neph_ray *ray)
{
    double end_m;
    guess->ray = *ray;
    guess->lit.is_known = false;
    if (scene->scattering != NEPH_SCATTERING_SINGLE || !scene->sun.present ||
        !find_hull(scene, ray, &guess->t0_m, &end_m))
        return;
    guess->stretch_m = (end_m - guess->t0_m) / NEPH_GUESS_STRETCHES;
    guess_depths(guess, scene);
    for (int i = 0; i <= NEPH_LIT_CELLS; i++) {
        guess->sun_depth[i] = sun_depth(scene, place_m(guess, i * NEPH_GUESS_PLACES));
        guess->lit.log_light[i] = -guess->lit.s[i] - guess->sun_depth[i];
    }
    if (compute_free_flight_spread(guess) > spread_max)
        neph_lit_flight_complete(&guess->lit, scene->environment_light || neph_scene_emits(scene));
}

/* Choose a medium by its share of the extinction; -1: there is none. */
static int pick_medium(const struct neph_scene *scene, struct neph_vec3 at_m, double total,
                       struct neph_random *random)
{
    double left = neph_random_uniform(random) * total;
    int last = -1;
    for (int m = 0; m < scene->medium_count; m++) {
        const double own = extinction_per_m(&scene->media[m], at_m);
        if (own <= 0.0)
            continue;
        last = m;
        left -= own;
        if (left < 0.0)
            break;
    }
    return last;
}

struct neph_guess_result neph_guess_sample(const struct neph_guess *guess,
                                           const struct neph_scene *scene,
                                           struct neph_random *random)
{
    const struct neph_lit_flight *lit = &guess->lit;
    const double s = neph_lit_flight_sample(lit, random);
    int i = 0;
    while (i + 1 < NEPH_GUESS_STRETCHES && guess->depth[i + 1] <= s)
        i++;
    const double own = guess->depth[i + 1] - guess->depth[i];
    const double stretches = i + (s - guess->depth[i]) / own;
    const double t_m = guess->t0_m + stretches * guess->stretch_m;
    const struct neph_vec3 at_m = place_m(guess, stretches);
    const double cells = stretches / NEPH_GUESS_PLACES;
    const int cell = (int)fmin(cells, NEPH_LIT_CELLS - 1);
    const double within = cells - cell;
    const double total = total_per_m(scene, at_m);
    struct neph_guess_result guessed = {
        .collision = {t_m, pick_medium(scene, at_m, total, random), {1.0, 1.0, 1.0}},
        .view_depth = s,
        .sun_depth = guess->sun_depth[cell] * (1.0 - within) + guess->sun_depth[cell + 1] * within,
    };
    if (guessed.collision.medium < 0)
        return guessed;
    const double density_per_m = neph_lit_flight_density(lit, s) * own / guess->stretch_m;
    const struct neph_rgb color = scene->media[guessed.collision.medium].extinction_color;
    const double value[3] = {color.r, color.g, color.b};
    for (int j = 0; j < 3; j++)
        guessed.value[j] = value[j] / channel_mean(color) * total / density_per_m;
    return guessed;
}
