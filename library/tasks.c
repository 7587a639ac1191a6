/* SPDX-License-Identifier: MIT */
#include "harness/compare/choice.h"
#include "library/handles.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static enum neph_status add_word(nephm_task *task, struct neph_task_words *words, const char *word,
                                 struct neph_diag *diag)
{
    if (words->count == NEPH_TASK_WORDS_MAX)
        return neph_fail(diag, NEPH_ERR_USAGE, "more than %d words", NEPH_TASK_WORDS_MAX);
    words->list[words->count] = neph_arena_copy_text(&task->arena, word);
    words->count += !task->arena.is_short;
    return neph_arena_check(&task->arena, diag);
}

static enum neph_status add_metric(nephm_task *task, const char *word, struct neph_diag *diag)
{
    struct neph_comparison trial = {.choice_count = 0};
    const enum neph_status status = neph_choose_word(&trial, word, diag);
    return status ? status : add_word(task, &task->metrics, word, diag);
}

static enum neph_status add_metrics(nephm_task *task, const char *value, struct neph_diag *diag)
{
    char *words = strdup(value), *rest = words;
    enum neph_status status = words ? NEPH_OK : neph_fail_memory(diag);
    for (const char *word; !status && (word = strsep(&rest, ",")) != NULL;)
        status = add_metric(task, word, diag);
    free(words);
    return status;
}

static enum neph_status add_setting(nephm_task *task, const char *value, struct neph_diag *diag)
{
    struct neph_comparison trial = {.choice_count = 0};
    if (value[strcspn(value, ".:=")] == '.')
        return neph_fail(diag, NEPH_ERR_USAGE, "setting '%s' is not EXTRACTOR:KEY=VALUE", value);
    const enum neph_status status = neph_choose_setting(&trial, value, diag);
    return status ? status : add_word(task, &task->settings, value, diag);
}

static enum neph_status set_mask(nephm_task *task, const char *value, struct neph_diag *diag)
{
    if (strpbrk(value, "./"))
        return neph_fail(diag, NEPH_ERR_USAGE,
                         "mask '%s' is no name; a mask of your own is a channel mask.NAME of the "
                         "reference",
                         value);
    task->mask = neph_arena_copy_text(&task->arena, value);
    return neph_arena_check(&task->arena, diag);
}

/* How an option reads its value. */
struct task_option {
    const char *name;
    enum neph_status (*read)(nephm_task *task, const char *value, struct neph_diag *diag);
    size_t flag, real; /* without `read`: the place of a bool or of a double in the task; 0: it is
                        * the other one (the task begins with neither) */
    double least, most;
};

#define FLAG(member) .flag = offsetof(nephm_task, member)
#define REAL(member) .real = offsetof(nephm_task, member)
static const struct task_option task_options[] = {
    {"metric", .read = add_metrics},
    {"set", .read = add_setting},
    {"mask", .read = set_mask},
    {"rings", FLAG(rings)},
    {"negative-ok", FLAG(negative_is_fine)},
    {"frozen-ok", FLAG(frozen_is_fine)},
    {"warm-up", REAL(warm_up_frames), .least = 0, .most = 1e6},
    {"fps", REAL(viewing.frame_rate_hz), .least = 0, .most = 1e6},
    {"ppd", REAL(viewing.pixels_per_degree), .least = 0, .most = 1e6},
    {"exposure", REAL(viewing.exposure_ev), .least = -126, .most = 127},
    {"white", REAL(viewing.white_cd_per_m2), .least = 0, .most = 1e6},
};
#undef FLAG
#undef REAL

static enum neph_status set_flag(const struct task_option *option, nephm_task *task,
                                 const char *value, struct neph_diag *diag)
{
    bool *flag = (bool *)((char *)task + option->flag);
    if (strcmp(value, "on") != 0 && strcmp(value, "off") != 0)
        return neph_fail(diag, NEPH_ERR_USAGE, "%s '%s': on and off are allowed", option->name,
                         value);
    *flag = strcmp(value, "on") == 0;
    return NEPH_OK;
}

static enum neph_status set_real(const struct task_option *option, nephm_task *task,
                                 const char *value, struct neph_diag *diag)
{
    double *place = (double *)(void *)((char *)task + option->real);
    const bool is_whole = place == &task->warm_up_frames;
    char *end;
    const double read = strtod(value, &end);
    if (end == value || *end || !(read >= option->least && read <= option->most) ||
        (is_whole && read != floor(read)))
        return neph_fail(diag, NEPH_ERR_USAGE, "%s '%s': %s from %g to %g is allowed", option->name,
                         value, is_whole ? "a whole number" : "a number", option->least,
                         option->most);
    *place = read;
    return NEPH_OK;
}

int nephm_task_set(nephm_task *task, const char *name, const char *value, struct nephm_error *error)
{
    struct neph_diag diag = {.line = 0};
    const struct task_option *option = NULL;
    if (!task || !name || !value)
        return neph_library_tell(neph_fail(&diag, NEPH_ERR_USAGE, "%s is NULL",
                                           !task   ? "the task"
                                           : !name ? "the name of the option"
                                                   : "the value of the option"),
                                 &diag, error);
    for (size_t i = 0; i < sizeof(task_options) / sizeof(task_options[0]); i++)
        if (strcmp(task_options[i].name, name) == 0)
            option = &task_options[i];
    locale_t inside;
    const locale_t before = neph_library_enter(&inside);
    const enum neph_status status = !before        ? neph_fail_memory(&diag)
                                    : !option      ? neph_fail(&diag, NEPH_ERR_USAGE,
                                                               "there is no option '%s'", name)
                                    : option->read ? option->read(task, value, &diag)
                                    : option->flag ? set_flag(option, task, value, &diag)
                                                   : set_real(option, task, value, &diag);
    neph_library_leave(before, inside);
    return neph_library_tell(status, &diag, error);
}

int nephm_task_create(int kind, nephm_task **task, struct nephm_error *error)
{
    struct neph_diag diag = {.line = 0};
    nephm_task *made = NULL;
    enum neph_status status = NEPH_OK;
    if (kind != NEPHM_COMPARE && kind != NEPHM_FLICKER)
        status = neph_fail(&diag, NEPH_ERR_USAGE, "there is no kind of task %d", kind);
    else if (!(made = calloc(1, sizeof(*made))))
        status = neph_fail_memory(&diag);
    if (!status) {
        made->is_flicker = kind == NEPHM_FLICKER;
        made->viewing = (struct neph_viewing){NAN, NAN, NAN, NAN};
        *task = made;
    }
    return neph_library_tell(status, &diag, error);
}

void nephm_task_destroy(nephm_task *task)
{
    if (task)
        neph_arena_finish(&task->arena);
    free(task);
}
