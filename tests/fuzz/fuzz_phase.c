/* SPDX-License-Identifier: MIT
 *
 * The reader of tabulated phase functions: a table that is read has the integral 1, angles in
 * order, moments within -1..1 and finite samples.
 */
#include "tests/fuzz/fuzz.h"

#include "scenes/phase_table.h"

#include <math.h>

static void require_table(const struct neph_phase_table *table)
{
    const struct neph_phase_node *nodes = table->nodes;
    for (int i = 0; i < table->count; i++) {
        fuzz_require(isfinite(nodes[i].per_sr) && nodes[i].per_sr >= 0.0, "a value is finite");
        fuzz_require(i == 0 || (nodes[i].versine > nodes[i - 1].versine &&
                                nodes[i].within >= nodes[i - 1].within),
                     "rows are in order");
    }
    fuzz_require(fabs(nodes[table->count - 1].within - 1.0) < 1e-9, "the integral is 1");
    for (int l = 0; l <= NEPH_TABULATED_MOMENTS; l++)
        fuzz_require(fabs(table->moments[l]) < 1.0 + 1e-6, "a moment is within -1..1");
    for (int i = 1; i <= 64; i++) {
        const double versine = neph_phase_table_versine(table, i / 64.0);
        fuzz_require(versine >= 0.0 && versine <= 2.0, "a sample is an angle");
        fuzz_require(isfinite(neph_phase_table_per_sr(table, versine)), "its value is finite");
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const struct fuzz_file file = fuzz_file_make("fuzz.csv", data, size);
    struct neph_arena arena = {NULL};
    const struct neph_phase_table *table = NULL;
    struct neph_diag diag = {0};
    const enum neph_status status = neph_phase_table_read(file.path, &arena, &table, &diag);
    fuzz_require_outcome(status, &diag, table);
    fuzz_require(status == NEPH_OK || status == NEPH_ERR_INPUT, "the file is at fault");
    fuzz_require(status == NEPH_OK || strstr(diag.message, file.path), "the file is named");
    if (table)
        require_table(table);
    neph_arena_finish(&arena);
    fuzz_file_remove(&file);
    return 0;
}
