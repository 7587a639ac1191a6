/* SPDX-License-Identifier: MIT */
#include "harness/serve/files.h"

#include <fcntl.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char *const types[][2] = {
    {".html", "text/html; charset=utf-8"},
    {".js", "text/javascript; charset=utf-8"},
    {".css", "text/css; charset=utf-8"},
    {".json", "application/json"},
    {".png", "image/png"},
    {".svg", "image/svg+xml"},
    {".xml", "text/xml; charset=utf-8"},
    {".txt", "text/plain; charset=utf-8"},
    {".log", "text/plain; charset=utf-8"},
};

static const char *find_type(const char *name)
{
    const char *ending = strrchr(name, '.');
    for (size_t i = 0; ending && i < sizeof(types) / sizeof(types[0]); i++)
        if (strcmp(ending, types[i][0]) == 0)
            return types[i][1];
    return "application/octet-stream";
}

/* Opens the parts of the path one by one, each in the folder before it and none through a link, so
 * that no path leaves the folder, whatever is renamed meanwhile. Returns a file descriptor, or -1.
 */
static int open_below(int folder, char *path)
{
    int at = dup(folder);
    for (char *name = path, *rest; at >= 0 && name; name = rest) {
        rest = strchr(name, '/');
        if (rest)
            *rest++ = '\0';
        const char *part = !rest && name[0] == '\0' ? "index.html" : name;
        const int flags = O_RDONLY | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK | (rest ? O_DIRECTORY : 0);
        const int next = part[0] == '.' || part[0] == '\0' ? -1 : openat(at, part, flags);
        close(at);
        at = next;
    }
    return at;
}

void neph_serve_file(int folder, const char *path, struct neph_http_reply *reply)
{
    struct stat info;
    char *parts = strlen(path) < PATH_MAX ? strdup(path) : NULL;
    const char *name = strrchr(path, '/') ? strrchr(path, '/') + 1 : path;
    const int file = parts ? open_below(folder, parts) : -1;
    free(parts);
    if (file >= 0 && fstat(file, &info) == 0 && S_ISREG(info.st_mode)) {
        *reply = (struct neph_http_reply){.code = 200,
                                          .type = find_type(name[0] ? name : "index.html"),
                                          .file = file,
                                          .file_bytes = (size_t)info.st_size};
        return;
    }
    if (file >= 0)
        close(file);
    neph_http_reply_text(reply, 404, "text/plain; charset=utf-8", strdup("404: no such file\n"));
}
