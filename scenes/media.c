/* SPDX-License-Identifier: MIT
 *
 * Closed-form optical depths. Why the height fog is written the way it is: the textbook
 * a e^{-b y0} (1 - e^{-b k L}) / (b k) cancels for level rays and gives 0 * inf for a camera high
 * above the fog that looks down. Taking the density at the *denser* end and phi(x) = (1-e^-x)/x
 * for the rest has neither: the exponential is the largest one needed and phi lies in (0, 1].
 */
#include "scenes/media.h"

#include <math.h>

static const double ln2 = 0.693147180559945309417232121458;
static const double pi = 3.14159265358979323846264338328;

double neph_phi(double x)
{
    if (x == 0.0)
        return 1.0;
    if (x < -700.0) {                        /* e^-x may overflow where e^-x / -x does not */
        const double size = fmin(-x, 800.0); /* e^800/800 is infinite */
        const double half = exp(0.5 * size);
        return half / size * half;
    }
    return -expm1(-x) / x;
}

double neph_fog_layer_optical_depth(const struct neph_fog_layer *layer, double y_m, double k_y,
                                    double length_m)
{
    if (layer->extinction_per_m == 0.0 || length_m <= 0.0)
        return 0.0;
    const double rate_per_m = layer->falloff_per_m * k_y; /* > 0: thins out along the ray */
    if (isinf(length_m) && rate_per_m <= 0.0)
        return INFINITY;
    const double dense_y_m = rate_per_m >= 0.0 ? y_m : y_m + k_y * length_m;
    /* The density e^-x is applied in two halves, to the extinction and to the length: either alone
     * may leave the range of a double where their product does not. */
    const double half = exp(-0.5 * layer->falloff_per_m * (dense_y_m - layer->height_m));
    if (half == 0.0)
        return 0.0; /* keeps 0 * inf out */
    const double density_per_m = layer->extinction_per_m * half;
    const double decay = fabs(rate_per_m) * length_m;
    /* Beyond e^-40 the end of the ray adds nothing in double, and length may be infinite. */
    if (decay > 40.0)
        return density_per_m / layer->falloff_per_m / fabs(k_y) * half;
    return density_per_m * (half * (length_m * neph_phi(decay)));
}

static bool bounds_contain(const struct neph_bounds *bounds, struct neph_vec3 p)
{
    return p.x >= bounds->min_m.x && p.x <= bounds->max_m.x && p.y >= bounds->min_m.y &&
           p.y <= bounds->max_m.y && p.z >= bounds->min_m.z && p.z <= bounds->max_m.z;
}

double neph_medium_extinction_per_m(const struct neph_medium *medium, struct neph_vec3 point_m)
{
    if (!bounds_contain(&medium->bounds, point_m))
        return 0.0;
    double extinction_per_m = 0.0;
    for (int i = 0; i < medium->layer_count; i++) {
        const struct neph_fog_layer *layer = &medium->layers[i];
        if (layer->extinction_per_m > 0.0)
            extinction_per_m += layer->extinction_per_m *
                                exp(-layer->falloff_per_m * (point_m.y - layer->height_m));
    }
    return extinction_per_m;
}

bool neph_clip_axis(double minimum, double maximum, double origin, double direction, double *t0,
                    double *t1)
{
    if (direction == 0.0)
        return origin >= minimum && origin <= maximum;
    double near = (minimum - origin) / direction;
    double far = (maximum - origin) / direction;
    if (direction < 0.0) {
        const double swap = near;
        near = far;
        far = swap;
    }
    *t0 = fmax(*t0, near);
    *t1 = fmin(*t1, far);
    return *t0 < *t1;
}

bool neph_bounds_clip(const struct neph_bounds *bounds, struct neph_vec3 origin_m,
                      struct neph_vec3 direction, double *t0_m, double *t1_m)
{
    return *t0_m < *t1_m &&
           neph_clip_axis(bounds->min_m.x, bounds->max_m.x, origin_m.x, direction.x, t0_m, t1_m) &&
           neph_clip_axis(bounds->min_m.y, bounds->max_m.y, origin_m.y, direction.y, t0_m, t1_m) &&
           neph_clip_axis(bounds->min_m.z, bounds->max_m.z, origin_m.z, direction.z, t0_m, t1_m);
}

double neph_medium_optical_depth(const struct neph_medium *medium, struct neph_vec3 origin_m,
                                 struct neph_vec3 direction, double t0_m, double t1_m)
{
    if (!neph_bounds_clip(&medium->bounds, origin_m, direction, &t0_m, &t1_m))
        return 0.0;
    const double y_m = origin_m.y + t0_m * direction.y;
    double optical_depth = 0.0;
    for (int i = 0; i < medium->layer_count; i++)
        optical_depth += neph_fog_layer_optical_depth(&medium->layers[i], y_m, direction.y,
                                                      t1_m - t0_m);
    return optical_depth;
}

struct neph_rgb neph_scene_optical_depth(const struct neph_scene *scene, struct neph_vec3 origin_m,
                                         struct neph_vec3 direction, double t0_m, double t1_m)
{
    struct neph_rgb sum = {0, 0, 0};
    for (int i = 0; i < scene->medium_count; i++) {
        const struct neph_medium *medium = &scene->media[i];
        const double optical_depth = neph_medium_optical_depth(medium, origin_m, direction, t0_m,
                                                               t1_m);
        if (optical_depth > 0.0) /* 0 * inf: a channel that is not attenuated stays so */
            sum = neph_rgb_add(sum, neph_rgb_attenuation(medium->extinction_color, optical_depth));
    }
    return sum;
}

static double henyey_greenstein_per_sr(double g, double cosine)
{
    /* 1 + g^2 - 2 g c without its cancellation at the peak, for either sign of g. */
    const double base = g >= 0.0 ? (1.0 - g) * (1.0 - g) + 2.0 * g * (1.0 - cosine)
                                 : (1.0 + g) * (1.0 + g) - 2.0 * g * (1.0 + cosine);
    return (1.0 - g) * (1.0 + g) / (4.0 * pi * base * sqrt(base));
}

double neph_phase_per_sr(const struct neph_phase *phase, double cosine)
{
    switch (phase->kind) {
    case NEPH_PHASE_HENYEY_GREENSTEIN:
        return henyey_greenstein_per_sr(phase->g, fmin(1.0, fmax(-1.0, cosine)));
    case NEPH_PHASE_RAYLEIGH:
        return 3.0 / (16.0 * pi) * (1.0 + cosine * cosine);
    case NEPH_PHASE_ISOTROPIC:
        break;
    }
    return 1.0 / (4.0 * pi);
}

/* The UI divides density and falloff by 1000 and counts in centimetres: /10 per metre. */
static const double unreal_ui_per_m = 0.1;

struct neph_fog_layer neph_fog_layer_from_unreal(const struct neph_unreal_fog *unreal)
{
    return (struct neph_fog_layer){
        .extinction_per_m = ln2 * ln2 * unreal_ui_per_m * unreal->fog_density,
        .falloff_per_m = ln2 * unreal_ui_per_m * unreal->fog_height_falloff,
        .height_m = unreal->fog_height_m,
    };
}

struct neph_unreal_fog neph_fog_layer_to_unreal(const struct neph_fog_layer *layer)
{
    return (struct neph_unreal_fog){
        .fog_density = layer->extinction_per_m / (ln2 * ln2 * unreal_ui_per_m),
        .fog_height_falloff = layer->falloff_per_m / (ln2 * unreal_ui_per_m),
        .fog_height_m = layer->height_m,
    };
}
