/* SPDX-License-Identifier: MIT
 *
 * From one pixel of each cell to all.
 */
#include "tests/renderer/twins/screen.h"

#include <math.h>

/* How much two pixels are one surface: 1 on one plane. */
static double likeness(const struct twin_screen *twin, int x, int y, struct twin_pixel at)
{
    const struct neph_vec3 normal = twin_screen_normal(twin, x, y);
    const struct neph_vec3 way_m = neph_vec3_sub(twin_screen_surface_m(twin, at.x, at.y),
                                                 twin_screen_surface_m(twin, x, y));
    const double distance_m = neph_vec3_length(way_m);
    const double slope = distance_m > 0.0 ? fabs(neph_vec3_dot(way_m, normal)) / distance_m : 0.0;
    const double facing = neph_vec3_dot(twin_screen_normal(twin, at.x, at.y), normal);
    return facing < 0.1 ? 0.0 : fmax(1e-4, 1.0 - slope / 0.1) * pow(fmin(1.0, facing), 8.0);
}

static struct texel unknown(const struct twin_screen *twin, int resolution, int x, int y)
{
    return resolution == SCREEN_AO_RESOLUTION
               ? (struct texel){{1.0, 1.0, 1.0, 1.0}}
               : (struct texel){{0.0, 0.0, 0.0, twin_screen_open(twin, x, y)}};
}

static struct texel between_cells(const struct twin_screen *twin, int resolution, int x, int y)
{
    const int from = twin_screen_cells_at(twin, resolution);
    const int side = twin_screen_cell_px(twin, resolution);
    const struct twin_pixel first = twin_screen_pixel_in(twin, resolution, 0, 0);
    const double across = (double)(x - first.x) / side, down = (double)(y - first.y) / side;
    struct texel sum = {{0.0}};
    double weights = 0.0;
    for (int i = 0; i < 4; i++) {
        const int column = (int)floor(across) + i % 2, row = (int)floor(down) + i / 2;
        if (column < 0 || row < 0 || side * column >= twin->width_px ||
            side * row >= twin->height_px)
            continue;
        const struct twin_pixel at = twin_screen_pixel_in(twin, resolution, column, row);
        const double share = (1.0 - fabs(across - column)) * (1.0 - fabs(down - row));
        if (!twin_screen_has_light(twin, resolution, at.x, at.y))
            continue;
        const double weight = share * likeness(twin, x, y, at);
        const struct texel texel = twin_screen_load(twin, from, column, row);
        for (int c = 0; c < 4; c++)
            sum.v[c] += weight * texel.v[c];
        weights += weight;
    }
    for (int c = 0; c < 4; c++)
        sum.v[c] /= weights > 0.0 ? weights : 1.0;
    return weights > 0.0 ? sum : unknown(twin, resolution, x, y);
}

struct texel twin_screen_whole(const struct twin_screen *twin, int resolution, int x, int y)
{
    const double none = resolution == SCREEN_AO_RESOLUTION ? 1.0 : 0.0;
    return twin_screen_has_light(twin, resolution, x, y) ? between_cells(twin, resolution, x, y)
                                                         : (struct texel){{none, none, none, none}};
}
