#include "renderer/base/plan.h"

#include <cstddef>
#include <cstdint>
#include <initializer_list>

#include "core/error.h"

namespace render2mpeg::renderer {
namespace {

using scene::Traits;

constexpr std::size_t pass_count = static_cast<std::size_t>(Pass::count);

/// A set of passes, one bit each.
using PassSet = std::uint64_t;
static_assert(pass_count < 64);

constexpr PassSet bit(Pass pass) {
    return PassSet{1} << static_cast<unsigned>(pass);
}
constexpr PassSet set_of(std::initializer_list<Pass> passes) {
    PassSet set = 0;
    for (const Pass pass : passes) set |= bit(pass);
    return set;
}

constexpr bool always(const Traits&) {
    return true;
}
constexpr bool never(const Wanted&) {
    return false;
}
constexpr bool has_light(const Traits& t) {
    return t.has_punctual_lights || t.has_emissive_surfaces || t.has_shining_sky;
}
constexpr bool has_caustics(const Traits& t) {
    return t.casts_caustics && has_light(t) && (t.has_diffuse_surfaces || t.has_glossy_surfaces);
}
constexpr bool without_indirect(const Wanted& w) {
    return !w.indirect;
}
constexpr bool without_light_points(const Wanted& w) {
    return !w.indirect || w.by_rays;
}

constexpr bool without_caustics(const Wanted& w) {
    return !w.caustics;
}

/// One effect. `feeds`: the later passes that read what it writes, in the same frame. `wanted`: whether the user asked
/// for its product itself; `refused`: whether the user asked to do without it.
struct Rule {
    Pass pass;
    const char* name;
    const char* cause;     ///< why it runs where it does
    const char* no_cause;  ///< why it does not: "nothing is transparent"
    bool (*cause_in)(const Traits&);
    PassSet feeds;
    bool (*wanted)(const Wanted&);
    const char* reads;
    const char* writes;
    const char* effect = "";  ///< see PlanRow; the pass does without it where the plan says that it does not run
    bool (*refused)(const Wanted&) = &never;
};

using enum Pass;

/// The table. A new effect is one row here and one file beside it; with its name in the last column `cost` shows its
/// time, and pictures without it.
constexpr Rule rules[] = {
    {pose, "pose", "the scene has surfaces", "there are no surfaces", [](const Traits& t) { return t.has_surfaces; },
     set_of({see, emissive_lights, caustics, photons, shade}), never, "snapshot (n)", "traced geometry (n)"},
    {textures, "textures", "materials have images", "no material has an image",
     [](const Traits& t) { return t.has_textures; }, set_of({see, emissive_lights, caustics, photons, shade}), never,
     "images (film)", "filtered images (film)", "textures"},
    {normal_maps, "normal maps", "materials have normal maps", "no material has a normal map",
     [](const Traits& t) { return t.has_normal_maps; }, set_of({see, caustics, photons}), never, "images (film)",
     "bent normals (n)", "normal maps"},
    {alpha, "alpha", "surfaces have holes or are see-through", "nothing has holes or is see-through",
     [](const Traits& t) { return t.has_alpha_mask || t.has_alpha_blend; }, set_of({see, caustics, photons, shade}),
     never, "materials (n)", "layers met by rays (n)", "holes and veils"},
    {mirrors, "mirrors", "surfaces are smooth enough to mirror", "nothing is smooth enough to mirror",
     [](const Traits& t) { return t.has_mirrors; }, set_of({see, caustics, photons}), never, "geometry (n)",
     "surfaces seen in mirrors (n)", "mirrors"},
    {lobe_rays, "lobe rays", "surfaces are glossy, but not rough", "nothing is glossy, but not rough",
     [](const Traits& t) { return t.has_narrow_lobes && has_light(t); }, set_of({shade}), never,
     "geometry, sky, cells of light (n)", "radiance along narrow lobes (n)", "sharp gloss"},
    {glass, "glass", "surfaces transmit light", "nothing is transparent", [](const Traits& t) { return t.has_glass; },
     set_of({see, caustics, photons, shade}), never, "geometry (n)", "surfaces seen through glass, tinted light (n)",
     "glass"},
    {refraction, "refraction", "glass has a thickness", "all glass is thin",
     [](const Traits& t) { return t.has_bodies; }, set_of({see, photons, caustics}), never, "geometry (n)",
     "ways of rays through glass (n)", "refraction"},
    {subsurface, "subsurface", "light goes below surfaces", "no light goes below a surface",
     [](const Traits& t) { return t.has_subsurface && has_light(t); }, set_of({shade}), never,
     "lights, geometry, cells of light (n)", "light that leaves elsewhere (n)", "light below surfaces"},
    {sky_background, "sky background", "the sky shines", "the sky is black",
     [](const Traits& t) { return t.has_shining_sky; }, set_of({see}), never, "sky (film), camera (n)",
     "background (n)", "the sky seen"},
    {edited_reflections, "edited reflections", "mirrors are told what to show", "no mirror is told what to show",
     [](const Traits& t) { return t.has_edited_reflections; }, set_of({see}), never,
     "edits, camera (n: opening to closing)", "turns of mirrored rays (n)", "edits of reflections"},
    {see, "see", "frames are looked at", "", always, set_of({shutter, lens, motion, caustics, shade, layers}), never,
     "geometry, materials, camera (n)", "visible surfaces, gather points (n)"},
    {shutter, "shutter", "the shutter is open, and things or cameras move", "the shutter is closed, or nothing moves",
     [](const Traits& t) { return t.shows_motion(); }, set_of({shade}), never,
     "snapshots (n: opening to closing), visible surfaces (n)", "which points each pixel shows (n)", "motion blur"},
    {lens, "lens", "a camera has an aperture", "all cameras are pinholes",
     [](const Traits& t) { return t.has_aperture; }, set_of({shade}), never, "camera, visible surfaces (n)",
     "which points each pixel shows (n)", "depth of field"},
    {motion, "motion", "the camera or the scene moves", "nothing moves",
     [](const Traits& t) { return t.anything_moves() || t.has_cuts; }, set_of({layers, encode}), never,
     "visible surfaces (n), snapshots (references)", "motion (n to its references)"},
    {punctual_lights, "punctual lights", "there are punctual lights", "there is no punctual light",
     [](const Traits& t) { return t.has_punctual_lights; }, set_of({caustics, hair, direct_tree, photons, shade}),
     never, "lights (n)", "light points (n)", "lamps"},
    {emissive_lights, "emissive surfaces", "surfaces shine", "no surface shines",
     [](const Traits& t) { return t.has_emissive_surfaces; }, set_of({caustics, hair, direct_tree, photons}), never,
     "emission (n), places (chunk)", "light points (n)", "light of shining surfaces"},
    {sky_light, "sky light", "the sky shines", "the sky is black",
     [](const Traits& t) { return t.has_shining_sky && (t.has_surfaces || t.has_volumes); },
     set_of({caustics, hair, direct_tree, photons, volumes}), never, "sky (film)", "light points (film)",
     "light of the sky"},
    {area_lamps, "area lamps", "lamps shine evenly", "no lamp has a size and shines evenly",
     [](const Traits& t) { return t.has_surfaces && t.has_even_lamps; }, set_of({shade}), never,
     "lamps (n), choice (film)", "lamps in closed form (n)", "area lamps in closed form"},
    {caustics, "caustics", "things mirror or bend light onto others", "nothing mirrors or bends light onto others",
     has_caustics, set_of({shade}), never, "lights, geometry, gather points (n), photons' number (chunk)",
     "light on points (n)", "caustics", without_caustics},
    {hair, "hair", "strands scatter light as fibres", "there is no hair",
     [](const Traits& t) { return t.has_hair && has_light(t); }, set_of({shade}), never,
     "lights, geometry, strands seen (n)", "light of strands (n)", "hair's scattering"},
    {direct_tree, "direct light tree", "there are lights to cluster", "there is no light to cluster",
     [](const Traits& t) { return t.has_surfaces && has_light(t); }, set_of({shade}), never,
     "light points (n), topology (chunk)", "direct light tree (n)"},
    {photons, "photons", "light bounces off surfaces", "no light bounces off anything",
     [](const Traits& t) { return has_light(t) && (t.has_diffuse_surfaces || t.has_glossy_surfaces); },
     set_of({indirect_tree}), never, "light points, geometry (n), photons' number (chunk)", "virtual point lights (n)",
     "", without_light_points},
    {indirect_tree, "indirect light", "light bounces off surfaces", "no light bounces off anything",
     [](const Traits& t) { return has_light(t) && (t.has_diffuse_surfaces || t.has_glossy_surfaces); }, set_of({shade}),
     never, "geometry (n), or virtual point lights (n)", "bounced light (n)", "bounced light", without_indirect},
    {glossy, "glossy lobes", "surfaces have glossy lobes", "nothing is glossy",
     [](const Traits& t) { return t.has_glossy_surfaces; }, set_of({shade}), never, "materials (n)", "lobes (n)",
     "gloss"},
    {air, "air", "the film has fog", "the air is clear", [](const Traits& t) { return t.has_fog; },
     set_of({shade, layers}), never, "fog (film), lights, cells of light, depth (n)",
     "light that air scatters, dimmed light (n)", "fog"},
    {volumes, "volumes", "there are volumes", "there are no volumes", [](const Traits& t) { return t.has_volumes; },
     set_of({shade, layers}), never, "grids, lights, cells of light, depth (n)", "light of volumes, dimmed light (n)",
     "smoke, clouds and fire"},
    {shade, "shade", "pictures are wanted", "", always, set_of({layers, glare, develop}),
     [](const Wanted& w) { return w.picture; }, "gather points, light trees, tolerance (n)", "radiance (n)"},
    {layers, "layers", "layers are wanted", "", always, 0, [](const Wanted& w) { return w.layers; },
     "visible surfaces, radiance (n), motion (n to n-1 and n+1)", "layer file (n)"},
    {glare, "glare", "glare is asked for", "nobody asks for glare", [](const Traits& t) { return t.has_glare; },
     set_of({develop}), never, "radiance (n)", "radiance as an eye gets it (n)", "glare"},
    {develop, "develop", "pictures are developed", "", always, set_of({encode}),
     [](const Wanted& w) { return w.developed; }, "radiance (n)", "picture (n)"},
    {encode, "encode", "a film is wanted", "", always, 0, [](const Wanted& w) { return w.film; },
     "picture (n), motion, coded references", "bits, reconstruction (n)"},
};

/// Every pass has its row, in the order of the enumeration, and feeds later passes only: one sweep from last to first
/// closes it.
constexpr bool is_ordered_and_complete() {
    if (sizeof(rules) / sizeof(rules[0]) != pass_count) return false;
    for (std::size_t i = 0; i < pass_count; ++i) {
        if (rules[i].pass != static_cast<Pass>(i)) return false;
        const PassSet up_to_here = (PassSet{2} << i) - 1;
        if ((rules[i].feeds & up_to_here) != 0 || (rules[i].feeds >> pass_count) != 0) return false;
    }
    return true;
}
static_assert(is_ordered_and_complete());

/// A pass that feeds nobody must be something that a user can ask for.
constexpr bool ends_in_products() {
    for (const Rule& rule : rules)
        if (rule.feeds == 0 && rule.wanted == &never) return false;
    return true;
}
static_assert(ends_in_products());

}  // namespace

Plan make_plan(const Traits& traits, const Wanted& wanted) {
    std::vector<PlanRow> rows(pass_count);
    PassSet running = 0;
    for (std::size_t i = pass_count; i-- > 0;) {
        const Rule& rule = rules[i];
        PlanRow& row = rows[i];
        row.pass = rule.pass;
        row.name = rule.name;
        row.reads = rule.reads;
        row.writes = rule.writes;
        row.effect = rule.effect;
        const bool cause = rule.cause_in(traits), refused = rule.refused(wanted) || wanted.without == rule.pass;
        const bool read = rule.wanted(wanted) || (rule.feeds & running) != 0;
        row.runs = cause && read && !refused;
        if (row.runs) {
            row.reason = rule.cause;
            running |= bit(rule.pass);
        } else if (!cause) {
            row.reason = std::string("no cause: ") + rule.no_cause;
        } else {
            row.reason = refused ? "not wanted" : "nobody reads it";
        }
    }
    return Plan(std::move(rows));
}

}  // namespace render2mpeg::renderer
