"""python3 models.py FOLDER

Writes a ball for each extension of glTF's materials, FOLDER/NAME.gltf, and the sky that all are seen in, FOLDER/sky.hdr.
Prints the names. cycles.py and three.html show the same files.
"""
import base64
import json
import math
import os
import struct
import sys

RINGS, SEGMENTS = 48, 96
SKY = (256, 128)


def ball():
    """Positions (normals alike), tangents, texture coordinates, triangles; y is up, tangents run east."""
    places, tangents, uvs, triangles = [], [], [], []
    for i in range(RINGS + 1):
        for k in range(SEGMENTS + 1):
            polar, around = math.pi * i / RINGS, 2 * math.pi * k / SEGMENTS
            places.append((math.sin(polar) * math.sin(around), math.cos(polar), math.sin(polar) * math.cos(around)))
            tangents.append((math.cos(around), 0.0, -math.sin(around), 1.0))
            uvs.append((k / SEGMENTS, i / RINGS))
    for i in range(RINGS):
        for k in range(SEGMENTS):
            a, b = i * (SEGMENTS + 1) + k, (i + 1) * (SEGMENTS + 1) + k
            if i > 0:
                triangles.append((a, b, a + 1))
            if i < RINGS - 1:
                triangles.append((b, b + 1, a + 1))
    return places, tangents, uvs, triangles


def pbr(color, metallic, roughness):
    return {"pbrMetallicRoughness": {"baseColorFactor": [*color, 1], "metallicFactor": metallic, "roughnessFactor": roughness}}


def with_extension(material, **extensions):
    return {**material, "extensions": {f"KHR_materials_{name}": values for name, values in extensions.items()}}


RED, WHITE, STEEL, GOLD = (0.6, 0.08, 0.06), (0.8, 0.8, 0.8), (0.7, 0.72, 0.75), (1.0, 0.78, 0.34)


def materials():
    return {
        "plain": pbr(RED, 0, 0.4),
        "metal": pbr(GOLD, 1, 0.3),
        "specular": with_extension(pbr(RED, 0, 0.4), specular={"specularFactor": 1, "specularColorFactor": [1, 4, 8]}),
        "ior": with_extension(pbr(RED, 0, 0.3), ior={"ior": 2.2}),
        "clearcoat": with_extension(pbr(RED, 0, 0.8), clearcoat={"clearcoatFactor": 1}),
        "rough_clearcoat": with_extension(pbr(RED, 0, 0.8), clearcoat={"clearcoatFactor": 1, "clearcoatRoughnessFactor": 0.4}),
        "sheen": with_extension(pbr((0.1, 0.02, 0.15), 0, 1), sheen={"sheenColorFactor": [0.9, 0.6, 0.8], "sheenRoughnessFactor": 0.5}),
        "iridescence": with_extension(pbr((0.02, 0.02, 0.02), 0, 0.2), ior={"ior": 1.8}, iridescence={
            "iridescenceFactor": 1, "iridescenceIor": 1.4, "iridescenceThicknessMaximum": 420}),
        "iridescent_metal": with_extension(pbr(WHITE, 1, 0.25), iridescence={
            "iridescenceFactor": 1, "iridescenceIor": 1.6, "iridescenceThicknessMaximum": 350}),
        "anisotropy": with_extension(pbr(STEEL, 1, 0.3), anisotropy={"anisotropyStrength": 0.7}),
        "anisotropy_turned": with_extension(pbr(STEEL, 1, 0.3), anisotropy={
            "anisotropyStrength": 0.7, "anisotropyRotation": math.pi / 2}),
        "transmission": {**with_extension(pbr((0.7, 0.9, 0.8), 0, 0), transmission={"transmissionFactor": 1}), "doubleSided": True},
        "diffuse_transmission": {**with_extension(pbr((0.25, 0.5, 0.1), 0, 1), ior={"ior": 1}, diffuse_transmission={
            "diffuseTransmissionFactor": 0.5, "diffuseTransmissionColorFactor": [0.7, 0.8, 0.2]}), "doubleSided": True},
        "emissive_strength": with_extension({**pbr(RED, 0, 0.6), "emissiveFactor": [0.1, 0.2, 0.4]}, emissive_strength={"emissiveStrength": 1.5}),
    }


def radiance(direction):
    """Two soft boxes over a dim room, brighter towards one side; no brighter than 12."""
    x, y, z = direction
    sum_ = [0.10 + 0.12 * max(y, 0), 0.10 + 0.13 * max(y, 0), 0.11 + 0.16 * max(y, 0)]
    for towards, light, inner, outer in (((-0.55, 0.62, 0.56), (12, 11, 10), 0.97, 0.93), ((0.75, 0.25, -0.6), (2, 3, 5), 0.93, 0.85),
                                         ((0.3, 0.9, 0.3), (1.5, 1.5, 1.5), 0.95, 0.8)):
        length = math.sqrt(sum(t * t for t in towards))
        cosine = (x * towards[0] + y * towards[1] + z * towards[2]) / length
        share = min(max((cosine - outer) / (inner - outer), 0), 1)
        share = share * share * (3 - 2 * share)
        sum_ = [s + share * l for s, l in zip(sum_, light)]
    return sum_


def write_sky(path):
    """Latitude-longitude, -z in the middle."""
    width, height = SKY
    with open(path, "wb") as file:
        file.write(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n" % (height, width))
        for j in range(height):
            polar = math.pi * (j + 0.5) / height
            for i in range(width):
                around = 2 * math.pi * ((i + 0.5) / width - 0.5)
                light = radiance((math.sin(polar) * math.sin(around), math.cos(polar), -math.sin(polar) * math.cos(around)))
                mantissa, exponent = math.frexp(max(light))
                scale = mantissa * 256 / max(light)
                file.write(bytes([*(int(c * scale) for c in light), exponent + 128]))


def write_ball(path, name, material):
    places, tangents, uvs, triangles = ball()
    parts = [(places, "VEC3", 34962), (tangents, "VEC4", 34962), (uvs, "VEC2", 34962), (triangles, "SCALAR", 34963)]
    data, views, accessors = b"", [], []
    for rows, kind, target in parts:
        packed = b"".join(struct.pack(f"<{len(r)}{'I' if kind == 'SCALAR' else 'f'}", *r) for r in rows)
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(packed), "target": target})
        accessor = {"bufferView": len(accessors), "componentType": 5125 if kind == "SCALAR" else 5126, "type": kind,
                    "count": 3 * len(rows) if kind == "SCALAR" else len(rows)}
        if kind == "VEC3":
            accessor.update(min=[-1, -1, -1], max=[1, 1, 1])
        accessors.append(accessor)
        data += packed
    used = sorted(material.get("extensions", {}))
    document = {
        "asset": {"version": "2.0"}, "extensionsUsed": used, "scene": 0, "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"mesh": 0}, {"camera": 0, "translation": [0, 0, 5]}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.5, "aspectRatio": 1, "znear": 0.1}}],
        "materials": [{"name": name, **material}], "accessors": accessors, "bufferViews": views,
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 0, "TANGENT": 1, "TEXCOORD_0": 2}, "indices": 3, "material": 0}]}],
        "buffers": [{"byteLength": len(data), "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}]}
    if not used:
        del document["extensionsUsed"]
    json.dump(document, open(path, "w"))


def main():
    folder = sys.argv[1]
    write_sky(os.path.join(folder, "sky.hdr"))
    for name, material in materials().items():
        write_ball(os.path.join(folder, name + ".gltf"), name, material)
        print(name)


if __name__ == "__main__":
    main()
