#pragma once
// Objects of an animation file, and its changes to another scene.

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "scene/animation_file/json.h"
#include "scene/animation_file/looks.h"
#include "scene/animation_file/movement.h"
#include "scene/model/animation.h"

namespace render2mpeg::scene {

/// Objects of built-in shapes, and changes to the scene's.
class Objects {
  public:
    Objects(Animation& film, Looks& looks, const FilmClock& clock) : film_(film), looks_(looks), clock_(clock) {}

    void read(const JsonValue& objects);

    /// Moves, hides or repaints nodes by name, else objects.
    void read_changes(const JsonValue& changes);

    /// Reads the reflection edits of mirrors, after all objects.
    void read_edits();

  private:
    void build(const JsonValue& value, int parent);
    int mesh_of(const JsonValue& value);
    void repaint(const JsonValue& material, const std::vector<int>& nodes, const std::string& name);

    Animation& film_;
    Looks& looks_;
    const FilmClock& clock_;
    std::vector<std::pair<JsonValue, int>> edited_;  ///< things with `reflections`, and their nodes
    std::map<std::string, int> mesh_at_;             ///< by the place of the shape in the file: copies share it
};

}  // namespace render2mpeg::scene
