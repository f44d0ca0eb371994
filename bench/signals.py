#!/usr/bin/env python3
"""Ends renders, encodings and a farm's parts and joins at random moments by KILL, TERM and INT and goes on with them: every kind of
output must come out with the bytes of an undisturbed run, leave nothing else behind and never hang. Tells how long a signal took.

usage: bench/signals.py PROGRAM [SIGNALS [SEED [KIND ...]]]"""
import json, os, pathlib, random, signal, subprocess, sys, tempfile, time

FRAMES, GOP = 80, 41
SCENE = {
    "camera": {"look_at": [0, 0.5, 0],
               "keys": [{"at": 0, "position": [0, 1.5, 4]}, {"at": 3, "position": [3, 1.5, 3]}]},
    "lights": [{"kind": "point", "position": [1, 2, 1], "intensity": 9},
               {"kind": "point", "position": [-2, 2, 1], "intensity": 3}],
    "objects": [{"name": "floor", "shape": "plane", "size": [6, 6]},
                {"name": "box", "shape": "box", "keys": [{"at": 0, "position": [0, 0, 0]}, {"at": 3, "position": [1, 0, 0]}]}],
    "frames": FRAMES}
STILL = {**SCENE, "objects": [{"name": "floor", "shape": "plane", "size": [6, 6]}, {"name": "box", "shape": "box"}]}
WITH_ALL_LIGHT = ("mpg", "hevc", "layers", "light", "pipe")  # others are drafts, for more signals
# name: ending, options, whether things stand still
OUTPUTS = {
    "mpg": (".mpg", "", False), "m2v": (".m2v", "", True), "ts": (".ts", "", False), "vob": (".vob", "", False),
    "mp4": (".mp4", "", False), "mov": (".mov", "", True), "mkv": (".mkv", "", False), "hevc": (".mp4", "--codec hevc", True),
    "av1": (".mkv", "--codec av1", True), "y4m": (".y4m", "", False), "exr": (".%04d.exr", "", True),
    "png": (".%04d.png", "", False), "layers": (".mpg", "--aov {folder}/layers/", True),
    "passes": (".mpg", "--bitrate 200k", False), "light": (".mpg", "--light-cache {folder}/film.light", True),
    "webm": (".webm", "", False), "gif": (".gif", "", False), "prores": (".mov", "--codec prores", False),
    "ffv1": (".mkv", "--codec ffv1", False), "lossless": (".mkv", "--codec h264_lossless", True),
    "encode": (".mp4", "", False), "join": (".mp4", "", False),
    "stats": (".mpg", "--stats {folder}/film.json --chunks-at-once 2", False), "pipe": (".mpg", "", False)}


class Kind:
    def __init__(self, program, name, base):
        self.name, self.base = name, base
        self.ending, self.options, still = OUTPUTS[name]
        self.scene = base / ("still.json" if still else "moving.json")
        self.program, self.lit, self.again, self.ends = program, 0, 0, []
        begin = time.monotonic()
        self.whole = self.finish("whole")
        self.seconds = time.monotonic() - begin

    def settings(self, folder):
        return ([str(self.scene), "-o", str(folder / ("film" + self.ending)), "--size", "64x64" if self.name == "av1" else "48x32",
                 "--samples", "1", "--gop", str(GOP), "--effort", "default" if self.name in WITH_ALL_LIGHT else "draft"]
                + self.options.format(folder=folder).split())

    def commands(self, folder):
        """Whatever is given makes the film, one behind the other; each goes on where it was ended."""
        threads = ["--threads", random.choice("12")]
        if self.name == "encode":
            return [[self.program, "encode", str(self.frames()), "-o", str(folder / "film.mp4"), "-y", "--gop", str(GOP)] + threads]
        if self.name == "join":
            plan = str(folder / "film.mp4.farm")
            return [[self.program, "part", plan, part] + threads for part in "12"] + [[self.program, "join", plan]]
        return [[self.program, "render", *self.settings(folder), "-y", "--resume", *threads]]

    def frames(self):
        """Uncompressed pictures, made once."""
        file = self.base / "frames.y4m"
        if not file.exists():
            subprocess.run([self.program, "render", str(self.scene), "-o", str(file), "--size", "320x180", "--samples", "1",
                            "--effort", "draft", "--quiet"], check=True)
        return file

    def make(self, name):
        folder = self.base / self.name / name
        folder.mkdir(parents=True)
        if self.name == "layers": (folder / "layers").mkdir()
        if self.name == "pipe": os.mkfifo(folder / "film.mpg")
        if self.name == "join":
            subprocess.run([self.program, "farm", *self.settings(folder), "--to", "parallel", "--parts", "2"], check=True, capture_output=True)
        return folder

    def start(self, command):
        return subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                start_new_session=True, preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))

    def told(self, process, seconds):
        try:
            return process.communicate(timeout=seconds)[0].decode(errors="replace")
        except subprocess.TimeoutExpired:
            process.kill()
            raise SystemExit(f"{self.name}: it hangs: {process.args}")

    def count(self, text):
        for line in text.splitlines():
            if line.startswith("resuming") and " with frame " in line:
                self.again += 1
                self.lit += int(line.split(": ")[-1].split()[0])

    def finish(self, name):
        folder = self.base / self.name / name
        if not folder.exists(): self.make(name)
        read = None
        for command in self.commands(folder):
            process = self.start(command)
            if self.name == "pipe":
                read = subprocess.Popen(["cat", str(folder / "film.mpg")], stdout=open(folder / "read", "wb"))
            text = self.told(process, 300)
            if read: read.wait(60)
            if process.returncode: raise SystemExit(f"{self.name}: {process.returncode}: {text}")
            self.count(text)
        found = {}
        for file in sorted(folder.rglob("*")):
            if file.is_fifo() or file.is_dir() or "film.mp4.farm" in file.parts: continue
            # Later runs may add more light; statistics have times.
            found[str(file.relative_to(folder))] = b"" if file.suffix in (".light", ".json") else file.read_bytes()
        if any("partial" in name or ".tmp" in name for name in found): raise SystemExit(f"{self.name}: litter: {list(found)}")
        return found

    def disturb(self, name, most):
        folder = self.make(name)
        ended = 0
        for _ in range(most):
            # A join before its parts says that they are not whole.
            process = self.start(random.choice(self.commands(folder)))
            time.sleep(random.uniform(0, self.seconds if self.name != "pipe" else 2 * self.seconds))
            which = random.choice([signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
            process.send_signal(which)
            sent = time.monotonic()
            text = self.told(process, 60)
            self.count(text)
            if process.returncode == 0 and self.name != "join": break
            if self.name == "join" and process.returncode in (0, 1): continue
            self.ends.append(time.monotonic() - sent)
            if process.returncode not in (-which, 128 + which): raise SystemExit(f"{self.name}: {process.returncode}: {text}")
            ended += 1
        found = self.finish(name)
        if found != self.whole:
            other = [n for n in self.whole.keys() | found.keys() if found.get(n) != self.whole.get(n)]
            raise SystemExit(f"{self.name}: other bytes: {sorted(other)[:5]} in {folder}")
        subprocess.run(["rm", "-rf", str(folder)])
        return ended


def main():
    program = os.path.abspath(sys.argv[1])
    wanted, seed = int(sys.argv[2]) if len(sys.argv) > 2 else 500, int(sys.argv[3]) if len(sys.argv) > 3 else 1
    named = sys.argv[4:] or list(OUTPUTS)
    if not set(named) <= set(OUTPUTS): sys.exit(f"signals: kinds are {' '.join(OUTPUTS)}")
    random.seed(seed)
    base = pathlib.Path(tempfile.mkdtemp(prefix="signals."))
    (base / "moving.json").write_text(json.dumps(SCENE))
    (base / "still.json").write_text(json.dumps(STILL))
    kinds = [Kind(program, name, base) for name in named]
    ended = films = 0
    while ended < wanted:
        for kind in kinds:
            films += 1
            ended += kind.disturb(f"film{films}", 5)
        longest = max((end for kind in kinds for end in kind.ends), default=0)
        print(f"{films} films, {ended} signals; from signal to end {longest:.2f} s at most", flush=True)
    for kind in kinds:
        print(f"{kind.name:7} a film takes {kind.seconds:.1f} s; {kind.again} runs went on, behind "
              f"{kind.lit / max(1, kind.again):.0f} of {FRAMES} frames")
    ends = sorted(end for kind in kinds for end in kind.ends)
    print(f"{ended} ends by a signal in {films} films: all have the bytes of an undisturbed run; from signal to end "
          f"{ends[len(ends) // 2]:.2f} s, {ends[-1]:.2f} at most")
    subprocess.run(["rm", "-rf", str(base)])


main()
