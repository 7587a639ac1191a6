/* SPDX-License-Identifier: MIT */
#include "truth/flight.h"

#include "scenes/emission.h"
#include "scenes/media.h"
#include "scenes/medium_bounds.h"

#include <math.h>
#include <string.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_SCATTERING_COUNT == 3, "a new kind");

/* Optical depths at which a fog layer gets a table edge. */
static const double ladder[NEPH_FLIGHT_LADDER] = {0.05, 0.1, 0.2, 0.4, 0.8, 1.6, 3.0, 6.0, 12.0};

/* Accuracy of a collision's place, relative to an interval's optical depth. */
static const double placement = 1e-12;

/* Whether all media have closed forms, which a table needs. */
static bool is_possible(const struct neph_scene *scene)
{
    for (int m = 0; m < scene->medium_count; m++)
        if (!neph_medium_has_closed_form(&scene->media[m]))
            return false;
    return true;
}

/* ---- the table ---- */

/* Insert an edge inside the ray, in ascending order. */
static void add_edge(struct neph_flight *flight, double t_m)
{
    if (!(t_m > 0.0 && t_m < flight->ray.end_m))
        return;
    int at = flight->count;
    while (at > 0 && flight->t_m[at - 1] >= t_m)
        at--;
    if (at < flight->count && flight->t_m[at] == t_m)
        return;
    memmove(&flight->t_m[at + 1], &flight->t_m[at],
            (size_t)(flight->count - at) * sizeof(flight->t_m[0]));
    flight->t_m[at] = t_m;
    flight->count++;
}

static void add_medium_edges(struct neph_flight *flight, const struct neph_medium *medium)
{
    const struct neph_bounds support = neph_medium_support(medium);
    const struct neph_ray *ray = &flight->ray;
    double t0_m = 0.0, t1_m = ray->end_m;
    if (!neph_bounds_clip(&support, ray->origin_m, ray->direction, &t0_m, &t1_m) ||
        !neph_medium_clip(medium, ray->origin_m, ray->direction, &t0_m, &t1_m))
        return;
    add_edge(flight, t0_m);
    add_edge(flight, t1_m);
    if (neph_medium_facts(medium->kind)->is_even)
        return; /* interpolation is exact */
    if (isfinite(t1_m))
        for (int i = 1; i <= NEPH_FLIGHT_INNER_EDGES; i++)
            add_edge(flight, t0_m + (t1_m - t0_m) * i / (NEPH_FLIGHT_INNER_EDGES + 1));
    const double y_m = ray->origin_m.y + t0_m * ray->direction.y;
    for (int l = 0; l < medium->layer_count; l++)
        for (int i = 0; i < NEPH_FLIGHT_LADDER; i++)
            add_edge(flight, t0_m + neph_fog_layer_distance_m(&medium->layers[l], y_m,
                                                              ray->direction.y, ladder[i]));
}

static struct neph_rgb depth_between(const struct neph_flight *flight, double t0_m, double t1_m)
{
    return neph_scene_optical_depth(flight->scene, flight->ray.origin_m, flight->ray.direction,
                                    t0_m, t1_m);
}

/* ---- looking up ---- */

static double read_channel(struct neph_rgb rgb, int channel)
{
    if (channel == NEPH_FLIGHT_MEAN)
        return (rgb.r + rgb.g + rgb.b) / 3.0;
    return channel == 0 ? rgb.r : channel == 1 ? rgb.g : rgb.b;
}

/* Extinction of one medium in one channel. */
static double extinction_per_m(const struct neph_flight *flight, int medium, int channel,
                               double t_m)
{
    const struct neph_medium *m = &flight->scene->media[medium];
    return read_channel(m->extinction_color, channel) *
           neph_medium_extinction_per_m(
               m, neph_vec3_along(flight->ray.origin_m, flight->ray.direction, t_m));
}

static double extinction_sum_per_m(const struct neph_flight *flight, int channel, double t_m)
{
    double sum = 0.0;
    for (int m = 0; m < flight->scene->medium_count; m++)
        sum += extinction_per_m(flight, m, channel, t_m);
    return sum;
}

/* The index of the last edge before a depth. */
static int find_interval(const double *depth, int count, double target)
{
    int low = 0, high = count - 1;
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        if (depth[middle] <= target)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/* A finite distance beyond t0 at which the depth from t0 has reached the target. */
static double finite_end_m(const struct neph_flight *flight, int channel, double t0_m,
                           double target)
{
    double step_m = target / extinction_sum_per_m(flight, channel, t0_m);
    if (!(step_m > 0.0 && step_m < 1e300))
        step_m = 1.0;
    while (step_m < 1e300 &&
           read_channel(depth_between(flight, t0_m, t0_m + step_m), channel) < target)
        step_m *= 2.0;
    return t0_m + step_m;
}

/* The distance at which the depth from t0 reaches the target, in an interval of depth `whole`:
 * Newton's method, with bisection when it leaves the bracket. */
static double place_m(const struct neph_flight *flight, int channel, double t0_m, double t1_m,
                      double target, double whole)
{
    double low_m = t0_m;
    double high_m = isinf(t1_m) ? finite_end_m(flight, channel, t0_m, target) : t1_m;
    double t_m = isinf(t1_m) ? 0.5 * (low_m + high_m) : t0_m + (t1_m - t0_m) * (target / whole);
    for (int i = 0; i < 100; i++) {
        const double excess = read_channel(depth_between(flight, t0_m, t_m), channel) - target;
        if (fabs(excess) <= placement * fmin(whole, 1.0) || high_m - low_m <= 1e-15 * high_m)
            break;
        if (excess > 0.0)
            high_m = t_m;
        else
            low_m = t_m;
        t_m -= excess / extinction_sum_per_m(flight, channel, t_m);
        if (!(t_m > low_m && t_m < high_m))
            t_m = 0.5 * (low_m + high_m);
    }
    return t_m;
}

/* The distance at which the depth from the camera reaches `target`, in interval i. */
static double interval_place_m(const struct neph_flight *flight, int channel, int i, double target)
{
    const double *depth = flight->depth[channel];
    return place_m(flight, channel, flight->t_m[i], flight->t_m[i + 1], target - depth[i],
                   depth[i + 1] - depth[i]);
}

/* Choose the colliding medium by its share of the extinction. */
static int pick_medium(const struct neph_flight *flight, int channel, double t_m,
                       struct neph_random *random)
{
    const int count = flight->scene->medium_count;
    if (count == 1)
        return 0;
    double left = neph_random_uniform(random) * extinction_sum_per_m(flight, channel, t_m);
    int last = 0;
    for (int m = 0; m < count; m++) {
        const double own = extinction_per_m(flight, m, channel, t_m);
        if (own <= 0.0)
            continue;
        last = m;
        left -= own;
        if (left < 0.0)
            break;
    }
    return last;
}

/* ---- sunlight along the ray ---- */

/* The share of light in a channel, whatever the depth: it only distributes samples. */
static double channel_part(const struct neph_flight *flight, int channel)
{
    const double own = flight->depth[channel][flight->count - 1];
    const double mean = flight->depth[NEPH_FLIGHT_MEAN][flight->count - 1];
    const double depth_part = isinf(mean) ? (double)isinf(own) : own / mean;
    return depth_part * read_channel(flight->scene->sun.irradiance_w_per_m2, channel);
}

/* The logarithm of the sunlight that is scattered at a depth and reaches the camera, without
 * solids. */
static double log_light_at(const struct neph_flight *flight, double target)
{
    const int i = find_interval(flight->depth[NEPH_FLIGHT_MEAN], flight->count, target);
    const double t_m = interval_place_m(flight, NEPH_FLIGHT_MEAN, i, target);
    const struct neph_vec3 at_m = neph_vec3_along(flight->ray.origin_m, flight->ray.direction, t_m);
    const struct neph_rgb way = neph_rgb_add(
        depth_between(flight, flight->t_m[i], t_m),
        neph_scene_optical_depth(flight->scene, at_m, flight->scene->sun.direction, 0.0, INFINITY));
    double log_light[3], most = -INFINITY, sum = 0.0;
    for (int j = 0; j < 3; j++) {
        log_light[j] = log(channel_part(flight, j)) - flight->depth[j][i] - read_channel(way, j);
        most = fmax(most, log_light[j]);
    }
    for (int j = 0; j < 3; j++)
        sum += exp(log_light[j] - most);
    return most > -INFINITY ? most + log(sum) : -INFINITY;
}

static void init_lit(struct neph_flight *flight)
{
    const struct neph_scene *scene = flight->scene;
    const double end = flight->depth[NEPH_FLIGHT_MEAN][flight->count - 1];
    if (scene->scattering != NEPH_SCATTERING_SINGLE || !scene->sun.present || !(end > 0.0))
        return;
    neph_lit_flight_edges(&flight->lit, end);
    for (int i = 0; i <= NEPH_LIT_CELLS; i++) /* just inside: the end may be infinitely far */
        flight->lit.log_light[i] = log_light_at(flight, fmin(flight->lit.s[i], end * (1.0 - 1e-9)));
    neph_lit_flight_complete(&flight->lit, scene->environment_light || neph_scene_emits(scene));
}

/* ---- the flight ---- */

void neph_flight_init(struct neph_flight *flight, const struct neph_scene *scene,
                      const struct neph_ray *ray)
{
    flight->scene = scene;
    flight->ray = *ray;
    flight->is_table = is_possible(scene);
    flight->lit.is_known = flight->guess.lit.is_known = false;
    neph_medium_flight_init(&flight->own, scene, ray);
    if (flight->own.is_known)
        return;
    if (!flight->is_table) {
        neph_guess_init(&flight->guess, scene, ray);
        return;
    }
    flight->t_m[0] = 0.0;
    flight->count = 1;
    for (int m = 0; m < scene->medium_count; m++)
        add_medium_edges(flight, &scene->media[m]);
    flight->t_m[flight->count++] = ray->end_m;
    double sum[3] = {0.0, 0.0, 0.0};
    for (int i = 0; i < flight->count; i++) {
        if (i > 0) {
            const struct neph_rgb own = depth_between(flight, flight->t_m[i - 1], flight->t_m[i]);
            sum[0] += own.r;
            sum[1] += own.g;
            sum[2] += own.b;
        }
        for (int j = 0; j < 3; j++)
            flight->depth[j][i] = sum[j];
        flight->depth[NEPH_FLIGHT_MEAN][i] = (sum[0] + sum[1] + sum[2]) / 3.0;
    }
    for (int j = 0; j < 3; j++)
        flight->chance[j] = -expm1(-sum[j]);
    init_lit(flight);
}

struct neph_collision neph_flight_collide(const struct neph_flight *flight, int channel,
                                          struct neph_random *random)
{
    struct neph_collision collision = {flight->ray.end_m, -1, {1.0, 1.0, 1.0}};
    if (!(flight->chance[channel] > 0.0))
        return collision;
    const double *depth = flight->depth[channel];
    const double target = -log1p(-flight->chance[channel] * neph_random_uniform(random));
    const int i = find_interval(depth, flight->count, target);
    collision.t_m = interval_place_m(flight, channel, i, target);
    collision.medium = pick_medium(flight, channel, collision.t_m, random);
    const struct neph_rgb way = depth_between(flight, flight->t_m[i], collision.t_m);
    const struct neph_rgb color = flight->scene->media[collision.medium].extinction_color;
    for (int j = 0; j < 3; j++) {
        const double excess = flight->depth[j][i] + read_channel(way, j) - target;
        collision.ratio[j] = 0.0;
        if (flight->chance[j] > 0.0)
            collision.ratio[j] = read_channel(color, j) / read_channel(color, channel) *
                                 exp(-excess) * flight->chance[channel] / flight->chance[j];
    }
    return collision;
}

struct neph_collision neph_flight_collide_lit(const struct neph_flight *flight,
                                              struct neph_random *random, double value[3])
{
    struct neph_collision collision = {flight->ray.end_m, -1, {1.0, 1.0, 1.0}};
    const double target = neph_lit_flight_sample(&flight->lit, random);
    const int i = find_interval(flight->depth[NEPH_FLIGHT_MEAN], flight->count, target);
    collision.t_m = interval_place_m(flight, NEPH_FLIGHT_MEAN, i, target);
    collision.medium = pick_medium(flight, NEPH_FLIGHT_MEAN, collision.t_m, random);
    const struct neph_rgb way = depth_between(flight, flight->t_m[i], collision.t_m);
    const struct neph_rgb color = flight->scene->media[collision.medium].extinction_color;
    const double density = neph_lit_flight_density(&flight->lit, target);
    for (int j = 0; j < 3; j++)
        value[j] = read_channel(color, j) / read_channel(color, NEPH_FLIGHT_MEAN) *
                   exp(-flight->depth[j][i] - read_channel(way, j)) / density;
    return collision;
}
