/* SPDX-License-Identifier: MIT
 *
 * Homogeneous media and exponential height fog, in closed form. Why the height fog is written the
 * way it is: the textbook a e^{-b y0} (1 - e^{-b k L}) / (b k) cancels for level rays and gives
 * 0 * inf for a camera high above the fog. Taking the density at the *denser* end and
 * phi(x) = (1-e^-x)/x for the rest has neither: the exponential is the largest one needed and phi
 * lies in (0, 1].
 */
#include "scenes/medium_kind.h"

#include <math.h>

static const double ln2 = 0.693147180559945309417232121458;

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
        return density_per_m / fabs(layer->falloff_per_m) / fabs(k_y) * half;
    return density_per_m * (half * (length_m * neph_phi(decay)));
}

/* In logarithms, for the density at y may underflow. */
double neph_fog_layer_distance_m(const struct neph_fog_layer *layer, double y_m, double k_y,
                                 double optical_depth)
{
    if (layer->extinction_per_m == 0.0)
        return INFINITY;
    if (layer->falloff_per_m < 0.0) { /* the same upside down */
        const struct neph_fog_layer mirror = {layer->extinction_per_m, -layer->falloff_per_m,
                                              -layer->height_m};
        return neph_fog_layer_distance_m(&mirror, -y_m, -k_y, optical_depth);
    }
    const double rate_per_m = layer->falloff_per_m * fabs(k_y);
    const double folds = layer->falloff_per_m * (y_m - layer->height_m); /* density at y, as e^- */
    /* The density changes by less than rounding over the way: even. */
    if (!(rate_per_m > 1e-290))
        return optical_depth / (layer->extinction_per_m * exp(-folds));
    const double exponent = log(optical_depth * rate_per_m / layer->extinction_per_m) + folds;
    if (exponent < -690.0)
        return exp(exponent - log(rate_per_m)); /* even, too; e^exponent alone would underflow */
    if (k_y > 0.0)
        return exponent < 0.0 ? -log1p(-exp(exponent)) / rate_per_m : INFINITY;
    return (exponent > 36.0 ? exponent : log1p(exp(exponent))) / rate_per_m;
}

/* Of one layer at a height, which may be infinite in a bound. */
static double layer_extinction_per_m(const struct neph_fog_layer *layer, double y_m)
{
    if (layer->extinction_per_m == 0.0 || layer->falloff_per_m == 0.0)
        return layer->extinction_per_m; /* keeps 0 * inf out */
    return layer->extinction_per_m * exp(-layer->falloff_per_m * (y_m - layer->height_m));
}

static double extinction_per_m(const struct neph_medium *medium, struct neph_vec3 point_m)
{
    double sum_per_m = 0.0;
    for (int i = 0; i < medium->layer_count; i++)
        sum_per_m += layer_extinction_per_m(&medium->layers[i], point_m.y);
    return sum_per_m;
}

static double optical_depth(const struct neph_medium *medium, struct neph_vec3 origin_m,
                            struct neph_vec3 direction, double t0_m, double t1_m)
{
    const double y_m = origin_m.y + t0_m * direction.y;
    double sum = 0.0;
    for (int i = 0; i < medium->layer_count; i++)
        sum += neph_fog_layer_optical_depth(&medium->layers[i], y_m, direction.y, t1_m - t0_m);
    return sum;
}

/* A layer is densest at the bottom, or at the top where it thins out downwards. */
static double bound_per_m(const struct neph_medium *medium, const struct neph_bounds *box)
{
    double sum_per_m = 0.0;
    for (int i = 0; i < medium->layer_count; i++) {
        const struct neph_fog_layer *layer = &medium->layers[i];
        const bool is_mirrored = layer->falloff_per_m < 0.0;
        sum_per_m += layer_extinction_per_m(layer, is_mirrored ? box->max_m.y : box->min_m.y);
    }
    return sum_per_m;
}

static struct neph_bounds support(const struct neph_medium *medium)
{
    return medium->bounds;
}

const struct neph_medium_kind_ops neph_medium_fog = {
    .name = "height fog",
    .closed_form = true,
    .extinction_per_m = extinction_per_m,
    .optical_depth = optical_depth,
    .bound_per_m = bound_per_m,
    .support = support,
    .container = neph_fog_container,
};

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
