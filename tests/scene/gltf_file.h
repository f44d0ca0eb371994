#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

/// Tiny glTF files made in code, whole or broken.
namespace render2mpeg::test {

/// A glTF document with one buffer. `json` is free to be changed or broken before it is written.
class GltfFile {
  public:
    nlohmann::json json = {{"asset", {{"version", "2.0"}}}};
    std::vector<unsigned char> binary;

    static constexpr int int8 = 5120, uint8 = 5121, int16 = 5122, uint16 = 5123, uint32 = 5125, float32 = 5126;

    /// Appends values to the buffer as a view of their own and returns its index.
    template <class T>
    int add_view(const std::vector<T>& values, int stride = 0) {
        while (binary.size() % 4 != 0) binary.push_back(0);
        nlohmann::json view = {{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", values.size() * sizeof(T)}};
        if (stride != 0) view["byteStride"] = stride;
        const auto* bytes = reinterpret_cast<const unsigned char*>(values.data());
        binary.insert(binary.end(), bytes, bytes + values.size() * sizeof(T));
        return append("bufferViews", view);
    }

    /// An accessor over a view of its own.
    template <class T>
    int add_accessor(const std::vector<T>& values, int component, const std::string& type, bool normalized = false) {
        const std::size_t width = type == "SCALAR" ? 1
                                  : type == "VEC2" ? 2
                                  : type == "VEC3" ? 3
                                  : type == "VEC4" ? 4
                                                   : 16;
        nlohmann::json accessor = {{"bufferView", add_view(values)},
                                   {"componentType", component},
                                   {"count", values.size() / width},
                                   {"type", type}};
        if (normalized) accessor["normalized"] = true;
        return append("accessors", accessor);
    }
    int add_floats(const std::vector<float>& values, const std::string& type) {
        return add_accessor(values, float32, type);
    }

    /// Appends to a top-level array and returns the index.
    int append(const char* kind, const nlohmann::json& value) {
        json[kind].push_back(value);
        return static_cast<int>(json[kind].size()) - 1;
    }
    /// The one primitive of the one mesh.
    nlohmann::json& primitive() { return json["meshes"][0]["primitives"][0]; }

    /// The triangle (0,0,0), (1,0,0), (0,1,0) at one node.
    static GltfFile triangle() {
        GltfFile file;
        const int positions = file.add_floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
        file.append("meshes", {{"primitives", {{{"attributes", {{"POSITION", positions}}}}}}});
        file.append("nodes", {{"mesh", 0}, {"name", "thing"}});
        file.append("scenes", {{"nodes", {0}}});
        file.json["scene"] = 0;
        return file;
    }

    std::string text() const {
        nlohmann::json whole = json;
        if (!binary.empty() && !whole.contains("buffers"))
            whole["buffers"] = {{{"byteLength", binary.size()}, {"uri", data_uri(binary)}}};
        return whole.dump();
    }

    std::filesystem::path write(const std::filesystem::path& path) const { return write_text(path, text()); }

    /// As a binary file with the buffer in its second chunk.
    std::filesystem::path write_binary(const std::filesystem::path& path) const {
        nlohmann::json whole = json;
        whole["buffers"] = {{{"byteLength", binary.size()}}};
        std::string text = whole.dump();
        while (text.size() % 4 != 0) text += ' ';
        std::vector<unsigned char> data = binary;
        while (data.size() % 4 != 0) data.push_back(0);
        std::string bytes = "glTF";
        const auto add = [&](std::uint32_t v) { bytes.append(reinterpret_cast<const char*>(&v), 4); };
        add(2);
        add(static_cast<std::uint32_t>(12 + 8 + text.size() + 8 + data.size()));
        add(static_cast<std::uint32_t>(text.size()));
        bytes += "JSON" + text;
        add(static_cast<std::uint32_t>(data.size()));
        bytes.append("BIN\0", 4).append(data.begin(), data.end());
        return write_text(path, bytes);
    }

    static std::filesystem::path write_text(const std::filesystem::path& path, const std::string& text) {
        std::ofstream(path, std::ios::binary) << text;
        return path;
    }

    static std::string data_uri(const std::vector<unsigned char>& bytes) {
        static const char* alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        std::string text = "data:application/octet-stream;base64,";
        for (std::size_t i = 0; i < bytes.size(); i += 3) {
            std::uint32_t three = 0;
            for (std::size_t k = 0; k < 3; ++k) three = three << 8 | (i + k < bytes.size() ? bytes[i + k] : 0u);
            for (std::size_t k = 0; k < 4; ++k)
                text += i + k <= bytes.size() ? alphabet[three >> (18 - 6 * k) & 63] : '=';
        }
        return text;
    }
};

}  // namespace render2mpeg::test
