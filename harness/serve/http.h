/* SPDX-License-Identifier: MIT
 *
 * An HTTP server for one person at this machine. It listens on the loopback address only, and every
 * path begins with a secret token of 256 random bits, which is new in each run:
 *
 *     http://127.0.0.1:PORT/TOKEN/PATH
 *
 * A request reaches the answering function only if it has the token, names this server as its host
 * (so a foreign name that resolves to the loopback address fails) and, if a browser says where it
 * comes from, comes from a page of this server. A POST must say that. All else is refused with 403.
 * Answers forbid that other pages embed them or learn their address.
 *
 * http_microhttpd.c is libmicrohttpd; http_missing.c replaces it if neph was built without that.
 */
#ifndef NEPH_HARNESS_SERVE_HTTP_H
#define NEPH_HARNESS_SERVE_HTTP_H

#include "base/status.h"

#include <stdbool.h>

enum { NEPH_HTTP_BODY_MAX = 1 << 16, NEPH_HTTP_URL_BYTES = 128 };

struct neph_http_request {
    bool is_post;     /* else it is GET or HEAD */
    const char *path; /* decoded, behind the token: "report/index.html" */
    const char *body; /* of a POST; ends with a zero, which body_size does not count */
    size_t body_size; /* at most NEPH_HTTP_BODY_MAX */
};

/* An answer: a text or a file. */
struct neph_http_reply {
    int code;         /* of HTTP */
    const char *type; /* its Content-Type */
    char *text;       /* freed by the server; NULL: the file */
    int file;         /* a file descriptor, closed by the server */
    size_t file_bytes;
    char location[64]; /* of a redirection, relative to the path; "": none */
};

/* Fills a zeroed reply. */
typedef void neph_http_answer(void *context, const struct neph_http_request *request,
                              struct neph_http_reply *reply);

/* A reply of this text (NULL: out of memory, which is 500). */
void neph_http_reply_text(struct neph_http_reply *reply, int code, const char *type, char *text);

struct neph_http_counts {
    long long answered, refused;
};

struct neph_http;

/* Whether neph was built with a server, and its library can be opened. */
bool neph_http_has_library(void);

/* Begins to listen. `port` 0: one that is free. NEPH_ERR_UNAVAILABLE: it has no library;
 * NEPH_ERR_IO: the port is taken. Free with neph_http_close(). */
enum neph_status neph_http_open(int port, neph_http_answer *answer, void *context,
                                struct neph_http **http, struct neph_diag *diag);
void neph_http_close(struct neph_http *http);

/* The address of the empty path, with the token. */
const char *neph_http_url(const struct neph_http *http);

/* Answers requests, one after the other, until Ctrl-C. */
enum neph_status neph_http_run(struct neph_http *http, struct neph_diag *diag);

struct neph_http_counts neph_http_counts(const struct neph_http *http);

#endif
