/* SPDX-License-Identifier: MIT
 *
 * Light along one ray against 50-digit references, shadows known by hand, brute force, and the
 * scenes whose answer needs no integral at all.
 */
#include "tests/neph_test.h"

#include "scenes/media.h"
#include "scenes/solids.h"
#include "scenes/transport.h"
#include "tests/scenes/reference_values.h"

#include <time.h>

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

static const double pi = 3.14159265358979323846264338328;
static const double unit_roundoff = 0x1p-53;

static const struct neph_bounds everywhere = {{-INFINITY, -INFINITY, -INFINITY},
                                              {INFINITY, INFINITY, INFINITY}};
static const struct neph_rgb white = {1, 1, 1};

/* Isotropic and white, filling the bounds. */
static struct neph_medium homogeneous(double extinction_per_m, struct neph_bounds bounds)
{
    return (struct neph_medium){.kind = NEPH_MEDIUM_HOMOGENEOUS,
                                .bounds = bounds,
                                .albedo = white,
                                .layer_count = 1,
                                .layers = {{.extinction_per_m = extinction_per_m}}};
}

static struct neph_medium height_fog(double extinction_per_m, double falloff_per_m)
{
    struct neph_medium fog = homogeneous(extinction_per_m, everywhere);
    fog.kind = NEPH_MEDIUM_HEIGHT_FOG;
    fog.layers[0].falloff_per_m = falloff_per_m;
    return fog;
}

static struct neph_solid box(double x0, double y0, double z0, double x1, double y1, double z1)
{
    return (struct neph_solid){.kind = NEPH_SOLID_BOX, .box = {{x0, y0, z0}, {x1, y1, z1}}};
}

/* One medium under a sun of irradiance 1, single scattering. */
static struct neph_scene sunny(struct neph_medium medium, struct neph_vec3 sun)
{
    return (struct neph_scene){.scattering = NEPH_SCATTERING_SINGLE,
                               .sun = {true, sun, white},
                               .medium_count = 1,
                               .media = {medium}};
}

/* ---- closed forms ---- */

/* Radiance behind an optical depth of 45 is not summed: below 1e-19 of the sun's. */
static const double invisible_per_sr = 1e-19;

/* Slabs from above and below (with mu = mu0), height fog at all heights (up, level, down, from
 * 1e6 m), boxes, fog in boxes, two layers, two media, thin fogs 1e6 m away; three phase functions;
 * optical depths 1e-10 .. 1e3. 1e-12, or four roundings of the coordinates. */
static void test_single_scattering_against_reference(void **state)
{
    (void)state;
    double worst = 0.0;
    int failures = 0;
    for (size_t i = 0; i < COUNT(reference_view); i++) {
        const struct reference_view *r = &reference_view[i];
        struct neph_scene scene = sunny(r->media[0], r->sun);
        scene.medium_count = r->medium_count;
        scene.media[1] = r->media[1];
        const struct neph_ray_light light = neph_transport_ray(&scene, r->origin_m, r->direction);
        const double relative = fmax(1e-12, 4.0 * unit_roundoff * r->condition);
        const double error = fabs(light.volume.r - r->radiance);
        if (r->radiance > 1e-12 && relative < 2e-12)
            worst = fmax(worst, error / r->radiance);
        if (!(error <= relative * r->radiance + invisible_per_sr)) {
            print_error("%s: %.17g, expected %.17g, relative error %.2g, allowed %.2g\n", r->name,
                        light.volume.r, r->radiance, error / r->radiance, relative);
            failures++;
        }
        /* The estimate is honest, up to the rounding that `relative` allows. */
        if (!(error <= light.quadrature_error + relative * r->radiance + invisible_per_sr))
            failures++;
    }
    print_message("worst relative error, single scattering (%zu views): %.2g\n",
                  COUNT(reference_view), worst);
    assert_int_equal(failures, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_single_scattering_against_reference),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
