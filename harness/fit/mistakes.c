/* SPDX-License-Identifier: MIT */
#include "harness/fit/mistakes.h"

#include <math.h>
#include <string.h>

#define LN2 0.69314718055994531
#define LN10 2.30258509299404568
#define FOUR_PI 12.566370614359173

struct factors {
    double extinction, albedo;
};

/* Factors by the medium's albedo, where one number is taken for another. */
static struct factors absorption_added(double albedo)
{
    return (struct factors){2.0 - albedo, 1.0 / ((2.0 - albedo) * albedo)};
}

static struct factors divided_by_albedo(double albedo)
{
    return (struct factors){1.0 / albedo, 1.0};
}

static struct factors all_scattered(double albedo)
{
    return (struct factors){1.0, 1.0 / albedo};
}

static struct factors multiplied_by_albedo(double albedo)
{
    return (struct factors){albedo, 1.0};
}

static struct factors absorption_missing(double albedo)
{
    return (struct factors){albedo, 1.0 / albedo};
}

/* Light that was integrated along a ray is blended by the opacity of the ray once more (Godot until
 * pull request 112494), so no factor of it is the same for all rays. */
static struct factors apply_opacity_twice(double albedo)
{
    (void)albedo;
    return (struct factors){1.0, 1.0};
}

static const struct row {
    const char *name, *detail;
    struct factors factors;
    struct factors (*find)(double albedo); /* NULL: `factors` */
} rows[] = {
    {"exp2 taken for exp", "", {LN2, 1.0}, NULL},
    {"exp2 taken for exp", "in attenuation only", {LN2, 1.0 / LN2}, NULL},
    {"exp2 taken for exp", "twice", {LN2 * LN2, 1.0}, NULL},
    {"exp2 taken for exp", "twice, in attenuation only", {LN2 * LN2, 1.0 / (LN2 * LN2)}, NULL},
    {"exp taken for exp2", "", {1.0 / LN2, 1.0}, NULL},
    {"exp taken for exp2", "in attenuation only", {1.0 / LN2, LN2}, NULL},
    {"exp taken for exp2", "twice", {1.0 / (LN2 * LN2), 1.0}, NULL},
    {"exp taken for exp2", "twice, in attenuation only", {1.0 / (LN2 * LN2), LN2 *LN2}, NULL},
    {"10^x taken for exp (base-10 optical density)", "", {LN10, 1.0}, NULL},
    {"10^x taken for exp (base-10 optical density)",
     "in attenuation only",
     {LN10, 1.0 / LN10},
     NULL},
    {"exp taken for 10^x (base-10 optical density)", "", {1.0 / LN10, 1.0}, NULL},
    {"exp taken for 10^x (base-10 optical density)",
     "in attenuation only",
     {1.0 / LN10, LN10},
     NULL},
    {"extinction taken for scattering", "absorption is added", {0, 0}, absorption_added},
    {"extinction taken for scattering", "divided by the albedo", {0, 0}, divided_by_albedo},
    {"extinction taken for scattering", "no absorption", {0, 0}, all_scattered},
    {"scattering taken for extinction", "", {0, 0}, multiplied_by_albedo},
    {"scattering taken for extinction", "no absorption", {0, 0}, absorption_missing},
    {"a missing 4 pi", "the phase function is not divided by it", {1.0, FOUR_PI}, NULL},
    {"a 4 pi too much", "scattered light is divided by it twice", {1.0, 1.0 / FOUR_PI}, NULL},
    {"opacity applied twice",
     "scattered light times 1 - transmittance",
     {0, 0},
     apply_opacity_twice},
    {"density in 1/km taken for 1/m", "", {1000.0, 1.0}, NULL},
    {"density in 1/m taken for 1/km", "", {0.001, 1.0}, NULL},
};
enum { ROWS = sizeof(rows) / sizeof(rows[0]) };

static struct factors find_factors(const struct row *row, double albedo)
{
    if (!row->find)
        return row->factors;
    return albedo > 0.0 ? row->find(albedo) : (struct factors){1.0, 1.0};
}

static bool is_opacity_twice(const struct row *row)
{
    return row->find == apply_opacity_twice;
}

bool neph_fit_mistake_at(int index, double albedo, struct neph_fit_mistake *mistake)
{
    if (index < 0 || index >= ROWS)
        return false;
    const struct factors factors = find_factors(&rows[index], albedo);
    *mistake = (struct neph_fit_mistake){.name = rows[index].name,
                                         .detail = rows[index].detail,
                                         .extinction = factors.extinction,
                                         .albedo = factors.albedo,
                                         .is_opacity_twice = is_opacity_twice(&rows[index])};
    return true;
}

/* ---- one mistake ----------------------------------------------------------------------------- */

static struct neph_fit_base make_base(const struct neph_scene *scene, int index)
{
    struct neph_fit_base base = neph_fit_scene_base();
    base.id = index + 1;
    base.is_opacity_twice = is_opacity_twice(&rows[index]);
    for (int m = 0; m < scene->medium_count; m++) {
        const struct neph_rgb albedo = scene->media[m].albedo;
        const struct factors r = find_factors(&rows[index], albedo.r),
                             g = find_factors(&rows[index], albedo.g),
                             b = find_factors(&rows[index], albedo.b);
        base.extinction[m] = (struct neph_rgb){r.extinction, g.extinction, b.extinction};
        base.albedo[m] = (struct neph_rgb){r.albedo, g.albedo, b.albedo};
    }
    return base;
}

/* Narrow factors to the tolerance around those of a base. */
static void narrow(struct neph_fit_range *range, enum neph_fit_unknown unknown)
{
    const double tolerance = log(1.0 + NEPH_FIT_TOLERANCE);
    range->low.x[unknown] = fmax(range->low.x[unknown], -tolerance);
    range->high.x[unknown] = fmin(range->high.x[unknown], tolerance);
}

/* Whether a factor is far from what was found, before any ray is traced. */
static bool is_far(const struct neph_fit_estimate *found, double factor)
{
    const double tolerance = 1.0 + 2.0 * NEPH_FIT_TOLERANCE;
    return found->is_free && found->is_determined &&
           (factor * tolerance < found->low || factor > found->high * tolerance);
}

/* Whether a base only has factors that are the same for all channels and media, as the unknowns
 * have. */
static bool is_uniform(const struct neph_scene *scene, const struct neph_fit_base *base)
{
    if (base->is_opacity_twice)
        return false;
    for (int m = 0; m < scene->medium_count; m++) {
        const struct neph_rgb e = base->extinction[m], a = base->albedo[m];
        if (e.r != e.g || e.g != e.b || a.r != a.g || a.g != a.b || e.r != base->extinction[0].r ||
            a.r != base->albedo[0].r)
            return false;
    }
    return true;
}

static bool is_excluded(const struct neph_fit_estimates *found,
                        const struct neph_fit_mistake *mistake)
{
    return is_far(&found->list[NEPH_FIT_EXTINCTION], mistake->extinction) ||
           is_far(&found->list[NEPH_FIT_ALBEDO], mistake->albedo) ||
           is_far(&found->scattering, mistake->extinction * mistake->albedo);
}

/* Narrow asymmetry and falloff to the scene's. */
static void narrow_others(const struct neph_fit *fit, struct neph_fit_range *range)
{
    const double g = neph_fit_scene_point(fit->scene).x[NEPH_FIT_ASYMMETRY];
    double *low = &range->low.x[NEPH_FIT_ASYMMETRY], *high = &range->high.x[NEPH_FIT_ASYMMETRY];
    narrow(range, NEPH_FIT_FALLOFF);
    *low = fmax(*low, g - NEPH_FIT_TOLERANCE);
    *high = fmin(*high, g + NEPH_FIT_TOLERANCE);
}

/* Whether a mistake explains the frame; the factors that do are its `found`. `is_alone`: with the
 * scene's asymmetry and falloff. */
static enum neph_status try_mistake(struct neph_fit *fit, const struct neph_fit_base *base,
                                    bool is_alone, struct neph_fit_mistake *mistake, bool *explains,
                                    struct neph_diag *diag)
{
    const double limit = neph_fit_limit(fit, 2);
    struct neph_fit_range range = neph_fit_whole_range(fit);
    struct neph_fit_point point = is_alone ? fit->held.point : fit->best.point;
    double squares = INFINITY;
    point.x[NEPH_FIT_EXTINCTION] -= log(mistake->extinction);
    point.x[NEPH_FIT_ALBEDO] -= log(mistake->albedo);
    narrow(&range, NEPH_FIT_EXTINCTION);
    narrow(&range, NEPH_FIT_ALBEDO);
    if (is_alone)
        narrow_others(fit, &range);
    const double enough = is_uniform(fit->scene, base) ? limit : 0.0;
    const enum neph_status status = neph_fit_minimise(fit, base, &range, enough, &point, &squares,
                                                      diag);
    mistake->squares = squares;
    *explains = !status && squares <= limit;
    mistake->found[0] = mistake->extinction * exp(point.x[NEPH_FIT_EXTINCTION]);
    mistake->found[1] = mistake->albedo * exp(point.x[NEPH_FIT_ALBEDO]);
    return status;
}

/* ---- all ------------------------------------------------------------------------------------- */

static bool is_one(double factor)
{
    return fabs(log(factor)) <= log(1.0 + NEPH_FIT_TOLERANCE);
}

/* Whether a mistake may be tried: it changes what is free, and not to factors that are far from
 * those that were found. */
static bool can_explain(const struct neph_fit *fit, const struct neph_fit_base *base,
                        const struct neph_fit_mistake *mistake)
{
    const bool has_extinction = !is_one(mistake->extinction),
               has_albedo = mistake->is_opacity_twice || !is_one(mistake->albedo);
    return (has_extinction || has_albedo) &&
           (fit->is_free[NEPH_FIT_EXTINCTION] || !has_extinction) &&
           (fit->is_free[NEPH_FIT_ALBEDO] || !has_albedo) &&
           !(is_uniform(fit->scene, base) && is_excluded(&fit->best, mistake));
}

/* How far the factors that were found are from those of a mistake. */
static double find_distance(const struct neph_fit_mistake *mistake)
{
    return hypot(log(mistake->found[0] / mistake->extinction),
                 log(mistake->found[1] / mistake->albedo));
}

static void remove_at(struct neph_fit_verdict *verdict, int at)
{
    verdict->count--;
    for (int i = at; i < verdict->count; i++)
        verdict->list[i] = verdict->list[i + 1];
}

/* Add a mistake, the nearest first; of variants of one name only the nearest. */
static void insert(struct neph_fit_verdict *verdict, struct neph_fit_mistake mistake)
{
    for (int i = 0; i < verdict->count; i++)
        if (strcmp(verdict->list[i].name, mistake.name) == 0) {
            if (find_distance(&verdict->list[i]) <= find_distance(&mistake))
                return;
            remove_at(verdict, i);
        }
    if (verdict->count == NEPH_FIT_FOUND_MAX)
        return;
    int at = verdict->count++;
    for (; at > 0 && find_distance(&mistake) < find_distance(&verdict->list[at - 1]); at--)
        verdict->list[at] = verdict->list[at - 1];
    verdict->list[at] = mistake;
}

/* Factors that differ between channels may explain a frame better than the fit, which has one of
 * each: then mistakes that only do as well as the fit are removed. */
static void remove_worse(const struct neph_fit *fit, struct neph_fit_verdict *verdict)
{
    double least = fit->best.squares;
    int kept = 0;
    for (int i = 0; i < verdict->count; i++)
        least = fmin(least, verdict->list[i].squares);
    const double limit = least + fmax(least / fit->best.squares, 1e-6) *
                                     (neph_fit_limit(fit, 2) - fit->best.squares);
    for (int i = 0; i < verdict->count; i++)
        if (verdict->list[i].squares <= limit || least == fit->best.squares)
            verdict->list[kept++] = verdict->list[i];
    verdict->count = kept;
}

static enum neph_status find_mistakes(struct neph_fit *fit, bool is_alone,
                                      struct neph_fit_verdict *verdict, struct neph_diag *diag)
{
    struct neph_fit_mistake mistake;
    enum neph_status status = NEPH_OK;
    for (int i = 0; neph_fit_mistake_at(i, fit->scene->media[0].albedo.r, &mistake) && !status;
         i++) {
        const struct neph_fit_base base = make_base(fit->scene, i);
        bool explains = false;
        if (!can_explain(fit, &base, &mistake))
            continue;
        status = try_mistake(fit, &base, is_alone, &mistake, &explains, diag);
        if (explains)
            insert(verdict, mistake);
    }
    remove_worse(fit, verdict);
    return status;
}

/* The mistake that has this factor of extinction only; NULL: none. */
static const char *find_name(const struct neph_fit_estimate *found)
{
    struct neph_fit_mistake mistake;
    for (int i = 0; neph_fit_mistake_at(i, 1.0, &mistake); i++)
        if (!rows[i].find && mistake.albedo == 1.0 && !is_far(found, mistake.extinction))
            return mistake.name;
    return NULL;
}

static bool is_other(const struct neph_fit_estimate *found, double own, double tolerance)
{
    return found->is_free && found->is_determined && fabs(found->value - own) > tolerance &&
           (own < found->low || own > found->high);
}

/* Compare with the scene, with each mistake and the scene's other values, with the scene's
 * extinction and albedo, and with each mistake: the first that explains the frame is enough. */
static enum neph_status compare(struct neph_fit *fit, struct neph_fit_verdict *verdict,
                                bool *is_scene, struct neph_diag *diag)
{
    const struct neph_fit_base base = neph_fit_scene_base();
    struct neph_fit_mistake none = {.name = "", .detail = "", .extinction = 1.0, .albedo = 1.0};
    enum neph_status status = try_mistake(fit, &base, true, &none, is_scene, diag);
    verdict->factors_agree = *is_scene;
    if (status || *is_scene)
        return status;
    status = find_mistakes(fit, true, verdict, diag);
    verdict->is_alone = verdict->count > 0;
    if (!status && verdict->count == 0)
        status = try_mistake(fit, &base, false, &none, &verdict->factors_agree, diag);
    if (!status && verdict->count == 0 && !verdict->factors_agree)
        status = find_mistakes(fit, false, verdict, diag);
    return status;
}

enum neph_status neph_fit_judge(struct neph_fit *fit, struct neph_fit_verdict *verdict,
                                struct neph_diag *diag)
{
    const double g = neph_fit_scene_point(fit->scene).x[NEPH_FIT_ASYMMETRY];
    bool is_scene = false;
    *verdict = (struct neph_fit_verdict){.agrees = false};
    const enum neph_status status = compare(fit, verdict, &is_scene, diag);
    verdict->agrees = is_scene && fit->transfer == NEPH_FIT_LINEAR;
    const bool may_differ = !is_scene && !verdict->is_alone;
    verdict->is_asymmetry_other = may_differ && is_other(&fit->best.list[NEPH_FIT_ASYMMETRY], g,
                                                         NEPH_FIT_TOLERANCE);
    verdict->is_falloff_other = may_differ && is_other(&fit->best.list[NEPH_FIT_FALLOFF], 1.0,
                                                       NEPH_FIT_TOLERANCE);
    if (verdict->is_falloff_other)
        verdict->falloff = find_name(&fit->best.list[NEPH_FIT_FALLOFF]);
    return status;
}
