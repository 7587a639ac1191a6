/* SPDX-License-Identifier: MIT
 *
 * Which engines are non-physical: by engine, by lighting, by fog model.
 */
#include "tests/neph_test.h"

#include "harness/engines/engines.h"
#include "harness/engines/non_physical.h"

static const struct neph_engine *engine_named(const char *name)
{
    const struct neph_engine *engine = neph_engine_find(name);
    assert_non_null(engine);
    return engine;
}

static void test_which_engines_are_non_physical(void **state)
{
    static const struct {
        const char *engine, *setting;
        bool is_look;
        const char *fog; /* in the reason for non-physical fog; NULL: none */
    } cases[] = {
        {"exact", NULL, false, NULL},
        {"tracer", NULL, false, NULL},
        {"march", NULL, false, NULL},
        {"march", "fog=medium", false, NULL},
        {"march", "fog=unreal", true, "fog=unreal"},
        {"march_traced", "fog=filament", true, "fog=filament"},
        {"march_octaves", NULL, true, NULL},
        {"fog_look", NULL, true, "fog model"},
        {"realtime", "lighting=single", false, NULL},
        {"realtime", "lighting=traced", false, NULL},
        {"realtime", "lighting=octaves", true, NULL},
        {"cycles", NULL, false, NULL},
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        const struct neph_engine *engine = engine_named(cases[i].engine);
        struct neph_settings settings = neph_settings_default(engine);
        struct neph_diag diag = {0};
        if (cases[i].setting)
            neph_assert_ok(neph_settings_set(engine, &settings, cases[i].setting, &diag), &diag);
        const char *words = neph_fog_model_note(engine, &settings);
        assert_int_equal(neph_is_non_physical(engine, &settings), cases[i].is_look);
        assert_int_equal(words != NULL, cases[i].fog != NULL);
        if (words)
            assert_non_null(strstr(words, cases[i].fog));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_which_engines_are_non_physical),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
