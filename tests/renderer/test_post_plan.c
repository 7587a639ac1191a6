/* SPDX-License-Identifier: MIT
 *
 * Chains from files: volumes compared with interpolations by hand, valid orders, invalid files, and
 * the frames that a chain produces. The table of keys in docs/post.md is printed from the fields;
 * `test_post_plan --write` writes it.
 */
#include "tests/printed_table.h"
#include "tests/renderer/post_test.h"

#include "renderer/post/plan.h"

#include <unistd.h>

/* ---- volumes --------------------------------------------------------------------------------- */

static struct neph_post_volume volume(double priority, double weight, int setting, double value)
{
    struct neph_post_volume made = {.priority = priority, .weight = weight};
    made.changes.values[setting] = value;
    made.changes.is_given[setting] = true;
    return made;
}

static double blended(const struct neph_post_volume *volumes, int count, struct neph_vec3 place,
                      int setting)
{
    struct neph_settings settings = neph_options_default(neph_post_options);
    neph_post_blend(volumes, count, place, &settings);
    return settings.values[setting];
}

/* A box of 2 m around (1, 1, 1), blended over 4 m. */
static void test_a_volume_fades_with_the_distance(void **state)
{
    struct neph_post_volume box = volume(0.0, 0.8, POST_EXPOSURE_EV, 5.0);
    box.blend_radius_m = 4.0;
    box.box = (struct neph_post_box){true, {0, 0, 0}, {2, 2, 2}};
    const struct {
        struct neph_vec3 place;
        double weight;
    } cases[] = {{{1, 1, 1}, 0.8},
                 {{2, 2, 2}, 0.8},
                 {{3, 1, 1}, 0.6},
                 {{1, -2, 1}, 0.4},
                 {{6, 1, 1}, 0.0},
                 {{1, 1, 100}, 0.0},
                 {{-1, 4, 1}, 0.8 * (1 - sqrt(5) / 4)},
                 {{3, 3, 3}, 0.8 * (1 - sqrt(3) / 4)}};
    for (size_t i = 0; i < COUNT(cases); i++) {
        neph_assert_close(neph_post_volume_weight(&box, cases[i].place), cases[i].weight, 0.0,
                          1e-15);
        neph_assert_close(blended(&box, 1, cases[i].place, POST_EXPOSURE_EV), 5.0 * cases[i].weight,
                          0.0, 1e-14);
    }
    box.blend_radius_m = 0.0; /* a hard border */
    assert_true(neph_post_volume_weight(&box, (struct neph_vec3){2.0001, 1, 1}) == 0.0);
    assert_true(neph_post_volume_weight(&box, (struct neph_vec3){2.0, 1, 1}) == 0.8);
}

static void test_priority_is_the_order_of_lerps(void **state)
{
    const struct neph_vec3 origin = {0, 0, 0};
    const struct neph_post_volume volumes[] = {
        volume(2.0, 0.5, POST_EXPOSURE_EV, 8.0), volume(-1.0, 1.0, POST_EXPOSURE_EV, 1.0),
        volume(0.5, 0.25, POST_EXPOSURE_EV, -3.0), volume(2.0, 0.5, POST_EXPOSURE_EV, 4.0)};
    /* 0 -> 1 -> 1 + (-3 - 1) / 4 = 0 -> 4 -> 4; equal priorities in the file's order. */
    neph_assert_close(blended(volumes, 4, origin, POST_EXPOSURE_EV), 4.0, 0.0, 0.0);
    /* Without the second: 0 -> -0.75 -> 3.625 -> 3.8125. */
    const struct neph_post_volume fewer[] = {volumes[0], volumes[2], volumes[3]};
    neph_assert_close(blended(fewer, 3, origin, POST_EXPOSURE_EV), 3.8125, 0.0, 0.0);
    /* Weighted numbers stay in the range of the numbers. */
    uint64_t seed = 9;
    for (int run = 0; run < 200; run++) {
        struct neph_post_volume many[7];
        for (int i = 0; i < 7; i++)
            many[i] = volume(neph_test_uniform(&seed, -2, 2), neph_test_uniform(&seed, 0, 1),
                             POST_VIGNETTE, neph_test_uniform(&seed, 0, 4));
        const double made = blended(many, 7, origin, POST_VIGNETTE);
        assert_true(made >= 0.0 && made <= 4.0);
    }
}

static void test_choices_change_at_once(void **state)
{
    const struct neph_vec3 origin = {0, 0, 0};
    const struct neph_post_volume faint = volume(0, 0.01, POST_TONE_MAP, POST_MAP_AGX);
    const struct neph_post_volume none = volume(0, 0.0, POST_TONE_MAP, POST_MAP_AGX);
    assert_true(blended(&faint, 1, origin, POST_TONE_MAP) == POST_MAP_AGX);
    assert_true(blended(&none, 1, origin, POST_TONE_MAP) == POST_MAP_UNREAL);
}

/* ---- files ----------------------------------------------------------------------------------- */

static enum neph_status load(const char *text, struct neph_post_plan *plan, struct neph_diag *diag)
{
    char path[] = "/tmp/neph-test-chain-XXXXXX";
    const int handle = mkstemp(path);
    assert_true(handle >= 0);
    close(handle);
    neph_assert_ok(neph_file_write(path, text, strlen(text), diag), diag);
    const enum neph_status status = neph_post_plan_load(path, plan, diag);
    unlink(path);
    return status;
}

static void test_a_file_is_its_chain(void **state)
{
    static const char text[] = "title: an evening\n"
                               "preset: unreal\n"
                               "settings: {exposure_ev: 1.5, bloom: conserving, bloom_levels: 4}\n"
                               "passes:\n"
                               "  - pass: bloom\n"
                               "  - pass: upscale\n"
                               "    on: false\n"
                               "  - pass: tone_mapping\n"
                               "volumes:\n"
                               "  - name: cave\n"
                               "    priority: 3\n"
                               "    weight: 0.5\n"
                               "    blend_radius_m: 20\n"
                               "    box: {minimum_m: [0, 0, 0], maximum_m: [10, 5, 10]}\n"
                               "    settings: {exposure_ev: 4, tone_map: agx}\n"
                               "  - name: all\n"
                               "    settings: {}\n";
    struct neph_post_plan plan;
    struct neph_diag diag = {0};
    neph_assert_ok(load(text, &plan, &diag), &diag);
    const struct neph_settings settings = neph_post_plan_settings(&plan);
    assert_true(settings.values[POST_EXPOSURE_EV] == 1.5);
    assert_true(settings.values[POST_LUT] == 1.0); /* from the preset */
    assert_true(settings.values[POST_BLOOM] == POST_BLOOM_CONSERVING);
    assert_true(settings.values[POST_BLOOM_LEVELS] == 4.0);
    assert_int_equal(plan.order.count, 2);
    assert_int_equal(plan.order.passes[0], NEPH_POST_BLOOM);
    assert_int_equal(plan.order.passes[1], NEPH_POST_TONE_MAPPING);
    assert_int_equal(plan.volume_count, 2);
    assert_true(neph_post_plan_wants_camera(&plan));
    struct neph_settings there = settings;
    neph_post_blend(plan.volumes, plan.volume_count, (struct neph_vec3){5, 5, 20}, &there);
    neph_assert_close(there.values[POST_EXPOSURE_EV], 1.5 + 0.25 * 2.5, 0.0, 1e-15);
    assert_true(there.values[POST_TONE_MAP] == POST_MAP_AGX);
    assert_true(plan.volumes[1].weight == 1.0 && !plan.volumes[1].box.present);
    neph_post_plan_finish(&plan);
    neph_assert_ok(load("{}\n", &plan, &diag), &diag);
    assert_int_equal(plan.order.count, NEPH_POST_PASS_COUNT);
    neph_post_plan_finish(&plan);
}

static void test_what_makes_no_sense_is_refused_by_line(void **state)
{
    static const struct {
        const char *text, *says, *hints;
        int line;
    } cases[] = {
        {"settings:\n  exposure_ev: 99\n", "99 is outside -32 to 32", "2^EV", 2},
        {"settings:\n  tone_map: acse\n", "'acse', expected one of none", NULL, 2},
        {"settings: {exposur_ev: 1}\n", "exposur_ev", "exposure_ev", 1},
        {"preset: unral\n", "unral", "unreal", 1},
        {"passes:\n- pass: tone_mapping\n- pass: bloom\n", "bloom spreads light", NULL, 3},
        {"passes:\n- pass: fxaa\n- pass: tone_mapping\n", "fxaa works on display codes", NULL, 3},
        {"passes:\n- pass: bloom\n- pass: bloom\n", "twice", NULL, 3},
        {"passes:\n- pass: bloem\n", "bloem", "bloom", 2},
        {"volumes:\n- name: a\n  weight: 1.5\n  settings: {}\n", "1.5 is outside 0 to 1", NULL, 3},
        {"volumes:\n- name: a\n", "settings", NULL, 2},
        {"volumes:\n- name: a\n  settings: {}\n  box:\n    minimum_m: [0, 0, 0]\n    maximum_m: "
         "[1, -1, 1]\n",
         "below its minimum_m", NULL, 6}};
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct neph_post_plan plan;
        struct neph_diag diag = {0};
        assert_int_equal(load(cases[i].text, &plan, &diag), NEPH_ERR_INPUT);
        if (!strstr(diag.message, cases[i].says) || diag.line != cases[i].line ||
            (cases[i].hints && !strstr(diag.hint, cases[i].hints)))
            fail_msg("%s\nsaid line %d: %s\n%s", cases[i].text, diag.line, diag.message, diag.hint);
    }
}

static void test_the_manual_holds_the_keys(void **state)
{
    const struct printed_table table = {NEPH_SOURCE_DIR "/docs/post.md",
                                        "<!-- written by tests/test_post_plan --write -->\n"
                                        "| key | value | default | meaning |\n"
                                        "| --- | --- | --- | --- |\n",
                                        "<!-- end -->\n", neph_post_plan_print_keys};
    check_readme(&table, *state);
}

/* ---- a frame --------------------------------------------------------------------------------- */

static struct neph_image *made_by(struct neph_vulkan *vulkan, const struct neph_post_order *order,
                                  const char *settings, const struct neph_image *frame,
                                  float *rgb[3])
{
    const struct neph_post_params params = {.settings = post_settings(settings), .order = order};
    struct neph_diag diag = {0};
    struct neph_image *made;
    neph_assert_ok(neph_post_run(vulkan, &params, frame, &made, NULL, &diag), &diag);
    assert_true(neph_image_rgb(made, NULL, rgb));
    return made;
}

/* Upscaling before tone mapping differs from upscaling codes; both equal the stages run one by
 * one. */
static void test_the_order_is_what_runs(void **state)
{
    static const struct neph_post_order upscale_first = {
        3, {NEPH_POST_UPSCALE, NEPH_POST_BLOOM, NEPH_POST_TONE_MAPPING}};
    static const char all[] = "tone=on tone_map=reinhard bloom=conserving upscale=bilinear";
    enum { width = 13, height = 9 };
    float *in[3], *one[3], *two[3], *usual[3], *other[3];
    uint64_t seed = 4;
    OWNED(image) struct neph_image *image = post_image(width, height, in);
    for (int i = 0; i < width * height; i++)
        for (int c = 0; c < 3; c++)
            in[c][i] = (float)exp2(neph_test_uniform(&seed, -6.0, 6.0));
    OWNED(image) struct neph_image *larger = made_by(*state, NULL, "upscale=bilinear", image, one);
    OWNED(image)
    struct neph_image *shown = made_by(*state, NULL, "tone=on tone_map=reinhard bloom=conserving",
                                       larger, two);
    OWNED(image) struct neph_image *first = made_by(*state, &upscale_first, all, image, other);
    OWNED(image) struct neph_image *last = made_by(*state, NULL, all, image, usual);
    bool differs = false;
    for (int i = 0; i < 4 * width * height; i++) {
        assert_true(other[1][i] == two[1][i]);
        differs = differs || other[1][i] != usual[1][i];
    }
    assert_true(differs);
}

/* Half, and half again: the second upscale continues from the first, with its own filter. */
static void test_the_second_upscale_comes_after_the_first(void **state)
{
    float *in[3], *out[3], *once[3];
    OWNED(image) struct neph_image *image = post_image(4, 3, in);
    for (int i = 0; i < 12; i++)
        in[0][i] = in[1][i] = in[2][i] = (float)i;
    OWNED(image) struct neph_image *first = made_by(*state, NULL, "upscale=bilinear", image, once);
    OWNED(image)
    struct neph_image *both = made_by(
        *state, NULL, "upscale=bilinear secondary_upscale=nearest secondary_percent=25", image,
        out);
    assert_int_equal(both->width_px, 32);
    assert_int_equal(both->height_px, 24);
    for (int y = 0; y < 24; y++)
        for (int x = 0; x < 32; x++)
            assert_true(out[0][y * 32 + x] == once[0][y / 4 * 8 + x / 4]);
}

/* Passes are turned off from the last to the first: the last active pass writes the image, from the
 * output of the pass before. */
static void test_the_last_that_is_on_writes_the_picture(void **state)
{
    static const struct {
        const char *setting;
        int percent; /* of the side before */
    } passes[] = {{"bloom=conserving", 100}, {"tone=on lut=on grain=3 vignette=0.4", 100},
                  {"fxaa=quality_29", 100},  {"upscale=easu", 200},
                  {"sharpen=rcas", 100},     {"secondary_upscale=catmull_rom", 200}};
    enum { width = 13, height = 9, count = COUNT(passes) };
    char all[300] = "";
    float *rgb[3], *whole[3], *step[3];
    uint64_t seed = 7;
    struct neph_image *before = post_image(width, height, rgb);
    OWNED(image) struct neph_image *frame = post_image(width, height, step);
    for (int i = 0; i < width * height; i++)
        for (int c = 0; c < 3; c++)
            rgb[c][i] = step[c][i] = (float)exp2(neph_test_uniform(&seed, -6.0, 3.0));
    for (int k = 0, side = width; k < count; k++) {
        snprintf(all + strlen(all), sizeof(all) - strlen(all), " %s", passes[k].setting);
        OWNED(image) struct neph_image *made = made_by(*state, NULL, all, frame, whole);
        struct neph_image *alone = made_by(*state, NULL, passes[k].setting, before, step);
        side = side * passes[k].percent / 100;
        assert_int_equal(made->width_px, side);
        for (size_t i = 0; i < neph_image_pixel_count(made); i++)
            for (int c = 0; c < 3; c++)
                assert_true(whole[c][i] == step[c][i] && isfinite(whole[c][i]));
        neph_image_destroy(before);
        before = alone;
    }
    neph_image_destroy(before);
}

static double half_ulp(double value)
{
    return ldexp(1.0, (int)fmax(floor(log2(fmax(fabs(value), 1e-30))), -14.0) - 10);
}

/* Half-precision values are within one step for every rounding of the device; 10 bits are codes. */
static void test_targets_keep_what_fits_into_them(void **state)
{
    static const char chain[] = "bloom=conserving tone=on tone_map=reinhard sharpen=cas";
    static const char *const last[] = {"bloom=conserving", "tone=on tone_map=reinhard"};
    enum { width = 13, height = 9 };
    float *in[3], *full[3], *half[3], *codes[3];
    uint64_t seed = 11;
    OWNED(image) struct neph_image *image = post_image(width, height, in);
    for (int i = 0; i < width * height; i++)
        for (int c = 0; c < 3; c++)
            in[c][i] = (float)exp2(neph_test_uniform(&seed, -12.0, 12.0));
    for (int k = 0; k < 3; k++) {
        char settings[200];
        struct neph_image *made[3];
        float **rgb[3] = {full, half, codes};
        static const char *const targets[] = {"float32", "float16", "unorm10"};
        for (int t = 0; t < 3; t++) {
            snprintf(settings, sizeof(settings), "%s targets=%s", k < 2 ? last[k] : chain,
                     targets[t]);
            made[t] = made_by(*state, NULL, settings, image, rgb[t]);
        }
        for (int c = 0; c < 3; c++)
            for (int i = 0; i < width * height; i++) {
                const double code = 1023.0 * codes[c][i];
                if (k < 2)
                    neph_assert_close(half[c][i], full[c][i], 0.0, half_ulp(full[c][i]));
                if (k == 0)
                    assert_true(codes[c][i] == half[c][i]); /* no tone mapping */
                if (k == 1)
                    neph_assert_close(codes[c][i], full[c][i], 0.0, 0.50001 / 1023.0);
                if (k > 0)
                    neph_assert_close(code, round(code), 0.0, 1e-3);
                assert_true(isfinite(half[c][i]) && half[c][i] >= 0.0 && codes[c][i] >= 0.0);
            }
        for (int t = 0; t < 3; t++)
            neph_image_destroy(made[t]);
    }
}

/* Frames for a window's chain are smaller by its percentages, and are enlarged to exactly that
 * window. */
static void test_a_window_is_met_to_the_pixel(void **state)
{
    static const struct {
        int window_px[2], frame_px[2];
        const char *settings;
    } cases[] = {
        {{37, 23}, {37, 23}, "tone=on screen_percent=50"},
        {{38, 22}, {19, 11}, "upscale=nearest screen_percent=50"},
        {{37, 23}, {25, 16}, "upscale=lanczos screen_percent=67"},
        {{37, 23},
         {21, 14},
         "upscale=easu screen_percent=70 secondary_upscale=bilinear "
         "secondary_percent=80"},
        {{5, 1}, {1, 1}, "upscale=bilinear screen_percent=12.5"},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct neph_post_params params = {.settings = post_settings(cases[i].settings)};
        int width_px = cases[i].window_px[0], height_px = cases[i].window_px[1];
        struct neph_diag diag = {0};
        struct neph_image *made;
        float *rgb[3];
        params.width_px = width_px;
        params.height_px = height_px;
        neph_post_frame_size(NULL, &params.settings, &width_px, &height_px);
        assert_int_equal(width_px, cases[i].frame_px[0]);
        assert_int_equal(height_px, cases[i].frame_px[1]);
        OWNED(image) struct neph_image *image = post_image(width_px, height_px, rgb);
        for (int c = 0; c < 3; c++)
            for (int p = 0; p < width_px * height_px; p++)
                rgb[c][p] = 0.5f;
        neph_assert_ok(neph_post_run(*state, &params, image, &made, NULL, &diag), &diag);
        assert_int_equal(made->width_px, cases[i].window_px[0]);
        assert_int_equal(made->height_px, cases[i].window_px[1]);
        neph_image_destroy(made);
    }
}

/* The load that keeps a GPU's clock up before timing does not change image or eye. */
static void test_heat_changes_nothing(void **state)
{
    float *rgb[3], *made[2][3];
    struct neph_diag diag = {0};
    OWNED(image) struct neph_image *frame = post_image(37, 23, rgb);
    struct neph_image *pictures[2];
    struct neph_post_stats stats[2];
    for (int p = 0; p < 37 * 23; p++)
        for (int c = 0; c < 3; c++)
            rgb[c][p] = (float)((p * 7 + 13 * c) % 29) / 7.0F;
    for (int i = 0; i < 2; i++) {
        const struct neph_post_params params = {
            .settings = post_settings("tone=on auto_exposure=on bloom=conserving lut=on "
                                      "fxaa=quality_29 upscale=lanczos sharpen=cas"),
            .heat_runs = 700 * i,
        };
        neph_assert_ok(neph_post_run(*state, &params, frame, &pictures[i], &stats[i], &diag),
                       &diag);
        assert_true(neph_image_rgb(pictures[i], NULL, made[i]));
    }
    for (int c = 0; c < 3; c++)
        assert_memory_equal(made[0][c], made[1][c],
                            neph_image_pixel_count(pictures[0]) * sizeof(float));
    assert_true(stats[0].metered_ev == stats[1].metered_ev);
    neph_image_destroy(pictures[0]);
    neph_image_destroy(pictures[1]);
}

int main(int count, char **arguments)
{
    const struct CMUnitTest manual[] = {
        cmocka_unit_test_prestate(test_the_manual_holds_the_keys, writes_readme(count, arguments)),
    };
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_volume_fades_with_the_distance),
        cmocka_unit_test(test_priority_is_the_order_of_lerps),
        cmocka_unit_test(test_choices_change_at_once),
        cmocka_unit_test(test_a_file_is_its_chain),
        cmocka_unit_test(test_what_makes_no_sense_is_refused_by_line),
        cmocka_unit_test(test_the_order_is_what_runs),
        cmocka_unit_test(test_the_second_upscale_comes_after_the_first),
        cmocka_unit_test(test_the_last_that_is_on_writes_the_picture),
        cmocka_unit_test(test_a_window_is_met_to_the_pixel),
        cmocka_unit_test(test_targets_keep_what_fits_into_them),
        cmocka_unit_test(test_heat_changes_nothing),
    };
    return cmocka_run_group_tests(manual, NULL, NULL) +
           cmocka_run_group_tests(tests, test_vulkan_setup, test_vulkan_teardown);
}
