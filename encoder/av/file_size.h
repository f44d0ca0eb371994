#pragma once
// What containers add to pictures, about.
#include <cstdint>
#include <filesystem>

namespace render2mpeg::av {

/// Bytes for pictures in a file of `bytes`, after the container's share; at least 1.
double pictures_in_file(double bytes, std::int64_t pictures, const std::filesystem::path& file, bool disc);

/// File size of pictures of `bytes`, about.
double file_of_pictures(double bytes, std::int64_t pictures, const std::filesystem::path& file, bool disc);

/// The same as it is in the mean, with `sound` bytes of sound.
double likely_file(double bytes, double sound, std::int64_t pictures, const std::filesystem::path& file, bool disc);

}  // namespace render2mpeg::av
