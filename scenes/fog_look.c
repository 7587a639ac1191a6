/* SPDX-License-Identifier: MIT
 *
 * The controls of non-physical fog: their names in the scene file, Unreal and Filament, and their
 * difference from any physical medium.
 */
#include "scenes/fog_look.h"

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_FOG_CONTROL_COUNT == 9, "a new kind");

#define LOOK(member) offsetof(struct neph_fog_look, member)

const char *const neph_fog_model_words[] = {"unreal", "filament", NULL};

static const struct neph_fog_control_row rows[NEPH_FOG_CONTROL_COUNT] = {
    [NEPH_FOG_SKY_LIGHT] = {"sky_light", "sky_light", "Sky Atmosphere Ambient Contribution",
                            "fogColorFromIbl",
                            "the sky's light is not attenuated by the fog above: correct in a "
                            "white furnace, too bright deep in the fog",
                            LOOK(sky_light), 3, 0.0},
    [NEPH_FOG_START] = {"start_distance", "start_distance_m", "Start Distance", "distance",
                        "a ball around the camera has no fog: its transmittance is too high, and "
                        "no light is scattered there",
                        LOOK(start_distance_m), 1, 0.0},
    [NEPH_FOG_END] =
        {"end_distance", "end_distance_m", "End Distance", NULL,
         "fog ends at a cylinder around the camera: the background has too much contrast",
         LOOK(end_distance_m), 1, 0.0},
    [NEPH_FOG_CUTOFF] = {"cutoff_distance", "cutoff_distance_m", "Fog Cutoff Distance",
                         "cutOffDistance",
                         "beyond a ball around the camera there is no fog, not even in front of "
                         "it: objects jump as they cross it",
                         LOOK(cutoff_distance_m), 1, 0.0},
    [NEPH_FOG_MAX_OPACITY] = {"max_opacity", "max_opacity", "Fog Max Opacity", "maximumOpacity",
                              "no depth of fog is opaque: the background remains visible, and the "
                              "fog's own light is reduced by the same part",
                              LOOK(max_opacity), 1, 1.0},
    [NEPH_FOG_HAND_OVER] =
        {"volumetric_fog_distance", "volumetric_fog_distance_m", "Volumetric Fog View Distance",
         NULL,
         "nearer fog belongs to another renderer: physical in the froxels of realtime, absent in "
         "engine fog_look; a march without froxels starts the non-physical fog at the camera",
         LOOK(volumetric_fog_distance_m), 1, 0.0},
    [NEPH_FOG_OBSERVER] = {"observer_height_max", "observer_height_max_m",
                           "(fixed: 65536 cm above the fog)", NULL,
                           "a camera above is moved down, into denser fog and along other rays",
                           LOOK(observer_height_max_m), 1, NEPH_FOG_NO_OBSERVER_M},
    [NEPH_FOG_DIRECTIONAL] =
        {"directional", "directional_w_per_m2_sr", "Directional Inscattering Color",
         "(the light's own colour)",
         "a glow around the sun is added: cos^e integrates to 2 pi / (e + 1) instead of 1, its "
         "energy is not subtracted, it has no shadows, max_opacity does not reduce it",
         LOOK(directional_w_per_m2_sr), 3, 0.0},
    [NEPH_FOG_DIRECTIONAL_START] = {"directional_start", "directional_start_m",
                                    "Directional Inscattering Start Distance", "inScatteringStart",
                                    "the glow starts farther away than the fog, with a kink",
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
