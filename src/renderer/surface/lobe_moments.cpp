#include "renderer/surface/lobe_moments.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>

#include "core/sampling.h"
#include "renderer/surface/bsdf.h"
#include "renderer/surface/dielectric.h"

namespace render2mpeg::renderer {
namespace {

constexpr int table_side = 16, roots = 9;
constexpr float narrowest = 0.1f, largest_root = 0.5f;

/// Of one outgoing direction and width.
struct MomentEntry {
    std::array<float, 2> whole{};                       ///< by Masking
    std::array<std::array<float, roots>, 2> fresnel{};  ///< likewise
    float edge = 0;
};

struct MomentTable {
    std::array<std::array<MomentEntry, table_side>, table_side> entries{};  ///< by roughness, by the root of the cosine
    std::array<float, table_side> mean_whole{};                             ///< by roughness
    std::array<float, roots> mean_fresnel{};
};

float root_of(int k) {
    return largest_root * static_cast<float>(k) / (roots - 1);
}

MomentEntry entry_at(float cosine, float alpha) {
    constexpr int across = 32;
    const glm::vec3 eye(std::sqrt(1.0f - cosine * cosine), 0, cosine);
    const float eye_part = unhidden(cosine, alpha);
    MomentEntry sum;
    for (int i = 0; i < across * across; ++i) {
        const glm::vec2 u((static_cast<float>(i % across) + 0.5f) / across,
                          (static_cast<float>(i / across) + 0.5f) / across);
        const glm::vec3 half = visible_normal(eye, alpha, u);
        const float vh = std::clamp(glm::dot(eye, half), 0.0f, 1.0f), nl = 2.0f * vh * half.z - cosine;
        if (!(nl > 0.0f)) continue;
        const float light_part = unhidden(nl, alpha), hidden = 1.0f / light_part + 1.0f / eye_part - 1.0f;
        const std::array<float, 2> weight{1.0f / (hidden * eye_part), light_part};
        for (std::size_t m = 0; m < 2; ++m) sum.whole[m] += weight[m];
        for (int k = 1; k < roots; ++k) {
            const float f = relative_fresnel(vh, root_of(k));
            for (std::size_t m = 0; m < 2; ++m) sum.fresnel[m][static_cast<std::size_t>(k)] += weight[m] * f;
        }
        sum.edge += weight[0] * vh * std::pow(1.0f - vh, 6.0f);
    }
    constexpr float share = 1.0f / (across * across);
    for (std::size_t m = 0; m < 2; ++m) {
        sum.whole[m] *= share;
        for (float& f : sum.fresnel[m]) f *= share;
    }
    sum.edge *= share;
    return sum;
}

MomentTable make_moment_table() {
    MomentTable table;
    for (int row = 0; row < table_side; ++row) {
        const float roughness = narrowest + (1.0f - narrowest) * static_cast<float>(row) / (table_side - 1);
        auto& entries = table.entries[static_cast<std::size_t>(row)];
        for (int column = 0; column < table_side; ++column) {
            const float x = static_cast<float>(column) / (table_side - 1);
            entries[static_cast<std::size_t>(column)] = entry_at(std::max(x * x, 1e-3f), roughness * roughness);
        }
        // The cosine is x^2, so that a mean by 2 c dc is one by 4 x^3 dx.
        float mean = 0, weights = 0;
        for (int column = 0; column < table_side; ++column) {
            const float x = static_cast<float>(column) / (table_side - 1);
            const float weight = x * x * x * (column == table_side - 1 ? 0.5f : 1.0f);
            mean += weight * entries[static_cast<std::size_t>(column)].whole[0];
            weights += weight;
        }
        table.mean_whole[static_cast<std::size_t>(row)] = mean / weights;
    }
    for (int k = 1; k < roots; ++k) {
        constexpr int parts = 256;
        float sum = 0;
        for (int i = 0; i < parts; ++i) {
            const float c = (static_cast<float>(i) + 0.5f) / parts;
            sum += 2.0f * c * relative_fresnel(c, root_of(k));
        }
        table.mean_fresnel[static_cast<std::size_t>(k)] = sum / parts;
    }
    return table;
}

const MomentTable& moment_table() {
    static const MomentTable made = make_moment_table();
    return made;
}

/// A place between two entries of a table.
struct TablePlace {
    std::size_t low;
    float share;  ///< of the next

    TablePlace(float at, int count) {
        const float inside = std::clamp(at, 0.0f, static_cast<float>(count - 1));
        low = std::min(static_cast<std::size_t>(inside), static_cast<std::size_t>(count - 2));
        share = inside - static_cast<float>(low);
    }
    float between(float a, float b) const { return a + share * (b - a); }
};

TablePlace row_of(float alpha) {
    const float roughness = std::sqrt(std::clamp(alpha, 0.0f, 1.0f));
    return {(table_side - 1) * (roughness - narrowest) / (1.0f - narrowest), table_side};
}

TablePlace place_of_root(float root_f0) {
    return {(roots - 1) * root_f0 / largest_root, roots};
}

}  // namespace

float unhidden(float cosine, float alpha) {
    const float tangent2 = std::max(1.0f / std::max(cosine * cosine, 1e-6f) - 1.0f, 0.0f);
    return 2.0f / (1.0f + std::sqrt(1.0f + alpha * alpha * tangent2));
}

float relative_fresnel(float cosine, float root_f0) {
    const float f0 = root_f0 * root_f0;
    if (!(root_f0 > 0.0f) || f0 >= 1.0f) return 0.0f;
    const float index = (1.0f + root_f0) / (1.0f - root_f0);
    return std::max((dielectric_reflectance(cosine, index) - f0) / (1.0f - f0), 0.0f);
}

LobeMoments lobe_moments(float cosine, float alpha, float root_f0, Masking masking) {
    const TablePlace row = row_of(alpha),
                     column((table_side - 1) * std::sqrt(std::clamp(cosine, 0.0f, 1.0f)), table_side),
                     root = place_of_root(root_f0);
    const std::size_t m = masking == Masking::separable ? 1 : 0;
    const auto at = [&](auto value) {
        const auto in_row = [&](std::size_t r) {
            const auto& entries = moment_table().entries[r];
            return column.between(value(entries[column.low]), value(entries[column.low + 1]));
        };
        return row.between(in_row(row.low), in_row(row.low + 1));
    };
    return {at([&](const MomentEntry& e) { return e.whole[m]; }),
            at([&](const MomentEntry& e) { return root.between(e.fresnel[m][root.low], e.fresnel[m][root.low + 1]); }),
            at([](const MomentEntry& e) { return e.edge; })};
}

float mean_whole(float alpha) {
    const TablePlace row = row_of(alpha);
    return row.between(moment_table().mean_whole[row.low], moment_table().mean_whole[row.low + 1]);
}

float mean_fresnel(float root_f0) {
    const TablePlace root = place_of_root(root_f0);
    return root.between(moment_table().mean_fresnel[root.low], moment_table().mean_fresnel[root.low + 1]);
}

}  // namespace render2mpeg::renderer
