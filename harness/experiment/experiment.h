/* SPDX-License-Identifier: MIT
 *
 * An experiment is a verb that renders scenes, measures them and publishes its results. It consists
 * of a table of options and of functions on its request. neph_experiment_main() does the work that
 * all experiments share. Each experiment has a file of its own.
 */
#ifndef NEPH_HARNESS_EXPERIMENT_EXPERIMENT_H
#define NEPH_HARNESS_EXPERIMENT_EXPERIMENT_H

#include "harness/document/publication.h"
#include "harness/engines/vulkan_device.h"
#include "harness/options.h"
#include "harness/run/job.h"
#include "harness/run/store.h"

/* The resources that neph_experiment_main() lends to a run. */
struct neph_experiment_run {
    /* In OUTPUT/store; NULL without --output, and where the run opens its own stores
     * (opens_stores). */
    struct neph_store *store;
    struct neph_shared_device *device;
    const char *output; /* the folder of --output, which exists */
    bool quiet;
};

struct neph_experiment {
    const struct neph_cli_syntax *syntax;
    size_t request_size; /* of the request, which begins with a struct neph_cli_shared */
    /* A verb may be several experiments with one request type: choose one of them, which needs
     * neither syntax nor request_size. NULL: the verb is one experiment. */
    const struct neph_experiment *(*choose)(const void *request);
    const char *chart;        /* file name of the chart in OUTPUT; NULL: none */
    const char *document;     /* file name of the JSON there; NULL: JSON only on stdout */
    const char *csv;          /* file name of the CSV there without --csv; NULL: no CSV */
    const char *const *files; /* more file names there, ends with NULL; listed before those above;
                               * or NULL */
    bool opens_stores;        /* the run opens its own stores, below OUTPUT */
    /* Read the inputs that the options name, such as scenes, before anything is written. NULL:
     * nothing to do. */
    enum neph_status (*prepare)(void *request, struct neph_diag *diag);
    /* For --jobs: change a prepared request to its part `index`, from 0 on. No two parts render the
     * same frames. The request is a shallow copy: its owner frees it. False: there is no such part.
     * NULL: the experiment has no parts. */
    bool (*part)(void *request, int index);
    /* Measure, and write the forms of the publication; a form that is NULL is not wanted. */
    enum neph_status (*run)(void *request, const struct neph_experiment_run *run,
                            struct neph_publication *publication, struct neph_diag *diag);
    /* Free the memory of prepare() and run(); always called. NULL: nothing to do. */
    void (*finish)(void *request);
};

/* The `part` function of an experiment with one part for each operand. */
bool neph_experiment_operand(void *request, int index);

/* Engine settings and size of the frames of a real-time method. */
struct neph_experiment_frames {
    const char *words; /* "PRESET+KEY=VALUE+..." of realtime, or of another engine (engines.h) */
    int steps;         /* along every view ray */
    struct neph_cli_size size;
    int seed; /* from 1 on */
};

/* Make the job of the first frame; `info` is filled here and borrowed by the job.
 * NEPH_ERR_UNAVAILABLE: the engine is missing. NEPH_ERR_UNSUPPORTED: the engine cannot render the
 * scene. Other errors as of neph_engine_parse_words(). */
enum neph_status neph_experiment_job(const struct neph_experiment_run *run,
                                     const struct neph_scene *scene,
                                     const struct neph_experiment_frames *frames,
                                     struct neph_engine_info *info, struct neph_job *job,
                                     struct neph_diag *diag);

/* Run an experiment: parse the command line, prepare, open the store, run, publish. Errors of these
 * steps are returned. With --jobs N worker processes run the parts first; their publications are
 * dropped, but their frames are in the store. The run in this process then finds all frames there,
 * so the results do not depend on N. */
enum neph_status neph_experiment_main(const struct neph_experiment *experiment, int argc,
                                      char **argv, struct neph_diag *diag);

#endif
