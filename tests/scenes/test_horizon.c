/* SPDX-License-Identifier: MIT
 *
 * Horizon clouds: noise that repeats and is equal on all machines, formulas against the article's
 * table in a second transcription, a valid bound, an integral that a brute-force sum confirms.
 */
#include "tests/scene_builders.h"

#include "base/hash.h"
#include "scenes/bake.h"
#include "scenes/horizon.h"
#include "scenes/majorant.h"
#include "scenes/media.h"
#include "scenes/noise.h"

static const uint64_t seed = 20151;

static struct neph_horizon *make(const struct neph_horizon_params *params)
{
    struct neph_horizon *horizon = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_horizon_create(params, &horizon, &diag), &diag);
    return horizon;
}

/* Textures depend only on the seed: tests that change other parameters share these. */
static int setup(void **state)
{
    const struct neph_horizon_params params = neph_horizon_defaults();
    *state = make(&params);
    return 0;
}

static int teardown(void **state)
{
    neph_horizon_destroy(*state);
    return 0;
}

/* --- noise -------------------------------------------------------------------------------- */

/* Multiples of 2^-10: moving them by whole numbers is exact. */
static double lattice_place(uint64_t *random, int cells)
{
    return (double)(neph_test_random(random) % (uint64_t)(cells * 1024)) / 1024.0;
}

static void test_noise_repeats(void **state)
{
    uint64_t random = seed;
    for (int i = 0; i < 3000; i++) {
        const struct neph_noise noise = {neph_test_random(&random), 2 + i % 2,
                                         1 + (int)(neph_test_random(&random) % 7)};
        double at[3], moved[3];
        int cell[3], moved_cell[3];
        for (int axis = 0; axis < 3; axis++) {
            const int turns = (int)(neph_test_random(&random) % 9) - 4;
            at[axis] = lattice_place(&random, noise.period);
            moved[axis] = at[axis] + turns * noise.period;
            cell[axis] = (int)at[axis];
            moved_cell[axis] = cell[axis] + turns * noise.period;
        }
        assert_true(neph_noise_perlin(&noise, at) == neph_noise_perlin(&noise, moved));
        assert_true(neph_noise_worley(&noise, at) == neph_noise_worley(&noise, moved));
        assert_true(neph_noise_perlin_sum(&noise, 3, at) ==
                    neph_noise_perlin_sum(&noise, 3, moved));
        assert_true(neph_noise_cell_random(&noise, cell, 5) ==
                    neph_noise_cell_random(&noise, moved_cell, 5));
    }
}

/* A row gives the same bits as its points one by one: whether or not they share a cell, in any
 * order, on both sides of 0, with more points than are processed together. */
static void test_a_row_of_noise_is_its_points(void **state)
{
    enum { POINTS = 150, TRIALS = 300, OCTAVES = 3 };
    for (uint64_t trial = 0; trial < TRIALS; trial++) {
        uint64_t random = seed + trial;
        const struct neph_noise noise = {neph_test_random(&random), 2 + (int)(trial & 1),
                                         1 + (int)(neph_test_random(&random) % 9)};
        const double step = trial % 3 ? neph_test_uniform(&random, -0.3, 0.3) : 0.0;
        double along[POINTS], perlin[POINTS], worley[POINTS];
        along[0] = neph_test_uniform(&random, -9.0, 9.0);
        for (int i = 1; i < POINTS; i++)
            along[i] = trial % 3 ? along[i - 1] + step : neph_test_uniform(&random, -9.0, 9.0);
        const struct neph_noise_row row = {
            POINTS,
            along,
            {neph_test_uniform(&random, -9.0, 9.0), neph_test_uniform(&random, -9.0, 9.0)}};
        neph_noise_perlin_row(&noise, OCTAVES, &row, perlin);
        neph_noise_worley_row(&noise, &row, worley);
        for (int i = 0; i < POINTS; i++) {
            const double at[3] = {along[i], row.across[0], row.across[1]};
            if (perlin[i] != neph_noise_perlin_sum(&noise, OCTAVES, at) ||
                worley[i] != neph_noise_worley(&noise, at))
                fail_msg("seed %llu: point %d of a row in %d dimensions, (%.17g, %.17g, %.17g)",
                         (unsigned long long)(seed + trial), i, noise.dimensions, at[0], at[1],
                         at[2]);
        }
    }
}

static void test_noise_stays_in_its_range(void **state)
{
    uint64_t random = seed;
    double lowest[2] = {0, 0}, highest[2] = {0, 0}, sum[2] = {0, 0};
    enum { SAMPLES = 100000 };
    for (int i = 0; i < SAMPLES; i++) {
        const int deep = i % 2;
        const struct neph_noise noise = {seed, 2 + deep, 64};
        const double at[3] = {neph_test_uniform(&random, 0, 64), neph_test_uniform(&random, 0, 64),
                              neph_test_uniform(&random, 0, 64)};
        const double perlin = neph_noise_perlin(&noise, at);
        const double worley = neph_noise_worley(&noise, at);
        assert_true(worley >= 0.0 && worley <= 1.0);
        lowest[deep] = fmin(lowest[deep], perlin);
        highest[deep] = fmax(highest[deep], perlin);
        sum[deep] += perlin;
    }
    for (int deep = 0; deep < 2; deep++) {
        assert_true(lowest[deep] >= -1.04 && highest[deep] <= 1.04);
        assert_true(lowest[deep] < -0.7 && highest[deep] > 0.7);
        /* A standard deviation below 0.4 and almost independent cells: 4 sigma. */
        neph_assert_close(sum[deep] / (SAMPLES / 2), 0.0, 0.0, 4.0 * 0.4 / sqrt(64.0 * 64.0));
    }
    const struct neph_noise noise = {seed, 3, 8};
    assert_true(neph_noise_perlin(&noise, (const double[3]){3.0, 5.0, 1.0}) == 0.0);
}

/* Continuous and once differentiable across the faces of cells: the difference quotients of the two
 * sides agree up to the second derivative, which is below 40. */
static void test_perlin_noise_is_smooth(void **state)
{
    uint64_t random = seed;
    const double h = 1e-5;
    for (int i = 0; i < 2000; i++) {
        const struct neph_noise noise = {neph_test_random(&random), 2 + i % 2, 5};
        double at[3], before[3], after[3];
        for (int axis = 0; axis < 3; axis++)
            before[axis] = after[axis] = at[axis] = neph_test_uniform(&random, 0, 5);
        const int axis = i % noise.dimensions;
        at[axis] = floor(at[axis]);
        before[axis] = at[axis] - h;
        after[axis] = at[axis] + h;
        const double middle = neph_noise_perlin(&noise, at);
        const double down = middle - neph_noise_perlin(&noise, before);
        const double up = neph_noise_perlin(&noise, after) - middle;
        neph_assert_close(up, down, 0.0, 40.0 * h * h + 1e-15);
    }
}

/* No feature point is missed: the slope of a distance is at most 1, and from a point of the pattern
 * the noise decreases with exactly this slope. */
static void test_worley_noise_is_a_distance(void **state)
{
    uint64_t random = seed;
    for (int i = 0; i < 20000; i++) {
        const struct neph_noise noise = {seed, 2 + i % 2, 4};
        double a[3], b[3], squared = 0.0;
        for (int axis = 0; axis < 3; axis++) {
            a[axis] = neph_test_uniform(&random, -8, 8);
            b[axis] = a[axis] + neph_test_uniform(&random, -0.3, 0.3);
            if (axis < noise.dimensions)
                squared += (a[axis] - b[axis]) * (a[axis] - b[axis]);
        }
        const double difference = neph_noise_worley(&noise, a) - neph_noise_worley(&noise, b);
        assert_true(fabs(difference) <= sqrt(squared) + 1e-14);
    }
}

static void hash_floats(const float *values, size_t count, char hex[NEPH_HASH_HEX_SIZE])
{
    struct neph_diag diag = {0};
    neph_assert_ok(neph_hash(values, count * sizeof(float), hex, &diag), &diag);
}

/* The same bits on every machine: scenes are named by their seeds. A new appearance needs new
 * hashes. */
static void test_textures_have_the_bits_they_always_had(void **state)
{
    const struct neph_horizon *horizon = *state;
    enum { BASE = NEPH_HORIZON_BASE_SIDE, DETAIL = NEPH_HORIZON_DETAIL_SIDE };
    enum { WEATHER = NEPH_HORIZON_WEATHER_SIDE };
    char hex[NEPH_HASH_HEX_SIZE];
    hash_floats(horizon->base, (size_t)BASE * BASE * BASE * 4, hex);
    assert_string_equal(hex, "0df69b07896c426b63d29d2004dab6ad3d9de81200976bd6ac840c0380484272");
    hash_floats(horizon->detail, (size_t)DETAIL * DETAIL * DETAIL * 3, hex);
    assert_string_equal(hex, "1cee2d2d9d1e2b3988e93ffb88f4b1a4077ec9e675157a8a146628e6caec19a4");
    hash_floats(horizon->weather, (size_t)WEATHER * WEATHER * 4, hex);
    assert_string_equal(hex, "012400c80b86eb35c034cc873912c550e19e585f0e102ae09af2d066983bd0e1");
}

static void assert_within(const float *values, size_t count, float low, float high)
{
    for (size_t i = 0; i < count; i++)
        if (!(values[i] >= low && values[i] <= high))
            fail_msg("texel %zu is %g, outside %g..%g", i, (double)values[i], (double)low,
                     (double)high);
}

static void test_another_seed_makes_other_clouds(void **state)
{
    const struct neph_horizon *horizon = *state;
    struct neph_horizon_params params = neph_horizon_defaults();
    params.seed = UINT64_MAX;
    struct neph_horizon *other = make(&params);
    int same = 0, clear = 0;
    const int texels = NEPH_HORIZON_WEATHER_SIDE * NEPH_HORIZON_WEATHER_SIDE;
    for (int i = 0; i < texels; i++) {
        same += horizon->weather[4 * i + 2] == other->weather[4 * i + 2];
        clear += other->weather[4 * i] <= 0.0f;
    }
    assert_true(same < texels / 4);                             /* 0 and 1 are frequent */
    assert_true(clear > texels / 4 && clear < texels * 9 / 10); /* sky between clouds */
    assert_within(other->base, 64 * 64 * 64 * 4, 0.0f, 1.0f);
    assert_within(other->detail, 32 * 32 * 32 * 3, 0.0f, 1.0f);
    assert_within(other->weather, (size_t)texels * 4, 0.0f, 1.0f);
    neph_horizon_destroy(other);
}

/* --- formulas ----------------------------------------------------------------------------- */

static double R(double v, double a, double b, double c, double d)
{
    return c + (v - a) * (d - c) / (b - a);
}

static double sat(double x)
{
    return x < 0.0 ? 0.0 : x > 1.0 ? 1.0 : x;
}

/* Tables C2 to C6 with the article's letters, and R as printed: only where nothing divides by 0. */
struct article {
    double gc, gd;           /* coverage and density of the whole sky */
    double wc0, wc1, wh, wd; /* weather */
    double r, g, b, a;       /* base noise */
    double dr, dg, db;       /* detail noise */
    double ph;
};

static double article_density(const struct article *x, double *without_detail)
{
    const double WMc = fmax(x->wc0, sat(x->gc - 0.5) * x->wc1 * 2.0);
    const double SRb = sat(R(x->ph, 0.0, 0.07, 0.0, 1.0));
    const double SRt = sat(R(x->ph, 0.2 * x->wh, x->wh, 1.0, 0.1));
    const double SA = SRb * SRt;
    const double DRb = x->ph * sat(R(x->ph, 0.0, 0.15, 0.0, 1.0));
    const double DRt = sat(R(x->ph, 0.9, 1.0, 1.0, 0.2));
    const double DA = x->gd * DRb * DRt * x->wd * 2.0;
    const double fbm = 0.625 * x->g + 0.25 * x->b + 0.125 * x->a;
    const double SNs = R(x->r, fbm - 1.0, 1.0, 0.0, 1.0);
    const double SN = sat(R(SNs * SA, 1.0 - x->gc * WMc, 1.0, 0.0, 1.0));
    const double DNfbm = 0.625 * x->dr + 0.25 * x->dg + 0.125 * x->db;
    const double D = sat(R(x->dr, 1.0 - DNfbm, 1.0, 0.0, 1.0));
    const double turned = sat(1.8 * x->ph);
    const double mod = 0.8 * exp(-0.75 * x->gc) * (D * (1.0 - turned) + (1.0 - D) * turned);
    *without_detail = SN * DA;
    return sat(R(SN, mod, 1.0, 0.0, 1.0)) * DA;
}

static double *linear(const float *texels, int side, int channels, const double *repeats, int axes,
                      double out[4])
{
    for (int c = 0; c < 4; c++)
        out[c] = 0.0;
    for (int corner = 0; corner < 1 << axes; corner++) {
        double weight = 1.0;
        int at = 0;
        for (int axis = axes - 1; axis >= 0; axis--) {
            const double place = repeats[axis] * side - 0.5;
            const double texel = floor(place) + (corner >> axis & 1);
            weight *= 1.0 - fabs(place - texel);
            at = at * side + (int)(texel - side * floor(texel / side));
        }
        for (int c = 0; c < channels; c++)
            out[c] += weight * (double)texels[at * channels + c];
    }
    return out;
}

static double reference_density(const struct neph_horizon *h, struct neph_vec3 p,
                                double *without_detail)
{
    const struct neph_horizon_params *q = &h->params;
    const struct neph_vec3 u = neph_vec3_scale(neph_vec3_sub(p, q->wind_m),
                                               1.0 / q->texture_scale_m);
    const struct neph_vec3 ub = neph_vec3_scale(u, q->base_repeats);
    const struct neph_vec3 ud = neph_vec3_scale(u, q->detail_repeats);
    double w[4], n[4], d[4];
    linear(h->weather, NEPH_HORIZON_WEATHER_SIDE, 4, (const double[]){u.x, u.z}, 2, w);
    linear(h->base, NEPH_HORIZON_BASE_SIDE, 4, (const double[]){ub.x, ub.y, ub.z}, 3, n);
    linear(h->detail, NEPH_HORIZON_DETAIL_SIDE, 3, (const double[]){ud.x, ud.y, ud.z}, 3, d);
    const struct neph_vec3 center_m = {0.0, q->bottom_m - q->planet_radius_m, 0.0};
    const double radius_m = neph_vec3_length(neph_vec3_sub(p, center_m));
    const double ph = (radius_m - q->planet_radius_m) / q->thickness_m;
    *without_detail = 0.0;
    if (ph < 0.0 || ph > 1.0)
        return 0.0;
    return article_density(&(struct article){.gc = q->coverage,
                                             .gd = q->density,
                                             .wc0 = w[0],
                                             .wc1 = w[1],
                                             .wh = w[2],
                                             .wd = w[3],
                                             .r = n[0],
                                             .g = n[1],
                                             .b = n[2],
                                             .a = n[3],
                                             .dr = d[0],
                                             .dg = d[1],
                                             .db = d[2],
                                             .ph = ph},
                           without_detail);
}

static void fill_random(uint64_t *random, double low, float *texels, size_t count)
{
    for (size_t i = 0; i < count; i++)
        texels[i] = (float)neph_test_uniform(random, low, 1.0);
}

static struct neph_vec3 point_in_layer(uint64_t *random, const struct neph_horizon_params *params,
                                       double reach_m)
{
    const double x_m = neph_test_uniform(random, -reach_m, reach_m);
    const double z_m = neph_test_uniform(random, -reach_m, reach_m);
    const double r_m = params->planet_radius_m +
                       params->thickness_m * neph_test_uniform(random, -0.02, 1.02);
    const double y_m = sqrt(r_m * r_m - x_m * x_m - z_m * z_m);
    return (struct neph_vec3){x_m, params->bottom_m - params->planet_radius_m + y_m, z_m};
}

/* Textures of unstructured noise. The reference computes the altitude as a difference of lengths
 * and divides by a coverage of 0.2 or more: 2e5 m / 280 m times some roundings. */
static void test_density_is_the_articles(void **state)
{
    uint64_t random = seed;
    const struct neph_horizon_params params = neph_horizon_defaults();
    struct neph_horizon *h = make(&params);
    fill_random(&random, 0.01, h->base, 64 * 64 * 64 * 4);
    fill_random(&random, 0.01, h->detail, 32 * 32 * 32 * 3);
    fill_random(&random, 0.4, h->weather, 256 * 256 * 4);
    int clouds = 0;
    for (int i = 0; i < 20000; i++) {
        h->params.coverage = i % 10 ? neph_test_uniform(&random, 0.5, 1.0) : 1.0;
        h->params.density = neph_test_uniform(&random, 0.0, 3.0);
        h->params.wind_m = (struct neph_vec3){neph_test_uniform(&random, -1e4, 1e4), 7.0, -3e3};
        const struct neph_vec3 p = point_in_layer(&random, &h->params, i % 2 ? 5e3 : 1e5);
        double without_detail, expected_without_detail;
        const double density = neph_horizon_density(h, p, &without_detail);
        const double expected = reference_density(h, p, &expected_without_detail);
        neph_assert_close(density, expected, 0.0, 1e-11);
        neph_assert_close(without_detail, expected_without_detail, 0.0, 1e-11);
        assert_true(density <= without_detail);
        assert_true(neph_horizon_density(h, p, NULL) == density);
        clouds += density > 0.0;
    }
    assert_true(clouds > 2000);
    neph_horizon_destroy(h);
}

/* Where R divides by 0: no coverage, no peak, no detail noise. */
static void test_limits_of_the_formulas(void **state)
{
    struct neph_horizon_params params = neph_horizon_defaults();
    params.coverage = 1.0;
    struct neph_horizon *h = make(&params);
    const struct neph_vec3 middle_m = {0.0, params.bottom_m + 0.3 * params.thickness_m, 0.0};
    for (size_t i = 0; i < 64 * 64 * 64 * 4; i++)
        h->base[i] = 1.0f;
    for (size_t i = 0; i < 32 * 32 * 32 * 3; i++)
        h->detail[i] = 0.0f;
    for (size_t i = 0; i < 256 * 256 * 4; i++)
        h->weather[i] = 1.0f;
    double without_detail;
    /* All ones: S = SA = 1 - 1.125 (.3 - .2), E = .8 e^-.75 sat(.54), DA = 2 gd .3. */
    const double shape = 1.0 - 1.125 * 0.1, erosion = 0.8 * exp(-0.75) * 0.54;
    const double density = neph_horizon_density(h, middle_m, &without_detail);
    neph_assert_close(without_detail, shape * 2.0 * 1.5 * 0.3, 1e-12, 0.0);
    neph_assert_close(density, (shape - erosion) / (1.0 - erosion) * 2.0 * 1.5 * 0.3, 1e-12, 0.0);
    h->params.coverage = 0.0;
    assert_true(neph_horizon_density(h, middle_m, NULL) == 0.0);
    h->params.coverage = 1.0;
    for (size_t i = 0; i < 256 * 256; i++)
        h->weather[4 * i + 2] = 0.0f;
    assert_true(neph_horizon_density(h, middle_m, NULL) == 0.0);
    neph_horizon_destroy(h);
}

static void test_height_in_the_layer(void **state)
{
    struct neph_horizon *h = *state;
    h->params = make_cumulus();
    h->params.planet_radius_m = 6.371e6;
    assert_true(horizon_height(h, (struct neph_vec3){0.0, 599.0, 0.0}) == 0.0);
    assert_true(horizon_height(h, (struct neph_vec3){0.0, 1801.0, 0.0}) == 1.0);
    neph_assert_close(horizon_height(h, (struct neph_vec3){0.0, 1200.0, 0.0}), 0.5, 1e-15, 0);
    /* 100 km away the layer is lower by R - sqrt(R^2 - d^2). */
    const double sag_m = 1e10 / (6.371e6 + sqrt(6.371e6 * 6.371e6 - 1e10));
    const struct neph_vec3 far_m = {6e4, 600.0 - sag_m + 0.012, 8e4};
    const double slant = sqrt(1.0 - 1e10 / (6.371e6 * 6.371e6));
    neph_assert_close(horizon_height(h, far_m), 1e-5 * slant, 0.0, 1e-12);
}

/* --- bound -------------------------------------------------------------------------------- */

static struct neph_horizon_params random_params(uint64_t *random)
{
    struct neph_horizon_params params = make_cumulus();
    params.coverage = neph_test_uniform(random, 0, 1) < 0.2 ? 1.0
                                                            : neph_test_uniform(random, 0.2, 1.0);
    params.planet_radius_m = pow(10.0, neph_test_uniform(random, 3.3, 7.0));
    params.bottom_m = neph_test_uniform(random, -1e3, 1e4);
    params.thickness_m = pow(10.0, neph_test_uniform(random, 1.0, 3.5));
    params.texture_scale_m = pow(10.0, neph_test_uniform(random, 2.0, 5.0));
    params.base_repeats = pow(10.0, neph_test_uniform(random, -0.5, 1.5));
    params.detail_repeats = pow(10.0, neph_test_uniform(random, -0.5, 2.0));
    params.wind_m = (struct neph_vec3){neph_test_uniform(random, -1e5, 1e5),
                                       neph_test_uniform(random, -1e5, 1e5),
                                       neph_test_uniform(random, -1e5, 1e5)};
    return params;
}

/* From fractions of a texel to parts of the planet. */
static struct neph_bounds random_box(uint64_t *random, const struct neph_horizon_params *params)
{
    const struct neph_vec3 p = point_in_layer(random, params,
                                              fmin(5e4, 0.5 * params->planet_radius_m));
    double half[3];
    for (int axis = 0; axis < 3; axis++)
        half[axis] = params->thickness_m * pow(10.0, neph_test_uniform(random, -3.0, 0.7));
    return (struct neph_bounds){{p.x - half[0], p.y - half[1], p.z - half[2]},
                                {p.x + half[0], p.y + half[1], p.z + half[2]}};
}

static struct neph_vec3 point_in(uint64_t *random, const struct neph_bounds *box)
{
    const struct neph_vec3 a = box->min_m, b = box->max_m;
    const bool on_faces = neph_test_uniform(random, 0, 1) < 0.2;
    double share[3];
    for (int axis = 0; axis < 3; axis++)
        share[axis] = on_faces ? (double)(neph_test_random(random) & 1)
                               : neph_test_uniform(random, 0, 1);
    return (struct neph_vec3){a.x + share[0] * (b.x - a.x), a.y + share[1] * (b.y - a.y),
                              a.z + share[2] * (b.z - a.z)};
}

static void test_bound_is_never_beaten(void **state)
{
    struct neph_horizon *h = *state;
    int clouds = 0, empty = 0;
    for (int trial = 0; trial < 3000; trial++) {
        uint64_t random = seed + (uint64_t)trial;
        h->params = random_params(&random);
        const struct neph_bounds box = random_box(&random, &h->params);
        const double bound = neph_horizon_bound(h, &box);
        assert_true(bound >= 0.0 && isfinite(bound));
        empty += bound <= 0.0;
        for (int i = 0; i < 60; i++) {
            const struct neph_vec3 p = point_in(&random, &box);
            const double density = neph_horizon_density(h, p, NULL);
            clouds += density > 0.0;
            if (!(density <= bound))
                fail_msg("seed %llu: density %.17g at (%.17g, %.17g, %.17g) passes the bound %.17g",
                         (unsigned long long)seed + (unsigned long long)trial, density, p.x, p.y,
                         p.z, bound);
        }
    }
    print_message("bound: %d boxes of 3000 are empty, %d points of 180000 in clouds\n", empty,
                  clouds);
    assert_true(clouds > 2000 && empty > 200);
}

static void test_bound_of_endless_boxes(void **state)
{
    struct neph_horizon *h = *state;
    h->params = make_cumulus();
    const struct neph_bounds all = {{-INFINITY, -INFINITY, -INFINITY},
                                    {INFINITY, INFINITY, INFINITY}};
    const struct neph_bounds below = {{-INFINITY, -INFINITY, -1e3}, {1e3, -1e6, 2e3}};
    const struct neph_bounds column = {{-1e3, -INFINITY, -1e3}, {1e3, INFINITY, 1e3}};
    const struct neph_bounds above = {{-INFINITY, 1801.0, -INFINITY},
                                      {INFINITY, INFINITY, INFINITY}};
    assert_true(neph_horizon_bound(h, &all) > 0.0);
    assert_true(neph_horizon_bound(h, &all) <= 2.0 * h->params.density * (1.0 + 1e-6));
    assert_true(neph_horizon_bound(h, &below) == 0.0);
    assert_true(neph_horizon_bound(h, &above) == 0.0);
    assert_true(neph_horizon_bound(h, &column) >= 0.0);
}

/* The majorants of trackers: never exceeded, and low enough that tracking is efficient. The
 * fraction of candidates that become collisions is the integral of the density over the integral of
 * its majorant; with cells of 100 m, a perfect majorant would give a half. */
static void test_majorants_are_sound_and_worth_having(void **state)
{
    struct neph_horizon *h = *state;
    h->params = make_cumulus();
    const struct neph_medium medium = {.kind = NEPH_MEDIUM_HORIZON,
                                       .bounds = {{-4e3, 0.0, -4e3}, {4e3, 2e3, 4e3}},
                                       .extinction_color = {1, 1, 1},
                                       .extinction_per_m = 0.05,
                                       .horizon = h};
    const struct neph_bounds box = neph_medium_support(&medium);
    struct neph_majorants *m = NULL;
    struct neph_diag diag = {0};
    const int cells = neph_medium_facts(NEPH_MEDIUM_HORIZON)->majorant_cells;
    neph_assert_ok(neph_majorants_create(&medium, &box, cells, &m, &diag), &diag);
    uint64_t random = seed;
    double density_sum = 0.0, majorant_sum = 0.0;
    for (int i = 0; i < 200000; i++) {
        const double share[3] = {neph_test_uniform(&random, 0, 1), neph_test_uniform(&random, 0, 1),
                                 neph_test_uniform(&random, 0, 1)};
        const struct neph_vec3 p = {box.min_m.x + share[0] * (box.max_m.x - box.min_m.x),
                                    box.min_m.y + share[1] * (box.max_m.y - box.min_m.y),
                                    box.min_m.z + share[2] * (box.max_m.z - box.min_m.z)};
        const int cell[3] = {(int)(share[0] * m->size[0]), (int)(share[1] * m->size[1]),
                             (int)(share[2] * m->size[2])};
        const double majorant =
            (double)m->extinction_per_m[(cell[2] * m->size[1] + cell[1]) * m->size[0] + cell[0]];
        const double extinction = neph_medium_extinction_per_m(&medium, p);
        assert_true(extinction <= majorant);
        density_sum += extinction;
        majorant_sum += majorant;
    }
    print_message("majorants of %d x %d x %d cells: %.1f %% of candidates are collisions\n",
                  m->size[0], m->size[1], m->size[2], 100.0 * density_sum / majorant_sum);
    assert_true(density_sum > 0.1 * majorant_sum);
    neph_majorants_destroy(m);
}

/* Each node has the density of the clouds, although blocks of nodes are skipped where the bound is
 * 0. No side of the grid is a whole number of blocks. */
static void test_voxels_are_the_clouds(void **state)
{
    struct neph_horizon *h = *state;
    h->params = make_cumulus();
    const struct neph_medium medium = {.kind = NEPH_MEDIUM_HORIZON,
                                       .bounds = {{-4e3, 0.0, -4e3}, {4e3, 2e3, 3e3}},
                                       .extinction_color = {1, 1, 1},
                                       .extinction_per_m = 0.05,
                                       .horizon = h};
    const struct neph_bounds box = neph_medium_support(&medium);
    struct neph_bake bake;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_medium_sample(&medium, &box, 117, &bake, &diag), &diag);
    const struct neph_grid *grid = bake.grid;
    const int *size = grid->size;
    int clear = 0, nodes = 0;
    for (int k = 0; k < size[2]; k++)
        for (int j = 0; j < size[1]; j++)
            for (int i = 0; i < size[0]; i++, nodes++) {
                const struct neph_vec3 p = {grid->origin_m.x + i * grid->spacing_m.x,
                                            grid->origin_m.y + j * grid->spacing_m.y,
                                            grid->origin_m.z + k * grid->spacing_m.z};
                const double density = neph_medium_extinction_per_m(&medium, p) / 0.05;
                if (grid->values[nodes] != (float)density)
                    fail_msg("node (%d, %d, %d) is %g, the density %g", i, j, k,
                             (double)grid->values[nodes], density);
                clear += density <= 0.0;
            }
    print_message("voxels: %d x %d x %d, %d of %d clear\n", size[0], size[1], size[2], clear,
                  nodes);
    assert_true(size[0] % 4 && size[1] % 4 && size[2] % 4);
    assert_true(clear > nodes / 2 && clear < nodes);
    neph_bake_finish(&bake);
}

/* --- line integral ------------------------------------------------------------------------ */

/* The midpoint rule; `*spread` is the difference to half as many points. */
static double brute_force_m(const struct neph_horizon *h, struct neph_vec3 origin_m,
                            struct neph_vec3 direction, double t0_m, double t1_m, int points,
                            double *spread_m)
{
    const double step_m = (t1_m - t0_m) / points;
    double sum[2] = {0.0, 0.0};
    for (int i = 0; i < points; i++)
        sum[0] += neph_horizon_density(
            h, neph_vec3_along(origin_m, direction, t0_m + (i + 0.5) * step_m), NULL);
    for (int i = 0; i < points / 2; i++)
        sum[1] += neph_horizon_density(
            h, neph_vec3_along(origin_m, direction, t0_m + (i + 0.5) * 2.0 * step_m), NULL);
    *spread_m = fabs(sum[0] - 2.0 * sum[1]) * step_m;
    return sum[0] * step_m;
}

static struct neph_vec3 all_but_level(uint64_t *random)
{
    struct neph_vec3 v;
    do {
        v = (struct neph_vec3){neph_test_uniform(random, -1, 1),
                               neph_test_uniform(random, -0.3, 0.3),
                               neph_test_uniform(random, -1, 1)};
    } while (neph_vec3_length(v) < 0.1);
    return neph_vec3_normalize(v);
}

/* A ray through a position in a cloud. */
struct ray {
    struct neph_vec3 origin_m, direction;
};

static struct ray ray_through_cloud(uint64_t *random, const struct neph_horizon *h)
{
    struct ray ray;
    do
        ray.origin_m = point_in_layer(random, &h->params, 4e3);
    while (neph_horizon_density(h, ray.origin_m, NULL) <= 0.0);
    ray.direction = all_but_level(random);
    return ray;
}

/* The error of midpoints is a few times the spread; the error of the integral is at most the
 * reported one. */
static void test_integral_against_brute_force(void **state)
{
    struct neph_horizon *h = *state;
    uint64_t random = seed;
    double worst_error = 0.0;
    for (int i = 0; i < 40; i++) {
        h->params = make_cumulus();
        h->params.coverage = i % 4 ? 0.58 : 1.0;
        const struct ray ray = ray_through_cloud(&random, h);
        const double t0_m = i % 3 ? 0.0 : -500.0,
                     t1_m = pow(10.0, neph_test_uniform(&random, 1.0, 3.3));
        double error_m, spread_m;
        const double integral_m = neph_horizon_integral_m(h, ray.origin_m, ray.direction, t0_m,
                                                          t1_m, &error_m);
        const double brute_m = brute_force_m(h, ray.origin_m, ray.direction, t0_m, t1_m, 20000,
                                             &spread_m);
        neph_assert_close(integral_m, brute_m, 0.0, 4.0 * spread_m + error_m + 1e-8);
        assert_true(error_m >= 0.0 && error_m <= 1e-7 * (1.0 + integral_m));
        worst_error = fmax(worst_error, error_m / (1.0 + integral_m));
    }
    print_message("integral: its own error is at most %.1e\n", worst_error);
}

/* The whole is the sum of its parts, wherever it is cut, and the same reversed. */
static void test_integral_is_additive_and_knows_no_direction(void **state)
{
    struct neph_horizon *h = *state;
    uint64_t random = seed;
    int clouds = 0;
    for (int i = 0; i < 60; i++) {
        h->params = make_cumulus();
        const struct ray ray = ray_through_cloud(&random, h);
        const struct neph_vec3 origin_m = ray.origin_m, direction = ray.direction;
        const double end_m = neph_test_uniform(&random, 100.0, 3000.0);
        const double cut_m = neph_test_uniform(&random, 0.0, end_m);
        double e[4];
        const double whole_m = neph_horizon_integral_m(h, origin_m, direction, 0.0, end_m, &e[0]);
        const double first_m = neph_horizon_integral_m(h, origin_m, direction, 0.0, cut_m, &e[1]);
        const double second_m = neph_horizon_integral_m(h, origin_m, direction, cut_m, end_m,
                                                        &e[2]);
        const double back_m = neph_horizon_integral_m(
            h, neph_vec3_along(origin_m, direction, end_m), neph_vec3_scale(direction, -1.0), 0.0,
            end_m, &e[3]);
        /* Positions are accurate to 1e-12 m: 1e-9 covers hundreds of faces. */
        neph_assert_close(first_m + second_m, whole_m, 0.0, e[0] + e[1] + e[2] + 1e-9);
        neph_assert_close(back_m, whole_m, 0.0, e[0] + e[3] + 1e-9);
        clouds += whole_m > 0.0;
    }
    assert_true(clouds > 15);
}

static void test_integral_of_rays_without_end(void **state)
{
    struct neph_horizon *h = *state;
    h->params = make_cumulus();
    const struct neph_vec3 ground_m = {0.0, 2.0, 0.0};
    const struct neph_vec3 up = neph_vec3_normalize((struct neph_vec3){0.3, 1.0, -0.4});
    double error_m;
    const double endless_m = neph_horizon_integral_m(h, ground_m, up, 0.0, INFINITY, &error_m);
    neph_assert_close(neph_horizon_integral_m(h, ground_m, up, 0.0, 1e4, NULL), endless_m, 0.0,
                      error_m + 1e-9);
    assert_true(neph_horizon_integral_m(h, ground_m, up, 5e3, INFINITY, NULL) == 0.0);
    assert_true(neph_horizon_integral_m(h, ground_m, up, 0.0, 500.0, NULL) == 0.0);
    const struct neph_vec3 above_m = {0.0, 2500.0, 0.0};
    assert_true(neph_horizon_integral_m(h, above_m, up, 0.0, INFINITY, NULL) == 0.0);
}

/* --- invalid input ------------------------------------------------------------------------ */

static void test_parameters_out_of_range_are_refused(void **state)
{
    static const double bad_lengths[] = {0.0, -1.0, 1e10, NAN, INFINITY};
    const struct neph_horizon_params good = neph_horizon_defaults();
    const struct {
        size_t offset;
        const char *name;
    } lengths[] = {
        {offsetof(struct neph_horizon_params, planet_radius_m), "planet radius"},
        {offsetof(struct neph_horizon_params, thickness_m), "thickness"},
        {offsetof(struct neph_horizon_params, texture_scale_m), "texture scale"},
        {offsetof(struct neph_horizon_params, base_repeats), "base noise"},
        {offsetof(struct neph_horizon_params, detail_repeats), "detail noise"},
    };
    struct neph_horizon *untouched = (struct neph_horizon *)&good, *h = untouched;
    for (size_t l = 0; l < sizeof(lengths) / sizeof(lengths[0]); l++)
        for (size_t b = 0; b < sizeof(bad_lengths) / sizeof(bad_lengths[0]); b++) {
            struct neph_horizon_params params = good;
            struct neph_diag diag = {0};
            memcpy((char *)&params + lengths[l].offset, &bad_lengths[b], sizeof(double));
            assert_int_equal(neph_horizon_create(&params, &h, &diag), NEPH_ERR_INPUT);
            assert_ptr_equal(h, untouched);
            assert_non_null(strstr(diag.message, lengths[l].name));
        }
    static const struct {
        double coverage, density, bottom_m, wind_x_m;
    } others[] = {{-0.1, 1, 0, 0},       {1.1, 1, 0, 0},        {NAN, 1, 0, 0},
                  {0.5, -1, 0, 0},       {0.5, NAN, 0, 0},      {0.5, 1, NAN, 0},
                  {0.5, 1, INFINITY, 0}, {0.5, 1, 0, -INFINITY}};
    for (size_t o = 0; o < sizeof(others) / sizeof(others[0]); o++) {
        struct neph_horizon_params params = good;
        struct neph_diag diag = {0};
        params.coverage = others[o].coverage;
        params.density = others[o].density;
        params.bottom_m = others[o].bottom_m;
        params.wind_m.x = others[o].wind_x_m;
        assert_int_equal(neph_horizon_create(&params, &h, &diag), NEPH_ERR_INPUT);
    }
}

static double one_of(uint64_t *random, const double *values, size_t count)
{
    return values[neph_test_random(random) % count];
}
#define ONE_OF(random, values) one_of((random), (values), sizeof(values) / sizeof((values)[0]))

/* All allowed parameters give finite values. */
static void test_extreme_parameters_give_no_nonsense(void **state)
{
    struct neph_horizon *h = *state;
    static const double lengths_m[] = {1e-9, 1.0, 1e3, 1e9};
    static const double repeats[] = {1e-9, 1.0, 1e6};
    static const double places_m[] = {0.0, 1e3, -1e9, 1e9};
    static const double parts[] = {0.0, 1e-300, 0.5, 1.0};
    for (int trial = 0; trial < 3000; trial++) {
        uint64_t random = seed + (uint64_t)trial;
        h->params = (struct neph_horizon_params){
            .planet_radius_m = ONE_OF(&random, lengths_m),
            .bottom_m = ONE_OF(&random, places_m),
            .thickness_m = ONE_OF(&random, lengths_m),
            .coverage = ONE_OF(&random, parts),
            .density = ONE_OF(&random, lengths_m),
            .texture_scale_m = ONE_OF(&random, lengths_m),
            .base_repeats = ONE_OF(&random, repeats),
            .detail_repeats = ONE_OF(&random, repeats),
            .wind_m = {ONE_OF(&random, places_m), ONE_OF(&random, places_m), 0.0},
        };
        const struct neph_vec3 p = {ONE_OF(&random, places_m),
                                    h->params.bottom_m + 0.5 * h->params.thickness_m,
                                    ONE_OF(&random, places_m)};
        double without_detail;
        const double density = neph_horizon_density(h, p, &without_detail);
        const double height = horizon_height(h, p);
        const double most = 2.0 * h->params.density;
        if (!(density >= 0.0 && density <= most) ||
            !(without_detail >= density && without_detail <= most) ||
            !(height >= 0.0 && height <= 1.0))
            fail_msg("trial %d: density %g, %g without detail, height %g", trial, density,
                     without_detail, height);
        const struct neph_bounds box = {p, neph_vec3_add(p, (struct neph_vec3){1.0, 1.0, 1.0})};
        assert_true(neph_horizon_bound(h, &box) >= density);
    }
}

int main(void)
{
    print_message("seed %llu\n", (unsigned long long)seed);
    const struct CMUnitTest tests[] = {
#include "cases/test_horizon.inc"
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
