/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/shared/check_reference.h"

#include <math.h>
#include <stdlib.h>

/* One step of the filter, from one target to another. */
struct step {
    const struct reference *cpu;
    int input, output, apart;
};

/* False where there is no valid history. */
static bool fetch(const struct step *step, int x, int y, float volume[4])
{
    float state[4];
    cpu_fetch_half(step->cpu, RT_HISTORY_STATE, x, y, state);
    cpu_fetch_half(step->cpu, step->input, x, y, volume);
    return state[0] > 0.0f && cpu_is_valid(volume);
}

static double luma(const float volume[4])
{
    return (double)volume[0] + 2.0 * (double)volume[1] + (double)volume[2];
}

static double deviation(const struct step *step, int x, int y)
{
    double lumas[9], mean = 0.0, across = 0.0, down = 0.0, squares = 0.0;
    bool counts[9];
    int count = 0;
    for (int i = 0; i < 9; i++) {
        float volume[4];
        counts[i] = fetch(step, x + i % 3 - 1, y + i / 3 - 1, volume);
        lumas[i] = luma(volume);
        count += counts[i];
    }
    for (int i = 0; i < 9; i++)
        mean += counts[i] ? lumas[i] / count : 0.0;
    for (int i = 0; i < 9 && count == 9; i++) {
        across += (i % 3 - 1) * lumas[i] / 6.0;
        down += (i / 3 - 1) * lumas[i] / 6.0;
    }
    for (int i = 0; i < 9; i++)
        if (counts[i])
            squares += pow(lumas[i] - mean - (i % 3 - 1) * across - (i / 3 - 1) * down, 2.0);
    return sqrt(squares / (count == 9 ? 6 : count));
}

static double falling(double difference, double unit)
{
    return difference > 0.0 ? exp(-difference / fmax(unit, 1e-20)) : 1.0;
}

static double depth_m(const struct step *step, int x, int y)
{
    float value[4];
    cpu_fetch_half(step->cpu, RT_HALF_DEPTH, x, y, value);
    return value[0];
}

static void filter(const struct step *step, int x, int y)
{
    static const double spline[3] = {6.0 / 16.0, 4.0 / 16.0, 1.0 / 16.0};
    float own[4], other[4];
    double sum[4] = {0.0}, weights = 0.0;
    if (!fetch(step, x, y, own)) {
        cpu_put_half(step->cpu, step->output, x, y, own);
        return;
    }
    const double luma_unit = 4.0 * deviation(step, x, y);
    const double depth_unit = (double)0.1f * depth_m(step, x, y);
    for (int v = -2; v <= 2; v++)
        for (int u = -2; u <= 2; u++) {
            const int at_x = x + step->apart * u, at_y = y + step->apart * v;
            if (!fetch(step, at_x, at_y, other))
                continue;
            const double weight = spline[abs(u)] * spline[abs(v)] *
                                  falling(fabs(luma(other) - luma(own)), luma_unit) *
                                  falling(fabs(depth_m(step, at_x, at_y) - depth_m(step, x, y)),
                                          depth_unit);
            weights += weight;
            for (int c = 0; c < 4; c++)
                sum[c] += weight * other[c];
        }
    for (int c = 0; c < 4; c++)
        own[c] = (float)(sum[c] / weights);
    cpu_put_half(step->cpu, step->output, x, y, own);
}

void cpu_atrous(const struct reference *cpu, int apart)
{
    const struct step step = {
        .cpu = cpu,
        .input = apart == 1   ? RT_HISTORY
                 : apart == 2 ? RT_HISTORY_BEFORE
                              : RT_KEPT_RAY,
        .output = apart == 2 ? RT_KEPT_RAY : RT_HISTORY_BEFORE,
        .apart = apart,
    };
    for (int y = 0; y < (int)cpu->view->half_size_px[1]; y++)
        for (int x = 0; x < (int)cpu->view->half_size_px[0]; x++)
            filter(&step, x, y);
}
