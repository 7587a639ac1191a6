# SPDX-License-Identifier: MIT
"""Parts of the scenes of motion.py: paths of the camera, solids and media, as lines of YAML."""
import math
import random

FRAMES, RATE_HZ = 256, 30


def listed(values):
    return "[%s]" % ", ".join(f"{round(v, 4) + 0.0:g}" for v in values)


def gray(albedo):
    return (albedo,) * 3 if isinstance(albedo, (int, float)) else albedo


# ---- paths of the camera: (frame, position, look at, cut) ---------------------------------------

def ahead(position, yaw_deg, pitch_deg=0.0):
    """A point 20 m ahead; a yaw of 0 looks along -z, of 90 along +x."""
    yaw, pitch = math.radians(yaw_deg), math.radians(pitch_deg)
    return (position[0] + 20 * math.cos(pitch) * math.sin(yaw), position[1] + 20 * math.sin(pitch),
            position[2] - 20 * math.cos(pitch) * math.cos(yaw))


def sample(pose, step=2, first=0, last=FRAMES, cut=False):
    """Keys of a function of seconds that gives position, yaw and pitch."""
    keys = []
    for frame in range(first, last + 1, step):
        position, yaw_deg, pitch_deg = pose(frame / RATE_HZ)
        keys.append((frame, position, ahead(position, yaw_deg, pitch_deg),
                     cut and frame == first))
    return keys


def straight(start, yaw_deg, speed_m_per_s, pitch_deg=0.0, bob_m=0.0, steps_hz=1.8):
    """A walk or a flight along the yaw; each step lifts the eye, each second one sways it."""
    yaw = math.radians(yaw_deg)

    def pose(time_s):
        way_m, phase = speed_m_per_s * time_s, 2 * math.pi * steps_hz * time_s
        sway_m = 0.6 * bob_m * math.sin(0.5 * phase)
        position = (start[0] + way_m * math.sin(yaw) + sway_m * math.cos(yaw),
                    start[1] + bob_m * math.sin(phase),
                    start[2] - way_m * math.cos(yaw) + sway_m * math.sin(yaw))
        return position, yaw_deg, pitch_deg
    return pose


def weave(start, speed_m_per_s, width_m, period_s, pitch_deg=0.0):
    """A flight along -z in curves, in the direction of which the camera turns."""
    rate = 2 * math.pi / period_s

    def pose(time_s):
        side_m_per_s = width_m * rate * math.cos(rate * time_s)
        position = (start[0] + width_m * math.sin(rate * time_s), start[1],
                    start[2] - speed_m_per_s * time_s)
        return position, math.degrees(math.atan2(side_m_per_s, speed_m_per_s)), pitch_deg
    return pose


def turn(place, from_deg, deg_per_s, pitch_deg=0.0):
    return lambda time_s: (place, from_deg + deg_per_s * time_s, pitch_deg)


def pan(place, yaw_deg, half_deg, period_s, pitch_deg=0.0):
    """A turn to and fro."""
    return lambda time_s: (place, yaw_deg + half_deg * math.sin(2 * math.pi * time_s / period_s),
                           pitch_deg)


def shake(place, yaw_deg, pitch_deg, move_m, turn_deg, rate_hz):
    """Two oscillations without a common period in each of place, yaw and pitch."""
    def wave(time_s, phase):
        return 0.6 * (math.sin(2 * math.pi * rate_hz * time_s + phase) +
                      0.6 * math.sin(2 * math.pi * 1.43 * rate_hz * time_s + 2 * phase))

    def pose(time_s):
        position = tuple(p + move_m * wave(time_s, i + 1) for i, p in enumerate(place))
        return (position, yaw_deg + turn_deg * wave(time_s, 0.3),
                pitch_deg + turn_deg * wave(time_s, 1.9))
    return pose


def hand(place, yaw_deg, pitch_deg, sway_deg, tremor_deg):
    """A camera in a hand: it sways at about 1 Hz, moves by 1 cm with it, and trembles at 7 to 8."""
    def wave(time_s, slow_hz, fast_hz, phase):
        return (sway_deg * math.sin(2 * math.pi * slow_hz * time_s + phase) +
                tremor_deg * math.sin(2 * math.pi * fast_hz * time_s + 2 * phase))

    def pose(time_s):
        across, up = wave(time_s, 0.9, 7.3, 0.4), wave(time_s, 1.2, 8.1, 2.1)
        position = (place[0] + 0.01 * math.sin(2 * math.pi * 0.9 * time_s),
                    place[1] + 0.01 * math.sin(2 * math.pi * 1.2 * time_s), place[2])
        return position, yaw_deg + across, pitch_deg + up
    return pose


def orbit(center, radius_m, from_deg, deg_per_s, step=2):
    """Keys around the vertical through the centre, which stays in the middle of the frame."""
    keys = []
    for frame in range(0, FRAMES + 1, step):
        angle = math.radians(from_deg + deg_per_s * frame / RATE_HZ)
        keys.append((frame, (center[0] + radius_m * math.sin(angle), center[1],
                             center[2] + radius_m * math.cos(angle)), center, False))
    return keys


def shots(poses, every):
    """One pose after the other, in turn, with a cut every so many frames."""
    keys = []
    for shot, first in enumerate(range(0, FRAMES, every)):
        last = min(first + every - 1, FRAMES)
        pose = poses[shot % len(poses)]
        keys += sample(pose, last - first, first, last, cut=first > 0)
    return keys


# ---- solids -------------------------------------------------------------------------------------

def mapping(kind, parts, is_short=False):
    """An entry of a list: on one line if it is short and fits."""
    line = "  - %s: {%s}" % (kind, ", ".join(parts))
    if is_short and len(line) <= 100:
        return line
    return f"  - {kind}:\n" + "\n".join(f"      {part}" for part in parts)


def box(low, high, albedo, motion=""):
    parts = [f"min_m: {listed(low)}", f"max_m: {listed(high)}", f"albedo: {listed(gray(albedo))}"]
    return mapping("box", parts + [motion] if motion else parts, not motion)


def post(x, z, width, height, albedo, foot=0.0):
    """An upright box."""
    half = 0.5 * width
    return box((x - half, foot, z - half), (x + half, foot + height, z + half), albedo)


def bar(middle, size, albedo, axis="", turn_deg=0.0):
    """A box about its middle, rotated about an axis through it."""
    low = tuple(m - 0.5 * s for m, s in zip(middle, size))
    high = tuple(m + 0.5 * s for m, s in zip(middle, size))
    motion = "motion: {axis: %s, pivot_m: %s, keys: [{frame: 0, turn_deg: %g}]}" % (
        axis, listed(middle), turn_deg) if axis else ""
    return box(low, high, albedo, motion)


def sway(move_m, period, phase, step=4):
    """Motion to and fro along x with a period in frames."""
    rows = [f"          - {{frame: {f}, move_m: " +
            listed((move_m * math.sin(2 * math.pi * f / period + phase),
                    0.3 * move_m * math.sin(4 * math.pi * f / period + phase), 0)) + "}"
            for f in range(0, FRAMES + 1, step)]
    return "motion:\n        keys:\n" + "\n".join(rows)


def fence(origin, bars, pitch, width, depth, height, albedo, rails="", rows="", motion=""):
    lines = [f"origin_m: {listed(origin)}", f"bars: {bars}", f"pitch_m: {pitch:g}",
             f"bar_width_m: {width:g}", f"bar_depth_m: {depth:g}", f"height_m: {height:g}"]
    if rows:
        lines += [f"rows: {rows[0]}", f"row_spacing_m: {rows[1]:g}"]
    if rails:
        lines.append("rails: {heights_m: %s, width_m: %g, depth_m: %g}" % (
            listed(rails[0]), rails[1], rails[2]))
    lines.append(f"albedo: {listed(gray(albedo))}")
    return mapping("fence", lines + [motion] if motion else lines)


def ground(low, high, albedo, y=0.0):
    return box((low[0], y - 1, low[1]), (high[0], y, high[1]), albedo)


# ---- media --------------------------------------------------------------------------------------

def blob(center, width, extinction, albedo=1):
    return mapping("gaussian", [f"center_m: {listed(center)}", f"width_m: {width:g}",
                                f"extinction_per_m: {extinction:g}",
                                f"albedo: {listed(gray(albedo))}"], True)


def bounds(low, high):
    return f"bounds: {{min_m: {listed(low)}, max_m: {listed(high)}}}"


def medium(kind, lines, low, high, g=0.0):
    lines = lines + ["albedo: [1, 1, 1]"]
    if g:
        lines += ["phase: henyey_greenstein", f"asymmetry_g: {g:g}"]
    lines.append(bounds(low, high))
    return mapping(kind, lines)


def haze(extinction, low, high, g=0.0):
    return medium("homogeneous", [f"extinction_per_m: {extinction:g}"], low, high, g)


def height_fog(extinction, falloff, low, high, g=0.0):
    layer = f"{{extinction_per_m: {extinction:g}, falloff_per_m: {falloff:g}, height_m: 0}}"
    return medium("height_fog", [f"layers: [{layer}]"], low, high, g)


def cumulus(seed, bottom, thickness, coverage, extinction, low, high, g=0.5):
    """Procedural clouds with details of some 50 m."""
    return medium("horizon", [
        f"seed: {seed}", "planet_radius_m: 1000000", f"bottom_m: {bottom}",
        f"thickness_m: {thickness}", f"coverage: {coverage:g}", "density: 1.2",
        "texture_scale_m: 7000", "base_repeats: 8", "detail_repeats: 25",
        f"extinction_per_m: {extinction:g}"], low, high, g)


def smoothed(noise, place):
    total = weight = 0.0
    for dx in (-1, 0, 1):
        for dy in (-1, 0, 1):
            for dz in (-1, 0, 1):
                share = 0.5 ** (abs(dx) + abs(dy) + abs(dz))
                total += share * noise.get((place[0] + dx, place[1] + dy, place[2] + dz), 0.0)
                weight += share
    return total / weight


def lumps(seed, nodes, origin, spacing, extinction, repeat=1, cover=0.42):
    """Voxels of smoothed noise: lumps with clear air between them, flat below."""
    draw = random.Random(seed)
    wide, high, deep = nodes
    places = [(x, y, z) for z in range(deep) for y in range(high) for x in range(wide)]
    noise = {place: draw.random() for place in places}
    rows = []
    for z in range(deep):
        for y in range(high):
            values = [max(0.0, 4.0 * (smoothed(noise, (x, y, z)) - cover - 0.10 * y / high))
                      for x in range(wide)]
            rows.append("       " + ", ".join(f"{round(v, 2):g}" for v in values))
    lines = [f"size: {listed(nodes)}", f"origin_m: {listed(origin)}",
             f"spacing_m: {listed(spacing)}"]
    if repeat > 1:
        lines.append(f"repeat: [{repeat}, 1, 1]")
    lines.append("values: [ # x fastest, then y, then z\n" + ",\n".join(rows) + "]")
    lines += [f"extinction_per_m: {extinction:g}", "albedo: [1, 1, 1]"]
    return mapping("grid", lines)


def plume(foot, axis, width, scale, extinction, albedo=1):
    return mapping("plume", [f"foot_m: {listed(foot)}", f"axis: {listed(axis)}",
                             f"width_m: {width:g}", f"scale_height_m: {scale:g}",
                             f"extinction_per_m: {extinction:g}",
                                 f"albedo: {listed(gray(albedo))}"])


# ---- light and files ----------------------------------------------------------------------------

def sun(direction, irradiance=(14, 13.4, 12.6)):
    return f"sun: {{direction: {listed(direction)}, irradiance_w_per_m2: {listed(irradiance)}}}"


def sun_path(azimuth_deg, elevation_deg, turn_deg, rise_deg, first, last, step=8):
    """A sun that turns and rises evenly; its colour goes from the first to the last."""
    rows = []
    for frame in range(0, FRAMES + 1, step):
        part = frame / FRAMES
        azimuth = math.radians(azimuth_deg + turn_deg * part)
        elevation = math.radians(elevation_deg + rise_deg * part)
        direction = (math.cos(elevation) * math.sin(azimuth), math.sin(elevation),
                     -math.cos(elevation) * math.cos(azimuth))
        colour = tuple(round(a + (b - a) * part, 2) for a, b in zip(first, last))
        rows.append(f"    - {{frame: {frame}, direction: {listed(direction)}, "
                    f"irradiance_w_per_m2: {listed(colour)}}}")
    return "sun:\n  keys:\n" + "\n".join(rows)


def camera(keys, fov_deg):
    if len(keys) == 1:
        return "camera: {position_m: %s, look_at_m: %s, vertical_fov_deg: %g}" % (
            listed(keys[0][1]), listed(keys[0][2]), fov_deg)
    rows = ""
    for frame, position, look_at, cut in keys:
        row = "    - {frame: %d, position_m: %s, look_at_m: %s" % (frame, listed(position),
                                                                  listed(look_at))
        rows += row + (",\n       cut: true}\n" if cut else "}\n")
    return f"camera:\n  vertical_fov_deg: {fov_deg:g}\n  keys:\n{rows}".rstrip()


def still(position, look_at):
    return [(0, position, look_at, False)]
