#include "renderer/lights/kept_photons.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/error.h"
#include "parallel/loops.h"

namespace render2mpeg::renderer {
namespace {

/// A way is taken for so much longer than it is: what it met may lie on the surface of what moves.
constexpr float way_slack = 1.0f + 0x1p-12f;

bool shines_alike(const LightPoint& a, const LightPoint& b) {
    return a.position == b.position && a.normal == b.normal && a.intensity == b.intensity &&
           a.spot_scale == b.spot_scale && a.spot_offset == b.spot_offset && a.range == b.range && a.kind == b.kind;
}

}  // namespace

void KeptPhotons::start(std::span<const LightPoint> lights, const WorldBox& box, std::uint64_t paths) {
    next_ = {};
    taken_hits_ = 0;
    const bool beams = std::any_of(lights.begin(), lights.end(),
                                   [](const LightPoint& l) { return l.kind == LightPointKind::directional; });
    if (now_.paths.size() == paths && (!beams || (box.low == box_.low && box.high == box_.high)) &&
        std::equal(lights.begin(), lights.end(), lights_.begin(), lights_.end(), shines_alike))
        return;
    now_ = {};
    lights_.assign(lights.begin(), lights.end());
    box_ = box;
}

bool KeptPhotons::passes_clear(std::uint64_t path, const RayTracer& scene) const {
    const PhotonPath& p = now_.paths[path];
    if (p.met_dynamic) return false;
    const std::span<const glm::vec3> places = std::span(now_.places).subspan(now_.first_place[path], p.places);
    for (std::size_t i = 0; i + 1 < places.size(); ++i) {
        const bool leaves = p.escapes && i + 2 == places.size();
        const glm::vec3 way = leaves ? places[i + 1] : places[i + 1] - places[i];
        if (scene.may_meet_dynamic(places[i], way, leaves ? std::numeric_limits<float>::infinity() : way_slack))
            return false;
    }
    return true;
}

std::vector<std::uint64_t> KeptPhotons::changed(std::uint64_t first, std::uint64_t last, const RayTracer& scene) const {
    std::vector<std::uint8_t> clear(last - first, 0);
    if (!now_.paths.empty())
        parallel::for_ranges(clear.size(), 256, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) clear[i] = passes_clear(first + i, scene) ? 1 : 0;
        });
    std::vector<std::uint64_t> anew;
    for (std::size_t i = 0; i < clear.size(); ++i)
        if (clear[i] == 0) anew.push_back(i);
    return anew;
}

/// Of the k-th hit of a path that is followed anew: up to where its way changes the hits are those of before.
KeptShares KeptPhotons::shares_of(std::uint64_t path, std::uint32_t k, const PhotonHit& hit) const {
    if (now_.paths.empty() || k >= now_.paths[path].vpls) return {};
    const PhotonHit& before = now_.hits[taken_hits_ + k];
    const bool same =
        before.group == hit.group && before.at.position == hit.at.position && before.at.normal == hit.at.normal;
    return same ? now_.shares[taken_hits_ + k] : KeptShares();
}

void KeptPhotons::take(std::uint64_t count, std::span<const std::uint64_t> changed, const PhotonResult& traced,
                       std::span<const PhotonHit> hits) {
    EXPECTS(traced.each.size() == changed.size() && traced.vpls.size() == hits.size());
    const std::uint64_t first = next_.paths.size();
    std::size_t anew = 0, hit = 0, place = 0;
    const auto append = [](auto& to, const auto& from, std::size_t begin, std::size_t size) {
        to.insert(to.end(), from.begin() + static_cast<std::ptrdiff_t>(begin),
                  from.begin() + static_cast<std::ptrdiff_t>(begin + size));
    };
    for (std::uint64_t i = 0; i < count; ++i) {
        const bool is_new = anew < changed.size() && changed[anew] == i;
        const PhotonPath path = is_new ? traced.each[anew] : now_.paths[first + i];
        next_.paths.push_back(path);
        next_.first_place.push_back(next_.places.size());
        if (is_new) {
            append(next_.places, traced.places, place, path.places);
            append(next_.hits, hits, hit, path.vpls);
            for (std::uint32_t k = 0; k < path.vpls; ++k)
                next_.shares.push_back(shares_of(first + i, k, hits[hit + k]));
            ++anew;
            place += path.places;
            hit += path.vpls;
        } else {
            append(next_.places, now_.places, now_.first_place[first + i], path.places);
            append(next_.hits, now_.hits, taken_hits_, path.vpls);
            append(next_.shares, now_.shares, taken_hits_, path.vpls);
        }
        if (!now_.paths.empty()) taken_hits_ += now_.paths[first + i].vpls;
    }
}

}  // namespace render2mpeg::renderer
