/* SPDX-License-Identifier: MIT
 *
 * The non-physical controls of a fog in a scene file: read as written, refused with a way out, part
 * of the scene's identity if present, and the physical value of each.
 */
#include "tests/scene_builders.h"

#include "base/files.h"
#include "base/text.h"
#include "scenes/fog_translation.h"

static const char head[] =
    "name: probe\ntitle: a probe\nphysics: none\nscattering: single\n"
    "camera: {position_m: [0, 1, 50], look_at_m: [0, 1, 0], vertical_fov_deg: 40}\n"
    "sun: {direction: [0, 2, 0], irradiance_w_per_m2: [3, 2, 1]}\n";

static const char fog[] =
    "media: [{height_fog: {albedo: [1, 1, 1], layers: [{extinction_per_m: 0.01,\n"
    "  falloff_per_m: 0.1, height_m: 0}]}}]\n";

static enum neph_status load(const char *media, const char *keys, struct neph_scene **scene,
                             struct neph_diag *diag)
{
    char folder[] = "/tmp/neph-fog-look-XXXXXX";
    assert_non_null(mkdtemp(folder));
    char *path = neph_path_join(folder, "probe.yaml");
    char *text = neph_format("%s%s%s\n", head, media, keys);
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
    neph_assert_ok(load(fog, keys, &scene, &diag), &diag);
    return scene;
}

static void test_what_is_left_out_is_off(void **state)
{
    struct neph_scene *scene = loaded("fog_look: {inscattering_w_per_m2_sr: [1, 2, 3]}");
    assert_true(scene->fog_look.present && scene->fog_look.inscattering_w_per_m2_sr.b == 3.0);
    for (int c = 0; c < NEPH_FOG_CONTROL_COUNT; c++)
        assert_false(neph_fog_control_is_on(&scene->fog_look, (enum neph_fog_control)c));
    neph_scene_destroy(scene);
    scene = loaded("");
    assert_false(scene->fog_look.present);
    neph_scene_destroy(scene);
}

/* Each control by its key, and no other control with it. */
static void test_each_control_has_its_key(void **state)
{
    for (int c = 0; c < NEPH_FOG_CONTROL_COUNT; c++) {
        const struct neph_fog_control_row *row = &neph_fog_controls()[c];
        char *keys = neph_format("fog_look: {inscattering_w_per_m2_sr: [1, 2, 3], %s: %s}",
                                 row->key, row->count == 3 ? "[0, 0, 0.5]" : "0.5");
        struct neph_scene *scene = loaded(keys);
        for (int other = 0; other < NEPH_FOG_CONTROL_COUNT; other++)
            assert_int_equal(neph_fog_control_is_on(&scene->fog_look, (enum neph_fog_control)other),
                             other == c);
        neph_scene_destroy(scene);
        free(keys);
    }
}

static void assert_refused(const char *media, const char *keys, const char *words)
{
    struct neph_scene *scene = NULL;
    struct neph_diag diag = {.line = 0};
    assert_int_equal(load(media, keys, &scene, &diag), NEPH_ERR_INPUT);
    if (!strstr(diag.message, words))
        print_error("'%s' is not in: %s\n", words, diag.message);
    assert_non_null(strstr(diag.message, words));
    assert_true(diag.line > 0);
}

static void test_refusals(void **state)
{
    assert_refused("", "fog_look: {inscattering_w_per_m2_sr: [1, 1, 1]}", "the scene has 0");
    assert_refused(fog, "fog_look: {}", "inscattering_w_per_m2_sr");
    assert_refused(fog, "fog_look: {inscattering_w_per_m2_sr: [1, 1, 1], max_opacity: 1.5}", "1");
    assert_refused(fog,
                   "fog_look: {inscattering_w_per_m2_sr: [1, 1, 1], start_distance_m: 9,\n"
                   "  end_distance_m: 5}",
                   "the start of the fog, 9");
    assert_refused(fog,
                   "fog_look: {inscattering_w_per_m2_sr: [1, 1, 1], volumetric_fog_distance_m: 7,\n"
                   "  end_distance_m: 7}",
                   "the start of the fog, 7");
}

/* Isotropic scattering is E albedo / (4 pi); a lobe has the mean cosine and the energy of the phase
 * function. */
static void test_what_physics_has_for_a_look(void **state)
{
    struct neph_scene *scene = loaded("");
    struct neph_medium *medium = &scene->media[0];
    struct neph_fog_look look = neph_fog_look_of_physics(scene, medium);
    neph_assert_close(look.inscattering_w_per_m2_sr.g, 2.0 / (4.0 * M_PI), 1e-15, 0.0);
    assert_true(look.directional_w_per_m2_sr.g == 0.0);
    medium->phase = (struct neph_phase){NEPH_PHASE_HENYEY_GREENSTEIN, 0.8};
    look = neph_fog_look_of_physics(scene, medium);
    const double e = look.directional_exponent;
    neph_assert_close((e + 1.0) / (e + 2.0), 0.8, 1e-14, 0.0);
    neph_assert_close(look.directional_w_per_m2_sr.r * 2.0 * M_PI / (e + 1.0), 3.0, 1e-14, 0.0);
    assert_true(look.inscattering_w_per_m2_sr.r == 0.0);
    medium->albedo = make_grey(0.0);
    medium->emission_w_per_m2_sr = (struct neph_rgb){7, 8, 9};
    look = neph_fog_look_of_physics(scene, medium);
    assert_true(look.inscattering_w_per_m2_sr.b == 9.0 && look.directional_w_per_m2_sr.b == 0.0);
    neph_scene_destroy(scene);
}

static void assert_cannot(struct neph_scene *scene, enum neph_fog_model model, const char *words)
{
    char reason[256] = "";
    assert_false(neph_fog_look_is_of(scene, model, reason, sizeof(reason)));
    assert_non_null(strstr(reason, words));
}

static void test_what_a_look_does_not_know(void **state)
{
    char reason[256];
    struct neph_scene *scene = loaded("fog_look: {inscattering_w_per_m2_sr: [1, 2, 3]}");
    struct neph_medium *medium = &scene->media[0];
    assert_true(neph_fog_look_is_of(scene, NEPH_FOG_FILAMENT, reason, sizeof(reason)));
    scene->medium_count = 0; /* in a frame that shows the scene without media */
    assert_true(neph_fog_look_is_of(scene, NEPH_FOG_FILAMENT, reason, sizeof(reason)));
    scene->medium_count = 1;
    scene->light_count = 1;
    assert_cannot(scene, NEPH_FOG_UNREAL, "only the sun");
    scene->light_count = 0;
    medium->layers[medium->layer_count++] = medium->layers[0];
    assert_true(neph_fog_look_is_of(scene, NEPH_FOG_UNREAL, reason, sizeof(reason)));
    assert_cannot(scene, NEPH_FOG_FILAMENT, "second layer");
    medium->extinction_color.g = 0.5;
    assert_cannot(scene, NEPH_FOG_UNREAL, "one opacity");
    medium->bounds.min_m.x = -5.0;
    assert_cannot(scene, NEPH_FOG_UNREAL, "bounds");
    scene->media[scene->medium_count++] = *medium;
    assert_cannot(scene, NEPH_FOG_UNREAL, "beside");
    scene->medium_count--;
    scene->fog_look.present = false;
    assert_cannot(scene, NEPH_FOG_UNREAL, "without the key fog_look");
    neph_scene_destroy(scene);
}

#include "tests/main.h"
