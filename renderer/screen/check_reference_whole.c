/* SPDX-License-Identifier: MIT
 *
 * CPU reference: upsampling from one pixel of each cell to all pixels.
 */
#include "renderer/screen/check_reference.h"

#include <math.h>

/* Similarity of the surfaces of two pixels: 1 on one plane. */
static double likeness(const struct reference *ref, int x, int y, struct reference_pixel at)
{
    const struct neph_vec3 normal = reference_normal(ref, x, y);
    const struct neph_vec3 way_m = neph_vec3_sub(reference_surface_m(ref, at.x, at.y),
                                                 reference_surface_m(ref, x, y));
    const double distance_m = neph_vec3_length(way_m);
    const double slope = distance_m > 0.0 ? fabs(neph_vec3_dot(way_m, normal)) / distance_m : 0.0;
    const double facing = neph_vec3_dot(reference_normal(ref, at.x, at.y), normal);
    return facing < 0.1 ? 0.0 : fmax(1e-4, 1.0 - slope / 0.1) * pow(fmin(1.0, facing), 8.0);
}

static struct texel unknown(const struct reference *ref, int resolution, int x, int y)
{
    return resolution == SCREEN_AO_RESOLUTION
               ? (struct texel){{1.0, 1.0, 1.0, 1.0}}
               : (struct texel){{0.0, 0.0, 0.0, reference_open(ref, x, y)}};
}

static struct texel between_cells(const struct reference *ref, int resolution, int x, int y)
{
    const int from = reference_cells_at(ref, resolution);
    const int side = reference_cell_px(ref, resolution);
    const struct reference_pixel first = reference_sampled_pixel(ref, resolution, 0, 0);
    const double across = (double)(x - first.x) / side, down = (double)(y - first.y) / side;
    struct texel sum = {{0.0}};
    double weights = 0.0;
    for (int i = 0; i < 4; i++) {
        const int column = (int)floor(across) + i % 2, row = (int)floor(down) + i / 2;
        if (column < 0 || row < 0 || side * column >= ref->width_px || side * row >= ref->height_px)
            continue;
        const struct reference_pixel at = reference_sampled_pixel(ref, resolution, column, row);
        const double share = (1.0 - fabs(across - column)) * (1.0 - fabs(down - row));
        if (!reference_has_light(ref, resolution, at.x, at.y))
            continue;
        const double weight = share * likeness(ref, x, y, at);
        const struct texel texel = reference_load(ref, from, column, row);
        for (int c = 0; c < 4; c++)
            sum.v[c] += weight * texel.v[c];
        weights += weight;
    }
    for (int c = 0; c < 4; c++)
        sum.v[c] /= weights > 0.0 ? weights : 1.0;
    return weights > 0.0 ? sum : unknown(ref, resolution, x, y);
}

struct texel reference_whole(const struct reference *ref, int resolution, int x, int y)
{
    const double none = resolution == SCREEN_AO_RESOLUTION ? 1.0 : 0.0;
    return reference_has_light(ref, resolution, x, y) ? between_cells(ref, resolution, x, y)
                                                      : (struct texel){{none, none, none, none}};
}
