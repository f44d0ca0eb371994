// Animations of a glTF file.
#include <map>
#include <utility>

#include "core/error.h"
#include "scene/gltf/accessor.h"
#include "scene/gltf/parts.h"
#include "scene/model/choice.h"
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
    AnimationReader(const Document& document, const MeshReader& meshes, Animation& animation)
        : document_(document), meshes_(meshes), animation_(animation) {}

    void read(const Element& element, const std::string& name) {
        const std::vector<Element> samplers = element.objects("samplers");
        for (const Element& channel : element.objects("channels")) {
            const std::size_t sampler = channel.required_size("sampler");
            if (sampler >= samplers.size())
                channel.refuse("refers to sampler " + std::to_string(sampler) + ", but there are " +
                               std::to_string(samplers.size()));
            const std::optional<Element> target = channel.object("target");
            if (!target) channel.refuse("has no target");
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
    void add_track(TrackTarget what, int node, const Element& sampler, const std::string& name) {
        // Clips of one character move the same nodes; two at a time make no sense.
        const auto [first, is_new] = moved_.emplace(std::pair(what, node), name);
        if (!is_new) {
            note_once(animation_, "animations " + in_quotes(first->second) + " and " + in_quotes(name) +
                                      " move the same nodes; there the first is used");
            return;
        }
        Track track;
        track.target = what;
        track.index = node;
        track.interpolation = interpolation_of(sampler);
        track.width = what == TrackTarget::rotation ? 4 : 3;
        if (what == TrackTarget::weights) {
            const int mesh = document_.at("nodes", node).index("mesh", "meshes");
            track.width = mesh < 0 ? 0 : static_cast<int>(meshes_.morph_targets_of(mesh));
            if (track.width == 0) {
                note_once(animation_,
                          sampler.where() + ": moves morph weights of a node without morph targets; left out");
                return;
            }
        }

        const int input = sampler.required_index("input", "accessors"),
                  output = sampler.required_index("output", "accessors");
        track.times = read_finite_floats(document_, input, {1}, 0, sampler.where() + ", input").values;
        const std::size_t per_key = track.interpolation == Interpolation::cubic_spline ? 3 : 1;
        const std::size_t width = what == TrackTarget::weights ? static_cast<std::size_t>(track.width) : 1;
        const int components = what == TrackTarget::weights ? 1 : track.width;
        track.values = read_finite_floats(document_, output, {components}, track.times.size() * per_key * width,
                                          sampler.where() + ", output")
                           .values;
        animation_.tracks.push_back(std::move(track));
    }

    const Document& document_;
    const MeshReader& meshes_;
    Animation& animation_;
    std::map<std::pair<TrackTarget, int>, std::string> moved_;
};

}  // namespace

void read_animations(const Document& document, const LoadOptions& options, const MeshReader& meshes,
                     Animation& animation) {
    const std::vector<Element> elements = document.all("animations");
    std::vector<std::string> names;
    for (const Element& element : elements) names.push_back(element.string("name", ""));
    AnimationReader reader(document, meshes, animation);
    if (options.animation) {
        const std::optional<std::size_t> chosen = choose(*options.animation, names);
        if (!chosen)
            throw core::Error("reading", document.file().string(), no_such("animation", *options.animation, names));
        reader.read(elements[*chosen], names[*chosen]);
        return;
    }
    for (std::size_t i = 0; i < elements.size(); ++i) reader.read(elements[i], names[i]);
}

}  // namespace render2mpeg::scene::gltf
