/* SPDX-License-Identifier: MIT
 *
 * Engine `povray`: POV-Ray 3.7 as a witness of single scattering, and of light between solids by
 * radiosity. Light adds up, so a frame is put
 * together from monochrome pictures that POV-Ray renders one after the other:
 *
 *   volume = sum over the phase functions of the scene of what their media scatter
 *            + what the media emit
 *   radiance = volume + surface (lit solids and background behind absorbing media)
 *
 * and transmittance and depth are pictures of their own. Colours whose sources are proportional to
 * those of another colour are not rendered again. povray_scene.c writes the pictures down,
 * povray_exposure.c reads numbers from them.
 */
#include "harness/engines/engines.h"

#include "base/child.h"
#include "base/clock.h"
#include "base/files.h"
#include "base/png.h"
#include "base/threads.h"
#include "harness/engines/baked_scene.h"
#include "harness/engines/bakes.h"
#include "harness/engines/povray_exposure.h"
#include "harness/engines/povray_lamps.h"
#include "harness/engines/povray_scene.h"
#include "harness/engines/program.h"
#include "scenes/emission.h"
#include "scenes/media.h"
#include "scenes/solids.h"
#include "scenes/surfaces.h"
#include "scenes/volume_file.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_PATTERN_COUNT == 2, "a new kind");
_Static_assert(NEPH_SCATTERING_COUNT == 3, "a new kind");
_Static_assert(NEPH_SOLID_KIND_COUNT == 2, "a new kind");

/* Renders of one picture at rising (or falling) gains, at most. */
#define EXPOSURES_MAX 8
#define THREADS_MAX 64

static const struct neph_option options[] = {
    {.name = "intervals",
     .kind = NEPH_OPTION_INTEGER,
     .default_value = 50,
     .minimum = 1,
     .maximum = NEPH_POVRAY_INTERVALS_MAX,
     .help = "samples of each ray and of each of its shadow rays (midpoint rule)"},
    NEPH_OPTION_BAKE_RESOLUTION,
    {.name = "radiosity_rays",
     .kind = NEPH_OPTION_INTEGER,
     .default_value = 400,
     .minimum = 0,
     .maximum = NEPH_POVRAY_RAYS_MAX,
     .help = "light between solids: rays from each place that shares its light with those around; "
             "0: scenes with such light are refused"},
    {.name = "radiosity_error",
     .kind = NEPH_OPTION_REAL,
     .default_value = 0.25,
     .minimum = 0.01,
     .maximum = 10.0,
     .help = "POV-Ray's measure of how different the light may be that places share"},
    {.name = "photons",
     .kind = NEPH_OPTION_INTEGER,
     .default_value = 1000000,
     .minimum = 1000,
     .maximum = 10000000,
     .help = "sunlight that a mirror throws on others: so many, whose light is spread around"},
    {.name = NULL},
};

/* Transmittance: 1e-4 of the value, down to a transmittance of 1e-8. */
static const struct neph_povray_target transmittance_target = {.relative = 1e-4, .absolute = 1e-12};

/* Radiance: 1e-4 of the value, or 1e-6 of the brightest. */
static const double radiance_relative = 1e-4;
static const double radiance_of_peak = 1e-6;
/* With lights, whose rays may be 1e6 times as bright as others, or this part of the median. */
static const double radiance_of_median = 1e-4;
/* Below this part of what the scene could scatter at most, a picture counts as black. */
static const double radiance_black = 1e-13;

/* ---- Probe ---------------------------------------------------------------------------------- */

/* The word after "POV-Ray " that starts with a digit, such as "3.7.0.10.unofficial". */
static bool parse_version(const char *text, char version[64])
{
    static const char name[] = "POV-Ray ";
    for (const char *at = text; (at = strstr(at, name)); at += sizeof(name) - 1) {
        if (sscanf(at + sizeof(name) - 1, "%63[0-9.]", version) != 1)
            continue;
        size_t length = strlen(version);
        while (length > 0 && version[length - 1] == '.')
            version[--length] = '\0';
        return length > 0;
    }
    return false;
}

static const char *const environment[] = {"POVINI=povray.ini", NULL}; /* in the working folder */

static const struct neph_external_renderer povray = {
    .program = "povray",
    .name = "POV-Ray",
    .install_line = "apt-get install povray",
    .parse_version = parse_version,
    .measured = "3.7.0.",
    .other = {"'povray' is version ", "; its media were measured for 3.7.0 only"},
    .environment = environment,
};

static void probe(struct neph_shared_device *device, struct neph_engine_info *info)
{
    (void)device;
    neph_external_probe(&povray, info);
}

/* ---- What it can model ---------------------------------------------------------------------- */

static bool is_lit(struct neph_rgb colour)
{
    return colour.r > 0.0 || colour.g > 0.0 || colour.b > 0.0;
}

/* Does anything of the scene send light on? */
static bool has_scatterer(const struct neph_scene *scene)
{
    for (int i = 0; i < scene->medium_count; i++) {
        if (is_lit(scene->media[i].albedo))
            return true;
    }
    for (int i = 0; i < scene->solid_count; i++) {
        const struct neph_solid *solid = &scene->solids[i];
        if (is_lit(solid->albedo) ||
            (neph_is_textured(&solid->surface) && is_lit(solid->surface.texture.other)))
            return true;
    }
    return false;
}

/* Why its solids are none that POV-Ray has, in words; NULL: it has them. */
static const char *solid_obstacle(const struct neph_scene *scene)
{
    int mirrors = 0;
    for (int i = 0; i < scene->solid_count; i++) {
        const struct neph_surface *surface = &scene->solids[i].surface;
        if (surface->metalness == 0.0)
            continue;
        if (scene->scattering != NEPH_SCATTERING_MULTIPLE)
            return "solids of metal where light is scattered once";
        if (surface->roughness > 0.0)
            return "rough metal on solids: its highlights follow another law in POV-Ray";
        if (neph_is_textured(surface))
            return "a pattern on a mirror";
        if (scene->light_count > 0)
            return "lamps in a mirror, whose light on others POV-Ray was not tried for";
        if (scene->sun.present && (scene->solids[i].kind != NEPH_SOLID_BOX || ++mirrors > 1))
            return "the sun in a mirrored ball, or in several mirrors";
    }
    return NULL;
}

/* Light between solids alone; with 0 rays there is none. */
static bool wants_radiosity(const struct neph_scene *scene)
{
    return scene->scattering == NEPH_SCATTERING_MULTIPLE && scene->medium_count == 0;
}

static bool can_render(const struct neph_scene *scene, const struct neph_settings *settings,
                       char *reason, size_t reason_size)
{
    const bool has_rays = neph_setting(&neph_engine_povray, settings, "radiosity_rays") > 0.0;
    const bool has_light_between = wants_radiosity(scene) && has_rays;
    const char *cannot = solid_obstacle(scene);
    struct neph_diag diag = {0};
    struct neph_povray_world world;
    if (!cannot && neph_scene_is_endless(scene))
        cannot = neph_endless_reason;
    if (cannot)
        ;
    else if (scene->scattering == NEPH_SCATTERING_MULTIPLE && has_scatterer(scene) &&
             !has_light_between)
        cannot = wants_radiosity(scene) ? "light between solids without radiosity_rays"
                                        : "multiple scattering";
    else if (scene->environment_light && has_scatterer(scene) && !has_light_between)
        cannot = "environment light on media or solids";
    else if (neph_povray_world(scene, 0, 1, 1, 1, &world, &diag))
        cannot = diag.message;
    if (cannot && reason_size > 0)
        snprintf(reason, reason_size, "%s", cannot);
    return !cannot;
}

/* ---- One child process ---------------------------------------------------------------------- */

/* One frame in the making. */
struct session {
    struct neph_shot shot; /* its scene is `baked` */
    struct neph_baked_scene baked;
    struct neph_povray_world world;
    size_t pixel_count;
    int threads;
    int renders[NEPH_POVRAY_DEPTH + 1]; /* by enum neph_povray_kind */
    struct neph_cost cost;
};

/* One for radiosity: the order in which it finds its places decides whose light is shared. */
static int thread_count(const struct neph_scene *scene)
{
    int count = neph_processor_count();
    if (wants_radiosity(scene))
        return 1;
    return count < THREADS_MAX ? count : THREADS_MAX;
}

/* The names of the files of one picture. The first two have no folder: POV-Ray runs beside them. */
struct files {
    char scene[64], image[64];
    char *scene_path, *image_path, *log_path;
};

static void free_files(struct files *files)
{
    free(files->scene_path);
    free(files->image_path);
    free(files->log_path);
}

static enum neph_status name_files(const char *directory, const char *name, struct files *files,
                                   struct neph_diag *diag)
{
    char log[80];
    snprintf(files->scene, sizeof(files->scene), "%.48s.pov", name);
    snprintf(files->image, sizeof(files->image), "%.48s.png", name);
    snprintf(log, sizeof(log), "povray-%.48s.log", name);
    files->scene_path = neph_path_join(directory, files->scene);
    files->image_path = neph_path_join(directory, files->image);
    files->log_path = neph_path_join(directory, log);
    if (files->scene_path && files->image_path && files->log_path)
        return NEPH_OK;
    return neph_fail_memory(diag);
}

/* With POVINI naming it, it is the only one that is read: neither the system's, nor the user's in
 * ~/.povray, nor one in the working folder. It names no Library_Path; pictures need no other file
 * than the volumes beside them. */
static const char ini_name[] = "povray.ini";
static const char ini_text[] =
    "; What decides a picture and stands on no command line; read instead of\n"
    "; any other povray.ini.\n"
    "Antialias=off\nJitter=off\nQuality=9\n"
    "Bounding=on\nBounding_Method=1\nBounding_Threshold=3\n"
    "Remove_Bounds=on\nSplit_Unions=off\n"
    "Output_to_File=on\nOutput_Alpha=off\nContinue_Trace=off\n"
    "Clock=0\nInitial_Frame=1\nFinal_Frame=1\nField_Render=off\n";

static enum neph_status write_ini(const char *directory, struct neph_diag *diag)
{
    char *path = neph_path_join(directory, ini_name);
    const enum neph_status status = path ? neph_file_write(path, ini_text, strlen(ini_text), diag)
                                         : neph_fail_memory(diag);
    free(path);
    return status;
}

static enum neph_status write_scene(const struct session *session,
                                    const struct neph_povray_pass *pass, const char *path,
                                    struct neph_diag *diag)
{
    char *text = NULL;
    enum neph_status status = neph_povray_text(&session->world, pass, &text, diag);
    if (!status)
        status = neph_file_write(path, text, strlen(text), diag);
    free(text);
    return status;
}

static enum neph_status run_povray(struct session *session, const struct files *files,
                                   double *wall_s, struct neph_diag *diag)
{
    char input[72], output[72], width[16], height[16], threads[16];
    snprintf(input, sizeof(input), "+I%s", files->scene);
    snprintf(output, sizeof(output), "+O%s", files->image);
    snprintf(width, sizeof(width), "+W%d", session->shot.width_px);
    snprintf(height, sizeof(height), "+H%d", session->shot.height_px);
    snprintf(threads, sizeof(threads), "+WT%d", session->threads);
    const char *argv[] = {"povray",     input, output, "+FN16", "File_Gamma=1.0",
                          "Dither=off", width, height, "+Q9",   "-A",
                          "-D",         "-P",  "-C",   "-GA",   "+BS8",
                          threads,      NULL};
    struct neph_child_result result = {0};
    const enum neph_status status = neph_external_run(
        &povray, argv, session->shot.scratch_directory, files->log_path, &session->shot, &result,
        diag);
    session->cost.cpu_s += result.cpu_s;
    if (result.peak_memory_bytes > session->cost.peak_memory_bytes)
        session->cost.peak_memory_bytes = result.peak_memory_bytes;
    *wall_s = result.wall_s;
    return status;
}

/* The image must be there and of the right size; it is fresh because none was there before. */
static enum neph_status read_image(const struct session *session, const struct files *files,
                                   uint16_t **codes, struct neph_diag *diag)
{
    int width_px = 0, height_px = 0;
    uint16_t *read = NULL;
    enum neph_status status = neph_external_left(&povray, files->image_path, "", files->log_path,
                                                 diag);
    if (!status)
        status = neph_program_status(
            neph_png_read_rgb16(files->image_path, &width_px, &height_px, &read, diag));
    if (!status)
        status = neph_external_size(&povray, "", width_px, height_px, &session->shot, diag);
    if (status)
        free(read);
    else
        *codes = read;
    return status;
}

/* Render one picture; `*codes` (three per pixel) is for the caller to free. */
static enum neph_status render_picture(struct session *session, const char *name,
                                       const struct neph_povray_pass *pass, uint16_t **codes,
                                       double *wall_s, struct neph_diag *diag)
{
    struct files files = {.scene_path = NULL};
    enum neph_status status = name_files(session->shot.scratch_directory, name, &files, diag);
    if (!status)
        status = write_scene(session, pass, files.scene_path, diag);
    if (!status && unlink(files.image_path) && errno != ENOENT)
        status = neph_fail(diag, NEPH_ERR_IO, "cannot remove '%s': %s", files.image_path,
                           strerror(errno));
    if (!status)
        status = run_povray(session, &files, wall_s, diag);
    if (!status)
        status = read_image(session, &files, codes, diag);
    if (!status)
        session->renders[pass->kind]++;
    free_files(&files);
    return status;
}

/* ---- One quantity --------------------------------------------------------------------------- */

/* A picture with one value in all channels is the first of three brackets, the others clamped. */
static void take_readings(const struct session *session, const uint16_t *codes, double gain,
                          struct neph_povray_reading *readings)
{
    const bool is_single = neph_povray_has_photons(session->shot.scene);
    for (size_t i = 0; i < session->pixel_count; i++) {
        const uint16_t first[] = {codes[3 * i], UINT16_MAX, UINT16_MAX};
        const uint16_t *brackets = is_single ? first : codes + 3 * i;
        readings[i] = neph_povray_better(readings[i], neph_povray_read_brackets(brackets, gain));
    }
}

static bool any_clamped(const struct neph_povray_reading *readings, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (isinf(readings[i].error))
            return true;
    }
    return false;
}

/* Render a bracketed picture at as many gains as the target needs. No value is above `bound`, as
 * far as we know; the gain falls when one is. `*readings` (one per pixel) is for the caller to
 * free; `*wall_s` is the time of the last render. */
static enum neph_status expose(struct session *session, const char *name,
                               struct neph_povray_pass pass, double bound,
                               const struct neph_povray_target *target,
                               struct neph_povray_reading **readings, double *wall_s,
                               struct neph_diag *diag)
{
    size_t count = session->pixel_count;
    struct neph_povray_reading *best = malloc(count * sizeof(*best));
    enum neph_status status = best ? NEPH_OK : neph_fail_memory(diag);
    for (size_t i = 0; !status && i < count; i++)
        best[i] = (struct neph_povray_reading){0.0, INFINITY};
    pass.gain = NEPH_POVRAY_HEADROOM / bound;
    for (int i = 1; !status && pass.gain > 0.0 && i <= EXPOSURES_MAX; i++) {
        char file[64];
        uint16_t *codes = NULL;
        snprintf(file, sizeof(file), "%.32s-%d", name, i);
        status = render_picture(session, file, &pass, &codes, wall_s, diag);
        if (status)
            break;
        take_readings(session, codes, pass.gain, best);
        free(codes);
        pass.gain = neph_povray_next_gain(best, count, pass.gain, target);
    }
    if (!status && any_clamped(best, count))
        status = neph_fail(diag, NEPH_ERR_ENGINE,
                           "the picture '%s' is brighter than POV-Ray's images can hold", name);
    if (status) {
        free(best);
        return status;
    }
    *readings = best;
    return NEPH_OK;
}

/* ---- Light ---------------------------------------------------------------------------------- */

/* The sources of a picture, by colour: their weights decide which colours need a render. */
enum { SOURCES_MAX = NEPH_SCENE_SOLIDS_MAX + 1 };

struct sources {
    int count;
    double weights[3][SOURCES_MAX];
};

static bool is_source(const struct sources *sources, int i, struct neph_rgb weight)
{
    return sources->weights[0][i] == weight.r && sources->weights[1][i] == weight.g &&
           sources->weights[2][i] == weight.b;
}

/* Those that are there already say nothing new. Where there is no room for more the brighter one
 * stays, without a colour in common with the others. */
static void add_source(struct sources *sources, struct neph_rgb weight)
{
    for (int i = 0; i < sources->count; i++)
        if (is_source(sources, i, weight))
            return;
    if (sources->count == SOURCES_MAX) {
        const double most = fmax(weight.r, fmax(weight.g, weight.b));
        for (int channel = 0; channel < 3; channel++)
            sources->weights[channel][SOURCES_MAX - 1] = fmax(
                sources->weights[channel][SOURCES_MAX - 1], most * (1.0 + 1e-3 * channel));
        return;
    }
    for (int channel = 0; channel < 3; channel++)
        sources->weights[channel][sources->count] = neph_povray_component(weight, channel);
    sources->count++;
}

static double brightest_source(const struct sources *sources, int channel)
{
    double brightest = 0.0;
    for (int i = 0; i < sources->count; i++)
        brightest = fmax(brightest, sources->weights[channel][i]);
    return brightest;
}

/* Do all media attenuate two colours alike? */
static bool same_extinction(const struct neph_scene *scene, int a, int b)
{
    for (int i = 0; i < scene->medium_count; i++) {
        const struct neph_rgb color = scene->media[i].extinction_color;
        if (neph_povray_component(color, a) != neph_povray_component(color, b))
            return false;
    }
    return true;
}

/* Do all solids reflect two colours alike? */
static bool same_albedo(const struct neph_scene *scene, int a, int b)
{
    for (int i = 0; i < scene->solid_count; i++) {
        const struct neph_rgb colors[2] = {scene->solids[i].albedo,
                                           scene->solids[i].surface.texture.other};
        for (int c = 0; c < 2; c++)
            if (neph_povray_component(colors[c], a) != neph_povray_component(colors[c], b))
                return false;
    }
    return true;
}

/* The factor from one colour to another, 0 when they are not proportional to rounding. Between
 * solids light is no multiple of its sources' weights alone. */
static double proportion(const struct neph_scene *scene, const struct sources *sources, int from,
                         int to)
{
    if (!same_extinction(scene, from, to) ||
        (scene->scattering == NEPH_SCATTERING_MULTIPLE && !same_albedo(scene, from, to)))
        return 0.0;
    double from_peak = brightest_source(sources, from), to_peak = brightest_source(sources, to);
    for (int i = 0; i < sources->count; i++) {
        double difference = sources->weights[to][i] / to_peak -
                            sources->weights[from][i] / from_peak;
        if (fabs(difference) > 1e-14)
            return 0.0;
    }
    return to_peak / from_peak;
}

/* The colour among the rendered ones that can stand for `channel`, with its factor; else itself. */
static int representative(const struct neph_scene *scene, const struct sources *sources,
                          int channel, struct neph_povray_reading *const readings[3],
                          double *factor)
{
    for (int earlier = 0; earlier < channel; earlier++) {
        if (!readings[earlier])
            continue;
        *factor = proportion(scene, sources, earlier, channel);
        if (*factor > 0.0)
            return earlier;
    }
    *factor = 1.0;
    return channel;
}

/* A sum of pictures, three planes of doubles. */
struct light {
    double *planes[3];
};

static void free_light(struct light *light)
{
    for (int channel = 0; channel < 3; channel++)
        free(light->planes[channel]);
}

static enum neph_status make_light(size_t pixel_count, struct light *light, struct neph_diag *diag)
{
    for (int channel = 0; channel < 3; channel++) {
        light->planes[channel] = calloc(pixel_count, sizeof(double));
        if (!light->planes[channel])
            return neph_fail_memory(diag);
    }
    return NEPH_OK;
}

static void add_readings(double *plane, const struct neph_povray_reading *readings, double factor,
                         size_t count)
{
    for (size_t i = 0; i < count; i++)
        plane[i] += factor * readings[i].value;
}

/* Render the colours of one picture and add them to `light`. No pixel of a colour is brighter than
 * `bound_per_source` times its brightest source. */
static enum neph_status add_picture(struct session *session, const char *name,
                                    struct neph_povray_pass pass, const struct sources *sources,
                                    double bound_per_source, struct light *light,
                                    struct neph_diag *diag)
{
    static const char letters[] = "rgb";
    struct neph_povray_reading *readings[3] = {NULL, NULL, NULL};
    enum neph_status status = NEPH_OK;
    for (int channel = 0; !status && channel < 3; channel++) {
        double factor = 1.0, wall_s = 0.0;
        double bound = bound_per_source * brightest_source(sources, channel);
        if (!(bound > 0.0))
            continue;
        int shown = representative(session->shot.scene, sources, channel, readings, &factor);
        if (shown == channel) {
            char file[32];
            snprintf(file, sizeof(file), "%.24s-%c", name, letters[channel]);
            struct neph_povray_target target = {.relative = radiance_relative,
                                                .absolute = radiance_black * bound,
                                                .absolute_of_peak = radiance_of_peak};
            if (session->shot.scene->light_count > 0)
                target.absolute_of_median = radiance_of_median;
            pass.channel = channel;
            status = expose(session, file, pass, bound, &target, &readings[channel], &wall_s, diag);
            session->cost.render_s += wall_s;
        }
        if (!status)
            add_readings(light->planes[channel], readings[shown], factor, session->pixel_count);
    }
    for (int channel = 0; channel < 3; channel++)
        free(readings[channel]);
    return status;
}

/* The largest part of one unit of irradiance that media of one phase function and albedo 1 could
 * send into a pixel: p(cos) (1 - T), as if no sunlight were lost on its way in. */
static double brightest_scattering_per_sr(const struct session *session,
                                          const struct neph_phase *phase)
{
    const struct neph_shot *shot = &session->shot;
    const struct neph_camera *camera = &session->world.camera;
    double brightest = 0.0;
    for (size_t pixel = 0; pixel < session->pixel_count; pixel++) {
        size_t width = (size_t)shot->width_px;
        const struct neph_pixel_ray ray = neph_camera_ray(camera, shot->width_px, shot->height_px,
                                                          (double)(pixel % width),
                                                          (double)(pixel / width));
        const struct neph_rgb depths = neph_scene_optical_depth(shot->scene, ray.origin_m,
                                                                ray.direction, 0.0, INFINITY);
        double depth = fmax(depths.r, fmax(depths.g, depths.b));
        double phase_per_sr = neph_phase_per_sr(
            phase, neph_vec3_dot(shot->scene->sun.direction, ray.direction));
        brightest = fmax(brightest, phase_per_sr * -expm1(-depth));
    }
    return brightest;
}

/* The densest that all media together could be, in any colour. */
static double densest_per_m(const struct session *session)
{
    double sum_per_m = 0.0;
    for (int i = 0; i < session->shot.scene->medium_count; i++) {
        const struct neph_rgb color = session->shot.scene->media[i].extinction_color;
        if (session->world.containers[i].used)
            sum_per_m += session->world.containers[i].extinction_per_m *
                         fmax(color.r, fmax(color.g, color.b));
    }
    return sum_per_m;
}

/* pi / h of the light that any ray passes at the distance h: the integral of 1/d^2. */
static double closest_per_m(const struct session *session, struct neph_vec3 light_m)
{
    const struct neph_shot *shot = &session->shot;
    double most_per_m = 0.0;
    for (size_t pixel = 0; pixel < session->pixel_count; pixel++) {
        const size_t width = (size_t)shot->width_px;
        const struct neph_pixel_ray ray = neph_camera_ray(&session->world.camera, shot->width_px,
                                                          shot->height_px, (double)(pixel % width),
                                                          (double)(pixel / width));
        const struct neph_vec3 way_m = neph_vec3_sub(light_m, ray.origin_m);
        const double height_m = neph_vec3_length(neph_vec3_cross(way_m, ray.direction));
        most_per_m = fmax(most_per_m, M_PI / fmax(height_m, 1e-6));
    }
    return most_per_m;
}

/* The largest part of one unit of radiant intensity that media of one phase function and albedo 1
 * could send into a pixel, of all lights: as if none were lost on its way and all were air. */
static double brightest_lamplight_per_m2(const struct session *session,
                                         const struct neph_phase *phase)
{
    const double phase_per_sr = fmax(neph_phase_per_sr(phase, 1.0), neph_phase_per_sr(phase, -1.0));
    double sum_per_m = 0.0;
    for (int i = 0; i < session->shot.scene->light_count; i++)
        sum_per_m += closest_per_m(session, session->shot.scene->lights[i].position_m);
    return sum_per_m * densest_per_m(session) * phase_per_sr;
}

static struct sources scattering_sources(const struct session *session,
                                         const struct neph_phase *phase)
{
    const struct neph_scene *scene = session->shot.scene;
    struct sources sources = {.count = 0};
    for (int i = 0; i < scene->medium_count; i++) {
        const struct neph_medium *medium = &scene->media[i];
        if (!session->world.containers[i].used || !neph_povray_same_phase(phase, &medium->phase))
            continue;
        if (scene->sun.present)
            add_source(&sources, neph_rgb_mul(medium->albedo, scene->sun.irradiance_w_per_m2));
        for (int l = 0; l < scene->light_count; l++)
            add_source(&sources, neph_rgb_mul(medium->albedo, scene->lights[l].intensity_w_per_sr));
    }
    return sources;
}

/* Was this medium's phase function the turn of an earlier medium? */
static bool is_repeated(const struct session *session, int medium)
{
    const struct neph_scene *scene = session->shot.scene;
    for (int i = 0; i < medium; i++) {
        if (session->world.containers[i].used &&
            neph_povray_same_phase(&scene->media[i].phase, &scene->media[medium].phase))
            return true;
    }
    return false;
}

static enum neph_status add_volume(struct session *session, struct light *volume,
                                   struct neph_diag *diag)
{
    const struct neph_scene *scene = session->shot.scene;
    enum neph_status status = NEPH_OK;
    if (!(scene->sun.present || scene->light_count > 0) ||
        scene->scattering == NEPH_SCATTERING_NONE)
        return NEPH_OK;
    for (int i = 0; !status && i < scene->medium_count; i++) {
        if (!session->world.containers[i].used || is_repeated(session, i))
            continue;
        char name[32];
        struct neph_povray_pass pass = {.kind = NEPH_POVRAY_VOLUME, .phase = scene->media[i].phase};
        struct sources sources = scattering_sources(session, &pass.phase);
        snprintf(name, sizeof(name), "volume%d", i + 1);
        const double bound = (scene->sun.present ? brightest_scattering_per_sr(session, &pass.phase)
                                                 : 0.0) +
                             brightest_lamplight_per_m2(session, &pass.phase);
        status = add_picture(session, name, pass, &sources, bound, volume, diag);
    }
    return status;
}

/* A picture is nowhere brighter than the brightest of its media were, if it were opaque. */
static enum neph_status add_emission(struct session *session, struct light *volume,
                                     struct neph_diag *diag)
{
    const struct neph_scene *scene = session->shot.scene;
    struct neph_povray_pass pass = {.kind = NEPH_POVRAY_EMISSION};
    struct sources sources = {.count = 0};
    for (int i = 0; i < scene->medium_count; i++)
        if (session->world.containers[i].used)
            add_source(&sources, neph_medium_glow(&scene->media[i]));
    return add_picture(session, "emission", pass, &sources, 1.0, volume, diag);
}

/* From a point to a box, 0 inside. */
static double distance_m(const struct neph_bounds *box, struct neph_vec3 point_m)
{
    const struct neph_vec3 out_m = {
        fmax(0.0, fmax(box->min_m.x - point_m.x, point_m.x - box->max_m.x)),
        fmax(0.0, fmax(box->min_m.y - point_m.y, point_m.y - box->max_m.y)),
        fmax(0.0, fmax(box->min_m.z - point_m.z, point_m.z - box->max_m.z))};
    return neph_vec3_length(out_m);
}

/* Each light as bright as it is where the solid's box comes nearest to it; a ball is farther away.
 */
static void add_lamplit(struct sources *sources, const struct neph_scene *scene,
                        const struct neph_solid *solid, struct neph_rgb color)
{
    const struct neph_bounds box = neph_solid_bounds(solid);
    for (int l = 0; l < scene->light_count; l++) {
        const double near_m = fmax(1e-3, distance_m(&box, scene->lights[l].position_m));
        add_source(sources, neph_rgb_scale(neph_rgb_mul(color, scene->lights[l].intensity_w_per_sr),
                                           scene->light_count / (M_PI * near_m * near_m)));
    }
}

static void add_sunlit(struct sources *sources, const struct neph_scene *scene,
                       struct neph_rgb color)
{
    if (scene->sun.present)
        add_source(sources,
                   neph_rgb_scale(neph_rgb_mul(color, scene->sun.irradiance_w_per_m2), 1.0 / M_PI));
}

static enum neph_status add_surface(struct session *session, struct light *surface,
                                    struct neph_diag *diag)
{
    const struct neph_scene *scene = session->shot.scene;
    struct neph_povray_pass pass = {.kind = NEPH_POVRAY_SURFACE};
    struct sources sources = {.count = 0};
    add_source(&sources, scene->background_w_per_m2_sr);
    for (int i = 0; i < scene->solid_count; i++)
        add_sunlit(&sources, scene, scene->solids[i].albedo);
    for (int i = 0; i < scene->solid_count; i++)
        add_lamplit(&sources, scene, &scene->solids[i], scene->solids[i].albedo);
    for (int i = 0; i < scene->solid_count; i++) {
        const struct neph_surface *look = &scene->solids[i].surface;
        if (!neph_is_textured(look))
            continue;
        add_sunlit(&sources, scene, look->texture.other);
        add_lamplit(&sources, scene, &scene->solids[i], look->texture.other);
    }
    return add_picture(session, "surface", pass, &sources, 1.0, surface, diag);
}

/* ---- The layers of the frame ---------------------------------------------------------------- */

static enum neph_status radiance_layers(struct session *session, struct neph_image *frame,
                                        struct neph_diag *diag)
{
    float *all[3], *scattered[3];
    struct light volume = {.planes = {NULL}}, surface = {.planes = {NULL}};
    enum neph_status status = make_light(session->pixel_count, &volume, diag);
    if (!status)
        status = make_light(session->pixel_count, &surface, diag);
    if (!status)
        status = neph_image_add_rgb(frame, NULL, all, diag);
    if (!status)
        status = neph_image_add_rgb(frame, "volume", scattered, diag);
    if (!status)
        status = add_volume(session, &volume, diag);
    if (!status)
        status = add_emission(session, &volume, diag);
    if (!status)
        status = add_surface(session, &surface, diag);
    for (int channel = 0; !status && channel < 3; channel++) {
        for (size_t i = 0; i < session->pixel_count; i++) {
            double from_media = volume.planes[channel][i];
            scattered[channel][i] = (float)from_media;
            all[channel][i] = (float)(from_media + surface.planes[channel][i]);
        }
    }
    free_light(&volume);
    free_light(&surface);
    return status;
}

static bool has_media(const struct session *session)
{
    for (int i = 0; i < session->shot.scene->medium_count; i++) {
        if (session->world.containers[i].used)
            return true;
    }
    return false;
}

static void take_transmittance(const struct neph_povray_reading *readings, size_t count,
                               float *layer)
{
    for (size_t i = 0; i < count; i++)
        layer[i] = readings ? (float)fmin(readings[i].value, 1.0) : 1.0f;
}

/* A colour that is attenuated like an earlier one is not rendered again. */
static enum neph_status transmittance_layer(struct session *session, struct neph_image *frame,
                                            struct neph_diag *diag)
{
    static const char *const names[3] = {"transmittance-r", "transmittance-g", "transmittance-b"};
    float *layer[3];
    struct neph_povray_pass pass = {.kind = NEPH_POVRAY_TRANSMITTANCE};
    enum neph_status status = neph_image_add_rgb(frame, "transmittance", layer, diag);
    for (int channel = 0; !status && channel < 3; channel++) {
        double wall_s = 0.0;
        struct neph_povray_reading *readings = NULL;
        if (channel > 0 && same_extinction(session->shot.scene, channel - 1, channel)) {
            memcpy(layer[channel], layer[channel - 1], session->pixel_count * sizeof(float));
            continue;
        }
        pass.channel = channel;
        if (has_media(session))
            status = expose(session, names[channel], pass, 1.0, &transmittance_target, &readings,
                            &wall_s, diag);
        if (!status)
            take_transmittance(readings, session->pixel_count, layer[channel]);
        free(readings);
    }
    return status;
}

static enum neph_status depth_layer(struct session *session, struct neph_image *frame,
                                    struct neph_diag *diag)
{
    float *layer = NULL;
    double wall_s = 0.0;
    uint16_t *codes = NULL;
    struct neph_povray_pass pass = {.kind = NEPH_POVRAY_DEPTH};
    double range_m = session->world.depth_range_m;
    enum neph_status status = neph_image_add_channel(frame, "Z", &layer, diag);
    if (!status && range_m > 0.0)
        status = render_picture(session, "depth", &pass, &codes, &wall_s, diag);
    for (size_t i = 0; !status && i < session->pixel_count; i++) {
        double depth_m = INFINITY;
        bool solid = codes && neph_povray_read_depth(codes + 3 * i, range_m, &depth_m);
        layer[i] = solid ? (float)depth_m : INFINITY;
    }
    free(codes);
    return status;
}

static enum neph_status add_attributes(const struct session *session, struct neph_image *frame,
                                       struct neph_diag *diag)
{
    const int *renders = session->renders;
    enum neph_status status = neph_image_set_attribute(frame, "neph.povray.intervals", diag, "%d",
                                                       session->world.intervals);
    if (!status)
        status = neph_image_set_attribute(
            frame, "neph.povray.passes", diag, "volume %d, surface %d, transmittance %d, depth %d",
            renders[NEPH_POVRAY_VOLUME], renders[NEPH_POVRAY_SURFACE],
            renders[NEPH_POVRAY_TRANSMITTANCE], renders[NEPH_POVRAY_DEPTH]);
    if (!status && renders[NEPH_POVRAY_EMISSION] > 0)
        status = neph_image_set_attribute(frame, "neph.povray.emission_passes", diag, "%d",
                                          renders[NEPH_POVRAY_EMISSION]);
    if (!status)
        status = neph_image_set_attribute(frame, "neph.povray.cut_error", diag, "%.3g",
                                          session->world.cut_error);
    if (!status)
        status = neph_image_set_attribute(frame, "neph.povray.shift_optical_depth", diag, "%.3g",
                                          session->world.shift_error);
    if (!status)
        status = neph_image_set_attribute(
            frame, "neph.povray.render_s", diag,
            "wall time of the last volume and surface processes, start-up of about 0.6 s included");
    if (!status)
        status = neph_bakes_label(session->baked.bakes, session->baked.bake_count, frame, diag);
    return status;
}

/* ---- The engine ----------------------------------------------------------------------------- */

static enum neph_status write_noise(const struct neph_solid *solid, const char *directory,
                                    struct neph_diag *diag)
{
    char name[NEPH_POVRAY_FILE_NAME_MAX];
    struct neph_grid *grid = NULL;
    neph_povray_noise_name(solid->surface.texture.seed, name);
    char *path = neph_path_join(directory, name);
    enum neph_status status = path ? neph_povray_noise(solid->surface.texture.seed, &grid, diag)
                                   : neph_fail_memory(diag);
    if (!status)
        status = neph_volume_write_df3(path, grid, diag);
    neph_grid_destroy(grid);
    free(path);
    return status;
}

static enum neph_status write_noises(const struct neph_scene *scene, const char *directory,
                                     struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < scene->solid_count && !status; i++)
        if (neph_is_textured(&scene->solids[i].surface) &&
            scene->solids[i].surface.texture.pattern == NEPH_PATTERN_NOISE)
            status = write_noise(&scene->solids[i], directory, diag);
    return status;
}

static enum neph_status write_grids(const struct session *session, const char *directory,
                                    struct neph_diag *diag)
{
    const struct neph_scene *scene = session->shot.scene;
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < scene->medium_count && !status; i++) {
        if (!session->world.containers[i].used || !scene->media[i].grid)
            continue;
        const struct neph_grid scaled = neph_povray_grid(scene->media[i].grid);
        char name[NEPH_POVRAY_FILE_NAME_MAX];
        neph_povray_grid_name(i, name);
        char *path = neph_path_join(directory, name);
        status = path ? neph_volume_write_df3(path, &scaled, diag) : neph_fail_memory(diag);
        free(path);
    }
    return status;
}

static enum neph_status adapt_scene(const struct neph_shot *shot, struct session *session,
                                    struct neph_diag *diag)
{
    const int intervals = (int)neph_setting(&neph_engine_povray, &shot->settings, "intervals");
    const int resolution = (int)neph_setting(&neph_engine_povray, &shot->settings,
                                             "bake_resolution");
    struct neph_diag why = {0};
    enum neph_status status = neph_baked_scene_make(shot->scene, resolution, &session->baked, &why);
    session->shot.scene = &session->baked.scene;
    if (!status)
        status = neph_povray_world(session->shot.scene, shot->frame, shot->width_px,
                                   shot->height_px, intervals, &session->world, &why);
    if (!status)
        status = neph_povray_cut_rays(&session->world, &why);
    session->world.cut_error += session->baked.cut_error;
    if (!status && wants_radiosity(session->shot.scene))
        session->world.radiosity = (struct neph_povray_radiosity){
            (int)neph_setting(&neph_engine_povray, &shot->settings, "radiosity_rays"),
            neph_setting(&neph_engine_povray, &shot->settings, "radiosity_error"),
            (int)neph_setting(&neph_engine_povray, &shot->settings, "photons")};
    return neph_external_cannot("POV-Ray", status, &why, diag);
}

/* Grids and the ini go to `directory`. The caller ends session->baked, whatever the status. */
static enum neph_status start(const struct neph_shot *shot, const char *directory,
                              struct session *session, struct neph_diag *diag)
{
    *session = (struct session){.shot = *shot, .threads = thread_count(shot->scene)};
    session->pixel_count = (size_t)shot->width_px * (size_t)shot->height_px;
    char reason[256] = "";
    if (!can_render(shot->scene, &shot->settings, reason, sizeof(reason)))
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "POV-Ray cannot: %s", reason);
    enum neph_status status = adapt_scene(shot, session, diag);
    if (!status)
        status = write_ini(directory, diag);
    if (!status)
        status = write_noises(session->shot.scene, directory, diag);
    return status ? status : write_grids(session, directory, diag);
}

static enum neph_status render(const struct neph_shot *shot, struct neph_image **frame,
                               struct neph_cost *cost, struct neph_diag *diag)
{
    double start_s = neph_wall_s();
    struct session session;
    struct neph_image *image = NULL;
    enum neph_status status = start(shot, shot->scratch_directory, &session, diag);
    if (!status)
        status = neph_image_create(shot->width_px, shot->height_px, &image, diag);
    if (!status && (shot->layers & NEPH_LAYER_RADIANCE))
        status = radiance_layers(&session, image, diag);
    if (!status && (shot->layers & NEPH_LAYER_TRANSMITTANCE))
        status = transmittance_layer(&session, image, diag);
    if (!status && (shot->layers & NEPH_LAYER_DEPTH))
        status = depth_layer(&session, image, diag);
    if (!status)
        status = add_attributes(&session, image, diag);
    neph_baked_scene_finish(&session.baked);
    if (status) {
        neph_image_destroy(image);
        return status;
    }
    session.cost.wall_s = neph_wall_s() - start_s;
    *cost = session.cost;
    *frame = image;
    return NEPH_OK;
}

static enum neph_status export_scene(const struct neph_shot *shot, const char *directory,
                                     char *command, size_t command_size, struct neph_diag *diag)
{
    struct session session;
    struct neph_povray_pass beauty = {.kind = NEPH_POVRAY_BEAUTY,
                                      .gain = exp2(shot->scene->exposure_ev)};
    char *path = neph_path_join(directory, "scene.pov");
    enum neph_status status = start(shot, directory, &session, diag);
    if (!status)
        status = path ? write_scene(&session, &beauty, path, diag) : neph_fail_memory(diag);
    free(path);
    neph_baked_scene_finish(&session.baked);
    if (!status)
        snprintf(command, command_size,
                 "POVINI=povray.ini povray +Iscene.pov +Oscene.png +FN16 Dither=off +W%d +H%d -A "
                 "-D -P -GA +WT%d "
                 "+BS8",
                 shot->width_px, shot->height_px, session.threads);
    return status;
}

const struct neph_engine neph_engine_povray = {
    .name = "povray",
    .summary = "POV-Ray 3.7 media, single scattering; between solids all of it, by radiosity",
    .rung = NEPH_RUNG_WITNESS,
    .typical_s = 12.0,
    .bias = "single scattering only; midpoint rule of its intervals, error ~ 1/intervals^2 (~ "
            "1/intervals at the edges of shadows); 16-bit output in brackets: 1e-4 of the value "
            "or 1e-6 of the brightest, transmittance to 1e-8; what it has no formula for is baked "
            "to voxels; radiosity shares light among places: 0.01 to 1 % of it, docs/surfaces.md",
    .options = options,
    .version = 4,
    /* At most 256 intervals: POV-Ray ends with an error beyond. */
    .step = {.option = "intervals", .coarsest = 25, .refine = 2, .level_count = 4, .order = 2},
    .probe = probe,
    .can_render = can_render,
    .render = render,
    .export_scene = export_scene,
};
