/* SPDX-License-Identifier: MIT
 *
 * Tests of the slot schedule and the override: the shader against the CPU reference, and the depths
 * that have a matching ray nearby.
 */
#include "renderer/realtime/tile_index/check_reference_slots.h"
#include "tests/renderer/realtime_test.h"

static const int sizes_px[][2] = {{1, 1}, {2, 3}, {5, 4}, {64, 36}, {127, 33}, {641, 363}};

static void run_tile_index(struct test_passes *test)
{
    test_passes_run(test, "tile index");
    test_take(test, RT_TILE);
}

static int slot_at(const struct test_passes *test, int x, int y)
{
    float tile[4];
    cpu_fetch_tile(&test->cpu, RT_TILE, x, y, tile);
    return (int)tile[0];
}

/* Depths that are equal, exactly a quarter apart, sky, near the sky's limit, or arbitrary. */
static float random_depth_m(uint64_t *seed)
{
    static const float depths_m[] = {8.0f,     10.0f,    12.5f,    10.0f,         100.0f,
                                     15000.0f, 20000.0f, 25000.0f, NEPH_GPU_FAR_M};
    const size_t i = neph_test_random(seed) % (COUNT(depths_m) + 1);
    return i ? depths_m[i - 1] : (float)exp(14.0 * test_uniform(seed));
}

static struct neph_settings random_settings(uint64_t *seed, int override, int far, int gather)
{
    struct neph_settings settings = test_settings("");
    settings.values[RT_OVERRIDE] = override;
    settings.values[RT_FAR] = far;
    settings.values[RT_GATHER] = gather;
    settings.values[RT_SLOT_ORDER] = (double)(neph_test_random(seed) % 4);
    settings.values[RT_SLOT_CHECKERBOARD] = (double)(neph_test_random(seed) % 2);
    settings.values[RT_TILE_ORIGIN] = (double)(neph_test_random(seed) % 2);
    settings.values[RT_TARGET_FORMAT] = (double)(neph_test_random(seed) % 2);
    settings.values[RT_SKY_M] = neph_test_random(seed) % 2 ? 20000.0 : 1e15;
    settings.values[RT_RAY_DEPTH_MAX_M] = neph_test_random(seed) % 2 ? 10000.0 : 1e15;
    return settings;
}

/* Mostly one depth: overrides happen in such scenes. */
static void fill_depths(struct test_passes *test, uint64_t *seed)
{
    const uint64_t one_in = 1 + neph_test_random(seed) % 12;
    for (size_t i = 0; i < test_elements(test, RT_HALF_DEPTH); i++) {
        const bool is_odd_one_out = neph_test_random(seed) % one_in == 0;
        test_set(test, RT_HALF_DEPTH, i,
                 (float[4]){is_odd_one_out ? random_depth_m(seed) : NEPH_GPU_FAR_M});
    }
}

static void compare_with_reference(struct neph_vulkan *vulkan, const struct neph_settings *settings,
                                   const int size_px[2], uint64_t seed)
{
    uint64_t random = seed;
    OWNED(passes) struct test_passes test;
    const int origin_px[2] = {seed % 2 ? 8 : 0, seed % 2 ? 4 : 0};
    test_passes_open(vulkan, settings, size_px, origin_px, seed, &test);
    test.view.frame = (uint32_t)neph_test_random(&random);
    test.view.resting = neph_test_random(&random) % 8 == 0;
    fill_depths(&test, &random);
    for (size_t i = 0; i < neph_rt_device_words(&test.device, RT_TILE); i++)
        test.cpu.targets[RT_TILE][i] = (uint32_t)neph_test_random(&random); /* an old frame's */
    test_passes_run(&test, "tile index");
    cpu_tile_index(&test.cpu);
    test_same_words(&test, RT_TILE, seed);
}

static void test_tile_index_equals_the_cpu_reference(void **state)
{
    uint64_t seed = 1;
    for (size_t s = 0; s < COUNT(sizes_px); s++) {
        const bool is_large = sizes_px[s][0] > 200;
        for (int i = 0; i < 2 * 12; i++) {
            const struct neph_settings settings = random_settings(&seed, i % 3, i / 3 % 2,
                                                                  i / 6 % 2);
            if (!is_large || i % 5 == 0)
                compare_with_reference(*state, &settings, sizes_px[s], neph_test_random(&seed));
        }
    }
}

/* Without override each slot of each tile is marched once in four frames, for any order and
 * start. */
static void test_every_slot_has_a_turn_in_four_frames(void **state)
{
    static const char *const orders[] = {"clockwise", "raster", "diagonal", "anticlockwise"};
    for (int i = 0; i < 8; i++) {
        OWNED(passes) struct test_passes test;
        test_open(*state, 21, 10, 1, &test, "override=none slot_order=%s slot_checkerboard=%s",
                  orders[i % 4], i < 4 ? "on" : "off");
        unsigned marched[6 * 3] = {0};
        for (uint32_t frame = 0; frame < 4; frame++) {
            test.view.frame = 0xffffffffu - 1u + frame; /* over the counter's end */
            run_tile_index(&test);
            for (int t = 0; t < 18; t++) {
                const int *place = cpu_slot_place(&test.view, slot_at(&test, t % 6, t / 6));
                marched[t] |= 1u << (place[0] + 2 * place[1]);
            }
        }
        for (int t = 0; t < 18; t++)
            assert_int_equal(marched[t], 15);
    }
}

/* Half-resolution texels with x % 2 == y % 2 have near depths, the others far ones. The test counts
 * the frames of four that have, around every tile, rays of both kinds: clockwise with the
 * checkerboard all of them; raster order, which the article's comments attribute to the game, two;
 * without the checkerboard all tiles have the same slot and no frame has both. */
static void test_slot_orders_cover_near_and_far(void **state)
{
    static const struct {
        const char *assignments;
        int expected;
    } cases[] = {
        {"override=none slot_order=clockwise slot_checkerboard=on", 4},
        {"override=none slot_order=raster slot_checkerboard=on", 2},
        {"override=none slot_order=clockwise slot_checkerboard=off", 0},
        {"override=none slot_order=raster slot_checkerboard=off", 0},
    };
    for (size_t c = 0; c < COUNT(cases); c++) {
        OWNED(passes) struct test_passes test;
        test_open(*state, 40, 24, 1, &test, "%s", cases[c].assignments);
        int seeing = 0;
        for (test.view.frame = 0; test.view.frame < 4; test.view.frame++) {
            run_tile_index(&test);
            bool both_everywhere = true, both_anywhere = false;
            for (int t = 0; t < 10 * 6; t++) {
                unsigned kinds = 0;
                for (int i = 0; i < 9; i++) {
                    const int x = t % 10 + i % 3 - 1, y = t / 10 + i / 3 - 1;
                    const int *place = cpu_slot_place(&test.view, slot_at(&test, x, y));
                    kinds |= place[0] == place[1] ? 1u : 2u;
                }
                both_everywhere = both_everywhere && kinds == 3;
                both_anywhere = both_anywhere || kinds == 3;
            }
            assert_int_equal(both_everywhere, both_anywhere);
            seeing += both_everywhere;
        }
        assert_int_equal(seeing, cases[c].expected);
    }
}

/* With an infinite sky no ray covers the sky, so its tiles march slot 0 in every frame. */
static void test_infinite_sky_starves_three_slots(void **state)
{
    static const char *const overrides[] = {"parallel", "sequential"};
    for (int i = 0; i < 4; i++) {
        OWNED(passes) struct test_passes test;
        test_open(*state, 20, 12, 1, &test, "override=%s far=%s", overrides[i % 2],
                  i / 2 ? "infinite" : "finite");
        test_fill(&test, RT_HALF_DEPTH, NEPH_GPU_FAR_M, 0, 0, 0);
        for (test.view.frame = 0; test.view.frame < 8; test.view.frame++) {
            run_tile_index(&test);
            for (int t = 0; t < 15; t++) {
                const int x = t % 5, y = t / 5;
                assert_int_equal(slot_at(&test, x, y),
                                 i / 2 ? 0 : cpu_default_slot(&test.view, x, y));
                float tile[4];
                cpu_fetch_tile(&test.cpu, RT_TILE, x, y, tile);
                assert_true(tile[1] == 2.0f); /* with sky_m = 20000 */
            }
        }
    }
}

/* A depth that is stored as a half has its rounding error, 2^-11. */
static void test_stored_depths(void **state)
{
    OWNED(passes) struct test_passes test;
    test_open(*state, 4096, 1, 1, &test, "override=none ray_depth_max_m=10000");
    uint64_t seed = 7;
    for (size_t i = 0; i < test_elements(&test, RT_HALF_DEPTH); i++)
        test_set(&test, RT_HALF_DEPTH, i, (float[4]){(float)exp(11.0 * test_uniform(&seed))});
    run_tile_index(&test);
    for (int x = 0; x < 1024; x++) {
        const int *place = cpu_slot_place(&test.view, slot_at(&test, x, 0));
        float tile[4], depth[4];
        cpu_fetch_tile(&test.cpu, RT_TILE, x, 0, tile);
        cpu_fetch_half(&test.cpu, RT_HALF_DEPTH, 2 * x + place[0], place[1], depth);
        /* ... and by 2^-24 / 1e-4 of a metre below the normal halves */
        neph_assert_close(tile[1] * 1e4, fmin(depth[0], 1e4), 0x1p-11 + 1e-7, 0x1p-25 * 1e4);
    }
}

/* A view in the corner of a larger buffer makes the same decisions as in a buffer of its own; with
 * tile_origin=buffer it reads the depths of the neighbouring view. */
static void test_views_are_independent(void **state)
{
    static const char *const origins[] = {"tile_origin=view", "tile_origin=buffer"};
    for (int i = 0; i < 2; i++) {
        const struct neph_settings settings = test_settings(origins[i]);
        OWNED(passes) struct test_passes alone, beside;
        test_passes_open(*state, &settings, (int[2]){61, 35}, (int[2]){0, 0}, 3, &alone);
        test_passes_open(*state, &settings, (int[2]){61, 35}, (int[2]){64, 36}, 3, &beside);
        uint64_t seed = 5;
        for (size_t e = 0; e < test_elements(&beside, RT_HALF_DEPTH); e++)
            test_set(&beside, RT_HALF_DEPTH, e, (float[4]){random_depth_m(&seed)});
        for (int y = 0; y < 18; y++)
            for (int x = 0; x < 31; x++) {
                float depth[4];
                cpu_fetch_half(&beside.cpu, RT_HALF_DEPTH, x, y, depth);
                cpu_put_half(&alone.cpu, RT_HALF_DEPTH, x, y, depth);
            }
        run_tile_index(&alone);
        run_tile_index(&beside);
        int different = 0;
        for (int t = 0; t < 16 * 9; t++) {
            float a[4], b[4];
            cpu_fetch_tile(&alone.cpu, RT_TILE, t % 16, t / 16, a);
            cpu_fetch_tile(&beside.cpu, RT_TILE, t % 16, t / 16, b);
            different += a[0] != b[0] || a[1] != b[1];
        }
        if (i == 0)
            assert_int_equal(different, 0);
        else
            assert_true(different > 16 * 9 / 2);
    }
}

/* Normalised coordinates find the texels of every tile, but in a view that ends within a tile they
 * are not clamped to its side. */
static void test_normalised_coordinates_leave_the_view(void **state)
{
    OWNED(passes) struct test_passes test;
    test_open(*state, 61, 4, 4, &test, "override=none gather=normalised");
    assert_int_equal(test.view.targets[RT_HALF_DEPTH].width, 33);
    for (size_t e = 0; e < test_elements(&test, RT_HALF_DEPTH); e++)
        test_set(&test, RT_HALF_DEPTH, e, (float[4]){e % 33 < 31 ? 10.0f : 500.0f});
    for (test.view.frame = 0; test.view.frame < 4; test.view.frame++) {
        run_tile_index(&test);
        for (int x = 0; x < 16; x++) {
            const bool is_outside = x == 15 &&
                                    cpu_slot_place(&test.view, slot_at(&test, x, 0))[0] == 1;
            float tile[4];
            cpu_fetch_tile(&test.cpu, RT_TILE, x, 0, tile);
            assert_int_equal(tile[1] > 0.01f, is_outside);
        }
    }
}

/* --- effect of the override --------------------------------------------------------------------
 */

enum { MAP_PX = 128, MAP_TILES = MAP_PX / 4, MAP_COUNT = 10, MODE_COUNT = 3 };

/* Python's random: MT19937 (Matsumoto and Nishimura 1998), so that the maps below equal the Python
 * program's. */
struct mersenne {
    uint32_t words[624];
    int next;
};

static void mersenne_seed(struct mersenne *twister, uint32_t key)
{
    uint32_t *words = twister->words;
    words[0] = 19650218;
    for (uint32_t i = 1; i < 624; i++)
        words[i] = 1812433253u * (words[i - 1] ^ words[i - 1] >> 30) + i;
    uint32_t i = 1;
    for (int k = 0; k < 624; k++) {
        words[i] = (words[i] ^ (words[i - 1] ^ words[i - 1] >> 30) * 1664525u) + key;
        if (++i == 624) {
            words[0] = words[623];
            i = 1;
        }
    }
    for (int k = 0; k < 623; k++) {
        words[i] = (words[i] ^ (words[i - 1] ^ words[i - 1] >> 30) * 1566083941u) - i;
        if (++i == 624) {
            words[0] = words[623];
            i = 1;
        }
    }
    words[0] = 0x80000000u;
    twister->next = 624;
}

static uint32_t mersenne_word(struct mersenne *twister)
{
    uint32_t *words = twister->words;
    if (twister->next == 624) {
        for (int i = 0; i < 624; i++) {
            const uint32_t both = (words[i] & 0x80000000u) | (words[(i + 1) % 624] & 0x7fffffffu);
            words[i] = words[(i + 397) % 624] ^ both >> 1 ^ (both & 1 ? 0x9908b0dfu : 0);
        }
        twister->next = 0;
    }
    uint32_t y = words[twister->next++];
    y ^= y >> 11;
    y ^= y << 7 & 0x9d2c5680u;
    y ^= y << 15 & 0xefc60000u;
    return y ^ y >> 18;
}

static double python_random(struct mersenne *twister)
{
    const uint32_t upper = mersenne_word(twister) >> 5, lower = mersenne_word(twister) >> 6;
    return (upper * 67108864.0 + lower) / 9007199254740992.0;
}

static int python_randrange_3(struct mersenne *twister)
{
    uint32_t bits;
    while ((bits = mersenne_word(twister) >> 30) == 3)
        continue;
    return (int)bits;
}

/* Ten depth maps: 10 m (and 100 m in the last) in front of the sky. The random numbers are drawn in
 * the order of the Python program, pixel by pixel, also for blocks that have one already. */
static void make_maps(float maps_m[MAP_COUNT][MAP_PX * MAP_PX])
{
    static const float layers_m[3] = {10.0f, 100.0f, NEPH_GPU_FAR_M};
    OWNED(memory) struct mersenne *twister = malloc(sizeof(*twister));
    int block[MAP_PX * MAP_PX];
    mersenne_seed(twister, 1);
    for (int map = 0; map < MAP_COUNT; map++) {
        memset(block, -1, sizeof(block));
        for (int i = 0; i < MAP_PX * MAP_PX; i++) {
            const int x = i % MAP_PX, y = i / MAP_PX;
            const int shift = map == 2 ? 2 : 1;
            int *own_block = &block[(y >> shift) * MAP_PX + (x >> shift)];
            int drawn = 0;
            if (map == 0 || map == 2)
                drawn = python_random(twister) < 0.5;
            else if (map == 1)
                drawn = python_random(twister) < 0.1;
            else if (map == 9)
                drawn = python_randrange_3(twister);
            if (*own_block < 0)
                *own_block = drawn;
            const bool near[MAP_COUNT] = {
                drawn,
                drawn,
                *own_block,
                x % 8 == 3,
                x % 4 == 1,
                x % 4 < 2,
                fabs(x - y * 0.73 - 20) < 0.7,
                x < 63,
                x % 32 == 9 && y % 32 == 9,
            };
            maps_m[map][i] = map == 9 ? layers_m[*own_block] : near[map] ? 10.0f : NEPH_GPU_FAR_M;
        }
    }
}

struct coverage {
    int unmatched;       /* texels without a ray, in four frames, and no ray within 10 % around */
    int unmatched_worst; /* of one frame */
    int starved;         /* slots that no frame marches */
};

static int count_unmatched(const struct test_passes *test)
{
    int unmatched = 0;
    for (int t = 0; t < MAP_TILES * MAP_TILES; t++)
        for (int slot = 0; slot < 4; slot++) {
            const int x = t % MAP_TILES, y = t / MAP_TILES;
            if (slot == slot_at(test, x, y))
                continue;
            const int *place = cpu_slot_place(&test->view, slot);
            float depth[4], ray[4];
            cpu_fetch_half(&test->cpu, RT_HALF_DEPTH, 2 * x + place[0], 2 * y + place[1], depth);
            const double own_m = depth[0] == NEPH_GPU_FAR_M ? 20000.0 : depth[0];
            bool matched = false;
            for (int i = 0; i < 9; i++) {
                cpu_fetch_tile(&test->cpu, RT_TILE, x + i % 3 - 1, y + i / 3 - 1, ray);
                const double ray_m = ray[1] * 1e4;
                matched = matched || fabs(own_m - ray_m) < 0.1 * ray_m;
            }
            unmatched += !matched;
        }
    return unmatched;
}

static struct coverage measure_coverage(struct test_passes *test)
{
    struct coverage coverage = {0};
    unsigned marched[MAP_TILES * MAP_TILES] = {0};
    for (test->view.frame = 0; test->view.frame < 4; test->view.frame++) {
        run_tile_index(test);
        const int unmatched = count_unmatched(test);
        coverage.unmatched += unmatched;
        if (unmatched > coverage.unmatched_worst)
            coverage.unmatched_worst = unmatched;
        for (int t = 0; t < MAP_TILES * MAP_TILES; t++)
            marched[t] |= 1u << slot_at(test, t % MAP_TILES, t / MAP_TILES);
    }
    for (int t = 0; t < MAP_TILES * MAP_TILES; t++)
        coverage.starved += 4 - __builtin_popcount(marched[t]);
    return coverage;
}

/* The numbers were counted by the same rule on the same maps in a separate Python program, in
 * double precision. They are parts of 4 * 3072 texels, and of 4096 slots. A fence with the pitch of
 * the tiles is the failure of the parallel override: two frames without a single matching ray. */
static void test_coverage_equals_the_python_program(void **state)
{
    static const char *const modes[MODE_COUNT] = {"override=none", "override=parallel",
                                                  "override=sequential"};
    static const struct {
        const char *name;
        struct coverage expected[MODE_COUNT];
    } maps[MAP_COUNT] = {
        {"half of the pixels", {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}},
        {"a tenth of the pixels", {{364, 95, 0}, {0, 0, 332}, {0, 0, 183}}},
        {"half of the 4 px blocks", {{0, 0, 0}, {0, 0, 21}, {0, 0, 21}}},
        {"bars 1 px, pitch 8", {{1024, 512, 0}, {0, 0, 1024}, {0, 0, 512}}},
        {"bars 1 px, pitch 4", {{2048, 1024, 0}, {6144, 3072, 2048}, {0, 0, 512}}},
        {"bars 2 px, pitch 4", {{4096, 2048, 0}, {4096, 2048, 1024}, {0, 0, 256}}},
        {"wire 1.4 px", {{80, 22, 0}, {0, 0, 43}, {0, 0, 22}}},
        {"half plane", {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}},
        {"single pixels", {{48, 16, 0}, {0, 0, 48}, {0, 0, 48}}},
        {"three layers, 2 px", {{422, 131, 0}, {88, 36, 253}, {61, 19, 185}}},
    };
    float(*depths_m)[MAP_PX * MAP_PX] = malloc(MAP_COUNT * sizeof(*depths_m));
    make_maps(depths_m);
    for (int mode = 0; mode < MODE_COUNT; mode++) {
        OWNED(passes) struct test_passes test;
        test_open(*state, MAP_PX, MAP_PX, 1, &test, "%s", modes[mode]);
        for (int map = 0; map < MAP_COUNT; map++) {
            for (size_t i = 0; i < MAP_PX * MAP_PX; i++)
                cpu_put_full(&test.cpu, RT_STEADY_DEPTH, (int)i % MAP_PX, (int)i / MAP_PX,
                             (float[4]){depths_m[map][i]});
            test_passes_run(&test, "depth map");
            test_take(&test, RT_HALF_DEPTH);
            const struct coverage actual = measure_coverage(&test);
            const struct coverage *expected = &maps[map].expected[mode];
            if (memcmp(&actual, expected, sizeof(actual)) != 0)
                fail_msg("%s, %s: %d unmatched (worst frame %d), %d starved; expected %d (%d), %d",
                         maps[map].name, modes[mode], actual.unmatched, actual.unmatched_worst,
                         actual.starved, expected->unmatched, expected->unmatched_worst,
                         expected->starved);
        }
    }
    free(depths_m);
}

#include "tests/renderer/main.h"
