/* SPDX-License-Identifier: MIT */
#include "harness/compare/headlines.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const struct neph_headline neph_headlines[NEPH_HEADLINES] = {
    {"radiance", "seen_contrast", "times the threshold"},
    {"radiance", "rel_rmse", NULL},
    {"radiance", "rel_bias", NULL},
    {"radiance", "max_rel", NULL},
    {"radiance", "pu_psnr", NULL},
    {"radiance", "ssim_mean", NULL},
    {"radiance", "flip_mean", NULL},
    {"transmittance", "rmse", NULL},
    {"radiance", "cyclic_share", NULL},
    {"radiance", "restless_share", NULL},
    {"radiance", "a4_p95", NULL},
    {"radiance", "residual_change_rms", NULL},
    {"radiance", "half_life_p50", NULL},
};

static const struct neph_difference *find(const struct neph_differences *list, const char *quantity,
                                          const char *metric, const char *mask)
{
    for (int i = 0; i < list->count; i++) {
        const struct neph_measurement *number = list->list[i].number;
        if (strcmp(number->quantity->name, quantity) == 0 && strcmp(number->mask, mask) == 0 &&
            (!metric || strcmp(number->metric->name, metric) == 0))
            return &list->list[i];
    }
    return NULL;
}

const struct neph_difference *neph_headline_difference(const struct neph_differences *list,
                                                       const char *mask, const char **words)
{
    *words = NULL;
    for (int h = 0; h < NEPH_HEADLINES; h++) {
        const struct neph_headline *headline = &neph_headlines[h];
        const struct neph_difference *found = find(list, headline->quantity, headline->metric,
                                                   mask);
        if (!found)
            continue;
        *words = headline->words;
        return found;
    }
    return find(list, "radiance", NULL, mask);
}

void neph_headline_value(double value, char text[32])
{
    if (fabs(value) >= 99.95)
        snprintf(text, 32, "%.0f", value);
    else if (value == 0.0)
        snprintf(text, 32, "0");
    else
        snprintf(text, 32, "%#.3g", value);
}

const char *neph_headline_unit(const struct neph_measurement *number, char text[64])
{
    text[0] = '\0';
    if (strcmp(number->unit, "1") != 0)
        snprintf(text, 64, " %s", number->unit);
    return text;
}
