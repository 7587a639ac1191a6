/* SPDX-License-Identifier: MIT */
#include "metrics/extractors/pair_codes.h"

#include "base/threads.h"

enum { ROW_GROUP = 8 }; /* rows per job */

void neph_pair_codes_forget(struct neph_pair_codes *codes)
{
    for (int k = 0; k < NEPH_CODE_COUNT; k++)
        codes->kinds[k].is_made = false;
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
