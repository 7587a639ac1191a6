/* SPDX-License-Identifier: MIT
 *
 * What sequences of a shortcut are measured against; one policy, at rest and moving, whatever sun
 * and wind do.
 *
 * The reference of a picture is the march of the same moment with the steps and the lighting of the
 * test's own model, its radiance averaged over 16 rays a pixel (renderer/march_average.h), without
 * dither and without history: what any anti-aliasing of this model is after, and nobody's in
 * particular. Beside it stand the centre rays alone, which have the staircase of an edge where the
 * average has its share: how much a number owes to that, the number against them says.
 */
#ifndef NEPH_HARNESS_STUDY_REFERENCE_H
#define NEPH_HARNESS_STUDY_REFERENCE_H

#include "harness/compare/sequence.h"
#include "harness/progress.h"
#include "harness/run/job.h"

enum { NEPH_REFERENCE_RAYS_PER_PX = 16 };

/* Which pictures of a reference. */
enum neph_reference_rays {
    NEPH_REFERENCE_AVERAGED, /* the reference */
    NEPH_REFERENCE_CENTRE,   /* what it is held beside */
    NEPH_REFERENCE_RAYS_COUNT,
};

/* Start from {0}; free with _finish. */
struct neph_reference {
    /* Files of the store: one for all where nothing moves, else as many as the test has. */
    struct neph_sequence frames[NEPH_REFERENCE_RAYS_COUNT];
    char *text;                   /* "march, 16 rays a pixel, 32 steps"; owned */
    char *settings;               /* of the averaged ones; owned */
    char key[NEPH_HASH_HEX_SIZE]; /* of all that the pictures depend on */
    int picture_count;            /* that differ, of both kinds: rendered or taken from the store */
    struct neph_cost cost;        /* of all these pictures, when they were rendered */
};

/* The job of one picture of the reference, with the scene, size and frame of the test, and what it
 * is told of its engine. NEPH_ERR_USAGE as of neph_settings_set(). */
enum neph_status neph_reference_job(const struct neph_job *test, enum neph_reference_rays rays,
                                    struct neph_engine_info *info, struct neph_job *job,
                                    struct neph_diag *diag);

/* How many pictures the reference of so many frames takes: moments that are the same share one. */
int neph_reference_picture_count(const struct neph_scene *scene, int first, int frame_count);

/* What a reference's key is, without a picture. */
enum neph_status neph_reference_key(const struct neph_job *test, int frame_count,
                                    char key[NEPH_HASH_HEX_SIZE], struct neph_diag *diag);

/* Find in the store, or render, the reference for `frame_count` pictures from the first of `test`
 * on; the test's engine is a shortcut (engine.h). Each picture is a step of progress. Errors:
 * NEPH_ERR_UNAVAILABLE, NEPH_ERR_UNSUPPORTED, NEPH_ERR_ENGINE as of neph_outcome_check();
 * NEPH_ERR_INTERRUPTED: what is finished stays in the store. */
enum neph_status neph_reference_make(const struct neph_job *test, int frame_count,
                                     struct neph_store *store, struct neph_progress *progress,
                                     struct neph_reference *reference, struct neph_diag *diag);

void neph_reference_finish(struct neph_reference *reference);

/* Add the cost of a frame: times, and the larger memory. */
void neph_cost_add(struct neph_cost *sum, const struct neph_cost *cost);

#endif
