# SPDX-License-Identifier: MIT
"""Scenes of the suite `motion_test`: no setting is chosen by these."""
import random

from parts import (bar, blob, box, cumulus, fence, ground, hand, haze, height_fog, lumps, orbit,
                   pan, plume, post, sample, shake, shots, still, straight, sun, sun_path, sway,
                   turn, weave)

MARCH = "the march, in every frame"
NOON = (0.12, 0.21, 0.36)
GRASS, ROCK, TIMBER, IRON = (0.08, 0.11, 0.05), (0.32, 0.26, 0.21), (0.22, 0.17, 0.12), 0.22


def rocks(seed, count, near, far, path_m, tall):
    """Pillars on both sides of a way along -z."""
    draw = random.Random(seed)
    return [post((1 if i % 2 else -1) * (path_m + draw.uniform(0, 1.6 * path_m)),
                 near + (far - near) * (i + draw.random()) / count,
                 draw.uniform(0.25, 0.6) * path_m, draw.uniform(0.6, 1) * tall, ROCK)
            for i in range(count)]


def frame_of_pipes(x, y, z, columns, rows, pitch, width):
    """A scaffold: upright pipes and lying ones."""
    wide, high = pitch * (columns - 1), pitch * rows
    return [post(x + pitch * i, z, width, high, IRON, y) for i in range(columns)] + [
        bar((x + 0.5 * wide, y + pitch * (i + 1) - width, z + width), (wide, width, width), IRON)
        for i in range(rows)]


SCENES = [
    {"name": "gorge_flight", "title": "A flight between pillars of rock in mist",
     "isolates": """A quick camera in a medium: 25 m/s between thick solids in mist, so that edges
         cross the frame within a second and fog covers the far ones.""",
     "fov_deg": 58, "ev": -0.5, "sky": (0.14, 0.18, 0.24),
     "sun": sun((-0.5, 0.7, 0.4), (10, 9.4, 8.6)),
     "camera": sample(straight((0, 18, 10), 0, 25, -2), 256),
     "solids": [ground((-300, -600), (300, 40), ROCK)] + rocks(31, 30, -15, -330, 10, 46),
     "media": [height_fog(0.02, 0.06, (-200, 0, -500), (200, 40, 40), 0.4)]},

    {"name": "deck_skim", "title": "A flight above a deck of clouds, past peaks",
     "isolates": """A quick camera close to clouds: 90 m/s above their tops and past peaks between
         them; far clouds move by fractions of a pixel.""",
     "reference": MARCH, "fov_deg": 52, "ev": -1, "sky": NOON, "sun": sun((0.6, 0.55, 0.3)),
     "camera": sample(straight((0, 1500, 900), -4, 90, -6), 256),
     "solids": [ground((-9000, -12000), (9000, 3000), (0.03, 0.05, 0.08))] + [
         post(x, z, w, h, ROCK) for x, z, w, h in (
         (-260, -500, 60, 1490), (330, -900, 90, 1530), (-520, -1500, 130, 1580),
         (180, -2000, 120, 1540), (640, -2600, 200, 1700), (-300, -3000, 150, 1620))],
     "media": [cumulus(17, 900, 560, 0.74, 0.05, (-2200, 880, -4200), (2200, 1460, 900))]},

    {"name": "bridge_walk", "title": "A walk over a suspension bridge above mist",
     "isolates": """A walking camera among thin solids: 1.5 m/s past hangers that are rods near and
         parts of a pixel far away, before hills of mist.""",
     "fov_deg": 55, "ev": -0.5, "sky": NOON, "sun": sun((-0.6, 0.6, 0.3)),
     "camera": sample(straight((0.3, 1.7, 4), 0, 1.5, 2, 0.03)),
     "solids": [box((-2, -0.4, -70), (2, 0, 8), TIMBER),
                fence((-1.95, 0, 1), 2, 3.9, 0.06, 0.06, 2.6, IRON, rows=(13, 3.1)),
                box((-2, 2.6, -70), (-1.9, 2.7, 8), IRON), box((1.9, 2.6, -70), (2, 2.7, 8), IRON),
                box((-2, 1.05, -70), (-1.96, 1.1, 8), IRON), box((1.96, 1.05, -70), (2, 1.1, 8),
                    IRON)],
     "media": [blob((-30, -3, -60), 11, 0.12), blob((34, 2, -75), 14, 0.1),
               blob((-14, 8, -110), 12, 0.1), blob((20, 12, -130), 13, 0.1),
               blob((-55, 14, -120), 17, 0.07), blob((4, -8, -30), 5, 0.15)]},

    {"name": "pier_run", "title": "A run along a pier in sea fog",
     "isolates": """A running camera in dense fog: 4 m/s with the lift and sway of steps between two
         rows of posts that come out of the fog.""",
     "fov_deg": 58, "ev": 0, "sky": (0.18, 0.2, 0.22), "sun": sun((-0.4, 0.8, -0.4), (8, 7.8, 7.4)),
     "camera": sample(straight((0, 1.6, 4), 0, 4, 0, 0.05, 2.8)),
     "solids": [box((-1.8, -0.4, -80), (1.8, 0, 8), TIMBER), ground((-90, -120), (90, 20),
                                                                     (0.05, 0.07, 0.09), -1.6),
                fence((-1.85, -1.6, 0), 2, 3.5, 0.2, 0.2, 2.9, TIMBER, rows=(14, 3.6)),
                box((-1.78, 0.95, -60), (-1.72, 1.05, 8), TIMBER),
                box((1.72, 0.95, -60), (1.78, 1.05, 8), TIMBER), post(12, -26, 0.4, 9, TIMBER,
                    -1.6)],
     "media": [height_fog(0.075, 0.12, (-80, -1.6, -100), (80, 12, 18), 0.5)]},

    {"name": "square_turn", "title": "A quick turn on a foggy square",
     "isolates": """A quickly turning camera: 120 degrees per second, so that a quarter of the
         frame is new after four frames, past posts in fog.""",
     "fov_deg": 55, "ev": 0, "sky": (0.15, 0.18, 0.22), "sun": sun((0.5, 0.6, 0.4), (8, 7.4, 6.6)),
     "camera": sample(turn((0, 1.7, 0), 0, 120, 2), 1),
     "solids": [ground((-60, -60), (60, 60), (0.26, 0.24, 0.2))] + [
         post(x, z, w, h, ROCK) for x, z, w, h in (
             (-5, -7, 0.5, 4), (2, -6, 0.15, 3.4), (4, -13, 1.8, 6), (9, -4, 0.3, 4), (11, 5, 2, 7),
             (6, 9, 0.15, 3.4), (-1, 8, 0.5, 4), (-4, 15, 1.6, 7), (-9, 6, 0.15, 3.4),
             (-13, 1, 2.2, 6), (-7, -2, 0.12, 3.2), (-12, -12, 2, 8), (15, -15, 3, 9),
             (16, 16, 3, 8), (-18, 17, 3, 9), (3.2, 3.4, 0.1, 2.6))],
     "media": [height_fog(0.04, 0.18, (-50, 0, -50), (50, 12, 50), 0.4)]},

    {"name": "lookout_pan", "title": "A slow pan along a railing before cumulus",
     "isolates": """A slowly turning camera: at most 7 degrees per second to and fro, about a
         pixel per frame at 384x216, bars before clouds.""",
     "reference": MARCH, "fov_deg": 42, "ev": -1, "sky": NOON, "sun": sun((-0.5, 0.5, 0.6)),
     "camera": sample(pan((0, 301.7, 0), 0, 11, 9.87, 6)),
     "solids": [ground((-5000, -8000), (5000, 600), GRASS), box((-7, 299, -8), (7, 300, 4), ROCK),
                fence((-6.9, 300, -7.5), 26, 0.55, 0.05, 0.05, 4.2, IRON, ((1.2, 4), 0.06, 0.04))],
     "media": [cumulus(23, 620, 800, 0.6, 0.035, (-2200, 600, -3800), (2200, 1440, -600))]},

    {"name": "ruin_orbit", "title": "A shot around broken columns in ground fog",
     "isolates": """A camera on a circle inside fog: 20 degrees per second around columns, so that
         near and far edges move in opposite directions.""",
     "fov_deg": 48, "ev": 0, "sky": (0.12, 0.15, 0.2), "sun": sun((0.6, 0.6, 0.2), (9, 8.2, 7)),
     "camera": orbit((0, 2.2, 0), 13, 30, 20),
     "solids": [ground((-60, -60), (60, 60), (0.2, 0.18, 0.13))] + [
         post(6 * ((i * 37 % 13) / 6.5 - 1), 6 * ((i * 53 % 17) / 8.5 - 1), 0.7,
             1.4 + (i * 29 % 7) * 0.6,
              ROCK) for i in range(18)] + [
         bar((0, 4.7, 0), (5, 0.6, 0.8), ROCK, "z", 6), bar((1, 2.4, 2), (0.06, 4.8, 0.06), IRON),
         bar((-2, 2.1, -1), (0.06, 4.2, 0.06), IRON, "z", 8)],
     "media": [height_fog(0.07, 0.5, (-45, 0, -45), (45, 7, 45), 0.3)]},

    {"name": "balloon_orbit", "title": "A shot around a balloon between clouds",
     "isolates": """A slow circle: 6 degrees per second around a ball on ropes of a pixel, inside a
         ring of clouds of which some lie in front.""",
     "fov_deg": 44, "ev": -1, "sky": NOON, "sun": sun((0.4, 0.6, 0.7)),
     "camera": orbit((0, 120, 0), 34, -40, 6),
     "solids": ["  - sphere: {center_m: [0, 125, 0], radius_m: 6, albedo: [0.5, 0.12, 0.08]}",
                box((-1, 112.5, -1), (1, 114, 1), TIMBER),
                ground((-3000, -3000), (3000, 3000), GRASS)] + [
         bar((sx * 1.6, 117, sz * 0.95), (0.1, 6.4, 0.1), IRON, "z", -sx * 11)
         for sx in (-1, 1) for sz in (-1, 1)],
     "media": [blob((-40, 118, -50), 11, 0.16), blob((30, 128, -62), 13, 0.14),
               blob((66, 116, 4), 12, 0.15), blob((38, 130, 60), 14, 0.13),
               blob((-26, 120, 66), 11, 0.15), blob((-70, 132, 12), 14, 0.13),
               blob((-9, 113, 16), 2.4, 0.25)]},

    {"name": "truck_shake", "title": "A truck shakes before a scaffold in dust",
     "isolates": """A camera that shakes slower and wider: 6 cm and 1 degree at 2 and 3 Hz,
         before a grid of pipes in dust.""",
     "fov_deg": 52, "ev": 0, "sky": (0.3, 0.32, 0.34), "sun": sun((0.6, 0.6, 0.4), (9, 8, 6.6)),
     "camera": sample(shake((0, 2.4, 7), 0, 4, 0.06, 1, 2.1), 1), "wind": (0.8, 0, 0.3),
     "solids": [ground((-60, -80), (60, 14), (0.32, 0.26, 0.18)),
                box((-12, 0, -20), (12, 9, -16), ROCK), post(-7, -3, 0.1, 3, IRON),
                post(7.5, -5, 0.1, 3, IRON)] + frame_of_pipes(-7, 0, -10, 15, 7, 1.05, 0.06),
     "media": [blob((-6, 1.2, -6), 1.7, 0.25, (0.9, 0.75, 0.55)),
               blob((-1, 1.6, -12.5), 2.2, 0.25, (0.9, 0.75, 0.55)),
               blob((5, 1, -7.5), 1.6, 0.3, (0.9, 0.75, 0.55)),
               haze(0.015, (-40, 0, -60), (40, 12, 12), 0.4)]},

    {"name": "film_cuts", "title": "Moving shots of one valley, with cuts",
     "isolates": """Cuts between cameras that move: every 32 frames another of a flight, a turn and
         a walk, so that the history of a shot has to form while it moves.""",
     "fov_deg": 50, "ev": -1, "sky": NOON, "sun": sun((-0.6, 0.6, 0.3)),
     "camera": shots([straight((-30, 26, 40), 20, 12, -8), turn((0, 2, 0), -40, 12, 6),
                      straight((6, 1.7, -20), -20, 1.4, 8)], 32),
     "solids": [ground((-600, -700), (600, 100), GRASS), box((-9, 0, -46), (-3, 7, -38), ROCK),
                box((8, 0, -60), (16, 9, -50), ROCK), post(-18, -70, 6, 34, ROCK)] + [
         post(-16 + 3.1 * i, -24 - 2.4 * (i % 4), 0.24, 4 + (i % 3), TIMBER) for i in range(12)] + [
         fence((-6, 0, -9), 12, 1.1, 0.09, 0.09, 1.2, TIMBER, ((0.9,), 0.08, 0.05))],
     "media": [blob((-50, 30, -150), 17, 0.1), blob((10, 36, -170), 20, 0.09),
               blob((70, 32, -140), 18, 0.1), blob((-110, 40, -130), 20, 0.09),
               blob((-4, 2, -34), 3.2, 0.15),
               height_fog(0.006, 0.12, (-300, 0, -400), (300, 20, 60))]},

    {"name": "reed_breeze", "title": "Reeds sway before mist",
     "isolates": """Thin solids and mist that move apart: reeds of a pixel to two at
         384x216 sway with a period of 64 frames before wisps in a wind of 0.8 m/s.""",
     "fov_deg": 38, "ev": -0.5, "sky": (0.13, 0.17, 0.22),
     "sun": sun((-0.6, 0.5, 0.4), (10, 9, 7.6)),
     "camera": still((0, 1.2, 0), (0, 1.6, -10)), "wind": (-0.8, 0, 0),
     "solids": [ground((-60, -80), (60, 5), (0.06, 0.09, 0.08)),
                box((-30, 0, -60), (30, 3.5, -56), GRASS)] + [
         fence((-2.6 + 0.21 * i, 0, -6 - 0.5 * i), 8, 0.67 + 0.05 * i, 0.03, 0.03,
             2.1 + 0.2 * (i % 3),
               (0.16, 0.2, 0.08), motion=sway(0.05 + 0.01 * i, 64, 1.3 * i)) for i in range(4)],
     "media": [blob((-5, 1.2, -16), 1.5, 0.35), blob((0, 1.5, -19), 1.9, 0.28),
               blob((4, 1.1, -15), 1.3, 0.4), blob((8, 1.6, -20), 2.1, 0.25),
               blob((12, 1.3, -17), 1.7, 0.3)]},

    {"name": "gale_lines", "title": "Power lines before clouds of a gale",
     "isolates": """Quick clouds: 40 m/s are more than two pixels per frame at
         384x216 behind pylons and lines.""",
     "fov_deg": 42, "ev": -0.5, "sky": (0.14, 0.18, 0.24),
     "sun": sun((-0.5, 0.7, 0.5), (10, 9.8, 9.4)),
     "camera": still((0, 1.7, 0), (-2, 7, -20)), "wind": (-40, 0, 6),
     "solids": [ground((-400, -500), (400, 30), GRASS)] + [
         solid for x, z in ((-13, -32), (12, -46)) for solid in (
             bar((x - 0.9, 8, z), (0.2, 16.2, 0.2), IRON, "z", -5),
             bar((x + 0.9, 8, z), (0.2, 16.2, 0.2), IRON, "z", 5),
             bar((x, 12, z), (7, 0.18, 0.18), IRON), bar((x, 15, z), (5, 0.18, 0.18), IRON),
             bar((x, 6, z), (2.2, 0.12, 0.12), IRON))] + [
         bar((0, 11.6 + 3 * (i // 2), -39 + 2 * (i % 2)), (64, 0.12, 0.12), IRON, "y", 29)
         for i in range(4)],
     "media": [lumps(44, (16, 5, 5), (-40, 18, -190), (15, 10, 13), 0.1, 3, 0.39)]},

    {"name": "scaffold_smoke", "title": "Smoke drifts behind a scaffold",
     "isolates": """Smoke in a steady wind: voxels at 5 m/s, less than a pixel per frame at 384x216,
         behind crossed pipes of a pixel.""",
     "fov_deg": 42, "ev": -0.5, "sky": (0.3, 0.36, 0.44),
     "sun": sun((0.5, 0.7, 0.4), (10, 9.4, 8.6)),
     "camera": still((0, 1.7, 0), (0, 4.2, -16)), "wind": (5, 0, 0),
     "solids": [ground((-100, -160), (100, 8), (0.2, 0.18, 0.15))] +
     frame_of_pipes(-9, 0, -18, 13, 8, 1.5, 0.075) + [box((-40, 0, -80), (-14, 9, -70), ROCK)],
     "media": [lumps(50, (16, 6, 4), (-104, 3, -62), (3.2, 3.8, 3.2), 0.35, 3, 0.36),
               plume((6, 0.2, -60), (0.5, 1, 0), 1.6, 9, 0.3, (0.4, 0.38, 0.36))]},

    {"name": "obelisk_day", "title": "The sun races around an obelisk in haze",
     "isolates": """A quick sun: 0.8 degrees per frame around a tall solid, so that its shadow in
         haze and on the ground turns like the hand of a clock.""",
     "fov_deg": 46, "ev": 0, "sky": (0.12, 0.17, 0.26),
     "sun": sun_path(20, 32, 204.8, 0, (9, 8.4, 7.6), (9, 8, 6.8)),
     "camera": still((9, 9, 22), (0, 4, 0)),
     "solids": [ground((-80, -80), (80, 40), (0.3, 0.26, 0.2)), post(0, 0, 1.4, 12, ROCK),
                box((-2, 0, -2), (2, 0.8, 2), ROCK)] + [
         post(7.5 * (i % 4) - 11, 6 * (i // 4) - 9, 0.2, 2.4, IRON) for i in range(12)] + [
         bar((0, 2.2, -9 + 6 * i), (24, 0.06, 0.06), IRON) for i in range(3)],
     "media": [haze(0.03, (-40, 0, -40), (40, 14, 30), 0.3)]},

    {"name": "blinds_evening", "title": "Evening sun through blinds into a dusty yard",
     "isolates": """A slow sun in narrow beams: 0.02 degrees per frame through slats, so that many
         parallel edges creep through dust together.""",
     "fov_deg": 50, "ev": 0.5, "sky": (0.12, 0.11, 0.13),
     "sun": sun_path(75, 30, 0, -5.12, (10, 7.4, 4.8), (10, 6.2, 3.4)),
     "camera": still((-3.5, 1.7, 7), (1.2, 2.2, -3)),
     "solids": [ground((-40, -50), (40, 12), TIMBER), box((5, 5, -12), (5.4, 5.4, 5), ROCK),
                box((-6, 0, -12.4), (5, 4, -12), ROCK)] + [
         box((5, 0.5 + 0.3 * i, -11), (5.3, 0.62 + 0.3 * i, 5), IRON) for i in range(14)] + [
         box((5, 0, z), (5.4, 5, z + 0.5), ROCK) for z in (-12, -8, -4, 0, 4)] + [
         post(1.5, -2, 0.4, 5, ROCK), post(1.5, -7, 0.4, 5, ROCK), box((-2, 0, -6), (0, 1, -4),
             TIMBER)],
     "media": [haze(0.06, (-9, 0, -20), (14, 6, 9), 0.4)]},

    {"name": "raid_dawn", "title": "A low flight at dawn with a strong wind",
     "isolates": """All motions at once: a flight in curves at 20 m/s past masts, clouds at 16 m/s
         across them and a sun that rises by 0.03 degrees per frame.""",
     "fov_deg": 56, "ev": -0.5, "sky": (0.12, 0.14, 0.22), "wind": (-16, 0, 0),
     "sun": sun_path(-110, 12, 4, 7.68, (9, 6, 3.8), (10, 7.8, 5.8)),
     "camera": sample(weave((0, 11, 20), 20, 5, 5, 4)),
     "solids": [ground((-600, -800), (600, 60), GRASS)] + [
         solid for i in range(11) for solid in (
             post((-1 if i % 2 else 1) * (9 + 3 * (i % 3)), -12 - 19 * i, 0.4, 19 + 3 * (i % 4),
                 IRON),
             bar(((-1 if i % 2 else 1) * (9 + 3 * (i % 3)), 15, -12 - 19 * i), (5, 0.25, 0.25),
                 IRON),
             box((-40 + 8 * i, 0, -50 - 16 * i), (-34 + 8 * i, 5 + 2 * (i % 3), -44 - 16 * i),
                 ROCK))],
     "media": [lumps(61, (16, 5, 10), (-250, 34, -480), (25, 14, 38), 0.06, 2),
               haze(0.003, (-300, 0, -500), (300, 26, 50), 0.5)]},

    {"name": "barn_hand", "title": "A hand films through the boards of a barn",
     "isolates": """A camera in a hand before light in haze: it sways by 0.35 degrees and trembles
         by 0.04 at 7 and 8 Hz, less than a pixel per frame at 384x216, before gaps between boards
         and beams of the sun behind them.""",
     "fov_deg": 48, "ev": -1, "sky": (0.2, 0.24, 0.3), "sun": sun((0.45, 0.6, -0.4), (9, 8, 6.6)),
     "camera": sample(hand((0.4, 1.6, 4), 4, 5, 0.35, 0.04), 1),
     "solids": [ground((-40, -60), (40, 12), TIMBER)] + [
         box((-5.6 + 0.62 * i, 0, -3), (-5.18 + 0.62 * i, 4.6, -2.94), TIMBER)
         for i in range(18)] + [
         box((-5.8, 1.2, -3.1), (5.6, 1.34, -3), TIMBER), box((-5.8, 3.2, -3.1), (5.6, 3.34, -3),
                                                              TIMBER),
         post(-5, -12, 0.7, 7, ROCK), post(1, -16, 0.5, 8, ROCK), post(6, -14, 0.8, 6, ROCK),
         bar((0, 1.1, -9), (18, 0.06, 0.06), IRON), bar((0, 0.6, -9), (18, 0.06, 0.06), IRON)],
     "media": [haze(0.05, (-12, 0, -26), (12, 8, 5), 0.4)]},
]
