#!/usr/bin/env python3
"""bench/silence.py COMMAND...

Runs a command on a terminal of its own, and tells for how long nothing was written to it: the longest silences, and what
stood there before each. Exits with 1 where one is longer than two seconds.
"""
import os
import pty
import re
import sys
import time


def main():
    pid, terminal = pty.fork()
    if pid == 0:
        os.execvp(sys.argv[1], sys.argv[1:])
    silences, before, last = [], "its start", time.monotonic()
    while True:
        try:
            text = os.read(terminal, 65536)
        except OSError:  # the terminal's other end is closed
            text = b""
        now = time.monotonic()
        silences.append((now - last, before))
        if not text:
            break
        lines = re.split(r"[\r\n]+", re.sub(r"\x1b\[[0-9;]*[A-Za-z]", "", text.decode(errors="replace")))
        before = next((line for line in reversed(lines) if line.strip()), before)
        last = now
    os.waitpid(pid, 0)
    silences.sort(reverse=True)
    for seconds, line in silences[:5]:
        print(f"{seconds:6.2f} s after: {line[:100]}")
    sys.exit(silences[0][0] > 2)


if __name__ == "__main__":
    main()
