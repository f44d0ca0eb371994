#pragma once
// Accessors: the only place that turns bytes of a glTF file into numbers.
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

#include "scene/gltf/document.h"

namespace render2mpeg::scene::gltf {

/// The numbers of an accessor, row by row.
struct Floats {
    int components = 1;
    std::vector<float> values;
    std::size_t count() const { return values.size() / static_cast<std::size_t>(components); }
};

/// Accessor as numbers: normalised integers map to [0, 1] or [-1, 1] [glTF2, 3.6.2.2]. `components`: allowed;
/// `expected_count` 0: any; `user`: for messages. Values may be non-finite.
Floats read_floats(const Document& document, int accessor, std::initializer_list<int> components,
                   std::size_t expected_count, const std::string& user);
/// The same, but every number must be finite.
Floats read_finite_floats(const Document& document, int accessor, std::initializer_list<int> components,
                          std::size_t expected_count, const std::string& user);

/// An accessor of unsigned integers, row by row.
std::vector<std::uint32_t> read_integers(const Document& document, int accessor, int components,
                                         std::size_t expected_count, const std::string& user);

}  // namespace render2mpeg::scene::gltf
