/* SPDX-License-Identifier: MIT */
#include "harness/physics/participants.h"

#include <string.h>

const struct neph_participant neph_participants[NEPH_PARTICIPANTS] = {
    {.name = "exact", .engine = "exact", .refined = "", .rounding = 1e-6},
    {.name = "oracle", .engine = "oracle", .rounding = 1e-6},
    {.name = "tracer", .engine = "tracer", .rounding = 1e-6},
    /* Cycles has no step in homogeneous media. Its single scattering there was within 1e-4 in all
     * measured cases: float32 sums, and paths ended below a throughput of 1e-6. */
    {.name = "cycles", .engine = "cycles", .settings = {"samples=256"}, .rounding = 1e-4},
    {.name = "povray",
     .engine = "povray",
     .refined = "intervals=100",
     .order = 2,
     /* 16-bit images: half a quantization step of the range up to the brightest pixel. */
     .rounding = 2e-5},
    {.name = "march", .engine = "march", .refined = "steps=128", .order = 2, .rounding = 1e-6},
    {.name = "march octaves",
     .engine = "march_octaves",
     .refined = "steps=128",
     .order = 2,
     .rounding = 1e-6},
    {.name = "march octaves fitted",
     .engine = "march_octaves_fitted",
     .refined = "steps=128",
     .order = 2,
     .rounding = 1e-6},
};

enum when { ALWAYS, LOWERED, BAKED, STEPPED, DEEP, WHEN_COUNT };

/* The first matching row applies. A NULL participant matches all. */
static const struct {
    const char *participant;
    enum when when;
    const char *cause;
} causes[] = {
    {"povray", LOWERED,
     "it has single scattering from light sources only: no light of the environment and no higher "
     "orders"},
    {NULL, LOWERED, "it models single scattering only"},
    {"march octaves", ALWAYS,
     "a sum of octaves is a non-physical model: it saturates with optical depth and does not "
     "conserve energy"},
    {"march octaves fitted", ALWAYS,
     "a sum of octaves is a non-physical model, fitted or not: it does not conserve energy"},
    {"cycles", DEEP,
     "it ends paths at 1024 bounces, Blender's own limit, and beyond an optical depth of some 30 "
     "light without absorption scatters more often than that"},
    {"cycles", STEPPED,
     "it marches through uneven media in steps with one random offset: e^-tau of a noisy optical "
     "depth is too bright on average (Jensen), and less so with smaller steps"},
    {NULL, STEPPED, "its steps are too long: the error shrinks with them as it should"},
    {NULL, BAKED,
     "it renders voxels in place of the medium: the row includes the error of the voxel grid"},
};

const char *neph_participant_cause(const struct neph_participant *participant,
                                   const struct neph_check *check,
                                   const struct neph_participation *part)
{
    const bool is_so[WHEN_COUNT] = {[ALWAYS] = true,
                                    [LOWERED] = part->lowered,
                                    [BAKED] = part->baked,
                                    [STEPPED] = part->stepped && check->uneven,
                                    [DEEP] = check->deep};
    for (size_t i = 0; i < sizeof(causes) / sizeof(causes[0]); i++)
        if ((!causes[i].participant || strcmp(causes[i].participant, participant->name) == 0) &&
            is_so[causes[i].when])
            return causes[i].cause;
    return NULL;
}
