#pragma once
// Gives a film without cameras one that shows it.
#include <string>

#include "scene/model/animation.h"

namespace render2mpeg::scene {

/// How a camera looks at a film: from an orbit about it, into its open side, or turning about within it.
enum class View { orbit, front, turn };

/// Camera added to a film without cameras.
struct AutomaticCamera {
    std::string note;  ///< one-line description
    View view = View::orbit;
};

/// Gives a film without cameras one that shows it (two nodes, a lens and a track). `in_studio`: orbits are as products
/// are shown, a slow turn of at most four seconds about still things, which fill the picture. Needs a film that is
/// valid otherwise.
AutomaticCamera add_automatic_camera(Animation& animation, bool in_studio);

/// Moves that camera, if it is the film's, so that what it shows fills a picture that is higher than wide. `aspect`:
/// width of the picture over its height, as it is shown.
void fit_automatic_camera(Animation& animation, double aspect);

}  // namespace render2mpeg::scene
