/* SPDX-License-Identifier: MIT
 *
 * The fog study where its values have closed forms: glowing fog so thick that every direction is
 * opaque, or so thin that steps are isolated.
 */
#include "tests/scene_builders.h"

#include "harness/study/fog_study.h"

static struct neph_fog_study study;

/* Glowing fog, seen horizontally from a height of 10 m; the ground is a box. */
static void set_stage(struct test_scene *test, double extinction_per_m, double falloff_per_m)
{
    test_scene_init(test);
    test->scene.name = "probe";
    struct neph_medium *fog = test_add_medium(test, extinction_per_m, falloff_per_m, 0.0);
    fog->albedo = make_grey(0.0);
    fog->emission_w_per_m2_sr = white;
    test->scene.scattering = NEPH_SCATTERING_NONE;
    test->scene.background_w_per_m2_sr = make_grey(0.25);
    test->key.position_m = (struct neph_vec3){0, 10, 0};
    test->key.look_at_m = (struct neph_vec3){0, 10, -10};
    const struct neph_fog_look none = {
        .present = true, .inscattering_w_per_m2_sr = white, .directional_exponent = 3.0};
    test->scene.fog_look = neph_fog_look_only(&none, 0);
}

static void run(const struct test_scene *test)
{
    static struct neph_fog_study_params params;
    params = (struct neph_fog_study_params){
        .scene = &test->scene, .model = -1, .width_px = 12, .height_px = 8, .directions = 2048};
    struct neph_diag diag = {0};
    neph_assert_ok(neph_fog_study_run(&params, &study, &diag), &diag);
}

static const struct neph_fog_row *row(enum neph_fog_model model, const char *name)
{
    for (int i = 0; i < study.row_count; i++)
        if (study.rows[i].model == model && strcmp(study.rows[i].name, name) == 0)
            return &study.rows[i];
    print_error("no row '%s'\n", name);
    fail();
    return NULL;
}

/* Without controls the error is 0, and so it is with the physical parameters. */
static void test_what_is_physics_is_off_by_nothing(void **state)
{
    struct test_scene test;
    set_stage(&test, 0.01, 0.02);
    test_add_box(&test, (struct neph_vec3){-500, -1, -500}, (struct neph_vec3){500, 0, 500});
    run(&test);
    assert_int_equal(study.row_count, 2 * 4); /* none, all, and two with physical parameters */
    for (int i = 0; i < study.row_count; i++) {
        const struct neph_fog_row *off = &study.rows[i];
        const double seam = off->model == NEPH_FOG_FILAMENT ? 1e-3 : 1e-5;
        assert_true(off->transmittance_worst < seam && off->radiance_rms < seam);
        assert_true(fabs(off->fog_light) < seam && off->all_light_alone == 0.0);
        assert_true(isnan(off->lobe_over_sun));
    }
}

/* In fog that is opaque in all directions a glow of cos^e adds 1 / (2 (e + 1)) of its colour to the
 * mean over the sphere, an opacity of 3/4 leaves a quarter of the sky, and a cutoff the whole sky.
 */
static void test_energy_over_the_sphere(void **state)
{
    struct test_scene test;
    set_stage(&test, 20.0, 0.01);
    test.scene.fog_look.directional_w_per_m2_sr = make_grey(0.5);
    test.scene.fog_look.max_opacity = 0.75;
    test.scene.fog_look.cutoff_distance_m = 1e4;
    run(&test);
    neph_assert_close(study.exact_fog_light, 1.0, 1e-12, 0.0);
    for (int m = 0; m < NEPH_FOG_MODEL_COUNT; m++) {
        const enum neph_fog_model model = (enum neph_fog_model)m;
        const struct neph_fog_row *glow = row(model, "directional"),
                                  *held = row(model, "max_opacity"),
                                  *cut = row(model, "cutoff_distance");
        neph_assert_close(glow->fog_light_alone, 0.5 / 8.0, 2e-3, 0.0);
        neph_assert_close(held->fog_light, -0.25, 1e-12, 0.0);
        neph_assert_close(held->all_light, 0.25 * 0.25 - 0.25, 1e-12, 0.0);
        neph_assert_close(held->transmittance_bias, 0.25, 1e-12, 0.0);
        neph_assert_close(cut->fog_light, -1.0, 1e-12, 0.0);
        neph_assert_close(cut->all_light, 0.25 - 1.0, 1e-12, 0.0);
        neph_assert_close(cut->radiance_bias, 0.25 - 1.0, 1e-12, 0.0);
    }
}

/* Nearly constant fog: a cutoff at 300 m removes 1 - e^-0.3 of fog in every direction. */
static void test_a_jump_is_found_where_it_is(void **state)
{
    struct test_scene test;
    set_stage(&test, 1e-3, 1e-9);
    test.scene.fog_look.cutoff_distance_m = 300.0;
    test.scene.fog_look.max_opacity = 0.9;
    run(&test);
    const struct neph_fog_row *cut = row(NEPH_FOG_UNREAL, "cutoff_distance");
    neph_assert_close(cut->transmittance_jump, 1.0 - exp(-0.3), 1e-6, 0.0);
    neph_assert_close(cut->transmittance_jump_m, 300.0, 1e-9, 0.0);
    neph_assert_close(cut->light_jump, 1.0 - exp(-0.3), 1e-6, 0.0);
    assert_true(row(NEPH_FOG_UNREAL, "max_opacity")->transmittance_jump < 1e-12);
}

/* The step at the series' switch distance, of known size: Filament's mean lacks half of its
 * exponent, Unreal's a sixth of its square. */
static void test_the_seam_of_a_series_is_found(void **state)
{
    const double shares[] = {pow(0.01 * M_LN2, 2.0) / 6.0, 0.5 * 0.00125};
    struct test_scene test;
    set_stage(&test, 1e-3, 1e-2);
    run(&test);
    for (int m = 0; m < NEPH_FOG_MODEL_COUNT; m++) {
        const struct neph_fog_row *none = row((enum neph_fog_model)m, "none");
        const double depth = 1e-3 * exp(-0.1) * none->transmittance_jump_m;
        neph_assert_close(none->transmittance_jump, exp(-depth) * depth * shares[m], 0.02, 0.0);
        assert_true(depth > 0.02 && depth < 40.0);
    }
}

/* A lobe of 1 integrates to E albedo over the sphere. */
static void test_a_lobe_beside_the_suns_light(void **state)
{
    struct test_scene test;
    set_stage(&test, 0.01, 0.02);
    struct neph_medium *fog = &test.scene.media[0];
    test.scene.scattering = NEPH_SCATTERING_SINGLE;
    fog->emission_w_per_m2_sr = make_grey(0.0);
    fog->albedo = make_grey(0.5);
    fog->phase = (struct neph_phase){NEPH_PHASE_HENYEY_GREENSTEIN, 0.75};
    test.scene.fog_look.directional_w_per_m2_sr = make_grey(9.0); /* the sun has 10, 9, 8 */
    run(&test);
    neph_assert_close(row(NEPH_FOG_UNREAL, "directional")->lobe_over_sun, 2.0 * 2.0 * M_PI / 4.0,
                      1e-12, 0.0);
    neph_assert_close(row(NEPH_FOG_UNREAL, "of physics")->lobe_over_sun, 1.0, 1e-12, 0.0);
}

/* Fog that starts later, with physical fog before it, has an error only from the part behind. */
static void test_near_fog_by_physics(void **state)
{
    struct test_scene test;
    set_stage(&test, 0.01, 0.02);
    test.scene.fog_look.volumetric_fog_distance_m = 30.0;
    run(&test);
    const struct neph_fog_row *left = row(NEPH_FOG_UNREAL, "volumetric_fog_distance"),
                              *mended = row(NEPH_FOG_UNREAL, "the same, near fog by physics");
    assert_true(left->transmittance_worst > 0.05 && left->fog_light < -0.05);
    assert_true(mended->transmittance_worst < 1e-5 && fabs(mended->fog_light) < 1e-5);
}

static void test_refusals(void **state)
{
    struct test_scene test;
    set_stage(&test, 0.01, 0.02);
    struct neph_diag diag = {0};
    const struct neph_fog_study_params params = {
        .scene = &test.scene, .width_px = 4, .height_px = 4, .directions = 16};
    test.scene.scattering = NEPH_SCATTERING_MULTIPLE;
    test.scene.media[0].albedo = make_grey(0.5);
    assert_int_equal(neph_fog_study_run(&params, &study, &diag), NEPH_ERR_UNSUPPORTED);
    assert_non_null(strstr(diag.message, "exact cannot"));
    test.scene.fog_look.present = false;
    assert_int_equal(neph_fog_study_run(&params, &study, &diag), NEPH_ERR_UNSUPPORTED);
    assert_non_null(strstr(diag.message, "without the key fog_look"));
}

#include "tests/main.h"
