#pragma once

#include <map>
#include <string>
#include <utility>

#include "scene/animation_file/json.h"
#include "scene/animation_file/looks.h"
#include "scene/animation_file/movement.h"
#include "scene/model/animation.h"

namespace render2mpeg::scene {

/// What an animation file puts into the scene: objects of built-in shapes, and lights.
class Things {
  public:
    Things(Animation& film, Looks& looks, const FilmClock& clock) : film_(film), looks_(looks), clock_(clock) {}

    void read_objects(const JsonValue& objects);
    void read_lights(const JsonValue& lights);

    /// Moves, hides or repaints what the scene file has: by the name of a node, else of an object.
    void read_changes(const JsonValue& changes);

  private:
    void build_object(const JsonValue& value, int parent);
    void build_light(const JsonValue& value, std::size_t number);
    void build_punctual(const JsonValue& value, const std::string& name, int node, std::size_t copy);
    void build_lamp(const JsonValue& value, const std::string& name, int node, std::size_t copy);
    int mesh_of(const JsonValue& value);
    void add_object(const std::string& name, int node, int mesh, int material);
    Curve power_of(const JsonValue& value, std::size_t copy);
    void repaint(const JsonValue& material, const std::vector<int>& nodes, const std::string& name);

    Animation& film_;
    Looks& looks_;
    const FilmClock& clock_;
    std::map<std::string, int> mesh_at_;  ///< by the place of the shape in the file: copies share it
    std::map<std::string, int> lamp_material_at_;
};

}  // namespace render2mpeg::scene
