/* SPDX-License-Identifier: MIT */
#include "tests/neph_test.h"

#include "base/option.h"

static const char *const colours[] = {"red", "green", NULL};
static const struct neph_option options[] = {
    {"steps", NEPH_OPTION_INTEGER, 8, 1, 64, NULL, "steps"},
    {"width_m", NEPH_OPTION_REAL, 0.1, 0, 10, NULL, "width [m]"},
    {"colour", NEPH_OPTION_CHOICE, 1, 0, 0, colours, "colour"},
    {.name = NULL},
};

static const struct neph_preset presets[] = {
    {"thin", "thin and red", "width_m=0.01 colour=red", 1},
    {"plain", "the defaults", "", 2},
    {"broken", "names what is not there", "colour=red length_m=1", 3},
    {.name = NULL},
};

static void expect_text(const struct neph_settings *settings, const char *expected)
{
    char *text = neph_options_text(options, settings);
    assert_string_equal(text, expected);
    free(text);
}

/* The setting must be refused, with these words in message and hint, and change nothing. */
static void expect_refusal(const struct neph_option *table, const char *assignment,
                           const char *message, const char *hint)
{
    struct neph_settings settings = neph_options_default(table);
    const struct neph_settings before = settings;
    struct neph_diag diag = {.line = 0};
    assert_int_equal(neph_options_set(table, "engine x", assignment, &settings, &diag),
                     NEPH_ERR_USAGE);
    assert_non_null(strstr(diag.message, message));
    assert_string_equal(diag.hint, hint);
    assert_memory_equal(&settings, &before, sizeof(settings));
}

static void test_text_has_all_settings_and_reads_back(void **state)
{
    struct neph_diag diag = {.line = 0};
    struct neph_settings settings = neph_options_default(options);
    expect_text(&settings, "steps=8 width_m=0.1 colour=green");
    neph_assert_ok(neph_options_set(options, "x", "width_m=0.30000000000000004", &settings, &diag),
                   &diag);
    neph_assert_ok(neph_options_set(options, "x", "steps=64", &settings, &diag), &diag);
    expect_text(&settings, "steps=64 width_m=0.30000000000000004 colour=green");
    const struct neph_settings from = neph_options_default(options);
    char *changes = neph_options_changes(options, &settings, &from);
    assert_string_equal(changes, "steps=64 width_m=0.30000000000000004");
    free(changes);
    changes = neph_options_changes(options, &from, &from);
    assert_string_equal(changes, "");
    free(changes);
}

static void test_wrong_settings_are_refused_with_what_is_allowed(void **state)
{
    static const char known[] = "settings of engine x: steps, width_m, colour";
    expect_refusal(options, "steps", "key=value", "");
    expect_refusal(options, "steps=", "not an integer", "");
    expect_refusal(options, "steps=1.5", "not an integer", "");
    expect_refusal(options, "steps=65", "1..64", "");
    expect_refusal(options, "width_m=nan", "finite", "");
    expect_refusal(options, "colour=blue", "red, green", "");
    expect_refusal(options, "step=1", "no setting 'step'", known);
    expect_refusal(options, "=1", "no setting ''", known);
    expect_refusal(&options[3], "steps=1", "no setting", "engine x has no settings");
}

/* If there are more names than fit into a hint, it has the names that share the longest run of
 * letters with the key; runs of less than three are ignored. */
static void test_of_many_settings_those_alike_are_named(void **state)
{
    struct neph_option many[NEPH_OPTIONS_MAX + 1] = {{.name = NULL}};
    char names[NEPH_OPTIONS_MAX][16];
    for (int i = 0; i < NEPH_OPTIONS_MAX; i++) {
        snprintf(names[i], sizeof(names[i]), "%c%c_filler", 'a' + i / 26, 'a' + i % 26);
        many[i] = (struct neph_option){names[i], NEPH_OPTION_REAL, 0, 0, 1, NULL, ""};
    }
    many[10].name = "far_jitter";
    many[90].name = "jitters";
    expect_refusal(many, "jitter=1", "no setting 'jitter'",
                   "settings of engine x with a similar name: far_jitter, jitters");
    expect_refusal(many, "far=1", "no setting",
                   "settings of engine x with a similar name: "
                   "far_jitter");
    expect_refusal(many, "zz=1", "no setting 'zz'", "");
    expect_refusal(many, "filler=1", "no setting 'filler'", ""); /* 94 are too many as well */
}

/* The words of the last row. */
static void test_words_that_are_gone_change_nothing(void **state)
{
    static const char *const gone[] = {"old_word", "it was 3 in every preset", NULL};
    struct neph_option table[sizeof(options) / sizeof(options[0])];
    memcpy(table, options, sizeof(options));
    table[sizeof(options) / sizeof(options[0]) - 1].choices = gone;
    struct neph_settings settings = neph_options_default(table);
    struct neph_diag diag = {.line = 0};
    for (int i = 0; i < 2; i++)
        neph_assert_ok(neph_options_set(table, "x", "old_word=anything", &settings, &diag), &diag);
    expect_text(&settings, "steps=8 width_m=0.1 colour=green");
    expect_refusal(table, "old_words=1", "no setting 'old_words'",
                   "settings of engine x: steps, width_m, colour");
}

static void test_presets_start_from_the_defaults(void **state)
{
    struct neph_diag diag = {.line = 0};
    struct neph_settings settings = neph_options_default(options);
    neph_assert_ok(neph_options_set(options, "x", "steps=3", &settings, &diag), &diag);
    neph_assert_ok(neph_options_preset(options, "x", presets, "thin", &settings, &diag), &diag);
    expect_text(&settings, "steps=8 width_m=0.01 colour=red");
    neph_assert_ok(neph_options_preset(options, "x", presets, "plain", &settings, &diag), &diag);
    expect_text(&settings, "steps=8 width_m=0.1 colour=green");
}

static void test_a_preset_that_is_not_there_changes_nothing(void **state)
{
    static const char *const names[] = {"broken", "none", ""};
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++) {
        struct neph_settings settings = neph_options_default(options);
        struct neph_diag diag = {.line = 0};
        assert_int_equal(neph_options_preset(options, "x", presets, names[i], &settings, &diag),
                         NEPH_ERR_USAGE);
        expect_text(&settings, "steps=8 width_m=0.1 colour=green");
        if (i > 0)
            assert_string_equal(diag.hint, "x has: thin, plain, broken");
        assert_int_equal(neph_options_preset(options, "x", NULL, names[i], &settings, &diag),
                         NEPH_ERR_USAGE);
        assert_non_null(strstr(diag.message, "x has no presets"));
    }
}

static void test_presets_of_a_use(void **state)
{
    static const struct {
        unsigned use;
        const char *first, *separator, *names;
    } cases[] = {{1, "", ",", "thin,broken"},
                 {2, "none", ",a+", "none,a+plain,a+broken"},
                 {4, "", ",", ""},
                 {0, "", ", ", "thin, plain, broken"}};
    for (size_t i = 0; i < COUNT(cases); i++) {
        char *names = neph_preset_names(presets, cases[i].use, cases[i].first, cases[i].separator);
        assert_string_equal(names, cases[i].names);
        free(names);
    }
    assert_string_equal(neph_preset_of_use(presets, 2, 1)->name, "broken");
    assert_null(neph_preset_of_use(presets, 2, 2));
}

#include "tests/main.h"
