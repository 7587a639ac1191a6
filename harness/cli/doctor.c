/* SPDX-License-Identifier: MIT
 *
 * `neph doctor`: lists which programs, libraries and devices are installed.
 */
#include "harness/cli/cli.h"

#include "base/child.h"
#include "base/confine.h"
#include "base/oiio.h"
#include "harness/data.h"
#include "harness/engines/engines.h"
#include "harness/engines/vulkan_device.h"
#include "harness/fly/window.h"
#include "harness/host.h"
#include "harness/packages.h"
#include "harness/serve/http.h"
#include "scenes/mesh_file.h"
#include "scenes/volume_file.h"

#include <stdio.h>
#include <stdlib.h>

static const struct neph_cli_option options[] = {
    {.name = "blender"},
    {.name = "json"},
    {.name = "quiet", .help = "Accepted; this verb prints only results"},
    {.name = NULL},
};

/* Checks for programs and libraries that the report and the tests need. */
static bool has_openvdb(const char *program)
{
    (void)program;
    char *path = NULL;
    const bool found = neph_volume_find_openvdb(&path, NULL) == NEPH_OK;
    free(path);
    return found;
}

static bool has_windows(const char *library)
{
    (void)library;
    return neph_window_has_library();
}

static bool has_server(const char *library)
{
    (void)library;
    return neph_http_has_library();
}

static bool has_netcdf(const char *name)
{
    char *program = NULL;
    (void)name;
    const bool is_there = neph_volume_find_netcdf(&program, NULL) == NEPH_OK;
    free(program);
    return is_there;
}

static bool has_assimp(const char *name)
{
    char *program = NULL;
    (void)name;
    const bool is_there = neph_mesh_find_program(&program, NULL) == NEPH_OK;
    free(program);
    return is_there;
}

static bool has_openimageio(const char *name)
{
    (void)name;
    return neph_oiio_is_available();
}

/* User engines may write only in their folder. Tested in the temporary folder, where these folders
 * are created. */
static bool has_confinement(const char *name)
{
    (void)name;
    const char *folder = getenv("TMPDIR");
    return neph_confine_probe(folder && folder[0] ? folder : "/tmp") == NEPH_CONFINE_TO_FOLDER;
}

static const struct {
    const char *program;
    bool (*is_there)(const char *program);
    const char *needed_for;
    struct neph_packages packages; /* packages that contain it; {NULL}: none */
    const char *otherwise;         /* another way to get it, or a further step after the package */
} tools[] = {
    {"neph-vdb",
     has_openvdb,
     "OpenVDB files, and voxels in cycles",
     {NULL},
     "copy it from the build folder into neph's folder, or set NEPH_VDB to its path"},
    {"neph-netcdf",
     has_netcdf,
     "NetCDF files of simulations",
     {"libnetcdf-dev", "netcdf-devel", "netcdf"},
     ", and build neph again"},
    {"neph-mesh",
     has_assimp,
     "meshes in OBJ, PLY and glTF",
     {"libassimp-dev", "assimp-devel", "assimp"},
     ", and build neph again"},
    {"neph-image",
     has_openimageio,
     "frames in TIFF, HDR, PFM, PPM, JPEG, WebP and DPX",
     {"libopenimageio-dev", "OpenImageIO-devel", "openimageio"},
     ", and build neph again"},
    {"ffmpeg",
     neph_child_program_exists,
     "frames of videos",
     {"ffmpeg", "ffmpeg-free", "ffmpeg"},
     ""},
    {"cvvdp",
     neph_child_program_exists,
     "--partner cvvdp of compare and flicker",
     {NULL},
     "pip install cvvdp"},
    {"node",
     neph_child_program_exists,
     "static charts in the report",
     {"nodejs npm", "nodejs npm", "nodejs npm"},
     ""},
    {"chromium",
     neph_child_program_exists,
     "the browser test of the report",
     {"chromium", "chromium", "chromium"},
     ""},
    {"sbatch",
     neph_child_program_exists,
     "nightly runs by Slurm",
     {"slurm-client", "slurm", "slurm-llnl"},
     ""},
    {"confine",
     has_confinement,
     "user engines, which then change files in their folder only",
     {NULL},
     "a Linux kernel of 5.13 or later with Landlock, and user namespaces that users may make; "
     "docs/engines.md says what a user engine can change without"},
    {"SDL 2",
     has_windows,
     "neph fly",
     {"libsdl2-dev", "SDL2-devel", "sdl2"},
     ", and build neph again"},
    {"libmicrohttpd",
     has_server,
     "neph serve",
     {"libmicrohttpd-dev", "libmicrohttpd-devel", "libmicrohttpd"},
     ", and build neph again"},
};

static void how_to_get(size_t tool, char line[512])
{
    char command[256] = "";
    if (tools[tool].packages.debian)
        neph_install_line(&tools[tool].packages, command, sizeof(command));
    snprintf(line, 512, "%s%s", command, tools[tool].otherwise);
}

static json_t *engine_json(const struct neph_engine *engine, const struct neph_engine_info *info)
{
    return json_pack("{s:s, s:b, s:b, s:s, s:s, s:s, s:s, s:s, s:s}", "name", engine->name,
                     "available", info->available, "broken", info->broken, "version", info->version,
                     "device", info->device, "missing", info->missing, "install_line",
                     info->install_line, "can", info->can, "warning", info->warning);
}

static void print_engine(const struct neph_engine *engine, const struct neph_engine_info *info)
{
    if (info->available)
        printf("ok       %-10s %s; %s%s%s\n", engine->name, info->version, info->device,
               info->can[0] ? "; " : "", info->can);
    else if (info->broken)
        printf("broken   %-10s %s\n", engine->name, info->missing);
    else
        printf("missing  %-10s %s\n         get it:   %s\n", engine->name, info->missing,
               info->install_line);
    if (info->warning[0])
        printf("         warning:  %s\n", info->warning);
}

/* ---- the Vulkan device ----------------------------------------------------------------------- */

static json_t *requirement_json(const struct neph_vulkan_requirement *row)
{
    return json_pack("{s:s, s:s, s:s, s:b, s:b, s:s, s:s}", "name", row->name, "needed",
                     row->needed, "value", row->value, "required", row->is_required, "met",
                     row->is_met, "needed_for", row->purpose, "without",
                     row->without ? row->without : "");
}

/* The device's features and limits beside the requirements of the engines. Empty where the device
 * was refused; the lines of the engines give the reason. */
static json_t *check_requirements(const struct neph_shared_device *device, bool prints)
{
    struct neph_vulkan_requirement rows[NEPH_VULKAN_REQUIREMENTS_MAX];
    const int count = device->open ? neph_vulkan_requirements(device->open->vulkan, rows) : 0;
    json_t *list = json_array();
    int met = 0;
    for (int i = 0; i < count; i++) {
        met += rows[i].is_met;
        neph_json_add(&list, requirement_json(&rows[i]));
    }
    if (prints && count > 0)
        printf("ok       %-10s has %d of %d of the wanted features and limits\n", "vulkan", met,
               count);
    for (int i = 0; i < count && prints; i++)
        if (!rows[i].is_met)
            printf("         %s is %s, not %s: %s\n", rows[i].name, rows[i].value, rows[i].needed,
                   rows[i].without);
    return list;
}

static const struct neph_cli_syntax syntax = {
    .options = options,
    .doc = "List the installed engines, the device, and install commands for missing programs.\v"
           "Exit code 69 when an engine is missing, 3 when one is installed and does not work.\n\n"
           "Example:\n"
           "  neph doctor",
};

enum neph_status neph_cli_doctor(int argc, char **argv, struct neph_diag *diag)
{
    struct neph_cli_shared request = {0};
    neph_cli_parse(&syntax, argc, argv, &request);
    struct neph_shared_device device = {.open = NULL};
    json_t *list = json_array();
    int count, missing = 0, broken = 0;
    const struct neph_engine *const *engines = neph_engines_with_user_engines(&count);
    for (int i = 0; i < count; i++) {
        struct neph_engine_info info;
        neph_engine_probe(engines[i], &device, &info);
        if (engines[i]->is_user_engine && !info.available && !info.broken)
            continue;
        missing += !info.available;
        broken += info.broken;
        neph_json_add(&list, engine_json(engines[i], &info));
        if (!request.json)
            print_engine(engines[i], &info);
    }
    json_t *requirements = check_requirements(&device, !request.json);
    neph_shared_device_close(&device);
    for (size_t i = 0; i < sizeof(tools) / sizeof(tools[0]); i++) {
        const bool there = tools[i].is_there(tools[i].program);
        char get_it[512];
        how_to_get(i, get_it);
        neph_json_add(&list,
                      json_pack("{s:s, s:b, s:s, s:s}", "name", tools[i].program, "available",
                                there, "needed_for", tools[i].needed_for, "install_line", get_it));
        if (!request.json)
            printf("%-8s %-10s for %s%s%s\n", there ? "ok" : "missing", tools[i].program,
                   tools[i].needed_for, there ? "" : "\n         get it:   ", there ? "" : get_it);
    }
    char *data = neph_data_directory();
    if (!request.json)
        printf("data     %s\n", data ? data : "");
    free(data);
    const enum neph_status status = neph_cli_print_json(json_pack("{s:o, s:o, s:o}", "host",
                                                                  neph_host_json(), "parts", list,
                                                                  "vulkan", requirements),
                                                        request.json, diag);
    if (status)
        return status;
    return broken ? NEPH_ERR_ENGINE : missing ? NEPH_ERR_UNAVAILABLE : NEPH_OK;
}
