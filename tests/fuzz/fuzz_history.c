/* SPDX-License-Identifier: MIT
 *
 * The reader of documents of nightly runs and of acceptances (the first byte selects), into rows of
 * a database in memory: a document is skipped, or its rows agree with it, and the document written
 * from these rows is read as the same.
 */
#include "tests/fuzz/fuzz.h"

#include "harness/run/history.h"
#include "harness/run/index.h"

static struct {
    char folder[192]; /* of a store without other files */
    struct neph_database *index;
} kept;

static void have_store(void)
{
    struct neph_diag diag = {0};
    char path[256];
    if (kept.index)
        return;
    const struct fuzz_file file = fuzz_file_make("none", NULL, 0);
    snprintf(kept.folder, sizeof(kept.folder), "%s", file.folder);
    fuzz_file_remove(&file);
    snprintf(path, sizeof(path), "%s/frames", kept.folder);
    fuzz_require(neph_dir_create(path, &diag) == NEPH_OK, diag.message);
    fuzz_require(neph_index_open(kept.folder, false, &kept.index, &diag) == NEPH_OK, diag.message);
    fuzz_require(neph_database_do(kept.index, &diag, "PRAGMA synchronous = OFF", "") == NEPH_OK,
                 diag.message);
    snprintf(path, sizeof(path), "%s/history", kept.folder);
    fuzz_require(neph_dir_create(path, &diag) == NEPH_OK, diag.message);
}

static void forget_rows(void)
{
    static const char *const tables[] = {
        "measurements", "steps", "night_frames", "night_scenes", "nights", "acceptances", "series"};
    for (size_t i = 0; i < sizeof(tables) / sizeof(tables[0]); i++) {
        char text[64];
        snprintf(text, sizeof(text), "DELETE FROM %s", tables[i]);
        fuzz_require(neph_database_do(kept.index, NULL, text, "") == NEPH_OK,
                     "rows can be removed");
    }
}

static void write_document(const char *name, const void *data, size_t size)
{
    char path[256];
    snprintf(path, sizeof(path), "%s/history/%s", kept.folder, name);
    FILE *out = fopen(path, "wb");
    fuzz_require(out && fwrite(data, 1, size, out) == size && fclose(out) == 0,
                 "a document can be written");
}

static void remove_document(const char *name)
{
    char path[256];
    snprintf(path, sizeof(path), "%s/history/%s", kept.folder, name);
    unlink(path);
}

/* The document from the rows, again through a file. */
static void require_same_again(const char *name)
{
    json_t *rows = NULL, *again = NULL;
    if (neph_history_document(kept.index, 1, &rows, NULL)) /* not finished: no document */
        return;
    char *text = json_dumps(rows, 0);
    fuzz_require(text, "rows can be written");
    write_document(name, text, strlen(text));
    forget_rows();
    fuzz_require(neph_history_refresh(kept.index, kept.folder, NULL) == NEPH_OK, "read again");
    fuzz_require(neph_history_document(kept.index, 1, &again, NULL) == NEPH_OK,
                 "what we write we read");
    fuzz_require(json_equal(rows, again), "the same rows");
    json_decref(rows);
    json_decref(again);
    free(text);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct neph_diag diag = {0};
    json_t *list = NULL;
    if (size < 1)
        return 0;
    have_store();
    const bool is_night = data[0] % 2 == 0;
    const char *name = is_night ? "night-000001.json" : "accept-000001.json";
    write_document(name, data + 1, size - 1);
    const enum neph_status status = neph_history_refresh(kept.index, kept.folder, &diag);
    fuzz_require(status != NEPH_ERR_INTERNAL || diag.message[0], "a failure says why");
    fuzz_require(status == NEPH_OK, "a document is taken or left out");
    if (is_night)
        require_same_again(name);
    else
        fuzz_require(neph_history_acceptances(kept.index, &list, &diag) == NEPH_OK, diag.message);
    json_decref(list);
    forget_rows();
    remove_document(name);
    return 0;
}
