#pragma once

#include <array>
#include <glm/glm.hpp>

#include "renderer/surface/surface_point.h"
#include "renderer/tree/light_kernels.h"

/// Light and lobes in hemispherical harmonics [Render2MPEG, eqs. 6.10-6.15], to be held against what records keep.
namespace render2mpeg::bench {

inline constexpr int most_coefficients = 64;

/// Functions over a hemisphere, each set orthonormal there. Stretched: spherical harmonics whose Legendre polynomials
/// are stretched over it, P(2 cos - 1) [Render2MPEG, eq. 6.10]; whatever turns with the azimuth is 0 at its rim. Even:
/// those spherical harmonics that are the same above and below its rim.
enum class Basis { stretched, even };

/// Orders of either set that are tried, and how many functions they have.
inline constexpr int tried_orders = 6;
int orders_of(Basis basis, int tried);
int functions_of(Basis basis, int orders);

/// Values at a direction of a frame whose third axis is the hemisphere's, order by order; 0 below it.
std::array<float, most_coefficients> harmonics_at(Basis basis, glm::vec3 direction);

/// What arrives at a place, cosine included, by channel.
class IncidentHarmonics {
  public:
    IncidentHarmonics(Basis basis, glm::vec3 axis);
    /// Light of this irradiance from a direction, spread over a disc of so many tangents' radius, squared.
    void add(glm::vec3 to_light, float spread2, glm::vec3 irradiance);
    glm::vec3 operator[](int i) const { return sums_[static_cast<std::size_t>(i)]; }
    const glm::mat3& to_frame() const { return to_frame_; }
    Basis basis() const { return basis_; }

  private:
    Basis basis_;
    glm::mat3 to_frame_{1};
    std::array<glm::vec3, most_coefficients> sums_{};
};

/// The two parts of a lobe, without the cosine, towards an eye.
struct LobeHarmonics {
    std::array<float, most_coefficients> f0{}, schlick{};
};
LobeHarmonics project_lobe(const IncidentHarmonics& light, glm::vec3 normal, glm::vec3 outgoing, float alpha);

/// Radiance of a lobe by the first so many functions.
glm::vec3 scattered(const IncidentHarmonics& light, const LobeHarmonics& lobe, glm::vec3 f0, int functions);

}  // namespace render2mpeg::bench
