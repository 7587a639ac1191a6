/* SPDX-License-Identifier: MIT */
#include "harness/engines/process_cost.h"

#include "base/clock.h"

#include <math.h>
#include <sys/resource.h>

struct neph_stopwatch neph_stopwatch_start(void)
{
    return (struct neph_stopwatch){neph_wall_s(), neph_cpu_s()};
}

struct neph_cost neph_measure_process_cost(struct neph_stopwatch start, double render_s)
{
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    const double wall_s = neph_wall_s() - start.wall_s;
    return (struct neph_cost){
        .render_s = isnan(render_s) ? wall_s : render_s,
        .wall_s = wall_s,
        .cpu_s = neph_cpu_s() - start.cpu_s,
        .peak_memory_bytes = (int64_t)usage.ru_maxrss * 1024,
    };
}

enum neph_status neph_finish_process_frame(enum neph_status status, struct neph_image *image,
                                           struct neph_stopwatch start, double render_s,
                                           struct neph_image **frame, struct neph_cost *cost)
{
    if (status) {
        neph_image_destroy(image);
        return status;
    }
    *cost = neph_measure_process_cost(start, render_s);
    *frame = image;
    return NEPH_OK;
}
