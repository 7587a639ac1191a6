/* SPDX-License-Identifier: MIT
 *
 * The oracles of the real-time renderer: each replaces one shortcut by what it approximates, and
 * changes nothing else. The scene has depth edges, fog that drifts, and a camera that moves.
 */
#include "tests/renderer/sequence_test.h"

enum {
    WIDTH_PX = 64,
    HEIGHT_PX = 36,
    HALF_WIDTH = WIDTH_PX / 2,
    TILE_COLUMNS = WIDTH_PX / 4,
    FRAMES = 6
};

/* A scene with a moving camera; it must outlive its `test.scene`. */
struct moving_scene {
    struct test_scene test;
    struct neph_camera_key cameras[2];
    struct neph_wind_key wind;
};

static void init_scene(struct moving_scene *moving)
{
    struct test_scene *test = &moving->test;
    test_scene_fence(test);
    test_add_cloud(test, NEPH_MEDIUM_GAUSSIAN, 0.8)->gaussian = (struct neph_gaussian){
        {0.5, 2.0, -20.0}, 1.5};
    moving->cameras[0] = moving->cameras[1] = test->key;
    moving->cameras[1].frame = FRAMES - 1;
    moving->cameras[1].position_m.x += 1.0;
    moving->cameras[1].look_at_m.x += 1.0;
    moving->wind = (struct neph_wind_key){.velocity_m_per_s = {3.0, 0.0, 0.0}};
    test->scene.camera_key_count = 2;
    test->scene.camera_keys = moving->cameras;
    test->scene.wind_key_count = 1;
    test->scene.wind_keys = &moving->wind;
    test->scene.frame_count = FRAMES;
}

/* Targets of the frames of a sequence. */
enum kept { TILES, RAYS, TEXELS, COLORS, KEPT };

static const struct {
    int target;
    const char *after; /* the pass that writes it */
} kept[KEPT] = {
    [TILES] = {RT_TILE, "march"},
    [RAYS] = {RT_RAY, "march"},
    [TEXELS] = {RT_HISTORY, "reconstruction"},
    [COLORS] = {RT_COLOR, "upscale"},
};

struct sequence {
    uint32_t *frames[KEPT][FRAMES];
    size_t words[KEPT];
    int frame;
};

static void keep_targets(struct neph_rt_device *device, const struct neph_rt_pass *pass,
                         void *context)
{
    struct sequence *sequence = context;
    for (int k = 0; k < KEPT; k++)
        if (strcmp(pass->name, kept[k].after) == 0) {
            sequence->words[k] = neph_rt_device_words(device, kept[k].target);
            sequence->frames[k][sequence->frame] = test_words(device, kept[k].target);
        }
}

/* Renders `fixed` without anti-aliasing, changed by settings. The sequence is freed by
 * finish_sequence(). */
static struct sequence render_sequence(struct neph_vulkan *vulkan, const char *settings)
{
    struct moving_scene moving;
    struct sequence sequence = {.frame = 0};
    char words[256];
    init_scene(&moving);
    snprintf(words, sizeof(words), "taa=off warm_up=0 target_format=float %s", settings);
    const struct neph_settings fixed = test_preset("fixed", words);
    OWNED(realtime)
    struct neph_realtime *realtime = test_sequence(vulkan, &moving.test.scene, &fixed, WIDTH_PX,
                                                   HEIGHT_PX);
    neph_realtime_observe(realtime, keep_targets, &sequence);
    for (; sequence.frame < FRAMES; sequence.frame++)
        neph_image_destroy(test_next(realtime, &moving.test.scene, sequence.frame, NULL));
    return sequence;
}

static void finish_sequence(struct sequence *sequence)
{
    for (int k = 0; k < KEPT; k++)
        for (int f = 0; f < FRAMES; f++)
            free(sequence->frames[k][f]);
}

/* Number of words of a target that differ, over all frames. */
static int count_differences(const struct sequence *a, const struct sequence *b, enum kept k)
{
    int count = 0;
    for (int f = 0; f < FRAMES; f++)
        for (size_t i = 0; i < a->words[k]; i++)
            count += a->frames[k][f][i] != b->frames[k][f][i];
    return count;
}

/* The half-resolution texel of the ray of a tile. */
static int ray_texel(const struct sequence *sequence, int frame, int tile)
{
    static const int places[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    float slot;
    memcpy(&slot, &sequence->frames[TILES][frame][2 * tile], sizeof(slot));
    const int x = 2 * (tile % TILE_COLUMNS) + places[(int)slot][0];
    const int y = 2 * (tile / TILE_COLUMNS) + places[(int)slot][1];
    return y * HALF_WIDTH + x;
}

/* Number of tiles whose rays differ from their texels, over all frames. */
static int count_foreign_rays(const struct sequence *rays, const struct sequence *texels)
{
    int count = 0;
    for (int f = 0; f < FRAMES; f++)
        for (int tile = 0; tile < TILE_COLUMNS * (HEIGHT_PX / 4); tile++)
            count += memcmp(&rays->frames[RAYS][f][4 * tile],
                            &texels->frames[TEXELS][f][4 * ray_texel(rays, f, tile)], 16) != 0;
    return count;
}

/* With the rays of all texels and the upscale's error removed, a frame is the frame that marches
 * every pixel. The difference and its sum round, so float32 frames agree to a few units. */
static void test_all_oracles_march_every_pixel(void **state)
{
    struct moving_scene moving;
    init_scene(&moving);
    const struct neph_settings whole = test_preset("off", "");
    const struct neph_settings split = test_preset(
        "fixed", "taa=off warm_up=0 target_format=float oracle_rays=on oracle_upscale=on");
    OWNED(realtime)
    struct neph_realtime *a = test_sequence(*state, &moving.test.scene, &whole, WIDTH_PX,
                                            HEIGHT_PX);
    OWNED(realtime)
    struct neph_realtime *b = test_sequence(*state, &moving.test.scene, &split, WIDTH_PX,
                                            HEIGHT_PX);
    for (int frame = 0; frame < FRAMES; frame++) {
        OWNED(image) struct neph_image *every = test_next(a, &moving.test.scene, frame, NULL);
        OWNED(image) struct neph_image *ideal = test_next(b, &moving.test.scene, frame, NULL);
        float *of_every[3], *of_ideal[3];
        neph_image_rgb(every, NULL, of_every);
        neph_image_rgb(ideal, NULL, of_ideal);
        for (int c = 0; c < 3; c++)
            for (size_t i = 0; i < neph_image_pixel_count(every); i++)
                assert_true(fabsf(of_every[c][i] - of_ideal[c][i]) <= 8e-7f * of_every[c][i]);
    }
}

/* The oracles of the history and the upscale change nothing that is made before them, and no texel
 * with a ray of its own in this frame (fresh_weight = 1): it has no history. */
static void test_an_oracle_changes_its_part_only(void **state)
{
    static const struct {
        const char *settings;
        bool changes_texels;
    } oracles[] = {
        {"oracle_motion=on", true}, {"oracle_depth=on", true}, {"oracle_upscale=on", false}};
    struct sequence plain = render_sequence(*state, "");
    assert_int_equal(count_foreign_rays(&plain, &plain), 0);
    for (size_t i = 0; i < COUNT(oracles); i++) {
        struct sequence ideal = render_sequence(*state, oracles[i].settings);
        assert_int_equal(count_differences(&plain, &ideal, RAYS), 0);
        assert_int_equal(count_differences(&plain, &ideal, TILES), 0);
        assert_int_equal(count_foreign_rays(&ideal, &ideal), 0);
        assert_int_equal(count_differences(&plain, &ideal, TEXELS) > 100,
                         oracles[i].changes_texels);
        assert_true(count_differences(&plain, &ideal, COLORS) > 100);
        finish_sequence(&ideal);
    }
    finish_sequence(&plain);
}

/* Sum of the errors of all texels against their own rays, over frames and channels. */
static double sum_errors(const struct sequence *own, const struct sequence *found)
{
    double sum = 0.0;
    for (int f = 0; f < FRAMES; f++)
        for (size_t i = 0; i < own->words[TEXELS]; i++) {
            float a, b;
            memcpy(&a, &own->frames[TEXELS][f][i], sizeof(a));
            memcpy(&b, &found->frames[TEXELS][f][i], sizeof(b));
            sum += (double)fabsf(a - b);
        }
    return sum;
}

/* With oracle_rays every texel has its own ray: where a tile has one, and there is no noise, it is
 * the tile's, bit by bit. Other settings of the history then have no effect. Each oracle of the
 * history brings it nearer to these rays; without noise, to which a search would fit as well. */
static void test_the_texels_have_their_own_rays(void **state)
{
    struct sequence own = render_sequence(*state, "oracle_rays=on");
    struct sequence same = render_sequence(*state, "oracle_rays=on oracle_motion=on "
                                                   "oracle_depth=on box=none ray_dither=none");
    struct sequence plain = render_sequence(*state, "ray_dither=none box=none");
    struct sequence motion = render_sequence(*state, "ray_dither=none box=none oracle_motion=on");
    struct sequence depth = render_sequence(*state, "ray_dither=none box=none oracle_depth=on");
    assert_int_equal(count_foreign_rays(&plain, &own), 0);
    assert_int_equal(count_differences(&own, &same, TEXELS), 0);
    assert_true(sum_errors(&own, &motion) < sum_errors(&own, &plain));
    assert_true(sum_errors(&own, &depth) < sum_errors(&own, &plain));
    finish_sequence(&own);
    finish_sequence(&same);
    finish_sequence(&plain);
    finish_sequence(&motion);
    finish_sequence(&depth);
}

#include "tests/renderer/main.h"
