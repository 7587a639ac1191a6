/* SPDX-License-Identifier: MIT
 *
 * The reader of plans of sweeps: every refusal has a position in the file, and a plan that is read
 * has series of existing engines.
 */
#include "tests/fuzz/fuzz.h"

#include "harness/sweep/plan.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const struct fuzz_file file = fuzz_file_make("fuzz.yaml", data, size);
    struct neph_sweep_plan plan = {.series = NULL};
    struct neph_diag diag = {0};
    const enum neph_status status = neph_sweep_plan_load(file.path, &plan, &diag);
    fuzz_require_outcome(status, &diag, status ? NULL : plan.series);
    fuzz_require(status == NEPH_OK || status == NEPH_ERR_INPUT, "the file is at fault");
    fuzz_require(status == NEPH_OK || (diag.line >= 1 && diag.column >= 1), "a position is named");
    for (int i = 0; !status && i < plan.series_count; i++)
        fuzz_require(plan.series[i].engine != NULL, "a series has an engine");
    if (!status)
        neph_sweep_plan_finish(&plan);
    fuzz_file_remove(&file);
    return 0;
}
