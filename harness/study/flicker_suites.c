/* SPDX-License-Identifier: MIT */
#include "harness/study/flicker_suites.h"

#include "harness/data.h"
#include "harness/study/suites.h"

#include <stdlib.h>
#include <string.h>

static enum neph_status copy_names(const json_t *entries, char ***scenes, int *count,
                                   struct neph_diag *diag)
{
    const size_t entry_count = json_array_size(entries);
    char **names = calloc(entry_count + 1, sizeof(*names));
    if (!names)
        return neph_fail_memory(diag);
    for (size_t i = 0; i < entry_count; i++)
        if (!(names[i] = neph_suite_scene(json_array_get(entries, i)))) {
            neph_data_free_names(names);
            return neph_fail_memory(diag);
        }
    *scenes = names;
    *count = (int)entry_count;
    return NEPH_OK;
}

enum neph_status neph_flicker_suite_find(const char *name, char ***scenes, int *count,
                                         struct neph_diag *diag)
{
    json_t *entries = NULL;
    enum neph_status status = neph_suite_find("scenes/studies/flicker.json",
                                              "neph-flicker-suites-1", name, &entries, diag);
    if (!status)
        status = copy_names(entries, scenes, count, diag);
    json_decref(entries);
    return status;
}
