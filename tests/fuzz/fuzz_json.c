/* SPDX-License-Identifier: MIT
 *
 * Readers of other JSON files that users may edit; the first byte selects: lists of expectations of
 * the stress tests, stored times of a sweep, results of `neph scaling`.
 */
#include "tests/fuzz/fuzz.h"

#include "harness/run/times.h"
#include "harness/stress/expectations.h"
#include "harness/sweep/scaling.h"

static enum neph_status read_expectations(const char *path, struct neph_diag *diag)
{
    static const struct neph_stress_place place = {"fence", "", "seed", "error", "all"};
    json_t *list = NULL;
    const char *reason = NULL;
    const enum neph_status status = neph_stress_expectations_load(path, &list, diag);
    fuzz_require_outcome(status, diag, list);
    if (list)
        neph_stress_expected_at(list, &place, &reason);
    json_decref(list);
    return status;
}

static enum neph_status read_times(const char *path, struct neph_diag *diag)
{
    struct neph_times times = {NULL};
    const enum neph_status status = neph_times_open(path, &times, diag);
    neph_times_close(&times);
    return status;
}

static enum neph_status read_scaling(const char *path, struct neph_diag *diag)
{
    json_t *document = NULL;
    const enum neph_status status = neph_scaling_load(path, &document, diag);
    fuzz_require_outcome(status, diag, document);
    json_decref(document);
    return status;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static enum neph_status (*const readers[])(const char *, struct neph_diag *) = {
        read_expectations, read_times, read_scaling};
    if (size < 1)
        return 0;
    const struct fuzz_file file = fuzz_file_make("fuzz.json", data + 1, size - 1);
    struct neph_diag diag = {0};
    const enum neph_status status = readers[data[0] % 3](file.path, &diag);
    fuzz_require(status == NEPH_OK || status == NEPH_ERR_INPUT, "the file is at fault");
    fuzz_require(status == NEPH_OK || diag.message[0], "a failure says why");
    fuzz_file_remove(&file);
    return 0;
}
