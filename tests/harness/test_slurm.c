/* SPDX-License-Identifier: MIT
 *
 * The commands sent to Slurm, recorded by scripts with the names of its programs: arrays no longer
 * than its limit, marked hosts, a last job that waits for all. With a real Slurm: e2e_slurm.py.
 */
#include "tests/base/scratch.h"

#include "harness/run/slurm.h"

#include <sys/stat.h>

/* Job numbers from 1 on, below a warning; if REFUSE is set, the second job is refused. */
static const char fake[] =
    "#!/bin/sh\n"
    "here=${0%/*}\n"
    "{ printf '%s' \"${0##*/}\"; printf ' <%s>' \"$@\"; echo; } >>\"$here/told\"\n"
    "case ${0##*/} in\n"
    "scontrol) printf 'Configuration\\nMaxArraySize            = 3\\nMaxDBDMsgs = 20000\\n' ;;\n"
    "squeue) printf 'squeue: warning\\nPENDING\\nRUNNING\\n' ;;\n"
    "sbatch)\n"
    "    number=0\n"
    "    while read -r line; do case $line in sbatch*) number=$((number + 1)) ;; esac; done"
    " <\"$here/told\"\n"
    "    [ \"$REFUSE$number\" != 12 ] || { echo 'Invalid feature specification'; exit 1; }\n"
    "    echo \"sbatch: 12 hours are the limit here\"; echo \"$number;cluster\" ;;\n"
    "esac\n";

static int setup(void **state)
{
    static const char *const names[] = {"sbatch", "squeue", "scancel", "scontrol"};
    char path[SCRATCH_PATH_MAX];
    if (scratch_setup(state))
        return -1;
    for (size_t i = 0; i < COUNT(names); i++) {
        scratch_write(scratch_path(state, path, names[i]), fake, sizeof(fake) - 1);
        chmod(path, 0755);
    }
    unsetenv("REFUSE");
    return setenv("PATH", ((struct scratch *)*state)->folder, 1); /* all other programs are the
                                                                     shell's */
}

/* The recorded commands, one a line; for free(). */
static char *told(void **state)
{
    char path[SCRATCH_PATH_MAX], *text = NULL;
    size_t size;
    neph_assert_ok(neph_file_read(scratch_path(state, path, "told"), 1 << 20, &text, &size, NULL),
                   NULL);
    return text;
}

static void assert_recorded(const char *all, const char *words)
{
    if (!strstr(all, words))
        fail_msg("'%s' is not in what was told:\n%s", words, all);
}

struct batch {
    char folder[SCRATCH_PATH_MAX], manifest[SCRATCH_PATH_MAX];
    struct neph_slurm_task tasks[8];
    struct neph_slurm_batch batch;
};

/* Eight tasks, every third of them timed, in a folder with an apostrophe in its name. */
static void make_batch(void **state, struct batch *b)
{
    static const char *const lines[] = {"a", "b", "c", "d", "e", "f", "g", "h"};
    scratch_path(state, b->folder, "it's");
    neph_assert_ok(neph_dir_create(b->folder, NULL), NULL);
    snprintf(b->manifest, sizeof(b->manifest), "%.400s/manifest", b->folder);
    for (int i = 0; i < 8; i++)
        b->tasks[i] = (struct neph_slurm_task){.line = lines[i], .is_timed = i % 3 == 0};
    b->batch = (struct neph_slurm_batch){.name = "neph-1",
                                         .manifest = b->manifest,
                                         .logs = b->folder,
                                         .tasks = b->tasks,
                                         .task_count = 8,
                                         .last = {.line = "neph --report"}};
}

static void test_arrays_are_as_long_as_allowed_and_go_to_marked_hosts(void **state)
{
    struct batch b;
    struct neph_diag diag = {.line = 0};
    make_batch(state, &b);
    const struct neph_slurm_settings settings = {.timing = "quiet",
                                                 .partition = "render",
                                                 .at_once = "2",
                                                 .arguments = " --account=a  --mem=4G"};
    neph_assert_ok(neph_slurm_submit(&settings, &b.batch, &diag), &diag);
    char *text = NULL, *all = told(state);
    size_t size;
    neph_assert_ok(neph_file_read(b.manifest, 1000, &text, &size, NULL), NULL);
    assert_string_equal(text, "b\nc\ne\nf\nh\na\nd\ng\n"); /* by hosts, otherwise in order */
    free(text);
    /* 3 + 2 tasks for any host, 3 timed tasks: no array has both kinds, none is longer than 3. */
    assert_recorded(all, "<--array=0-2%2> <--account=a> <--mem=4G> <--wrap> "
                         "<eval \"exec $(sed -n $((1 + SLURM_ARRAY_TASK_ID))p '");
    assert_recorded(all, "<--array=0-1%2> <--account=a> <--mem=4G> <--wrap> "
                         "<eval \"exec $(sed -n $((4 + SLURM_ARRAY_TASK_ID))p '");
    assert_recorded(all,
                    "<--array=0-2%2> <--constraint=quiet> <--exclusive> <--account=a> <--mem=4G> "
                    "<--wrap> <eval \"exec $(sed -n $((6 + SLURM_ARRAY_TASK_ID))p '");
    assert_recorded(all, "/it'\\''s/manifest')\">");
    assert_recorded(all, "<--partition=render>");
    assert_recorded(all, "<--dependency=afterany:1:2:3> <--account=a> <--mem=4G> <--wrap> "
                         "<exec neph --report>");
    int commands = 0;
    for (const char *at = all; (at = strstr(at, "sbatch <--parsable> <--requeue>")); at++)
        commands++;
    assert_int_equal(commands, 4);
    assert_null(strstr(all, "scancel"));
    free(all);
}

static void test_gpu_jobs_go_to_gpu_hosts(void **state)
{
    struct batch b;
    make_batch(state, &b);
    const struct neph_slurm_settings settings = {.timing = "quiet", .gpu = "h100"};
    b.batch.task_count = 2;
    for (int i = 0; i < 2; i++)
        b.tasks[i].wants_gpu = true;
    b.batch.last.wants_gpu = true;
    neph_assert_ok(neph_slurm_submit(&settings, &b.batch, NULL), NULL);
    char *all = told(state);
    assert_recorded(all, "<--array=0-0> <--constraint=h100> <--wrap>");
    assert_recorded(all, "<--array=0-0> <--constraint=quiet&h100> <--exclusive> <--wrap>");
    assert_recorded(all, "<--dependency=afterany:1:2> <--constraint=h100> <--wrap>");
    free(all);
}

static void test_no_job_for_unnamed_hosts(void **state)
{
    static const struct neph_slurm_settings nothing = {NULL};
    struct batch b;
    struct neph_diag diag = {.line = 0};
    make_batch(state, &b);
    assert_int_equal(neph_slurm_submit(&nothing, &b.batch, &diag), NEPH_ERR_USAGE);
    assert_non_null(strstr(diag.hint, "timing=FEATURE"));
    char *all = told(state); /* earlier jobs are cancelled */
    assert_recorded(all, "scancel <--quiet> <--name> <neph-1>");
    free(all);
    b.batch.task_count = 0;
    b.batch.last.wants_gpu = true;
    assert_int_equal(neph_slurm_submit(&nothing, &b.batch, &diag), NEPH_ERR_USAGE);
    assert_non_null(strstr(diag.hint, "gpu=FEATURE"));
}

static void test_a_refusal_quotes_slurm(void **state)
{
    struct batch b;
    struct neph_diag diag = {.line = 0};
    make_batch(state, &b);
    const struct neph_slurm_settings settings = {.timing = "quiet"};
    setenv("REFUSE", "1", 1);
    assert_int_equal(neph_slurm_submit(&settings, &b.batch, &diag), NEPH_ERR_ENGINE);
    assert_non_null(strstr(diag.message, "Invalid feature specification"));
    char *all = told(state);
    assert_recorded(all, "scancel <--quiet> <--name> <neph-1>");
    free(all);
    b.tasks[3].line = "two\nlines";
    assert_int_equal(neph_slurm_submit(&settings, &b.batch, &diag), NEPH_ERR_USAGE);
    setenv("PATH", "/nonexistent", 1);
    b.tasks[3].line = "d";
    assert_int_equal(neph_slurm_submit(&settings, &b.batch, &diag), NEPH_ERR_UNAVAILABLE);
    assert_string_equal(diag.hint, "apt-get install slurm-client");
}

static void test_states_are_counted_and_warnings_are_not(void **state)
{
    int count = 0;
    char *all = NULL;
    neph_assert_ok(neph_slurm_count("neph-1", ((struct scratch *)*state)->folder, &count, NULL),
                   NULL);
    assert_int_equal(count, 2);
    all = told(state);
    assert_recorded(all, "<--name> <neph-1>");
    free(all);
}

static void test_settings(void **state)
{
    static const char *const words[] = {"timing=quiet", "arguments=--a=b --c", "at_once=4"};
    static const char *const wrong[] = {
        "hosts=a", "timing", "timing=", "at_once=0", "at_once=a", "=a"};
    struct neph_slurm_settings settings = {NULL};
    neph_assert_ok(neph_slurm_read_settings(words, COUNT(words), &settings, NULL), NULL);
    assert_string_equal(settings.timing, "quiet");
    assert_string_equal(settings.arguments, "--a=b --c");
    assert_string_equal(settings.at_once, "4");
    assert_null(settings.gpu);
    for (size_t i = 0; i < COUNT(wrong); i++)
        assert_int_equal(neph_slurm_read_settings(&wrong[i], 1, &settings, NULL), NEPH_ERR_USAGE);
}

static void test_a_line_is_shell_quoted(void **state)
{
    struct neph_arena arena = {NULL};
    const char *const words[] = {"neph", "it's", "", "a b", "$x", NULL};
    assert_string_equal(neph_slurm_line(&arena, words), "'neph' 'it'\\''s' '' 'a b' '$x'");
    neph_arena_finish(&arena);
}

#define fake_test(function) cmocka_unit_test_setup_teardown(function, setup, scratch_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        fake_test(test_arrays_are_as_long_as_allowed_and_go_to_marked_hosts),
        fake_test(test_gpu_jobs_go_to_gpu_hosts),
        fake_test(test_no_job_for_unnamed_hosts),
        fake_test(test_a_refusal_quotes_slurm),
        fake_test(test_states_are_counted_and_warnings_are_not),
        cmocka_unit_test(test_settings),
        cmocka_unit_test(test_a_line_is_shell_quoted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
