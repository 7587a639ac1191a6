/* SPDX-License-Identifier: MIT */
#include "harness/cli/scenes_fog.h"

#include "scenes/fog_translation.h"
#include "scenes/media.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_PHASE_KIND_COUNT == 3, "a new kind");
_Static_assert(NEPH_SCATTERING_COUNT == 3, "a new kind");

enum { CELL_SIZE = 80 };

/* ---- what physics has and a look has not ----------------------------------------------------- */

static bool has_ends(const struct neph_medium *fog)
{
    const double sides[] = {fog->bounds.min_m.x, fog->bounds.min_m.y, fog->bounds.min_m.z,
                            fog->bounds.max_m.x, fog->bounds.max_m.y, fog->bounds.max_m.z};
    for (int i = 0; i < 6; i++)
        if (isfinite(sides[i]))
            return true;
    return false;
}

/* What of a scene is lost in all looks; NULL beyond the last. */
static const char *lost_in_looks(const struct neph_scene *scene, const struct neph_medium *fog,
                                 int index)
{
    const bool scatters = scene->sun.present && scene->scattering != NEPH_SCATTERING_NONE &&
                          fog->albedo.r + fog->albedo.g + fog->albedo.b > 0.0;
    const struct {
        bool is_there;
        const char *words;
    } rows[] = {
        {has_ends(fog), "bounds: a look fills all space"},
        {neph_medium_is_coloured(fog), "extinction_color: a look has one opacity"},
        {scatters, "sunlight lost on its way, and shadows in the fog: a look is as bright at all "
                   "depths and places"},
        {scatters && fog->phase.kind != NEPH_PHASE_ISOTROPIC,
         "the phase function: a look has a lobe cos^e around the sun, and nothing behind"},
        {scene->scattering == NEPH_SCATTERING_MULTIPLE,
         "light scattered more than once: a look has the colour that it is given"},
    };
    for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++)
        if (rows[i].is_there && index-- == 0)
            return rows[i].words;
    return NULL;
}

/* ---- for people ------------------------------------------------------------------------------ */

static void print_row(const char *name, const char *physical, const char *unreal,
                      const char *filament)
{
    printf("  %-26s %-22s %-22s %s\n", name, physical, unreal, filament);
}

static const char *written(char cell[CELL_SIZE], const char *format, ...)
    __attribute__((format(printf, 2, 3)));

static const char *written(char cell[CELL_SIZE], const char *format, ...)
{
    va_list values;
    va_start(values, format);
    vsnprintf(cell, CELL_SIZE, format, values);
    va_end(values);
    return cell;
}

static void print_layer(const struct neph_fog_layer *layer, int index)
{
    const struct neph_unreal_fog unreal = neph_fog_layer_to_unreal(layer);
    char name[CELL_SIZE], physical[CELL_SIZE], theirs[CELL_SIZE], filament[CELL_SIZE];
    print_row(written(name, "layer %d: density", index),
              written(physical, "%.6g /m", layer->extinction_per_m),
              written(theirs, "%.6g", unreal.fog_density),
              index > 0 ? "(it has one layer)"
                        : written(filament, "%.6g /m", layer->extinction_per_m));
    print_row("  falloff", written(physical, "%.6g /m", layer->falloff_per_m),
              written(theirs, "%.6g", unreal.fog_height_falloff),
              index > 0 ? "" : written(filament, "%.6g /m", layer->falloff_per_m));
    print_row("  height", written(physical, "%.6g m", layer->height_m),
              written(theirs, "%.6g cm", 100.0 * layer->height_m),
              index > 0 ? "" : written(filament, "%.6g m", layer->height_m));
}

static const char *written_values(char cell[CELL_SIZE], const double *values, int count)
{
    return count == 3 ? written(cell, "%.4g %.4g %.4g", values[0], values[1], values[2])
                      : written(cell, "%.6g", values[0]);
}

/* A look and what comes of physics, in the words of both engines. */
static void print_look(const struct neph_scene *scene, const struct neph_fog_look *physics)
{
    const struct neph_fog_look *look = &scene->fog_look;
    char physical[CELL_SIZE], set[CELL_SIZE];
    print_row("inscattering", written_values(physical, &physics->inscattering_w_per_m2_sr.r, 3),
              written_values(set, &look->inscattering_w_per_m2_sr.r, 3), set);
    for (int c = 0; c < NEPH_FOG_CONTROL_COUNT; c++) {
        const struct neph_fog_control_row *row = &neph_fog_controls()[c];
        const double *values = (const double *)((const char *)look + row->at);
        const double *thin = (const double *)((const char *)physics + row->at);
        const bool is_known = neph_fog_control_is_on(physics, (enum neph_fog_control)c);
        written_values(set, values, row->count);
        print_row(row->name, is_known ? written_values(physical, thin, row->count) : "-",
                  neph_fog_control_is_on(look, (enum neph_fog_control)c) ? set : "off",
                  !row->filament                                           ? "(has none)"
                  : neph_fog_control_is_on(look, (enum neph_fog_control)c) ? set
                                                                           : "off");
    }
    print_row("directional_exponent",
              neph_fog_control_is_on(physics, NEPH_FOG_DIRECTIONAL)
                  ? written_values(physical, &physics->directional_exponent, 1)
                  : "-",
              written_values(set, &look->directional_exponent, 1), set);
}

static void print_departures(const struct neph_fog_look *look)
{
    printf("  of the look no medium has:\n");
    for (int c = 0; c < NEPH_FOG_CONTROL_COUNT; c++)
        if (neph_fog_control_is_on(look, (enum neph_fog_control)c))
            printf("    %s (%s): %s\n", neph_fog_controls()[c].name, neph_fog_controls()[c].unreal,
                   neph_fog_controls()[c].physics);
}

void neph_cli_print_fog(const struct neph_scene *scene)
{
    const struct neph_medium *fog = neph_fog_look_medium(scene);
    if (!fog)
        return;
    const struct neph_fog_look physics = neph_fog_look_of_physics(scene, fog);
    printf("height fog\n");
    print_row("", "physical", "Unreal", "Filament");
    for (int l = 0; l < fog->layer_count; l++)
        print_layer(&fog->layers[l], l);
    if (scene->fog_look.present) {
        print_look(scene, &physics);
        print_departures(&scene->fog_look);
    }
    if (lost_in_looks(scene, fog, 0))
        printf("  of the medium no look has:\n");
    for (int i = 0; lost_in_looks(scene, fog, i); i++)
        printf("    %s\n", lost_in_looks(scene, fog, i));
}

/* ---- for programs ---------------------------------------------------------------------------- */

static json_t *values_json(const double *values, int count)
{
    return count == 3 ? json_pack("[f, f, f]", values[0], values[1], values[2])
                      : json_real(values[0]);
}

static json_t *control_json(const struct neph_fog_look *look, enum neph_fog_control control)
{
    const struct neph_fog_control_row *row = &neph_fog_controls()[control];
    const double *values = (const double *)((const char *)look + row->at);
    return json_pack("{s:s, s:s, s:o, s:b, s:s, s:s?, s:s}", "name", row->name, "key", row->key,
                     "value", values_json(values, row->count), "on",
                     neph_fog_control_is_on(look, control), "unreal", row->unreal, "filament",
                     row->filament, "physics", row->physics);
}

static json_t *look_json(const struct neph_fog_look *look)
{
    json_t *controls = json_array();
    if (!look->present) {
        json_decref(controls);
        return json_null();
    }
    for (int c = 0; c < NEPH_FOG_CONTROL_COUNT; c++)
        neph_json_add(&controls, control_json(look, (enum neph_fog_control)c));
    return json_pack("{s:o, s:f, s:o}", "inscattering_w_per_m2_sr",
                     values_json(&look->inscattering_w_per_m2_sr.r, 3), "directional_exponent",
                     look->directional_exponent, "controls", controls);
}

static json_t *thin_json(const struct neph_fog_look *physics)
{
    return json_pack("{s:o, s:o, s:f}", "inscattering_w_per_m2_sr",
                     values_json(&physics->inscattering_w_per_m2_sr.r, 3),
                     "directional_w_per_m2_sr", values_json(&physics->directional_w_per_m2_sr.r, 3),
                     "directional_exponent", physics->directional_exponent);
}

json_t *neph_cli_fog_json(const struct neph_scene *scene)
{
    const struct neph_medium *fog = neph_fog_look_medium(scene);
    json_t *lost = json_array();
    if (!fog) {
        json_decref(lost);
        return json_null();
    }
    const struct neph_fog_look physics = neph_fog_look_of_physics(scene, fog);
    for (int i = 0; lost_in_looks(scene, fog, i); i++)
        neph_json_add(&lost, json_string(lost_in_looks(scene, fog, i)));
    return json_pack("{s:o, s:o, s:o}", "look", look_json(&scene->fog_look), "of_physics",
                     thin_json(&physics), "lost_in_looks", lost);
}
