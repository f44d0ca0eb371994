#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include "core/sampling.h"

namespace render2mpeg::reference {

/// The random numbers of one path.
class Random {
  public:
    Random(std::uint64_t seed, std::uint64_t path) : seed_(seed), path_(path) {}

    /// Uniform in [0, 1).
    double one() { return core::uniform(seed_, path_, count_++); }
    glm::dvec3 three() {
        const double x = one(), y = one();
        return {x, y, one()};
    }

  private:
    std::uint64_t seed_, path_, count_ = 0;
};

}  // namespace render2mpeg::reference
