/* SPDX-License-Identifier: MIT */
#include "harness/night/environment.h"

#include "metrics/significance.h"

#include <math.h>
#include <string.h>

bool neph_is_same_environment(const char *a, const char *b)
{
    static const char revision[] = ", revision ";
    const size_t length = sizeof(revision) - 1;
    while (*a && *a == *b) {
        if (strncmp(a, revision, length) == 0 && strncmp(b, revision, length) == 0) {
            a += length + strspn(a + length, "0123456789");
            b += length + strspn(b + length, "0123456789");
        } else {
            a++, b++;
        }
    }
    return *a == *b;
}

/* The note of an environment, which describes the samples of a frame: the text between the first ";
 * " and "; against". Returns its length. */
static size_t find_note(const char *environment, const char **note)
{
    const char *against = strstr(environment, "; against ");
    *note = strstr(environment, "; ");
    if (!*note || *note == against)
        return 0;
    return against ? (size_t)(against - *note) : strlen(*note);
}

static bool has_same_note(const char *a, const char *b)
{
    const char *note_a, *note_b;
    const size_t length = find_note(a, &note_a);
    return length == find_note(b, &note_b) && (length == 0 || strncmp(note_a, note_b, length) == 0);
}

static bool is_more_than_chance(const struct neph_series *series, double difference,
                                double before_error, double alpha)
{
    if (series->kind == NEPH_SERIES_FIXED)
        return true;
    const double error = hypot(series->standard_error, before_error);
    return isfinite(error) && error > 0.0 && neph_normal_p(difference / error) <= 0.1 * alpha;
}

bool neph_is_worse_elsewhere(const struct neph_series *series, const char *environment,
                             double before, double before_error, const char *environment_before,
                             double alpha, struct neph_judgement *change)
{
    const double difference = series->tonight - before;
    const bool worse = series->is_signed ? fabs(series->tonight) > fabs(before) : difference > 0.0;
    *change = (struct neph_judgement){.baseline = before,
                                      .change = difference / fmax(fabs(before), series->unit),
                                      .floor = neph_series_rule(series->kind)->least};
    return series->kind != NEPH_SERIES_TIMED && isfinite(difference) && worse &&
           fabs(change->change) >= change->floor &&
           (series->kind == NEPH_SERIES_FIXED || has_same_note(environment, environment_before)) &&
           is_more_than_chance(series, difference, before_error, alpha);
}
