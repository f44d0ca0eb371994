// Animations of a glTF file.
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "core/error.h"
#include "scene/gltf/accessor.h"
#include "scene/gltf/parts.h"
#include "scene/model/wording.h"

namespace render2mpeg::scene::gltf {
namespace {

std::optional<TrackTarget> target_of(const std::string& path) {
    if (path == "translation") return TrackTarget::translation;
    if (path == "rotation") return TrackTarget::rotation;
    if (path == "scale") return TrackTarget::scale;
    if (path == "weights") return TrackTarget::weights;
    return std::nullopt;
}

Interpolation interpolation_of(const Element& sampler) {
    const std::string word = sampler.string("interpolation", "LINEAR");
    if (word == "LINEAR") return Interpolation::linear;
    if (word == "STEP") return Interpolation::step;
    if (word == "CUBICSPLINE") return Interpolation::cubic_spline;
    sampler.refuse("interpolation " + in_quotes(word) + " is none of glTF's");
}

class AnimationReader {
  public:
    AnimationReader(const Document& document, const MeshReader& meshes, const Carried& carried, Animation& animation)
        : document_(document), meshes_(meshes), carried_(carried), animation_(animation) {}

    void read(const Element& element, const std::string& name) {
        const std::vector<Element> samplers = element.objects("samplers");
        for (const Element& channel : element.objects("channels")) {
            const std::size_t sampler = channel.required_size("sampler");
            if (sampler >= samplers.size())
                channel.refuse("refers to sampler " + std::to_string(sampler) + ", but there are " +
                               std::to_string(samplers.size()));
            const std::optional<Element> target = channel.object("target");
            if (!target) channel.refuse("has no target");
            if (const auto pointer = target->extension("KHR_animation_pointer")) {
                add_pointed(pointer->string("pointer", ""), channel, samplers[sampler], name);
                continue;
            }
            const std::string path = target->string("path", "");
            const std::optional<TrackTarget> what = target_of(path);
            const int node = target->index("node", "nodes");
            if (!what || node < 0) {
                note_once(animation_, channel.where() + ": moves " + (what ? "no node" : in_quotes(path)) +
                                          ", which is not understood; left out");
                continue;
            }
            add_track(*what, node, samplers[sampler], name);
        }
    }

  private:
    /// A channel of KHR_animation_pointer.
    void add_pointed(const std::string& pointer, const Element& channel, const Element& sampler,
                     const std::string& name) {
        const PointedTrack pointed = pointed_track(document_, pointer);
        const auto each_of = [&](const std::vector<int>& carried, auto&& add) {
            for (std::size_t i = 0; i < carried.size(); ++i)
                if (carried[i] == pointed.index) add(static_cast<int>(i));
        };
        using enum TrackTarget;
        switch (pointed.what.value_or(f_stop)) {
            case translation:
            case rotation:
            case scale:
            case weights:
                return add_track(*pointed.what, pointed.index, sampler, name);
            case visibility:
                return add_numbers(visibility, pointed.index, sampler, name, 1);
            case field_of_view:
                return each_of(carried_.cameras, [&](int i) { add_numbers(field_of_view, i, sampler, name, 1); });
            case light_intensity:
                return each_of(carried_.lights, [&](int i) { add_intensity(i, sampler, name); });
            case light_color:
                return each_of(carried_.lights, [&](int i) { add_color(light_color, i, 3, sampler, name); });
            case base_color:
                return add_color(base_color, pointed.index, 4, sampler, name);
            case emission:
                return add_emission(pointed, sampler, name);
            default:
                break;
        }
        note_once(animation_, channel.where() + ": moves " + in_quotes(pointer) + ", which stays still here; left out");
    }

    /// Whether nothing moved this before: clips of one character move the same nodes.
    bool is_first(TrackTarget what, int index, const std::string& name) {
        const auto [first, is_new] = moved_.emplace(std::pair(what, index), name);
        if (!is_new)
            for (const std::string& other : {first->second, name})
                if (std::find(overlapping_.begin(), overlapping_.end(), other) == overlapping_.end())
                    overlapping_.push_back(other);
        return is_new;
    }

    /// Keys of `width` elements of `components` numbers each, whatever they stand for.
    Track keys_of(TrackTarget what, int index, const Element& sampler, int components, int width = 1) {
        Track track;
        track.target = what;
        track.index = index;
        track.interpolation = interpolation_of(sampler);
        track.width = components * width;
        const int input = sampler.required_index("input", "accessors"),
                  output = sampler.required_index("output", "accessors");
        track.times = read_finite_floats(document_, input, {1}, 0, sampler.where() + ", input").values;
        const auto per_key =
            static_cast<std::size_t>(width) * (track.interpolation == Interpolation::cubic_spline ? 3 : 1);
        track.values = read_finite_floats(document_, output, {components}, track.times.size() * per_key,
                                          sampler.where() + ", output")
                           .values;
        return track;
    }

    /// A track of single numbers over `unit`.
    void add_numbers(TrackTarget what, int index, const Element& sampler, const std::string& name, float unit) {
        if (!is_first(what, index, name)) return;
        Track track = keys_of(what, index, sampler, 1);
        for (float& value : track.values) value /= unit;
        animation_.tracks.push_back(std::move(track));
    }

    void add_color(TrackTarget what, int index, int components, const Element& sampler, const std::string& name) {
        if (!is_first(what, index, name)) return;
        Track track = keys_of(what, index, sampler, components);
        // Traits ask before keys are read.
        const auto n = static_cast<std::size_t>(components);
        const std::size_t step = track.interpolation == Interpolation::cubic_spline ? 3 * n : n;
        for (std::size_t c = 0; c < n; ++c) {
            float largest = 0;
            for (std::size_t k = step == n ? 0 : n; k + n <= track.values.size(); k += step)
                largest = std::max(largest, track.values[k + c]);
            const auto i = static_cast<std::size_t>(index);
            const auto channel = static_cast<int>(c);
            if (what == TrackTarget::light_color)
                animation_.lights[i].color[channel] = largest;
            else
                animation_.materials[i].base_color[channel] = largest;
        }
        animation_.tracks.push_back(std::move(track));
    }

    void add_intensity(int index, const Element& sampler, const std::string& name) {
        // Tracks are factors; a light that begins dark gets a strength.
        float& own = animation_.lights[static_cast<std::size_t>(index)].intensity;
        if (!(own > 0)) own = 1;
        add_numbers(TrackTarget::light_intensity, index, sampler, name, own);
    }

    /// Emission by colour or strength, as factors of the material's own.
    void add_emission(const PointedTrack& pointed, const Element& sampler, const std::string& name) {
        if (!is_first(TrackTarget::emission, pointed.index, name)) return;
        Material& material = animation_.materials[static_cast<std::size_t>(pointed.index)];
        const Element element = document_.at("materials", pointed.index);
        const std::vector<double> factor = element.numbers("emissiveFactor", 3);
        const auto extension = element.extension("KHR_materials_emissive_strength");
        const auto strength = static_cast<float>(extension ? extension->number("emissiveStrength", 1) : 1);
        const bool by_color = !pointed.strength;
        Track track = keys_of(TrackTarget::emission, pointed.index, sampler, by_color ? 3 : 1);
        if (!by_color) {
            material.emission = factor.empty() ? glm::vec3(0) : glm::vec3(factor[0], factor[1], factor[2]);
            animation_.tracks.push_back(std::move(track));
            return;
        }
        // The brightest key's colour is the material's.
        const auto color = [&](std::size_t k) {
            return glm::vec3(track.values[3 * k], track.values[3 * k + 1], track.values[3 * k + 2]);
        };
        const std::size_t step = track.interpolation == Interpolation::cubic_spline ? 3 : 1;
        glm::vec3 brightest(0);
        for (std::size_t k = step / 2; 3 * k < track.values.size(); k += step)
            if (glm::dot(color(k), color(k)) > glm::dot(brightest, brightest)) brightest = color(k);
        const float square = glm::dot(brightest, brightest);
        if (!(square > 0) || !std::isfinite(square)) return;
        std::vector<float> shares;
        bool one_color = true;
        for (std::size_t k = 0; 3 * k < track.values.size(); ++k) {
            const float share = glm::dot(color(k), brightest) / square;
            shares.push_back(share);
            if (k % step == step / 2)
                one_color = one_color && glm::length(color(k) - share * brightest) <= 0.02f * std::sqrt(square);
        }
        if (!one_color)
            note_once(animation_, element.where() + ": its emission changes its strength, but not its colour");
        material.emission = strength * brightest;
        track.width = 1;
        track.values = std::move(shares);
        animation_.tracks.push_back(std::move(track));
    }

  public:
    /// Says once which animations move the same nodes, and how to see another one.
    void tell_overlaps() {
        if (overlapping_.size() < 2) return;
        std::string others;
        for (std::size_t i = 1; i < overlapping_.size(); ++i)
            others += (i == 1 ? "" : ", ") + in_quotes(overlapping_[i]);
        note_once(animation_, std::to_string(overlapping_.size()) + " animations move the same nodes; " +
                                  in_quotes(overlapping_.front()) +
                                  " is used; --animation NAME takes another: " + others);
    }

  private:
    void add_track(TrackTarget what, int node, const Element& sampler, const std::string& name) {
        if (!is_first(what, node, name)) return;
        if (what != TrackTarget::weights) {
            const int components = what == TrackTarget::rotation ? 4 : 3;
            animation_.tracks.push_back(keys_of(what, node, sampler, components));
            return;
        }
        const int mesh = document_.at("nodes", node).index("mesh", "meshes");
        const int targets = mesh < 0 ? 0 : static_cast<int>(meshes_.morph_targets_of(mesh));
        if (targets > 0)
            animation_.tracks.push_back(keys_of(what, node, sampler, 1, targets));
        else
            note_once(animation_, sampler.where() + ": moves morph weights of a node without morph targets; left out");
    }

    const Document& document_;
    const MeshReader& meshes_;
    const Carried& carried_;
    Animation& animation_;
    std::map<std::pair<TrackTarget, int>, std::string> moved_;
    std::vector<std::string> overlapping_;  ///< animations that share a target with another, the first of all first
};

}  // namespace

void read_animations(const Document& document, const LoadOptions& options, const MeshReader& meshes,
                     const Carried& carried, Animation& animation) {
    const std::vector<Element> elements = document.all("animations");
    std::vector<std::string> names;
    for (const Element& element : elements) names.push_back(element.string("name", ""));
    AnimationReader reader(document, meshes, carried, animation);
    if (options.animation) {
        const std::optional<std::size_t> chosen = choose(*options.animation, names);
        if (!chosen)
            throw core::Error("reading", document.file().string(), no_such("animation", *options.animation, names));
        reader.read(elements[*chosen], names[*chosen]);
        return;
    }
    for (std::size_t i = 0; i < elements.size(); ++i) reader.read(elements[i], names[i]);
    reader.tell_overlaps();
}

}  // namespace render2mpeg::scene::gltf
