/* SPDX-License-Identifier: MIT */
#include "renderer/phase_tables.h"

#include "scenes/phase_colour.h"
#include "scenes/phase_table.h"

#include <math.h>

enum { HEAD = 3, ROW = 3, FORMULA_ROWS = NEPH_TABULATED_ROWS_MAX - 1 };

/* The device's list of kinds ends with the table. */
#define IN_SHADERS(number, NAME, name) +1
_Static_assert((int)NEPH_PHASE_TABLE == NEPH_PHASES_IN_SHADERS(IN_SHADERS), "shaders/phase.glsl");
_Static_assert(FORMULA_ROWS % 2 == 1, "a row in the middle");

static int count_rows(const struct neph_phase *phase)
{
    return phase->table ? phase->table->count : FORMULA_ROWS;
}

size_t neph_gpu_phase_table_size(const struct neph_phase *phase)
{
    const size_t one = HEAD + ROW * (size_t)count_rows(phase);
    return neph_phase_is_in_shaders(phase->kind) ? 0
           : neph_phase_is_coloured(phase)       ? 4 * one
                                                 : one;
}

/* From 0 to 1 in FORMULA_ROWS / 2 steps: to 0.05 in steps in proportion to the value, for the peak,
 * and then evenly, for the valley of a Draine lobe at 90 degrees. */
static double spread(int i)
{
    enum { PEAK = 2400, EVEN = FORMULA_ROWS / 2 - PEAK };
    static const double peak = 0.05, growth = 17.7; /* the first step is 7e-12 */
    if (i <= PEAK)
        return peak * expm1(growth * i / PEAK) / expm1(growth);
    return peak + (1.0 - peak) * (i - PEAK) / EVEN;
}

static void write_row(double versine, double per_sr, double within, float *values)
{
    values[0] = (float)versine;
    values[1] = (float)per_sr;
    values[2] = (float)within;
}

static void write_table(const struct neph_phase_table *table, float *values)
{
    for (int i = 0; i < table->count; i++)
        write_row(table->nodes[i].versine, table->nodes[i].per_sr, table->nodes[i].within,
                  values + ROW * i);
}

static double find_formula_versine(int i)
{
    return i <= FORMULA_ROWS / 2 ? spread(i) : 2.0 - spread(FORMULA_ROWS - 1 - i);
}

/* The light of all rows, which is 1 except for the error of the straight lines between them. */
static double sum_formula(const struct neph_phase *phase)
{
    double light = 0.0;
    for (int i = 1; i < FORMULA_ROWS; i++) {
        const double near = find_formula_versine(i - 1), far = find_formula_versine(i);
        light += M_PI * (far - near) *
                 (neph_phase_per_sr(phase, 1.0 - near) + neph_phase_per_sr(phase, 1.0 - far));
    }
    return light;
}

static void write_formula(const struct neph_phase *phase, float *values)
{
    const double whole = sum_formula(phase);
    double within = 0.0, before_per_sr = 0.0, before = 0.0;
    for (int i = 0; i < FORMULA_ROWS; i++) {
        const double versine = find_formula_versine(i);
        const double per_sr = neph_phase_per_sr(phase, 1.0 - versine) / whole;
        if (i > 0)
            within += M_PI * (versine - before) * (per_sr + before_per_sr);
        write_row(versine, per_sr, within, values + ROW * i);
        before = versine;
        before_per_sr = per_sr;
    }
}

static void write_one(const struct neph_phase *phase, float next, float *values)
{
    values[0] = (float)count_rows(phase);
    values[1] = (float)neph_phase_mean_cosine(phase);
    values[2] = next;
    if (phase->table)
        write_table(phase->table, values + HEAD);
    else
        write_formula(phase, values + HEAD);
}

void neph_gpu_phase_table_write(const struct neph_phase *phase, float *values)
{
    const bool is_coloured = neph_phase_is_coloured(phase);
    const size_t one = HEAD + ROW * (size_t)count_rows(phase);
    write_one(phase, is_coloured ? (float)one : 0.0f, values);
    for (int channel = 0; channel < 3 && is_coloured; channel++) {
        const struct neph_phase own = neph_phase_channel(phase, channel);
        write_one(&own, 0.0f, values + (size_t)(1 + channel) * one);
    }
}
