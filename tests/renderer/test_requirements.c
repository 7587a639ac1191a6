/* SPDX-License-Identifier: MIT
 *
 * Requirements of a device: fictitious devices, each without one row of the table, are refused with
 * a message or used without the feature. No Vulkan driver is called.
 */
#include "tests/neph_test.h"

#include "base/files.h"
#include "renderer/requirements.h"

#include <stdlib.h>
#include <string.h>

static void set_number(struct neph_device_facts *facts, const struct neph_requirement *row,
                       uint32_t number)
{
    memcpy((char *)facts + row->offset, &number, sizeof(number));
}

/* A device that meets each requirement exactly. */
static struct neph_device_facts sufficient_device(const char *name, bool is_cpu)
{
    struct neph_device_facts facts = {.is_cpu = is_cpu};
    int count;
    const struct neph_requirement *rows = neph_requirements(&count);
    for (int i = 0; i < count; i++)
        set_number(&facts, &rows[i], rows[i].needed);
    snprintf(facts.device, sizeof(facts.device), "%s", name);
    return facts;
}

/* One less than required; for bits, none. */
static uint32_t too_little(const struct neph_requirement *row)
{
    return row->kind == NEPH_REQUIREMENT_BITS ? 0 : row->needed - 1;
}

static void assert_says(const char *text, const char *words)
{
    if (!strstr(text, words))
        fail_msg("'%s' does not say '%s'", text, words);
}

static void assert_refused(const struct neph_requirement *row,
                           const struct neph_device_facts *facts)
{
    struct neph_diag diag = {0};
    const struct neph_vulkan_requirement answer = neph_requirement_describe(row, facts);
    assert_int_equal(neph_requirements_check(facts, &diag), NEPH_ERR_UNAVAILABLE);
    assert_int_equal(neph_status_exit_code(NEPH_ERR_UNAVAILABLE), 69);
    const char *const words[] = {row->name, "'Abacus 3'", answer.value, answer.needed,
                                 row->purpose};
    for (size_t i = 0; i < sizeof(words) / sizeof(words[0]); i++)
        assert_says(diag.message, words[i]);
    assert_says(diag.hint, "NEPH_VULKAN_DEVICE");
    assert_says(diag.hint, "apt-get install mesa-vulkan-drivers");
    assert_false(answer.is_met);
}

static void test_each_missing_row_is_refused_or_done_without(void **state)
{
    int count;
    const struct neph_requirement *rows = neph_requirements(&count);
    for (int i = 0; i < count; i++)
        for (int is_cpu = 0; is_cpu < 2; is_cpu++) {
            struct neph_device_facts facts = sufficient_device("Abacus 3", is_cpu);
            struct neph_diag diag = {0};
            neph_assert_ok(neph_requirements_check(&facts, &diag), &diag);
            set_number(&facts, &rows[i], too_little(&rows[i]));
            const bool is_needed = rows[i].necessity == NEPH_REQUIRED ||
                                   (rows[i].necessity == NEPH_REQUIRED_OF_CPU && is_cpu);
            if (is_needed)
                assert_refused(&rows[i], &facts);
            else
                neph_assert_ok(neph_requirements_check(&facts, &diag), &diag);
        }
}

static void test_each_optional_row_says_how_it_is_done_without(void **state)
{
    int count;
    const struct neph_requirement *rows = neph_requirements(&count);
    for (int i = 0; i < count; i++)
        assert_true((rows[i].without != NULL) == (rows[i].necessity == NEPH_OPTIONAL));
}

static void test_all_that_is_missing_is_named(void **state)
{
    const struct neph_device_facts nothing = {.device = "stone"};
    struct neph_diag diag = {0};
    int count;
    const struct neph_requirement *rows = neph_requirements(&count);
    assert_int_equal(neph_requirements_check(&nothing, &diag), NEPH_ERR_UNAVAILABLE);
    print_message("%s (%s)\n", diag.message, diag.hint);
    for (int i = 0; i < count; i++)
        if (rows[i].necessity == NEPH_REQUIRED)
            assert_says(diag.message, rows[i].name);
        else
            assert_null(strstr(diag.message, rows[i].name));
}

/* Enabling a feature that the device lacks would give a driver error without the feature's name. */
static void test_only_features_that_a_device_has_are_enabled(void **state)
{
    struct neph_device_facts facts = sufficient_device("Abacus 3", false);
    VkPhysicalDeviceFeatures features;
    VkPhysicalDeviceVulkan12Features features_12;
    neph_requirements_features(&facts, &features, &features_12);
    assert_int_equal(features.shaderInt64, VK_TRUE);
    assert_int_equal(features_12.hostQueryReset, VK_TRUE);
    assert_int_equal(features_12.sType, VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES);
    facts.features.shaderInt64 = VK_FALSE;
    facts.features.geometryShader = VK_TRUE;
    neph_requirements_features(&facts, &features, &features_12);
    assert_int_equal(features.shaderInt64, VK_FALSE);
    assert_int_equal(features.geometryShader, VK_FALSE);
}

/* --- choosing ----------------------------------------------------------------------------- */

static int choose(const struct neph_device_facts *facts, int count, const char *wanted)
{
    int chosen = -1;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_requirements_choose(facts, count, wanted, &chosen, &diag), &diag);
    return chosen;
}

static void test_a_device_that_lacks_something_is_passed_over(void **state)
{
    struct neph_device_facts facts[] = {sufficient_device("Abacus 3", true),
                                        sufficient_device("Slide Rule", false),
                                        sufficient_device("Mill", true)};
    assert_int_equal(choose(facts, 3, NULL), 0);
    assert_int_equal(choose(facts, 3, "rule"), 1);
    facts[0].features.shaderInt64 = VK_FALSE; /* the CPU device */
    facts[1].features.shaderInt64 = VK_FALSE; /* not required of a GPU */
    assert_int_equal(choose(facts, 3, NULL), 2);
    assert_int_equal(choose(facts, 2, NULL), 1);
}

static void assert_none(const struct neph_device_facts *facts, int count, const char *wanted,
                        const char *in_message, const char *in_hint)
{
    int chosen = 7;
    struct neph_diag diag = {0};
    assert_int_equal(neph_requirements_choose(facts, count, wanted, &chosen, &diag),
                     NEPH_ERR_UNAVAILABLE);
    assert_int_equal(chosen, 7);
    assert_says(diag.message, in_message);
    assert_says(diag.hint, in_hint);
}

static void test_why_no_device_can_be_used_is_said(void **state)
{
    struct neph_device_facts facts[] = {sufficient_device("Abacus 3", false),
                                        sufficient_device("Slide Rule", false)};
    facts[1].limits.maxUniformBufferRange = 16384;
    assert_none(facts, 2, "rule", "'Slide Rule' cannot be used: its maxUniformBufferRange is 16384",
                "NEPH_VULKAN_DEVICE");
    assert_none(facts, 2, "mill", "named like 'mill'", "'Abacus 3', 'Slide Rule'");
    facts[0].api_version = VK_API_VERSION_1_1;
    assert_none(facts, 2, NULL, "apiVersion is 1.1.0, needed is 1.2.0", "NEPH_VULKAN_DEVICE");
    assert_none(facts, 0, NULL, "no Vulkan device", "apt-get install mesa-vulkan-drivers");
}

/* --- the table in words --------------------------------------------------------------------- */

static void test_docs_have_the_table(void **state)
{
    OWNED(memory) char *text = NULL;
    size_t size_bytes = 0;
    struct neph_diag diag = {0};
    int count;
    const struct neph_requirement *rows = neph_requirements(&count);
    const struct neph_device_facts facts = sufficient_device("Abacus 3", true);
    neph_assert_ok(
        neph_file_read(NEPH_SOURCE_DIR "/docs/devices.md", 1 << 20, &text, &size_bytes, &diag),
        &diag);
    for (int i = 0; i < count; i++) {
        char line[128];
        snprintf(line, sizeof(line), "\n| `%s` | %s | %s |", rows[i].name,
                 neph_requirement_describe(&rows[i], &facts).needed,
                 rows[i].necessity == NEPH_REQUIRED          ? "required"
                 : rows[i].necessity == NEPH_REQUIRED_OF_CPU ? "required of a CPU"
                                                             : "optional");
        assert_says(text, line);
    }
}

#include "tests/main.h"
