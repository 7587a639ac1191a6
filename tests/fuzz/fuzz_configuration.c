/* SPDX-License-Identifier: MIT
 *
 * The reader of configurations (`neph render --config`): a configuration that is read, written and
 * read again is unchanged.
 */
#include "tests/fuzz/fuzz.h"

#include "harness/run/configuration.h"

static void require_same(const struct neph_configuration *a, const struct neph_configuration *b)
{
    char *before = neph_settings_text(a->engine, &a->settings),
         *after = neph_settings_text(b->engine, &b->settings);
    fuzz_require(a->engine == b->engine, "the same engine");
    fuzz_require(before && after && strcmp(before, after) == 0, "the same settings");
    fuzz_require(a->rescatters == b->rescatters, "the same light");
    fuzz_require(!a->rescatters || a->scattering == b->scattering, "the same orders");
    free(before);
    free(after);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const struct fuzz_file file = fuzz_file_make("fuzz.json", data, size);
    struct neph_configuration read = {.engine = NULL}, again = {.engine = NULL};
    struct neph_diag diag = {0};
    const enum neph_status status = neph_configuration_read(file.path, &read, &diag);
    fuzz_require_outcome(status, &diag, status ? NULL : read.engine);
    fuzz_file_remove(&file);
    if (status)
        return 0;
    json_t *json = neph_configuration_json(&read);
    char *text = json ? json_dumps(json, 0) : NULL;
    fuzz_require(text, "what is read can be written");
    const struct fuzz_file written = fuzz_file_make("fuzz.json", (const uint8_t *)text,
                                                    strlen(text));
    fuzz_require(neph_configuration_read(written.path, &again, &diag) == NEPH_OK,
                 "what we write we read");
    require_same(&read, &again);
    fuzz_file_remove(&written);
    json_decref(json);
    free(text);
    return 0;
}
