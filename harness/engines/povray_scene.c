/* SPDX-License-Identifier: MIT
 *
 * What POV-Ray 3.7.0.10 does with media (its media.cpp; measured), and what follows here:
 * - Scattering is k(cos) * colour * light, k = 4 pi p; a surface is albedo * light * cos. With a
 *   light of E / pi the colour of the scattering is sigma_s / 4.
 * - Where containers overlap, extinctions and scatterings add, but k is the plain mean of the k of
 *   all media present, absorbers included. So a picture holds the scattering of one phase function
 *   only, and every other medium in it is an absorber that names the same phase function.
 * - A ray that no light reaches, and every shadow ray, is sampled once when the medium with the
 *   most intervals (the first of them) is uniform. So beside a fog, uniform media ask for one
 *   interval less.
 * - Emission is radiance per unit of length, without a factor. Slabs with 200 intervals: within
 *   2e-5 of 1 - exp(-tau) at tau 0.01 to 4, and by -(tau / 200)^2 / 24, which is the midpoint
 *   rule's, at 10 and 20. Uniform media that emit are written as media of uneven density: unlit,
 *   they would be sampled once.
 * - A light of colour C fades by 2 C / (1 + (r / d)^2): 1/r^2 to (d / r)^2.
 *   Of a spot `tightness 0` leaves the smoothstep of the cosine between `radius` and `falloff`.
 * - Pigment and density functions wrap at 1: the densest place gets 0.999.
 * - Radiosity has the light of the background, too, and follows mirrors. `reflection` of a colour
 *   is that of a mirror at every angle; the highlights of rough metal are of no law of ours.
 * - Photons that a mirror throws arrive in a world of 1e4 units, and in one of 1e6 they do not. A
 *   photon has 8 bits a channel and one exponent for all three.
 * - Method 2 with one sample is the midpoint rule; methods 1 and 3 are random and biased.
 */
#include "harness/engines/povray_scene.h"

#include "harness/engines/povray_exposure.h"
#include "scenes/bounds.h"
#include "scenes/emission.h"
#include "scenes/lights.h"
#include "scenes/media.h"
#include "scenes/solids.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_PATTERN_COUNT == 2, "a new kind");
_Static_assert(NEPH_POVRAY_KIND_COUNT == 6, "a new kind");
_Static_assert(NEPH_SCATTERING_COUNT == 3, "a new kind");
_Static_assert(NEPH_SOLID_KIND_COUNT == 2, "a new kind");

static const double sun_distance_radii = 2.0; /* no distance exceeds 6e6 units */
static const double density_peak = 0.999;

/* Twice what float bounding boxes are off; see povray_world.c. */
static const double face_margin_units = 4.0;
/* Cubes around a light, far more than the 1e-3 units that shadow rays ignore beside it. */
static const double hole_units = 0.01;
static const double mask_units = 0.05;
static const double fade_units = 1e-3;

/* ---- Phase functions ------------------------------------------------------------------------ */

bool neph_povray_same_phase(const struct neph_phase *a, const struct neph_phase *b)
{
    return a->kind == b->kind && (!neph_phase_has_asymmetry(a->kind) || a->g == b->g);
}

double neph_povray_phase_excess(enum neph_phase_kind kind)
{
    switch (kind) {
    case NEPH_PHASE_RAYLEIGH:
        return 0.799372013 * 4.0 / 3.0; /* the mean over the sphere of 0.799372013 (1 + cos^2) */
    case NEPH_PHASE_ISOTROPIC:
    case NEPH_PHASE_HENYEY_GREENSTEIN:
        return 1.0;
    case NEPH_PHASE_KIND_COUNT:
        break;
    }
    return NAN;
}

static int povray_phase_type(enum neph_phase_kind kind)
{
    switch (kind) {
    case NEPH_PHASE_ISOTROPIC:
        return 1;
    case NEPH_PHASE_HENYEY_GREENSTEIN:
        return 5;
    case NEPH_PHASE_RAYLEIGH:
        return 4;
    case NEPH_PHASE_KIND_COUNT:
        break;
    }
    return 0;
}

/* ---- The text ------------------------------------------------------------------------------- */

struct writer {
    FILE *stream;
    const struct neph_povray_world *world;
    const struct neph_povray_pass *pass;
    bool not_a_number; /* something infinite or undefined was to be written */
};

/* Everything but fixed words goes through here. */
static void number(struct writer *writer, double value)
{
    if (!isfinite(value))
        writer->not_a_number = true;
    fprintf(writer->stream, "%.17g", value);
}

static void words(struct writer *writer, const char *fixed)
{
    fputs(fixed, writer->stream);
}

static void triple(struct writer *writer, double a, double b, double c)
{
    words(writer, "<");
    number(writer, a);
    words(writer, ", ");
    number(writer, b);
    words(writer, ", ");
    number(writer, c);
    words(writer, ">");
}

static void vector(struct writer *writer, struct neph_vec3 v)
{
    triple(writer, v.x, v.y, v.z);
}

/* A position in metres, which the macro P brings to units. */
static void position(struct writer *writer, struct neph_vec3 position_m)
{
    words(writer, "P(");
    vector(writer, position_m);
    words(writer, ")");
}

static void named_number(struct writer *writer, const char *before, double value, const char *after)
{
    words(writer, before);
    number(writer, value);
    words(writer, after);
}

/* "rgb <...>": a colour of the beauty as it is; else gain * value in three brackets, but for
 * photons, which would lose the darkest of them. */
static void colour(struct writer *writer, struct neph_rgb value)
{
    double gain = writer->pass->gain;
    words(writer, "rgb ");
    if (writer->pass->kind == NEPH_POVRAY_BEAUTY) {
        triple(writer, gain * value.r, gain * value.g, gain * value.b);
        return;
    }
    double bright = gain * neph_povray_component(value, writer->pass->channel);
    if (neph_povray_has_photons(writer->world->scene)) {
        triple(writer, bright, bright, bright);
        return;
    }
    triple(writer, neph_povray_bracket_scales[0] * bright, neph_povray_bracket_scales[1] * bright,
           neph_povray_bracket_scales[2] * bright);
}

/* "rgb <...>": a property of matter, without gain. */
static void property(struct writer *writer, struct neph_rgb value)
{
    words(writer, "rgb ");
    if (writer->pass->kind == NEPH_POVRAY_BEAUTY) {
        triple(writer, value.r, value.g, value.b);
        return;
    }
    double grey = neph_povray_component(value, writer->pass->channel);
    triple(writer, grey, grey, grey);
}

/* Is light between solids part of this picture? */
static bool has_radiosity(const struct writer *writer)
{
    return writer->world->radiosity.rays > 0 &&
           (writer->pass->kind == NEPH_POVRAY_BEAUTY || writer->pass->kind == NEPH_POVRAY_SURFACE);
}

/* Places are found before the picture, down to each pixel, and none is added while it is made: that
 * would depend on the order of its threads. */
static void write_radiosity(struct writer *writer)
{
    const struct neph_povray_world *world = writer->world;
    named_number(writer, "  radiosity { count ", world->radiosity.rays, "");
    named_number(writer, " error_bound ", world->radiosity.error_bound, "");
    named_number(writer, " pretrace_end ", 1.0 / world->width_px, "");
    words(writer, " pretrace_start 0.08 nearest_count 8 recursion_limit 6 low_error_factor 0.7\n"
                  "    brightness 1 gray_threshold 0 minimum_reuse 0.005 maximum_reuse 0.1 "
                  "adc_bailout 1e-12 always_sample off }");
    if (neph_povray_has_photons(world->scene))
        named_number(writer, "\n  photons { count ", world->radiosity.photons,
                     " autostop 0 jitter 0 media 0 }");
}

static void write_header(struct writer *writer)
{
    words(writer,
          "// A frame of Nephelometer for POV-Ray 3.7.\n"
          "// World: metres, right-handed, +Y up. POV-Ray's tolerances are fixed lengths, so the\n"
          "// world is blown up: U units are one metre, and O is moved to the origin.\n"
          "#version 3.7;\n"
          "global_settings { assumed_gamma 1.0 max_trace_level 256 adc_bailout 0");
    if (has_radiosity(writer))
        write_radiosity(writer);
    words(writer, " }\n");
    named_number(writer, "#declare U = ", writer->world->units_per_m, ";\n");
    words(writer, "#declare O = ");
    vector(writer, writer->world->origin_m);
    words(writer, ";\n#macro P(A) (U*((A) - O)) #end\n\n");
}

/* The lengths of up and right are the sides of the picture at the distance 1, or those of an
 * orthographic one in POV-Ray's units. */
static void write_camera(struct writer *writer)
{
    const struct neph_camera *camera = &writer->world->camera;
    const bool is_parallel = camera->orthographic_height_m > 0.0;
    const double height = is_parallel ? camera->orthographic_height_m * writer->world->units_per_m
                                      : 2.0 * tan(0.5 * camera->vertical_fov_rad);
    const double width = height * writer->world->width_px / writer->world->height_px;
    words(writer, is_parallel ? "// Camera: up and right are as long as the picture's sides.\n"
                                "camera { orthographic\n  location "
                              : "// Camera: the lengths of up and right are the angles of view.\n"
                                "camera { perspective\n  location ");
    position(writer, camera->position_m);
    words(writer, "\n  right ");
    vector(writer, neph_vec3_scale(camera->right, width));
    words(writer, "\n  up ");
    vector(writer, neph_vec3_scale(camera->up, height));
    words(writer, "\n  direction ");
    vector(writer, camera->forward);
    words(writer, "\n}\n\n");
}

/* Are sun and lights part of this picture? */
static bool is_lit(const struct writer *writer)
{
    enum neph_povray_kind kind = writer->pass->kind;
    return kind != NEPH_POVRAY_EMISSION && kind != NEPH_POVRAY_TRANSMITTANCE &&
           kind != NEPH_POVRAY_DEPTH;
}

/* ---- Containers ------------------------------------------------------------------------------ */

static void corners(struct writer *writer, const struct neph_bounds *bounds)
{
    position(writer, bounds->min_m);
    words(writer, ", ");
    position(writer, bounds->max_m);
}

static void box(struct writer *writer, struct neph_bounds bounds)
{
    words(writer, "\n  box { ");
    corners(writer, &bounds);
    words(writer, " }");
}

static struct neph_bounds grown(const struct neph_bounds *bounds, double by_units,
                                const struct writer *writer)
{
    const double by_m = by_units / writer->world->units_per_m;
    const struct neph_vec3 by = {by_m, by_m, by_m};
    return (struct neph_bounds){neph_vec3_sub(bounds->min_m, by), neph_vec3_add(bounds->max_m, by)};
}

/* Copy the lower (0) or upper (1) face of `from` across `axis` to that side of `to`. */
static void copy_face(struct neph_bounds *to, int to_side, const struct neph_bounds *from,
                      int from_side, int axis)
{
    const struct neph_vec3 plane_m = from_side ? from->max_m : from->min_m;
    neph_povray_set_axis(to_side ? &to->max_m : &to->min_m, axis, neph_povray_axis(plane_m, axis));
}

/* The first parts of a difference: a box whose marked faces are cut from a larger one. POV-Ray's
 * bounding box of a difference is its first part's; which side of a marked face a ray begins on is
 * then decided by the cut, in doubles. */
static void cut_box(struct writer *writer, const struct neph_bounds *bounds,
                    const bool is_marked[3][2])
{
    const struct neph_bounds large = grown(bounds, face_margin_units, writer);
    struct neph_bounds first = *bounds;
    for (int face = 0; face < 6; face++)
        if (is_marked[face / 2][face % 2])
            copy_face(&first, face % 2, &large, face % 2, face / 2);
    box(writer, first);
    for (int face = 0; face < 6; face++) {
        struct neph_bounds beyond = grown(&large, face_margin_units, writer);
        copy_face(&beyond, 1 - face % 2, bounds, face % 2, face / 2);
        if (is_marked[face / 2][face % 2])
            box(writer, beyond);
    }
}

static bool has_marked_face(const struct neph_povray_container *container)
{
    for (int face = 0; face < 6; face++)
        if (container->is_near_an_eye[face / 2][face % 2])
            return true;
    return false;
}

/* A shadow ray is attenuated where it leaves a medium: around a light inside there is a hole for it
 * to leave by. A cube, for POV-Ray's spheres of that size are lost in their rounding. */
static void write_container(struct writer *writer, const struct neph_povray_container *container)
{
    const struct neph_scene *scene = writer->world->scene;
    const struct neph_bounds reach = grown(&container->bounds, 2.0 * hole_units, writer);
    bool is_difference = has_marked_face(container);
    for (int i = 0; i < scene->light_count; i++)
        is_difference |= neph_bounds_contain(&reach, scene->lights[i].position_m);
    if (!is_difference) {
        words(writer, "box { ");
        corners(writer, &container->bounds);
        return;
    }
    words(writer, "difference {");
    cut_box(writer, &container->bounds, container->is_near_an_eye);
    for (int i = 0; i < scene->light_count; i++) {
        const struct neph_vec3 at_m = scene->lights[i].position_m;
        const struct neph_bounds point = {at_m, at_m};
        if (neph_bounds_contain(&reach, at_m))
            box(writer, grown(&point, hole_units, writer));
    }
    words(writer, "\n ");
}

/* ---- Lights ---------------------------------------------------------------------------------- */

/* Do media scatter light in this picture? */
static bool has_scattering(const struct writer *writer)
{
    const enum neph_povray_kind kind = writer->pass->kind;
    return kind == NEPH_POVRAY_VOLUME ||
           (kind == NEPH_POVRAY_BEAUTY && writer->world->scene->scattering != NEPH_SCATTERING_NONE);
}

/* What a spot lets through of a light all around, at a place x, y, z from it. */
static void write_mask(struct writer *writer, const struct neph_light *light)
{
    static const bool all[3][2] = {{true, true}, {true, true}, {true, true}};
    const struct neph_bounds point = {light->position_m, light->position_m};
    const struct neph_bounds cube = grown(&point, mask_units, writer);
    words(writer, "difference {");
    cut_box(writer, &cube, all);
    words(writer, "\n  hollow no_image no_reflection\n"
                  "  pigment { function { Soft(min(1, max(0, ((x*(");
    named_number(writer, "", light->axis.x, ") + y*(");
    named_number(writer, "", light->axis.y, ") + z*(");
    named_number(writer, "", light->axis.z, "))/sqrt(x*x + y*y + z*z) - (");
    named_number(writer, "", light->outer_cosine, "))*");
    named_number(writer, "", 1.0 / (light->inner_cosine - light->outer_cosine), "))) }\n");
    named_number(writer, "    color_map { [0 rgbt 0] [", density_peak, " rgbt 1] } translate ");
    position(writer, light->position_m);
    words(writer, " } finish { ambient 0 diffuse 0 } }\n");
}

static void write_clear(struct writer *writer)
{
    words(writer, " hollow no_shadow pigment { rgbt 1 } finish { ambient 0 diffuse 0 } }\n");
}

/* Where a ray enters or leaves a cone, where it is wide enough not to be a plane. */
static void write_cone_cut(struct writer *writer, const struct neph_light *light)
{
    const double length = 2.0 * writer->world->radius_units;
    const double tangent = sqrt(1.0 - light->outer_cosine * light->outer_cosine) /
                           light->outer_cosine;
    if (!(tangent < 10.0))
        return;
    words(writer, "cone { ");
    position(writer, light->position_m);
    words(writer, ", 0, ");
    position(writer, light->position_m);
    words(writer, " + ");
    vector(writer, neph_vec3_scale(light->axis, length));
    named_number(writer, ", ", length * tangent, "");
    write_clear(writer);
}

/* Clear cubes, which cut the rays of pixels and no shadow ray. As one object, whose bounding box is
 * the largest. */
static void write_cubes(struct writer *writer, const struct neph_povray_lamp *lamp,
                        struct neph_vec3 at_m)
{
    if (lamp->cube_count == 0)
        return;
    words(writer, "union {");
    for (int i = 0; i < lamp->cube_count; i++)
        box(writer, neph_bounds_around(at_m, lamp->half_sides_m[i]));
    words(writer, "\n ");
    write_clear(writer);
}

static bool is_masked(const struct writer *writer, int light)
{
    return has_scattering(writer) && writer->world->lamps[light].is_masked;
}

/* Beside the sources of light: masks of spots, and what cuts rays near a light (povray_lamps.h). */
static void write_lamps(struct writer *writer)
{
    const struct neph_scene *scene = writer->world->scene;
    bool is_first = true;
    for (int i = 0; i < scene->light_count && has_scattering(writer); i++) {
        if (is_masked(writer, i)) {
            if (is_first)
                words(writer, "#declare Soft = function(x) { ");
            if (is_first)
                named_number(writer, "", density_peak, "*x*x*(3 - 2*x) }\n");
            is_first = false;
            write_mask(writer, &scene->lights[i]);
            write_cone_cut(writer, &scene->lights[i]);
        }
        write_cubes(writer, &writer->world->lamps[i], scene->lights[i].position_m);
    }
}

static void write_sun(struct writer *writer)
{
    const struct neph_sun *sun = &writer->world->scene->sun;
    if (!sun->present || !is_lit(writer))
        return;
    words(writer, "// Sun: irradiance / pi, from far outside all else.\nlight_source { ");
    vector(writer,
           neph_vec3_scale(sun->direction, sun_distance_radii * writer->world->radius_units));
    words(writer, " ");
    colour(writer, neph_rgb_scale(sun->irradiance_w_per_m2, 1.0 / M_PI));
    words(writer, " parallel point_at 0 }\n\n");
}

static void write_cone(struct writer *writer, const struct neph_light *light)
{
    if (!light->is_spot)
        return;
    named_number(writer, " spotlight radius ", acos(light->inner_cosine) / NEPH_RAD_PER_DEG, "");
    named_number(writer, " falloff ", acos(light->outer_cosine) / NEPH_RAD_PER_DEG, "");
    words(writer, " tightness 0 point_at ");
    position(writer, neph_vec3_add(light->position_m, light->axis));
}

/* As the sun's, of the irradiance at one metre: 1/2 of what it is at `fade_distance`. */
static void write_lights(struct writer *writer)
{
    const struct neph_scene *scene = writer->world->scene;
    const double fades_per_m = writer->world->units_per_m / fade_units;
    for (int i = 0; i < scene->light_count && is_lit(writer); i++) {
        words(writer, "light_source { ");
        position(writer, scene->lights[i].position_m);
        words(writer, " ");
        colour(writer, neph_rgb_scale(scene->lights[i].intensity_w_per_sr,
                                      fades_per_m * fades_per_m / (2.0 * M_PI)));
        named_number(writer, " fade_distance ", fade_units, " fade_power 2");
        if (!is_masked(writer, i))
            write_cone(writer, &scene->lights[i]);
        words(writer, " }\n\n");
    }
}

static void write_background(struct writer *writer)
{
    words(writer, "background { ");
    switch (writer->pass->kind) {
    case NEPH_POVRAY_BEAUTY:
    case NEPH_POVRAY_SURFACE:
        colour(writer, writer->world->scene->background_w_per_m2_sr);
        break;
    case NEPH_POVRAY_TRANSMITTANCE:
        colour(writer, (struct neph_rgb){1.0, 1.0, 1.0});
        break;
    case NEPH_POVRAY_DEPTH:
        words(writer, "rgb 1");
        break;
    case NEPH_POVRAY_VOLUME:
    case NEPH_POVRAY_EMISSION:
        words(writer, "rgb 0");
        break;
    case NEPH_POVRAY_KIND_COUNT:
        break;
    }
    words(writer, " }\n\n");
}

/* ---- Media ---------------------------------------------------------------------------------- */

/* Is light that media emit part of this picture? */
static bool has_emission(const struct writer *writer)
{
    enum neph_povray_kind kind = writer->pass->kind;
    return kind == NEPH_POVRAY_EMISSION ||
           (kind == NEPH_POVRAY_BEAUTY && neph_scene_emits(writer->world->scene));
}

/* Is a medium written without a density? */
static bool is_plain(const struct writer *writer, int index)
{
    return writer->world->containers[index].uniform && !has_emission(writer);
}

static bool has_density(const struct writer *writer)
{
    for (int i = 0; i < writer->world->scene->medium_count; i++) {
        if (writer->world->containers[i].used && !is_plain(writer, i))
            return true;
    }
    return false;
}

/* Where no medium scatters, no sample needs a shadow ray, and four times as many are cheap. */
static int intervals_of(const struct writer *writer, bool plain)
{
    enum neph_povray_kind kind = writer->pass->kind;
    int intervals = writer->world->intervals;
    if (kind == NEPH_POVRAY_SURFACE || kind == NEPH_POVRAY_EMISSION ||
        kind == NEPH_POVRAY_TRANSMITTANCE)
        intervals *= 4;
    /* A spot cuts the ray at its cone, and each piece gets an interval at least. */
    const int most = NEPH_POVRAY_INTERVALS_MAX - 4 * writer->world->scene->light_count;
    if (intervals > most)
        intervals = most;
    if (plain && has_density(writer) && intervals > 1)
        intervals--;
    return intervals;
}

/* The scattering of one medium in this picture: its colour is sigma_s / 4, or 0 where the medium
 * only absorbs; see the top of this file. */
static void write_scattering(struct writer *writer, const struct neph_medium *medium,
                             double extinction_per_unit)
{
    const struct neph_povray_pass *pass = writer->pass;
    bool volume = pass->kind == NEPH_POVRAY_VOLUME;
    if (!volume && (pass->kind != NEPH_POVRAY_BEAUTY ||
                    writer->world->scene->scattering == NEPH_SCATTERING_NONE))
        return;
    const struct neph_phase *phase = volume ? &pass->phase : &medium->phase;
    bool scatters = neph_povray_same_phase(phase, &medium->phase);
    double scale = extinction_per_unit / (4.0 * neph_povray_phase_excess(phase->kind));
    named_number(writer, "    scattering { ", povray_phase_type(phase->kind), ", ");
    property(writer, neph_rgb_scale(neph_rgb_mul(medium->albedo, medium->extinction_color),
                                    scatters ? scale : 0.0));
    if (neph_phase_has_asymmetry(phase->kind))
        named_number(writer, " eccentricity ", phase->g, "");
    words(writer, " extinction 0 }\n");
}

void neph_povray_grid_name(int index, char name[NEPH_POVRAY_FILE_NAME_MAX])
{
    snprintf(name, NEPH_POVRAY_FILE_NAME_MAX, "medium%d.df3", index + 1);
}

struct neph_grid neph_povray_grid(const struct neph_grid *grid)
{
    struct neph_grid scaled = *grid;
    scaled.maximum = (float)(grid->maximum / density_peak);
    return scaled;
}

/* The file has a layer of zeros on every side; POV-Ray puts node i of N at i / N of a unit cube and
 * interpolates between nodes (notes in scenes/volume_file.h). */
static void write_voxels(struct writer *writer, int index)
{
    const struct neph_grid *grid = writer->world->scene->media[index].grid;
    const struct neph_vec3 h = grid->spacing_m;
    char name[NEPH_POVRAY_FILE_NAME_MAX];
    neph_povray_grid_name(index, name);
    words(writer, "    density { density_file df3 \"");
    words(writer, name);
    words(writer, "\" interpolate 1\n      scale U*");
    triple(writer, (grid->size[0] + 2) * h.x, (grid->size[1] + 2) * h.y, (grid->size[2] + 2) * h.z);
    words(writer, " translate ");
    position(writer, neph_vec3_sub(grid->origin_m, h));
    words(writer, " }\n");
}

/* The sum of the layers, relative to its value at the bottom of the container. */
static void write_layers(struct writer *writer, const struct neph_medium *medium,
                         const struct neph_povray_container *container)
{
    const struct neph_povray_world *world = writer->world;
    double bottom_m = container->bounds.min_m.y;
    double bottom_units = world->units_per_m * (bottom_m - world->origin_m.y);
    words(writer, "    density { function { 0");
    for (int i = 0; i < medium->layer_count; i++) {
        const struct neph_fog_layer *layer = &medium->layers[i];
        double part = neph_povray_layer_per_m(layer, bottom_m) / container->extinction_per_m;
        if (!(part > 0.0))
            continue;
        named_number(writer, " + ", density_peak * part, "");
        named_number(writer, "*exp(-", layer->falloff_per_m / world->units_per_m, "");
        named_number(writer, "*(y - (", bottom_units, ")))");
    }
    words(writer, " } }\n");
}

static void write_comment(struct writer *writer, const struct neph_medium *medium,
                          const struct neph_povray_container *container)
{
    const char *where = container->uniform           ? " per metre.\n"
                        : neph_medium_is_fog(medium) ? " per metre at the bottom, falling.\n"
                                                     : " per metre at the densest.\n";
    named_number(writer, "// Extinction ", container->extinction_per_m, where);
}

/* Extinction of density 1 as the density is written, per unit of length. */
static double extinction_per_unit(const struct writer *writer, int index)
{
    const struct neph_povray_world *world = writer->world;
    const struct neph_medium *medium = &world->scene->media[index];
    const struct neph_povray_container *container = &world->containers[index];
    if (!neph_medium_is_fog(medium))
        return medium->extinction_per_m * (double)neph_povray_grid(medium->grid).maximum /
               world->units_per_m;
    const double per_unit = container->extinction_per_m / world->units_per_m;
    return is_plain(writer, index) ? per_unit : per_unit / density_peak;
}

static void write_emission(struct writer *writer, const struct neph_medium *medium, double per_unit)
{
    if (!has_emission(writer))
        return;
    words(writer, "    emission ");
    colour(writer, neph_rgb_scale(neph_rgb_mul(neph_medium_glow(medium), medium->extinction_color),
                                  per_unit));
    words(writer, "\n");
}

static void write_medium(struct writer *writer, int index)
{
    const struct neph_medium *medium = &writer->world->scene->media[index];
    const struct neph_povray_container *container = &writer->world->containers[index];
    const double per_unit = extinction_per_unit(writer, index);
    write_comment(writer, medium, container);
    write_container(writer, container);
    words(writer, " hollow pigment { rgbt 1 } finish { ambient 0 diffuse 0 }\n"
                  "  interior { media {\n");
    named_number(writer, "    method 2 intervals ", intervals_of(writer, is_plain(writer, index)),
                 " samples 1,1\n");
    words(writer, "    absorption ");
    property(writer, neph_rgb_scale(medium->extinction_color, per_unit));
    words(writer, "\n");
    write_emission(writer, medium, per_unit);
    write_scattering(writer, medium, per_unit);
    if (!neph_medium_is_fog(medium))
        write_voxels(writer, index);
    else if (!is_plain(writer, index))
        write_layers(writer, medium, container);
    words(writer, "  } }\n}\n\n");
}

static void write_media(struct writer *writer)
{
    const struct neph_povray_world *world = writer->world;
    if (writer->pass->kind == NEPH_POVRAY_DEPTH)
        return;
    for (int i = 0; i < world->scene->medium_count; i++) {
        if (world->containers[i].used)
            write_medium(writer, i);
    }
}

/* ---- Solids --------------------------------------------------------------------------------- */

/* One digit of the depth: depth / range * base^place, wrapped at 1 by POV-Ray, in one channel. The
 * mean of three pigments is a third of their sum. */
static void write_digit(struct writer *writer, int place)
{
    static const char *const channels[] = {"<3,0,0>", "<0,3,0>", "<0,0,3>"};
    const struct neph_povray_world *world = writer->world;
    struct neph_vec3 forward = world->camera.forward;
    struct neph_vec3 eye_m = neph_vec3_sub(world->camera.position_m, world->origin_m);
    struct neph_vec3 eye = neph_vec3_scale(eye_m, world->units_per_m);
    double scale = pow(NEPH_POVRAY_DEPTH_BASE, place) / (world->depth_range_m * world->units_per_m);
    named_number(writer, "  [1 function { (", scale, ")");
    named_number(writer, "*((x - (", eye.x, "))");
    named_number(writer, "*(", forward.x, ")");
    named_number(writer, " + (y - (", eye.y, "))");
    named_number(writer, "*(", forward.y, ")");
    named_number(writer, " + (z - (", eye.z, "))");
    named_number(writer, "*(", forward.z, ")) } color_map { [0 rgb 0] [1 rgb ");
    words(writer, channels[place]);
    words(writer, "] }]\n");
}

static void declare_depth_texture(struct writer *writer)
{
    words(writer, "#declare Depth = texture { pigment { average pigment_map {\n");
    for (int place = 0; place < 3; place++)
        write_digit(writer, place);
    words(writer, "} } finish { ambient 0 diffuse 0 emission 1 } }\n\n");
}

/* What a lit solid does with light, behind its pigment. */
static void write_finish(struct writer *writer, const struct neph_solid *solid)
{
    const double metalness = solid->surface.metalness;
    named_number(writer, " finish { ambient 0 diffuse ", 1.0 - metalness, "");
    if (metalness > 0.0) {
        words(writer, " reflection { ");
        property(writer, neph_rgb_scale(solid->albedo, metalness));
        words(writer, " }");
    }
    words(writer, " }");
}

static void write_texture(struct writer *writer, const struct neph_solid *solid)
{
    switch (writer->pass->kind) {
    case NEPH_POVRAY_DEPTH:
        words(writer, " texture { Depth }");
        break;
    case NEPH_POVRAY_TRANSMITTANCE:
        words(writer, " pigment { ");
        colour(writer, (struct neph_rgb){1.0, 1.0, 1.0});
        words(writer, " } finish { ambient 0 diffuse 0 emission 1 }");
        break;
    case NEPH_POVRAY_VOLUME:
    case NEPH_POVRAY_EMISSION:
        words(writer, " pigment { rgb 0 } finish { ambient 0 diffuse 0 }");
        break;
    case NEPH_POVRAY_BEAUTY:
    case NEPH_POVRAY_SURFACE:
        words(writer, " pigment { ");
        property(writer, solid->albedo);
        words(writer, " }");
        write_finish(writer, solid);
        break;
    case NEPH_POVRAY_KIND_COUNT:
        break;
    }
}

/* Whether the pass shows what a pattern looks like. */
static bool shows_paint(const struct writer *writer, const struct neph_solid *solid)
{
    return neph_is_textured(&solid->surface) &&
           (writer->pass->kind == NEPH_POVRAY_BEAUTY || writer->pass->kind == NEPH_POVRAY_SURFACE);
}

/* By the face of a place in cells from the middle of the box: `across_z`, `across_y` and
 * `across_x`, functions of the two coordinates in that face. A face is where |x|, |y| or |z| is
 * half of the side. */
static void write_by_face(struct writer *writer, const struct neph_solid *box, const char *across_z,
                          const char *across_y, const char *across_x)
{
    static const double within = 1.0 - 1e-9; /* POV-Ray's places on a face are rounded */
    const struct neph_vec3 side_m = neph_vec3_sub(box->box.max_m, box->box.min_m);
    const double half = 0.5 / box->surface.texture.cell_m * within;
    named_number(writer, "select(abs(x) - ", half * side_m.x, ", ");
    named_number(writer, "select(abs(y) - ", half * side_m.y, ", ");
    words(writer, across_z);
    words(writer, ", ");
    words(writer, across_y);
    words(writer, "), ");
    words(writer, across_x);
    words(writer, ")");
}

/* Patterns wrap at 1, so the two values are 1/4 and 3/4. */
static void write_checker(struct writer *writer, const struct neph_solid *box)
{
    words(writer, " function { 0.25 + 0.5*abs(mod(");
    write_by_face(writer, box, "floor(x) + floor(y)", "floor(x) + floor(z)", "floor(y) + floor(z)");
    words(writer, ", 2)) } color_map { [0.5 ");
    property(writer, box->albedo);
    words(writer, "] [0.5 ");
    property(writer, box->surface.texture.other);
    words(writer, "] }");
}

/* The file's nodes, with zeros around them, lie at (i + 1) / (NEPH_NOISE_CELLS + 3) of a unit cube,
 * its layer at 1/3 (as in write_voxels). */
static void write_noise(struct writer *writer, const struct neph_solid *box)
{
    const struct neph_paint *noise = &box->surface.texture;
    named_number(writer, " function { 0.999*Noise", noise->seed, "(Cell(");
    write_by_face(writer, box, "x", "x", "y");
    words(writer, "), Cell(");
    write_by_face(writer, box, "y", "z", "z");
    words(writer, "), 1/3) } color_map { [0 ");
    property(writer, box->albedo);
    words(writer, "] [0.999 ");
    property(writer, noise->other);
    words(writer, "] }");
}

static bool is_noise(const struct neph_solid *solid)
{
    return neph_is_textured(&solid->surface) &&
           solid->surface.texture.pattern == NEPH_PATTERN_NOISE;
}

/* A pattern turns along where it stands before the turn. */
static void write_paint(struct writer *writer, const struct neph_solid *box)
{
    words(writer, " pigment {");
    if (is_noise(box))
        write_noise(writer, box);
    else
        write_checker(writer, box);
    named_number(writer, " scale U*", box->surface.texture.cell_m, " translate ");
    position(writer, neph_vec3_scale(neph_vec3_add(box->box.min_m, box->box.max_m), 0.5));
    words(writer, " }");
    write_finish(writer, box);
}

/* Before the texture, which does not turn along. Row i of POV-Ray's matrix is what becomes of unit
 * vector i. */
static void write_turn(struct writer *writer, const struct neph_solid *box)
{
    const struct neph_vec3 middle_m = neph_vec3_scale(neph_vec3_add(box->box.min_m, box->box.max_m),
                                                      0.5);
    if (!neph_is_turned(&box->turn))
        return;
    words(writer, " translate -");
    position(writer, middle_m);
    words(writer, " matrix <");
    for (int axis = 0; axis < 3; axis++) {
        const struct neph_vec3 unit = {axis == 0, axis == 1, axis == 2};
        const struct neph_vec3 row = neph_turned(&box->turn, unit);
        for (int i = 0; i < 3; i++)
            named_number(writer, "", neph_povray_axis(row, i), ", ");
    }
    words(writer, "0, 0, 0> translate ");
    position(writer, middle_m);
}

static void write_solid(struct writer *writer, const struct neph_solid *solid)
{
    if (solid->kind == NEPH_SOLID_BOX) {
        words(writer, "box { ");
        position(writer, solid->box.min_m);
        words(writer, ", ");
        position(writer, solid->box.max_m);
        if (shows_paint(writer, solid))
            write_paint(writer, solid);
        write_turn(writer, solid);
    } else {
        words(writer, "sphere { ");
        position(writer, solid->center_m);
        named_number(writer, ", U*", solid->radius_m, "");
    }
    if (!shows_paint(writer, solid))
        write_texture(writer, solid);
    if (has_radiosity(writer) && neph_is_mirror(&solid->surface))
        words(writer, " photons { target reflection on refraction off collect off }");
    words(writer, " }\n");
}

void neph_povray_noise_name(int seed, char name[NEPH_POVRAY_FILE_NAME_MAX])
{
    snprintf(name, NEPH_POVRAY_FILE_NAME_MAX, "noise%d.df3", seed);
}

enum neph_status neph_povray_noise(int seed, struct neph_grid **grid, struct neph_diag *diag)
{
    const int size[3] = {NEPH_NOISE_CELLS + 1, NEPH_NOISE_CELLS + 1, 1};
    struct neph_grid *made = NULL;
    enum neph_status status = neph_grid_create(size, (struct neph_vec3){0, 0, 0},
                                               (struct neph_vec3){1, 1, 1}, &made, diag);
    for (int j = 0; j < size[1] && !status; j++)
        for (int i = 0; i < size[0]; i++)
            made->values[j * size[0] + i] = (float)neph_noise_value(seed, i, j);
    if (!status) {
        made->maximum = 1.0F; /* what the file's largest number stands for */
        *grid = made;
    }
    return status;
}

static bool is_first_of_seed(const struct neph_scene *scene, int index)
{
    for (int i = 0; i < index; i++)
        if (is_noise(&scene->solids[i]) &&
            scene->solids[i].surface.texture.seed == scene->solids[index].surface.texture.seed)
            return false;
    return true;
}

/* Noise of each seed, and where a coordinate lies in its file. */
static void declare_noises(struct writer *writer)
{
    const struct neph_scene *scene = writer->world->scene;
    bool is_first = true;
    for (int i = 0; i < scene->solid_count; i++) {
        const int seed = scene->solids[i].surface.texture.seed;
        char name[NEPH_POVRAY_FILE_NAME_MAX];
        if (!is_noise(&scene->solids[i]) || !is_first_of_seed(scene, i))
            continue;
        if (is_first) {
            named_number(writer, "#declare Cell = function(x) { (x - ", NEPH_NOISE_CELLS, "*");
            named_number(writer, "floor(x/", NEPH_NOISE_CELLS, ") + 1)");
            named_number(writer, "/", NEPH_NOISE_CELLS + 3, " }\n");
        }
        is_first = false;
        neph_povray_noise_name(seed, name);
        named_number(writer, "#declare Noise", seed, " = function { pattern { density_file df3 \"");
        words(writer, name);
        words(writer, "\" interpolate 1 } }\n");
    }
}

static void write_solids(struct writer *writer)
{
    const struct neph_scene *scene = writer->world->scene;
    if (writer->pass->kind == NEPH_POVRAY_BEAUTY || writer->pass->kind == NEPH_POVRAY_SURFACE)
        declare_noises(writer);
    if (scene->solid_count > 0 && writer->pass->kind == NEPH_POVRAY_DEPTH)
        declare_depth_texture(writer);
    if (scene->solid_count > 0)
        words(writer, "// Solids.\n");
    for (int i = 0; i < scene->solid_count; i++)
        write_solid(writer, &scene->solids[i]);
}

enum neph_status neph_povray_text(const struct neph_povray_world *world,
                                  const struct neph_povray_pass *pass, char **text,
                                  struct neph_diag *diag)
{
    char *memory = NULL;
    size_t size = 0;
    struct writer writer = {.stream = open_memstream(&memory, &size), .world = world, .pass = pass};
    if (!writer.stream)
        return neph_fail_memory(diag);
    write_header(&writer);
    write_camera(&writer);
    write_sun(&writer);
    write_lights(&writer);
    write_lamps(&writer);
    write_background(&writer);
    write_media(&writer);
    write_solids(&writer);
    enum neph_status status = NEPH_OK;
    if (fclose(writer.stream) != 0)
        status = neph_fail_memory(diag);
    else if (writer.not_a_number)
        status = neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                           "the scene needs a number that POV-Ray cannot take");
    if (status) {
        free(memory);
        return status;
    }
    *text = memory;
    return NEPH_OK;
}
