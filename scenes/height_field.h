/* SPDX-License-Identifier: MIT
 *
 * Meshes of images of heights. Private to scenes/.
 */
#ifndef NEPH_SCENES_HEIGHT_FIELD_H
#define NEPH_SCENES_HEIGHT_FIELD_H

#include "base/status.h"
#include "scenes/mesh_data.h"
#include "scenes/scene.h"

struct neph_height_field {
    const char *path, *channel; /* channel NULL: of an EXR the only one, else R */
    struct neph_bounds box;
    bool has_normals, has_uv; /* to be made */
};

/* Reads a 16-bit grey PNG, whose codes 0 .. 65535 are the values 0 .. 1, or an EXR, whose values
 * are those of the channel. The value 0 is the bottom of the box and 1
 * its top; values of an EXR may be outside. Each pixel is a vertex. Columns of the image go along
 * +x and rows along +z (the first row is at the lowest z), the outer ones on the sides of the box.
 * The four vertices of a cell are two triangles on both sides of the diagonal from (low x, high z)
 * to (high x, low z). The normal of a vertex is the sum of those of its triangles, weighted by
 * their areas. u is 0 at the lowest x and 1 at the highest, v 1 at the lowest z and 0 at the
 * highest: a texture lies as the image of heights does.
 *
 * NEPH_ERR_INPUT: another kind of file, without such a channel, fewer than 2 pixels along a side,
 * more than NEPH_MESH_TRIANGLES_MAX triangles, a height that is not finite. NEPH_ERR_NOT_FOUND,
 * NEPH_ERR_IO, NEPH_ERR_MEMORY. Each message names the file. */
enum neph_status neph_height_field_read(const struct neph_height_field *field,
                                        struct neph_mesh_data *data, struct neph_diag *diag);

#endif
