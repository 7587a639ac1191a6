/* SPDX-License-Identifier: MIT
 *
 * Files of a folder for a server: regular files below it, and nothing that a link, "..", a hidden
 * name or an absolute path leads to.
 */
#ifndef NEPH_HARNESS_SERVE_FILES_H
#define NEPH_HARNESS_SERVE_FILES_H

#include "harness/serve/http.h"

/* Replies with the file `path` of the folder; "" at the end of a path is index.html. 404 for all
 * else. `folder` is a file descriptor. */
void neph_serve_file(int folder, const char *path, struct neph_http_reply *reply);

#endif
