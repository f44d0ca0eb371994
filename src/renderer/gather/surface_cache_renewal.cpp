// How cells follow light that changes: as anchors of gather rays do in [Smyk2005].
#include <algorithm>
#include <limits>
#include <utility>

#include "core/color.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "parallel/loops.h"
#include "renderer/base/flush_denormals.h"
#include "renderer/base/lobe.h"
#include "renderer/gather/packed_light.h"
#include "renderer/gather/surface_cache.h"

namespace render2mpeg::renderer {
namespace {

/// Places that are kept, at most: 600 MB. chosen: a film that has more begins each change with none.
constexpr std::size_t most_kept_places = std::size_t{1} << 22;

/// Renewals from one to the next after which cells are forgotten that no record asked in two of these spans. chosen: 4;
/// not tuned.
constexpr std::uint32_t renewals_of_mark = 4, keeps_unasked = 2;

/// Change of luminance, as a share, at which all equations count as solved; and sweeps at most. chosen: 1e-3, since
/// they begin where the change began; what is left is met by the next one.
constexpr double solved_again = 1e-3;
constexpr int most_sweeps_again = 32;

/// Shadow rays of packed directions end so far before their sources, as a share of their length.
constexpr float before_source = 0.999f;

/// Cells of one task.
constexpr std::size_t cells_at_once = 4096, met_at_once = 256;

/// Rays of a place: SurfaceCache::KeptPlace.
constexpr std::size_t last_ray = 3;

/// Share of places that a change meets from which on keeping them does not pay: the rest of the chunk does without.
/// chosen: 0.1; a box that crosses a room meets 0.08 and saves a third, a figure before the camera 0.25 and loses a
/// tenth.
constexpr double most_places_met = 0.1;

/// Shares of sources in all light may become so many times larger or smaller before choices that were made by them are
/// mostly noise. chosen: 8; not tuned.
constexpr float most_apart = 8.0f;

/// Whether sources are about as strong, against each other, as others are.
bool are_alike(const SourceStrengths& a, const SourceStrengths& b) {
    const auto alike = [](std::size_t count, auto&& of_a, auto&& of_b) {
        float least = std::numeric_limits<float>::infinity(), most = 0;
        for (std::size_t i = 0; i < count; ++i) {
            if (!(of_a(i) > 0.0f) || !(of_b(i) > 0.0f)) continue;
            least = std::min(least, of_a(i) / of_b(i));
            most = std::max(most, of_a(i) / of_b(i));
        }
        return !(most > most_apart * least);
    };
    return alike(
               a.lamps.size(), [&](std::size_t i) { return core::luminance(a.lamps[i]); },
               [&](std::size_t i) { return core::luminance(b.lamps[i]); }) &&
           alike(
               a.objects.size(), [&](std::size_t i) { return a.objects[i]; },
               [&](std::size_t i) { return b.objects[i]; });
}

}  // namespace

/// Rays of places that a change met, traced again.
struct SurfaceCache::Retraced {
    std::vector<std::uint32_t> gone;    ///< cells on things that moved
    std::vector<std::uint32_t> places;  ///< whose last ray was traced
    std::vector<RayTerm> terms;         ///< by index into these
    std::uint64_t rays = 0;
};

/// Keeps the places of some lessons, and says which ones links are of.
void SurfaceCache::keep(std::span<const KeptPlace> kept, std::span<Lesson> lessons, std::span<Link> links) {
    std::vector<std::uint32_t> index;
    for (Lesson& lesson : lessons)
        for (std::uint32_t k = 0; k < lesson.places; ++k) {
            index.push_back(none);
            if (is_own(lesson.cell)) continue;
            if (free_places_.empty()) {
                free_places_.push_back(static_cast<std::uint32_t>(places_.size()));
                places_.emplace_back();
            }
            index.back() = free_places_.back();
            free_places_.pop_back();
            places_[index.back()] = kept[index.size() - 1];
            places_[index.back()].next = std::exchange(kept_cells_[lesson.cell].first, index.back());
            lesson.kept = index.back();
        }
    for (Link& link : links) link.place = index[link.place];
}

/// Keeps what their equations came to.
void SurfaceCache::keep_solved(std::span<const Lesson> lessons, std::span<const Link> links) {
    for (const Link& link : links) {
        if (link.place == none) continue;
        places_[link.place].weight = PackedLight(link.weight);
        places_[link.place].cell = link.cell;
    }
    // The last lesson of a cell, which comes last, knows by how much.
    for (const Lesson& lesson : lessons) {
        if (!lesson.scale) continue;
        for (const Lesson* l = &lesson;; l = &lessons[l->earlier]) {
            std::uint32_t p = l->kept;
            for (std::uint32_t k = 0; k < l->places && p != none; ++k, p = places_[p].next)
                places_[p].goes_on = PackedLight(*lesson.scale * unpacked(places_[p].goes_on));
            if (l->earlier == none) break;
        }
    }
}

glm::vec3 SurfaceCache::known_of(const KeptPlace& place) const {
    glm::vec3 sum(0);
    for (std::size_t kind = 0; kind <= last_ray; ++kind) {
        const KeptRay& ray = place.rays[kind];
        if (ray.far > 0.0f) sum += unpacked(ray.light) * unpacked_share(ray.passes) * strength(kind, ray.source);
    }
    return sum;
}

/// Frees cells that nobody asked for long, but for what those that stay ask.
void SurfaceCache::mark_asked() {
    std::vector<std::uint32_t> asked;
    for (std::uint32_t i = 0; i < cells_.size(); ++i)
        if (mark_ - kept_cells_[i].used < keeps_unasked) asked.push_back(i);
    while (!asked.empty()) {
        const std::uint32_t cell = asked.back();
        asked.pop_back();
        for (std::uint32_t p = kept_cells_[cell].first; p != none; p = places_[p].next) {
            const std::uint32_t other = places_[p].cell;
            if (other == none || kept_cells_[other].used >= kept_cells_[cell].used) continue;
            kept_cells_[other].used = kept_cells_[cell].used;
            asked.push_back(other);
        }
    }
    for (std::uint32_t i = 0; i < cells_.size(); ++i)
        if (mark_ - kept_cells_[i].used >= keeps_unasked) free_cell(i);
}

void SurfaceCache::free_places(std::uint32_t cell) {
    for (std::uint32_t p = std::exchange(kept_cells_[cell].first, none); p != none; p = places_[p].next)
        free_places_.push_back(p);
    cells_[cell].places = 0;
    cells_[cell].radiance = glm::vec3(0);
}

void SurfaceCache::free_cell(std::uint32_t cell) {
    if (kept_cells_[cell].key == 0) return;
    free_places(cell);
    table_.erase(std::exchange(kept_cells_[cell].key, 0));
    free_cells_.push_back(cell);
}

/// Whether a change leaves so little as it was that keeping it does not pay: asked of one cell in sixteen.
bool SurfaceCache::meets_too_much(const LightChange& change) const {
    std::vector<std::array<std::uint32_t, 2>> counts((cells_.size() + cells_at_once - 1) / cells_at_once);
    parallel::for_each(counts.size(), [&](std::size_t task) {
        const std::size_t end = std::min((task + 1) * cells_at_once, cells_.size());
        for (std::size_t i = task * cells_at_once; i < end; i += 16)
            for (std::uint32_t p = kept_cells_[i].first; p != none; p = places_[p].next) {
                const KeptPlace& place = places_[p];
                const SeenChange seen(change, place.origin);
                const bool met = change.moves(place.object) ||
                                 std::any_of(place.rays.begin(), place.rays.end(), [&](const KeptRay& ray) {
                                     return ray.far > 0.0f && seen.meets(ray.direction, ray.far);
                                 });
                ++counts[task][0];
                counts[task][1] += met ? 1 : 0;
            }
    });
    double all = 0, met = 0;
    for (const auto& [of_all, of_met] : counts) all += of_all, met += of_met;
    return met > most_places_met * all;
}

/// Traces again what a change meets of these cells.
void SurfaceCache::trace_met(std::span<const std::uint32_t> cells, const LightChange& change, Retraced& out) {
    const FlushDenormals flushed;
    std::vector<RayQuery> queries;
    std::vector<std::uint64_t> numbers;
    for (const std::uint32_t cell : cells) {
        if (kept_cells_[cell].first != none && change.moves(places_[kept_cells_[cell].first].object)) {
            out.gone.push_back(cell);
            continue;
        }
        for (std::uint32_t p = kept_cells_[cell].first; p != none; p = places_[p].next) {
            KeptPlace& place = places_[p];
            const SeenChange seen(change, place.origin);
            for (std::size_t kind = 0; kind < place.rays.size(); ++kind) {
                KeptRay& ray = place.rays[kind];
                if (!(ray.far > 0.0f) || !seen.meets(ray.direction, ray.far)) continue;
                if (kind < last_ray) {
                    ray.passes = packed_share(
                        posed_scene_.tracer().passes(place.origin, ray.direction.unpack(), before_source * ray.far));
                    ++out.rays;
                    continue;
                }
                queries.push_back({place.origin, ray.direction.unpack(), std::numeric_limits<float>::infinity()});
                numbers.push_back(core::mix(core::mix(kept_cells_[cell].key) + place.ordinal));
                out.places.push_back(p);
            }
        }
    }
    std::vector<Hit> hits(queries.size());
    posed_scene_.tracer().any_nearest(queries, hits, false);
    out.rays += queries.size();
    RayRules rules;
    rules.brightest = std::numeric_limits<float>::infinity();
    for (std::uint32_t i = 0; i < queries.size(); ++i) {
        KeptPlace& place = places_[out.places[i]];
        const AskedLights asked{*sources_, {place.origin, place.origin, place.normal.unpack()}, place.density};
        rules.asked = &asked;
        const glm::vec3 known =
            unpacked(place.goes_on) *
            gather_rays_.follow(queries[i], hits[i], rules, lobe::inverse_pi, numbers[i], i, out.terms, out.rays);
        KeptRay& ray = place.rays[last_ray];
        ray.source = hits[i].found() && core::luminance(known) > 0.0f ? hits[i].address.object : none;
        ray.light = PackedLight(over(core::is_finite(known) ? known : glm::vec3(0), strength(last_ray, ray.source)));
        ray.far = gather_rays_.length(hits[i]);
        place.cell = none;
    }
}

void SurfaceCache::trace_met(const LightChange& change) {
    std::vector<std::uint32_t> cells;
    for (std::uint32_t i = 0; i < cells_.size(); ++i)
        if (kept_cells_[i].first != none) cells.push_back(i);
    std::vector<Retraced> found((cells.size() + met_at_once - 1) / met_at_once);
    parallel::for_each(found.size(), [&](std::size_t task) {
        const std::size_t first = task * met_at_once, count = std::min(met_at_once, cells.size() - first);
        trace_met(std::span<const std::uint32_t>(cells).subspan(first, count), change, found[task]);
    });
    std::vector<Sighting> wanted;
    for (const Retraced& r : found) {
        rays_ += r.rays;
        for (const std::uint32_t cell : r.gone) free_cell(cell);
    }
    for (const Retraced& r : found)
        for (const RayTerm& term : r.terms)
            if (index_of(term.place.key) == none) wanted.push_back(term.place);
    learn(wanted);
    for (const Retraced& r : found)
        for (const RayTerm& term : r.terms) {
            KeptPlace& place = places_[r.places[term.ray]];
            place.cell = index_of(term.place.key);
            place.weight = PackedLight(unpacked(place.goes_on) * term.weight);
        }
}

/// Gauss-Seidel over all cells.
void SurfaceCache::solve_kept() {
    struct Equation {
        std::uint32_t cell = 0, first = 0, last = 0;  ///< and its terms
        glm::vec3 known{0};
    };
    struct Term {
        std::uint32_t cell = 0;
        glm::vec3 weight{0};
    };
    struct Part {
        std::vector<Equation> equations;
        std::vector<Term> terms;
    };
    std::vector<Part> parts((cells_.size() + cells_at_once - 1) / cells_at_once);
    parallel::for_each(parts.size(), [&](std::size_t part) {
        const std::size_t end = std::min((part + 1) * cells_at_once, cells_.size());
        for (std::size_t i = end; i-- > part * cells_at_once;) {
            if (cells_[i].places == 0) continue;
            Equation e{static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(parts[part].terms.size())};
            const float share = 1.0f / static_cast<float>(cells_[i].places);
            for (std::uint32_t p = kept_cells_[i].first; p != none; p = places_[p].next) {
                const KeptPlace& place = places_[p];
                e.known += share * known_of(place);
                if (place.cell != none) parts[part].terms.push_back({place.cell, share * unpacked(place.weight)});
            }
            e.last = static_cast<std::uint32_t>(parts[part].terms.size());
            parts[part].equations.push_back(e);
        }
    });
    for (int sweep = 0; sweep < most_sweeps_again; ++sweep) {
        double change = 0, all = 0;
        // Cells that were learnt last first: they are what the others ask.
        for (auto part = parts.rbegin(); part != parts.rend(); ++part)
            for (const Equation& e : part->equations) {
                glm::vec3 sum = e.known;
                for (std::uint32_t t = e.first; t < e.last; ++t)
                    sum += part->terms[t].weight * cells_[part->terms[t].cell].radiance;
                glm::vec3& radiance = cells_[e.cell].radiance;
                change += static_cast<double>(std::abs(core::luminance(sum - radiance)));
                all += static_cast<double>(core::luminance(sum));
                radiance = sum;
            }
        if (!(change > solved_again * all)) break;
    }
}

/// Parts of cells that near_light has.
void SurfaceCache::solve_near() {
    if (near_field_.empty()) return;
    parallel::for_ranges(cells_.size(), cells_at_once, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            if (cells_[i].places == 0) continue;
            glm::vec3 sum(0);
            for (std::uint32_t p = kept_cells_[i].first; p != none; p = places_[p].next) {
                const float share = near_field_.share(places_[p].origin);
                if (!(share > 0.0f)) continue;
                sum += share * known_of(places_[p]);
                if (places_[p].cell != none)
                    sum += share * unpacked(places_[p].weight) * cells_[places_[p].cell].radiance;
            }
            cells_[i].near = sum / static_cast<float>(cells_[i].places);
        }
    });
}

bool SurfaceCache::renew(const LightChange& change, NearField near_field) {
    const bool holds = !change.all && keeps() && places_.size() <= most_kept_places &&
                       are_alike(strengths_of(posed_scene_.posed()), asked_strengths_);
    if (holds && (change.moves_sources(posed_scene_.animation()) || meets_too_much(change))) keeps_ = false;
    if (!holds || !keeps()) {
        forget(std::move(near_field));
        return false;
    }
    near_field_ = std::move(near_field);
    strengths_ = strengths_of(posed_scene_.posed());
    if (++renewals_ % renewals_of_mark == 0) {
        mark_asked();
        ++mark_;
    }
    if (!change.boxes.empty()) trace_met(change);
    solve_kept();
    solve_near();
    return true;
}

}  // namespace render2mpeg::renderer
