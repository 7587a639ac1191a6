/* SPDX-License-Identifier: MIT
 *
 * `neph validate --suite iprt`: radiance of a water cloud against the results of radiation codes.
 */
#include "harness/experiments/validate.h"

#include "base/files.h"
#include "harness/physics/iprt.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define VIEW(member) offsetof(struct neph_iprt_view, member)

static const struct neph_field fields[] = {
    {{.key = "is_below"}, VIEW(is_below)},
    {{.key = "sun_deg"}, VIEW(sun_deg)},
    {{.key = "view_deg"}, VIEW(view_deg)},
    {{.key = "azimuth_deg"}, VIEW(azimuth_deg)},
    {{.key = "from_sun_deg"}, VIEW(from_sun_deg)},
    {{.key = "theirs"}, VIEW(theirs)},
    {{.key = "theirs_standard_deviation"}, VIEW(theirs_error)},
    {{.key = "doubling"}, VIEW(doubling)},
    {{.key = "oracle"}, VIEW(oracle)},
    {{.key = "oracle_standard_error"}, VIEW(oracle_error)},
};
enum { FIELDS = sizeof(fields) / sizeof(fields[0]) };

static void fill_views(const struct neph_iprt *suite, struct neph_table *table)
{
    neph_table_column(table, (struct neph_column){.key = "file"});
    neph_table_fields(table, fields, FIELDS);
    neph_table_column(table, (struct neph_column){.key = "agrees"});
    for (int v = 0; v < suite->view_count; v++) {
        neph_table_word(table, suite->views[v].file);
        neph_table_field_cells(table, fields, FIELDS, &suite->views[v]);
        neph_table_flag(table, suite->views[v].agrees);
    }
}

/* Directions of one file, on one side, near the sun or far from it. */
struct group {
    const char *file;
    bool is_below, is_near;
};

/* Deviations from theirs, in parts of it. */
struct line {
    double count, failed, doubling, doubling_worst, oracle, oracle_error, oracle_worst;
};
#define LINE(member) offsetof(struct line, member)

static const struct neph_field line_fields[] = {
    {{NULL, "directions", "%.0f", .width = 10}, LINE(count)},
    {{NULL, "doubling", "%+.2f %%", 100.0, .width = 9}, LINE(doubling)},
    {{NULL, "at most", "%.2f %%", 100.0, .width = 8}, LINE(doubling_worst)},
    {{NULL, "oracle", "%+.2f %%", 100.0, .width = 9}, LINE(oracle)},
    {{NULL, "+-", "%.2f %%", 100.0, .width = 8}, LINE(oracle_error)},
    {{NULL, "at most", "%.2f %%", 100.0, .width = 8}, LINE(oracle_worst)},
    {{NULL, "differ", "%.0f", .width = 6}, LINE(failed)},
};
enum { LINE_FIELDS = sizeof(line_fields) / sizeof(line_fields[0]) };

static struct line summarize(const struct neph_iprt *suite, const struct group *group)
{
    struct line line = {.count = 0.0};
    for (int v = 0; v < suite->view_count; v++) {
        const struct neph_iprt_view *view = &suite->views[v];
        if (strcmp(view->file, group->file) != 0 || (view->is_below > 0.0) != group->is_below ||
            (view->from_sun_deg <= NEPH_IPRT_NEAR_DEG) != group->is_near)
            continue;
        const double doubling = view->doubling / view->theirs - 1.0;
        const double oracle = view->oracle / view->theirs - 1.0;
        line.count += 1.0;
        line.failed += !view->agrees;
        line.doubling += doubling;
        line.oracle += oracle;
        line.oracle_error += pow(view->oracle_error / view->theirs, 2.0);
        line.doubling_worst = fmax(line.doubling_worst, fabs(doubling));
        line.oracle_worst = fmax(line.oracle_worst, fabs(oracle));
    }
    line.doubling /= line.count;
    line.oracle /= line.count;
    line.oracle_error = sqrt(line.oracle_error) / line.count;
    return line;
}

static void print(const struct neph_iprt *suite, FILE *out)
{
    struct neph_table table = {.columns = NULL};
    fprintf(out,
            "IPRT: radiance of a water cloud, ours over theirs. Mean and largest deviation; "
            "the oracle with %d paths a direction.\n\n",
            suite->paths);
    if (suite->missing[0]) {
        fprintf(out, "%s\n", suite->missing);
        return;
    }
    neph_table_column(&table, (struct neph_column){.title = "file", .width = -28});
    neph_table_column(&table, (struct neph_column){.title = "light", .width = -11});
    neph_table_column(&table, (struct neph_column){.title = "from the sun", .width = -14});
    neph_table_fields(&table, line_fields, LINE_FIELDS);
    for (int f = 0; f < suite->file_count; f++)
        for (int side = 0; side < 4; side++) {
            const struct group group = {suite->files[f], side < 2, side % 2 == 0};
            const struct line line = summarize(suite, &group);
            if (line.count == 0.0)
                continue;
            neph_table_word(&table, group.file);
            neph_table_word(&table, group.is_below ? "transmitted" : "reflected");
            neph_table_word(&table, group.is_near ? "within 5 deg" : "beyond 5 deg");
            neph_table_field_cells(&table, line_fields, LINE_FIELDS, &line);
        }
    neph_table_print_aligned(&table, out);
    neph_table_finish(&table);
    fprintf(out,
            "\nOracle over doubling, mean of all directions: %.4f +- %.4f, by their scatter.\n"
            "Judged are doubling, by 1 %% beyond 5 degrees from the sun and 2 %% within, and this "
            "mean.\nTheirs may have polarisation, ours have not.\n",
            suite->oracle_over_doubling, suite->oracle_error);
}

static enum neph_status judge(const struct neph_iprt *suite, struct neph_diag *reason)
{
    if (suite->view_count > 0 && suite->failed == 0 && suite->oracle_agrees)
        return NEPH_OK;
    if (suite->view_count > 0 && suite->failed == 0)
        return neph_fail(reason, NEPH_ERR_GATE, "the oracle is %.4f +- %.4f of the doubling",
                         suite->oracle_over_doubling, suite->oracle_error);
    if (suite->failed > 0)
        return neph_fail(
            reason, NEPH_ERR_GATE,
            "%d of %d radiances by doubling differ by more than 1 %% beyond 5 degrees from the "
            "sun, or 2 %% within",
            suite->failed, suite->view_count);
    neph_fail(reason, NEPH_ERR_GATE, "nothing was compared: there is no verdict");
    neph_hint(reason, "%s=FOLDER with its files", NEPH_IPRT_VARIABLE);
    return NEPH_ERR_GATE;
}

static void publish(const struct neph_iprt *suite, struct neph_publication *publication)
{
    struct neph_table data = {.columns = NULL}, csv = {.columns = NULL};
    if (publication->text)
        print(suite, publication->text);
    fill_views(suite, &data);
    publication->json = json_pack("{s:s, s:f, s:f, s:i, s:i, s:i, s:s, s:o}", "suite", "iprt",
                                  "oracle_over_doubling", suite->oracle_over_doubling,
                                  "oracle_error", suite->oracle_error, "paths", suite->paths,
                                  "compared", suite->view_count, "failed", suite->failed, "missing",
                                  suite->missing, "rows", neph_table_json(&data));
    neph_table_finish(&data);
    if (publication->csv) {
        fill_views(suite, &csv);
        neph_publication_csv(publication, "\n", &csv);
    }
    publication->verdict = judge(suite, &publication->reason);
}

static enum neph_status run(void *request_, const struct neph_experiment_run *run,
                            struct neph_publication *publication, struct neph_diag *diag)
{
    const struct neph_validate_request *request = request_;
    const struct neph_iprt_params params = {.folder = getenv(NEPH_IPRT_VARIABLE),
                                            .paths = request->samples > 0 ? request->samples : 0,
                                            .quiet = run->quiet};
    struct neph_iprt suite = {.views = NULL};
    enum neph_status status = neph_dir_create(run->output, diag);
    if (!status)
        status = neph_iprt_run(&params, &suite, diag);
    if (!status)
        publish(&suite, publication);
    neph_iprt_finish(&suite);
    return status;
}

const struct neph_experiment neph_experiment_iprt = {
    .document = "iprt.json", .csv = "iprt.csv", .run = run};
