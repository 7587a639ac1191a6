/* SPDX-License-Identifier: MIT */
#include "scenes/phase_table.h"

#include "base/files.h"
#include "scenes/hash_text.h"
#include "scenes/phase.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- values --- */

/* The last node whose `versine`, or with `by_light` whose `within`, is at most `value`; not the
 * last one of all. */
static int find_node(const struct neph_phase_table *table, bool by_light, double value)
{
    int low = 0, high = table->count - 1;
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        const struct neph_phase_node *node = &table->nodes[middle];
        if ((by_light ? node->within : node->versine) <= value)
            low = middle;
        else
            high = middle;
    }
    return low;
}

static double slope(const struct neph_phase_node *node)
{
    return (node[1].per_sr - node[0].per_sr) / (node[1].versine - node[0].versine);
}

double neph_phase_table_per_sr(const struct neph_phase_table *table, double versine)
{
    const double v = fmin(2.0, fmax(0.0, versine));
    const struct neph_phase_node *node = &table->nodes[find_node(table, false, v)];
    const double part = (v - node[0].versine) / (node[1].versine - node[0].versine);
    return (1.0 - part) * node[0].per_sr + part * node[1].per_sr;
}

/* Within an interval the light grows as 2 pi (p t + s t^2 / 2), with the value p and slope s at its
 * start: the root t in the form without cancellation. */
double neph_phase_table_versine(const struct neph_phase_table *table, double u)
{
    const double light = 1.0 - u;
    const struct neph_phase_node *node = &table->nodes[find_node(table, true, light)];
    const double rest = fmax(0.0, light - node->within) / (2.0 * M_PI);
    const double under = node->per_sr * node->per_sr + 2.0 * slope(node) * rest;
    const double divisor = node->per_sr + sqrt(fmax(0.0, under));
    const double t = divisor > 0.0 ? 2.0 * rest / divisor : 0.0;
    return fmin(node[1].versine, node->versine + t);
}

/* --- Legendre moments --- */

/* Per degree the integral of the integral of P_l, from cosine -1: the integral of P_l is Q_l =
 * (P_(l+1) - P_(l-1)) / (2 l + 1), and that of Q_l is (Q_(l+1) - Q_(l-1)) / (2 l + 1). */
static void integrate_twice(double cosine, double twice[NEPH_TABULATED_MOMENTS + 1])
{
    enum { TERMS = NEPH_TABULATED_MOMENTS + 3 };
    double p[TERMS], q[TERMS];
    p[0] = 1.0;
    p[1] = cosine;
    for (int l = 2; l < TERMS; l++)
        p[l] = ((2.0 * l - 1.0) * cosine * p[l - 1] - (l - 1.0) * p[l - 2]) / l;
    q[0] = cosine + 1.0;
    for (int l = 1; l + 1 < TERMS; l++)
        q[l] = (p[l + 1] - p[l - 1]) / (2.0 * l + 1.0);
    for (int l = 1; l <= NEPH_TABULATED_MOMENTS; l++)
        twice[l] = (q[l + 1] - q[l - 1]) / (2.0 * l + 1.0);
}

/* Integrated by parts, only the slopes are left, since Q_l is 0 at both ends. */
static void find_moments(const struct neph_phase_table *table, double *moments)
{
    double twice[2][NEPH_TABULATED_MOMENTS + 1];
    moments[0] = 1.0;
    integrate_twice(1.0, twice[0]);
    for (int i = 0; i + 1 < table->count; i++) {
        const double *near = twice[i % 2], *far = twice[(i + 1) % 2];
        const double factor = 2.0 * M_PI * slope(&table->nodes[i]);
        integrate_twice(1.0 - table->nodes[i + 1].versine, twice[(i + 1) % 2]);
        for (int l = 1; l <= NEPH_TABULATED_MOMENTS; l++)
            moments[l] += factor * (near[l] - far[l]);
    }
}

/* --- making a table --- */

/* The value of a row, and its angle after that of the row before. */
static enum neph_status check_row(const double *angles_deg, double value, int i,
                                  struct neph_diag *diag)
{
    const double step_deg = i > 0 ? angles_deg[i] - angles_deg[i - 1] : 1.0;
    if (!(value >= 0.0 && value <= 1e12))
        return neph_fail(diag, NEPH_ERR_INPUT,
                         "the phase function is %g at %g degrees, not in 0..1e12", value,
                         angles_deg[i]);
    if (!(angles_deg[i] >= 0.0 && angles_deg[i] <= 180.0))
        return neph_fail(diag, NEPH_ERR_INPUT, "%g degrees are not in 0..180", angles_deg[i]);
    if (i > 0 && !((angles_deg[1] < angles_deg[0] ? -step_deg : step_deg) > 0.0))
        return neph_fail(diag, NEPH_ERR_INPUT, "%g degrees after %g: the angles are not in order",
                         angles_deg[i], angles_deg[i - 1]);
    return NEPH_OK;
}

static enum neph_status check_count(int count, struct neph_diag *diag)
{
    if (count < 2 || count > NEPH_TABULATED_ROWS_MAX)
        return neph_fail(diag, NEPH_ERR_INPUT, "a phase function of %d rows, not 2 to %d", count,
                         NEPH_TABULATED_ROWS_MAX);
    return NEPH_OK;
}

static enum neph_status check_rows(int count, const double *angles_deg, const double *values,
                                   struct neph_diag *diag)
{
    const bool falls = angles_deg[1] < angles_deg[0];
    for (int i = 0; i < count; i++) {
        const enum neph_status status = check_row(angles_deg, values[i], i, diag);
        if (status)
            neph_prefix(diag, "row %d: ", i + 1);
        if (status)
            return status;
    }
    const double first_deg = angles_deg[falls ? count - 1 : 0],
                 last_deg = angles_deg[falls ? 0 : count - 1];
    if (first_deg != 0.0 || last_deg != 180.0)
        return neph_fail(diag, NEPH_ERR_INPUT,
                         "the angles reach from %g to %g degrees, not from 0 to 180", first_deg,
                         last_deg);
    return NEPH_OK;
}

static enum neph_status check_integral(double integral, struct neph_diag *diag)
{
    static const double tolerance = 0.01; /* tables of one degree and three digits reach it */
    if (fabs(integral - 1.0) <= tolerance || fabs(integral / (4.0 * M_PI) - 1.0) <= tolerance)
        return NEPH_OK;
    const enum neph_status status = neph_fail(diag, NEPH_ERR_INPUT,
                                              "the integral of the phase function over the sphere "
                                              "is %.6g, neither 1 nor 4 pi within 1 %%",
                                              integral);
    if (integral > 0.0)
        neph_hint(diag,
                  "multiplied by %.6g its values are a phase function; a peak that the rows "
                  "do not resolve needs more of them",
                  1.0 / integral);
    return status;
}

/* Sets `within` of the nodes, and returns the whole light. */
static double sum_light(struct neph_phase_table *table)
{
    double light = 0.0;
    for (int i = 0; i < table->count; i++) {
        struct neph_phase_node *node = &table->nodes[i];
        if (i > 0)
            light += M_PI * (node->per_sr + node[-1].per_sr) * (node->versine - node[-1].versine);
        node->within = light;
    }
    return light;
}

enum neph_status neph_phase_table_make(int count, const double *angles_deg, const double *values,
                                       struct neph_arena *arena,
                                       const struct neph_phase_table **table,
                                       struct neph_diag *diag)
{
    enum neph_status status = check_count(count, diag);
    if (!status)
        status = check_rows(count, angles_deg, values, diag);
    if (status)
        return status;
    struct neph_phase_table *made = neph_arena_allocate(arena, 1, sizeof(*made));
    struct neph_phase_node *nodes = neph_arena_allocate(arena, (size_t)count, sizeof(*nodes));
    double *moments = neph_arena_allocate(arena, NEPH_TABULATED_MOMENTS + 1, sizeof(*moments));
    if (!made || !nodes || !moments)
        return neph_fail_memory(diag);
    *made = (struct neph_phase_table){.count = count, .nodes = nodes, .moments = moments};
    for (int i = 0; i < count; i++) {
        const int from = angles_deg[1] < angles_deg[0] ? count - 1 - i : i;
        const double half_sine = sin(0.5 * angles_deg[from] * M_PI / 180.0);
        nodes[i] = (struct neph_phase_node){2.0 * half_sine * half_sine, values[from], 0.0};
        if (i > 0 && !(nodes[i].versine > nodes[i - 1].versine))
            return neph_fail(diag, NEPH_ERR_INPUT, "angles of %g and less degrees are one angle",
                             angles_deg[from]);
    }
    made->given_integral = sum_light(made);
    status = check_integral(made->given_integral, diag);
    if (status)
        return status;
    for (int i = 0; i < count; i++)
        nodes[i].per_sr /= made->given_integral;
    sum_light(made);
    find_moments(made, moments);
    *table = made;
    return NEPH_OK;
}

/* The values of a channel, or with channel 3 the mean of the three normalised channels. */
static enum neph_status make_channel(int count, const double *angles_deg, const double *values,
                                     const double integrals[3], int channel,
                                     struct neph_arena *arena,
                                     const struct neph_phase_table **table, struct neph_diag *diag)
{
    static const char *const names[] = {"red", "green", "blue", "the mean"};
    double *own = malloc((size_t)count * sizeof(*own));
    if (!own)
        return neph_fail_memory(diag);
    for (int i = 0; i < count; i++) {
        own[i] = channel < 3 ? values[3 * i + channel] : 0.0;
        for (int j = 0; j < 3 && channel == 3; j++)
            own[i] += values[3 * i + j] / integrals[j] / 3.0;
    }
    const enum neph_status status = neph_phase_table_make(count, angles_deg, own, arena, table,
                                                          diag);
    free(own);
    if (status)
        neph_prefix(diag, "%s: ", names[channel]);
    return status;
}

enum neph_status neph_phase_table_make_coloured(int count, const double *angles_deg,
                                                const double *values, struct neph_arena *arena,
                                                const struct neph_phase_table **table,
                                                struct neph_diag *diag)
{
    const struct neph_phase_table *made[4];
    double integrals[3];
    enum neph_status status = check_count(count, diag);
    for (int channel = 0; channel < 4 && !status; channel++) {
        status = make_channel(count, angles_deg, values, integrals, channel, arena, &made[channel],
                              diag);
        if (!status && channel < 3)
            integrals[channel] = made[channel]->given_integral;
    }
    struct neph_phase_table *mean = status ? NULL : neph_arena_allocate(arena, 1, sizeof(*mean));
    if (!status && !mean)
        status = neph_fail_memory(diag);
    if (status)
        return status;
    *mean = *made[3];
    for (int j = 0; j < 3; j++)
        mean->channels[j] = made[j];
    *table = mean;
    return NEPH_OK;
}

/* --- a file --- */

enum { FILE_BYTES_MAX = 16 << 20 };

enum { NUMBERS_MAX = 4 }; /* an angle and three channels */

/* The numbers of a line, one more than there may be at most; 0 for a line without a row, -1 for
 * anything else. */
static int read_line(const char *line, double numbers[NUMBERS_MAX + 1])
{
    int count = 0;
    char *end;
    while (count <= NUMBERS_MAX) {
        line += strspn(line, " \t\r,;");
        if (*line == '\0' || *line == '#')
            return count;
        const size_t length = strcspn(line, " \t\r,;#");
        numbers[count++] = strtod(line, &end);
        if (end != line + length || strspn(line, "0123456789+-.eE") < length)
            return -1;
        line = end;
    }
    return count;
}

struct rows {
    int count, line;
    int channels; /* 1 or 3; 0: not known yet */
    double angles_deg[NEPH_TABULATED_ROWS_MAX];
    double values[3 * NEPH_TABULATED_ROWS_MAX]; /* the channels of a row together */
};

/* "angle_deg,value" */
static bool is_heading(const char *line)
{
    return isalpha((unsigned char)line[strspn(line, " \t\"")]);
}

static enum neph_status add_line(const char *line, struct rows *rows, struct neph_diag *diag)
{
    double numbers[NUMBERS_MAX + 1];
    const int channels = read_line(line, numbers) - 1;
    rows->line++;
    if (channels == -1 || (rows->line == 1 && is_heading(line)))
        return NEPH_OK;
    if (channels != 1 && channels != 3)
        return neph_fail(diag, NEPH_ERR_INPUT,
                         "'%.60s' is not an angle in degrees and a value of the phase function, or "
                         "three values: red, green, blue",
                         line);
    if (rows->channels > 0 && rows->channels != channels)
        return neph_fail(diag, NEPH_ERR_INPUT,
                         "'%.60s' has %d values after an angle, the rows before it %d", line,
                         channels, rows->channels);
    if (rows->count == NEPH_TABULATED_ROWS_MAX)
        return neph_fail(diag, NEPH_ERR_INPUT, "more than %d rows", NEPH_TABULATED_ROWS_MAX);
    rows->channels = channels;
    rows->angles_deg[rows->count] = numbers[0];
    memcpy(rows->values + channels * rows->count, numbers + 1, (size_t)channels * sizeof(*numbers));
    enum neph_status status = NEPH_OK;
    for (int channel = 0; channel < channels && !status; channel++)
        status = check_row(rows->angles_deg, numbers[1 + channel], rows->count, diag);
    rows->count++;
    return status;
}

/* Splits `text` at its line ends. */
static enum neph_status read_rows(char *text, struct rows *rows, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (char *line = text, *next; line && !status; line = next) {
        next = strchr(line, '\n');
        if (next)
            *next++ = '\0';
        status = add_line(line, rows, diag);
    }
    return status;
}

enum neph_status neph_phase_table_read(const char *path, struct neph_arena *arena,
                                       const struct neph_phase_table **table,
                                       struct neph_diag *diag)
{
    char *text = NULL;
    size_t size = 0;
    enum neph_status status = neph_file_read(path, FILE_BYTES_MAX, &text, &size, diag);
    if (status)
        return status;
    struct rows *rows = calloc(1, sizeof(*rows));
    int line = 0;
    if (!rows)
        status = neph_fail_memory(diag);
    else if (strlen(text) != size)
        status = neph_fail(diag, NEPH_ERR_INPUT, "this is not a text");
    else
        status = read_rows(text, rows, diag);
    if (status && rows)
        line = rows->line;
    if (!status)
        status = (rows->channels == 3 ? neph_phase_table_make_coloured : neph_phase_table_make)(
            rows->count, rows->angles_deg, rows->values, arena, table, diag);
    free(rows);
    free(text);
    if (status && line > 0)
        neph_prefix(diag, "'%s' line %d: ", path, line);
    else if (status)
        neph_prefix(diag, "'%s': ", path);
    return status;
}

bool neph_phase_table_is_same(const struct neph_phase_table *a, const struct neph_phase_table *b)
{
    if (a == b || !a || !b)
        return a == b;
    bool is_same = a->count == b->count &&
                   memcmp(a->nodes, b->nodes, (size_t)a->count * sizeof(*a->nodes)) == 0;
    for (int j = 0; j < 3; j++)
        is_same = is_same && neph_phase_table_is_same(a->channels[j], b->channels[j]);
    return is_same;
}

void neph_phase_table_hash(const struct neph_phase_table *table, FILE *text)
{
    for (int i = 0; i < table->count; i++)
        neph_put_three(text, "phase_row", table->nodes[i].versine, table->nodes[i].per_sr, 0.0);
    for (int j = 0; j < 3 && table->channels[j]; j++)
        neph_phase_table_hash(table->channels[j], text);
}

/* --- the kind --- */

static double per_sr(const struct neph_phase *phase, double cosine)
{
    return neph_phase_table_per_sr(phase->table, 1.0 - cosine);
}

static double versine(const struct neph_phase *phase, double u)
{
    return neph_phase_table_versine(phase->table, u);
}

static double moment(const struct neph_phase *phase, int degree)
{
    return degree <= NEPH_TABULATED_MOMENTS ? phase->table->moments[degree] : NAN;
}

static double mean_cosine(const struct neph_phase *phase)
{
    return phase->table->moments[1];
}

/* Without trials of its own: neph_phases_check() tabulates other kinds. */
const struct neph_phase_row neph_phase_table = {
    .title = "tabulated",
    .parameters = NEPH_PHASE_PARAMETER_TABLE,
    .per_sr = per_sr,
    .versine = versine,
    .mean_cosine = mean_cosine,
    .moment = moment,
};
