/* SPDX-License-Identifier: MIT
 *
 * Other people's programs: a folder to run them in, how much they may write there, what they may
 * leave there, and which build of one is installed. A number of its version alone does not tell two
 * builds apart whose pictures differ in their last bits.
 */
#ifndef NEPH_HARNESS_ENGINES_PROGRAM_H
#define NEPH_HARNESS_ENGINES_PROGRAM_H

#include "base/child_result.h"
#include "base/scratch.h"
#include "base/usage.h"
#include "harness/engines/engine.h"
#include "harness/packages.h"

/* A folder in TMPDIR for a program that wants to write; what a run that was killed here has left
 * there is removed. `prefix` is that of all such folders. Free with neph_scratch_destroy(). */
enum neph_status neph_program_home(const char *prefix, struct neph_scratch **home,
                                   struct neph_diag *diag);

/* What a program may write into a folder for a picture of that size, beside what was `before` in
 * it: 512 MiB and 256 bytes a pixel (64 floats) on the disk, 16384 files and folders, and 16 MiB of
 * text. */
struct neph_child_limits neph_program_limits(const struct neph_usage *before, int width_px,
                                             int height_px);

/* Whether a program has left a file: something is at `path`. NEPH_ERR_ENGINE: it is a folder, a
 * pipe, a socket, a device, or a symbolic link that leads to none of these or to nothing. */
enum neph_status neph_program_left(const char *path, bool *is_left, struct neph_diag *diag);

/* The status of a program whose file could not be read with `status`: what is wrong with the file
 * is the program's failure, NEPH_ERR_ENGINE; an interrupt and a lack of memory are not. */
enum neph_status neph_program_status(enum neph_status status);

/* Ask `program` (in PATH) with --version, confined to a folder of its own (base/confine.h).
 * `*text` is what it says from the first `name` on, for the caller to free; `build` a digest of
 * that text and of the program's file. What a run that was killed here has left in TMPDIR is
 * removed. NEPH_ERR_IO: TMPDIR cannot be written. Else what neph_child_run() says. */
enum neph_status neph_program_ask(const char *program, const char *name, double time_limit_s,
                                  char **text, char build[NEPH_BUILD_SIZE], struct neph_diag *diag);

/* An external renderer that neph knows. */
struct neph_external_renderer {
    const char *program;  /* the name of its file: "povray" */
    const char *variable; /* of the environment, that names it in place of PATH: "NEPH_POVRAY" */
    bool is_list;         /* the variable may name several, separated by colons */
    const char *name;     /* "POV-Ray": --version says it, a space and the version */
    struct neph_packages packages; /* that have it */
    const char *data_file; /* a file of neph's that it is run with (neph_data_path()), or NULL */

    /* The version in what it says of itself; false: it does not tell it. */
    bool (*parse_version)(const char *text, char version[64]);
    const char *const *measured; /* what versions start with that were measured, NULL-terminated */
    const char *laws;            /* of which versions these are, in words: "3.4.x, 4.3.x" */
    int oldest[2];               /* version; those before it are refused */
    const char *const *environment; /* of its processes: neph_child_params.environment */
};

/* The programs that a renderer's variable may name, at most. */
enum { NEPH_EXTERNAL_PROGRAMS_MAX = 8 };

/* How many programs the variable names, 1 where it is not set or names none. */
int neph_external_count(const struct neph_external_renderer *renderer);

/* The path of program `index`, from 0 on, for the caller to free: by the variable, which names a
 * program or the folder that holds it, or by PATH where the variable is not set or empty. NULL:
 * `missing` says why. */
char *neph_external_find(const struct neph_external_renderer *renderer, int index, char *missing,
                         size_t missing_size);

/* What `index` says is its version. */
bool neph_external_version(const struct neph_external_renderer *renderer, int index,
                           char version[64]);

/* Whether version "3.4.1" is not below major.minor. */
bool neph_version_is_from(const char *version, int major, int minor);

/* neph_engine.probe of an engine on such a renderer on the CPU. A version that is newer than the
 * oldest and was not measured is available, with a warning. */
void neph_external_probe(const struct neph_external_renderer *renderer, int index,
                         struct neph_engine_info *info);

/* NEPH_ERR_UNAVAILABLE with the command that installs it as the hint, and `why` as the message, or
 * with NULL the message that is there. */
enum neph_status neph_external_missing(const struct neph_external_renderer *renderer,
                                       const char *why, struct neph_diag *diag);

/* Run it for a shot in `folder`, where it may write for a frame of the shot's size; argv[0] is the
 * path of the program. Errors as of neph_child_run(). */
enum neph_status neph_external_run(const struct neph_external_renderer *renderer,
                                   const char *const argv[], const char *folder, const char *log,
                                   const struct neph_shot *shot, struct neph_child_result *result,
                                   struct neph_diag *diag);

/* Whether it has left an image: NEPH_ERR_ENGINE says that it has not, which one ("depth ", or ""
 * where there is one) and where its `log` is. */
enum neph_status neph_external_left(const struct neph_external_renderer *renderer, const char *path,
                                    const char *which, const char *log, struct neph_diag *diag);

/* NEPH_ERR_ENGINE when an image that it has left is not of the shot's size. */
enum neph_status neph_external_size(const struct neph_external_renderer *renderer,
                                    const char *which, int width_px, int height_px,
                                    const struct neph_shot *shot, struct neph_diag *diag);

/* Why a scene could not be adapted to a renderer called `name`, in front of what it cannot. */
enum neph_status neph_external_cannot(const char *name, enum neph_status status,
                                      const struct neph_diag *why, struct neph_diag *diag);

#endif
