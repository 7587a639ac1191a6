/* SPDX-License-Identifier: MIT
 *
 * Shader functions, value by value through shaders/probe.comp, compared with the double-precision
 * functions of scenes/. Inputs are rounded to float32 first and given to both sides, so only the
 * shader's arithmetic is measured. Tolerances are the unit roundoff of float32 times the condition
 * number, with Vulkan's bound for exp(x): 3 + 2|x| ulp.
 */
#include "tests/renderer/probe.h"

#include "base/half.h"
#include "renderer/halves.h"
#include "renderer/media/fog.h"
#include "renderer/realtime/view.h"
#include "scenes/media.h"
#include "scenes/solids.h"

static const uint32_t probe_code[] = {
#include "shaders/probe.comp.inc"
};

/* as in shaders/probe.comp */
enum probe_what {
    PROBE_PHI,
    PROBE_TRANSMITTANCE,
    PROBE_ABSORBED,
    PROBE_PHASE,
    PROBE_EXTINCTION,
    PROBE_FOG,
    PROBE_DISTANCE,
    PROBE_SOLID,
    PROBE_SUM,
    PROBE_LOOPS,
    PROBE_HALVES,
};

struct probe {
    float a[4], b[4], c[4], d[4];
    uint32_t what, kind, padding[2];
};
_Static_assert(sizeof(struct probe) == 80, "std430 Probe");

struct answer {
    float value[4];
};

static const double epsilon = 0x1p-23; /* one ulp at 1 */
static const uint64_t seed = 20240607;

/* Storage for the probes of a test and their results. */
#define PROBES_MAX 20000
static struct probe *new_probes(void)
{
    static struct probe probes[PROBES_MAX];
    memset(probes, 0, sizeof(probes));
    return probes;
}

static struct answer *ask(struct neph_vulkan *vulkan, const struct probe *probes, int count)
{
    const struct neph_kernel_params params = {
        .name = "probe", .code = probe_code, .code_bytes = sizeof(probe_code), .buffer_count = 2};
    return test_probe(vulkan, &params, NULL, probes, sizeof(*probes), sizeof(struct answer), count);
}

static float uniform(uint64_t *random, double low, double high)
{
    return (float)neph_test_uniform(random, low, high);
}

/* Log-uniform. */
static float scale(uint64_t *random, double low, double high)
{
    return (float)exp(neph_test_uniform(random, log(low), log(high)));
}

/* A unit vector rounded to float32; sometimes along an axis or nearly so. */
static void direction(uint64_t *random, float out[4])
{
    double v[3];
    for (int i = 0; i < 3; i++)
        v[i] = neph_test_uniform(random, -1.0, 1.0);
    const uint64_t special = neph_test_random(random) % 8;
    if (special < 3) {
        v[(special + 1) % 3] = 0.0;
        v[(special + 2) % 3] = neph_test_random(random) % 2 ? 0.0 : 1e-6;
    }
    const double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int i = 0; i < 3; i++)
        out[i] = (float)(v[i] / length);
}

static struct neph_vec3 vec3(const float v[4])
{
    return (struct neph_vec3){v[0], v[1], v[2]};
}

/* --- exponentials ------------------------------------------------------------------------- */

static void test_phi_and_friends(void **state)
{
    struct probe *probes = new_probes();
    uint64_t random = seed;
    static const float edges[] = {0.0f,  1e-38f,    1e-30f, 1e-7f,      1e-4f, 0.0099f,
                                  0.5f,  0.999999f, 1.0f,   1.0000001f, 2.0f,  80.0f,
                                  86.9f, 87.0f,     88.0f,  1e3f,       1e20f, 3e38f};
    const int edge_count = sizeof(edges) / sizeof(edges[0]);
    const int count = 4000;
    for (int i = 0; i < count; i++)
        for (int what = PROBE_PHI; what <= PROBE_ABSORBED; what++) {
            probes[3 * i + what].what = (uint32_t)what;
            probes[3 * i + what].a[0] = i < edge_count ? edges[i] : scale(&random, 1e-9, 300.0);
            if (what > PROBE_PHI)
                probes[3 * i + what].a[0] = probes[3 * i].a[0];
        }
    OWNED(memory) struct answer *answers = ask(*state, probes, 3 * count);
    double worst_phi = 0.0;
    for (int i = 0; i < count; i++) {
        const double x = probes[3 * i].a[0];
        const double phi = neph_phi(x);
        worst_phi = fmax(worst_phi, fabs(answers[3 * i].value[0] / phi - 1.0));
        /* A device may flush a result below the smallest normal number, 1.18e-38, to 0 (Vulkan,
         * float controls; lavapipe of Mesa 26 does). */
        neph_assert_close(answers[3 * i].value[0], phi, 3e-7, 1.2e-38);
        /* Flushing x near 0 has an error of at most the smallest normal number. */
        neph_assert_close(answers[3 * i + 1].value[0], exp(-x), epsilon * (3.0 + 2.0 * x), 2e-38);
        neph_assert_close(answers[3 * i + 2].value[0], -expm1(-x), 4e-7, 2e-38);
    }
    print_message("phi: worst relative error %.2e\n", worst_phi);
}

static void test_sum_of_many_steps_keeps_its_digits(void **state)
{
    struct probe *probes = new_probes();
    const float terms[] = {0.1f, 1e-3f, 0.3333333f, 1e-20f};
    for (int i = 0; i < 4; i++)
        probes[i] = (struct probe){.what = PROBE_SUM, .a = {terms[i]}, .b = {60000.0f}};
    OWNED(memory) struct answer *answers = ask(*state, probes, 4);
    for (int i = 0; i < 4; i++) /* a plain sum of 0.1 has an error of 1e-3 here */
        neph_assert_close(answers[i].value[0], 60000.0 * (double)terms[i], epsilon, 0.0);
}

/* The driver of lavapipe ends loops silently (compute.h). Up to the limit that the renderers
 * respect, every iteration must be executed, in every thread of a work group. */
static void test_loops_make_all_their_turns(void **state)
{
    static const float turns[][2] = {{1, 64990}, {20000, 1}, {250, 250}, {10, 6400}};
    struct probe *probes = new_probes();
    for (int i = 0; i < 256; i++)
        probes[i] = (struct probe){.what = PROBE_LOOPS, .a = {turns[i % 4][0], turns[i % 4][1]}};
    for (int i = 0; i < 4; i++) { /* each by itself, then all in parallel */
        OWNED(memory) struct answer *answers = ask(*state, &probes[i], 1);
        assert_true(answers[0].value[0] == turns[i][0] * turns[i][1]);
        assert_true(answers[0].value[1] == turns[i][0]);
    }
    for (int i = 0; i < 256; i++)
        probes[i].a[0] = 250, probes[i].a[1] = (float)(i % 250);
    struct answer *answers = ask(*state, probes, 256);
    for (int i = 0; i < 256; i++)
        assert_true(answers[i].value[0] == 250.0f * probes[i].a[1]);
    free(answers);
    probes[0].a[0] = probes[0].a[1] = 1000;
    answers = ask(*state, probes, 1);
    print_message("of 1000000 turns in one thread, %.0f are made\n", (double)answers[0].value[0]);
    free(answers);
}

/* --- phase functions ---------------------------------------------------------------------- */

static void test_phase_functions(void **state)
{
    struct probe *probes = new_probes();
    uint64_t random = seed;
    static const float edges[] = {0.0f, 0.5f, -0.5f, 0.9f, -0.9f, 0.99f, 0.999f, -0.999f};
    const int count = 12000;
    for (int i = 0; i < count; i++) {
        struct probe *p = &probes[i];
        p->what = PROBE_PHASE;
        p->kind = (uint32_t)(i % NEPH_PHASE_TABLE);
        p->a[1] = uniform(&random, 0.0, 1.0);
        p->a[0] = i % 2 ? edges[(i / (2 * (int)NEPH_PHASE_TABLE)) % 8]
                        : uniform(&random, -0.999, 0.999);
        direction(&random, p->b);
        direction(&random, p->c);
        if (i % 5 == 0) { /* at or near the peak, forward or backward */
            const float sign = i % 10 ? 1.0f : -1.0f;
            for (int k = 0; k < 3; k++)
                p->c[k] = sign * p->b[k] + (i % 20 < 10 ? 0.0f : uniform(&random, -1e-3, 1e-3));
            const struct neph_vec3 unit = neph_vec3_normalize(vec3(p->c));
            p->c[0] = (float)unit.x;
            p->c[1] = (float)unit.y;
            p->c[2] = (float)unit.z;
        }
    }
    OWNED(memory) struct answer *answers = ask(*state, probes, count);
    double worst = 0.0;
    for (int i = 0; i < count; i++) {
        const struct probe *p = &probes[i];
        const enum neph_phase_kind kind = (enum neph_phase_kind)p->kind;
        const bool has_g = neph_phase_has(kind, NEPH_PHASE_PARAMETER_G);
        const struct neph_phase phase = {kind, has_g ? p->a[0] : 0.0},
                                forward = {kind, fabs(phase.g)};
        const double cosine = neph_vec3_dot(neph_vec3_normalize(vec3(p->b)),
                                            neph_vec3_normalize(vec3(p->c)));
        const double expected = neph_phase_per_sr(&phase, cosine);
        /* A rounding of the vector turns it by 6e-8. Near the peak the factor base^(-3/2), with
         * base = (1-|g|)^2 + |g| angle^2, makes this at most 3/2 * 2 * 6e-8 sqrt|g| / (1-|g|). */
        const double a = fabs((double)p->a[0]);
        const double turned = has_g ? 3.0 * 0.5 * epsilon / (1.0 - a) : 0.0;
        const double error = fabs(answers[i].value[0] / expected - 1.0);
        worst = fmax(worst, error / (8.0 * epsilon + turned));
        neph_assert_close(answers[i].value[0], expected, 8.0 * epsilon + turned, 0.0);
        /* The power for Rayleigh's root is exp2 of a product, accurate to a few dozen roundings. */
        neph_assert_close(answers[i].value[1], neph_phase_versine(&forward, p->a[1]), 0.0,
                          64.0 * epsilon);
        neph_assert_close(answers[i].value[2], neph_phase_mean_cosine(&phase), 4.0 * epsilon, 0.0);
    }
    print_message("phase: worst error is %.2f of what is allowed\n", worst);
}

/* --- fog ---------------------------------------------------------------------------------- */

/* Fog as the shader gets it: the reference height moved by neph_gpu_fog_layer_from(), y relative to
 * the camera. The reference uses the same float32 numbers. */
static void set_layer(struct probe *p, struct neph_gpu_fog_layer layer)
{
    p->a[0] = layer.extinction_per_m;
    p->a[1] = layer.falloff_per_m;
    p->a[2] = layer.height_m;
    p->a[3] = layer.exponent_max;
}

static struct neph_fog_layer make_layer(const struct probe *p)
{
    return (struct neph_fog_layer){p->a[0], p->a[1], p->a[2]};
}

static void random_fog(uint64_t *random, struct probe *p, int i)
{
    static const double falloffs[] = {0.0, 1e-9, 1e-6, 0.01386, 0.1, 1.0, 10.0};
    static const float slopes[] = {0.0f, 1e-20f, -1e-20f, 1e-7f, -1e-7f, 1e-3f, 1.0f, -1.0f};
    const struct neph_fog_layer layer = {
        .extinction_per_m = scale(random, 1e-9, 10.0),
        .falloff_per_m = i % 2 ? falloffs[(i / 2) % 7] : scale(random, 1e-6, 1.0),
        .height_m = i % 5 ? uniform(random, -100.0, 100.0) : uniform(random, -1e6, 1e6),
    };
    set_layer(p, neph_gpu_fog_layer_from(&layer, i % 7 ? uniform(random, 0.0, 500.0)
                                                       : uniform(random, -1e6, 1e6)));
    p->b[0] = i % 3 ? uniform(random, -200.0, 200.0) : 0.0f;
    p->b[1] = i % 2 ? uniform(random, -1.0, 1.0) : slopes[(i / 2) % 8];
    p->b[2] = i % 11 ? scale(random, 1e-3, 1e6) : NEPH_GPU_FAR_M;
}

/* Relative float32 error of the extinction at y: of exp, and of its rounded argument. */
static double extinction_tolerance(const struct probe *p, double y_m, double y_magnitude_m)
{
    const double exponent = fabs((double)p->a[1] * (y_m - (double)p->a[2]));
    const double operands = (double)p->a[1] * (y_magnitude_m + fabs((double)p->a[2]));
    return epsilon * (8.0 + 2.0 * exponent + 1.5 * operands);
}

static void test_fog_optical_depth(void **state)
{
    struct probe *probes = new_probes();
    uint64_t random = seed;
    const int count = PROBES_MAX;
    for (int i = 0; i < count; i++) {
        probes[i].what = PROBE_FOG;
        random_fog(&random, &probes[i], i);
    }
    OWNED(memory) struct answer *answers = ask(*state, probes, count);
    int compared = 0;
    for (int i = 0; i < count; i++) {
        const struct probe *p = &probes[i];
        const struct neph_fog_layer layer = make_layer(p);
        const double expected = neph_fog_layer_optical_depth(&layer, p->b[0], p->b[1], p->b[2]);
        const double depth = answers[i].value[0];
        assert_true(depth >= 0.0 && isfinite(depth));
        const double end_y_m = p->b[0] + (double)p->b[1] * (double)p->b[2];
        const double dense_y_m = p->a[1] * p->b[1] >= 0.0f ? p->b[0] : end_y_m;
        const double exponent = -layer.falloff_per_m * (dense_y_m - layer.height_m);
        const double magnitude_m = fabs((double)p->b[0]) +
                                   (dense_y_m == end_y_m ? fabs(end_y_m - p->b[0]) : 0.0);
        const double relative = extinction_tolerance(p, dense_y_m, magnitude_m);
        /* The transmittance must be correct in every case; an optical depth above 100 is black. */
        if (relative < 1.0) {
            const double transmitted = exp(-expected);
            neph_assert_close(answers[i].value[1], transmitted,
                              fmin(relative * expected, 50.0) + epsilon * (3.0 + 2.0 * expected),
                              2e-38 + relative * 0.37);
            compared++;
        }
        /* A density or a depth below the smallest normal number may be flushed to 0. */
        const double decay = fabs((double)p->a[1] * (double)p->b[1]) * (double)p->b[2];
        if (expected < 100.0 && exponent > -80.0 && relative < 0.01)
            neph_assert_close(depth, expected, relative,
                              1.2e-38 * (1.0 + (double)p->b[2] * neph_phi(decay)));
    }
    print_message("fog: %d of %d transmittances compared\n", compared, count);
    assert_true(compared > count * 9 / 10);
}

static void test_fog_extinction(void **state)
{
    struct probe *probes = new_probes();
    uint64_t random = seed;
    const int count = 10000;
    for (int i = 0; i < count; i++) {
        probes[i].what = PROBE_EXTINCTION;
        random_fog(&random, &probes[i], i);
    }
    OWNED(memory) struct answer *answers = ask(*state, probes, count);
    for (int i = 0; i < count; i++) {
        const struct probe *p = &probes[i];
        const struct neph_fog_layer layer = make_layer(p);
        const double exponent = -layer.falloff_per_m * ((double)p->b[0] - layer.height_m);
        const double expected = layer.extinction_per_m * exp(fmin(exponent, (double)p->a[3]));
        assert_true(answers[i].value[0] >= 0.0f && answers[i].value[0] <= 1.01e20f);
        neph_assert_close(answers[i].value[0], expected,
                          extinction_tolerance(p, p->b[0], fabs((double)p->b[0])),
                          layer.extinction_per_m * 2e-38 + 2e-38);
    }
}

/* The ends of a march are approximate; the omitted parts must be as small as documented. */
static void test_fog_distances_omit_little_depth(void **state)
{
    struct probe *probes = new_probes();
    uint64_t random = seed;
    const int count = PROBES_MAX;
    static const float depths[] = {1e-7f, 16.0f};
    for (int i = 0; i < count; i++) {
        probes[i].what = PROBE_DISTANCE;
        random_fog(&random, &probes[i], i);
        probes[i].b[2] = depths[(i / 3) % 2];
    }
    OWNED(memory) struct answer *answers = ask(*state, probes, count);
    for (int i = 0; i < count; i++) {
        const struct probe *p = &probes[i];
        const struct neph_fog_layer layer = make_layer(p);
        const double wanted = p->b[2];
        const double distance_m = answers[i].value[0], thin_end_m = answers[i].value[1];
        assert_true(distance_m >= 0.0 && !isnan(thin_end_m));
        const double met = neph_fog_layer_optical_depth(&layer, p->b[0], p->b[1], distance_m);
        const double total = neph_fog_layer_optical_depth(&layer, p->b[0], p->b[1], INFINITY);
        /* A distance has a relative error of ~1e-6; a steep fog needs it to a fraction of its scale
         * height. */
        const double rate_per_m = fabs((double)p->a[1] * (double)p->b[1]);
        const double blur = exp(fmin(20.0, rate_per_m * distance_m * 1e-6));
        if (distance_m < 0.99 * (double)NEPH_GPU_FAR_M) {
            if (distance_m > 1e-36 && rate_per_m > 1e-25)
                neph_assert_close(met / wanted, 1.0, 0.04 * blur + (blur - 1.0), 0.0);
        } else {
            assert_true(fmin(met, total) <= wanted * 1.05);
        }
        if (rate_per_m * (p->b[1] > 0 ? 1.0 : 0.0) > 1e-25 && thin_end_m > 0.0 &&
            thin_end_m < 0.99 * (double)NEPH_GPU_FAR_M) {
            const double left = neph_fog_layer_optical_depth(
                &layer, p->b[0] + (double)p->b[1] * thin_end_m, p->b[1], INFINITY);
            neph_assert_close(left, 1e-7, 0.001 + 1e-6 * rate_per_m * thin_end_m, 0.0);
        }
    }
}

/* --- solids ------------------------------------------------------------------------------- */

/* Random rays, half of them aimed at the solid. */
static void random_ray(uint64_t *random, struct probe *p, const float target[3], float spread)
{
    for (int k = 0; k < 3; k++)
        p->c[k] = uniform(random, -50.0, 50.0);
    direction(random, p->d);
    if (neph_test_random(random) % 2) {
        struct neph_vec3 towards = {
            (double)target[0] + neph_test_uniform(random, -1, 1) * (double)spread - (double)p->c[0],
            (double)target[1] + neph_test_uniform(random, -1, 1) * (double)spread - (double)p->c[1],
            (double)target[2] + neph_test_uniform(random, -1, 1) * (double)spread -
                (double)p->c[2]};
        towards = neph_vec3_normalize(towards);
        p->d[0] = (float)towards.x;
        p->d[1] = (float)towards.y;
        p->d[2] = (float)towards.z;
    }
}

static void test_boxes(void **state)
{
    struct probe *probes = new_probes();
    uint64_t random = seed;
    const int count = PROBES_MAX;
    for (int i = 0; i < count; i++) {
        struct probe *p = &probes[i];
        p->what = PROBE_SOLID;
        p->kind = NEPH_SOLID_BOX;
        float middle[3];
        for (int k = 0; k < 3; k++) {
            p->a[k] = uniform(&random, -20.0, 20.0);
            p->b[k] = p->a[k] + (i % 2 ? scale(&random, 1e-3, 20.0) : uniform(&random, 5.0, 20.0));
            middle[k] = 0.5f * (p->a[k] + p->b[k]);
        }
        random_ray(&random, p, middle, 5.0f);
    }
    OWNED(memory) struct answer *answers = ask(*state, probes, count);
    int met = 0, grazing = 0;
    for (int i = 0; i < count; i++) {
        const struct probe *p = &probes[i];
        const struct neph_bounds box = {vec3(p->a), vec3(p->b)};
        double t0_m = -INFINITY, t1_m = INFINITY;
        const bool expected = neph_bounds_clip(&box, vec3(p->c), vec3(p->d), &t0_m, &t1_m);
        const bool actual = answers[i].value[2] > 0.0f;
        /* (face - origin) / direction: two roundings. Where entry and exit are closer than that,
         * hit and miss are both correct. */
        const double allowed_m = 2.0 * epsilon * fmax(fabs(t0_m), fabs(t1_m));
        if (isfinite(allowed_m) && fabs(t1_m - t0_m) <= 2.0 * allowed_m) {
            grazing++;
            continue;
        }
        assert_int_equal(actual, expected);
        if (!expected)
            continue;
        met++;
        neph_assert_close(answers[i].value[0], t0_m, 2.0 * epsilon, 0.0);
        neph_assert_close(answers[i].value[1], t1_m, 2.0 * epsilon, 0.0);
    }
    print_message("boxes: %d met, %d grazing of %d\n", met, grazing, count);
    assert_true(met > count / 10 && grazing < count / 1000);
}

/* Data of a sphere on the device, for a camera at the origin. */
static void place_sphere(struct probe *p)
{
    const struct neph_solid sphere = {
        .kind = NEPH_SOLID_SPHERE, .center_m = vec3(p->a), .radius_m = (double)p->b[3]};
    const struct neph_gpu_solid gpu = neph_gpu_solid_pack(&sphere, (struct neph_vec3){0, 0, 0});
    memcpy(p->b, gpu.high_m, sizeof(gpu.high_m));
    p->a[3] = gpu.albedo[3];
}

static void test_spheres(void **state)
{
    struct probe *probes = new_probes();
    uint64_t random = seed;
    const int count = PROBES_MAX;
    for (int i = 0; i < count; i++) {
        struct probe *p = &probes[i];
        p->what = PROBE_SOLID;
        p->kind = NEPH_SOLID_SPHERE;
        const double reach_m = i % 4 ? 30.0 : 1000.0;
        for (int k = 0; k < 3; k++)
            p->a[k] = uniform(&random, -reach_m, reach_m);
        p->b[3] = scale(&random, 0.01, 20.0);
        place_sphere(p);
        random_ray(&random, p, p->a, p->b[3]);
    }
    OWNED(memory) struct answer *answers = ask(*state, probes, count);
    int met = 0, grazing = 0;
    for (int i = 0; i < count; i++) {
        const struct probe *p = &probes[i];
        const struct neph_vec3 offset_m = neph_vec3_sub(vec3(p->c), vec3(p->a));
        const double middle_m = -neph_vec3_dot(offset_m, vec3(p->d));
        const double miss_m = neph_vec3_length(neph_vec3_along(offset_m, vec3(p->d), middle_m));
        const double radius_m = p->b[3];
        const double half_squared = (radius_m - miss_m) * (radius_m + miss_m);
        /* The nearest point has an error of a few roundings of the distance; the half chord has
         * that times its slope, miss / half chord. */
        const double position_m = 3.0 * epsilon * neph_vec3_length(offset_m);
        if (fabs(radius_m - miss_m) < 4.0 * position_m) {
            grazing++;
            continue;
        }
        assert_int_equal(answers[i].value[2] > 0.0f, half_squared > 0.0);
        if (half_squared <= 0.0)
            continue;
        met++;
        const double half_m = sqrt(half_squared);
        const double allowed_m = position_m * (1.0 + 2.0 * miss_m / half_m) +
                                 4.0 * epsilon * radius_m;
        neph_assert_close(answers[i].value[0], middle_m - half_m, 0.0, allowed_m);
        neph_assert_close(answers[i].value[1], middle_m + half_m, 0.0, allowed_m);
    }
    print_message("spheres: %d met, %d grazing of %d\n", met, grazing, count);
    assert_true(met > count / 10 && grazing < count / 100);
}

/* The Earth from up to 100 m above it: where rays meet the ground. Its position is exact in
 * float32, and the double side uses the float32 radius. The altitude of the ray's start is accurate
 * to a few roundings of its distance from the camera; along the ray this grows by 1 / sine. */
static void test_the_ground_of_a_planet(void **state)
{
    struct probe *probes = new_probes();
    uint64_t random = seed;
    const int count = PROBES_MAX;
    const double radius_m = 6371000.0;
    for (int i = 0; i < count; i++) {
        struct probe *p = &probes[i];
        p->what = PROBE_SOLID;
        p->kind = NEPH_SOLID_SPHERE;
        p->a[1] = -6371000.0f - (i % 2 ? 1.5f : 50.0f);
        p->b[3] = (float)radius_m;
        place_sphere(p);
        p->c[0] = uniform(&random, -100.0, 100.0);
        p->c[1] = uniform(&random, -1.0, 50.0);
        p->c[2] = uniform(&random, -100.0, 100.0);
        direction(&random, p->d);
        p->d[1] = -fabsf(p->d[1]);
    }
    OWNED(memory) struct answer *answers = ask(*state, probes, count);
    int met = 0;
    for (int i = 0; i < count; i++) {
        const struct probe *p = &probes[i];
        const struct neph_solid earth = {
            .kind = NEPH_SOLID_SPHERE, .center_m = vec3(p->a), .radius_m = radius_m};
        struct neph_solid solids[1] = {earth};
        const struct neph_scene scene = {.solid_count = 1, .solids = solids};
        const struct neph_hit hit = neph_scene_hit(&scene, vec3(p->c),
                                                   neph_vec3_normalize(vec3(p->d)));
        const double height_m = neph_vec3_length(neph_vec3_sub(vec3(p->c), earth.center_m)) -
                                radius_m;
        const double sine = -(double)p->d[1];
        if (height_m < 0.01 || sine < 0.02)
            continue;
        met++;
        assert_true(answers[i].value[2] > 0.0f);
        neph_assert_close(answers[i].value[0], hit.t_m, 8.0 * epsilon,
                          8.0 * epsilon * (100.0 + hit.t_m) / sine);
    }
    print_message("the ground of a planet: %d rays of %d\n", met, count);
    assert_true(met > count / 2);
}

/* --- halves ------------------------------------------------------------------------------- */

static float moved(float value, int ulps)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof(bits));
    bits += (uint32_t)ulps;
    memcpy(&value, &bits, sizeof(value));
    return value;
}

/* The half itself, and three floats around the middle between it and the next larger one. */
static void about_half(uint32_t half, float values[4])
{
    const uint32_t magnitude = half & 0x7fffu;
    const float sign = half & 0x8000u ? -1.0f : 1.0f;
    const float own = neph_half_to_float((uint16_t)magnitude);
    const float next = magnitude == 0x7bffu ? 65536.0f
                                            : neph_half_to_float((uint16_t)(magnitude + 1));
    const float middle = sign * (0.5f * (own + next));
    const bool ends = magnitude >= 0x7c00u;
    for (int i = 0; i < 4; i++)
        values[i] = i == 0 || ends ? neph_half_to_float((uint16_t)half) : moved(middle, i - 2);
}

static bool is_read_right(float answer, uint16_t half)
{
    const float expected = neph_half_to_float(half);
    return isnan(expected) ? isnan(answer) : memcmp(&answer, &expected, sizeof(answer)) == 0;
}

static bool is_written_right(float answer, float value)
{
    const uint16_t half = (uint16_t)answer;
    return isnan(value) ? isnan(neph_half_to_float(half)) : half == neph_rt_to_half(value);
}

/* Bits of the driver's conversions that differ from the CPU reference, for `count` halves. */
static uint32_t wrong_from(struct neph_vulkan *vulkan, struct probe *probes, uint32_t first,
                           int count)
{
    uint32_t wrong = 0;
    for (int i = 0; i < 2 * count; i++) {
        const uint32_t half = first + (uint32_t)i / 2;
        float values[4];
        about_half(half, values);
        probes[i] = (struct probe){.what = PROBE_HALVES, .kind = half | half << 16};
        memcpy(probes[i].a, &values[i % 2 * 2], 2 * sizeof(values[0]));
    }
    OWNED(memory) struct answer *answers = ask(vulkan, probes, 2 * count);
    for (int i = 0; i < 2 * count; i++)
        for (int c = 0; c < 2; c++) {
            if (!is_read_right(answers[i].value[c], (uint16_t)probes[i].kind))
                wrong |= NEPH_HALVES_READ;
            if (!is_written_right(answers[i].value[2 + c], probes[i].a[c]))
                wrong |= NEPH_HALVES_WRITTEN;
        }
    return wrong;
}

/* neph_halves_test() reports the driver's behaviour correctly, for every driver. */
static void test_driver_halves_are_classified(void **state)
{
    struct probe *probes = new_probes();
    const int batch = 8192;
    uint32_t wrong = 0, right = 0;
    struct neph_diag diag = {0};
    for (uint32_t half = 0; half < 1u << 16; half += (uint32_t)batch)
        wrong |= wrong_from(*state, probes, half, batch);
    neph_assert_ok(neph_halves_test(*state, &right, &diag), &diag);
    print_message("halves: read right %d, written right %d\n", (right & NEPH_HALVES_READ) != 0,
                  (right & NEPH_HALVES_WRITTEN) != 0);
    assert_int_equal(right, (NEPH_HALVES_READ | NEPH_HALVES_WRITTEN) & ~wrong);
}

int main(void)
{
    print_message("seed %llu\n", (unsigned long long)seed);
    const struct CMUnitTest tests[] = {
#include "cases/test_shaders.inc"
    };
    return cmocka_run_group_tests(tests, test_vulkan_setup, test_vulkan_teardown);
}
