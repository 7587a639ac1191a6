/* SPDX-License-Identifier: MIT
 *
 * The process of neph-image that reads the files of a sequence (base/oiio_stream.h). It loads
 * OpenImageIO once, which costs half a second, and forks a process for each file: one that crashes
 * or exceeds a limit ends only that process.
 */
#ifndef NEPH_BASE_OIIO_SERVER_H
#define NEPH_BASE_OIIO_SERVER_H

#include "base/helper.h"
#include "base/oiio_stream.h"

#include <stdbool.h>

struct neph_oiio_server;

/* The process is started by the first file. Free with _destroy. NEPH_ERR_MEMORY. */
enum neph_status neph_oiio_server_create(struct neph_oiio_server **server, struct neph_diag *diag);

/* Ends the process. NULL is fine. No file may be being read. If neph dies, it ends by itself. */
void neph_oiio_server_destroy(struct neph_oiio_server *server);

/* Read a file into memory of neph; `request` has the path, the part and the limits. Threads may
 * call this at the same time: their files are read at the same time.
 *
 * NEPH_ERR_INPUT, without the path: the file is refused, or its process crashed or needed too much
 * processor time. NEPH_ERR_TIMEOUT: it did not end in `wall_limit_s`. NEPH_ERR_UNAVAILABLE: there
 * is no neph-image, it does not start, or something ended it; the next call starts another one.
 * NEPH_ERR_INTERRUPTED, NEPH_ERR_MEMORY. */
enum neph_status neph_oiio_server_read(struct neph_oiio_server *server,
                                       const struct neph_oiio_request *request,
                                       const struct neph_shared *stream, struct neph_diag *diag);

/* Whether neph-image can be run. */
bool neph_oiio_is_available(void);

#endif
