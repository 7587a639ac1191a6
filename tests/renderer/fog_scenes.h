/* SPDX-License-Identifier: MIT
 *
 * Scenes in which both the ray marcher and the path tracer are compared with the reference.
 */
#ifndef NEPH_TESTS_FOG_SCENES_H
#define NEPH_TESTS_FOG_SCENES_H

#include "tests/scene_builders.h"

#include "truth/slab.h"

static inline void scene_cube(struct test_scene *test)
{
    struct neph_medium *cube = test_add_medium(test, 0.4, 0.0, 0.0);
    cube->bounds = (struct neph_bounds){{-3.0, -1.0, -12.0}, {4.0, 5.0, -6.0}};
}

static inline void scene_fog(struct test_scene *test)
{
    test_add_medium(test, 0.03, 0.05, 0.0);
}

static inline void scene_fog_down(struct test_scene *test)
{
    test_add_medium(test, 0.2, 0.08, 2.0);
    test_add_box(test, (struct neph_vec3){-1e3, -1.0, -1e3}, (struct neph_vec3){1e3, 0.0, 1e3});
    test->key.position_m = (struct neph_vec3){10.0, 120.0, 30.0};
    test->key.look_at_m = (struct neph_vec3){0.0, 0.0, 0.0};
}

static inline void scene_two_layers_up(struct test_scene *test)
{
    struct neph_medium *fog = test_add_medium(test, 0.01, 0.02, 0.0);
    test_add_layer(fog, 0.04, 0.1, 1.0);
    test->key.look_at_m = (struct neph_vec3){3.0, 9.0, -5.0};
}

static inline void scene_overlapping_media(struct test_scene *test)
{
    scene_fog(test);
    test->scene.media[0].phase.g = -0.3;
    struct neph_medium *cube = test_add_medium(test, 0.3, 0.0, 0.0);
    cube->bounds = (struct neph_bounds){{-4.0, -1.0, -20.0}, {2.0, 6.0, -10.0}};
    cube->albedo = (struct neph_rgb){0.2, 0.9, 1.0};
    cube->phase = (struct neph_phase){.kind = NEPH_PHASE_RAYLEIGH};
}

static inline void scene_far_from_the_origin(struct test_scene *test)
{
    test_add_medium(test, 0.03, 0.05, 3.0e6);
    test->key.position_m = (struct neph_vec3){-2.0e6, 3.0e6 + 1.6, 5.0e6};
    test->key.look_at_m = (struct neph_vec3){-2.0e6 + 1.0, 3.0e6 + 2.6, 5.0e6 - 10.0};
}

static inline void scene_blob(struct test_scene *test)
{
    test_add_cloud(test, NEPH_MEDIUM_GAUSSIAN, 0.8)->gaussian = (struct neph_gaussian){
        {0.5, 2.0, -12.0}, 1.5};
}

static inline void scene_voxels(struct test_scene *test)
{
    uint64_t random = 11;
    test_add_cloud(test, NEPH_MEDIUM_GRID, 0.9)->grid = random_lattice(
        (const int[3]){7, 6, 5}, (struct neph_vec3){-3.0, -1.0, -15.0},
        (struct neph_vec3){1.0, 0.9, 1.3}, -0.4, &random);
}

/* Fog over ground, a box and a ball. */
static inline void scene_yard(struct test_scene *test)
{
    test_add_medium(test, 0.03, 0.08, 0.0);
    test_add_box(test, (struct neph_vec3){-200, -1, -200}, (struct neph_vec3){200, 0, 200});
    test_add_box(test, (struct neph_vec3){-4, 0, -16}, (struct neph_vec3){-1, 5, -12});
    test_add_sphere(test, (struct neph_vec3){3, 2, -14}, 2.0);
}

/* Gives the media emission of different colours. */
static inline void make_glow(struct test_scene *test)
{
    static const struct neph_rgb emissions[] = {{1, 20, 4}, {30, 1, 0}, {0, 2, 9}};
    for (int m = 0; m < test->scene.medium_count; m++)
        test->scene.media[m].emission_w_per_m2_sr = emissions[m % 3];
}

/* All orders of scattering, a white sun, a black sky. */
static inline void make_sunlit(struct test_scene *test)
{
    test->scene.scattering = NEPH_SCATTERING_MULTIPLE;
    test->scene.background_w_per_m2_sr = make_grey(0.0);
    test->scene.sun.irradiance_w_per_m2 = make_grey(1.0);
}

/* A slab from y = 0 to 1 without sides. With a narrow field of view all pixels have nearly the same
 * direction. */
static inline void slab_scene(struct test_scene *test, const struct neph_slab_params *slab,
                              bool from_below, double vertical_fov_rad)
{
    test_scene_init(test);
    make_sunlit(test);
    struct neph_medium *medium = test_add_medium(test, slab->optical_depth, 0.0, 0.0);
    medium->bounds.min_m.y = 0.0;
    medium->bounds.max_m.y = 1.0;
    medium->albedo = make_grey(slab->albedo);
    medium->phase = slab->phase;
    const double sine = sqrt(1.0 - slab->sun_cosine * slab->sun_cosine);
    test->scene.sun.direction = (struct neph_vec3){sine, slab->sun_cosine, 0.0};
    test->scene.vertical_fov_rad = vertical_fov_rad;
    test->key.position_m = (struct neph_vec3){0.0, from_below ? -0.5 : 1.5, 0.0};
    test->key.look_at_m = (struct neph_vec3){0.7, 0.5, 0.3};
}

/* Reference by adding and doubling, for the middle of the frame. Light travels to the camera along
 * -view and sunlight along -x, so the azimuth is the angle between the two. */
static inline double slab_per_sr(const struct test_scene *test, const struct neph_slab_params *of)
{
    const struct neph_vec3 view = neph_scene_camera(&test->scene, 0.0).forward;
    const double cosine = fabs(view.y), azimuth_rad = atan2(view.z, view.x);
    struct neph_slab_params params = *of;
    struct neph_slab *slab = NULL;
    struct neph_diag diag = {0};
    params.view_count = 1;
    params.view_cosines = &cosine;
    neph_assert_ok(neph_slab_create(&params, &slab, &diag), &diag);
    const double radiance = view.y < 0.0 ? neph_slab_reflected_per_sr(slab, 0, azimuth_rad)
                                         : neph_slab_transmitted_per_sr(slab, 0, azimuth_rad);
    neph_slab_destroy(slab);
    return radiance;
}

#endif
