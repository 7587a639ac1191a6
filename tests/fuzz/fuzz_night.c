/* SPDX-License-Identifier: MIT
 *
 * The input of a nightly run from its steps: the first byte selects the suite, the remaining bytes
 * are the step's output. Numbers are finite, and series have names with parts.
 */
#include "tests/fuzz/fuzz.h"

#include "harness/night/readers.h"

#include <math.h>

/* Frames and scenes that a document names are other files, which are not tested here. */
static bool names_files(const uint8_t *data, size_t size)
{
    return memmem(data, size, "/", 1) != NULL;
}

static void require_number(struct neph_arena *arena, const struct neph_measurement *number)
{
    const struct neph_night_name name = neph_night_split(arena, number->series);
    fuzz_require(isfinite(number->value), "a number");
    fuzz_require(name.suite[0] && name.metric, "a name of parts");
    fuzz_require(number->kind && number->environment && number->frame, "all is said of it");
    fuzz_require(neph_night_metric(name.metric)->unit > 0.0, "a unit");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size < 2 || names_files(data, size))
        return 0;
    char *text = malloc(size);
    memcpy(text, data + 1, size - 1);
    text[size - 1] = '\0';
    json_t *document = neph_night_find_document(text);
    struct neph_arena arena = {NULL};
    struct neph_night_numbers numbers = {.count = 0};
    struct neph_diag diag = {0};
    const enum neph_night_suite suite = (enum neph_night_suite)(data[0] % NEPH_NIGHT_SUITES);
    const enum neph_status status = neph_night_read(suite, document, 0.25, "host", &arena, &numbers,
                                                    &diag);
    fuzz_require(status == NEPH_OK || diag.message[0], "a failure says why");
    fuzz_require(status == NEPH_OK || status == NEPH_ERR_ENGINE, "the step is at fault");
    for (int i = 0; !status && i < numbers.count; i++)
        require_number(&arena, &numbers.list[i]);
    neph_arena_finish(&arena);
    json_decref(document);
    free(text);
    return 0;
}
