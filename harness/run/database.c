/* SPDX-License-Identifier: MIT
 *
 * SQLite behind harness/run/database.h: statements, transactions, migration.
 */
#include "harness/run/database.h"

#include "base/path.h"

#include <math.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WAIT_MS = 10000 };

struct neph_database {
    sqlite3 *handle;
    struct neph_path path;
};

struct neph_query {
    struct neph_database *database;
    sqlite3_stmt *statement;
    enum neph_status status; /* of the query so far */
    struct neph_diag *diag;
};

static enum neph_status status_from_sqlite(int code)
{
    switch (code & 0xff) {
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB:
        return NEPH_ERR_INPUT;
    case SQLITE_NOMEM:
        return NEPH_ERR_MEMORY;
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
    case SQLITE_FULL:
    case SQLITE_IOERR:
    case SQLITE_READONLY:
    case SQLITE_CANTOPEN:
    case SQLITE_PERM:
    case SQLITE_AUTH:
        return NEPH_ERR_IO;
    default:
        return NEPH_ERR_INTERNAL;
    }
}

static enum neph_status fail(const struct neph_database *database, struct neph_diag *diag)
{
    const enum neph_status status = status_from_sqlite(sqlite3_errcode(database->handle));
    neph_fail(diag, status, "'%s': %s", database->path.text, sqlite3_errmsg(database->handle));
    return status;
}

/* ---- statements ------------------------------------------------------------------------------ */

/* Prepares a statement without values. NULL: out of memory. */
static struct neph_query *prepare(struct neph_database *database, struct neph_diag *diag,
                                  const char *text)
{
    struct neph_query *query = calloc(1, sizeof(*query));
    if (!query) {
        neph_fail_memory(diag);
        return NULL;
    }
    query->database = database;
    query->diag = diag;
    if (sqlite3_prepare_v2(database->handle, text, -1, &query->statement, NULL) != SQLITE_OK)
        query->status = fail(database, diag);
    return query;
}

/* Binds the value of the `at`-th "?", counted from 1. */
static void bind(struct neph_query *query, int at, char type, union neph_database_value value)
{
    int code;
    if (!query || query->status)
        return;
    if (type == 's')
        code = sqlite3_bind_text(query->statement, at, value.text, -1, SQLITE_TRANSIENT);
    else if (type == 'i')
        code = sqlite3_bind_int64(query->statement, at, value.integer);
    else
        code = isfinite(value.real) ? sqlite3_bind_double(query->statement, at, value.real)
                                    : sqlite3_bind_null(query->statement, at);
    if (code != SQLITE_OK)
        query->status = fail(query->database, query->diag);
}

struct neph_query *neph_query_list(struct neph_database *database, struct neph_diag *diag,
                                   const char *statement, const char *types, va_list values)
{
    struct neph_query *query = prepare(database, diag, statement);
    for (int i = 0; types[i]; i++) {
        union neph_database_value value;
        if (types[i] == 's')
            value.text = va_arg(values, const char *);
        else if (types[i] == 'i')
            value.integer = va_arg(values, int64_t);
        else
            value.real = va_arg(values, double);
        bind(query, i + 1, types[i], value);
    }
    return query;
}

struct neph_query *neph_query(struct neph_database *database, struct neph_diag *diag,
                              const char *statement, const char *types, ...)
{
    va_list values;
    va_start(values, types);
    struct neph_query *query = neph_query_list(database, diag, statement, types, values);
    va_end(values);
    return query;
}

bool neph_query_next(struct neph_query *query)
{
    if (!query || query->status)
        return false;
    const int code = sqlite3_step(query->statement);
    if (code != SQLITE_ROW && code != SQLITE_DONE)
        query->status = fail(query->database, query->diag);
    return code == SQLITE_ROW;
}

const char *neph_query_text(struct neph_query *query, int column)
{
    const unsigned char *text = sqlite3_column_text(query->statement, column);
    return text ? (const char *)text : "";
}

int64_t neph_query_integer(struct neph_query *query, int column)
{
    return sqlite3_column_int64(query->statement, column);
}

double neph_query_real(struct neph_query *query, int column)
{
    return sqlite3_column_type(query->statement, column) == SQLITE_NULL
               ? NAN
               : sqlite3_column_double(query->statement, column);
}

enum neph_status neph_query_end(struct neph_query *query, enum neph_status status)
{
    const enum neph_status of_query = query ? query->status : NEPH_ERR_MEMORY;
    if (query)
        sqlite3_finalize(query->statement);
    free(query);
    return status ? status : of_query;
}

static enum neph_status run_statement(struct neph_query *query)
{
    while (neph_query_next(query))
        ;
    return neph_query_end(query, NEPH_OK);
}

enum neph_status neph_database_put(struct neph_database *database, struct neph_diag *diag,
                                   const char *statement, const char *types,
                                   const union neph_database_value *values)
{
    struct neph_query *query = prepare(database, diag, statement);
    for (int i = 0; types[i]; i++)
        bind(query, i + 1, types[i], values[i]);
    return run_statement(query);
}

enum neph_status neph_database_do(struct neph_database *database, struct neph_diag *diag,
                                  const char *statement, const char *types, ...)
{
    va_list values;
    va_start(values, types);
    struct neph_query *query = neph_query_list(database, diag, statement, types, values);
    va_end(values);
    return run_statement(query);
}

enum neph_status neph_database_count(struct neph_database *database, int64_t *count,
                                     struct neph_diag *diag, const char *statement,
                                     const char *types, ...)
{
    va_list values;
    va_start(values, types);
    struct neph_query *query = neph_query_list(database, diag, statement, types, values);
    va_end(values);
    const int64_t found = neph_query_next(query) ? neph_query_integer(query, 0) : 0;
    const enum neph_status status = neph_query_end(query, NEPH_OK);
    if (!status)
        *count = found;
    return status;
}

/* ---- transactions ---------------------------------------------------------------------------- */

/* For several statements at once, and for statements whose result rows are not needed. */
static enum neph_status execute(struct neph_database *database, const char *text,
                                struct neph_diag *diag)
{
    return sqlite3_exec(database->handle, text, NULL, NULL, NULL) == SQLITE_OK
               ? NEPH_OK
               : fail(database, diag);
}

enum neph_status neph_database_begin(struct neph_database *database, struct neph_diag *diag)
{
    return execute(database, "BEGIN IMMEDIATE", diag);
}

enum neph_status neph_database_end(struct neph_database *database, enum neph_status status,
                                   struct neph_diag *diag)
{
    if (!status)
        status = execute(database, "COMMIT", diag);
    if (status && !sqlite3_get_autocommit(database->handle))
        execute(database, "ROLLBACK", NULL);
    return status;
}

/* ---- opening --------------------------------------------------------------------------------- */

static enum neph_status run_migration_step(struct neph_database *database, const char *step,
                                           int64_t form, struct neph_diag *diag)
{
    char mark[64];
    snprintf(mark, sizeof(mark), "PRAGMA user_version = %lld", (long long)form);
    const enum neph_status status = execute(database, step, diag);
    return status ? status : execute(database, mark, diag);
}

/* Runs the missing migration steps. The version is read again under the database's lock, as another
 * process may have migrated first. */
static enum neph_status migrate(struct neph_database *database, const char *const *steps,
                                struct neph_diag *diag)
{
    int64_t form = 0, last = 0;
    while (steps[last])
        last++;
    enum neph_status status = neph_database_count(database, &form, diag, "PRAGMA user_version", "");
    if (status || form == last)
        return status;
    status = neph_database_begin(database, diag);
    if (!status)
        status = neph_database_count(database, &form, diag, "PRAGMA user_version", "");
    if (!status && form > last) {
        status = neph_fail(diag, NEPH_ERR_USAGE,
                           "'%s' has version %lld, and this neph reads versions up to %lld",
                           database->path.text, (long long)form, (long long)last);
        neph_hint(diag,
                  "a later neph has written it: use that version, or name another folder with -o");
    }
    for (; !status && form < last; form++)
        status = run_migration_step(database, steps[form], form + 1, diag);
    return neph_database_end(database, status, diag);
}

enum neph_status neph_database_open(const char *path, const char *const *steps,
                                    struct neph_database **database, struct neph_diag *diag)
{
    struct neph_database *opened = calloc(1, sizeof(*opened));
    if (!opened)
        return neph_fail_memory(diag);
    opened->path = neph_path_in("", path);
    enum neph_status status = NEPH_OK;
    if (sqlite3_open_v2(path, &opened->handle,
                        SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_FULLMUTEX,
                        NULL) != SQLITE_OK)
        status = opened->handle ? fail(opened, diag) : neph_fail_memory(diag);
    if (!status) {
        sqlite3_extended_result_codes(opened->handle, 1);
        sqlite3_busy_timeout(opened->handle, WAIT_MS);
        /* On a file system without WAL, SQLite keeps its rollback journal: slower, equally safe. */
        status = execute(opened, "PRAGMA journal_mode = WAL; PRAGMA foreign_keys = ON;", diag);
    }
    if (!status)
        status = migrate(opened, steps, diag);
    if (status) {
        neph_database_close(opened);
        return status;
    }
    *database = opened;
    return NEPH_OK;
}

void neph_database_close(struct neph_database *database)
{
    if (!database)
        return;
    sqlite3_close(database->handle);
    free(database);
}

enum neph_status neph_database_check(struct neph_database *database, bool thorough,
                                     struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    struct neph_query *query = neph_query(
        database, diag, thorough ? "PRAGMA integrity_check(1)" : "PRAGMA quick_check(1)", "");
    if (neph_query_next(query) && strcmp(neph_query_text(query, 0), "ok") != 0)
        status = neph_fail(diag, NEPH_ERR_INPUT, "'%s' is damaged: %s", database->path.text,
                           neph_query_text(query, 0));
    return neph_query_end(query, status);
}
