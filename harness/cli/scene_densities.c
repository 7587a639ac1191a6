/* SPDX-License-Identifier: MIT */
#include "harness/cli/scene_densities.h"

#include "base/text.h"
#include "scenes/column.h"
#include "scenes/density_units.h"
#include "scenes/grid.h"
#include "scenes/media.h"

#include <math.h>
#include <stdio.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_DENSITY_UNIT_COUNT == 6, "a new unit");
_Static_assert(NEPH_MEDIUM_KIND_COUNT == 8, "a new kind");

/* Water droplets scatter more than this part of visible light (truth/mie.h). */
static const double droplet_albedo = 0.999;

enum { AXES = 3, CELL_SIZE = 24 };

/* Quantities that do not depend on an axis, in the order of columns. */
static const enum neph_density_unit scalar_units[] = {
    NEPH_DENSITY_EXTINCTION, NEPH_DENSITY_VISIBILITY_2, NEPH_DENSITY_VISIBILITY_5,
    NEPH_DENSITY_WATER, NEPH_DENSITY_DROPLETS};
enum { SCALARS = sizeof(scalar_units) / sizeof(scalar_units[0]) };

/* A medium, or one layer of a height fog. */
struct density {
    int medium, layer; /* layer -1: the medium has none */
    const struct neph_medium_facts *facts;
    double values[SCALARS];
    double optical_depths[AXES]; /* along x, y, z; infinite or NAN as neph_medium_column...() */
    struct neph_droplet_radii radii;
    bool is_radius_given, is_variance_given;
};

static struct density measure(const struct neph_medium *medium, int index, int layer)
{
    const bool has_layers = neph_medium_is_fog(medium);
    const struct neph_medium one = has_layers ? neph_medium_of_layer(medium, layer) : *medium;
    const struct neph_droplet_radii given = one.droplets[0];
    struct density density = {.medium = index,
                              .layer = medium->kind == NEPH_MEDIUM_HEIGHT_FOG ? layer : -1,
                              .facts = neph_medium_facts(medium->kind),
                              .radii = neph_droplet_radii_assume(given),
                              .is_radius_given = given.effective_radius_um != 0.0,
                              .is_variance_given = given.effective_variance > 0.0};
    const double extinction_per_m = has_layers ? one.layers[0].extinction_per_m
                                               : one.extinction_per_m;
    for (int i = 0; i < SCALARS; i++)
        density.values[i] = neph_density_from_extinction(scalar_units[i], extinction_per_m,
                                                         density.radii, NAN);
    for (int axis = 0; axis < AXES; axis++)
        density.optical_depths[axis] = neph_medium_column_optical_depth(&one, axis);
    return density;
}

/* ---- what the units do not express ----------------------------------------------------------- */

/* The `index`-th property of a medium that no unit expresses; NULL beyond the last one. */
static const char *find_untranslated(const struct neph_medium *medium, int index)
{
    const struct neph_rgb albedo = medium->albedo;
    const struct {
        bool is_there;
        const char *words;
    } rows[] = {
        {neph_medium_is_coloured(medium),
         "extinction_color: all values are for an extinction_color of 1"},
        {fmin(albedo.r, fmin(albedo.g, albedo.b)) < droplet_albedo,
         "albedo: water droplets absorb less than 0.001 of visible light, this medium more"},
        {medium->kind == NEPH_MEDIUM_HORIZON,
         "density of horizon: a factor of its noise without a unit, so optical depth is unknown"},
        {medium->kind != NEPH_MEDIUM_HEIGHT_FOG,
         "densities of Unreal and Filament: their fog is a height_fog"},
        {isnan(medium->droplets[0].effective_radius_um),
         "radius_grid: each voxel has its own water and droplets for the same extinction"},
        {true, "phase: the scene's own, whatever the droplets (`neph droplets` has theirs)"},
    };
    for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++)
        if (rows[i].is_there && index-- == 0)
            return rows[i].words;
    return NULL;
}

static const char *const assumptions[] = {
    "visibility: a black object against the horizon keeps a contrast of 2 or 5 % "
    "(Koschmieder), along a level line with this extinction everywhere",
    "g/m3, /cm3: spheres of water of effective radius r_e and effective variance v in a gamma "
    "distribution, with the extinction efficiency Q at 550 nm (scenes/density_units.h)",
    "optical depth: along a line through the densest place (scenes/column.h)",
};
enum { ASSUMPTIONS = sizeof(assumptions) / sizeof(assumptions[0]) };

/* ---- text ------------------------------------------------------------------------------------ */

static const char *write_number(char cell[CELL_SIZE], double value)
{
    if (isnan(value))
        return "-";
    neph_text_format(cell, CELL_SIZE, isinf(value) ? "infinite" : "%.4g", value);
    return cell;
}

static const char *write_assumed(char cell[CELL_SIZE], double value, bool is_given)
{
    if (isnan(value))
        return "varies";
    neph_text_format(cell, CELL_SIZE, "%.4g%s", value, is_given ? "" : "*");
    return cell;
}

static void print_density(const struct density *density)
{
    char name[CELL_SIZE], radius[CELL_SIZE], variance[CELL_SIZE], cell[CELL_SIZE];
    if (density->layer < 0)
        neph_text_format(name, sizeof(name), "medium %d", density->medium);
    else
        neph_text_format(name, sizeof(name), "medium %d layer %d", density->medium, density->layer);
    printf("  %-17s %-13s", name, density->facts->place);
    for (int i = 0; i < SCALARS; i++)
        printf(" %-10s", write_number(cell, density->values[i]));
    printf(" %-6s %-6s %-6s",
           write_assumed(radius, density->radii.effective_radius_um, density->is_radius_given),
           write_assumed(variance, density->radii.effective_variance, density->is_variance_given),
           write_number(cell, neph_droplet_extinction_efficiency(density->radii)));
    for (int axis = 0; axis < AXES; axis++)
        printf(axis < AXES - 1 ? " %-9s" : " %s\n",
               write_number(cell, density->optical_depths[axis]));
}

/* How a reader changed the values of a file; "": not at all. */
static const char *find_note(const struct neph_medium *medium)
{
    return medium->kind == NEPH_MEDIUM_GRID ? medium->grid->note : "";
}

static void print_values(const struct neph_medium *medium, int index)
{
    if (medium->kind != NEPH_MEDIUM_GRID)
        return;
    printf("  medium %d: values up to %.4g\n", index, (double)medium->grid->maximum);
    if (*find_note(medium))
        printf("  medium %d: %s\n", index, find_note(medium));
}

static int count_densities(const struct neph_medium *medium)
{
    return medium->kind == NEPH_MEDIUM_HEIGHT_FOG ? medium->layer_count : 1;
}

void neph_print_densities(const struct neph_scene *scene)
{
    if (scene->medium_count == 0)
        return;
    printf("densities\n  %-17s %-13s %-10s %-21s %-10s %-10s %-6s %-6s %-6s %s\n"
           "  %-31s %-10s %-10s %-10s %-10s %-10s %-6s %-6s %-6s %-9s %-9s %s\n",
           "", "", "extinction", "visibility (2 %, 5 %)", "water", "droplets", "r_e", "v", "Q",
           "optical depth along", "", "/m", "m", "m", "g/m3", "/cm3", "um", "", "", "x", "y", "z");
    for (int m = 0; m < scene->medium_count; m++)
        for (int l = 0; l < count_densities(&scene->media[m]); l++) {
            const struct density density = measure(&scene->media[m], m, l);
            print_density(&density);
        }
    for (int m = 0; m < scene->medium_count; m++)
        print_values(&scene->media[m], m);
    printf("  *: assumed, the scene has none\n");
    for (int i = 0; i < ASSUMPTIONS; i++)
        printf("  %s\n", assumptions[i]);
    printf("  properties that no unit expresses:\n");
    for (int m = 0; m < scene->medium_count; m++)
        for (int i = 0; find_untranslated(&scene->media[m], i); i++)
            printf("    medium %d: %s\n", m, find_untranslated(&scene->media[m], i));
}

/* ---- JSON ------------------------------------------------------------------------------------ */

static json_t *untranslated_json(const struct neph_medium *medium)
{
    json_t *list = json_array();
    for (int i = 0; find_untranslated(medium, i); i++)
        neph_json_add(&list, json_string(find_untranslated(medium, i)));
    return list;
}

/* An infinite optical depth is null, and the name of its axis is in `endless_along`. */
static json_t *density_json(const struct neph_medium *medium, const struct density *density)
{
    json_t *json = json_pack("{s:i, s:o, s:s, s:s}", "medium", density->medium, "layer",
                             density->layer < 0 ? json_null() : json_integer(density->layer),
                             "kind", density->facts->name, "place", density->facts->place);
    for (int i = 0; i < SCALARS; i++)
        neph_json_set(&json, neph_density_unit_row(scalar_units[i])->key,
                      neph_json_number(density->values[i]));
    json_t *depths = json_object(), *endless = json_array();
    for (int axis = 0; axis < AXES; axis++) {
        const char name[] = {"xyz"[axis], '\0'};
        neph_json_set(&depths, name, neph_json_number(density->optical_depths[axis]));
        if (isinf(density->optical_depths[axis]))
            neph_json_add(&endless, json_string(name));
    }
    neph_json_set(&json, "optical_depth", depths);
    neph_json_set(&json, "endless_along", endless);
    neph_json_set(&json, "effective_radius_um",
                  neph_json_number(density->radii.effective_radius_um));
    neph_json_set(&json, "effective_variance", json_real(density->radii.effective_variance));
    neph_json_set(&json, "effective_radius_assumed", json_boolean(!density->is_radius_given));
    neph_json_set(&json, "effective_variance_assumed", json_boolean(!density->is_variance_given));
    neph_json_set(&json, "extinction_efficiency",
                  neph_json_number(neph_droplet_extinction_efficiency(density->radii)));
    neph_json_set(&json, "largest_value",
                  medium->kind == NEPH_MEDIUM_GRID ? json_real((double)medium->grid->maximum)
                                                   : json_null());
    neph_json_set(&json, "note", neph_json_cleaned(find_note(medium)));
    neph_json_set(&json, "untranslated", untranslated_json(medium));
    return json;
}

json_t *neph_densities_json(const struct neph_scene *scene)
{
    json_t *list = json_array(), *assumed = json_array();
    for (int m = 0; m < scene->medium_count; m++)
        for (int l = 0; l < count_densities(&scene->media[m]); l++) {
            const struct density density = measure(&scene->media[m], m, l);
            neph_json_add(&list, density_json(&scene->media[m], &density));
        }
    for (int i = 0; i < ASSUMPTIONS; i++)
        neph_json_add(&assumed, json_string(assumptions[i]));
    return json_pack("{s:o, s:o}", "media", list, "assumptions", assumed);
}
