/* SPDX-License-Identifier: MIT
 *
 * Samples free flights through several media. Media that need majorants are traversed side by side,
 * always the one with the nearest candidate. So nothing is sampled behind the accepted collision,
 * and the ratios include only events before it.
 */
#include "truth/tracking.h"

#include "scenes/bounds.h"
#include "scenes/grid.h"
#include "scenes/majorant.h"
#include "scenes/media.h"
#include "scenes/medium_bounds.h"
#include "scenes/phase_colour.h"
#include "truth/segments.h"

#include <math.h>
#include <stdlib.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_MEDIUM_KIND_COUNT == 8, "a new kind");

struct tracked {
    const struct neph_medium *medium;
    bool inverted; /* collisions by the inverse of each fog layer, or of constant cells; else by
                    * candidates of a majorant */
    struct neph_majorants *majorants; /* owned; NULL for shells and if `inverted` */
    double color[3], color_max;       /* extinction_color */
    bool grey;
    bool exact; /* has a closed form */
};

struct neph_tracker {
    const struct neph_scene *scene;
    int count;
    bool grey;
    struct tracked media[NEPH_SCENE_MEDIA_MAX];
};

/* ---- set-up ---- */

/* Free paths through these are inverted cell by cell. */
static bool has_constant_cells(const struct neph_medium *medium)
{
    return medium->kind == NEPH_MEDIUM_GRID && medium->grid->is_constant;
}

static enum neph_status prepare(struct tracked *tracked, const struct neph_medium *medium,
                                struct neph_diag *diag)
{
    const struct neph_medium_facts *facts = neph_medium_facts(medium->kind);
    const struct neph_rgb color = medium->extinction_color;
    *tracked = (struct tracked){
        .medium = medium,
        .inverted = facts->is_fog || has_constant_cells(medium),
        .color = {color.r, color.g, color.b},
        .color_max = fmax(color.r, fmax(color.g, color.b)),
        .grey = color.r == color.g && color.g == color.b,
        .exact = facts->has_closed_form,
    };
    if (!facts->needs_majorants || tracked->inverted)
        return NEPH_OK;
    const struct neph_bounds box = neph_medium_support(medium);
    if (!(box.min_m.x < box.max_m.x && box.min_m.y < box.max_m.y && box.min_m.z < box.max_m.z)) {
        tracked->color_max = 0.0; /* outside of its bounds: no medium */
        return NEPH_OK;
    }
    return neph_majorants_create(medium, &box, facts->majorant_cells, &tracked->majorants, diag);
}

enum neph_status neph_tracker_create(const struct neph_scene *scene, struct neph_tracker **tracker,
                                     struct neph_diag *diag)
{
    struct neph_tracker *made = calloc(1, sizeof(*made));
    if (!made)
        return neph_fail_memory(diag);
    made->scene = scene;
    made->grey = true;
    for (int m = 0; m < scene->medium_count; m++) {
        const enum neph_status status = prepare(&made->media[m], &scene->media[m], diag);
        if (status) {
            neph_tracker_destroy(made);
            return status;
        }
        made->count++;
        made->grey = made->grey && made->media[m].grey &&
                     !neph_phase_is_coloured(&scene->media[m].phase);
    }
    *tracker = made;
    return NEPH_OK;
}

void neph_tracker_destroy(struct neph_tracker *tracker)
{
    if (!tracker)
        return;
    for (int m = 0; m < tracker->count; m++)
        neph_majorants_destroy(tracker->media[m].majorants);
    free(tracker);
}

bool neph_tracker_is_grey(const struct neph_tracker *tracker)
{
    return tracker->grey;
}

/* Sample the optical depth of a collision for light of colour 1. */
static double exponential(struct neph_random *random)
{
    return -log(neph_random_uniform(random));
}

/* ---- fog and constant cells ---- */

static void collide_cells(const struct tracked *tracked, int index, const struct neph_ray *ray,
                          int channel, double t0_m, double t1_m, struct neph_random *random,
                          struct neph_collision *collision)
{
    const struct neph_medium *medium = tracked->medium;
    const double per_density = medium->extinction_per_m * tracked->color[channel];
    if (!(per_density > 0.0))
        return;
    const double t_m = neph_grid_free_path_m(medium->grid, ray->origin_m, ray->direction, t0_m,
                                             t1_m, exponential(random) / per_density);
    if (t_m < t1_m) {
        collision->t_m = t_m;
        collision->medium = index;
    }
}

/* Find the nearest collision with an inverted medium before `collision`. */
static void collide_inverted(const struct tracked *tracked, int index, const struct neph_ray *ray,
                             int channel, struct neph_random *random,
                             struct neph_collision *collision)
{
    const struct neph_medium *medium = tracked->medium;
    double t0_m = 0.0, t1_m = collision->t_m;
    if (!neph_medium_clip(medium, ray->origin_m, ray->direction, &t0_m, &t1_m))
        return;
    if (has_constant_cells(medium)) {
        collide_cells(tracked, index, ray, channel, t0_m, t1_m, random, collision);
        return;
    }
    const double y_m = ray->origin_m.y + t0_m * ray->direction.y;
    for (int l = 0; l < medium->layer_count; l++) {
        const struct neph_fog_layer *layer = &medium->layers[l];
        if (layer->extinction_per_m == 0.0)
            continue;
        const double optical_depth = exponential(random) / tracked->color[channel];
        const double t_m = t0_m +
                           neph_fog_layer_distance_m(layer, y_m, ray->direction.y, optical_depth);
        if (t_m < t1_m) {
            t1_m = collision->t_m = t_m;
            collision->medium = index;
        }
    }
}

/* ---- candidates of a majorant ---- */

struct walk {
    const struct tracked *tracked;
    int index;
    double t_m;            /* of the current candidate */
    double majorant_per_m; /* at the candidate, for the channel with the largest extinction */
    double raised;         /* factor above the necessary majorant */
    struct neph_segments segments;
};

/* Advance to the next candidate; false: none before the end. */
static bool walk_next(struct walk *walk, struct neph_random *random)
{
    struct neph_segments *segments = &walk->segments;
    const double scale = walk->tracked->color_max * walk->raised;
    double left = exponential(random);
    for (;;) {
        const double majorant_per_m = segments->majorant_per_m * scale;
        const double depth = majorant_per_m * (segments->t1_m - walk->t_m);
        if (left < depth) {
            walk->t_m += left / majorant_per_m;
            walk->majorant_per_m = majorant_per_m;
            return true;
        }
        left -= depth;
        walk->t_m = segments->t1_m;
        if (!neph_segments_next(segments))
            return false;
    }
}

static bool walk_start(struct walk *walk, const struct tracked *tracked, int index,
                       const struct neph_ray *ray, double end_m, double raised,
                       struct neph_random *random)
{
    walk->raised = raised;
    walk->tracked = tracked;
    walk->index = index;
    if (!neph_segments_start(&walk->segments, tracked->medium, tracked->majorants, ray->origin_m,
                             ray->direction, end_m))
        return false;
    walk->t_m = walk->segments.t0_m;
    return walk_next(walk, random);
}

/* Extinction / majorant at the candidate, for the channel with the largest extinction. */
static double walk_density(const struct walk *walk, const struct neph_ray *ray,
                           struct neph_tracking_cost *cost)
{
    const struct neph_vec3 point_m = neph_vec3_along(ray->origin_m, ray->direction, walk->t_m);
    cost->lookups++;
    return neph_medium_extinction_per_m(walk->tracked->medium, point_m) * walk->tracked->color_max /
           walk->majorant_per_m;
}

/* Accept or reject the candidate. */
static bool walk_decide(const struct walk *walk, const struct neph_ray *ray, int channel,
                        struct neph_random *random, struct neph_collision *collision,
                        struct neph_tracking_cost *cost)
{
    const struct tracked *tracked = walk->tracked;
    const double density = walk_density(walk, ray, cost) / tracked->color_max;
    const double probability = density * tracked->color[channel];
    if (neph_random_uniform(random) < probability) {
        collision->t_m = walk->t_m;
        collision->medium = walk->index;
        return true;
    }
    if (!tracked->grey)
        for (int j = 0; j < 3; j++)
            collision->ratio[j] *= fmax(0.0, 1.0 - density * tracked->color[j]) /
                                   (1.0 - probability);
    return false;
}

static struct walk *nearest_walk(struct walk *walks, int count)
{
    struct walk *nearest = &walks[0];
    for (int i = 1; i < count; i++)
        if (walks[i].t_m < nearest->t_m)
            nearest = &walks[i];
    return nearest;
}

static void collide_candidates(const struct neph_tracker *tracker, const struct neph_ray *ray,
                               int channel, struct neph_random *random,
                               struct neph_collision *collision, struct neph_tracking_cost *cost)
{
    struct walk walks[NEPH_SCENE_MEDIA_MAX];
    int count = 0;
    for (int m = 0; m < tracker->count; m++) {
        const struct tracked *tracked = &tracker->media[m];
        if (!tracked->inverted && tracked->color_max > 0.0)
            count += walk_start(&walks[count], tracked, m, ray, collision->t_m, 1.0, random);
    }
    while (count > 0) {
        struct walk *walk = nearest_walk(walks, count);
        if (walk_decide(walk, ray, channel, random, collision, cost))
            return;
        if (!walk_next(walk, random))
            *walk = walks[--count];
    }
}

/* ---- all media ---- */

/* Multiply the ratios of the other channels for a coloured medium: for an inverted medium, whose
 * null collisions are not sampled, and for the collision itself. */
static void multiply_channel_ratios(const struct neph_tracker *tracker, const struct neph_ray *ray,
                                    int channel, struct neph_collision *collision)
{
    for (int m = 0; m < tracker->count; m++) {
        const struct tracked *tracked = &tracker->media[m];
        if (tracked->grey)
            continue;
        const double depth = tracked->inverted
                                 ? neph_medium_optical_depth(tracked->medium, ray->origin_m,
                                                             ray->direction, 0.0, collision->t_m)
                                 : 0.0;
        for (int j = 0; j < 3; j++) {
            const double excess = tracked->color[j] - tracked->color[channel];
            if (excess != 0.0 && depth > 0.0) /* avoids 0 * inf */
                collision->ratio[j] *= exp(-excess * depth);
            if (m == collision->medium)
                collision->ratio[j] *= tracked->color[j] / tracked->color[channel];
        }
    }
}

struct neph_collision neph_tracker_collide(const struct neph_tracker *tracker,
                                           const struct neph_ray *ray, int channel,
                                           struct neph_random *random,
                                           struct neph_tracking_cost *cost)
{
    struct neph_collision collision = {ray->end_m, -1, {1.0, 1.0, 1.0}};
    for (int m = 0; m < tracker->count; m++)
        if (tracker->media[m].inverted && tracker->media[m].color[channel] > 0.0)
            collide_inverted(&tracker->media[m], m, ray, channel, random, &collision);
    collide_candidates(tracker, ray, channel, random, &collision, cost);
    if (!tracker->grey)
        multiply_channel_ratios(tracker, ray, channel, &collision);
    cost->collisions += collision.medium >= 0;
    return collision;
}

/* Russian roulette: a faint estimate ends, or is raised to `faint`; in a thick cloud it would only
 * become smaller. False: it ends. */
static bool survives(double transmittance[3], struct neph_random *random)
{
    const double faint = 0.05;
    const double most = fmax(transmittance[0], fmax(transmittance[1], transmittance[2]));
    if (most >= faint)
        return true;
    const bool lives = neph_random_uniform(random) * faint < most;
    for (int j = 0; j < 3; j++)
        transmittance[j] *= lives ? faint / most : 0.0;
    return lives;
}

static void track_ratio(const struct tracked *tracked, const struct neph_ray *ray,
                        double expected_depth, struct neph_random *random, double transmittance[3],
                        struct neph_tracking_cost *cost)
{
    const double raised_most = 16.0;
    struct walk walk;
    bool more = walk_start(&walk, tracked, 0, ray, ray->end_m,
                           fmax(1.0, fmin(expected_depth, raised_most)), random);
    while (more) {
        const double density = walk_density(&walk, ray, cost) / tracked->color_max;
        for (int j = 0; j < 3; j++)
            transmittance[j] *= fmax(0.0, 1.0 - density * tracked->color[j]);
        more = (expected_depth > 0.0 || survives(transmittance, random)) &&
               walk_next(&walk, random);
    }
}

struct neph_rgb neph_tracker_transmittance(const struct neph_tracker *tracker,
                                           const struct neph_ray *ray, double expected_depth,
                                           struct neph_random *random,
                                           struct neph_tracking_cost *cost)
{
    struct neph_rgb depth = {0, 0, 0};
    double ratio[3] = {1.0, 1.0, 1.0};
    for (int m = 0; m < tracker->count; m++) {
        const struct tracked *tracked = &tracker->media[m];
        if (!tracked->exact) {
            if (tracked->color_max > 0.0 && fmax(ratio[0], fmax(ratio[1], ratio[2])) > 0.0)
                track_ratio(tracked, ray, expected_depth, random, ratio, cost);
            continue;
        }
        const double own = neph_medium_optical_depth(tracked->medium, ray->origin_m, ray->direction,
                                                     0.0, ray->end_m);
        depth = neph_rgb_add(depth, neph_rgb_attenuation(tracked->medium->extinction_color, own));
    }
    if (tracker->grey) {
        const double light = ratio[0] * exp(-depth.r);
        return (struct neph_rgb){light, light, light};
    }
    return (struct neph_rgb){ratio[0] * exp(-depth.r), ratio[1] * exp(-depth.g),
                             ratio[2] * exp(-depth.b)};
}
