/* SPDX-License-Identifier: MIT
 *
 * What a screen cannot know, over the pictures: a page, and beside it a picture for each scene and
 * part in which lost pixels have the colour of their reason.
 */
#ifndef NEPH_HARNESS_STUDY_SCREEN_PAGE_H
#define NEPH_HARNESS_STUDY_SCREEN_PAGE_H

#include "harness/study/screen_study.h"

/* Make `folder` for the page, or take one of before: neph_owned_claim(), before minutes of work. */
enum neph_status neph_screen_page_claim(const char *folder, struct neph_diag *diag);

/* Into `folder`, which is claimed: index.html and SCENE_PART.png, and over frames screen.svg, what
 * models make of error, flicker and milliseconds over those of the first. The page opens from disk
 * alone. */
enum neph_status neph_screen_page_write(const struct neph_screen_study *study, const char *folder,
                                        struct neph_diag *diag);

#endif
