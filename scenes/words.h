/* SPDX-License-Identifier: MIT
 *
 * The words for enumerations in scene files. Each list ends with NULL. Private to scenes/; other
 * folders call neph_scattering_name() and the like.
 */
#ifndef NEPH_SCENES_WORDS_H
#define NEPH_SCENES_WORDS_H

extern const char *const neph_scattering_words[];        /* by enum neph_scattering */
extern const char *const neph_gate_quantity_words[];     /* by enum neph_gate_quantity */
extern const char *const neph_failing_measure_words[];   /* by enum neph_failing_measure */
extern const char *const neph_failing_reference_words[]; /* by enum neph_failing_reference */
extern const char *const neph_injected_value_words[];    /* by enum neph_injected_value */

#endif
