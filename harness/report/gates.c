/* SPDX-License-Identifier: MIT */
#include "harness/report/gates.h"

#include <math.h>
#include <string.h>

static int frame_of_engine(const struct neph_scene_result *result, const char *engine)
{
    for (int f = 0; f < result->frame_count; f++)
        if (strcmp(result->frames[f].engine->name, engine) == 0)
            return f;
    return -1;
}

/* NaN when there is no such number. */
static double value_of(const struct neph_frame_result *frame, const struct neph_gate *gate)
{
    const struct neph_measurement *number = neph_measurement_find(
        &frame->measurements, neph_gate_quantity_name(gate->quantity), gate->metric, gate->mask);
    return number && number->defined ? number->value : NAN;
}

/* A gate is not measured where its engine is missing, cannot, or is itself the truth; a frame that
 * was there to be measured and has no such number does not pass it. A limit was set for what the
 * engine does with all its samples: a frame that got fewer may keep it, but cannot break it. */
static void judge(const struct neph_gate *gate, const struct neph_scene_result *scene,
                  struct neph_arena *arena, struct neph_gate_result *result)
{
    const int f = frame_of_engine(scene, gate->engine);
    const struct neph_frame_result *frame = f < 0 ? NULL : &scene->frames[f];
    const double value = frame ? value_of(frame, gate) : NAN;
    const bool owed = frame && frame->path && scene->truth >= 0 && f != scene->truth;
    const bool kept = fabs(value) <= gate->maximum;
    *result = (struct neph_gate_result){
        .engine = neph_arena_text(arena, gate->engine),
        .quantity = neph_gate_quantity_name(gate->quantity),
        .metric = neph_arena_text(arena, gate->metric),
        .mask = neph_arena_text(arena, gate->mask),
        .value = value,
        .maximum = gate->maximum,
        .verdict = kept                    ? NEPH_GATE_PASS
                   : !isnan(value) || owed ? NEPH_GATE_FAIL
                                           : NEPH_GATE_NOT_MEASURED,
        .reason = neph_arena_text(arena, gate->reason),
    };
    if (isnan(value) || kept || !frame->note[0])
        return;
    result->value = NAN;
    result->verdict = NEPH_GATE_NOT_MEASURED;
    result->reason = neph_arena_format(arena, "not judged: %s", frame->note);
}

void neph_gates_judge(const struct neph_scene *scene, struct neph_arena *arena,
                      struct neph_scene_result *result)
{
    result->gates = neph_arena_zeroed(arena, (size_t)scene->gate_count, sizeof(*result->gates));
    result->gate_count = result->gates ? scene->gate_count : 0;
    for (int g = 0; g < result->gate_count; g++)
        judge(&scene->gates[g], result, arena, &result->gates[g]);
}
