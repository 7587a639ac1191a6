/* SPDX-License-Identifier: MIT
 *
 * CPU reference: denoising of cells by their neighbours, for occlusion (blur) and for rays
 * (smoothing). At full resolution each pixel is a cell.
 */
#include "renderer/screen/check_reference.h"

#include <math.h>
#include <stdlib.h>

/* A cell, its sampled pixel, and the surface of that pixel. */
struct site {
    const struct reference *ref;
    int resolution;
    struct reference_pixel cell, pixel;
    struct neph_vec3 point_m, normal;
};

static struct site make_site(const struct reference *ref, int resolution, int x, int y)
{
    const struct reference_pixel pixel = reference_sampled_pixel(ref, resolution, x, y);
    return (struct site){.ref = ref,
                         .resolution = resolution,
                         .cell = {x, y},
                         .pixel = pixel,
                         .point_m = reference_surface_m(ref, pixel.x, pixel.y),
                         .normal = reference_normal(ref, pixel.x, pixel.y)};
}

/* The cell at an offset; false outside the frame and for the sky. */
static bool find_neighbour(const struct site *site, int across, int down, struct site *other)
{
    const struct reference *ref = site->ref;
    const int x = site->cell.x + across, y = site->cell.y + down;
    const int cell_px = reference_cell_px(ref, site->resolution);
    if (!reference_is_inside(ref, cell_px * x, cell_px * y))
        return false;
    *other = make_site(ref, site->resolution, x, y);
    return !reference_is_sky(ref, other->pixel.x, other->pixel.y);
}

/* Weight 1 in the plane, falling to 0 at a slope of 1:10. */
static double in_plane(const struct site *site, const struct site *other)
{
    const struct neph_vec3 way_m = neph_vec3_sub(other->point_m, site->point_m);
    const double distance_m = neph_vec3_length(way_m);
    const double off_m = fabs(neph_vec3_dot(way_m, site->normal));
    return distance_m > 0.0 ? fmax(0.0, 1.0 - off_m / (0.1 * distance_m)) : 1.0;
}

/* ---- the blur -------------------------------------------------------------------------------- */

struct texel reference_blur(const struct reference *ref, int x, int y)
{
    const struct site site = make_site(ref, SCREEN_AO_RESOLUTION, x, y);
    const int radius = (int)ref->values[SCREEN_AO_BLUR_PX], side = 2 * radius + 1;
    double sum = 0.0, weights = 0.0;
    if (reference_is_sky(ref, site.pixel.x, site.pixel.y))
        return reference_load(ref, SCREEN_OPEN, x, y);
    for (int i = 0; i < side * side; i++) {
        const int across = i % side - radius, down = i / side - radius;
        struct site other;
        if (!find_neighbour(&site, across, down, &other))
            continue;
        const double rim = (abs(across) == radius ? 0.5 : 1.0) * (abs(down) == radius ? 0.5 : 1.0);
        const double weight = rim * in_plane(&site, &other);
        sum += weight * reference_load(ref, SCREEN_OPEN, other.cell.x, other.cell.y).v[0];
        weights += weight;
    }
    const double open = sum / weights;
    return (struct texel){{open, open, open, open}};
}

/* ---- the smoothing --------------------------------------------------------------------------- */

/* Radius of the samples of a reflection [px]: the spread of rough metal. */
static double reach_px(const struct site *site)
{
    const struct reference *ref = site->ref;
    const double roughness = reference_load(ref, SCREEN_NORMAL, site->pixel.x, site->pixel.y).v[3];
    return site->resolution == SCREEN_GI_RESOLUTION
               ? INFINITY
               : 0.25 * roughness * roughness * ref->height_px / ref->half_height;
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

/* Reflections use only neighbours of metal; indirect light also metal, whose value is 0. */
static bool has_smoothed_light(const struct site *site)
{
    return site->resolution == SCREEN_GI_RESOLUTION ||
           reference_has_light(site->ref, site->resolution, site->pixel.x, site->pixel.y);
}

/* At half resolution cells without the light are unchanged. */
static bool is_unchanged_cell(const struct site *site)
{
    const struct reference *ref = site->ref;
    const struct reference_pixel at = site->pixel;
    return reference_is_sky(ref, at.x, at.y) ||
           (reference_cell_px(ref, site->resolution) > 1 &&
            !reference_has_light(ref, site->resolution, at.x, at.y));
}

struct texel reference_smooth(const struct reference *ref, int resolution, int turn, int x, int y)
{
    static const double b3[3] = {0.375, 0.25, 0.0625};
    const int from = reference_turned_at(resolution, turn);
    const struct site site = make_site(ref, resolution, x, y);
    struct texel sum = {{0.0}};
    double weights = 0.0;
    for (int i = 0; i < 25 && !is_unchanged_cell(&site); i++) {
        const int across = i % 5 - 2, down = i / 5 - 2;
        struct site other;
        if (!find_neighbour(&site, across * (1 << turn), down * (1 << turn), &other) ||
            !has_smoothed_light(&other))
            continue;
        const double weight = b3[abs(across)] * b3[abs(down)] * likeness(&site, &other);
        const struct texel texel = reference_load(ref, from, other.cell.x, other.cell.y);
        for (int c = 0; c < 4; c++)
            sum.v[c] += weight * texel.v[c];
        weights += weight;
    }
    for (int c = 0; c < 4; c++)
        sum.v[c] /= weights > 0.0 ? weights : 1.0;
    return weights > 0.0 ? sum : reference_load(ref, from, x, y);
}
