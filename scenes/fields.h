/* SPDX-License-Identifier: MIT
 *
 * A scene file as tables: one row per key says where its value goes and what it may be. The rows
 * read the YAML into structs, refuse what is not allowed with line, column and the way out, fill in
 * what is left out, go into the hash, and write the reference in scenes/README.md. Private to
 * scenes/.
 */
#ifndef NEPH_SCENES_FIELDS_H
#define NEPH_SCENES_FIELDS_H

#include "base/arena.h"
#include "base/vec3.h"
#include "scenes/document.h"

#include <stdbool.h>
#include <stdio.h>

/* 1e6 m: beyond it float32 renderers resolve 6 cm and less, so no engine could be compared. */
#define NEPH_FAR_M 1e6
#define NEPH_PLANET_M 1e8 /* balls of ground and air may be planets */

#define NEPH_FIELD_PATH_MAX 160 /* of a value inside a file: "media[0].height_fog.albedo[2]" */

enum neph_field_type {
    NEPH_NUMBER,  /* double */
    NEPH_THREE,   /* three doubles: struct neph_vec3, struct neph_rgb */
    NEPH_WHOLE,   /* int */
    NEPH_WHOLES,  /* three ints */
    NEPH_FLAG,    /* bool */
    NEPH_WORD,    /* int or enum: the index in `words` */
    NEPH_TEXT,    /* const char *, in the arena; where there are `words`, one of them */
    NEPH_RECORD,  /* a mapping, read into the place itself */
    NEPH_NUMBERS, /* double[most] and a count */
    NEPH_ENTRIES, /* mappings: an array[most] and a count */
    NEPH_LIST,    /* mappings: a pointer to an array in the arena, and a count */
    NEPH_FIELD_TYPE_COUNT,
};

/* What of a row goes into the scene's hash: a line with its name and value (scenes/hash_text.h). */
enum neph_hashing {
    NEPH_HASHED,
    NEPH_HASHED_IF_SET,    /* where it, or a row of its record, is not 0: hashes from before stay */
    NEPH_HASHED_AS_THREE,  /* a number, on one line with the two of the next rows */
    NEPH_HASHED_WITH_LAST, /* where the row before it is */
    NEPH_HASHED_AS_MADE,   /* not as it is written: the hash has the things that it is made into */
    NEPH_NOT_HASHED,       /* no rendered value depends on it */
    NEPH_HASHING_COUNT,
};

struct neph_reader;

/* A mapping. */
struct neph_record {
    size_t size;                     /* of the struct that it is read into */
    const struct neph_field *fields; /* ends with a row without key */
    /* NULL: the fields alone, neph_read_fields(). Others call that, and then check or convert; what
     * stands in the place of a mapping that is left out is theirs, too. */
    enum neph_status (*read)(struct neph_reader *reader, const yaml_node_t *node,
                             const struct neph_record *record, void *target);
    /* NULL: the fields, neph_fields_hash(). Others write what the mapping was made into. */
    void (*hash)(const void *target, FILE *text);
};

struct neph_field {
    const char *key;
    enum neph_field_type type;
    size_t at; /* in the struct that the record is read into */
    const char *unit;
    double minimum, maximum; /* of each number */
    const char *note;        /* what it is, or why not otherwise; also told beside a complaint */
    const char *standard;    /* when left out: "1.5", "[0, 1, 0]", or words; NULL: it may not be */
    int least, most;         /* entries of a list, bytes of a text */
    size_t count_at;         /* an int; of a list */
    bool is_ascending; /* a list whose entries begin with a field that grows from one to the next */
    const char *const *words; /* ends with NULL */
    const struct neph_record *record;
    enum neph_hashing hashing;
    const char *hash_name; /* NULL: the key */
};

struct neph_reader {
    struct neph_document *document;
    struct neph_arena *arena;       /* of texts and lists */
    struct neph_diag *diag;         /* of the error that is being reported */
    struct neph_errors *errors;     /* all of them, see neph_read_document() */
    char path[NEPH_FIELD_PATH_MAX]; /* of what is being read: "media[0].homogeneous" */
};

/* The mapping into `target`, which is 0 or was read before: every key known and given once, every
 * value of its type and in its range, what must be there is there, the rest has its default. All
 * errors of the mapping are kept in the reader; the status is the first of them.
 */
enum neph_status neph_read_fields(struct neph_reader *reader, const yaml_node_t *node,
                                  const struct neph_field *fields, void *target);

/* What needs several keys of a document, after all were read; `so_far` is the status of that. */
typedef enum neph_status neph_document_check(struct neph_reader *reader, enum neph_status so_far,
                                             void *target);

/* The whole document into `target`, as neph_read_fields() does, and its check. Fills the diag with
 * all errors, in the order of their lines. */
enum neph_status neph_read_document(struct neph_document *document, struct neph_arena *arena,
                                    const struct neph_field *fields, neph_document_check *check,
                                    void *target, struct neph_diag *diag);

/* A mapping with exactly one of its keys; `what` is its name for a person. */
enum neph_status neph_read_choice(struct neph_reader *reader, const yaml_node_t *node,
                                  const struct neph_field *fields, void *target, const char *what);

/* What neph_read_fields() gives for keys that are all left out. */
void neph_fields_default(const struct neph_field *fields, void *target);

/* Whether the file gives the key, default or not. */
bool neph_reader_has(const struct neph_reader *reader, const yaml_node_t *mapping, const char *key);

/* Fill the diag for the value at `path`, counted from what is being read ("" is that itself), or
 * for as much of the path as the file has. Returns NEPH_ERR_INPUT. */
enum neph_status neph_refuse(const struct neph_reader *reader, const char *path, const char *format,
                             ...) __attribute__((format(printf, 3, 4)));

/* Keep the error of a check in the reader and go on with the next check. `next` is the status of
 * the check that just ran, `first` that of the checks before it. Returns the first that is an
 * error. */
enum neph_status neph_also(const struct neph_reader *reader, enum neph_status first,
                           enum neph_status next);

/* Whether these keys of the mapping that is being read were read without an error. They are
 * separated by spaces. */
bool neph_is_sound(const struct neph_reader *reader, const char *keys);

/* A path made on the spot: neph_at("layers[%d].height_m", i).text */
struct neph_path {
    char text[NEPH_FIELD_PATH_MAX];
};
struct neph_path neph_at(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* Whether a text is of these characters alone. Names of scenes are so long at most. */
#define NEPH_NAME_CHARACTERS "abcdefghijklmnopqrstuvwxyz0123456789_"
#define NEPH_NAME_MAX_BYTES 64
bool neph_is_identifier(const char *text);

/* Whether a text has control characters, but for those of `except`, or bytes that are no UTF-8. */
bool neph_has_control(const char *text, const char *except);

/* A direction has a length. */
enum neph_status neph_check_direction(const struct neph_reader *reader, const char *path,
                                      struct neph_vec3 direction);

/* The lines of a scene's hash, see scenes/hash_text.h: of every row that does not say otherwise. */
void neph_fields_hash(const struct neph_field *fields, const void *target, FILE *text);

/* "key: value, key: value", as a scene file may have it, of numbers, threes and flags. Rows that
 * are hashed where they are set are written only then. */
void neph_fields_write(const struct neph_field *fields, const void *target, FILE *out);

/* What its value may be, in words. */
void neph_field_describe(const struct neph_field *field, char *text, size_t size);

/* A line of Markdown's table per key, records opened up; `owner` stands before each key. */
void neph_fields_print(const struct neph_field *fields, const char *owner, FILE *file);

#endif
