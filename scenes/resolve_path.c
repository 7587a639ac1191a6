/* SPDX-License-Identifier: MIT */
#include "scenes/resolve_path.h"

#include <stdlib.h>
#include <string.h>

enum neph_status neph_resolve_path(const struct neph_reader *reader, const char *file,
                                   const char *example, const char **path)
{
    const char *scene_path = reader->document->file, *slash = strrchr(scene_path, '/');
    if (file[0] == '$') {
        const size_t length = strcspn(file + 1, "/");
        const char *value = getenv(neph_arena_format(reader->arena, "%.*s", (int)length, file + 1));
        if (!value || !*value) {
            neph_fail(reader->diag, NEPH_ERR_NOT_FOUND,
                      "'%s': the environment variable %.*s is not set", file, (int)length,
                      file + 1);
            neph_hint(reader->diag, "export %.*s=%s", (int)length, file + 1, example);
            return NEPH_ERR_NOT_FOUND;
        }
        *path = neph_arena_format(reader->arena, "%s%s", value, file + 1 + length);
    } else if (file[0] == '/' || !slash) {
        *path = file;
    } else {
        *path = neph_arena_format(reader->arena, "%.*s/%s", (int)(slash - scene_path), scene_path,
                                  file);
    }
    return neph_arena_check(reader->arena, reader->diag);
}
