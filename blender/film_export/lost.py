"""What a film cannot show of a .blend: one line each, by object and reason."""


class Lost:
    def __init__(self):
        self.lines = []

    def add(self, thing, reason):
        """`thing`: a name, or something that has one."""
        line = f"{getattr(thing, 'name', thing)}: {reason}"
        if line not in self.lines:
            self.lines.append(line)
