/* SPDX-License-Identifier: MIT
 *
 * The window through SDL 2. No other file includes SDL.
 */
#include "harness/fly/window.h"

#include <SDL.h>
#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>

static const char library_name[] = "libSDL2-2.0.so.0";

/* The used functions of SDL. */
/* clang-format off */
#define SDL_FUNCTIONS(of) \
    of(Init) of(Quit) of(GetError) of(SetHint) of(GetCurrentVideoDriver) \
    of(CreateWindow) of(DestroyWindow) of(SetWindowTitle) of(SetRelativeMouseMode) \
    of(CreateRenderer) of(DestroyRenderer) of(RenderSetLogicalSize) \
    of(CreateTexture) of(DestroyTexture) of(UpdateTexture) \
    of(RenderClear) of(RenderCopy) of(RenderPresent) \
    of(PollEvent) of(PushEvent)
/* clang-format on */

struct sdl {
    void *library;
#define POINTER(name) __typeof__(SDL_##name) *name;
    SDL_FUNCTIONS(POINTER)
#undef POINTER
};

struct neph_window {
    struct sdl sdl;
    bool is_ready; /* SDL is initialised, so it needs SDL_Quit() */
    SDL_Window *window;
    SDL_Renderer *renderer;
    SDL_Texture *texture;
    int width_px, height_px; /* of the frames */
};

/* ---- the library ----------------------------------------------------------------------------- */

static const struct {
    const char *name;
    size_t at;
} functions[] = {
#define ROW(name) {"SDL_" #name, offsetof(struct sdl, name)},
    SDL_FUNCTIONS(ROW)
#undef ROW
};

static enum neph_status load(struct sdl *sdl, struct neph_diag *diag)
{
    sdl->library = dlopen(library_name, RTLD_NOW | RTLD_LOCAL);
    bool complete = sdl->library != NULL;
    for (size_t i = 0; i < sizeof(functions) / sizeof(functions[0]) && complete; i++) {
        void *function = dlsym(sdl->library, functions[i].name);
        memcpy((char *)sdl + functions[i].at, &function, sizeof(function));
        complete = function != NULL;
    }
    if (complete)
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_UNAVAILABLE, "SDL 2 cannot be opened: %s", dlerror());
    neph_hint(diag, "apt-get install libsdl2-2.0-0");
    return NEPH_ERR_UNAVAILABLE;
}

bool neph_window_has_library(void)
{
    void *library = dlopen(library_name, RTLD_LAZY | RTLD_LOCAL);
    if (library)
        dlclose(library);
    return library != NULL;
}

/* ---- open and close -------------------------------------------------------------------------- */

/* Whether the video driver has a screen. SDL falls back to drivers without one, whose windows are
 * invisible; a driver named in $SDL_VIDEODRIVER is accepted as it is. */
static bool has_screen(const struct sdl *sdl)
{
    static const char *const blind[] = {"dummy", "offscreen", "evdev"};
    const char *driver = sdl->GetCurrentVideoDriver();
    bool is_blind = !driver;
    for (size_t i = 0; i < sizeof(blind) / sizeof(blind[0]) && driver; i++)
        is_blind |= strcmp(driver, blind[i]) == 0;
    return !is_blind || getenv("SDL_VIDEODRIVER");
}

/* Initialise SDL: signal handlers off, because neph handles Ctrl-C; nearest-neighbour scaling, so
 * that pixels stay visible. */
static enum neph_status start(struct neph_window *window, struct neph_diag *diag)
{
    const struct sdl *sdl = &window->sdl;
    sdl->SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
    sdl->SetHint(SDL_HINT_RENDER_SCALE_QUALITY, "nearest");
    window->is_ready = sdl->Init(SDL_INIT_VIDEO) == 0;
    if (window->is_ready && has_screen(sdl))
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_UNAVAILABLE, "no window can be opened: %s",
              window->is_ready ? "there is no screen" : sdl->GetError());
    neph_hint(diag, "is there a display ($DISPLAY, $WAYLAND_DISPLAY)? Without a screen: "
                    "apt-get install xvfb, and xvfb-run -a neph fly ...");
    return NEPH_ERR_UNAVAILABLE;
}

static bool make(struct neph_window *window, const char *title)
{
    const struct sdl *sdl = &window->sdl;
    window->window = sdl->CreateWindow(title, SDL_WINDOWPOS_CENTERED, SDL_WINDOWPOS_CENTERED,
                                       window->width_px, window->height_px, SDL_WINDOW_RESIZABLE);
    if (window->window)
        window->renderer = sdl->CreateRenderer(window->window, -1, 0);
    if (window->renderer)
        window->texture = sdl->CreateTexture(window->renderer, SDL_PIXELFORMAT_RGB24,
                                             SDL_TEXTUREACCESS_STREAMING, window->width_px,
                                             window->height_px);
    return window->texture &&
           sdl->RenderSetLogicalSize(window->renderer, window->width_px, window->height_px) == 0;
}

enum neph_status neph_window_open(const char *title, int width_px, int height_px,
                                  struct neph_window **window, struct neph_diag *diag)
{
    struct neph_window *made = calloc(1, sizeof(*made));
    if (!made)
        return neph_fail_memory(diag);
    made->width_px = width_px;
    made->height_px = height_px;
    enum neph_status status = load(&made->sdl, diag);
    if (!status)
        status = start(made, diag);
    if (!status && !make(made, title))
        status = neph_fail(diag, NEPH_ERR_UNAVAILABLE, "no window of %dx%d can be opened: %s",
                           width_px, height_px, made->sdl.GetError());
    if (status)
        neph_window_close(made);
    else
        *window = made;
    return status;
}

void neph_window_close(struct neph_window *window)
{
    if (!window)
        return;
    const struct sdl *sdl = &window->sdl;
    if (window->texture)
        sdl->DestroyTexture(window->texture);
    if (window->renderer)
        sdl->DestroyRenderer(window->renderer);
    if (window->window)
        sdl->DestroyWindow(window->window);
    if (window->is_ready)
        sdl->Quit();
    /* The library stays loaded: threads of its own dependencies may still run its code. */
    free(window);
}

void neph_window_set_title(struct neph_window *window, const char *title)
{
    window->sdl.SetWindowTitle(window->window, title);
}

void neph_window_capture(struct neph_window *window, bool is_captured)
{
    window->sdl.SetRelativeMouseMode(is_captured ? SDL_TRUE : SDL_FALSE);
}

/* ---- events ---------------------------------------------------------------------------------- */

static const struct {
    SDL_Keycode sdl;
    int key;
} keys[] = {
    {SDLK_LSHIFT, NEPH_FLY_KEY_SHIFT},
    {SDLK_RSHIFT, NEPH_FLY_KEY_SHIFT},
    {SDLK_HOME, NEPH_FLY_KEY_HOME},
    {SDLK_PLUS, '='},
    {SDLK_KP_PLUS, '='},
    {SDLK_KP_MINUS, '-'},
};

static int convert_key_code(SDL_Keycode code)
{
    for (size_t i = 0; i < sizeof(keys) / sizeof(keys[0]); i++)
        if (keys[i].sdl == code)
            return keys[i].key;
    return code > 0 && code < 128 ? (int)code : NEPH_FLY_KEY_NONE;
}

static SDL_Keycode sdl_key_code(int key)
{
    for (size_t i = 0; i < sizeof(keys) / sizeof(keys[0]); i++)
        if (keys[i].key == key && key >= 128)
            return keys[i].sdl;
    return key;
}

static enum neph_fly_button convert_button(int button)
{
    return button == SDL_BUTTON_LEFT    ? NEPH_FLY_BUTTON_LEFT
           : button == SDL_BUTTON_RIGHT ? NEPH_FLY_BUTTON_RIGHT
                                        : NEPH_FLY_BUTTON_OTHER;
}

/* Convert a mouse event. The SDL renderer has already scaled the position to frame pixels. */
static bool convert_mouse_event(const struct neph_window *window, const SDL_Event *from,
                                struct neph_fly_event *event)
{
    const double width_px = window->width_px, height_px = window->height_px;
    if (from->type == SDL_MOUSEMOTION) {
        *event = (struct neph_fly_event){.kind = NEPH_FLY_MOUSE_MOVED,
                                         .x_share = from->motion.x / width_px,
                                         .dx_share = from->motion.xrel / height_px,
                                         .dy_share = from->motion.yrel / height_px};
        return true;
    }
    if (from->type == SDL_MOUSEWHEEL) {
        *event = (struct neph_fly_event){.kind = NEPH_FLY_WHEEL, .wheel = from->wheel.y};
        return true;
    }
    *event = (struct neph_fly_event){
        .kind = from->type == SDL_MOUSEBUTTONDOWN ? NEPH_FLY_BUTTON_DOWN : NEPH_FLY_BUTTON_UP,
        .button = convert_button(from->button.button),
        .x_share = from->button.x / width_px};
    return from->type == SDL_MOUSEBUTTONDOWN || from->type == SDL_MOUSEBUTTONUP;
}

/* Convert an event; false: the event is not used. */
static bool take(const struct neph_window *window, const SDL_Event *from,
                 struct neph_fly_event *event)
{
    switch (from->type) {
    case SDL_KEYDOWN:
    case SDL_KEYUP:
        *event = (struct neph_fly_event){.kind = from->type == SDL_KEYDOWN ? NEPH_FLY_KEY_DOWN
                                                                           : NEPH_FLY_KEY_UP,
                                         .key = convert_key_code(from->key.keysym.sym)};
        return from->key.repeat == 0;
    case SDL_QUIT:
        *event = (struct neph_fly_event){.kind = NEPH_FLY_CLOSED};
        return true;
    case SDL_WINDOWEVENT:
        *event = (struct neph_fly_event){.kind = NEPH_FLY_FOCUS_LOST};
        return from->window.event == SDL_WINDOWEVENT_FOCUS_LOST;
    default:
        return convert_mouse_event(window, from, event);
    }
}

bool neph_window_next(struct neph_window *window, struct neph_fly_event *event)
{
    SDL_Event from;
    while (window->sdl.PollEvent(&from))
        if (take(window, &from, event))
            return true;
    return false;
}

void neph_window_push_key(struct neph_window *window, int key, bool is_down)
{
    SDL_Event event = {.type = is_down ? SDL_KEYDOWN : SDL_KEYUP};
    event.key.state = is_down ? SDL_PRESSED : SDL_RELEASED;
    event.key.keysym.sym = sdl_key_code(key);
    window->sdl.PushEvent(&event);
}

/* ---- frames ---------------------------------------------------------------------------------- */

enum neph_status neph_window_show(struct neph_window *window, const uint8_t *rgb,
                                  struct neph_diag *diag)
{
    const struct sdl *sdl = &window->sdl;
    const bool shown = sdl->UpdateTexture(window->texture, NULL, rgb, 3 * window->width_px) == 0 &&
                       sdl->RenderClear(window->renderer) == 0 &&
                       sdl->RenderCopy(window->renderer, window->texture, NULL, NULL) == 0;
    if (!shown)
        return neph_fail(diag, NEPH_ERR_ENGINE, "SDL: %s", sdl->GetError());
    sdl->RenderPresent(window->renderer);
    return NEPH_OK;
}
