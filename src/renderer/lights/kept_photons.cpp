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

/// Makes all[i] all[from(i)] for i below `count`, what comes from nowhere empty, in place, since there are many and
/// they are large. `from` rises where it is not `none`.
template <typename T, typename From>
void rearrange(std::vector<T>& all, std::size_t count, std::uint32_t none, From from) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i)
        if (from(i) != none) all[kept++] = all[from(i)];
    // To where they belong, the last first, so that none meets one that has not moved yet.
    all.resize(kept);
    all.reserve(count);
    all.resize(count);
    for (std::size_t i = count; i-- > 0;) all[i] = from(i) != none ? all[--kept] : T();
}

}  // namespace

void KeptPhotons::start(std::span<const LightPoint> lights, const WorldBox& box, std::uint64_t paths) {
    next_ = {};
    next_.reserve(paths, now_.places.size());
    sources_.clear();
    new_hits_.clear();
    taken_hits_ = 0;
    const bool beams = std::any_of(lights.begin(), lights.end(),
                                   [](const LightPoint& l) { return l.kind == LightPointKind::directional; });
    if (now_.paths.size() == paths && (!beams || (box.low == box_.low && box.high == box_.high)) &&
        std::equal(lights.begin(), lights.end(), lights_.begin(), lights_.end(), shines_alike))
        return;
    now_ = {};
    hits_.clear();
    shares_.clear();
    lights_.assign(lights.begin(), lights.end());
    box_ = box;
}

/// A little more than before, so that nothing grows to twice its size on the way.
void KeptPhotons::Paths::reserve(std::uint64_t count, std::size_t place_count) {
    paths.reserve(count);
    first_place.reserve(count);
    places.reserve(place_count + place_count / 16);
}

void KeptPhotons::finish() {
    now_ = std::exchange(next_, {});
    rearrange(hits_, sources_.size(), none, [&](std::size_t i) { return sources_[i].hit; });
    rearrange(shares_, sources_.size(), none, [&](std::size_t i) { return sources_[i].shares; });
    std::size_t next = 0;
    for (std::size_t i = 0; i < sources_.size(); ++i)
        if (sources_[i].hit == none) hits_[i] = new_hits_[next++];
    sources_ = {};
    new_hits_ = {};
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
std::uint32_t KeptPhotons::shares_of(std::uint64_t path, std::uint32_t k, const PhotonHit& hit) const {
    if (now_.paths.empty() || k >= now_.paths[path].vpls) return none;
    const PhotonHit& before = hits_[taken_hits_ + k];
    const bool same =
        before.group == hit.group && before.at.position == hit.at.position && before.at.normal == hit.at.normal;
    return same ? static_cast<std::uint32_t>(taken_hits_ + k) : none;
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
            append(new_hits_, hits, hit, path.vpls);
            for (std::uint32_t k = 0; k < path.vpls; ++k)
                sources_.push_back({none, shares_of(first + i, k, hits[hit + k])});
            ++anew;
            place += path.places;
            hit += path.vpls;
        } else {
            append(next_.places, now_.places, now_.first_place[first + i], path.places);
            for (std::uint32_t k = 0; k < path.vpls; ++k) {
                const auto from = static_cast<std::uint32_t>(taken_hits_ + k);
                sources_.push_back({from, from});
            }
        }
        if (!now_.paths.empty()) taken_hits_ += now_.paths[first + i].vpls;
    }
}

}  // namespace render2mpeg::renderer
