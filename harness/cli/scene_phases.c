/* SPDX-License-Identifier: MIT */
#include "harness/cli/scene_phases.h"

#include "scenes/phase_colour.h"
#include "scenes/phase_table.h"

static struct neph_rgb find_mean_cosines(const struct neph_phase *phase)
{
    double of_channels[3];
    for (int j = 0; j < 3; j++) {
        const struct neph_phase own = neph_phase_channel(phase, j);
        of_channels[j] = neph_phase_mean_cosine(&own);
    }
    return (struct neph_rgb){of_channels[0], of_channels[1], of_channels[2]};
}

/* The rows of a table, and what its values integrate to. */
static void print_table(const struct neph_phase_table *table)
{
    printf(", %d rows", table->count);
    if (!table->channels[0])
        printf(" of integral %.6g, normalised to 1", table->given_integral);
    else
        printf(" of integrals %.6g, %.6g, %.6g, normalised to 1",
               table->channels[0]->given_integral, table->channels[1]->given_integral,
               table->channels[2]->given_integral);
}

void neph_print_phases(const struct neph_scene *scene)
{
    for (int m = 0; m < scene->medium_count; m++) {
        const struct neph_medium *medium = &scene->media[m];
        const struct neph_rgb g = find_mean_cosines(&medium->phase);
        char name[128];
        neph_phase_describe(&medium->phase, name, sizeof(name));
        printf("phase %-5d %s, asymmetry %.6g", m, name, g.r);
        if (neph_phase_is_coloured(&medium->phase))
            printf(" %.6g %.6g", g.g, g.b);
        if (medium->phase.table)
            print_table(medium->phase.table);
        printf("; albedo %g %g %g\n", medium->albedo.r, medium->albedo.g, medium->albedo.b);
    }
}

static json_t *integrals_json(const struct neph_phase_table *table)
{
    json_t *all = json_array();
    for (int j = 0; j < 3; j++) {
        const struct neph_phase_table *own = table && table->channels[j] ? table->channels[j]
                                                                         : table;
        neph_json_add(&all, own ? json_real(own->given_integral) : json_null());
    }
    return all;
}

json_t *neph_phases_json(const struct neph_scene *scene)
{
    json_t *all = json_array();
    for (int m = 0; m < scene->medium_count; m++) {
        const struct neph_medium *medium = &scene->media[m];
        const struct neph_rgb g = find_mean_cosines(&medium->phase);
        neph_json_add(&all,
                      json_pack("{s:s, s:[f, f, f], s:[f, f, f], s:o}", "kind",
                                neph_phase_words[medium->phase.kind], "mean_cosine", g.r, g.g, g.b,
                                "albedo", medium->albedo.r, medium->albedo.g, medium->albedo.b,
                                "given_integral", integrals_json(medium->phase.table)));
    }
    return all;
}
