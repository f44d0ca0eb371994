#pragma once

#include <filesystem>
#include <vector>

#include "app/files/chunk_file.h"
#include "app/options/film.h"

namespace render2mpeg::app {

/// Joins chunks to one film `file`, whose format the ending of `name` tells.
void assemble(const std::vector<ChunkFile>& chunks, const Film& film, const std::filesystem::path& file,
              const std::filesystem::path& name);

/// Decodes the film and throws core::Error unless every picture equals its recorded reconstruction bit for bit.
void verify(const std::filesystem::path& film, const std::vector<ChunkFile>& chunks);

}  // namespace render2mpeg::app
