/* SPDX-License-Identifier: MIT
 *
 * Homogeneous media and exponential height fog, in closed form. The textbook form of the height
 * fog, a e^{-b y0} (1 - e^{-b k L}) / (b k), cancels for level rays and gives 0 * inf for a camera
 * high above the fog. This file uses the density at the *denser* end of the ray, times phi(x) =
 * (1-e^-x)/x. It has neither problem: the exponential is the largest one that occurs, and phi lies
 * in (0, 1].
 */
#include "scenes/bounds.h"
#include "scenes/column.h"
#include "scenes/load_extinction.h"
#include "scenes/media.h"
#include "scenes/medium_bounds.h"
#include "scenes/medium_kind.h"

#include <math.h>
#include <stddef.h>

#define AT(member) offsetof(struct neph_medium, member)
#define LAYER(member) offsetof(struct neph_fog_layer, member)
#define WRITTEN(member) offsetof(struct written_fog, member)
#define UNREAL(member) offsetof(struct neph_unreal_fog, member)

enum { LAYER_FIELDS_MAX = 16 };

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
    /* The density e^-x is applied in two halves, to the extinction and to the length: each factor
     * may leave the range of a double where their product does not. */
    const double half = exp(-0.5 * layer->falloff_per_m * (dense_y_m - layer->height_m));
    if (half == 0.0)
        return 0.0; /* avoids 0 * inf */
    const double density_per_m = layer->extinction_per_m * half;
    const double decay = fabs(rate_per_m) * length_m;
    /* Beyond e^-40 the end of the ray adds nothing in double, and length may be infinite. */
    if (decay > 40.0)
        return density_per_m / fabs(layer->falloff_per_m) / fabs(k_y) * half;
    return density_per_m * (half * (length_m * neph_phi(decay)));
}

/* In logarithms, because the density at y may underflow. */
double neph_fog_layer_distance_m(const struct neph_fog_layer *layer, double y_m, double k_y,
                                 double optical_depth)
{
    if (layer->extinction_per_m == 0.0)
        return INFINITY;
    if (layer->falloff_per_m < 0.0) { /* mirrored */
        const struct neph_fog_layer mirror = {layer->extinction_per_m, -layer->falloff_per_m,
                                              -layer->height_m};
        return neph_fog_layer_distance_m(&mirror, -y_m, -k_y, optical_depth);
    }
    const double rate_per_m = layer->falloff_per_m * fabs(k_y);
    const double folds = layer->falloff_per_m * (y_m - layer->height_m); /* density at y, as e^- */
    /* Homogeneous: the density changes by less than rounding along the ray. */
    if (!(rate_per_m > 1e-290))
        return optical_depth / (layer->extinction_per_m * exp(-folds));
    const double exponent = log(optical_depth * rate_per_m / layer->extinction_per_m) + folds;
    if (exponent < -690.0)
        return exp(exponent - log(rate_per_m)); /* homogeneous, too; e^exponent would underflow */
    if (k_y > 0.0)
        return exponent < 0.0 ? -log1p(-exp(exponent)) / rate_per_m : INFINITY;
    return (exponent > 36.0 ? exponent : log1p(exp(exponent))) / rate_per_m;
}

/* Extinction of one layer at a height, which may be infinite when a bound is computed. */
static double layer_extinction_per_m(const struct neph_fog_layer *layer, double y_m)
{
    if (layer->extinction_per_m == 0.0 || layer->falloff_per_m == 0.0)
        return layer->extinction_per_m; /* avoids 0 * inf */
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

/* Fog without a lower bound is denser below, without limit. */
static struct neph_column column(const struct neph_medium *medium, int axis)
{
    const struct neph_bounds *bounds = &medium->bounds;
    const double bottom_m = bounds->min_m.y;
    const struct neph_vec3 point_m = {
        0.0, isfinite(bottom_m) ? bottom_m : medium->layers[0].height_m, 0.0};
    return (struct neph_column){.point_m = neph_bounds_nearest(bounds, point_m),
                                .begins_there = axis == 1 && !isfinite(bottom_m)};
}

static struct neph_bounds support(const struct neph_medium *medium)
{
    return medium->bounds;
}

enum { LADDER_COUNT = 9 };

/* Splits at the points where a layer has reached half of its optical depth times 64^-k, from either
 * end. Between two of them its density changes at most 64-fold, or the layer contributes less than
 * 1e-14 of its total. So at any distance and thickness some piece has the layer's scale. */
static void cut_scales(struct neph_cuts *cuts, const struct neph_medium *medium)
{
    double near_m = cuts->t0_m, far_m = cuts->t1_m;
    if (!neph_medium_clip(medium, cuts->origin_m, cuts->direction, &near_m, &far_m))
        return;
    const double k_y = cuts->direction.y;
    const double near_y_m = cuts->origin_m.y + near_m * k_y,
                 far_y_m = cuts->origin_m.y + far_m * k_y;
    for (int l = 0; l < medium->layer_count; l++) {
        const struct neph_fog_layer *layer = &medium->layers[l];
        double step = 0.5 * neph_fog_layer_optical_depth(layer, near_y_m, k_y, far_m - near_m);
        if (layer->falloff_per_m * k_y == 0.0)
            continue; /* constant along the ray */
        for (int k = 0; k < LADDER_COUNT && step > 0.0; k++, step /= 64.0) {
            neph_cuts_add(cuts, near_m + neph_fog_layer_distance_m(layer, near_y_m, k_y, step));
            neph_cuts_add(cuts, far_m - neph_fog_layer_distance_m(layer, far_y_m, -k_y, step));
        }
    }
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

/* --- in a scene file --- */

static const struct neph_field homogeneous_fields[] = {
    {"extinction_per_m", NEPH_NUMBER, AT(layers[0].extinction_per_m), "1/m", 0, 1e4,
     .note = "everywhere", .standard = NEPH_OR_ANOTHER_DENSITY},
    {"bounds", NEPH_RECORD, AT(bounds),
     .note = "a homogeneous medium needs finite bounds: without them the sun, which is infinitely "
             "far away, would never arrive",
     .record = &neph_bounds_record},
    {0},
};

static enum neph_status finish_homogeneous(struct neph_reader *reader, const yaml_node_t *node,
                                           void *written)
{
    struct neph_medium *medium = written;
    (void)reader;
    (void)node;
    medium->layer_count = 1;
    return NEPH_OK;
}

static const struct neph_field layer_fields[] = {
    {"extinction_per_m", NEPH_NUMBER, LAYER(extinction_per_m), "1/m", 0, 1e4, .note = "at height_m",
     .standard = NEPH_OR_ANOTHER_DENSITY, .hashing = NEPH_HASHED_AS_THREE, .hash_name = "layer"},
    {"falloff_per_m", NEPH_NUMBER, LAYER(falloff_per_m), "1/m", 0, 10,
     .note = "a fog that grows denser with height is not modelled"},
    {"height_m", NEPH_NUMBER, LAYER(height_m), "m", -1e5, 1e5,
     .note = "where the layer has extinction_per_m"},
    {0},
};

struct written_layer {
    struct neph_fog_layer layer;
    struct neph_written_density density;
};

struct written_fog {
    struct neph_written_medium common; /* has the layers of unreal_layers */
    int layer_count;
    struct written_layer layers[NEPH_FOG_LAYERS_MAX];
};

static enum neph_status read_layer(struct neph_reader *reader, const yaml_node_t *node,
                                   const struct neph_record *record, void *target)
{
    struct neph_field fields[LAYER_FIELDS_MAX];
    struct written_layer *written = target;
    const int count = neph_gather_fields(record->fields, offsetof(struct written_layer, density),
                                         fields);
    fields[count] = (struct neph_field){0};
    const enum neph_status status = neph_read_fields(reader, node, fields, written);
    return neph_keep_error(reader, status, neph_choose_density(reader, node, &written->density));
}

static const struct neph_record layer_record = {
    .size = sizeof(struct written_layer), .fields = layer_fields, .read = read_layer};

static const struct neph_field unreal_layer_fields[] = {
    {"fog_density", NEPH_NUMBER, UNREAL(fog_density), "(Unreal's UI value)", 0, 10,
     .note = "Fog Density"},
    {"fog_height_falloff", NEPH_NUMBER, UNREAL(fog_height_falloff), "(Unreal's UI value)", 0, 10,
     .note = "Fog Height Falloff"},
    {"fog_height_m", NEPH_NUMBER, UNREAL(fog_height_m), "m", -1e5, 1e5,
     .note = "Fog Height Offset"},
    {0},
};

static enum neph_status read_unreal_layer(struct neph_reader *reader, const yaml_node_t *node,
                                          const struct neph_record *record, void *target)
{
    struct neph_unreal_fog unreal;
    const enum neph_status status = neph_read_fields(reader, node, record->fields, &unreal);
    if (!status)
        *(struct neph_fog_layer *)target = neph_fog_layer_from_unreal(&unreal);
    return status;
}

static const struct neph_record unreal_layer_record = {.size = sizeof(struct neph_fog_layer),
                                                       .fields = unreal_layer_fields,
                                                       .read = read_unreal_layer};

static const struct neph_field height_fog_fields[] = {
    {"layers", NEPH_ENTRIES, WRITTEN(layers), .note = "they add", .least = 1,
     .most = NEPH_FOG_LAYERS_MAX, .count_at = WRITTEN(layer_count), .record = &layer_record,
     .standard = "needed, or `unreal_layers`"},
    {"unreal_layers", NEPH_ENTRIES, AT(layers), .note = "in their place", .least = 1,
     .most = NEPH_FOG_LAYERS_MAX, .count_at = AT(layer_count), .record = &unreal_layer_record,
     .standard = "none"},
    {"bounds", NEPH_RECORD, AT(bounds), .record = &neph_bounds_record, .standard = "unbounded"},
    {0},
};

/* Each layer's optical depth is its own, within the bounds of the medium. */
static enum neph_status finish_layers(const struct neph_reader *reader, struct written_fog *written)
{
    struct neph_medium *medium = &written->common.medium;
    enum neph_status status = NEPH_OK;
    medium->layer_count = written->layer_count;
    for (int i = 0; i < written->layer_count; i++) {
        const struct written_layer *layer = &written->layers[i];
        medium->layers[i] = layer->layer;
        medium->droplets[i] = layer->density.radii;
        struct neph_medium one = neph_medium_of_layer(medium, i);
        const struct neph_path path = neph_format_path("layers[%d]", i);
        status = neph_keep_error(reader, status,
                                 neph_apply_density(reader, path.text, &layer->density, &one,
                                                    &one.layers[0].extinction_per_m));
        medium->layers[i] = one.layers[0];
    }
    return status;
}

static enum neph_status refuse_level_fog(const struct neph_reader *reader, const char *path)
{
    const enum neph_status status = neph_refuse(
        reader, path, "0 makes the layer the same at all heights, and the fog has no bounds");
    neph_hint(
        reader->diag,
        "give bounds: without them the sun, which is infinitely far away, would never arrive");
    return status;
}

static enum neph_status finish_height_fog(struct neph_reader *reader, const yaml_node_t *node,
                                          void *written)
{
    const struct neph_medium *medium = written;
    const bool has_layers = neph_reader_has(reader, node, "layers");
    enum neph_status status = NEPH_OK;
    if (has_layers == neph_reader_has(reader, node, "unreal_layers"))
        return neph_refuse(reader, "", "give exactly one of layers, unreal_layers");
    if (has_layers)
        status = finish_layers(reader, written);
    if (status || neph_reader_has(reader, node, "bounds"))
        return status;
    for (int i = 0; i < medium->layer_count; i++)
        if (medium->layers[i].falloff_per_m == 0.0 && medium->layers[i].extinction_per_m > 0.0)
            return refuse_level_fog(
                reader, neph_format_path(has_layers ? "layers[%d].falloff_per_m"
                                                    : "unreal_layers[%d].fog_height_falloff",
                                         i)
                            .text);
    return NEPH_OK;
}

static void hash(const struct neph_medium *medium, FILE *text)
{
    for (int i = 0; i < medium->layer_count; i++)
        neph_fields_hash(layer_fields, &medium->layers[i], text);
}

const struct neph_medium_row neph_medium_homogeneous = {
    .facts = {.name = "homogeneous medium",
              .place = "everywhere",
              .is_fog = true,
              .is_even = true,
              .has_closed_form = true,
              .majorant_cells = NEPH_MAJORANT_CELLS},
    .forms = {{"homogeneous", "the same everywhere within its bounds", homogeneous_fields,
               .finish = finish_homogeneous}},
    .extinction_per_m = extinction_per_m,
    .optical_depth = optical_depth,
    .bound_per_m = bound_per_m,
    .column = column,
    .support = support,
    .container = neph_fog_container,
    .cut_scales = cut_scales,
    .hash = hash,
};

const struct neph_medium_row neph_medium_height_fog = {
    .facts = {.name = "height fog",
              .place = "at height_m",
              .is_fog = true,
              .has_closed_form = true,
              .majorant_cells = NEPH_MAJORANT_CELLS},
    .forms = {{"height_fog", "extinction_per_m * exp(-falloff_per_m * (y - height_m))",
               height_fog_fields, sizeof(struct written_fog), finish_height_fog}},
    .extinction_per_m = extinction_per_m,
    .optical_depth = optical_depth,
    .bound_per_m = bound_per_m,
    .column = column,
    .support = support,
    .container = neph_fog_container,
    .cut_scales = cut_scales,
    .hash = hash,
};
