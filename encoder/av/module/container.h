#pragma once
// Muxes a coded stream into a container, with libavformat.
#include <filesystem>
#include <memory>

#include "encoder/av/backend.h"

/// Muxes with libavformat: `Backend::create` inside the module.
namespace render2mpeg::av {

/// `Backend::create` inside the module.
std::unique_ptr<Container> create_container(const std::filesystem::path& file, const ByteSink& sink, const char* format,
                                            const encoder::Settings& settings, const SequenceFacts& facts,
                                            const Sound& sound);

/// `Backend::check_film` inside the module.
void check_container(const std::filesystem::path& name, const char* format, encoder::Codec codec, const Sound& sound);

}  // namespace render2mpeg::av
