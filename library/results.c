/* SPDX-License-Identifier: MIT */
#include "base/text.h"
#include "harness/compare/choice.h"
#include "library/handles.h"
#include "metrics/extractors/extractors.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* An image of a run, which the comparison knows by its name. */
struct named_image {
    const char *name; /* of a sequence of the comparison */
    const struct neph_image *image;
};

struct nephm_result {
    struct neph_comparison asked;
    struct neph_compared compared;
    struct neph_frame_source source; /* with the result as its context */
    struct named_image *images;
    int image_count;
    char *json;
};

/* ---- a run ----------------------------------------------------------------------------------- */

static const struct neph_image *find_image(const nephm_result *result, const char *name)
{
    for (int i = 0; i < result->image_count; i++)
        if (strcmp(result->images[i].name, name) == 0)
            return result->images[i].image;
    return NULL;
}

static enum neph_status copy_image(const struct neph_image *from, struct neph_image **image,
                                   struct neph_diag *diag)
{
    const size_t bytes = neph_image_pixel_count(from) * sizeof(float);
    struct neph_image *made = NULL;
    enum neph_status status = neph_image_create(from->width_px, from->height_px, &made, diag);
    for (int c = 0; c < from->channel_count && !status; c++) {
        float *samples;
        status = neph_image_add_channel(made, from->channels[c].name, &samples, diag);
        if (!status)
            memcpy(samples, from->channels[c].samples, bytes);
    }
    if (!status)
        status = neph_image_copy_labels(from, made, diag);
    if (status)
        neph_image_destroy(made);
    else
        *image = made;
    return status;
}

/* The frame of a name, as of a file with these channels: struct neph_frame_source. */
static enum neph_status read_frame(const void *context, const char *name,
                                   const struct neph_frame_choice *choice, size_t negative_allowed,
                                   struct neph_image **frame, struct neph_diag *diag)
{
    struct neph_image *image = NULL;
    const enum neph_status status = copy_image(find_image(context, name), &image, diag);
    return status ? status : neph_frame_make(name, image, choice, negative_allowed, frame, diag);
}

/* A sequence of images, which are added to those of the result. */
static enum neph_status add_sequence(nephm_result *result, const char *what,
                                     const nephm_image *const *images, size_t count,
                                     struct neph_sequence *sequence, struct neph_diag *diag)
{
    if (count == 0)
        return NEPH_OK;
    sequence->paths = calloc(count, sizeof(*sequence->paths));
    for (size_t i = 0; i < count && sequence->paths; i++) {
        char name[64];
        if (!images[i])
            return neph_fail(diag, NEPH_ERR_USAGE, "%s image %zu is NULL", what, i);
        neph_text_format(name, sizeof(name), count > 1 ? "%s[%zu]" : "%s", what, i);
        sequence->paths[i] = strdup(name);
        if (!sequence->paths[i])
            return neph_fail_memory(diag);
        sequence->count = (int)i + 1;
        result->images[result->image_count++] = (struct named_image){sequence->paths[i],
                                                                     images[i]->image};
    }
    return sequence->paths ? NEPH_OK : neph_fail_memory(diag);
}

/* Without a reference: the first measured frame is in its place (harness/compare/comparison.h). */
static enum neph_status put_still(const nephm_task *task, nephm_result *result,
                                  struct neph_diag *diag)
{
    struct neph_comparison *asked = &result->asked;
    const int first = (int)task->warm_up_frames < asked->test.count ? (int)task->warm_up_frames : 0;
    asked->without_reference = true;
    asked->reference.paths = calloc(1, sizeof(*asked->reference.paths));
    if (asked->reference.paths)
        asked->reference.paths[0] = strdup(asked->test.paths[first]);
    asked->reference.count = asked->reference.paths && asked->reference.paths[0] ? 1 : 0;
    return asked->reference.count ? NEPH_OK : neph_fail_memory(diag);
}

static enum neph_status choose(const nephm_task *task, struct neph_comparison *asked,
                               struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < task->metrics.count && !status; i++)
        status = neph_choose_word(asked, task->metrics.list[i], diag);
    if (task->metrics.count == 0)
        neph_choose_usual(asked, task->is_flicker);
    for (int i = 0; i < task->settings.count && !status; i++)
        status = neph_choose_setting(asked, task->settings.list[i], diag);
    return status ? status : neph_choice_check_reference(asked, NULL, diag);
}

static enum neph_status prepare(const nephm_task *task, const nephm_image *const *reference,
                                size_t reference_count, const nephm_image *const *test,
                                size_t test_count, nephm_result *result, struct neph_diag *diag)
{
    struct neph_comparison *asked = &result->asked;
    if (!task || !test || (reference_count > 0 && !reference))
        return neph_fail(diag, NEPH_ERR_USAGE, "the %s is NULL", task ? "list of images" : "task");
    if (test_count == 0 || test_count > INT_MAX / 2 || reference_count > test_count ||
        (reference_count == 0 && !task->is_flicker))
        return neph_fail(diag, NEPH_ERR_INPUT,
                         "%zu reference and %zu test images: one reference for all, or as many",
                         reference_count, test_count);
    result->source = (struct neph_frame_source){.context = result, .read = read_frame};
    *asked = (struct neph_comparison){
        .source = &result->source,
        .viewing = neph_viewing_complete(task->viewing),
        .own_frame_rate = isnan(task->viewing.frame_rate_hz),
        .warm_up_frames = (int)task->warm_up_frames,
        .mask = task->mask,
        .detail_masks = task->is_flicker || task->rings ||
                        (task->mask && neph_mask_is_detail(task->mask)),
        .negative_allowed = task->negative_is_fine ? SIZE_MAX : 0,
        .by_position = true,
        .with_histogram = !task->is_flicker,
        .allow_frozen_frames = task->frozen_is_fine || !task->is_flicker,
        .quiet = true,
    };
    result->images = calloc(reference_count + test_count, sizeof(*result->images));
    enum neph_status status = result->images ? NEPH_OK : neph_fail_memory(diag);
    if (!status)
        status = add_sequence(result, "test", test, test_count, &asked->test, diag);
    if (!status)
        status = reference_count > 0 ? add_sequence(result, "reference", reference, reference_count,
                                                    &asked->reference, diag)
                                     : put_still(task, result, diag);
    return status ? status : choose(task, asked, diag);
}

static enum neph_status measure(const nephm_task *task, nephm_result *result,
                                struct neph_diag *diag)
{
    const struct neph_named named = {
        .metrics = task->metrics.list,
        .metric_count = task->metrics.count,
        .settings = task->settings.list,
        .setting_count = task->settings.count,
        .mask = task->mask,
        .is_flicker = task->is_flicker,
    };
    enum neph_status status = neph_comparison_run(&result->asked, false, &result->compared, diag);
    if (!result->compared.asked)
        return status;
    const enum neph_status checked = neph_named_check(&named, &result->compared,
                                                      status ? NULL : diag);
    status = status ? status : checked;
    neph_named_select(&named, &result->compared);
    json_t *json = neph_compared_json(&result->compared);
    result->json = json ? json_dumps(json, JSON_INDENT(2)) : NULL;
    json_decref(json);
    return status || result->json ? status : neph_fail_memory(diag);
}

int nephm_task_run(const nephm_task *task, const nephm_image *const *reference,
                   size_t reference_count, const nephm_image *const *test, size_t test_count,
                   nephm_result **result, struct nephm_error *error)
{
    struct neph_diag diag = {.line = 0};
    nephm_result *made = calloc(1, sizeof(*made));
    locale_t inside;
    const locale_t before = neph_library_enter(&inside);
    enum neph_status status = made && before ? prepare(task, reference, reference_count, test,
                                                       test_count, made, &diag)
                                             : neph_fail_memory(&diag);
    if (!status)
        status = measure(task, made, &diag);
    neph_library_leave(before, inside);
    const bool has_result = made && made->json && (!status || status == NEPH_ERR_GATE);
    if (has_result)
        *result = made;
    else
        nephm_result_destroy(made);
    return neph_library_tell(status, &diag, error);
}

void nephm_result_destroy(nephm_result *result)
{
    if (!result)
        return;
    neph_compared_finish(&result->compared);
    neph_comparison_finish(&result->asked);
    free(result->images);
    free(result->json);
    free(result);
}

/* ---- numbers --------------------------------------------------------------------------------- */

size_t nephm_result_count(const nephm_result *result)
{
    return result ? (size_t)result->compared.numbers.count : 0;
}

int nephm_result_number(const nephm_result *result, size_t index, struct nephm_number *number,
                        struct nephm_error *error)
{
    struct neph_diag diag = {.line = 0};
    const struct neph_extractor *owner = NULL;
    if (index >= nephm_result_count(result))
        return neph_library_tell(neph_fail(&diag, NEPH_ERR_USAGE, "number %zu of %zu", index,
                                           nephm_result_count(result)),
                                 &diag, error);
    const struct neph_measurement *m = &result->compared.numbers.list[index];
    const bool has_interval = m->defined && neph_interval_is_bounded(m->interval);
    neph_metric_find(m->metric->name, &owner);
    *number = (struct nephm_number){
        .extractor = owner->name,
        .metric = m->metric->name,
        .quantity = m->quantity->name,
        .mask = m->mask,
        .unit = m->unit,
        .frame = m->frame,
        .is_defined = m->defined,
        .undefined_because = m->undefined_because,
        .value = m->defined ? m->value : NAN,
        .low = has_interval ? m->low : NAN,
        .high = has_interval ? m->high : NAN,
    };
    return neph_library_tell(NEPH_OK, &diag, error);
}

const char *nephm_result_json(const nephm_result *result)
{
    return result ? result->json : NULL;
}
