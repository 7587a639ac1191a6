/* SPDX-License-Identifier: MIT */
#include "harness/report/ranking.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A part of the error is named as the cause, and a mask as the location, when it contains at least
 * half of the squared error. A location must also contain at least 1.5 times its share of the
 * pixels. */
static const double least_share = 0.5, least_density = 1.5;

/* A step with a larger optical depth is called too long: it transmits less than 1/e of the light
 * from its far end. */
static const double long_step = 1.0;

/* ---- order ----------------------------------------------------------------------------------- */

const struct neph_measurement *neph_ranking_number(const struct neph_frame_result *frame)
{
    static const char *const candidates[][2] = {
        {"radiance", "rel_rmse"}, {"transmittance", "rmse"}, {"depth", "rel_rmse"}};
    for (size_t i = 0; i < sizeof(candidates) / sizeof(candidates[0]); i++) {
        const struct neph_measurement *number = neph_measurement_find(
            &frame->measurements, candidates[i][0], candidates[i][1], "all");
        if (number && number->defined)
            return number;
    }
    return NULL;
}

static bool is_failing(const struct neph_scene_result *scene, const char *engine)
{
    for (int g = 0; g < scene->gate_count; g++)
        if (scene->gates[g].verdict == NEPH_GATE_FAIL &&
            strcmp(scene->gates[g].engine, engine) == 0)
            return true;
    return false;
}

/* Order of the run for equal errors: scenes and the frames of a scene are elements of two
 * arrays. */
static int compare_places(const struct neph_ranked *a, const struct neph_ranked *b)
{
    if (a->scene != b->scene)
        return a->scene < b->scene ? -1 : 1;
    return a->frame < b->frame ? -1 : a->frame > b->frame;
}

static int compare_ranked(const void *a_, const void *b_)
{
    const struct neph_ranked *a = a_, *b = b_;
    if (a->is_failing != b->is_failing)
        return a->is_failing ? -1 : 1;
    if (a->number->value != b->number->value)
        return a->number->value > b->number->value ? -1 : 1;
    return compare_places(a, b);
}

int neph_ranking(const struct neph_validation *validation, struct neph_ranked *list, int most)
{
    int count = 0;
    for (int s = 0; s < validation->scene_count; s++) {
        const struct neph_scene_result *scene = &validation->scenes[s];
        for (int f = 0; f < scene->frame_count && scene->truth >= 0 && count < most; f++) {
            const struct neph_frame_result *frame = &scene->frames[f];
            const struct neph_measurement *number = neph_ranking_number(frame);
            if (f != scene->truth && number)
                list[count++] = (struct neph_ranked){scene, frame, number,
                                                     is_failing(scene, frame->engine->name)};
        }
    }
    qsort(list, (size_t)count, sizeof(*list), compare_ranked);
    return count;
}

/* ---- location of an error -------------------------------------------------------------------- */

struct place {
    double error_share, pixel_share;
    const char *words;
};

static bool is_concentrated(const struct place *place)
{
    return place->error_share >= least_share &&
           place->error_share >= least_density * place->pixel_share;
}

/* The share of the squared error within a mask, from the RMSE over the mask and over the frame. */
static struct place find_mask(const struct neph_ranked *ranked, const char *mask, const char *words)
{
    const char *quantity = ranked->number->quantity->name;
    const struct neph_measurements *list = &ranked->frame->measurements;
    const struct neph_measurement *all = neph_measurement_find(list, quantity, "rmse", "all");
    const struct neph_measurement *part = neph_measurement_find(list, quantity, "rmse", mask);
    if (!all || !part || !all->defined || !part->defined || !(all->value > 0.0))
        return (struct place){0.0, 1.0, words};
    const double pixels = (double)part->pixel_count / (double)all->pixel_count;
    const double ratio = part->value / all->value;
    return (struct place){fmin(ratio * ratio * pixels, 1.0), pixels, words};
}

/* The smallest mask that contains most of the error. */
static struct place find_place(const struct neph_ranked *ranked)
{
    static const char *const masks[][2] = {{"depth_edge", "within 2\u00a0px of edges in depth"},
                                           {"thin", "at thin objects"},
                                           {"sun", "around the sun"},
                                           {"cloud", "in the cloud"},
                                           {"fog", "in the fog"},
                                           {"medium", "inside the medium"},
                                           {"sky", "in the sky"},
                                           {"solid", "on solids"}};
    const struct neph_error_parts *parts = &ranked->frame->error_parts;
    struct place best = {0.0, 1.0, NULL};
    if (strcmp(ranked->number->quantity->name, "radiance") == 0 && isfinite(parts->edge_share))
        best = (struct place){parts->edge_share, parts->edge_pixel_share,
                              "within 2\u00a0px of edges of brightness"};
    for (size_t i = 0; i < sizeof(masks) / sizeof(masks[0]); i++) {
        const struct place place = find_mask(ranked, masks[i][0], masks[i][1]);
        if (is_concentrated(&place) &&
            (!is_concentrated(&best) || place.pixel_share < best.pixel_share))
            best = place;
    }
    return best;
}

/* A share as text; a share below 1 is not rounded to 100 %. */
static const char *format_percent(double share, struct neph_arena *arena)
{
    if (share > 0.995 && share < 1.0)
        return "over 99\u00a0%";
    return neph_arena_format(arena, "%.0f\u00a0%%", 100.0 * fmin(share, 1.0));
}

static const char *describe_place(const struct neph_ranked *ranked, struct neph_arena *arena)
{
    const struct place place = find_place(ranked);
    if (!is_concentrated(&place))
        return "Where: spread over the frame.";
    return neph_arena_format(arena, "Where: %s of the squared error lies %s (%s of the pixels).",
                             format_percent(place.error_share, arena), place.words,
                             format_percent(place.pixel_share, arena));
}

/* ---- cause of an error ----------------------------------------------------------------------- */

static double defined_value(const struct neph_ranked *ranked, const char *metric)
{
    const struct neph_measurement *number = neph_measurement_find(
        &ranked->frame->measurements, ranked->number->quantity->name, metric, "all");
    return number && number->defined ? number->value : NAN;
}

/* The largest part of the error, as text; NULL: no part has half of it. */
static const char *find_part(const struct neph_ranked *ranked, struct neph_arena *arena)
{
    const struct neph_error_parts *parts = &ranked->frame->error_parts;
    const double shift_gain = defined_value(ranked, "shift_gain");
    const double shift_share = 1.0 - shift_gain * shift_gain;
    const bool is_radiance = strcmp(ranked->number->quantity->name, "radiance") == 0;
    if (is_radiance && parts->noise_share >= least_share)
        return neph_arena_format(arena,
                                 "noise is %s of the squared error, and more samples lower it",
                                 format_percent(parts->noise_share, arena));
    const double bias = defined_value(ranked, "rel_bias");
    if (is_radiance && parts->offset_share >= least_share && isfinite(bias))
        return neph_arena_format(
            arena, "one offset of the whole frame, %+.2g\u00a0%%, is %s of the squared error",
            100.0 * bias, format_percent(parts->offset_share, arena));
    if (shift_share >= least_share)
        return neph_arena_format(arena,
                                 "a shift by up to one pixel explains %s of the squared error",
                                 format_percent(shift_share, arena));
    return NULL;
}

/* Compare a real-time method with the engine of the same lighting model: does the marcher have the
 * same error? NULL: no real-time method, or that engine was not measured here. */
static const char *compare_with_model(const struct neph_ranked *ranked, struct neph_arena *arena)
{
    const char *model = ranked->frame->engine->shortcut_of;
    for (int f = 0; model && f < ranked->scene->frame_count; f++) {
        const struct neph_frame_result *frame = &ranked->scene->frames[f];
        const struct neph_measurement *number = neph_ranking_number(frame);
        if (strcmp(frame->engine->name, model) != 0 || !number ||
            number->metric != ranked->number->metric)
            continue;
        return neph_arena_format(
            arena, "%s, the ray marcher with the same lighting, has an error of %.2g\u00a0%%: %s",
            model, 100.0 * number->value,
            number->value < 0.5 * ranked->number->value
                ? "the error comes from the reuse of pixels and of earlier frames"
                : "most of the error comes from the ray marching");
    }
    return NULL;
}

static const char *find_step(const struct neph_ranked *ranked, struct neph_arena *arena)
{
    const struct neph_frame_result *frame = ranked->frame;
    const struct neph_study *study = frame->study;
    const double step_bias = study ? study->levels[study->chosen].bias : 0.0;
    if (fabs(step_bias) >= least_share * ranked->number->value)
        return neph_arena_format(arena, "the step length causes %+.2g\u00a0%%", 100.0 * step_bias);
    if (frame->step_optical_depth > long_step)
        return neph_arena_format(
            arena,
            "one step spans an optical depth of up to %.2g, and misses changes within the step",
            frame->step_optical_depth);
    if (frame->bakes && frame->bakes->worst.transmittance_max > 0.0)
        return neph_arena_format(arena, "its voxel grid has transmittance errors of up to %.2g",
                                 frame->bakes->worst.transmittance_max);
    return NULL;
}

static const char *describe_cause(const struct neph_ranked *ranked, struct neph_arena *arena)
{
    const char *clauses[] = {find_part(ranked, arena), compare_with_model(ranked, arena),
                             find_step(ranked, arena)};
    const char *all = NULL;
    for (size_t i = 0; i < sizeof(clauses) / sizeof(clauses[0]); i++)
        if (clauses[i])
            all = all ? neph_arena_format(arena, "%s; %s", all, clauses[i]) : clauses[i];
    const char *bias = ranked->frame->engine->bias;
    if (ranked->frame->is_look)
        return neph_arena_format(arena, "Why: its light is a model that claims no physics%s%s.",
                                 bias ? ": " : "", bias ? bias : "");
    if (!all && bias)
        return neph_arena_format(arena, "Why: not measured; known bias of the engine: %s.", bias);
    return all ? neph_arena_format(arena, "Why: %s.", all)
               : "Why: not found; it is neither noise, nor one offset, nor a displacement.";
}

const char *neph_ranked_cause(const struct neph_ranked *ranked, struct neph_arena *arena)
{
    const char *note = ranked->frame->note;
    return neph_arena_format(arena, "%s %s%s%s%s", describe_place(ranked, arena),
                             describe_cause(ranked, arena), note[0] ? " Note of the run: " : "",
                             note, note[0] ? "." : "");
}

/* ---- as JSON --------------------------------------------------------------------------------- */

static json_t *ranked_json(const struct neph_ranked *ranked, struct neph_arena *arena)
{
    const struct neph_error_parts *parts = &ranked->frame->error_parts;
    return json_pack(
        "{s:s, s:s, s:s, s:s, s:s, s:f, s:s, s:b, s:s, s:{s:o, s:o, s:o, s:o}}", "scene",
        ranked->scene->name, "engine", ranked->frame->engine->name, "quantity",
        ranked->number->quantity->name, "metric", ranked->number->metric->name, "mask", "all",
        "value", ranked->number->value, "unit", ranked->number->unit, "failing", ranked->is_failing,
        "cause", neph_ranked_cause(ranked, arena), "parts", "noise",
        neph_json_number(parts->noise_share), "offset", neph_json_number(parts->offset_share),
        "edges", neph_json_number(parts->edge_share), "edge_pixels",
        neph_json_number(parts->edge_pixel_share));
}

json_t *neph_ranking_json(const struct neph_validation *validation)
{
    struct neph_arena arena = {.last = NULL};
    int most = 0;
    for (int s = 0; s < validation->scene_count; s++)
        most += validation->scenes[s].frame_count;
    struct neph_ranked *list = neph_arena_allocate(&arena, (size_t)most + 1, sizeof(*list));
    const int count = list ? neph_ranking(validation, list, most) : 0;
    json_t *ranking = json_array();
    for (int i = 0; i < count; i++)
        neph_json_add(&ranking, ranked_json(&list[i], &arena));
    if (neph_arena_check(&arena, NULL)) {
        json_decref(ranking);
        ranking = NULL;
    }
    neph_arena_finish(&arena);
    return ranking;
}
