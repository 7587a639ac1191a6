/* SPDX-License-Identifier: MIT
 *
 * Tests of the screen passes against their references in double precision, pixel by pixel:
 * occlusion by all methods and its blur, indirect light, reflections, their means and smoothing,
 * the final image; at full and half resolution, with targets of 32 and 16 bits, with perspective
 * and orthographic cameras, at an odd size.
 */
#include "renderer/screen/check_screen.h"
#include "renderer/screen/check_reference.h"

enum { WIDTH = 37, HEIGHT = 23 };

/* A floor, a turned box on it, a sphere of rough metal, a mirror, a light, the sun, and the sky. */
static void set_things(struct test_scene *test)
{
    test_scene_init(test);
    test->key.position_m = (struct neph_vec3){0.5, 1.2, 3.5};
    test->key.look_at_m = (struct neph_vec3){0.0, 0.5, 0.0};
    test->scene.scattering = NEPH_SCATTERING_MULTIPLE;
    test->scene.environment_light = true;
    screen_add_light(test, (struct neph_vec3){0.5, 1.6, 1.4});
    test_add_box(test, (struct neph_vec3){-9, -1, -9}, (struct neph_vec3){9, 0, 9});
    test_add_box(test, (struct neph_vec3){-0.9, 0, -0.5}, (struct neph_vec3){-0.1, 0.9, 0.3});
    test->solids[1].turn = (struct neph_turn){1, cos(0.4), sin(0.4)};
    test_add_sphere(test, (struct neph_vec3){0.6, 0.4, 0.2}, 0.4);
    test->solids[2].surface.metalness = 0.7;
    test->solids[2].surface.roughness = 0.6;
    test_add_box(test, (struct neph_vec3){-1.4, 0, -1.2}, (struct neph_vec3){1.4, 1.1, -0.9});
    test->solids[3].surface.metalness = 1.0;
}

/* ---- a scene for the device and the reference ------------------------------------------------ */

struct both {
    struct test_scene test;
    struct neph_settings settings;
    struct neph_screen_renderer *screen;
    struct reference ref;
    float *texels[SCREEN_TARGET_COUNT]; /* owned */
};

/* Scenes: a perspective camera; an orthographic one; a mirror as floor; with some rough metal and a
 * flat hill of it, whose neighbouring pixels are nearly coplanar, seen by either camera. */
enum kind { PLAIN, FLAT, MIRROR, ROUGH, FLAT_ROUGH };

/* Render a number of frames; the device keeps the targets of the last. */
static void render(struct neph_vulkan *vulkan, const char *settings, enum kind kind, int frames,
                   struct both *both)
{
    struct neph_diag diag = {0};
    *both = (struct both){.settings = screen_settings(settings)};
    set_things(&both->test);
    if (kind == MIRROR)
        both->test.solids[0].surface.metalness = 1.0;
    if (kind == ROUGH || kind == FLAT_ROUGH) {
        test_add_sphere(&both->test, (struct neph_vec3){0.0, -2.4, 1.2}, 2.6);
        for (int i = 0; i <= 4; i += 4) {
            both->test.solids[i].surface.metalness = 0.5;
            both->test.solids[i].surface.roughness = 0.6;
        }
    }
    if (kind == FLAT || kind == FLAT_ROUGH) {
        both->test.scene.vertical_fov_rad = 0.0;
        both->test.scene.orthographic_height_m = 2.6;
    }
    both->screen = create_screen(vulkan, &both->test, WIDTH, HEIGHT, settings);
    for (int i = 0; i < frames; i++)
        neph_assert_ok(
            neph_screen_renderer_frame(both->screen, &both->test.scene, 0.0, NULL, NULL, &diag),
            &diag);
    const struct neph_camera camera = neph_scene_camera(&both->test.scene, 0.0);
    const double half = neph_camera_half_height(&camera);
    both->ref = (struct reference){.scene = &both->test.scene,
                                   .camera = camera,
                                   .values = both->settings.values,
                                   .width_px = WIDTH,
                                   .height_px = HEIGHT,
                                   .half_width = half * WIDTH / HEIGHT,
                                   .half_height = half,
                                   .frame = (unsigned)frames - 1};
    for (int t = 0; t < SCREEN_TARGET_COUNT; t++) {
        if (!(neph_screen_targets_used(&both->settings) >> t & 1u))
            continue;
        both->texels[t] = screen_read(both->screen, WIDTH, HEIGHT, t);
        both->ref.targets[t] = both->texels[t];
    }
}

static void drop(struct both *both)
{
    for (int t = 0; t < SCREEN_TARGET_COUNT; t++)
        free(both->texels[t]);
    neph_screen_renderer_destroy(both->screen);
}

/* ---- comparison ------------------------------------------------------------------------------ */

typedef struct texel reference_function(const struct reference *ref, int x, int y);

/* Whether a cell of this size is in the frame. */
static bool is_cell(int x, int y, int cell_px)
{
    return cell_px * x < WIDTH && cell_px * y < HEIGHT;
}

/* Count the pixels or cells that differ by more than the rounding of float32 (or half). Where a
 * step falls onto a depth edge or between two pixels, its last digit decides which surface is
 * sampled. */
static int count_off(const struct both *both, int target, int cell_px, reference_function *ref,
                     int channels, double *largest)
{
    const bool half = both->settings.values[SCREEN_TARGETS] == SCREEN_FLOAT16;
    const double relative = half ? 1e-3 : 1e-4, absolute = half ? 1e-3 : 1e-4;
    int off = 0;
    *largest = 0.0;
    for (int p = 0; p < WIDTH * HEIGHT; p++) {
        if (!is_cell(p % WIDTH, p / WIDTH, cell_px))
            continue;
        const struct texel own = ref(&both->ref, p % WIDTH, p / WIDTH);
        bool is_off = false;
        for (int c = 0; c < channels; c++) {
            const double seen = both->texels[target][4 * p + c], gap = fabs(seen - own.v[c]);
            assert_true(isfinite(seen) && seen >= 0.0);
            is_off = is_off || gap > absolute + relative * fabs(own.v[c]);
            *largest = fmax(*largest, gap);
        }
        off += is_off;
    }
    return off;
}

/* Check the cells of passes with a resolution setting; 0: all pixels. */
static void check_cells(const struct both *both, int target, int resolution,
                        reference_function *ref, int channels, int most, const char *what)
{
    double largest;
    const int cell_px = resolution ? reference_cell_px(&both->ref, resolution) : 1;
    const int off = count_off(both, target, cell_px, ref, channels, &largest);
    printf("%s: %d of %d pixels are others, by %.3g at most\n", what, off,
           WIDTH * HEIGHT / cell_px / cell_px, largest);
    assert_true(off <= most);
}

static void check(const struct both *both, int target, reference_function *ref, int channels,
                  int most, const char *what)
{
    check_cells(both, target, 0, ref, channels, most, what);
}

/* ---- tests ----------------------------------------------------------------------------------- */

static void check_occlusion(struct neph_vulkan *vulkan, const char *settings, enum kind kind)
{
    struct both both;
    char all[200];
    snprintf(all, sizeof(all), "gi=off ssr=off ao_blur_px=0 %s", settings);
    render(vulkan, all, kind, 2, &both);
    check(&both, SCREEN_OPEN, reference_ao, 1, WIDTH * HEIGHT / 200, settings);
    drop(&both);
}

static void test_occlusion(void **state)
{
    static const char *const by_day[] = {"ao=gtao", "ao=ssao", "ao=unreal"};
    static const char *const by_night[] = {
        "ao=gtao targets=float16",
        "ao=gtao ao_places=pixel ao_slices=axis ao_sum=mean ao_falloff=0.6 ao_thickness=0.1",
        "ao=gtao ao_noise=off ao_directions=5 ao_steps=9 ao_step_power=1 ao_radius_m=0.4",
        "ao=gtao ao_power=2 ao_intensity=0.5",
        "ao=ssao ao_bias=0.01 ao_radius_m=2",
        "ao=unreal ao_places=pixel ao_radius_m=2 ao_directions=6 ao_steps=3 targets=float16",
    };
    for (size_t i = 0; i < COUNT(by_day); i++)
        check_occlusion(*state, by_day[i], PLAIN);
    check_occlusion(*state, "ao=gtao ao_slices=axis", FLAT);
    for (size_t i = 0; i < COUNT(by_night) && neph_test_is_night(); i++)
        for (int kind = PLAIN; kind <= FLAT; kind++)
            check_occlusion(*state, by_night[i], (enum kind)kind);
}

static struct texel gi_mean(const struct reference *ref, int x, int y)
{
    return reference_mean(ref, SCREEN_GI_RESOLUTION, x, y);
}

static struct texel ssr_mean(const struct reference *ref, int x, int y)
{
    return reference_mean(ref, SCREEN_SSR_RESOLUTION, x, y);
}

/* The second frame uses the history of the first. */
static void check_rays(struct neph_vulkan *vulkan, const char *settings, enum kind kind, int frames)
{
    struct both both;
    render(vulkan, settings, kind, frames, &both);
    printf("frame %d: %s\n", frames, settings);
    check_cells(&both, SCREEN_GI_RAW, SCREEN_GI_RESOLUTION, reference_gi, 4, WIDTH * HEIGHT / 200,
                "indirect light");
    check_cells(&both, SCREEN_SSR_RAW, SCREEN_SSR_RESOLUTION, reference_ssr, 4,
                WIDTH * HEIGHT / 200, "reflections");
    check_cells(&both, SCREEN_GI_MEAN, SCREEN_GI_RESOLUTION, gi_mean, 4, 0, "their means");
    check_cells(&both, SCREEN_SSR_MEAN, SCREEN_SSR_RESOLUTION, ssr_mean, 4, 0, "over frames");
    check(&both, SCREEN_LIT, reference_lit, 4, 0, "diffuse light");
    check(&both, SCREEN_PICTURE, reference_final, 4, 0, "picture");
    drop(&both);
}

static void test_rays(void **state)
{
    static const char *const by_night[] = {
        "targets=float16",
        "gi_bounces=one ray_metal=camera ray_noise=off ao=off",
        "ray_thickness_m=0 ray_refine=0 gi_reach_m=1.5 gi_rays=3",
        "ray_step_power=1.5 ssr_steps=20 gi_steps=9 ssr_rays=2 ao=ssao gi_smooth=0 ssr_smooth=1",
        "ssr_roughest=0.5 ao_resolution=half",
        "gi_resolution=half gi_smooth=1",
        "ssr_resolution=half targets=float16",
        "gi_resolution=half ssr_resolution=half ray_pixel=turning ao=off",
    };
    check_rays(*state, "", PLAIN, 2);
    if (!neph_test_is_night())
        return;
    check_rays(*state, "", PLAIN, 1);
    check_rays(*state, "", FLAT, 2);
    for (size_t i = 0; i < COUNT(by_night); i++)
        check_rays(*state, by_night[i], PLAIN, 3);
}

/* ---- at half resolution ---------------------------------------------------------------------- */

static struct texel whole_ao(const struct reference *ref, int x, int y)
{
    return reference_whole(ref, SCREEN_AO_RESOLUTION, x, y);
}

static struct texel whole_gi(const struct reference *ref, int x, int y)
{
    return reference_whole(ref, SCREEN_GI_RESOLUTION, x, y);
}

static struct texel whole_ssr(const struct reference *ref, int x, int y)
{
    return reference_whole(ref, SCREEN_SSR_RESOLUTION, x, y);
}

/* Check all pixels of the final upsampled results. */
static void check_whole(const struct both *both)
{
    check(both, SCREEN_OPEN_WHOLE, whole_ao, 4, 0, "occlusion of all");
    check(both, reference_gi_at(&both->ref), whole_gi, 4, 0, "indirect light of all");
    check(both, reference_ssr_at(&both->ref), whole_ssr, 4, 0, "reflections of all");
}

#define HALF "ao_resolution=half gi_resolution=half ssr_resolution=half "

static void check_half(struct neph_vulkan *vulkan, const char *settings, enum kind kind, int frames)
{
    struct both both;
    char all[200];
    snprintf(all, sizeof(all), HALF "ao_blur_px=0 gi_smooth=0 ssr_smooth=0 %s", settings);
    check_rays(vulkan, all, kind, frames);
    render(vulkan, all, kind, frames, &both);
    check_cells(&both, SCREEN_OPEN, SCREEN_AO_RESOLUTION, reference_ao, 1, 2, "occlusion");
    check_whole(&both);
    drop(&both);
}

/* In the fourth frame rays start at the last of the four pixels. */
static void test_half_resolution(void **state)
{
    check_half(*state, "gi_rays=1 ssr_rays=1 ray_pixel=turning", PLAIN, 4);
    if (!neph_test_is_night())
        return;
    for (int frames = 1; frames <= 3; frames++)
        check_half(*state, "ray_pixel=turning", PLAIN, frames);
    check_half(*state, "gi_rays=1 ssr_rays=1 targets=float16 ray_pixel=turning", FLAT, 2);
    check_half(*state, "ssr_roughest=0.3", MIRROR, 3);
}

/* ---- blur and smoothing ---------------------------------------------------------------------- */

static struct texel gi_turn_0(const struct reference *ref, int x, int y)
{
    return reference_smooth(ref, SCREEN_GI_RESOLUTION, 0, x, y);
}

static struct texel gi_turn_1(const struct reference *ref, int x, int y)
{
    return reference_smooth(ref, SCREEN_GI_RESOLUTION, 1, x, y);
}

/* At full resolution pixels without metal are not used, and their weights are below the precision
 * of float32. */
static struct texel ssr_turn(const struct reference *ref, int turn, int x, int y)
{
    if (reference_cell_px(ref, SCREEN_SSR_RESOLUTION) > 1 ||
        reference_has_light(ref, SCREEN_SSR_RESOLUTION, x, y))
        return reference_smooth(ref, SCREEN_SSR_RESOLUTION, turn, x, y);
    return reference_load(ref, reference_turned_at(SCREEN_SSR_RESOLUTION, turn + 1), x, y);
}

static struct texel ssr_turn_0(const struct reference *ref, int x, int y)
{
    return ssr_turn(ref, 0, x, y);
}

static struct texel ssr_turn_1(const struct reference *ref, int x, int y)
{
    return ssr_turn(ref, 1, x, y);
}

/* Replace a target that a later pass has overwritten by the reference's own values. */
static void put(struct both *both, int target, int resolution, reference_function *ref)
{
    const int cell_px = reference_cell_px(&both->ref, resolution);
    for (int p = 0; p < WIDTH * HEIGHT; p++) {
        if (!is_cell(p % WIDTH, p / WIDTH, cell_px))
            continue;
        const struct texel own = ref(&both->ref, p % WIDTH, p / WIDTH);
        for (int c = 0; c < 4; c++)
            both->texels[target][4 * p + c] = (float)own.v[c];
    }
}

/* Check all smoothing passes of a light; with upsampling only the last is still on the device. */
static void check_turns(struct both *both, int resolution, int turns,
                        reference_function *const *refs, const char *what)
{
    for (int turn = 0; turn < turns; turn++) {
        const int to = reference_turned_at(resolution, turn + 1);
        if (turn + 1 < turns && both->settings.values[resolution] == SCREEN_HALF)
            put(both, to, resolution, refs[turn]);
        else
            check_cells(both, to, resolution, refs[turn], 4, 0, what);
    }
}

/* Up to two smoothing passes. */
static void check_smoothing(struct neph_vulkan *vulkan, const char *settings, enum kind kind)
{
    static reference_function *const gi[] = {gi_turn_0, gi_turn_1}, *const ssr[] = {ssr_turn_0,
                                                                                    ssr_turn_1};
    struct both both;
    render(vulkan, settings, kind, 2, &both);
    printf("%s\n", settings);
    check_cells(&both, SCREEN_OPEN_SMOOTH, SCREEN_AO_RESOLUTION, reference_blur, 4, 0, "blur");
    if (both.settings.values[SCREEN_GI_RESOLUTION] == SCREEN_HALF)
        check_whole(&both);
    check_turns(&both, SCREEN_GI_RESOLUTION, (int)both.settings.values[SCREEN_GI_SMOOTH], gi,
                "smoothing of indirect light");
    check_turns(&both, SCREEN_SSR_RESOLUTION, (int)both.settings.values[SCREEN_SSR_SMOOTH], ssr,
                "of reflections");
    drop(&both);
}

/* In a frame with history, at full and at half resolution. */
static void test_blur_and_smoothing(void **state)
{
    static const char *const by_day[] = {
        "gi_smooth=2 ssr_smooth=2 gi_rays=1",
        HALF "gi_smooth=1 ssr_smooth=1 ao_blur_px=1 gi_rays=1 targets=float16",
        HALF "gi_smooth=2 ssr_smooth=2 ao_blur_px=3 gi_rays=1 ray_pixel=turning",
    };
    static const char *const by_night[] = {
        "gi_smooth=1 ssr_smooth=1 ao_blur_px=1 targets=float16",
        "gi_smooth=2 ssr_smooth=2 ao_blur_px=3",
        HALF "gi_smooth=1 ssr_smooth=1 ao_blur_px=1",
        HALF "gi_smooth=2 ssr_smooth=2 ao_blur_px=3 targets=float16",
    };
    for (size_t i = 0; i < COUNT(by_day); i++)
        for (int kind = ROUGH; kind <= FLAT_ROUGH; kind++)
            check_smoothing(*state, by_day[i], (enum kind)kind);
    for (size_t i = 0; i < COUNT(by_night) && neph_test_is_night(); i++)
        for (int kind = PLAIN; kind <= FLAT_ROUGH; kind++)
            check_smoothing(*state, by_night[i], (enum kind)kind);
}

/* ---- a mirror's rays ------------------------------------------------------------------------- */

struct found {
    int known, found, wrong; /* hits that the frame shows; found; found although not shown */
    double off_px;           /* summed over the found hits */
};

/* Whether a point in world space is visible at its pixel. */
static bool is_shown(const struct both *both, struct neph_vec3 point_m, struct vec2 *place_px)
{
    const struct neph_camera *camera = &both->ref.camera;
    const struct neph_vec3 way_m = neph_vec3_sub(point_m, camera->position_m);
    const struct neph_vec3 own_m = {neph_vec3_dot(way_m, camera->right),
                                    neph_vec3_dot(way_m, camera->up),
                                    neph_vec3_dot(way_m, camera->forward)};
    *place_px = reference_project(&both->ref, own_m);
    const double distance_m = neph_vec3_length(way_m);
    const struct neph_hit hit = neph_scene_hit(&both->test.scene, camera->position_m,
                                               neph_vec3_scale(way_m, 1.0 / distance_m));
    return own_m.z > 0.0 && hit.solid && fabs(hit.t_m - distance_m) < 1e-6 * distance_m &&
           reference_is_inside(&both->ref, (int)floor(place_px->x), (int)floor(place_px->y));
}

/* Compare with the exact hit of the mirrored ray. */
static void look_into_mirror(const struct both *both, int p, struct found *found)
{
    struct neph_vec3 point_m, met_m;
    struct vec2 place_px, met_px;
    const struct neph_hit own = screen_hit(&both->test, WIDTH, HEIGHT, p % WIDTH, p / WIDTH,
                                           &point_m);
    if (own.solid != &both->test.solids[0] || own.normal.y < 0.5)
        return;
    struct neph_vec3 way = neph_vec3_normalize(neph_vec3_sub(point_m, both->ref.camera.position_m));
    way.y = -way.y;
    const struct neph_vec3 from_m = neph_vec3_along(point_m, own.normal, 1e-9);
    const struct neph_hit hit = neph_scene_hit(&both->test.scene, from_m, way);
    const bool is_known = hit.solid &&
                          is_shown(both, neph_vec3_along(from_m, way, hit.t_m), &place_px);
    const bool is_met = reference_mirror(&both->ref, p % WIDTH, p / WIDTH, &met_m);
    found->known += is_known;
    found->wrong += is_met && !is_known;
    if (!is_known || !is_met)
        return;
    met_px = reference_project(&both->ref, met_m);
    found->found++;
    found->off_px += hypot(met_px.x - place_px.x, met_px.y - place_px.y);
}

/* Using the reference, which equals the device's ray: nearly all hits that are visible in the frame
 * are found, within a fraction of a pixel. */
static void test_a_mirror_finds_what_is_shown(void **state)
{
    struct both both;
    struct found found = {0};
    render(*state, "", MIRROR, 1, &both);
    for (int p = 0; p < WIDTH * HEIGHT; p++)
        look_into_mirror(&both, p, &found);
    printf(
        "of %d meetings that are shown %d are found, %.3g px off in the mean; %d are not there\n",
        found.known, found.found, found.off_px / found.found, found.wrong);
    assert_true(found.known > 60 && found.found > 0.9 * found.known);
    assert_true(found.off_px < 0.3 * found.found && found.wrong < 0.1 * found.known);
    drop(&both);
}

/* In a static scene frame n has the weight 1 / n, until the history is full. */
static void test_the_mean_over_frames(void **state)
{
    struct test_scene test;
    struct neph_diag diag = {0};
    double mean[WIDTH * HEIGHT] = {0.0};
    set_things(&test);
    OWNED(screening)
    struct neph_screen_renderer *screen = create_screen(
        *state, &test, WIDTH, HEIGHT, "ao=off ssr=off gi_smooth=0 gi_rays=1 gi_history=3");
    for (int frame = 1; frame <= 6; frame++) {
        static const int targets[] = {SCREEN_DEPTH, SCREEN_GI_RAW, SCREEN_GI_MEAN, SCREEN_GI_COUNT};
        float *texels[4];
        neph_assert_ok(neph_screen_renderer_frame(screen, &test.scene, 0.0, NULL, NULL, &diag),
                       &diag);
        for (int t = 0; t < 4; t++)
            texels[t] = screen_read(screen, WIDTH, HEIGHT, targets[t]);
        const int count = frame < 4 ? frame : 4;
        for (int p = 0; p < WIDTH * HEIGHT; p++) {
            mean[p] += (texels[1][4 * p + 3] - mean[p]) / count;
            if (texels[0][4 * p] >= 1e15f) /* the sky */
                continue;
            neph_assert_close(texels[3][4 * p], count, 0.0, 0.0);
            neph_assert_close(texels[2][4 * p + 3], mean[p], 0.0, 1e-3);
        }
        for (int t = 0; t < 4; t++)
            free(texels[t]);
    }
}

/* Without rays only the sky lights open surfaces. */
static void test_the_picture_without_rays(void **state)
{
    struct both both;
    render(*state, "gi=off ssr=off", PLAIN, 1, &both);
    check(&both, SCREEN_LIT, reference_lit, 4, 0, "diffuse light");
    check(&both, SCREEN_PICTURE, reference_final, 4, 0, "picture");
    drop(&both);
}

#include "tests/renderer/main.h"
