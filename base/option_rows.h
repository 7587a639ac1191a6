/* SPDX-License-Identifier: MIT
 *
 * Macros for the rows of a table of options (base/option.h).
 */
#ifndef NEPH_BASE_OPTION_ROWS_H
#define NEPH_BASE_OPTION_ROWS_H

#include "base/option.h"

#define CHOICE(name, value, words, help)                                                           \
    {                                                                                              \
        name, NEPH_OPTION_CHOICE, value, 0, 0, words, help                                         \
    }
#define REAL(name, value, least, most, help)                                                       \
    {                                                                                              \
        name, NEPH_OPTION_REAL, value, least, most, NULL, help                                     \
    }
#define WHOLE(name, value, least, most, help)                                                      \
    {                                                                                              \
        name, NEPH_OPTION_INTEGER, value, least, most, NULL, help                                  \
    }

#endif
