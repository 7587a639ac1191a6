/* SPDX-License-Identifier: MIT
 *
 * Values that are injected into a running renderer: read as written, found at their frame,
 * described in words, and not a part of the scene's identity.
 */
#include "tests/neph_test.h"

#include "base/files.h"
#include "base/text.h"
#include "scenes/injection.h"
#include "scenes/scene.h"

static const char head[] =
    "name: probe\ntitle: a probe\nphysics: none\nscattering: single\n"
    "camera: {position_m: [0, 1, 50], look_at_m: [0, 1, 0], vertical_fov_deg: 40}\n"
    "sun: {direction: [0, 2, 0], irradiance_w_per_m2: [3, 3, 3]}\n";

static enum neph_status load(const char *keys, struct neph_scene **scene, struct neph_diag *diag)
{
    char folder[] = "/tmp/neph-injection-XXXXXX";
    assert_non_null(mkdtemp(folder));
    char *path = neph_path_join(folder, "probe.yaml"), *text = neph_format("%s%s", head, keys);
    assert_int_equal(neph_file_write(path, text, strlen(text), NULL), NEPH_OK);
    const enum neph_status status = neph_scene_load(path, scene, diag);
    free(text);
    free(path);
    neph_dir_remove(folder, NULL);
    return status;
}

static struct neph_scene *loaded(const char *keys)
{
    struct neph_scene *scene = NULL;
    struct neph_diag diag = {.line = 0};
    neph_assert_ok(load(keys, &scene, &diag), &diag);
    return scene;
}

static void test_each_is_found_at_its_picture(void **state)
{
    struct neph_scene *scene = loaded(
        "inject:\n"
        "  history: [{frame: 3, value: garbage, first: true}, {frame: 5, value: huge}]\n"
        "  rays: [{frame: 4, count: 7, value: negative}]\n"
        "  sizes: [{frame: 9, scale: 0.5}]\n"
        "  view: {left_px: 8, bottom_px: 3, value: nan}\n"
        "  mirror: {frame: 2, count: 3, height_m: 1.5}\n"
        "  origin: [{frame: 6, by_m: [1, 2, 3]}, {frame: 8, by_m: [0, 0, 4]}]\n"
        "  exposures: [{frame: 5, factor: 8}, {frame: 7, factor: 0.5}]\n");
    const struct neph_injections *all = neph_scene_injections(scene);
    for (int frame = -2; frame < 12; frame++) {
        assert_int_equal(neph_injected_history_at(all, frame) != NULL, frame == 3 || frame == 5);
        assert_int_equal(neph_injected_rays_at(all, frame) != NULL, frame == 4);
        assert_int_equal(neph_injected_size_at(all, frame) != NULL, frame == 9);
        assert_int_equal(neph_injected_mirror_at(all, frame), frame >= 2 && frame < 5);
        const struct neph_vec3 by_m = neph_injected_origin_at(all, frame);
        assert_true(neph_injected_exposure_at(all, frame) == (frame < 5   ? 1.0
                                                              : frame < 7 ? 8.0
                                                                          : 0.5));
        assert_true(by_m.x == (frame == 6 || frame == 7 ? 1.0 : 0.0));
        assert_true(by_m.z == (frame < 6 ? 0.0 : frame < 8 ? 3.0 : 4.0));
    }
    assert_true(neph_injected_history_at(all, 3)->first);
    assert_false(neph_injected_history_at(all, 5)->first);
    assert_int_equal(neph_injected_rays_at(all, 4)->count, 7);
    assert_int_equal(neph_injected_rays_at(all, 4)->value, NEPH_INJECTED_NEGATIVE);
    char *text = neph_injections_text(all);
    assert_string_equal(text, "history garbage as if first at 3, history huge at 5, rays 7 "
                              "negative at 4, size by 0.5 at 9, origin by 1 2 3 m at 6, origin by "
                              "0 0 4 m at 8, exposure by 8 at 5, exposure by 0.5 at 7, view "
                              "within 8 0 0 3 px of nan, mirror at 1.5 m in 3 from 2");
    free(text);
    neph_scene_destroy(scene);
}

/* Injected values do not change the scene's identity: the truth stays in the store. */
static void test_the_scene_stays_what_it_is(void **state)
{
    static const char *const one_each[] = {
        "history: [{frame: 3, value: nan}]",     "history: [{frame: 3, value: huge}]",
        "history: [{frame: 4, value: nan}]",     "history: [{frame: 3, value: nan, first: true}]",
        "rays: [{frame: 3, value: nan}]",        "rays: [{frame: 3, count: 2, value: nan}]",
        "view: {top_px: 4, value: nan}",         "view: {bottom_px: 4, value: nan}",
        "view: {bottom_px: 4, value: black}",    "mirror: {count: 3, height_m: 1}",
        "mirror: {count: 4, height_m: 1}",       "mirror: {frame: 1, count: 3, height_m: 1}",
        "sizes: [{frame: 3, scale: 2}]",         "sizes: [{frame: 3, scale: 0.3333333333333333}]",
        "origin: [{frame: 3, by_m: [0, 0, 1]}]", "origin: [{frame: 3, by_m: [1e-17, 0, 1]}]",
        "exposures: [{frame: 3, factor: 8}]",    "exposures: [{frame: 4, factor: 8}]",
    };
    struct neph_scene *plain = loaded("");
    char *texts[COUNT(one_each)];
    char *none = neph_injections_text(neph_scene_injections(plain));
    assert_string_equal(none, "");
    free(none);
    for (size_t i = 0; i < COUNT(one_each); i++) {
        char *keys = neph_format("inject: {%s}\n", one_each[i]);
        struct neph_scene *scene = loaded(keys);
        assert_string_equal(scene->hash, plain->hash);
        texts[i] = neph_injections_text(neph_scene_injections(scene));
        for (size_t k = 0; k < i; k++)
            assert_string_not_equal(texts[i], texts[k]);
        neph_scene_destroy(scene);
        free(keys);
    }
    for (size_t i = 0; i < COUNT(one_each); i++)
        free(texts[i]);
    neph_scene_destroy(plain);
}

static void test_what_cannot_be_is_refused(void **state)
{
    static const struct {
        const char *keys, *message;
    } cases[] = {
        {"inject: {view: {left_px: 6, value: nan}}\n", "no multiple of 4"},
        {"inject: {view: {value: nan}}\n", "give a margin"},
        {"inject: {history: [{frame: 2, value: inf}]}\n", "one of nan, infinite"},
        {"inject: {rays: [{frame: 2, value: nan}, {frame: 2, value: nan}]}\n", "not above"},
        {"inject: {origin: [{frame: 2, by_m: [1, 0, 0]}]}\n"
         "media: [{horizon: {extinction_per_m: 0.1, albedo: [1, 1, 1],\n"
         "         bounds: {min_m: [-9, 0, -9], max_m: [9, 9, 9]}}}]\n",
         "has a fixed place"},
        {"frames: {advance: [1], pauses: [{frame: 1, count: 1}]}\n", "either advance"},
        {"solids: [{box: {min_m: [0, 0, 0], max_m: [1, 1, 1], albedo: [0, 0, 0],\n"
         "         motion: {axis: w, keys: [{frame: 0}]}}}]\n",
         "one of x, y, z"},
        {"frames: {count: 4}\n" /* the camera is at z = 50 */
         "solids: [{sphere: {center_m: [0, 1, 0], radius_m: 1, albedo: [0, 0, 0],\n"
         "         motion: {keys: [{frame: 0}, {frame: 2, move_m: [0, 0, 50]}]}}}]\n",
         "inside a solid"},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct neph_scene *scene = NULL;
        struct neph_diag diag = {.line = 0};
        assert_int_equal(load(cases[i].keys, &scene, &diag), NEPH_ERR_INPUT);
        if (!strstr(diag.message, cases[i].message))
            print_error("%s\n", diag.message);
        assert_non_null(strstr(diag.message, cases[i].message));
        assert_true(diag.line > 0);
    }
}

#include "tests/main.h"
