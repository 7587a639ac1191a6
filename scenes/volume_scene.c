/* SPDX-License-Identifier: MIT */
#include "scenes/volume_scene.h"

#include "base/files.h"
#include "base/text.h"
#include "scenes/fields.h"
#include "scenes/volume_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define OPTICAL_DEPTH 20.0 /* of a small cumulus */
#define FOV_DEG 40.0

enum { MEMORY_LIMIT_MIB = 512 }; /* the default of a scene file */

bool neph_is_volume_scene(const char *path)
{
    const char *dot = strrchr(path, '.');
    return dot && strcmp(dot, ".vdb") == 0;
}

/* The largest integral of the density straight up, over the columns of nodes. */
static double largest_column_m(const struct neph_grid *grid)
{
    const size_t nx = (size_t)grid->size[0], ny = (size_t)grid->size[1];
    double largest = 0.0;
    for (size_t z = 0; z < (size_t)grid->size[2]; z++)
        for (size_t x = 0; x < nx; x++) {
            double sum = 0.0;
            for (size_t y = 0; y < ny; y++)
                sum += (double)grid->values[(z * ny + y) * nx + x];
            largest = fmax(largest, sum);
        }
    return largest * grid->spacing_m.y;
}

/* Checks that a text can be written between double quotes of YAML. */
static enum neph_status check_written(const char *written, struct neph_diag *diag)
{
    const size_t length = strlen(written);
    if (!strpbrk(written, "\"\\") && written[0] != '$' &&
        neph_text_first_unfit(written, length) == length)
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_INPUT,
              "the name of the volume, '%s', does not fit into a scene file: it has a quote, a "
              "backslash, a control character, or begins with $",
              written);
    neph_hint(diag, "rename the file, or link to it by another name");
    return NEPH_ERR_INPUT;
}

static enum neph_status check_grid(const char *path, const struct neph_grid *grid,
                                   struct neph_diag *diag)
{
    const struct neph_bounds box = neph_grid_support(grid);
    const double *low_m = &box.min_m.x, *high_m = &box.max_m.x;
    if (!(grid->maximum > 0.0F))
        return neph_fail(diag, NEPH_ERR_INPUT, "'%s' is 0 everywhere: the volume is empty", path);
    for (int axis = 0; axis < 3; axis++)
        if (low_m[axis] < -0.1 * NEPH_FAR_M || high_m[axis] > 0.1 * NEPH_FAR_M) {
            neph_fail(diag, NEPH_ERR_INPUT,
                      "'%s' spans %g to %g m along %c, if its unit is the metre; a scene around it "
                      "may span %g to %g m",
                      path, low_m[axis], high_m[axis], "xyz"[axis], -0.1 * NEPH_FAR_M,
                      0.1 * NEPH_FAR_M);
            neph_hint(diag, "write a scene file with unit_m (0.01: centimetres) or placement: fit; "
                            "`neph scenes --new cloud FILE` begins one");
            return NEPH_ERR_INPUT;
        }
    return NEPH_OK;
}

/* Distance from the centre of a box to a camera that looks back at it and sees its eight corners in
 * a square frame, with a margin of a tenth. */
static double find_camera_distance(struct neph_vec3 size_m, struct neph_vec3 backward)
{
    const double slope = tan(0.5 * FOV_DEG * NEPH_RAD_PER_DEG);
    const struct neph_vec3 right = neph_vec3_normalize(
        neph_vec3_cross((struct neph_vec3){0, 1, 0}, backward));
    const struct neph_vec3 up = neph_vec3_cross(backward, right);
    double distance_m = 0.0;
    for (int corner = 0; corner < 8; corner++) {
        const struct neph_vec3 at_m = {(corner & 1 ? 0.5 : -0.5) * size_m.x,
                                       (corner & 2 ? 0.5 : -0.5) * size_m.y,
                                       (corner & 4 ? 0.5 : -0.5) * size_m.z};
        const double aside_m = fmax(fabs(neph_vec3_dot(at_m, right)),
                                    fabs(neph_vec3_dot(at_m, up)));
        distance_m = fmax(distance_m, 1.1 * aside_m / slope + neph_vec3_dot(at_m, backward));
    }
    return distance_m;
}

static char *format(const char *name, const char *written, const struct neph_grid *grid)
{
    const struct neph_bounds box = neph_grid_support(grid);
    const struct neph_vec3 size_m = neph_vec3_sub(box.max_m, box.min_m);
    const struct neph_vec3 middle_m = neph_vec3_scale(neph_vec3_add(box.min_m, box.max_m), 0.5);
    const struct neph_vec3 backward = neph_vec3_normalize((struct neph_vec3){-0.35, 0.12, 1.0});
    const struct neph_vec3 eye_m = neph_vec3_along(middle_m, backward,
                                                   find_camera_distance(size_m, backward));
    const double extinction_per_m = OPTICAL_DEPTH / largest_column_m(grid);
    return neph_format(
        "# A scene around the medium of a .vdb file: neph scenes --new vdb.\n"
        "# All keys: scenes/README.md. `neph scenes FILE` checks this file.\n"
        "title: \"%.80s in the sun\"\n"
        "\n"
        "# The file spans %.6g x %.6g x %.6g m (%d x %d x %d voxels), if its unit is the metre.\n"
        "# The whole volume is in the frame.\n"
        "camera:\n"
        "  position_m: [%.6g, %.6g, %.6g]\n"
        "  look_at_m: [%.6g, %.6g, %.6g]\n"
        "  vertical_fov_deg: %g\n"
        "\n"
        "# The direction is towards the sun. There is no ground: a box in `solids` would be one.\n"
        "sun: {direction: [0.7, 0.5, 0.5], irradiance_w_per_m2: [10, 9.6, 9]}\n"
        "background_w_per_m2_sr: [0.1, 0.2, 0.4] # the sky behind; it does not light the medium\n"
        "\n"
        "# single: sunlight is scattered once, which engine `exact` computes exactly.\n"
        "# multiple: all orders of scattering, as in a photograph; the path tracer is the "
        "reference.\n"
        "scattering: single\n"
        "\n"
        "media:\n"
        "  - volume:\n"
        "      file: \"%s\" # from the folder of this file on, or absolute\n"
        "      # unit_m: 0.01 # if the file is in centimetres\n"
        "      # grid: density # if the file has several\n"
        "      # For density 1. The file has no such value: this one gives the densest vertical\n"
        "      # column an optical depth of %g. Replace it by the value of your renderer.\n"
        "      extinction_per_m: %.6g\n"
        "      albedo: [1, 1, 1] # scattered part of the extinction\n"
        "      phase: henyey_greenstein\n"
        "      asymmetry_g: 0.6 # forward; water droplets have about 0.85\n"
        "\n"
        "display: {exposure_ev: 2} # of PNG images; measured radiance does not depend on it\n",
        name, size_m.x, size_m.y, size_m.z, grid->size[0], grid->size[1], grid->size[2], eye_m.x,
        eye_m.y, eye_m.z, middle_m.x, middle_m.y, middle_m.z, FOV_DEG, written, OPTICAL_DEPTH,
        extinction_per_m);
}

enum neph_status neph_volume_scene_text(const char *path, const char *written, char **text,
                                        struct neph_diag *diag)
{
    const struct neph_volume_request request = {
        .path = path, .memory_limit_bytes = (size_t)MEMORY_LIMIT_MIB << 20};
    struct neph_grid *grid = NULL;
    enum neph_status status = check_written(written, diag);
    if (!status)
        status = neph_volume_read(&request, &grid, diag);
    if (!status)
        status = check_grid(path, grid, diag);
    char *name = neph_scene_name_from_path(path);
    char *made = status || !name ? NULL : format(name, written, grid);
    free(name);
    neph_grid_destroy(grid);
    if (status)
        return status;
    if (!made)
        return neph_fail_memory(diag);
    *text = made;
    return NEPH_OK;
}
