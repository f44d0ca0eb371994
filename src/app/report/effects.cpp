#include "app/report/effects.h"

#include <algorithm>
#include <initializer_list>
#include <utility>

#include "core/numeric.h"

namespace render2mpeg::app {
namespace {

using renderer::Pass;

struct Named {
    Pass pass;
    const char* name;
};

/// "lamps, shining shapes and the sky", as far as these passes run.
std::string list_of(const renderer::Plan& plan, std::initializer_list<Named> passes) {
    std::vector<std::string> names;
    for (const Named& named : passes)
        if (plan.runs(named.pass)) names.emplace_back(named.name);
    std::string text;
    for (std::size_t i = 0; i < names.size(); ++i)
        text += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
    return text;
}

}  // namespace

std::vector<Effect> effects_of(const RenderJob& film, const RunStatistics& statistics) {
    const renderer::Plan& plan = film.plan;
    const renderer::Statistics& r = statistics.rendering;
    const auto pass = [&](Pass p) { return statistics.pass_seconds[static_cast<std::size_t>(p)]; };
    std::vector<Effect> effects;
    const double exposing = pass(Pass::shutter) + pass(Pass::lens);
    // A clock that samples may tell more than the whole it is part of.
    const double see = pass(Pass::see), sky = std::min(r.sky_seconds, see);
    effects.push_back({"seeing", see - sky, r.primary_rays, {}, ""});
    if (plan.runs(Pass::sky_background))
        effects.push_back({"the sky seen", sky, {}, {}, "about; what it lights is in direct light"});
    const std::string blur = list_of(plan, {{Pass::shutter, "open shutter"}, {Pass::lens, "lens"}});
    if (!blur.empty())
        effects.push_back({blur, exposing, r.exposure_rays, {}, "what they show of all that is blurred"});
    const std::string specular =
        list_of(plan, {{Pass::lobe_rays, "narrow lobes"}, {Pass::mirrors, "mirrors"}, {Pass::glass, "glass"}});
    if (!specular.empty())
        effects.push_back(
            {specular, {}, r.specular_rays, {}, "time in seeing, and in the light of what is seen there"});
    if (plan.runs(Pass::caustics))
        effects.push_back(
            {"caustics", pass(Pass::caustics), r.caustic_rays, {}, "light that mirrors and glass throw, by photons"});
    if (const std::string own = list_of(plan, {{Pass::hair, "hair"}, {Pass::subsurface, "subsurface"}}); !own.empty())
        effects.push_back(
            {own, pass(Pass::hair) + pass(Pass::subsurface), r.hair.rays, {}, "their light, by rays of their own"});
    // Layers are met by shadow rays to all lights alike.
    const bool photons = plan.runs(Pass::photons);
    const double direct = pass(Pass::punctual_lights) + pass(Pass::emissive_lights) + pass(Pass::direct_tree);
    const bool bounces = plan.runs(Pass::indirect_tree);
    const double bounced = bounces ? pass(Pass::indirect_tree) : 0.0;
    const double layers = std::min(r.layer_seconds, direct + bounced);
    const double rest = core::divide_or(direct + bounced - layers, direct + bounced, 1.0);
    if (const std::string sources = list_of(plan, {{Pass::punctual_lights, "lamps"},
                                                   {Pass::emissive_lights, "shining surfaces"},
                                                   {Pass::sky_light, "the sky"}});
        !sources.empty())
        effects.push_back({"direct light", rest * direct, {}, r.direct_clusters, sources});
    if (photons)
        effects.push_back({"photons", pass(Pass::photons), r.photon_rays, {}, "that carry light to where it bounces"});
    if (bounces && film.rendering.indirect == renderer::Indirect::rays)
        effects.push_back({"bounced light", rest * bounced, r.gather_rays, {}, ""});
    else if (bounces)
        effects.push_back({"bounced light", rest * bounced, {}, r.indirect_clusters, ""});
    if (plan.runs(Pass::alpha) || plan.runs(Pass::glass))
        effects.push_back({"transparent shadows", layers, {}, {}, "about: what layers let through of light"});
    if (film.tolerance.coupled && film.kind == OutputKind::film)
        effects.push_back({"what the eye misses",
                           statistics.stage_seconds(Stage::tolerate),
                           {},
                           {},
                           "tolerances from the pictures before"});
    if (plan.runs(Pass::air)) effects.push_back({"fog", pass(Pass::air), r.air_rays, {}, "light that air scatters"});
    if (plan.runs(Pass::glare)) effects.push_back({"glare", pass(Pass::glare), {}, {}, ""});
    if (plan.runs(Pass::motion)) effects.push_back({"motion", pass(Pass::motion), {}, {}, ""});
    if (film.kind == OutputKind::film)
        effects.push_back({"coding", statistics.stage_seconds(Stage::encode), {}, {}, ""});
    return effects;
}

}  // namespace render2mpeg::app
