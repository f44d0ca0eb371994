#include "image/cryptomatte.h"

#include <algorithm>
#include <bit>
#include <cstdio>
#include <map>
#include <utility>

namespace render2mpeg::image {
namespace {

/// Objects or materials of a pixel that a file keeps. chosen: 6 as Blender's default.
constexpr std::size_t ranks = 6;

std::string hex(std::uint32_t value) {
    char text[9];
    std::snprintf(text, sizeof text, "%08x", value);
    return text;
}

/// In quotes, for JSON.
std::string json_text(const std::string& text) {
    std::string out(1, '"');
    for (const char c : text) {
        char code[8];
        std::snprintf(code, sizeof code, "\\u%04x", static_cast<unsigned>(static_cast<unsigned char>(c)));
        if (c == '"' || c == '\\') out.push_back('\\');
        if (static_cast<unsigned char>(c) < 0x20)
            out.append(code);
        else
            out.push_back(c);
    }
    out.push_back('"');
    return out;
}

/// Says in the header how the layer is to be read.
void describe(const std::string& layer, const std::vector<std::string>& names, FrameFacts& facts) {
    const std::string key = "cryptomatte/" + hex(matte_hash(layer)).substr(0, 7) + "/";
    std::map<std::string, std::uint32_t> ids;
    for (const std::string& name : names) ids.emplace(name, std::bit_cast<std::uint32_t>(matte_id(name)));
    std::string manifest = "{";
    for (const auto& [name, id] : ids)
        manifest.append(manifest.size() > 1 ? "," : "")
            .append(json_text(name))
            .append(":\"")
            .append(hex(id))
            .append("\"");
    facts.texts.emplace_back(key + "name", layer);
    facts.texts.emplace_back(key + "hash", "MurmurHash3_32");
    facts.texts.emplace_back(key + "conversion", "uint32_to_float32");
    facts.texts.emplace_back(key + "manifest", manifest + "}");
}

/// Ids of a pixel with their shares, the largest first.
void rank(std::span<const core::Matte> parts, std::uint32_t core::Matte::*index, const std::vector<float>& ids,
          std::vector<std::pair<float, float>>& out) {
    out.clear();
    for (const core::Matte& part : parts) {
        if (part.*index == core::no_id) continue;
        const float id = ids[part.*index];
        const auto same = std::find_if(out.begin(), out.end(), [&](const auto& o) { return o.first == id; });
        if (same == out.end())
            out.emplace_back(id, part.share);
        else
            same->second += part.share;
    }
    std::stable_sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
}

void add_layer(const core::Mattes& mattes, const std::string& layer, const std::vector<std::string>& names,
               std::uint32_t core::Matte::*index, std::vector<Channel>& channels) {
    std::vector<float> ids;
    for (const std::string& name : names) ids.push_back(matte_id(name));
    const std::size_t first = channels.size(), pixels = mattes.starts.size() - 1;
    for (std::size_t k = 0; k < 2 * ranks; ++k)
        channels.push_back({layer + "0" + std::to_string(k / 4) + "." + "RGBA"[k % 4], std::vector<float>(pixels)});
    std::vector<std::pair<float, float>> ranked;
    for (std::size_t p = 0; p < pixels; ++p) {
        rank(mattes.of_pixel(p), index, ids, ranked);
        for (std::size_t k = 0; k < std::min(ranks, ranked.size()); ++k) {
            channels[first + 2 * k].values[p] = ranked[k].first;
            channels[first + 2 * k + 1].values[p] = ranked[k].second;
        }
    }
}

}  // namespace

std::uint32_t matte_hash(std::string_view name) {
    // Austin Appleby's MurmurHash3_x86_32, as [Cryptomatte] asks for.
    constexpr std::uint32_t c1 = 0xcc9e2d51u, c2 = 0x1b873593u;
    const auto byte = [&](std::size_t i) { return std::uint32_t{static_cast<unsigned char>(name[i])}; };
    const auto scrambled = [](std::uint32_t k) { return std::rotl(k * c1, 15) * c2; };
    std::uint32_t h = 0;
    const std::size_t whole = name.size() / 4 * 4;
    for (std::size_t i = 0; i < whole; i += 4) {
        h ^= scrambled(byte(i) | byte(i + 1) << 8 | byte(i + 2) << 16 | byte(i + 3) << 24);
        h = std::rotl(h, 13) * 5 + 0xe6546b64u;
    }
    std::uint32_t rest = 0;
    for (std::size_t i = name.size(); i > whole; --i) rest = rest << 8 | byte(i - 1);
    h ^= scrambled(rest);
    h ^= static_cast<std::uint32_t>(name.size());
    h = (h ^ h >> 16) * 0x85ebca6bu;
    h = (h ^ h >> 13) * 0xc2b2ae35u;
    return h ^ h >> 16;
}

float matte_id(std::string_view name) {
    const std::uint32_t hash = matte_hash(name), exponent = hash >> 23 & 255u;
    return std::bit_cast<float>(exponent == 0 || exponent == 255 ? hash ^ 1u << 23 : hash);
}

void add_cryptomatte(const core::Mattes& mattes, const MatteNames& names, std::vector<Channel>& channels,
                     FrameFacts& facts) {
    add_layer(mattes, "ViewLayer.CryptoObject", names.objects, &core::Matte::object, channels);
    add_layer(mattes, "ViewLayer.CryptoMaterial", names.materials, &core::Matte::material, channels);
    describe("ViewLayer.CryptoObject", names.objects, facts);
    describe("ViewLayer.CryptoMaterial", names.materials, facts);
}

}  // namespace render2mpeg::image
