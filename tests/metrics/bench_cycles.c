/* SPDX-License-Identifier: MIT
 *
 * Accuracy of `cycles` on 10,000 pixels and 256 frames: planted periods 2..32, sines and general
 * waveforms, in phase and not, single, in pairs and under noise of the same RMS; and coloured noise
 * without a planted period. Run by hand: minutes to hours.
 *
 *   bench_cycles one [SEED]            each period by itself
 *   bench_cycles pairs [SEED [COUNT]]  this number of pairs (all)
 *   bench_cycles none [COUNT [SIDE]]   seeds of each noise (100), SIDE^2 pixels (100^2)
 */
#include "tests/metrics/cycle_signal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE_PX = 100, FRAMES = 256 };

struct tally {
    int trials, missed, wrong, extra;
    double worst;
};

static void look(const struct cycle_plan *plan, int side_px, struct tally *tally)
{
    const struct cycle_result result = cycle_try(plan, side_px, side_px, FRAMES);
    tally->trials++;
    tally->missed += result.missed > 0;
    tally->wrong += result.worst > 0.02;
    tally->extra += result.extra > 0;
    tally->worst = fmax(tally->worst, result.worst);
    if (result.missed || result.worst > 0.02 || result.extra)
        printf("  %d %d general %d phases %d noise %g seed %llu: missed %d worst %.3f (period %d) "
               "extra %d (period %d)\n",
               plan->periods[0], plan->periods[1], plan->is_general, plan->random_phase,
               plan->noise, (unsigned long long)plan->seed, result.missed, result.worst,
               result.worst_period, result.extra, result.extra_period);
    fflush(stdout);
}

static void print(const char *name, const struct tally *tally)
{
    printf("%-44s trials %4d  missed %3d  RMS off by > 2 %%: %3d (worst %.2f %%)  more found %3d\n",
           name, tally->trials, tally->missed, tally->wrong, 100.0 * tally->worst, tally->extra);
    fflush(stdout);
}

static struct cycle_plan plan_of(int kind, int a, int b, uint64_t seed)
{
    return (struct cycle_plan){.periods = {a, b},
                               .is_general = kind & 1,
                               .random_phase = (kind & 2) != 0,
                               .rms = 0.02,
                               .noise = kind & 4 ? 0.02 : 0.0,
                               .seed = seed};
}

static void name_kind(int kind, const char *what, char name[64])
{
    snprintf(name, 64, "%s, %s, %s%s", what, kind & 1 ? "general" : "sine",
             kind & 2 ? "random phase" : "in phase", kind & 4 ? ", noise" : "");
}

static void bench_one(uint64_t seed)
{
    for (int kind = 0; kind < 8; kind++) {
        struct tally tally = {0};
        char name[64];
        for (int period = 2; period <= 32; period++) {
            const struct cycle_plan plan = plan_of(kind, period, 0, seed + (uint64_t)period);
            look(&plan, SIDE_PX, &tally);
        }
        name_kind(kind, "one", name);
        print(name, &tally);
    }
}

static void bench_pairs(uint64_t seed, int count)
{
    for (int kind = 0; kind < 8; kind++) {
        struct tally tally = {0};
        char name[64];
        uint64_t random = seed;
        for (int i = 0; i < 465 && i < count; i++) {
            int at = count < 465 ? (int)neph_test_uniform(&random, 0.0, 465.0) : i, a = 2;
            while (at >= 32 - a)
                at -= 32 - a++;
            const struct cycle_plan plan = plan_of(kind, a, a + 1 + at, seed + (uint64_t)i);
            look(&plan, SIDE_PX, &tally);
        }
        name_kind(kind, "pairs", name);
        print(name, &tally);
    }
}

static void bench_none(int count, int side_px)
{
    for (int colour = 0; colour < CYCLE_COLOUR_COUNT; colour++) {
        struct tally tally = {0};
        for (int i = 0; i < count; i++) {
            const struct cycle_plan plan = {
                .noise = 0.02, .colour = (enum cycle_colour)colour, .seed = 1000 + (uint64_t)i};
            look(&plan, side_px, &tally);
        }
        print(cycle_colour_names[colour], &tally);
    }
}

int main(int argc, char **argv)
{
    const char *what = argc > 1 ? argv[1] : "one";
    const long first = argc > 2 ? atol(argv[2]) : 0, second = argc > 3 ? atol(argv[3]) : 465;
    if (strcmp(what, "one") == 0)
        bench_one((uint64_t)first + 1);
    else if (strcmp(what, "pairs") == 0)
        bench_pairs((uint64_t)first + 1, (int)second);
    else if (strcmp(what, "none") == 0)
        bench_none(first ? (int)first : 100, argc > 3 ? (int)second : SIDE_PX);
    else
        return EXIT_FAILURE;
    return EXIT_SUCCESS;
}
