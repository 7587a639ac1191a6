/* SPDX-License-Identifier: MIT
 *
 * Options that were renamed: for one release a verb accepts the old name and warns.
 */
#ifndef NEPH_HARNESS_OLD_OPTIONS_H
#define NEPH_HARNESS_OLD_OPTIONS_H

struct neph_old_option {
    const char *verb; /* "compare", "study flicker" */
    const char *old;  /* the old name, without dashes */
    const char *name; /* the option of that verb that takes its argument */
};

/* All of them; the last has a NULL verb. */
extern const struct neph_old_option neph_old_options[];

/* Print on stderr that `old` of a verb ("neph compare") is now `name`; both with their dashes. */
void neph_old_option_warn(const char *verb, const char *old, const char *name);

/* Results lay in out/store before each verb had out/VERB. Print where they are, if there is such a
 * store in the working folder and none yet in `output`, a folder out/VERB. */
void neph_old_output_warn(const char *output);

#endif
