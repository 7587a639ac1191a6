/* SPDX-License-Identifier: MIT */
#include "harness/engines/sky_passes.h"

#include <math.h>

void neph_sky_passes_add(const struct neph_sky_times *times, struct neph_flight_cost *cost)
{
    const struct {
        const char *name;
        double gpu_s;
    } lines[] = {{"sky of the air", times->air_s},
                 {"sky views", times->view_s},
                 {"sky shadows", times->shade_s},
                 {"sky before", times->aerial_s}};
    for (size_t i = 0; i < sizeof(lines) / sizeof(lines[0]); i++) {
        cost->passes[cost->pass_count].name = lines[i].name;
        cost->passes[cost->pass_count].gpu_s = lines[i].gpu_s;
        cost->passes[cost->pass_count++].traffic_bytes = NAN;
    }
}
