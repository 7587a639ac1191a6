/* SPDX-License-Identifier: MIT */
#include "harness/physics/participants.h"

#include <string.h>

static const struct neph_participant participants[] = {
    {.name = "exact", .engine = "exact", .refined = "", .rounding = 1e-6},
    {.name = "oracle", .engine = "oracle", .rounding = 1e-6},
    {.name = "tracer", .engine = "tracer", .rounding = 1e-6},
    /* Homogeneous single scattering, where Cycles has no step, came out within 1e-4 in every case
     * measured: its float32 sums, and paths that it ends below a throughput of 1e-6. */
    {.name = "cycles", .engine = "cycles", .settings = {"samples=256"}, .rounding = 1e-4},
    {.name = "povray",
     .engine = "povray",
     .refined = "intervals=100",
     .order = 2,
     /* 16-bit pictures: half a step of a range that the brightest pixel fills. */
     .rounding = 2e-5},
    {.name = "march", .engine = "march", .refined = "steps=128", .order = 2, .rounding = 1e-6},
    {.name = "march octaves",
     .engine = "march_octaves",
     .refined = "steps=128",
     .order = 2,
     .rounding = 1e-6},
};

int neph_participant_count(void)
{
    return (int)(sizeof(participants) / sizeof(participants[0]));
}

const struct neph_participant *neph_participant_at(int index)
{
    return &participants[index];
}

/* The first row that fits speaks. NULL fits everything. */
static const struct {
    const char *participant;
    bool lowered_only, uneven_only;
    const char *cause;
} causes[] = {
    {"povray", true, false,
     "it has single scattering from light sources only: no light of the surroundings and no higher "
     "orders"},
    {NULL, true, false, "it models single scattering only"},
    {"march octaves", false, false,
     "a sum of octaves is a look: it saturates with optical depth and does not conserve energy"},
    {"cycles", false, true,
     "it marches through uneven media in steps with one random offset: e^-tau of a noisy optical "
     "depth is too bright on average (Jensen), and less so with smaller steps"},
    {"povray", false, true, "its midpoint rule has a step error of second order"},
    {"march", false, false, "it marches in steps"},
};

const char *neph_participant_cause(const struct neph_participant *participant,
                                   const struct neph_check *check, bool lowered)
{
    for (size_t i = 0; i < sizeof(causes) / sizeof(causes[0]); i++)
        if ((!causes[i].participant || strcmp(causes[i].participant, participant->name) == 0) &&
            (lowered || !causes[i].lowered_only) && (check->uneven || !causes[i].uneven_only))
            return causes[i].cause;
    return NULL;
}
