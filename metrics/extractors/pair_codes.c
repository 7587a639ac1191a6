/* SPDX-License-Identifier: MIT */
#include "metrics/extractors/pair_codes.h"

#include "base/threads.h"
#include "metrics/extractors/display_luma.h"

#include <math.h>
#include <string.h>

enum { ROW_GROUP = 8 }; /* rows per job */

void neph_pair_codes_forget(struct neph_pair_codes *codes)
{
    for (int k = 0; k < NEPH_CODE_COUNT; k++)
        codes->kinds[k].is_made = false;
    codes->luma.is_made = false;
}

struct encoding {
    const struct neph_frame_pair *pair;
    const struct neph_code_planes *planes;
};

static void encode_group(int group, void *context)
{
    const struct encoding *encoding = context;
    const struct neph_frame_pair *pair = encoding->pair;
    const struct neph_code_planes *planes = encoding->planes;
    const size_t width = (size_t)pair->width_px, height = (size_t)pair->height_px;
    const size_t first_row = (size_t)group * ROW_GROUP;
    const size_t row_count = height - first_row < ROW_GROUP ? height - first_row : ROW_GROUP;
    const size_t first = first_row * width, count = row_count * width;
    neph_code_pixels(planes->code, pair->reference, first, count, planes->reference + first);
    neph_code_pixels(planes->code, pair->test, first, count, planes->test + first);
}

/* Allocate the planes, once; they stay for later pairs, also after a failure. */
static enum neph_status prepare(const struct neph_frame_pair *pair, enum neph_code_kind kind,
                                struct neph_code_planes *planes, struct neph_diag *diag)
{
    const size_t count = (size_t)pair->width_px * (size_t)pair->height_px;
    struct neph_arena *memory = pair->codes->memory;
    if (!planes->reference)
        planes->reference = neph_arena_allocate(memory, count, sizeof(double));
    if (!planes->test)
        planes->test = neph_arena_allocate(memory, count, sizeof(double));
    if (!planes->reference || !planes->test)
        return neph_fail_memory(diag);
    return planes->code ? NEPH_OK
                        : neph_code_create(kind, pair->viewing, memory, &planes->code, diag);
}

enum neph_status neph_pair_codes_get(const struct neph_frame_pair *pair, enum neph_code_kind kind,
                                     const struct neph_code_planes **planes, struct neph_diag *diag)
{
    struct neph_code_planes *of_kind = &pair->codes->kinds[kind];
    struct encoding encoding = {pair, of_kind};
    enum neph_status status = prepare(pair, kind, of_kind, diag);
    if (!status && !of_kind->is_made)
        status = neph_parallel_rows((pair->height_px + ROW_GROUP - 1) / ROW_GROUP, encode_group,
                                    &encoding, diag);
    if (status)
        return status;
    of_kind->is_made = true;
    *planes = of_kind;
    return NEPH_OK;
}

/* ---- luma ------------------------------------------------------------------------------------ */

static void convert_row(const float *const planes[3], size_t first, size_t count, double gain,
                        double *luma)
{
    const float *const row[3] = {planes[0] + first, planes[1] + first, planes[2] + first};
    neph_display_luma(row, count, gain, luma + first, NULL);
}

/* Compared by value: the caller may read every frame into the same memory. */
static bool is_seen(const struct neph_frame_pair *pair, size_t first, size_t count)
{
    const struct neph_luma_planes *luma = &pair->codes->luma;
    bool same = luma->has_seen;
    for (int c = 0; c < 3 && same; c++)
        same = memcmp(pair->reference[c] + first, luma->seen[c] + first, count * sizeof(float)) ==
               0;
    return same;
}

static void convert_luma(int row, void *context)
{
    const struct neph_frame_pair *pair = context;
    const struct neph_luma_planes *luma = &pair->codes->luma;
    const size_t width = (size_t)pair->width_px, first = (size_t)row * width;
    const double gain = exp2(pair->viewing->exposure_ev);
    convert_row(pair->test, first, width, gain, luma->test);
    if (is_seen(pair, first, width))
        return;
    convert_row(pair->reference, first, width, gain, luma->reference);
    for (int c = 0; c < 3; c++)
        memcpy(luma->seen[c] + first, pair->reference[c] + first, width * sizeof(float));
}

static enum neph_status allocate_luma(const struct neph_frame_pair *pair, struct neph_diag *diag)
{
    const size_t count = (size_t)pair->width_px * (size_t)pair->height_px;
    struct neph_luma_planes *luma = &pair->codes->luma;
    struct neph_arena *memory = &pair->codes->luma_memory;
    if (luma->reference)
        return NEPH_OK;
    luma->reference = neph_arena_allocate(memory, count, sizeof(double));
    luma->test = neph_arena_allocate(memory, count, sizeof(double));
    for (int c = 0; c < 3; c++)
        luma->seen[c] = neph_arena_allocate(memory, count, sizeof(float));
    const enum neph_status status = neph_arena_check(memory, diag);
    if (status)
        neph_pair_luma_end(pair->codes);
    return status;
}

enum neph_status neph_pair_luma_get(const struct neph_frame_pair *pair,
                                    const struct neph_luma_planes **planes, struct neph_diag *diag)
{
    struct neph_luma_planes *luma = &pair->codes->luma;
    struct neph_frame_pair rows = *pair;
    enum neph_status status = allocate_luma(pair, diag);
    if (!status && !luma->is_made)
        status = neph_parallel_rows(pair->height_px, convert_luma, &rows, diag);
    if (status)
        return status;
    luma->is_made = luma->has_seen = true;
    *planes = luma;
    return NEPH_OK;
}

void neph_pair_luma_end(struct neph_pair_codes *codes)
{
    neph_arena_finish(&codes->luma_memory);
    codes->luma = (struct neph_luma_planes){.reference = NULL};
}
