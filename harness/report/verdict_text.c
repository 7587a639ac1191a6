/* SPDX-License-Identifier: MIT
 *
 * The verdict of a run in one sentence. A verdict covers only the compared frames, so the sentence
 * names each engine that is not installed, is over its budget, has fewer samples than set, or has
 * noise whose size is in doubt.
 */
#include "base/doubt.h"
#include "harness/report/validation.h"

/* Compiles only when this file handles every outcome. */
_Static_assert(NEPH_OUTCOME_COUNT == 7, "a new kind");

static bool is_missing(const struct neph_frame_result *frame)
{
    return frame->outcome == NEPH_OUTCOME_MISSING;
}

static bool is_over_budget(const struct neph_frame_result *frame)
{
    return frame->outcome == NEPH_OUTCOME_OVER_BUDGET;
}

/* A frame of a physical engine has a note when it got fewer samples. */
static bool has_fewer_samples(const struct neph_frame_result *frame)
{
    return frame->path && !frame->is_look && frame->note[0];
}

static bool has_doubtful_noise(const struct neph_frame_result *frame)
{
    return frame->path && frame->noise_doubt > NEPH_DOUBTFUL;
}

static const struct shortfall {
    bool (*has)(const struct neph_frame_result *frame);
    const char *before, *after; /* text around an engine's name */
} shortfalls[] = {{is_missing, ", without ", " (not installed)"},
                  {is_over_budget, ", without ", " (did not fit its budget)"},
                  {has_fewer_samples, ", with fewer samples than set for ", ""},
                  {has_doubtful_noise, ", with an error bar that is not to be trusted of ", ""}};

static int count_scenes(const struct neph_validation *validation, int engine,
                        const struct shortfall *shortfall)
{
    int count = 0;
    for (int s = 0; s < validation->scene_count; s++) {
        const struct neph_scene_result *scene = &validation->scenes[s];
        count += engine < scene->frame_count && shortfall->has(&scene->frames[engine]);
    }
    return count;
}

static void print_shortfall(const struct neph_validation *validation,
                            const struct shortfall *shortfall, FILE *out)
{
    for (int e = 0; e < validation->field.count; e++) {
        const int count = count_scenes(validation, e, shortfall);
        if (count == 0)
            continue;
        fprintf(out, "%s%s", shortfall->before, validation->field.engines[e]->name);
        if (count < validation->scene_count)
            fprintf(out, " in %d of %d scenes", count, validation->scene_count);
        fputs(shortfall->after, out);
    }
}

void neph_validation_print_verdict(const struct neph_validation *validation, FILE *out)
{
    fputs(neph_verdict_name(validation->verdict), out);
    for (size_t i = 0; i < sizeof(shortfalls) / sizeof(shortfalls[0]); i++)
        print_shortfall(validation, &shortfalls[i], out);
}
