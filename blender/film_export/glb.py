# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""Writes binary glTF 2.0 [glTF2]."""
import json
import struct

import numpy as np

COMPONENTS = {np.dtype(np.float32): 5126, np.dtype(np.uint32): 5125, np.dtype(np.uint16): 5123}
TYPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}


class Glb:
    """A document in the making. Everything is added once and named by its index."""

    def __init__(self):
        self.document = {"asset": {"version": "2.0", "generator": "render2mpeg's Blender export"}, "scene": 0,
                         "scenes": [{"nodes": []}], "nodes": [], "meshes": [], "materials": [], "textures": [],
                         "samplers": [], "images": [], "accessors": [], "bufferViews": []}
        self.channels, self.samplers = [], []
        self.extensions = set()
        self.bytes = bytearray()
        self.times = {}
        self.brushed = set()  # materials whose lobe is wider about their object's axis

    def add(self, kind, value):
        self.document[kind].append(value)
        return len(self.document[kind]) - 1

    def accessor(self, array, bounds=False):
        """Of rows of numbers, or of numbers."""
        array = np.ascontiguousarray(array)
        width = 1 if array.ndim == 1 else array.shape[1]
        while len(self.bytes) % 4:
            self.bytes.append(0)
        view = self.add("bufferViews", {"buffer": 0, "byteOffset": len(self.bytes), "byteLength": array.nbytes})
        self.bytes += array.tobytes()
        says = {"bufferView": view, "componentType": COMPONENTS[array.dtype], "count": len(array), "type": TYPES[width]}
        if bounds:
            rows = array.reshape(len(array), -1)
            says["min"], says["max"] = rows.min(axis=0).tolist(), rows.max(axis=0).tolist()
        return self.add("accessors", says)

    def node(self, node, parent=None):
        index = self.add("nodes", node)
        if parent is None:
            self.document["scenes"][0]["nodes"].append(index)
        else:
            self.document["nodes"][parent].setdefault("children", []).append(index)
        return index

    def channel(self, node, path, times, values, interpolation="LINEAR"):
        exact, times = np.asarray(times, dtype=float), np.asarray(times, dtype=np.float32)
        if interpolation == "STEP":  # what changes at a frame is not to be late by a rounding
            times = np.where(times > exact, np.nextafter(times, np.float32(0)), times)
        known = times.tobytes()
        if known not in self.times:
            self.times[known] = self.accessor(times, bounds=True)
        output = self.accessor(np.asarray(values, dtype=np.float32))
        self.samplers.append({"input": self.times[known], "output": output, "interpolation": interpolation})
        self.channels.append({"sampler": len(self.samplers) - 1, "target": {"node": node, "path": path}})

    def save(self, path):
        document = {key: value for key, value in self.document.items() if value != []}
        if self.channels:
            document["animations"] = [{"name": "film", "channels": self.channels, "samplers": self.samplers}]
        if self.extensions:
            document["extensionsUsed"] = sorted(self.extensions)
        if self.bytes:
            document["buffers"] = [{"byteLength": len(self.bytes)}]
        text = json.dumps(document, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        data = bytes(self.bytes) + b"\0" * (-len(self.bytes) % 4)
        chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
        if data:
            chunks += struct.pack("<II", len(data), 0x004E4942) + data
        with open(path, "wb") as file:
            file.write(struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks)
