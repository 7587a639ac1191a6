/* SPDX-License-Identifier: MIT
 *
 * What takes the noise out of cells beside each other: the blur of occlusion, and the smoothing of
 * rays. At full resolution each pixel is a cell.
 */
#include "tests/renderer/twins/screen.h"

#include <math.h>
#include <stdlib.h>

/* A cell, the pixel that it stands for, and what that shows. */
struct site {
    const struct twin_screen *twin;
    int resolution;
    struct twin_pixel cell, pixel;
    struct neph_vec3 point_m, normal;
};

static struct site site_of(const struct twin_screen *twin, int resolution, int x, int y)
{
    const struct twin_pixel pixel = twin_screen_pixel_in(twin, resolution, x, y);
    return (struct site){.twin = twin,
                         .resolution = resolution,
                         .cell = {x, y},
                         .pixel = pixel,
                         .point_m = twin_screen_surface_m(twin, pixel.x, pixel.y),
                         .normal = twin_screen_normal(twin, pixel.x, pixel.y)};
}

/* A cell so many cells away; false where there is none, or the sky. */
static bool beside(const struct site *site, int across, int down, struct site *other)
{
    const struct twin_screen *twin = site->twin;
    const int x = site->cell.x + across, y = site->cell.y + down;
    const int cell_px = twin_screen_cell_px(twin, site->resolution);
    if (!twin_screen_is_inside(twin, cell_px * x, cell_px * y))
        return false;
    *other = site_of(twin, site->resolution, x, y);
    return !twin_screen_is_sky(twin, other->pixel.x, other->pixel.y);
}

/* 1 in the plane, 0 from a slope of 1:10 on. */
static double in_plane(const struct site *site, const struct site *other)
{
    const struct neph_vec3 way_m = neph_vec3_sub(other->point_m, site->point_m);
    const double distance_m = neph_vec3_length(way_m);
    const double off_m = fabs(neph_vec3_dot(way_m, site->normal));
    return distance_m > 0.0 ? fmax(0.0, 1.0 - off_m / (0.1 * distance_m)) : 1.0;
}

/* ---- the blur -------------------------------------------------------------------------------- */

double twin_screen_blur(const struct twin_screen *twin, int x, int y)
{
    const struct site site = site_of(twin, SCREEN_AO_RESOLUTION, x, y);
    const int radius = (int)twin->values[SCREEN_AO_BLUR_PX], side = 2 * radius + 1;
    double sum = 0.0, weights = 0.0;
    if (twin_screen_is_sky(twin, site.pixel.x, site.pixel.y))
        return twin_screen_load(twin, SCREEN_OPEN, x, y).v[0];
    for (int i = 0; i < side * side; i++) {
        const int across = i % side - radius, down = i / side - radius;
        struct site other;
        if (!beside(&site, across, down, &other))
            continue;
        const double rim = (abs(across) == radius ? 0.5 : 1.0) * (abs(down) == radius ? 0.5 : 1.0);
        const double weight = rim * in_plane(&site, &other);
        sum += weight * twin_screen_load(twin, SCREEN_OPEN, other.cell.x, other.cell.y).v[0];
        weights += weight;
    }
    return sum / weights;
}

/* ---- the smoothing --------------------------------------------------------------------------- */

/* How far a reflection may be taken from [px]: as far as rough metal spreads it. */
static double reach_px(const struct site *site)
{
    const struct twin_screen *twin = site->twin;
    const double roughness =
        twin_screen_load(twin, SCREEN_NORMAL, site->pixel.x, site->pixel.y).v[3];
    return site->resolution == SCREEN_GI_RESOLUTION
               ? INFINITY
               : 0.25 * roughness * roughness * twin->height_px / twin->half_height;
}

static double likeness(const struct site *site, const struct site *other)
{
    const double facing = fmax(0.0, fmin(1.0, neph_vec3_dot(other->normal, site->normal)));
    const double far = hypot(other->pixel.x - site->pixel.x, other->pixel.y - site->pixel.y) /
                       reach_px(site);
    const bool is_own = other->cell.x == site->cell.x && other->cell.y == site->cell.y;
    return in_plane(site, other) * pow(facing, 32.0) *
           (is_own ? 1.0 : exp(-fmin(80.0, 0.5 * far * far)));
}

/* Reflections are taken from metal alone; indirect light from metal, too, which has none. */
static bool is_of_kind(const struct site *site)
{
    return site->resolution == SCREEN_GI_RESOLUTION ||
           twin_screen_has_light(site->twin, site->resolution, site->pixel.x, site->pixel.y);
}

/* At half resolution cells without the light are left as they are. */
static bool is_left(const struct site *site)
{
    const struct twin_screen *twin = site->twin;
    const struct twin_pixel at = site->pixel;
    return twin_screen_is_sky(twin, at.x, at.y) ||
           (twin_screen_cell_px(twin, site->resolution) > 1 &&
            !twin_screen_has_light(twin, site->resolution, at.x, at.y));
}

struct texel twin_screen_smooth(const struct twin_screen *twin, int resolution, int turn, int x,
                                int y)
{
    static const double b3[3] = {0.375, 0.25, 0.0625};
    const int from = twin_screen_turned_at(resolution, turn);
    const struct site site = site_of(twin, resolution, x, y);
    struct texel sum = {{0.0}};
    double weights = 0.0;
    for (int i = 0; i < 25 && !is_left(&site); i++) {
        const int across = i % 5 - 2, down = i / 5 - 2;
        struct site other;
        if (!beside(&site, across * (1 << turn), down * (1 << turn), &other) || !is_of_kind(&other))
            continue;
        const double weight = b3[abs(across)] * b3[abs(down)] * likeness(&site, &other);
        const struct texel texel = twin_screen_load(twin, from, other.cell.x, other.cell.y);
        for (int c = 0; c < 4; c++)
            sum.v[c] += weight * texel.v[c];
        weights += weight;
    }
    for (int c = 0; c < 4; c++)
        sum.v[c] /= weights > 0.0 ? weights : 1.0;
    return weights > 0.0 ? sum : twin_screen_load(twin, from, x, y);
}
