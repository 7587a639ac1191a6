/* SPDX-License-Identifier: MIT
 *
 * The laws for lighting models hold for exact light (single scattering of a thin ball in closed
 * form, slabs by adding-doubling), and planted errors are reported with their size.
 */
#include "tests/neph_test.h"

#include "harness/physics/light_laws.h"
#include "scenes/media.h"

static const double e_w_per_m2 = NEPH_STAGE_IRRADIANCE_W_PER_M2;

typedef double radiance_function(const struct neph_stage *stage, const struct neph_pixel_ray *ray);

/* Single scattering with negligible attenuation. */
static double thin_radiance(const struct neph_stage *stage, const struct neph_pixel_ray *ray)
{
    const struct neph_scene *scene = &stage->scene;
    const double depth =
        neph_scene_optical_depth(scene, ray->origin_m, ray->direction, 0.0, INFINITY).g;
    return e_w_per_m2 * depth *
           neph_phase_per_sr(&scene->media[0].phase,
                             neph_vec3_dot(ray->direction, scene->sun.direction));
}

static double true_radiance(const struct neph_stage *stage, const struct neph_pixel_ray *ray)
{
    return neph_stage_truth_w_per_m2_sr(stage, ray->direction);
}

static double see(const struct neph_check_view *view, enum neph_stage_truth truth,
                  radiance_function *radiance)
{
    struct neph_diag diag = {.line = 0};
    struct neph_stage *stage = NULL;
    struct neph_stage_params params = view->stage;
    double sum = 0.0;
    params.truth = truth;
    neph_assert_ok(neph_stage_create(&params, &stage, &diag), &diag);
    const struct neph_camera camera = neph_scene_camera(&stage->scene, 0.0);
    for (int p = 0; p < view->width_px * view->height_px; p++) {
        const struct neph_pixel_ray ray = neph_camera_ray(&camera, view->width_px, view->height_px,
                                                          p % view->width_px, p / view->width_px);
        const double weight = neph_check_pixel_weight(view, &camera, ray.direction);
        sum += weight > 0.0 ? weight * radiance(stage, &ray) : 0.0;
    }
    neph_stage_destroy(stage);
    return sum;
}

struct seen {
    int count;
    struct neph_check_view views[NEPH_LIGHT_LAW_VIEWS_MAX];
    double sums[NEPH_LIGHT_LAW_VIEWS_MAX];
};

static struct seen see_all(const struct neph_light_law_case *of, enum neph_stage_truth truth,
                           radiance_function *radiance)
{
    struct seen seen;
    seen.count = neph_light_law_views(of, "law", seen.views);
    for (int i = 0; i < seen.count; i++)
        seen.sums[i] = see(&seen.views[i], truth, radiance);
    return seen;
}

/* The value of a case over its truth, when the radiance from view `first` on is multiplied by
 * `factor`. */
static double find_ratio(const struct neph_light_law_case *of, const struct seen *seen, int first,
                         double factor)
{
    struct neph_diag diag = {.line = 0};
    double sums[NEPH_LIGHT_LAW_VIEWS_MAX], value, truth;
    for (int i = first; i < seen->count; i++)
        sums[i - first] = factor * seen->sums[i];
    neph_assert_ok(neph_light_law_value(of, seen->views + first, sums, &value, &truth, &diag),
                   &diag);
    return value / truth;
}

/* The quadrature over suns is exact up to Legendre order 23; beyond it Henyey-Greenstein has g^24.
 * The ball's attenuation, half of its optical depth, is not in the closed form. Pixels represent
 * rings around the suns' axis, which leaves 2.4e-4 at g = 0.5; all else is smaller. */
static void test_furnace_of_a_thin_ball(void **state)
{
    for (double g = -0.5; g < 0.51; g += 0.5) {
        const struct neph_light_law_case of = {NEPH_LAW_FURNACE, 1e-4, g, 1.0};
        const struct seen seen = see_all(&of, NEPH_STAGE_TRUTH_HALF_SPACE, thin_radiance);
        print_message("g = %g: %.6f of the truth\n", g, find_ratio(&of, &seen, 0, 1.0));
        neph_assert_close(find_ratio(&of, &seen, 0, 1.0), 1.0, 5e-4, 0.0);
        neph_assert_close(find_ratio(&of, &seen, 0, 0.8), 0.8, 5e-4, 0.0);
    }
}

/* Midpoint rule over 16 pixels across a face: its error falls with their square. Removing half of
 * the light that leaves a white slab removes half of all light. */
static void test_fluxes_of_a_slab(void **state)
{
    const struct neph_light_law_case balance = {NEPH_LAW_BALANCE, 4.0, 0.2, 1.0},
                                     reflected = {NEPH_LAW_REFLECTED, 4.0, 0.2, 1.0},
                                     transmitted = {NEPH_LAW_TRANSMITTED, 4.0, 0.2, 1.0};
    const struct seen seen = see_all(&balance, NEPH_STAGE_TRUTH_SLAB, true_radiance);
    const double whole = find_ratio(&balance, &seen, 0, 1.0);
    print_message("R %.5f, T %.5f, all %.5f of the truth\n", find_ratio(&reflected, &seen, 0, 1.0),
                  find_ratio(&transmitted, &seen, NEPH_CHECK_FACES, 1.0), whole);
    neph_assert_close(find_ratio(&reflected, &seen, 0, 1.0), 1.0, 4e-3, 0.0);
    neph_assert_close(find_ratio(&transmitted, &seen, NEPH_CHECK_FACES, 1.0), 1.0, 4e-3, 0.0);
    neph_assert_close(whole, 1.0, 4e-3, 0.0);
    neph_assert_close(whole - find_ratio(&balance, &seen, 0, 0.5), 0.5 * (whole - exp(-4.0 / 0.7)),
                      1e-9, 0.0);
}

/* A narrow view averages over half a degree; smooth light has its mean at the centre. */
static void test_reciprocity_of_a_slab(void **state)
{
    const struct neph_light_law_case of = {NEPH_LAW_RECIPROCITY, 4.0, 0.2, 1.0};
    const struct seen seen = see_all(&of, NEPH_STAGE_TRUTH_SLAB, true_radiance);
    neph_assert_close(find_ratio(&of, &seen, 0, 1.0), 1.0, 1e-4, 0.0);
    neph_assert_close(find_ratio(&of, &seen, 0, 3.0), 1.0, 1e-4, 0.0);
}

/* Every law has a case with a white medium, and every flux has a balance of the same slab. */
static void test_cases(void **state)
{
    int of_law[NEPH_LAW_RECIPROCITY + 1] = {0};
    for (int i = 0; i < NEPH_LIGHT_LAWS; i++) {
        const struct neph_light_law_case *of = &neph_light_law_cases[i];
        of_law[of->law] += of->albedo == 1.0;
        assert_true(of->law != NEPH_LAW_FURNACE || of->albedo == 1.0);
    }
    for (int law = 0; law <= NEPH_LAW_RECIPROCITY; law++)
        assert_true(of_law[law] > 0);
}

#include "tests/main.h"
