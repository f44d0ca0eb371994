#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "tests/reference/random.h"
#include "tests/reference/surfaces.h"
#include "tests/reference/texels.h"

namespace render2mpeg::reference {

/// Light that may reach a place from one direction, if nothing is in the way.
struct Connection {
    glm::dvec3 to_light{0};  ///< unit
    double distance = 0;     ///< infinite for sky and suns
    glm::dvec3 light{0};     ///< radiance over the density of choosing the direction, or irradiance across it
};

/// Everything that shines in the posed scene.
class Lamps {
  public:
    explicit Lamps(const Surfaces& surfaces);

    /// Radiance of the sky.
    glm::dvec3 sky(glm::dvec3 direction) const;
    /// Radiance of the suns that have a size.
    glm::dvec3 suns(glm::dvec3 direction) const;

    /// Lights without a size, which no path can meet: all of them.
    std::vector<Connection> punctual(glm::dvec3 place) const;
    /// What paths can meet, one direction for each kind: a point of a surface that shines, a direction of the sky, one
    /// of each sun with a size.
    std::vector<Connection> extended(glm::dvec3 place, glm::dvec3 normal, Random& random) const;

  private:
    struct Emitter {
        std::uint32_t object, primitive;
        double area, upto;  ///< share of its and all earlier ones' power
    };
    void find_emitters();
    void measure_sky();
    void connect_surface(glm::dvec3 place, Random& random, std::vector<Connection>& connections) const;
    void connect_sky(glm::dvec3 normal, Random& random, std::vector<Connection>& connections) const;

    const Surfaces& surfaces_;
    std::vector<Emitter> emitters_;
    std::optional<Texels> sky_image_;
    std::vector<double> sky_upto_;  ///< by pixel: share of its and all earlier ones' power
};

}  // namespace render2mpeg::reference
