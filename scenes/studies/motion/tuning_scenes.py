# SPDX-License-Identifier: MIT
"""Scenes of the suite `motion`, by which settings may be chosen."""
import random

from parts import (bar, blob, box, cumulus, fence, ground, hand, haze, height_fog, lumps, orbit,
                   plume, post, sample, shake, shots, still, straight, sun, sun_path, sway, turn,
                   weave)

MARCH = "the march, in every frame"
DAY = (0.1, 0.2, 0.38)
EARTH, STONE, WOOD, STEEL = (0.09, 0.1, 0.05), (0.3, 0.27, 0.24), (0.2, 0.15, 0.1), 0.25


def trunks(seed, count, half_width, path, near, far):
    """Trees on both sides of a path along -z."""
    draw = random.Random(seed)
    solids = []
    for i in range(count):
        x = draw.uniform(path, half_width) * (1 if i % 2 else -1)
        z = near + (far - near) * (i + draw.random()) / count
        solids.append(post(x, z, draw.uniform(0.22, 0.5), 11, WOOD, -0.1))
    return solids


def lattice(x, z, side, height, width, steps):
    """Four legs, rungs in front and behind, and braces in front."""
    half, solids = 0.5 * side, []
    solids += [post(x + sx * half, z + sz * half, width, height, STEEL)
               for sx in (-1, 1) for sz in (-1, 1)]
    rise = height / steps
    for i in range(steps):
        y = rise * (i + 1) - 0.5 * width
        solids += [bar((x, y, z + sz * half), (side, 0.7 * width, 0.7 * width), STEEL)
                   for sz in (-1, 1)]
        if i < 6:
            tilt = (1 if i % 2 else -1) * 45
            solids.append(bar((x, rise * (i + 0.5), z + half), (1.35 * side, 0.5 * width,
                                                                0.5 * width), STEEL, "z", tilt))
    return solids


SCENES = [
    {"name": "cumulus_flight", "title": "A flight below cumulus, over towers",
     "isolates": """A quick camera below clouds: 60 m/s ahead, so that near towers cross the frame
         while clouds overhead move by pixels and far ones by fractions.""",
     "reference": MARCH, "fov_deg": 55, "ev": -1, "sky": DAY, "sun": sun((-0.4, 0.6, 0.45)),
     "camera": sample(straight((0, 260, 600), 0, 60, 11), 256),
     "solids": [ground((-6000, -9000), (6000, 1500), EARTH)] + [
         post(x, z, 9, h, STONE) for x, z, h in (
             (-70, 300, 330), (90, 150, 350), (-130, -60, 380), (60, -260, 345), (-40, -420, 300),
             (150, -500, 400), (-200, -700, 420), (230, -900, 430), (-320, -1100, 450))],
     "media": [cumulus(9, 520, 600, 0.6, 0.035, (-2200, 500, -3600), (2200, 1150, 700))]},

    {"name": "lattice_mast", "title": "A lattice mast before clouds in a wind of 14 m/s",
     "isolates": """Clouds that drift behind thin solids: members of one to two pixels at 384x216
         before clouds that move by half a pixel per frame, without a history of their own behind
         the members.""",
     "fov_deg": 42, "ev": -1, "sky": DAY, "sun": sun((-0.5, 0.6, 0.6)), "wind": (14, 0, 0),
     "camera": still((0, 2, 17), (0.6, 6.5, 0)),
     "solids": [ground((-700, -700), (700, 30), EARTH)] + lattice(0, 0, 2.4, 22, 0.13, 9),
     "media": [lumps(4, (16, 7, 6), (-360, 40, -300), (15, 16, 15), 0.1, 2, 0.38)]},

    {"name": "forest_walk", "title": "A walk through a wood in ground fog",
     "isolates": """A walking camera in fog: 1.4 m/s between trunks with the lift and sway of steps,
         so that depth edges move by pixels near and by fractions far away.""",
     "fov_deg": 55, "ev": 0, "sky": (0.1, 0.12, 0.13), "sun": sun((0.8, 0.5, -0.45), (9, 8, 6.5)),
     "camera": sample(straight((0, 1.7, 2), 0, 1.4, 0, 0.03)),
     "solids": [ground((-60, -70), (60, 10), (0.12, 0.12, 0.06))] + trunks(3, 30, 10, 0.9, -1, -36),
     "media": [height_fog(0.06, 0.35, (-50, 0, -65), (50, 9, 9), 0.5)]},

    {"name": "fence_dusk", "title": "Dusk behind a fence",
     "isolates": """A slow sun against the light: it sinks by 0.02 degrees per frame behind a fence
         and small clouds in haze.""",
     "fov_deg": 42, "ev": -0.5, "sky": (0.1, 0.1, 0.16),
     "sun": sun_path(8, 12, 2, -5.12, (8, 4.8, 2.6), (6, 2.9, 1.3)),
     "camera": still((0, 1.7, 6), (0.2, 2.3, -8)),
     "solids": [ground((-80, -120), (80, 12), (0.16, 0.15, 0.1)),
                fence((-5.6, 0, -3), 28, 0.4, 0.06, 0.05, 2.1, WOOD, ((0.5, 1.7), 0.08, 0.04)),
                box((-22, 0, -46), (-9, 6, -38), (0.3, 0.25, 0.2))],
     "media": [haze(0.012, (-60, 0, -100), (60, 18, 10), 0.6),
               blob((-6, 12, -70), 3.4, 0.3), blob((4, 14, -74), 2.6, 0.35),
               blob((15, 9, -66), 3, 0.25)]},

    {"name": "tower_orbit", "title": "A shot around a tower between clouds",
     "isolates": """A camera on a circle: 12 degrees per second around a thick solid with thin
         parts, while clouds at three distances pass behind it.""",
     "fov_deg": 48, "ev": -1, "sky": DAY, "sun": sun((0.5, 0.6, 0.6)),
     "camera": orbit((0, 30, 0), 46, 0, 12),
     "solids": [ground((-700, -700), (700, 700), EARTH), post(0, 0, 8, 40, STONE),
                box((-6, 27, -6), (6, 28, 6), STONE), post(0, 0, 0.4, 22, STEEL, 40),
                bar((0, 52, 0), (7, 0.3, 0.3), STEEL), bar((0, 56, 0), (0.3, 0.3, 5), STEEL),
                fence((-6, 28, 6), 11, 1.2, 0.15, 0.15, 1.6, STEEL),
                fence((-6, 28, -6), 11, 1.2, 0.15, 0.15, 1.6, STEEL)],
     "media": [blob((-70, 46, -60), 15, 0.12), blob((75, 40, -70), 13, 0.14),
               blob((60, 52, 85), 17, 0.1), blob((-80, 38, 70), 12, 0.15),
               blob((-150, 60, 5), 24, 0.07), blob((140, 66, 20), 22, 0.07),
               blob((10, 58, -190), 28, 0.05)]},

    {"name": "veil_cumulus", "title": "Cumulus behind a veil",
     "isolates": """A static scene of two layers: a thin veil before cumulus with sharp rims, no
         solids between them and the camera.""",
     "reference": "the march", "fov_deg": 42, "ev": -1, "sky": DAY, "sun": sun((0.5, 0.55, 0.6)),
     "camera": still((0, 180, 0), (60, 520, -1000)),
     "solids": [ground((-6000, -9000), (6000, 900), EARTH),
                box((-500, 0, -1500), (-380, 190, -1400), STONE)],
     "media": [cumulus(12, 600, 800, 0.58, 0.035, (-2000, 580, -3600), (2000, 1450, -1200)),
               blob((150, 420, -560), 130, 0.0022)]},

    {"name": "balcony_turn", "title": "A turn on a balcony, past rails, towers and clouds",
     "isolates": """A turning camera: 45 degrees per second in place, the depth of a pixel changes
         with the frame but no point changes its distance.""",
     "fov_deg": 50, "ev": -1, "sky": DAY, "sun": sun((0.3, 0.8, 0.5)),
     "camera": sample(turn((0, 31.7, 0), -60, 45, 4)),
     "solids": [ground((-500, -500), (500, 500), EARTH), box((-2, 29, -2), (2, 30, 2), STONE),
                fence((-2, 30, -1.98), 9, 0.5, 0.04, 0.04, 1.3, STEEL),
                fence((-2, 30, 2), 9, 0.5, 0.04, 0.04, 1.3, STEEL),
                box((-2, 31.3, -2.02), (2.04, 31.36, -1.96), STEEL),
                box((-2, 31.3, 1.96), (2.04, 31.36, 2.02), STEEL)] + [
         post(x, z, w, h, STONE) for x, z, w, h in (
             (-40, -60, 9, 52), (55, -30, 7, 44), (70, 40, 10, 60), (-60, 50, 8, 47),
             (10, 90, 12, 55), (-95, -5, 6, 58))],
     "media": [blob((-60, 56, -120), 17, 0.12), blob((40, 62, -140), 20, 0.1),
               blob((150, 58, 20), 21, 0.1), blob((60, 60, 140), 19, 0.11),
               blob((-90, 64, 120), 22, 0.1), blob((-160, 52, -10), 18, 0.1)]},

    {"name": "blast_shake", "title": "A shaken camera in ruins with smoke",
     "isolates": """A shaking camera: 4 cm and 0.5 degrees at 5 and 7 Hz, so that the motion of a
         pixel changes its direction within frames, before dark smoke and thin beams.""",
     "fov_deg": 50, "ev": 0, "sky": (0.3, 0.36, 0.45), "sun": sun((-0.5, 0.6, 0.5), (8, 7.4, 6.5)),
     "camera": sample(shake((0, 1.7, 9), 0, 6, 0.04, 0.5, 5), 1), "wind": (0.5, 0, 0),
     "solids": [ground((-60, -80), (60, 14), (0.3, 0.27, 0.22)),
                box((-9, 0, -6), (-4.5, 3.4, -5), STONE), box((4, 0, -9), (9, 4.6, -8), STONE),
                box((-12, 0, -22), (-2, 6, -20), STONE), box((6, 0, -26), (16, 7.5, -24), STONE),
                bar((-1.5, 2.6, -5.5), (7, 0.12, 0.12), STEEL, "z", 24),
                bar((2.4, 3.2, -8.4), (8, 0.1, 0.1), STEEL, "z", -31),
                bar((0.4, 1.4, -3), (0.07, 4.6, 0.07), STEEL, "z", 12)] + [
         post(x, -4.5 - 0.3 * i, 0.06, 2.6 + 0.25 * (i % 3), STEEL)
         for i, x in enumerate((-4.2, -3.6, 1.1, 1.9, 3.0, 4.6))],
     "media": [plume((-3, 0.2, -13), (0.25, 1, 0), 1.5, 6, 0.7, (0.35, 0.33, 0.3)),
               plume((4.4, 0.2, -18), (0.3, 1, 0.1), 1.9, 7, 0.45, (0.7, 0.68, 0.65)),
               haze(0.012, (-40, 0, -60), (40, 14, 12))]},

    {"name": "street_cuts", "title": "Three views of a foggy street, with cuts",
     "isolates": """Cuts of the camera: every 40 frames another of three views, which come back, so
         that no history is valid at a cut and an old one is nearly right.""",
     "fov_deg": 48, "ev": 0, "sky": (0.16, 0.18, 0.2), "sun": sun((0.5, 0.7, 0.35), (7, 6.6, 6)),
     "camera": shots([straight((0, 1.7, 6), -3, 0.3), turn((-3.6, 2.6, 0), 18, 2, -4),
                      straight((-1.2, 1.5, -17), 168, 0.2, 3)], 40),
     "solids": [ground((-40, -70), (40, 20), (0.2, 0.2, 0.19))] + [
         box((side * 7 - 2.5, 0, z), (side * 7 + 2.5, h, z + 7), (0.4, 0.34, 0.3))
         for side, z, h in ((-1, -12, 7), (-1, -24, 9), (1, -10, 8), (1, -20, 6), (1, -32, 9),
                            (-1, 2, 6), (1, 4, 7))] + [
         solid for i in range(6) for solid in (
             post(-3.4 if i % 2 else 3.4, 2 - 5 * i, 0.1, 4.2, STEEL),
             bar((-3 if i % 2 else 3, 4.2, 2 - 5 * i), (1.2, 0.08, 0.08), STEEL))] + [
         bar((0, 4.9, -2 - 6 * i), (9, 0.03, 0.03), STEEL) for i in range(4)],
     "media": [height_fog(0.05, 0.15, (-30, 0, -60), (30, 14, 18), 0.4)]},

    {"name": "leaf_breeze", "title": "Leaves sway before slow clouds",
     "isolates": """Small solids and clouds that move apart: leaves of three pixels at 384x216 sway
         with a period of 40 frames before clouds in a wind of 2 m/s.""",
     "fov_deg": 40, "ev": -1, "sky": DAY, "sun": sun((-0.4, 0.6, 0.6)), "wind": (2, 0, 0),
     "camera": still((0, 1.7, 0), (0, 3.2, -10)),
     "solids": [ground((-80, -90), (80, 6), EARTH), post(-4.2, -9, 0.5, 8, WOOD),
                bar((-1.4, 4.5, -9), (6, 0.12, 0.12), WOOD, "z", 14),
                bar((-2.2, 2.7, -9), (4.4, 0.09, 0.09), WOOD, "z", -9)] + [
         fence((-3.6 + 0.3 * i, 2.1 + 0.75 * i, -8.8 + 0.2 * i), 7, 0.62, 0.1, 0.02, 0.14,
               (0.16, 0.28, 0.08), motion=sway(0.09, 40, 1.7 * i)) for i in range(4)],
     "media": [blob((-11, 12, -46), 2.8, 0.3), blob((-6.5, 13, -48), 3.4, 0.3),
               blob((-8, 10.5, -44), 2.2, 0.3), blob((3, 9, -50), 3.2, 0.3),
               blob((7, 11, -52), 3.8, 0.25), blob((9, 14.5, -50), 2.5, 0.25)]},

    {"name": "wire_storm", "title": "Wires before clouds of a storm",
     "isolates": """Quick clouds behind wires: 28 m/s are more than two pixels per frame at 384x216,
         and wires of a pixel cross them aslant.""",
     "fov_deg": 40, "ev": -0.5, "sky": (0.16, 0.22, 0.3),
     "sun": sun((0.4, 0.7, 0.5), (8, 7.8, 7.5)),
     "camera": still((0, 1.7, 0), (1, 5.6, -20)), "wind": (28, 0, 0),
     "solids": [ground((-300, -400), (300, 20), (0.12, 0.13, 0.08)),
                post(-7, -24, 0.35, 12, WOOD), post(8.5, -31, 0.35, 12, WOOD),
                bar((-7, 11, -24), (3, 0.2, 0.2), WOOD), bar((8.5, 11, -31), (3, 0.2, 0.2), WOOD)] +
         [bar((0.5, 6.5 + 1.05 * i, -22 - i), (26, 0.08, 0.08), STEEL, "z", -6 + 2.1 * i)
          for i in range(6)],
     "media": [lumps(8, (16, 5, 5), (-420, 14, -150), (13, 9, 11), 0.12, 3, 0.40)]},

    {"name": "mist_fence", "title": "Wisps of mist drift behind a fence",
     "isolates": """Slow mist near the camera: 0.5 m/s are less than half a pixel per frame at
         384x216, behind bars of two pixels.""",
     "fov_deg": 40, "ev": 0, "sky": (0.12, 0.15, 0.19), "sun": sun((0.6, 0.6, 0.3), (8, 7.4, 6.4)),
     "camera": still((0, 1.7, 0), (0, 1.5, -10)), "wind": (0.5, 0, 0.05),
     "solids": [ground((-60, -80), (60, 6), (0.1, 0.14, 0.07)),
                fence((-4.5, 0, -8), 26, 0.36, 0.05, 0.04, 1.9, STEEL, ((0.4, 1.6), 0.05, 0.03)),
                post(-5.5, -24, 0.9, 9, WOOD), post(6, -28, 1.1, 9, WOOD), post(1, -34, 0.8, 9,
                    WOOD)],
     "media": [blob((-4.6, 1.1, -12), 1.0, 0.5), blob((-1.5, 0.8, -14), 1.3, 0.4),
               blob((2.6, 1.3, -12.5), 0.9, 0.55), blob((-8.5, 1.6, -17), 1.8, 0.3),
               blob((5.5, 0.9, -16), 1.4, 0.35), blob((-2, 1.5, -21), 2.2, 0.2)]},

    {"name": "sun_race", "title": "A day passes over columns in ground fog",
     "isolates": """A quick sun: 0.55 degrees per frame across the sky, so that shadows of columns
         sweep through fog by more than a pixel per frame.""",
     "fov_deg": 45, "ev": 0, "sky": (0.14, 0.2, 0.3),
     "sun": sun_path(-80, 25, 140.8, 20, (9, 7.6, 6), (9, 8.8, 8)),
     "camera": still((0, 7, 16), (0, 1.5, -4)),
     "solids": [ground((-70, -70), (70, 24), (0.3, 0.27, 0.2))] + [
         post(-7.5 + 3 * (i % 6), -9 + 6 * (i // 6), 0.45, 3.2 + 0.9 * (i % 4), STONE)
         for i in range(18)] + [box((-7.8, 6.1, -9.3), (7.8, 6.5, -8.7), STONE)],
     "media": [height_fog(0.05, 0.3, (-40, 0, -45), (40, 9, 22), 0.3)]},

    {"name": "temple_noon", "title": "The sun moves slowly behind a colonnade",
     "isolates": """A slow sun in beams: 0.03 degrees per frame, so that edges of beams between
         columns creep through haze by fractions of a pixel.""",
     "fov_deg": 48, "ev": 0, "sky": (0.14, 0.18, 0.25),
     "sun": sun_path(62, 36, 7.68, 0, (9, 8.2, 7), (9, 8.6, 7.6)),
     "camera": still((-0.8, 1.7, 8), (0, 2.9, -6)),
     "solids": [ground((-40, -60), (40, 14), STONE), box((4.4, 6, -26), (5.5, 6.8, 5), STONE),
                box((-5.5, 6, -26), (-4.4, 6.8, 5), STONE),
                fence((4.6, 0, 4), 1, 1, 0.7, 0.7, 6, STONE, rows=(11, 2.6)),
                fence((-5.3, 0, 4), 1, 1, 0.7, 0.7, 6, STONE, rows=(11, 2.6)),
                fence((-3.6, 0, -22), 4, 2.4, 0.16, 0.16, 6, STEEL, ((2, 4), 0.1, 0.1))],
     "media": [haze(0.035, (-14, 0, -40), (14, 8, 11), 0.5)]},

    {"name": "coast_ride", "title": "A ride along a coast in a slow wind and sun",
     "isolates": """All motions at once, slow: a rider at 6 m/s, clouds at 10 m/s behind posts, and
         a sun that sinks by 0.02 degrees per frame.""",
     "fov_deg": 52, "ev": -0.5, "sky": (0.2, 0.28, 0.42), "wind": (10, 0, 0),
     "sun": sun_path(130, 30, 2, -5.12, (9, 7.6, 5.8), (9, 7.2, 5.2)),
     "camera": sample(straight((0, 2.4, 4), 8, 6, 5, 0.06, 2.4)),
     "solids": [ground((-400, -500), (400, 30), (0.2, 0.2, 0.13))] + [
         post(-2.2 if i % 2 else 3.6 + 0.5 * i, -2 - 5.5 * i, 0.12, 1.7 + 0.5 * (i % 3), WOOD)
         for i in range(14)] + [bar((2 + 2 * i, 1.2, -6 - 11 * i), (6, 0.05, 0.05), WOOD)
                                for i in range(5)] + [
         box((-60, 0, -120), (-44, 26, -104), STONE), post(24, -90, 5, 24, STONE)],
     "media": [lumps(15, (16, 5, 6), (-270, 26, -260), (14, 9, 14), 0.1, 2),
               haze(0.002, (-200, 0, -300), (200, 16, 25), 0.5)]},

    {"name": "valley_chase", "title": "A chase through a valley in a quick wind and sun",
     "isolates": """All motions at once, quick: a flight in curves at 30 m/s, clouds at 20 m/s and a
         sun that turns by 0.3 degrees per frame.""",
     "fov_deg": 60, "ev": -0.5, "sky": (0.2, 0.3, 0.48), "wind": (20, 0, 4),
     "sun": sun_path(100, 35, 76.8, 10, (9, 7.8, 6.4), (9.5, 9, 8.2)),
     "camera": sample(weave((0, 16, 20), 30, 7, 4, 6)),
     "solids": [ground((-700, -900), (700, 80), EARTH)] + [
         post((-1 if i % 2 else 1) * (13 + 4 * (i % 4)), -8 - 17 * i, 3.5 + (i % 3),
             24 + 9 * (i % 4),
              STONE) for i in range(17)] + [bar((0, 22 + (i % 3), -30 - 55 * i), (44, 0.35, 0.35),
                                                STEEL) for i in range(5)],
     "media": [lumps(21, (16, 5, 12), (-420, 52, -560), (26, 15, 40), 0.05, 2),
               haze(0.0025, (-300, 0, -600), (300, 30, 60), 0.4)]},

    {"name": "rigging_swell", "title": "Rigging of a ship in a swell before clouds",
     "isolates": """A slow large sway: a third of a metre and 2 degrees with a period of 4 s,
         with ropes of less than a pixel at 384x216 before clouds in a wind of 8 m/s.""",
     "fov_deg": 48, "ev": -1, "sky": DAY, "sun": sun((0.45, 0.65, 0.5)), "wind": (-8, 0, 0),
     "camera": sample(shake((0, 4, 9), 0, 16, 0.35, 2.2, 0.25)),
     "solids": [ground((-900, -900), (900, 200), (0.05, 0.09, 0.12)),
                box((-3, 0.6, -14), (3, 2.2, 12), WOOD), post(0, -6, 0.4, 17, WOOD, 1.5),
                bar((0, 11, -5.8), (9, 0.22, 0.22), WOOD), bar((0, 15, -5.8), (6, 0.18, 0.18),
                    WOOD)]
     + [bar((side * (1.6 + 0.5 * i), 8.2, -5.9 + 0.1 * i), (0.05, 13.2 - i, 0.05), WOOD, "z",
            side * (13 + 4 * i)) for side in (-1, 1) for i in range(4)] + [
         bar((0, 4 + 1.6 * i, -5.6), (4.4 - 0.55 * i, 0.04, 0.04), WOOD) for i in range(5)],
     "media": [lumps(27, (16, 5, 5), (-120, 30, -210), (14, 10, 13), 0.1, 2)]},

    {"name": "porch_hand", "title": "A hand films a valley from a porch",
     "isolates": """A camera in a hand: it sways by 0.25 degrees and trembles by 0.05 at 7 and 8 Hz,
         less than a pixel per frame at 384x216, never evenly and never static, before a railing,
         wires and clouds in a wind of 3 m/s.""",
     "fov_deg": 45, "ev": -1, "sky": DAY, "sun": sun((-0.5, 0.6, 0.5)), "wind": (3, 0, 0),
     "camera": sample(hand((0, 1.7, 3), 0, 1.5, 0.25, 0.05), 1),
     "solids": [ground((-500, -700), (500, 0), EARTH, -6), box((-4, -0.3, -0.2), (4, 0, 5), WOOD),
                fence((-3.9, 0, 0), 19, 0.42, 0.05, 0.05, 1.05, WOOD, ((0.1, 1.0), 0.06, 0.04)),
                post(-2.8, -0.1, 0.16, 4.2, WOOD), post(3, -0.1, 0.16, 4.2, WOOD),
                bar((0, 4.1, -0.1), (8, 0.2, 0.2), WOOD), bar((0, 3.4, -6), (26, 0.03, 0.03),
                                                            STEEL),
                bar((0, 3.9, -7), (26, 0.03, 0.03), STEEL, "z", 3)] + [
         post(x, z, w, h, WOOD, -6) for x, z, w, h in (
             (-9, -22, 0.5, 12), (-4, -31, 0.6, 11), (6, -26, 0.5, 13), (12, -36, 0.7, 13),
             (1.5, -44, 0.6, 12))] + [box((-30, -6, -90), (-14, 8, -78), STONE)],
     "media": [lumps(33, (16, 5, 5), (-120, 16, -190), (14, 9, 12), 0.1, 2),
               height_fog(0.02, 0.25, (-200, -6, -300), (200, 6, -8), 0.4)]},
]
