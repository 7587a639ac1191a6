/* SPDX-License-Identifier: MIT */
#include "harness/surroundings.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { NAME_MAX_BYTES = 128 };

/* Names, or, with an underscore at their end, all that begin so. Debugging switches of drivers
 * replace shaders, leave passes of the compiler out or pretend another processor; layers stand
 * between us and the driver; OpenColorIO's flags override ours. */
static const char *const ignored[] = {
    "ACO_DEBUG",
    "AMD_DEBUG",
    "ANV_",
    "DRAW_",
    "GALLIUM_",
    "GALLIVM_",
    "INTEL_DEBUG",
    "LP_",
    "LVP_",
    "MESA_",
    "NIR_",
    "NVK_",
    "RADV_",
    "VK_INSTANCE_LAYERS",
    "VK_LOADER_LAYERS_ALLOW",
    "VK_LOADER_LAYERS_ENABLE",
    "OCIO_OPTIMIZATION_FLAGS",
};

/* What of these chooses a device, which its name tells, or costs time alone. */
static const char *const harmless[] = {
    "LP_NUM_THREADS",
    "MESA_DISK_CACHE_",
    "MESA_GLSL_CACHE_",
    "MESA_LOADER_DRIVER_OVERRIDE",
    "MESA_SHADER_CACHE_",
    "MESA_VK_DEVICE_SELECT",
    "MESA_VK_DEVICE_SELECT_FORCE_DEFAULT_DEVICE",
    "MESA_LOG_FILE",
};

static bool is_in(const char *const *patterns, size_t count, const char *name)
{
    for (size_t i = 0; i < count; i++) {
        const size_t length = strlen(patterns[i]);
        const bool is_start = patterns[i][length - 1] == '_';
        if (is_start ? strncmp(name, patterns[i], length) == 0 : strcmp(name, patterns[i]) == 0)
            return true;
    }
    return false;
}

static bool is_ignored(const char *name)
{
    return is_in(ignored, sizeof(ignored) / sizeof(ignored[0]), name) &&
           !is_in(harmless, sizeof(harmless) / sizeof(harmless[0]), name);
}

/* The first variable to be ignored; false when there is none (left). */
static bool find_ignored(char name[NAME_MAX_BYTES])
{
    for (char **entry = environ; entry && *entry; entry++) {
        const size_t length = strcspn(*entry, "=");
        if (length == 0 || length >= NAME_MAX_BYTES)
            continue;
        memcpy(name, *entry, length);
        name[length] = '\0';
        if (is_ignored(name))
            return true;
    }
    return false;
}

/* A name is the user's text too: one that is more than letters is not repeated. */
static bool is_plain(const char *name)
{
    return name[strspn(name, "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_")] ==
           '\0';
}

void neph_surroundings_settle(FILE *out)
{
    char name[NAME_MAX_BYTES];
    while (find_ignored(name) && unsetenv(name) == 0)
        fprintf(out, "neph: the environment variable %s is ignored: it can change frames\n",
                is_plain(name) ? name : "of a driver");
    /* Overlays, recorders and the like that are installed for every program. Loaders before
     * 1.3.234 do not know the variable; our explicit layer of validation is not concerned. */
    setenv("VK_LOADER_LAYERS_DISABLE", "~implicit~", 1);
}
