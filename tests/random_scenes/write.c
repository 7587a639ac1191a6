/* SPDX-License-Identifier: MIT
 *
 * A recipe as a scene file, and its meshes. Numbers of the scene are written so that they are read
 * back as the same double.
 */
#include "tests/random_scenes/recipe.h"

#include <string.h>

static void write_three(FILE *file, const char *key, struct neph_vec3 v)
{
    fprintf(file, "%s: [%.17g, %.17g, %.17g]", key, v.x, v.y, v.z);
}

static void write_rgb(FILE *file, const char *key, struct neph_rgb c)
{
    write_three(file, key, (struct neph_vec3){c.r, c.g, c.b});
}

static void write_bounds(FILE *file, const struct neph_bounds *bounds)
{
    fprintf(file, "      bounds:\n        ");
    write_three(file, "min_m", bounds->min_m);
    fprintf(file, "\n        ");
    write_three(file, "max_m", bounds->max_m);
    fprintf(file, "\n");
}

/* ---- media ----------------------------------------------------------------------------------- */

static const char *const form_keys[FORM_COUNT] = {
    [FORM_HOMOGENEOUS] = "homogeneous",
    [FORM_FOG_OPEN] = "height_fog",
    [FORM_FOG_BOXED] = "height_fog",
    [FORM_FOG_TWO_LAYERS] = "height_fog",
    [FORM_GAUSSIAN] = "gaussian",
    [FORM_GAUSSIAN_BOXED] = "gaussian",
    [FORM_SHELL] = "shell",
    [FORM_TENT] = "tent",
    [FORM_GRID] = "grid",
    [FORM_GRID_ENDLESS] = "grid",
    [FORM_SHEET] = "sheet",
    [FORM_PLUME] = "plume",
    [FORM_HORIZON] = "horizon",
};

static void write_layers(FILE *file, const struct recipe_medium *medium)
{
    fprintf(file, "      layers:\n");
    for (int i = 0; i < medium->layer_count; i++)
        fprintf(file,
                "        - {extinction_per_m: %.17g, falloff_per_m: %.17g, height_m: %.17g}\n",
                medium->layers[i].extinction_per_m, medium->layers[i].falloff_per_m,
                medium->layers[i].height_m);
}

static void write_grid(FILE *file, const struct recipe_medium *medium)
{
    const int *nodes = medium->nodes, *repeat = medium->repeat;
    fprintf(file, "      size: [%d, %d, %d]\n      repeat: [%d, %d, %d]\n      ", nodes[0],
            nodes[1], nodes[2], repeat[0], repeat[1], repeat[2]);
    write_three(file, "origin_m", medium->origin_m);
    fprintf(file, "\n      ");
    write_three(file, "spacing_m", medium->spacing_m);
    fprintf(file, "\n      values: [");
    for (int i = 0; i < nodes[0] * nodes[1] * nodes[2]; i++)
        fprintf(file, "%s%.9g", i > 0 ? ", " : "", medium->values[i]);
    fprintf(file, "]\n");
}

/* The keys that only this form has. */
static void write_shape(FILE *file, const struct recipe_medium *medium)
{
    switch (medium->form) {
    case FORM_FOG_OPEN:
    case FORM_FOG_BOXED:
    case FORM_FOG_TWO_LAYERS:
        write_layers(file, medium);
        break;
    case FORM_GAUSSIAN:
    case FORM_GAUSSIAN_BOXED:
        write_three(file, "      center_m", medium->center_m);
        fprintf(file, "\n      width_m: %.17g\n", medium->width_m);
        break;
    case FORM_SHELL:
        write_three(file, "      center_m", medium->center_m);
        fprintf(file, "\n      radius_m: %.17g\n      scale_height_m: %.17g\n", medium->radius_m,
                medium->scale_m);
        break;
    case FORM_TENT:
        write_three(file, "      center_m", medium->center_m);
        fprintf(file,
                "\n      radius_m: %.17g\n      altitude_m: %.17g\n      half_width_m: %.17g\n",
                medium->radius_m, medium->altitude_m, medium->scale_m);
        break;
    case FORM_GRID:
    case FORM_GRID_ENDLESS:
        write_grid(file, medium);
        break;
    case FORM_SHEET:
        write_three(file, "      center_m", medium->center_m);
        fprintf(file,
                "\n      side_m: %.17g\n      thickness_m: %.17g\n      optical_depth: %.17g\n"
                "      nodes: %d\n      pattern: %s\n      seed: %d\n      wisp_m: %.17g\n",
                medium->width_m, medium->scale_m, medium->extinction_per_m, medium->nodes[0],
                medium->is_streaked ? "streaks" : "even", medium->seed, medium->width_m / 3.0);
        break;
    case FORM_PLUME:
        write_three(file, "      foot_m", medium->center_m);
        write_three(file, "\n      axis", medium->axis);
        fprintf(file, "\n      width_m: %.17g\n      scale_height_m: %.17g\n", medium->width_m,
                medium->scale_m);
        break;
    case FORM_HORIZON:
        fprintf(file, "      seed: %d\n      ", medium->seed);
        write_three(file, "wind_m", medium->wind_m);
        fprintf(file, "\n");
        break;
    case FORM_HOMOGENEOUS:
    case FORM_COUNT:
        break;
    }
}

static bool is_black(struct neph_rgb c)
{
    return c.r == 0.0 && c.g == 0.0 && c.b == 0.0;
}

static void write_medium(FILE *file, const struct recipe_medium *medium)
{
    static const char *const phases[] = {"isotropic", "henyey_greenstein", "rayleigh"};
    fprintf(file, "  - %s:\n", form_keys[medium->form]);
    if (medium->layer_count == 0 && medium->form != FORM_SHEET)
        fprintf(file, "      extinction_per_m: %.17g\n", medium->extinction_per_m);
    write_shape(file, medium);
    fprintf(file, "      ");
    write_rgb(file, "albedo", medium->albedo);
    fprintf(file, "\n      ");
    write_rgb(file, "extinction_color", medium->color);
    fprintf(file, "\n      phase: %s\n", phases[medium->phase.kind]);
    if (medium->phase.kind == NEPH_PHASE_HENYEY_GREENSTEIN)
        fprintf(file, "      asymmetry_g: %.17g\n", medium->phase.g);
    if (!is_black(medium->emission_w_per_m2_sr)) {
        fprintf(file, "      ");
        write_rgb(file, "emission_w_per_m2_sr", medium->emission_w_per_m2_sr);
        fprintf(file, "\n");
    }
    if (medium->voxels > 0)
        fprintf(file, "      voxels: %d\n", medium->voxels);
    if (medium->is_bounded)
        write_bounds(file, &medium->bounds);
}

/* ---- other parts ----------------------------------------------------------------------------- */

static void write_light(FILE *file, const struct recipe_light *light)
{
    fprintf(file, "  - {");
    write_three(file, "position_m", light->position_m);
    write_rgb(file, ", intensity_w_per_sr", light->intensity_w_per_sr);
    if (light->is_spot) {
        write_three(file, ", cone: {axis", light->axis);
        fprintf(file, ", inner_deg: %.17g, outer_deg: %.17g}", light->inner_deg, light->outer_deg);
    }
    fprintf(file, "}\n");
}

static void write_motion(FILE *file, const struct recipe_solid *solid)
{
    fprintf(file, "      motion:\n        axis: %c\n", solid->axis);
    write_three(file, "        pivot_m",
                neph_vec3_scale(neph_vec3_add(solid->box.min_m, solid->box.max_m), 0.5));
    fprintf(file, "\n        keys:\n          - {frame: 0}\n          - {frame: %d, ",
            RECIPE_KEY_FRAME);
    write_three(file, "move_m", solid->move_m);
    fprintf(file, ", turn_deg: %.17g}\n", solid->turn_deg);
}

static void write_solid(FILE *file, const struct recipe_solid *solid)
{
    switch (solid->kind) {
    case RECIPE_BOX:
        fprintf(file, "  - box:\n");
        write_three(file, "      min_m", solid->box.min_m);
        write_three(file, "\n      max_m", solid->box.max_m);
        break;
    case RECIPE_SPHERE:
        fprintf(file, "  - sphere:\n");
        write_three(file, "      center_m", solid->center_m);
        fprintf(file, "\n      radius_m: %.17g", solid->radius_m);
        break;
    case RECIPE_FENCE:
        fprintf(file, "  - fence:\n");
        write_three(file, "      origin_m", solid->box.min_m);
        fprintf(file,
                "\n      bars: %d\n      pitch_m: %.17g\n      bar_width_m: %.17g\n"
                "      bar_depth_m: %.17g\n      height_m: %.17g",
                solid->bars, solid->pitch_m, 0.5 * solid->pitch_m, 0.25 * solid->pitch_m,
                solid->height_m);
        break;
    }
    fprintf(file, "\n      ");
    write_rgb(file, "albedo", solid->albedo);
    fprintf(file, "\n");
    if (solid->moves)
        write_motion(file, solid);
}

static void write_mesh_solid(FILE *file, const struct recipe_mesh *mesh, const char *name,
                             int number)
{
    fprintf(file, "  - mesh:\n      file: %s_%d.obj\n", name, number);
    write_three(file, "      position_m", mesh->position_m);
    fprintf(file, "\n      scale_m: %.17g\n      turn_deg: %.17g\n      ", mesh->scale_m,
            mesh->turn_deg);
    write_rgb(file, "albedo", mesh->albedo);
    fprintf(file, "\n");
}

/* Bit 0 of a block's corner is its side along x, bit 1 along y, bit 2 along z. */
static const struct {
    int corner_count, triangle_count, triangles[12][3];
} mesh_forms[RECIPE_MESH_KINDS] = {
    [RECIPE_TETRAHEDRON] = {4, 4, {{1, 2, 3}, {1, 4, 2}, {1, 3, 4}, {2, 4, 3}}},
    [RECIPE_BLOCK] = {8,
                      12,
                      {{1, 5, 7},
                       {1, 7, 3},
                       {2, 4, 8},
                       {2, 8, 6},
                       {1, 2, 6},
                       {1, 6, 5},
                       {3, 7, 8},
                       {3, 8, 4},
                       {1, 3, 4},
                       {1, 4, 2},
                       {5, 6, 8},
                       {5, 8, 7}}},
    [RECIPE_SURFACE] =
        {9,
         8,
         {{1, 4, 2}, {2, 4, 5}, {2, 5, 3}, {3, 5, 6}, {4, 7, 5}, {5, 7, 8}, {5, 8, 6}, {6, 8, 9}}},
};

void recipe_write_mesh(const struct recipe_mesh *mesh, const char *prefix, FILE *file)
{
    for (int i = 0; i < mesh_forms[mesh->kind].corner_count; i++) {
        const struct neph_vec3 p = mesh->corners[i];
        fprintf(file, "%sv %.9g %.9g %.9g\n", prefix, p.x, p.y, p.z);
    }
    for (int i = 0; i < mesh_forms[mesh->kind].triangle_count; i++) {
        const int *corners = mesh_forms[mesh->kind].triangles[i];
        fprintf(file, "%sf %d %d %d\n", prefix, corners[0], corners[1], corners[2]);
    }
}

static void write_camera(const struct recipe *recipe, FILE *file)
{
    write_three(file, "camera: {position_m", recipe->eye_m);
    write_three(file, ", look_at_m", recipe->look_at_m);
    write_three(file, ", up", recipe->up);
    if (recipe->orthographic_height_m > 0.0)
        fprintf(file, ", orthographic_height_m: %.17g}\n", recipe->orthographic_height_m);
    else
        fprintf(file, ", vertical_fov_deg: %.17g}\n", recipe->vertical_fov_deg);
}

static void write_wind(const struct recipe *recipe, FILE *file)
{
    if (!recipe->is_wind_keyed) {
        write_three(file, "wind: {velocity_m_per_s", recipe->wind_m_per_s);
        fprintf(file, "}\n");
        return;
    }
    write_three(file, "wind:\n  keys:\n    - {frame: 0, velocity_m_per_s", recipe->wind_m_per_s);
    fprintf(file, "}\n    - {frame: %d, ", RECIPE_KEY_FRAME);
    write_three(file, "velocity_m_per_s", neph_vec3_scale(recipe->wind_m_per_s, 2.0));
    fprintf(file, "}\n");
}

void recipe_write(const struct recipe *recipe, const char *name, const char *note, FILE *file)
{
    static const char *const scatterings[] = {"none", "single", "multiple"};
    fprintf(file,
            "%sname: %s\ntitle: Random scene %d of seed %llu\n"
            "description: engines that know this scene agree about it\n",
            note, name, recipe->index, (unsigned long long)recipe->seed);
    write_camera(recipe, file);
    fprintf(file, "frames: {count: %d}\n", RECIPE_KEY_FRAME + 1);
    if (recipe->has_sun) {
        write_three(file, "sun: {direction", recipe->sun_direction);
        write_rgb(file, ", irradiance_w_per_m2", recipe->sun_w_per_m2);
        fprintf(file, "}\n");
    }
    if (recipe->has_wind)
        write_wind(recipe, file);
    write_rgb(file, "background_w_per_m2_sr", recipe->background_w_per_m2_sr);
    fprintf(file, "\nenvironment_light: %s\nscattering: %s\n",
            recipe->environment_light ? "true" : "false", scatterings[recipe->scattering]);
    if (recipe->light_count > 0)
        fprintf(file, "lights:\n");
    for (int i = 0; i < recipe->light_count; i++)
        write_light(file, &recipe->lights[i]);
    if (recipe->solid_count + recipe->mesh_count > 0)
        fprintf(file, "solids:\n");
    for (int i = 0; i < recipe->solid_count; i++)
        write_solid(file, &recipe->solids[i]);
    for (int i = 0; i < recipe->mesh_count; i++)
        write_mesh_solid(file, &recipe->meshes[i], name, i);
    if (recipe->medium_count > 0)
        fprintf(file, "media:\n");
    for (int i = 0; i < recipe->medium_count; i++)
        write_medium(file, &recipe->media[i]);
}
