/* SPDX-License-Identifier: MIT */
#include "harness/engines/blender.h"

#include <stdio.h>
#include <string.h>

/* Python of Blender reads no user packages and writes no cache files. */
static const char *const environment[] = {"PYTHONNOUSERSITE=1", "PYTHONDONTWRITEBYTECODE=1", NULL};

static const char *const measured[] = {"3.4.", "4.3.", "5.2.", NULL};

/* Find the version after "Blender " at the start of a line. */
static bool parse_version(const char *text, char version[64])
{
    static const char name[] = "Blender ";
    for (const char *at = text; (at = strstr(at, name)); at += sizeof(name) - 1)
        if ((at == text || at[-1] == '\n') &&
            sscanf(at + sizeof(name) - 1, "%63[0-9.]", version) == 1)
            return true;
    return false;
}

const struct neph_external_renderer neph_blender = {
    .program = "blender",
    .variable = "NEPH_BLENDER",
    .is_list = true,
    .name = "Blender",
    .packages = {"blender python3-numpy", "blender", "blender"},
    .data_file = NEPH_BLENDER_SCRIPT_PATH,
    .parse_version = parse_version,
    .measured = measured,
    .laws = "3.4, 4.3 and 5.2",
    .oldest = {3, 4},
    .environment = environment,
};
