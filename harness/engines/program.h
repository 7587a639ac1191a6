/* SPDX-License-Identifier: MIT
 *
 * External programs: a folder to run in, limits of their output, checks of their files, and the
 * installed build. A version number is not enough: two builds of one version may differ in the last
 * bits of their images.
 */
#ifndef NEPH_HARNESS_ENGINES_PROGRAM_H
#define NEPH_HARNESS_ENGINES_PROGRAM_H

#include "base/child_result.h"
#include "base/scratch.h"
#include "base/usage.h"
#include "harness/engines/engine.h"
#include "harness/packages.h"

/* Create a folder in TMPDIR for a program that writes files; remove folders there that killed
 * runs have left. `prefix` is the common prefix of all such folders. Free with
 * neph_scratch_destroy(). */
enum neph_status neph_program_make_folder(const char *prefix, struct neph_scratch **home,
                                          struct neph_diag *diag);

/* Limits of a program's output for a frame of that size, in addition to the usage `before`: 512 MiB
 * and 256 bytes per pixel (64 floats) on disk, 16384 files and folders, and 16 MiB of text. */
struct neph_child_limits neph_program_limits(const struct neph_usage *before, int width_px,
                                             int height_px);

/* Whether the program has written a file at `path`. NEPH_ERR_ENGINE: the path is a folder, pipe,
 * socket or device, or a symbolic link to no regular file. */
enum neph_status neph_program_has_file(const char *path, bool *is_left, struct neph_diag *diag);

/* The status of a program whose file could not be read with `status`: a fault of the file is the
 * program's failure, NEPH_ERR_ENGINE; an interrupt and short memory keep their status. */
enum neph_status neph_program_status(enum neph_status status);

/* Run `program` (found in PATH) with --version, confined to a folder of its own (base/confine.h).
 * `*text` is its output from the first `name` on, for the caller to free; `build` is a digest of
 * that text and of the program's file. Folders of killed runs in TMPDIR are removed. NEPH_ERR_IO:
 * TMPDIR is not writable. Other errors as of neph_child_run(). */
enum neph_status neph_program_query_version(const char *program, const char *name,
                                            double time_limit_s, char **text,
                                            char build[NEPH_BUILD_SIZE], struct neph_diag *diag);

/* An external renderer that neph supports. */
struct neph_external_renderer {
    const char *program;  /* file name of the program: "povray" */
    const char *variable; /* environment variable that overrides PATH: "NEPH_POVRAY" */
    bool is_list;         /* the variable may name several programs, separated by colons */
    const char *name;     /* "POV-Ray": in the output of --version, followed by a space and the
                           * version */
    struct neph_packages packages; /* packages that contain it */
    const char *data_file; /* data file of neph that it is run with (neph_data_path()), or NULL */

    /* Find the version in the output of --version; false: not found. */
    bool (*parse_version)(const char *text, char version[64]);
    const char *const *measured;    /* prefixes of the measured versions, NULL-terminated */
    const char *laws;               /* the measured versions as text: "3.4.x, 4.3.x" */
    int oldest[2];                  /* oldest accepted version */
    const char *const *environment; /* environment of its processes:
                                     * neph_child_params.environment */
};

/* Limit of programs in a renderer's variable. */
enum { NEPH_EXTERNAL_PROGRAMS_MAX = 8 };

/* The number of programs in the variable; 1 if it is not set or empty. */
int neph_external_count(const struct neph_external_renderer *renderer);

/* The path of program `index`, from 0 on, for the caller to free. The variable names a program or
 * its folder; if it is not set or empty, the program is found in PATH. NULL: `missing` has the
 * reason. */
char *neph_external_find(const struct neph_external_renderer *renderer, int index, char *missing,
                         size_t missing_size);

/* The version that program `index` reports. */
bool neph_external_version(const struct neph_external_renderer *renderer, int index,
                           char version[64]);

/* Whether a version such as "3.4.1" is at least major.minor. */
bool neph_version_is_from(const char *version, int major, int minor);

/* neph_engine.probe for an engine that runs such a renderer on the CPU. A version above the oldest
 * that was not measured is available, with a warning. */
void neph_external_probe(const struct neph_external_renderer *renderer, int index,
                         struct neph_engine_info *info);

/* Fail with NEPH_ERR_UNAVAILABLE. The hint is the install command; the message is `why`, or with
 * NULL the existing message. */
enum neph_status neph_external_fail_missing(const struct neph_external_renderer *renderer,
                                            const char *why, struct neph_diag *diag);

/* Run the program for a shot in `folder`, with write limits for the shot's size; argv[0] is its
 * path. Errors as of neph_child_run(). */
enum neph_status neph_external_run(const struct neph_external_renderer *renderer,
                                   const char *const argv[], const char *folder, const char *log,
                                   const struct neph_shot *shot, struct neph_child_result *result,
                                   struct neph_diag *diag);

/* Check that the program has written an image. NEPH_ERR_ENGINE names the image (`which`: "depth ",
 * or "" for a single image) and the `log`. */
enum neph_status neph_external_check_image(const struct neph_external_renderer *renderer,
                                           const char *path, const char *which, const char *log,
                                           struct neph_diag *diag);

/* Check that an image has the shot's size; else NEPH_ERR_ENGINE. */
enum neph_status neph_external_check_size(const struct neph_external_renderer *renderer,
                                          const char *which, int width_px, int height_px,
                                          const struct neph_shot *shot, struct neph_diag *diag);

/* Put the renderer's `name` before the reason why a scene could not be adapted. */
enum neph_status neph_external_fail_scene(const char *name, enum neph_status status,
                                          const struct neph_diag *why, struct neph_diag *diag);

#endif
