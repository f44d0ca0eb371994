#include "renderer/gather/cell_light.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/color.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "renderer/base/lobe.h"
#include "renderer/surface/lobe_albedo.h"

namespace render2mpeg::renderer {
namespace {

/// Share of a gather ray's light from which on light that nobody asked for yet counts as none. chosen: 0.001, after ten
/// bounces off a surface of 0.5; what is asked from elsewhere as well goes on.
constexpr float least_carried = 0.001f;

/// Directions among which a place's ray is chosen. chosen: 4; by one, a closed room of roughness 0.9 and albedo 0.8 is
/// 7 % dark.
constexpr std::uint64_t candidates = 4;

/// Directions to light that a fibre's shadow ray has one of. chosen: 4 of 1 to 16. A head under three lamps errs as by
/// 2.1 times the rays, which cost a quarter more each; 8 are as good for their time.
constexpr std::uint32_t peaked_choices = 4;

/// What a place draws numbers for.
enum Number : std::uint64_t { lamp, surface, sky, bounce, side, part, onward };

/// One of some candidates, in proportion to their luminance. Resampled importance sampling [Talbot2005].
class Resampled {
  public:
    /// Whether this one takes the place of the one before. `number()`: in [0, 1).
    template <class Number>
    bool takes(float luminance, const Number& number) {
        if (!(luminance > 0.0f)) return false;
        all_ += luminance;
        if (luminance < all_ && !(number() * all_ < luminance)) return false;
        own_ = luminance;
        return true;
    }
    bool any() const { return all_ > 0.0f; }
    /// Weight of the one of so many.
    float weight(float count) const { return all_ / (count * own_); }

  private:
    float all_ = 0, own_ = 0;  ///< luminance
};

struct Drawn {
    glm::vec3 direction{0}, weight{0};
    float density = 0;  ///< of one candidate
};

/// One of some directions, in proportion to what the surface throws from there: those below a rough surface are never
/// chosen, and lobes get no more rays than light. Those of a polished surface count as they are drawn.
Drawn draw(const Scatterer& at, bool polished, const Stream& numbers) {
    const std::uint64_t count = polished || at.is_fibre() || !at.point().bsdf.has_lobe() ? 1 : candidates;
    Drawn chosen;
    Resampled of;
    for (std::uint64_t k = 0; k < count; ++k) {
        Drawn c;
        c.density =
            at.sample(numbers.uniform(part, 2 * k),
                      {numbers.uniform(bounce, 2 * k), numbers.uniform(bounce, 2 * k + 1)}, c.direction, c.weight);
        if (!(c.density > 0.0f) || !at.query().may_see(c.direction)) continue;
        if (of.takes(core::luminance(c.weight), [&] { return numbers.uniform(part, 2 * k + 1); })) chosen = c;
    }
    if (of.any()) chosen.weight *= of.weight(static_cast<float>(count));
    return chosen;
}

}  // namespace

/// A ray on which a cell's light goes on.
struct CellLight::Bounce {
    RayQuery ray;
    LightQuery query;  ///< that lights were asked by
    LightChoices choices;
    float density = 0;  ///< of the direction
    glm::vec3 weight{1};
    float share = 0;  ///< NearField::share
    Stream numbers;
    float near = 0;     ///< RayRules
    float carried = 1;  ///< CellQuery
    CellUpdate* update = nullptr;
    std::uint8_t depth = 0;
    float lobe = 0;  ///< alpha of the polished metal that it leaves; 0: it leaves no such
};

/// Results of some places.
struct CellLight::Found {
    std::vector<Bounce> bounces;
    std::vector<RayTerm> terms;
    std::uint64_t rays = 0;
};

CellLight::CellLight(const PosedScene& posed_scene, const Plan& plan)
    : posed_scene_(posed_scene), gather_rays_(posed_scene, plan), plan_(plan) {}

void CellLight::pose(NearField near_field) {
    near_field_ = std::move(near_field);
    sources_.emplace(posed_scene_, plan_);
}

LightChoices CellLight::light_choices() const {
    return {std::min(peaked_choices, static_cast<std::uint32_t>(sources_->lamps().lights().size())), peaked_choices};
}

glm::vec3 CellLight::lamps(const Scatterer& at, const Stream& numbers, LightChoices choices, std::uint64_t& rays,
                           const Scatterer* wide) const {
    const LightQuery& query = at.query();
    glm::vec3 sum(0);
    // One of the directions has a ray, as likely as the place scatters light from there if nothing is in the way.
    const auto add = [&](Number use, std::uint32_t count, const SourceTree& lights) {
        if (lights.empty()) return;
        const auto n = static_cast<float>(count);
        LightSample chosen;
        glm::vec3 light(0);
        Resampled of;
        for (std::uint32_t k = 0; k < count; ++k) {
            const auto u = [&](std::uint64_t which) { return numbers.uniform(use, 4 * k + which); };
            const LightSample s = lights.sample(query, (static_cast<float>(k) + u(0)) / n, {u(1), u(2)});
            if (!(core::luminance(s.light) > 0.0f) || !query.may_see(s.direction)) continue;
            const Scattered to =
                (s.density > 0.0f || wide == nullptr ? at : *wide).scattered(s.direction, s.density > 0.0f);
            glm::vec3 candidate = to.share * s.light;
            if (!(core::luminance(candidate) > 0.0f)) continue;
            if (s.density > 0.0f) candidate *= n * s.density / (n * s.density + to.density);
            if (!of.takes(core::luminance(candidate), [&] { return u(3); })) continue;
            chosen = s;
            light = candidate;
        }
        if (!of.any()) return;
        light *= of.weight(n);
        if (const Air* air = posed_scene_.air(); air != nullptr) {
            const glm::vec3 direction = core::normalize_or(chosen.ray, chosen.direction);
            const float way = std::isinf(chosen.far) ? chosen.far : glm::length(chosen.ray) * chosen.far;
            light *= air->left_of_light(query.origin, direction, way);
        }
        ++rays;
        const float skipped = at.skipped(chosen.ray);
        sum += light * posed_scene_.tracer().passes(at.origin_of(chosen.ray), chosen.ray, chosen.far - skipped);
    };
    add(lamp, choices.lamps, sources_->lamps());
    add(surface, choices.surfaces, sources_->surfaces());
    add(sky, 1, sources_->skies());
    return sum;
}

/// Light comes from this side or from beyond, in proportion to what is reflected and let through. Returns its weight.
glm::vec3 CellLight::choose_side(const Stream& numbers, SurfacePoint& p) const {
    const float through = core::luminance(p.bsdf.diffuse_transmission);
    glm::vec3 weight(1);
    if (through > 0.0f) {
        const float reflected = core::luminance(p.bsdf.diffuse) + core::luminance(p.bsdf.f0);
        const float chance = through / (through + reflected);
        const bool beyond = numbers.uniform(side, 0) < chance;
        weight = glm::vec3(1.0f / (beyond ? chance : 1.0f - chance));
        if (beyond) p = posed_scene_.other_side(p);
    }
    return weight;
}

/// Evaluates a place: what lamps send, and one ray whose end sends the rest.
void CellLight::light_place(const CellQuery& place, const Stream& numbers, CellUpdate& update, Found& out) const {
    glm::vec3 along, across;
    core::make_frame(place.outgoing, along, across);
    SurfacePoint p = posed_scene_.surface_at(place.address, place.outgoing, {place.size * along, place.size * across});
    if (p.unlit) return;
    glm::vec3 weight = choose_side(numbers, p);
    const float cosine = glm::dot(p.shading_normal, p.outgoing);
    const glm::vec3 albedo = diffuse_albedo(p.bsdf, cosine) + glossy_albedo(p.bsdf, cosine);
    const float brightest = p.fibre ? 1.0f : std::max({albedo.x, albedo.y, albedo.z});
    if (!(brightest > 0.0f)) return;
    const float scale = std::min(largest_albedo / brightest, 1.0f);
    p.bsdf.scale(scale);
    const float alpha = p.bsdf.alpha;
    Scatterer polished;
    if (place.polished) polished = Scatterer(posed_scene_, p);
    p.bsdf.alpha = std::max(p.bsdf.alpha, least_alpha_of_cells);
    p.bsdf.alpha_along = std::max(p.bsdf.alpha_along, least_alpha_of_cells);

    const Scatterer wide(posed_scene_, p);
    const Scatterer& at = place.polished ? polished : wide;
    update.fibres = p.fibre;
    update.albedo += p.fibre ? at.albedo() : scale * weight * albedo;
    const LightChoices choices = p.fibre ? light_choices() : LightChoices{};
    const glm::vec3 direct = weight * lamps(at, numbers, choices, out.rays, &wide);
    const float share = near_field_.share(p.position);
    if (core::is_finite(direct)) {
        update.known += direct;
        update.near += share * direct;
    }

    const Drawn drawn = draw(at, place.polished, numbers);
    const glm::vec3 of_place = weight;
    weight *= drawn.weight;
    if (!(core::luminance(weight) > 0.0f) || !core::is_finite(weight)) return;
    // Directions that fall below a polished surface are lost in the mean: no other candidate makes up for them.
    update.drawn += place.polished ? scale * of_place * albedo : weight;
    out.rays += 1;
    out.bounces.push_back({{at.origin_of(drawn.direction), drawn.direction, std::numeric_limits<float>::infinity()},
                           at.query(),
                           choices,
                           drawn.density,
                           weight,
                           share,
                           numbers,
                           place.depth > 0 ? 0.5f * place.size : 0.0f,
                           place.carried,
                           &update,
                           place.depth,
                           place.polished ? alpha : 0.0f});
}

/// Follows the rays of all places. Links of updates are their terms.
void CellLight::follow_bounces(Found& out) const {
    std::vector<RayQuery> queries;
    for (const Bounce& b : out.bounces) queries.push_back(b.ray);
    std::vector<Hit> hits(queries.size());
    posed_scene_.tracer().any_nearest(queries, hits, false);
    RayRules rules;
    rules.brightest = std::numeric_limits<float>::infinity();
    for (std::size_t i = 0; i < queries.size(); ++i) {
        const Bounce& b = out.bounces[i];
        const AskedLights asked{*sources_, b.query, b.density, b.choices};
        rules.asked = &asked;
        rules.near = b.near;
        rules.depth = b.depth;
        rules.is_lobe = b.lobe > 0.0f;
        rules.spread = rules.is_lobe ? std::min(cell_spread, 0.5f * b.lobe) : cell_spread;
        CellUpdate& update = *b.update;
        const auto first = static_cast<std::uint32_t>(out.terms.size());
        const glm::vec3 known =
            b.weight * gather_rays_.follow(b.ray, hits[i], rules, b.numbers.at(onward), 0, out.terms, out.rays);
        if (core::is_finite(known)) {
            update.known += known;
            update.near += b.share * known;
        }
        if (out.terms.size() > first) {
            RayTerm& term = out.terms.back();
            term.weight *= b.weight;
            term.near = b.share;
            term.place.carried =
                b.carried * core::luminance(term.weight) * (update.fibres ? largest_fibre_albedo : 1.0f);
        }
        if (update.first_link == update.last_link) update.first_link = first;
        update.last_link = static_cast<std::uint32_t>(out.terms.size());
    }
}

namespace {

/// Whether rays to a cell end there, where surfaces' need so many places.
bool answers(const CellQuery& place, CellTable::Found cell, std::uint32_t known) {
    return cell.places >= (place.fibre ? answering_places : known);
}

}  // namespace

TaskLight CellLight::evaluate(const ShardUpdates& shard, std::span<CellUpdate> updates, std::uint32_t known,
                              const LightCells& cells) const {
    Found found;
    for (CellUpdate& update : updates)
        for (std::uint32_t k = 0; k < update.places; ++k) {
            const CellQuery& place = shard.place(update.first + k);
            light_place(place, Stream(Purpose::places_of_cells, {.index = place.key}).at(update.number + k), update,
                        found);
        }
    follow_bounces(found);
    TaskLight out;
    out.rays = found.rays;
    out.links.reserve(found.terms.size());
    std::vector<PathStart> starts;
    for (const RayTerm& t : found.terms) {
        const CellTable::Found cell = cells.find(t.place.key);
        out.links.push_back({t.place.key, t.weight, t.near, cell.index});
        if (answers(t.place, cell, known) || !(t.place.carried > least_carried)) continue;
        if (t.place.fibre)
            out.among.places.push_back(t.place);
        else if (known > 1)
            out.asked.places.push_back(t.place);
        else
            starts.push_back({t.place, Stream(Purpose::paths_of_cells)});
    }
    for (CellUpdate& update : updates) update.links = out.links.data();
    out.asked.sort();
    out.among.sort();
    if (known == 1) follow_paths(std::move(starts), cells, out);
    return out;
}

namespace {

/// Replaces links between updates of a path by links to what the path meets in the end: radiances of later ones are
/// put in. Updates come before those that they meet.
void eliminate(std::vector<PathUpdate>& updates, std::vector<CellLink>& links) {
    for (std::size_t i = updates.size(); i-- > 0;) {
        CellUpdate& update = updates[i].update;
        const bool has_link = update.first_link < update.last_link;
        if (has_link) links[i].weight *= link_scale(update, links[i].weight, 1);
        // The cell of this update and others need not scale it again.
        update.albedo = update.drawn = glm::vec3(1);
        if (!has_link) continue;
        if (updates[i].next == LightCells::none) continue;
        const CellUpdate& met = updates[updates[i].next].update;
        const glm::vec3 light = links[i].weight * met.known;
        update.known += light;
        update.near += links[i].near * light;
        const CellLink& beyond = links[updates[i].next];
        links[i].key = beyond.key;
        links[i].cell = beyond.cell;
        links[i].weight *= beyond.weight;
        if (met.first_link == met.last_link) update.last_link = update.first_link;
    }
}

}  // namespace

/// Follows rays from place to place, those of all paths together.
void CellLight::follow_paths(std::vector<PathStart> starts, const LightCells& cells, TaskLight& out) const {
    std::vector<PathUpdate>& updates = out.paths.updates;
    for (std::uint64_t step = 0; !starts.empty(); ++step) {
        const std::size_t first = updates.size();
        updates.resize(first + starts.size());
        out.path_links.resize(updates.size());
        Found found;
        for (std::size_t i = 0; i < starts.size(); ++i) {
            PathUpdate& path = updates[first + i];
            path.key = starts[i].place.key;
            // A path may come back to a cell, and goes on to elsewhere then.
            light_place(starts[i].place, starts[i].numbers.at(path.key).at(step), path.update, found);
        }
        follow_bounces(found);
        out.rays += found.rays;
        std::vector<PathStart> going_on;
        const std::size_t next = updates.size();
        for (std::size_t i = first; i < next; ++i) {
            CellUpdate& update = updates[i].update;
            const bool has_link = update.first_link < update.last_link;
            const std::size_t term = std::exchange(update.first_link, static_cast<std::uint32_t>(i));
            update.last_link = update.first_link + (has_link ? 1 : 0);
            if (!has_link) continue;
            const RayTerm& t = found.terms[term];
            const CellTable::Found cell = cells.find(t.place.key);
            out.path_links[i] = {t.place.key, t.weight, t.near, cell.index};
            if (answers(t.place, cell, 1) || !(t.place.carried > least_carried)) continue;
            updates[i].next = static_cast<std::uint32_t>(next + going_on.size());
            going_on.push_back({t.place, starts[i - first].numbers});
        }
        starts = std::move(going_on);
    }
    eliminate(updates, out.path_links);
    for (PathUpdate& path : updates) path.update.links = out.path_links.data();
    out.paths.keys = AskedKeys(updates.size(), [&](std::size_t i) { return updates[i].key; });
}

}  // namespace render2mpeg::renderer
