/* SPDX-License-Identifier: MIT
 *
 * Acceptance of a nightly run by its page, as JSON:
 *
 *   GET   {"format": "neph-approval-1", "night": 12, "nonce": "...", "acceptances": [...]}
 *         the last finished run, and the acceptances of it
 *   POST  {"nonce": "...", "night": 12, "series": ["..."], "why": "..."}
 *         accepts these series of the run, or with ["*"] all; answered as GET, with all new
 *
 * A nonce is valid for one acceptance: a request that is sent again is refused, and so is one from
 * a page that was loaded before the last acceptance or shows another run than the last (409).
 */
#ifndef NEPH_HARNESS_SERVE_APPROVAL_H
#define NEPH_HARNESS_SERVE_APPROVAL_H

#include "harness/night/accept.h"
#include "harness/run/store.h"
#include "harness/serve/http.h"
#include "harness/serve/secret.h"

enum { NEPH_APPROVAL_WHY_MAX = 1000 };

struct neph_approval {
    struct neph_store *store; /* borrowed */
    char nonce[NEPH_SECRET_TEXT_SIZE];
    /* Called after each acceptance; `series` as in the request. */
    void (*tell)(void *context, const struct neph_accepted *accepted, const json_t *series,
                 const char *why);
    void *context;
};

/* Draws the first nonce; the caller has set the other members. */
enum neph_status neph_approval_begin(struct neph_approval *approval, struct neph_diag *diag);

/* Replies to a request. Errors are {"error": text} with 400 (a wrong request), 404 (a series that
 * was not measured), 409 (see above) or 500 (the store cannot be used). */
void neph_approval_answer(struct neph_approval *approval, const struct neph_http_request *request,
                          struct neph_http_reply *reply);

#endif
