/* SPDX-License-Identifier: MIT */
#include "renderer/sky/field.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- axes and interpolation ------------------------------------------------------------------- */

/* Nodes are dense near the ground and for a sun near the horizon: uniform in the square root of the
 * altitude, and in the signed square root of the sun's elevation, down to deepest_sun_deg. */
static const double deepest_sun_deg = -20.0;

double neph_sky_deepest_root(void)
{
    return -sqrt(-deepest_sun_deg / 90.0);
}

double neph_sky_node_altitude_m(const struct neph_sky_air *air, const struct neph_sky_field *field,
                                int node)
{
    const double part = node / (field->altitudes - 1.0);
    return air->top_m * part * part;
}

double neph_sky_node_sun_cosine(const struct neph_sky_field *field, int node)
{
    const double low = neph_sky_deepest_root();
    const double root = low + (1.0 - low) * node / (field->suns - 1.0);
    return sin(root * fabs(root) * M_PI / 2.0);
}

static double locate_between_nodes(double part, int nodes, int *low)
{
    const double place = fmin(fmax(part, 0.0), 1.0) * (nodes - 1);
    *low = (int)fmin(floor(place), nodes - 2.0);
    return place - *low;
}

static double locate_sun(const struct neph_sky_field *field, double sun_cosine, int *low)
{
    const double part = asin(fmin(1.0, fmax(-1.0, sun_cosine))) / (M_PI / 2.0);
    const double root = copysign(sqrt(fabs(part)), part);
    return locate_between_nodes((root - neph_sky_deepest_root()) / (1.0 - neph_sky_deepest_root()),
                                field->suns, low);
}

void neph_sky_field_at(const struct neph_sky_air *air, const struct neph_sky_field *field,
                       double altitude_m, double sun_cosine,
                       double moments[NEPH_SKY_MOMENTS_MAX][3])
{
    int i, j;
    const int count = neph_sky_moments(field->degree);
    const double x = locate_sun(field, sun_cosine, &i);
    const double y = locate_between_nodes(sqrt(fmax(0.0, altitude_m) / air->top_m),
                                          field->altitudes, &j);
    const double weights[4] = {(1.0 - x) * (1.0 - y), x * (1.0 - y), (1.0 - x) * y, x * y};
    memset(moments, 0, (size_t)count * sizeof(*moments));
    for (int corner = 0; corner < 4; corner++) {
        const int node = (j + corner / 2) * field->suns + i + corner % 2;
        const double(*from)[3] = (const double(*)[3]) & field->moments[node * count];
        for (int k = 0; k < count; k++)
            for (int c = 0; c < 3; c++)
                moments[k][c] += weights[corner] * from[k][c];
    }
}

void neph_sky_field_ground(const struct neph_sky_field *field, double sun_cosine,
                           double irradiance[3])
{
    int i;
    const double x = locate_sun(field, sun_cosine, &i);
    for (int c = 0; c < 3; c++)
        irradiance[c] = (1.0 - x) * field->ground[i][c] + x * field->ground[i + 1][c];
}

/* --- memory ---------------------------------------------------------------------------------- */

enum neph_status neph_sky_field_create(int altitudes, int suns, int degree,
                                       struct neph_sky_field *field, struct neph_diag *diag)
{
    const size_t nodes = (size_t)altitudes * (size_t)suns;
    *field = (struct neph_sky_field){altitudes, suns, degree, NULL, NULL};
    field->moments = calloc(nodes * (size_t)neph_sky_moments(degree), sizeof(*field->moments));
    field->ground = calloc((size_t)suns, sizeof(*field->ground));
    return field->moments && field->ground ? NEPH_OK : neph_fail_memory(diag);
}

void neph_sky_field_destroy(struct neph_sky_field *field)
{
    free(field->moments);
    free(field->ground);
    *field = (struct neph_sky_field){0};
}
