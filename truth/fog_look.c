/* SPDX-License-Identifier: MIT */
#include "truth/fog_look.h"

#include "scenes/fog_translation.h"
#include "scenes/media.h"

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_FOG_MODEL_COUNT == 2, "a new kind");

/* Limit of the optical depth: an infinite one times 0 would be NaN. */
static const double opaque = 1e300;

static const double ln2 = 0.693147180559945309417232121458;

struct neph_unreal_layer neph_unreal_layer_from_fog(const struct neph_fog_layer *layer)
{
    return (struct neph_unreal_layer){layer->extinction_per_m / (ln2 * ln2),
                                      layer->falloff_per_m / ln2, layer->height_m};
}

/* --- parts ------------------------------------------------------------------------------------ */

double neph_unreal_density_per_m(const struct neph_unreal_layer *layer, double y_m)
{
    const double exponent = layer->falloff_per_m * (y_m - layer->height_m);
    return layer->density_per_m * exp2(-fmax(NEPH_FOG_EXPONENT_MIN, exponent));
}

double neph_unreal_mean(double exponent)
{
    const double f = fmax(NEPH_FOG_EXPONENT_MIN, exponent);
    return fabs(f) > NEPH_FOG_UNREAL_LEVEL ? -expm1(-ln2 * f) / f : ln2 - 0.5 * ln2 * ln2 * f;
}

double neph_filament_depth(const struct neph_fog_layer *layer, double y_m, double k_y,
                           double length_m)
{
    const bool is_level = fabs(layer->falloff_per_m * k_y * length_m) <= NEPH_FOG_FILAMENT_LEVEL;
    if (!is_level)
        return neph_fog_layer_optical_depth(layer, y_m, k_y, length_m);
    return neph_fog_layer_optical_depth(layer, y_m, 0.0, length_m);
}

double neph_fog_lobe(double cosine, double exponent)
{
    return cosine > 0.0 ? pow(fmin(cosine, 1.0), exponent) : 0.0;
}

/* --- a ray segment ---------------------------------------------------------------------------- */

/* The segment from the observer, which a fog model may place elsewhere than the camera. */
struct way {
    double y_m, k_y, length_m;
    struct neph_vec3 direction;
};

static struct way make_fog_segment(const struct neph_fog_look *look, struct neph_vec3 origin_m,
                                   struct neph_vec3 direction, double length_m)
{
    const double drop_m = fmax(0.0, origin_m.y - look->observer_height_max_m);
    struct way way = {origin_m.y - drop_m, direction.y, length_m, direction};
    if (drop_m == 0.0 || isinf(length_m))
        return way;
    struct neph_vec3 seen_m = neph_vec3_scale(direction, length_m);
    seen_m.y += drop_m;
    way.length_m = neph_vec3_length(seen_m);
    if (way.length_m > 0.0) /* the engines' rsqrt(0) is infinite */
        way.direction = neph_vec3_scale(seen_m, 1.0 / way.length_m);
    way.k_y = way.direction.y;
    return way;
}

/* L(rate length) length; for an infinite length L is 1 / (rate length). */
static double unreal_mean_length_m(double rate_per_m, double length_m)
{
    if (!isinf(length_m))
        return neph_unreal_mean(rate_per_m * length_m) * length_m;
    return rate_per_m > 0.0 ? 1.0 / rate_per_m : INFINITY;
}

/* 1 - base^-depth, base given by its logarithm. */
static double lost(double depth, double log_base)
{
    return -expm1(-log_base * fmax(depth, 0.0));
}

/* Light of an optical depth; `begun` is its part that has directional light. */
static struct neph_fog_look_light compute_fog_light(const struct neph_scene *scene,
                                                    const struct neph_fog_look *look,
                                                    const struct way *way, double depth,
                                                    double begun, double log_base)
{
    const struct neph_rgb sky = scene->background_w_per_m2_sr, dim = look->sky_light,
                          own = look->inscattering_w_per_m2_sr, sun = look->directional_w_per_m2_sr;
    const double opacity = fmin(lost(depth, log_base), look->max_opacity);
    double glow = 0.0;
    if (scene->sun.present)
        glow = neph_fog_lobe(neph_vec3_dot(way->direction, scene->sun.direction),
                             look->directional_exponent) *
               lost(begun * depth, log_base);
    return (struct neph_fog_look_light){
        .transmittance = fmax(exp(-log_base * fmax(depth, 0.0)), 1.0 - look->max_opacity),
        .opacity = opacity,
        .volume = {(own.r + dim.r * sky.r) * opacity + sun.r * glow,
                   (own.g + dim.g * sky.g) * opacity + sun.g * glow,
                   (own.b + dim.b * sky.b) * opacity + sun.b * glow},
    };
}

/* The part of a length beyond a start distance. */
static double part_behind(double start_m, double length_m)
{
    return isinf(length_m) ? 1.0 : fmax(0.0, 1.0 - start_m / length_m);
}

static struct neph_fog_look_light unreal(const struct neph_scene *scene,
                                         const struct neph_fog_look *look, const struct way *way)
{
    const double start_m = fmax(look->start_distance_m, look->volumetric_fog_distance_m);
    const double across = hypot(way->direction.x, way->direction.z); /* horizontal distance per
                                                                      * metre of the segment */
    const double end_m = look->end_distance_m > 0.0 ? look->end_distance_m / across : INFINITY;
    const double length_m = fmin(way->length_m, end_m) - start_m;
    double depth = 0.0;
    if (length_m <= 0.0)
        return (struct neph_fog_look_light){.transmittance = 1.0};
    const struct neph_medium *fog = neph_fog_look_find_medium(scene);
    for (int l = 0; l < fog->layer_count; l++) {
        const struct neph_unreal_layer layer = neph_unreal_layer_from_fog(&fog->layers[l]);
        const double at_start_per_m = neph_unreal_density_per_m(&layer,
                                                                way->y_m + start_m * way->k_y);
        if (at_start_per_m > 0.0)
            depth += at_start_per_m *
                     unreal_mean_length_m(layer.falloff_per_m * way->k_y, length_m);
    }
    return compute_fog_light(scene, look, way, fmin(depth, opaque),
                             part_behind(look->directional_start_m, length_m), ln2);
}

static struct neph_fog_look_light filament(const struct neph_scene *scene,
                                           const struct neph_fog_look *look, const struct way *way)
{
    const struct neph_fog_layer *layer = &neph_fog_look_find_medium(scene)->layers[0];
    const double start_m = look->start_distance_m;
    if (way->length_m <= start_m)
        return (struct neph_fog_look_light){.transmittance = 1.0};
    const double whole = fmin(neph_filament_depth(layer, way->y_m, way->k_y, way->length_m),
                              opaque); /* of the whole segment from the camera */
    const double part = part_behind(start_m, way->length_m);
    const double glowing = part_behind(look->directional_start_m, way->length_m);
    return compute_fog_light(scene, look, way, whole * part, part > 0.0 ? glowing / part : 0.0,
                             1.0);
}

/* Switch off controls that a model does not have. */
static struct neph_fog_look mask_unknown_controls(const struct neph_fog_look *look,
                                                  enum neph_fog_model model)
{
    unsigned known = 0;
    for (int c = 0; c < NEPH_FOG_CONTROL_COUNT; c++)
        if (model == NEPH_FOG_UNREAL || neph_fog_controls()[c].filament)
            known |= 1u << c;
    return neph_fog_look_mask_controls(look, known);
}

struct neph_fog_look_light neph_fog_look_ray(const struct neph_scene *scene,
                                             const struct neph_fog_look *look,
                                             enum neph_fog_model model, struct neph_vec3 origin_m,
                                             struct neph_vec3 direction, double length_m)
{
    const struct neph_fog_look known = mask_unknown_controls(look, model);
    const struct way way = make_fog_segment(&known, origin_m, direction, length_m);
    const bool is_cut = known.cutoff_distance_m > 0.0 && way.length_m > known.cutoff_distance_m;
    if (scene->medium_count == 0 || is_cut || way.length_m <= 0.0)
        return (struct neph_fog_look_light){.transmittance = 1.0};
    return model == NEPH_FOG_UNREAL ? unreal(scene, &known, &way) : filament(scene, &known, &way);
}
