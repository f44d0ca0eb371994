#!/usr/bin/env python3
"""bench/records.py OFF.json ON.json [CHUNK]

One row of bench/records.sh, of the statistics of a film with --cache off and one with --cache on, which may have different numbers
of frames: CPU seconds of light (gathering, and photons) of the first frame and of a later one in the mean, how many times as long a
chunk of CHUNK frames (48) takes without records, rays of a later frame, and the share of audited pixels beyond their tolerance."""
import json
import sys


def light(s):
    """(first frame, later frame, choice of anchors) in CPU seconds. Anchors are chosen before the first frame, outside its own time."""
    frames, seconds, passes = s['frames'], s['seconds'], s['passes']
    gathered = sum(v for name, v in passes.items() if name in ('direct light tree', 'indirect light tree', 'punctual lights', 'photons'))
    in_frames = seconds['shade'] + seconds['preview']
    audit = (s.get('audit') or {}).get('seconds', 0)
    other = (seconds['see'] + seconds['tolerate'] + seconds['develop'] + seconds['encode'] + passes.get('motion', 0) + audit) / frames
    first = s['per_frame'][0]['seconds'] - other
    return first, (in_frames - first) / (frames - 1), max(gathered - in_frames, 0)


def later_rays(s):
    return sum(f['shadow_rays'] for f in s['per_frame'][1:]) / 1e6 / (s['frames'] - 1)


def beyond(s):
    return f"{100 * s['audit']['over_tolerance']:.2f}" if s.get('audit') else '-'


def main():
    off, on = (json.load(open(f)) for f in sys.argv[1:3])
    frames = int(sys.argv[3]) if len(sys.argv) > 3 else 48
    a, b = light(off), light(on)
    chunk = [first + choice + (frames - 1) * later for first, later, choice in (a, b)]
    print(f'{a[0] + a[2]:.1f}, {b[0] + b[2]:.1f} | {a[1]:.2f}, {b[1]:.2f} | x{chunk[0] / chunk[1]:.2f} | x{a[1] / b[1]:.2f} '
          f'| {later_rays(off):.1f}, {later_rays(on):.1f} | {beyond(off)}, {beyond(on)} % |')


if __name__ == '__main__':
    main()
