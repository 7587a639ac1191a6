/* SPDX-License-Identifier: MIT
 *
 * A planet's sky from tables behind, in front of and between marched media, compared with the exact
 * light of one order, with the tables' CPU reference, and between frames that must be equal.
 */
#include "tests/renderer/frames.h"

#include "renderer/sky/split.h"
#include "scenes/solids.h"

enum { WIDTH = 24, HEIGHT = 16, PIXELS = WIDTH * HEIGHT };

/* The Earth with a cloud at a distance of 12 km and an altitude of 2 km, over 40 degrees. */
static struct neph_scene *load_with_cloud(double depth, enum neph_scattering scattering)
{
    struct neph_scene *scene = test_load("catalog/sky_earth");
    const double width_m = 500.0;
    const double peak_per_m = depth / (width_m * sqrt(2.0 * M_PI));
    scene->media[scene->medium_count++] = make_blob(
        peak_per_m, (struct neph_vec3){-300.0, 2000.0, -12e3}, width_m);
    scene->scattering = scattering;
    scene->camera_keys[0].look_at_m = (struct neph_vec3){0.0, 2.15, -1.0};
    scene->vertical_fov_rad = 0.7;
    return scene;
}

/* Scene sky_aerial with invisible clouds behind the camera: the scene then shares kernels with
 * other tests, and compiling them is most of a test's time. */
static struct neph_scene *load_aerial(int clouds)
{
    struct neph_scene *scene = test_load("catalog/sky_aerial");
    for (int i = 0; i < clouds; i++)
        scene->media[scene->medium_count++] = make_blob(1e-3, (struct neph_vec3){0.0, 2000.0, 3e4},
                                                        500.0);
    return scene;
}

static struct neph_march_params make_params(enum neph_march_lighting lighting, int nodes)
{
    struct neph_march_params params = {
        .width_px = WIDTH,
        .height_px = HEIGHT,
        .steps = 96,
        .lighting = lighting,
        .sky = neph_march_sky_choose(
            (struct neph_march_sky_choices){true, true, nodes, nodes, nodes, 6e4, 0}),
    };
    params.sky.tables.field.altitudes = 6;
    params.sky.tables.field.suns = 16;
    params.sky.tables.field.orders = 3;
    params.sky.tables.field.above = 4;
    params.sky.tables.field.below = 2;
    params.sky.tables.field.around = 3;
    return params;
}

/* Mean over pixels and channels of |a - b|, over the mean of b; of a layer of the image. */
static double distance(const struct neph_image *image, const char *layer, const double *b)
{
    const struct test_rgb rgb = test_layer(image, layer);
    double off = 0.0, sum = 0.0;
    for (int i = 0; i < PIXELS; i++)
        for (int c = 0; c < 3; c++) {
            off += fabs((double)rgb.of[c][i] - b[3 * i + c]);
            sum += b[3 * i + c];
        }
    return off / sum;
}

static double *copy_values(const struct neph_image *image)
{
    const struct test_rgb rgb = test_layer(image, NULL);
    double *values = malloc(3 * PIXELS * sizeof(*values));
    assert_non_null(values);
    for (int i = 0; i < PIXELS; i++)
        for (int c = 0; c < 3; c++)
            values[3 * i + c] = (double)rgb.of[c][i];
    return values;
}

/* --- one order of scattering ------------------------------------------------------------------ */

static void exact_light(const struct neph_scene *scene, double *radiance, double *through)
{
    for (int i = 0; i < PIXELS; i++) {
        const struct neph_ray_light light = test_exact_ray(scene, WIDTH, HEIGHT, i);
        memcpy(&radiance[3 * i], &light.radiance, 3 * sizeof(double));
        memcpy(&through[3 * i], &light.transmittance, 3 * sizeof(double));
    }
}

/* A cloud in air with one order of scattering. The remaining errors are from the tables'
 * interpolation, the edge of the cloud's shadow on the air, and the steps. Clouds from thin to
 * black. */
static void test_air_and_cloud_are_exact_of_one_order(void **state)
{
    static const double depths[] = {8.0, 0.3};
    for (int n = 0; n < neph_test_by_day(1, 2); n++) {
        OWNED(scene) struct neph_scene *scene = load_with_cloud(depths[n], NEPH_SCATTERING_SINGLE);
        double exact[3 * PIXELS], through[3 * PIXELS], off[2] = {0.0, 0.0};
        exact_light(scene, exact, through);
        for (int fine = neph_test_by_day(1, 0); fine < 2; fine++) {
            const struct neph_march_params params = make_params(NEPH_MARCH_SINGLE, fine ? 64 : 16);
            OWNED(image) struct neph_image *image = test_march(*state, scene, &params, NULL);
            off[fine] = distance(image, NULL, exact);
            assert_true(distance(image, "transmittance", through) < 1e-3);
        }
        print_message("cloud of depth %g in air: off by %.2g, %.2g\n", depths[n], off[0], off[1]);
        assert_true(off[0] < 8e-3 && off[1] < 3e-3);
    }
}

/* --- layers in any order ---------------------------------------------------------------------- */

/* Splits a medium into two, one before and one after all others. */
static void cut_in_two(struct neph_scene *scene, int medium, double part)
{
    struct neph_medium first = scene->media[medium];
    first.extinction_per_m *= part;
    scene->media[medium].extinction_per_m *= 1.0 - part;
    memmove(scene->media + 1, scene->media, (size_t)scene->medium_count * sizeof(first));
    scene->media[0] = first;
    scene->medium_count++;
}

static void turn_round(struct neph_scene *scene)
{
    for (int i = 0, j = scene->medium_count - 1; i < j; i++, j--) {
        const struct neph_medium medium = scene->media[i];
        scene->media[i] = scene->media[j];
        scene->media[j] = medium;
    }
}

/* The cloud split, the haze split, both, and in reverse order: the same frame up to the rounding of
 * sums. By day both are split into halves and then into other fractions, which have the same
 * kernels. */
static void test_any_order_of_layers_is_the_same(void **state)
{
    enum { HAZE = 1, CLOUD = 3 };
    static const int cuts[][2] = {{CLOUD, HAZE + 1}, {-1, -1}, {CLOUD, -1}, {HAZE, -1}};
    OWNED(scene) struct neph_scene *scene = load_with_cloud(3.0, NEPH_SCATTERING_MULTIPLE);
    const struct neph_march_params params = make_params(NEPH_MARCH_OCTAVES, 16);
    struct neph_scene plain = *scene;
    for (int i = 0; i < 2 && !neph_test_is_night(); i++)
        cut_in_two(&plain, cuts[0][i], 0.5);
    struct neph_image *image = test_march(*state, &plain, &params, NULL);
    OWNED(memory) double *whole = copy_values(image);
    neph_image_destroy(image);
    for (int n = 0; n < neph_test_by_day(1, 4); n++) {
        struct neph_scene cut = *scene;
        for (int i = 0; i < 2; i++)
            if (cuts[n][i] >= 0)
                cut_in_two(&cut, cuts[n][i], 0.3);
        turn_round(&cut);
        image = test_march(*state, &cut, &params, NULL);
        const double off = distance(image, NULL, whole);
        print_message("cut and turned round, %d: off by %.2g\n", n, off);
        assert_true(off < 3e-6);
        neph_image_destroy(image);
    }
}

/* --- behind and before ------------------------------------------------------------------------ */

/* A cloud without extinction changes nothing, and without solids except the ground the frame is the
 * table's; neph_sky_trace() is its CPU reference. */
static void test_without_clouds_it_is_the_sky(void **state)
{
    neph_test_waits_for_the_night();
    OWNED(scene) struct neph_scene *scene = test_load("catalog/sky_earth");
    struct neph_march_params params = make_params(NEPH_MARCH_SINGLE, 8);
    OWNED(sky) struct neph_sky *sky = test_sky(scene, &params.sky.tables);
    struct neph_diag diag = {0};
    OWNED(image) struct neph_image *image = test_march(*state, scene, &params, NULL);
    const struct neph_camera camera = neph_scene_camera(scene, 0.0);
    OWNED(memory) double *light = calloc(3 * PIXELS, sizeof(*light));
    neph_assert_ok(neph_sky_fill_view_table(sky, camera.position_m, &diag), &diag);
    for (int i = 0; i < PIXELS; i++) {
        const struct neph_pixel_ray ray = test_ray(scene, WIDTH, HEIGHT, i);
        const struct neph_sky_light seen = neph_sky_trace(sky, ray.origin_m, ray.direction);
        memcpy(&light[3 * i], seen.radiance, sizeof(seen.radiance));
    }
    const double off = distance(image, NULL, light);
    print_message("a sky without clouds: off by %.2g\n", off);
    assert_true(off < 1e-3); /* the ground's light is exact, not interpolated */
}

/* Solids at 2.5 to 30 km in air compared with marched rays, over the number of nodes. */
static void test_aerial_perspective_converges(void **state)
{
    OWNED(scene) struct neph_scene *scene = load_aerial(2);
    double off[2];
    struct neph_march_params params = make_params(NEPH_MARCH_OCTAVES, 8);
    struct neph_sky_params walked = params.sky.tables;
    struct neph_scene air = *scene;
    scene->camera_keys[0].look_at_m = (struct neph_vec3){-0.1, 2.02, -1.0};
    scene->vertical_fov_rad = 0.35;
    walked.view.is_table = false;
    walked.steps = 96;
    air.medium_count -= 2; /* without the clouds */
    OWNED(sky) struct neph_sky *sky = test_sky(&air, &walked);
    params.sky.has_shadows = false; /* the marched rays have none */
    for (int fine = 0; fine < 2; fine++) {
        params.sky.tables.aerial = fine ? (struct neph_sky_aerial_params){64, 64, 32, 6e4}
                                        : (struct neph_sky_aerial_params){16, 16, 16, 6e4};
        OWNED(image) struct neph_image *image = test_march(*state, scene, &params, NULL);
        float *rgb[3];
        int solid = 0;
        off[fine] = 0.0;
        assert_true(neph_image_rgb(image, NULL, rgb));
        for (int i = 0; i < PIXELS; i++) {
            const struct neph_pixel_ray ray = test_ray(scene, WIDTH, HEIGHT, i);
            const struct neph_hit hit = neph_scene_hit(scene, ray.origin_m, ray.direction);
            if (!hit.solid || hit.solid == &scene->solids[0])
                continue;
            const struct neph_sky_light seen = neph_sky_trace(sky, ray.origin_m, ray.direction);
            for (int c = 0; c < 3; c++)
                off[fine] += fabs((double)rgb[c][i] / seen.radiance[c] - 1.0) / 3.0;
            solid++;
        }
        off[fine] /= solid;
        assert_true(solid >= 12);
    }
    print_message("aerial perspective of solids: off by %.2g, %.2g\n", off[0], off[1]);
    assert_true(off[0] < 5e-3 && off[1] < 1e-3);
}

/* A solid that moves takes its shadow on the air along: the last frame of a sequence has the bits
 * of that frame alone. */
static void test_shadows_on_the_air_follow_solids(void **state)
{
    struct neph_solid_key keys[] = {{.frame = 0, .move_m = {-4e3, 0, 0}}, {.frame = 1}};
    struct neph_mover mover = {.first = 4, .count = 1, .key_count = 2, .keys = keys};
    const struct neph_march_params params = make_params(NEPH_MARCH_OCTAVES, 8);
    OWNED(scene) struct neph_scene *scene = load_aerial(2);
    scene->movers = &mover;
    scene->mover_count = 1;
    OWNED(scene) struct neph_scene *first = test_still(scene, 0), *last = test_still(scene, 1);
    OWNED(march) struct neph_march *march = test_march_open(*state, scene, &params);
    OWNED(image) struct neph_image *before = test_march_next(march, first, NULL);
    OWNED(image) struct neph_image *after = test_march_next(march, last, NULL);
    OWNED(image) struct neph_image *alone = test_march(*state, last, &params, NULL);
    assert_same_bits(after, alone);
    assert_false(test_same_bits(after, before));
}

/* --- light of the sky ------------------------------------------------------------------------- */

/* Mean radiance over all directions at a point, in double. */
static void mean_sky(const struct neph_scene *scene, const struct neph_sky_params *params,
                     struct neph_vec3 place_m, double mean[3])
{
    enum { DIRECTIONS = 3000 };
    struct neph_scene air = *scene;
    struct neph_sky_params walked = *params;
    air.medium_count = 3; /* without the cloud */
    walked.view.is_table = false;
    walked.steps = 24;
    OWNED(sky) struct neph_sky *sky = test_sky(&air, &walked);
    mean[0] = mean[1] = mean[2] = 0.0;
    for (int i = 0; i < DIRECTIONS; i++) { /* uniform on the sphere, by the golden angle */
        const double y = 1.0 - (2.0 * i + 1.0) / DIRECTIONS, across = sqrt(1.0 - y * y);
        const double turn = M_PI * (3.0 - sqrt(5.0)) * i;
        const struct neph_sky_light light = neph_sky_trace(
            sky, place_m, (struct neph_vec3){across * cos(turn), y, across * sin(turn)});
        for (int c = 0; c < 3; c++)
            mean[c] += light.radiance[c] / DIRECTIONS;
    }
}

/* After sunset a thin white cloud scatters the mean of sky and ground light over directions; by day
 * double scattering of sunlight would be larger. The remaining errors are the noise of the paths
 * and the cloud's attenuation of its own light, 2 %. */
static void test_the_sky_lights_a_thin_cloud(void **state)
{
    neph_test_waits_for_the_night();
    const double depth = 0.4;
    const struct neph_vec3 place_m = {-300.0, 2000.0, -12e3};
    OWNED(scene) struct neph_scene *scene = load_with_cloud(depth, NEPH_SCATTERING_MULTIPLE);
    struct neph_march_params params = make_params(NEPH_MARCH_TRACED, 16);
    double mean[3];
    scene->camera_keys[0].position_m = (struct neph_vec3){-300.0, 2000.0, -11.9e3};
    scene->camera_keys[0].look_at_m = place_m;
    scene->vertical_fov_rad = 0.1;
    scene->sun.direction = (struct neph_vec3){0.0, -sin(0.05), -cos(0.05)};
    params.light = (struct neph_light_paths){
        .texel_px = 8, .paths = 64, .rounds = 24, .memory = 1, .blur_texels = 2.0, .seed = 7};
    OWNED(image) struct neph_image *traced = test_march(*state, scene, &params, NULL);
    params.lighting = NEPH_MARCH_OCTAVES;
    scene->octaves.count = 1;
    OWNED(image) struct neph_image *once = test_march(*state, scene, &params, NULL);
    float *a[3], *b[3];
    mean_sky(scene, &params.sky.tables, place_m, mean);
    assert_true(neph_image_rgb(traced, NULL, a) && neph_image_rgb(once, NULL, b));
    for (int c = 0; c < 3; c++) {
        const int middle = (HEIGHT / 2) * WIDTH + WIDTH / 2;
        const double opacity = 1.0 - exp(-depth * 0.5 * (1.0 + erf(100.0 / 500.0 / sqrt(2.0))));
        const double found = ((double)a[c][middle] - (double)b[c][middle]) / opacity;
        print_message("channel %d: %.4g of the sky, %.4g wanted\n", c, found, mean[c]);
        neph_assert_close(found, mean[c], 0.05, 0.0);
    }
}

/* Air in front of a black wall under an overcast sky, sun at 45 degrees: in shade there is neither
 * sun nor clear sky, only light from clouds. The tables' model is for broken clouds and is within a
 * third of the tracer; the light of clear air would be two and a half times too large. */
static void test_clouds_light_the_air_below(void **state)
{
    neph_test_waits_for_the_night();
    OWNED(scene) struct neph_scene *scene = test_load("catalog/sky_aerial");
    struct neph_march_params params = make_params(NEPH_MARCH_OCTAVES, 16);
    params.sky.tables.field.orders = 8;
    params.steps = 64;
    scene->camera_keys[0].position_m = (struct neph_vec3){0.0, 400.0, 0.0};
    scene->camera_keys[0].look_at_m = (struct neph_vec3){0.0, 400.0, -1.0};
    scene->vertical_fov_rad = 0.2;
    scene->sun.direction = neph_vec3_normalize((struct neph_vec3){0.3, 0.7071, -0.64});
    scene->solid_count = 2;
    scene->solids[0].albedo = make_grey(0.0);
    scene->solids[1] = (struct neph_solid){.kind = NEPH_SOLID_BOX,
                                           .box = {{-9e3, -50.0, -7e3}, {9e3, 1200.0, -6.8e3}}};
    struct neph_medium *clouds = &scene->media[scene->medium_count++];
    *clouds = make_homogeneous(0.024,
                               (struct neph_bounds){{-4e4, 1500.0, -4e4}, {4e4, 2000.0, 4e4}});
    clouds->albedo = white;
    clouds->phase = (struct neph_phase){NEPH_PHASE_HENYEY_GREENSTEIN, 0.6};
    const struct neph_tracer_params tracer = test_samples(WIDTH, HEIGHT, 3, 256);
    OWNED(image) struct neph_image *image = test_march(*state, scene, &params, NULL);
    OWNED(image) struct neph_image *truth = test_trace(*state, scene, &tracer, NULL);
    float *a[3], *b[3];
    assert_true(neph_image_rgb(image, NULL, a) && neph_image_rgb(truth, NULL, b));
    for (int c = 0; c < 3; c++) {
        double found = 0.0, expected = 0.0;
        for (int i = 0; i < PIXELS; i++) {
            const bool is_wall = neph_image_channel(image, "Z")[i] < 7.5e3f;
            found += is_wall ? (double)a[c][i] : 0.0;
            expected += is_wall ? (double)b[c][i] : 0.0;
        }
        print_message("channel %d under clouds: %.2f of the tracer's\n", c, found / expected);
        neph_assert_close(found, expected, 0.35, 0.0);
    }
}

/* --- in real time ----------------------------------------------------------------------------- */

static const char plain_words[] =
    "split=four ray_dither=none upscale_dither=none sky=tables sky_columns=8 sky_rows=8 "
    "sky_slices=8 sky_far_m=6e4";

/* Preset `off` with changes. */
static struct neph_image *render_realtime(struct neph_vulkan *vulkan,
                                          const struct neph_scene *scene, const char *words)
{
    const struct neph_settings settings = test_preset("off", words);
    const struct neph_realtime_params params = {WIDTH, HEIGHT, &settings, 7, NULL};
    return test_film(vulkan, scene, &params, 1, NULL);
}

/* Without clouds `realtime` equals the march: the sky, and solids through air. One order, so that
 * no table of multiple scattering is needed. */
static void test_realtime_has_the_same_sky(void **state)
{
    OWNED(scene) struct neph_scene *scene = load_aerial(1);
    scene->scattering = NEPH_SCATTERING_SINGLE;
    const struct neph_march_params params = make_params(NEPH_MARCH_SINGLE, 8);
    OWNED(image) struct neph_image *marched = test_march(*state, scene, &params, NULL);
    OWNED(memory) double *values = copy_values(marched);
    OWNED(image) struct neph_image *image = render_realtime(*state, scene, plain_words);
    const double off = distance(image, NULL, values);
    print_message("the sky in real time: off by %.2g\n", off);
    assert_true(off < 1e-3); /* half precision */
}

/* A fog bank at 2 to 12 km, all of it in froxels: the air in front of each froxel attenuates it and
 * adds light, as in front of a march step. One order, compared with the exact light; without that
 * air the difference is large. */
static void test_froxels_are_seen_through_the_air(void **state)
{
    static const char words[] =
        "split=four ray_dither=none upscale_dither=none sky=tables sky_columns=32 sky_rows=32 "
        "sky_slices=32 sky_far_m=6e4 froxels=on froxel_px=1 froxel_near_m=2000 froxel_end_m=14000 "
        "froxel_history=0 froxel_jitter=off steps=16";
    OWNED(scene) struct neph_scene *scene = load_with_cloud(1.0, NEPH_SCATTERING_SINGLE);
    struct neph_medium *fog = &scene->media[scene->medium_count - 1];
    double exact[3 * PIXELS], through[3 * PIXELS];
    *fog = make_homogeneous(1e-4, (struct neph_bounds){{-6e3, 0.0, -12e3}, {6e3, 1500.0, -2e3}});
    exact_light(scene, exact, through);
    OWNED(image) struct neph_image *image = render_realtime(*state, scene, words);
    const double off = distance(image, NULL, exact);
    print_message("fog in froxels under a sky: off by %.2g\n", off);
    assert_true(off < 5e-3); /* 4.4e-2 without that air */
}

/* --- refusals --------------------------------------------------------------------------------- */

static const struct neph_march_veils sky = {.sky = true};

static void refuses(const struct neph_scene *scene, enum neph_march_lighting lighting,
                    const char *words)
{
    char reason[256] = "";
    assert_false(neph_march_can_render_with(scene, sky, lighting, reason, sizeof(reason)));
    if (!strstr(reason, words))
        print_error("no '%s' in '%s'\n", words, reason);
    assert_non_null(strstr(reason, words));
}

static void test_unsupported_scenes_are_named(void **state)
{
    char reason[256];
    OWNED(scene) struct neph_scene *scene = load_with_cloud(1.0, NEPH_SCATTERING_MULTIPLE);
    assert_true(neph_march_can_render_with(scene, sky, NEPH_MARCH_TRACED, reason, sizeof(reason)));
    assert_false(neph_march_can_render(scene, NEPH_MARCH_TRACED, reason,
                                       sizeof(reason))); /* air has colour */
    refuses(scene, NEPH_MARCH_SINGLE, "multiple scattering");
    refuses(scene, NEPH_MARCH_HORIZON, "Horizon");
    struct neph_scene other = *scene;
    other.orthographic_height_m = 100.0;
    refuses(&other, NEPH_MARCH_OCTAVES, "orthographic");
    other = *scene;
    other.solid_count = 0;
    refuses(&other, NEPH_MARCH_OCTAVES, "ground");
    other = *scene;
    other.background_w_per_m2_sr.g = 1.0;
    refuses(&other, NEPH_MARCH_OCTAVES, "background");
    other = *scene;
    other.media[0] = scene->media[3];
    other.medium_count = 1;
    refuses(&other, NEPH_MARCH_OCTAVES, "without an atmosphere");
}

#include "tests/renderer/main.h"
