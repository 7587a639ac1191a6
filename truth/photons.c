/* SPDX-License-Identifier: MIT
 *
 * Colour as in truth/path.c: a photon has a channel that decides its collisions, and in each
 * channel its value and the probability of its history, both over the mean probability.
 */
#include "truth/photons.h"

#include "base/interrupt.h"
#include "scenes/phase_colour.h"
#include "scenes/solids.h"
#include "scenes/surfaces.h"
#include "truth/directions.h"

#include <math.h>

/* Russian roulette: a photon below this weight survives with a probability of its part of it. */
static const double roulette_weight = 0.1;

/* Launch columns, at most. */
static const double launch_max = 16777216.0;

struct photon {
    const struct neph_photons *of;
    struct neph_random *random;
    double *values;
    double share; /* of the sunlight of a column */
    struct neph_vec3 at_m, direction;
    int channel;
    double value[3], probability[3];
    bool is_direct; /* no event yet */
    bool is_below;  /* the bottom level */
};

/* Columns along one axis above which sunlight enters: those of the domain and, where it is open,
 * those through which sunlight reaches its sides. `shift_m`: from top to bottom. */
static void find_launch(double width_m, int columns, bool is_open, double shift_m, int *low,
                        int *high)
{
    const double shift = is_open ? shift_m / (width_m / columns) : 0.0;
    *low = -(int)fmin(launch_max, ceil(fmax(0.0, shift)));
    *high = columns + (int)fmin(launch_max, ceil(fmax(0.0, -shift)));
}

enum neph_status neph_photons_init(struct neph_photons *photons, const struct neph_scene *scene,
                                   const struct neph_tracker *tracker,
                                   const struct neph_flux_domain *domain, int channel_count,
                                   struct neph_diag *diag)
{
    const struct neph_bounds *box = &domain->box;
    const struct neph_vec3 sun = scene->sun.direction;
    const double per_x = (box->max_m.y - box->min_m.y) / sun.y;
    struct neph_photons made = {scene, tracker, *domain, channel_count, {0, 0}, {0, 0}};
    find_launch(box->max_m.x - box->min_m.x, domain->columns_x, domain->is_open_x, -sun.x * per_x,
                &made.launch_low[0], &made.launch_high[0]);
    find_launch(box->max_m.z - box->min_m.z, domain->columns_z, domain->is_open_z, -sun.z * per_x,
                &made.launch_low[1], &made.launch_high[1]);
    const double launches = ((double)made.launch_high[0] - made.launch_low[0]) *
                            ((double)made.launch_high[1] - made.launch_low[1]);
    if (launches > launch_max)
        return neph_fail(diag, NEPH_ERR_INPUT,
                         "the sun is %g degrees above the horizon: its light enters the sides of "
                         "this domain from %.3g columns, at most %.0f",
                         asin(sun.y) * 180.0 / M_PI, launches, launch_max);
    *photons = made;
    return NEPH_OK;
}

/* ---- tallies ---- */

/* The place in a periodic domain, or where it is. */
static double wrapped(double x_m, double low_m, double high_m, bool is_open)
{
    if (is_open || (x_m >= low_m && x_m < high_m))
        return x_m;
    const double side_m = high_m - low_m, at_m = x_m - side_m * floor((x_m - low_m) / side_m);
    return at_m < high_m ? at_m : low_m;
}

static struct neph_vec3 wrap(const struct neph_flux_domain *domain, struct neph_vec3 point_m)
{
    const struct neph_bounds *box = &domain->box;
    return (struct neph_vec3){wrapped(point_m.x, box->min_m.x, box->max_m.x, domain->is_open_x),
                              point_m.y,
                              wrapped(point_m.z, box->min_m.z, box->max_m.z, domain->is_open_z)};
}

/* The column of a point; -1 beyond an open side. */
static int find_column(const struct neph_flux_domain *domain, struct neph_vec3 point_m)
{
    const struct neph_bounds *box = &domain->box;
    const struct neph_vec3 at_m = wrap(domain, point_m);
    const double x = floor((at_m.x - box->min_m.x) / (box->max_m.x - box->min_m.x) *
                           domain->columns_x),
                 z = floor((at_m.z - box->min_m.z) / (box->max_m.z - box->min_m.z) *
                           domain->columns_z);
    const bool is_outside = x < 0.0 || x >= domain->columns_x || z < 0.0 || z >= domain->columns_z;
    if (is_outside && (domain->is_open_x || domain->is_open_z))
        return -1;
    return (int)fmin(domain->columns_x - 1, x) +
           domain->columns_x * (int)fmin(domain->columns_z - 1, z);
}

static void leave(const struct photon *photon, enum neph_flux flux, struct neph_vec3 point_m,
                  const double part[3])
{
    const struct neph_flux_domain *domain = &photon->of->domain;
    const int column = find_column(domain, point_m), channels = photon->of->channel_count;
    if (column < 0)
        return;
    const size_t columns = (size_t)domain->columns_x * (size_t)domain->columns_z;
    double *values = photon->values + ((size_t)flux * columns + (size_t)column) * (size_t)channels;
    for (int c = 0; c < channels; c++)
        values[c] += photon->share * part[c];
}

/* Leave the photon's weight at the levels that it crosses before `end_m`. A ground at the bottom
 * level ends the ray there, up to rounding. */
static void cross_levels(struct photon *photon, double end_m, bool is_at_ground)
{
    const struct neph_flux_domain *domain = &photon->of->domain;
    const struct neph_vec3 from_m = photon->at_m, along = photon->direction;
    const double to_top_m = (domain->box.max_m.y - from_m.y) / along.y,
                 to_bottom_m = (neph_flux_bottom_m(domain) - from_m.y) / along.y;
    if (along.y > 0.0) {
        if (photon->is_below)
            leave(photon, NEPH_FLUX_UPWARD, neph_vec3_along(from_m, along, fmax(0.0, to_bottom_m)),
                  photon->value);
        if (to_top_m >= 0.0 && to_top_m <= end_m)
            leave(photon, NEPH_FLUX_REFLECTED, neph_vec3_along(from_m, along, to_top_m),
                  photon->value);
        photon->is_below = false;
    } else if (along.y < 0.0 && !photon->is_below && (to_bottom_m <= end_m || is_at_ground)) {
        if (!photon->is_direct) /* else leave_direct() has counted it */
            leave(photon, NEPH_FLUX_TRANSMITTED,
                  neph_vec3_along(from_m, along, fmin(to_bottom_m, end_m)), photon->value);
        photon->is_below = true;
    }
}

/* The sunlight on the photon's first line that reaches the bottom. */
static void leave_direct(const struct photon *photon)
{
    const struct neph_flux_domain *domain = &photon->of->domain;
    const double way_m = (neph_flux_bottom_m(domain) - photon->at_m.y) / photon->direction.y;
    const struct neph_vec3 end_m = neph_vec3_along(photon->at_m, photon->direction, way_m);
    const struct neph_ray ray = {end_m, photon->of->scene->sun.direction, INFINITY};
    struct neph_tracking_cost cost = {0, 0};
    const struct neph_rgb light = neph_tracker_transmittance(photon->of->tracker, &ray, 0.0,
                                                             photon->random, &cost);
    leave(photon, NEPH_FLUX_DIRECT, end_m, (const double[3]){light.r, light.g, light.b});
    leave(photon, NEPH_FLUX_TRANSMITTED, end_m, (const double[3]){light.r, light.g, light.b});
}

/* ---- a photon ---- */

static void multiply(struct photon *photon, struct neph_rgb by)
{
    photon->value[0] *= by.r;
    photon->value[1] *= by.g;
    photon->value[2] *= by.b;
}

static void weigh(struct photon *photon, const double ratio[3])
{
    double mean = 0.0;
    for (int j = 0; j < 3; j++) {
        photon->value[j] *= ratio[j];
        photon->probability[j] *= ratio[j];
        mean += photon->probability[j] / 3.0;
    }
    for (int j = 0; j < 3; j++) {
        photon->value[j] /= mean;
        photon->probability[j] /= mean;
    }
}

static bool survives(struct photon *photon)
{
    const double most = fmax(photon->value[0], fmax(photon->value[1], photon->value[2]));
    if (most >= roulette_weight)
        return true;
    if (neph_random_uniform(photon->random) * roulette_weight >= most)
        return false;
    for (int j = 0; j < 3; j++)
        photon->value[j] *= roulette_weight / most;
    return true;
}

static void scatter(struct photon *photon, const struct neph_collision *collision)
{
    const struct neph_medium *medium = &photon->of->scene->media[collision->medium];
    const struct neph_rgb w = medium->albedo;
    photon->at_m = neph_vec3_along(photon->at_m, photon->direction, collision->t_m);
    leave(photon, NEPH_FLUX_ABSORBED, photon->at_m,
          (const double[3]){photon->value[0] * (1.0 - w.r), photon->value[1] * (1.0 - w.g),
                            photon->value[2] * (1.0 - w.b)});
    multiply(photon, w);
    const struct neph_phase own = neph_phase_channel(&medium->phase, photon->channel);
    const struct neph_vec3 before = photon->direction;
    photon->direction = neph_phase_sample(&own, before, photon->random);
    if (!neph_phase_is_coloured(&medium->phase))
        return;
    double ratio[3];
    neph_direction_ratios(
        neph_phase_rgb_per_sr(&medium->phase, neph_vec3_dot(before, photon->direction)),
        photon->channel, ratio);
    weigh(photon, ratio);
}

static void reflect(struct photon *photon, const struct neph_hit *hit)
{
    const struct neph_vec3 point_m = neph_vec3_along(photon->at_m, photon->direction, hit->t_m);
    multiply(photon, neph_surface_color(hit, point_m));
    photon->at_m = neph_hit_outside_m(hit, point_m);
    photon->direction = neph_cosine_sample(hit->normal, photon->random);
}

/* Trace a photon until it leaves or is absorbed. */
static void follow(struct photon *photon)
{
    const struct neph_photons *of = photon->of;
    struct neph_tracking_cost cost = {0, 0};
    do {
        photon->at_m = wrap(&of->domain, photon->at_m);
        const struct neph_hit hit = neph_scene_hit(of->scene, photon->at_m, photon->direction);
        const struct neph_ray ray = {photon->at_m, photon->direction, hit.t_m};
        const struct neph_collision collision = neph_tracker_collide(
            of->tracker, &ray, photon->channel, photon->random, &cost);
        if (!neph_tracker_is_grey(of->tracker))
            weigh(photon, collision.ratio);
        cross_levels(photon, collision.t_m, collision.medium < 0 && hit.solid);
        photon->is_direct = false;
        if (collision.medium >= 0)
            scatter(photon, &collision);
        else if (hit.solid)
            reflect(photon, &hit);
        else
            return;
    } while (survives(photon));
}

static void launch(const struct neph_photons *photons, int x, int z, double share,
                   struct neph_random *random, double *values)
{
    const struct neph_bounds *box = &photons->domain.box;
    const double u = neph_random_uniform(random), v = neph_random_uniform(random);
    struct photon photon = {
        .of = photons,
        .random = random,
        .values = values,
        .share = share,
        .at_m = {box->min_m.x + (box->max_m.x - box->min_m.x) * (x + u) / photons->domain.columns_x,
                 box->max_m.y,
                 box->min_m.z +
                     (box->max_m.z - box->min_m.z) * (z + v) / photons->domain.columns_z},
        .direction = neph_vec3_scale(photons->scene->sun.direction, -1.0),
        .value = {1.0, 1.0, 1.0},
        .probability = {1.0, 1.0, 1.0},
        .is_direct = true};
    if (!neph_tracker_is_grey(photons->tracker))
        photon.channel = (int)(3.0 * neph_random_uniform(random));
    leave_direct(&photon);
    follow(&photon);
}

void neph_photons_trace(const struct neph_photons *photons, uint64_t seed, int batch, int paths,
                        double *values)
{
    uint64_t column = 0;
    for (int z = photons->launch_low[1]; z < photons->launch_high[1]; z++)
        for (int x = photons->launch_low[0]; x < photons->launch_high[0]; x++) {
            struct neph_random random = neph_random_stream(seed, column++, (uint64_t)batch);
            for (int i = 0; i < paths && !(i % 64 == 0 && neph_interrupted()); i++)
                launch(photons, x, z, 1.0 / paths, &random, values);
        }
}
