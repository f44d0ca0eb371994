#pragma once

#include <filesystem>

/// Where the tree lies that is being tested. Only places.cpp knows, so that the tests' own object files are the same
/// for every checkout.
namespace render2mpeg::support {

std::filesystem::path source_folder();
std::filesystem::path binary_folder();

}  // namespace render2mpeg::support
