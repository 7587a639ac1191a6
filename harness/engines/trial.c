/* SPDX-License-Identifier: MIT */
#include "harness/engines/trial.h"

#include "base/files.h"
#include "harness/data.h"
#include "harness/json_file.h"
#include "scenes/grid.h"
#include "scenes/media.h"
#include "truth/transport.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { FORMAT = 2, GRID_SIDE = 4 };
enum { FOG, VOXELS };

/* Tolerances lie between the errors of a working renderer and the smallest fault to be found.
 * Measured in this scene with Blender 3.4, 4.3 and 5.2, three seeds each, and POV-Ray 3.7
 * (2026-11-29): errors are at most 9e-6 in transmittance, 0.4 % in scattered light, 1.1e-6 in
 * depth. Transmittance in other scenes: at most 2.2e-4 (results/blender). Half or twice the density
 * differs by 0.22 from exp(-0.8). 0.02 is 90 times the former and an 11th of the latter. */
static const double transmittance_slack = 0.02;
/* Transmittance without a medium is exactly 1; the slack is five times the error above. */
static const double empty_transmittance = 0.999;
/* Scattered light, the sum of 16 pixels of 64 paths: 50 times the measured error. The smallest
 * fault of wrong units is a factor of 2, an error of 0.5 or 1. */
static const double radiance_slack = 0.2;
/* Depth: an image of half floats rounds by 2^-11; this is twice as much. The distance along the ray
 * instead of along the axis is 6 % off, a position half a pixel from the centre 14 %. */
static const double depth_slack = 1e-3;

/* ---- the scene ------------------------------------------------------------------------------- */

static struct neph_medium make_trial_medium(enum neph_medium_kind kind)
{
    return (struct neph_medium){
        .kind = kind,
        .bounds = {{-INFINITY, -INFINITY, -INFINITY}, {INFINITY, INFINITY, INFINITY}},
        .albedo = {0.9, 0.9, 0.9},
        .extinction_color = {1.0, 1.0, 1.0}};
}

/* Open the trial scene: two media of optical depth 0.8, in the middle of each half, and a visible
 * floor below them. */
enum neph_status neph_trial_open(bool with_voxels, struct neph_trial *trial, struct neph_diag *diag)
{
    static const int size[3] = {GRID_SIDE, GRID_SIDE, GRID_SIDE};
    *trial = (struct neph_trial){.key = {.position_m = {0.0, 0.0, 8.0}},
                                 .floor = {.kind = NEPH_SOLID_BOX,
                                           .box = {{-9.0, -4.0, -3.0}, {9.0, -1.5, 3.0}},
                                           .albedo = {0.5, 0.5, 0.5}}};
    trial->scene = (struct neph_scene){
        .name = "probe",
        .camera_key_count = 1,
        .camera_keys = &trial->key,
        .camera_up = {0.0, 1.0, 0.0},
        .vertical_fov_rad = 0.5,
        .frame_count = 1,
        .frame_rate_hz = 25.0,
        .sun = {true, neph_vec3_normalize((struct neph_vec3){0.3, 0.8, 0.5}), {2.0, 2.0, 2.0}},
        .background_w_per_m2_sr = {0.25, 0.25, 0.25},
        .scattering = NEPH_SCATTERING_SINGLE,
        .medium_count = with_voxels ? 2 : 1,
        .solid_count = 1,
        .solids = &trial->floor};
    trial->scene.media[FOG] = make_trial_medium(NEPH_MEDIUM_HOMOGENEOUS);
    trial->scene.media[FOG].bounds = (struct neph_bounds){{-3.0, -1.0, -1.0}, {-0.5, 1.0, 1.0}};
    trial->scene.media[FOG].layer_count = 1;
    trial->scene.media[FOG].layers[0] = (struct neph_fog_layer){0.4, 0.0, 0.0};
    trial->scene.media[VOXELS] = make_trial_medium(NEPH_MEDIUM_GRID);
    trial->scene.media[VOXELS].extinction_per_m = 0.4;
    const enum neph_status status = neph_grid_create(size, (struct neph_vec3){1.0, -0.75, -0.75},
                                                     (struct neph_vec3){0.5, 0.5, 0.5},
                                                     &trial->grid, diag);
    for (int i = 0; i < GRID_SIDE * GRID_SIDE * GRID_SIDE && !status; i++)
        trial->grid->values[i] = 1.0f;
    trial->scene.media[VOXELS].grid = trial->grid;
    return status ? status : neph_grid_seal(trial->grid, diag);
}

void neph_trial_close(struct neph_trial *trial)
{
    neph_grid_destroy(trial->grid);
}

/* ---- checks of the images -------------------------------------------------------------------- */

static struct neph_ray_light compute_exact_light(const struct neph_scene *scene, int column,
                                                 int row)
{
    const struct neph_camera camera = neph_scene_camera(scene, 0.0);
    const struct neph_pixel_ray ray = neph_camera_ray(&camera, NEPH_TRIAL_WIDTH_PX,
                                                      NEPH_TRIAL_HEIGHT_PX, column, row);
    return neph_transport_ray(scene, ray.origin_m, ray.direction);
}

/* Pixels in the middle of each medium and on the floor. */
enum { FOG_COLUMN = 7, VOXELS_COLUMN = 16, MIDDLE_ROW = 4, FLOOR_ROW = 7 };

static double transmittance_at(const struct neph_image *image, int column)
{
    return (double)neph_image_channel(image,
                                      "transmittance.G")[MIDDLE_ROW * NEPH_TRIAL_WIDTH_PX + column];
}

static enum neph_status check_transmittance(const struct neph_scene *scene,
                                            const struct neph_image *image, int column,
                                            const char *what, struct neph_diag *diag)
{
    const double truth = compute_exact_light(scene, column, MIDDLE_ROW).transmittance.g;
    const double measured = transmittance_at(image, column);
    if (fabs(measured - truth) <= transmittance_slack)
        return NEPH_OK;
    return neph_fail(diag, NEPH_ERR_ENGINE,
                     "its images of a trial scene are wrong: behind %s of transmittance %.4f they "
                     "have %.4f%s",
                     what, truth, measured,
                     measured > empty_transmittance ? ", as if it were not there" : "");
}

static enum neph_status check_radiance(const struct neph_scene *scene,
                                       const struct neph_image *image, struct neph_diag *diag)
{
    const float *radiance = neph_image_channel(image, "G");
    const float *scattered = neph_image_channel(image, "volume.G");
    double sum = 0.0, fog = 0.0, truth = 0.0;
    for (int p = 0; p < NEPH_TRIAL_WIDTH_PX * NEPH_TRIAL_HEIGHT_PX; p++)
        sum += fabs((double)radiance[p]);
    if (sum == 0.0)
        return neph_fail(diag, NEPH_ERR_ENGINE, "its images of a trial scene are black");
    for (int row = 2; row < 6; row++)
        for (int column = 6; column < 10; column++) {
            fog += (double)scattered[row * NEPH_TRIAL_WIDTH_PX + column];
            truth += compute_exact_light(scene, column, row).volume.g;
        }
    if (fabs(fog - truth) <= radiance_slack * truth)
        return NEPH_OK;
    return neph_fail(diag, NEPH_ERR_ENGINE,
                     "its images of a trial scene are wrong: a fog in the sun scatters %.3g times "
                     "as much light as it does",
                     fog / truth);
}

static enum neph_status check_depth(const struct neph_scene *scene, const struct neph_image *image,
                                    struct neph_diag *diag)
{
    const struct neph_camera camera = neph_scene_camera(scene, 0.0);
    const struct neph_pixel_ray ray = neph_camera_ray(&camera, NEPH_TRIAL_WIDTH_PX,
                                                      NEPH_TRIAL_HEIGHT_PX, FOG_COLUMN, FLOOR_ROW);
    const double truth_m = compute_exact_light(scene, FOG_COLUMN, FLOOR_ROW).hit_m *
                           neph_vec3_dot(ray.direction, camera.forward);
    const double depth_m = (double)neph_image_channel(
        image, "Z")[FLOOR_ROW * NEPH_TRIAL_WIDTH_PX + FOG_COLUMN];
    if (fabs(depth_m - truth_m) <= depth_slack * truth_m)
        return NEPH_OK;
    return neph_fail(
        diag, NEPH_ERR_ENGINE,
        "its images of a trial scene are wrong: a floor at the depth %.4f m has %.4f m", truth_m,
        depth_m);
}

enum neph_status neph_trial_judge(const struct neph_trial *trial, const struct neph_image *image,
                                  bool *has_voxels, struct neph_diag *diag)
{
    const struct neph_scene *scene = &trial->scene;
    enum neph_status status = check_radiance(scene, image, diag);
    if (!status)
        status = check_transmittance(scene, image, FOG_COLUMN, "a fog", diag);
    if (!status)
        status = check_depth(scene, image, diag);
    *has_voxels = !status && transmittance_at(image, VOXELS_COLUMN) < empty_transmittance;
    return status || !*has_voxels
               ? status
               : check_transmittance(scene, image, VOXELS_COLUMN, "voxels", diag);
}

/* ---- cached results -------------------------------------------------------------------------- */

char *neph_trial_file(const char *program, const char *data_file)
{
    struct stat info;
    char data_hash[NEPH_HASH_HEX_SIZE] = "", key[NEPH_HASH_HEX_SIZE];
    char *path = realpath(program, NULL), *data = data_file ? neph_data_path(data_file) : NULL;
    char *cache = neph_cache_path(), *words = NULL, *file = NULL;
    const bool is_hashed = !data_file || (data && !neph_hash_file(data, data_hash, NULL));
    if (path && cache && is_hashed && stat(path, &info) == 0)
        words = neph_format("%d\n%s\n%lld\n%lld.%09ld\n%s", FORMAT, path, (long long)info.st_size,
                            (long long)info.st_mtim.tv_sec, info.st_mtim.tv_nsec, data_hash);
    if (words && !neph_hash(words, strlen(words), key, NULL))
        file = neph_format("%s/trials/%.32s.json", cache, key);
    free(words);
    free(cache);
    free(data);
    free(path);
    return file;
}

json_t *neph_trial_load_result(const char *file)
{
    json_t *kept = NULL;
    return file && !neph_json_read(file, 1 << 12, &kept, NULL) ? kept : NULL;
}

void neph_trial_save_result(const char *file, json_t *found)
{
    char *folder = file ? strdup(file) : NULL;
    if (folder && found) {
        *strrchr(folder, '/') = '\0';
        if (!neph_dir_create(folder, NULL))
            (void)neph_json_write(found, JSON_INDENT(1), file, NULL);
    }
    json_decref(found);
    free(folder);
}
