/* SPDX-License-Identifier: MIT
 *
 * Media against 50-digit references, and the general properties of an optical depth.
 */
#include "tests/scene_builders.h"

#include "scenes/media.h"
#include "scenes/quadrature.h"
#include "tests/scenes/reference_values.h"

#include <float.h>

static const double unit_roundoff = 0x1p-53;

/* The worst error of a quantity, for printing the measured value next to the asserted one. */
struct worst {
    const char *what;
    double relative;
};

static void note(struct worst *worst, double actual, double expected, double allowed)
{
    const double error = fabs(actual - expected) / fabs(expected);
    if (allowed < 2e-12 && isfinite(error) && error > worst->relative)
        worst->relative = error;
}

static void report(const struct worst *worst)
{
    print_message("worst relative error, %s: %.2g\n", worst->what, worst->relative);
}

/* phi(x) = (1 - e^-x)/x to a few ulp over all magnitudes and both signs. Where e^-x itself is
 * ill-conditioned (|x| large and negative) its exponent is still the exact input. */
static void test_phi(void **state)
{
    struct worst worst = {.what = "phi"};
    for (size_t i = 0; i < COUNT(reference_phi); i++) {
        const double phi = neph_phi(reference_phi[i].x), expected = reference_phi[i].phi;
        neph_assert_close(phi, expected, 1e-15, 0.0);
        note(&worst, phi, expected, 0.0);
    }
    assert_true(neph_phi(INFINITY) == 0.0);
    assert_true(neph_phi(-INFINITY) == INFINITY);
    report(&worst);
}

/* One layer: all extremes of the parameters. 1e-12, or, where the exponent b (y - h) is so large
 * that rounding its inputs changes the result further, four such roundings. */
static void assert_fog_depth(double tau, const struct reference_depth *r, struct worst *depth,
                             struct worst *light)
{
    const double relative = fmax(1e-12, 4.0 * unit_roundoff * r->condition);
    assert_true(tau >= 0.0);
    if (relative < 0.1)
        neph_assert_close(tau, r->optical_depth, relative, 2.0 * 0x1p-1074);
    note(depth, tau, r->optical_depth, relative);
    /* exp turns an absolute error of its argument into a relative one. */
    const double transmittance = exp(-tau), expected = exp(-r->optical_depth);
    assert_true(transmittance >= 0.0 && transmittance <= 1.0);
    if (relative < 0.1)
        neph_assert_close(transmittance, expected,
                          2.0 * relative * fmin(700.0, fmax(1.0, r->optical_depth)),
                          2.0 * 0x1p-1074);
    if (r->optical_depth <= 1.0)
        note(light, transmittance, expected, relative);
}

static void test_fog_layer_against_reference(void **state)
{
    struct worst depth = {.what = "fog optical depth"}, light = {.what = "fog transmittance"};
    for (size_t i = 0; i < COUNT(reference_fog); i++) {
        const struct reference_fog *r = &reference_fog[i];
        for (const struct reference_depth *d = r->depths; d < r->depths + r->count; d++)
            assert_fog_depth(neph_fog_layer_optical_depth(&r->layer, r->y_m, r->k_y, d->length_m),
                             d, &depth, &light);
    }
    report(&depth);
    report(&light);
}

/* Never NaN, never negative, never T > 1: all combinations of extremes, without a reference. */
static void test_fog_layer_is_never_nonsense(void **state)
{
    static const double extinctions[] = {0.0, 5e-324, 1e-300, 1e-3, 1.0, 1e300};
    static const double falloffs[] = {0.0, 5e-324, 1e-300, 1e-9, 0.01, 1.0, 1e3};
    static const double heights[] = {-1e6, -3.0, 0.0, 3.0, 1e6};
    static const double slopes[] = {0.0, -0.0, 5e-324, 1e-300, 1e-160, 1e-9, 0.5, 1.0};
    static const double lengths[] = {0.0, 5e-324, 1e-300, 1.0, 1e6, 1e300, DBL_MAX, INFINITY};
    for (size_t a = 0; a < COUNT(extinctions); a++)
        for (size_t b = 0; b < COUNT(falloffs); b++)
            for (size_t h = 0; h < COUNT(heights); h++)
                for (size_t k = 0; k < 2 * COUNT(slopes); k++)
                    for (size_t l = 0; l < COUNT(lengths); l++) {
                        const struct neph_fog_layer layer = {extinctions[a], falloffs[b], 0.0};
                        const double k_y = k % 2 ? -slopes[k / 2] : slopes[k / 2];
                        const double tau = neph_fog_layer_optical_depth(&layer, heights[h], k_y,
                                                                        lengths[l]);
                        if (!(tau >= 0.0))
                            print_error("a %g, b %g, y %g, k %g, length %g: %g\n", extinctions[a],
                                        falloffs[b], heights[h], k_y, lengths[l], tau);
                        assert_true(tau >= 0.0 && exp(-tau) <= 1.0);
                        if (extinctions[a] == 0.0 || lengths[l] == 0.0)
                            assert_true(tau == 0.0);
                    }
}

struct fog_ray {
    struct neph_fog_layer layer;
    double y_m, k_y;
};

static void fog_on_ray(double t_m, void *context, double value[3])
{
    const struct fog_ray *ray = context;
    value[0] = ray->layer.extinction_per_m *
               exp(-ray->layer.falloff_per_m * (ray->y_m + t_m * ray->k_y - ray->layer.height_m));
    value[1] = value[2] = 0.0;
}

/* Fog that becomes thinner downwards: the same formula, against quadrature and its own inverse. */
static void test_fog_upside_down(void **state)
{
    static const double falloffs[] = {-1e-3, -0.1, -2.0}, slopes[] = {-1.0, -0.3, 0.2, 1.0};
    static const double lengths[] = {0.5, 20.0, 300.0};
    for (size_t b = 0; b < COUNT(falloffs); b++)
        for (size_t k = 0; k < COUNT(slopes); k++)
            for (size_t l = 0; l < COUNT(lengths); l++) {
                struct fog_ray ray = {{0.2, falloffs[b], 1.0}, 3.0, slopes[k]};
                struct neph_interval pieces[64];
                double expected[3];
                for (int i = 0; i < 64; i++)
                    pieces[i] = (struct neph_interval){lengths[l] * i / 64.0,
                                                       lengths[l] * (i + 1) / 64.0};
                neph_integrate(fog_on_ray, &ray, pieces, 64, expected);
                const double depth = neph_fog_layer_optical_depth(&ray.layer, ray.y_m, ray.k_y,
                                                                  lengths[l]);
                /* Exponents up to 600 are rounded. */
                neph_assert_close(depth, expected[0], 1e-12 + 600.0 * unit_roundoff * 4.0, 0.0);
                const double part_m = 0.25 * lengths[l];
                const double part = neph_fog_layer_optical_depth(&ray.layer, ray.y_m, ray.k_y,
                                                                 part_m);
                if (part < 0.999 * depth) /* otherwise nothing remains to invert */
                    neph_assert_close(neph_fog_layer_distance_m(&ray.layer, ray.y_m, ray.k_y, part),
                                      part_m, 1e-9, 0.0);
            }
    const struct neph_fog_layer layer = {1e-3, -0.01, 0.0};
    neph_assert_close(neph_fog_layer_optical_depth(&layer, 0.0, -1.0, INFINITY), 0.1, 1e-15, 0.0);
    assert_true(neph_fog_layer_optical_depth(&layer, 0.0, 1.0, INFINITY) == INFINITY);
}

/* To infinity: finite upwards, opaque horizontally and downwards, at any eye height. */
static void test_infinite_rays(void **state)
{
    const struct neph_fog_layer fog = {1e-3, 0.01, 0.0};
    neph_assert_close(neph_fog_layer_optical_depth(&fog, 0.0, 1.0, INFINITY), 0.1, 1e-15, 0.0);
    neph_assert_close(neph_fog_layer_optical_depth(&fog, 0.0, 0.5, INFINITY), 0.2, 1e-15, 0.0);
    for (double y_m = -1e4; y_m < 2e6; y_m += 1e5) {
        assert_true(neph_fog_layer_optical_depth(&fog, y_m, 0.0, INFINITY) == INFINITY);
        assert_true(neph_fog_layer_optical_depth(&fog, y_m, -0.1, INFINITY) == INFINITY);
    }
    const struct neph_fog_layer homogeneous = {1e-3, 0.0, 0.0};
    assert_true(neph_fog_layer_optical_depth(&homogeneous, 0.0, 1.0, INFINITY) == INFINITY);
}

static struct neph_medium random_medium(uint64_t *seed)
{
    struct neph_medium medium = {.kind = NEPH_MEDIUM_HEIGHT_FOG,
                                 .bounds = everywhere,
                                 .layer_count = 2,
                                 .extinction_color = {1, 1, 1}};
    for (int i = 0; i < 2; i++)
        medium.layers[i] = (struct neph_fog_layer){pow(10.0, neph_test_uniform(seed, -5, -1)),
                                                   pow(10.0, neph_test_uniform(seed, -4, -1)),
                                                   neph_test_uniform(seed, -30, 30)};
    if (neph_test_uniform(seed, 0, 1) < 0.7) {
        const struct neph_vec3 corner = random_point(seed, 60.0);
        medium.bounds = (struct neph_bounds){
            corner, neph_vec3_add(corner, (struct neph_vec3){neph_test_uniform(seed, 1, 90),
                                                             neph_test_uniform(seed, 1, 90),
                                                             neph_test_uniform(seed, 1, 90)})};
    }
    return medium;
}

/* Rounding errors in parts of a ray: positions of up to 400 m, falloffs of up to 0.1 / m and
 * extinctions of up to e^{0.1 * 130} times 0.1 / m at their densest give these for 2^-53. */
static const double property_relative = 1e-12;
static const double property_absolute = 1e-13;

/* tau(0, a) + tau(a, b) = tau(0, b), and the reversed ray meets the same fog. */
static void test_optical_depth_adds_and_reverses(void **state)
{
    const uint64_t first_seed = 20240607;
    for (uint64_t trial = 0; trial < 20000; trial++) {
        uint64_t seed = first_seed + trial;
        const struct neph_medium medium = random_medium(&seed);
        const struct neph_vec3 origin = random_point(&seed, 80.0), d = random_direction(&seed);
        const double a_m = neph_test_uniform(&seed, 0, 150), b_m = neph_test_uniform(&seed, 0, 150);
        const double end_m = a_m + b_m;
        const double whole = neph_medium_optical_depth(&medium, origin, d, 0.0, end_m);
        const double parts = neph_medium_optical_depth(&medium, origin, d, 0.0, a_m) +
                             neph_medium_optical_depth(&medium, origin, d, a_m, end_m);
        const double back = neph_medium_optical_depth(&medium, neph_vec3_along(origin, d, end_m),
                                                      neph_vec3_scale(d, -1.0), 0.0, end_m);
        const double allowed = property_relative * whole + property_absolute;
        if (!(fabs(parts - whole) <= allowed && fabs(back - whole) <= allowed))
            print_error("seed %llu\n", (unsigned long long)(first_seed + trial));
        neph_assert_close(parts, whole, 0.0, allowed);
        neph_assert_close(back, whole, 0.0, allowed);
    }
}

/* Bounds only cut: the depth inside is the unbounded depth of the segment inside, and the
 * extinction is 0 outside and unchanged inside. */
static void test_bounds_clip(void **state)
{
    const uint64_t first_seed = 99;
    for (uint64_t trial = 0; trial < 20000; trial++) {
        uint64_t seed = first_seed + trial;
        const struct neph_medium medium = random_medium(&seed);
        struct neph_medium unbounded = medium;
        unbounded.bounds = everywhere;
        const struct neph_vec3 origin = random_point(&seed, 80.0), d = random_direction(&seed);
        double t0_m = 0.0, t1_m = 300.0;
        const bool inside = neph_bounds_clip(&medium.bounds, origin, d, &t0_m, &t1_m);
        const double expected = inside
                                    ? neph_medium_optical_depth(&unbounded, origin, d, t0_m, t1_m)
                                    : 0.0;
        neph_assert_close(neph_medium_optical_depth(&medium, origin, d, 0.0, 300.0), expected, 0.0,
                          0.0);

        const struct neph_vec3 p = random_point(&seed, 80.0);
        const bool contained = p.x >= medium.bounds.min_m.x && p.x <= medium.bounds.max_m.x &&
                               p.y >= medium.bounds.min_m.y && p.y <= medium.bounds.max_m.y &&
                               p.z >= medium.bounds.min_m.z && p.z <= medium.bounds.max_m.z;
        neph_assert_close(neph_medium_extinction_per_m(&medium, p),
                          contained ? neph_medium_extinction_per_m(&unbounded, p) : 0.0, 0.0, 0.0);
    }
}

static void test_clip_by_hand(void **state)
{
    const struct neph_bounds box = {{-1, 0, -1}, {1, 2, 1}};
    double t0_m = 0.0, t1_m = INFINITY;
    assert_true(neph_bounds_clip(&box, (struct neph_vec3){-5, 1, 0}, (struct neph_vec3){1, 0, 0},
                                 &t0_m, &t1_m));
    assert_true(t0_m == 4.0 && t1_m == 6.0);
    t0_m = 0.0, t1_m = INFINITY; /* from inside */
    assert_true(neph_bounds_clip(&box, (struct neph_vec3){0, 1, 0}, (struct neph_vec3){0, -1, 0},
                                 &t0_m, &t1_m));
    assert_true(t0_m == 0.0 && t1_m == 1.0);
    t0_m = 0.0, t1_m = INFINITY; /* behind */
    assert_false(neph_bounds_clip(&box, (struct neph_vec3){5, 1, 0}, (struct neph_vec3){1, 0, 0},
                                  &t0_m, &t1_m));
    t0_m = 0.0, t1_m = 3.0; /* ends in front of it */
    assert_false(neph_bounds_clip(&box, (struct neph_vec3){-5, 1, 0}, (struct neph_vec3){1, 0, 0},
                                  &t0_m, &t1_m));
    t0_m = 0.0, t1_m = INFINITY; /* all open */
    assert_true(neph_bounds_clip(&everywhere, (struct neph_vec3){5, 1, 0},
                                 (struct neph_vec3){0, 1e-300, -1}, &t0_m, &t1_m));
    assert_true(t0_m == 0.0 && t1_m == INFINITY);
}

/* A scene's optical depth is the sum of its media's. */
static void test_scene_adds_media(void **state)
{
    struct neph_scene scene = {.medium_count = 2};
    scene.media[0] = (struct neph_medium){.bounds = {{0, 0, 0}, {2, 2, 2}},
                                          .layer_count = 1,
                                          .extinction_color = {1, 1, 1},
                                          .layers = {{.extinction_per_m = 0.5}}};
    scene.media[1] = (struct neph_medium){.bounds = {{1, 0, 0}, {5, 2, 2}},
                                          .layer_count = 1,
                                          .extinction_color = {1, 1, 1},
                                          .layers = {{.extinction_per_m = 0.25}}};
    const struct neph_vec3 origin = {-1, 1, 1}, direction = {1, 0, 0};
    neph_assert_close(neph_scene_optical_depth(&scene, origin, direction, 0.0, INFINITY).r, 2.0,
                      1e-15, 0.0);
    neph_assert_close(neph_scene_optical_depth(&scene, origin, direction, 0.0, 2.5).r, 0.875, 1e-15,
                      0.0);
}

static void test_phase_against_reference(void **state)
{
    struct worst worst = {.what = "phase functions"};
    for (size_t i = 0; i < COUNT(reference_phase); i++) {
        const struct reference_phase *r = &reference_phase[i];
        for (int k = 0; k < r->count; k++) {
            const double value = neph_phase_per_sr(&r->phase, r->values[k].cosine);
            neph_assert_close(value, r->values[k].per_sr, 4e-15, 0.0);
            note(&worst, value, r->values[k].per_sr, 0.0);
        }
    }
    report(&worst);
}

/* p, p P_1 and p P_2 over the sphere at c = cos(theta), substituted to widen the peak of each side:
 * c = +-(1 - 2 v^2). */
static void phase_moments(double v, void *context, double value[3])
{
    const struct neph_phase *phase = context;
    const double from_pole = 2.0 * v * v, c = 1.0 - from_pole, jacobian = 8.0 * M_PI * v;
    const double forward = neph_phase_per_sr(phase, c);
    const double backward = neph_phase_per_sr(phase, -c);
    value[0] = jacobian * (forward + backward);
    value[1] = jacobian * c * (forward - backward);
    value[2] = jacobian * (1.5 * c * c - 0.5) * (forward + backward);
}

/* 1 - 2 v^2 is rounded by 2^-53, which changes a peak of width (1-g)^2 by at most a relative
 * 2^-53/(1-g)^2; the top of Henyey-Greenstein's is 1 / (2 pi) of 1/(1-g)^2, or less. */
static void check_moments(struct neph_phase phase)
{
    /* Both hemispheres at once: forward and backward poles at v = 0, the equator at v^2 = 1/2. */
    const struct neph_interval pieces[] = {{0.0, 0.002}, {0.002, 0.05}, {0.05, sqrt(0.5)}};
    const double peak = fmax(neph_phase_per_sr(&phase, 1.0), neph_phase_per_sr(&phase, -1.0));
    const double allowed = 1e-13 + unit_roundoff * 2.0 * M_PI * peak;
    double moments[3];
    neph_integrate(phase_moments, &phase, pieces, 3, moments);
    neph_assert_close(moments[0], 1.0, 0.0, allowed);
    neph_assert_close(moments[1], neph_phase_mean_cosine(&phase), 0.0, allowed);
    neph_assert_close(moments[1], neph_phase_moment(&phase, 1), 0.0, allowed);
    neph_assert_close(moments[2], neph_phase_moment(&phase, 2), 0.0, allowed);
}

/* Each kind is normalised, has the moments of its row, and -g is the mirror image of g. */
static void test_phases_match_their_rows(void **state)
{
    uint64_t seed = 4;
    for (int kind = 0; kind < NEPH_PHASE_KIND_COUNT; kind++) {
        const struct neph_phase_row *row = neph_phase_row(kind);
        for (int i = 0; i < row->trial_count; i++)
            check_moments(row->trials[i]);
        for (int trial = 0; trial < 1000 && row->trial_count > 0; trial++) {
            const double cosine = neph_test_uniform(&seed, -1.0, 1.0);
            struct neph_phase phase = row->trials[trial % row->trial_count], mirrored;
            if (row->parameters & NEPH_PHASE_PARAMETER_G)
                phase.g = neph_test_uniform(&seed, 0.0, 0.999);
            mirrored = phase;
            mirrored.g = -phase.g;
            if (row->parameters & NEPH_PHASE_PARAMETER_G &&
                !(row->parameters & NEPH_PHASE_PARAMETER_LOBES))
                neph_assert_close(neph_phase_per_sr(&phase, cosine),
                                  neph_phase_per_sr(&mirrored, -cosine), 1e-15, 0.0);
        }
    }
}

/* ---- Unreal ---- */

/* Unreal's own ray integral, in its units and base, transcribed from its formulas: centimetres, UI
 * values divided by 1000, I = D 2^{-f (z - h)} (1 - 2^{-F})/F L with F = f dz, T = 2^{-I}. */
static double unreal_transmittance(const struct neph_unreal_fog *ui, double eye_m, double k_y,
                                   double length_m)
{
    const double density = ui->fog_density / 1000.0, falloff = ui->fog_height_falloff / 1000.0;
    const double eye_cm = 100.0 * eye_m, length_cm = 100.0 * length_m;
    const double height_cm = 100.0 * ui->fog_height_m;
    const double f = falloff * k_y * length_cm;
    const double at_eye = density * exp2(-falloff * (eye_cm - height_cm));
    const double mean = fabs(f) > 1e-6 ? (1.0 - exp2(-f)) / f
                                       : log(2.0) * (1.0 - 0.5 * f * log(2.0));
    return exp2(-at_eye * mean * length_cm);
}

static void test_unreal_defaults(void **state)
{
    const struct neph_unreal_fog defaults = {0.02, 0.2, 0.0};
    const struct neph_fog_layer layer = neph_fog_layer_from_unreal(&defaults);
    neph_assert_close(layer.extinction_per_m, 9.609e-4, 5e-5, 0.0); /* the notes' four digits */
    neph_assert_close(layer.falloff_per_m, 0.01386, 5e-4, 0.0);
    const double ln2 = log(2.0);
    neph_assert_close(layer.extinction_per_m, ln2 * ln2 * 0.002, 1e-15, 0.0);
    neph_assert_close(layer.falloff_per_m, ln2 * 0.02, 1e-15, 0.0);
}

static void test_unreal_round_trip(void **state)
{
    const uint64_t first_seed = 5;
    for (uint64_t trial = 0; trial < 1000; trial++) {
        uint64_t seed = first_seed + trial;
        const struct neph_unreal_fog ui = {neph_test_uniform(&seed, 0, 10),
                                           neph_test_uniform(&seed, 0, 5),
                                           neph_test_uniform(&seed, -1e4, 1e4)};
        const struct neph_fog_layer layer = neph_fog_layer_from_unreal(&ui);
        const struct neph_unreal_fog back = neph_fog_layer_to_unreal(&layer);
        neph_assert_close(back.fog_density, ui.fog_density, 1e-15, 0.0);
        neph_assert_close(back.fog_height_falloff, ui.fog_height_falloff, 1e-15, 0.0);
        assert_true(back.fog_height_m == ui.fog_height_m);
    }
}

/* The converted fog attenuates as Unreal's formula. 1e-9: the transcription's own cancellation at
 * |F| near 1e-6 is 2^-53/1e-6. */
static void test_unreal_formula(void **state)
{
    struct worst worst = {.what = "transmittance against Unreal's formula"};
    const uint64_t first_seed = 6;
    for (uint64_t trial = 0; trial < 5000; trial++) {
        uint64_t seed = first_seed + trial;
        const struct neph_unreal_fog ui = {neph_test_uniform(&seed, 0.001, 1),
                                           neph_test_uniform(&seed, 0.001, 2),
                                           neph_test_uniform(&seed, -100, 100)};
        const struct neph_fog_layer layer = neph_fog_layer_from_unreal(&ui);
        const double eye_m = neph_test_uniform(&seed, -50, 200);
        const double k_y = trial % 10 ? neph_test_uniform(&seed, -1, 1) : 0.0;
        const double length_m = pow(10.0, neph_test_uniform(&seed, -1, 3));
        const double expected = unreal_transmittance(&ui, eye_m, k_y, length_m);
        const double actual = exp(-neph_fog_layer_optical_depth(&layer, eye_m, k_y, length_m));
        if (expected < 1e-100)
            continue;
        neph_assert_close(actual, expected, 1e-9, 0.0);
        note(&worst, actual, expected, 0.0);
    }
    report(&worst);
}

#include "tests/main.h"
