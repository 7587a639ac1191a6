/* SPDX-License-Identifier: MIT */
#include "tests/metrics/bench_program.h"

#include "base/child.h"
#include "base/exr.h"
#include "base/files.h"
#include "base/path.h"
#include "base/scratch.h"
#include "tests/metrics/synthetic.h"

#include <errno.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <unistd.h>

enum { DISTINCT = 4 };

static enum neph_status write_frame(const struct bench_program *bench, int frame, const char *path,
                                    struct neph_diag *diag)
{
    const struct synthetic what = {.width_px = bench->width_px,
                                   .height_px = bench->height_px,
                                   .frame = frame,
                                   .seed = (uint64_t)frame + 1,
                                   .is_test = true};
    struct neph_image *image = NULL;
    enum neph_status status = synthetic_create(&what, &image, diag);
    if (!status)
        status = neph_exr_write_plain(path, image, diag);
    neph_image_destroy(image);
    return status;
}

static enum neph_status make_frames(const struct bench_program *bench, const char *folder,
                                    struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < bench->frame_count && !status; i++) {
        const struct neph_path path = neph_path_format("%s/f.%04d.exr", folder, i);
        const struct neph_path first = neph_path_format("f.%04d.exr", i % DISTINCT);
        if (i < DISTINCT)
            status = write_frame(bench, i, path.text, diag);
        else if (symlink(first.text, path.text) != 0)
            status = neph_fail(diag, NEPH_ERR_IO, "cannot link '%s': %s", path.text,
                               strerror(errno));
    }
    return status;
}

static double seconds(struct timeval time)
{
    return (double)time.tv_sec + 1e-6 * (double)time.tv_usec;
}

static enum neph_status run_there(const struct bench_program *bench, const char *program,
                                  const char *folder, struct bench_program_cost *cost,
                                  struct neph_diag *diag)
{
    const struct neph_path still = neph_path_format("%s/f.0000.exr", folder);
    const char *const argv[] = {program, "flicker", "-q", "-r", still.text, folder, NULL};
    const struct neph_child_params params = {.argv = argv};
    struct neph_child_result result = {.wall_s = 0.0};
    struct rusage before, after;
    enum neph_status status = make_frames(bench, folder, diag);
    getrusage(RUSAGE_CHILDREN, &before);
    if (!status)
        status = neph_child_run(&params, &result, diag);
    getrusage(RUSAGE_CHILDREN, &after);
    if (!status)
        *cost = (struct bench_program_cost){
            .wall_s = result.wall_s,
            .user_s = seconds(after.ru_utime) - seconds(before.ru_utime),
            .system_s = seconds(after.ru_stime) - seconds(before.ru_stime)};
    return status;
}

enum neph_status bench_program_run(const struct bench_program *bench,
                                   struct bench_program_cost *cost, struct neph_diag *diag)
{
    char *program = neph_path_beside_program("../neph");
    const char *parent = getenv("TMPDIR") ? getenv("TMPDIR") : "/tmp";
    struct neph_scratch *scratch = NULL;
    enum neph_status status = program ? NEPH_OK
                                      : neph_fail(diag, NEPH_ERR_UNAVAILABLE,
                                                  "there is no neph beside the folder of this "
                                                  "program");
    if (!status)
        status = neph_scratch_create(parent, "neph-bench-", &scratch, diag);
    if (!status)
        status = run_there(bench, program, neph_scratch_path(scratch), cost, diag);
    neph_scratch_destroy(scratch);
    free(program);
    return status;
}
