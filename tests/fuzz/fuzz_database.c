/* SPDX-License-Identifier: MIT
 *
 * The store's database with arbitrary bytes: it is used or moved away, and afterwards there is a
 * database that answers every query.
 */
#include "tests/fuzz/fuzz.h"

#include "harness/run/history.h"
#include "harness/run/index.h"

static void ask(struct neph_database *index, const char *folder)
{
    struct neph_diag diag = {0};
    json_t *list = NULL;
    int64_t nights = 0;
    bool whole = false;
    fuzz_require(neph_database_count(index, &nights, &diag, "SELECT count(*) FROM nights", "") ==
                         NEPH_OK ||
                     diag.message[0],
                 "a failure says why");
    enum neph_status status = neph_history_acceptances(index, &list, &diag);
    fuzz_require((status == NEPH_OK) == (list != NULL), "there is a list after success alone");
    json_decref(list);
    status = neph_index_check(index, folder, &whole, &diag, &diag);
    fuzz_require(status == NEPH_OK || diag.message[0], "a failure says why");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct neph_database *index = NULL;
    struct neph_diag diag = {0};
    char path[256], frames[256], folder[256];
    const struct fuzz_file file = fuzz_file_make("none", NULL, 0);
    snprintf(folder, sizeof(folder), "%s/store", file.folder);
    snprintf(frames, sizeof(frames), "%s/store/frames", file.folder);
    snprintf(path, sizeof(path), "%s/store/index", file.folder);
    fuzz_require(neph_dir_create(frames, &diag) == NEPH_OK, diag.message);
    fuzz_require(neph_dir_create(path, &diag) == NEPH_OK, diag.message);
    snprintf(path, sizeof(path), "%s/store/index/neph.sqlite", file.folder);
    FILE *out = fopen(path, "wb");
    fuzz_require(out && fwrite(data, 1, size, out) == size && fclose(out) == 0,
                 "a database can be written");
    const enum neph_status status = neph_index_open(folder, true, &index, &diag);
    fuzz_require((status == NEPH_OK) == (index != NULL), "there is one after success alone");
    fuzz_require(status == NEPH_OK || diag.message[0], "a failure says why");
    if (index)
        ask(index, folder);
    neph_database_close(index);
    neph_dir_remove(folder, NULL);
    fuzz_file_remove(&file);
    return 0;
}
