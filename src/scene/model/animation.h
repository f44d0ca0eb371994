#pragma once
// A film's scene as plain data: nodes, objects, tracks, cameras, lights.
#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/fog.h"
#include "core/frame_packing.h"
#include "core/glare.h"
#include "core/rational.h"
#include "core/view.h"
#include "scene/model/camera.h"
#include "scene/model/light.h"
#include "scene/model/material.h"
#include "scene/model/mesh.h"
#include "scene/model/reflection.h"
#include "scene/model/shutter.h"
#include "scene/model/track.h"
#include "scene/model/volume.h"

namespace render2mpeg::scene {

/// A node of the hierarchy, in double precision.
struct Node {
    std::string name;
    int parent = -1;  ///< -1: root; the graph has no cycle after validation
    glm::dvec3 translation{0};
    glm::dquat rotation{1, 0, 0, 0};  ///< w, x, y, z; unit
    glm::dvec3 scale{1};
    std::optional<glm::dmat4> matrix;  ///< instead of the three above; such nodes are not animated
};

struct Skin {
    std::vector<int> joints;               ///< nodes
    std::vector<glm::dmat4> inverse_bind;  ///< as many
};

/// Change of an object's surface over the film: `rigid` as a whole, `deforming` vertex by vertex.
enum class Mobility { still, rigid, deforming };

/// Light through a mesh's glass. `none`: straight. `slab`: a window, which shifts the view and passes light straight.
/// `solid`: bends light.
enum class Body : std::uint8_t { none, slab, solid };

/// One mesh with one material at one node: the target of a pixel's object id.
struct Object {
    std::string name;
    int node = -1;
    int mesh = -1;
    int material = 0;
    int skin = -1;                     ///< -1: moved by its node; else by its joints alone [glTF2, 3.7.3.3]
    std::vector<float> morph_weights;  ///< where no track says otherwise
    Mobility mobility = Mobility::still;
    Body body = Body::none;
    float pane_thickness = 0;  ///< of a slab, world: the mean of its panes
};

/// From `frame` on, the film shows this camera.
struct Shot {
    std::int64_t frame = 0;
    int camera = 0;
};

/// A part of the film that players can go to, from `frame` on.
struct Chapter {
    std::int64_t frame = 0;
    std::string title;  ///< UTF-8
};

/// A scene with all its motion: plain data, constant after loading.
struct Animation {
    std::string source;  ///< the file the user named
    std::vector<std::filesystem::path>
        files;  ///< every file that was read for it, in that order; images are in `images`
    std::vector<Node> nodes;
    std::vector<Mesh> meshes;
    std::vector<Object> objects;
    std::vector<Skin> skins;
    std::vector<Material> materials;
    std::vector<ImageSource> images;
    std::vector<CameraLens> cameras;  ///< at least one after loading
    std::vector<Light> lights;
    std::vector<Volume> volumes;
    std::vector<Reflection> reflections;  ///< edits of reflections in mirrors
    Sky sky;
    int stage = -1;  ///< object: the floor that default light adds, which exposure looks past; -1: none
    std::vector<Track> tracks;
    std::vector<Shot> shots;        ///< by frame; empty: camera 0 throughout
    std::vector<Chapter> chapters;  ///< by frame

    /// Subtracted from world positions before they are rounded to single precision, so that far scenes lose no digits.
    glm::dvec3 origin{0};
    /// Corners of a box about all surfaces at the first frame, relative to `origin`; equal where there is no surface.
    glm::vec3 bounds_min{0}, bounds_max{0};

    double duration = 0;                    ///< seconds until the last key, or file of a volume; 0: nothing moves
    std::optional<std::string> frame_rate;  ///< as the animation file says
    std::optional<std::int64_t> first_frame, last_frame;   ///< likewise
    Shutter shutter;                                       ///< likewise, or as the command line says
    std::optional<float> exposure;                         ///< EV, likewise; none: automatic
    std::optional<core::View> view;                        ///< likewise; none: neutral
    core::Fog fog;                                         ///< likewise, or as the command line says
    core::Glare glare;                                     ///< likewise, or as the command line says
    int grain = 0;                                         ///< ISO of film grain, likewise; 0: none
    bool transparent = false;                              ///< the camera sees no world; likewise
    core::FramePacking stereo = core::FramePacking::none;  ///< of both eyes' pictures, likewise; none: a film for one
    std::optional<glm::ivec2> size;                        ///< picture width and height, likewise
    std::optional<core::Rational>
        display_aspect;  ///< width by height of the picture as shown, likewise; none: square pixels

    std::optional<std::filesystem::path> sound;  ///< begins with frame 0, likewise

    std::vector<std::string> notes;  ///< one line each: assumed, dropped or unknown features

    /// Surfaces of part coverage that an eye's, a shadow's and a gathered ray pass before all is black, as Cycles
    /// limits transparent bounces; none: as many as are traced. From the animation file.
    std::optional<int> layers;
};

}  // namespace render2mpeg::scene
