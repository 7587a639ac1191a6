/* SPDX-License-Identifier: MIT
 *
 * `neph validate --suite i3rc`: fluxes of clouds against the consensus of radiation codes.
 */
#include "harness/experiments/validate.h"

#include "base/files.h"
#include "harness/physics/i3rc.h"
#include "harness/physics/i3rc_files.h"

#include <stdlib.h>

static enum neph_status write_junit(const struct neph_i3rc *suite, const char *path,
                                    struct neph_diag *diag)
{
    struct neph_junit junit = {.name = "neph validate --suite i3rc"};
    for (int r = 0; r < suite->row_count; r++) {
        const struct neph_i3rc_row *row = &suite->rows[r];
        char group[32];
        snprintf(group, sizeof(group), "case%d_exp%d", row->experiment->case_number,
                 row->experiment->number);
        for (int q = 0; q < NEPH_I3RC_QUANTITIES; q++) {
            const struct neph_i3rc_number *number = &row->numbers[q];
            char message[160];
            snprintf(message, sizeof(message), "%.5f +- %.5f, consensus %.5f", number->ours.mean,
                     number->ours.standard_error, number->consensus);
            if (!number->has_consensus)
                neph_junit_add(&junit, group, neph_i3rc_quantities[q].name, NEPH_JUNIT_SKIPPED,
                               row->missing ? row->missing : "no consensus here");
            else
                neph_junit_add(&junit, group, neph_i3rc_quantities[q].name,
                               number->agrees ? NEPH_JUNIT_PASSED : NEPH_JUNIT_FAILED,
                               number->agrees ? NULL : message);
        }
    }
    const enum neph_status status = neph_junit_write(&junit, path, diag);
    neph_junit_finish(&junit);
    return status;
}

static enum neph_status judge(const struct neph_i3rc *suite, struct neph_diag *reason)
{
    if (suite->compared > 0 && suite->failed == 0)
        return NEPH_OK;
    if (suite->failed > 0)
        return neph_fail(reason, NEPH_ERR_GATE,
                         "%d of %d means differ from the consensus by more than 0.3 %% and three "
                         "standard errors",
                         suite->failed, suite->compared);
    neph_fail(reason, NEPH_ERR_GATE, "nothing was compared with a consensus: there is no verdict");
    neph_hint(reason, "%s=FOLDER with its files", NEPH_I3RC_VARIABLE);
    return NEPH_ERR_GATE;
}

static enum neph_status publish(const struct neph_validate_request *request,
                                const struct neph_i3rc *suite, struct neph_publication *publication,
                                struct neph_diag *diag)
{
    struct neph_table data = {.columns = NULL}, csv = {.columns = NULL};
    const enum neph_status status = request->junit ? write_junit(suite, request->junit, diag)
                                                   : NEPH_OK;
    if (status)
        return status;
    if (publication->text)
        neph_i3rc_print(suite, publication->text);
    neph_i3rc_fill_table(suite, &data);
    publication->json = json_pack("{s:s, s:i, s:i, s:o}", "suite", "i3rc", "compared",
                                  suite->compared, "failed", suite->failed, "rows",
                                  neph_table_json(&data));
    neph_table_finish(&data);
    if (publication->csv) {
        neph_i3rc_fill_table(suite, &csv);
        neph_publication_csv(publication, "\n", &csv);
    }
    publication->verdict = judge(suite, &publication->reason);
    return NEPH_OK;
}

static enum neph_status run(void *request_, const struct neph_experiment_run *run,
                            struct neph_publication *publication, struct neph_diag *diag)
{
    const struct neph_validate_request *request = request_;
    const struct neph_i3rc_params params = {
        .folder = getenv(NEPH_I3RC_VARIABLE),
        .engine = request->engines.count > 0 ? request->engines.words[0] : "oracle",
        .only = request->only.words,
        .only_count = request->only.count,
        .paths = request->samples > 0 ? request->samples : 0,
        .device = run->device,
        .quiet = run->quiet};
    struct neph_i3rc suite = {.rows = NULL};
    enum neph_status status = neph_dir_create(run->output, diag);
    if (!status)
        status = neph_i3rc_run(&params, &suite, diag);
    if (!status)
        status = publish(request, &suite, publication, diag);
    neph_i3rc_finish(&suite);
    return status;
}

const struct neph_experiment neph_experiment_i3rc = {
    .document = "i3rc.json", .csv = "i3rc.csv", .opens_stores = true, .run = run};
