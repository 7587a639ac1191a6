/* SPDX-License-Identifier: MIT
 *
 * Scene data on the device: whether a solid may shadow a medium, voxels as pairs for a CPU device,
 * and places of data over frames.
 */
#include "tests/renderer/march_test.h"

#include "renderer/gpu_scene.h"
#include "scenes/media.h"
#include "scenes/motion.h"
#include "scenes/solids.h"

static bool may_be_shaded(struct neph_vulkan *vulkan, const struct neph_scene *scene)
{
    struct neph_gpu_scene gpu = {.frame = NULL};
    struct neph_diag diag = {0};
    neph_assert_ok(neph_gpu_scene_create(vulkan, scene, 0.0, 8, 8, false, &gpu, &diag), &diag);
    const bool may_be = gpu.frame->solids_shade;
    assert_int_equal((gpu.constants[1] & NEPH_GPU_SHADED) != 0, may_be || !gpu.is_on_cpu);
    neph_gpu_scene_destroy(vulkan, &gpu);
    return may_be;
}

/* Boxes and a sphere around a cloud, with suns from all directions: where no solid may shadow the
 * cloud, each of its points sees the sun. Both cases occur. */
static void test_where_nothing_is_in_the_way_all_is_lit(void **state)
{
    uint64_t seed = 11;
    int free_count = 0, shaded_count = 0;
    for (int round = 0; round < 60; round++) {
        struct test_scene test;
        test_scene_init(&test);
        test_add(&test, make_homogeneous(0.1, (struct neph_bounds){{-2, 3, -9}, {4, 5, -6}}));
        test.scene.sun.direction = random_direction(&seed);
        for (int i = 0; i < round % 3; i++) {
            const struct neph_vec3 low_m = random_point(&seed, 6.0);
            const struct neph_vec3 size_m = {3.0, 1.0, 2.0};
            test_add_box(&test, low_m, neph_vec3_add(low_m, size_m));
        }
        if (round % 4 == 0)
            test_add_sphere(&test, random_point(&seed, 6.0), 1.5);
        const struct neph_bounds box = neph_medium_support(&test.scene.media[0]);
        const bool may_be = may_be_shaded(*state, &test.scene);
        bool is_shaded = false;
        for (int i = 0; i < 200; i++)
            is_shaded |= !neph_scene_is_sun_visible(&test.scene, random_place_in(&box, &seed));
        assert_false(is_shaded && !may_be);
        free_count += !may_be && test.scene.solid_count > 0;
        shaded_count += is_shaded;
    }
    print_message("%d scenes with solids out of the way, %d with shaded places\n", free_count,
                  shaded_count);
    assert_true(free_count > 10 && shaded_count > 3);
}

/* The ground below clouds and sun; solids on it, beside the clouds and below the sun; and a sun
 * below the horizon. Fog reaches into the ground. */
static void test_the_ground_shades_no_cloud(void **state)
{
    const struct neph_bounds layer = {{-3000.0, 500.0, -9000.0}, {9000.0, 1900.0, 0.0}};
    struct test_scene test;
    test_scene_init(&test);
    test_add(&test, make_homogeneous(0.01, layer));
    test_add_box(&test, (struct neph_vec3){-2e4, -10.0, -2e4}, (struct neph_vec3){2e4, 0.0, 2e4});
    test_add_box(&test, (struct neph_vec3){10.0, 0.0, -50.0},
                 (struct neph_vec3){20.0, 99.0, -40.0});
    test.scene.sun.direction = (struct neph_vec3){-0.8, 0.6, 0.0};
    assert_false(may_be_shaded(*state, &test.scene));
    test.scene.sun.direction.y = -0.6;
    assert_true(may_be_shaded(*state, &test.scene));
    test.scene.sun.direction.y = 0.6;
    test_add_medium(&test, 0.01, 0.05, 0.0);
    assert_true(may_be_shaded(*state, &test.scene));
}

/* Each value and the next one, of two grids; the last pair of a row is not used. */
static void test_a_cpu_has_voxels_in_pairs(void **state)
{
    const struct neph_vec3 origin_m = {-1, 0, -9}, spacing_m = {1, 1, 1};
    uint64_t seed = 5;
    OWNED(media) struct test_scene test;
    struct neph_gpu_scene gpu = {.frame = NULL};
    struct neph_diag diag = {0};
    test_scene_init(&test);
    test_add(&test,
             make_voxels(0.5, random_lattice((int[3]){3, 4, 2}, origin_m, spacing_m, -0.2, &seed)));
    test_add(&test,
             make_voxels(0.5, random_lattice((int[3]){2, 2, 3}, origin_m, spacing_m, 0.1, &seed)));
    neph_assert_ok(neph_gpu_scene_create(*state, &test.scene, 0.0, 8, 8, false, &gpu, &diag),
                   &diag);
    assert_int_equal((gpu.constants[1] & NEPH_GPU_PAIRS) != 0, gpu.is_on_cpu);
    const size_t count = gpu.buffers[NEPH_GPU_VALUES_BUFFER].size_bytes / sizeof(float);
    assert_int_equal(count, 5 * 6 * 4 + 4 * 4 * 5);
    OWNED(memory)
    float *values = test_read_buffer(*state, &gpu.buffers[NEPH_GPU_VALUES_BUFFER],
                                     count * sizeof(float));
    if (gpu.is_on_cpu) {
        OWNED(memory)
        float *pairs = test_read_buffer(*state, &gpu.pairs, 2 * count * sizeof(float));
        for (size_t i = 0; i < count; i++) {
            const size_t row = i < 5 * 6 * 4 ? 5 : 4, place = i < 5 * 6 * 4 ? i : i - 5 * 6 * 4;
            assert_true(pairs[2 * i] == values[i]);
            if (place % row + 1 < row)
                assert_true(pairs[2 * i + 1] == values[i + 1]);
        }
    }
    neph_gpu_scene_destroy(*state, &gpu);
}

/* The static scene of a frame would get room for a grid across the sun, in front of the clouds'
 * textures; a scene whose sun or solids move has none. */
static void test_textures_stay_in_scenes_that_move(void **state)
{
    const struct neph_horizon_params cumulus = make_cumulus();
    struct neph_solid_key keys[] = {{.frame = 0}, {.frame = 4, .move_m = {1, 0, 0}}};
    struct neph_mover mover = {.first = 3, .count = 1, .key_count = 2, .keys = keys};
    OWNED(media) struct test_scene test;
    struct neph_gpu_scene gpu = {.frame = NULL};
    struct neph_diag diag = {0};
    test_scene_init(&test);
    struct neph_medium cloud = {.kind = NEPH_MEDIUM_HORIZON,
                                .albedo = white,
                                .extinction_color = white,
                                .extinction_per_m = 0.08,
                                .box = {{-3e3, 500, -5e3}, {3e3, 1900, 2e3}}};
    neph_assert_ok(neph_horizon_create(&cumulus, &cloud.horizon, &diag), &diag);
    test_add(&test, cloud);
    for (int i = 0; i < 14; i++)
        test_add_box(&test, (struct neph_vec3){i, 0, -9}, (struct neph_vec3){i + 0.5, 2, -8});
    test.scene.movers = &mover;
    test.scene.mover_count = 1;
    neph_assert_ok(neph_gpu_scene_create(*state, &test.scene, 0.0, 8, 8, false, &gpu, &diag),
                   &diag);
    const struct neph_gpu_medium before = gpu.frame->media[0];
    OWNED(scene) struct neph_scene *still = NULL;
    neph_assert_ok(neph_scene_at(&test.scene, 2.0, &still, &diag), &diag);
    neph_assert_ok(neph_gpu_scene_update(*state, &gpu, still, 2.0, 8, 8, NULL, &diag), &diag);
    assert_memory_equal(&before, &gpu.frame->media[0], sizeof(before));
    neph_gpu_scene_destroy(*state, &gpu);
}

#include "tests/renderer/main.h"
