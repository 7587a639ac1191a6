/* SPDX-License-Identifier: MIT
 *
 * Runs a fuzz target on the files of a folder, and prints the name of each before it runs: fixed
 * findings stay fixed. At least one file must exist.
 */
#include "tests/fuzz/fuzz.h"

static void replay(const char *folder, const char *name)
{
    char *path = neph_path_join(folder, name), *data = NULL;
    size_t size = 0;
    struct neph_diag diag = {0};
    const enum neph_status status = neph_file_read(path, (size_t)1 << 24, &data, &size, &diag);
    fuzz_require(status == NEPH_OK, diag.message);
    /* A copy of the exact size, so that AddressSanitizer detects a read beyond the end. */
    uint8_t *exact = malloc(size ? size : 1);
    memcpy(exact, data, size);
    LLVMFuzzerTestOneInput(exact, size);
    free(exact);
    free(data);
    free(path);
}

int main(int argc, char **argv)
{
    struct neph_arena arena = {NULL};
    struct neph_names names = {.count = 0};
    int replayed = 0;
    if (argc == 2)
        neph_dir_list(argv[1], &arena, &names, NULL);
    for (int i = 0; i < names.count; i++) {
        if (names.list[i][0] == '.')
            continue;
        printf("%s\n", names.list[i]);
        fflush(stdout);
        replay(argv[1], names.list[i]);
        replayed++;
    }
    neph_arena_finish(&arena);
    printf("%d inputs\n", replayed);
    return replayed > 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
