/* SPDX-License-Identifier: MIT */
#include "renderer/gpu_scene.h"

#include <math.h>
#include <string.h>

/* No float32 leaves the shaders' finite world. */
static float relative_m(double position_m, double camera_m)
{
    const double far_m = NEPH_GPU_FAR_M;
    return (float)fmax(-far_m, fmin(far_m, position_m - camera_m));
}

static void set_position(float out[3], struct neph_vec3 position_m, struct neph_vec3 camera_m)
{
    out[0] = relative_m(position_m.x, camera_m.x);
    out[1] = relative_m(position_m.y, camera_m.y);
    out[2] = relative_m(position_m.z, camera_m.z);
}

static void set_direction(float out[3], struct neph_vec3 direction)
{
    out[0] = (float)direction.x;
    out[1] = (float)direction.y;
    out[2] = (float)direction.z;
}

static void set_rgb(float out[3], struct neph_rgb rgb)
{
    out[0] = (float)rgb.r;
    out[1] = (float)rgb.g;
    out[2] = (float)rgb.b;
}

/* The reference height of a fog layer is a free choice: a e^(-b (y - h)) is the same fog for all
 * (a, h) with a e^(b h) fixed. The camera's own height is the best one, because there y is small
 * and keeps its digits; but no further than 20 scale heights from the layer's own, so that the
 * extinction stays well inside float32. */
struct neph_gpu_fog_layer neph_gpu_fog_layer_from(const struct neph_fog_layer *layer,
                                                  double camera_y_m)
{
    const double scale_heights_max = 20.0;
    const double extinction_max_per_m = 1e20; /* exponent_max in shaders/fog.glsl */
    const double exponent_max = 87.0;         /* e^88.8 is the end of float32 */
    const double extinction_min_per_m = 1e-36;
    double extinction_per_m = layer->extinction_per_m;
    double height_m = layer->height_m;
    if (layer->falloff_per_m > 0.0) {
        const double wanted = layer->falloff_per_m * (camera_y_m - layer->height_m);
        const double moved = fmax(-scale_heights_max, fmin(scale_heights_max, wanted));
        extinction_per_m *= exp(-moved);
        height_m = moved == wanted ? camera_y_m : layer->height_m + moved / layer->falloff_per_m;
    } else {
        height_m = camera_y_m;
    }
    extinction_per_m = fmax(extinction_min_per_m, fmin(extinction_max_per_m, extinction_per_m));
    return (struct neph_gpu_fog_layer){
        .extinction_per_m = (float)extinction_per_m,
        .falloff_per_m = (float)layer->falloff_per_m,
        .height_m = relative_m(height_m, camera_y_m),
        .exponent_max = (float)fmin(exponent_max, log(extinction_max_per_m / extinction_per_m)),
    };
}

struct neph_gpu_solid neph_gpu_solid_from(const struct neph_solid *solid,
                                          struct neph_vec3 camera_position_m)
{
    struct neph_gpu_solid gpu = {
        .kind = (uint32_t)solid->kind,
        .radius_m = (float)solid->radius_m,
    };
    const bool is_box = solid->kind == NEPH_SOLID_BOX;
    set_position(gpu.low_m, is_box ? solid->box.min_m : solid->center_m, camera_position_m);
    set_position(gpu.high_m, is_box ? solid->box.max_m : solid->center_m, camera_position_m);
    set_rgb(gpu.albedo, solid->albedo);
    return gpu;
}

/* Layers without extinction are left out: nothing in the shaders has to expect a 0. */
static struct neph_gpu_medium medium_from(const struct neph_medium *medium,
                                          struct neph_vec3 camera_position_m)
{
    struct neph_gpu_medium gpu = {
        .phase_kind = (uint32_t)medium->phase.kind,
        .g = (float)medium->phase.g,
    };
    set_position(gpu.low_m, medium->bounds.min_m, camera_position_m);
    set_position(gpu.high_m, medium->bounds.max_m, camera_position_m);
    set_rgb(gpu.albedo, medium->albedo);
    for (int i = 0; i < medium->layer_count; i++)
        if (medium->layers[i].extinction_per_m > 0.0)
            gpu.layers[gpu.layer_count++] = neph_gpu_fog_layer_from(&medium->layers[i],
                                                                    camera_position_m.y);
    return gpu;
}

static bool is_black(const float rgb[3])
{
    return rgb[0] <= 0.0f && rgb[1] <= 0.0f && rgb[2] <= 0.0f;
}

struct neph_gpu_frame neph_gpu_frame_from(const struct neph_scene *scene, double frame,
                                          int width_px, int height_px)
{
    const struct neph_camera camera = neph_scene_camera(scene, frame);
    const double tan_half_height = tan(0.5 * camera.vertical_fov_rad);
    struct neph_gpu_frame gpu = {
        .tan_half_width = (float)(tan_half_height * width_px / height_px),
        .tan_half_height = (float)tan_half_height,
        .width_px = (uint32_t)width_px,
        .height_px = (uint32_t)height_px,
        .solid_count = (uint32_t)scene->solid_count,
    };
    set_direction(gpu.camera_right, camera.right);
    set_direction(gpu.camera_up, camera.up);
    set_direction(gpu.camera_forward, camera.forward);
    set_rgb(gpu.background, scene->background_w_per_m2_sr);
    if (scene->sun.present) {
        set_direction(gpu.sun_direction, scene->sun.direction);
        set_rgb(gpu.sun_irradiance, scene->sun.irradiance_w_per_m2);
    }
    bool scatters = false;
    for (int i = 0; i < scene->medium_count; i++) {
        const struct neph_gpu_medium medium = medium_from(&scene->media[i], camera.position_m);
        if (medium.layer_count == 0)
            continue;
        scatters = scatters || !is_black(medium.albedo);
        gpu.media[gpu.medium_count++] = medium;
    }
    gpu.single_scattering = scatters && scene->scattering == NEPH_SCATTERING_SINGLE &&
                            !is_black(gpu.sun_irradiance);
    return gpu;
}
