/* SPDX-License-Identifier: MIT
 *
 * The limits of a scene file against what was measured. A frame that they do not name is limited,
 * too: the means of its radiance and its transmittance are to be within a factor of two of those of
 * the truth. So an engine that is far off does not pass for want of a gate.
 */
#include "scenes/gates.h"
#include "harness/report/validation.h"

#include <math.h>
#include <string.h>

/* Quantities that are limited where no gate names them. Depth is not: no mean is taken of it where
 * it is infinite. */
enum { QUANTITIES_UNGATED = 2 };

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
static void judge(const struct neph_gate *gate, const char *engine,
                  const struct neph_scene_result *scene, struct neph_arena *arena,
                  struct neph_gate_result *result)
{
    const int f = frame_of_engine(scene, engine);
    const struct neph_frame_result *frame = f < 0 ? NULL : &scene->frames[f];
    const double value = frame ? value_of(frame, gate) : NAN;
    const bool owed = frame && frame->path && scene->truth >= 0 && f != scene->truth;
    const bool kept = fabs(value) <= gate->maximum;
    *result = (struct neph_gate_result){
        .engine = neph_arena_text(arena, engine),
        .quantity = neph_gate_quantity_name(gate->quantity),
        .metric = neph_arena_text(arena, gate->metric),
        .mask = neph_arena_text(arena, gate->mask),
        .value = value,
        .maximum = gate->maximum,
        .verdict = kept                    ? NEPH_GATE_PASS
                   : !isnan(value) || owed ? NEPH_GATE_FAIL
                                           : NEPH_GATE_NOT_MEASURED,
        .reason = neph_arena_text(arena, gate->reason),
        .line = gate->line,
    };
    if (isnan(value) || kept || !frame->note[0])
        return;
    result->value = NAN;
    result->verdict = NEPH_GATE_NOT_MEASURED;
    result->reason = neph_arena_format(arena, "not judged: %s", frame->note);
}

/* ---- the limit of what no gate names --------------------------------------------------------- */

/* One stop, upwards or downwards. Of the frames of the catalogue that claim physics the worst is
 * off by 21 % (realtime in spot_fence, 48 x 27 pixels). What mistaken units cost (pi, 4 pi, code
 * values of sRGB for linear ones) is more than a factor of two. */
static const double least_share = 0.5, largest_share = 2.0;

static const char ungated_reason[] =
    "no gate of the scene limits this, so its mean is to be within a factor "
    "of two of the truth's";

bool neph_scene_is_gated(const struct neph_scene_result *scene, const char *engine,
                         const char *quantity)
{
    for (int g = 0; g < scene->gate_count; g++)
        if (strcmp(scene->gates[g].engine, engine) == 0 &&
            strcmp(scene->gates[g].quantity, quantity) == 0)
            return true;
    return false;
}

/* Which number says that a mean is off by more than a factor of two, and how large it may be; NULL:
 * the mean is not, or it was not measured. A truth of 0 has no relative bias, and no other mean is
 * near it. */
static const struct neph_measurement *find_excess(const struct neph_frame_result *frame,
                                                  const char *quantity, double *maximum)
{
    const struct neph_measurement *relative = neph_measurement_find(&frame->measurements, quantity,
                                                                    "rel_bias", "all");
    const struct neph_measurement *bias = neph_measurement_find(&frame->measurements, quantity,
                                                                "bias", "all");
    if (relative && relative->defined) {
        const double share = 1.0 + relative->value;
        *maximum = share > 1.0 ? largest_share - 1.0 : 1.0 - least_share;
        return share >= least_share && share <= largest_share ? NULL : relative;
    }
    *maximum = 0.0;
    return bias && bias->defined && bias->value != 0.0 ? bias : NULL;
}

/* A frame that is the truth, claims no physics or lacks samples is not limited, as by gates. */
static void judge_ungated(const struct neph_frame_result *frame, struct neph_scene_result *scene,
                          struct neph_arena *arena)
{
    static const enum neph_gate_quantity quantities[QUANTITIES_UNGATED] = {
        NEPH_QUANTITY_RADIANCE, NEPH_QUANTITY_TRANSMITTANCE};
    if (!frame->path || frame->is_look || frame->note[0])
        return;
    scene->ungated_count += !neph_scene_is_gated(scene, frame->engine->name,
                                                 neph_gate_quantity_name(NEPH_QUANTITY_RADIANCE));
    for (size_t i = 0; i < QUANTITIES_UNGATED; i++) {
        const char *quantity = neph_gate_quantity_name(quantities[i]);
        double maximum;
        const struct neph_measurement *found = find_excess(frame, quantity, &maximum);
        if (found && !neph_scene_is_gated(scene, frame->engine->name, quantity))
            scene->gates[scene->gate_count++] = (struct neph_gate_result){
                .engine = frame->engine->name,
                .quantity = quantity,
                .metric = neph_arena_text(arena, found->metric->name),
                .mask = neph_arena_text(arena, found->mask),
                .value = found->value,
                .maximum = maximum,
                .verdict = NEPH_GATE_FAIL,
                .reason = ungated_reason,
            };
    }
}

/* The gates of `cycles` hold for other Blenders, too. */
static void judge_further(const struct neph_scene *scene, const struct neph_engine *engine,
                          struct neph_arena *arena, struct neph_scene_result *result)
{
    const struct neph_gates *gates = neph_scene_gates(scene);
    for (int g = 0; g < gates->count && engine->first; g++)
        if (neph_engine_is(engine, gates->list[g].engine))
            judge(&gates->list[g], engine->name, result, arena,
                  &result->gates[result->gate_count++]);
}

void neph_gates_judge(const struct neph_scene *scene, struct neph_arena *arena,
                      struct neph_scene_result *result)
{
    const struct neph_gates *gates = neph_scene_gates(scene);
    const int most = gates->count + (gates->count + QUANTITIES_UNGATED) * result->frame_count;
    result->gates = neph_arena_zeroed(arena, (size_t)most, sizeof(*result->gates));
    result->gate_count = result->gates ? gates->count : 0;
    for (int g = 0; g < result->gate_count; g++)
        judge(&gates->list[g], gates->list[g].engine, result, arena, &result->gates[g]);
    for (int f = 0; f < result->frame_count && result->gates; f++)
        judge_further(scene, result->frames[f].engine, arena, result);
    for (int f = 0; f < result->frame_count && result->gates && result->truth >= 0; f++)
        if (f != result->truth)
            judge_ungated(&result->frames[f], result, arena);
}
