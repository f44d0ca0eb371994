#include "app/publish.h"

#include <fstream>
#include <system_error>

#include "core/error.h"

namespace render2mpeg::app {

void check_writable(const std::filesystem::path& file) {
    const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) throw core::Error("writing", file.string(), error.message());
    if (std::filesystem::is_directory(file)) throw core::Error("writing", file.string(), "it is a folder");
    const std::filesystem::path probe = folder / (file.filename().string() + ".probe");
    if (!std::ofstream(probe)) throw core::Error("writing", file.string(), "the folder cannot be written");
    std::filesystem::remove(probe, error);
}

std::uint64_t publish(const std::vector<ChunkFile>& chunks, const Film& film, const WorkFolder& work,
                      const std::filesystem::path& target) {
    const std::filesystem::path file = work.path("film" + target.extension().string());
    assemble(chunks, film, file, target);
    verify(file, chunks);
    const std::uint64_t bytes = std::filesystem::file_size(file);
    std::error_code error;
    std::filesystem::rename(file, target, error);
    if (error) throw core::Error("writing", target.string(), error.message());
    return bytes;
}

}  // namespace render2mpeg::app
