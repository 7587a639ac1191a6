/* SPDX-License-Identifier: MIT
 *
 * Base and detail noise as in Schneider 2015. The weather map is ours; his is painted. Fair-weather
 * cumulus are lobes, round hills, which are dense where a large-scale field is high and absent
 * where it is low.
 */
#include "scenes/horizon_textures.h"

#include "base/threads.h"
#include "scenes/noise.h"

#include <math.h>
#include <stddef.h>

static double clamp01(double x)
{
    return fmin(1.0, fmax(0.0, x));
}

/* Offsets of the patterns' seeds: different patterns for every seed of a scene. */
enum pattern {
    PATTERN_BASE_PERLIN = 0x10,
    PATTERN_BASE_WORLEY = 0x20,
    PATTERN_DETAIL_WORLEY = 0x30,
    PATTERN_FIELD = 0x40,
    PATTERN_LOBES = 0x50,
    PATTERN_WARP = 0x60,
    PATTERN_HIGH = 0x70,
    PATTERN_DENSITY = 0x80,
};

static struct neph_noise make_noise(uint64_t seed, uint64_t pattern, int dimensions, int period)
{
    return (struct neph_noise){(seed << 8) + pattern, dimensions, period};
}

/* The places of a row of texels in their texture, 0..1 along each axis; ROW texels at most. */
enum { ROW = NEPH_HORIZON_WEATHER_SIDE };
struct texel_row {
    int count;
    double along[ROW];
    double across[2];
};

static struct texel_row texel_row(int side, int j, int k)
{
    struct texel_row row = {.count = side, .across = {(j + 0.5) / side, (k + 0.5) / side}};
    for (int i = 0; i < side; i++)
        row.along[i] = (i + 0.5) / side;
    return row;
}

/* The same row in cells of a pattern; `along` is the memory for it. */
static struct neph_noise_row to_cells(const struct texel_row *row, int period, double along[ROW])
{
    for (int i = 0; i < row->count; i++)
        along[i] = row->along[i] * period;
    return (struct neph_noise_row){
        row->count, along, {row->across[0] * period, row->across[1] * period}};
}

static void perlin_row(const struct neph_noise *noise, int octaves, const struct texel_row *texels,
                       double values[ROW])
{
    double along[ROW];
    const struct neph_noise_row row = to_cells(texels, noise->period, along);
    neph_noise_perlin_row(noise, octaves, &row, values);
}

/* Three octaves of Worley noise. */
static void worley_rows(uint64_t seed, uint64_t pattern, int period, const struct texel_row *texels,
                        double octaves[3][ROW])
{
    for (int o = 0; o < 3; o++) {
        double along[ROW];
        const struct neph_noise noise = make_noise(seed, pattern + (uint64_t)o, 3, period << o);
        const struct neph_noise_row row = to_cells(texels, noise.period, along);
        neph_noise_worley_row(&noise, &row, octaves[o]);
    }
}

/* A texture that is filled slice by slice. */
struct filling {
    uint64_t seed;
    float *texels;
};

static void fill_base_row(uint64_t seed, const struct texel_row *row, float *base)
{
    enum { PERIOD = 4, PERLIN_OCTAVES = 3 };
    const struct neph_noise noise = make_noise(seed, PATTERN_BASE_PERLIN, 3, PERIOD);
    double perlin[ROW], octaves[3][ROW];
    perlin_row(&noise, PERLIN_OCTAVES, row, perlin);
    worley_rows(seed, PATTERN_BASE_WORLEY, PERIOD, row, octaves);
    for (int i = 0; i < row->count; i++, base += 4) {
        const double worley = 0.625 * octaves[0][i] + 0.25 * octaves[1][i] + 0.125 * octaves[2][i];
        base[0] = (float)neph_noise_perlin_worley(clamp01(0.5 + 0.5 * perlin[i]), worley);
        for (int o = 0; o < 3; o++)
            base[1 + o] = (float)octaves[o][i];
    }
}

static void fill_base_slice(int k, void *context)
{
    enum { SIDE = NEPH_HORIZON_BASE_SIDE };
    const struct filling *filling = context;
    for (int j = 0; j < SIDE; j++) {
        const struct texel_row row = texel_row(SIDE, j, k);
        fill_base_row(filling->seed, &row, filling->texels + (size_t)(k * SIDE + j) * SIDE * 4);
    }
}

enum neph_status neph_horizon_fill_base(uint64_t seed, float *base, struct neph_diag *diag)
{
    struct filling filling = {seed, base};
    return neph_parallel_rows(NEPH_HORIZON_BASE_SIDE, fill_base_slice, &filling, diag);
}

static void fill_detail_slice(int k, void *context)
{
    enum { SIDE = NEPH_HORIZON_DETAIL_SIDE, PERIOD = 2 };
    const struct filling *filling = context;
    float *detail = filling->texels + (size_t)k * SIDE * SIDE * 3;
    for (int j = 0; j < SIDE; j++) {
        const struct texel_row row = texel_row(SIDE, j, k);
        double octaves[3][ROW];
        worley_rows(filling->seed, PATTERN_DETAIL_WORLEY, PERIOD, &row, octaves);
        for (int i = 0; i < SIDE; i++)
            for (int o = 0; o < 3; o++)
                *detail++ = (float)octaves[o][i];
    }
}

enum neph_status neph_horizon_fill_detail(uint64_t seed, float *detail, struct neph_diag *diag)
{
    struct filling filling = {seed, detail};
    return neph_parallel_rows(NEPH_HORIZON_DETAIL_SIDE, fill_detail_slice, &filling, diag);
}

/* --- weather --------------------------------------------------------------------------------- */

/* Large-scale updraft, -1..1, at a point of the map, 0..1 along both axes. */
static double field_at(uint64_t seed, const double point[2])
{
    enum { PERIOD = 5 };
    const struct neph_noise noise = make_noise(seed, PATTERN_FIELD, 2, PERIOD);
    return neph_noise_perlin_sum(&noise, 3,
                                 (const double[2]){point[0] * PERIOD, point[1] * PERIOD});
}

/* A round hill, in cells; one in each cell of the plane. */
enum { LOBES = 18 }; /* along a side */
struct lobe {
    double middle[2]; /* within its cell */
    double radius;    /* at most 1: it overlaps only neighbouring cells */
    double height;
};

/* Hills are high and wide where the updraft is strong, and absent elsewhere. */
static void raise_lobes(uint64_t seed, struct lobe lobes[LOBES][LOBES])
{
    const struct neph_noise noise = make_noise(seed, PATTERN_LOBES, 2, LOBES);
    for (int y = 0; y < LOBES; y++)
        for (int x = 0; x < LOBES; x++) {
            const int cell[2] = {x, y};
            const double middle[2] = {neph_noise_cell_random(&noise, cell, 0),
                                      neph_noise_cell_random(&noise, cell, 1)};
            const double point[2] = {(x + middle[0]) / LOBES, (y + middle[1]) / LOBES};
            const double strength = clamp01(0.35 + 2.4 * field_at(seed, point));
            lobes[y][x] = (struct lobe){{middle[0], middle[1]},
                                        0.3 + 0.7 * strength,
                                        strength > 0.0 ? 0.4 + 0.6 * strength : 0.0};
        }
}

/* The highest hill at a place: the height of its lobe at the centre, 0 at the rim and beyond. */
static double hill_at(struct lobe lobes[LOBES][LOBES], const double point[2])
{
    double highest = 0.0;
    const double at[2] = {point[0] * LOBES, point[1] * LOBES};
    const double low[2] = {floor(at[0]), floor(at[1])};
    for (int y = -1; y <= 1; y++)
        for (int x = -1; x <= 1; x++) {
            const int column = ((int)low[0] + x + LOBES) % LOBES;
            const int row = ((int)low[1] + y + LOBES) % LOBES;
            const struct lobe *lobe = &lobes[row][column];
            const double dx = (at[0] - low[0] - x - lobe->middle[0]) / lobe->radius;
            const double dy = (at[1] - low[1] - y - lobe->middle[1]) / lobe->radius;
            const double height = (1.0 - dx * dx - dy * dy) * lobe->height;
            if (height > highest) /* fmax() may return -0 where there is no hill */
                highest = height;
        }
    return highest;
}

/* Deforms the plane, so that outlines are not circles: displacement of a row along `axis`. */
static void bend_row(uint64_t seed, int axis, const struct texel_row *row, double by[ROW])
{
    const double reach = 0.012;
    const struct neph_noise noise = make_noise(seed, PATTERN_WARP + 8 * (uint64_t)axis, 2, 24);
    perlin_row(&noise, 2, row, by);
    for (int i = 0; i < row->count; i++)
        by[i] *= reach;
}

struct weather_filling {
    uint64_t seed;
    float *weather;
    struct lobe lobes[LOBES][LOBES];
};

static void fill_weather_row(int k, void *context)
{
    enum { SIDE = NEPH_HORIZON_WEATHER_SIDE };
    struct weather_filling *filling = context;
    const uint64_t seed = filling->seed;
    const struct neph_noise high_noise = make_noise(seed, PATTERN_HIGH, 2, 6);
    const struct neph_noise density_noise = make_noise(seed, PATTERN_DENSITY, 2, 8);
    const struct texel_row row = texel_row(SIDE, k, 0);
    double bent[2][ROW], high[ROW], density[ROW];
    for (int axis = 0; axis < 2; axis++)
        bend_row(seed, axis, &row, bent[axis]);
    perlin_row(&high_noise, 3, &row, high);
    perlin_row(&density_noise, 2, &row, density);
    float *texel = filling->weather + (size_t)k * SIDE * 4;
    for (int i = 0; i < SIDE; i++, texel += 4) {
        const double point[2] = {row.along[i] + bent[0][i], row.across[0] + bent[1][i]};
        const double field = field_at(seed, point);
        const double hill = hill_at(filling->lobes, point);
        texel[0] = (float)(hill * (2.0 - hill));
        texel[1] = (float)clamp01(0.5 + 0.6 * field + 0.6 * high[i]);
        texel[2] = (float)clamp01((0.4 + 0.6 * hill) * (0.9 + 0.6 * field));
        texel[3] = (float)clamp01(0.75 + 0.4 * density[i]);
    }
}

enum neph_status neph_horizon_fill_weather(uint64_t seed, float *weather, struct neph_diag *diag)
{
    struct weather_filling filling = {.seed = seed, .weather = weather};
    raise_lobes(seed, filling.lobes);
    return neph_parallel_rows(NEPH_HORIZON_WEATHER_SIDE, fill_weather_row, &filling, diag);
}
