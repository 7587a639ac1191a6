/* SPDX-License-Identifier: MIT
 *
 * A scene file as tables: one row per key defines its type, range and place in a struct. The rows
 * read the YAML into structs, refuse invalid values with line, column and the way out, apply the
 * defaults, enter the hash, and write the reference in scenes/README.md. Private to scenes/.
 */
#ifndef NEPH_SCENES_FIELDS_H
#define NEPH_SCENES_FIELDS_H

#include "base/arena.h"
#include "base/vec3.h"
#include "scenes/document.h"

#include <stdbool.h>
#include <stdio.h>

/* Beyond 1e6 m float32 renderers resolve only 6 cm and more, so engines could not be compared. */
#define NEPH_FAR_M 1e6
#define NEPH_PLANET_M 1e8 /* for balls of ground and air, which may be planets */

#define NEPH_FIELD_PATH_MAX 160 /* path inside a file: "media[0].height_fog.albedo[2]" */

enum neph_field_type {
    NEPH_NUMBER,  /* double */
    NEPH_THREE,   /* three doubles: struct neph_vec3, struct neph_rgb */
    NEPH_WHOLE,   /* int */
    NEPH_WHOLES,  /* three ints */
    NEPH_FLAG,    /* bool */
    NEPH_WORD,    /* int or enum: the index in `words` */
    NEPH_TEXT,    /* const char *, in the arena; with `words`, one of them */
    NEPH_RECORD,  /* a mapping, read into the struct at `at` */
    NEPH_NUMBERS, /* double[most] and a count */
    NEPH_ENTRIES, /* mappings: an array[most] and a count */
    NEPH_LIST,    /* mappings: a pointer to an array in the arena, and a count */
    NEPH_FIELD_TYPE_COUNT,
};

/* The part of a row in the scene's hash: a line with its name and value (scenes/hash_text.h). */
enum neph_hashing {
    NEPH_HASHED,
    NEPH_HASHED_IF_SET,   /* where it, or a row of its record, is not 0: keeps older hashes valid */
    NEPH_HASHED_AS_THREE, /* a number, on one line with the two of the next rows */
    NEPH_HASHED_WITH_LAST, /* where the row before is hashed */
    NEPH_HASHED_AS_MADE,   /* not as written: the objects that it is converted into are hashed */
    NEPH_NOT_HASHED,       /* no rendered value depends on it */
    NEPH_HASHING_COUNT,
};

struct neph_reader;

/* A mapping of the file. */
struct neph_record {
    size_t size;                     /* of the struct that it is read into */
    const struct neph_field *fields; /* ends with a row without key */
    /* NULL: only the fields, neph_read_fields(). Other readers call that and then check or convert;
     * they also define the value of an absent mapping. */
    enum neph_status (*read)(struct neph_reader *reader, const yaml_node_t *node,
                             const struct neph_record *record, void *target);
    /* NULL: the fields, neph_fields_hash(). Others write the result of the conversion. */
    void (*hash)(const void *target, FILE *text);
};

struct neph_field {
    const char *key;
    enum neph_field_type type;
    size_t at; /* offset in the struct that the record is read into */
    const char *unit;
    double minimum, maximum; /* of each number */
    const char *note;        /* meaning, or reason for the range; also printed in errors */
    const char *standard;    /* default: "1.5", "[0, 1, 0]", or words; NULL: the key is required */
    int least, most;         /* entries of a list, bytes of a text */
    size_t count_at;         /* an int; of a list */
    bool is_ascending; /* the first field of a list's entries grows from one entry to the next */
    const char *const *words; /* ends with NULL */
    const struct neph_record *record;
    enum neph_hashing hashing;
    const char *hash_name; /* NULL: the key */
};

struct neph_reader {
    struct neph_document *document;
    struct neph_arena *arena;       /* memory of texts and lists */
    struct neph_diag *diag;         /* the error that is being reported */
    struct neph_errors *errors;     /* all errors, see neph_read_document() */
    char path[NEPH_FIELD_PATH_MAX]; /* of the value being read: "media[0].homogeneous" */
};

/* Reads the mapping into `target`, which is 0 or was read before. Checks that every key is known
 * and given once, that every value has its type and range and that required keys are present; other
 * keys get their defaults. All errors of the mapping are kept in the reader; the status is the
 * first of them. */
enum neph_status neph_read_fields(struct neph_reader *reader, const yaml_node_t *node,
                                  const struct neph_field *fields, void *target);

/* A check that needs several keys of a document, after all were read; `so_far`: status of
 * reading. */
typedef enum neph_status neph_document_check(struct neph_reader *reader, enum neph_status so_far,
                                             void *target);

/* Reads the whole document into `target` as neph_read_fields() does, and runs its check. Fills the
 * diag with all errors in the order of their lines. */
enum neph_status neph_read_document(struct neph_document *document, struct neph_arena *arena,
                                    const struct neph_field *fields, neph_document_check *check,
                                    void *target, struct neph_diag *diag);

/* Reads a mapping with exactly one of its keys; `what` is its name in messages. */
enum neph_status neph_read_choice(struct neph_reader *reader, const yaml_node_t *node,
                                  const struct neph_field *fields, void *target, const char *what);

/* Sets the values that neph_read_fields() gives when all keys are absent. */
void neph_fields_default(const struct neph_field *fields, void *target);

/* Whether the file has the key. */
bool neph_reader_has(const struct neph_reader *reader, const yaml_node_t *mapping, const char *key);

/* Fills the diag for the value at `path`, relative to the value being read ("" is that value), or
 * for the longest part of the path that the file has. Returns NEPH_ERR_INPUT. */
enum neph_status neph_refuse(const struct neph_reader *reader, const char *path, const char *format,
                             ...) __attribute__((format(printf, 3, 4)));

/* Keeps the error of a check in the reader, so that the next check can run. `next` is the status of
 * the check that just ran, `first` the status of the checks before it. Returns the first error of
 * the two. */
enum neph_status neph_keep_error(const struct neph_reader *reader, enum neph_status first,
                                 enum neph_status next);

/* Whether these keys (separated by spaces) of the mapping being read were read without an error. */
bool neph_were_keys_read(const struct neph_reader *reader, const char *keys);

/* A formatted path: neph_format_path("layers[%d].height_m", i).text */
struct neph_path {
    char text[NEPH_FIELD_PATH_MAX];
};
struct neph_path neph_format_path(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* Whether a text has only these characters. Maximum length of names of scenes. */
#define NEPH_NAME_CHARACTERS "abcdefghijklmnopqrstuvwxyz0123456789_"
#define NEPH_NAME_MAX_BYTES 64
bool neph_is_identifier(const char *text);

/* Whether a text has control characters other than those in `except`, or is not UTF-8. */
bool neph_has_control(const char *text, const char *except);

/* Refuses a direction of length 0. */
enum neph_status neph_check_direction(const struct neph_reader *reader, const char *path,
                                      struct neph_vec3 direction);

/* Writes the lines of a scene's hash (scenes/hash_text.h) for every row, as `hashing` defines. */
void neph_fields_hash(const struct neph_field *fields, const void *target, FILE *text);

/* Writes "key: value, key: value" in the syntax of scene files, for numbers, threes and flags. Rows
 * with NEPH_HASHED_IF_SET are written only where they are set. */
void neph_fields_write(const struct neph_field *fields, const void *target, FILE *out);

/* Describes the allowed values of a field in words. */
void neph_field_describe(const struct neph_field *field, char *text, size_t size);

/* Prints a row of a Markdown table per key, with the keys of records; `owner` precedes each key. */
void neph_fields_print(const struct neph_field *fields, const char *owner, FILE *file);

#endif
