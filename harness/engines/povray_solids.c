/* SPDX-License-Identifier: MIT */
#include "harness/engines/povray_solids.h"

#include "harness/engines/povray_exposure.h"
#include "harness/engines/povray_mesh.h"
#include "scenes/mesh.h"
#include "scenes/solids.h"
#include "scenes/surfaces.h"

#include <math.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_PATTERN_COUNT == 2, "a new kind");
_Static_assert(NEPH_POVRAY_KIND_COUNT == 6, "a new kind");
_Static_assert(NEPH_SOLID_KIND_COUNT == 3, "a new kind");

static bool is_cut_out(const struct neph_solid *solid)
{
    return solid && solid->kind == NEPH_SOLID_MESH &&
           solid->mesh->material.alpha != NEPH_ALPHA_IGNORED;
}

/* Write the values of a digit. Within a cut-out, functions would have its uv for x and y: so the
 * cut-outs are within the functions. */
static void write_digit_map(struct neph_povray_writer *writer, const char *channel,
                            const struct neph_solid *solid)
{
    const char *colors[2] = {"<0,0,0>", channel};
    if (!is_cut_out(solid)) {
        neph_povray_write_text(writer, "color_map { [0 rgb 0] [1 rgb %s] }]\n", channel);
        return;
    }
    neph_povray_write_text(writer, "pigment_map {");
    for (int i = 0; i < 2; i++) {
        neph_povray_write_text(writer, " [%i", i);
        neph_povray_write_alpha(writer, solid);
        neph_povray_write_text(writer, " color_map { [0.5 rgbt 1] [0.5 rgb %s] }]", colors[i]);
    }
    neph_povray_write_text(writer, " }]\n");
}

/* Write one digit of the depth in one channel: depth / range * base^place, wrapped at 1 by POV-Ray.
 * The factor 3 compensates the mean of three pigments. */
static void write_digit(struct neph_povray_writer *writer, int place,
                        const struct neph_solid *solid)
{
    static const char *const channels[] = {"<3,0,0>", "<0,3,0>", "<0,0,3>"};
    const struct neph_povray_world *world = writer->world;
    struct neph_vec3 forward = world->camera.forward;
    struct neph_vec3 eye_m = neph_vec3_sub(world->camera.position_m, world->origin_m);
    struct neph_vec3 eye = neph_vec3_scale(eye_m, world->units_per_m);
    double scale = pow(NEPH_POVRAY_DEPTH_BASE, place) / (world->depth_range_m * world->units_per_m);
    neph_povray_write_text(
        writer, "  [1 function { (%n)*((x - (%n))*(%n) + (y - (%n))*(%n) + (z - (%n))*(%n)) } ",
        scale, eye.x, forward.x, eye.y, forward.y, eye.z, forward.z);
    write_digit_map(writer, channels[place], solid);
}

/* `solid` NULL: one without holes. */
static void write_depth_texture(struct neph_povray_writer *writer, const struct neph_solid *solid)
{
    neph_povray_write_text(writer, " texture { pigment { average pigment_map {\n");
    for (int place = 0; place < 3; place++)
        write_digit(writer, place, solid);
    neph_povray_write_text(writer, "} } finish { ambient 0 diffuse 0 emission 1 } }");
}

static void declare_depth_texture(struct neph_povray_writer *writer)
{
    neph_povray_write_text(writer, "#declare Depth =");
    write_depth_texture(writer, NULL);
    neph_povray_write_text(writer, "\n\n");
}

/* Write the finish of a lit solid: its reflection properties, after its pigment. */
static void write_finish(struct neph_povray_writer *writer, const struct neph_solid *solid)
{
    const double metalness = solid->surface.metalness;
    neph_povray_write_text(writer, " finish { ambient 0 diffuse %n", 1.0 - metalness);
    if (metalness > 0.0)
        neph_povray_write_text(writer, " reflection { %m }",
                               neph_rgb_scale(solid->albedo, metalness));
    neph_povray_write_text(writer, " }");
}

static void write_texture(struct neph_povray_writer *writer, const struct neph_solid *solid)
{
    if (is_cut_out(solid) && writer->pass->kind == NEPH_POVRAY_DEPTH) {
        write_depth_texture(writer, solid);
        return;
    }
    if (is_cut_out(solid))
        neph_povray_start_cutout(writer, solid);
    switch (writer->pass->kind) {
    case NEPH_POVRAY_DEPTH:
        neph_povray_write_text(writer, " texture { Depth }");
        break;
    case NEPH_POVRAY_TRANSMITTANCE:
        neph_povray_write_text(writer, " pigment { %l } finish { ambient 0 diffuse 0 emission 1 }",
                               (struct neph_rgb){1.0, 1.0, 1.0});
        break;
    case NEPH_POVRAY_VOLUME:
    case NEPH_POVRAY_EMISSION:
        neph_povray_write_text(writer, " pigment { rgb 0 } finish { ambient 0 diffuse 0 }");
        break;
    case NEPH_POVRAY_BEAUTY:
    case NEPH_POVRAY_SURFACE:
        if (solid->kind == NEPH_SOLID_MESH && solid->mesh->material.texture)
            neph_povray_write_mesh_pigment(writer, solid);
        else
            neph_povray_write_text(writer, " pigment { %m }", solid->albedo);
        write_finish(writer, solid);
        break;
    case NEPH_POVRAY_KIND_COUNT:
        break;
    }
    if (is_cut_out(solid))
        neph_povray_end_cutout(writer);
}

/* Whether the pass shows the solid's texture. */
static bool shows_paint(const struct neph_povray_writer *writer, const struct neph_solid *solid)
{
    return neph_is_textured(&solid->surface) &&
           (writer->pass->kind == NEPH_POVRAY_BEAUTY || writer->pass->kind == NEPH_POVRAY_SURFACE);
}

/* Select by the face of a point: `across_z`, `across_y` or `across_x`, each a function of the two
 * coordinates in that face. Coordinates are in cells from the centre of the box; on a face |x|, |y|
 * or |z| is half of the side. */
static void write_by_face(struct neph_povray_writer *writer, const struct neph_solid *box,
                          const char *across_z, const char *across_y, const char *across_x)
{
    static const double within = 1.0 - 1e-9; /* POV-Ray's points on a face are rounded */
    const struct neph_vec3 side_m = neph_vec3_sub(box->box.max_m, box->box.min_m);
    const double half = 0.5 / box->surface.texture.cell_m * within;
    neph_povray_write_text(writer, "select(abs(x) - %n, select(abs(y) - %n, %s, %s), %s)",
                           half * side_m.x, half * side_m.y, across_z, across_y, across_x);
}

/* Write a checker. Patterns wrap at 1, so the two values are 1/4 and 3/4. */
static void write_checker(struct neph_povray_writer *writer, const struct neph_solid *box)
{
    neph_povray_write_text(writer, " function { 0.25 + 0.5*abs(mod(");
    write_by_face(writer, box, "floor(x) + floor(y)", "floor(x) + floor(z)", "floor(y) + floor(z)");
    neph_povray_write_text(writer, ", 2)) } color_map { [0.5 %m] [0.5 %m] }", box->albedo,
                           box->surface.texture.other);
}

/* Write a noise. Its nodes, with zeros around them, lie at (i + 1) / (NEPH_NOISE_CELLS + 3) of a
 * unit cube, its layer at 1/3 (as in write_voxels). */
static void write_noise(struct neph_povray_writer *writer, const struct neph_solid *box)
{
    const struct neph_paint *noise = &box->surface.texture;
    neph_povray_write_text(writer, " function { 0.999*Noise%i(Cell(", noise->seed);
    write_by_face(writer, box, "x", "x", "y");
    neph_povray_write_text(writer, "), Cell(");
    write_by_face(writer, box, "y", "z", "z");
    neph_povray_write_text(writer, "), 1/3) } color_map { [0 %m] [0.999 %m] }", box->albedo,
                           noise->other);
}

static bool is_noise(const struct neph_solid *solid)
{
    return neph_is_textured(&solid->surface) &&
           solid->surface.texture.pattern == NEPH_PATTERN_NOISE;
}

/* Write a texture. It is evaluated at the place before the rotation, so it turns with the solid. */
static void write_paint(struct neph_povray_writer *writer, const struct neph_solid *box)
{
    neph_povray_write_text(writer, " pigment {");
    if (is_noise(box))
        write_noise(writer, box);
    else
        write_checker(writer, box);
    neph_povray_write_text(writer, " scale U*%n translate %p }", box->surface.texture.cell_m,
                           neph_vec3_scale(neph_vec3_add(box->box.min_m, box->box.max_m), 0.5));
    write_finish(writer, box);
}

static void write_solid(struct neph_povray_writer *writer, const struct neph_solid *solid)
{
    switch (solid->kind) {
    case NEPH_SOLID_BOX:
        neph_povray_write_text(writer, "box { %p, %p", solid->box.min_m, solid->box.max_m);
        if (shows_paint(writer, solid))
            write_paint(writer, solid);
        neph_povray_write_turn(writer, &solid->turn, &solid->box);
        break;
    case NEPH_SOLID_SPHERE:
        neph_povray_write_text(writer, "sphere { %p, U*%n", solid->center_m, solid->radius_m);
        break;
    case NEPH_SOLID_MESH:
        neph_povray_write_mesh(writer, solid);
        break;
    case NEPH_SOLID_KIND_COUNT:
        break;
    }
    if (!shows_paint(writer, solid))
        write_texture(writer, solid);
    if (neph_povray_has_radiosity(writer) && neph_is_mirror(&solid->surface))
        neph_povray_write_text(writer,
                               " photons { target reflection on refraction off collect off }");
    neph_povray_write_text(writer, " }\n");
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
        made->maximum = 1.0F; /* value of the file's largest number */
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

/* Declare the noise of each seed, and the map from a coordinate to its file. */
static void declare_noises(struct neph_povray_writer *writer)
{
    const struct neph_scene *scene = writer->world->scene;
    bool is_first = true;
    for (int i = 0; i < scene->solid_count; i++) {
        const int seed = scene->solids[i].surface.texture.seed;
        char name[NEPH_POVRAY_FILE_NAME_MAX];
        if (!is_noise(&scene->solids[i]) || !is_first_of_seed(scene, i))
            continue;
        if (is_first)
            neph_povray_write_text(writer,
                                   "#declare Cell = function(x) { (x - %i*floor(x/%i) + 1)/%i }\n",
                                   NEPH_NOISE_CELLS, NEPH_NOISE_CELLS, NEPH_NOISE_CELLS + 3);
        is_first = false;
        neph_povray_noise_name(seed, name);
        neph_povray_write_text(
            writer,
            "#declare Noise%i = function { pattern { density_file df3 \"%s\" interpolate 1 } }\n",
            seed, name);
    }
}

void neph_povray_write_solids(struct neph_povray_writer *writer)
{
    const struct neph_scene *scene = writer->world->scene;
    if (writer->pass->kind == NEPH_POVRAY_BEAUTY || writer->pass->kind == NEPH_POVRAY_SURFACE)
        declare_noises(writer);
    if (scene->solid_count > 0 && writer->pass->kind == NEPH_POVRAY_DEPTH)
        declare_depth_texture(writer);
    neph_povray_include_meshes(writer);
    if (scene->solid_count > 0)
        neph_povray_write_text(writer, "// Solids.\n");
    for (int i = 0; i < scene->solid_count; i++)
        write_solid(writer, &scene->solids[i]);
}
