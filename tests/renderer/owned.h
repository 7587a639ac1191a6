/* SPDX-License-Identifier: MIT
 *
 * Clean-up functions for the objects that tests of this folder create, called at the end of the
 * block: OWNED() of neph_test.h.
 */
#ifndef NEPH_TESTS_OWNED_H
#define NEPH_TESTS_OWNED_H

#include "tests/scene_builders.h"

#include "renderer/fog_look.h"
#include "renderer/march.h"
#include "renderer/realtime/pipeline.h"
#include "renderer/screen/screen.h"
#include "renderer/sky/sky.h"
#include "truth/slab.h"

static inline void test_end_image(struct neph_image **image)
{
    neph_image_destroy(*image);
}

static inline void test_end_scene(struct neph_scene **scene)
{
    neph_scene_destroy(*scene);
}

static inline void test_end_grid(struct neph_grid **grid)
{
    neph_grid_destroy(*grid);
}

static inline void test_end_slab(struct neph_slab **slab)
{
    neph_slab_destroy(*slab);
}

static inline void test_end_sky(struct neph_sky **sky)
{
    neph_sky_destroy(*sky);
}

static inline void test_end_march(struct neph_march **march)
{
    neph_march_destroy(*march);
}

static inline void test_end_realtime(struct neph_realtime **realtime)
{
    neph_realtime_destroy(*realtime);
}

static inline void test_end_screening(struct neph_screen_renderer **screening)
{
    neph_screen_renderer_destroy(*screening);
}

static inline void test_end_fog_looks(struct neph_fog_renderer **fog_looks)
{
    neph_fog_renderer_destroy(*fog_looks);
}

/* Destroys the grids and clouds of a scene that a test has built. */
static inline void test_end_media(struct test_scene *test)
{
    for (int m = 0; m < test->scene.medium_count; m++) {
        neph_grid_destroy(test->scene.media[m].grid);
        neph_horizon_destroy(test->scene.media[m].horizon);
    }
}

#endif
