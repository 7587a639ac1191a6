/* SPDX-License-Identifier: MIT */
#include "harness/fit/answer.h"

#include "base/text.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_FIT_UNKNOWN_COUNT == 4, "a new unknown");
_Static_assert(NEPH_FIT_TRANSFER_COUNT == 3, "a new transfer");

const char *const neph_fit_unknown_names[] = {
    [NEPH_FIT_EXTINCTION] = "extinction", [NEPH_FIT_ALBEDO] = "albedo",
    [NEPH_FIT_ASYMMETRY] = "asymmetry",   [NEPH_FIT_FALLOFF] = "falloff",
    [NEPH_FIT_UNKNOWN_COUNT] = NULL,
};

static const char *const transfer_keys[NEPH_FIT_TRANSFER_COUNT] = {
    [NEPH_FIT_LINEAR] = "linear",
    [NEPH_FIT_ENCODED] = "srgb_codes",
    [NEPH_FIT_DECODED] = "decoded"};

static const char *const transfer_words[NEPH_FIT_TRANSFER_COUNT] = {
    [NEPH_FIT_LINEAR] = "linear light",
    [NEPH_FIT_ENCODED] = "sRGB codes taken for linear light",
    [NEPH_FIT_DECODED] = "linear light decoded as if it were sRGB codes"};

enum { CELL = 64 };

static void add(char *text, size_t size, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

static void add(char *text, size_t size, const char *format, ...)
{
    const size_t used = strlen(text);
    va_list values;
    va_start(values, format);
    vsnprintf(text + used, size - used, format, values);
    va_end(values);
}

/* ---- the sentence ---------------------------------------------------------------------------- */

static void add_factor(const char *name, double predicted, double found,
                       const struct neph_fit_estimate *estimate, char *text, size_t size)
{
    add(text, size, "%s x %.4g", name, predicted);
    if (estimate->is_determined)
        add(text, size, ", found %.4g", found);
}

static void add_mistake(const struct neph_fit *fit, const struct neph_fit_mistake *mistake,
                        char *text, size_t size)
{
    const bool both = mistake->extinction != 1.0 && mistake->albedo != 1.0;
    const char *between = mistake->detail[0] && !mistake->is_opacity_twice ? ": " : "";
    add(text, size, "%s (%s%s", mistake->name, mistake->detail, between);
    if (mistake->extinction != 1.0)
        add_factor("extinction", mistake->extinction, mistake->found[0],
                   &fit->held.list[NEPH_FIT_EXTINCTION], text, size);
    add(text, size, both ? "; " : "");
    if (mistake->albedo != 1.0)
        add_factor("scattered light", mistake->albedo, mistake->found[1],
                   &fit->held.list[NEPH_FIT_ALBEDO], text, size);
    add(text, size, ")");
}

/* The factors of extinction and albedo, where no mistake explains them. */
static void add_factors(const struct neph_fit *fit, char *text, size_t size)
{
    const struct neph_fit_estimate *e = &fit->best.list[NEPH_FIT_EXTINCTION],
                                   *a = &fit->best.list[NEPH_FIT_ALBEDO];
    const char *between = "";
    if (e->is_free && e->is_determined) {
        add(text, size, "extinction x %.4g", e->value);
        between = ", ";
    }
    if (a->is_free && a->is_determined) {
        add(text, size, "%sscattered light x %.4g", between, a->value);
        between = ", ";
    }
    if (!between[0] && fit->best.scattering.is_determined)
        add(text, size, "extinction times albedo x %.4g", fit->best.scattering.value);
    else if (!between[0])
        add(text, size, "by factors that it does not determine");
    add(text, size, "; no known mistake has such factors");
}

static void add_differences(const struct neph_fit_answer *answer, char *text, size_t size)
{
    const struct neph_fit *fit = answer->fit;
    const struct neph_fit_verdict *verdict = answer->verdict;
    const char *between = "";
    if (fit->transfer != NEPH_FIT_LINEAR) {
        add(text, size, "%s", transfer_words[fit->transfer]);
        between = "; ";
    }
    for (int i = 0; i < verdict->count; i++) {
        add(text, size, "%s", i > 0 ? " or " : between);
        add_mistake(fit, &verdict->list[i], text, size);
        between = "; ";
    }
    if (!verdict->factors_agree && verdict->count == 0) {
        add(text, size, "%s", between);
        add_factors(fit, text, size);
        between = "; ";
    }
    if (verdict->is_asymmetry_other) {
        add(text, size, "%sasymmetry %.3g in place of %.3g", between,
            fit->best.list[NEPH_FIT_ASYMMETRY].value, fit->scene->media[0].phase.g);
        between = "; ";
    }
    if (verdict->is_falloff_other)
        add(text, size, "%sfalloff x %.4g%s%s", between, fit->best.list[NEPH_FIT_FALLOFF].value,
            verdict->falloff ? ": " : "", verdict->falloff ? verdict->falloff : "");
    else if (!between[0])
        add(text, size, "in asymmetry or falloff, which it does not determine");
}

static bool is_any_determined(const struct neph_fit *fit)
{
    for (int k = 0; k < NEPH_FIT_UNKNOWN_COUNT; k++)
        if (fit->is_free[k] && fit->best.list[k].is_determined)
            return true;
    return fit->best.scattering.is_determined;
}

void neph_fit_sentence(const struct neph_fit_answer *answer, char *text, size_t size)
{
    const struct neph_fit *fit = answer->fit;
    neph_text_format(text, size, "%s", answer->frame);
    add(text, size, answer->verdict->agrees ? " agrees with %s" : " differs from %s: ",
        fit->scene->name ? fit->scene->name : "the scene");
    if (!answer->verdict->agrees)
        add_differences(answer, text, size);
    else if (!is_any_determined(fit))
        add(text, size, ", but determines nothing of its medium");
    if (!fit->is_transfer_sure)
        add(text, size, " (it does not tell whether R G B are linear light)");
}

/* ---- the table ------------------------------------------------------------------------------- */

/* The extinction of a scene with one medium and one layer; NaN: there are several. */
static double own_extinction(const struct neph_scene *scene)
{
    const struct neph_medium *medium = &scene->media[0];
    if (scene->medium_count > 1 || medium->layer_count > 1)
        return NAN;
    return medium->layer_count == 1 ? medium->layers[0].extinction_per_m : medium->extinction_per_m;
}

static double own_albedo(const struct neph_scene *scene)
{
    const struct neph_rgb albedo = scene->media[0].albedo;
    for (int m = 1; m < scene->medium_count; m++)
        if (memcmp(&scene->media[m].albedo, &albedo, sizeof(albedo)) != 0)
            return NAN;
    return albedo.r == albedo.g && albedo.g == albedo.b ? albedo.r : NAN;
}

static double own_falloff(const struct neph_scene *scene)
{
    const struct neph_medium *medium = &scene->media[0];
    return scene->medium_count == 1 && medium->layer_count == 1 ? medium->layers[0].falloff_per_m
                                                                : NAN;
}

/* The scene's value of an unknown; NaN: it has several, or none. */
static double own_value(const struct neph_scene *scene, enum neph_fit_unknown unknown)
{
    switch (unknown) {
    case NEPH_FIT_EXTINCTION:
        return own_extinction(scene);
    case NEPH_FIT_ALBEDO:
        return own_albedo(scene);
    case NEPH_FIT_ASYMMETRY:
        return neph_phase_has(scene->media[0].phase.kind, NEPH_PHASE_PARAMETER_G)
                   ? scene->media[0].phase.g
                   : NAN;
    case NEPH_FIT_FALLOFF:
        return own_falloff(scene);
    case NEPH_FIT_UNKNOWN_COUNT:
        break;
    }
    return NAN;
}

static const char *const units[] = {" /m", "", "", " /m"};

static void write_cell(char cell[CELL], double value, const char *unit)
{
    if (isnan(value))
        snprintf(cell, CELL, "-");
    else
        snprintf(cell, CELL, "%.4g%s", value, unit);
}

static void print_row(const char *name, const char *own, const char *found, const char *factor,
                      const char *interval, FILE *out)
{
    fprintf(out, "  %-22s %-12s %-15s %-9s %s\n", name, own, found, factor, interval);
}

static void print_estimate(const struct neph_fit *fit, enum neph_fit_unknown unknown,
                           const struct neph_fit_estimate *found, FILE *out)
{
    const bool is_factor = unknown != NEPH_FIT_ASYMMETRY;
    const double own = own_value(fit->scene, unknown);
    char scene[CELL], frame[CELL] = "not determined", factor[CELL] = "", interval[CELL] = "";
    write_cell(scene, own, units[unknown]);
    if (found->is_determined) {
        write_cell(frame, is_factor ? own * found->value : found->value, units[unknown]);
        snprintf(interval, CELL, "%.4g to %.4g", found->low, found->high);
    }
    if (found->is_determined && is_factor)
        snprintf(factor, CELL, "%.4g", found->value);
    print_row(neph_fit_unknown_names[unknown], scene, frame, factor, interval, out);
}

static void print_estimates(const struct neph_fit *fit, FILE *out)
{
    const struct neph_fit_estimate *product = &fit->best.scattering, *list = fit->best.list;
    char factor[CELL], interval[CELL];
    for (int k = 0; k < NEPH_FIT_UNKNOWN_COUNT; k++)
        if (list[k].is_free)
            print_estimate(fit, (enum neph_fit_unknown)k, &list[k], out);
    if (!product->is_determined || !list[0].is_free || !list[1].is_free ||
        (list[0].is_determined && list[1].is_determined))
        return;
    snprintf(factor, CELL, "%.4g", product->value);
    snprintf(interval, CELL, "%.4g to %.4g", product->low, product->high);
    print_row("extinction * albedo", "", "", factor, interval, out);
}

/* What is determined with some unknowns held at the scene's values. */
static void print_held(const struct neph_fit *fit, FILE *out)
{
    const char *between = "with the scene's ";
    for (int k = 0; k < NEPH_FIT_UNKNOWN_COUNT; k++)
        if (fit->is_held[k]) {
            fprintf(out, "%s%s", between, neph_fit_unknown_names[k]);
            between = ", ";
        }
    if (between[0] != ',')
        return;
    fprintf(out, ":\n");
    for (int k = 0; k < NEPH_FIT_UNKNOWN_COUNT; k++)
        if (fit->held.list[k].is_free)
            print_estimate(fit, (enum neph_fit_unknown)k, &fit->held.list[k], out);
}

/* Ends of the extinction's factor where not even that determines it. */
static void print_ends(const struct neph_fit *fit, FILE *out)
{
    const bool has_min = fit->extinction_min > 0.0, has_max = isfinite(fit->extinction_max);
    if (fit->held.list[NEPH_FIT_EXTINCTION].is_determined || !(has_min || has_max))
        return;
    fprintf(out, "the factor of extinction is ");
    if (has_min)
        fprintf(out, "at least %.2g%s", fit->extinction_min, has_max ? " and " : "");
    if (has_max)
        fprintf(out, "at most %.2g", fit->extinction_max);
    fprintf(out, "\n");
}

static void print_fixed(const struct neph_fit *fit, FILE *out)
{
    fprintf(out, "held fixed: ");
    for (int k = 0; k < NEPH_FIT_UNKNOWN_COUNT; k++) {
        const char *why = neph_fit_obstacle(fit->scene, (enum neph_fit_unknown)k);
        if (!fit->is_free[k])
            fprintf(out, "%s%s%s%s, ", neph_fit_unknown_names[k], why ? " (" : "", why ? why : "",
                    why ? ")" : "");
    }
    fprintf(out, "camera, light, solids, places of media\n");
}

static void print_depth(const struct neph_fit_pixels *pixels, FILE *out)
{
    if (!pixels->has_depth)
        return;
    fprintf(out, "Z is that of the scene");
    if (pixels->depth_is_distance)
        fprintf(out, ", along the ray");
    if (isfinite(pixels->depth_factor) && pixels->depth_factor != 1.0)
        fprintf(out, ", times %.4g", pixels->depth_factor);
    fprintf(out, "; %d pixels with another Z are left out\n", pixels->depth_count);
}

static void print_used(const struct neph_fit *fit, FILE *out)
{
    const struct neph_fit_pixels *pixels = fit->pixels;
    fprintf(out, "fitted: %d of %d pixels (left out: %d with edges, %d far from all others)",
            pixels->count, pixels->frame_count, pixels->edge_count, fit->outlier_count);
    if (pixels->has[NEPH_FIT_RADIANCE])
        fprintf(out, "; R G B, rms residual %.2g %%", 100.0 * fit->rms[NEPH_FIT_RADIANCE]);
    if (pixels->has[NEPH_FIT_TRANSMITTANCE])
        fprintf(out, "; %s, %.2g %%", pixels->transmittance,
                100.0 * fit->rms[NEPH_FIT_TRANSMITTANCE]);
    fprintf(out, "\n");
    if (!isnan(fit->transfer_rms[NEPH_FIT_ENCODED]))
        fprintf(out,
                "rms residual of R G B as linear light %.2g %%, sRGB codes %.2g %%, decoded "
                "%.2g %%\n",
                100.0 * fit->transfer_rms[NEPH_FIT_LINEAR],
                100.0 * fit->transfer_rms[NEPH_FIT_ENCODED],
                100.0 * fit->transfer_rms[NEPH_FIT_DECODED]);
}

void neph_fit_print(const struct neph_fit_answer *answer, bool is_short, FILE *out)
{
    const struct neph_fit *fit = answer->fit;
    char text[2048];
    neph_fit_sentence(answer, text, sizeof(text));
    fprintf(out, "%s\n", text);
    if (is_short)
        return;
    print_row("", "scene", "frame", "factor", "95 % interval", out);
    print_estimates(fit, out);
    print_held(fit, out);
    print_ends(fit, out);
    print_fixed(fit, out);
    print_depth(fit->pixels, out);
    print_used(fit, out);
}

/* ---- JSON ------------------------------------------------------------------------------------ */

static json_t *estimate_json(const struct neph_fit_estimate *found)
{
    const double value = found->is_determined ? found->value : NAN;
    return json_pack("{s:b, s:b, s:o, s:o}", "free", found->is_free, "determined",
                     found->is_determined, "value", neph_json_number(value), "interval",
                     found->is_free && found->is_determined
                         ? json_pack("[f, f]", found->low, found->high)
                         : json_null());
}

static json_t *unknown_json(const struct neph_fit *fit, enum neph_fit_unknown unknown)
{
    json_t *json = estimate_json(&fit->best.list[unknown]);
    neph_json_set(&json, "held", json_boolean(fit->is_held[unknown]));
    neph_json_set(&json, "with_held", estimate_json(&fit->held.list[unknown]));
    const char *why = neph_fit_obstacle(fit->scene, unknown);
    neph_json_set(&json, "scene", neph_json_number(own_value(fit->scene, unknown)));
    neph_json_set(&json, "held_because", why ? json_string(why) : json_null());
    return json;
}

static json_t *extinction_json(const struct neph_fit *fit)
{
    json_t *json = unknown_json(fit, NEPH_FIT_EXTINCTION);
    neph_json_set(&json, "at_least", json_real(fit->extinction_min));
    neph_json_set(&json, "at_most", neph_json_number(fit->extinction_max));
    return json;
}

static json_t *mistakes_json(const struct neph_fit *fit, const struct neph_fit_verdict *verdict)
{
    const struct neph_fit_estimate *list = fit->held.list;
    json_t *json = json_array();
    for (int i = 0; i < verdict->count; i++) {
        const struct neph_fit_mistake *mistake = &verdict->list[i];
        const double e = list[NEPH_FIT_EXTINCTION].is_determined ? mistake->found[0] : NAN,
                     a = list[NEPH_FIT_ALBEDO].is_determined ? mistake->found[1] : NAN;
        neph_json_add(&json, json_pack("{s:s, s:s, s:f, s:f, s:o, s:o}", "name", mistake->name,
                                       "detail", mistake->detail, "extinction", mistake->extinction,
                                       "albedo", mistake->albedo, "found_extinction",
                                       neph_json_number(e), "found_albedo", neph_json_number(a)));
    }
    return json;
}

static json_t *pixels_json(const struct neph_fit *fit)
{
    const struct neph_fit_pixels *pixels = fit->pixels;
    return json_pack("{s:i, s:i, s:i, s:i, s:i, s:b, s:b, s:o}", "fitted", pixels->count, "frame",
                     pixels->frame_count, "edges", pixels->edge_count, "other_depth",
                     pixels->depth_count, "outliers", fit->outlier_count, "depth_compared",
                     pixels->has_depth, "depth_is_distance", pixels->depth_is_distance,
                     "depth_factor", neph_json_number(pixels->depth_factor));
}

static json_t *transfer_json(const struct neph_fit *fit)
{
    json_t *json = json_pack("{s:s, s:b}", "name", transfer_keys[fit->transfer], "sure",
                             fit->is_transfer_sure);
    for (int t = 0; t < NEPH_FIT_TRANSFER_COUNT; t++)
        neph_json_set(&json, transfer_keys[t], neph_json_number(fit->transfer_rms[t]));
    return json;
}

json_t *neph_fit_json(const struct neph_fit_answer *answer)
{
    const struct neph_fit *fit = answer->fit;
    const struct neph_fit_verdict *verdict = answer->verdict;
    const bool *has = fit->pixels->has;
    char text[2048];
    neph_fit_sentence(answer, text, sizeof(text));
    return json_pack(
        "{s:s, s:b, s:o, s:s?, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "sentence", text, "agrees",
        verdict->agrees, "mistakes", mistakes_json(fit, verdict), "falloff_mistake",
        verdict->falloff, "transfer", transfer_json(fit), "extinction", extinction_json(fit),
        "albedo", unknown_json(fit, NEPH_FIT_ALBEDO), "asymmetry",
        unknown_json(fit, NEPH_FIT_ASYMMETRY), "falloff", unknown_json(fit, NEPH_FIT_FALLOFF),
        "extinction_times_albedo", estimate_json(&fit->best.scattering), "rms",
        json_pack("{s:o, s:o}", "radiance", neph_json_number(has[0] ? fit->rms[0] : NAN),
                  "transmittance", neph_json_number(has[1] ? fit->rms[1] : NAN)),
        "pixels", pixels_json(fit));
}
