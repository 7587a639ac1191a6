/* SPDX-License-Identifier: MIT
 *
 * `neph bake SCENE`.
 */
#include "harness/cli/cli.h"

#include "base/arena.h"
#include "base/files.h"
#include "harness/data.h"
#include "harness/engines/bakes.h"
#include "harness/old_options.h"
#include "scenes/media.h"
#include "scenes/volume_file.h"

#include <stdio.h>
#include <stdlib.h>

struct request {
    struct neph_cli_shared shared;
    int medium, resolution;
};

static const struct neph_cli_option options[] = {
    {"medium", 0, "N", "Which medium of the scene, from 1", NEPH_CLI_INTEGER,
     .at = offsetof(struct request, medium), "1", 1, NEPH_SCENE_MEDIA_MAX},
    {"resolution", 0, "N",
     "Nodes along the longest side, 2..1024 (default: the scene's bake_resolution, and a grid as "
     "it is)",
     NEPH_CLI_INTEGER, .at = offsetof(struct request, resolution),
     .minimum = NEPH_BAKE_RESOLUTION_MIN, .maximum = NEPH_GRID_SIDE_MAX},
    {.name = "output", .help = "Folder of SCENE.vdb, without FILE", .otherwise = "out/bake"},
    {.name = "json"},
    {.name = "quiet", .help = "Accepted; this verb prints only results"},
    {.name = NULL},
};

static const struct neph_cli_operands operands = {
    .shown = "SCENE [FILE]",
    .minimum = 1,
    .maximum = 2,
    .missing = "which scene? `neph scenes` lists the catalogue",
    .surplus = "one scene and one file",
};

static const struct neph_cli_syntax syntax = {
    .options = options,
    .operands = &operands,
    .doc =
        "Write a medium of a scene as a voxel file, FILE.vdb (OpenVDB) or FILE.df3 (POV-Ray), and "
        "print its error: the grid is compared with the medium at random points, and along random "
        "chords by their exact optical depths. So the error of a renderer that reads the file can "
        "be separated from the error of the file.\v"
        "Densities have no unit: extinction [1/m] = density * the extinction of density 1, which "
        "is printed. A .vdb has the nodes in metres and world axes. A .df3 has density / largest "
        "density in 32 bits with a layer of zeros around it; POV-Ray puts it in place with "
        "`interpolate 1`, `scale (size + 2) * spacing` and `translate origin - spacing`.\n\n"
        "Examples:\n"
        "  neph bake gaussian_blob blob.vdb\n"
        "  neph bake my_clouds.yaml clouds.df3 --medium 2 --resolution 256 --json",
};

struct result {
    const struct neph_medium *medium;
    struct neph_bake bake;
    double cut_error; /* in transmittance, from cutting an unbounded medium to a box */
};

static enum neph_status bake(const struct request *request, const struct neph_scene *scene,
                             struct result *result, struct neph_diag *diag)
{
    if (scene->medium_count == 0)
        return neph_fail(diag, NEPH_ERR_INPUT, "scene %s has no medium", scene->name);
    const enum neph_status status = neph_cli_check_range("--medium", request->medium, 1,
                                                         scene->medium_count, diag);
    if (status)
        return status;
    result->medium = &scene->media[request->medium - 1];
    int resolution = request->resolution;
    if (resolution < 0)
        resolution = neph_medium_is_whole_grid(result->medium) ? 0 : scene->bake_resolution;
    const struct neph_bounds box = neph_medium_container(scene, result->medium, &result->cut_error);
    return neph_medium_bake(result->medium, &box, resolution, &result->bake, diag);
}

/* The scene file entry that reads the written file as a medium of the same place and density. For
 * free(); NULL: memory is short. */
static char *volume_entry(const char *path, const struct result *result)
{
    const struct neph_grid *grid = result->bake.grid;
    const struct neph_vec3 first_m = grid->origin_m, h = grid->spacing_m;
    const int *size = grid->size;
    if (neph_volume_has_transform(path))
        return neph_format("volume: {file: \"%s\", extinction_per_m: %.15g}", path,
                           result->bake.extinction_per_m);
    return neph_format("volume: {file: \"%s\", center_m: [%.15g, %.15g, %.15g], size_m: [%.15g, "
                       "%.15g, %.15g], extinction_per_m: %.15g}",
                       path, first_m.x + 0.5 * (size[0] - 1) * h.x,
                       first_m.y + 0.5 * (size[1] - 1) * h.y, first_m.z + 0.5 * (size[2] - 1) * h.z,
                       (size[0] + 2) * h.x, (size[1] + 2) * h.y, (size[2] + 2) * h.z,
                       result->bake.extinction_per_m * (double)grid->maximum);
}

static json_t *result_json(const char *path, const char *entry, const struct result *result)
{
    const struct neph_grid *grid = result->bake.grid;
    return json_pack(
        "{s:s, s:s, s:s, s:[i,i,i], s:[f,f,f], s:[f,f,f], s:f, s:f, s:b, s:f, s:i, s:i, s:o}",
        "file", path, "scene_entry", entry, "kind", neph_medium_facts(result->medium->kind)->name,
        "size", grid->size[0], grid->size[1], grid->size[2], "origin_m", grid->origin_m.x,
        grid->origin_m.y, grid->origin_m.z, "spacing_m", grid->spacing_m.x, grid->spacing_m.y,
        grid->spacing_m.z, "density_maximum", (double)grid->maximum,
        "extinction_of_density_1_per_m", result->bake.extinction_per_m, "is_copy",
        result->bake.is_copy, "cut_error", result->cut_error, "points",
        result->bake.error.point_count, "chords", result->bake.error.chord_count, "error",
        neph_bakes_json(&result->bake, 1));
}

static void print_error(const struct neph_bake_error *error)
{
    printf("  extinction     rms %.3g %%, largest %.3g %% of the largest (%d places)\n",
           100.0 * error->extinction_rms_relative, 100.0 * error->extinction_max_relative,
           error->point_count);
    printf("  optical depth  rms %.3g, largest %.3g, mean %+.3g (%d chords)\n",
           error->optical_depth_rms, error->optical_depth_max, error->optical_depth_mean,
           error->chord_count);
    printf("  transmittance  largest %.3g\n", error->transmittance_max);
}

static void print_result(const char *path, const char *entry, const struct result *result)
{
    const struct neph_grid *grid = result->bake.grid;
    printf("%s: %s as %d x %d x %d nodes of %.6g x %.6g x %.6g m, the first at (%.6g, %.6g, %.6g) "
           "m\n",
           path, neph_medium_facts(result->medium->kind)->name, grid->size[0], grid->size[1],
           grid->size[2], grid->spacing_m.x, grid->spacing_m.y, grid->spacing_m.z, grid->origin_m.x,
           grid->origin_m.y, grid->origin_m.z);
    printf("  density 1 is an extinction of %.9g per metre; the largest density is %.9g\n",
           result->bake.extinction_per_m, (double)grid->maximum);
    if (result->bake.is_copy)
        printf("  the medium's own grid, unchanged: nothing is lost\n");
    else
        print_error(&result->bake.error);
    if (result->cut_error > 0.0)
        printf("  cut to a box, which costs up to %.3g of transmittance\n", result->cut_error);
    printf("  in a scene file, with an albedo: %s\n", entry);
}

/* The file to write to, owned by the arena. The old form is -o FILE. */
static enum neph_status choose_file(const struct neph_cli_shared *shared,
                                    const struct neph_scene *scene, struct neph_arena *arena,
                                    const char **path, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    const bool is_old = shared->operand_count == 1 &&
                        neph_volume_has_known_extension(shared->output);
    *path = shared->operand_count > 1 ? shared->operands[1] : shared->output;
    if (is_old)
        neph_old_option_warn("neph bake", "-o FILE", "neph bake SCENE FILE");
    if (shared->operand_count == 1 && !is_old) {
        status = neph_dir_create(shared->output, diag);
        *path = neph_arena_format(arena, "%s/%s.vdb", shared->output, scene->name);
        return status ? status : neph_arena_check(arena, diag);
    }
    if (neph_volume_has_known_extension(*path))
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_USAGE, "'%s' is no volume file that neph knows", *path);
    neph_hint(diag, "FILE.vdb for OpenVDB, FILE.df3 for POV-Ray");
    return NEPH_ERR_USAGE;
}

static enum neph_status tell(const char *path, const struct result *result, bool json,
                             struct neph_diag *diag)
{
    char *entry = volume_entry(path, result);
    enum neph_status status = entry ? NEPH_OK : neph_fail_memory(diag);
    if (!status && json)
        status = neph_json_print(result_json(path, entry, result), diag);
    else if (!status)
        print_result(path, entry, result);
    free(entry);
    return status;
}

enum neph_status neph_cli_bake(int argc, char **argv, struct neph_diag *diag)
{
    struct request request = {0};
    neph_cli_parse(&syntax, argc, argv, &request);
    const char *path = NULL;
    struct neph_arena arena = {NULL};
    struct neph_scene *scene = NULL;
    struct result result = {.medium = NULL};
    enum neph_status status = neph_data_load_scene(request.shared.operands[0], &scene, diag);
    if (!status)
        status = choose_file(&request.shared, scene, &arena, &path, diag);
    if (!status)
        status = bake(&request, scene, &result, diag);
    if (!status)
        status = neph_volume_write(path, result.bake.grid, diag);
    if (!status)
        status = tell(path, &result, request.shared.json, diag);
    neph_bake_finish(&result.bake);
    neph_scene_destroy(scene);
    neph_arena_finish(&arena);
    return status;
}
