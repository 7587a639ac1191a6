/* SPDX-License-Identifier: MIT
 *
 * The reader of records of stored frames (job.json). The input is tested unchanged, where a fuzzer
 * cannot find a signature, and again with a valid signature: then it is complete, and becomes a row
 * that agrees with it.
 */
#include "tests/fuzz/fuzz.h"

#include "base/hash.h"
#include "harness/run/store_entry.h"

static const char key[] = "00000000000000000000000000000000000000000000000000000000deadbeef";

static void try_as_it_is(const char *folder)
{
    char why[NEPH_ENTRY_WHY_BYTES] = "";
    json_t *record = NULL;
    const enum neph_entry_state state = neph_entry_read(folder, key, &record, why);
    fuzz_require((state == NEPH_ENTRY_GOOD) == (record != NULL), "a good one has a record");
    fuzz_require(state == NEPH_ENTRY_GOOD || why[0], "a bad one says why");
    fuzz_require(state != NEPH_ENTRY_ABSENT && state != NEPH_ENTRY_UNREADABLE, "it is there");
    json_decref(record);
}

static void try_signed(const struct fuzz_file *file, const uint8_t *data, size_t size)
{
    char why[NEPH_ENTRY_WHY_BYTES] = "";
    json_t *given = json_loadb((const char *)data, size, JSON_REJECT_DUPLICATES, NULL),
           *record = NULL;
    char frame[256];
    if (!json_is_object(given)) {
        json_decref(given);
        return;
    }
    snprintf(frame, sizeof(frame), "%s/frame.exr", file->folder);
    FILE *out = fopen(frame, "wb");
    fuzz_require(out && fclose(out) == 0, "a frame can be written");
    struct neph_diag diag = {0};
    const enum neph_status status = neph_entry_write_record(file->folder, key, given, &diag);
    fuzz_require(status == NEPH_OK || diag.message[0], "a failure says why");
    if (!status)
        fuzz_require(neph_entry_read(file->folder, key, &record, why) == NEPH_ENTRY_GOOD,
                     "what we sign is whole");
    if (record)
        neph_entry_has_picture(record, "flip_0.png");
    unlink(frame);
    json_decref(given);
    json_decref(record);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const struct fuzz_file file = fuzz_file_make("job.json", data, size);
    try_as_it_is(file.folder);
    try_signed(&file, data, size);
    fuzz_file_remove(&file);
    return 0;
}
