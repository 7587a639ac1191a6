/* SPDX-License-Identifier: MIT */
#include "harness/packages.h"

#include "base/files.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Whether a word is among the values of ID or ID_LIKE. */
static bool is_like(const char *os_release, const char *word)
{
    const size_t length = strlen(word);
    for (const char *line = os_release; line; line = strchr(line, '\n')) {
        line += *line == '\n';
        if (strncmp(line, "ID=", 3) != 0 && strncmp(line, "ID_LIKE=", 8) != 0)
            continue;
        for (const char *at = strchr(line, '=') + 1; *at && *at != '\n';) {
            at += strspn(at, "\"' ");
            const size_t here = strcspn(at, "\"' \n");
            if (here == length && strncmp(at, word, length) == 0)
                return true;
            at += here;
        }
    }
    return false;
}

void neph_install_line_on(const char *os_release, const struct neph_packages *packages, char *line,
                          size_t size)
{
    const struct {
        const char *like, *command, *names;
    } kinds[] = {
        {"debian", "apt-get install", packages->debian},
        {"fedora", "dnf install", packages->fedora},
        {"arch", "pacman -S", packages->arch},
    };
    for (size_t i = 0; i < sizeof(kinds) / sizeof(kinds[0]); i++)
        if (is_like(os_release, kinds[i].like)) {
            snprintf(line, size, "%s %s", kinds[i].command, kinds[i].names);
            return;
        }
    snprintf(line, size, "install %s (the names of Debian's packages)", packages->debian);
}

void neph_install_line(const struct neph_packages *packages, char *line, size_t size)
{
    char *text = NULL;
    size_t length = 0;
    const bool is_told = neph_file_read("/etc/os-release", 1 << 16, &text, &length, NULL) ==
                         NEPH_OK;
    neph_install_line_on(is_told ? text : "", packages, line, size);
    free(text);
}
