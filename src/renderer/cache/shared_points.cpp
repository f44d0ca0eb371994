#include "renderer/cache/shared_points.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <tuple>

#include "core/color.h"
#include "core/numeric.h"
#include "parallel/loops.h"
#include "renderer/cache/receiver.h"

namespace render2mpeg::renderer {
namespace {

/// A point that may share.
struct Candidate {
    PointRef ref;
    double chance = 0;
    bool glossy = false;
    std::uint8_t path = direct_path;
    std::uint32_t material = 0;
    int faces = 0;    ///< one of six directions
    float depth = 0;  ///< scene units

    auto kind() const { return std::tuple(path, glossy, material); }
    auto order() const { return std::tuple(kind(), faces, depth, ref.index); }
};

/// The axis that a normal is nearest to, and its sign.
int direction_of(glm::vec3 normal) {
    const glm::vec3 size = glm::abs(normal);
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    return 2 * axis + (normal[axis] < 0.0f ? 1 : 0);
}

Candidate candidate_of(const FrameState& frame, const PointRef& ref) {
    const GatherPoint& p = frame.point(ref);
    return {ref,
            frame.pilots_worth(frame.tiles[ref.tile].tolerance[ref.index]),
            p.point.bsdf.has_glossy(),
            p.path,
            p.point.material,
            direction_of(p.point.shading_normal),
            glm::distance(frame.camera().position(), p.point.position)};
}

/// Makes the tolerance of a point that of all whose light it brings: of a share W of the pixel, not of its own.
void stand_for(std::span<const Candidate> stratum, std::span<const PointTolerance> tolerances, PointTolerance& own) {
    double share = 0;
    for (const Candidate& c : stratum) share += std::pow(tolerances[c.ref.index].root, 2.0);
    own.noise *= static_cast<float>(core::divide_or(std::pow(1.0 * own.root, 2), share, 1.0));
    own.root = static_cast<float>(std::sqrt(share));
}

/// Strata of like points, in their order: those that are gathered go to `gathered`.
void part(FrameState& frame, std::span<const Candidate> like, std::vector<PointRef>& gathered) {
    double sum = 0;
    for (const Candidate& c : like) sum += c.chance;
    const double strata = std::max(std::ceil(sum), 1.0);
    if (strata >= static_cast<double>(like.size())) {
        for (const Candidate& c : like) gathered.push_back(c.ref);
        return;
    }
    TileState& tile = frame.tiles[like.front().ref.tile];
    const Stream numbers(Purpose::shared_points,
                         {.pixel = frame.pixel_of(like.front().ref.tile, frame.point(like.front().ref)),
                          .index = like.front().ref.index});
    double passed = 0;
    for (std::size_t first = 0, end = 0, k = 0; first < like.size(); first = end, ++k) {
        // A stratum has those whose middle lies in it.
        const double wanted = static_cast<double>(k + 1) * sum / strata, begin = passed;
        while (end < like.size() && (end == first || passed + 0.5 * like[end].chance < wanted))
            passed += like[end++].chance;
        const std::span<const Candidate> stratum = like.subspan(first, end - first);
        double left = (passed - begin) * static_cast<double>(numbers.uniform(k));
        std::size_t chosen = 0;
        while (chosen + 1 < stratum.size() && left >= stratum[chosen].chance) left -= stratum[chosen++].chance;
        const PointRef lit = stratum[chosen].ref;
        gathered.push_back(lit);
        SharedStratum& shared = tile.strata.emplace_back(SharedStratum{lit.index, {}, first > 0});
        for (const Candidate& c : stratum) {
            shared.points.push_back(c.ref.index);
            if (c.ref.index != lit.index) tile.state[c.ref.index] = PointState::done;
        }
        stand_for(stratum, tile.tolerance, tile.tolerance[lit.index]);
    }
}

/// Light from all around a point, luminance, by what it scatters as a plain receiver.
double received(const GatherPoint& p, const PointLight& light) {
    return core::divide_or(1.0 * core::luminance(light.scattered(plain_receiver(p))), 1.0 * receives(p), 0.0);
}

/// Light of the point `from`, as the point `to` would have it in the same place.
PointLight carried(const PointLight& light, const GatherPoint& from, const GatherPoint& to) {
    const auto albedo = [](const GatherPoint& p) {
        const Bsdf& bsdf = p.point.bsdf;
        const float cosine = glm::dot(p.point.shading_normal, p.point.outgoing);
        return bsdf.has_glossy() ? glossy_albedo(bsdf, cosine) : glm::vec3(0);
    };
    const glm::vec3 before = albedo(from), now = albedo(to);
    PointLight carried = light;
    carried.direct_cut = carried.indirect_cut = 0;
    for (int c = 0; c < 3; ++c) carried.glossy[c] *= core::divide_or(now[c], before[c], 0.0f);
    carried.clamped *=
        core::divide_or(core::luminance(carried.scattered(to)), core::luminance(light.scattered(from)), 0.0f);
    return carried;
}

/// How light varies from a stratum to the next of like points: half of the mean square of what they differ by.
struct Spread {
    double squares = 0, light = 0, pairs = 0;

    void add(double a, double b) {
        squares += 0.5 * (a - b) * (a - b);
        light += 0.5 * (a * a + b * b);
        ++pairs;
    }
    /// Mean square of what a point's light may be off by; of few that of all others of the tile, by their light.
    double square(const Spread& of_tile, double own) const {
        if (pairs > 0) return squares / pairs;
        return own * own * core::divide_or(of_tile.squares, of_tile.light, 1.0);
    }
};

void share(TileState& tile, const GatherTile& points, const SharedStratum& stratum, double spread) {
    const GatherPoint& from = points[stratum.gathered];
    const PointLight light = tile.light[stratum.gathered];
    double all = 0;
    for (const std::uint32_t i : stratum.points) all += 1.0 * receives(points[i]);
    // Errors of one light add up, while those of a pixel's points are told as if each were its own.
    const double own = core::divide_or(1.0, 1.0 * receives(from), 0.0);
    const auto error = [&](double unit, const GatherPoint& p) {
        return core::StandardError{static_cast<float>(unit * std::sqrt(all * static_cast<double>(receives(p))))};
    };
    for (const std::uint32_t i : stratum.points) {
        const GatherPoint& to = points[i];
        if (i != stratum.gathered) {
            tile.light[i] = carried(light, from, to);
            tile.light[i].served = true;
            ++tile.served;
        }
        PointLight& now = tile.light[i];
        now.error = error(own * static_cast<double>(light.error.value), to);
        now.shared = error(own * static_cast<double>(light.shared.value), to);
        if (stratum.points.size() > 1) now.add_alone(error(std::sqrt(spread), to));
    }
}

}  // namespace

void choose_gathered(FrameState& frame, std::vector<PointRef>& requests) {
    std::vector<PointRef> gathered;
    std::vector<Candidate> candidates;
    for (std::size_t first = 0, end = 0; first < requests.size(); first = end) {
        const auto place = [&](std::size_t i) { return std::tuple(requests[i].tile, frame.point(requests[i]).pixel); };
        candidates.clear();
        for (end = first; end < requests.size() && place(end) == place(first); ++end) {
            Candidate c = candidate_of(frame, requests[end]);
            if (c.chance < 1.0 && uses_cache(frame.point(c.ref)) && std::isfinite(c.depth))
                candidates.push_back(c);
            else
                gathered.push_back(c.ref);
        }
        std::ranges::sort(candidates, {}, &Candidate::order);
        for (std::size_t i = 0, after = 0; i < candidates.size(); i = after) {
            while (after < candidates.size() && candidates[after].kind() == candidates[i].kind()) ++after;
            part(frame, std::span(candidates).subspan(i, after - i), gathered);
        }
    }
    requests = std::move(gathered);
}

void share_in_pixels(FrameState& frame) {
    parallel::for_each(frame.tiles.size(), [&](std::size_t t) {
        TileState& tile = frame.tiles[t];
        const GatherTile& points = frame.seen().tiles[t];
        std::vector<double> light;
        std::vector<Spread> spread(tile.strata.size());
        std::vector<std::size_t> of;  // the first stratum of like points
        Spread all;
        for (std::size_t k = 0; k < tile.strata.size(); ++k) {
            const std::uint32_t i = tile.strata[k].gathered;
            light.push_back(received(points[i], tile.light[i]));
            of.push_back(tile.strata[k].goes_on ? of.back() : k);
            if (!tile.strata[k].goes_on) continue;
            spread[of[k]].add(light[k - 1], light[k]);
            all.add(light[k - 1], light[k]);
        }
        for (std::size_t k = 0; k < tile.strata.size(); ++k)
            share(tile, points, tile.strata[k], spread[of[k]].square(all, light[k]));
    });
}

}  // namespace render2mpeg::renderer
