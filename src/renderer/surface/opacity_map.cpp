#include "renderer/surface/opacity_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>
#include <utility>

#include "image/channel_bounds.h"
#include "parallel/loops.h"

namespace render2mpeg::renderer {
namespace {

/// A triangle is split so often that its parts have about so many texels. chosen: 4, of 1 to 16, which leaves a
/// quarter of a leaf's card of 64 x 64 texels mixed; 1 leaves a sixth and takes four times the memory.
constexpr double texels_of_part = 4.0;
constexpr unsigned finest_level = 6;

constexpr unsigned level_bits = 4;

/// Bound of how far texture coordinates are off that floats interpolate, as a share of the largest of their terms.
/// 2^-23 for each of eight sums and products.
constexpr double uv_digits = 0x1p-20;

/// Values that textures mix are off by so much of the largest at most: as above.
constexpr float value_digits = 0x1p-18f;

constexpr std::size_t parts_of(unsigned level) {
    return std::size_t{1} << 2 * level;
}
constexpr std::size_t bytes_of(unsigned level) {
    return (parts_of(level) + 3) / 4;
}

static_assert(bytes_of(finest_level) + sizeof(std::uint32_t) == OpacityMaps::most_bytes_of_triangle);

/// The part of a triangle that holds weights (1 - u - v, u, v): row by row along v, each but the last of a row with
/// the one beside it that is turned.
std::size_t part_at(unsigned level, float u, float v) {
    const int n = 1 << level;
    const auto across = static_cast<float>(n);
    const int row = std::min(static_cast<int>(v * across), n - 1);
    const int column = std::min(static_cast<int>(u * across), n - 1 - row);
    const bool turned =
        u * across - static_cast<float>(column) + (v * across - static_cast<float>(row)) > 1.0f && column < n - 1 - row;
    return static_cast<std::size_t>(row * (2 * n - row) + 2 * column + (turned ? 1 : 0));
}

/// Texture coordinates of a triangle's corners.
using Corners = std::array<glm::dvec2, 3>;

/// A texture that has a say in how opaque a material is.
struct Channel {
    image::ChannelBounds bounds;
    scene::TextureUse use;
    glm::ivec2 size;

    Corners corners(const scene::Mesh& mesh, glm::uvec3 triangle) const {
        Corners at{};
        const std::vector<glm::vec2>& uv = mesh.uv[static_cast<std::size_t>(use.uv_set)];
        const auto& m = use.transform;
        for (int k = 0; k < 3; ++k) {
            const glm::dvec2 own = uv.empty() ? glm::dvec2(0) : glm::dvec2(uv[triangle[k]]);
            at[static_cast<std::size_t>(k)] = {m[0][0] * own.x + m[0][1] * own.y + m[0][2],
                                               m[1][0] * own.x + m[1][1] * own.y + m[1][2]};
        }
        return at;
    }

    /// By how much coordinates of a triangle are off at most.
    double error(const scene::Mesh& mesh, glm::uvec3 triangle) const {
        const std::vector<glm::vec2>& uv = mesh.uv[static_cast<std::size_t>(use.uv_set)];
        double largest = 0;
        for (int k = 0; k < 3 && !uv.empty(); ++k)
            largest = std::max({largest, std::abs(static_cast<double>(uv[triangle[k]].x)),
                                std::abs(static_cast<double>(uv[triangle[k]].y))});
        double most = 0;
        for (const auto& row : use.transform)
            most = std::max(most,
                            (std::abs(static_cast<double>(row[0])) + std::abs(static_cast<double>(row[1]))) * largest +
                                std::abs(static_cast<double>(row[2])));
        return uv_digits * most;
    }
};

/// How opaque a material is, by its textures.
struct AlphaRule {
    float factor;                 ///< of the material
    std::optional<float> cutoff;  ///< of alpha that is opaque or nothing
    std::vector<Channel> channels;

    AlphaRule(const scene::Material& material, const MaterialTextures& textures, std::uint32_t index)
        : factor(material.base_color.a) {
        if (material.alpha_mode == scene::AlphaMode::mask) cutoff = material.alpha_cutoff;
        for (const auto& [role, channel] : {std::pair(TextureRole::base_color, 3), std::pair(TextureRole::alpha, 0)})
            if (const image::Texture* texture = textures.of(index, role))
                channels.push_back({image::ChannelBounds(*texture, channel),
                                    use_of(material, role),
                                    {texture->width(), texture->height()}});
    }

    Opacity of(image::Bounds alpha) const {
        const float off = value_digits * std::max(alpha.high, cutoff.value_or(1.0f));
        if (!(alpha.low >= 0.0f)) return Opacity::mixed;
        if (cutoff) {
            if (alpha.low - off >= *cutoff) return Opacity::opaque;
            return alpha.high + off < *cutoff ? Opacity::clear : Opacity::mixed;
        }
        // All texels alike are mixed without rounding.
        if (alpha == image::Bounds{1.0f, 1.0f} || alpha.low - off >= 1.0f) return Opacity::opaque;
        return alpha.high == 0.0f ? Opacity::clear : Opacity::mixed;
    }
};

/// A triangle as the textures have it.
struct Card {
    std::vector<Corners> corners;  ///< by channel
    std::vector<double> error;     ///< likewise

    bool operator<(const Card& other) const {
        const auto bits = [](const Card& card) {
            std::vector<double> all;
            for (const Corners& c : card.corners)
                for (const glm::dvec2& uv : c) all.insert(all.end(), {uv.x, uv.y});
            all.insert(all.end(), card.error.begin(), card.error.end());
            return all;
        };
        const std::vector<double> a = bits(*this), b = bits(other);
        return std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) < 0;
    }

    /// Of the part whose corners have these weights of the second and third corner.
    Opacity part(const AlphaRule& rule, const std::array<glm::dvec2, 3>& weights) const {
        image::Bounds alpha{rule.factor, rule.factor};
        if (!(rule.factor >= 0.0f)) return Opacity::mixed;
        for (std::size_t c = 0; c < corners.size(); ++c) {
            glm::dvec2 low(INFINITY), high(-INFINITY);
            for (const glm::dvec2& w : weights) {
                const glm::dvec2 uv = (1.0 - w.x - w.y) * corners[c][0] + w.x * corners[c][1] + w.y * corners[c][2];
                if (!(std::isfinite(uv.x) && std::isfinite(uv.y))) return Opacity::mixed;
                low = glm::min(low, uv);
                high = glm::max(high, uv);
            }
            const auto found = rule.channels[c].bounds.within(low - error[c], high + error[c]);
            if (!found || !(found->low >= 0.0f)) return Opacity::mixed;
            alpha = {alpha.low * found->low, alpha.high * found->high};
        }
        return rule.of(alpha);
    }

    /// How often it is worth splitting.
    unsigned level(const AlphaRule& rule) const {
        double texels = 0;
        for (std::size_t c = 0; c < corners.size(); ++c) {
            const glm::dvec2 size(rule.channels[c].size), a = (corners[c][1] - corners[c][0]) * size,
                                                          b = (corners[c][2] - corners[c][0]) * size;
            texels = std::max(texels, 0.5 * std::abs(a.x * b.y - a.y * b.x));
        }
        unsigned level = 0;
        while (level < finest_level && static_cast<double>(parts_of(level)) * texels_of_part < texels) ++level;
        return level;
    }

    void fill(const AlphaRule& rule, unsigned level, std::uint8_t* states) const {
        const int n = 1 << level;
        const double side = 1.0 / n;
        std::size_t part_index = 0;
        for (int row = 0; row < n; ++row)
            for (int k = 0; k < 2 * (n - row) - 1; ++k, ++part_index) {
                const glm::dvec2 first(k / 2 * side, row * side), right = first + glm::dvec2(side, 0),
                                                                  above = first + glm::dvec2(0, side);
                const Opacity opacity = part(rule, {k % 2 == 0 ? first : first + glm::dvec2(side), right, above});
                states[part_index / 4] |=
                    static_cast<std::uint8_t>(static_cast<unsigned>(opacity) << 2 * (part_index % 4));
            }
    }
};

/// Whether a mesh in its material can have a map at all.
bool is_mapped(const scene::Mesh& mesh, const SurfaceMaterials& materials, std::uint32_t material) {
    return !mesh.has_curves() && mesh.colors.empty() && !mesh.triangles.empty() && materials.is_cut_out(material);
}

}  // namespace

OpacityMaps::Map::Map(const scene::Mesh& mesh, const scene::Material& material, const MaterialTextures& textures,
                      std::uint32_t index, std::size_t most) {
    if (mesh.triangles.size() > most / sizeof(std::uint32_t)) return;
    most -= mesh.triangles.size() * sizeof(std::uint32_t);
    const AlphaRule rule(material, textures, index);

    // Find triangles that differ.
    std::map<Card, std::size_t> known;
    std::vector<std::size_t> card_of;
    for (const glm::uvec3& triangle : mesh.triangles) {
        Card card;
        for (const Channel& channel : rule.channels) {
            card.corners.push_back(channel.corners(mesh, triangle));
            card.error.push_back(channel.error(mesh, triangle));
        }
        card_of.push_back(known.emplace(std::move(card), known.size()).first->second);
    }
    std::vector<const Card*> cards(known.size());
    for (const auto& [card, place] : known) cards[place] = &card;

    // Split them as finely as memory allows.
    std::vector<unsigned> levels(cards.size());
    for (std::size_t i = 0; i < cards.size(); ++i) levels[i] = cards[i]->level(rule);
    const auto size_with = [&](unsigned finest) {
        std::size_t size = 0;
        for (const unsigned level : levels) size += bytes_of(std::min(level, finest));
        return size;
    };
    unsigned finest = finest_level;
    while (finest > 0 && size_with(finest) > most) --finest;
    if (size_with(finest) > most) return;
    std::vector<std::uint32_t> first(cards.size());
    std::size_t size = 0;
    for (std::size_t i = 0; i < cards.size(); ++i) {
        levels[i] = std::min(levels[i], finest);
        first[i] = static_cast<std::uint32_t>(size) << level_bits | levels[i];
        size += bytes_of(levels[i]);
    }
    states_.assign(size, 0);
    parallel::for_each(cards.size(),
                       [&](std::size_t i) { cards[i]->fill(rule, levels[i], &states_[first[i] >> level_bits]); });
    for (const std::size_t card : card_of) triangles_.push_back(first[card]);
}

Opacity OpacityMaps::Map::at(const core::SurfaceAddress& address) const {
    if (triangles_.empty()) return Opacity::mixed;
    const std::uint32_t triangle = triangles_[address.primitive];
    const std::size_t part = part_at(triangle & ((1u << level_bits) - 1), address.u, address.v);
    return static_cast<Opacity>(states_[(triangle >> level_bits) + part / 4] >> 2 * (part % 4) & 3u);
}

std::size_t OpacityMaps::Map::bytes() const {
    return triangles_.size() * sizeof(std::uint32_t) + states_.size();
}

OpacityMaps::OpacityMaps(const scene::Animation& animation, const SurfaceMaterials& materials) {
    std::map<std::pair<int, int>, int> made;
    std::size_t left = most_bytes;
    for (std::size_t i = 0; i < animation.objects.size(); ++i) {
        const scene::Object& object = animation.objects[i];
        const scene::Mesh& mesh = animation.meshes[static_cast<std::size_t>(object.mesh)];
        const auto material = static_cast<std::uint32_t>(object.material);
        if (!is_mapped(mesh, materials, material)) continue;
        if (map_of_.empty()) map_of_.assign(animation.objects.size(), -1);
        const auto [entry, is_new] =
            made.emplace(std::pair(object.mesh, object.material), static_cast<int>(maps_.size()));
        map_of_[i] = entry->second;
        if (!is_new) continue;
        maps_.push_back(Map(mesh, animation.materials[material], materials.textures(), material, left));
        left -= maps_.back().bytes();
    }
}

std::size_t OpacityMaps::bytes() const {
    std::size_t sum = 0;
    for (const Map& map : maps_) sum += map.bytes();
    return sum;
}

}  // namespace render2mpeg::renderer
