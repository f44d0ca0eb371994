#include "renderer/gather/surface_cache.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/color.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "parallel/loops.h"
#include "renderer/base/flush_denormals.h"
#include "renderer/base/lobe.h"
#include "renderer/paths/scatterer.h"
#include "renderer/surface/lobe_albedo.h"

namespace render2mpeg::renderer {
namespace {

/// Places that a cell is evaluated at, at most, if a point asks it; half as many for each bounce that lies between.
/// chosen: 16 of 4 to 64, which err alike in Sponza.
constexpr std::uint32_t most_places = 16;

/// Share of a gather ray's light from which on light that nobody asked for yet counts as none. chosen: 0.001, after ten
/// bounces off a surface of 0.5; what is asked from elsewhere as well goes on.
constexpr float least_carried = 0.001f;

/// Lobes seen by a cell are at least so wide: what a mirror-like floor throws is a matter of caustics, and would be
/// noise here. chosen: 0.25 of alpha, a roughness of 0.5; not tuned.
constexpr float least_alpha = 0.25f;

/// As largest_albedo, of fibres, among which light stays for many of them. chosen: 0.999; white hair lacks a thousandth
/// for each.
constexpr float largest_fibre_albedo = 0.999f;

/// Change of luminance, as a share, at which the equations count as solved; and sweeps at most, for surfaces that
/// reflect nearly all. chosen: 1e-4; what is left is a hundred times as much where they reflect 99 %.
constexpr double solved = 1e-4;
constexpr int most_sweeps = 256;

/// Places that one task evaluates.
constexpr std::size_t lessons_at_once = 64;

/// The first four are a place's rays as well.
enum Number : std::uint64_t { lamp, surface, sky, bounce, side, part };

float uniform(std::uint64_t number, Number use, std::uint64_t which) {
    return core::uniform(number, use, which);
}

}  // namespace

void CellTable::clear() {
    slots_.clear();
    used_ = 0;
}

std::size_t CellTable::place_of(std::uint64_t key) const {
    const std::size_t mask = slots_.size() - 1;
    std::size_t i = core::mix(key) & mask;
    while (slots_[i].index != none && slots_[i].key != key) i = (i + 1) & mask;
    return i;
}

std::uint32_t CellTable::find(std::uint64_t key) const {
    return slots_.empty() ? none : slots_[place_of(key)].index;
}

void CellTable::insert(std::uint64_t key, std::uint32_t index) {
    if (slots_.size() <= 2 * used_) {
        std::vector<Slot> old(std::max<std::size_t>(2 * slots_.size(), 1024));
        old.swap(slots_);
        for (const Slot& s : old)
            if (s.index != none) slots_[place_of(s.key)] = s;
    }
    slots_[place_of(key)] = {key, index};
    ++used_;
}

/// A ray on which a cell's light goes on.
struct SurfaceCache::Bounce {
    RayQuery ray;
    LightQuery query;   ///< that lights were asked by
    float density = 0;  ///< of the direction
    glm::vec3 weight{1};
    float share = 0;  ///< NearField::share
    std::uint64_t number = 0;
    float near = 0;            ///< RayRules
    float carried = 1;         ///< Sighting
    std::uint32_t lesson = 0;  ///< of its task
    std::uint8_t depth = 0;
};

/// Results of some places of lessons.
struct SurfaceCache::Evaluated {
    std::vector<Bounce> bounces;
    std::vector<RayTerm> terms;
    std::uint64_t rays = 0;
};

SurfaceCache::SurfaceCache(const PosedScene& posed_scene, const Plan& plan)
    : posed_scene_(posed_scene), gather_rays_(posed_scene, plan), plan_(plan) {}

void SurfaceCache::forget(NearField near_field) {
    near_field_ = std::move(near_field);
    table_.clear();
    own_table_.clear();
    cells_.clear();
    own_cells_.clear();
    sources_.emplace(posed_scene_, plan_);
}

std::uint32_t SurfaceCache::make_cell(std::uint64_t key) {
    const bool is_own = (key & own_cell) != 0;
    std::vector<Cell>& cells = is_own ? own_cells_ : cells_;
    const std::uint32_t index = static_cast<std::uint32_t>(cells.size()) | (is_own ? own_index : 0u);
    cells.emplace_back();
    (is_own ? own_table_ : table_).insert(key, index);
    return index;
}

std::uint32_t SurfaceCache::index_of(std::uint64_t key) const {
    return ((key & own_cell) != 0 ? own_table_ : table_).find(key);
}

std::uint32_t SurfaceCache::find(std::uint64_t key) const {
    const std::uint32_t index = table_.find(key);
    return index != none && cells_[index].places >= most_places ? index : none;
}

/// Light of lamps, shining surfaces and the image of a sky, by next events.
glm::vec3 SurfaceCache::lamps(const Scatterer& at, std::uint64_t number, std::uint64_t& rays) const {
    const LightQuery& query = at.query();
    glm::vec3 sum(0);
    const auto add = [&](const LightSample& s) {
        if (!(core::luminance(s.light) > 0.0f) || !query.may_see(s.direction)) return;
        const Scattered to = at.scattered(s.direction, s.density > 0.0f);
        glm::vec3 light = to.share * s.light;
        if (!(core::luminance(light) > 0.0f)) return;
        if (s.density > 0.0f) light *= s.density / (s.density + to.density);
        if (!(core::luminance(light) > 0.0f)) return;
        if (const Air* air = posed_scene_.air(); air != nullptr) {
            const glm::vec3 direction = core::normalize_or(s.ray, s.direction);
            light *= std::isinf(s.far)
                         ? std::exp(-air->depth_to_sky(query.origin, direction))
                         : std::exp(-air->optical_depth(query.origin, direction, glm::length(s.ray) * s.far));
        }
        ++rays;
        const float skipped = at.skipped(s.ray);
        const glm::vec3 passes = posed_scene_.tracer().passes(at.origin_of(s.ray), s.ray, s.far - skipped);
        sum += light * passes;
    };
    const auto pair = [&](Number use) { return glm::vec2(uniform(number, use, 1), uniform(number, use, 2)); };
    if (sources_->has_lamps()) add(sources_->to_lamp(query, uniform(number, lamp, 0), pair(lamp)));
    if (sources_->has_surfaces()) add(sources_->to_surface(query, uniform(number, surface, 0), pair(surface)));
    if (sources_->has_sky()) add(sources_->to_sky(query, uniform(number, sky, 0), pair(sky)));
    return sum;
}

/// Light comes from this side or from beyond, in proportion to what is reflected and let through. Returns its weight.
glm::vec3 SurfaceCache::choose_side(std::uint64_t number, SurfacePoint& p) const {
    const float through = core::luminance(p.bsdf.diffuse_transmission);
    glm::vec3 weight(1);
    if (through > 0.0f) {
        const float reflected = core::luminance(p.bsdf.diffuse) + core::luminance(p.bsdf.f0);
        const float chance = through / (through + reflected);
        const bool beyond = uniform(number, side, 0) < chance;
        weight = glm::vec3(1.0f / (beyond ? chance : 1.0f - chance));
        if (beyond) p = posed_scene_.other_side(p);
    }
    return weight;
}

/// Evaluates a place: what lamps send, and one ray whose end sends the rest.
void SurfaceCache::light_place(const Sighting& place, std::uint64_t number, std::uint32_t index, Lesson& lesson,
                               Evaluated& out) const {
    glm::vec3 along, across;
    core::make_frame(place.outgoing, along, across);
    SurfacePoint p = posed_scene_.surface_at(place.address, place.outgoing, {place.size * along, place.size * across});
    if (p.unlit) return;
    glm::vec3 weight = choose_side(number, p);
    const float cosine = glm::dot(p.shading_normal, p.outgoing);
    const glm::vec3 albedo = diffuse_albedo(p.bsdf, cosine) + glossy_albedo(p.bsdf, cosine);
    const float brightest = p.fibre ? 1.0f : std::max({albedo.x, albedo.y, albedo.z});
    if (!(brightest > 0.0f)) return;
    const float scale = std::min(largest_albedo / brightest, 1.0f);
    p.bsdf.scale(scale);
    p.bsdf.alpha = std::max(p.bsdf.alpha, least_alpha);
    p.bsdf.alpha_along = std::max(p.bsdf.alpha_along, least_alpha);

    const Scatterer at(posed_scene_, p);
    lesson.fibres = p.fibre;
    lesson.albedo += p.fibre ? at.albedo() : scale * weight * albedo;
    const glm::vec3 direct = weight * lamps(at, number, out.rays);
    const float share = near_field_.share(p.position);
    if (core::is_finite(direct)) {
        lesson.known += direct;
        lesson.near += share * direct;
    }

    glm::vec3 direction, chosen(0);
    const float density = at.sample(uniform(number, part, 0), {uniform(number, bounce, 0), uniform(number, bounce, 1)},
                                    direction, chosen);
    if (!at.query().may_see(direction) || !(density > 0.0f)) return;
    weight *= chosen;
    if (!(core::luminance(weight) > 0.0f) || !core::is_finite(weight)) return;
    lesson.drawn += weight;
    out.rays += 1;
    out.bounces.push_back({{at.origin_of(direction), direction, std::numeric_limits<float>::infinity()},
                           at.query(),
                           density,
                           weight,
                           share,
                           number,
                           place.depth > 0 ? 0.5f * place.size : 0.0f,
                           place.carried,
                           index,
                           place.depth});
}

/// Follows the rays of all places of a task.
void SurfaceCache::follow_bounces(std::span<Lesson> lessons, Evaluated& out) const {
    std::vector<RayQuery> queries;
    for (const Bounce& b : out.bounces) queries.push_back(b.ray);
    std::vector<Hit> hits(queries.size());
    posed_scene_.tracer().any_nearest(queries, hits, false);
    RayRules rules;
    rules.brightest = std::numeric_limits<float>::infinity();
    for (std::size_t i = 0; i < queries.size(); ++i) {
        const Bounce& b = out.bounces[i];
        const AskedLights asked{*sources_, b.query, b.density};
        rules.asked = &asked;
        rules.near = b.near;
        rules.depth = b.depth;
        Lesson& lesson = lessons[b.lesson];
        const auto first = static_cast<std::uint32_t>(out.terms.size());
        const glm::vec3 known = b.weight * gather_rays_.follow(b.ray, hits[i], rules, lobe::inverse_pi,
                                                               core::mix(b.number), 0, out.terms, out.rays);
        if (core::is_finite(known)) {
            lesson.known += known;
            lesson.near += b.share * known;
        }
        if (out.terms.size() > first) {
            RayTerm& term = out.terms.back();
            term.weight *= b.weight;
            term.near = b.share;
            term.place.carried = b.carried * core::luminance(term.weight);
        }
        if (lesson.first_link == lesson.last_link) lesson.first_link = first;
        lesson.last_link = static_cast<std::uint32_t>(out.terms.size());
    }
}

/// Chooses the places that cells are evaluated at among those where rays met them, evenly. A cell has as many as ever
/// asked at once, so that asking again teaches nothing: frames that are alike stay alike.
void SurfaceCache::plan_lessons(std::vector<Sighting>& wanted, std::uint32_t most, std::vector<Sighting>& places,
                                std::vector<Lesson>& lessons) {
    std::stable_sort(wanted.begin(), wanted.end());
    for (std::size_t first = 0, last = 0; first < wanted.size(); first = last) {
        const std::uint64_t key = wanted[first].key;
        while (last < wanted.size() && wanted[last].key == key) ++last;
        std::uint32_t index = index_of(key);
        if (index == none) index = make_cell(key);
        Cell& taught = cell(index);
        const auto asked = static_cast<std::uint32_t>(last - first), wanted_places = std::min(asked, most);
        if (wanted_places <= taught.places) continue;
        const std::uint32_t take = wanted_places - taught.places;
        Lesson lesson;
        lesson.cell = index;
        lesson.first = static_cast<std::uint32_t>(places.size());
        lesson.places = take;
        lesson.number = taught.places;
        lesson.earlier = taught.lesson;
        taught.lesson = static_cast<std::uint32_t>(lessons.size());
        taught.places += lesson.places;
        lessons.push_back(lesson);
        for (std::size_t i = 0; i < take; ++i) places.push_back(wanted[first + i * asked / take]);
    }
    wanted.clear();
}

void SurfaceCache::evaluate_lessons(std::span<Lesson> lessons, const std::vector<Sighting>& places,
                                    std::vector<Link>& links, std::uint32_t most, std::vector<Sighting>& wanted) {
    const std::size_t tasks = (lessons.size() + lessons_at_once - 1) / lessons_at_once;
    std::vector<Evaluated> found(tasks);
    parallel::for_each(tasks, [&](std::size_t task) {
        const FlushDenormals flushed;
        Evaluated& out = found[task];
        const std::size_t first = task * lessons_at_once, last = std::min(first + lessons_at_once, lessons.size());
        for (std::size_t l = first; l < last; ++l) {
            Lesson& lesson = lessons[l];
            for (std::uint32_t k = 0; k < lesson.places; ++k) {
                const Sighting& place = places[lesson.first + k];
                light_place(place, core::mix(place.key) + lesson.number + k, static_cast<std::uint32_t>(l - first),
                            lesson, out);
            }
        }
        follow_bounces(lessons.subspan(first, last - first), out);
        out.bounces = {};
    });
    for (std::size_t task = 0; task < tasks; ++task) {
        const auto base = static_cast<std::uint32_t>(links.size());
        const std::size_t first = task * lessons_at_once, last = std::min(first + lessons_at_once, lessons.size());
        for (std::size_t l = first; l < last; ++l) lessons[l].first_link += base, lessons[l].last_link += base;
        for (const RayTerm& t : found[task].terms) {
            links.push_back({t.place.key, t.weight, t.near, index_of(t.place.key)});
            const bool known = links.back().cell != none && cell(links.back().cell).places >= most;
            if (!known && t.place.carried > least_carried) wanted.push_back(t.place);
        }
        rays_ += found[task].rays;
    }
}

/// Gauss-Seidel, the cells learnt last first: they are what the others ask.
void SurfaceCache::solve(std::span<Lesson> lessons, std::vector<Link>& links) {
    for (Link& link : links)
        if (link.cell == none) link.cell = index_of(link.key);
    // The last lesson of a cell has the sum of all that is known of it.
    for (Lesson& lesson : lessons) {
        const Cell& taught = cell(lesson.cell);
        const auto number = static_cast<float>(lesson.number);
        const bool is_first = lesson.earlier == none;
        lesson.known += is_first ? number * taught.radiance : lessons[lesson.earlier].known;
        lesson.near += is_first ? number * taught.near : lessons[lesson.earlier].near;
    }
    const auto links_of = [&](std::uint32_t last, auto&& visit) {
        for (std::uint32_t l = last; l != none; l = lessons[l].earlier)
            for (std::uint32_t k = lessons[l].first_link; k < lessons[l].last_link; ++k)
                if (links[k].cell != none) visit(links[k]);
    };
    std::vector<std::uint32_t> last_ones;
    for (auto l = static_cast<std::uint32_t>(lessons.size()); l-- > 0;) {
        Cell& taught = cell(lessons[l].cell);
        if (taught.lesson != l) continue;
        last_ones.push_back(l);
        taught.lesson = none;
        taught.radiance = lessons[l].known / static_cast<float>(taught.places);
        // Weights of a cell's places come to their albedo, and no cell reflects more than surfaces do: such equations
        // have no solution.
        glm::vec3 albedo(0), drawn(0);
        for (std::uint32_t k = l; k != none; k = lessons[k].earlier) {
            albedo += lessons[k].albedo;
            drawn += lessons[k].drawn;
        }
        for (int c = 0; c < 3; ++c) albedo[c] = core::divide_or(albedo[c], drawn[c], 0.0f);
        glm::vec3 row(0);
        links_of(l, [&](Link& link) { row += link.weight *= albedo; });
        const float largest = lessons[l].fibres ? largest_fibre_albedo : largest_albedo;
        const glm::vec3 most(largest * static_cast<float>(taught.places));
        if (glm::any(glm::greaterThan(row, most)))
            links_of(l, [&](Link& link) { link.weight *= most / glm::max(row, most); });
    }
    for (int sweep = 0; sweep < most_sweeps; ++sweep) {
        double change = 0, all = 0;
        for (const std::uint32_t last : last_ones) {
            glm::vec3 sum = lessons[last].known;
            links_of(last, [&](const Link& link) { sum += link.weight * cell(link.cell).radiance; });
            Cell& taught = cell(lessons[last].cell);
            sum /= static_cast<float>(taught.places);
            change += static_cast<double>(std::abs(core::luminance(sum - taught.radiance)));
            all += static_cast<double>(core::luminance(sum));
            taught.radiance = sum;
        }
        if (!(change > solved * all)) break;
    }
    for (const std::uint32_t last : last_ones) {
        glm::vec3 sum = lessons[last].near;
        links_of(last, [&](const Link& link) { sum += link.near * link.weight * cell(link.cell).radiance; });
        Cell& taught = cell(lessons[last].cell);
        taught.near = sum / static_cast<float>(taught.places);
    }
}

void SurfaceCache::learn(std::vector<Sighting>& wanted) {
    own_cells_.clear();
    own_table_.clear();
    std::vector<Lesson> lessons;
    std::vector<Link> links;
    std::vector<Sighting> places;
    for (std::uint32_t most = most_places; !wanted.empty();) {
        const std::size_t first = lessons.size();
        places.clear();
        plan_lessons(wanted, most, places, lessons);
        most = std::max(most / 2, 1u);
        evaluate_lessons(std::span(lessons).subspan(first), places, links, most, wanted);
    }
    solve(lessons, links);
}

}  // namespace render2mpeg::renderer
