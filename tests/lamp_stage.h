/* SPDX-License-Identifier: MIT
 *
 * A scene with lights for comparing all transports.
 */
#ifndef NEPH_TESTS_LAMP_STAGE_H
#define NEPH_TESTS_LAMP_STAGE_H

#include "tests/scene_builders.h"

/* Two lights, one of them a spot light, in three media of different kinds and colours, with a ball
 * and boxes. */
static inline struct test_scene *lamp_stage(struct test_scene *test)
{
    test_scene_init(test);
    struct neph_scene *scene = &test->scene;
    scene->sun.present = false;
    scene->background_w_per_m2_sr = make_grey(0.0);
    struct neph_medium *fog = test_add_medium(test, 0.1, 0.3, 0.0);
    fog->bounds = (struct neph_bounds){{-6, -1, -14}, {6, 7, 2}};
    fog->extinction_color = (struct neph_rgb){0.7, 1.0, 1.4};
    *test_add(test, make_blob(0.4, (struct neph_vec3){0.5, 2, -6}, 0.8)) = make_blob(
        0.4, (struct neph_vec3){0.5, 2, -6}, 0.8);
    struct neph_medium *block = test_add(
        test, make_homogeneous(0.2, (struct neph_bounds){{-3, 0, -9}, {-1, 3, -5}}));
    block->phase = (struct neph_phase){NEPH_PHASE_RAYLEIGH, 0.0};
    test_add_box(test, (struct neph_vec3){0.6, 0, -5}, (struct neph_vec3){0.8, 2.4, -4.5});
    test_add_box(test, (struct neph_vec3){-9, -1, -30}, (struct neph_vec3){9, 0, 3});
    test_add_sphere(test, (struct neph_vec3){-0.7, 1.7, -4.0}, 0.5);
    scene->light_count = 2;
    scene->lights[0] = (struct neph_light){.position_m = {1.1, 2.1, -6.5},
                                           .intensity_w_per_sr = {5, 3, 1}};
    scene->lights[1] = (struct neph_light){
        .position_m = {-1.5, 2.6, -8},
        .intensity_w_per_sr = {1, 4, 9},
        .is_spot = true,
        .axis = neph_vec3_normalize((struct neph_vec3){2, -1, 4}),
        .inner_cosine = 0.9,
        .outer_cosine = 0.7};
    return test;
}

static inline struct neph_vec3 lamp_direction(int i)
{
    return neph_vec3_normalize(
        (struct neph_vec3){-0.45 + 0.13 * (i % 8), 0.2 - 0.11 * (i / 8), -1.0});
}

/* A box of fog in front of a camera whose middle ray is along -z, and lights so near to the camera
 * or to this ray that 1 / d^2 has no correct digits in plain float32. */
struct near_lamp {
    const char *name;
    struct neph_vec3 light_m;
    double second_box_m; /* the far side of a second box behind a gap; 0: none */
    double other_lamp;   /* intensity of a second light next to the box */
};

static const struct near_lamp near_lamps[] = {
    {"at the eye", {0, 0, 5}, 0, 0},
    {"1e-9 m from the eye", {1e-9, 0, 5}, 0, 0},
    {"1e-6 m from the eye", {0, 1e-6, 5}, 0, 0},
    {"1e-5 m before the eye", {0, 0, 5 - 1e-5}, 0, 0},
    {"1e-4 m from the eye", {1e-4, 0, 5}, 0, 0},
    {"1e-3 m behind the eye", {0, 0, 5 + 1e-3}, 0, 0},
    {"on the ray before the fog", {0, 0, 3}, 0, 0},
    {"1e-6 m from the ray before the fog", {0, 1e-6, 3}, 0, 0},
    {"on the ray behind the fog", {0, 0, -3}, 0, 0},
    {"on the ray in a gap", {0, 0, -2}, -4, 0},
    {"on the ray in a gap, beside a light that is brighter", {0, 0, -2}, -4, 30},
    {"1e-6 m from the ray in the fog", {1e-6, 0, 0}, 0, 0},
    {"1e-5 m from the ray in the fog", {0, 1e-5, 0.5}, 0, 0},
    {"1e-3 m from the ray in the fog", {1e-3, 0, -0.5}, 0, 0},
};
enum { NEAR_LAMPS = sizeof(near_lamps) / sizeof(near_lamps[0]) };

static inline struct neph_scene *near_lamp_stage(struct test_scene *test,
                                                 const struct near_lamp *lamp)
{
    test_scene_init(test);
    struct neph_scene *scene = &test->scene;
    test->key.position_m = (struct neph_vec3){0, 0, 5};
    test->key.look_at_m = (struct neph_vec3){0, 0, 0};
    scene->vertical_fov_rad = 30.0 * NEPH_RAD_PER_DEG;
    scene->sun.present = false;
    scene->background_w_per_m2_sr = make_grey(0.0);
    test_add(test, make_homogeneous(0.5, (struct neph_bounds){{-1, -1, -1}, {1, 1, 1}}));
    if (lamp->second_box_m != 0.0)
        test_add(test, make_homogeneous(
                           0.2, (struct neph_bounds){{-2, -2, lamp->second_box_m}, {2, 2, -3}}));
    scene->light_count = 1 + (lamp->other_lamp > 0.0);
    scene->lights[0] = (struct neph_light){.position_m = lamp->light_m,
                                           .intensity_w_per_sr = {1, 1, 1}};
    scene->lights[1] = (struct neph_light){.position_m = {4, 5, 1},
                                           .intensity_w_per_sr = make_grey(lamp->other_lamp)};
    return scene;
}

#endif
