/* SPDX-License-Identifier: MIT
 *
 * An experiment is a verb that renders scenes, measures them and publishes its results: options and
 * functions on its request. neph_experiment_main() does what all of them have in common. One file
 * an experiment.
 */
#ifndef NEPH_HARNESS_EXPERIMENT_EXPERIMENT_H
#define NEPH_HARNESS_EXPERIMENT_EXPERIMENT_H

#include "harness/document/publication.h"
#include "harness/engines/vulkan_device.h"
#include "harness/options.h"
#include "harness/run/job.h"
#include "harness/run/store.h"

/* What a run is lent. */
struct neph_experiment_run {
    /* In OUTPUT/store; NULL without --output, and where the run opens its own (opens_stores). */
    struct neph_store *store;
    struct neph_shared_device *device;
    const char *output; /* the folder of --output, which is there */
    bool quiet;
};

struct neph_experiment {
    const struct neph_cli_syntax *syntax;
    size_t request_size; /* of the request, which begins with a struct neph_cli_shared */
    /* A verb may be several experiments on one request: choose one, which needs neither syntax nor
     * size. NULL: the verb is one. */
    const struct neph_experiment *(*choose)(const void *request);
    const char *chart;        /* the chart's name in OUTPUT; NULL: none */
    const char *document;     /* the JSON's name there; NULL: it has none but on stdout */
    const char *csv;          /* the name of the CSV there, without --csv; NULL: it has none */
    const char *const *files; /* further names there, before those above; ends with NULL; or NULL */
    bool opens_stores;        /* the run opens its own, below OUTPUT */
    /* Read what options name, scenes for one, before anything is written. NULL: nothing to do. */
    enum neph_status (*prepare)(void *request, struct neph_diag *diag);
    /* For --jobs: change a prepared request to its part `index`, from 0 on, which renders other
     * frames than the other parts. Not a deep copy: what it owns stays. False: there are no more
     * parts. NULL: the experiment has no parts. */
    bool (*part)(void *request, int index);
    /* Measure, and write the forms of the publication; those that are NULL are not wanted. */
    enum neph_status (*run)(void *request, const struct neph_experiment_run *run,
                            struct neph_publication *publication, struct neph_diag *diag);
    /* Free what they made of the request; called in any case. NULL: nothing to do. */
    void (*finish)(void *request);
};

/* The `part` of an experiment whose parts are its operands. */
bool neph_experiment_operand(void *request, int index);

/* What the frames of a real-time method are rendered with. */
struct neph_experiment_frames {
    const char *words; /* "PRESET+KEY=VALUE+..." of realtime, or another engine's (engines.h) */
    int steps;         /* of every view ray */
    struct neph_cli_size size;
    int seed; /* 1 .. */
};

/* The job of the first frame; `info` is for the job to borrow. NEPH_ERR_UNAVAILABLE;
 * NEPH_ERR_UNSUPPORTED: the engine cannot render the scene; else as of neph_engine_words(). */
enum neph_status neph_experiment_job(const struct neph_experiment_run *run,
                                     const struct neph_scene *scene,
                                     const struct neph_experiment_frames *frames,
                                     struct neph_engine_info *info, struct neph_job *job,
                                     struct neph_diag *diag);

/* Parse the command line, prepare, open the store, run, publish. Errors as of these. With --jobs N
 * workers run the parts first and drop what these publish: their frames are in the store then, and
 * the run in this process finds them there. So its results do not depend on N. */
enum neph_status neph_experiment_main(const struct neph_experiment *experiment, int argc,
                                      char **argv, struct neph_diag *diag);

#endif
