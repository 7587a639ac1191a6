/* SPDX-License-Identifier: MIT */
#include "harness/report/attribution.h"

#include "base/exr.h"
#include "harness/engines/engines.h"
#include "metrics/pair.h"
#include "metrics/significance.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ENGINES_MAX = 16 };

struct entrant {
    const char *name;
    struct neph_image *frames[2]; /* the same twice for a deterministic engine */
};

struct field {
    struct entrant entrants[ENGINES_MAX];
    int count;
    struct neph_mask *mask;
};

static const char *text_of(const json_t *object, const char *key)
{
    return json_string_value(json_object_get(object, key));
}

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

static enum neph_status enrol(const json_t *frame, struct field *field, struct neph_diag *diag)
{
    const char *path = text_of(frame, "exr"), *second = text_of(frame, "exr_second");
    struct entrant *entrant = &field->entrants[field->count];
    const struct neph_engine *engine = neph_engine_find(text_of(frame, "engine"));
    const bool look = engine && engine->look; /* it claims no physics to be right or wrong about */
    if (!path || look || field->count == ENGINES_MAX)
        return NEPH_OK;
    entrant->name = text_of(frame, "engine");
    enum neph_status status = neph_exr_read(path, &entrant->frames[0], diag);
    if (status)
        return status;
    entrant->frames[1] = entrant->frames[0];
    field->count++;
    return second ? neph_exr_read(second, &entrant->frames[1], diag) : NEPH_OK;
}

/* Where a medium is: sky and solids in clear air would water the numbers down. */
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

static json_t *pair_json(const struct entrant *x, const struct entrant *y,
                         const struct neph_pair *pair)
{
    return json_pack("{s:s, s:s, s:f, s:[f,f], s:f, s:f, s:s}", "first", x->name, "second", y->name,
                     "mean_difference", pair->mean_difference, "interval", pair->mean_low,
                     pair->mean_high, "rms_difference", pair->rms_difference, "noise_floor",
                     pair->noise_floor, "verdict", neph_pair_verdict_name(pair->verdict));
}

static enum neph_status compare_all(const struct field *field, int *verdicts, json_t *pairs,
                                    struct neph_diag *diag)
{
    const int n = field->count;
    const double critical_z = neph_normal_critical(
        neph_sidak_alpha(NEPH_ATTRIBUTION_FAMILY_ALPHA, n * (n - 1) / 2));
    for (int i = 0; i < n; i++)
        for (int j = i + 1; j < n; j++) {
            const struct entrant *x = &field->entrants[i], *y = &field->entrants[j];
            const struct neph_image *const frames[4] = {x->frames[0], x->frames[1], y->frames[0],
                                                        y->frames[1]};
            struct neph_pair pair = {.verdict = NEPH_PAIR_CANNOT_TELL};
            const enum neph_status status = neph_pair_compare(frames, field->mask, critical_z,
                                                              &pair, diag);
            if (status)
                return status;
            verdicts[i * n + j] = verdicts[j * n + i] = (int)pair.verdict;
            if (json_array_append_new(pairs, pair_json(x, y, &pair)) != 0)
                return neph_fail_memory(diag);
        }
    return NEPH_OK;
}

/* How many of the others `who` has that verdict with. */
static int count_verdicts(const int *verdicts, int count, int who, enum neph_pair_verdict verdict)
{
    int found = 0;
    for (int j = 0; j < count; j++)
        found += j != who && verdicts[who * count + j] == (int)verdict;
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
    /* The odd one differs from every other, and no two others differ. */
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
                                : "cannot tell: some differ, and noise hides which stands alone");
        return -1;
    }
    snprintf(sentence, 400, "%s is the odd one out: it differs from all others, and they %s",
             names[odd], undecided == 0 ? "agree" : "do not differ beyond noise");
    return odd;
}

static enum neph_status conclude(const struct field *field, json_t **attribution,
                                 struct neph_diag *diag)
{
    int verdicts[ENGINES_MAX * ENGINES_MAX] = {0};
    const char *names[ENGINES_MAX];
    char sentence[400];
    json_t *pairs = json_array();
    enum neph_status status = compare_all(field, verdicts, pairs, diag);
    for (int i = 0; i < field->count; i++)
        names[i] = field->entrants[i].name;
    if (status == NEPH_ERR_UNSUPPORTED) { /* dark, or too few pixels: nothing to attribute */
        json_decref(pairs);
        *attribution = json_null();
        return NEPH_OK;
    }
    if (!status) {
        const int odd = neph_odd_one_out(names, field->count, verdicts, sentence);
        *attribution = json_pack(
            "{s:s, s:I, s:f, s:f, s:f, s:O, s:s?, s:s}", "mask", field->mask->name, "pixel_count",
            (json_int_t)field->mask->pixel_count, "family_alpha", NEPH_ATTRIBUTION_FAMILY_ALPHA,
            "mean_meant", NEPH_PAIR_MEAN_MEANT, "rms_meant", NEPH_PAIR_RMS_MEANT, "pairs", pairs,
            "odd_one_out", odd < 0 ? NULL : names[odd], "sentence", sentence);
        status = *attribution ? NEPH_OK : neph_fail_memory(diag);
    }
    json_decref(pairs);
    return status;
}

enum neph_status neph_attribute(const json_t *frames, json_t **attribution, struct neph_diag *diag)
{
    struct field field = {.count = 0};
    enum neph_status status = NEPH_OK;
    for (size_t i = 0; i < json_array_size(frames) && !status; i++)
        status = enrol(json_array_get(frames, i), &field, diag);
    if (!status && field.count < 3)
        *attribution = json_null();
    else if (!status)
        status = choose_mask(&field, diag);
    if (!status && field.count >= 3)
        status = conclude(&field, attribution, diag);
    finish(&field);
    return status;
}
