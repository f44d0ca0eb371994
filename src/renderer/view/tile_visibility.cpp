#include "renderer/view/tile_visibility.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "core/color.h"
#include "core/numeric.h"
#include "renderer/view/normal_spread.h"

namespace render2mpeg::renderer {
namespace {

/// Two samples of a pixel lie on one surface if their normals are the same, and if neither lies off the other's plane
/// by more than this share of the distance between neighbouring pixels. chosen: steps lower than that are not seen as
/// steps; tried 0.1..1.
constexpr float same_plane = 0.5f;

/// And they show no detail between them if their reflectances differ by less than this share of the larger one.
/// chosen: a tenth, of 0.03, 0.1, 0.25 (docs/measurements.md#edges).
constexpr float same_reflectance = 0.1f;

/// Ends of segments through air lie together if they are apart by less than this share of their distance. chosen: 2 %,
/// of which light of air changes by as much; not tuned.
constexpr float same_distance = 0.02f;

bool lie_together(float a, float b) {
    return a == b || std::abs(a - b) <= same_distance * std::min(a, b);
}

/// Whether two samples of one surface reflect white light alike: where they do not, a texture has detail.
bool reflect_alike(const Bsdf& a, const Bsdf& b) {
    const float x = core::luminance(a.diffuse + a.f0), y = core::luminance(b.diffuse + b.f0);
    return std::abs(x - y) <= same_reflectance * std::max(x, y);
}

float weight_of(glm::vec3 weight) {
    return weight.x + weight.y + weight.z;
}

/// Takes b into a: the weights add, and the reflectances become their means by weight.
void merge(GatherPoint& a, const Fragment& b, glm::vec3 weight) {
    const glm::vec3 sum = a.weight + weight;
    const auto mean = [&](glm::vec3 x, glm::vec3 y) {
        glm::vec3 m;
        for (int c = 0; c < 3; ++c) m[c] = core::divide_or(a.weight[c] * x[c] + weight[c] * y[c], sum[c], x[c]);
        return m;
    };
    Bsdf& bsdf = a.point.bsdf;
    const float heavy = weight_of(a.weight), light = weight_of(weight);
    bsdf.alpha = core::divide_or(heavy * bsdf.alpha + light * b.point.bsdf.alpha, heavy + light, bsdf.alpha);
    if (bsdf.is_stretched() && b.point.bsdf.is_stretched()) {
        const Bsdf& other = b.point.bsdf;
        bsdf.alpha_along =
            core::divide_or(heavy * bsdf.alpha_along + light * other.alpha_along, heavy + light, bsdf.alpha_along);
        const float side = glm::dot(bsdf.along, other.along) < 0.0f ? -light : light;
        bsdf.along = core::normalize_or(heavy * bsdf.along + side * other.along, bsdf.along);
    }
    bsdf.diffuse = mean(bsdf.diffuse, b.point.bsdf.diffuse);
    bsdf.f0 = mean(bsdf.f0, b.point.bsdf.f0);
    bsdf.f90 = mean(bsdf.f90, b.point.bsdf.f90);
    const auto mix = [&](float& x, float y) { x = core::divide_or(heavy * x + light * y, heavy + light, x); };
    const DiffuseShape& shape = b.point.bsdf.shape;
    if (!(bsdf.shape.is_lambert() && shape.is_lambert())) {
        mix(bsdf.shape.retro, shape.retro);
        mix(bsdf.shape.loss, shape.loss);
        mix(bsdf.shape.flat, shape.flat);
        mix(bsdf.shape.rough, shape.rough);
    }
    if (bsdf.covered != b.point.bsdf.covered) mix(bsdf.covered, b.point.bsdf.covered);
    a.weight = sum;
}

/// Records the main surface of the sample at the pixel's centre.
void record(core::Visible& visible, const scene::Camera& camera, int x, int y, const MainSurface& main) {
    visible.kind.at(x, y) = main.kind;
    if (main.kind != core::PixelClass::surface && main.kind != core::PixelClass::reflected) return;
    const SurfacePoint& point = main.point;
    visible.address.at(x, y) = point.address;
    visible.material.at(x, y) = point.material;
    visible.geometric_normal.at(x, y) = core::PackedNormal(point.geometric_normal);
    visible.shading_normal.at(x, y) = core::PackedNormal(point.shading_normal);
    visible.depth.at(x, y) = std::max(camera.depth_of(point.position), std::numeric_limits<float>::min());
}

/// Copies the parts of one pixel.
template <class Parts>
void copy_parts(const Parts& from, std::uint16_t pixel, Parts& to) {
    const auto before = [](const auto& part, std::uint16_t p) { return part.pixel < p; };
    for (auto s = std::lower_bound(from.begin(), from.end(), pixel, before); s != from.end() && s->pixel == pixel; ++s)
        to.push_back(*s);
}

/// Results of a tile beside gather points.
struct Found {
    SeenAir air;
    std::vector<SeenMatte> mattes;

    void copy_pixel(const Frame& seen, std::size_t t, std::uint16_t pixel) {
        if (!seen.air.empty()) {
            copy_parts(seen.air[t].straight, pixel, air.straight);
            copy_parts(seen.air[t].beyond, pixel, air.beyond);
        }
        if (!seen.mattes.empty()) copy_parts(seen.mattes[t], pixel, mattes);
    }
    void give(Frame& seen, std::size_t t) {
        if (!seen.air.empty()) seen.air[t] = std::move(air);
        if (!seen.mattes.empty()) seen.mattes[t] = std::move(mattes);
    }
};

/// The tile in no more memory than it takes.
GatherTile fitted(GatherTile tile) {
    return tile.size() == tile.capacity() ? std::move(tile) : GatherTile(tile);
}

/// Pixels whose rays are traced together have at most so many samples. chosen: rows of a tile with 64 samples.
constexpr std::size_t most_rays = 1024;

/// Looks through the pixels of a tile.
class TileVisibility {
  public:
    TileVisibility(const Looking& looking, Frame& seen, SeeCounts& counts, Found& found)
        : looking_(looking), seen_(seen), counts_(counts), found_(found) {}

    /// Pixels (first, y) to (end - 1, y), all of them; true in `edges`, by x % tile_size, where samples differ.
    void take(int first, int end, int y, GatherTile& tile, std::array<bool, tile_size>* edges) {
        rays_.clear();
        for (int x = first; x < end; ++x)
            for (std::size_t s = 0; s < looking_.pattern.size(); ++s) {
                float far = 0.0f;
                const glm::vec2 position =
                    glm::vec2{static_cast<float>(x), static_cast<float>(y)} + looking_.pattern[s];
                const EyeRay ray = eye_ray(looking_.camera, position, looking_.spacing, far);
                rays_.add(ray, far, {x, y}, static_cast<int>(s));
            }
        rays_.trace(looking_.tracer);
        for (int x = first; x < end; ++x) {
            const bool edge =
                see_pixel(x, y, static_cast<std::size_t>(x - first) * looking_.pattern.size(), tile, edges != nullptr);
            if (edges != nullptr) (*edges)[static_cast<std::size_t>(x % tile_size)] = edge;
        }
    }

  private:
    /// `begin`: the index of the pixel's first ray. Returns whether its samples show different surfaces.
    bool see_pixel(int x, int y, std::size_t begin, GatherTile& tile, bool records) {
        const std::size_t first = tile.size();
        const auto share = 1.0f / static_cast<float>(looking_.pattern.size());
        const auto pixel = static_cast<std::uint16_t>((y % tile_size) * tile_size + x % tile_size);
        glm::vec3 emitted{0.0f}, emitted_specular{0.0f};
        bool differ = false;
        std::size_t fragments = 0;
        for (std::size_t s = 0; s < looking_.pattern.size(); ++s) {
            const std::size_t ray = begin + s;
            looking_.paths.look(rays_.rays[ray], rays_.queries[ray].far, rays_.hits[ray], sample_, counts_);
            if (s == 0 && records) {
                record(seen_.visible, looking_.camera, x, y, sample_.main);
                if (!seen_.imaged.empty()) seen_.imaged.at(x, y) = sample_.main.imaged;
            }
            emitted += sample_.emitted;
            emitted_specular += sample_.emitted_specular;
            if (!seen_.air.empty()) add_air(sample_, pixel, share, found_.air);
            add_mattes(sample_.mattes, pixel, share, found_.mattes);
            differ = differ || (s > 0 && sample_.fragments.size() != fragments);
            fragments = sample_.fragments.size();
            for (const Fragment& fragment : sample_.fragments) {
                const glm::vec3 weight = share * fragment.weight;
                if (fragment.point.is_sampled()) {
                    const auto across = static_cast<std::size_t>(seen_.tiles_across());
                    seen_
                        .fibres[static_cast<std::size_t>(y / tile_size) * across +
                                static_cast<std::size_t>(x / tile_size)]
                        .push_back(fibre_sample(fragment, pixel, weight));
                    differ = differ || s > 0;
                    continue;
                }
                const float extent = core::divide_or(fragment.extent, looking_.spacing, 0.0f);
                const auto match =
                    std::find_if(tile.begin() + static_cast<std::ptrdiff_t>(first), tile.end(),
                                 [&](const GatherPoint& g) { return same_surface(g, fragment, extent); });
                if (match != tile.end()) {
                    differ = differ || !reflect_alike(match->point.bsdf, fragment.point.bsdf);
                    merge(*match, fragment, weight);
                    spreads_[static_cast<std::size_t>(match - tile.begin()) - first].add(
                        fragment.point.shading_normal, fragment.turn, weight_of(weight));
                    add_place(tile, static_cast<std::size_t>(match - tile.begin()), shadow_origin(fragment.point));
                    continue;
                }
                differ = differ || s > 0;
                tile.push_back({fragment.point, pixel, fragment.path, weight});
                spreads_.emplace_back().add(fragment.point.shading_normal, fragment.turn, weight_of(weight));
            }
        }
        for (std::size_t i = first; i < tile.size(); ++i) spreads_[i - first].fold_into(tile[i].point);
        spreads_.clear();
        for (auto& [point, places] : more_places_)
            tile[point].more_places = std::make_shared<const std::vector<glm::vec3>>(std::move(places));
        more_places_.clear();
        seen_.emitted.at(x, y) = share * emitted;
        if (!seen_.emitted_specular.empty()) seen_.emitted_specular.at(x, y) = share * emitted_specular;
        return differ;
    }

    /// One more place that shadow rays may leave.
    void add_place(GatherTile& tile, std::size_t point, glm::vec3 place) {
        GatherPoint& p = tile[point];
        if (p.others < most_other_places) {
            p.elsewhere[p.others++] = place;
        } else if (looking_.keeps_places) {
            auto entry = std::find_if(more_places_.begin(), more_places_.end(),
                                      [&](const auto& other) { return other.first == point; });
            if (entry == more_places_.end()) entry = more_places_.insert(entry, {point, {}});
            entry->second.push_back(place);
        }
    }

    const Looking& looking_;
    Frame& seen_;
    SeeCounts& counts_;
    Found& found_;
    EyeSample sample_;
    EyeRays rays_;
    std::vector<NormalSpread> spreads_;  ///< of the pixel's points
    /// Of the pixel's points, by their places in the tile.
    std::vector<std::pair<std::size_t, std::vector<glm::vec3>>> more_places_;
};

}  // namespace

void EyeRays::clear() {
    rays.clear();
    queries.clear();
}

void EyeRays::add(EyeRay ray, float far, glm::ivec2 pixel, int sample) {
    ray.number = static_cast<std::uint32_t>(sample) | static_cast<std::uint32_t>(pixel.y % 4 * 4 + pixel.x % 4) << 16;
    queries.push_back({ray.origin, ray.direction, far, ray.time});
    rays.push_back(ray);
}

void EyeRays::trace(const RayTracer& tracer) {
    hits.resize(queries.size());
    tracer.nearest(queries, hits);
}

FibreSample fibre_sample(const Fragment& fragment, std::uint16_t pixel, glm::vec3 weight) {
    const SurfacePoint& p = fragment.point;
    return {p.address, core::PackedNormal(p.outgoing), weight, pixel, fragment.path != direct_path, p.below};
}

bool same_surface(const GatherPoint& a, const Fragment& b, float pixel_extent) {
    if (a.point.address.object != b.point.address.object || a.point.back_side != b.point.back_side) return false;
    if (a.path != b.path) return false;
    if (glm::dot(a.point.shading_normal, b.point.shading_normal) < same_normal) return false;
    const glm::vec3 apart = b.point.position - a.point.position;
    const float off = std::max(std::abs(glm::dot(apart, a.point.geometric_normal)),
                               std::abs(glm::dot(apart, b.point.geometric_normal)));
    return off <= same_plane * pixel_extent + a.point.position_error + b.point.position_error;
}

void forget_fibres(std::uint16_t pixel, FibreTile& fibres) {
    while (!fibres.empty() && fibres.back().pixel == pixel) fibres.pop_back();
}

void forget_air(std::uint16_t pixel, SeenAir& air) {
    while (!air.straight.empty() && air.straight.back().pixel == pixel) air.straight.pop_back();
    while (!air.beyond.empty() && air.beyond.back().pixel == pixel) air.beyond.pop_back();
}

void add_air(const EyeSample& sample, std::uint16_t pixel, float share, SeenAir& air) {
    for (const AirSpan& span : sample.air) {
        auto& all = air.straight;
        auto match = all.rbegin();
        while (match != all.rend() && match->pixel == pixel && !lie_together(match->distance, span.distance)) ++match;
        if (match == all.rend() || match->pixel != pixel) {
            all.push_back({pixel, span.distance, share * span.weight});
            continue;
        }
        match->weight += share * span.weight;
    }
    for (const AirPath& path : sample.air_beyond) {
        auto& all = air.beyond;
        auto match = all.rbegin();
        while (match != all.rend() && match->pixel == pixel &&
               !(match->path == path.path && lie_together(match->distance, path.distance)))
            ++match;
        if (match == all.rend() || match->pixel != pixel) {
            all.push_back(path);
            all.back().pixel = pixel;
            all.back().weight *= share;
            continue;
        }
        match->weight += share * path.weight;
    }
}

TileArea area_of(const Frame& seen, std::size_t tile) {
    const glm::ivec2 first = seen.corner_of(tile);
    return {first, glm::min(first + tile_size, glm::ivec2(seen.visible.width(), seen.visible.height()))};
}

PixelMarks look_through(const Looking& looking, std::size_t t, Frame& seen, SeeCounts& counts) {
    const TileArea area = area_of(seen, t);
    const int together = std::max(1, static_cast<int>(most_rays / looking.pattern.size()));
    Found found;
    TileVisibility visibility(looking, seen, counts, found);
    PixelMarks edges{};
    GatherTile tile;
    tile.reserve(static_cast<std::size_t>((area.end.x - area.first.x) * (area.end.y - area.first.y)));
    for (int y = area.first.y; y < area.end.y; ++y)
        for (int x = area.first.x; x < area.end.x; x += together)
            visibility.take(x, std::min(x + together, area.end.x), y, tile,
                            &edges[static_cast<std::size_t>(y % tile_size)]);
    seen.tiles[t] = fitted(std::move(tile));
    found.give(seen, t);
    return edges;
}

void look_again(const Looking& looking, std::size_t t, const PixelMarks& marks, Frame& seen, SeeCounts& counts) {
    const auto marked = [](const auto& row) { return std::find(row.begin(), row.end(), true) != row.end(); };
    if (std::none_of(marks.begin(), marks.end(), marked)) return;
    const TileArea area = area_of(seen, t);
    Found found;
    TileVisibility visibility(looking, seen, counts, found);
    GatherTile before = std::move(seen.tiles[t]);
    GatherTile tile;
    tile.reserve(before.size());
    const auto is_marked = [&](const FibreSample& f) {
        return marks[static_cast<std::size_t>(f.pixel / tile_size)][static_cast<std::size_t>(f.pixel % tile_size)];
    };
    if (!seen.fibres.empty()) std::erase_if(seen.fibres[t], is_marked);
    std::size_t next = 0;
    for (int y = area.first.y; y < area.end.y; ++y)
        for (int x = area.first.x; x < area.end.x; ++x) {
            const auto pixel = static_cast<std::uint16_t>((y % tile_size) * tile_size + x % tile_size);
            const std::size_t first = next;
            while (next < before.size() && before[next].pixel == pixel) ++next;
            if (marks[static_cast<std::size_t>(y % tile_size)][static_cast<std::size_t>(x % tile_size)]) {
                visibility.take(x, x + 1, y, tile, nullptr);
                seen.samples.at(x, y) = static_cast<std::uint16_t>(looking.pattern.size());
            } else {
                found.copy_pixel(seen, t, pixel);
                tile.insert(tile.end(), std::make_move_iterator(before.begin() + static_cast<std::ptrdiff_t>(first)),
                            std::make_move_iterator(before.begin() + static_cast<std::ptrdiff_t>(next)));
            }
        }
    if (!seen.fibres.empty())
        std::stable_sort(seen.fibres[t].begin(), seen.fibres[t].end(),
                         [](const FibreSample& a, const FibreSample& b) { return a.pixel < b.pixel; });
    seen.tiles[t] = fitted(std::move(tile));
    found.give(seen, t);
}

}  // namespace render2mpeg::renderer
