/* SPDX-License-Identifier: MIT
 *
 * Base and detail noise as Schneider 2015 describes them. The weather map is ours: he painted his.
 * Fair-weather cumulus are lobes, hills of round plan, that stand close together where a field of
 * large scale is high and not at all where it is low.
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

/* The seeds of the patterns, apart from each other for all seeds of a scene. */
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

static struct neph_noise noise_of(uint64_t seed, uint64_t pattern, int dimensions, int period)
{
    return (struct neph_noise){(seed << 8) + pattern, dimensions, period};
}

/* A point of a texture, 0..1 along each axis, in the cells of a pattern. */
static void to_cells(const double point[3], int period, double cells[3])
{
    for (int axis = 0; axis < 3; axis++)
        cells[axis] = point[axis] * period;
}

static double perlin_sum_at(const struct neph_noise *noise, int octaves, const double point[3])
{
    double cells[3];
    to_cells(point, noise->period, cells);
    return neph_noise_perlin_sum(noise, octaves, cells);
}

static double worley_at(const struct neph_noise *noise, const double point[3])
{
    double cells[3];
    to_cells(point, noise->period, cells);
    return neph_noise_worley(noise, cells);
}

/* Three octaves of Worley noise in octaves[0..2]; their sum with the weights of the shape. */
static double worley_octaves_at(uint64_t seed, uint64_t pattern, int period, const double point[3],
                                double octaves[3])
{
    for (int i = 0; i < 3; i++) {
        const struct neph_noise noise = noise_of(seed, pattern + (uint64_t)i, 3, period << i);
        octaves[i] = worley_at(&noise, point);
    }
    return 0.625 * octaves[0] + 0.25 * octaves[1] + 0.125 * octaves[2];
}

/* A texture, slice by slice. */
struct filling {
    uint64_t seed;
    float *texels;
};

static void fill_base_slice(int k, void *context)
{
    enum { SIDE = NEPH_HORIZON_BASE_SIDE, PERIOD = 4, PERLIN_OCTAVES = 3 };
    const struct filling *filling = context;
    const uint64_t seed = filling->seed;
    const struct neph_noise perlin = noise_of(seed, PATTERN_BASE_PERLIN, 3, PERIOD);
    float *base = filling->texels + (size_t)k * SIDE * SIDE * 4;
    for (int j = 0; j < SIDE; j++)
        for (int i = 0; i < SIDE; i++, base += 4) {
            const double point[3] = {(i + 0.5) / SIDE, (j + 0.5) / SIDE, (k + 0.5) / SIDE};
            double octaves[3];
            const double worley = worley_octaves_at(seed, PATTERN_BASE_WORLEY, PERIOD, point,
                                                    octaves);
            const double gradient = clamp01(0.5 +
                                            0.5 * perlin_sum_at(&perlin, PERLIN_OCTAVES, point));
            base[0] = (float)neph_noise_perlin_worley(gradient, worley);
            for (int octave = 0; octave < 3; octave++)
                base[1 + octave] = (float)octaves[octave];
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
    for (int j = 0; j < SIDE; j++)
        for (int i = 0; i < SIDE; i++, detail += 3) {
            const double point[3] = {(i + 0.5) / SIDE, (j + 0.5) / SIDE, (k + 0.5) / SIDE};
            double octaves[3];
            worley_octaves_at(filling->seed, PATTERN_DETAIL_WORLEY, PERIOD, point, octaves);
            for (int octave = 0; octave < 3; octave++)
                detail[octave] = (float)octaves[octave];
        }
}

enum neph_status neph_horizon_fill_detail(uint64_t seed, float *detail, struct neph_diag *diag)
{
    struct filling filling = {seed, detail};
    return neph_parallel_rows(NEPH_HORIZON_DETAIL_SIDE, fill_detail_slice, &filling, diag);
}

/* --- weather --------------------------------------------------------------------------------- */

/* -1..1: where the air rises. */
static double field_at(uint64_t seed, const double point[3])
{
    const struct neph_noise noise = noise_of(seed, PATTERN_FIELD, 2, 5);
    return perlin_sum_at(&noise, 3, point);
}

/* A hill of round plan, in cells; one cell of the plane has one. */
enum { LOBES = 18 }; /* along a side */
struct lobe {
    double middle[2]; /* within its cell */
    double radius;    /* 1 at most: it reaches the next cells alone */
    double height;
};

/* Where the air rises hills are high and wide, elsewhere there are none. */
static void raise_lobes(uint64_t seed, struct lobe lobes[LOBES][LOBES])
{
    const struct neph_noise noise = noise_of(seed, PATTERN_LOBES, 2, LOBES);
    for (int y = 0; y < LOBES; y++)
        for (int x = 0; x < LOBES; x++) {
            const int cell[2] = {x, y};
            const double middle[2] = {neph_noise_cell_random(&noise, cell, 0),
                                      neph_noise_cell_random(&noise, cell, 1)};
            const double point[3] = {(x + middle[0]) / LOBES, (y + middle[1]) / LOBES, 0.0};
            const double strength = clamp01(0.35 + 2.4 * field_at(seed, point));
            lobes[y][x] = (struct lobe){{middle[0], middle[1]},
                                        0.3 + 0.7 * strength,
                                        strength > 0.0 ? 0.4 + 0.6 * strength : 0.0};
        }
}

/* The highest hill at a place: the height of its lobe in the middle, 0 at the rim and beyond. */
static double hill_at(struct lobe lobes[LOBES][LOBES], const double point[3])
{
    double at[3], highest = 0.0;
    to_cells(point, LOBES, at);
    const double low[2] = {floor(at[0]), floor(at[1])};
    for (int y = -1; y <= 1; y++)
        for (int x = -1; x <= 1; x++) {
            const int column = ((int)low[0] + x + LOBES) % LOBES;
            const int row = ((int)low[1] + y + LOBES) % LOBES;
            const struct lobe *lobe = &lobes[row][column];
            const double dx = (at[0] - low[0] - x - lobe->middle[0]) / lobe->radius;
            const double dy = (at[1] - low[1] - y - lobe->middle[1]) / lobe->radius;
            const double height = (1.0 - dx * dx - dy * dy) * lobe->height;
            if (height > highest) /* fmax() may answer -0 where there is no hill */
                highest = height;
        }
    return highest;
}

/* Outlines are not circles: the plane is bent a little. */
static void bend(uint64_t seed, const double point[3], double bent[3])
{
    const double reach = 0.012;
    for (int axis = 0; axis < 2; axis++) {
        const struct neph_noise noise = noise_of(seed, PATTERN_WARP + 8 * (uint64_t)axis, 2, 24);
        bent[axis] = point[axis] + reach * perlin_sum_at(&noise, 2, point);
    }
    bent[2] = 0.0;
}

static void weather_texel(uint64_t seed, struct lobe lobes[LOBES][LOBES], const double point[3],
                          float texel[4])
{
    const struct neph_noise high = noise_of(seed, PATTERN_HIGH, 2, 6);
    const struct neph_noise density = noise_of(seed, PATTERN_DENSITY, 2, 8);
    double bent[3];
    bend(seed, point, bent);
    const double field = field_at(seed, bent);
    const double hill = hill_at(lobes, bent);
    texel[0] = (float)(hill * (2.0 - hill));
    texel[1] = (float)clamp01(0.5 + 0.6 * field + 0.6 * perlin_sum_at(&high, 3, point));
    texel[2] = (float)clamp01((0.4 + 0.6 * hill) * (0.9 + 0.6 * field));
    texel[3] = (float)clamp01(0.75 + 0.4 * perlin_sum_at(&density, 2, point));
}

void neph_horizon_fill_weather(uint64_t seed, float *weather)
{
    enum { SIDE = NEPH_HORIZON_WEATHER_SIDE };
    struct lobe lobes[LOBES][LOBES];
    raise_lobes(seed, lobes);
    for (int k = 0; k < SIDE; k++)
        for (int i = 0; i < SIDE; i++, weather += 4)
            weather_texel(seed, lobes, (const double[3]){(i + 0.5) / SIDE, (k + 0.5) / SIDE, 0.0},
                          weather);
}
