#pragma once
// How much of a file's size its container takes.
#include <cstdint>
#include <filesystem>

namespace render2mpeg::app {

/// Bytes that the pictures of a film may have so that a file of `bytes` with so many of them is surely large enough,
/// by what its container, which its ending names, takes for itself (more for a DVD's `disc`); at least 1.
double pictures_in_file(double bytes, std::int64_t pictures, const std::filesystem::path& file, bool disc);

/// Bytes of the file that so many pictures of `bytes` make, about.
double file_of_pictures(double bytes, std::int64_t pictures, const std::filesystem::path& file, bool disc);

}  // namespace render2mpeg::app
