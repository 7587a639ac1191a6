/* SPDX-License-Identifier: MIT
 *
 * Tests of the screen's G-buffer against the same rays in double precision, and of frames of odd
 * sizes, in both formats, by both cameras: all values are finite.
 */
#include "renderer/screen/check_screen.h"

#include "scenes/surfaces.h"
#include "truth/reflected.h"

enum { WIDTH = 67, HEIGHT = 41 };

/* ---- a scene with all kinds of surfaces ------------------------------------------------------ */

static struct neph_solid *last_solid(struct test_scene *test)
{
    return &test->solids[test->scene.solid_count - 1];
}

static void set_room(struct test_scene *test)
{
    test_scene_init(test);
    test->key.position_m = (struct neph_vec3){0.6, 1.9, 4.2};
    test->key.look_at_m = (struct neph_vec3){0.0, 0.6, 0.0};
    test->scene.scattering = NEPH_SCATTERING_MULTIPLE;
    test->scene.environment_light = true;
    test->scene.sun.direction = neph_vec3_normalize((struct neph_vec3){0.5, 0.7, 0.4});
    screen_add_light(test, (struct neph_vec3){-0.5, 2.5, 1.5});
    test_add_box(test, (struct neph_vec3){-20, -1, -20}, (struct neph_vec3){20, 0, 20});
    last_solid(test)->surface.texture = (struct neph_paint){
        .cell_m = 0.7, .pattern = NEPH_PATTERN_CHECKER, .other = {0.1, 0.2, 0.3}};
    test_add_box(test, (struct neph_vec3){-1.2, 0, -0.9}, (struct neph_vec3){-0.3, 1.1, -0.1});
    last_solid(test)->turn = (struct neph_turn){1, cos(0.5), sin(0.5)};
    last_solid(test)->surface.texture = (struct neph_paint){
        .cell_m = 0.21, .pattern = NEPH_PATTERN_NOISE, .other = {0.9, 0.8, 0.1}, .seed = 7};
    test_add_sphere(test, (struct neph_vec3){0.7, 0.5, 0.2}, 0.5);
    last_solid(test)->surface.metalness = 0.6;
    last_solid(test)->surface.roughness = 0.45;
    test_add_box(test, (struct neph_vec3){-3, 0, -3.2}, (struct neph_vec3){3, 2, -3});
    last_solid(test)->surface.metalness = 1.0;
    last_solid(test)->surface.roughness = 0.2; /* a mirror would reflect light onto the others */
}

/* ---- the reference --------------------------------------------------------------------------- */

/* Targets of a frame. */
struct buffers {
    float *depth, *normal, *base, *direct;
};

static bool near(double a, double b, double relative, double absolute)
{
    return fabs(a - b) <= absolute + relative * fabs(b);
}

/* Whether a pixel agrees with the ray in double precision. */
static bool is_reference(const struct test_scene *test, const struct buffers *got, int p)
{
    const struct neph_camera camera = neph_scene_camera(&test->scene, 0.0);
    const struct neph_pixel_ray ray = neph_camera_ray(&camera, WIDTH, HEIGHT, p % WIDTH, p / WIDTH);
    const struct neph_reflected_view view = neph_reflected_view(&test->scene, ray.origin_m,
                                                                ray.direction);
    const float *normal = &got->normal[4 * p], *base = &got->base[4 * p],
                *direct = &got->direct[4 * p];
    if (!view.hit.solid)
        return isinf(got->depth[4 * p]) || got->depth[4 * p] >= 1e15f;
    const struct neph_vec3 point_m = neph_vec3_along(ray.origin_m, ray.direction, view.hit.t_m);
    const struct neph_surface *surface = &view.hit.solid->surface;
    const struct neph_rgb colour = neph_surface_color(&view.hit, point_m);
    const struct neph_rgb light = neph_rgb_add(neph_rgb_mul(view.color[0], view.direct[0]),
                                               neph_rgb_mul(view.color[1], view.direct[1]));
    const double *colours = &colour.r, *lights = &light.r;
    bool same = near(got->depth[4 * p], view.hit.t_m * neph_vec3_dot(ray.direction, camera.forward),
                     2e-6, 0.0) &&
                near(normal[0], neph_vec3_dot(view.hit.normal, camera.right), 0.0, 3e-6) &&
                near(normal[1], neph_vec3_dot(view.hit.normal, camera.up), 0.0, 3e-6) &&
                near(normal[2], neph_vec3_dot(view.hit.normal, camera.forward), 0.0, 3e-6) &&
                near(normal[3], surface->roughness, 1e-6, 0.0) &&
                near(base[3], surface->metalness, 1e-6, 0.0);
    for (int c = 0; c < 3; c++)
        same = same && near(base[c], colours[c], 1e-6, 2e-5) &&
               near(direct[c], lights[c], 2e-4, 1e-5);
    return same;
}

/* One or two pixels at edges of solids, shadows and checkers may differ. */
static void test_the_g_buffer_is_what_rays_find(void **state)
{
    struct test_scene test;
    set_room(&test);
    OWNED(screening)
    struct neph_screen_renderer *screen = create_screen(*state, &test, WIDTH, HEIGHT, "");
    neph_image_destroy(screen_next(screen, &test));
    const struct buffers got = {screen_read(screen, WIDTH, HEIGHT, SCREEN_DEPTH),
                                screen_read(screen, WIDTH, HEIGHT, SCREEN_NORMAL),
                                screen_read(screen, WIDTH, HEIGHT, SCREEN_BASE),
                                screen_read(screen, WIDTH, HEIGHT, SCREEN_DIRECT)};
    int others = 0;
    for (int p = 0; p < WIDTH * HEIGHT; p++)
        others += !is_reference(&test, &got, p);
    printf("%d of %d pixels are others\n", others, WIDTH * HEIGHT);
    assert_true(others <= 2);
    free(got.depth);
    free(got.normal);
    free(got.base);
    free(got.direct);
}

/* ---- finite values --------------------------------------------------------------------------- */

static void check_image(const struct neph_image *image)
{
    for (int c = 0; c < image->channel_count; c++)
        for (size_t p = 0; p < neph_image_pixel_count(image); p++) {
            const float value = image->channels[c].samples[p];
            const bool may_be_far = strcmp(image->channels[c].name, "Z") == 0;
            assert_true(value >= 0.0f && (isfinite(value) || may_be_far));
        }
}

static void test_no_bad_values(void **state)
{
    static const struct {
        int width_px, height_px;
        const char *settings;
    } cases[] = {
        {1, 1, ""},
        {3, 5, "ao=ssao targets=float16"},
        {17, 1, "ao=unreal ray_thickness_m=0 gi_smooth=6"},
        {1, 9, "ao_thickness=1 ao_falloff=1 ssr_smooth=0 gi_smooth=0"},
        {33, 19, "ao_radius_m=100000 ao_intensity=0.5 ao_power=3 targets=float16"},
        {33, 19, "ao=off gi=off ssr=off"},
        {8, 8, "gi=off ray_noise=off gi_reach_m=0.3"},
    };
    struct test_scene test;
    set_room(&test);
    for (size_t i = 0; i < 2 * COUNT(cases); i++) {
        test.scene.vertical_fov_rad = i % 2 ? 0.0 : 0.9;
        test.scene.orthographic_height_m = i % 2 ? 4.0 : 0.0;
        OWNED(screening)
        struct neph_screen_renderer *screen = create_screen(
            *state, &test, cases[i / 2].width_px, cases[i / 2].height_px, cases[i / 2].settings);
        for (int frame = 0; frame < 3; frame++) {
            OWNED(image) struct neph_image *image = screen_next(screen, &test);
            check_image(image);
        }
    }
}

/* Halves have 11 significant bits; computed values may differ in the last few. */
static void test_halves_are_near(void **state)
{
    struct test_scene test;
    set_room(&test);
    const char *const settings = "ray_noise=off";
    OWNED(image) struct neph_image *full = screen_picture(*state, &test, WIDTH, HEIGHT, settings);
    OWNED(image)
    struct neph_image *half = screen_picture(*state, &test, WIDTH, HEIGHT,
                                             "ray_noise=off targets=float16");
    for (int c = 0; c < full->channel_count; c++) {
        const float *a = full->channels[c].samples, *b = half->channels[c].samples;
        double off = 0.0, sum = 0.0;
        for (size_t p = 0; p < neph_image_pixel_count(full); p++)
            if (isfinite(a[p])) {
                off += fabs(a[p] - b[p]);
                sum += a[p];
            }
        printf("%s: %.2e\n", full->channels[c].name, off / sum);
        assert_true(off <= 0.01 * sum);
    }
}

#include "tests/renderer/main.h"
