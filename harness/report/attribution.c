/* SPDX-License-Identifier: MIT */
#include "harness/report/attribution.h"

#include "base/exr.h"
#include "harness/engines/engines.h"
#include "metrics/pair.h"
#include "metrics/significance.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct entrant {
    const char *name;
    bool is_shortcut;
    struct neph_image *frames[2]; /* the same frame twice for a deterministic engine */
};

struct field {
    struct entrant entrants[NEPH_ENGINE_COUNT];
    int count;
    struct neph_mask *mask;
};

static void finish(struct field *field)
{
    for (int i = 0; i < field->count; i++) {
        struct entrant *entrant = &field->entrants[i];
        if (entrant->frames[1] != entrant->frames[0])
            neph_image_destroy(entrant->frames[1]);
        neph_image_destroy(entrant->frames[0]);
    }
    neph_mask_destroy(field->mask);
}

static enum neph_status enrol(const struct neph_peer *peer, struct field *field,
                              struct neph_diag *diag)
{
    struct entrant *entrant = &field->entrants[field->count];
    entrant->name = peer->name;
    entrant->is_shortcut = peer->is_shortcut;
    enum neph_status status = neph_exr_read(peer->path, &entrant->frames[0], diag);
    if (status)
        return status;
    entrant->frames[1] = entrant->frames[0];
    field->count++;
    return peer->second_path ? neph_exr_read(peer->second_path, &entrant->frames[1], diag)
                             : NEPH_OK;
}

/* Pixels with a medium: sky and solids in clear air would dilute the differences. */
static enum neph_status choose_mask(struct field *field, struct neph_diag *diag)
{
    for (int i = 0; i < field->count; i++) {
        struct neph_diag why = {.line = 0};
        if (neph_mask_create(field->entrants[i].frames[0], "medium", NULL, &field->mask, &why))
            continue;
        if (field->mask->pixel_count > 0)
            return NEPH_OK;
        neph_mask_destroy(field->mask);
        field->mask = NULL;
    }
    return neph_mask_create(field->entrants[0].frames[0], "all", NULL, &field->mask, diag);
}

static bool has_shortcut(const struct field *field, int i, int j)
{
    return field->entrants[i].is_shortcut || field->entrants[j].is_shortcut;
}

/* Compare the pairs of one family: those with a real-time method, or those without. Each family has
 * its own correction, so that adding a real-time method changes no interval of the other pairs. */
static enum neph_status compare_family(const struct field *field, bool with_shortcuts,
                                       int *verdicts, struct neph_attribution *made,
                                       struct neph_diag *diag)
{
    const int n = field->count;
    int size = 0;
    for (int i = 0; i < n; i++)
        for (int j = i + 1; j < n; j++)
            size += has_shortcut(field, i, j) == with_shortcuts;
    const double critical_z = neph_normal_critical(
        neph_sidak_alpha(NEPH_ATTRIBUTION_FAMILY_ALPHA, size > 0 ? size : 1));
    for (int i = 0; i < n; i++)
        for (int j = i + 1; j < n; j++) {
            if (has_shortcut(field, i, j) != with_shortcuts)
                continue;
            const struct entrant *x = &field->entrants[i], *y = &field->entrants[j];
            const struct neph_image *const frames[4] = {x->frames[0], x->frames[1], y->frames[0],
                                                        y->frames[1]};
            struct neph_peer_pair *pair = &made->pairs[made->pair_count++];
            *pair = (struct neph_peer_pair){x->name, y->name, {.verdict = NEPH_PAIR_CANNOT_TELL}};
            const enum neph_status status = neph_pair_compare(frames, field->mask, critical_z,
                                                              &pair->found, diag);
            if (status)
                return status;
            verdicts[i * n + j] = verdicts[j * n + i] = (int)pair->found.verdict;
        }
    return NEPH_OK;
}

/* The number of engines with which engine `who` has the verdict. */
static int count_verdicts(const int *verdicts, int count, int engine_index,
                          enum neph_pair_verdict verdict)
{
    int found = 0;
    for (int j = 0; j < count; j++)
        found += j != engine_index && verdicts[engine_index * count + j] == (int)verdict;
    return found;
}

int neph_odd_one_out(const char *const *names, int count, const int *verdicts, char sentence[400])
{
    int differing = 0, undecided = 0, odd = -1, odd_count = 0;
    for (int i = 0; i < count; i++) {
        differing += count_verdicts(verdicts, count, i, NEPH_PAIR_DIFFER);
        undecided += count_verdicts(verdicts, count, i, NEPH_PAIR_CANNOT_TELL);
    }
    if (differing == 0) {
        snprintf(sentence, 400, "%s",
                 undecided == 0 ? "all agree" : "cannot tell: noise hides whether all agree");
        return -1;
    }
    /* The engine differs from every other engine, and no two other engines differ. */
    for (int i = 0; i < count; i++) {
        const int own = count_verdicts(verdicts, count, i, NEPH_PAIR_DIFFER);
        if (own == count - 1 && differing == 2 * own) {
            odd = i;
            odd_count++;
        }
    }
    if (odd_count != 1) {
        snprintf(sentence, 400, "%s",
                 undecided == 0 ? "more than one differs: no odd one out"
                                : "cannot tell: some differ, and noise hides the odd one out");
        return -1;
    }
    snprintf(sentence, 400, "%s is the odd one out: it differs from all others, and they %s",
             names[odd], undecided == 0 ? "agree" : "do not differ beyond noise");
    return odd;
}

static enum neph_status conclude(const struct field *field, struct neph_arena *arena,
                                 const struct neph_attribution **attribution,
                                 struct neph_diag *diag)
{
    int verdicts[NEPH_ENGINE_COUNT * NEPH_ENGINE_COUNT] = {0};
    const char *names[NEPH_ENGINE_COUNT];
    const size_t pair_count = (size_t)field->count * (size_t)(field->count - 1) / 2;
    struct neph_attribution *made = neph_arena_allocate(arena, 1, sizeof(*made));
    if (made)
        made->pairs = neph_arena_allocate(arena, pair_count, sizeof(*made->pairs));
    enum neph_status status = neph_arena_check(arena, diag);
    if (!status)
        status = compare_family(field, false, verdicts, made, diag);
    if (!status)
        status = compare_family(field, true, verdicts, made, diag);
    if (status) /* dark, or too few pixels: nothing to attribute */
        return status == NEPH_ERR_UNSUPPORTED ? NEPH_OK : status;
    for (int i = 0; i < field->count; i++)
        names[i] = field->entrants[i].name;
    const int odd = neph_odd_one_out(names, field->count, verdicts, made->sentence);
    made->odd_one_out = odd < 0 ? NULL : names[odd];
    memcpy(made->mask, field->mask->name, sizeof(made->mask));
    made->pixel_count = field->mask->pixel_count;
    *attribution = made;
    return NEPH_OK;
}

enum neph_status neph_attribute(const struct neph_peer *peers, int count, struct neph_arena *arena,
                                const struct neph_attribution **attribution, struct neph_diag *diag)
{
    struct field field = {.count = 0};
    enum neph_status status = NEPH_OK;
    *attribution = NULL;
    if (count < 3)
        return NEPH_OK;
    for (int i = 0; i < count && i < NEPH_ENGINE_COUNT && !status; i++)
        status = enrol(&peers[i], &field, diag);
    if (!status)
        status = choose_mask(&field, diag);
    if (!status)
        status = conclude(&field, arena, attribution, diag);
    finish(&field);
    return status;
}

static json_t *pair_json(const struct neph_peer_pair *pair)
{
    const struct neph_pair *found = &pair->found;
    return json_pack("{s:s, s:s, s:f, s:[f,f], s:f, s:f, s:s}", "first", pair->first, "second",
                     pair->second, "mean_difference", found->mean_difference, "interval",
                     found->mean_low, found->mean_high, "rms_difference", found->rms_difference,
                     "noise_floor", found->noise_floor, "verdict",
                     neph_pair_verdict_name(found->verdict));
}

json_t *neph_attribution_json(const struct neph_attribution *attribution)
{
    if (!attribution)
        return json_null();
    json_t *pairs = json_array();
    for (int i = 0; i < attribution->pair_count; i++)
        neph_json_add(&pairs, pair_json(&attribution->pairs[i]));
    return json_pack("{s:s, s:I, s:f, s:f, s:f, s:o, s:s?, s:s}", "mask", attribution->mask,
                     "pixel_count", (json_int_t)attribution->pixel_count, "family_alpha",
                     NEPH_ATTRIBUTION_FAMILY_ALPHA, "mean_meant", NEPH_PAIR_MEAN_MEANT, "rms_meant",
                     NEPH_PAIR_RMS_MEANT, "pairs", pairs, "odd_one_out", attribution->odd_one_out,
                     "sentence", attribution->sentence);
}
