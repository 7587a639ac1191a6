/* SPDX-License-Identifier: MIT */
#include "renderer/sky/solve.h"

#include "base/threads.h"

#include <math.h>
#include <string.h>

/* --- directions ------------------------------------------------------------------------------- */

/* Gauss-Legendre nodes by Newton's method from Tricomi's approximation. */
void neph_sky_gauss(int count, double nodes[NEPH_SKY_DIRECTIONS_MAX],
                    double weights[NEPH_SKY_DIRECTIONS_MAX])
{
    for (int i = 0; i < count; i++) {
        double x = cos(M_PI * (i + 0.75) / (count + 0.5)), slope = 1.0;
        for (int step = 0; step < 8; step++) {
            double p = x, before = 1.0;
            for (int n = 2; n <= count; n++) {
                const double next = ((2.0 * n - 1.0) * x * p - (n - 1.0) * before) / n;
                before = p;
                p = next;
            }
            slope = count > 1 ? count * (x * p - before) / (x * x - 1.0) : 1.0;
            x -= p / slope;
        }
        nodes[i] = x;
        weights[i] = count > 1 ? 2.0 / ((1.0 - x * x) * slope * slope) : 2.0;
    }
}

/* --- passes ----------------------------------------------------------------------------------- */

struct pass {
    const struct neph_sky_air *air;
    const struct neph_sky_solve_params *params;
    struct neph_sky_sources sources;
    bool isotropic; /* all phase functions are replaced by the isotropic one */
    struct neph_sky_field *made;
};

struct node {
    double altitude_m, sun_cosine, sun_sine;
    double (*moments)[3], *ground; /* ground: NULL above the ground */
};

static void find_phases(const struct pass *pass, struct neph_sky_ray *ray)
{
    neph_sky_find_phases(pass->air, ray);
    for (int i = 0; i < pass->air->layer_count && pass->isotropic; i++)
        ray->phases[i] = 0.25 / M_PI;
}

/* Add the light from all azimuths at one cosine, of the given solid angle. */
static void gather_ring(const struct pass *pass, const struct node *node, double cosine,
                        double solid_angle_sr)
{
    const int degree = pass->made->degree, around = pass->params->around;
    const double sine = sqrt(fmax(0.0, 1.0 - cosine * cosine));
    for (int j = 0; j < around; j++) {
        const double x = sine * cos(M_PI * (j + 0.5) / around);
        struct neph_sky_ray ray = {.altitude_m = node->altitude_m,
                                   .cosine = cosine,
                                   .sun_cosine = node->sun_cosine,
                                   .toward_sun = x * node->sun_sine + cosine * node->sun_cosine};
        find_phases(pass, &ray);
        const struct neph_sky_light light = neph_sky_walk(pass->air, &pass->sources, &ray,
                                                          pass->params->steps);
        double values[NEPH_SKY_MOMENTS_MAX];
        neph_sky_harmonics(degree, x, cosine, values);
        for (int c = 0; c < 3; c++) {
            const double flux = light.radiance[c] * solid_angle_sr / around;
            for (int k = 0; k < neph_sky_moments(degree); k++)
                node->moments[k][c] += flux * values[k];
            if (node->ground && cosine > 0.0)
                node->ground[c] += flux * cosine;
        }
    }
}

/* Add the light from all directions between two cosines. */
static void gather_cap(const struct pass *pass, const struct node *node, double low, double high,
                       int count)
{
    double nodes[NEPH_SKY_DIRECTIONS_MAX], weights[NEPH_SKY_DIRECTIONS_MAX];
    neph_sky_gauss(count, nodes, weights);
    for (int i = 0; i < count; i++)
        gather_ring(pass, node, 0.5 * (low + high) + 0.5 * (high - low) * nodes[i],
                    M_PI * (high - low) * weights[i]);
}

static void gather_row(int row, void *context)
{
    const struct pass *pass = context;
    const struct neph_sky_field *made = pass->made;
    const int count = neph_sky_moments(made->degree);
    const double altitude_m = neph_sky_node_altitude_m(pass->air, made, row);
    const double r_m = pass->air->radius_m + altitude_m;
    const double horizon = -sqrt(altitude_m * (2.0 * pass->air->radius_m + altitude_m)) / r_m;
    memset(made->moments[row * made->suns * count], 0,
           (size_t)made->suns * (size_t)count * sizeof(*made->moments));
    for (int i = 0; i < made->suns; i++) {
        const double sun_cosine = neph_sky_node_sun_cosine(made, i);
        const struct node node = {
            altitude_m, sun_cosine, sqrt(fmax(0.0, 1.0 - sun_cosine * sun_cosine)),
            &made->moments[(row * made->suns + i) * count], row == 0 ? made->ground[i] : NULL};
        if (node.ground)
            memset(node.ground, 0, sizeof(*made->ground));
        gather_cap(pass, &node, horizon, 1.0, pass->params->above);
        gather_cap(pass, &node, -1.0, horizon, pass->params->below);
    }
}

static enum neph_status create_like_params(const struct neph_sky_solve_params *params, int degree,
                                           struct neph_sky_field *field, struct neph_diag *diag)
{
    return neph_sky_field_create(params->altitudes, params->suns, degree, field, diag);
}

static enum neph_status run_pass(struct pass *pass, const struct neph_sky_field *from,
                                 struct neph_sky_field *to, struct neph_diag *diag)
{
    pass->sources.field = from;
    pass->made = to;
    return neph_parallel_rows(pass->params->altitudes, gather_row, pass, diag);
}

static void swap(struct neph_sky_field *a, struct neph_sky_field *b)
{
    const struct neph_sky_field held = *a;
    *a = *b;
    *b = held;
}

/* Add orders one by one: the result of a pass is the input of the next. */
static enum neph_status add_orders(struct pass *pass, struct neph_sky_field *field,
                                   struct neph_diag *diag)
{
    struct neph_sky_field next;
    enum neph_status status = create_like_params(pass->params, field->degree, &next, diag);
    for (int order = 0; order < pass->params->orders && !status; order++) {
        status = run_pass(pass, order > 0 ? field : NULL, &next, diag);
        swap(field, &next);
    }
    neph_sky_field_destroy(&next);
    return status;
}

/* The closure: two isotropic orders, and a geometric series for the others. Its ratio is the light
 * that a node receives back for a radiance of 1 from everywhere (Hillaire 2020, equations 5 to 10).
 * All orders light the ground. */
static enum neph_status close_series(struct pass *pass, struct neph_sky_field *field,
                                     struct neph_diag *diag)
{
    struct neph_sky_field back;
    enum neph_status status = create_like_params(pass->params, 0, &back, diag);
    pass->isotropic = true;
    if (!status)
        status = run_pass(pass, NULL, field, diag);
    pass->sources.alight = true;
    if (!status)
        status = run_pass(pass, NULL, &back, diag);
    for (int i = 0; i < field->altitudes * field->suns && !status; i++)
        for (int c = 0; c < 3; c++)
            field->moments[i][c] /= 1.0 - back.moments[i][c] / sqrt(4.0 * M_PI);
    pass->isotropic = pass->sources.alight = false;
    if (!status)
        status = run_pass(pass, field, &back, diag);
    if (!status)
        memcpy(field->ground, back.ground, (size_t)field->suns * sizeof(*field->ground));
    neph_sky_field_destroy(&back);
    return status;
}

enum neph_status neph_sky_solve(const struct neph_sky_air *air,
                                const struct neph_sky_sun_table *sun,
                                const struct neph_sky_solve_params *params,
                                struct neph_sky_field *field, struct neph_diag *diag)
{
    struct pass pass = {
        .air = air, .params = params, .sources = {.sun = sun, .media_scatter = true}};
    enum neph_status status = create_like_params(params, params->closure ? 0 : params->degree,
                                                 field, diag);
    if (status)
        return status;
    return params->closure ? close_series(&pass, field, diag) : add_orders(&pass, field, diag);
}
