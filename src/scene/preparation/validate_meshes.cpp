// Checks meshes.
#include <algorithm>
#include <cmath>

#include "core/numeric.h"
#include "core/text.h"
#include "scene/model/wording.h"
#include "scene/preparation/validate.h"

namespace render2mpeg::scene {
namespace {

/// chosen: as animation files have it (json.h).
constexpr float widest_strand = 1e6f;

void check_sizes(const Animation& animation, const Mesh& mesh, const std::string& name) {
    const std::size_t n = mesh.positions.size();
    const auto check = [&](std::size_t size, const char* what) {
        if (size != 0 && size != n)
            refuse(animation, name,
                   "has " + std::to_string(size) + " " + what + " for " + core::counted(n, "position"));
    };
    check(mesh.normals.size(), "normals");
    check(mesh.tangents.size(), "tangents");
    check(mesh.uv[0].size(), "texture coordinates");
    check(mesh.uv[1].size(), "texture coordinates of the second set");
    check(mesh.colors.size(), "colours");
    check(mesh.joints.size(), "joints");
    for (const MorphTarget& target : mesh.morph_targets) {
        check(target.positions.size(), "morph positions");
        check(target.normals.size(), "morph normals");
    }
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (int k = 0; k < 3; ++k)
            if (mesh.triangles[t][k] >= n)
                refuse(animation, name,
                       "triangle " + std::to_string(t) + " has the corner " + std::to_string(mesh.triangles[t][k]) +
                           ", but there are " + std::to_string(n) + " vertices");
    if (!mesh.curves.empty() && mesh.radii.size() != n)
        refuse(animation, name,
               "has " + std::to_string(mesh.radii.size()) + " radii for " + core::counted(n, "position"));
    for (std::size_t s = 0; s < mesh.curves.size(); ++s)
        if (n < 4 || mesh.curves[s] > n - 4)
            refuse(animation, name,
                   "segment " + std::to_string(s) + " of its strands has positions that are not there");
}

/// Twice the area over the square of the longest edge: 0 for a triangle without area, whatever its size.
double flatness(glm::vec3 a, glm::vec3 b, glm::vec3 c) {
    const glm::dvec3 ab = glm::dvec3(b) - glm::dvec3(a), ac = glm::dvec3(c) - glm::dvec3(a),
                     bc = glm::dvec3(c) - glm::dvec3(b);
    const double longest = std::max({glm::dot(ab, ab), glm::dot(ac, ac), glm::dot(bc, bc)});
    return core::divide_or(glm::length(glm::cross(ab, ac)), longest, 0.0);
}

/// Finite in the base shape and in every target.
std::vector<char> sound_vertices(const Mesh& mesh) {
    std::vector<char> sound(mesh.positions.size(), 1);
    for (std::size_t v = 0; v < sound.size(); ++v) {
        if (!core::is_finite(mesh.positions[v])) sound[v] = 0;
        for (const MorphTarget& target : mesh.morph_targets)
            if (!target.positions.empty() && !core::is_finite(target.positions[v])) sound[v] = 0;
    }
    return sound;
}

/// Repairs of all meshes in one line.
class Tally {
  public:
    /// `verb` 3 `noun`s `reason`.
    Tally(const char* verb, const char* noun, const char* reason) : verb_(verb), noun_(noun), reason_(reason) {}
    void add(std::size_t count, const std::string& mesh) {
        if (count == 0) return;
        if (meshes_++ == 0) first_ = mesh;
        count_ += count;
    }
    void write(Animation& animation) const {
        if (count_ == 0) return;
        const std::string others = meshes_ > 1 ? " and " + core::counted(meshes_ - 1, "other") : "";
        note_once(animation, first_ + others + ": " + verb_ + " " + core::counted(count_, noun_) + " " + reason_);
    }

  private:
    std::string verb_, noun_, reason_, first_;
    std::size_t count_ = 0, meshes_ = 0;
};

struct Tallies {
    Tally flat{"dropped", "triangle", "without area"};
    Tally thin{"dropped", "segment", "of hair without width or length"};
    Tally normals{"derived", "normal", "in place of what is not finite"};
    Tally attributes{"replaced", "texture coordinate or colour", "as not finite"};
};

/// Broken corners are damage (docs/decisions.md#broken-corners-are-refused).
void refuse_broken_corners(const Animation& animation, const Mesh& mesh, const std::vector<char>& sound,
                           const std::string& name) {
    for (const glm::uvec3& t : mesh.triangles)
        for (int k = 0; k < 3; ++k)
            if (!sound[t[k]]) refuse(animation, name, "vertex " + std::to_string(t[k]) + " is not finite");
}

void drop_triangles(const Animation& animation, Mesh& mesh, const std::string& name, Tallies& tallies) {
    // Deformation may open a flat triangle.
    const bool bends = !mesh.joints.empty() || !mesh.morph_targets.empty();
    const std::vector<char> sound = sound_vertices(mesh);
    refuse_broken_corners(animation, mesh, sound, name);
    std::size_t flat = 0;
    const auto is_bad = [&](const glm::uvec3& t) {
        const bool repeats = t.x == t.y || t.y == t.z || t.x == t.z;
        // chosen: 1e-10; a needle of 1e6 : 1 has 1e-6, three points in a line of single precision coordinates up to
        // 1e-14.
        if (repeats || (!bends && flatness(mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]) <= 1e-10))
            return ++flat, true;
        return false;
    };
    mesh.triangles.erase(std::remove_if(mesh.triangles.begin(), mesh.triangles.end(), is_bad), mesh.triangles.end());
    tallies.flat.add(flat, name);

    for (std::size_t v = 0; v < sound.size(); ++v) {
        if (sound[v]) continue;
        mesh.positions[v] = glm::vec3(0);
        for (MorphTarget& target : mesh.morph_targets)
            if (!target.positions.empty()) target.positions[v] = glm::vec3(0);
    }
}

/// `point 3 of strand 12`, as files count them: from 0, without the ends' doubles. Segments of a strand lie in a row.
std::string place_on_strand(const Mesh& mesh, std::size_t segment, std::uint32_t position) {
    const auto starts = [&](std::size_t s) { return s == 0 || mesh.curves[s] != mesh.curves[s - 1] + 1; };
    std::size_t strand = 0, first = 0, last = segment;
    for (std::size_t s = 1; s <= segment; ++s)
        if (starts(s)) ++strand, first = s;
    while (last + 1 < mesh.curves.size() && !starts(last + 1)) ++last;
    const std::uint32_t root = mesh.curves[first] + 1, tip = mesh.curves[last] + 2;
    return "point " + std::to_string(std::clamp(position, root, tip) - root) + " of strand " + std::to_string(strand);
}

/// Broken points are damage as corners are.
void refuse_broken_strands(const Animation& animation, const Mesh& mesh, const std::string& name) {
    const std::vector<char> sound = sound_vertices(mesh);
    for (std::size_t s = 0; s < mesh.curves.size(); ++s) {
        const std::uint32_t first = mesh.curves[s];
        for (std::uint32_t k = first; k < first + 4; ++k) {
            const auto is_bad = [&](const std::string& cause) {
                refuse(animation, name, place_on_strand(mesh, s, k) + " " + cause);
            };
            if (!sound[k]) is_bad("is not finite");
            if (!std::isfinite(mesh.radii[k])) is_bad("has a radius that is not finite");
            // Points before and behind only bend it.
            if (k == first || k == first + 3) continue;
            if (mesh.radii[k] < 0) is_bad("has a radius below 0");
            if (mesh.radii[k] > widest_strand) is_bad("has a radius above 1000000");
        }
    }
}

void drop_segments(Mesh& mesh, const std::string& name, Tallies& tallies) {
    const bool bends = !mesh.joints.empty() || !mesh.morph_targets.empty();
    std::size_t thin = 0;
    const auto is_bad = [&](std::uint32_t first) {
        const float a = mesh.radii[first + 1], b = mesh.radii[first + 2];
        const bool short_one = !bends && mesh.positions[first + 1] == mesh.positions[first + 2];
        return (a == 0 && b == 0) || short_one ? (++thin, true) : false;
    };
    mesh.curves.erase(std::remove_if(mesh.curves.begin(), mesh.curves.end(), is_bad), mesh.curves.end());
    tallies.thin.add(thin, name);
}

/// Area-weighted mean normal of the triangles about each vertex that is marked.
void derive_normals(Mesh& mesh, const std::vector<char>& wanted) {
    std::vector<glm::dvec3> sum(mesh.positions.size(), glm::dvec3(0));
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::dvec3 a(mesh.positions[t.x]);
        const glm::dvec3 cross = glm::cross(glm::dvec3(mesh.positions[t.y]) - a, glm::dvec3(mesh.positions[t.z]) - a);
        for (int k = 0; k < 3; ++k) sum[t[k]] += cross;
    }
    for (std::size_t v = 0; v < sum.size(); ++v) {
        if (!wanted[v]) continue;
        const double length = glm::length(sum[v]);
        mesh.normals[v] = length > 0 ? glm::vec3(sum[v] / length) : glm::vec3(0, 1, 0);
    }
}

void mend_normals(Mesh& mesh, const std::string& name, Tallies& tallies) {
    // Normalise; unit normals stay as they are.
    std::vector<char> missing(mesh.normals.size(), 0);
    std::size_t broken = 0;
    for (std::size_t v = 0; v < mesh.normals.size(); ++v) {
        glm::vec3& n = mesh.normals[v];
        const double length2 = glm::dot(glm::dvec3(n), glm::dvec3(n));
        if (std::abs(length2 - 1) < 1e-6) continue;
        const glm::vec3 unit = core::normalize_or(n, glm::vec3(0));
        missing[v] = unit == glm::vec3(0);
        broken += !core::is_finite(n);
        n = unit;
    }
    if (std::find(missing.begin(), missing.end(), 1) != missing.end()) derive_normals(mesh, missing);
    tallies.normals.add(broken, name);
    for (MorphTarget& target : mesh.morph_targets)
        for (glm::vec3& n : target.normals)
            if (!core::is_finite(n)) n = glm::vec3(0);
}

void mend_attributes(Mesh& mesh, const std::string& name, Tallies& tallies) {
    std::size_t broken = 0;
    for (std::vector<glm::vec2>& set : mesh.uv)
        for (glm::vec2& uv : set)
            if (!core::is_finite(uv)) uv = glm::vec2(0), ++broken;
    for (glm::vec4& c : mesh.colors) {
        if (!core::is_finite(glm::vec3(c)) || !std::isfinite(c.a)) c = glm::vec4(1), ++broken;
        // Above 1 a surface would send out more than falls on it.
        c = glm::clamp(c, glm::vec4(0), glm::vec4(1));
    }
    tallies.attributes.add(broken, name);

    for (glm::vec4& t : mesh.tangents) {
        glm::vec3 unit(t);
        if (!(std::abs(glm::dot(unit, unit) - 1) < 1e-6f)) unit = core::normalize_or(unit, glm::vec3(0));
        if (unit == glm::vec3(0) || !std::isfinite(t.w)) {
            mesh.tangents.clear();
            break;
        }
        t = glm::vec4(unit, t.w < 0 ? -1.0f : 1.0f);
    }

    // Weights sum to 1; a vertex that no joint holds follows the first.
    for (VertexJoints& joints : mesh.joints) {
        double sum = 0;
        for (float& w : joints.weight) {
            if (!(w > 0) || !std::isfinite(w)) w = 0;
            sum += static_cast<double>(w);
        }
        if (sum == 0)
            joints.weight[0] = 1;
        else if (std::abs(sum - 1) > 1e-6)
            for (float& w : joints.weight) w = static_cast<float>(static_cast<double>(w) / sum);
    }
}

}  // namespace

void validate_meshes(Animation& animation) {
    Tallies tallies;
    for (std::size_t i = 0; i < animation.meshes.size(); ++i) {
        Mesh& mesh = animation.meshes[i];
        const std::string name = described("mesh", i, mesh.name);
        check_sizes(animation, mesh, name);
        refuse_broken_strands(animation, mesh, name);
        drop_segments(mesh, name, tallies);
        drop_triangles(animation, mesh, name, tallies);
        mend_normals(mesh, name, tallies);
        mend_attributes(mesh, name, tallies);
    }
    for (const Tally* tally : {&tallies.flat, &tallies.thin, &tallies.normals, &tallies.attributes})
        tally->write(animation);
}

}  // namespace render2mpeg::scene
