/* SPDX-License-Identifier: MIT
 *
 * Fogs that the march and the tracer are both held against the truth in.
 */
#ifndef NEPH_TESTS_FOG_SCENES_H
#define NEPH_TESTS_FOG_SCENES_H

#include "tests/scene_builders.h"

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

#endif
