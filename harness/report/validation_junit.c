/* SPDX-License-Identifier: MIT
 *
 * The results of `neph validate` and of the physics suite as JUnit test cases.
 */
#include "harness/report/validation.h"

#include <math.h>
#include <string.h>

/* Compiles only when this file handles every verdict. */
_Static_assert(NEPH_GATE_VERDICT_COUNT == 3, "a new kind");
_Static_assert(NEPH_PHYSICS_VERDICT_COUNT == 3, "a new kind");

/* An engine that does not model a scene, or is not installed, is skipped, not failed. */
static enum neph_junit_result find_junit_result(enum neph_outcome outcome)
{
    if (outcome == NEPH_OUTCOME_RENDERED)
        return NEPH_JUNIT_PASSED;
    return neph_outcome_is_broken(outcome) ? NEPH_JUNIT_FAILED : NEPH_JUNIT_SKIPPED;
}

static const char *format_factor_case(struct neph_arena *arena, const char *engine,
                                      const char *quantity)
{
    return neph_arena_format(arena, "%s %s within a factor of two of the reference", engine,
                             quantity);
}

static void add_gate(const struct neph_gate_result *gate, const char *group,
                     struct neph_junit *junit)
{
    static const enum neph_junit_result results[NEPH_GATE_VERDICT_COUNT] = {
        [NEPH_GATE_PASS] = NEPH_JUNIT_PASSED,
        [NEPH_GATE_FAIL] = NEPH_JUNIT_FAILED,
        [NEPH_GATE_NOT_MEASURED] = NEPH_JUNIT_SKIPPED,
    };
    struct neph_arena *arena = &junit->arena;
    const char *name = neph_arena_format(arena, "%s %s %s over %s", gate->engine, gate->quantity,
                                         gate->metric, gate->mask);
    const char *message = "";
    if (gate->line == 0)
        name = format_factor_case(arena, gate->engine, gate->quantity);
    if (gate->verdict == NEPH_GATE_FAIL)
        message =
            isnan(gate->value)
                ? neph_arena_format(arena, "no number, limit %.4g: %s", gate->maximum, gate->reason)
                : neph_arena_format(arena, "%s %.4g is above the limit, %.4g: %s", gate->metric,
                                    fabs(gate->value), gate->maximum, gate->reason);
    else if (gate->verdict == NEPH_GATE_NOT_MEASURED)
        message = "not measured";
    neph_junit_add(junit, group, name, results[gate->verdict], message);
}

/* Add passed cases for means without a gate: harness/report/gates.c lists only the means outside
 * the factor of two. */
static void add_means(const struct neph_scene_result *scene, int index, const char *group,
                      struct neph_junit *junit)
{
    static const char *const quantities[] = {"radiance", "transmittance"};
    const struct neph_frame_result *frame = &scene->frames[index];
    const char *engine = frame->engine->name;
    if (!frame->path || frame->is_look || scene->truth < 0 || index == scene->truth)
        return;
    for (size_t q = 0; q < sizeof(quantities) / sizeof(quantities[0]); q++)
        if (!neph_scene_is_gated(scene, engine, quantities[q]))
            neph_junit_add(junit, group, format_factor_case(&junit->arena, engine, quantities[q]),
                           frame->note[0] ? NEPH_JUNIT_SKIPPED : NEPH_JUNIT_PASSED, frame->note);
}

static bool has_engine(const struct neph_scene_result *scene, const char *engine)
{
    for (int f = 0; f < scene->frame_count; f++)
        if (strcmp(scene->frames[f].engine->name, engine) == 0)
            return true;
    return false;
}

/* Gates of engines that are not part of the run are left out. */
static void add_scene(const struct neph_scene_result *scene, struct neph_junit *junit)
{
    const char *group = neph_arena_format(&junit->arena, "validate %s", scene->name);
    for (int f = 0; f < scene->frame_count; f++) {
        const struct neph_frame_result *frame = &scene->frames[f];
        neph_junit_add(junit, group,
                       neph_arena_format(&junit->arena, "%s renders", frame->engine->name),
                       find_junit_result(frame->outcome), frame->reason);
        neph_junit_set_location(junit, scene->file, 1);
        add_means(scene, f, group, junit);
    }
    for (int g = 0; g < scene->gate_count; g++) {
        if (!has_engine(scene, scene->gates[g].engine))
            continue;
        add_gate(&scene->gates[g], group, junit);
        neph_junit_set_location(junit, scene->file,
                                scene->gates[g].line > 0 ? scene->gates[g].line : 1);
    }
}

/* A deviation fails only reference engines; for other engines the suite reports its size. */
static void add_row(const struct neph_physics_row *row, struct neph_junit *junit)
{
    const bool claims_truth = row->engine->rung <= NEPH_LEVEL_TRACER;
    enum neph_junit_result result = find_junit_result(row->outcome);
    if (result == NEPH_JUNIT_PASSED && row->verdict == NEPH_PHYSICS_NOT_MEASURED)
        result = NEPH_JUNIT_SKIPPED;
    if (result == NEPH_JUNIT_PASSED && row->verdict == NEPH_PHYSICS_OFF)
        result = claims_truth ? NEPH_JUNIT_FAILED : NEPH_JUNIT_SKIPPED;
    neph_junit_add(junit, neph_arena_format(&junit->arena, "physics %s", row->check->name),
                   row->participant->name, result,
                   row->reason && row->reason[0] ? row->reason : row->sentence);
}

static void add_phase(const struct neph_phase_finding *finding, struct neph_junit *junit)
{
    char name[128];
    neph_phase_describe(&finding->phase, name, sizeof(name));
    neph_junit_add(junit, "physics phase functions", neph_arena_copy_text(&junit->arena, name),
                   finding->agrees ? NEPH_JUNIT_PASSED : NEPH_JUNIT_FAILED,
                   finding->agrees ? "" : "it does not agree with its definition");
}

static void add_sequence(const struct neph_over_time *sequence, struct neph_junit *junit)
{
    const char *group = neph_arena_format(&junit->arena, "validate sequence %s", sequence->scene);
    neph_junit_add(junit, group, "reference renders",
                   find_junit_result(sequence->reference.outcome), sequence->reference.reason);
    for (int i = 0; i < sequence->row_count; i++)
        neph_junit_add(junit, group,
                       neph_arena_format(&junit->arena, "%s renders", sequence->rows[i].preset),
                       find_junit_result(sequence->rows[i].outcome), sequence->rows[i].reason);
}

void neph_validation_junit(const struct neph_validation *validation, struct neph_junit *junit)
{
    const struct neph_physics *physics = validation->physics;
    junit->seconds = validation->seconds;
    for (int s = 0; s < validation->scene_count; s++)
        add_scene(&validation->scenes[s], junit);
    for (int a = 0; a < validation->absent_count; a++)
        neph_junit_add(junit,
                       neph_arena_format(&junit->arena, "validate %s", validation->absent[a].scene),
                       "its data is here", NEPH_JUNIT_SKIPPED, validation->absent[a].reason);
    if (validation->over_time)
        add_sequence(validation->over_time, junit);
    for (int p = 0; physics && p < physics->phase_count; p++)
        add_phase(&physics->phases[p], junit);
    for (int r = 0; physics && r < physics->row_count; r++)
        add_row(&physics->rows[r], junit);
    neph_junit_add(junit, "validate", "verdict",
                   validation->verdict == NEPH_VERDICT_PASS ? NEPH_JUNIT_PASSED : NEPH_JUNIT_FAILED,
                   validation->verdict == NEPH_VERDICT_PASS ? ""
                   : validation->counts.compared > 0        ? "the run failed; see the other cases"
                                                     : "nothing was compared with a reference");
}
