/* SPDX-License-Identifier: MIT
 *
 * The handles of neph_metrics.h, and how its functions begin and end.
 */
#ifndef NEPH_LIBRARY_HANDLES_H
#define NEPH_LIBRARY_HANDLES_H

#include "base/arena.h"
#include "base/image.h"
#include "library/neph_metrics.h"
#include "metrics/extractor.h"

#include <locale.h>
#include <stdbool.h>

struct nephm_image {
    struct neph_image *image;
};

enum { NEPH_TASK_WORDS_MAX = 128 };

struct neph_task_words {
    const char *list[NEPH_TASK_WORDS_MAX];
    int count;
};

struct nephm_task {
    struct neph_arena arena; /* of the texts */
    bool is_flicker;
    struct neph_task_words metrics, settings;
    const char *mask; /* NULL: all */
    bool rings, negative_is_fine, frozen_is_fine;
    double warm_up_frames;
    struct neph_viewing viewing; /* NaN: the default */
};

/* Give a status and its reason to the caller of the library. */
int neph_library_tell(enum neph_status status, const struct neph_diag *diag,
                      struct nephm_error *error);

/* Numbers have a point inside, whatever the locale of the program. Returns the locale to go back
 * to; 0: memory is short. */
locale_t neph_library_enter(locale_t *inside);
void neph_library_leave(locale_t before, locale_t inside);

#endif
