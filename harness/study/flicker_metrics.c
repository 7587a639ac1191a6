/* SPDX-License-Identifier: MIT
 *
 * Tables of the flicker study: sequences, displays, metrics.
 */
#include "harness/study/flicker_metrics.h"

#include <string.h>

/* Fails to compile when a kind is added, as the table of sequences needs a row for it. */
_Static_assert(NEPH_STUDY_CAPTURES == 4, "a new kind");

static const char *const of_flicker[] = {"seen", "cycles", "flicker", "error", NULL};
static const char *const of_lag[] = {"lag", NULL};
static const char *const of_follow[] = {"follow", NULL};

/* NEPH_STUDY_EVENT_FRAME and neph_variant_periods as settings; a test compares them. */
static const char *const at_event[] = {"lag.step_frame=32", NULL};
static const char *const at_periods[] = {"follow.period_1=16", "follow.period_2=32",
                                         "follow.period_3=64", NULL};

const struct neph_study_capture neph_study_captures[NEPH_STUDY_CAPTURES] = {
    [NEPH_STUDY_FLICKER] = {"flicker", NEPH_VARIANT_KIND_COUNT, 0, of_flicker, NULL},
    [NEPH_STUDY_STEP] = {"step", NEPH_VARIANT_SUN_STEP, 80, of_lag, at_event},
    [NEPH_STUDY_SINE] = {"sine", NEPH_VARIANT_SUN_SINE, 128, of_follow, at_periods},
    [NEPH_STUDY_CUT] = {"cut", NEPH_VARIANT_CAMERA_CUT, 64, of_lag, at_event},
};

/* Film, television and games, each at a desk and in a living room. */
const struct neph_study_display neph_study_displays[NEPH_STUDY_DISPLAYS] = {
    {30.0, 60.0}, {24.0, 60.0}, {60.0, 60.0}, {30.0, 30.0}, {24.0, 30.0}, {60.0, 30.0},
};

int neph_study_display_count(double frame_rate_hz)
{
    return frame_rate_hz > 0.0 ? 2 : NEPH_STUDY_DISPLAYS;
}

struct neph_study_display neph_study_display_at(double frame_rate_hz, int index)
{
    return frame_rate_hz > 0.0
               ? (struct neph_study_display){frame_rate_hz, index == 0 ? 60.0 : 30.0}
               : neph_study_displays[index];
}

const char *const neph_study_eye_extractors[] = {"seen", NULL};

/* Least values: 1/400 of an 8-bit step for display values; 1/1000 of the threshold, or of the
 * pixels, for the eye; 1/100 of a frame for times. */
const struct neph_study_metric neph_study_metrics[] = {
    {"Flicker seen, contrast over threshold", NEPH_STUDY_FLICKER, "seen_contrast", "all", 1, 1e-3,
     .of_the_eye = true},
    {"Flicker seen at depth edges, contrast over threshold", NEPH_STUDY_FLICKER, "seen_contrast",
     "depth_edge", 1, .least = 1e-3, .of_the_eye = true},
    {"Share of the pixels whose flicker is seen [1/1000]", NEPH_STUDY_FLICKER, "seen_share", "all",
     1e3, .least = 1e-3, .of_the_eye = true},
    {"All that repeats every 4 frames, RMS at depth edges [1/1000 of white]", NEPH_STUDY_FLICKER,
     "repeats_4", "depth_edge", 1e3, .least = 1e-5, .at_most = "cycle_std"},
    {"All that repeats every 7 frames, RMS at depth edges [1/1000 of white]", NEPH_STUDY_FLICKER,
     "repeats_7", "depth_edge", 1e3, .least = 1e-5, .at_most = "cycle_std"},
    {"All that repeats every 8 frames, RMS at depth edges [1/1000 of white]", NEPH_STUDY_FLICKER,
     "repeats_8", "depth_edge", 1e3, .least = 1e-5, .at_most = "cycle_std"},
    {"Neither cycle nor drift, RMS at depth edges [1/1000 of white]", NEPH_STUDY_FLICKER,
     "cycle_noise", "depth_edge", 1e3, .least = 1e-5},
    {"Four-frame flicker at depth edges [1/1000 of white], 95th percentile", NEPH_STUDY_FLICKER,
     "a4_p95", "depth_edge", 1e3, .least = 1e-5, .alone = "reference_a4_p95"},
    {"Standard deviation over time at depth edges [1/1000 of white], 95th percentile",
     NEPH_STUDY_FLICKER, "std_p95", "depth_edge", 1e3, .least = 1e-5, .alone = "reference_std_p95"},
    {"Relative RMSE [1/1000]", NEPH_STUDY_FLICKER, "rel_rmse", "all", 1e3, .least = 1e-6,
     .name = "error"},
    {"Half-life after a step of the sun [frames], median", NEPH_STUDY_STEP, "half_life_p50", "all",
     1, .least = 1e-2, .name = "half-life"},
    {"Half-life after a step of the sun [frames], 95th percentile", NEPH_STUDY_STEP,
     "half_life_p95", "all", 1, .least = 1e-2, .never_share = "share_unsettled"},
    {"Frames to 10 % after a step of the sun, 95th percentile", NEPH_STUDY_STEP, "frames_to_10_p95",
     "all", 1, .least = 1e-2, .never_share = "share_unsettled_10"},
    {"Lag behind a sun that swings in 16 frames [frames], median", NEPH_STUDY_SINE,
     "follow_lag_1_p50", "all", 1, .least = 1e-2},
    {"Lag behind a sun that swings in 32 frames [frames], median", NEPH_STUDY_SINE,
     "follow_lag_2_p50", "all", 1, .least = 1e-2, .name = "lag"},
    {"Lag behind a sun that swings in 64 frames [frames], median", NEPH_STUDY_SINE,
     "follow_lag_3_p50", "all", 1, .least = 1e-2},
    {"Ghosts after a cut of the camera [area times frames]", NEPH_STUDY_CUT, "ghost_area_frames",
     "all", 1, .least = 1e-2, .name = "ghosts"},
    {.title = NULL},
};

int neph_study_capture_find(const char *name)
{
    int id = 0;
    while (id < NEPH_STUDY_CAPTURES && strcmp(name, neph_study_captures[id].name) != 0)
        id++;
    return id;
}

int neph_study_metric_count(void)
{
    int count = 0;
    while (neph_study_metrics[count].title)
        count++;
    return count;
}

int neph_study_metric_find(const char *metric, const char *mask)
{
    int index = 0;
    while (strcmp(neph_study_metrics[index].metric, metric) != 0 ||
           strcmp(neph_study_metrics[index].mask, mask) != 0)
        index++; /* a test checks that every metric that is searched for exists */
    return index;
}

int neph_study_find_headline(void)
{
    int index = 0;
    while (!neph_study_metrics[index].of_the_eye)
        index++;
    return index;
}

int neph_study_find_lag(void)
{
    int index = 0;
    while (neph_study_metrics[index].take != NEPH_STUDY_STEP)
        index++;
    return index;
}
