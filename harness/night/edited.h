/* SPDX-License-Identifier: MIT
 *
 * The accepted versions of scenes that were edited since, rendered once more by tonight's program
 * from the store's copies (scene_copy.h), so that an edit does not hide a regression.
 */
#ifndef NEPH_HARNESS_NIGHT_EDITED_H
#define NEPH_HARNESS_NIGHT_EDITED_H

#include "harness/night/work.h"

/* Find the edits of tonight, run the step of each once more with the accepted version in place of
 * the edited scene, and keep its numbers as measured by the step "NAME, as accepted". `scope` gets
 * the edits with what became of them; texts are of the night's arena. An accepted version that
 * cannot be rendered is no error. */
enum neph_status neph_night_render_accepted(struct neph_night_work *work,
                                            struct neph_night_scope *scope, struct neph_diag *diag);

#endif
