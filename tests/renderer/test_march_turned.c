/* SPDX-License-Identifier: MIT
 *
 * Rotated boxes on the device: hits, lighting of their faces and shadows, compared with exact
 * transport in double precision.
 */
#include "tests/renderer/frames.h"

#include "scenes/motion.h"

enum { WIDTH_PX = 48, HEIGHT_PX = 27 };

/* 64 steps of 0.2 m in fog of 0.05 /m give an error of a hundredth at shadow edges; faces have
 * float32 precision. A rotation of the wrong sign would change half of the frame. */
static void test_turned_boxes_are_those_of_the_truth(void **state)
{
    const struct neph_march_params params = {.width_px = WIDTH_PX,
                                             .height_px = HEIGHT_PX,
                                             .steps = 64,
                                             .transmittance = NEPH_MARCH_EXACT,
                                             .sun = NEPH_MARCH_EXACT};
    OWNED(scene) struct neph_scene *scene = test_load("catalog/turned_solids");
    OWNED(scene) struct neph_scene *still = test_still(scene, 0);
    OWNED(image) struct neph_image *image = test_march(*state, still, &params, NULL);
    const struct neph_camera camera = neph_scene_camera(still, 0);
    const float *depth_m = neph_image_channel(image, "Z"), *red = neph_image_channel(image, "R");
    double error = 0.0, sum = 0.0;
    for (int i = 0; i < WIDTH_PX * HEIGHT_PX; i++) {
        const struct neph_pixel_ray ray = test_ray(still, WIDTH_PX, HEIGHT_PX, i);
        const struct neph_ray_light light = neph_transport_ray(still, ray.origin_m, ray.direction);
        const double expected_m = light.hit_m * neph_vec3_dot(ray.direction, camera.forward);
        const double difference = (double)red[i] - light.radiance.r;
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
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_turned_boxes_are_those_of_the_truth),
    };
    return cmocka_run_group_tests(tests, test_vulkan_setup, test_vulkan_teardown);
}
