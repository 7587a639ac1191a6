/* SPDX-License-Identifier: MIT
 *
 * The reference of sequences of real-time methods: one definition for static and moving scenes.
 *
 * The reference of a frame is the marcher at the same scene state, with the steps and the lighting
 * of the test's model. Its radiance is the mean of 16 rays per pixel (renderer/march_average.h),
 * without dither and history: the limit that every anti-aliasing of this model approaches, without
 * favouring one. A second sequence has only the centre rays. At an edge the centre rays have a
 * staircase where the average has partial coverage; a metric against both shows how much depends on
 * that.
 */
#ifndef NEPH_HARNESS_STUDY_REFERENCE_H
#define NEPH_HARNESS_STUDY_REFERENCE_H

#include "harness/compare/sequence.h"
#include "harness/progress.h"
#include "harness/run/job.h"

enum { NEPH_REFERENCE_RAYS_PER_PX = 16 };

/* The two sequences of a reference. */
enum neph_reference_rays {
    NEPH_REFERENCE_AVERAGED, /* the reference, 16 rays per pixel */
    NEPH_REFERENCE_CENTRE,   /* one ray per pixel, for comparison */
    NEPH_REFERENCE_RAYS_COUNT,
};

/* Initialise with {0}; free with neph_reference_finish(). */
struct neph_reference {
    /* Files of the store: one for a static scene, else one for each frame of the test. */
    struct neph_sequence frames[NEPH_REFERENCE_RAYS_COUNT];
    char *text;                   /* "march, 16 rays a pixel, 32 steps"; owned */
    char *settings;               /* of the averaged frames; owned */
    char key[NEPH_HASH_HEX_SIZE]; /* hash of everything that the frames depend on */
    int picture_count;            /* distinct frames of both sequences, rendered or from the store
                                     */
    struct neph_cost cost;        /* of all these frames, at the time of their rendering */
};

/* The job of one reference frame, with the scene, size and frame of the test; `info` gets the probe
 * of its engine. NEPH_ERR_USAGE as of neph_settings_set(). */
enum neph_status neph_reference_job(const struct neph_job *test, enum neph_reference_rays rays,
                                    struct neph_engine_info *info, struct neph_job *job,
                                    struct neph_diag *diag);

/* Number of distinct frames of a reference, over both sequences: equal scene states share a frame.
 */
int neph_reference_frame_count(const struct neph_scene *scene, int first, int frame_count);

/* The key of a reference, without rendering. */
enum neph_status neph_reference_key(const struct neph_job *test, int frame_count,
                                    char key[NEPH_HASH_HEX_SIZE], struct neph_diag *diag);

/* Finds in the store, or renders, the reference for `frame_count` frames, starting at the test's
 * first frame. The test's engine is a real-time method. Each frame is a step of the progress.
 * Errors: NEPH_ERR_UNAVAILABLE, NEPH_ERR_UNSUPPORTED, NEPH_ERR_ENGINE as of neph_outcome_check();
 * NEPH_ERR_INTERRUPTED: finished frames stay in the store. */
enum neph_status neph_reference_make(const struct neph_job *test, int frame_count,
                                     struct neph_store *store, struct neph_progress *progress,
                                     struct neph_reference *reference, struct neph_diag *diag);

void neph_reference_finish(struct neph_reference *reference);

/* Adds the times of a frame, and takes the larger memory. */
void neph_cost_add(struct neph_cost *sum, const struct neph_cost *cost);

#endif
