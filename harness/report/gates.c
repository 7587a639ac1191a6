/* SPDX-License-Identifier: MIT
 *
 * Evaluates the gates of a scene file. A frame without a gate has a default limit: the means of its
 * radiance and its transmittance must be within a factor of two of the reference's means. So an
 * engine with a large error does not pass because a gate is missing.
 */
#include "scenes/gates.h"
#include "harness/report/validation.h"

#include <math.h>
#include <string.h>

/* Quantities with a default limit. Depth has none: its mean is undefined where depth is
 * infinite. */
enum { QUANTITIES_UNGATED = 2 };

static int find_engine_frame(const struct neph_scene_result *result, const char *engine)
{
    for (int f = 0; f < result->frame_count; f++)
        if (strcmp(result->frames[f].engine->name, engine) == 0)
            return f;
    return -1;
}

/* NaN when the frame has no such measurement. */
static double find_gate_value(const struct neph_frame_result *frame, const struct neph_gate *gate)
{
    const struct neph_measurement *number = neph_measurement_find(
        &frame->measurements, neph_gate_quantity_name(gate->quantity), gate->metric, gate->mask);
    return number && number->defined ? number->value : NAN;
}

/* Evaluate a gate. "Not measured" applies when the engine is missing, cannot render the scene, or
 * is the reference. A frame that was compared but has no such number fails. A limit was set for the
 * full number of samples: a frame with fewer samples can meet it, but cannot fail it. */
static void judge(const struct neph_gate *gate, const char *engine,
                  const struct neph_scene_result *scene, struct neph_arena *arena,
                  struct neph_gate_result *result)
{
    const int f = find_engine_frame(scene, engine);
    const struct neph_frame_result *frame = f < 0 ? NULL : &scene->frames[f];
    const double value = frame ? find_gate_value(frame, gate) : NAN;
    const bool owed = frame && frame->path && scene->truth >= 0 && f != scene->truth;
    const bool kept = fabs(value) <= gate->maximum;
    *result = (struct neph_gate_result){
        .engine = neph_arena_copy_text(arena, engine),
        .quantity = neph_gate_quantity_name(gate->quantity),
        .metric = neph_arena_copy_text(arena, gate->metric),
        .mask = neph_arena_copy_text(arena, gate->mask),
        .value = value,
        .maximum = gate->maximum,
        .verdict = kept                    ? NEPH_GATE_PASS
                   : !isnan(value) || owed ? NEPH_GATE_FAIL
                                           : NEPH_GATE_NOT_MEASURED,
        .reason = neph_arena_copy_text(arena, gate->reason),
        .line = gate->line,
    };
    if (isnan(value) || kept || !frame->note[0])
        return;
    result->value = NAN;
    result->verdict = NEPH_GATE_NOT_MEASURED;
    result->reason = neph_arena_format(arena, "not judged: %s", frame->note);
}

/* ---- default limit --------------------------------------------------------------------------- */

/* One stop up or down. Among the catalogue's frames of physical engines the largest error of a mean
 * is 21 % (realtime in spot_fence, 48 x 27 pixels). Wrong units (pi, 4 pi, sRGB code values as
 * linear ones) cause more than a factor of two. */
static const double least_share = 0.5, largest_share = 2.0;

static const char ungated_reason[] =
    "no gate of the scene limits this, so its mean must be within a factor of two of the reference";

bool neph_scene_is_gated(const struct neph_scene_result *scene, const char *engine,
                         const char *quantity)
{
    for (int g = 0; g < scene->gate_count; g++)
        if (strcmp(scene->gates[g].engine, engine) == 0 &&
            strcmp(scene->gates[g].quantity, quantity) == 0)
            return true;
    return false;
}

/* Find the measurement that shows a mean outside the factor of two, and its limit. NULL: the mean
 * is within the factor, or was not measured. A reference mean of 0 has no relative bias; any other
 * mean exceeds it. */
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

/* Apply the default limit to a frame of a physical engine. Frames with fewer samples are exempt, as
 * with gates. */
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
                .metric = neph_arena_copy_text(arena, found->metric->name),
                .mask = neph_arena_copy_text(arena, found->mask),
                .value = found->value,
                .maximum = maximum,
                .verdict = NEPH_GATE_FAIL,
                .reason = ungated_reason,
            };
    }
}

/* Gates of `cycles` apply to other Blender versions as well. */
static void judge_further(const struct neph_scene *scene, const struct neph_engine *engine,
                          struct neph_arena *arena, struct neph_scene_result *result)
{
    const struct neph_gates *gates = neph_scene_gates(scene);
    for (int g = 0; g < gates->count && engine->first; g++)
        if (neph_engine_is_kind(engine, gates->list[g].engine))
            judge(&gates->list[g], engine->name, result, arena,
                  &result->gates[result->gate_count++]);
}

void neph_gates_judge(const struct neph_scene *scene, struct neph_arena *arena,
                      struct neph_scene_result *result)
{
    const struct neph_gates *gates = neph_scene_gates(scene);
    const int most = gates->count + (gates->count + QUANTITIES_UNGATED) * result->frame_count;
    result->gates = neph_arena_allocate(arena, (size_t)most, sizeof(*result->gates));
    result->gate_count = result->gates ? gates->count : 0;
    for (int g = 0; g < result->gate_count; g++)
        judge(&gates->list[g], gates->list[g].engine, result, arena, &result->gates[g]);
    for (int f = 0; f < result->frame_count && result->gates; f++)
        judge_further(scene, result->frames[f].engine, arena, result);
    for (int f = 0; f < result->frame_count && result->gates && result->truth >= 0; f++)
        if (f != result->truth)
            judge_ungated(&result->frames[f], result, arena);
}
