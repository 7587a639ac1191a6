/* SPDX-License-Identifier: MIT */
#include "harness/compare/choice.h"

#include "base/text.h"
#include "harness/compare/alone.h"
#include "harness/old_options.h"
#include "metrics/extractors/extractors.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const struct neph_extractor *neph_find_extractor(const char *word)
{
    const struct neph_extractor *extractor = neph_extractor_find(word);
    if (!extractor)
        neph_metric_find(word, &extractor);
    return extractor;
}

static struct neph_meter_choice *find_choice(struct neph_comparison *comparison,
                                             const struct neph_extractor *extractor)
{
    for (int i = 0; i < comparison->choice_count; i++)
        if (comparison->choices[i].extractor == extractor)
            return &comparison->choices[i];
    return NULL;
}

void neph_choose_extractor(struct neph_comparison *comparison,
                           const struct neph_extractor *extractor)
{
    if (find_choice(comparison, extractor) || comparison->choice_count == NEPH_CHOICES_MAX)
        return;
    comparison->choices[comparison->choice_count++] = (struct neph_meter_choice){
        extractor, neph_options_default(extractor->options)};
    comparison->with_movement |= extractor->temporal;
}

enum neph_status neph_choose_word(struct neph_comparison *comparison, const char *word,
                                  struct neph_diag *diag)
{
    const struct neph_extractor *extractor = neph_find_extractor(word);
    if (extractor) {
        neph_choose_extractor(comparison, extractor);
        return NEPH_OK;
    }
    if (strcmp(word, "all") != 0) {
        neph_fail(diag, NEPH_ERR_USAGE, "there is no extractor or metric '%s'", word);
        neph_hint(diag, "`neph metrics` lists them");
        return NEPH_ERR_USAGE;
    }
    for (int i = 0; i < neph_extractor_count(); i++)
        if (!comparison->without_reference ||
            neph_extractor_needs_no_reference(neph_extractor_at(i)))
            neph_choose_extractor(comparison, neph_extractor_at(i));
    return NEPH_OK;
}

void neph_choose_usual(struct neph_comparison *comparison, bool temporal)
{
    for (int i = 0; i < neph_extractor_count(); i++) {
        const struct neph_extractor *extractor = neph_extractor_at(i);
        if (!extractor->costly && extractor->temporal == temporal &&
            (!comparison->without_reference || neph_extractor_needs_no_reference(extractor)))
            neph_choose_extractor(comparison, extractor);
    }
}

enum neph_status neph_choice_check_reference(const struct neph_comparison *comparison,
                                             const char *option, struct neph_diag *diag)
{
    const char *needing = option;
    for (int i = 0; i < comparison->choice_count; i++)
        if (!neph_extractor_needs_no_reference(comparison->choices[i].extractor))
            needing = comparison->choices[i].extractor->name;
    if (!comparison->without_reference || !needing)
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_USAGE,
              "%s needs a reference; without one there are flicker, cycles and seen", needing);
    neph_hint(diag, "name the reference: -r FILES");
    return NEPH_ERR_USAGE;
}

/* Warn about the old form of settings, EXTRACTOR.KEY=VALUE. */
static void warn_old_setting_form(const char *extractor, const char *key)
{
    char was[160], is[160];
    neph_text_format(was, sizeof(was), "-s %s.%s", extractor, key);
    neph_text_format(is, sizeof(is), "-s %s:%s", extractor, key);
    neph_old_option_warn("neph", was, is);
}

enum neph_status neph_choose_setting(struct neph_comparison *comparison, const char *text,
                                     struct neph_diag *diag)
{
    char name[64], owner[96];
    const size_t length = strcspn(text, ".:=");
    const char *key = text + length + 1;
    if (text[length] == '\0' || text[length] == '=' || length >= sizeof(name))
        return neph_fail(diag, NEPH_ERR_USAGE, "setting '%s' is not EXTRACTOR:KEY=VALUE", text);
    snprintf(name, sizeof(name), "%.*s", (int)length, text);
    if (text[length] == '.')
        warn_old_setting_form(name, key);
    const struct neph_extractor *extractor = neph_extractor_find(name);
    if (!extractor)
        return neph_fail(diag, NEPH_ERR_USAGE, "setting '%s': there is no extractor '%s'", text,
                         name);
    neph_choose_extractor(comparison, extractor); /* a setting also chooses its extractor */
    snprintf(owner, sizeof(owner), "extractor %s", name);
    return neph_options_set(extractor->options, owner, key,
                            &find_choice(comparison, extractor)->settings, diag);
}

/* ---- viewing --------------------------------------------------------------------------------- */

static double given_or(double given, double otherwise)
{
    return isnan(given) ? otherwise : given;
}

struct neph_viewing neph_viewing_complete(struct neph_viewing given)
{
    const struct neph_viewing usual = NEPH_VIEWING_DEFAULTS;
    return (struct neph_viewing){
        .frame_rate_hz = given_or(given.frame_rate_hz, usual.frame_rate_hz),
        .pixels_per_degree = given_or(given.pixels_per_degree, usual.pixels_per_degree),
        .exposure_ev = given_or(given.exposure_ev, usual.exposure_ev),
        .white_cd_per_m2 = given_or(given.white_cd_per_m2, usual.white_cd_per_m2),
    };
}

/* ---- what was named -------------------------------------------------------------------------- */

static bool is_wanted(const struct neph_measurement *number, const void *context)
{
    const struct neph_named *named = context;
    const char *metric = number->metric->name;
    const struct neph_extractor *owner = NULL;
    if (named->mask && strcmp(named->mask, number->mask) != 0)
        return false;
    neph_metric_find(metric, &owner);
    bool found = named->metric_count == 0;
    for (int i = 0; i < named->metric_count; i++) {
        const char *word = named->metrics[i];
        found |= strcmp(word, "all") == 0 || strcmp(word, owner->name) == 0 ||
                 strcmp(word, metric) == 0;
    }
    for (int i = 0; i < named->setting_count; i++) {
        const char *setting = named->settings[i];
        const size_t length = strlen(owner->name);
        found |= strncmp(setting, owner->name, length) == 0 &&
                 (setting[length] == '.' || setting[length] == ':');
    }
    return found;
}

/* A finding combines several metrics, so only its mask decides. `half_life` belongs to no mask. */
static bool is_wanted_finding(const struct neph_named *named, const struct neph_finding *finding)
{
    return !named->mask || strcmp(named->mask, finding->mask) == 0 ||
           strcmp(finding->name, "half_life") == 0;
}

void neph_named_select(const struct neph_named *named, struct neph_compared *compared)
{
    struct neph_findings *findings = &compared->findings;
    int kept = 0;
    neph_measurements_select(&compared->numbers, is_wanted, named);
    for (int i = 0; i < findings->count; i++)
        if (is_wanted_finding(named, &findings->list[i]))
            findings->list[kept++] = findings->list[i];
    findings->count = kept;
}

static bool has_extractor_numbers(const struct neph_compared *compared,
                                  const struct neph_extractor *extractor)
{
    for (int i = 0; i < compared->numbers.count; i++) {
        const struct neph_extractor *owner = NULL;
        neph_metric_find(compared->numbers.list[i].metric->name, &owner);
        if (owner == extractor)
            return true;
    }
    return false;
}

static enum neph_status check_was_measured(const char *word, const struct neph_compared *compared,
                                           struct neph_diag *diag)
{
    const struct neph_extractor *extractor = neph_find_extractor(word);
    if (!extractor || has_extractor_numbers(compared, extractor)) /* "all" is no extractor */
        return NEPH_OK;
    const char *because = "the images have nothing that it is taken of";
    for (int i = 0; i < compared->not_taken_count; i++)
        if (strcmp(compared->not_taken[i].extractor, extractor->name) == 0)
            because = compared->not_taken[i].because;
    return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "%s was not measured: %s", word, because);
}

enum neph_status neph_named_check(const struct neph_named *named,
                                  const struct neph_compared *compared, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    if (named->metric_count == 0 && named->is_flicker)
        status = check_was_measured("flicker", compared, diag);
    for (int i = 0; i < named->metric_count && !status; i++)
        status = check_was_measured(named->metrics[i], compared, diag);
    return status;
}
