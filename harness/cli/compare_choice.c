/* SPDX-License-Identifier: MIT */
#include "harness/cli/compare_choice.h"

#include "base/text.h"
#include "harness/compare/alone.h"
#include "harness/old_options.h"
#include "metrics/extractors/extractors.h"

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
