/* SPDX-License-Identifier: MIT
 *
 * The reader of display chains: every refusal has a position in the file, and a chain that is read
 * has settings within their ranges, for every position of the camera.
 */
#include "tests/fuzz/fuzz.h"

#include "renderer/post/plan.h"

static void require_in_range(const struct neph_settings *settings)
{
    for (int i = 0; i < POST_SETTING_COUNT; i++) {
        const struct neph_option *option = &neph_post_options[i];
        const double value = settings->values[i];
        fuzz_require(option->kind == NEPH_OPTION_CHOICE ||
                         (value >= option->minimum && value <= option->maximum),
                     "a setting is in its range");
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const struct fuzz_file file = fuzz_file_make("fuzz.yaml", data, size);
    struct neph_post_plan plan = {.title = NULL};
    struct neph_diag diag = {0};
    const enum neph_status status = neph_post_plan_load(file.path, &plan, &diag);
    fuzz_require_outcome(status, &diag, status ? NULL : &plan);
    fuzz_require(status == NEPH_OK || status == NEPH_ERR_INPUT, "the file is at fault");
    fuzz_require(status == NEPH_OK || (diag.line >= 1 && diag.column >= 1), "a position is named");
    if (!status) {
        struct neph_settings settings = neph_post_plan_settings(&plan);
        neph_post_blend(plan.volumes, plan.volume_count, (struct neph_vec3){3.0, 1.0, -7.0},
                        &settings);
        require_in_range(&settings);
        neph_post_plan_finish(&plan);
    }
    fuzz_file_remove(&file);
    return 0;
}
