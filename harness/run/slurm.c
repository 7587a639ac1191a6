/* SPDX-License-Identifier: MIT
 *
 * Slurm commands: sbatch, squeue, scancel, scontrol.
 */
#include "harness/run/slurm.h"

#include "base/child.h"
#include "base/files.h"
#include "base/interrupt.h"
#include "base/path.h"
#include "base/written.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char install_line[] = "apt-get install slurm-client";
static const double patience_s = 120.0;
static const size_t answer_limit_bytes = 16 << 20;
enum { WORDS_MAX = 64, VARIABLES_MAX = 1024, ARRAY_SIZE_OF_SLURM = 1001 };

/* ---- settings -------------------------------------------------------------------------------- */

static const struct {
    const char *name;
    size_t at;
} keys[] = {
    {"timing", offsetof(struct neph_slurm_settings, timing)},
    {"gpu", offsetof(struct neph_slurm_settings, gpu)},
    {"partition", offsetof(struct neph_slurm_settings, partition)},
    {"at_once", offsetof(struct neph_slurm_settings, at_once)},
    {"arguments", offsetof(struct neph_slurm_settings, arguments)},
};

static enum neph_status read_setting(const char *word, struct neph_slurm_settings *settings,
                                     struct neph_diag *diag)
{
    const size_t length = strcspn(word, "=");
    for (size_t i = 0; i < sizeof(keys) / sizeof(keys[0]); i++) {
        if (strlen(keys[i].name) != length || strncmp(word, keys[i].name, length) != 0)
            continue;
        if (strlen(word) < length + 2)
            return neph_fail(diag, NEPH_ERR_USAGE, "--slurm %s: no value; write %s=VALUE", word,
                             keys[i].name);
        *(const char **)((char *)settings + keys[i].at) = word + length + 1;
        return NEPH_OK;
    }
    return neph_fail(diag, NEPH_ERR_USAGE, "--slurm %s: no such key: " NEPH_SLURM_KEYS, word);
}

enum neph_status neph_slurm_read_settings(const char *const *words, int count,
                                          struct neph_slurm_settings *settings,
                                          struct neph_diag *diag)
{
    struct neph_slurm_settings read = {NULL};
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < count && !status; i++)
        status = read_setting(words[i], &read, diag);
    if (!status && read.at_once && atoi(read.at_once) < 1)
        status = neph_fail(diag, NEPH_ERR_USAGE, "--slurm at_once=%s: a number from 1 on",
                           read.at_once);
    if (!status)
        *settings = read;
    return status;
}

/* ---- running Slurm's commands ---------------------------------------------------------------- */

/* Runs a command of Slurm; `*answer` is its output, for free(). The child gets the user's whole
 * environment: it says how the cluster is reached, and jobs inherit it. */
static enum neph_status run_slurm_command(const char *logs, const char *const *words, char **answer,
                                          struct neph_diag *diag)
{
    static const char *const nothing[] = {NULL};
    const char *variables[VARIABLES_MAX];
    const struct neph_path log = neph_path_in(logs, "slurm-answer.log");
    size_t size;
    enum neph_status status = NEPH_OK;
    if (neph_child_inherit(variables, VARIABLES_MAX, nothing) < 0)
        status = neph_fail(diag, NEPH_ERR_USAGE, "the environment has more than %d variables",
                           VARIABLES_MAX - 1);
    if (!status) {
        const struct neph_child_params child = {.argv = words,
                                                .log_path = log.text,
                                                .home = getenv("HOME"),
                                                .environment = variables,
                                                .time_limit_s = patience_s};
        struct neph_child_result result;
        status = neph_child_run(&child, &result, diag);
    }
    if (status == NEPH_ERR_UNAVAILABLE)
        neph_hint(diag, "%s", install_line);
    if (!status)
        status = neph_file_read(log.text, answer_limit_bytes, answer, &size, diag);
    return status;
}

/* The largest number of tasks in an array. Slurm limits the largest index, not the number of tasks.
 */
static enum neph_status read_array_limit(const char *logs, int *limit, struct neph_diag *diag)
{
    static const char name[] = "MaxArraySize";
    const char *const words[] = {"scontrol", "show", "config", NULL};
    char *answer = NULL;
    const enum neph_status status = run_slurm_command(logs, words, &answer, diag);
    const char *found = answer ? strstr(answer, name) : NULL;
    *limit = ARRAY_SIZE_OF_SLURM;
    if (found)
        sscanf(found + strlen(name), " = %d", limit);
    free(answer);
    if (status || *limit >= 1)
        return status;
    return neph_fail(diag, NEPH_ERR_ENGINE, "this Slurm has no arrays of jobs (MaxArraySize %d)",
                     *limit);
}

/* Finds "123" or "123;cluster", the last such line below warnings. */
static bool find_id(const char *answer, long *id)
{
    bool found = false;
    for (const char *line = answer; line; line = strchr(line, '\n')) {
        line += *line == '\n';
        char *end;
        const long number = isdigit((unsigned char)*line) ? strtol(line, &end, 10) : 0;
        if (number > 0 && (*end == '\0' || *end == '\n' || *end == ';')) {
            *id = number;
            found = true;
        }
    }
    return found;
}

/* ---- shell quoting --------------------------------------------------------------------------- */

static const char *quote(struct neph_arena *arena, const char *word)
{
    const char *quoted = "'";
    for (size_t length; *word; word += length + (word[length] == '\'')) {
        length = strcspn(word, "'");
        quoted = neph_arena_format(arena, "%s%.*s%s", quoted, (int)length, word,
                                   word[length] ? "'\\''" : "");
    }
    return neph_arena_format(arena, "%s'", quoted);
}

const char *neph_slurm_line(struct neph_arena *arena, const char *const *words)
{
    const char *line = "";
    for (int i = 0; words[i]; i++)
        line = neph_arena_format(arena, "%s%s%s", line, i ? " " : "", quote(arena, words[i]));
    return line;
}

/* ---- submitting ------------------------------------------------------------------------------ */

struct submission {
    const struct neph_slurm_settings *settings;
    const struct neph_slurm_batch *batch;
    const struct neph_slurm_task *tasks; /* sorted by hosts */
    struct neph_arena arena;
    const char *manifest; /* path, quoted for a shell */
    const char *dependency;
    int array_limit;
};

static void append_word(const char **words, int *count, const char *word)
{
    if (*count < WORDS_MAX) /* keep the terminating NULL */
        words[(*count)++] = word;
}

/* Adds the constraint on the hosts of a task. */
static enum neph_status add_hosts(struct submission *submission, const struct neph_slurm_task *task,
                                  const char **words, int *count, struct neph_diag *diag)
{
    const struct neph_slurm_settings *settings = submission->settings;
    const char *timing = task->is_timed ? settings->timing : "",
               *gpu = task->wants_gpu ? settings->gpu : "";
    if (!timing || !gpu) {
        neph_fail(diag, NEPH_ERR_USAGE, "no host feature is given for hosts that %s",
                  timing ? "have a GPU" : "measure times");
        neph_hint(diag, "--slurm %s=FEATURE, as in `sinfo -o '%%n %%f'`",
                  timing ? "gpu" : "timing");
        return NEPH_ERR_USAGE;
    }
    if (timing[0] || gpu[0])
        append_word(words, count,
                    neph_arena_format(&submission->arena, "--constraint=%s%s%s", timing,
                                      timing[0] && gpu[0] ? "&" : "", gpu));
    if (task->is_timed)
        append_word(words, count, "--exclusive");
    return NEPH_OK;
}

static enum neph_status add_arguments(struct submission *submission, const char **words, int *count,
                                      struct neph_diag *diag)
{
    const char *arguments = submission->settings->arguments;
    for (const char *at = arguments ? arguments : ""; *(at += strspn(at, " "));
         at += strcspn(at, " "))
        append_word(words, count,
                    neph_arena_format(&submission->arena, "%.*s", (int)strcspn(at, " "), at));
    return *count < WORDS_MAX - 2
               ? NEPH_OK
               : neph_fail(diag, NEPH_ERR_USAGE, "--slurm arguments: more than %d words",
                           WORDS_MAX / 2);
}

/* Runs sbatch once; `own` are the arguments of this job. */
static enum neph_status submit(struct submission *submission, const struct neph_slurm_task *task,
                               const char *const *own, const char *log_name, const char *script,
                               long *id, struct neph_diag *diag)
{
    struct neph_arena *arena = &submission->arena;
    const struct neph_slurm_batch *batch = submission->batch;
    const char *words[WORDS_MAX + 1] = {"sbatch", "--parsable", "--requeue", "--open-mode=append"};
    int count = 4;
    append_word(words, &count, neph_arena_format(arena, "--job-name=%s", batch->name));
    append_word(words, &count,
                neph_arena_format(arena, "--output=%s/slurm-%s.log", batch->logs, log_name));
    if (submission->settings->partition)
        append_word(words, &count,
                    neph_arena_format(arena, "--partition=%s", submission->settings->partition));
    for (; *own; own++)
        append_word(words, &count, *own);
    enum neph_status status = add_hosts(submission, task, words, &count, diag);
    if (!status)
        status = add_arguments(submission, words, &count, diag);
    append_word(words, &count, "--wrap");
    append_word(words, &count, script);
    if (!status)
        status = neph_arena_check(arena, diag);
    char *answer = NULL;
    if (!status)
        status = run_slurm_command(batch->logs, words, &answer, diag);
    if (!status && !find_id(answer, id))
        status = neph_fail(diag, NEPH_ERR_ENGINE, "sbatch printed no job number: %.200s", answer);
    free(answer);
    return status;
}

/* Submits lines `first` .. `first` + `count` - 1 of the manifest (the first line is 1) as an array.
 */
static enum neph_status submit_array(struct submission *submission,
                                     const struct neph_slurm_task *task, int first, int count,
                                     struct neph_diag *diag)
{
    struct neph_arena *arena = &submission->arena;
    const char *at_once = submission->settings->at_once;
    const char *const own[] = {neph_arena_format(arena, "--array=0-%d%s%s", count - 1,
                                                 at_once ? "%" : "", at_once ? at_once : ""),
                               NULL};
    long id = 0;
    const enum neph_status status = submit(
        submission, task, own, "%A_%a",
        neph_arena_format(arena, "eval \"exec $(sed -n $((%d + SLURM_ARRAY_TASK_ID))p %s)\"", first,
                          submission->manifest),
        &id, diag);
    if (!status)
        submission->dependency = neph_arena_format(arena, "%s:%ld", submission->dependency, id);
    return status;
}

static bool has_same_constraints(const struct neph_slurm_task *a, const struct neph_slurm_task *b)
{
    return a->is_timed == b->is_timed && a->wants_gpu == b->wants_gpu;
}

/* Submits arrays of tasks with the same constraints, in the order of the manifest. */
static enum neph_status submit_arrays(struct submission *submission, struct neph_diag *diag)
{
    const struct neph_slurm_task *tasks = submission->tasks;
    const int count = submission->batch->task_count;
    enum neph_status status = NEPH_OK;
    for (int first = 0, size; first < count && !status; first += size) {
        for (size = 1; first + size < count && size < submission->array_limit &&
                       has_same_constraints(&tasks[first], &tasks[first + size]);)
            size++;
        status = submit_array(submission, &tasks[first], first + 1, size, diag);
    }
    return status;
}

static enum neph_status submit_last(struct submission *submission, struct neph_diag *diag)
{
    const struct neph_slurm_batch *batch = submission->batch;
    const bool waits = batch->task_count > 0;
    const char *const own[] = {waits ? neph_arena_format(&submission->arena,
                                                         "--dependency=afterany%s",
                                                         submission->dependency)
                                     : NULL,
                               NULL};
    long id;
    return submit(submission, &batch->last, own, "%j",
                  neph_arena_format(&submission->arena, "exec %s", batch->last.line), &id, diag);
}

/* Sorts tasks by their constraints, otherwise in the given order. */
static struct neph_slurm_task *sort_tasks(struct submission *submission)
{
    const struct neph_slurm_batch *batch = submission->batch;
    struct neph_slurm_task *sorted = neph_arena_allocate(
        &submission->arena, (size_t)batch->task_count + 1, sizeof(*sorted));
    int count = 0;
    for (int kind = 0; sorted && kind < 4; kind++)
        for (int i = 0; i < batch->task_count; i++)
            if (batch->tasks[i].is_timed == kind / 2 && batch->tasks[i].wants_gpu == kind % 2)
                sorted[count++] = batch->tasks[i];
    return sorted;
}

static void print_lines(const void *given, FILE *out)
{
    const struct submission *submission = given;
    for (int i = 0; i < submission->batch->task_count; i++)
        fprintf(out, "%s\n", submission->tasks[i].line);
}

static enum neph_status check_lines(const struct neph_slurm_batch *batch, struct neph_diag *diag)
{
    bool is_line = strchr(batch->last.line, '\n') == NULL;
    for (int i = 0; i < batch->task_count; i++)
        is_line = is_line && strchr(batch->tasks[i].line, '\n') == NULL;
    return is_line ? NEPH_OK
                   : neph_fail(diag, NEPH_ERR_USAGE,
                               "a word of the command has a line break, which the manifest of a "
                               "batch does not allow");
}

enum neph_status neph_slurm_submit(const struct neph_slurm_settings *settings,
                                   const struct neph_slurm_batch *batch, struct neph_diag *diag)
{
    struct submission submission = {.settings = settings, .batch = batch, .dependency = ""};
    submission.tasks = sort_tasks(&submission);
    submission.manifest = quote(&submission.arena, batch->manifest);
    enum neph_status status = check_lines(batch, diag);
    if (!status)
        status = submission.tasks
                     ? neph_write_to_file(batch->manifest, print_lines, &submission, diag)
                     : neph_fail_memory(diag);
    if (!status)
        status = read_array_limit(batch->logs, &submission.array_limit, diag);
    if (!status) {
        status = submit_arrays(&submission, diag);
        if (!status)
            status = submit_last(&submission, diag);
        if (status)
            neph_slurm_cancel(batch->name, batch->logs, NULL);
    }
    neph_arena_finish(&submission.arena);
    return status;
}

/* ---- after the submission -------------------------------------------------------------------- */

/* Counts the lines with a state, such as "PENDING", in the output of squeue; other lines are
 * warnings. */
static int count_states(const char *answer)
{
    int count = 0;
    for (const char *at = answer; *at; at += *at == '\n') {
        const size_t length = strcspn(at, "\n"), plain = strspn(at, "ABCDEFGHIJKLMNOPQRSTUVWXYZ_");
        count += length > 0 && plain == length;
        at += length;
    }
    return count;
}

enum neph_status neph_slurm_count(const char *name, const char *logs, int *count,
                                  struct neph_diag *diag)
{
    const char *const words[] = {"squeue", "--noheader", "--array",     "--me",
                                 "--name", name,         "--format=%T", NULL};
    char *answer = NULL;
    const enum neph_status status = run_slurm_command(logs, words, &answer, diag);
    if (!status)
        *count = count_states(answer);
    free(answer);
    return status;
}

enum neph_status neph_slurm_cancel(const char *name, const char *logs, struct neph_diag *diag)
{
    const char *const words[] = {"scancel", "--quiet", "--name", name, NULL};
    char *answer = NULL;
    neph_interrupt_acknowledge();
    const enum neph_status status = run_slurm_command(logs, words, &answer, diag);
    free(answer);
    return status;
}
