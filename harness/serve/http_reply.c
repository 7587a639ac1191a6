/* SPDX-License-Identifier: MIT */
#include "harness/serve/http.h"

void neph_http_reply_text(struct neph_http_reply *reply, int code, const char *type, char *text)
{
    reply->code = text ? code : 500;
    reply->type = type;
    reply->text = text;
    reply->file = -1;
}
