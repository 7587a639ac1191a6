/* SPDX-License-Identifier: MIT
 *
 * Runs a fuzz target over the files of a folder, each named before it is tried: what was once found
 * stays mended. At least one file must be there.
 */
#include "tests/fuzz/fuzz.h"

#include <dirent.h>

static int by_name(const struct dirent **a, const struct dirent **b)
{
    return strcmp((*a)->d_name, (*b)->d_name);
}

static void replay(const char *folder, const char *name)
{
    char *path = neph_path_join(folder, name), *data = NULL;
    size_t size = 0;
    struct neph_diag diag = {0};
    const enum neph_status status = neph_file_read(path, (size_t)1 << 24, &data, &size, &diag);
    fuzz_require(status == NEPH_OK, diag.message);
    /* A copy of its exact size, so that AddressSanitizer sees a read beyond the end. */
    uint8_t *exact = malloc(size ? size : 1);
    memcpy(exact, data, size);
    LLVMFuzzerTestOneInput(exact, size);
    free(exact);
    free(data);
    free(path);
}

int main(int argc, char **argv)
{
    struct dirent **entries = NULL;
    const int count = argc == 2 ? scandir(argv[1], &entries, NULL, by_name) : -1;
    int replayed = 0;
    for (int i = 0; i < count; i++) {
        if (entries[i]->d_name[0] != '.') {
            printf("%s\n", entries[i]->d_name);
            fflush(stdout);
            replay(argv[1], entries[i]->d_name);
            replayed++;
        }
        free(entries[i]);
    }
    free(entries);
    printf("%d inputs\n", replayed);
    return replayed > 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
