/* SPDX-License-Identifier: MIT
 *
 * A scene while it is read from its file. Private to scenes/.
 */
#ifndef NEPH_SCENES_LOAD_H
#define NEPH_SCENES_LOAD_H

#include "scenes/display.h"
#include "scenes/failing.h"
#include "scenes/fields.h"
#include "scenes/gates.h"
#include "scenes/injection.h"
#include "scenes/scene.h"

/* The scene comes first: freeing it frees all. */
struct neph_written_scene {
    struct neph_scene scene;
    struct neph_camera_key camera; /* used when the file has no list of keys */
    struct neph_sun_key sun;
    struct neph_wind_key wind;
    int solid_count;
    struct neph_written_solid *solids; /* a fence is one entry */
    struct neph_gates gates;
    struct neph_scene_display display;
    struct neph_failing failing;
    struct neph_injections injections;
    const char *old_description;   /* from the key's older name */
    neph_gate_metric_check *check; /* NULL: metrics of gates are not checked */
};

/* All keys of a scene file, read into a struct neph_written_scene. */
extern const struct neph_field neph_scene_fields[];

/* Read in place into a struct neph_written_scene. */
extern const struct neph_record neph_camera_record, neph_frames_record, neph_sun_record,
    neph_wind_record;

/* Into a struct neph_gate, and a struct neph_scene_display. */
extern const struct neph_record neph_gate_record, neph_display_record;

/* Into a struct neph_failing. */
extern const struct neph_record neph_failing_record;

/* Into a struct neph_injections. */
extern const struct neph_record neph_injection_record;

/* Checks of injections that need the finished scene. */
enum neph_status neph_check_injections(const struct neph_reader *reader,
                                       const struct neph_scene *scene);

/* Into a struct neph_fog_look. */
extern const struct neph_record neph_fog_look_record;

/* Checks of fog_look that need the finished scene: it has a height fog. */
enum neph_status neph_check_fog_look(const struct neph_reader *reader,
                                     const struct neph_scene *scene);

/* Writes the numbers of a point of the sweep into the document. */
enum neph_status neph_failing_put_point(struct neph_document *document,
                                        const struct neph_failing *failing, int point,
                                        struct neph_diag *diag);

/* Entries of lists. */
extern const struct neph_record neph_solid_record, neph_medium_record, neph_light_record;

/* Sets the sun of frame 0, after all keys were read. */
void neph_finish_sun(struct neph_written_scene *written);

/* Resolves the chain's path relative to the scene's folder; checks gates by written->check. */
enum neph_status neph_finish_chain(struct neph_reader *reader, struct neph_written_scene *written);
enum neph_status neph_finish_gates(struct neph_reader *reader, struct neph_written_scene *written);

/* Expands fences into their bars, and creates the movers of moving solids. */
enum neph_status neph_finish_solids(struct neph_reader *reader, struct neph_written_scene *written);

/* Writes their parts of the scene's hash. */
void neph_solids_hash(const struct neph_scene *scene, FILE *text);
void neph_movers_hash(const struct neph_scene *scene, FILE *text);

/* Whether two directions, of any length but 0, have a unique great circle between them. */
bool neph_has_great_circle(struct neph_vec3 a, struct neph_vec3 b);

/* Refuses a light inside a solid, where it would light nothing; one with keys in any frame. */
enum neph_status neph_check_lights(const struct neph_reader *reader,
                                   const struct neph_scene *scene);

/* Checks that need the finished scene: the cameras of all frames are outside solids and never
 * degenerate; wind moves a medium, and not too far. */
enum neph_status neph_check_views(const struct neph_reader *reader, const struct neph_scene *scene);
enum neph_status neph_check_wind(const struct neph_reader *reader, const struct neph_scene *scene);

#define NEPH_KEY_FRAME_MAX 1e5

/* Rows of a struct neph_camera_key. */
extern const struct neph_field neph_camera_key_fields[];

/* Prints the forms of all kinds of media, like neph_fields_print(). */
void neph_forms_print(FILE *file);

/* The forms of the kinds that wind moves, each followed by a comma: "gaussian, grid, ". */
void neph_list_drifting_forms(char *text, size_t size);

/* Checks that max_m is above min_m; `owner` is the key of the box. */
enum neph_status neph_check_extent(const struct neph_reader *reader, const char *owner,
                                   const struct neph_bounds *bounds);

#endif
