/* SPDX-License-Identifier: MIT
 *
 * The reader of checkpoints. The input is tested unchanged, and again as the body of a file with a
 * valid first line, as a fuzzer cannot find a hash.
 */
#include "tests/fuzz/fuzz.h"

#include "base/checkpoint.h"
#include "base/hash.h"

enum { NUMBERS = 3, LINE_BYTES = 160 };

static void try(const uint8_t *data, size_t size)
{
    const struct fuzz_file file = fuzz_file_make("fuzz.checkpoint", data, size);
    double values[NUMBERS];
    struct neph_diag diag = {0};
    const enum neph_status status = neph_checkpoint_read(file.path, "fuzz", values, NUMBERS, &diag);
    fuzz_require_outcome(status, &diag, status ? NULL : values);
    fuzz_file_remove(&file);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    try(data, size);
    if (size < 2)
        return 0;
    /* The first two bytes are the sizes that the line declares. */
    char hash[NEPH_HASH_HEX_SIZE];
    fuzz_require(neph_hash(data + 2, size - 2, hash, NULL) == NEPH_OK, "a hash");
    uint8_t *whole = malloc(LINE_BYTES + size);
    char line[LINE_BYTES + 1];
    snprintf(line, sizeof(line), "neph-checkpoint 1 %d %d %s", data[0], data[1], hash);
    const size_t length = strlen(line);
    memset(whole, ' ', LINE_BYTES);
    memcpy(whole, line, length);
    whole[LINE_BYTES - 1] = '\n';
    memcpy(whole + LINE_BYTES, data + 2, size - 2);
    try(whole, LINE_BYTES + size - 2);
    free(whole);
    return 0;
}
