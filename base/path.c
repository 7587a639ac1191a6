/* SPDX-License-Identifier: MIT */
#include "base/path.h"

#include <limits.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

_Static_assert(NEPH_PATH_SIZE > PATH_MAX, "the system refuses longer paths");

struct neph_path neph_path_in(const char *folder, const char *name)
{
    const size_t length = strlen(folder);
    const bool needs_slash = length > 0 && folder[length - 1] != '/';
    return neph_path_format("%s%s%s", folder, needs_slash ? "/" : "", name);
}

struct neph_path neph_path_format(const char *format, ...)
{
    struct neph_path path;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(path.text, sizeof(path.text), format, arguments);
    va_end(arguments);
    return path;
}
