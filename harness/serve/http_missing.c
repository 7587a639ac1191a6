/* SPDX-License-Identifier: MIT
 *
 * Replaces http_microhttpd.c if neph was built without libmicrohttpd.
 */
#include "harness/serve/http.h"

bool neph_http_has_library(void)
{
    return false;
}

enum neph_status neph_http_open(int port, neph_http_answer *answer, void *context,
                                struct neph_http **http, struct neph_diag *diag)
{
    (void)port;
    (void)answer;
    (void)context;
    (void)http;
    neph_fail(diag, NEPH_ERR_UNAVAILABLE,
              "this neph was built without libmicrohttpd: it serves no pages");
    neph_hint(diag, "apt-get install libmicrohttpd-dev, and build it again");
    return NEPH_ERR_UNAVAILABLE;
}

void neph_http_close(struct neph_http *http)
{
    (void)http;
}

const char *neph_http_url(const struct neph_http *http)
{
    (void)http;
    return "";
}

enum neph_status neph_http_run(struct neph_http *http, struct neph_diag *diag)
{
    (void)http;
    (void)diag;
    return NEPH_OK;
}

struct neph_http_counts neph_http_counts(const struct neph_http *http)
{
    (void)http;
    return (struct neph_http_counts){0, 0};
}
