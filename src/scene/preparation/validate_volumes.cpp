// Checks volumes.
#include <cmath>

#include "core/fog.h"
#include "core/numeric.h"
#include "scene/model/wording.h"
#include "scene/preparation/validate.h"
#include "scene/volumes/volume_reader.h"

namespace render2mpeg::scene {
namespace {

bool is_within(glm::vec3 v, float most) {
    for (int k = 0; k < 3; ++k)
        if (!(v[k] >= 0 && v[k] <= most)) return false;
    return true;
}

}  // namespace

void validate_volumes(Animation& animation) {
    // chosen: 1e30, as of materials.
    constexpr float most = 1e30f;
    for (std::size_t i = 0; i < animation.volumes.size(); ++i) {
        Volume& volume = animation.volumes[i];
        const std::string name = described("volume", i, volume.name);
        const auto check = [&](bool holds, const char* cause) {
            if (!holds) refuse(animation, name, cause);
        };
        check(volume.node >= -1 && volume.node < static_cast<int>(animation.nodes.size()), "its node is none");
        check(volume.grids || !volume.files.empty(), "it has neither files nor grids");
        check(volume.more_files.empty() || volume.more_files.size() == volume.files.size(),
              "it has not as many files of more grids as others");
        check(volume.density >= 0 && volume.density <= most, "its density must be finite and not negative");
        check(is_within(volume.color, 1), "its colour must lie between 0 and 1");
        check(is_within(volume.absorption_color, 1), "its absorption colour must lie between 0 and 1");
        check(std::abs(volume.anisotropy) <= core::most_anisotropy, "its anisotropy must lie between -0.95 and 0.95");
        check(
            volume.emission_strength >= 0 && volume.emission_strength <= most && is_within(volume.emission_color, most),
            "its emission must be finite and not negative");
        check(volume.blackbody_intensity >= 0 && volume.blackbody_intensity <= 1,
              "its blackbody intensity must lie between 0 and 1");
        check(is_within(volume.blackbody_tint, most), "its blackbody tint must be finite and not negative");
        check(volume.temperature >= 0 && volume.temperature <= 1e6f,
              "its temperature must lie between 0 and 1e6 kelvin");
        volume.outline = outline_of(volume);
        if (!volume.outline.box.any()) note_once(animation, name + ": there is nothing in it");
    }
}

}  // namespace render2mpeg::scene
