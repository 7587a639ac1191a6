/* SPDX-License-Identifier: MIT
 *
 * Boxes that have turned, on the device: where rays meet them, how their faces are lit and what
 * they shade, against exact transport in double precision.
 */
#include "tests/renderer/march_test.h"

#include "scenes/motion.h"
#include "truth/transport.h"

enum { WIDTH_PX = 48, HEIGHT_PX = 27 };

static struct neph_scene *load(const char *name)
{
    char path[512];
    struct neph_scene *scene = NULL;
    struct neph_diag diag = {0};
    snprintf(path, sizeof(path), NEPH_SOURCE_DIR "/scenes/catalog/%s.yaml", name);
    neph_assert_ok(neph_scene_load(path, &scene, &diag), &diag);
    return scene;
}

static struct neph_image *march(struct neph_vulkan *vulkan, const struct neph_scene *scene)
{
    const struct neph_march_params params = {.width_px = WIDTH_PX,
                                             .height_px = HEIGHT_PX,
                                             .steps = 64,
                                             .transmittance = NEPH_MARCH_EXACT,
                                             .sun = NEPH_MARCH_EXACT};
    struct neph_image *image = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(test_march_frame(vulkan, scene, &params, &image, NULL, &diag), &diag);
    return image;
}

/* 64 steps of 0.2 m in fog of 0.05 /m are unsure of a hundredth at an edge of a shadow; the faces
 * themselves are those of single floats. A wrong sign of a turn is off by half of the picture. */
static void test_turned_boxes_are_those_of_the_truth(void **state)
{
    struct neph_diag diag = {0};
    struct neph_scene *scene = load("turned_solids"), *still = NULL;
    neph_assert_ok(neph_scene_at(scene, 0, &still, &diag), &diag);
    struct neph_image *image = march(*state, still);
    const struct neph_camera camera = neph_scene_camera(still, 0);
    const float *depth_m = neph_image_channel(image, "Z");
    double error = 0.0, sum = 0.0;
    float *rgb[3];
    neph_image_rgb(image, NULL, rgb);
    for (int i = 0; i < WIDTH_PX * HEIGHT_PX; i++) {
        const struct neph_pixel_ray ray = neph_camera_ray(&camera, WIDTH_PX, HEIGHT_PX,
                                                          i % WIDTH_PX, i / WIDTH_PX);
        const struct neph_ray_light light = neph_transport_ray(still, ray.origin_m, ray.direction);
        const double expected_m = light.hit_m * neph_vec3_dot(ray.direction, camera.forward);
        const double difference = (double)rgb[0][i] - light.radiance.r;
        if (isfinite(expected_m))
            neph_assert_close(depth_m[i], expected_m, 1e-5, 0.0);
        else
            assert_true(isinf(depth_m[i]));
        error += difference * difference;
        sum += light.radiance.r;
    }
    const int pixels = WIDTH_PX * HEIGHT_PX;
    print_message("relative RMSE %.1e\n", sqrt(error / pixels) / (sum / pixels));
    assert_true(sqrt(error / pixels) < 2e-3 * sum / pixels);
    neph_image_destroy(image);
    neph_scene_destroy(still);
    neph_scene_destroy(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_turned_boxes_are_those_of_the_truth),
    };
    return cmocka_run_group_tests(tests, test_vulkan_setup, test_vulkan_teardown);
}
