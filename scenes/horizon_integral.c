/* SPDX-License-Identifier: MIT
 *
 * The line integral of Horizon clouds. The density is smooth between texel faces except for clamps.
 * Intervals whose bound is 0 are skipped, the others are split at every face of the three textures,
 * and between faces Gauss-Kronrod quadrature finds the clamps by bisection.
 */
#include "scenes/horizon.h"
#include "scenes/horizon_density.h"

#include <math.h>

/* Gauss 7 in Kronrod 15 (R. Piessens et al., QUADPACK, 1983): positive nodes, from the outside in;
 * the odd ones are Gauss's. */
static const double nodes[8] = {
    0.991455371120812639, 0.949107912342758525, 0.864864423359769073, 0.741531185599394440,
    0.586087235467691130, 0.405845151377397167, 0.207784955007898468, 0.0};
static const double kronrod_weights[8] = {
    0.022935322010529225, 0.063092092629978553, 0.104790010322250184, 0.140653259715525919,
    0.169004726639267903, 0.190350578064785410, 0.204432940075298892, 0.209482141084727828};
static const double gauss_weights[8] = {0.0, 0.129484966168869693, 0.0, 0.279705391489276668,
                                        0.0, 0.381830050505118945, 0.0, 0.417959183673469388};

struct quadrature {
    const struct neph_horizon *horizon;
    struct neph_vec3 origin_m, direction;
    double leaf_m;      /* intervals this short are not bisected to find empty ones */
    double tolerance_m; /* absolute, of one piece between faces */
    double value_m, error_m;
};

static const int bisections_max = 40;

/* --- between faces --------------------------------------------------------------------------- */

struct rule {
    double kronrod, gauss;
    double lowest, highest; /* of the margin */
    double least, most;     /* of the density */
    unsigned any_sides, all_sides;
};

static void rule_include(struct rule *rule, const struct neph_horizon_sample *sample)
{
    rule->lowest = fmin(rule->lowest, sample->margin);
    rule->highest = fmax(rule->highest, sample->margin);
    rule->least = fmin(rule->least, sample->density);
    rule->most = fmax(rule->most, sample->density);
    rule->any_sides |= sample->sides;
    rule->all_sides &= sample->sides;
}

static void sample_at(const struct quadrature *q, double t_m, struct neph_horizon_sample *sample)
{
    neph_horizon_sample(q->horizon, neph_vec3_along(q->origin_m, q->direction, t_m), sample);
}

static void rule_add(struct rule *rule, const struct quadrature *q, double t_m, int node)
{
    struct neph_horizon_sample sample;
    sample_at(q, t_m, &sample);
    rule->kronrod += kronrod_weights[node] * sample.density;
    rule->gauss += gauss_weights[node] * sample.density;
    rule_include(rule, &sample);
}

/* The outermost sampled points lie between the faces, slightly inside the interval. */
static struct rule apply_rule(const struct quadrature *q, double t0_m, double t1_m)
{
    struct rule rule = {0.0, 0.0, INFINITY, -INFINITY, INFINITY, 0.0, 0u, ~0u};
    const double middle_m = 0.5 * (t0_m + t1_m), half_m = 0.5 * (t1_m - t0_m);
    for (int i = 0; i < 7; i++)
        for (int side = -1; side <= 1; side += 2)
            rule_add(&rule, q, middle_m + side * nodes[i] * half_m, i);
    rule_add(&rule, q, middle_m, 7);
    for (int side = -1; side <= 1; side += 2) {
        struct neph_horizon_sample sample;
        sample_at(q, middle_m + side * (1.0 - 1e-9) * half_m, &sample);
        rule_include(&rule, &sample);
    }
    rule.kronrod *= half_m;
    rule.gauss *= half_m;
    return rule;
}

/* Whether a clamp may begin and end between two nodes: the margin comes this close to 0. */
static bool may_hide_edge(const struct rule *rule)
{
    const double nearness = 0.05 * (rule->highest - rule->lowest);
    return (rule->highest <= 0.0 && rule->highest > -nearness) ||
           (rule->lowest >= 0.0 && rule->lowest < nearness);
}

/* The error of a clamp in a piece whose points are on both sides of it, or may be: the rules do not
 * see a kink beyond their outermost nodes. The error is at most the change of slope at the kink
 * times the length squared. It is estimated from the change of the sampled density and, where the
 * kink was not sampled, from the change of the margin, to which the density is at most proportional
 * with factor `steepness` (except at very small coverage). */
static double kink_error_m(const struct quadrature *q, const struct rule *rule, double length_m)
{
    const double steepness = 20.0 * q->horizon->params.density;
    if (rule->any_sides == rule->all_sides && !may_hide_edge(rule))
        return 0.0;
    return length_m * fmax(rule->most - rule->least, steepness * (rule->highest - rule->lowest));
}

static void integrate_smooth(struct quadrature *q, double t0_m, double t1_m, int bisections)
{
    const struct rule rule = apply_rule(q, t0_m, t1_m);
    const double error_m = fabs(rule.kronrod - rule.gauss) + kink_error_m(q, &rule, t1_m - t0_m);
    const double middle_m = 0.5 * (t0_m + t1_m);
    if (error_m <= q->tolerance_m + 1e-10 * rule.kronrod || bisections == bisections_max ||
        middle_m <= t0_m || middle_m >= t1_m) {
        q->value_m += rule.kronrod;
        q->error_m += error_m;
        return;
    }
    integrate_smooth(q, t0_m, middle_m, bisections + 1);
    integrate_smooth(q, middle_m, t1_m, bisections + 1);
}

/* --- faces ----------------------------------------------------------------------------------- */

/* The crossings of a ray with the equidistant faces of a texture along one axis. */
struct faces {
    double start, per_m; /* place in texels at t = 0, and its change with t */
    double next;         /* the next face's number */
};

enum { FACES = 8 };

static struct faces faces_along(double origin_m, double wind_m, double direction,
                                double texels_per_m, double t0_m)
{
    struct faces faces = {.start = (origin_m - wind_m) * texels_per_m - 0.5,
                          .per_m = direction * texels_per_m};
    const double at = faces.start + t0_m * faces.per_m;
    faces.next = faces.per_m >= 0.0 ? floor(at) + 1.0 : ceil(at) - 1.0;
    return faces;
}

static double next_face_m(const struct faces *faces)
{
    return faces->per_m != 0.0 ? (faces->next - faces->start) / faces->per_m : INFINITY;
}

static double texels_per_m(const struct neph_horizon_params *params, double repeats, int side)
{
    return repeats * side / params->texture_scale_m;
}

static void find_faces(const struct quadrature *q, double t0_m, struct faces faces[FACES])
{
    const struct neph_horizon_params *p = &q->horizon->params;
    const struct neph_vec3 o = q->origin_m, d = q->direction, w = p->wind_m;
    const double weather_per_m = texels_per_m(p, 1.0, NEPH_HORIZON_WEATHER_SIDE);
    const double noise_per_m[2] = {
        texels_per_m(p, p->base_repeats, NEPH_HORIZON_BASE_SIDE),
        texels_per_m(p, p->detail_repeats, NEPH_HORIZON_DETAIL_SIDE),
    };
    *faces++ = faces_along(o.x, w.x, d.x, weather_per_m, t0_m);
    *faces++ = faces_along(o.z, w.z, d.z, weather_per_m, t0_m);
    for (int i = 0; i < 2; i++) {
        *faces++ = faces_along(o.x, w.x, d.x, noise_per_m[i], t0_m);
        *faces++ = faces_along(o.y, w.y, d.y, noise_per_m[i], t0_m);
        *faces++ = faces_along(o.z, w.z, d.z, noise_per_m[i], t0_m);
    }
}

static void integrate_leaf(struct quadrature *q, double t0_m, double t1_m)
{
    struct faces faces[FACES];
    find_faces(q, t0_m, faces);
    while (t0_m < t1_m) {
        struct faces *nearest = &faces[0];
        for (int i = 1; i < FACES; i++)
            if (next_face_m(&faces[i]) < next_face_m(nearest))
                nearest = &faces[i];
        const double end_m = fmin(t1_m, next_face_m(nearest));
        nearest->next += nearest->per_m >= 0.0 ? 1.0 : -1.0;
        if (end_m <= t0_m)
            continue;
        integrate_smooth(q, t0_m, end_m, 0);
        t0_m = end_m;
    }
}

/* --- stretches ------------------------------------------------------------------------------- */

static struct neph_bounds box_around(const struct quadrature *q, double t0_m, double t1_m)
{
    const struct neph_vec3 a = neph_vec3_along(q->origin_m, q->direction, t0_m);
    const struct neph_vec3 b = neph_vec3_along(q->origin_m, q->direction, t1_m);
    return (struct neph_bounds){{fmin(a.x, b.x), fmin(a.y, b.y), fmin(a.z, b.z)},
                                {fmax(a.x, b.x), fmax(a.y, b.y), fmax(a.z, b.z)}};
}

static void integrate_stretch(struct quadrature *q, double t0_m, double t1_m)
{
    const struct neph_bounds box = box_around(q, t0_m, t1_m);
    if (neph_horizon_bound(q->horizon, &box) <= 0.0)
        return;
    const double middle_m = 0.5 * (t0_m + t1_m);
    if (t1_m - t0_m <= q->leaf_m || middle_m <= t0_m || middle_m >= t1_m) {
        integrate_leaf(q, t0_m, t1_m);
        return;
    }
    integrate_stretch(q, t0_m, middle_m);
    integrate_stretch(q, middle_m, t1_m);
}

/* Half the length of a ray's chord in a sphere around the planet's centre, whose radius is the
 * planet's plus `altitude_m`; 0 when it misses. `low` is the ray's lowest altitude: half^2 =
 * (R - r_low) (R + r_low), with R - r_low a difference of altitudes. */
static double half_chord_m(double planet_radius_m, double low_m, double altitude_m)
{
    const double squared = (altitude_m - low_m) * (2.0 * planet_radius_m + altitude_m + low_m);
    return squared > 0.0 ? sqrt(squared) : 0.0;
}

double neph_horizon_integral_m(const struct neph_horizon *horizon, struct neph_vec3 origin_m,
                               struct neph_vec3 direction, double t0_m, double t1_m,
                               double *error_m)
{
    const struct neph_horizon_params *params = &horizon->params;
    const double texel_m = params->texture_scale_m /
                           (params->base_repeats * NEPH_HORIZON_BASE_SIDE);
    struct quadrature q = {.horizon = horizon,
                           .origin_m = origin_m,
                           .direction = direction,
                           .leaf_m = NEPH_HORIZON_BLOCK * texel_m,
                           .tolerance_m = 1e-11 * params->density * NEPH_HORIZON_BLOCK * texel_m};
    const struct neph_vec3 center_m = {0.0, params->bottom_m - params->planet_radius_m, 0.0};
    const double nearest_m = -neph_vec3_dot(neph_vec3_sub(origin_m, center_m), direction);
    const double low_m = neph_horizon_altitude_m(params,
                                                 neph_vec3_along(origin_m, direction, nearest_m));
    const double outer_m = half_chord_m(params->planet_radius_m, low_m, params->thickness_m);
    const double inner_m = half_chord_m(params->planet_radius_m, low_m, 0.0);
    const double first_m = fmax(t0_m, nearest_m - outer_m),
                 last_m = fmin(t1_m, nearest_m + outer_m);
    const double bottom_in_m = fmin(last_m, nearest_m - inner_m);
    const double bottom_out_m = fmax(first_m, nearest_m + inner_m);
    if (first_m < bottom_in_m)
        integrate_stretch(&q, first_m, bottom_in_m);
    if (bottom_out_m < last_m)
        integrate_stretch(&q, bottom_out_m, last_m);
    if (error_m)
        *error_m = q.error_m;
    return q.value_m;
}
