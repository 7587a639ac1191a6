/* SPDX-License-Identifier: MIT
 *
 * The controls of a fog's look: their names in three worlds, and the key `fog_look` of a scene
 * file.
 */
#include "scenes/fog_look.h"

#include "scenes/emission.h"
#include "scenes/hash_text.h"
#include "scenes/load.h"
#include "scenes/media.h"

#include <stdio.h>

#define EXPONENT_MAX 64 /* of directional_exponent, as Unreal's */

#define LOOK(member) offsetof(struct neph_fog_look, member)

const char *const neph_fog_model_words[] = {"unreal", "filament", NULL};

static const struct neph_fog_control_row rows[NEPH_FOG_CONTROL_COUNT] = {
    [NEPH_FOG_SKY_LIGHT] = {"sky_light", "sky_light", "Sky Atmosphere Ambient Contribution",
                            "fogColorFromIbl",
                            "the sky's light arrives everywhere as if there were no fog over it: "
                            "right where the fog is a white furnace, too bright in its depth",
                            LOOK(sky_light), 3, 0.0},
    [NEPH_FOG_START] = {"start_distance", "start_distance_m", "Start Distance", "distance",
                        "a ball around the camera, and wherever it goes, has no fog: too much "
                        "light comes through, none is scattered there",
                        LOOK(start_distance_m), 1, 0.0},
    [NEPH_FOG_END] = {"end_distance", "end_distance_m", "End Distance", NULL,
                      "fog ends at a ball around the camera: what lies behind is seen too well",
                      LOOK(end_distance_m), 1, 0.0},
    [NEPH_FOG_CUTOFF] = {"cutoff_distance", "cutoff_distance_m", "Fog Cutoff Distance",
                         "cutOffDistance",
                         "behind a ball around the camera there is no fog at all, also none "
                         "before it: things pop as they cross it",
                         LOOK(cutoff_distance_m), 1, 0.0},
    [NEPH_FOG_MAX_OPACITY] = {"max_opacity", "max_opacity", "Fog Max Opacity", "maximumOpacity",
                              "no depth of fog is opaque: what it hides shines through, and its "
                              "own light is dimmed as much",
                              LOOK(max_opacity), 1, 1.0},
    [NEPH_FOG_HAND_OVER] = {"volumetric_fog_distance", "volumetric_fog_distance_m",
                            "Volumetric Fog View Distance", NULL,
                            "fog nearer than that is another renderer's, and missing where "
                            "nobody renders it",
                            LOOK(volumetric_fog_distance_m), 1, 0.0},
    [NEPH_FOG_OBSERVER] = {"observer_height_max", "observer_height_max_m",
                           "(fixed: 65536 cm above the fog)", NULL,
                           "a camera above it looks from a lower place, into denser fog, and "
                           "along other rays",
                           LOOK(observer_height_max_m), 1, NEPH_FAR_M},
    [NEPH_FOG_DIRECTIONAL] = {"directional", "directional_w_per_m2_sr",
                              "Directional Inscattering Color", "(the light's own colour)",
                              "a glow around the sun that is added: cos^e over the sphere is "
                              "2 pi / (e + 1) and not 1, no light is taken for it, no shadow "
                              "falls on it, max_opacity does not dim it",
                              LOOK(directional_w_per_m2_sr), 3, 0.0},
    [NEPH_FOG_DIRECTIONAL_START] = {"directional_start", "directional_start_m",
                                    "Directional Inscattering Start Distance", "inScatteringStart",
                                    "that glow begins later than the fog, with a kink",
                                    LOOK(directional_start_m), 1, 0.0},
};

const struct neph_fog_control_row *neph_fog_controls(void)
{
    return rows;
}

bool neph_fog_control_is_on(const struct neph_fog_look *look, enum neph_fog_control control)
{
    const struct neph_fog_control_row *row = &rows[control];
    const double *values = (const double *)((const char *)look + row->at);
    for (int i = 0; i < row->count; i++)
        if (values[i] != row->off)
            return true;
    return false;
}

struct neph_fog_look neph_fog_look_only(const struct neph_fog_look *look, unsigned controls)
{
    struct neph_fog_look only = *look;
    for (int c = 0; c < NEPH_FOG_CONTROL_COUNT; c++) {
        double *values = (double *)((char *)&only + rows[c].at);
        for (int i = 0; i < rows[c].count && !(controls & 1u << c); i++)
            values[i] = rows[c].off;
    }
    return only;
}

/* --- of a scene --- */

const struct neph_medium *neph_fog_look_medium(const struct neph_scene *scene)
{
    for (int m = 0; m < scene->medium_count; m++)
        if (scene->media[m].kind == NEPH_MEDIUM_HEIGHT_FOG)
            return &scene->media[m];
    return NULL;
}

/* albedo times the sun's irradiance times a phase function. */
static struct neph_rgb scattered_once(const struct neph_scene *scene, struct neph_rgb albedo,
                                      double per_sr)
{
    const struct neph_rgb sun = scene->sun.irradiance_w_per_m2;
    if (!scene->sun.present || scene->scattering == NEPH_SCATTERING_NONE)
        return (struct neph_rgb){0.0, 0.0, 0.0};
    return (struct neph_rgb){albedo.r * sun.r * per_sr, albedo.g * sun.g * per_sr,
                             albedo.b * sun.b * per_sr};
}

struct neph_fog_look neph_fog_look_of_physics(const struct neph_scene *scene,
                                              const struct neph_medium *fog)
{
    const struct neph_fog_look none = {.present = true, .directional_exponent = 4.0};
    struct neph_fog_look look = neph_fog_look_only(&none, 0);
    const double g = fog->phase.kind == NEPH_PHASE_HENYEY_GREENSTEIN ? fog->phase.g : 0.0;
    const struct neph_rgb glow = neph_medium_glow(fog);
    look.inscattering_w_per_m2_sr = glow;
    if (g > 0.5) {
        look.directional_exponent = fmin((2.0 * g - 1.0) / (1.0 - g), EXPONENT_MAX);
        look.directional_w_per_m2_sr = scattered_once(
            scene, fog->albedo, (look.directional_exponent + 1.0) / (2.0 * M_PI));
        return look;
    }
    const struct neph_rgb even = scattered_once(scene, fog->albedo, 0.25 / M_PI);
    look.inscattering_w_per_m2_sr = (struct neph_rgb){glow.r + even.r, glow.g + even.g,
                                                      glow.b + even.b};
    return look;
}

static bool has_ends(const struct neph_bounds *bounds)
{
    return isfinite(bounds->min_m.x) || isfinite(bounds->min_m.y) || isfinite(bounds->min_m.z) ||
           isfinite(bounds->max_m.x) || isfinite(bounds->max_m.y) || isfinite(bounds->max_m.z);
}

/* NULL when there is none. */
static const char *find_obstacle(const struct neph_scene *scene, enum neph_fog_model model)
{
    if (!scene->fog_look.present)
        return "a scene without a look of its fog: fog_look says what it is";
    if (scene->medium_count != 1)
        return "media beside the fog: the look of a height fog is all that it has";
    if (has_ends(&scene->media[0].bounds))
        return "fog that has bounds: a look fills all space";
    if (neph_medium_is_coloured(&scene->media[0]))
        return "extinction that differs between the channels: a look has one opacity";
    if (model == NEPH_FOG_FILAMENT && scene->media[0].layer_count > 1)
        return "a second layer of fog: Filament has one";
    if (scene->orthographic_height_m > 0.0)
        return "an orthographic camera: a look has one observer, whom all distances are from";
    return NULL;
}

bool neph_fog_look_is_of(const struct neph_scene *scene, enum neph_fog_model model, char *reason,
                         size_t reason_size)
{
    const char *obstacle = find_obstacle(scene, model);
    if (!obstacle)
        return true;
    snprintf(reason, reason_size, "%s", obstacle);
    return false;
}

/* --- in a scene file --- */

static const struct neph_field fields[] = {
    {"inscattering_w_per_m2_sr", NEPH_THREE, LOOK(inscattering_w_per_m2_sr), "W/m2/sr", 0, 1e9,
     .note = "Fog Inscattering Color: the radiance of fog that nothing is seen through"},
    {"sky_light", NEPH_THREE, LOOK(sky_light), "", 0, 100,
     .note = "so much of the background's radiance is added to it", .standard = "[0, 0, 0]"},
    {"start_distance_m", NEPH_NUMBER, LOOK(start_distance_m), "m", 0, NEPH_FAR_M,
     .note = "fog nearer than this is left out", .standard = "0"},
    {"end_distance_m", NEPH_NUMBER, LOOK(end_distance_m), "m", 0, NEPH_FAR_M,
     .note = "fog beyond is left out; 0: none is", .standard = "0"},
    {"cutoff_distance_m", NEPH_NUMBER, LOOK(cutoff_distance_m), "m", 0, NEPH_FAR_M,
     .note = "what lies beyond is seen without any fog; 0: nothing is", .standard = "0"},
    {"max_opacity", NEPH_NUMBER, LOOK(max_opacity), "", 0, 1, .standard = "1"},
    {"volumetric_fog_distance_m", NEPH_NUMBER, LOOK(volumetric_fog_distance_m), "m", 0, NEPH_FAR_M,
     .note = "nearer fog is left to a volume of froxels", .standard = "0"},
    {"observer_height_max_m", NEPH_NUMBER, LOOK(observer_height_max_m), "m", -1e5, NEPH_FAR_M,
     .note = "a camera above it is taken to be there; Unreal has 655.36 m above the fog's height",
     .standard = "1e6"},
    {"directional_w_per_m2_sr", NEPH_THREE, LOOK(directional_w_per_m2_sr), "W/m2/sr", 0, 1e9,
     .note = "Directional Inscattering Color: added where one looks into the sun",
     .standard = "[0, 0, 0]"},
    {"directional_exponent", NEPH_NUMBER, LOOK(directional_exponent), "", 0, EXPONENT_MAX,
     .note = "of the cosine between view and sun", .standard = "4"},
    {"directional_start_m", NEPH_NUMBER, LOOK(directional_start_m), "m", 0, NEPH_FAR_M,
     .note = "that glow begins so far behind the start of the fog", .standard = "0"},
    {0},
};

/* Nothing of a scene that has none: what was stored before there were looks stays valid. */
void neph_fog_look_hash(const struct neph_fog_look *look, FILE *text)
{
    if (look->present)
        neph_fields_hash(fields, look, text);
}

static enum neph_status read_look(struct neph_reader *reader, const yaml_node_t *node,
                                  const struct neph_record *record, void *target)
{
    struct neph_fog_look *look = target;
    const enum neph_status status = neph_read_fields(reader, node, record->fields, target);
    if (status)
        return status;
    look->present = true;
    const double start_m = fmax(look->start_distance_m, look->volumetric_fog_distance_m);
    if (look->end_distance_m > 0.0 && look->end_distance_m <= start_m)
        return neph_refuse(reader, "end_distance_m",
                           "%g is not beyond %g, where the fog starts; 0: it does not end",
                           look->end_distance_m, start_m);
    return NEPH_OK;
}

const struct neph_record neph_fog_look_record = {sizeof(struct neph_fog_look), fields, read_look};

enum neph_status neph_check_fog_look(const struct neph_reader *reader,
                                     const struct neph_scene *scene)
{
    int fogs = 0;
    for (int i = 0; i < scene->medium_count; i++)
        fogs += scene->media[i].kind == NEPH_MEDIUM_HEIGHT_FOG;
    if (!scene->fog_look.present || fogs == 1)
        return NEPH_OK;
    return neph_refuse(reader, "fog_look",
                       "it is the look of a height fog, and the scene has %d; give it one", fogs);
}
