/* SPDX-License-Identifier: MIT
 *
 * The form `volume` of a medium: voxels from a file, and their placement. Private to scenes/.
 */
#ifndef NEPH_SCENES_LOAD_VOLUME_H
#define NEPH_SCENES_LOAD_VOLUME_H

#include "scenes/medium_kind.h"
#include "scenes/volume_file.h"

struct neph_written_volume {
    struct neph_written_medium common;
    const char *file, *grid, *radius_grid;
    double radius_unit_um;
    struct neph_radius_band radius_band;
    const char *axes, *value_unit;   /* NULL: not given */
    int time_index;
    int table_size[3];
    int interpolation; /* word */
    int repeat[3];
    int placement, fit_to, up; /* words */
    struct neph_volume_box index_box;
    struct neph_vec3 center_m, size_m; /* placement: fit */
    double longest_side_m;
    struct neph_vec3 origin_m; /* placement: file */
    double unit_m;
    int memory_limit_mib;
};

extern const struct neph_field neph_volume_fields[];

/* Reads the file into the medium's grid and puts it in place. */
enum neph_status neph_finish_volume(struct neph_reader *reader, const yaml_node_t *node,
                                    void *written);

#endif
