/* SPDX-License-Identifier: MIT
 *
 * The stress test of a scene (scenes/failing.h), from its file; and the file with the numbers of a
 * point of its sweep.
 */
#include "scenes/load.h"

#include "scenes/words.h"

#include <stdlib.h>
#include <string.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_FAILING_MEASURES == 8, "a new kind");

#define FAILING(member) offsetof(struct neph_failing, member)
#define LIMIT(member) offsetof(struct neph_failing_limit, member)
#define AXIS(member) offsetof(struct neph_failing_axis, member)

enum { TEXT_MAX = 1000, LIMITS_MAX = 16, AXES_MAX = 3, PATHS_MAX = 400, SIDE_MAX_PX = 4096 };
#define VALUE_MAX 1e9 /* the swept keys have their own ranges */

/* --- Limits --- */

static const char *const mask_words[] = {"all",        "sky",      "solid", "medium",
                                         "depth_edge", "non_edge", "thin",  NULL};

static const struct neph_field limit_fields[] = {
    {"measure", NEPH_WORD, LIMIT(measure), .words = neph_failing_measure_words},
    {"over", NEPH_TEXT, LIMIT(over), .words = mask_words, .standard = "`all`"},
    {"limit", NEPH_NUMBER, LIMIT(limit), "", 0, VALUE_MAX, .note = "in the measure's unit"},
    {"reason", NEPH_TEXT, LIMIT(reason), .least = 1, .most = TEXT_MAX},
    {0},
};

static enum neph_status read_limit(struct neph_reader *reader, const yaml_node_t *node,
                                   const struct neph_record *record, void *target)
{
    struct neph_failing_limit *limit = target;
    const enum neph_status status = neph_read_fields(reader, node, record->fields, target);
    if (status)
        return status;
    limit->line = (int)node->start_mark.line + 1;
    if (!limit->over)
        limit->over = mask_words[0];
    return NEPH_OK;
}

static const struct neph_record limit_record = {
    .size = sizeof(struct neph_failing_limit), .fields = limit_fields, .read = read_limit};

/* --- Sweeps --- */

static const struct neph_field axis_fields[] = {
    {"name", NEPH_TEXT, AXIS(name), .note = "of results: pitch_m", .least = 1, .most = 40},
    {"set", NEPH_TEXT, AXIS(paths),
     .note = "paths of numbers of this file, separated by spaces: solids[0].fence.pitch_m",
     .least = 1, .most = PATHS_MAX},
    {"to", NEPH_NUMBERS, AXIS(to), "", -VALUE_MAX, VALUE_MAX, .note = "in place of the numbers",
     .least = 1, .most = NEPH_FAILING_VALUES_MAX, .count_at = AXIS(to_count),
     .standard = "needed, or `by`"},
    {"by", NEPH_NUMBERS, AXIS(by), "", -VALUE_MAX, VALUE_MAX, .note = "added to the numbers",
     .least = 1, .most = NEPH_FAILING_VALUES_MAX, .count_at = AXIS(by_count),
     .standard = "needed, or `to`"},
    {0},
};

/* Copies the first path of `*rest` and advances `*rest` past it; false: there is none. */
static bool next_path(const char **rest, char path[NEPH_FIELD_PATH_MAX])
{
    *rest += strspn(*rest, " ");
    const size_t length = strcspn(*rest, " ");
    const size_t fits = length < NEPH_FIELD_PATH_MAX ? length : NEPH_FIELD_PATH_MAX - 1;
    memcpy(path, *rest, fits);
    path[fits] = '\0';
    *rest += length;
    return length > 0;
}

static bool is_number_node(const yaml_node_t *node)
{
    char *end = NULL;
    if (!node || node->type != YAML_SCALAR_NODE)
        return false;
    strtod(neph_document_text(node), &end);
    return end > neph_document_text(node) && !*end;
}

static enum neph_status check_paths(const struct neph_reader *reader,
                                    const struct neph_failing_axis *axis)
{
    char path[NEPH_FIELD_PATH_MAX], quote[NEPH_QUOTE_SIZE];
    const char *rest = axis->paths;
    while (next_path(&rest, path))
        if (!is_number_node(neph_document_exactly(reader->document, path)))
            return neph_refuse(reader, "set", "the file has no number at '%s'",
                               neph_document_quote(path, quote));
    return NEPH_OK;
}

static enum neph_status read_axis(struct neph_reader *reader, const yaml_node_t *node,
                                  const struct neph_record *record, void *target)
{
    struct neph_failing_axis *axis = target;
    const enum neph_status status = neph_read_fields(reader, node, record->fields, target);
    if (status)
        return status;
    if ((axis->to_count > 0) == (axis->by_count > 0))
        return neph_refuse(reader, "", "give either to or by");
    if (!neph_is_identifier(axis->name))
        return neph_refuse(reader, "name", "a name has only a-z, 0-9 and _");
    return check_paths(reader, axis);
}

static const struct neph_record axis_record = {
    .size = sizeof(struct neph_failing_axis), .fields = axis_fields, .read = read_axis};

/* --- The stress test --- */

static const struct neph_field failing_fields[] = {
    {"fails", NEPH_TEXT, FAILING(fails), .note = "the failure and its cause", .least = 1,
     .most = TEXT_MAX},
    {"known", NEPH_TEXT, FAILING(known), .note = "renderers that are known to fail", .least = 1,
     .most = TEXT_MAX},
    {"symptom", NEPH_TEXT, FAILING(symptom), .note = "the visible symptom", .least = 1,
     .most = TEXT_MAX},
    {"presets", NEPH_TEXT, FAILING(presets),
     .note = "of `realtime`, separated by spaces; `none`: only engines are tested", .least = 1,
     .most = 200, .standard = "all"},
    {"width_px", NEPH_WHOLE, FAILING(width_px), "", 16, SIDE_MAX_PX, .standard = "96"},
    {"height_px", NEPH_WHOLE, FAILING(height_px), "", 9, SIDE_MAX_PX, .standard = "54"},
    {"frames", NEPH_WHOLE, FAILING(frame_count), "", 4, 4096, .note = "that are measured",
     .standard = "32"},
    {"steps", NEPH_WHOLE, FAILING(steps), "", 1, 1024, .note = "of every ray", .standard = "8"},
    {"event_frame", NEPH_WHOLE, FAILING(event_frame), "", 1, 4095,
     .note = "the first frame after the event from which lags are measured", .standard = "none"},
    {"truth", NEPH_WORD, FAILING(truth),
     .note = "the march of the same frame with the same steps, 16 rays a pixel; or engine `exact` "
             "through centres of pixels",
     .words = neph_failing_truth_words, .standard = "`march`"},
    {"quick", NEPH_FLAG, FAILING(quick), .note = "one of the quick tier", .standard = "`false`"},
    {"engines", NEPH_FLAG, FAILING(engines),
     .note = "also tests engines without history, with engine `exact` as reference",
     .standard = "`false`"},
    {"measures", NEPH_LIST, FAILING(limits), .least = 1, .most = LIMITS_MAX,
     .count_at = FAILING(limit_count), .record = &limit_record},
    {"sweep", NEPH_LIST, FAILING(axes), .note = "the product of its axes, beside the file as it is",
     .most = AXES_MAX, .count_at = FAILING(axis_count), .record = &axis_record, .standard = "none"},
    {0},
};

static bool needs_event(enum neph_failing_measure measure)
{
    return measure == NEPH_FAILING_LAG || measure == NEPH_FAILING_NEVER_SEEN;
}

static enum neph_status read_failing(struct neph_reader *reader, const yaml_node_t *node,
                                     const struct neph_record *record, void *target)
{
    struct neph_failing *failing = target;
    enum neph_status status = neph_read_fields(reader, node, record->fields, target);
    for (int i = 0; i < failing->limit_count && !status; i++)
        if (needs_event(failing->limits[i].measure) && failing->event_frame == 0)
            status = neph_refuse(reader, neph_at("measures[%d].measure", i).text,
                                 "%s is measured from an event_frame on",
                                 neph_failing_measure_name(failing->limits[i].measure));
    if (!status && failing->event_frame >= failing->frame_count)
        status = neph_refuse(reader, "event_frame", "%d is not one of the %d frames",
                             failing->event_frame, failing->frame_count);
    if (!failing->presets)
        failing->presets = "";
    return status;
}

const struct neph_record neph_failing_record = {
    .size = sizeof(struct neph_failing), .fields = failing_fields, .read = read_failing};

/* --- A point of the sweep --- */

static enum neph_status put_value(struct neph_document *document, const char *path,
                                  const struct neph_failing_axis *axis, int index,
                                  struct neph_diag *diag)
{
    yaml_node_t *node = neph_document_exactly(document, path);
    if (!is_number_node(node)) /* the file has changed since it was read */
        return neph_fail(diag, NEPH_ERR_INPUT, "the file has no number at '%s'", path);
    const double number = axis->to_count > 0
                              ? axis->to[index]
                              : strtod(neph_document_text(node), NULL) + axis->by[index];
    return neph_document_put_number(node, number, diag);
}

enum neph_status neph_failing_put_point(struct neph_document *document,
                                        const struct neph_failing *failing, int point,
                                        struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < failing->axis_count && point > 0; i++) {
        const char *rest = failing->axes[i].paths;
        char path[NEPH_FIELD_PATH_MAX];
        while (!status && next_path(&rest, path))
            status = put_value(document, path, &failing->axes[i],
                               neph_failing_value_index(failing, point, i), diag);
    }
    return status;
}
