/* SPDX-License-Identifier: MIT */
#include "harness/progress.h"

#include "base/clock.h"

#include <stdio.h>
#include <unistd.h>

struct neph_progress neph_progress_start(bool quiet, int total)
{
    return (struct neph_progress){.quiet = quiet,
                                  .terminal = isatty(STDERR_FILENO) == 1,
                                  .total = total,
                                  .start_s = neph_wall_s()};
}

void neph_progress_begin(const struct neph_progress *progress, const char *what)
{
    if (progress->quiet || !progress->terminal)
        return;
    const double elapsed_s = neph_wall_s() - progress->start_s;
    fprintf(stderr, "\r\033[K[%d/%d] %s", progress->done + 1, progress->total, what);
    if (progress->done > 0)
        fprintf(stderr, " (about %.0f s left)",
                elapsed_s / progress->done * (progress->total - progress->done));
    fflush(stderr);
}

void neph_progress_step(struct neph_progress *progress, const char *what, const char *outcome,
                        double seconds)
{
    progress->done++;
    if (progress->quiet || progress->terminal)
        return;
    fprintf(stderr, "[%d/%d] %s: %s, %.1f s\n", progress->done, progress->total, what, outcome,
            seconds);
}

void neph_progress_tick(struct neph_progress *progress, const char *what)
{
    static const double every_s = 10.0;
    progress->done++;
    const double elapsed_s = neph_wall_s() - progress->start_s;
    if (progress->quiet || progress->terminal || elapsed_s - progress->told_s < every_s)
        return;
    progress->told_s = elapsed_s;
    fprintf(stderr, "[%d/%d] %s (about %.0f s left)\n", progress->done, progress->total, what,
            elapsed_s / progress->done * (progress->total - progress->done));
}

void neph_progress_end(const struct neph_progress *progress)
{
    if (!progress->quiet && progress->terminal)
        fprintf(stderr, "\r\033[K");
}
