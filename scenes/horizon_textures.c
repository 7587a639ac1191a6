/* SPDX-License-Identifier: MIT
 *
 * Base and detail noise as Schneider 2015 describes them. The weather map is ours: he painted his.
 * Fair-weather cumulus are lobes, hills of round plan, that stand close together where a field of
 * large scale is high and not at all where it is low.
 */
#include "scenes/horizon_textures.h"

#include "scenes/horizon.h"
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

void neph_horizon_fill_base(uint64_t seed, float *base)
{
    enum { SIDE = NEPH_HORIZON_BASE_SIDE, PERIOD = 4, PERLIN_OCTAVES = 3 };
    const struct neph_noise perlin = noise_of(seed, PATTERN_BASE_PERLIN, 3, PERIOD);
    for (int k = 0; k < SIDE; k++)
        for (int j = 0; j < SIDE; j++)
            for (int i = 0; i < SIDE; i++, base += 4) {
                const double point[3] = {(i + 0.5) / SIDE, (j + 0.5) / SIDE, (k + 0.5) / SIDE};
                double octaves[3];
                const double worley = worley_octaves_at(seed, PATTERN_BASE_WORLEY, PERIOD, point,
                                                        octaves);
                const double gradient = clamp01(
                    0.5 + 0.5 * perlin_sum_at(&perlin, PERLIN_OCTAVES, point));
                base[0] = (float)neph_noise_perlin_worley(gradient, worley);
                for (int octave = 0; octave < 3; octave++)
                    base[1 + octave] = (float)octaves[octave];
            }
}

void neph_horizon_fill_detail(uint64_t seed, float *detail)
{
    enum { SIDE = NEPH_HORIZON_DETAIL_SIDE, PERIOD = 2 };
    for (int k = 0; k < SIDE; k++)
        for (int j = 0; j < SIDE; j++)
            for (int i = 0; i < SIDE; i++, detail += 3) {
                const double point[3] = {(i + 0.5) / SIDE, (j + 0.5) / SIDE, (k + 0.5) / SIDE};
                double octaves[3];
                worley_octaves_at(seed, PATTERN_DETAIL_WORLEY, PERIOD, point, octaves);
                for (int octave = 0; octave < 3; octave++)
                    detail[octave] = (float)octaves[octave];
            }
}

/* --- weather --------------------------------------------------------------------------------- */

/* -1..1: where the air rises. */
static double field_at(uint64_t seed, const double point[3])
{
    const struct neph_noise noise = noise_of(seed, PATTERN_FIELD, 2, 5);
    return perlin_sum_at(&noise, 3, point);
}

/* The hill of the lobe in one cell, at a place: 1 at its middle, 0 at its rim and beyond. */
static double lobe_at(uint64_t seed, const struct neph_noise *lobes, const int cell[2],
                      const double at[2])
{
    const double middle[3] = {cell[0] + neph_noise_cell_random(lobes, cell, 0),
                              cell[1] + neph_noise_cell_random(lobes, cell, 1), 0.0};
    const double point[3] = {middle[0] / lobes->period, middle[1] / lobes->period, 0.0};
    const double strength = clamp01(0.35 + 2.4 * field_at(seed, point));
    if (strength <= 0.0)
        return 0.0;
    const double radius = 0.3 + 0.7 * strength;
    const double x = (at[0] - middle[0]) / radius, y = (at[1] - middle[1]) / radius;
    return fmax(0.0, 1.0 - x * x - y * y) * (0.4 + 0.6 * strength);
}

/* The highest hill. A lobe reaches one cell far at most, its middle lies within its own cell. */
static double lobes_at(uint64_t seed, int period, const double point[3])
{
    const struct neph_noise lobes = noise_of(seed, PATTERN_LOBES, 2, period);
    double at[3];
    to_cells(point, period, at);
    double highest = 0.0;
    for (int y = -1; y <= 1; y++)
        for (int x = -1; x <= 1; x++) {
            const int cell[2] = {(int)floor(at[0]) + x, (int)floor(at[1]) + y};
            highest = fmax(highest, lobe_at(seed, &lobes, cell, at));
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

static void weather_texel(uint64_t seed, const double point[3], float texel[4])
{
    const struct neph_noise high = noise_of(seed, PATTERN_HIGH, 2, 6);
    const struct neph_noise density = noise_of(seed, PATTERN_DENSITY, 2, 8);
    double bent[3];
    bend(seed, point, bent);
    const double field = field_at(seed, bent);
    const double lobe = lobes_at(seed, 18, bent);
    texel[0] = (float)(lobe * (2.0 - lobe));
    texel[1] = (float)clamp01(0.5 + 0.6 * field + 0.6 * perlin_sum_at(&high, 3, point));
    texel[2] = (float)clamp01((0.4 + 0.6 * lobe) * (0.9 + 0.6 * field));
    texel[3] = (float)clamp01(0.75 + 0.4 * perlin_sum_at(&density, 2, point));
}

void neph_horizon_fill_weather(uint64_t seed, float *weather)
{
    enum { SIDE = NEPH_HORIZON_WEATHER_SIDE };
    for (int k = 0; k < SIDE; k++)
        for (int i = 0; i < SIDE; i++, weather += 4)
            weather_texel(seed, (const double[3]){(i + 0.5) / SIDE, (k + 0.5) / SIDE, 0.0},
                          weather);
}
