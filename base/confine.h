/* SPDX-License-Identifier: MIT
 *
 * A process that may write into one folder alone, it and all that it starts: by Landlock, which
 * Linux has had since 5.13 and lets everybody use (its documentation: userspace-api/landlock.rst).
 */
#ifndef NEPH_BASE_CONFINE_H
#define NEPH_BASE_CONFINE_H

#include <stdbool.h>

/* Whether this kernel can do it. */
bool neph_confine_is_there(void);

/* From now on this process writes, makes, renames and removes files beneath `folder`, /dev and
 * /proc alone; files that are open stay as they are, and nothing is barred from reading. Where the
 * kernel cannot, nothing changes and true is returned; false: errno says why. Safe between fork()
 * and execve(). */
bool neph_confine_writes(const char *folder);

#endif
