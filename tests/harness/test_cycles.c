/* SPDX-License-Identifier: MIT
 *
 * The Cycles engine: its input for Blender and, where Blender is installed, its frames against
 * closed forms. Frames without noise (transmittance, depth, lit solids) have the tolerance of
 * single precision or of the step. Frames with noise are judged by the mean over the image, where
 * 512 paths per pixel leave about 3e-4.
 */
#include "tests/harness/engine_test.h"
#include "tests/scene_builders.h"

#include "base/files.h"
#include "harness/engines/cycles_spec.h"
#include "harness/engines/engines.h"
#include "scenes/media.h"
#include "scenes/solids.h"
#include "truth/transport.h"

#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

enum { WIDTH = 32, HEIGHT = 18, PIXELS = WIDTH * HEIGHT };

static const char *const colors[3] = {"R", "G", "B"};
static const char *const volume_colors[3] = {"volume.R", "volume.G", "volume.B"};

/* A name with an effect if any part of it were executed. */
static const char hostile_name[] = "\"; import os; os.system('touch /tmp/neph_pwned') # $(touch "
                                   "/tmp/neph_pwned) \\\n%s";
static const char pwned_path[] = "/tmp/neph_pwned";

/* ---- scenes in memory ------------------------------------------------------------------------ */

struct stage {
    struct neph_scene scene;
    struct neph_camera_key key;
    struct neph_solid solids[4];
    int samples; /* 0: the default */
    double step; /* 0: the default */
    int threads;
    uint64_t seed;
};

/* A camera, a coloured sun, no media, no solids, black sky, single scattering. */
static void set_stage(struct stage *stage, struct neph_vec3 eye, struct neph_vec3 look_at)
{
    memset(stage, 0, sizeof(*stage));
    stage->key = (struct neph_camera_key){.position_m = eye, .look_at_m = look_at};
    stage->seed = 1;
    stage->scene = (struct neph_scene){
        .name = hostile_name,
        .camera_key_count = 1,
        .camera_keys = &stage->key,
        .camera_up = {0.0, 1.0, 0.0},
        .vertical_fov_rad = 0.7,
        .frame_count = 1,
        .frame_rate_hz = 25.0,
        .sun = {true, neph_vec3_normalize((struct neph_vec3){0.48, 0.6, 0.64}), {2.0, 1.0, 4.0}},
        .scattering = NEPH_SCATTERING_SINGLE,
        .solids = stage->solids,
    };
}

static struct neph_medium *add_medium(struct stage *stage, struct neph_bounds bounds,
                                      double extinction_per_m, double falloff_per_m)
{
    struct neph_medium *medium = &stage->scene.media[stage->scene.medium_count++];
    *medium = (struct neph_medium){
        .kind = falloff_per_m > 0.0 ? NEPH_MEDIUM_HEIGHT_FOG : NEPH_MEDIUM_HOMOGENEOUS,
        .bounds = bounds,
        .albedo = {0.9, 0.5, 0.2},
        .layer_count = 1,
        .extinction_color = {1, 1, 1},
        .layers = {{extinction_per_m, falloff_per_m, 0.0}},
    };
    return medium;
}

static void add_box(struct stage *stage, struct neph_bounds box, struct neph_rgb albedo)
{
    stage->solids[stage->scene.solid_count++] = (struct neph_solid){
        .kind = NEPH_SOLID_BOX, .box = box, .albedo = albedo};
}

static void add_sphere(struct stage *stage, struct neph_vec3 center_m, double radius_m,
                       struct neph_rgb albedo)
{
    stage->solids[stage->scene.solid_count++] = (struct neph_solid){
        .kind = NEPH_SOLID_SPHERE, .center_m = center_m, .radius_m = radius_m, .albedo = albedo};
}

/* A camera before a homogeneous box of 6 x 4 x 7 m. */
static struct neph_medium *set_box_stage(struct stage *stage, double extinction_per_m)
{
    set_stage(stage, (struct neph_vec3){0.0, 2.0, 5.0}, (struct neph_vec3){0.0, 2.0, 0.0});
    return add_medium(stage, (struct neph_bounds){{-3.0, 0.0, -8.0}, {3.0, 4.0, -1.0}},
                      extinction_per_m, 0.0);
}

/* Ground, a post and a sphere in the thin fog of a box, before a grey sky. */
static void set_full_stage(struct stage *stage)
{
    set_stage(stage, (struct neph_vec3){0.3, 1.5, 6.0}, (struct neph_vec3){0.0, 0.8, 0.0});
    struct neph_medium *medium = add_medium(
        stage, (struct neph_bounds){{-8.0, -1.0, -9.0}, {8.0, 4.0, 7.0}}, 0.06, 0.0);
    medium->phase = (struct neph_phase){NEPH_PHASE_HENYEY_GREENSTEIN, 0.4};
    stage->scene.background_w_per_m2_sr = (struct neph_rgb){0.1, 0.2, 0.3};
    add_box(stage, (struct neph_bounds){{-20.0, -2.0, -20.0}, {20.0, 0.0, 8.0}}, make_grey(0.5));
    add_box(stage, (struct neph_bounds){{-1.5, 0.0, -1.0}, {-1.2, 2.0, -0.7}},
            (struct neph_rgb){0.8, 0.4, 0.2});
    add_sphere(stage, (struct neph_vec3){0.8, 0.8, -1.0}, 0.8, make_grey(0.7));
}

/* ---- rendering ------------------------------------------------------------------------------- */

static struct neph_shot make_shot(const struct stage *stage, unsigned layers)
{
    struct neph_shot shot = {
        .scene = &stage->scene,
        .settings = neph_settings_default(&neph_engine_cycles),
        .width_px = WIDTH,
        .height_px = HEIGHT,
        .layers = layers,
        .seed = stage->seed,
        .time_limit_s = 300.0,
    };
    if (stage->samples > 0)
        shot.settings.values[0] = stage->samples;
    if (stage->step > 0.0)
        shot.settings.values[1] = stage->step;
    shot.settings.values[2] = stage->threads;
    return shot;
}

static struct neph_image *render(const struct stage *stage, unsigned layers)
{
    struct neph_diag diag = {0};
    struct neph_cost cost = {0};
    struct neph_image *frame = NULL;
    struct neph_shot shot = make_shot(stage, layers);
    neph_assert_ok(test_render(&neph_engine_cycles, &shot, &frame, &cost, &diag), &diag);
    print_message("  %.2f s render, %.2f s wall, %.2f s cpu, %.0f MiB\n", cost.render_s,
                  cost.wall_s, cost.cpu_s, (double)cost.peak_memory_bytes / 1048576.0);
    assert_true(cost.wall_s > cost.render_s);
    assert_true(cost.peak_memory_bytes > 1 << 20);
    return frame;
}

static struct neph_pixel_ray make_pixel_ray(const struct stage *stage, int pixel)
{
    const struct neph_camera camera = neph_scene_camera(&stage->scene, 0.0);
    return neph_camera_ray(&camera, WIDTH, HEIGHT, pixel % WIDTH, pixel / WIDTH);
}

static struct neph_ray_light trace_pixel(const struct stage *stage, int pixel)
{
    const struct neph_pixel_ray ray = make_pixel_ray(stage, pixel);
    return neph_transport_ray(&stage->scene, ray.origin_m, ray.direction);
}

static double component(struct neph_rgb color, int channel)
{
    return channel == 0 ? color.r : channel == 1 ? color.g : color.b;
}

static double average_channel(const struct neph_image *frame, const char *channel)
{
    const float *samples = neph_image_channel(frame, channel);
    assert_non_null(samples);
    double sum = 0.0;
    for (int i = 0; i < PIXELS; i++)
        sum += samples[i];
    return sum / PIXELS;
}

static double truth_mean(const struct stage *stage, bool volume_only, int channel)
{
    double sum = 0.0;
    for (int i = 0; i < PIXELS; i++) {
        const struct neph_ray_light light = trace_pixel(stage, i);
        sum += component(volume_only ? light.volume : light.radiance, channel);
    }
    return sum / PIXELS;
}

/* ---- without Blender ------------------------------------------------------------------------- */

static void test_probe_without_blender(void **state)
{
    const struct neph_engine_info info = test_probe_without_path(&neph_engine_cycles);
    assert_false(info.available);
    assert_non_null(strstr(info.missing, "blender"));
    assert_string_equal(info.install_line, "apt-get install blender python3-numpy");
}

static void test_probe_refuses_an_old_version(void **state)
{
    const struct neph_engine_info info = test_probe_impostor(&neph_engine_cycles, "blender",
                                                             "#!/bin/sh\necho 'Blender 3.3.1'\n");
    assert_false(info.available);
    assert_non_null(strstr(info.missing, "is Blender 3.3.1; versions from 3.4 on are taken"));
}

static void assert_cannot(const struct stage *stage, const char *word)
{
    char reason[256] = "";
    assert_false(test_can_render(&neph_engine_cycles, &stage->scene, reason, sizeof(reason)));
    if (!strstr(reason, word))
        fail_msg("'%s' does not say '%s'", reason, word);
}

static void test_supported_scenes(void **state)
{
    char reason[256] = "";
    struct stage stage;
    struct neph_medium *medium = set_box_stage(&stage, 0.3);
    stage.scene.environment_light = true;
    stage.scene.scattering = NEPH_SCATTERING_MULTIPLE;
    assert_true(test_can_render(&neph_engine_cycles, &stage.scene, reason, sizeof(reason)));
    medium->phase = (struct neph_phase){NEPH_PHASE_HENYEY_GREENSTEIN, 0.85};
    assert_true(test_can_render(&neph_engine_cycles, &stage.scene, reason, sizeof(reason)));
    medium->phase = (struct neph_phase){NEPH_PHASE_ISOTROPIC, 0.0};
    add_medium(&stage, medium->bounds, 1e-8, 0.0);
    assert_cannot(&stage, "1e6");
    stage.scene.vertical_fov_rad = 3.1;
    assert_cannot(&stage, "field of view");
    set_box_stage(&stage, 1e12); /* a millionth of a micrometre: the box ends beyond 1e9 units */
    assert_cannot(&stage, "clips");
}

static void test_tiny_frames_are_refused(void **state)
{
    struct neph_diag diag = {0};
    struct neph_cost cost;
    struct neph_image *frame = NULL;
    struct stage stage;
    set_box_stage(&stage, 0.3);
    struct neph_shot shot = make_shot(&stage, NEPH_LAYER_DEPTH);
    shot.height_px = 3;
    shot.scratch_directory = "/nonexistent";
    assert_int_equal(neph_engine_cycles.render(&shot, &frame, &cost, &diag), NEPH_ERR_UNSUPPORTED);
    assert_non_null(strstr(diag.message, "32 x 3"));
    assert_null(frame);
}

static enum neph_status make_cycles_spec(const struct stage *stage, json_t **spec,
                                         double *sphere_error_px)
{
    struct neph_diag diag = {0};
    struct neph_cycles_world world;
    const struct neph_cycles_quality quality = {.samples = 4, .step = 0.2, .threads = 1};
    const struct neph_shot shot = make_shot(stage, NEPH_LAYERS_ALL);
    neph_assert_ok(neph_cycles_world(&stage->scene, &world, &diag), &diag);
    return neph_cycles_spec(&shot, &world, &quality, spec, sphere_error_px, &diag);
}

static void test_spec_is_data(void **state)
{
    json_t *spec = NULL;
    double error_px = 0.0;
    struct stage stage;
    set_full_stage(&stage);
    assert_int_equal(make_cycles_spec(&stage, &spec, &error_px), NEPH_OK);
    assert_string_equal(json_string_value(json_object_get(spec, "scene")), hostile_name);
    assert_int_equal(json_array_size(json_object_get(spec, "solids")), 3);
    assert_int_equal(json_array_size(json_object_get(spec, "passes")), 3);
    /* optical depth of at most 10 per unit */
    neph_assert_close(json_real_value(json_object_get(spec, "unit_m")), 10.0 / 0.06, 1e-15, 0.0);
    assert_true(error_px > 0.0 && error_px <= 0.01);
    json_decref(spec);
}

static const char *pass_kind(const json_t *spec, size_t index)
{
    const json_t *pass = json_array_get(json_object_get(spec, "passes"), index);
    return json_string_value(json_object_get(pass, "kind"));
}

/* Emission gets an image of its own unless one image has all orders; no image without emission. */
static void test_spec_of_emission(void **state)
{
    json_t *spec = NULL;
    double error_px = 0.0;
    struct stage stage;
    set_full_stage(&stage);
    stage.scene.media[0].emission_w_per_m2_sr = make_grey(4.0);
    assert_int_equal(make_cycles_spec(&stage, &spec, &error_px), NEPH_OK);
    const json_t *medium = json_array_get(json_object_get(spec, "media"), 0);
    const json_t *glow = json_object_get(medium, "glow_w_per_m2_sr");
    for (size_t j = 0; j < 3; j++) /* albedos 0.9, 0.5, 0.2 */
        neph_assert_close(json_real_value(json_array_get(glow, j)),
                          4.0 * (1.0 - (const double[]){0.9, 0.5, 0.2}[j]), 1e-15, 0.0);
    assert_int_equal(json_array_size(json_object_get(spec, "passes")), 4);
    assert_string_equal(pass_kind(spec, 1), "emission");
    json_decref(spec);
    stage.scene.scattering = NEPH_SCATTERING_MULTIPLE;
    assert_int_equal(make_cycles_spec(&stage, &spec, &error_px), NEPH_OK);
    assert_int_equal(json_array_size(json_object_get(spec, "passes")), 3);
    json_decref(spec);
    stage.scene.media[0].emission_w_per_m2_sr = make_grey(0.0);
    assert_int_equal(make_cycles_spec(&stage, &spec, &error_px), NEPH_OK);
    medium = json_array_get(json_object_get(spec, "media"), 0);
    assert_null(json_object_get(medium, "glow_w_per_m2_sr"));
    json_decref(spec);
}

/* The nodes of each kind whose sum is its phase function; kinds without nodes are refused. */
static void test_spec_of_phases(void **state)
{
    static const struct {
        struct neph_phase phase;
        const char *lobes; /* NULL: refused */
    } cases[] = {
        {{.kind = NEPH_PHASE_ISOTROPIC},
         "[{'phase':'HENYEY_GREENSTEIN','share':1.0,'inputs':{'Anisotropy':0.0}}]"},
        {{.kind = NEPH_PHASE_HENYEY_GREENSTEIN, .g = -0.25},
         "[{'phase':'HENYEY_GREENSTEIN','share':1.0,'inputs':{'Anisotropy':-0.25}}]"},
        {{.kind = NEPH_PHASE_RAYLEIGH}, "[{'phase':'RAYLEIGH','share':1.0,'inputs':{}}]"},
        {{.kind = NEPH_PHASE_DOUBLE_HENYEY_GREENSTEIN,
          .g = 0.75,
          .second_g = -0.5,
          .first_share = 0.875},
         "[{'phase':'HENYEY_GREENSTEIN','share':0.875,'inputs':{'Anisotropy':0.75}},"
         "{'phase':'HENYEY_GREENSTEIN','share':0.125,'inputs':{'Anisotropy':-0.5}}]"},
        {{.kind = NEPH_PHASE_CORNETTE_SHANKS, .g = 0.5},
         "[{'phase':'DRAINE','share':1.0,'inputs':{'Anisotropy':0.5,'Alpha':1.0}}]"},
        {{.kind = NEPH_PHASE_DRAINE, .g = 0.5, .draine_alpha = 500.0},
         "[{'phase':'DRAINE','share':1.0,'inputs':{'Anisotropy':0.5,'Alpha':500.0}}]"},
        {{.kind = NEPH_PHASE_DRAINE, .g = 0.5, .draine_alpha = 501.0}, NULL},
        {{.kind = NEPH_PHASE_JENDERSIE_DEON, .droplet_diameter_um = 12.5},
         "[{'phase':'MIE','share':1.0,'inputs':{'Diameter':12.5}}]"},
        {{.kind = NEPH_PHASE_TABLE}, NULL},
        {{.kind = NEPH_PHASE_POVRAY_MIE_HAZY}, NULL},
        {{.kind = NEPH_PHASE_POVRAY_MIE_MURKY}, NULL},
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        struct stage stage;
        set_box_stage(&stage, 0.3)->phase = cases[i].phase;
        if (!cases[i].lobes) {
            assert_cannot(&stage, cases[i].phase.kind == NEPH_PHASE_DRAINE
                                      ? "draine with Alpha 501: Cycles takes 0 to 500"
                                      : neph_phase_words[cases[i].phase.kind]);
            continue;
        }
        char expected[256];
        snprintf(expected, sizeof(expected), "%s", cases[i].lobes);
        for (char *at = expected; *at; at++)
            *at = *at == '\'' ? '"' : *at;
        json_t *spec = NULL;
        double error_px = 0.0;
        assert_int_equal(make_cycles_spec(&stage, &spec, &error_px), NEPH_OK);
        const json_t *medium = json_array_get(json_object_get(spec, "media"), 0);
        char *lobes = json_dumps(json_object_get(medium, "lobes"), JSON_COMPACT);
        assert_string_equal(lobes, expected);
        free(lobes);
        json_decref(spec);
    }
}

static void test_spec_refuses_nan(void **state)
{
    json_t *spec = NULL;
    double error_px;
    struct stage stage;
    set_full_stage(&stage);
    stage.scene.sun.irradiance_w_per_m2.g = NAN;
    assert_int_equal(make_cycles_spec(&stage, &spec, &error_px), NEPH_ERR_UNSUPPORTED);
    set_full_stage(&stage);
    stage.solids[1].box.max_m.y = INFINITY;
    assert_int_equal(make_cycles_spec(&stage, &spec, &error_px), NEPH_ERR_UNSUPPORTED);
    set_full_stage(&stage);
    stage.scene.name = "\xff";
    assert_int_equal(make_cycles_spec(&stage, &spec, &error_px), NEPH_ERR_UNSUPPORTED);
    assert_null(spec);
}

/* ---- transmittance and depth: no noise ------------------------------------------------------- */

/* Largest absolute error, and largest relative error where the truth exceeds `floor`. */
static void transmittance_errors(const struct stage *stage, double floor, double *absolute,
                                 double *relative)
{
    struct neph_image *frame = render(stage, NEPH_LAYER_TRANSMITTANCE);
    const float *samples = neph_image_channel(frame, "transmittance.G");
    assert_non_null(samples);
    double thickest = 0.0;
    *absolute = *relative = 0.0;
    for (int i = 0; i < PIXELS; i++) {
        const struct neph_pixel_ray ray = make_pixel_ray(stage, i);
        const double tau =
            neph_scene_optical_depth(&stage->scene, ray.origin_m, ray.direction, 0.0, INFINITY).r;
        const double off = fabs(samples[i] - exp(-tau));
        *absolute = fmax(*absolute, off);
        if (exp(-tau) > floor) {
            *relative = fmax(*relative, off / exp(-tau));
            thickest = fmax(thickest, tau);
        }
    }
    print_message("  transmittance: worst %.2e; worst relative %.2e up to tau %.3f\n", *absolute,
                  *relative, thickest);
    assert_null(neph_image_channel(frame, "R"));
    assert_null(neph_image_channel(frame, "Z"));
    neph_image_destroy(frame);
}

/* Cycles ends a path whose throughput is below 1e-6. */
static void test_transmittance_of_parallel_rays_is_cut(void **state)
{
    struct stage stage;
    set_box_stage(&stage, 2.8);
    stage.key.position_m.y = 6.0;
    stage.scene.vertical_fov_rad = 0.0;
    stage.scene.orthographic_height_m = 5.0;
    struct neph_image *frame = render(&stage, NEPH_LAYER_TRANSMITTANCE);
    const float *samples = neph_image_channel(frame, "transmittance.R");
    int above = 0, below = 0;
    for (int i = 0; i < PIXELS; i++) {
        const struct neph_pixel_ray ray = make_pixel_ray(&stage, i);
        const double tau =
            neph_scene_optical_depth(&stage.scene, ray.origin_m, ray.direction, 0.0, INFINITY).r;
        if (tau < 13.7)
            neph_assert_close(samples[i], exp(-tau), 1e-4, 0.0);
        above += tau > 0.0 && tau < 13.7;
        if (tau < 13.9)
            continue;
        neph_assert_close(samples[i], 0.0, 0.0, exp(-13.8)); /* Blender 5 has no cut */
        below++;
    }
    print_message("  transmittance: %d pixels, %d cut\n", above, below);
    assert_true(above > 50 && below > 50);
    neph_image_destroy(frame);
}

static void test_transmittance_of_open_fog(void **state)
{
    const struct neph_bounds open = {{-INFINITY, -INFINITY, -INFINITY},
                                     {INFINITY, INFINITY, INFINITY}};
    double absolute, relative;
    struct stage stage; /* above two layers, with the horizon in view */
    set_stage(&stage, (struct neph_vec3){0.0, 150.0, 0.0}, (struct neph_vec3){0.0, 130.0, -100.0});
    struct neph_medium *medium = add_medium(&stage, open, 0.02, 0.01386);
    medium->layer_count = 2;
    medium->layers[1] = (struct neph_fog_layer){0.004, 0.005, -50.0};
    transmittance_errors(&stage, 1e-2, &absolute, &relative);
    assert_true(absolute < 2e-4);
}

static void test_depth_behind_media(void **state)
{
    struct stage stage;
    set_full_stage(&stage);
    stage.scene.media[0].layers[0].extinction_per_m = 30.0; /* opaque, but depth ignores media */
    struct neph_image *frame = render(&stage, NEPH_LAYER_DEPTH);
    const struct neph_camera camera = neph_scene_camera(&stage.scene, 0.0);
    const float *depth_m = neph_image_channel(frame, "Z");
    assert_non_null(depth_m);
    int sky = 0;
    for (int i = 0; i < PIXELS; i++) {
        const struct neph_pixel_ray ray = make_pixel_ray(&stage, i);
        const struct neph_ray_light truth = trace_pixel(&stage, i);
        const double expected_m = truth.hit_m * neph_vec3_dot(ray.direction, camera.forward);
        /* The mesh deviates from the sphere by 1.2e-4 m, more along a grazing ray. */
        const struct neph_hit hit = neph_scene_hit(&stage.scene, ray.origin_m, ray.direction);
        const bool curved = hit.solid && hit.solid->kind == NEPH_SOLID_SPHERE;
        const double grazing = curved ? -neph_vec3_dot(hit.normal, ray.direction) : 1.0;
        sky += isinf(expected_m) != 0;
        neph_assert_close(depth_m[i], expected_m, 1e-5, curved ? 1.2e-4 / grazing : 0.0);
    }
    assert_true(sky > 10 && sky < PIXELS - 10);
    neph_image_destroy(frame);
}

/* ---- radiance -------------------------------------------------------------------------------- */

/* The mean of the in-scattered light over the image, per colour, within `relative` of the truth. */
static void check_single_scattering(const struct stage *stage, double relative)
{
    struct neph_image *frame = render(stage, NEPH_LAYER_RADIANCE);
    for (int channel = 0; channel < 3; channel++) {
        const double measured = average_channel(frame, volume_colors[channel]);
        const double truth = truth_mean(stage, true, channel);
        print_message("  %s mean %.6g, off by %+.2e\n", volume_colors[channel], truth,
                      measured / truth - 1.0);
        neph_assert_close(measured, truth, relative, 0.0);
        /* black sky and no solids: no other light */
        neph_assert_close(average_channel(frame, colors[channel]), measured, 1e-6, 0.0);
    }
    neph_image_destroy(frame);
}

/* An extinction of 1e-7/m is below the coefficient that Cycles drops, unless the unit is chosen
 * well. */
static void test_single_scattering_in_thin_air(void **state)
{
    struct stage stage;
    set_stage(&stage, (struct neph_vec3){0.0, 10.0, 0.0}, (struct neph_vec3){0.0, 10.0, -10.0});
    add_medium(&stage, (struct neph_bounds){{-4e5, -4e5, -8e5}, {4e5, 4e5, 5.0}}, 1e-7, 0.0);
    stage.samples = 512;
    check_single_scattering(&stage, 1e-3);
}

static void test_single_scattering_in_height_fog(void **state)
{
    struct stage stage;
    set_stage(&stage, (struct neph_vec3){0.0, 40.0, 0.0}, (struct neph_vec3){0.0, 35.0, -100.0});
    struct neph_medium *medium = add_medium(
        &stage, (struct neph_bounds){{-3000.0, -50.0, -3000.0}, {3000.0, 900.0, 3000.0}}, 0.01,
        0.01386);
    medium->phase = (struct neph_phase){NEPH_PHASE_HENYEY_GREENSTEIN, 0.6};
    stage.samples = 128; /* twice the noise of 512 */
    check_single_scattering(&stage, 2e-3);
}

/* The mean light of the full stage; 3e-3: shadow edges, noise. */
static void check_full_stage(struct stage *stage)
{
    stage->samples = 512;
    struct neph_image *frame = render(stage, NEPH_LAYERS_ALL);
    for (int channel = 0; channel < 3; channel++) {
        const double truth = truth_mean(stage, false, channel);
        const double measured = average_channel(frame, colors[channel]);
        print_message("  %s mean %.6g, off by %+.2e\n", colors[channel], truth,
                      measured / truth - 1.0);
        neph_assert_close(measured, truth, 3e-3, 0.0);
        neph_assert_close(average_channel(frame, volume_colors[channel]),
                          truth_mean(stage, true, channel), 3e-3, 0.0);
    }
    neph_image_destroy(frame);
}

/* Strong forward scattering. All other light comes straight from the sky: R - volume is T times the
 * background. */
static void test_single_scattering_in_a_box(void **state)
{
    struct stage stage;
    struct neph_medium *medium = set_box_stage(&stage, 0.3);
    medium->phase = (struct neph_phase){NEPH_PHASE_HENYEY_GREENSTEIN, 0.85};
    stage.scene.background_w_per_m2_sr = (struct neph_rgb){1.0, 2.0, 0.5};
    stage.samples = 512;
    struct neph_image *frame = render(&stage, NEPH_LAYER_RADIANCE | NEPH_LAYER_TRANSMITTANCE);
    const double transmittance = average_channel(frame, "transmittance.R");
    for (int channel = 0; channel < 3; channel++) {
        const double volume = average_channel(frame, volume_colors[channel]);
        neph_assert_close(volume, truth_mean(&stage, true, channel), 1e-3, 0.0);
        neph_assert_close(average_channel(frame, colors[channel]) - volume,
                          transmittance * component(stage.scene.background_w_per_m2_sr, channel),
                          1e-3, 0.0);
    }
    neph_image_destroy(frame);
}

/* Solids lit through an absorbing medium by a coloured sun, without noise: Lambert's law. */
static void test_no_scattering(void **state)
{
    struct stage stage;
    set_stage(&stage, (struct neph_vec3){0.0, 3.0, 6.0}, (struct neph_vec3){0.0, 0.0, 0.0});
    add_medium(&stage, (struct neph_bounds){{-8.0, -1.0, -9.0}, {8.0, 4.0, 7.0}}, 0.1, 0.0);
    add_box(&stage, (struct neph_bounds){{-50.0, -2.0, -50.0}, {50.0, 0.0, 20.0}},
            (struct neph_rgb){0.8, 0.4, 0.2});
    stage.scene.scattering = NEPH_SCATTERING_NONE;
    stage.scene.background_w_per_m2_sr = make_grey(0.25);
    stage.samples = 1;
    struct neph_image *frame = render(&stage, NEPH_LAYER_RADIANCE);
    for (int channel = 0; channel < 3; channel++) {
        const float *samples = neph_image_channel(frame, colors[channel]);
        for (int i = 0; i < PIXELS; i++)
            neph_assert_close(samples[i], component(trace_pixel(&stage, i).radiance, channel), 1e-4,
                              0.0);
        assert_true(average_channel(frame, volume_colors[channel]) == 0.0);
    }
    neph_image_destroy(frame);
}

/* A box of medium and a white ball, lit from all directions by radiance 1. */
static struct neph_medium *set_furnace(struct stage *stage, double ball_z_m)
{
    struct neph_medium *medium = set_box_stage(stage, 2.0);
    add_sphere(stage, (struct neph_vec3){0.0, 2.0, ball_z_m}, 1.0, make_grey(1.0));
    stage->scene.sun.present = false;
    stage->scene.background_w_per_m2_sr = make_grey(1.0);
    stage->scene.environment_light = true;
    stage->scene.scattering = NEPH_SCATTERING_MULTIPLE;
    stage->samples = 64;
    return medium;
}

/* Lit from all directions by radiance 1, without absorption. */
static void test_white_furnace(void **state)
{
    struct stage stage;
    set_furnace(&stage, -4.0)->albedo = make_grey(1.0);
    struct neph_image *frame = render(&stage, NEPH_LAYER_RADIANCE);
    const double mean = average_channel(frame, "G");
    print_message("  furnace %.6f\n", mean);
    neph_assert_close(mean, 1.0, 2e-3, 0.0);
    neph_image_destroy(frame);
}

/* ---- emission -------------------------------------------------------------------------------- */

/* Direct emission only. The noise is single precision, 1e-5 of the value. Faces at 13 m are known
 * to 1e-6 m, which emit less than 5e-6 W m^-2 sr^-1. Coloured extinction takes three images. */
static void test_emission_of_a_box(void **state)
{
    struct stage stage;
    struct neph_medium *medium = set_box_stage(&stage, 0.3);
    medium->emission_w_per_m2_sr = (struct neph_rgb){1, 2, 3};
    medium->extinction_color = (struct neph_rgb){0.3, 1, 4};
    stage.scene.scattering = NEPH_SCATTERING_NONE;
    stage.samples = 1;
    struct neph_image *frame = render(&stage, NEPH_LAYER_RADIANCE);
    for (int channel = 0; channel < 3; channel++)
        for (int i = 0; i < PIXELS; i++) {
            const double truth = component(trace_pixel(&stage, i).radiance, channel);
            neph_assert_close(neph_image_channel(frame, colors[channel])[i], truth, 1e-5, 5e-6);
            neph_assert_close(neph_image_channel(frame, volume_colors[channel])[i], truth, 1e-5,
                              5e-6);
        }
    neph_image_destroy(frame);
}

/* With single scattering, emitted light is visible but lights neither media nor solids. */
static void test_emission_beside_the_sun(void **state)
{
    struct stage stage;
    set_full_stage(&stage);
    stage.scene.media[0].emission_w_per_m2_sr = (struct neph_rgb){8, 1, 2};
    check_full_stage(&stage);
}

/* Absorbing media at the temperature of their surroundings, and a white ball: radiance 1
 * everywhere, with the part that the media hide in their layer. 2e-3: noise of the mean with 64
 * paths, which falls with the albedo. */
static void test_kirchhoff_furnace(void **state)
{
    struct stage stage;
    set_furnace(&stage, -2.0)->emission_w_per_m2_sr = make_grey(1.0);
    struct neph_image *frame = render(&stage, NEPH_LAYER_RADIANCE);
    for (int channel = 0; channel < 3; channel++) {
        const double mean = average_channel(frame, colors[channel]);
        print_message("  furnace %.6f\n", mean);
        neph_assert_close(mean, 1.0, 2e-3, 0.0);
        neph_assert_close(average_channel(frame, volume_colors[channel]),
                          truth_mean(&stage, true, channel), 2e-3, 0.0);
    }
    neph_image_destroy(frame);
}

/* A background without illumination lights neither media nor solids, in any order of scattering. */
static void test_background_that_is_only_seen(void **state)
{
    struct stage stage;
    set_full_stage(&stage);
    stage.scene.sun.present = false;
    stage.scene.scattering = NEPH_SCATTERING_MULTIPLE;
    stage.samples = 16;
    struct neph_image *frame = render(&stage, NEPH_LAYER_RADIANCE | NEPH_LAYER_DEPTH);
    const float *radiance = neph_image_channel(frame, "G");
    const float *depth_m = neph_image_channel(frame, "Z");
    double seen = 0.0;
    assert_true(average_channel(frame, "volume.G") == 0.0);
    for (int i = 0; i < PIXELS; i++) {
        if (isinf(depth_m[i]))
            seen += radiance[i];
        else if (i >= WIDTH && isfinite(depth_m[i - WIDTH])) /* not at the skyline */
            neph_assert_close(radiance[i], 0.0, 0.0, 0.2 * 2.0 / stage.samples);
    }
    assert_true(seen > 0.0);
    neph_image_destroy(frame);
}

/* --- deterministic renders -------------------------------------------------------------------- */

static double largest_difference(const struct neph_image *a, const struct neph_image *b)
{
    double largest = 0.0;
    assert_int_equal(a->channel_count, b->channel_count);
    for (int c = 0; c < a->channel_count; c++)
        for (int i = 0; i < PIXELS; i++)
            if (a->channels[c].samples[i] != b->channels[c].samples[i])
                largest = fmax(largest,
                               fabs(a->channels[c].samples[i] - b->channels[c].samples[i]));
    return largest;
}

static void test_same_seed_same_bits(void **state)
{
    struct stage stage;
    set_full_stage(&stage);
    stage.scene.media[0].kind = NEPH_MEDIUM_HEIGHT_FOG;
    stage.scene.media[0].layers[0].falloff_per_m = 0.5;
    stage.samples = 4;
    stage.threads = 2;
    struct neph_image *first = render(&stage, NEPH_LAYER_RADIANCE);
    stage.threads = 1;
    struct neph_image *again = render(&stage, NEPH_LAYER_RADIANCE);
    stage.seed = UINT64_C(1) << 40; /* its low bits are equal to seed 0 */
    struct neph_image *other = render(&stage, NEPH_LAYER_RADIANCE);
    assert_true(largest_difference(first, again) == 0.0);
    assert_true(largest_difference(first, other) > 0.0);
    neph_image_destroy(first);
    neph_image_destroy(again);
    neph_image_destroy(other);
}

/* All scenes above had the hostile name, in folders with hostile names. */
static void test_nothing_was_executed(void **state)
{
    assert_false(neph_path_exists(pwned_path));
}

/* ---- export and failure ---------------------------------------------------------------------- */

static void assert_file(const char *directory, const char *name)
{
    char *path = neph_path_join(directory, name);
    if (!neph_path_exists(path))
        fail_msg("'%s' is not there", path);
    free(path);
}

static void test_export_runs_by_hand(void **state)
{
    struct neph_diag diag = {0};
    char directory[] = "/tmp/neph-export-XXXXXX", command[256] = "";
    assert_non_null(mkdtemp(directory));
    struct stage stage;
    set_full_stage(&stage);
    stage.samples = 1;
    struct neph_shot shot = make_shot(&stage, NEPH_LAYERS_ALL);
    neph_assert_ok(
        neph_engine_cycles.export_scene(&shot, directory, command, sizeof(command), &diag), &diag);
    assert_file(directory, "spec.json");
    assert_file(directory, "blender_render.py");
    assert_file(directory, "scene.blend");
    char *line = neph_format("cd %s && %s >log 2>&1", directory, command);
    assert_int_equal(system(line), 0);
    free(line);
    assert_file(directory, "radiance.exr");
    assert_file(directory, "transmittance.exr");
    assert_file(directory, "depth.exr");
    line = neph_format("cd %s && rm *.exr && %.*s -b scene.blend -f 1 >log 2>&1", directory,
                       (int)strcspn(command, " "), command); /* the Blender that saved it */
    assert_int_equal(system(line), 0);
    free(line);
    neph_dir_remove(directory, NULL);
}

static void test_failures_are_reported(void **state)
{
    struct neph_diag diag = {0};
    struct neph_cost cost;
    struct neph_image *frame = NULL;
    struct stage stage;
    set_full_stage(&stage);
    struct neph_shot shot = make_shot(&stage, NEPH_LAYERS_ALL);
    shot.scratch_directory = "/nonexistent/folder";
    assert_int_not_equal(neph_engine_cycles.render(&shot, &frame, &cost, &diag), NEPH_OK);
    assert_true(diag.message[0] != '\0');
    shot.time_limit_s = 0.05;
    assert_int_equal(test_render(&neph_engine_cycles, &shot, &frame, &cost, &diag),
                     NEPH_ERR_TIMEOUT);
    assert_null(frame);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_probe_without_blender),
        cmocka_unit_test(test_probe_refuses_an_old_version),
        cmocka_unit_test(test_supported_scenes),
        cmocka_unit_test(test_tiny_frames_are_refused),
        cmocka_unit_test(test_spec_is_data),
        cmocka_unit_test(test_spec_of_emission),
        cmocka_unit_test(test_spec_of_phases),
        cmocka_unit_test(test_spec_refuses_nan),
    };
    const struct CMUnitTest engine_tests[] = {
        cmocka_unit_test(test_transmittance_of_parallel_rays_is_cut),
        cmocka_unit_test(test_transmittance_of_open_fog),
        cmocka_unit_test(test_depth_behind_media),
        cmocka_unit_test(test_single_scattering_in_a_box),
        cmocka_unit_test(test_single_scattering_in_thin_air),
        cmocka_unit_test(test_single_scattering_in_height_fog),
        cmocka_unit_test(test_no_scattering),
        cmocka_unit_test(test_white_furnace),
        cmocka_unit_test(test_emission_of_a_box),
        cmocka_unit_test(test_emission_beside_the_sun),
        cmocka_unit_test(test_kirchhoff_furnace),
        cmocka_unit_test(test_background_that_is_only_seen),
        cmocka_unit_test(test_same_seed_same_bits),
        cmocka_unit_test(test_nothing_was_executed),
        cmocka_unit_test(test_export_runs_by_hand),
        cmocka_unit_test(test_failures_are_reported),
    };
    if (neph_test_wants_engines(argc, argv))
        return test_has_engine(&neph_engine_cycles)
                   ? cmocka_run_group_tests(engine_tests, NULL, NULL)
                   : 0;
    return cmocka_run_group_tests(tests, NULL, NULL);
}
