/* SPDX-License-Identifier: MIT */
#include "scenes/horizon.h"

#include "scenes/horizon_density.h"
#include "scenes/horizon_textures.h"

#include <math.h>
#include <stdlib.h>

#define BASE_TEXELS (NEPH_HORIZON_BASE_SIDE * NEPH_HORIZON_BASE_SIDE * NEPH_HORIZON_BASE_SIDE)
#define DETAIL_TEXELS                                                                              \
    (NEPH_HORIZON_DETAIL_SIDE * NEPH_HORIZON_DETAIL_SIDE * NEPH_HORIZON_DETAIL_SIDE)
#define WEATHER_TEXELS (NEPH_HORIZON_WEATHER_SIDE * NEPH_HORIZON_WEATHER_SIDE)

enum {
    BASE_BLOCKS = NEPH_HORIZON_BASE_SIDE / NEPH_HORIZON_BLOCK,
    DETAIL_BLOCKS = NEPH_HORIZON_DETAIL_SIDE / NEPH_HORIZON_BLOCK,
    WEATHER_BLOCKS = NEPH_HORIZON_WEATHER_SIDE / NEPH_HORIZON_BLOCK,
};

/* fmin and fmax, here and below, would be calls in the innermost loops. */
static float smaller(float a, float b)
{
    return a < b ? a : b;
}

static float larger(float a, float b)
{
    return a > b ? a : b;
}

/* NaN becomes 0. */
static double clamp01(double x)
{
    const double above_0 = x > 0.0 ? x : 0.0;
    return above_0 < 1.0 ? above_0 : 1.0;
}

/* Weighted sum of octaves of noise; the weights are the same everywhere. */
static double octave_sum(const double octaves[3])
{
    return 0.625 * octaves[0] + 0.25 * octaves[1] + 0.125 * octaves[2];
}

/* --- the formulas of horizon.h, each with its limits ----------------------------------------- */

struct weather {
    double low, high, peak, density;
};

static double bound_coverage(const struct neph_horizon_params *params, double low, double high)
{
    const double from_high = 2.0 * high * clamp01(params->coverage - 0.5);
    return params->coverage * (low > from_high ? low : from_high);
}

/* The limit of the falling side for a peak of 0: no cloud. */
static double shape_below_peak(double height, double peak)
{
    return peak > 0.0 ? clamp01(1.0 - 1.125 * (height / peak - 0.2)) : 0.0;
}

static double shape_above_bottom(double height)
{
    return clamp01(height / 0.07);
}

static double mass_above_bottom(double height)
{
    return height * clamp01(height / 0.15);
}

static double mass_below_top(double height)
{
    return clamp01(1.0 - 8.0 * (height - 0.9));
}

static double base_noise(double perlin_worley, double octaves)
{
    return (perlin_worley + 1.0 - octaves) / (2.0 - octaves);
}

/* Clouds begin where `base` exceeds 1 - w; as w goes to 0 nothing does, for base < 1. */
static double compute_shape(double base, double coverage)
{
    return coverage > 0.0 ? clamp01((base - 1.0 + coverage) / coverage) : 0.0;
}

/* Where the sum is 0 its first octave is 0, too, so the detail is 0. */
static double detail_noise(const double octaves[3])
{
    const double sum = octave_sum(octaves);
    return sum > 0.0 ? clamp01((octaves[0] - 1.0 + sum) / sum) : 0.0;
}

static double erosion(const struct neph_horizon_params *params, double detail, double height)
{
    const double turned = clamp01(1.8 * height);
    return 0.8 * exp(-0.75 * params->coverage) * (detail + turned * (1.0 - 2.0 * detail));
}

static double eroded_shape(double shape, double erosion)
{
    return clamp01((shape - erosion) / (1.0 - erosion));
}

/* --- lookups --------------------------------------------------------------------------------- */

/* Two neighbouring texels along one axis, and the place between them, 0..1. `repeats` is a
 * coordinate in repeats of the texture. `side` is a power of two. */
struct pair {
    int texel[2];
    double between;
};

static struct pair pair_at(double repeats, int side)
{
    const double at = (repeats - floor(repeats)) * side - 0.5;
    const int texel = at < 0.0 ? -1 : (int)at; /* floor(at) without a call; at is -0.5 at least */
    return (struct pair){{texel & (side - 1), (texel + 1) & (side - 1)}, at - texel};
}

static double lerp(double a, double b, double t)
{
    return a + t * (b - a);
}

/* All channels at a place in repeats along x, z. */
static void lookup_2d(const float *texels, int side, int channels, const double repeats[2],
                      double values[4])
{
    const struct pair x = pair_at(repeats[0], side), z = pair_at(repeats[1], side);
    const float *rows[2] = {texels + (size_t)(z.texel[0] * side * channels),
                            texels + (size_t)(z.texel[1] * side * channels)};
    const int a = x.texel[0] * channels, b = x.texel[1] * channels;
    for (int c = 0; c < channels; c++)
        values[c] = lerp(lerp(rows[0][a + c], rows[0][b + c], x.between),
                         lerp(rows[1][a + c], rows[1][b + c], x.between), z.between);
}

/* The same along x, y, z. */
static void lookup_3d(const float *texels, int side, int channels, const double repeats[3],
                      double values[4])
{
    const struct pair y = pair_at(repeats[1], side), z = pair_at(repeats[2], side);
    const struct pair x = pair_at(repeats[0], side);
    const int a = x.texel[0] * channels, b = x.texel[1] * channels;
    const float *rows[4];
    for (int row = 0; row < 4; row++)
        rows[row] = texels +
                    (size_t)((z.texel[row >> 1] * side + y.texel[row & 1]) * side * channels);
    for (int c = 0; c < channels; c++)
        values[c] = lerp(lerp(lerp(rows[0][a + c], rows[0][b + c], x.between),
                              lerp(rows[1][a + c], rows[1][b + c], x.between), y.between),
                         lerp(lerp(rows[2][a + c], rows[2][b + c], x.between),
                              lerp(rows[3][a + c], rows[3][b + c], x.between), y.between),
                         z.between);
}

static void noise_at(const struct neph_horizon *horizon, const float *texels, int side,
                     int channels, double repeats_per_scale, struct neph_vec3 point_m,
                     double values[4])
{
    const struct neph_horizon_params *params = &horizon->params;
    const struct neph_vec3 repeats = neph_vec3_scale(neph_vec3_sub(point_m, params->wind_m),
                                                     repeats_per_scale / params->texture_scale_m);
    lookup_3d(texels, side, channels, (const double[3]){repeats.x, repeats.y, repeats.z}, values);
}

static struct weather weather_at(const struct neph_horizon *horizon, struct neph_vec3 point_m)
{
    const struct neph_horizon_params *params = &horizon->params;
    const double repeats[2] = {(point_m.x - params->wind_m.x) / params->texture_scale_m,
                               (point_m.z - params->wind_m.z) / params->texture_scale_m};
    double values[4];
    lookup_2d(horizon->weather, NEPH_HORIZON_WEATHER_SIDE, 4, repeats, values);
    return (struct weather){values[0], values[1], values[2], values[3]};
}

/* --- density --------------------------------------------------------------------------------- */

/* |p - c| - r as a quotient without cancellation in the numerator:
 * with y from the bottom, |p - c|^2 - r^2 = x^2 + z^2 + y (y + 2 r). */
double neph_horizon_altitude_m(const struct neph_horizon_params *params, struct neph_vec3 point_m)
{
    const double r_m = params->planet_radius_m, y_m = point_m.y - params->bottom_m;
    const double level_squared = point_m.x * point_m.x + point_m.z * point_m.z;
    return (level_squared + y_m * (y_m + 2.0 * r_m)) /
           (sqrt(level_squared + (y_m + r_m) * (y_m + r_m)) + r_m);
}

/* The bits of neph_horizon_sample.sides. */
static unsigned find_sides(const struct neph_horizon_params *params, const struct weather *weather,
                           double height, double base, const double octaves[3])
{
    const double sum = octave_sum(octaves);
    const bool sides[] = {
        true,
        weather->low > 2.0 * weather->high * clamp01(params->coverage - 0.5),
        height > 0.07,
        height > 0.2 * weather->peak,
        height > 0.15,
        height > 0.9,
        1.8 * height > 1.0,
        base > 1.0,
        octaves[0] + sum > 1.0,
    };
    unsigned bits = 0;
    for (size_t i = 0; i < sizeof(sides) / sizeof(sides[0]); i++)
        bits |= (unsigned)sides[i] << i;
    return bits;
}

void neph_horizon_sample(const struct neph_horizon *horizon, struct neph_vec3 point_m,
                         struct neph_horizon_sample *sample)
{
    const struct neph_horizon_params *params = &horizon->params;
    *sample = (struct neph_horizon_sample){.margin = -1.0};
    const double height = neph_horizon_altitude_m(params, point_m) / params->thickness_m;
    if (!(height >= 0.0 && height <= 1.0))
        return;
    const struct weather weather = weather_at(horizon, point_m);
    const double coverage = bound_coverage(params, weather.low, weather.high);
    const double profile = shape_above_bottom(height) * shape_below_peak(height, weather.peak);
    sample->margin = profile - 1.0 + coverage; /* base noise is at most 1 */
    if (sample->margin <= 0.0)
        return;
    double noise[4];
    noise_at(horizon, horizon->base, NEPH_HORIZON_BASE_SIDE, 4, params->base_repeats, point_m,
             noise);
    const double base = profile * base_noise(noise[0], octave_sum(&noise[1]));
    sample->margin = base - 1.0 + coverage;
    if (sample->margin <= 0.0)
        return;
    double octaves[4];
    noise_at(horizon, horizon->detail, NEPH_HORIZON_DETAIL_SIDE, 3, params->detail_repeats, point_m,
             octaves);
    const double shape = compute_shape(base, coverage);
    const double eroded = erosion(params, detail_noise(octaves), height);
    const double mass = 2.0 * params->density * weather.density * mass_above_bottom(height) *
                        mass_below_top(height);
    sample->margin -= eroded * coverage;
    sample->density = eroded_shape(shape, eroded) * mass;
    sample->without_detail = shape * mass;
    if (sample->density > 0.0)
        sample->sides = find_sides(params, &weather, height, base, octaves);
}

double neph_horizon_density(const struct neph_horizon *horizon, struct neph_vec3 point_m,
                            double *without_detail)
{
    struct neph_horizon_sample sample;
    neph_horizon_sample(horizon, point_m, &sample);
    if (without_detail)
        *without_detail = sample.without_detail;
    return sample.density;
}

/* --- bound ----------------------------------------------------------------------------------- */

struct range {
    double low, high;
};

static double nearest_to_0(struct range range)
{
    return fmax(0.0, fmax(range.low, -range.high));
}

static double farthest_from_0(struct range range)
{
    return fmax(fabs(range.low), fabs(range.high));
}

/* The range of the altitude over a box: at its points nearest to and farthest from the planet's
 * centre. */
static struct range altitude_range_m(const struct neph_horizon_params *params,
                                     const struct neph_bounds *box)
{
    const double center_y_m = params->bottom_m - params->planet_radius_m;
    const struct range x = {box->min_m.x, box->max_m.x}, z = {box->min_m.z, box->max_m.z};
    const struct range y = {box->min_m.y - center_y_m, box->max_m.y - center_y_m};
    /* On the axis the sides to which the altitude is relative keep their digits. */
    const double near_y_m = y.low > 0.0 ? box->min_m.y : y.high < 0.0 ? box->max_m.y : center_y_m;
    const double far_y_m = fabs(y.high) >= fabs(y.low) ? box->max_m.y : box->min_m.y;
    const struct neph_vec3 near_m = {nearest_to_0(x), near_y_m, nearest_to_0(z)};
    const struct neph_vec3 far_m = {farthest_from_0(x), far_y_m, farthest_from_0(z)};
    const bool endless = isinf(far_m.x) || isinf(far_m.y) || isinf(far_m.z);
    return (struct range){neph_horizon_altitude_m(params, near_m),
                          endless ? INFINITY : neph_horizon_altitude_m(params, far_m)};
}

/* The blocks that lookups between two coordinates read: `count` of them from `first` on, wrapping
 * around. Slightly wider than the range, for the rounding of lookups. */
struct blocks {
    int first, count;
};

static struct blocks find_blocks(double low_m, double high_m, double repeats_per_m, int block_count)
{
    const double per_m = repeats_per_m * block_count;
    const double half_texel = 0.5 / NEPH_HORIZON_BLOCK, hair = 1e-6;
    if (!((high_m - low_m) * per_m < block_count - 1))
        return (struct blocks){0, block_count};
    const double first = floor(low_m * per_m - half_texel - hair);
    const double last = floor(high_m * per_m - half_texel + hair);
    const double turns = floor(first / block_count);
    return (struct blocks){(int)(first - turns * block_count), (int)(last - first) + 1};
}

/* The largest value of each channel over the blocks that a box touches. */
static struct weather bound_weather(const struct neph_horizon *horizon,
                                    const struct neph_bounds *box)
{
    const struct neph_horizon_params *params = &horizon->params;
    const double per_m = 1.0 / params->texture_scale_m;
    const struct blocks x = find_blocks(box->min_m.x - params->wind_m.x,
                                        box->max_m.x - params->wind_m.x, per_m, WEATHER_BLOCKS);
    const struct blocks z = find_blocks(box->min_m.z - params->wind_m.z,
                                        box->max_m.z - params->wind_m.z, per_m, WEATHER_BLOCKS);
    float most[4] = {0, 0, 0, 0};
    for (int k = 0; k < z.count; k++)
        for (int i = 0; i < x.count; i++) {
            const int at = (z.first + k) % WEATHER_BLOCKS * WEATHER_BLOCKS +
                           (x.first + i) % WEATHER_BLOCKS;
            for (int c = 0; c < 4; c++)
                most[c] = larger(most[c], horizon->weather_blocks[4 * at + c]);
        }
    return (struct weather){most[0], most[1], most[2], most[3]};
}

/* The blocks of a noise that a box touches, along x, y, z. */
static void find_noise_blocks(const struct neph_horizon_params *params,
                              const struct neph_bounds *box, double repeats, int block_count,
                              struct blocks along[3])
{
    const double per_m = repeats / params->texture_scale_m;
    const struct neph_vec3 low_m = neph_vec3_sub(box->min_m, params->wind_m);
    const struct neph_vec3 high_m = neph_vec3_sub(box->max_m, params->wind_m);
    along[0] = find_blocks(low_m.x, high_m.x, per_m, block_count);
    along[1] = find_blocks(low_m.y, high_m.y, per_m, block_count);
    along[2] = find_blocks(low_m.z, high_m.z, per_m, block_count);
}

static int block_at(const struct blocks along[3], int block_count, int i, int j, int k)
{
    const int x = (along[0].first + i) % block_count, y = (along[1].first + j) % block_count,
              z = (along[2].first + k) % block_count;
    return (z * block_count + y) * block_count + x;
}

static double bound_base_noise(const struct neph_horizon *horizon, const struct neph_bounds *box)
{
    struct blocks along[3];
    find_noise_blocks(&horizon->params, box, horizon->params.base_repeats, BASE_BLOCKS, along);
    float most = 0.0f;
    for (int k = 0; k < along[2].count; k++)
        for (int j = 0; j < along[1].count; j++)
            for (int i = 0; i < along[0].count; i++)
                most = larger(most, horizon->base_blocks[block_at(along, BASE_BLOCKS, i, j, k)]);
    return most;
}

static struct range bound_detail_noise(const struct neph_horizon *horizon,
                                       const struct neph_bounds *box)
{
    struct blocks along[3];
    find_noise_blocks(&horizon->params, box, horizon->params.detail_repeats, DETAIL_BLOCKS, along);
    float low = 1.0f, high = 0.0f;
    for (int k = 0; k < along[2].count; k++)
        for (int j = 0; j < along[1].count; j++)
            for (int i = 0; i < along[0].count; i++) {
                const float *block =
                    &horizon->detail_blocks[2 * block_at(along, DETAIL_BLOCKS, i, j, k)];
                low = smaller(low, block[0]);
                high = larger(high, block[1]);
            }
    return (struct range){low, high};
}

/* The least erosion over a box. Erosion is linear in detail and in height except for the clamp,
 * which is monotone, so its minimum is at a corner. */
static double bound_erosion(const struct neph_horizon *horizon, const struct neph_bounds *box,
                            double low, double high)
{
    const struct neph_horizon_params *params = &horizon->params;
    const struct range detail = bound_detail_noise(horizon, box);
    return fmin(fmin(erosion(params, detail.low, low), erosion(params, detail.low, high)),
                fmin(erosion(params, detail.high, low), erosion(params, detail.high, high)));
}

/* An upper bound from the extremes of all quantities in the box, because each factor of the density
 * is monotone in each of them: the shape grows with coverage, peak and base noise and falls with
 * the erosion; both profiles are a rising times a falling function of the height. */
double neph_horizon_bound(const struct neph_horizon *horizon, const struct neph_bounds *box)
{
    const struct neph_horizon_params *params = &horizon->params;
    const double margin = 1e-9; /* far above the rounding errors below */
    const struct range altitude = altitude_range_m(params, box);
    const struct range height = {altitude.low / params->thickness_m - margin,
                                 altitude.high / params->thickness_m + margin};
    if (!(height.low <= 1.0 && height.high >= 0.0))
        return 0.0;
    const double low = fmax(0.0, height.low), high = fmin(1.0, height.high);
    const struct weather weather = bound_weather(horizon, box);
    const double coverage = bound_coverage(params, weather.low, weather.high);
    const double profile = shape_above_bottom(high) * shape_below_peak(low, weather.peak);
    if (profile * (1.0 + margin) <= 1.0 - coverage)
        return 0.0;
    const double base = profile * bound_base_noise(horizon, box) + margin;
    const double shape = fmin(1.0, compute_shape(base, coverage) * (1.0 + margin));
    const double eroded = fmax(0.0, bound_erosion(horizon, box, low, high) - margin);
    return (1.0 + margin) * eroded_shape(shape, eroded) * 2.0 * params->density * weather.density *
           mass_above_bottom(high) * mass_below_top(low);
}

struct neph_bounds neph_horizon_support(const struct neph_horizon *horizon,
                                        const struct neph_bounds *bounds)
{
    const struct neph_horizon_params *params = &horizon->params;
    const double center_y_m = params->bottom_m - params->planet_radius_m;
    const double top_m = params->planet_radius_m + params->thickness_m;
    struct neph_bounds support = {{-top_m, center_y_m - top_m, -top_m},
                                  {top_m, params->bottom_m + params->thickness_m, top_m}};
    const double x_m = farthest_from_0((struct range){bounds->min_m.x, bounds->max_m.x});
    const double z_m = farthest_from_0((struct range){bounds->min_m.z, bounds->max_m.z});
    const double level_squared = x_m * x_m + z_m * z_m;
    const double r_m = params->planet_radius_m;
    if (bounds->min_m.y >= center_y_m && level_squared < r_m * r_m) /* curvature of the layer */
        support.min_m.y = params->bottom_m -
                          level_squared / (r_m + sqrt(r_m * r_m - level_squared));
    return support;
}

/* --- tables of the bound --------------------------------------------------------------------- */

/* B of a texel of the base noise, or D of a texel of the detail noise. */
typedef double (*noise_of_texel)(const float *texel);

static double combine_base_noise(const float *texel)
{
    return base_noise(texel[0], octave_sum((const double[3]){texel[1], texel[2], texel[3]}));
}

static double combine_detail_noise(const float *texel)
{
    return detail_noise((const double[3]){texel[0], texel[1], texel[2]});
}

/* The range of a noise over a block's texels and the next ones. A lookup is a weighted mean of
 * texels, and both noises are quotients of linear functions of them with a positive divisor: such a
 * quotient lies between its values at the texels. The range is rounded outwards to float32, and
 * once more for the rounding of the lookup. */
static struct range noise_block(const float *texels, int side, int channels, const int block[3],
                                noise_of_texel noise)
{
    struct range range = {1.0, 0.0};
    for (int k = 0; k <= NEPH_HORIZON_BLOCK; k++)
        for (int j = 0; j <= NEPH_HORIZON_BLOCK; j++)
            for (int i = 0; i <= NEPH_HORIZON_BLOCK; i++) {
                const int x = (block[0] * NEPH_HORIZON_BLOCK + i) % side;
                const int y = (block[1] * NEPH_HORIZON_BLOCK + j) % side;
                const int z = (block[2] * NEPH_HORIZON_BLOCK + k) % side;
                const double value = noise(&texels[channels * ((z * side + y) * side + x)]);
                range.low = value < range.low ? value : range.low;
                range.high = value > range.high ? value : range.high;
            }
    return (struct range){nextafterf((float)range.low, -1.0f), nextafterf((float)range.high, 2.0f)};
}

static void weather_block(const float *weather, const int block[2], float out[4])
{
    enum { SIDE = NEPH_HORIZON_WEATHER_SIDE, BLOCK = NEPH_HORIZON_BLOCK };
    for (int c = 0; c < 4; c++)
        out[c] = 0.0f;
    for (int k = 0; k <= BLOCK; k++)
        for (int i = 0; i <= BLOCK; i++)
            for (int c = 0; c < 4; c++)
                out[c] = larger(out[c], weather[4 * ((block[1] * BLOCK + k) % SIDE * SIDE +
                                                     (block[0] * BLOCK + i) % SIDE) +
                                                c]);
}

static void fill_blocks(struct neph_horizon *horizon)
{
    float *out = horizon->base_blocks;
    for (int k = 0; k < BASE_BLOCKS; k++)
        for (int j = 0; j < BASE_BLOCKS; j++)
            for (int i = 0; i < BASE_BLOCKS; i++)
                *out++ = (float)noise_block(horizon->base, NEPH_HORIZON_BASE_SIDE, 4,
                                            (const int[3]){i, j, k}, combine_base_noise)
                             .high;
    out = horizon->detail_blocks;
    for (int k = 0; k < DETAIL_BLOCKS; k++)
        for (int j = 0; j < DETAIL_BLOCKS; j++)
            for (int i = 0; i < DETAIL_BLOCKS; i++) {
                const struct range range = noise_block(horizon->detail, NEPH_HORIZON_DETAIL_SIDE, 3,
                                                       (const int[3]){i, j, k},
                                                       combine_detail_noise);
                *out++ = (float)range.low;
                *out++ = (float)range.high;
            }
    out = horizon->weather_blocks;
    for (int k = 0; k < WEATHER_BLOCKS; k++)
        for (int i = 0; i < WEATHER_BLOCKS; i++, out += 4)
            weather_block(horizon->weather, (const int[2]){i, k}, out);
}

/* --- create and destroy ---------------------------------------------------------------------- */

static enum neph_status check(const struct neph_horizon_params *params, struct neph_diag *diag)
{
    const struct {
        const char *name;
        double value, low, high;
        bool low_too; /* whether `low` itself is allowed */
    } rules[] = {
        {"planet radius [m]", params->planet_radius_m, 0.0, 1e9, false},
        {"bottom height [m]", params->bottom_m, -1e9, 1e9, true},
        {"thickness [m]", params->thickness_m, 0.0, 1e9, false},
        {"coverage", params->coverage, 0.0, 1.0, true},
        {"density", params->density, 0.0, 1e9, true},
        {"texture scale [m]", params->texture_scale_m, 0.0, 1e9, false},
        {"repeats of the base noise", params->base_repeats, 0.0, 1e6, false},
        {"repeats of the detail noise", params->detail_repeats, 0.0, 1e6, false},
        {"wind along x [m]", params->wind_m.x, -1e9, 1e9, true},
        {"wind along y [m]", params->wind_m.y, -1e9, 1e9, true},
        {"wind along z [m]", params->wind_m.z, -1e9, 1e9, true},
    };
    for (size_t i = 0; i < sizeof(rules) / sizeof(rules[0]); i++) {
        const bool low_enough = rules[i].value <= rules[i].high;
        const bool high_enough = rules[i].low_too ? rules[i].value >= rules[i].low
                                                  : rules[i].value > rules[i].low;
        if (!low_enough || !high_enough)
            return neph_fail(diag, NEPH_ERR_INPUT,
                             "Horizon clouds: %s is %g, must be %s %g and at most %g",
                             rules[i].name, rules[i].value, rules[i].low_too ? "at least" : "above",
                             rules[i].low, rules[i].high);
    }
    return NEPH_OK;
}

enum neph_status neph_horizon_create(const struct neph_horizon_params *params,
                                     struct neph_horizon **horizon, struct neph_diag *diag)
{
    enum neph_status status = check(params, diag);
    if (status)
        return status;
    struct neph_horizon *made = calloc(1, sizeof(*made));
    if (!made)
        return neph_fail_memory(diag);
    const struct {
        float **values;
        size_t count;
    } arrays[] = {
        {&made->base, BASE_TEXELS * 4},
        {&made->detail, DETAIL_TEXELS * 3},
        {&made->weather, WEATHER_TEXELS * 4},
        {&made->base_blocks, BASE_BLOCKS * BASE_BLOCKS * BASE_BLOCKS},
        {&made->detail_blocks, DETAIL_BLOCKS * DETAIL_BLOCKS * DETAIL_BLOCKS * 2},
        {&made->weather_blocks, WEATHER_BLOCKS * WEATHER_BLOCKS * 4},
    };
    made->params = *params;
    for (size_t i = 0; i < sizeof(arrays) / sizeof(arrays[0]); i++)
        *arrays[i].values = neph_arena_allocate(&made->arena, arrays[i].count, sizeof(float));
    status = neph_arena_check(&made->arena, diag);
    if (!status)
        status = neph_horizon_fill_base(params->seed, made->base, diag);
    if (!status)
        status = neph_horizon_fill_detail(params->seed, made->detail, diag);
    if (!status)
        status = neph_horizon_fill_weather(params->seed, made->weather, diag);
    if (status) {
        neph_horizon_destroy(made);
        return status;
    }
    fill_blocks(made);
    *horizon = made;
    return NEPH_OK;
}

void neph_horizon_destroy(struct neph_horizon *horizon)
{
    if (!horizon)
        return;
    neph_arena_finish(&horizon->arena);
    free(horizon);
}
