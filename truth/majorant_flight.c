/* SPDX-License-Identifier: MIT */
#include "truth/majorant_flight.h"

#include "scenes/media.h"
#include "scenes/medium_bounds.h"

#include <math.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_SCATTERING_COUNT == 3, "a new kind");

/* The share of the samples that is divided equally among the media: no medium is missed because a
 * table is wrong, or because its light is in one channel only. */
static const double even_share = 0.5;

/* If a medium has no closed form, free flights, which use its true density, are better than guesses
 * if at least this part of them, weighted by brightness, collides: of 256, the usual number, none
 * collides once in e^8 pixels. */
static const double flights_suffice = 1.0 / 32.0;

/* Accuracy of a collision's place, relative to a medium's optical depth. */
static const double placement = 1e-12;

/* Tables are evaluated just before the far end, which may be infinitely far. */
static const double before_end = 1.0 - 1e-9;

static double channel_mean(struct neph_rgb color)
{
    return (color.r + color.g + color.b) / 3.0;
}

static const struct neph_medium *part_medium(const struct neph_medium_flight *flight,
                                             const struct neph_medium_flight_part *part)
{
    return &flight->scene->media[part->medium];
}

static struct neph_vec3 point_m(const struct neph_medium_flight *flight, double t_m)
{
    return neph_vec3_along(flight->ray.origin_m, flight->ray.direction, t_m);
}

/* Extinction of the medium, mean of the channels. */
static double extinction_per_m(const struct neph_medium_flight *flight,
                               const struct neph_medium_flight_part *part, double t_m)
{
    const struct neph_medium *medium = part_medium(flight, part);
    return channel_mean(medium->extinction_color) *
           neph_medium_extinction_per_m(medium, point_m(flight, t_m));
}

/* ---- from optical depths of one medium to distances ------------------------------------------ */

/* The optical depth s up to a distance, for a medium with a closed form. */
static double depth_at(const struct neph_medium_flight *flight,
                       const struct neph_medium_flight_part *part, double t_m)
{
    const struct neph_medium *medium = part_medium(flight, part);
    return channel_mean(medium->extinction_color) *
           neph_medium_optical_depth(medium, flight->ray.origin_m, flight->ray.direction, 0.0, t_m);
}

/* A distance beyond `low_m` at which s has reached the target. */
static double finite_end_m(const struct neph_medium_flight *flight,
                           const struct neph_medium_flight_part *part, double low_m, double target)
{
    double step_m = 1.0;
    while (step_m < 1e300 && depth_at(flight, part, low_m + step_m) < target)
        step_m *= 2.0;
    return low_m + step_m;
}

/* The distance at which s reaches the target: Newton's method, with bisection when it leaves the
 * bracket. */
static double solve_m(const struct neph_medium_flight *flight,
                      const struct neph_medium_flight_part *part, double low_m, double high_m,
                      double target)
{
    const double close = placement * fmin(target, 1.0);
    if (isinf(high_m))
        high_m = finite_end_m(flight, part, low_m, target);
    double t_m = 0.5 * (low_m + high_m);
    for (int i = 0; i < 100 && high_m - low_m > 1e-15 * high_m; i++) {
        const double excess = depth_at(flight, part, t_m) - target;
        if (fabs(excess) <= close)
            break;
        if (excess > 0.0)
            high_m = t_m;
        else
            low_m = t_m;
        t_m -= excess / extinction_per_m(flight, part, t_m);
        if (!(t_m > low_m && t_m < high_m))
            t_m = 0.5 * (low_m + high_m);
    }
    return t_m;
}

/* The position of a guessed s, in segments. */
static double guessed_place(const struct neph_medium_flight_part *part, double s)
{
    int i = 0;
    while (i + 1 < NEPH_GUESS_STRETCHES && part->depth[i + 1] <= s)
        i++;
    return i + fmin((s - part->depth[i]) / (part->depth[i + 1] - part->depth[i]), 1.0);
}

static double stretch_m(const struct neph_medium_flight_part *part)
{
    return (part->t1_m - part->t0_m) / NEPH_GUESS_STRETCHES;
}

/* The index of the last edge at or before s, except the very last edge. */
static int find_cell(const struct neph_medium_flight_part *part, double s)
{
    int i = 0;
    while (i + 1 < NEPH_LIT_CELLS && part->lit.s[i + 1] <= s)
        i++;
    return i;
}

static double place_m(const struct neph_medium_flight *flight,
                      const struct neph_medium_flight_part *part, double s)
{
    if (!neph_medium_has_closed_form(part_medium(flight, part)))
        return part->t0_m + guessed_place(part, s) * stretch_m(part);
    const int cell = find_cell(part, s);
    const bool is_inside = s < part->lit.s[NEPH_LIT_CELLS];
    return is_inside ? solve_m(flight, part, part->edge_t_m[cell], part->edge_t_m[cell + 1], s)
                     : solve_m(flight, part, part->edge_t_m[NEPH_LIT_CELLS], part->t1_m, s);
}

/* ---- the tables ---- */

/* Guess the depths; none is 0, as in truth/guess.c. */
static void guess_depths(const struct neph_medium_flight *flight,
                         struct neph_medium_flight_part *part)
{
    double own[NEPH_GUESS_STRETCHES], shared[NEPH_GUESS_STRETCHES], sum = 0.0;
    const double length_m = stretch_m(part);
    for (int i = 0; i < NEPH_GUESS_STRETCHES; i++) {
        own[i] = length_m * extinction_per_m(flight, part, part->t0_m + (i + 0.5) * length_m);
        sum += own[i];
    }
    for (int i = 0; i < NEPH_GUESS_STRETCHES; i++) { /* the medium may begin or end anywhere in a
                                                      * segment */
        const double before = i > 0 ? own[i - 1] : 0.0;
        const double behind = i + 1 < NEPH_GUESS_STRETCHES ? own[i + 1] : 0.0;
        shared[i] = 0.5 * own[i] + 0.25 * (before + behind);
    }
    const double least = sum > 0.0 ? 0.05 * sum / NEPH_GUESS_STRETCHES : 1e-6;
    part->depth[0] = 0.0;
    for (int i = 0; i < NEPH_GUESS_STRETCHES; i++)
        part->depth[i + 1] = part->depth[i] + fmax(shared[i], least);
    for (int i = 0; i <= NEPH_LIT_CELLS; i++) {
        part->lit.s[i] = part->depth[i * NEPH_GUESS_STRETCHES / NEPH_LIT_CELLS];
        part->edge_t_m[i] = part->t0_m + (part->t1_m - part->t0_m) * i / NEPH_LIT_CELLS;
    }
    part->lit.end = part->lit.s[NEPH_LIT_CELLS];
}

/* Set the edges; false: the ray misses the medium. */
static bool find_edges(const struct neph_medium_flight *flight,
                       struct neph_medium_flight_part *part)
{
    const double end = depth_at(flight, part, part->t1_m);
    if (!(end > 0.0))
        return false;
    neph_lit_flight_edges(&part->lit, end);
    double low_m = part->t0_m;
    for (int i = 0; i <= NEPH_LIT_CELLS; i++) {
        if (i > 0)
            low_m = solve_m(flight, part, low_m, part->t1_m,
                            fmin(part->lit.s[i], end * before_end));
        part->edge_t_m[i] = low_m;
    }
    return true;
}

/* The logarithm of sun e^-depth + ambient; computed in logarithms, for depths beyond the range of
 * e^x. */
static double log_sent(double sun, double ambient, double sun_depth)
{
    if (!(ambient > 0.0))
        return log(sun) - sun_depth;
    return log(ambient + sun * exp(-sun_depth));
}

/* The logarithm of the light that arrives from an edge, all channels together. */
static double log_light_at(const struct neph_medium_flight *flight,
                           const struct neph_source *source, struct neph_medium_flight_part *part,
                           int edge)
{
    const struct neph_scene *scene = flight->scene;
    const struct neph_vec3 at_m = point_m(flight, part->edge_t_m[edge]);
    const struct neph_rgb view = neph_guess_depth(scene, flight->ray.origin_m,
                                                  flight->ray.direction, part->edge_t_m[edge]);
    struct neph_rgb sun = {0, 0, 0};
    if (scene->sun.present)
        sun = neph_guess_depth(scene, at_m, scene->sun.direction, INFINITY);
    part->view_depth[edge] = channel_mean(view);
    part->sun_depth[edge] = channel_mean(sun);
    const struct neph_rgb color = part_medium(flight, part)->extinction_color;
    const double log_light[3] = {
        log(color.r) + log_sent(source->sun.r, source->ambient.r, sun.r) - view.r,
        log(color.g) + log_sent(source->sun.g, source->ambient.g, sun.g) - view.g,
        log(color.b) + log_sent(source->sun.b, source->ambient.b, sun.b) - view.b};
    const double most = fmax(log_light[0], fmax(log_light[1], log_light[2]));
    if (!(most > -INFINITY))
        return -INFINITY;
    double sum = 0.0;
    for (int j = 0; j < 3; j++)
        sum += exp(log_light[j] - most);
    return most + log(sum);
}

static bool is_black(struct neph_rgb light)
{
    return light.r == 0.0 && light.g == 0.0 && light.b == 0.0;
}

/* Set up a medium; false: no light of it arrives on the ray. */
static bool init_part(const struct neph_medium_flight *flight, struct neph_medium_flight_part *part,
                      int m)
{
    const struct neph_medium *medium = &flight->scene->media[m];
    const struct neph_source source = neph_medium_source(flight->scene, medium);
    const struct neph_bounds support = neph_medium_support(medium);
    part->medium = m;
    part->t0_m = 0.0;
    part->t1_m = flight->ray.end_m;
    if (is_black(neph_rgb_add(source.sun, source.ambient)) ||
        !neph_bounds_clip(&support, flight->ray.origin_m, flight->ray.direction, &part->t0_m,
                          &part->t1_m) ||
        !neph_medium_clip(medium, flight->ray.origin_m, flight->ray.direction, &part->t0_m,
                          &part->t1_m))
        return false;
    if (!neph_medium_has_closed_form(medium))
        guess_depths(flight, part);
    else if (!find_edges(flight, part))
        return false;
    for (int i = 0; i <= NEPH_LIT_CELLS; i++)
        part->lit.log_light[i] = log_light_at(flight, &source, part, i);
    neph_lit_flight_complete(&part->lit, !is_black(source.ambient));
    return true;
}

static void share_out(struct neph_medium_flight *flight)
{
    double most = -INFINITY, sum = 0.0;
    for (int p = 0; p < flight->count; p++)
        most = fmax(most, flight->parts[p].lit.log_whole);
    for (int p = 0; p < flight->count; p++)
        sum += exp(flight->parts[p].lit.log_whole - most);
    for (int p = 0; p < flight->count; p++) {
        const double even = 1.0 / flight->count;
        const double lit = most > -INFINITY ? exp(flight->parts[p].lit.log_whole - most) / sum
                                            : even;
        flight->parts[p].chance = even_share * even + (1.0 - even_share) * lit;
    }
}

/* ---- free flights ---- */

/* The probability that a free flight collides with the medium, mean of the channels. */
static double compute_collision_chance(const struct neph_medium_flight_part *part)
{
    double sum = 0.0;
    for (int i = 0; i < NEPH_LIT_CELLS; i++) {
        const double a = part->view_depth[i], b = part->view_depth[i + 1];
        if (isfinite(a))
            sum += (part->lit.s[i + 1] - part->lit.s[i]) * exp(-a) * neph_phi(fmax(b - a, 0.0));
    }
    return sum;
}

static double brightness(const struct neph_medium_flight *flight,
                         const struct neph_medium_flight_part *part, int channel)
{
    const struct neph_source source = neph_medium_source(flight->scene, part_medium(flight, part));
    const struct neph_rgb all = neph_rgb_add(source.sun, source.ambient);
    return channel == 0 ? all.r : channel == 1 ? all.g : all.b;
}

/* Whether free flights collide with bright media often enough, in all channels with light. */
static bool do_flights_suffice(const struct neph_medium_flight *flight)
{
    for (int j = 0; j < 3; j++) {
        double most = 0.0, met = 0.0;
        for (int p = 0; p < flight->count; p++) {
            const double bright = brightness(flight, &flight->parts[p], j);
            most = fmax(most, bright);
            met += bright * compute_collision_chance(&flight->parts[p]);
        }
        if (met < flights_suffice * most)
            return false;
    }
    return true;
}

/* Whether guesses are possible: media without closed forms are bounded on the ray. */
static bool is_possible(const struct neph_medium_flight *flight)
{
    for (int m = 0; m < flight->scene->medium_count; m++) {
        const struct neph_medium *medium = &flight->scene->media[m];
        const struct neph_bounds support = neph_medium_support(medium);
        double t0_m = 0.0, t1_m = flight->ray.end_m;
        if (!neph_medium_has_closed_form(medium) &&
            neph_bounds_clip(&support, flight->ray.origin_m, flight->ray.direction, &t0_m, &t1_m) &&
            isinf(t1_m))
            return false;
    }
    return true;
}

void neph_medium_flight_init(struct neph_medium_flight *flight, const struct neph_scene *scene,
                             const struct neph_ray *ray)
{
    flight->scene = scene;
    flight->ray = *ray;
    flight->count = 0;
    flight->is_exact = true;
    flight->is_known = neph_scene_sources_differ(scene) && is_possible(flight);
    if (!flight->is_known)
        return;
    for (int m = 0; m < scene->medium_count; m++) {
        flight->is_exact = flight->is_exact && neph_medium_has_closed_form(&scene->media[m]);
        flight->count += init_part(flight, &flight->parts[flight->count], m);
    }
    share_out(flight);
    flight->is_known = flight->is_exact || !do_flights_suffice(flight);
}

/* ---- sampling -------------------------------------------------------------------------------- */

static const struct neph_medium_flight_part *pick_part(const struct neph_medium_flight *flight,
                                                       struct neph_random *random)
{
    double left = neph_random_uniform(random);
    int p = 0;
    while (p + 1 < flight->count && left >= flight->parts[p].chance)
        left -= flight->parts[p++].chance;
    return &flight->parts[p];
}

static double between_edges(const double at_edges[NEPH_LIT_CELLS + 1],
                            const struct neph_medium_flight_part *part, double s)
{
    const int i = find_cell(part, s);
    const double width = part->lit.s[i + 1] - part->lit.s[i];
    const double x = fmin((s - part->lit.s[i]) / width, 1.0);
    return at_edges[i] * (1.0 - x) + at_edges[i + 1] * x;
}

/* True extinction of the medium over its guessed extinction; 1 if s is exact. */
static double true_over_guessed(const struct neph_medium_flight *flight,
                                const struct neph_medium_flight_part *part, double s, double t_m)
{
    if (neph_medium_has_closed_form(part_medium(flight, part)))
        return 1.0;
    const int i = (int)fmin(guessed_place(part, s), NEPH_GUESS_STRETCHES - 1);
    const double guessed_per_m = (part->depth[i + 1] - part->depth[i]) / stretch_m(part);
    return extinction_per_m(flight, part, t_m) / guessed_per_m;
}

struct neph_guess_result neph_medium_flight_sample(const struct neph_medium_flight *flight,
                                                   struct neph_random *random)
{
    struct neph_guess_result drawn = {.collision = {flight->ray.end_m, -1, {1.0, 1.0, 1.0}}};
    if (flight->count == 0)
        return drawn;
    const struct neph_medium_flight_part *part = pick_part(flight, random);
    const double s = neph_lit_flight_sample(&part->lit, random);
    const double t_m = place_m(flight, part, s);
    const double weight = true_over_guessed(flight, part, s, t_m) /
                          (neph_lit_flight_density(&part->lit, s) * part->chance);
    if (!(weight > 0.0))
        return drawn;
    const struct neph_rgb color = part_medium(flight, part)->extinction_color;
    struct neph_rgb way = {0, 0, 0};
    if (flight->is_exact)
        way = neph_scene_optical_depth(flight->scene, flight->ray.origin_m, flight->ray.direction,
                                       0.0, t_m);
    drawn.collision.t_m = t_m;
    drawn.collision.medium = part->medium;
    drawn.view_depth = between_edges(part->view_depth, part, s);
    drawn.sun_depth = between_edges(part->sun_depth, part, s);
    drawn.value[0] = color.r / channel_mean(color) * weight * exp(-way.r);
    drawn.value[1] = color.g / channel_mean(color) * weight * exp(-way.g);
    drawn.value[2] = color.b / channel_mean(color) * weight * exp(-way.b);
    return drawn;
}
