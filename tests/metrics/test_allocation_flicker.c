/* SPDX-License-Identifier: MIT
 *
 * Out of memory while flicker is measured: see tests/allocation.h.
 */
#include "tests/allocation.h"

#include "metrics/extractors/extractors.h"
#include "metrics/extractors/pair_codes.h"

enum { W = 21, H = 4, N = 16 };

struct life {
    const struct neph_extractor *extractor;
    int moves_at; /* frame in which the reference moves */
};

/* From creation to destruction. */
static enum neph_status live(void *context, struct neph_diag *diag)
{
    const struct life *life = context;
    const struct neph_extractor *extractor = life->extractor;
    struct neph_arena memory = {0};
    struct neph_pair_codes codes = {.memory = &memory};
    static const float dark[W * H], bright[W * H] = {1.0f};
    const struct neph_viewing viewing = NEPH_VIEWING_DEFAULTS;
    const struct neph_settings settings = neph_options_default(extractor->options);
    struct neph_frame_pair pair = {.quantity = neph_quantity_find("radiance"),
                                   .width_px = W,
                                   .height_px = H,
                                   .plane_count = 3,
                                   .reference = {dark, dark, dark},
                                   .test = {dark, dark, dark},
                                   .scene_mean = NAN,
                                   .frame_count = N,
                                   .viewing = &viewing,
                                   .codes = &codes,
                                   .memory = &memory};
    void *state = __real_calloc(1, extractor->state_size);
    assert_non_null(state);
    enum neph_status status = extractor->init(state, &pair, &settings, diag);
    for (int t = 0; t < N && !status; t++) {
        pair.frame = t;
        neph_pair_codes_forget(&codes);
        pair.reference[1] = t >= life->moves_at ? bright : dark;
        status = extractor->extract(state, &pair, diag);
    }
    if (!status && extractor->flush)
        status = extractor->flush(state, diag);
    extractor->close(state);
    neph_pair_luma_end(&codes);
    neph_arena_finish(&memory);
    free(state);
    return status;
}

static void test_flicker(void **state)
{
    struct life still = {&neph_extractor_flicker, N}, moving = {&neph_extractor_flicker, 5};
    assert_every_failure_is_reported("flicker before a still reference", live, &still);
    assert_every_failure_is_reported("flicker before a moving reference", live, &moving);
}

static void test_seen(void **state)
{
    struct life life = {&neph_extractor_seen, 5};
    assert_every_failure_is_reported("what is seen of flicker", live, &life);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_flicker), cmocka_unit_test(test_seen)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
