/* SPDX-License-Identifier: MIT */
#include "harness/old_options.h"

#include "base/files.h"
#include "base/path.h"

#include <stddef.h>
#include <stdio.h>
#include <string.h>

const struct neph_old_option neph_old_options[] = {
    {"benchmark", "engines", "engine"},
    {"benchmark", "frames", "repeat"},
    {"benchmark", "voxels", "resolution"},
    {"conform", "scene", "only"},
    {"pick", "presets", "preset"},
    {"scaling", "against", "other-device"},
    {"study convergence", "presets", "preset"},
    {"study flicker", "presets", "preset"},
    {"study light", "models", "model"},
    {"study light", "noise", "noise-limit"},
    {"study post", "chains", "only"},
    {"study screen", "models", "model"},
    {"study sky", "models", "model"},
    {"study sky", "suns", "elevations"},
    {"sweep", "against", "baseline"},
    {"validate", "check", "only"},
    {"validate", "time-limit", "budget"},
    {"view", "limit", "page-limit"},
    {NULL, NULL, NULL},
};

void neph_old_option_warn(const char *verb, const char *old, const char *name)
{
    fprintf(stderr, "%s: %s is now %s; the old spelling goes with the next release\n", verb, old,
            name);
}

void neph_old_output_warn(const char *output)
{
    static const char folder[] = "out/";
    const size_t length = strlen(folder);
    if (strncmp(output, folder, length) != 0 || strchr(output + length, '/') ||
        !neph_path_is_dir("out/store") || neph_path_is_dir(neph_path_in(output, "store").text))
        return;
    fprintf(stderr,
            "neph: results go to %s; those of before are in out/store, which -o out uses again\n",
            output);
}
