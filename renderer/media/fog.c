/* SPDX-License-Identifier: MIT */
#include "renderer/media/fog.h"

#include "renderer/media/kind.h"
#include "renderer/relative.h"

#include <math.h>

/* The reference height of a fog layer is arbitrary: a e^(-b (y - h)) is the same fog for all (a, h)
 * with equal a e^(b h). The camera's height is the best choice, because camera-relative y is small
 * there and keeps its precision. It is limited to 20 scale heights from the layer's own, so that
 * the extinction stays in the range of float32. */
struct neph_gpu_fog_layer neph_gpu_fog_layer_from(const struct neph_fog_layer *layer,
                                                  double camera_y_m)
{
    const double scale_heights_max = 20.0;
    const double exponent_max = 87.0; /* float32 overflows at e^88.8 */
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
    extinction_per_m = fmax(extinction_min_per_m, fmin(NEPH_GPU_EXTINCTION_MAX, extinction_per_m));
    return (struct neph_gpu_fog_layer){
        .extinction_per_m = (float)extinction_per_m,
        .falloff_per_m = (float)layer->falloff_per_m,
        .height_m = neph_relative_m(height_m, camera_y_m),
        .exponent_max = (float)fmin(exponent_max, log(NEPH_GPU_EXTINCTION_MAX / extinction_per_m)),
    };
}

/* Omits layers without extinction, so shaders need no test for 0. */
static void pack(const struct neph_medium *medium, struct neph_vec3 camera_m, uint32_t first,
                 struct neph_gpu_medium *gpu)
{
    (void)first;
    for (int i = 0; i < medium->layer_count; i++)
        if (medium->layers[i].extinction_per_m > 0.0)
            gpu->layers[gpu->layer_count++] = neph_gpu_fog_layer_from(&medium->layers[i],
                                                                      camera_m.y);
}

static uint64_t integral_turns(const struct neph_medium *medium)
{
    return (uint64_t)medium->layer_count;
}

/* At the reference heights of the layers. */
static double largest_per_m(const struct neph_medium *medium)
{
    double largest_per_m = 0.0;
    for (int i = 0; i < medium->layer_count; i++)
        largest_per_m = fmax(largest_per_m, medium->layers[i].extinction_per_m);
    return largest_per_m;
}

/* Extinction times distance of a fog layer. From above, the visible surface is where the extinction
 * grows by a factor of e within a mean free path, or the lower bound of the layer. */
static double compute_layer_product(const struct neph_fog_layer *layer,
                                    const struct neph_bounds *box, struct neph_vec3 camera_m,
                                    double *extinction_per_m)
{
    const double b_per_m = layer->falloff_per_m;
    *extinction_per_m = layer->extinction_per_m;
    if (layer->extinction_per_m <= 0.0)
        return 0.0;
    if (b_per_m <= 0.0)
        return layer->extinction_per_m * neph_box_distance_m(box, camera_m);
    const double skin_y_m = layer->height_m + log(layer->extinction_per_m / b_per_m) / b_per_m;
    const double face_per_m = layer->extinction_per_m *
                              exp(-b_per_m * (box->min_m.y - layer->height_m));
    *extinction_per_m = isfinite(box->min_m.y) ? fmax(b_per_m, fmin(face_per_m, 1e20)) : b_per_m;
    if (skin_y_m < box->min_m.y) /* transparent down to its lower bound */
        return face_per_m * neph_box_distance_m(box, camera_m);
    return fmax(*extinction_per_m * neph_box_distance_m(box, camera_m),
                b_per_m * fmax(0.0, camera_m.y - skin_y_m));
}

/* The layer with the largest product. */
static double reach(const struct neph_medium *medium, const struct neph_bounds *support,
                    struct neph_vec3 camera_m, double *extinction_per_m)
{
    double largest = 0.0;
    for (int i = 0; i < medium->layer_count; i++) {
        double layer_per_m;
        const double reach = compute_layer_product(&medium->layers[i], support, camera_m,
                                                   &layer_per_m);
        if (i == 0 || reach > largest) {
            largest = reach;
            *extinction_per_m = layer_per_m;
        }
    }
    return largest;
}

const struct neph_gpu_kind neph_gpu_homogeneous = {
    .layers_max = 1,
    .pack = pack,
    .integral_turns = integral_turns,
    .largest_per_m = largest_per_m,
    .reach = reach,
};

const struct neph_gpu_kind neph_gpu_height_fog = {
    .layers_max = NEPH_FOG_LAYERS_MAX,
    .pack = pack,
    .integral_turns = integral_turns,
    .largest_per_m = largest_per_m,
    .reach = reach,
};
