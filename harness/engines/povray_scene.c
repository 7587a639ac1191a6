/* SPDX-License-Identifier: MIT
 *
 * Writes a scene as POV-Ray text. Behaviour of media in POV-Ray 3.7.0.10 (its media.cpp; measured),
 * and the consequences here:
 * - Scattering is k(cos) * colour * light, k = 4 pi p; a surface is albedo * light * cos. With a
 *   light of E / pi the scattering colour is sigma_s / 4.
 * - Where containers overlap, extinctions and scatterings add, but k is the plain mean of the k of
 *   all media present, absorbers included. So an image contains the scattering of one phase
 *   function only; every other medium in it is an absorber that names the same phase function.
 * - A ray that no light reaches, and every shadow ray, is sampled once if the medium with the most
 *   intervals (the first of them) is uniform. So beside a fog, uniform media get one interval less.
 * - Emission is radiance per unit of length, without a factor. Error of slabs with 200 intervals:
 *   within 2e-5 of 1 - exp(-tau) at tau 0.01 to 4; at tau 10 and 20 it is -(tau / 200)^2 / 24, the
 *   error of the midpoint rule. Uniform emitting media are written as media of varying density:
 *   otherwise they would be sampled once, because they are unlit.
 * - A light of colour C fades by 2 C / (1 + (r / d)^2): 1/r^2 up to a relative error (d / r)^2. For
 *   a spot, `tightness 0` gives the smoothstep of the cosine between `radius` and `falloff`.
 * - Pigment and density functions wrap at 1: the densest point gets 0.999.
 * - Radiosity includes the background and follows mirrors. `reflection` of a colour is the
 *   reflectance of a mirror at every angle; highlights of rough metal follow no law of neph.
 * - Photons reflected by a mirror arrive in a world of 1e4 units, but not in one of 1e6. A photon
 *   has 8 bits per channel and one common exponent.
 * - Method 2 with one sample is the midpoint rule; methods 1 and 3 are random and biased.
 */
#include "harness/engines/povray_scene.h"

#include "harness/engines/baked_scene.h"
#include "harness/engines/povray_exposure.h"
#include "harness/engines/povray_solids.h"
#include "harness/engines/povray_text.h"
#include "scenes/bounds.h"
#include "scenes/emission.h"
#include "scenes/lights.h"
#include "scenes/media.h"
#include "scenes/medium_bounds.h"
#include "scenes/phase_same.h"
#include "scenes/solids.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_POVRAY_KIND_COUNT == 6, "a new kind");
_Static_assert(NEPH_SCATTERING_COUNT == 3, "a new kind");
_Static_assert(NEPH_SOLID_KIND_COUNT == 3, "a new kind");

static const double sun_distance_radii = 2.0; /* no distance exceeds 6e6 units */
static const double density_peak = 0.999;

/* Twice the error of float bounding boxes; see povray_world.c. */
static const double face_margin_units = 4.0;
/* Sizes of cubes around a light, much larger than the 1e-3 units that shadow rays ignore near
 * it. */
static const double hole_units = 0.01;
static const double mask_units = 0.05;
static const double fade_units = 1e-3;

/* ---- phase functions ------------------------------------------------------------------------- */

/* The phase functions of POV-Ray. Its phase factor k(cos) is 4 pi p(cos) times `excess`: Rayleigh's
 * is 0.799372013 (1 + cos^2), with the mean 0.799372013 * 4/3 over the sphere; that of the two of
 * Mie is a factor times 1 + a ((1 + cos) / 2)^n, whose mean is 1 + a / (n + 1). */
static const struct povray_phase {
    enum neph_phase_kind kind;
    int type;
    double excess;
} povray_phases[] = {
    {NEPH_PHASE_ISOTROPIC, 1, 1.0},
    {NEPH_PHASE_HENYEY_GREENSTEIN, 5, 1.0},
    {NEPH_PHASE_RAYLEIGH, 4, 0.799372013 * 4.0 / 3.0},
    {NEPH_PHASE_POVRAY_MIE_HAZY, 2, 0.576655375 * (1.0 + 9.0 / 9.0)},
    {NEPH_PHASE_POVRAY_MIE_MURKY, 3, 0.495714547 * (1.0 + 50.0 / 33.0)},
};

static const struct povray_phase *povray_phase(enum neph_phase_kind kind)
{
    for (size_t i = 0; i < sizeof(povray_phases) / sizeof(povray_phases[0]); i++)
        if (povray_phases[i].kind == kind)
            return &povray_phases[i];
    return NULL;
}

bool neph_povray_has_phase(enum neph_phase_kind kind)
{
    return povray_phase(kind) != NULL;
}

double neph_povray_phase_excess(enum neph_phase_kind kind)
{
    return povray_phase(kind)->excess;
}

/* Radiosity sample points are found before the final render, down to single pixels, and none is
 * added during it: later points would depend on the order of the threads. */
static void write_radiosity(struct neph_povray_writer *writer)
{
    const struct neph_povray_world *world = writer->world;
    neph_povray_write_text(
        writer,
        "  radiosity { count %i error_bound %n pretrace_end %n pretrace_start 0.08 "
        "nearest_count 8 recursion_limit 6 low_error_factor 0.7\n"
        "    brightness 1 gray_threshold 0 minimum_reuse 0.005 maximum_reuse 0.1 "
        "adc_bailout 1e-12 always_sample off }",
        world->radiosity.rays, world->radiosity.error_bound, 1.0 / world->width_px);
    if (neph_povray_has_photons(world->scene))
        neph_povray_write_text(writer, "\n  photons { count %i autostop 0 jitter 0 media 0 }",
                               world->radiosity.photons);
}

static void write_header(struct neph_povray_writer *writer)
{
    neph_povray_write_text(
        writer,
        "// A frame of Nephelometer for POV-Ray 3.7.\n"
        "// World: metres, right-handed, +Y up. POV-Ray's tolerances are fixed lengths, so the\n"
        "// world is blown up: U units are one metre, and O is moved to the origin.\n"
        "#version 3.7;\n"
        "global_settings { assumed_gamma 1.0 max_trace_level 256 adc_bailout 0");
    if (neph_povray_has_radiosity(writer))
        write_radiosity(writer);
    neph_povray_write_text(
        writer, " }\n#declare U = %n;\n#declare O = %v;\n#macro P(A) (U*((A) - O)) #end\n\n",
        writer->world->units_per_m, writer->world->origin_m);
}

/* The lengths of up and right are the sides of the image plane at distance 1; for an orthographic
 * camera, the sides of the view in POV-Ray's units. */
static void write_camera(struct neph_povray_writer *writer)
{
    const struct neph_camera *camera = &writer->world->camera;
    const bool is_parallel = camera->orthographic_height_m > 0.0;
    const double height = is_parallel ? camera->orthographic_height_m * writer->world->units_per_m
                                      : 2.0 * tan(0.5 * camera->vertical_fov_rad);
    const double width = height * writer->world->width_px / writer->world->height_px;
    neph_povray_write_text(writer, "%s\n  location %p\n  right %v\n  up %v\n  direction %v\n}\n\n",
                           is_parallel
                               ? "// Camera: up and right are as long as the picture's sides.\n"
                                 "camera { orthographic"
                               : "// Camera: the lengths of up and right are the angles of view.\n"
                                 "camera { perspective",
                           camera->position_m, neph_vec3_scale(camera->right, width),
                           neph_vec3_scale(camera->up, height), camera->forward);
}

/* Whether sun and lights are part of this image. */
static bool is_lit(const struct neph_povray_writer *writer)
{
    enum neph_povray_kind kind = writer->pass->kind;
    return kind != NEPH_POVRAY_EMISSION && kind != NEPH_POVRAY_TRANSMITTANCE &&
           kind != NEPH_POVRAY_DEPTH;
}

/* ---- containers ------------------------------------------------------------------------------ */

static void box(struct neph_povray_writer *writer, struct neph_bounds bounds)
{
    neph_povray_write_text(writer, "\n  box { %p, %p }", bounds.min_m, bounds.max_m);
}

static struct neph_bounds grown(const struct neph_bounds *bounds, double by_units,
                                const struct neph_povray_writer *writer)
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

/* Write the first parts of a difference: a box whose marked faces are cut from a larger box.
 * POV-Ray's bounding box of a difference is the box of its first part, so the cut, in doubles,
 * decides on which side of a marked face a ray begins. */
static void cut_box(struct neph_povray_writer *writer, const struct neph_bounds *bounds,
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

/* Write the container of a medium. A shadow ray is attenuated where it leaves the medium, so a
 * light inside gets a hole. The hole is a cube: POV-Ray's spheres of that size are lost in
 * rounding. */
static void write_container(struct neph_povray_writer *writer, const struct neph_medium *medium,
                            const struct neph_povray_container *container)
{
    const struct neph_scene *scene = writer->world->scene;
    const struct neph_bounds own = neph_own_container(medium, &container->bounds);
    const struct neph_bounds reach = grown(&own, 2.0 * hole_units, writer);
    bool is_difference = has_marked_face(container);
    for (int i = 0; i < scene->light_count; i++)
        is_difference |= neph_bounds_contain(
            &reach, neph_medium_own_point_m(medium, scene->lights[i].position_m));
    if (!is_difference) {
        neph_povray_write_text(writer, "box { %p, %p", own.min_m, own.max_m);
        return;
    }
    neph_povray_write_text(writer, "difference {");
    cut_box(writer, &own, container->is_near_an_eye);
    for (int i = 0; i < scene->light_count; i++) {
        const struct neph_vec3 at_m = neph_medium_own_point_m(medium, scene->lights[i].position_m);
        const struct neph_bounds point = {at_m, at_m};
        if (neph_bounds_contain(&reach, at_m))
            box(writer, grown(&point, hole_units, writer));
    }
    neph_povray_write_text(writer, "\n ");
}

/* ---- lights ---------------------------------------------------------------------------------- */

/* Whether media scatter light in this image. */
static bool has_scattering(const struct neph_povray_writer *writer)
{
    const enum neph_povray_kind kind = writer->pass->kind;
    return kind == NEPH_POVRAY_VOLUME ||
           (kind == NEPH_POVRAY_BEAUTY && writer->world->scene->scattering != NEPH_SCATTERING_NONE);
}

/* Write the cube around a masked spot: its transparency, as a function of the direction, is the
 * angular falloff of the spot. */
static void write_mask(struct neph_povray_writer *writer, const struct neph_light *light)
{
    static const bool all[3][2] = {{true, true}, {true, true}, {true, true}};
    const struct neph_bounds point = {light->position_m, light->position_m};
    const struct neph_bounds cube = grown(&point, mask_units, writer);
    neph_povray_write_text(writer, "difference {");
    cut_box(writer, &cube, all);
    neph_povray_write_text(writer,
                           "\n  hollow no_image no_reflection\n"
                           "  pigment { function { Soft(min(1, max(0, ((x*(%n) + y*(%n) + z*(%n))"
                           "/sqrt(x*x + y*y + z*z) - (%n))*%n))) }\n"
                           "    color_map { [0 rgbt 0] [%n rgbt 1] } translate %p } "
                           "finish { ambient 0 diffuse 0 } }\n",
                           light->axis.x, light->axis.y, light->axis.z, light->outer_cosine,
                           1.0 / (light->inner_cosine - light->outer_cosine), density_peak,
                           light->position_m);
}

static void write_clear(struct neph_povray_writer *writer)
{
    neph_povray_write_text(
        writer, " hollow no_shadow pigment { rgbt 1 } finish { ambient 0 diffuse 0 } }\n");
}

/* Write an invisible cone that cuts rays at the border of a spot, unless the cone is so wide that
 * it is nearly a plane. */
static void write_cone_cut(struct neph_povray_writer *writer, const struct neph_light *light)
{
    const double length = 2.0 * writer->world->radius_units;
    const double tangent = sqrt(1.0 - light->outer_cosine * light->outer_cosine) /
                           light->outer_cosine;
    if (!(tangent < 10.0))
        return;
    neph_povray_write_text(writer, "cone { %p, 0, %p + %v, %n", light->position_m,
                           light->position_m, neph_vec3_scale(light->axis, length),
                           length * tangent);
    write_clear(writer);
}

/* Write clear cubes, which cut the rays of pixels but no shadow rays. They are one object, whose
 * bounding box is the largest cube. */
static void write_cubes(struct neph_povray_writer *writer,
                        const struct neph_povray_point_light *lamp, struct neph_vec3 at_m)
{
    if (lamp->cube_count == 0)
        return;
    neph_povray_write_text(writer, "union {");
    for (int i = 0; i < lamp->cube_count; i++)
        box(writer, neph_bounds_around(at_m, lamp->half_sides_m[i]));
    neph_povray_write_text(writer, "\n ");
    write_clear(writer);
}

static bool is_masked(const struct neph_povray_writer *writer, int light)
{
    return has_scattering(writer) && writer->world->lamps[light].is_masked;
}

/* Write the objects around lights: masks of spots, and cuts of rays near a light
 * (povray_lamps.h). */
static void write_lamps(struct neph_povray_writer *writer)
{
    const struct neph_scene *scene = writer->world->scene;
    bool is_first = true;
    for (int i = 0; i < scene->light_count && has_scattering(writer); i++) {
        if (is_masked(writer, i)) {
            if (is_first)
                neph_povray_write_text(writer, "#declare Soft = function(x) { %n*x*x*(3 - 2*x) }\n",
                                       density_peak);
            is_first = false;
            write_mask(writer, &scene->lights[i]);
            write_cone_cut(writer, &scene->lights[i]);
        }
        write_cubes(writer, &writer->world->lamps[i], scene->lights[i].position_m);
    }
}

static void write_sun(struct neph_povray_writer *writer)
{
    const struct neph_sun *sun = &writer->world->scene->sun;
    if (!sun->present || !is_lit(writer))
        return;
    neph_povray_write_text(
        writer,
        "// Sun: irradiance / pi, from far outside all else.\n"
        "light_source { %v %l parallel point_at 0 }\n\n",
        neph_vec3_scale(sun->direction, sun_distance_radii * writer->world->radius_units),
        neph_rgb_scale(sun->irradiance_w_per_m2, 1.0 / M_PI));
}

static void write_cone(struct neph_povray_writer *writer, const struct neph_light *light)
{
    if (light->is_spot)
        neph_povray_write_text(writer, " spotlight radius %n falloff %n tightness 0 point_at %p",
                               acos(light->inner_cosine) / NEPH_RAD_PER_DEG,
                               acos(light->outer_cosine) / NEPH_RAD_PER_DEG,
                               neph_vec3_add(light->position_m, light->axis));
}

/* Write the lights. Their colour is scaled like the sun's, for the irradiance at one metre;
 * POV-Ray's fading is 1/2 at `fade_distance`, hence the factor. */
static void write_lights(struct neph_povray_writer *writer)
{
    const struct neph_scene *scene = writer->world->scene;
    const double fades_per_m = writer->world->units_per_m / fade_units;
    for (int i = 0; i < scene->light_count && is_lit(writer); i++) {
        neph_povray_write_text(writer, "light_source { %p %l fade_distance %n fade_power 2",
                               scene->lights[i].position_m,
                               neph_rgb_scale(scene->lights[i].intensity_w_per_sr,
                                              fades_per_m * fades_per_m / (2.0 * M_PI)),
                               fade_units);
        if (!is_masked(writer, i))
            write_cone(writer, &scene->lights[i]);
        neph_povray_write_text(writer, " }\n\n");
    }
}

static void write_background(struct neph_povray_writer *writer)
{
    neph_povray_write_text(writer, "background { ");
    switch (writer->pass->kind) {
    case NEPH_POVRAY_BEAUTY:
    case NEPH_POVRAY_SURFACE:
        neph_povray_write_text(writer, "%l", writer->world->scene->background_w_per_m2_sr);
        break;
    case NEPH_POVRAY_TRANSMITTANCE:
        neph_povray_write_text(writer, "%l", (struct neph_rgb){1.0, 1.0, 1.0});
        break;
    case NEPH_POVRAY_DEPTH:
        neph_povray_write_text(writer, "rgb 1");
        break;
    case NEPH_POVRAY_VOLUME:
    case NEPH_POVRAY_EMISSION:
        neph_povray_write_text(writer, "rgb 0");
        break;
    case NEPH_POVRAY_KIND_COUNT:
        break;
    }
    neph_povray_write_text(writer, " }\n\n");
}

/* ---- media ----------------------------------------------------------------------------------- */

/* Whether the emission of media is part of this image. */
static bool has_emission(const struct neph_povray_writer *writer)
{
    enum neph_povray_kind kind = writer->pass->kind;
    return kind == NEPH_POVRAY_EMISSION ||
           (kind == NEPH_POVRAY_BEAUTY && neph_scene_emits(writer->world->scene));
}

/* Whether a medium is written without a density. */
static bool is_plain(const struct neph_povray_writer *writer, int index)
{
    return writer->world->containers[index].uniform && !has_emission(writer);
}

static bool has_density(const struct neph_povray_writer *writer)
{
    for (int i = 0; i < writer->world->scene->medium_count; i++) {
        if (writer->world->containers[i].used && !is_plain(writer, i))
            return true;
    }
    return false;
}

/* The intervals of a medium. Images without scattering need no shadow rays, so four times as many
 * are affordable. */
static int choose_intervals(const struct neph_povray_writer *writer, bool plain)
{
    enum neph_povray_kind kind = writer->pass->kind;
    int intervals = writer->world->intervals;
    if (kind == NEPH_POVRAY_SURFACE || kind == NEPH_POVRAY_EMISSION ||
        kind == NEPH_POVRAY_TRANSMITTANCE)
        intervals *= 4;
    /* A spot cuts the ray at its cone, and each piece gets at least one interval. */
    const int most = NEPH_POVRAY_INTERVALS_MAX - 4 * writer->world->scene->light_count;
    if (intervals > most)
        intervals = most;
    if (plain && has_density(writer) && intervals > 1)
        intervals--;
    return intervals;
}

/* Write the scattering of a medium in this image: its colour is sigma_s / 4, or 0 if the medium
 * only absorbs in this image; see the top of this file. */
static void write_scattering(struct neph_povray_writer *writer, const struct neph_medium *medium,
                             double extinction_per_unit)
{
    const struct neph_povray_pass *pass = writer->pass;
    bool volume = pass->kind == NEPH_POVRAY_VOLUME;
    if (!volume && (pass->kind != NEPH_POVRAY_BEAUTY ||
                    writer->world->scene->scattering == NEPH_SCATTERING_NONE))
        return;
    const struct neph_phase *phase = volume ? &pass->phase : &medium->phase;
    bool scatters = neph_phase_is_same(phase, &medium->phase);
    const struct povray_phase *own = povray_phase(phase->kind);
    double scale = extinction_per_unit / (4.0 * own->excess);
    neph_povray_write_text(writer, "    scattering { %i, %m", own->type,
                           neph_rgb_scale(neph_rgb_mul(medium->albedo, medium->extinction_color),
                                          scatters ? scale : 0.0));
    if (neph_phase_has(phase->kind, NEPH_PHASE_PARAMETER_G))
        neph_povray_write_text(writer, " eccentricity %n", phase->g);
    neph_povray_write_text(writer, " extinction 0 }\n");
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

/* Write a density from voxels. The file has a layer of zeros on every side. POV-Ray puts node i of
 * N at i / N of a unit cube and interpolates between nodes (notes in scenes/volume_file.h). */
static void write_voxels(struct neph_povray_writer *writer, int index)
{
    const struct neph_grid *grid = writer->world->scene->media[index].grid;
    const struct neph_vec3 h = grid->spacing_m;
    char name[NEPH_POVRAY_FILE_NAME_MAX];
    neph_povray_grid_name(index, name);
    const struct neph_vec3 size_m = {(grid->size[0] + 2) * h.x, (grid->size[1] + 2) * h.y,
                                     (grid->size[2] + 2) * h.z};
    neph_povray_write_text(writer,
                           "    density { density_file df3 \"%s\" interpolate 1\n"
                           "      scale U*%v translate %p }\n",
                           name, size_m, neph_vec3_sub(grid->origin_m, h));
}

/* Write the sum of the fog layers, relative to its value at the bottom of the container. */
static void write_layers(struct neph_povray_writer *writer, const struct neph_medium *medium,
                         const struct neph_povray_container *container)
{
    const struct neph_povray_world *world = writer->world;
    double bottom_m = container->bounds.min_m.y;
    double bottom_units = world->units_per_m * (bottom_m - world->origin_m.y);
    neph_povray_write_text(writer, "    density { function { 0");
    for (int i = 0; i < medium->layer_count; i++) {
        const struct neph_fog_layer *layer = &medium->layers[i];
        double part = neph_fog_layer_per_m(layer, bottom_m) / container->extinction_per_m;
        if (part > 0.0)
            neph_povray_write_text(writer, " + %n*exp(-%n*(y - (%n)))", density_peak * part,
                                   layer->falloff_per_m / world->units_per_m, bottom_units);
    }
    neph_povray_write_text(writer, " } }\n");
}

static void write_comment(struct neph_povray_writer *writer, const struct neph_medium *medium,
                          const struct neph_povray_container *container)
{
    const char *where = container->uniform           ? " per metre.\n"
                        : neph_medium_is_fog(medium) ? " per metre at the bottom, falling.\n"
                                                     : " per metre at the densest.\n";
    neph_povray_write_text(writer, "// Extinction %n%s", container->extinction_per_m, where);
}

/* The extinction per unit of length that belongs to a written density of 1. */
static double extinction_per_unit(const struct neph_povray_writer *writer, int index)
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

static void write_emission(struct neph_povray_writer *writer, const struct neph_medium *medium,
                           double per_unit)
{
    if (has_emission(writer))
        neph_povray_write_text(
            writer, "    emission %l\n",
            neph_rgb_scale(neph_rgb_mul(neph_medium_glow(medium), medium->extinction_color),
                           per_unit));
}

static void write_medium(struct neph_povray_writer *writer, int index)
{
    const struct neph_medium *medium = &writer->world->scene->media[index];
    const struct neph_povray_container *container = &writer->world->containers[index];
    const double per_unit = extinction_per_unit(writer, index);
    write_comment(writer, medium, container);
    write_container(writer, medium, container);
    if (neph_is_container_turned(medium))
        neph_povray_write_turn(writer, &medium->turn, &medium->box);
    neph_povray_write_text(writer,
                           " hollow pigment { rgbt 1 } finish { ambient 0 diffuse 0 }\n"
                           "  interior { media {\n"
                           "    method 2 intervals %i samples 1,1\n",
                           choose_intervals(writer, is_plain(writer, index)));
    neph_povray_write_text(writer, "    absorption %m\n",
                           neph_rgb_scale(medium->extinction_color, per_unit));
    write_emission(writer, medium, per_unit);
    write_scattering(writer, medium, per_unit);
    if (!neph_medium_is_fog(medium))
        write_voxels(writer, index);
    else if (!is_plain(writer, index))
        write_layers(writer, medium, container);
    neph_povray_write_text(writer, "  } }\n}\n\n");
}

static void write_media(struct neph_povray_writer *writer)
{
    const struct neph_povray_world *world = writer->world;
    if (writer->pass->kind == NEPH_POVRAY_DEPTH)
        return;
    for (int i = 0; i < world->scene->medium_count; i++) {
        if (world->containers[i].used)
            write_medium(writer, i);
    }
}

enum neph_status neph_povray_text(const struct neph_povray_world *world,
                                  const struct neph_povray_pass *pass, char **text,
                                  struct neph_diag *diag)
{
    char *memory = NULL;
    size_t size = 0;
    struct neph_povray_writer writer = {
        .stream = open_memstream(&memory, &size), .world = world, .pass = pass};
    if (!writer.stream)
        return neph_fail_memory(diag);
    write_header(&writer);
    write_camera(&writer);
    write_sun(&writer);
    write_lights(&writer);
    write_lamps(&writer);
    write_background(&writer);
    write_media(&writer);
    neph_povray_write_solids(&writer);
    enum neph_status status = NEPH_OK;
    if (fclose(writer.stream) != 0)
        status = neph_fail_memory(diag);
    else if (writer.not_a_number)
        status = neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                           "the scene needs a number outside of POV-Ray's range");
    if (status) {
        free(memory);
        return status;
    }
    *text = memory;
    return NEPH_OK;
}
